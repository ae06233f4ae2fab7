//! Branch and bound for the largest of the thesis's magnitudes on a part's triangles: the peers' reference.

use super::formula;
use crate::race::contender::View;
use nalgebra::{Point3, Vector3};
use touchoff::{Mesh, Pose, TriangleId};

/// Tolerance of the result, mm.
pub const TOLERANCE: f64 = 1e-6;

/// Returns the largest magnitude on the part's triangles, to [`TOLERANCE`]. `best` is a magnitude known to be attained.
pub fn deepest(mesh: &Mesh, pose: &Pose, mut best: f64) -> f64 {
    let view = View::of(pose);
    let turn = |p: Point3<f64>| Vector3::from(view.turn(view.arm(p.coords.into())));
    let all = 0..mesh.triangles().len() as u32;
    let mut left: Vec<_> = all.map(|id| mesh.triangle(TriangleId(id)).map(turn)).collect();
    while let Some([a, b, c]) = left.pop() {
        let (here, most) = bound([a, b, c]);
        best = best.max(here);
        if most <= best + TOLERANCE {
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
        let middle = 0.5 * (p + q);
        left.extend([[p, middle, r], [middle, q, r]]);
    }
    best
}

/// Returns the magnitude at a triangle's centre, and an upper bound of the magnitude on the triangle. The magnitude is
/// the largest of concave functions, none of which exceeds its tangent at the centre.
fn bound(corners: [Vector3<f64>; 3]) -> (f64, f64) {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let d = centre.x.hypot(centre.y);
    let radial = if d > 0.0 { [centre.x / d, centre.y / d] } else { [0.0; 2] };
    let pieces = formula::pieces(d, formula::TIP - centre.z);
    let most = |(value, [by_d, by_z]): (f64, [f64; 2])| {
        let slope = Vector3::new(by_d * radial[0], by_d * radial[1], -by_z);
        let rise = corners.map(|corner| slope.dot(&(corner - centre)));
        value + rise.into_iter().fold(0.0, f64::max)
    };
    let largest = |values: [f64; 5]| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (largest(pieces.map(|(value, _)| value)), largest(pieces.map(most)))
}
