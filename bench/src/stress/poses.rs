//! Item 7: poses that are aligned with the part exactly, and poses that are tilted very slightly.

use super::ledger::{Kind, Ledger};
use super::scene::{PointSet, ProbeCheck, format_pose};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::{Pose, Probe};
use touchoff_tests::oracle::rng::Rng;

/// Part and tool rotated together by quarter and half turns: depths, magnitudes and regions have the same bits.
const CHANGED_BITS: Kind = Kind::forbidden_event("quarter turn: other bits");

/// Spacing of the coordinates' grid, so that its multiples keep all bits near the tips used here.
const GRID: f64 = 1.0 / 1024.0;

/// Returns quarter and half turns as quaternions. Those of the first list give rotations without rounding.
fn quarter_turns() -> [Vec<[f64; 4]>; 2] {
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
pub(super) fn aligned_poses(subject: &Subject, count: usize, rng: &mut Rng, ledger: &mut Ledger) {
    let scene = PointSet::near_tool(subject, count, GRID, rng);
    let tip = Point3::new(0.5, -1.0, -2.0);
    let [exact, rounded] = quarter_turns();
    let pose_of = |q: &[f64; 4]| Pose::from_quaternion(tip, *q).expect("a unit quaternion");
    let mut poses: Vec<Pose> = exact.iter().chain(&rounded).map(pose_of).collect();
    if subject.oracle.is_revolved() {
        let axes = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y(), -Vector3::z()];
        let tilted = [Vector3::x(), -Vector3::y(), Vector3::z(), -Vector3::z()]
            .map(|axis| axis + Vector3::new(1e-9, -1e-9, 1e-9));
        let all_axes = axes.into_iter().chain(tilted);
        poses.extend(all_axes.map(|axis| Pose::from_axis(tip, axis).expect("a unit vector")));
    }
    let tilts = [[1e-9, 0.0], [0.0, -1e-9], [1e-9, 1e-9]];
    poses.extend(tilts.map(|[x, y]| pose_of(&[x / 2.0, y / 2.0, 0.0, 1.0])));
    for pose in poses {
        let placed = scene.transformed(&pose, GRID);
        let part = placed.part();
        let (tool, truth) = (subject.tool, &*subject.truth);
        ProbeCheck { tool, truth, point_set: &placed, part: &part }.check(&pose, ledger);
    }
    compare_rotated(subject, &scene, &exact, ledger);
}

/// Rotates the scene as a whole.
fn compare_rotated(
    subject: &Subject,
    scene: &PointSet,
    rotations: &[[f64; 4]],
    ledger: &mut Ledger,
) {
    let evaluation = |point_set: &PointSet, pose: &Pose| {
        let part = point_set.part();
        let mut probe = Probe::new(&part, subject.tool);
        let mut values: Vec<(u32, usize, u64, u64)> = probe
            .contacts(pose)
            .iter()
            .map(|c| {
                // Adding 0 makes -0 equal to 0.
                let [depth, magnitude] = [c.depth, c.magnitude].map(|v| (v + 0.0).to_bits());
                (c.triangle.0, c.region, depth, magnitude)
            })
            .collect();
        values.sort_unstable();
        values
    };
    let expected = evaluation(scene, &Pose::default());
    for q in rotations {
        let pose = Pose::from_quaternion(Point3::origin(), *q).expect("a unit quaternion");
        let rotated = scene.transformed(&pose, GRID);
        ledger.count(CHANGED_BITS, evaluation(&rotated, &pose) != expected, || format_pose(&pose));
    }
}
