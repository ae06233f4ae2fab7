//! Depth on rings of ties. A point off the axis that is equally near to three segments of a profile is a corner of
//! their zones. Revolved about the axis, it is a ring. A triangle that the ring intersects may be deepest there,
//! neither on an edge nor on its meridian.

use crate::{UP, motion, pose, soup, tool};
use touchoff::certify::{Certifier, MotionVerdict, PoseVerdict, TriangleBvh};
use touchoff::tool::Interpreted;
use touchoff::{Interval, Mesh, Pose, SurfaceId, Tool};
use touchoff_tests::fixtures::drawn;

fn wall() -> Mesh {
    soup(&[[[-200.0, 3.0, -150.0], [200.0, 3.0, -150.0], [0.0, 3.0, 400.0]]])
}

fn upright() -> Pose {
    pose([0.0; 3], UP)
}

/// The flute has radius 10.5 from z = 0 to 9, between a face and a back. All three are 4.5 away from (6, 4.5).
const MAX_DEPTH: f64 = 4.5;

#[test]
fn a_flute_between_a_face_and_a_back_is_deepest_on_a_ring() {
    let bvh = TriangleBvh::new(&wall());
    let mut certifier = Certifier::new(&bvh, tool("TSlot")).expect("a profile");
    let penetration = certifier.deepest_on(SurfaceId(1), &upright(), 1e-9).expect("a surface");
    let Interval { low, high } = penetration.depth;
    assert!(low <= MAX_DEPTH && MAX_DEPTH <= high, "{penetration:?}");
}

#[test]
fn the_allowance_of_a_flute_deepest_on_a_ring_is_checked() {
    let bvh = TriangleBvh::new(&wall());
    let certifier = Certifier::new(&bvh, tool("TSlot")).expect("a profile");
    let mut certifier = ["face", "back", "neck", "shank"]
        .into_iter()
        .fold(certifier, |c, other| c.with_allowance(other, f64::INFINITY).expect("a surface"));
    let verdict = certifier.check_pose(&upright());
    assert!(matches!(verdict, PoseVerdict::Touching(_)), "{verdict:?}");
    let at_rest = motion(&upright(), &upright());
    let verdict = certifier.check_motion(&at_rest, 0.0);
    assert!(matches!(verdict, MotionVerdict::Touching(..)), "{verdict:?}");
}

/// The centre of the corner's arc is (4, 2). It is 2 away from all of the arc, from the face and from the flute.
#[test]
fn a_corner_is_deepest_at_its_centre() {
    let bvh = TriangleBvh::new(&wall());
    let mut certifier = Certifier::new(&bvh, tool("BullNose")).expect("a profile");
    let Interval { low, high } =
        certifier.deepest_on(SurfaceId(1), &upright(), 1e-9).expect("a surface of the tool").depth;
    assert!(low <= 2.0 && 2.0 <= high, "{low} to {high}");
}

/// Returns the certified depth of a surface beside a wall at y = 2.
fn deepest_on(tool: &Interpreted, surface: &str) -> [f64; 2] {
    let mesh = soup(&[[[-100.0, 2.0, -50.0], [100.0, 2.0, -50.0], [0.0, 2.0, 150.0]]]);
    let bvh = TriangleBvh::new(&mesh);
    let mut certifier = Certifier::new(&bvh, tool).expect("a profile");
    let known = tool.info().surface_named(surface).expect("a surface");
    certifier.deepest_on(known, &upright(), 1e-9).expect("a surface").depth.into()
}

#[test]
fn ties_belong_to_both_surfaces() {
    for (drawing, cutting, surface) in [
        // The wall meets the circle (2, 2), where the flute's upper end is as near as the face.
        ("0 0; face 5 0; flute 5 2; shank 5 50, 0 50", "flute", "flute"),
        // Near (3, 2) the corner of the back owns the point, at the same distance as the face.
        ("0 0; face 20 0; rim 20 2; back 5 2; neck 5 50, 0 50", "rim", "back"),
    ] {
        let [low, high] = deepest_on(&drawn(drawing, cutting), surface);
        assert!(low <= 2.0 && 2.0 <= high && high - low < 1e-8, "{surface}: {low} to {high}");
    }
}
