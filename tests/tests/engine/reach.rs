//! How far tools reach: points at the limit of what is ruled out without being evaluated.

use crate::prelude::*;
use nalgebra::Isometry3;
use touchoff::{InsideQuery, Scene, ToolEnvelope};
use touchoff_tests::fixtures::{drawn, part_at};

/// A disc of 10 mm radius and height.
const DISC: &str = "0 0; face 10 0; rim 10 10; top 0 10";

/// A disc as high as it is wide reaches farthest from its tip at its upper rim, and a cube from its middle at its
/// corners: the one just touches the other, along the line from the tip to the middle.
#[test]
fn a_rim_that_just_touches_a_corner_is_detected() {
    let disc = drawn(DISC, "rim");
    let half = 4.0;
    let corners: Vec<Point3<f64>> = (0..8)
        .map(|k| Point3::from([0, 1, 2].map(|axis| if k >> axis & 1 == 0 { -half } else { half })))
        .collect();
    let cube = part_at(&corners);
    let rim = Vector3::new(10.0, 0.0, 10.0);
    let diagonal = Vector3::new(1.0, 1.0, 1.0);
    let turn = UnitQuaternion::rotation_between(&-diagonal, &rim).expect("no half turn");
    let mut scene = Scene::new(Unit::Millimetre);
    let part = scene.add_part(&cube, Pose::default()).expect("millimetres");
    let id = scene.add_tool(&disc);
    for (inside, touches) in [(1e-3, true), (1e-5, true), (-1e-3, false)] {
        let middle = Point3::from(rim.normalize() * (rim.norm() - inside + 3f64.sqrt() * half));
        let frame = Isometry3::from_parts(middle.coords.into(), turn);
        scene.move_part(part, Pose::try_from(frame).expect("a pose"));
        assert_eq!(scene.detect(id), touches.then_some(part), "{inside}");
        assert_eq!(scene.pair_wrench(id, part).colliding, usize::from(touches), "{inside}");
    }
}

/// Points below, above and beside the disc, in turn.
#[test]
fn an_envelope_that_is_widened_reaches_points_as_far_as_that() {
    const DISTANCE: f64 = 2.0;
    let disc = drawn(DISC, "rim");
    for (outward, beside) in [
        (Vector3::new(0.0, 0.0, -1.0), Point3::new(3.0, 0.0, 0.0)),
        (Vector3::new(0.0, 0.0, 1.0), Point3::new(3.0, 0.0, 10.0)),
        (Vector3::new(1.0, 0.0, 0.0), Point3::new(10.0, 0.0, 5.0)),
    ] {
        for (gap, is_reached) in [(0.1, true), (1.99, true), (2.01, false), (5.0, false)] {
            let part = part_at(&[beside + gap * outward]);
            let tree = part.tree();
            let mut query = InsideQuery::default();
            let pose = Pose::default();
            let envelope = ToolEnvelope::new(tree, disc.info(), Unit::Millimetre);
            assert!(query.is_out_of_reach(tree, &envelope, &pose), "{outward} {gap}");
            let envelope = ToolEnvelope::widened(tree, disc.info(), Unit::Millimetre, DISTANCE);
            let found = query.is_out_of_reach(tree, &envelope, &pose);
            assert_eq!(found, !is_reached, "{outward} {gap}");
        }
    }
}

/// Points just inside each side of the disc. The part's other point is in the opposite corner of its bounding cube, whose
/// diagonal is turned away from the tool: the part's middle is as far from that point as it can be.
#[test]
fn points_just_inside_a_tool_are_found_however_far_the_part_reaches() {
    let disc = drawn(DISC, "rim");
    for (inside, away) in [
        (Vector3::new(9.99, 0.0, 5.0), Vector3::x()),
        (Vector3::new(0.0, -9.99, 0.01), -Vector3::y()),
        (Vector3::new(3.0, 0.0, 0.01), -Vector3::z()),
        (Vector3::new(-3.0, 1.0, 9.99), Vector3::z()),
    ] {
        for size in [1.0, 1e2, 1e3, 1e4] {
            let part = part_at(&[Point3::origin(), Point3::new(size, size, size)]);
            let diagonal = Vector3::new(1.0, 1.0, 1.0);
            let turn = UnitQuaternion::rotation_between(&away, &diagonal).expect("no half turn");
            let [x, y, z, w] = turn.coords.into();
            let pose = Pose::from_quaternion(Point3::from(-(turn * inside)), [x, y, z, w]);
            let pose = pose.expect("a pose");
            let mut scene = Scene::new(Unit::Millimetre);
            let id = scene.add_part(&part, Pose::default()).expect("millimetres");
            let tool = scene.add_tool(&disc);
            scene.move_tool(tool, pose);
            assert_eq!(scene.pair_wrench(tool, id).colliding, 1, "{inside} {size}");
        }
    }
}
