//! Item 7: quarter and half turns with and without rounding, the axes, and tilts of 1e-9. A contact's depth is compared
//! with that of the given point at the pose as it is in doubles. A scene turned as a whole without rounding has the same
//! bits.

use crate::equivalent::values;
use crate::prelude::*;
use touchoff_tests::turns::{EXACT_TURNS, ROUNDED_TURNS};

/// Spacing of the coordinates' grid, so that its multiples keep all bits near the tips used here.
const GRID: f64 = 1.0 / 1024.0;

#[test]
fn aligned_poses_are_exact() {
    check_tools(7, |subject, rng, checks| {
        let points = PointSet::near_tool(subject, extent(12, 200), GRID, rng);
        for pose in poses(subject.oracle.is_revolved()) {
            Scene::new(subject, points.transformed(&pose, GRID), pose).check(checks);
        }
        let original = values(&Scene::new(subject, points.clone(), Pose::default()), true);
        for turn in EXACT_TURNS {
            let pose = pose(Point3::origin(), turn);
            let turned = Scene::new(subject, points.transformed(&pose, GRID), pose);
            let turned = values(&turned, true);
            checks.never("quarter turn: other bits", turned != original, || format_pose(&pose));
        }
    });
}

/// Returns the poses; those without a spin are for tools of revolution.
fn poses(is_revolved: bool) -> Vec<Pose> {
    let tip = Point3::new(0.5, -1.0, -2.0);
    let mut poses: Vec<Pose> =
        EXACT_TURNS.iter().chain(&ROUNDED_TURNS).map(|turn| pose(tip, *turn)).collect();
    if is_revolved {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let tilted = [x, -y, z, -z].map(|axis| axis + Vector3::new(1e-9, -1e-9, 1e-9));
        let axes = [x, -x, y, -y, -z].into_iter().chain(tilted);
        poses.extend(axes.map(|axis| Pose::from_axis(tip, axis).expect("a unit vector")));
    }
    let tilts = [[1e-9, 0.0], [0.0, -1e-9], [1e-9, 1e-9]];
    poses.extend(tilts.map(|[x, y]| pose(tip, [x / 2.0, y / 2.0, 0.0, 1.0])));
    poses
}
