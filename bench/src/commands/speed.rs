//! The page `speed.md`: what queries and checks skip and what that saves, and run times beside goals and other methods.

use crate::commands::certified::Scene;
use clap::Args;
use cpu_time::ProcessTime;
use nalgebra::{Point3, Vector3};
use std::error::Error;
use std::fmt::Write;
use std::hint::black_box;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::scenes::{POSES, ScenePath, tube};
use touchoff::tool::{Evaluations, Outputs, PointBatch};
use touchoff::{
    Cloud, Law, Level, Mesh, Part, Pose, Probe, Sampling, Scene as Parts, SurfaceId, Tool, Unit,
};
use touchoff_bench::page::{Page, Section};
#[cfg(feature = "peers")]
use touchoff_bench::peers::parry_bvh::ParryBvh;
#[cfg(feature = "peers")]
use touchoff_bench::race::contender::Contender;
use touchoff_postures::sweep::{PostureSweep, SweepStats};
use touchoff_postures::{Directions, Rules};
use touchoff_tools::{BallEr16, D2Ball, Fig73Exact};
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::job::{Body, Job, JobTool, Program};
use touchoff_verify::machine::Machine;
use touchoff_verify::{MachineProgram, ToolSelection, Verifier};

/// Times work with and without what is skipped, and the slowest uses beside their goals.
#[derive(Args)]
pub(crate) struct Speed {
    /// A closed part in mm, as STL, whose accessibility is swept beside that of a generated tube.
    #[arg(long, value_name = "FILE.stl")]
    part: Option<PathBuf>,
    /// Time for each pair of rivals, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, value_parser = super::not_negative)]
    seconds: f64,
}

impl Speed {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let skipped = self.skipped()?;
        let ratios = self.ratios()?;
        Ok(Some(Page {
            name: "speed",
            title: "What is skipped, and how fast that is",
            covers: &[
                "postures/src/sweep",
                "runtime/src/bvh",
                "runtime/src/certify",
                "runtime/src/mesh",
                "runtime/src/point_bvh",
                "runtime/src/probe",
                "runtime/src/scene.rs",
                "runtime/src/storage",
                "runtime/src/tool",
                "verify/src/check",
                "verify/src/job",
            ],
            sections: vec![
                Section { title: "What is skipped", body: skipped },
                Section { title: "Beside goals and other methods", body: ratios },
            ],
            figures: Vec::new(),
        }))
    }

    /// Times two ways to do the same in turns of 25 steps, and returns their median times per step, in µs. `first` and
    /// `second` do the step of an index.
    fn race<A, B>(
        &self,
        mut first: impl FnMut(usize) -> A,
        mut second: impl FnMut(usize) -> B,
    ) -> [f64; 2] {
        const STEPS: usize = 25;
        let mut times = [Vec::new(), Vec::new()];
        let (start, mut turn) = (Instant::now(), 0);
        // No step is repeated until the path is gone through.
        while turn < 4 || start.elapsed() < Duration::from_secs_f64(self.seconds) {
            for order in 0..2 {
                let way = (turn + order) % 2;
                let now = Instant::now();
                for index in turn * STEPS..(turn + 1) * STEPS {
                    if way == 0 {
                        black_box(first(index % POSES));
                    } else {
                        black_box(second(index % POSES));
                    }
                }
                times[way].push(now.elapsed().as_secs_f64() * 1e6 / STEPS as f64);
            }
            turn += 1;
        }
        times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        })
    }
}

/// A row of the table of skipped work.
struct Skip {
    stage: &'static str,
    skipped: &'static str,
    step: &'static str,
    /// The times with the skipping and without it, µs per step.
    times: [f64; 2],
}

impl Speed {
    fn skipped(&self) -> Result<String, Box<dyn Error>> {
        let on_one_core =
            [self.outputs()?, self.points()?, self.regions(), self.parts()?, self.surfaces()?];
        let rows = on_one_core.into_iter().chain([self.free_space()?, self.readings()?]);
        let mut body = String::from(
            "Each row does the same work in two ways, in turns, both with this library: as it does it, and as if it could not skip this. \
             Medians on one core, µs per step; motions and readings in CPU time.\n\n\
             | stage | what is skipped | step | skipping | not skipping | saves |\n|---|---|---|--:|--:|--:|\n",
        );
        for Skip { stage, skipped, step, times: [with, without] } in rows {
            let saved = (100.0 * (1.0 - with / without)).round();
            let saved = if saved > 0.0 { format!("{saved:.0} %") } else { "nothing".into() };
            writeln!(
                body,
                "| {stage} | {skipped} | {step} | {with:.3} | {without:.3} | {saved} |"
            )?;
        }
        body += "\nTools are skipped before anything runs: a crate compiles those that it names (feature by feature of `touchoff-tools`), and a \
                 block of a program is checked with the tool in the spindle only.\n";
        Ok(body)
    }

