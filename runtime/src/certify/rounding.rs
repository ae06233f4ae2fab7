//! Rounding error bounds of the certifier's `f64` computations.
//!
//! Let `ε = 2⁻⁵²` and `u = ε/2`. `S` is the extent of the tool and of the circles of its arcs, along the axis or
//! away from it, and `P` the largest extent of the part, both in the tool's unit. No point of the tool is farther
//! than `√2 S` from its tip. Poses and meshes are taken as given: their doubles are exact. Only triangles that
//! reach the tool count, so no corner is farther from the tip than `M = √2 S + √3 P`, and no edge is longer than
//! `W = √3 P`. Sums of three products err by 3u of the sum of their magnitudes (Higham, *Accuracy and Stability
//! of Numerical Algorithms*, 2002, section 3.1). The rows of a rotation, with all entries made positive, form a
//! matrix of norm at most √3.
//!
//! | quantity | error |
//! |---|--:|
//! | a corner relative to the tip: three differences | 1 uM |
//! | the entries of the rotation divided by the unit of length: 2u each | 4 uM |
//! | the rotation: `RᵀR` is the identity to 6u per entry (see [`Pose`](crate::Pose)), hence within 9u of one | 9 uM |
//! | its product with the corner: three sums of three products | 6 uM |
//! | **a corner in the tool's frame** | **20 uM** |
//! | an edge from its corners, and the point on it at `t ≤ 1` | 2 uW + 1 uM |
//! | its components along and across its horizontal direction | 7 uM |
//! | the distance along it up to that point, and the point's distance from the axis | 3 uW + 3 uM |
//! | the height at which it is cut | 4 uM |
//! | **a point of an edge in the half plane, relative to that of the true edge** | **15 uM + 5 uW** |
//! | a tangent of the hyperbola: it is a tangent at a point 2 uM away, with a slope that errs by 4u | 8 uM |
//! | the base and the direction of the meridian, given the normal, and the points where it is cut | 18 uM |
//! | a profile segment, whose ends, centre and radius are doubles | 4 uS |
//! | the distance from it | 14 uS |
//!
//! A triangle whose corners move has all of its points moved by no more than the corners, and depth changes by no
//! more than the displacement. A plane that bounds depth only beyond its guards has the errors of a corner and of the
//! distance from a segment twice, `40 uM + 36 uS`: a point that is beyond them only by rounding is deeper by no more.
//! A plane that touches the tool has a normal whose length errs by 5u, which with the products of sums is another 8 uM,
//! and 8 uS of the tool: `28 uM + 12 uS`.
//! An upper bound along a line has all of these errors, `61 uM + 5 uW + 18 uS`, which is less than
//! `105 uS + 115 uP`. [`point_error_bound`] allows 128 u for both.
//!
//! **Motions.** A motion turns by the exact fraction of its stored angle, starting from the rotation nearest to
//! its stored start. In norms: a matrix whose `RᵀR` is the identity to 6u in each entry (every start, frame and
//! pose) is within 9u of a rotation. A rounded angle of less than half a turn, with its sine and cosine, adds 5u.
//! Columns that are sums of two products add 4u, and the step toward the nearest rotation adds 7u of its own. The
//! total is 25 uM, less than `36 uS + 44 uP`: half of [`point_error_bound`], which has 128 u of each. With spin the frame
//! adds 9u and its product, sums of three products, another 9u: 43 uM, less than `61 uS + 75 uP`. A whole
//! [`point_error_bound`] is allowed for that.
//!
//! **Meridians.** The cross product of two edges `e` and `f` errs by 6u of `|e| |f|`. For the two shorter edges that is
//! at most the shortest edge, `s`, times the longest. The normal is therefore off by an angle `η ≤ 6u s / h`, where `h`
//! is the height over the longest edge. Let `x` be a point of the true meridian at the distance `d` from the axis, and
//! let the triangle be inclined by `θ`. The azimuth of the normal is off by `η / sin θ`. If `sin θ ≥ 1/2`, the plane
//! through the axis at the wrong azimuth passes `x` at a distance of `2 η d`. If not, rotate `x` about the axis to that
//! azimuth. It stays at the distance `d`, and its height in the triangle's plane changes by at most `2 tan θ · d`, and
//! by `tan θ · d · α² / 2` after a small turn `α`: by at most `2 η d` in total. If it leaves the triangle on the way,
//! it does so through an edge, which is searched too. The computed plane passes that point at another `2 η r`, where
//! `r` is the largest distance of a corner from the tip. Some point of the computed meridian or of an edge is therefore
//! within `4 η r`, the [`skew`], of a point that is as deep as `x`. Points within the skew of an owned point count as
//! owned. No point of a triangle is farther than its height from its longest edge, which is searched too. Where the
//! height is less than the skew, no meridian is used. The computed height errs by `8u s`, less than the 18 uM that a
//! meridian would have added.
//!
//! **One budget.** `e` is [`point_error_bound`], for a point and its depth. Comparisons that are not with `e` itself are with a multiple of it:
//!
//! | multiple | what it is for |
//! |--:|---|
//! | 2 e, [`TOUCH`] | a depth certainly above a limit: its own error, and that by which slabs reach farther |
//! | 2 e, [`TIE`] | two features equally near: the errors of both distances |
//! | 4 e, [`APART`] | what no search took for a touch: a touch on either side of the limit |
//! | 8 e, [`ROOM`] | how far below a limit zones reach: two touches below it, and as much again for heights and distances |
//! | e/4, [`FRACTION`] | what rounding may add to a distance without being a depth: strips along seams, heights that count as one |
//! | 8 e, [`MERGED_CELL`] | the least cell in which two features that meet nearly in line may count as one |
//! | e/32, [`PEAK_CELL`] | the size at which a cell counts as one point |
//! | e/64, [`PEAK_TIE`] | two features equally near in cells as small as that |

