//! Bodies of a machine that move against each other, compared with brute force and with a closed form. The oracle has the place of
//! every link of one machine in closed form, and shares no code with the library.

use crate::oracle::{Mounted, Random, ToolPose, Worst, sample_points};
use crate::{RESOLUTION, block, compare_with_brute_force};
use nalgebra::{Point3, Vector3};
use std::fmt::Write;
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Pose};
use touchoff_verify::gcode::{ControlRules, ControlSetup};
use touchoff_verify::job::{Body, BodyRole, FindingDetail, Moving, NoVerdict, RevolvedBody};
use touchoff_verify::machine::{Letter, Link, Machine};
use touchoff_verify::{ClData, Finding, FindingKind, Job, JobError, JobTool, Program, Verdict};

/// Number of time steps per motion.
const TIME_STEPS: u32 = 48;

/// Y carries C, which turns the table about z through (1, -4, 0); X carries Z, and Z carries B, which tilts the head about y through
/// (1.5, 0, 20).
const MACHINE: &str = r#"
    name = "B head + C table"
    axis = [
        { letter = "Y", kind = "linear", carries = "table" },
        { letter = "C", kind = "rotary", carries = "table", direction = [0, 0, 1], point = [1, -4, 0] },
        { letter = "X", kind = "linear", carries = "tool" },
        { letter = "Z", kind = "linear", carries = "tool" },
        { letter = "B", kind = "rotary", carries = "tool", direction = [0, 1, 0], point = [1.5, 0, 20] },
    ]"#;

/// The origin of G54 on the machine, and the length of the tool.
const ORIGIN: [f64; 3] = [2.0, 5.0, -67.0];
const LENGTH: f64 = 60.0;

/// Joint values: X Y Z B C.
#[derive(Clone, Copy)]
struct Place {
    linear: [f64; 3],
    b: f64,
    c: f64,
}

/// Turns a point about z through (1, -4) by an angle in degrees.
fn about_z([x, y, z]: [f64; 3], degrees: f64) -> [f64; 3] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (u, v) = (x - 1.0, y + 4.0);
    [1.0 + cosine * u - sine * v, -4.0 + sine * u + cosine * v, z]
}

/// Turns a point about y through (1.5, 20) by an angle in degrees.
fn about_y([x, y, z]: [f64; 3], degrees: f64) -> [f64; 3] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (u, w) = (x - 1.5, z - 20.0);
    [1.5 + cosine * u + sine * w, y, 20.0 - sine * u + cosine * w]
}

impl Place {
    /// Maps a point of a link to machine coordinates.
    fn to_machine(self, link: Link, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.linear;
        let shifted = |[a, b, c]: [f64; 3], [x, y, z]: [f64; 3]| [a + x, b + y, c + z];
        match link {
            Link::Base => point,
            Link::Axis(Letter::Y) => shifted(point, [0.0, -y, 0.0]),
            // ISO 841: a table turns and moves the other way.
            Link::Axis(Letter::C) => shifted(about_z(point, -self.c), [0.0, -y, 0.0]),
            Link::Axis(Letter::X) => shifted(point, [x, 0.0, 0.0]),
            Link::Axis(Letter::Z) => shifted(point, [x, 0.0, z]),
            Link::Axis(_) => shifted(about_y(point, self.b), [x, 0.0, z]),
        }
    }
}

/// A block: the program's X Y Z B C, and the flags for rapid traverse and for tool centre point control.
#[derive(Clone, Copy)]
struct Block {
    linear: [f64; 3],
    b: f64,
    c: f64,
    rapid: bool,
    tcp: bool,
}

/// Returns the joints at a time between two blocks.
fn place(from: &Block, to: &Block, time: f64) -> Place {
    let mix = |from: f64, to: f64| from + time * (to - from);
    let [b, c] = [mix(from.b, to.b), mix(from.c, to.c)];
    let linear = [0, 1, 2].map(|k| mix(from.linear[k], to.linear[k]));
    let origin = [0, 1, 2].map(|k| linear[k] + ORIGIN[k]);
    if !to.tcp {
        return Place { linear: [origin[0], origin[1], origin[2] + LENGTH], b, c };
    }
    // The tip on the turned part is where that of the tilted head is, moved by the linear axes.
    let (tip, head) = (about_z(origin, -c), about_y([0.0, 0.0, -LENGTH], b));
    Place { linear: [0, 1, 2].map(|k| tip[k] - head[k]), b, c }
}