    /// The deepest point, with all outputs at all points inside instead of depth alone.
    fn outputs(&self) -> Result<Skip, Box<dyn Error>> {
        let part = points_of(&tube(), 20_000)?;
        let poses = poses(ScenePath::Outside);
        let (mut depth, mut all) = (Probe::new(&part, &Fig73Exact), Probe::new(&part, &Fig73Exact));
        let times = self.race(
            |k| depth.deepest(&poses[k]),
            |k| {
                let contacts = all.contacts(&poses[k]).iter();
                contacts.map(|contact| contact.depth).fold(0.0, f64::max)
            },
        );
        Ok(Skip {
            stage: "outputs",
            skipped: "force, direction and niceness where only depth is asked for",
            step: "deepest of 20,000 points, `outside`",
            times,
        })
    }

    /// The deepest point with a tree, and with an evaluation of all points.
    fn points(&self) -> Result<Skip, Box<dyn Error>> {
        let cloud = Cloud::sample(&tube(), Sampling::monte_carlo(20_000))?;
        let part = Part::from_cloud(&cloud);
        let poses = poses(ScenePath::Outside);
        let mut probe = Probe::new(&part, &Fig73Exact);
        let mut batch = PointBatch::default();
        let mut evaluations = Evaluations::default();
        let outputs = Outputs { depth: true, ..Outputs::INSIDE };
        let times = self.race(
            |k| probe.deepest(&poses[k]),
            |k| {
                batch.clear();
                for point in cloud.points() {
                    let local = poses[k].rotation().tr_mul(&(point - poses[k].tip()));
                    batch.push(local.into());
                }
                Fig73Exact.evaluate(Level::new(), outputs, &batch, 1.0, &mut evaluations);
                evaluations.inside_indices().count()
            },
        );
        Ok(Skip {
            stage: "points",
            skipped: "points of boxes that the tool cannot reach",
            step: "deepest of 20,000 points, `outside`",
            times,
        })
    }

    /// The same points in an order in which eight neighbours lie in one region or two, and in a random one.
    fn regions(&self) -> Skip {
        let tool = &BallEr16;
        let mut near = Vec::new();
        for index in 0..4096 {
            // Down the tool, around it, and outward: eight successive points differ in the distance from the axis alone.
            let [height, angle, out] = [index / 128, index / 8 % 16, index % 8];
            let (sine, cosine) = (0.39 * f64::from(angle)).sin_cos();
            let d = 0.4 * f64::from(out);
            near.push([d * cosine, d * sine, f64::from(height)]);
        }
        // A step that has no common factor with the number visits all points, far apart.
        let far: Vec<_> = (0..near.len()).map(|k| near[k * 1_601 % near.len()]).collect();
        let batch = |points: &[[f64; 3]]| {
            let mut batch = PointBatch::default();
            points.iter().for_each(|point| batch.push(*point));
            batch
        };
        let (near, far) = (batch(&near), batch(&far));
        let (mut one, mut other) = (Evaluations::default(), Evaluations::default());
        let evaluate = |points: &PointBatch, evaluations: &mut Evaluations| {
            tool.evaluate(Level::new(), Outputs::DIRECTION, points, 1.0, evaluations);
        };
        let times = self.race(|_| evaluate(&near, &mut one), |_| evaluate(&far, &mut other));
        Skip {
            stage: "regions",
            skipped: "regions in which none of eight points lies",
            step: "`BallEr16` at 4,096 points, neighbours together or not",
            times,
        }
    }

