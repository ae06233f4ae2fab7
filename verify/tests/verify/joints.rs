//! G-code on machines, compared with brute force. The oracle has the kinematics of one machine in closed form, and shares
//! no code with the library.

use crate::oracle::{Mounted, Random, ToolPose, Worst, sample_points};
use crate::{RESOLUTION, block, compare_with_brute_force, limits};
use nalgebra::{Point3, Vector3};
use std::fmt::Write;
use touchoff::certify::TriangleBvh;
use touchoff::{Tool, Unit};
use touchoff_verify::gcode::ControlSetup;
use touchoff_verify::machine::Machine;
use touchoff_verify::{Finding, FindingKind, MachineProgram, Move, ToolSelection, Verifier};

/// Number of time steps per motion.
const TIME_STEPS: u32 = 48;

/// A trunnion: A turns about x through (0, 3, -2), and carries C, which turns about z through (1, -4, 0).
const TRUNNION: &str = r#"
    name = "trunnion"
    axis = [
        { letter = "A", kind = "rotary", carries = "table", direction = [1, 0, 0], point = [0, 3, -2] },
        { letter = "C", kind = "rotary", carries = "table", direction = [0, 0, 1], point = [1, -4, 0] },
        { letter = "X", kind = "linear", carries = "tool" },
        { letter = "Y", kind = "linear", carries = "tool" },
        { letter = "Z", kind = "linear", carries = "tool" },
    ]"#;

/// The origin of G54 on the machine, and the length of the tool.
const ORIGIN: [f64; 3] = [2.0, 5.0, -7.0];
const LENGTH: f64 = 60.0;

/// A block: X Y Z A C, and the flags for rapid traverse and for tool centre point control.
#[derive(Clone, Copy)]
struct Block {
    linear: [f64; 3],
    angles: [f64; 2],
    rapid: bool,
    tcp: bool,
}

/// Returns tip and axis relative to the part for the tip's linear joints without rotation, and the rotary joints.
///
/// The tool turns about A's line, then about C's: first Y and Z, then X and Y.
fn place(tip: [f64; 3], [a, c]: [f64; 2]) -> ToolPose {
    let axis = turned([0.0, 0.0, 1.0], [a, c], [0.0; 4]);
    let [x, y, z] = turned(tip, [a, c], [3.0, -2.0, 1.0, -4.0]);
    let tip = Point3::new(x - ORIGIN[0], y - ORIGIN[1], z - ORIGIN[2]);
    (tip, Vector3::from(axis))
}

fn turned([x, y, z]: [f64; 3], [a, c]: [f64; 2], pivots: [f64; 4]) -> [f64; 3] {
    let (sine, cosine) = a.to_radians().sin_cos();
    let (v, w) = (y - pivots[0], z - pivots[1]);
    let [y, z] = [pivots[0] + cosine * v - sine * w, pivots[1] + sine * v + cosine * w];
    let (sine, cosine) = c.to_radians().sin_cos();
    let (u, v) = (x - pivots[2], y - pivots[3]);
    [pivots[2] + cosine * u - sine * v, pivots[3] + sine * u + cosine * v, z]
}

/// Returns the pose at a time between two blocks.
fn pose(from: &Block, to: &Block, time: f64) -> ToolPose {
    let mix = |from: f64, to: f64| from + time * (to - from);
    let angles = [0, 1].map(|k| mix(from.angles[k], to.angles[k]));
    let linear = [0, 1, 2].map(|k| mix(from.linear[k], to.linear[k]));
    if to.tcp {
        let (_, axis) = place([0.0; 3], angles);
        (Point3::from(linear), axis)
    } else {
        place([0, 1, 2].map(|k| linear[k] + ORIGIN[k]), angles)
    }
}

/// Returns random blocks of which every run of ten is with or without tool centre point control. The coordinates of a
/// block are those of a tip near the part.
fn blocks(random: &mut Random, count: usize) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut angles = [0.0; 2];
    for k in 0..count {
        let reach = if random.chance(0.3) { 40.0 } else { 6.0 };
        angles =
            [angles[0] + random.between(-reach, reach), angles[1] + random.between(-reach, reach)];
        angles[0] = f64::clamp(angles[0], -80.0, 80.0);
        let tcp = (k / 10) % 2 == 1;
        let tip: [f64; 3] = random.vector(14.0).into();
        blocks.push(Block { linear: tip, angles, rapid: random.chance(0.2), tcp });
    }
    blocks
}

/// Returns the program of blocks. Where tool centre point control changes, both ends of the change are given.
fn program(blocks: &[Block]) -> String {
    let mut text = String::from("G21 G90 G54 G94 F1000.\nT1 M6\nG43 H1\n");
    let mut tcp = false;
    for block in blocks {
        if block.tcp != tcp {
            tcp = block.tcp;
            text += if tcp { "G43.4 H1\n" } else { "G49\nG43 H1\n" };
        }
        let [x, y, z] = block.linear;
        let [a, c] = block.angles;
        let word = if block.rapid { "G0" } else { "G1" };
        let _ = writeln!(text, "{word} X{x:.6} Y{y:.6} Z{z:.6} A{a:.6} C{c:.6}");
    }
    text + "M30\n"
}

fn rounded(blocks: Vec<Block>) -> Vec<Block> {
    let round = |value: f64| format!("{value:.6}").parse().expect("a number");
    let rounded = |block: Block| Block {
        linear: block.linear.map(round),
        angles: block.angles.map(round),
        ..block
    };
    blocks.into_iter().map(rounded).collect()
}

/// Returns the number of motions: 10,000 with `MOTIONS=10000`.
fn motions() -> usize {
    match std::env::var("MOTIONS") {
        Ok(count) => count.parse().expect("MOTIONS is a number of motions"),
        Err(_) => 320,
    }
}

