//! Poses that are aligned with the part to the last bit, and ones that hardly differ from that.

use super::compare::check_tools;
use super::parts;
use crate::prelude::*;
use touchoff_tests::turns::{EXACT_TURNS, ROUNDED_TURNS};

/// Returns a grid of points half a unit apart: on faces, axes, edges and splitting curves of the tools, all at
/// once.
fn grid(half: i32) -> Part {
    let side = 2 * half + 1;
    let at = |i: i32| 0.5 * f64::from(i % side - half);
    let point = |k: i32| Point3::new(at(k / side / side), at(k / side), at(k));
    let points: Vec<_> = (0..side.pow(3)).map(point).collect();
    let count = points.len();
    let normals = (0..count).map(|i| Vector3::ith(i % 3, if i % 2 == 0 { 1.0 } else { -1.0 }));
    parts::of(points, normals.collect(), vec![0.25; count])
}

fn tips() -> [Point3<f64>; 3] {
    [Point3::origin(), Point3::new(0.5, -1.0, -2.0), Point3::new(0.25, 0.125, -3.0)]
}

#[test]
fn quarter_and_half_turns_agree_with_the_oracle() {
    check_tools("turns", &grid(7), 0, |case, _| {
        let mut k = 0;
        for tip in tips() {
            let turns = EXACT_TURNS.into_iter().chain(ROUNDED_TURNS);
            let turns = turns.map(|turn| Pose::from_quaternion(tip, turn));
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let axes = axes.into_iter().flat_map(|axis| [axis, -axis]);
            let axes = axes.map(|axis| Pose::from_axis(tip, axis));
            for pose in turns.chain(axes).map(|pose| pose.expect("a pose")) {
                let before = case.statistics.disputed;
                assert!(case.check(&pose, k) > 0);
                k += 1;
                if pose.rotation().iter().all(|c| [-1.0, 0.0, 1.0].contains(c)) {
                    // Nothing is rounded: points on the surface belong to the tool on both sides.
                    assert_eq!(case.statistics.disputed, before, "{} {pose:?}", case.oracle.name());
                }
            }
        }
        assert!(case.statistics.doubtful > 50);
    });
}

#[test]
fn slightly_tilted_poses_agree_with_the_oracle() {
    check_tools("tilts", &grid(7), 0, |case, _| {
        let mut k = 0;
        for tilt in [1e-5, 1e-9, 1e-13, 1e-17, 1e-300] {
            for up in [Vector3::x(), -Vector3::y(), Vector3::z(), -Vector3::z()] {
                for axis in [Vector3::new(tilt, tilt, 0.0), Vector3::new(0.0, -tilt, tilt)] {
                    let pose = Pose::from_axis(tips()[k % 3], up + axis).expect("a pose");
                    assert!(case.check(&pose, k) > 0);
                    k += 1;
                }
            }
        }
    });
}