    /// A tool at one of 64 parts in a row, in a scene or with a probe at each.
    fn parts(&self) -> Result<Skip, Box<dyn Error>> {
        const PARTS: usize = 64;
        let part = points_of(&tube(), 20_000)?;
        let poses = poses(ScenePath::Outside);
        let frames: Vec<Pose> = (0..PARTS).map(|index| shift(50.0 * index as f64)).collect();
        let mut scene = Parts::new(Unit::Millimetre).with_law(Law::Thesis);
        for frame in &frames {
            scene.add_part(&part, *frame)?;
        }
        let tool = scene.add_tool(&Fig73Exact);
        let mut probe = Probe::new(&part, &Fig73Exact).with_law(Law::Thesis);
        let times = self.race(
            |k| {
                scene.move_tool(tool, poses[k]);
                scene.wrench(tool).colliding
            },
            |k| {
                let wrenches =
                    frames.iter().map(|frame| probe.wrench(&poses[k].relative_to(frame)));
                wrenches.map(|wrench| wrench.colliding).sum::<usize>()
            },
        );
        Ok(Skip {
            stage: "parts",
            skipped: "relative poses of parts that are out of reach as a whole",
            step: "wrench at one of 64 parts",
            times,
        })
    }

    /// A check of all surfaces with their allowances, and a depth per surface.
    fn surfaces(&self) -> Result<Skip, Box<dyn Error>> {
        let bvh = TriangleBvh::new(&Scene::Apart(0.01).mesh(20_000));
        let poses: Vec<Pose> = (0..POSES).map(|k| Scene::Apart(0.01).pose(k, POSES)).collect();
        let mut together = Certifier::new(&bvh, &Fig73Exact)?;
        let mut alone = Certifier::new(&bvh, &Fig73Exact)?;
        let surfaces = Fig73Exact.info().surfaces.len();
        let times = self.race(
            |k| together.check_pose(&poses[k]),
            |k| {
                let depths = (0..surfaces).map(|surface| {
                    let deepest = alone.deepest_on(SurfaceId(surface), &poses[k], 1e-3);
                    deepest.map_or(f64::NAN, |deepest| deepest.depth.high)
                });
                depths.fold(0.0, f64::max)
            },
        );
        Ok(Skip {
            stage: "surfaces",
            skipped: "a search per surface, where surfaces have the same allowance",
            step: "pose checked 0.01 mm from 20,000 triangles",
            times,
        })
    }

    /// Joint motions in free space known from an earlier one, and the same motions just above the part, where none is known.
    fn free_space(&self) -> Result<Skip, Box<dyn Error>> {
        const MOTIONS: u32 = 20_000;
        let part = TriangleBvh::new(&Contact::Random(0).mesh()?);
        let verifier = Verifier::new(&part, &BallEr16)?;
        let mut times = [f64::INFINITY; 2];
        for _ in 0..3 {
            for (way, height) in [60.0, 30.05].into_iter().enumerate() {
                let program = fork_head("fanuc", &circles(MOTIONS, height)?)?.swap_remove(0);
                let moves = program.moves(ToolSelection::All, None, Unit::Millimetre)?;
                let start = ProcessTime::now();
                let report = verifier.check_moves(moves, &|_| ())?;
                times[way] = times[way].min(start.elapsed().as_secs_f64());
                if !report.findings.is_empty() {
                    return Err("a motion above the part has a finding".into());
                }
            }
        }
        Ok(Skip {
            stage: "motions",
            skipped: "motions in free space known from an earlier one; the others are the same motions 0.05 mm above the part",
            step: "joint motion of a fork head, read again",
            times: times.map(|time| time * 1e6 / f64::from(MOTIONS)),
        })
    }

    /// A program on a control whose rules are stated, and on one of which nothing is known.
    fn readings(&self) -> Result<Skip, Box<dyn Error>> {
        const MOTIONS: u32 = 2_000;
        let text = circles(MOTIONS, 60.0)?;
        let (mut times, mut counts) = ([f64::INFINITY; 2], [0; 2]);
        for _ in 0..5 {
            for (way, control) in ["fanuc", "unknown"].into_iter().enumerate() {
                let start = ProcessTime::now();
                counts[way] = fork_head(control, &text)?.len();
                times[way] = times[way].min(start.elapsed().as_secs_f64());
            }
        }
        if counts[0] != 1 || counts[1] < 2 {
            return Err(format!("{counts:?} readings").into());
        }
        Ok(Skip {
            stage: "readings",
            skipped: "readings that the control excludes; of an unknown one those of rules that the program does not ask for",
            step: "block of a fork head's program",
            times: times.map(|time| time * 1e6 / f64::from(MOTIONS)),
        })
    }
}

