//! Random programs in the languages of controls, against an interpreter of their intents that shares no code with the package: none that
//! collides is clean.

mod draw;
mod kinematics;
mod meaning;
mod text;
mod truth;

use crate::frozen::Frozen;
use crate::oracle::{Mounted, Random};
use draw::draw;
use kinematics::Machine;
use meaning::{Control, Intent, LENGTHS, Language, Way};
use nalgebra::{Point3, Vector3};
use touchoff::certify::TriangleBvh;
use touchoff::{Unit, mesh::shapes};
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::job::{Body, FindingRule, JobFinding, NoVerdict};
use touchoff_verify::{Job, JobError, JobTool, Program, Verdict};
use truth::{Cuboid, Limited};

/// Values of X, Y, Z in mm and A, B, C in degrees.
type Axes = [f64; 6];

const LANGUAGES: [Language; 5] =
    [Language::LinuxCnc, Language::Fanuc, Language::Haas, Language::Klartext, Language::Sinumerik];

/// A program by its intents, and the job in which it is checked.
struct Case {
    language: Language,
    machine: Machine,
    origins: [Axes; 2],
    rates: Axes,
    unit: f64,
    way: Way,
    takes_table_as_it_stands: bool,
    intents: Vec<Intent>,
    /// The part, then fixtures.
    boxes: Vec<Cuboid>,
}

/// The end of a check, with its findings or the reasons against a verdict.
struct Checked {
    outcome: Outcome,
    /// Set if a surface is in a box.
    touches: bool,
    text: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    Clean,
    Findings,
    Open,
    Refused,
}

/// Numbers of programs.
#[derive(Debug, Default)]
struct Counts {
    clean: usize,
    findings: usize,
    open: usize,
    refused: usize,
    colliding: usize,
}

impl Checked {
    fn refused(error: &JobError) -> Checked {
        Checked { outcome: Outcome::Refused, touches: false, text: error.to_string() }
    }
}

impl Counts {
    fn add(&mut self, outcome: Outcome, is_colliding: bool) {
        self.colliding += usize::from(is_colliding);
        *match outcome {
            Outcome::Clean => &mut self.clean,
            Outcome::Findings => &mut self.findings,
            Outcome::Open => &mut self.open,
            Outcome::Refused => &mut self.refused,
        } += 1;
    }
}

impl Case {
    fn draw(random: &mut Random) -> Case {
        let language = LANGUAGES[random.choice(5)];
        let machine = Machine::draw(random);
        let mut origins = [[0.0; 6]; 2];
        for origin in &mut origins {
            for (k, value) in origin.iter_mut().enumerate().take(3) {
                *value = random.between(-20.0, 20.0).round() + if k == 2 { -440.0 } else { 0.0 };
            }
        }
        if random.chance(0.3) {
            for origin in &mut origins {
                for (k, value) in origin.iter_mut().enumerate().skip(3) {
                    if machine.has(k) && random.chance(0.5) {
                        *value = random.between(-40.0, 40.0).round();
                    }
                }
            }
        }
        if random.chance(0.6) {
            let [first, second] = &mut origins;
            second[3..].copy_from_slice(&first[3..]);
        }
        let rates = machine.rates.unwrap_or_else(|| [0; 6].map(|_| random.between(5e3, 3e4)));
        let way = match language {
            Language::LinuxCnc | Language::Haas => Way::Counts,
            Language::Fanuc => Way::Shortest,
            Language::Klartext => [Way::Counts, Way::Shortest][random.choice(2)],
            Language::Sinumerik => Way::WithinTurn,
        };
        let mut case = Case {
            language,
            machine,
            origins,
            rates,
            unit: if random.chance(0.15) { 25.4 } else { 1.0 },
            way,
            takes_table_as_it_stands: language == Language::Fanuc && random.chance(0.3),
            intents: Vec::new(),
            boxes: Vec::new(),
        };
        let mut control = case.start();
        let count = random.between(3.0, 14.0) as usize;
        for _ in 0..count {
            for intent in draw(random, &control) {
                control.perform(&intent);
                case.intents.push(intent);
            }
        }
        case.place_boxes(random);
        case
    }

