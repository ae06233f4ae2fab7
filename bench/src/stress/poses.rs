//! Item 7: poses that are aligned with the part exactly, and poses that are tilted very slightly.

use super::ledger::{Kind, Ledger};
use super::scene::{Asked, Given, shown};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::{Pose, Probe};
use touchoff_tests::oracle::draw::Rng;

/// Part and tool rotated together by quarter and half turns: depths, magnitudes and regions have the same bits.
const SAME: Kind = Kind::never("quarter turn: other bits");

/// Spacing of the coordinates' grid, so that its multiples keep all bits near the tips used here.
const GRID: f64 = 1.0 / 1024.0;

/// Returns quarter and half turns as quaternions. Those of the first list give rotations without rounding.
fn turns() -> [Vec<[f64; 4]>; 2] {
    let s = std::f64::consts::FRAC_1_SQRT_2;
    let exact = vec![
        [0.0, 0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.5, 0.5, 0.5, 0.5],
        [-0.5, 0.5, 0.5, 0.5],
        [0.5, -0.5, 0.5, 0.5],
    ];
    let rounded = vec![[s, 0.0, 0.0, s], [0.0, s, 0.0, -s], [0.0, 0.0, s, s], [s, s, 0.0, 0.0]];
    [exact, rounded]
}

/// Validates a scene at all these poses.
pub(super) fn poses(subject: &Subject, count: usize, draw: &mut Rng, ledger: &mut Ledger) {
    let own = Given::about(subject, count, GRID, draw);
    let tip = Point3::new(0.5, -1.0, -2.0);
    let [exact, rounded] = turns();
    let of = |q: &[f64; 4]| Pose::from_quaternion(tip, *q).expect("a unit quaternion");
    let mut poses: Vec<Pose> = exact.iter().chain(&rounded).map(of).collect();
    if subject.oracle.revolved() {
        let ways = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y(), -Vector3::z()];
        let tilted = [Vector3::x(), -Vector3::y(), Vector3::z(), -Vector3::z()]
            .map(|way| way + Vector3::new(1e-9, -1e-9, 1e-9));
        let along = ways.into_iter().chain(tilted);
        poses.extend(along.map(|axis| Pose::from_axis(tip, axis).expect("a unit vector")));
    }
    let tilts = [[1e-9, 0.0], [0.0, -1e-9], [1e-9, 1e-9]];
    poses.extend(tilts.map(|[x, y]| of(&[x / 2.0, y / 2.0, 0.0, 1.0])));
    for pose in poses {
        let there = own.at(&pose, GRID);
        let part = there.part();
        let (tool, truth) = (subject.tool, &*subject.truth);
        Asked { tool, truth, given: &there, part: &part }.at(&pose, ledger);
    }
    turned(subject, &own, &exact, ledger);
}

/// Rotates the scene as a whole.
fn turned(subject: &Subject, own: &Given, turns: &[[f64; 4]], ledger: &mut Ledger) {
    let evaluation = |given: &Given, pose: &Pose| {
        let part = given.part();
        let mut probe = Probe::new(&part, subject.tool);
        let mut list: Vec<(u32, usize, u64, u64)> = probe
            .contacts(pose)
            .iter()
            .map(|c| {
                // Adding 0 makes -0 equal to 0.
                let [depth, magnitude] = [c.depth, c.magnitude].map(|v| (v + 0.0).to_bits());
                (c.triangle.0, c.region, depth, magnitude)
            })
            .collect();
        list.sort_unstable();
        list
    };
    let unturned = evaluation(own, &Pose::default());
    for q in turns {
        let pose = Pose::from_quaternion(Point3::origin(), *q).expect("a unit quaternion");
        let there = own.at(&pose, GRID);
        ledger.count(SAME, evaluation(&there, &pose) != unturned, || shown(&pose));
    }
}