/// Interprets a program of a fork head on a control, in all readings. The control is a known one's, or unknown.
fn fork_head(control: &str, text: &str) -> Result<Vec<MachineProgram>, Box<dyn Error>> {
    let rules = match control {
        "unknown" => ControlRules::default().with(Rule::Dialect, Choice::Iso),
        _ => ControlRules::named(control)?,
    };
    let machine = Machine::named("A-C fork head")?;
    Ok(MachineProgram::readings("program", text.to_owned(), machine, &with_tool(rules))?)
}

/// Returns the setup of a control with a tool of 150 mm.
fn with_tool(rules: ControlRules) -> ControlSetup {
    let mut setup = ControlSetup { rules, ..ControlSetup::default() };
    setup.lengths.insert(1, 150.0);
    setup
}

/// Returns a program of motions of all axes on circles above a height. It has one whole number, whose unit controls
/// differ in.
fn circles(motions: u32, height: f64) -> Result<String, std::fmt::Error> {
    let mut text = String::from("G21 G90 G54 G61\nT1 M6\nS12000 M3\nG94 G0 X0. Y0. A0. C0.\n");
    writeln!(text, "G43.4 H1 X0. Y0. Z150.\nG1 X20 Y0. Z{height:.4} F6000.")?;
    for index in 0..motions {
        let (sine, cosine) = (1e-3 * f64::from(index)).sin_cos();
        let [x, y, tilt] = [20.0 * cosine, 20.0 * sine, 2.0 * sine];
        writeln!(
            text,
            "G1 X{x:.4} Y{y:.4} Z{:.4} A{tilt:.3} C{:.3}",
            height + 0.001,
            5.0 * cosine
        )?;
    }
    text += "G0 Z150.\nG49\nM30\n";
    Ok(text)
}

/// A row of the table of run times.
struct Measured {
    what: String,
    value: String,
    goal: &'static str,
    limit: &'static str,
}

impl Speed {
    fn ratios(&self) -> Result<String, Box<dyn Error>> {
        let mut rows = Vec::new();
        for points in [20_000, 1_000_000] {
            self.wrench_rows(points, &mut rows)?;
        }
        self.certified_rows(&mut rows);
        for contact in [Contact::Random(1000), Contact::Deep(1000)] {
            rows.push(contact.row()?);
        }
        self.sweep_rows(&mut rows)?;
        self.start_rows(&mut rows)?;
        let mut body = String::from(
            "Times on one core, but of `verify`, the sweep and the start, which use all. *Limit* says what the time goes into.\n\n\
             | what | measured | goal | limit |\n|---|--:|--:|---|\n",
        );
        for Measured { what, value, goal, limit } in rows {
            writeln!(body, "| {what} | {value} | {goal} | {limit} |")?;
        }
        Ok(body)
    }

    fn wrench_rows(&self, points: usize, rows: &mut Vec<Measured>) -> Result<(), Box<dyn Error>> {
        let cloud = Cloud::sample(&tube(), Sampling::monte_carlo(points))?;
        let part = Part::from_cloud(&cloud);
        for path in ScenePath::ALL {
            let poses = poses(path);
            let mut probe = Probe::new(&part, &Fig73Exact).with_law(Law::Thesis);
            #[cfg(feature = "peers")]
            {
                let mut parry = ParryBvh::new(&cloud);
                let [ours, theirs] =
                    self.race(|k| probe.wrench(&poses[k]), |k| parry.query(&poses[k]));
                rows.push(Measured {
                    what: format!("wrench, {points} points, `{}`: `parry-bvh` by ours", path.name()),
                    value: format!("{:.2} ({ours:.2} µs)", theirs / ours),
                    goal: if points == 20_000 { "2.4" } else { "3" },
                    limit: "latency of the tree's levels; then the evaluation of points inside, a root and two divisions each",
                });
            }
            if let Some(avx2) = Level::new().as_avx2() {
                let mut narrow = Probe::new(&part, &Fig73Exact)
                    .with_law(Law::Thesis)
                    .with_level(Level::Avx2(avx2));
                let [wide, narrow] =
                    self.race(|k| probe.wrench(&poses[k]), |k| narrow.wrench(&poses[k]));
                rows.push(Measured {
                    what: "the same: AVX2 by this machine's best".to_owned(),
                    value: format!("{:.2}", narrow / wide),
                    goal: "1.6",
                    limit: "two registers for a vector, and a table instead of one instruction to compress it",
                });
            }
        }
        Ok(())
    }