/// Number of consecutive moves that one checker examines.
const MOVES_PER_TASK: usize = 32;

/// Returns the findings of moves if each task has checkers of its own.
fn by_tasks(verifier: &Verifier<'_>, moves: &[Move]) -> Vec<Finding> {
    let tasks = moves.chunks(MOVES_PER_TASK).enumerate().flat_map(|(task, moves)| {
        let report = verifier.check_moves(moves.to_vec(), &|_| ()).expect("it can be checked");
        let first = task * MOVES_PER_TASK;
        report.findings.into_iter().map(move |mut finding| {
            finding.location += first;
            finding
        })
    });
    tasks.collect()
}

#[test]
fn joint_motions_agree_with_brute_force() {
    let mesh = block([-8.0, -8.0, -8.0], [8.0, 8.0, 8.0]);
    let (bvh, points) = (TriangleBvh::new(&mesh), sample_points(&mesh, 0.6));
    let allowances: [&[(&str, f64)]; 3] =
        [&[], &[("ball", f64::INFINITY), ("flute", 1.5)], &[("nut", -4.0), ("shank", -1.5)]];
    let [mut deep, mut near, mut clear, mut judged] = [0; 4];
    let mut seed = 0;
    while judged < motions() {
        let allowances = allowances[seed % 3];
        seed += 1;
        let blocks = rounded(blocks(&mut Random::new(seed as u64), 60));
        let setup = ControlSetup {
            work_offsets: {
                let mut offsets = [None; 9];
                offsets[0] = Some([ORIGIN[0], ORIGIN[1], ORIGIN[2], 0.0, 0.0, 0.0]);
                offsets
            },
            lengths: [(1, LENGTH)].into(),
            ..ControlSetup::default()
        };
        let machine = Machine::parse(TRUNNION, "trunnion.toml").expect("a machine");
        let program = MachineProgram::new("blocks.nc", program(&blocks), machine, setup);
        let program = program.expect("a program");
        let moves: Vec<_> =
            program.moves(ToolSelection::All, None, Unit::Millimetre).expect("the part").collect();
        let first_line = moves[0].line;
        let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
        let verifier = verifier.with_resolution(RESOLUTION).expect("a length");
        let verifier = allowances.iter().fold(verifier, |verifier, (name, to)| {
            verifier.with_allowance(name, *to).expect("a surface")
        });
        // The line of each block: lines without axis words have no move.
        let lines: Vec<usize> = {
            let mut lines: Vec<usize> = moves.iter().map(|step| step.line).collect();
            lines.dedup();
            lines
        };
        assert_eq!((lines.len(), first_line), (blocks.len(), 4));
        let report = verifier.check_moves(moves.clone(), &|_| ()).expect("it can be checked");
        assert_eq!(report.findings, by_tasks(&verifier, &moves), "a checker is used again");
        for (k, to) in blocks.iter().enumerate().skip(1) {
            let from = &blocks[k - 1];
            // After a change of tool centre point control, the position is that of the other kind of coordinates.
            if from.tcp != to.tcp {
                continue;
            }
            judged += 1;
            let limits = limits(allowances, 0.0, to.rapid);
            let of_line =
                |found: &&Finding| found.line == lines[k] && found.from == Some(lines[k - 1]);
            let found: Vec<Finding> = report.findings.iter().filter(of_line).copied().collect();
            let shown: Vec<Finding> = found
                .iter()
                .filter(|found| {
                    matches!(found.kind, FindingKind::Deep { .. } | FindingKind::Near { .. })
                })
                .copied()
                .collect();
            for finding in &shown {
                let (tip, axis) = pose(from, to, finding.time);
                assert!((finding.pose.tip() - tip).norm() < 1e-9, "{finding:?}: {tip}");
                assert!((finding.pose.axis() - axis).norm() < 1e-12, "{finding:?}: {axis}");
                let mut there = Worst::none();
                match &finding.kind {
                    FindingKind::Deep { surface, depth, allowed, max_depth, witness, .. } => {
                        there.add(&witness.point, &(tip, axis));
                        let actual = there.depth[surface.0];
                        assert!(
                            actual > allowed.max(0.0) || actual == 0.0,
                            "{actual}: {finding:?}"
                        );
                        // On the border to another surface rounding may decide which is the nearest.
                        if actual > 0.0 {
                            assert!(depth.low <= actual + 1e-9 && actual <= depth.high + 1e-9);
                        }
                        assert!(*max_depth >= depth.high);
                        deep += 1;
                    }
                    FindingKind::Near { surface, margin, .. } => {
                        points.iter().for_each(|point| there.add(point, &(tip, axis)));
                        assert!(there.distance[surface.0] < margin + 0.6, "{finding:?}");
                        near += 1;
                    }
                    other => panic!("{other:?} at {finding:?}"),
                }
            }
            let mut expected = Worst::none();
            for step in 0..=TIME_STEPS {
                let pose = pose(from, to, f64::from(step) / f64::from(TIME_STEPS));
                points.iter().for_each(|point| expected.add(point, &pose));
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
                    matches!(found.kind, FindingKind::Deep { .. }) || !is_deep(found.kind.surface())
                })
                .copied()
                .collect();
            compare_with_brute_force(&decided, &limits, &expected);
            clear += usize::from(found.is_empty());
        }
    }
    println!(
        "{judged} motions: {deep} deep, {near} near, {clear} clear; tool {}",
        Mounted.info().name
    );
    assert!(deep > 50 && near > 10 && clear > 50, "{deep} deep, {near} near, {clear} clear");
}
