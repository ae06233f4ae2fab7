//! A tool whose end is in a part no deeper than it may be is beside the part, and not wholly inside.

use crate::{plate, pose, tool};
use touchoff::Motion;
use touchoff::certify::{Certifier, Clear, Facets, Sweep};

/// With its upper end, at 40, by so much below the plate's face.
fn upside_down(by: f64) -> touchoff::Pose {
    pose([0.3, 0.1, 40.0 - by], [0.0, 0.0, -1.0])
}

#[test]
fn an_end_within_the_tolerance_is_not_inside() {
    let facets = Facets::new(&plate());
    let mut certifier = Certifier::new(&facets, tool("D2Ball")).expect("a profile");
    let still = Motion::new(&upside_down(1e-4), &upside_down(1e-4)).expect("one way");
    assert_eq!(certifier.sweep_clear(&still, 1e-3), Sweep::Clear);
}

#[test]
fn an_end_that_is_allowed_to_be_there_is_not_inside() {
    let facets = Facets::new(&plate());
    let certifier = Certifier::new(&facets, tool("D2Ball")).expect("a profile");
    let mut certifier = certifier.allow("shank", 1.0).expect("a surface");
    assert_eq!(certifier.clear(&upside_down(0.5)), Clear::Clear);
}
