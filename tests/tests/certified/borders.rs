//! Corners at the height at which one surface ends and the next begins: rounding puts each on either side, and its depth
//! counts for the surface to which it is exactly the nearest.

use crate::prelude::*;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::space::{Frame, Triple, exactly};

const RADIUS: f64 = 5.0;
/// The height of the border.
const BORDER: f64 = 10.0;

pub(crate) fn pin() -> Interpreted {
    drawn("0 0; face 5 0; lower 5 10; upper 5 20; top 0 20", "lower")
}

/// Returns a point of the world in the tool's frame.
pub(crate) fn in_tool(pose: &Pose, point: Point3<f64>) -> Triple {
    Frame::new(pose.rotation(), pose.tip()).to_tool(&exactly(point))
}

/// Triangles all of whose corners are at the border as nearly as doubles can be.
#[test]
fn a_corner_at_the_border_counts_for_the_surface_that_is_exactly_nearest() {
    let tool = pin();
    let [lower, upper] =
        ["lower", "upper"].map(|name| tool.info().surface_named(name).expect("a surface"));
    let mut rng = Rng::new(1);
    let mut owned = [0, 0];
    for round in 0..120 {
        let size = [1.0, 1e2, 1e4, 1e6][round % 4];
        let tip = Point3::from(size * Vector3::from(rng.direction()));
        let pose = Pose::from_axis(tip, Vector3::from(rng.direction())).expect("an axis");
        let corners = [[3.0, 0.0], [3.5, 0.3], [3.5, -0.3]]
            .map(|[x, y]| tip + pose.rotation() * Vector3::new(x, y, BORDER));
        let part = soup(&[corners.map(Into::into)]);
        let mut certifier = certifier_of(&part, &tool);
        let depths = [lower, upper].map(|surface| {
            certifier.deepest_on(surface, &pose, 0.0).expect("a surface").depth.high
        });
        for corner in corners {
            let [x, y, z] = in_tool(&pose, corner);
            let depth = &Big::exactly(RADIUS) - &(&(&x * &x) + &(&y * &y)).sqrt();
            let owner = usize::from(z > Big::exactly(BORDER));
            owned[owner] += 1;
            let (deep, above) = (depth.to_f64(), (&z - &Big::exactly(BORDER)).to_f64());
            let text = format!("{deep:e} over {depths:?}, {above:e} above the border, {pose:?}");
            assert!(depth <= Big::exactly(depths[owner]), "surface {owner}: {text}");
        }
        // The lesser of two allowances holds at the border.
        for (strict, other) in [("lower", "upper"), ("upper", "lower")] {
            let all = [("face", 9.0), ("top", 9.0), (strict, 1.0), (other, 9.0)];
            let certifier = certifier_of(&part, &tool).with_allowances(all);
            let owner = usize::from(strict == "upper");
            let is_owned = corners.iter().any(|corner| {
                let [_, _, z] = in_tool(&pose, *corner);
                usize::from(z > Big::exactly(BORDER)) == owner
            });
            let verdict = certifier.expect("surfaces").check_pose(&pose);
            // The triangle is no solid, so that no pose is clear of more than its surface.
            assert!(!is_owned || verdict != PoseVerdict::SurfaceOnly, "{strict}: {verdict:?}");
        }
    }
    assert!(owned[0] > 60 && owned[1] > 60, "{owned:?}");
}

/// A plate whose face is at the end of the tool: no point of it is deeper than rounding, and none is missed.
#[test]
fn a_corner_at_the_end_of_a_tool_is_within_rounding_of_its_surface() {
    let tool = pin();
    let mut rng = Rng::new(2);
    for round in 0..200 {
        let size = [1.0, 1e2, 1e4, 1e6][round % 4];
        let tip = Point3::from(size * Vector3::from(rng.direction()));
        let pose = Pose::from_axis(tip, Vector3::from(rng.direction())).expect("an axis");
        let corners = [[0.1, 0.0], [2.5, 0.3], [2.5, -0.3]]
            .map(|[x, y]| tip + pose.rotation() * Vector3::new(x, y, 2.0 * BORDER));
        let mut certifier = certifier_of(&soup(&[corners.map(Into::into)]), &tool);
        let found = certifier.deepest(&pose, 0.0).depth;
        // Depth is the distance from the plane of the end, so near to it.
        let mut deepest = Big::zero();
        for corner in corners {
            let [_, _, z] = in_tool(&pose, corner);
            let depth = &Big::exactly(2.0 * BORDER) - &z;
            if depth > deepest {
                deepest = depth;
            }
        }
        let is_within = Big::exactly(found.low) <= deepest && deepest <= Big::exactly(found.high);
        assert!(is_within, "{:e} in {found:?} at {pose:?}", deepest.to_f64());
    }
}

/// An edge just above the end of a tool, which counts for its slab within rounding, is not in the tool.
#[test]
fn an_edge_above_the_end_of_a_tool_is_not_deep() {
    let tool = pin();
    let mut rng = Rng::new(3);
    for _ in 0..400 {
        let [x, y] = [rng.between(0.5, 4.0), rng.between(-2.0, 2.0)];
        let [from, to] = [rng.between(0.0, 1e-12), rng.between(0.01, 1.0)]
            .map(|above| [x, y, 2.0 * BORDER + above]);
        // With edges below the tool, the box of all is as deep as the tool. The triangle with area is in a leaf of its own.
        let below = [[9.0, 0.0, -5.0], [9.0, 0.0, -4.0], [9.0, 0.0, -5.0]];
        let beside = [[60.0, 0.0, 5.0], [61.0, 0.0, 5.0], [60.0, 0.5, 5.0]];
        let edges = [[from, to, from], below].map(|edge| vec![edge; 8]).concat();
        let certifier = certifier_of(&soup(&[edges, vec![beside]].concat()), &tool);
        let mut certifier = certifier.with_level(Level::baseline());
        let found = certifier.deepest(&Pose::default(), 0.0).depth;
        assert!(found.low == 0.0 && found.high < 1e-11, "{found:?}: {from:?} to {to:?}");
    }
}