use crate::tool::ToolInfo;

/// Multiples of [`point_error_bound`]; the table above derives them.
pub(super) const TOUCH: f64 = 2.0;
pub(super) const TIE: f64 = 2.0;
pub(super) const APART: f64 = 2.0 * TOUCH;
pub(super) const ROOM: f64 = 4.0 * TOUCH;
pub(super) const FRACTION: f64 = 0.25;
pub(super) const MERGED_CELL: f64 = 8.0;
pub(super) const PEAK_CELL: f64 = 1.0 / 32.0;
pub(super) const PEAK_TIE: f64 = 1.0 / 64.0;

/// Returns the error bound of a point's coordinates in the tool's frame and of its depth, in the tool's unit.
/// `part` is the largest extent of the part in that unit.
pub(super) fn point_error_bound(info: &ToolInfo, part: f64) -> f64 {
    let circles = info.outline.iter().filter_map(|piece| piece.circle);
    let reach = circles.map(|circle| circle.centre[0].hypot(circle.centre[1]) + circle.radius);
    64.0 * f64::EPSILON * (reach.fold(info.size(), f64::max) + part)
}

/// Returns the additional error bound of a point at this distance from the tool: the distance takes the place of
/// `M`. It may be a maximum norm: `61 u` times √3 is less than the `128 u` allowed.
pub(super) fn distance_error_bound(distance: f64) -> f64 {
    64.0 * f64::EPSILON * distance
}

/// Returns the largest distance between the computed and the true meridian of a triangle: `4 η r` with
/// `η ≤ 6u s / h`. The arguments are the height over the longest edge, the shortest edge, and the largest
/// distance of a corner from the tip.
pub(super) fn skew(height: f64, shortest: f64, far: f64) -> f64 {
    12.0 * f64::EPSILON * far * (shortest / height)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The skew of a regular triangle is of the order of rounding. So is that of a needle, whose shortest edge is as
    /// short as its height. The skew of a sliver with three long edges exceeds its height.
    #[test]
    fn skew_is_that_of_the_normal() {
        assert!(skew(0.8, 1.0, 2.0) < 1e-14);
        assert!(skew(1e-8, 1e-8, 1.0) < 1e-14);
        assert!((1e-10..1e-6).contains(&skew(1e-8, 1.0, 1.0)));
        assert!(skew(1e-12, 1.0, 1.0) > 1e-12);
        assert!(skew(0.0, 1.0, 1.0) > 0.0);
    }
}
