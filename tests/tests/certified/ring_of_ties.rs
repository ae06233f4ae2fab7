//! Depth on rings of ties. A point off the axis that is equally near to three segments of a profile is a corner of
//! their zones. Revolved about the axis, it is a ring. A triangle that the ring intersects may be deepest there,
//! neither on an edge nor on its meridian.

use crate::prelude::*;

fn wall() -> Mesh {
    soup(&[[[-200.0, 3.0, -150.0], [200.0, 3.0, -150.0], [0.0, 3.0, 400.0]]])
}

fn upright() -> Pose {
    pose([0.0; 3], UP)
}

/// The flute has radius 10.5 from z = 0 to 9, between a face and a back. All three are 4.5 away from (6, 4.5). The centre of
/// the corner's arc is (4, 2). It is 2 away from all of the arc, from the face and from the flute.
#[test]
fn a_flute_between_a_face_and_a_back_and_a_corner_are_deepest_on_a_ring() {
    for (tool, depth) in [("TSlot", 4.5), ("BullNose", 2.0)] {
        let found = certifier(&wall(), tool).deepest_on(SurfaceId(1), &upright(), 1e-9);
        assert_contains(found.expect("a surface").depth, depth, f64::INFINITY, tool);
    }
}

#[test]
fn the_allowance_of_a_flute_deepest_on_a_ring_is_checked() {
    let others = ["face", "back", "neck", "shank"].map(|other| (other, f64::INFINITY));
    let mut certifier = certifier(&wall(), "TSlot").with_allowances(others).expect("surfaces");
    let verdict = certifier.check_pose(&upright());
    assert!(matches!(verdict, PoseVerdict::Touching(_)), "{verdict:?}");
    touching(certifier.check_motion(&motion(&upright(), &upright()), 0.0));
}

#[test]
fn ties_belong_to_both_surfaces() {
    let wall = soup(&[[[-100.0, 2.0, -50.0], [100.0, 2.0, -50.0], [0.0, 2.0, 150.0]]]);
    for (drawing, cutting, surface) in [
        // The wall meets the circle (2, 2), where the flute's upper end is as near as the face.
        ("0 0; face 5 0; flute 5 2; shank 5 50, 0 50", "flute", "flute"),
        // Near (3, 2) the corner of the back owns the point, at the same distance as the face.
        ("0 0; face 20 0; rim 20 2; back 5 2; neck 5 50, 0 50", "rim", "back"),
    ] {
        let tool = drawn(drawing, cutting);
        let known = tool.info().surface_named(surface).expect("a surface");
        let found = certifier_of(&wall, &tool).deepest_on(known, &upright(), 1e-9);
        assert_contains(found.expect("a surface").depth, 2.0, 1e-8, surface);
    }
}
