//! Branch and bound for the largest of the thesis's magnitudes on a part's triangles: the peers' reference.

use super::formula;
use crate::race::contender::PoseTransform;
use nalgebra::{Point3, Vector3};
use touchoff::{Mesh, Pose, TriangleId};

/// Tolerance of the result, mm.
pub const TOLERANCE: f64 = 1e-6;

/// Returns the largest magnitude on the part's triangles, to [`TOLERANCE`]. `best` is a magnitude known to be attained.
pub fn deepest(mesh: &Mesh, pose: &Pose, mut best: f64) -> f64 {
    let transform = PoseTransform::of(pose);
    let to_tool = |p: Point3<f64>| {
        Vector3::from(transform.to_tool_frame(transform.offset_from_tip(p.coords.into())))
    };
    let ids = 0..mesh.triangles().len() as u32;
    let mut pending: Vec<_> = ids.map(|id| mesh.triangle(TriangleId(id)).map(to_tool)).collect();
    while let Some([a, b, c]) = pending.pop() {
        let (value, upper_bound) = bound_on_triangle([a, b, c]);
        best = best.max(value);
        if upper_bound <= best + TOLERANCE {
            continue;
        }
        // Bisect across the longest edge.
        let [ab, bc, ca] = [b - a, c - b, a - c].map(|edge| edge.norm_squared());
        let (p, q, r) = if ab >= bc && ab >= ca {
            (a, b, c)
        } else if bc >= ca {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let midpoint = 0.5 * (p + q);
        pending.extend([[p, midpoint, r], [midpoint, q, r]]);
    }
    best
}

/// Returns the magnitude at a triangle's centre, and an upper bound of the magnitude on the triangle. The magnitude is
/// the largest of concave functions, none of which exceeds its tangent at the centre.
fn bound_on_triangle(corners: [Vector3<f64>; 3]) -> (f64, f64) {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let d = centre.x.hypot(centre.y);
    let radial = if d > 0.0 { [centre.x / d, centre.y / d] } else { [0.0; 2] };
    let functions = formula::concave_pieces(d, formula::TIP - centre.z);
    let max_on_triangle = |(value, [by_d, by_z]): (f64, [f64; 2])| {
        let slope = Vector3::new(by_d * radial[0], by_d * radial[1], -by_z);
        let rise = corners.map(|corner| slope.dot(&(corner - centre)));
        value + rise.into_iter().fold(0.0, f64::max)
    };
    let largest = |values: [f64; 5]| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (largest(functions.map(|(value, _)| value)), largest(functions.map(max_on_triangle)))
}
