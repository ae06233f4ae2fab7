//! A tool whose end is in a part no deeper than it may be is beside the part, and not wholly inside.

use super::{plate, pose, tool};
use nalgebra::Point3;
use tool_dsl::source::Source;
use touchoff::certify::{Certifier, Clear, Facets, Sweep};
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Motion, Unit};

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

#[test]
fn a_tool_that_is_wholly_inside_is_so_whatever_is_allowed() {
    let block =
        shapes::cuboid(Point3::from([-100.0; 3]), Point3::from([100.0; 3]), Unit::Millimetre);
    let facets = Facets::new(&block.expect("a cuboid"));
    let pose = pose([0.0; 3], [0.0, 0.0, 1.0]);
    let still = Motion::new(&pose, &pose).expect("one way");
    let mut certifier = Certifier::new(&facets, tool("Flat")).expect("a profile");
    for surface in &*tool("Flat").card().surfaces {
        certifier = certifier.allow(&surface.name, 3.0).expect("a surface");
    }
    assert!(matches!(certifier.clear(&pose), Clear::Inside(_)));
    assert!(matches!(certifier.sweep_clear(&still, 0.2), Sweep::Inside(_)));
}

#[test]
fn a_margin_of_a_small_surface_is_kept_with_a_tolerance_larger_than_it() {
    let text = "tool Made { units mm; profile { start (0, 0); line to (4.98, 0) as face;
        line to (5, 0.02) as chamfer; line to (5, 50), (0, 50) as flute; } niceness cutting: 1; }";
    let text = text.replace("as flute", "as flute cutting");
    let made = Interpreted::parse(&Source::new("made.tool", text.as_str())).expect("a tool");
    let facets = Facets::new(&plate());
    let allow = |name: &str, allowed: f64, certifier: Certifier<'static>| {
        certifier.allow(name, allowed).expect("a surface")
    };
    let (facets, made) = (Box::leak(Box::new(facets)), Box::leak(Box::new(made)));
    let certifier = Certifier::new(facets, made).expect("a profile");
    let certifier = allow("face", f64::INFINITY, certifier);
    let certifier = allow("flute", f64::INFINITY, certifier);
    let mut certifier = allow("chamfer", -1.0, certifier);
    let still = |z: f64| {
        let pose = pose([0.0, 0.0, z], [0.0, 0.0, 1.0]);
        Motion::new(&pose, &pose).expect("one way")
    };
    for (z, clear) in [(1.1, true), (0.97, true), (0.9, false), (0.3, false)] {
        let found = certifier.sweep_clear(&still(z), 0.05);
        assert_eq!(found == Sweep::Clear || found == Sweep::SurfaceOnly, clear, "{z}: {found:?}");
    }
}
