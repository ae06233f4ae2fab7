//! A surface that crosses itself: a prism over a bow tie has material in one lobe and its opposite in the other. A tool
//! in the latter is neither inside nor outside, and no answer may take it for clear.

use crate::prelude::*;
use touchoff::certify::Containment;

use crate::supports::REGIONS;

fn bead() -> Interpreted {
    drawn("0 0; bead 0 0.2 about 0 0.1", "bead")
}

/// Returns the prism, with its triangles as they are or turned over.
fn bow_tie(turned: bool) -> TriangleBvh {
    let tie = [[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 3.0]];
    let vertices = [0.0, 2.0].map(|z| tie.map(|[x, y]| Point3::new(x, y, z))).concat();
    let caps = [[1, 0, 2], [2, 0, 3], [4, 5, 6], [4, 6, 7]];
    let walls = (0..4u32).flat_map(|k| {
        let next = (k + 1) % 4;
        [[k, next, next + 4], [k, next + 4, k + 4]]
    });
    let triangles = caps.into_iter().chain(walls);
    let triangles = triangles.map(|[a, b, c]| if turned { [b, a, c] } else { [a, b, c] });
    TriangleBvh::new(&Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh"))
}

#[test]
fn a_tool_in_a_lobe_that_is_inside_out_is_undecided() {
    let tool = bead();
    let mut solids = 0;
    for turned in [false, true] {
        let bvh = bow_tie(turned);
        if !bvh.has_inside() {
            continue;
        }
        solids += 1;
        let mut certifier = Certifier::new(&bvh, &tool).expect("a profile");
        let mut found = [0, 0];
        for x in [0.5, 3.5] {
            let tip = pose([x, 1.5, 1.0], UP);
            let at_rest = motion(&tip, &tip);
            let verdict = certifier.check_pose(&tip);
            let contained = certifier.containment(&tip);
            let buried = certifier.is_buried(&tip);
            let signed = certifier.signed_distance(&tip, 1e-9);
            let moved = certifier.check_motion(&at_rest, 1e-6);
            let depth = certifier.motion_depth(SurfaceId(0), &at_rest, 0.0, 1e-6);
            let depth = depth.expect("a surface");
            assert_eq!(signed.low, f64::NEG_INFINITY);
            let is_inside = contained == Containment::Inside(SurfaceId(0));
            found[usize::from(is_inside)] += 1;
            if is_inside {
                assert_eq!(verdict, PoseVerdict::Inside(SurfaceId(0)));
                assert_eq!((buried, moved), (Some(true), MotionVerdict::Inside(SurfaceId(0))));
                assert!(depth == MotionDepth::Inside && signed.high < 0.0);
            } else {
                assert_eq!(contained, Containment::Undecided);
                assert_eq!(verdict, PoseVerdict::Undecided(0.0));
                assert_eq!((buried, moved), (None, MotionVerdict::Undecided(0.0)));
                assert!(depth == MotionDepth::Undecided(0.0) && signed.high > 0.0);
            }
        }
        assert_eq!(found, [1, 1]);
    }
    assert!(solids > 0);
}

/// Hardly any point of the shank is deeper than its allowance, and none of them is found within the budget. A rod of 2 µm about the
/// axis has all of these in it, and is thinner than the boxes in which they are sought.
#[test]
fn a_tool_of_which_no_point_is_found_is_undecided() {
    let tool: Interpreted = REGIONS.parse().expect("a tool");
    let barely = 1.0 - 1e-9;
    for (half, allowed, expected) in [
        (50.0, 0.5, PoseVerdict::Inside(SurfaceId(1))),
        (50.0, barely, PoseVerdict::Undecided(0.0)),
        (1e-3, barely, PoseVerdict::Undecided(0.0)),
        (50.0, 1.1, PoseVerdict::Clear),
    ] {
        let part = block([-half, -half, -50.0], [half, half, 50.0]);
        let mut certifier = allowing(certifier_of(&part, &tool), &tool, [f64::INFINITY, allowed]);
        let verdict = certifier.check_pose(&pose([0.0; 3], UP));
        assert_eq!(verdict, expected, "{half} {allowed}");
    }
}

/// The lower bound of a buried tool's distance from the surface is 0 within the tolerance, as in contact. Then a ball in it counts.
#[test]
fn the_signed_distance_of_a_buried_tool_is_below_0_at_any_tolerance() {
    let tool = bead();
    let mut certifier = certifier_of(&block([-5.0; 3], [5.0; 3]), &tool);
    for tolerance in [1e-9, 1e-6, 0.5, 4.0, 50.0] {
        for below in [5e-7, 0.4, 3.0] {
            let found = certifier.signed_distance(&pose([1.0, 2.0, 4.8 - below], UP), tolerance);
            assert_eq!(found.low, f64::NEG_INFINITY, "{below}, {tolerance}");
            let deepest = f64::max(below, 0.1);
            assert!((-deepest..0.0).contains(&found.high), "{below}, {tolerance}: {found:?}");
        }
        let apart = certifier.signed_distance(&pose([1.0, 2.0, 5.3], UP), tolerance);
        assert!(apart.contains(0.3) && apart.low > -0.2, "{tolerance}: {apart:?}");
    }
}
