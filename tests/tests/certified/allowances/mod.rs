//! Allowances of surfaces and depths per surface, checked against known geometry and against the oracle's owners.

pub(crate) mod sampled;

use crate::prelude::*;
use touchoff::certify::AllowanceError;

fn surface(name: &str, surface: &str) -> SurfaceId {
    tool(name).info().surface_named(surface).expect("a surface")
}

/// Returns a certifier with allowances by name; those of all other surfaces are 0.
fn certifier_with(mesh: &Mesh, name: &str, allowed: &[(&str, f64)]) -> Certifier<'static> {
    certifier(mesh, name).with_allowances(allowed.iter().copied()).expect("surfaces")
}

/// Asserts that a tool at rest is clear, or touches with a surface.
fn assert_at_rest(
    certifier: &mut Certifier<'_>,
    pose: &Pose,
    touching: Option<SurfaceId>,
    text: &str,
) {
    let verdict = certifier.check_pose(pose);
    let at_rest = certifier.check_motion(&motion(pose, pose), 0.0);
    let touched = match (verdict, at_rest) {
        (PoseVerdict::Clear, MotionVerdict::Clear) => None,
        (
            PoseVerdict::Touching(witness) | PoseVerdict::Near(witness),
            MotionVerdict::Touching(..) | MotionVerdict::Near(..),
        ) => Some(witness.surface),
        other => panic!("{text}: {other:?}"),
    };
    assert_eq!(touched, touching, "{text}");
}

#[test]
fn a_flute_may_cut_and_a_shank_may_not() {
    // The flute extends from z = 0 to 26 and has a radius of 6; the shank above is as thick.
    let upright = pose([0.0; 3], UP);
    for (top, clear) in [(25.0, true), (25.5, true), (26.0 + 1e-3, false), (40.0, false)] {
        let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, top]);
        let mut certifier = certifier_with(&wall, "Flat", &[("flute", f64::INFINITY)]);
        let touching = (!clear).then(|| surface("Flat", "shank"));
        assert_at_rest(&mut certifier, &upright, touching, &format!("{top}"));
    }
    let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, 20.0]);
    for (allowed, clear) in [(2.0 + 1e-9, true), (2.0 - 1e-9, false), (0.0, false)] {
        let mut certifier = certifier_with(&wall, "Flat", &[("flute", allowed)]);
        assert_eq!(certifier.check_pose(&upright) == PoseVerdict::Clear, clear, "{allowed}");
        // Along the wall the depth is constant.
        let verdict = certifier.check_motion(&motion_along_wall(), 0.02);
        assert_eq!(verdict == MotionVerdict::Clear, allowed > 1.0, "{allowed}: {verdict:?}");
    }
}

/// Returns a motion on which the flute stays 2 mm deep in a wall at x = 4.
fn motion_along_wall() -> Motion {
    motion(&pose([0.0, -10.0, 0.0], UP), &pose([0.0, 10.0, 0.0], UP))
}

#[test]
fn a_flute_cuts_along_a_wall() {
    let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, 20.0]);
    for allowed in [2.01, 3.0, f64::INFINITY] {
        for tolerance in [0.0, 1e-6, 1e-3] {
            let mut certifier = certifier_with(&wall, "Flat", &[("flute", allowed)]);
            let verdict = certifier.check_motion(&motion_along_wall(), tolerance);
            assert_eq!(verdict, MotionVerdict::Clear, "{allowed} {tolerance:e}");
        }
    }
}

/// A thorn 1 mm from the flute where the tool passes it between the times at which a motion is probed.
#[test]
fn a_margin_that_a_thorn_breaks_in_passing_is_found() {
    for at in [0.03, 0.19, 0.44, 0.8] {
        let x = 160.0 * at - 80.0;
        let thorn = soup(&[[[x, 7.0, 5.0], [x - 0.1, 9.0, 5.0], [x + 0.1, 9.0, 5.0]]]);
        let mut certifier = certifier_with(&thorn, "Flat", &[("flute", -2.0)]);
        let path = motion(&pose([-80.0, 0.0, 0.0], UP), &pose([80.0, 0.0, 0.0], UP));
        let verdict = certifier.check_motion(&path, 1e-6);
        assert!(matches!(verdict, MotionVerdict::Near(time, _) if (time - at).abs() < 0.03));
        let flute = surface("Flat", "flute");
        let (_, depth, max_depth, _) = deeper(certifier.motion_depth(flute, &path, -2.0, 1e-6));
        assert!(depth.contains(-1.0) && (-1.0..-0.8).contains(&max_depth), "{depth} {max_depth}");
    }
}