    fn certified_rows(&self, rows: &mut Vec<Measured>) {
        let scenes = [
            (Scene::Along(ScenePath::Hold), 20_000, "57 (0.4 of 143)"),
            (Scene::Along(ScenePath::Hold), 200_000, "234 (0.4 of 586)"),
            (Scene::Bore, 20_000, "26"),
            (Scene::Along(ScenePath::Inside), 200_000, "8.6 (0.5 of 17.2)"),
        ];
        for (scene, triangles, goal) in scenes {
            let bvh = TriangleBvh::new(&scene.mesh(triangles));
            let mut certifier = Certifier::new(&bvh, scene.tool()).expect("a tool with a profile");
            let mut times: Vec<f64> = (0..POSES)
                .map(|k| {
                    let pose = scene.pose(k, POSES);
                    let start = Instant::now();
                    black_box(certifier.deepest(black_box(&pose), 1e-9));
                    start.elapsed().as_secs_f64() * 1e6
                })
                .collect();
            times.sort_by(f64::total_cmp);
            rows.push(Measured {
                what: format!("certified depth, `{}`, {triangles} triangles: p99, µs", scene.name()),
                value: format!("{:.1} (median {:.1})", times[POSES * 99 / 100], times[POSES / 2]),
                goal,
                limit: "triangles as deep as the deepest, each bounded once in `f64`; at 200,000 memory",
            });
        }
    }

    fn sweep_rows(&self, rows: &mut Vec<Measured>) -> Result<(), Box<dyn Error>> {
        let mut parts =
            vec![("a tube".to_owned(), shapes::tube(8.0, 10.0, 30.0, 120, 40, Unit::Millimetre)?)];
        if let Some(file) = &self.part {
            let name = file.file_stem().map_or_else(String::new, |name| name.display().to_string());
            parts.push((name, Mesh::read_stl(file, Unit::Millimetre)?));
        }
        for (name, mesh) in parts {
            let bvh = TriangleBvh::new(&mesh);
            let directions = Directions::spread(200);
            let rules = Rules { tolerance: 0.01, niceness: 0.0, allowed: Vec::new() };
            let tools: Vec<&dyn Tool> = vec![&D2Ball];
            let sweep = PostureSweep::new(&mesh, &bvh, tools, &directions, rules, NonZeroU16::MIN)?;
            let batches: Vec<usize> = (0..sweep.batches()).collect();
            let mut stats = SweepStats::default();
            let start = ProcessTime::now();
            let flow: ControlFlow<()> = sweep.run(&batches, |batch| {
                stats += batch.stats;
                ControlFlow::Continue(())
            });
            let time = start.elapsed().as_secs_f64();
            if flow.is_break() {
                return Err("a sweep ended early".into());
            }
            rows.push(Measured {
                what: format!(
                    "sweep of {name}, {} triangles, 200 directions, `D2Ball`: µs of a core per posture",
                    bvh.len()
                ),
                value: format!("{:.2}", time * 1e6 / stats.postures() as f64),
                goal: "0.25",
                limit: "a search of the tree for each posture that no neighbour's obstruction decides",
            });
        }
        Ok(())
    }

    fn start_rows(&self, rows: &mut Vec<Measured>) -> Result<(), Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let saved = folder.path().join("part.touchoff");
        points_of(&tube(), 20_000)?.save(&saved)?;
        let pose = ScenePath::Outside.pose(0, POSES);
        let mut best = f64::INFINITY;
        for _ in 0..9 {
            let start = Instant::now();
            let part = Part::open(&saved)?;
            black_box(Probe::new(&part, &Fig73Exact).with_law(Law::Thesis).wrench(&pose));
            best = best.min(start.elapsed().as_secs_f64());
        }
        rows.push(Measured {
            what: "first wrench at a saved part of 20,000 points, ms".to_owned(),
            value: format!("{:.2}", best * 1e3),
            goal: "5, of the program",
            limit: "reading the file and its check sums",
        });
        let stl = folder.path().join("part.stl");
        let mut bytes = Vec::new();
        Scene::Along(ScenePath::Outside).mesh(1_000_000).write_stl(&mut bytes)?;
        std::fs::write(&stl, bytes)?;
        let mut times = [f64::INFINITY; 2];
        for _ in 0..3 {
            let start = Instant::now();
            let mesh = Mesh::read_stl(&stl, Unit::Millimetre)?;
            times[0] = times[0].min(start.elapsed().as_secs_f64());
            let start = Instant::now();
            black_box(TriangleBvh::new(&mesh));
            times[1] = times[1].min(start.elapsed().as_secs_f64());
        }
        rows.push(Measured {
            what: "STL of a million triangles to a tree, s".to_owned(),
            value: format!("{:.2} ({:.2} to read)", times[0] + times[1], times[0]),
            goal: "1",
            limit: "joining the corners of the file, on one core; then sorting the triangles",
        });
        Ok(())
    }
}

