//! A tool whose end is in a part within its tolerance or allowance is beside the part, not inside it.

use crate::prelude::*;

/// Returns a pose upside down, with the tool's upper end (z = 40) at this depth below the plate's face.
fn upside_down(depth: f64) -> Pose {
    pose([0.3, 0.1, 40.0 - depth], [0.0, 0.0, -1.0])
}

#[test]
fn an_end_within_the_tolerance_is_not_inside() {
    let at_rest = motion(&upside_down(1e-4), &upside_down(1e-4));
    let verdict = certifier(&plate(), "D2Ball").check_motion(&at_rest, 1e-3);
    assert_eq!(verdict, MotionVerdict::Clear);
}

#[test]
fn an_end_within_its_allowance_is_not_inside() {
    let mut certifier =
        certifier(&plate(), "D2Ball").with_allowance("shank", 1.0).expect("a surface");
    assert_eq!(certifier.check_pose(&upside_down(0.5)), PoseVerdict::Clear);
}

#[test]
fn a_tool_entirely_inside_is_inside_with_any_allowance() {
    let pose = pose([0.0; 3], UP);
    let at_rest = motion(&pose, &pose);
    let certifier = certifier(&block([-100.0; 3], [100.0; 3]), "Flat");
    let mut certifier = allowing(certifier, tool("Flat"), [3.0; 3]);
    assert!(matches!(certifier.check_pose(&pose), PoseVerdict::Inside(_)));
    assert!(matches!(certifier.check_motion(&at_rest, 0.2), MotionVerdict::Inside(_)));
}

#[test]
fn the_margin_of_a_surface_smaller_than_the_tolerance_is_kept() {
    let made = drawn("0 0; face 4.98 0; chamfer 5 0.02; flute 5 50, 0 50", "flute");
    let allowed = [("face", f64::INFINITY), ("flute", f64::INFINITY), ("chamfer", -1.0)];
    let mut certifier = certifier_of(&plate(), &made).with_allowances(allowed).expect("surfaces");
    let at_rest = |z: f64| {
        let pose = pose([0.0, 0.0, z], UP);
        motion(&pose, &pose)
    };
    for (z, clear) in [(1.1, true), (0.97, true), (0.9, false), (0.3, false)] {
        let verdict = certifier.check_motion(&at_rest(z), 0.05);
        assert_eq!(verdict.is_clear(), clear, "{z}: {verdict:?}");
    }
}