    fn start(&self) -> Control {
        let mut control =
            Control::new(self.language, self.machine.clone(), self.origins, self.rates);
        (control.unit, control.way) = (self.unit, self.way);
        control.takes_table_as_it_stands = self.takes_table_as_it_stands;
        control.write_head();
        control.approach();
        control
    }

    fn play(&self) -> Control {
        let mut control = self.start();
        self.intents.iter().for_each(|intent| control.perform(intent));
        control.finish();
        control
    }

    /// Places boxes at the tool on its way, or beside it: of several, the one that the fewest motions meet.
    fn place_boxes(&mut self, random: &mut Random) {
        let played = self.play();
        let met_index = random.choice(6);
        for index in 0..3 {
            let meets = index == met_index;
            let mut best: Option<(usize, Cuboid)> = None;
            for _ in 0..10 {
                // A cycle has many motions in one block.
                let first = random.choice(played.motions.len());
                let line = random.choice(played.text.lines().count());
                let mut of_line = played.motions.iter().filter(|motion| motion.line == line);
                let motion = of_line.next().unwrap_or(&played.motions[first]);
                let pose = motion.poses[random.choice(motion.poses.len())];
                let side = pose.axis.cross(&random.vector(1.0)).normalize();
                let away =
                    if meets { random.between(0.0, 3.0) } else { random.between(12.0, 30.0) };
                let along = if index == 0 { 13.0 } else { 0.0 };
                let centre = pose.tip + random.between(along, 36.0) * pose.axis + away * side;
                let half = Vector3::from([0; 3].map(|_| random.between(0.8, 3.0)));
                let cuboid = Cuboid { centre, half };
                let met =
                    played.motions.iter().filter(|motion| collides(motion, &cuboid, index == 0));
                let met = met.count();
                let is_better =
                    |best: &Option<(usize, Cuboid)>| best.is_none_or(|(least, _)| met < least);
                let is_clear = || {
                    played
                        .motions
                        .iter()
                        .flat_map(|motion| &motion.poses)
                        .all(|pose| cuboid.is_clear(pose))
                };
                if (if meets { met > 0 } else { met == 0 && is_clear() }) && is_better(&best) {
                    best = Some((met, cuboid));
                }
            }
            let far = Vector3::new(2000.0, 100.0 * index as f64, 0.0);
            let nowhere = Cuboid { centre: far, half: Vector3::repeat(5.0) };
            self.boxes.push(best.map_or(nowhere, |(_, cuboid)| cuboid));
        }
    }

    fn setup(&self) -> (ControlSetup, &'static str) {
        let (name, file) = match self.language {
            Language::LinuxCnc => ("linuxcnc", "a.ngc"),
            Language::Fanuc => ("fanuc", "a.nc"),
            Language::Haas => ("haas", "a.nc"),
            Language::Klartext => ("heidenhain", "a.h"),
            Language::Sinumerik => ("siemens", "a.mpf"),
        };
        let mut rules = ControlRules::named(name).expect("a control");
        if matches!(self.language, Language::Fanuc | Language::Haas) {
            rules = rules
                .with(Rule::ReferenceReturn, Choice::KeepsLength)
                .with(Rule::LengthChange, Choice::WithNextZ)
                .with(Rule::CycleRepeats, Choice::RepeatsByL)
                .with(Rule::WholeRadii, Choice::Units);
        }
        if self.language == Language::Fanuc && !self.takes_table_as_it_stands {
            rules = rules.with(Rule::TcpStart, Choice::TableAtZero);
        }
        if self.language == Language::Sinumerik {
            rules = rules
                .with(Rule::ToolLength, Choice::Always)
                .with(Rule::Rotary, Choice::WithinTurn)
                .with(Rule::SwivelAxis, Choice::FirstAxis)
                .with(Rule::TransformationOffset, Choice::DeselectsOffset);
        }
        let setup = ControlSetup {
            work_offsets: std::array::from_fn(|k| self.origins.get(k).copied()),
            lengths: [(1, LENGTHS[0]), (2, LENGTHS[1])].into(),
            presets: [(1, 1), (2, 2)].into(),
            rules,
            ..ControlSetup::default()
        };
        (setup, file)
    }