/// A program that meets the part, of so many motions.
#[derive(Clone, Copy)]
enum Contact {
    /// Motions of a fork head between random poses in and around a block.
    Random(u32),
    /// Plunges and strokes whose holder is deep in a plate of many triangles.
    Deep(u32),
}

impl Contact {
    fn program(self) -> Result<String, std::fmt::Error> {
        let mut text = String::from(
            "G21 G90 G54 G61\nT1 M6\nS12000 M3\nG94 G0 X0. Y0. A0. C0.\nG43.4 H1 X0. Y0. Z150.\n",
        );
        let mut state = 11u64;
        let mut next = |low: f64, high: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            low + (high - low) * (state >> 11) as f64 / (1u64 << 53) as f64
        };
        match self {
            Contact::Random(count) => {
                for _ in 0..count {
                    let [x, y, z] = [next(-40.0, 40.0), next(-40.0, 40.0), next(-10.0, 70.0)];
                    let [a, c] = [next(-90.0, 90.0), next(-180.0, 180.0)];
                    writeln!(text, "G1 X{x:.4} Y{y:.4} Z{z:.4} A{a:.3} C{c:.3} F600.")?;
                }
            }
            Contact::Deep(count) => {
                for k in 0..count {
                    let [x, y] = [next(-12.0, 12.0), next(-12.0, 12.0)];
                    let z = -45.0 + f64::from(k % 7);
                    writeln!(text, "G1 X{x:.4} Y{y:.4} Z{z:.4} F600.")?;
                }
            }
        }
        text += "G49\nM30\n";
        Ok(text)
    }

    fn mesh(self) -> Result<Mesh, Box<dyn Error>> {
        let corner = |x: f64, z: f64| Point3::new(x, x, z);
        Ok(match self {
            Contact::Random(_) => {
                shapes::cuboid(corner(-30.0, 0.0), corner(30.0, 30.0), Unit::Millimetre)?
            }
            Contact::Deep(_) => shapes::tube(8.0, 40.0, 30.0, 360, 140, Unit::Millimetre)?,
        })
    }

    /// Times the check of the job.
    fn row(self) -> Result<Measured, Box<dyn Error>> {
        let part = TriangleBvh::new(&self.mesh()?);
        let setup = with_tool(ControlRules::named("fanuc")?);
        let machine = Machine::named("A-C fork head")?;
        let program = Program::parse(self.program()?, "contact.nc", machine, &setup)?;
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &BallEr16));
        if let Contact::Deep(_) = self {
            job.bodies.push(Body::fixture("table", &part));
        }
        job.tolerance = 0.01;
        job.anyway = true;
        let start = Instant::now();
        let report = job.check(&|_| ())?;
        let time = start.elapsed().as_secs_f64();
        let findings = report.findings().len();
        let (what, motions) = match self {
            Contact::Random(count) => ("random motions of a fork head at a block", count),
            Contact::Deep(count) => ("motions with the holder deep in a part and a fixture", count),
        };
        Ok(Measured {
            what: format!("`verify`, {motions} {what}, {} triangles: ms per motion", part.len()),
            value: format!(
                "{:.2} ({findings} groups of findings)",
                time * 1e3 / f64::from(motions)
            ),
            goal: "1",
            limit: "the search for the deepest point and its bound, per surface and body",
        })
    }
}

fn shift(x: f64) -> Pose {
    Pose::from_axis(Point3::new(x, 0.0, 0.0), Vector3::z()).expect("a unit vector")
}

fn poses(path: ScenePath) -> Vec<Pose> {
    (0..POSES).map(|k| path.pose(k, POSES)).collect()
}

fn points_of(mesh: &Mesh, count: usize) -> Result<Part, Box<dyn Error>> {
    Ok(Part::from_cloud(&Cloud::sample(mesh, Sampling::monte_carlo(count))?))
}
