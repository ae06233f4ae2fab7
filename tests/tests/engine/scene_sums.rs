//! Sums over the parts of a scene, for contacts whose depth and niceness are known.

use crate::prelude::*;
use nalgebra::Isometry3;
use touchoff::Scene;
use touchoff_tests::fixtures::{interpreted, part_at};
use touchoff_tests::oracle::restated::Restated;

/// Returns a ball of 3 mm radius about (0, 0, 3). Its niceness falls with the height, so that a deeper point may be nicer.
fn ball() -> Interpreted {
    let ball = Restated::drawn("Ball", "0 0; ball 0 6 about 0 3", &[]);
    interpreted(&ball.cuts("ball"), "1 - z/10 allow rising")
}

/// Returns the depth and the niceness of the point of the tool's axis at a height.
fn known(z: f64) -> [f64; 2] {
    [3.0 - (z - 3.0).abs(), 1.0 - z / 10.0]
}

fn near(what: &str, found: f64, expected: f64) {
    assert_near(found, expected, 1e-9, what);
}

/// One point per part, in both orders: the deeper of the two is nicer in some pairs and less nice in others.
#[test]
fn parts_together_have_the_greatest_depth_and_the_least_niceness() {
    let tool = ball();
    let turn = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.3);
    let frames =
        [Isometry3::identity(), Isometry3::from_parts(Vector3::new(7.0, -2.0, 4.0).into(), turn)];
    for heights in [[1.0, 5.5], [5.5, 1.0], [1.0, 4.5], [4.5, 1.0], [2.0, 2.5], [2.5, 2.0]] {
        for frame in frames {
            let parts = heights.map(|z| part_at(&[Point3::new(0.0, 0.0, z)]));
            let mut scene = Scene::new(Unit::Millimetre);
            let pose = Pose::try_from(frame).expect("a pose");
            let ids = parts.each_ref().map(|part| scene.add_part(part, pose).expect("millimetres"));
            let id = scene.add_tool(&tool);
            scene.move_tool(id, pose);
            let [[first, nice], [second, other]] = heights.map(known);
            let wrench = scene.wrench(id);
            near("depth", wrench.depth(), first.max(second));
            near("niceness", wrench.niceness.expect("a contact"), nice.min(other));
            let (part, deepest) = scene.deepest(id).expect("a contact");
            let deeper = usize::from(second > first);
            assert_eq!(part, ids[deeper], "{heights:?}");
            near("depth of the deepest", deepest.depth, first.max(second));
            let at = frame * Point3::new(0.0, 0.0, heights[deeper]);
            for found in [deepest.point, wrench.deepest.expect("a contact").point] {
                near("deepest point", (found - at).norm(), 0.0);
            }
        }
    }
}
