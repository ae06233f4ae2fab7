//! Scenes of several parts and tools: each pair has the results of a probe alone, wherever the part is put.

use crate::prelude::*;
use nalgebra::{Isometry3, Translation3};
use touchoff::scenes::ScenePath;
use touchoff::{Sampling, Scene};
use touchoff_tests::fixtures::{cuboid, part, poses};
use touchoff_tests::library::tool;

fn fig73() -> &'static dyn Tool {
    tool("Fig73")
}

fn near(what: &str, found: Vector3<f64>, expected: Vector3<f64>) {
    assert_near((found - expected).norm(), 0.0, 1e-9 * (1.0 + expected.norm()), what);
}

#[test]
fn a_scene_of_one_pair_equals_a_probe() {
    let part = part(5_000);
    let mut scene = Scene::new(Unit::Millimetre);
    let tube = scene.add_part(&part, Pose::default()).expect("millimetres");
    let tool = scene.add_tool(fig73());
    let mut probe = Probe::new(&part, fig73());
    for pose in poses(ScenePath::Hold, 200) {
        scene.move_tool(tool, pose);
        let expected = probe.wrench(&pose);
        // The second time the answer is cached.
        for _ in 0..2 {
            assert_eq!(scene.pair_wrench(tool, tube), expected);
        }
        assert_eq!(scene.wrench(tool), expected);
        assert_eq!(scene.detect(tool), probe.detect(&pose).then_some(tube));
        assert_eq!(scene.deepest(tool).map(|(_, deepest)| deepest), expected.deepest);
    }
}

#[test]
fn moving_tool_and_part_together_keeps_the_wrench() {
    let part = part(5_000);
    let moved = Isometry3::from_parts(
        Translation3::new(300.0, -40.0, 7.0),
        UnitQuaternion::from_euler_angles(0.4, -1.1, 2.3),
    );
    let mut scene = Scene::new(Unit::Millimetre);
    scene.add_part(&part, moved.try_into().expect("finite")).expect("millimetres");
    let tool = scene.add_tool(fig73());
    let mut probe = Probe::new(&part, fig73());
    let mut contacts = 0;
    for pose in poses(ScenePath::Hold, 100) {
        let expected = probe.wrench(&pose);
        scene.move_tool(tool, Pose::try_from(moved * pose.to_isometry()).expect("finite"));
        let found = scene.wrench(tool);
        // A point within rounding of the surface may change sides.
        assert!(found.colliding.abs_diff(expected.colliding) <= 1);
        near("force", found.force, moved * expected.force);
        near("torque", found.torque, moved * expected.torque);
        if let (Some(found), Some(expected)) = (found.deepest, expected.deepest) {
            near("deepest", found.point.coords, (moved * expected.point).coords);
            contacts += 1;
        }
    }
    assert!(contacts > 50);
}

#[test]
fn parts_add_up_and_move() {
    let cube = Part::from_mesh(&cuboid([0.0; 3], [20.0; 3]), Sampling::new(4_000));
    let cube = cube.expect("a part");
    let mut scene = Scene::new(Unit::Millimetre);
    let shifted = |x: f64| Pose::try_from(Isometry3::translation(x, 0.0, 0.0)).expect("finite");
    let left_part = scene.add_part(&cube, shifted(-20.5)).expect("millimetres");
    let tool = scene.add_tool(fig73());
    let right_part = scene.add_part(&cube, shifted(0.5)).expect("millimetres");
    // The cutter of radius 1 stands in a slot 1 wide.
    let pose = Pose::from_axis(Point3::new(0.0, 10.0, 15.0), Vector3::z());
    scene.move_tool(tool, pose.expect("unit"));
    let [a, b] = [left_part, right_part].map(|part| scene.pair_wrench(tool, part));
    assert!(a.colliding > 10 && b.colliding > 10 && a.force.x > 0.0 && b.force.x < 0.0);
    let both = scene.wrench(tool);
    assert_eq!((both.force, both.torque), (a.force + b.force, a.torque + b.torque));
    assert_eq!(both.colliding, a.colliding + b.colliding);
    assert_eq!((both.integral, both.energy), (a.integral + b.integral, a.energy + b.energy));
    assert_eq!(both.depth(), a.depth().max(b.depth()));
    assert_eq!(scene.detect(tool), Some(left_part));
    scene.move_part(left_part, shifted(-60.0));
    assert_eq!((scene.wrench(tool), scene.detect(tool)), (b, Some(right_part)));
}

#[test]
fn a_part_in_another_unit_is_converted() {
    let part = part(5_000);
    let pose = ScenePath::Inside.pose(3400, 10_000);
    let expected = Probe::new(&part, fig73()).wrench(&pose);
    let inches = part.converted_to(Unit::Inch);
    let error = Scene::new(Unit::Millimetre).add_part(&inches, Pose::default());
    let error = error.expect_err("inches");
    assert!(error.to_string().contains("inch") && error.to_string().contains("Part::converted_to"));
    let area = inches.diagnostics().expect("of a mesh").area;
    let millimetres = inches.converted_to(Unit::Millimetre);
    let again = millimetres.diagnostics().expect("of a mesh").area;
    assert!((again / area - 25.4f64.powi(2)).abs() < 1e-9);
    let mut scene = Scene::new(Unit::Millimetre);
    scene.add_part(&millimetres, Pose::default()).expect("millimetres");
    let tool = scene.add_tool(fig73());
    scene.move_tool(tool, pose);
    let found = scene.wrench(tool);
    assert_eq!(found.colliding, expected.colliding);
    near("force", found.force, expected.force);
}

#[test]
fn batched_poses_equal_successive_ones() {
    let part = part(5_000);
    let poses = poses(ScenePath::Outside, 3_000);
    let mut probe = Probe::new(&part, &touchoff_tools::Fig73);
    let together = probe.par_map(&poses, |probe, pose| probe.wrench(pose));
    for (pose, found) in poses.iter().zip(together) {
        assert_eq!(probe.wrench(pose), found);
    }
}