    fn check(&self, text: &str) -> Checked {
        let (setup, name) = self.setup();
        let machine = touchoff_verify::machine::Machine::parse(&self.machine.file(), "a.toml");
        let machine = machine.expect("a machine");
        let program = match Program::parse(text, name, machine, &setup) {
            Ok(program) => program,
            Err(error) => return Checked::refused(&error),
        };
        let meshes: Vec<TriangleBvh> = self.boxes.iter().map(mesh).collect();
        let mut job = Job::new(&program, &meshes[0]);
        job.resolution = Some(0.02);
        for number in [1, 2] {
            let mut tool = JobTool::numbered(number, &Mounted);
            tool.allow = ["ball", "flute"].map(|name| (name.to_owned(), f64::INFINITY)).to_vec();
            job.tools.push(tool);
        }
        job.bodies.extend(meshes[1..].iter().map(|mesh| Body::fixture("the clamp", mesh)));
        let report = match job.check(&|_| ()) {
            Ok(report) => report,
            Err(error) => return Checked::refused(&error),
        };
        // A program that is far from the part is as clean as one that is near.
        let mut refusals = report.refusals();
        refusals.retain(|refusal| !matches!(refusal.code(), "V0203" | "V0204" | "V0603"));
        let is_unread = refusals.iter().any(|refusal| matches!(refusal, NoVerdict::Unread { .. }));
        let outcome = match report.verdict() {
            Verdict::Findings => Outcome::Findings,
            _ if is_unread => Outcome::Refused,
            _ if !refusals.is_empty() => Outcome::Open,
            _ => Outcome::Clean,
        };
        let findings = report.findings().iter().map(ToString::to_string);
        let reasons = refusals.iter().map(ToString::to_string);
        let text = findings.chain(reasons).collect::<Vec<_>>().join("\n");
        // A finding under one of several ways of a control may lie beside the one that is taken for the truth.
        let is_surface = |finding: &JobFinding| {
            finding.under.is_none()
                && matches!(finding.rule, FindingRule::Deep | FindingRule::Inside)
        };
        Checked { outcome, touches: report.findings().iter().any(is_surface), text }
    }

    /// Returns the line of a motion that collides, and the box.
    fn collision(&self, played: &Control) -> Option<(usize, usize)> {
        played.motions.iter().find_map(|motion| {
            let mut boxes = self.boxes.iter().enumerate();
            let hit = boxes.find(|(index, cuboid)| collides(motion, cuboid, *index == 0))?;
            Some((motion.line, hit.0))
        })
    }

    /// Returns whether a program that collides is clean.
    fn is_missed(&self) -> bool {
        let played = self.play();
        self.collision(&played).is_some() && self.check(&played.text).outcome == Outcome::Clean
    }

    /// Returns whether a surface is found in a box, to which no way of the axes that the rules allow leads.
    fn is_found_in_vain(&self) -> bool {
        let played = self.play();
        let is_one_way = !played.each_axis || self.machine.rates.is_some();
        let mut poses = played.motions.iter().flat_map(|motion| &motion.poses);
        is_one_way
            && poses.all(|pose| self.boxes.iter().all(|cuboid| cuboid.is_clear(pose)))
            && self.check(&played.text).touches
    }