fn blocks(random: &mut Random, count: usize) -> Vec<Block> {
    let round = |value: f64| -> f64 { format!("{value:.6}").parse().expect("a number") };
    let (mut b, mut c) = (0.0, 0.0);
    let blocks = (0..count).map(|k| {
        let reach = if random.chance(0.3) { 40.0 } else { 6.0 };
        b = f64::clamp(b + random.between(-reach, reach), -60.0, 60.0);
        c += random.between(-reach, reach);
        let linear: [f64; 3] = random.vector(14.0).into();
        let rapid = random.chance(0.2);
        let tcp = (k / 10) % 2 == 1;
        Block { linear: linear.map(round), b: round(b), c: round(c), rapid, tcp }
    });
    blocks.collect()
}

/// Returns the program of blocks, of which each is a line.
fn program(blocks: &[Block]) -> String {
    let mut text = String::from("G21 G90 G54 G94 F1000.\nT1 M6\nS900 M3\nG43 H1\n");
    let mut tcp = false;
    for block in blocks {
        if block.tcp != tcp {
            tcp = block.tcp;
            text += if tcp { "G43.4 H1\n" } else { "G49\nG43 H1\n" };
        }
        let ([x, y, z], Block { b, c, .. }) = (block.linear, *block);
        let word = if block.rapid { "G0" } else { "G1" };
        let _ = writeln!(text, "{word} X{x:.6} Y{y:.6} Z{z:.6} B{b:.6} C{c:.6}");
    }
    text + "M30\n"
}

/// Returns the number of motions: 10,000 with `MOTIONS=10000`.
fn motions() -> usize {
    match std::env::var("MOTIONS") {
        Ok(count) => count.parse().expect("MOTIONS is a number of motions"),
        Err(_) => 40,
    }
}

fn setup() -> ControlSetup {
    let mut work_offsets = [None; 9];
    work_offsets[0] = Some([ORIGIN[0], ORIGIN[1], ORIGIN[2], 0.0, 0.0, 0.0]);
    let rules = ControlRules::named("linuxcnc").expect("a control");
    // Words of Fanuc, and straight lines in rapid traverse.
    let rules =
        rules.with(touchoff_verify::gcode::Rule::Dialect, touchoff_verify::gcode::Choice::Iso);
    ControlSetup { work_offsets, lengths: [(1, LENGTH)].into(), rules, ..ControlSetup::default() }
}

/// Something that moves in a pair, as the oracle has it: a tip and a direction of a link.
struct Mover {
    link: Link,
    tip: [f64; 3],
    axis: [f64; 3],
}

impl Mover {
    fn pose(&self, place: Place) -> ToolPose {
        let ahead = [0, 1, 2].map(|k| self.tip[k] + self.axis[k]);
        let [tip, ahead] =
            [self.tip, ahead].map(|point| Point3::from(place.to_machine(self.link, point)));
        (tip, (ahead - tip).normalize())
    }
}

fn mesh(low: [f64; 3], high: [f64; 3]) -> Mesh {
    block(low, high)
}

