//! Where three pieces of a profile are as near, away from the axis, a zone has a corner. Turned about the axis this
//! is a ring, and a triangle that the ring passes through may be deepest there: neither on an edge nor on its meridian.

use crate::{pose, soup, tool};
use touchoff::certify::{Certifier, Clear, Facets, Sweep};
use touchoff::{Mesh, Motion, Pose};

/// A wall at y = 3 that is larger than the tool.
fn wall() -> Mesh {
    soup(&[[[-200.0, 3.0, -150.0], [200.0, 3.0, -150.0], [0.0, 3.0, 400.0]]])
}

fn upright() -> Pose {
    pose([0.0; 3], [0.0, 0.0, 1.0])
}

/// The flute is at 10.5 from 0 to 9, between a face and a back: at (6, 4.5) all are 4.5 away.
const DEEPEST: f64 = 4.5;

#[test]
fn a_flute_between_a_face_and_a_back_is_deepest_on_a_ring() {
    let facets = Facets::new(&wall());
    let mut certifier = Certifier::new(&facets, tool("TSlot")).expect("a profile");
    let found = certifier.deepest_on(1, &upright(), 1e-9);
    let [low, high] = found.depth;
    assert!(low <= DEEPEST && DEEPEST <= high, "{found:?}");
}

#[test]
fn an_allowance_of_such_a_flute_is_not_passed_over() {
    let facets = Facets::new(&wall());
    let certifier = Certifier::new(&facets, tool("TSlot")).expect("a profile");
    let mut certifier = ["face", "back", "neck", "shank"]
        .into_iter()
        .fold(certifier, |c, other| c.allow(other, f64::INFINITY).expect("a surface"));
    let found = certifier.clear(&upright());
    assert!(matches!(found, Clear::Touching(_)), "{found:?}");
    let still = Motion::new(&upright(), &upright()).expect("one way");
    let found = certifier.sweep_clear(&still, 0.0);
    assert!(matches!(found, Sweep::Touching(..)), "{found:?}");
}

/// The corner's centre is at (4, 2), 2 from all of it, from the face and from the flute.
#[test]
fn a_corner_is_deepest_at_its_centre() {
    let facets = Facets::new(&wall());
    let mut certifier = Certifier::new(&facets, tool("BullNose")).expect("a profile");
    let [low, high] = certifier.deepest_on(1, &upright(), 1e-9).depth;
    assert!(low <= 2.0 && 2.0 <= high, "{low} to {high}");
}