    /// Drops intents while a predicate holds, and returns the program and its job.
    fn reduced(mut self, holds: impl Fn(&Case) -> bool) -> String {
        let mut index = 0;
        while index < self.intents.len() {
            let intent = self.intents.remove(index);
            if !holds(&self) {
                self.intents.insert(index, intent);
                index += 1;
            }
        }
        let played = self.play();
        let (setup, _) = self.setup();
        format!(
            "{:?}: line and box of a collision: {:?}\norigins: {:?}\nboxes: {:?}\nrules: {:?}\n{}\n{}\n{:#?}\n{}",
            self.language,
            self.collision(&played),
            self.origins,
            self.boxes,
            setup.rules,
            self.machine.file(),
            played.text,
            self.intents,
            self.check(&played.text).text
        )
    }
}

impl Control {
    fn perform(&mut self, intent: &Intent) {
        self.write(intent);
        self.execute(intent);
    }

    /// Ends what is in force, and the program.
    fn finish(&mut self) {
        if self.is_tcp {
            self.perform(&Intent::Tcp { is_on: false, is_vector: false });
        }
        if self.mirror != Vector3::repeat(1.0) {
            self.perform(&Intent::Mirror([false; 2]));
        }
        if self.is_tilted
            || self.inner.rotation.angle() > 0.0
            || self.language == Language::Sinumerik
        {
            self.perform(&Intent::Level(None));
        }
        if self.shift != [0.0; 6] || self.inner.translation.vector.norm() > 0.0 {
            self.perform(&Intent::Shift { axes: [Some(0.0); 6], adds: false });
        }
        if self.preset != [0.0; 6] {
            self.text.push_str("G92.1\n");
        }
        if self.offset != 0 {
            self.perform(&Intent::Offset(0));
        }
        self.write_end();
    }
}

/// Returns whether a motion collides with a box. In feed the part may be cut.
fn collides(motion: &meaning::Motion, cuboid: &Cuboid, is_part: bool) -> bool {
    let limited = if is_part && !motion.rapid { Limited::NotCutting } else { Limited::All };
    motion.poses.iter().any(|pose| cuboid.collides(pose, limited))
}

fn mesh(cuboid: &Cuboid) -> TriangleBvh {
    let [low, high] = [-1.0, 1.0].map(|sign| Point3::from(cuboid.centre + sign * cuboid.half));
    TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid"))
}

/// Returns the number of programs: 10,000 with `PROGRAMS=10000`.
fn programs() -> usize {
    match std::env::var("PROGRAMS") {
        Ok(count) => count.parse().expect("PROGRAMS is a number of programs"),
        Err(_) => 40,
    }
}

#[test]
fn no_program_that_collides_is_clean() {
    let mut counts = LANGUAGES.map(|_| Counts::default());
    let mut frozen = Frozen::new("programs", 20);
    for seed in 1..=programs() {
        let case = Case::draw(&mut Random::new(seed as u64));
        let played = case.play();
        let is_colliding = case.collision(&played).is_some();
        let checked = case.check(&played.text);
        let language = LANGUAGES.iter().position(|language| *language == case.language);
        counts[language.expect("a language")].add(checked.outcome, is_colliding);
        frozen.add(&played.text, &format!("{:?}\n{}", checked.outcome, checked.text));
        if checked.outcome == Outcome::Clean && is_colliding {
            panic!("{seed} collides and is clean:\n{}", case.reduced(Case::is_missed));
        }
        if checked.touches && !is_colliding && case.is_found_in_vain() {
            panic!("{seed} is free and has findings:\n{}", case.reduced(Case::is_found_in_vain));
        }
    }
    frozen.assert();
    for (language, count) in LANGUAGES.iter().zip(&counts) {
        println!("{language:?}: {count:?}");
    }
    // Without verdicts and collisions the test would prove nothing.
    let sum = |of: fn(&Counts) -> usize| counts.iter().map(of).sum::<usize>();
    assert!(3 * sum(|count| count.clean + count.findings) > programs());
    assert!(4 * sum(|count| count.colliding) > programs());
}