/// Tool, head, arm and post move against the part and meshes of four links: every violation that samples show is found, and every
/// finding holds at its pose.
#[test]
fn bodies_agree_with_brute_force() {
    let axis = |letter| Link::Axis(letter);
    let part = mesh([-8.0, -8.0, -8.0], [8.0, 8.0, 8.0]);
    // Meshes in machine coordinates with all axes at 0, with their links and margins.
    let meshes = [
        ("the bed", Link::Base, 0.0, mesh([-30.0, -25.0, -90.0], [25.0, 20.0, -76.0])),
        ("the rail", axis(Letter::Y), 0.0, mesh([-24.0, -20.0, -80.0], [-9.0, 20.0, -60.0])),
        ("the vise", axis(Letter::C), 1.5, mesh([4.0, -14.0, -75.0], [16.0, 2.0, -58.0])),
        ("the guard", axis(Letter::Z), 0.0, mesh([10.0, -14.0, -60.0], [22.0, 12.0, -45.0])),
    ];
    let head = Pose::from_axis(Point3::new(9.0, 3.0, -52.0), Vector3::new(0.36, -0.48, 0.8));
    let arm = Pose::from_axis(Point3::new(-16.0, 6.0, -55.0), Vector3::x());
    let post = Pose::from_axis(Point3::new(24.0, -24.0, -50.0), Vector3::new(0.0, 0.6, -0.8));
    let [head, arm, post] = [head, arm, post].map(|pose| pose.expect("a unit vector"));
    // Links, margins, and the bodies against which each is checked: the part is 0.
    let revolved = [
        ("the head", axis(Letter::B), head, 0.0, vec![0, 1, 2, 3, 4]),
        ("the arm", axis(Letter::Z), arm, 2.0, vec![0, 2, 3]),
        ("the post", axis(Letter::Y), post, 0.0, vec![4, 3]),
    ];
    let bvhs: Vec<TriangleBvh> = std::iter::once(&part)
        .chain(meshes.iter().map(|mesh| &mesh.3))
        .map(TriangleBvh::new)
        .collect();
    let points: Vec<Vec<Point3<f64>>> = std::iter::once(&part)
        .chain(meshes.iter().map(|mesh| &mesh.3))
        .map(|mesh| sample_points(mesh, 1.0))
        .collect();
    let mut counts = std::collections::BTreeMap::<(String, String), [usize; 3]>::new();
    let boxes: Vec<[[f64; 3]; 2]> =
        bvhs.iter().map(|bvh| bvh.bounds().map(|corner| corner.into())).collect();
    let [mut judged, mut seed, mut inside] = [0; 3];
    while judged < motions() {
        seed += 1;
        let blocks = blocks(&mut Random::new(seed as u64), 40);
        let machine = Machine::parse(MACHINE, "head.toml").expect("a machine");
        let text = program(&blocks);
        let program = Program::parse(&text, "blocks.nc", machine, &setup()).expect("a program");
        assert_eq!(program.reading_count(), 1);
        let mut job = Job::new(&program, &bvhs[0]);
        job.tools.push(JobTool::numbered(1, &Mounted));
        job.resolution = Some(RESOLUTION);
        for ((name, link, margin, _), bvh) in meshes.iter().zip(&bvhs[1..]) {
            let mut body = Body::machine(name, bvh, *link);
            body.role = BodyRole::Machine { margin: *margin, meets_tools: true };
            job.bodies.push(body);
        }
        for (name, link, mount, margin, against) in &revolved {
            let mut body = RevolvedBody::new(name, &Mounted, *link, *mount);
            (body.margin, body.against) = (*margin, against.clone());
            job.revolved.push(body);
        }
        let steps = std::sync::atomic::AtomicUsize::new(0);
        let count = |number| {
            steps.fetch_add(number, std::sync::atomic::Ordering::Relaxed);
        };
        let report = job.check(&count).expect("a result");
        assert_eq!(report.pairs.len(), 5 + 5 + 3 + 2);
        // Each pair has a rest at the first position beside the motions.
        assert_eq!(job.motion_checks() + report.pairs.len(), steps.into_inner());
        let lines: Vec<usize> = {
            let moving = |line: &&str| line.contains('X');
            let numbered = text.lines().enumerate().map(|(k, line)| (k + 1, line));
            numbered.filter(|(_, line)| moving(line)).map(|(line, _)| line).collect()
        };
        assert_eq!(lines.len(), blocks.len());
        for (k, to) in blocks.iter().enumerate().skip(1) {
            let from = &blocks[k - 1];
            // After a change of tool centre point control, the position is that of the other kind of coordinates.
            if from.tcp != to.tcp {
                continue;
            }
            judged += 1;
            for pair in &report.pairs {
                let (mover, margin) = match pair.moving {
                    Moving::Tool(_) => {
                        let (tip, up) = ([0.0, 0.0, -LENGTH], [0.0, 0.0, 1.0]);
                        (Mover { link: axis(Letter::B), tip, axis: up }, 0.0)
                    }
                    Moving::Revolved(index) => {
                        let (_, link, mount, margin, _) = &revolved[index];
                        let (tip, axis) = (mount.tip().into(), mount.axis().into());
                        (Mover { link: *link, tip, axis }, *margin)
                    }
                };
                let (link, frame, own) = match pair.body {
                    0 => (axis(Letter::C), ORIGIN, 0.0),
                    index => (meshes[index - 1].1, [0.0; 3], meshes[index - 1].2),
                };
                let limits = [-f64::max(margin, own) + 0.0; 4];
                let in_machine = |point: &Point3<f64>, place: Place| {
                    let point = [0, 1, 2].map(|k| point[k] + frame[k]);
                    Point3::from(place.to_machine(link, point))
                };
                let of_line =
                    |found: &&Finding| found.line == lines[k] && found.from == Some(lines[k - 1]);
                let found: Vec<Finding> =
                    pair.report.findings.iter().filter(of_line).copied().collect();
                let name = match pair.moving {
                    Moving::Tool(_) => "the tool",
                    Moving::Revolved(index) => revolved[index].0,
                };
                let count = counts
                    .entry((name.to_owned(), job.bodies[pair.body].name.clone()))
                    .or_default();
                for finding in &found {
                    let at = place(from, to, finding.time);
                    let pose = mover.pose(at);
                    let mut there = Worst::none();
                    match &finding.kind {
                        FindingKind::Deep { surface, depth, max_depth, witness, .. } => {
                            there.add(&in_machine(&witness.point, at), &pose);
                            let actual = there.depth[surface.0];
                            // On the border to another surface rounding may decide which is the nearest.
                            if actual > 0.0 {
                                assert!(
                                    depth.low <= actual + 1e-9 && actual <= depth.high + 1e-9,
                                    "{actual} {finding:?}"
                                );
                            }
                            assert!(*max_depth >= depth.high);
                            count[0] += 1;
                        }
                        FindingKind::Near { surface, distance, min_distance, witness, .. } => {
                            there.add(&in_machine(&witness.point, at), &pose);
                            let actual = there.distance[surface.0];
                            assert!(
                                distance.low <= actual + 1e-9 && actual <= distance.high + 1e-9,
                                "{actual} {finding:?}"
                            );
                            assert!(*min_distance <= distance.low);
                            count[1] += 1;
                        }
                        FindingKind::Inside { .. } => {
                            // No triangle touches the piece, but the axis of what moves goes through the body.
                            let [low, high] = boxes[pair.body];
                            let corner = |k: usize| {
                                let mut corner = low;
                                if k < 3 {
                                    corner[k] = high[k];
                                }
                                in_machine(&corner.into(), at)
                            };
                            let (origin, edges) = (corner(3), [0, 1, 2].map(corner));
                            let is_inside = |height: f64| {
                                let point = pose.0 + pose.1 * height - origin;
                                edges.iter().all(|edge| {
                                    let edge = edge - origin;
                                    (0.0..edge.norm_squared()).contains(&point.dot(&edge))
                                })
                            };
                            assert!(
                                (0..=400).any(|k| is_inside(0.1 * f64::from(k))),
                                "{finding:?}"
                            );
                            inside += 1;
                        }
                        other => panic!("{other:?} at {finding:?}"),
                    }
                }
                if found.iter().any(|found| matches!(found.kind, FindingKind::Inside { .. })) {
                    continue;
                }
                let mut expected = Worst::none();
                for step in 0..=TIME_STEPS {
                    let at = place(from, to, f64::from(step) / f64::from(TIME_STEPS));
                    let pose = mover.pose(at);
                    for point in &points[pair.body] {
                        expected.add(&in_machine(point, at), &pose);
                    }
                }
                // A surface that is too deep at one time may be only near or undecided at another.
                let is_deep = |surface| {
                    found.iter().any(|found| {
                        matches!(found.kind, FindingKind::Deep { .. })
                            && found.kind.surface() == surface
                    })
                };
                let decided: Vec<Finding> = found
                    .iter()
                    .filter(|found| {
                        matches!(found.kind, FindingKind::Deep { .. })
                            || !is_deep(found.kind.surface())
                    })
                    .copied()
                    .collect();
                compare_with_brute_force(&decided, &limits, &expected);
                count[2] += usize::from(found.is_empty());
            }
        }
    }
    println!(
        "{judged} motions; {inside} findings of pieces inside; findings deep and near, and motions without, per pair: {counts:?}"
    );
    assert_eq!(counts.len(), 15);
    for (pair, [deep, near, clear]) in &counts {
        assert!(deep + near > 0 && *clear > 0, "{pair:?}: {deep} {near} {clear}");
    }
}