/// A ball in a block, and a margin that it breaks in there: that it is inside is the graver finding.
#[test]
fn a_tool_inside_the_part_is_inside_whatever_its_margin() {
    let block = block([-20.0, -20.0, -40.0], [20.0, 20.0, 0.0]);
    let ball = touchoff_tests::fixtures::ball();
    let buried = pose([0.0, 0.0, -7.0], UP);
    let path = motion(&buried, &pose([0.5, 0.0, -7.0], UP));
    for margin in [0.0, 0.5, 2.0, 5.0] {
        let certifier = certifier_of(&block, &ball);
        let mut certifier = certifier.with_allowance("ball", -margin).expect("a surface");
        assert_eq!(certifier.check_pose(&buried), PoseVerdict::Inside(SurfaceId(0)), "{margin}");
        let verdict = certifier.check_motion(&path, 1e-3);
        assert_eq!(verdict, MotionVerdict::Inside(SurfaceId(0)), "{margin}");
        let depth = certifier.motion_depth(SurfaceId(0), &path, -margin, 1e-3);
        assert_eq!(depth, Ok(MotionDepth::Inside), "{margin}");
    }
}

#[test]
fn a_nut_keeps_its_margin_from_all_sides() {
    // The nut's ring is at z = 30, its cone has radii 12.9 to 14, its side has radius 14 up to z = 47.5.
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    type PartAt = fn(f64) -> Mesh;
    let cases: [(&str, PartAt); 4] = [
        ("ring", |gap| block([7.0, -1.0, 20.0], [9.0, 1.0, 30.0 - gap])),
        ("side", |gap| block([14.0 + gap, -9.0, 35.0], [30.0, 9.0, 40.0])),
        ("end", |gap| block([-9.0, -9.0, 47.5 + gap], [9.0, 9.0, 60.0])),
        ("past the ring", |gap| block([7.0, -1.0, 20.0], [40.0, 1.0, 30.0 - gap])),
    ];
    for (case, part) in cases {
        for (gap, clear) in [(0.4, false), (0.5 - 1e-9, false), (0.5 + 1e-9, true), (0.6, true)] {
            let mut certifier = certifier_with(&part(gap), "BallEr16", &[("nut.nut", -0.5)]);
            let end_pose = pose([0.0; 3], UP);
            let touching = (!clear).then(|| surface("BallEr16", "nut.nut"));
            assert_at_rest(&mut certifier, &end_pose, touching, &format!("{case} {gap}"));
            // Approach from far away along the axis.
            let lift = if case == "end" { -30.0 } else { 3.0 };
            let approach = motion(&pose([0.0, 0.0, lift], UP), &end_pose);
            let approach = certifier.check_motion(&approach, 0.0);
            if case != "side" {
                assert_eq!(approach == MotionVerdict::Clear, clear, "{case} {gap}: {approach:?}");
            }
        }
    }
    // A corner of a part beside the cone, at a distance along the diagonal.
    for (gap, clear) in [(0.4, false), (0.6, true)] {
        let at = [13.45 + gap * diagonal, 0.0, 30.55 - gap * diagonal];
        let part = block([at[0], -1.0, 20.0], [at[0] + 5.0, 1.0, at[2]]);
        let mut certifier = certifier_with(&part, "BallEr16", &[("nut.nut", -0.5)]);
        assert_eq!(certifier.check_pose(&pose([0.0; 3], UP)) == PoseVerdict::Clear, clear, "{gap}");
    }
}