touchoff::tool! {
    tool Disc "end of a spindle head, 80 mm" {
        units mm;
        profile { start (0, 0); line to (40, 0) as face; line to (40, 50), (0, 50) as side; }
    }
}

/// A trunnion about x through (0, 0, -100).
const TRUNNION: &str = r#"
    name = "trunnion"
    axis = [
        { letter = "A", kind = "rotary", carries = "table", direction = [1, 0, 0], point = [0, 0, -100] },
        { letter = "X", kind = "linear", carries = "tool" },
        { letter = "Y", kind = "linear", carries = "tool" },
        { letter = "Z", kind = "linear", carries = "tool" },
    ]"#;

/// A head of radius r at a height g over the pivot of a slab whose top goes through it: the rim touches the slab where it is tilted
/// by atan(g / r), is at the distance √(r² + g²) sin(atan(g / r) − θ) before, and the slab is (r tan θ − g) / (1 + tan θ) deep in the
/// head behind.
#[test]
fn a_head_touches_a_tilted_slab_at_the_angle_of_the_closed_form() {
    let (radius, height) = (40.0f64, 20.0f64);
    let touch = (height / radius).atan().to_degrees();
    let near = touch - (2.0 / radius.hypot(height)).asin().to_degrees();
    let slab = TriangleBvh::new(&block([-200.0, -200.0, -130.0], [200.0, 200.0, -100.0]));
    let part = TriangleBvh::new(&block([-1.0, -1.0, -3.0], [1.0, 1.0, -2.0]));
    let check = |angle: f64, margin: f64| -> (Verdict, Vec<FindingKind>, Vec<String>) {
        let mut setup = setup();
        setup.work_offsets[0] = Some([0.0, 0.0, -100.0, 0.0, 0.0, 0.0]);
        // The gauge point is at the height of the head over the pivot.
        setup.lengths = [(1, 15.0)].into();
        let machine = Machine::parse(TRUNNION, "trunnion.toml").expect("a machine");
        let text = format!(
            "G21 G90 G54 G94 F1000.\nT1 M6\nS900 M3\nG43 H1\nG0 X0. Y0. Z5. A0.\nG1 A{angle:.6}\nM30\n"
        );
        let program = Program::parse(&text, "tilt.nc", machine, &setup).expect("a program");
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &Mounted));
        job.anyway = true;
        let mut cradle = Body::machine("the slab", &slab, Link::Axis(Letter::A));
        cradle.role = BodyRole::Machine { margin: 0.0, meets_tools: false };
        job.bodies.push(cradle);
        let mount = Pose::from_axis(Point3::origin(), Vector3::z()).expect("a pose");
        let mut head = RevolvedBody::new("the head", &Disc, Link::Axis(Letter::Z), mount);
        (head.margin, head.against) = (margin, vec![1]);
        job.revolved.push(head);
        let report = job.check(&|_| ()).expect("a result");
        let kinds = report.findings().iter().filter_map(|finding| match &finding.detail {
            FindingDetail::Surface { groups, .. } => Some(groups[0].worst.kind),
            _ => None,
        });
        let texts = report.findings().iter().map(|finding| finding.text.clone());
        (report.verdict(), kinds.collect(), texts.collect())
    };
    for sign in [1.0, -1.0] {
        let (verdict, _, texts) = check(sign * (touch - 0.01), 0.0);
        assert_eq!(verdict, Verdict::Clean, "{texts:?}");
        assert_eq!(check(sign * (touch + 0.01), 0.0).0, Verdict::Findings);
        assert_eq!(check(sign * (near - 0.01), 2.0).0, Verdict::Clean);
        let (verdict, kinds, texts) = check(sign * (near + 0.01), 2.0);
        assert_eq!(verdict, Verdict::Findings);
        let angle = (touch - near - 0.01).to_radians();
        let exact = radius.hypot(height) * angle.sin();
        let is_exact = |kind: &FindingKind| matches!(kind, FindingKind::Near { distance, .. } if (distance.high - exact).abs() < 1e-3);
        assert!(kinds.iter().any(is_exact), "{exact}: {kinds:?}");
        assert!(
            texts[0].starts_with("the head: face is 1.99") && texts[0].contains("from the slab"),
            "{texts:?}"
        );
        let (_, kinds, texts) = check(sign * 40.0, 0.0);
        let tangent = 40f64.to_radians().tan();
        let exact = (radius * tangent - height) / (1.0 + tangent);
        let is_exact = |kind: &FindingKind| matches!(kind, FindingKind::Deep { depth, .. } if (depth.high - exact).abs() < 1e-3);
        assert!(kinds.iter().any(is_exact), "{exact}: {kinds:?}");
        assert!(
            texts
                .iter()
                .any(|text| text.contains("deep in the slab")
                    && text.contains("with a tool that is")),
            "{texts:?}"
        );
    }
}

/// Bodies need the place of the part and the lengths of all tools, and a machine's bodies are not left out silently.
#[test]
fn bodies_without_a_place_are_refused() {
    let part = TriangleBvh::new(&block([-8.0, -8.0, -8.0], [8.0, 8.0, 8.0]));
    let text =
        "G21 G90 G54 G94 F1000.\nT1 M6\nS900 M3\nG43 H1\nG0 X0. Y0. Z15. A0. C0.\nG1 Z9.\nM30\n";
    let check = |text: &str, setup: &ControlSetup, has_bodies: bool| {
        let machine = Machine::named("A-C trunnion with bodies").expect("a machine");
        let program = Program::parse(text, "a.nc", machine, setup).expect("a program");
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::of_all(&Mounted));
        if has_bodies {
            job.bodies.push(Body::machine("the table", &part, Link::Axis(Letter::C)));
        }
        job.check(&|_| ()).map(|report| report.refusals())
    };
    let placed = setup();
    let refusals = check(text, &placed, false).expect("a result");
    assert_eq!(refusals.iter().map(NoVerdict::code).collect::<Vec<_>>(), ["V0601"], "{refusals:?}");
    assert_eq!(check(text, &placed, true).expect("a result"), []);
    let elsewhere = ControlSetup { work_offsets: [None; 9], ..placed.clone() };
    let refused = check(text, &elsewhere, true).expect_err("no origin");
    assert!(matches!(refused, JobError::NoPlace), "{refused}");
    let unknown = ControlSetup { lengths: [(2, 60.0)].into(), ..placed.clone() };
    let refused = check(text, &unknown, true).expect_err("no length");
    assert!(matches!(refused, JobError::NoLength { number: 1, .. }), "{refused}");
    let unnamed = text.replace("T1 M6\nS900 M3\nG43 H1\n", "S900 M3\n");
    let refused = check(&unnamed, &placed, true).expect_err("no tool");
    assert!(matches!(refused, JobError::NoToolForLength { .. }), "{refused}");
    // Positions of tips have no machine.
    let positions = ClData::parse("0,0,20,0,0,1\n0,0,9,0,0,1\n", "a.csv").expect("positions");
    let positions = Program::Locations(vec![positions]);
    let mut job = Job::new(&positions, &part);
    job.tools.push(JobTool::of_all(&Mounted));
    job.bodies.push(Body::machine("the table", &part, Link::Base));
    let refused = job.check(&|_| ()).expect_err("no machine");
    assert!(matches!(refused, JobError::BodiesForPositions), "{refused}");
}