#[test]
fn a_level_face_alone_keeps_its_margin() {
    for (tip, clear) in [(0.4, false), (0.6, true), (0.5 + 1e-9, true), (0.5 - 1e-9, false)] {
        let mut certifier = certifier_with(&plate(), "Flat", &[("face", -0.5)]);
        let end_pose = pose([1.0, 2.0, tip], UP);
        let verdict = certifier.check_pose(&end_pose);
        assert_eq!(verdict == PoseVerdict::Clear, clear, "{tip}: {verdict:?}");
        for from in [[-60.0, 2.0, tip], [1.0, 2.0, 30.0]] {
            let path = motion(&pose(from, UP), &end_pose);
            let verdict = certifier.check_motion(&path, 0.0);
            assert_eq!(verdict == MotionVerdict::Clear, clear, "{tip}: {verdict:?}");
        }
        // A part inside the middle of the tool, with depth allowed for the flute.
        let inside = block([-1.0, -1.0, tip], [1.0, 1.0, 5.0]);
        let allowed = [("face", -0.5), ("flute", f64::INFINITY), ("shank", f64::INFINITY)];
        let mut certifier = certifier_with(&inside, "Flat", &allowed);
        // The face is the nearest surface here, and it must not be in the part at all.
        let verdict = certifier.check_pose(&pose([0.0; 3], UP));
        assert!(matches!(verdict, PoseVerdict::Touching(_)), "{tip}: {verdict:?}");
        let above = block([5.8, -0.1, tip], [5.9, 0.1, 5.0]);
        let mut certifier = certifier_with(&above, "Flat", &allowed);
        let verdict = certifier.check_pose(&pose([0.0; 3], UP));
        assert_eq!(verdict.is_clear(), clear, "{tip}: {verdict:?}");
        let path = motion(&pose([0.0; 3], UP), &pose([0.0; 3], UP));
        let verdict = certifier.check_motion(&path, 0.0);
        assert_eq!(verdict == MotionVerdict::Clear, clear, "{tip}: {verdict:?}");
    }
}

#[test]
fn allowances_of_all_surfaces_permit_depth_or_require_a_margin() {
    let deep = pose([0.0, 0.0, -5.0], UP);
    for (allowed, clear) in [(f64::INFINITY, true), (5.1, true), (4.9, false), (-1.0, false)] {
        let all = ["face", "flute", "shank"].map(|name| (name, allowed));
        let mut certifier = certifier_with(&plate(), "Flat", &all);
        let verdict = certifier.check_pose(&deep);
        assert_eq!(matches!(verdict, PoseVerdict::Touching(_)), !clear, "{allowed}: {verdict:?}");
        let high = certifier.check_pose(&pose([0.0, 0.0, 1.0 + 1e-6], UP));
        assert_eq!(high, PoseVerdict::Clear, "{allowed}");
        let path = motion(&deep, &pose([3.0, 0.0, -5.0], UP));
        let verdict = certifier.check_motion(&path, 0.0);
        let is_touching = matches!(verdict, MotionVerdict::Touching(..));
        assert_eq!(is_touching, !clear, "{allowed}: {verdict:?}");
    }
}

#[test]
fn rejects_unknown_surfaces_and_allowances_without_length() {
    let error_of = |surface: &str, allowed: f64| {
        certifier(&plate(), "Flat").with_allowance(surface, allowed).expect_err("no allowance")
    };
    let known = "`face`, `flute`, `shank`".to_owned();
    let expected =
        AllowanceError::NoSurface { tool: "Flat".into(), surface: "flank".into(), known };
    assert_eq!(error_of("flank", 1.0), expected);
    let text = "Flat has no surface `flank`; it has `face`, `flute`, `shank`";
    assert_eq!(expected.to_string(), text);
    for (allowed, word) in [(f64::NAN, "NaN"), (f64::NEG_INFINITY, "-inf")] {
        let (text, start) = (error_of("flute", allowed).to_string(), "an allowance of");
        assert!(text.starts_with(&format!("{start} {word} for `flute` is not a length")), "{text}");
    }
}

/// The corner that the neck shares with the surface below owns points at the flute's heights, but not points of the
/// flute: a part that touches the flute does not touch the neck.
#[test]
fn contact_with_the_flute_does_not_touch_the_neck() {
    for step in -40..=40 {
        let wall = block([8.25 + f64::from(step) * 1e-13, -20.0, 0.5], [30.0, 20.0, 2.5]);
        let mut certifier = certifier_with(&wall, "Woodruff", &[("flute", 0.01)]);
        let clear = certifier.check_pose(&pose([0.0; 3], UP));
        assert!(matches!(clear, PoseVerdict::Clear), "{step}: {clear:?}");
    }
}

/// The part is beside the shank and far from the face, which the first box tells: no triangle needs to be examined.
#[test]
fn a_margin_is_kept_from_a_part_beside_another_surface() {
    let ball = shapes::sphere(8.0, 5, Unit::Millimetre).expect("a sphere");
    let all = [("face", -0.5), ("flute", f64::INFINITY), ("shank", f64::INFINITY)];
    let mut certifier = certifier_with(&ball, "Flat", &all).with_budget(100);
    assert_eq!(certifier.check_pose(&pose([14.1, 0.0, -50.0], UP)), PoseVerdict::Clear);
}