/// In rapid traverse at unknown rates, a body on the slide of X is checked on all paths between those of the axes: a post beside the
/// straight line is found, and one beside the box is not.
#[test]
fn bodies_are_checked_at_any_rates() {
    let part = TriangleBvh::new(&block([-8.0, -8.0, -8.0], [8.0, 8.0, 8.0]));
    let text = "G21 G90 G54 G94 F1000.\nT1 M6\nS900 M3\nG43 H1\nG1 X0. Y0. Z30. B0. C0.\nG0 X80. Y80.\nG1 Z32.\nM30\n";
    let machine = Machine::parse(MACHINE, "head.toml").expect("a machine");
    // A control without a name moves at unknown rates.
    let setup = ControlSetup { rules: ControlRules::default(), ..setup() };
    let program = Program::parse(text, "a.nc", machine, &setup).expect("a program");
    let mount = Pose::from_axis(Point3::new(0.0, 0.0, 40.0), Vector3::z()).expect("a pose");
    for (x, y, is_found) in
        [(70.0, 10.0, true), (10.0, 70.0, true), (120.0, 10.0, false), (40.0, -40.0, false)]
    {
        // The program's origin is at (2, 5) on the machine, and the table moves the other way.
        let (low, high) = ([x, y, -200.0], [x + 4.0, y + 4.0, 200.0]);
        let shifted = |[x, y, z]: [f64; 3]| [x + ORIGIN[0], y + ORIGIN[1], z];
        let post = TriangleBvh::new(&block(shifted(low), shifted(high)));
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &Mounted));
        job.anyway = true;
        let mut body = Body::machine("the post", &post, Link::Axis(Letter::Y));
        body.role = BodyRole::Machine { margin: 0.0, meets_tools: false };
        job.bodies.push(body);
        let mut slide = RevolvedBody::new("the slide", &Mounted, Link::Axis(Letter::X), mount);
        slide.against = vec![1];
        job.revolved.push(slide);
        let report = job.check(&|_| ()).expect("a result");
        let pairs = report.pairs.iter().filter(|pair| pair.moving == Moving::Revolved(0));
        let found: Vec<&Finding> = pairs.flat_map(|pair| &pair.report.findings).collect();
        assert_eq!(!found.is_empty(), is_found, "{x} {y}: {found:?}");
        assert!(found.iter().all(|found| found.any_rates && found.line == 6), "{found:?}");
    }
}
