//! How far rounding takes what is computed in doubles.
//!
//! `ε = 2⁻⁵²`, and `u` is half of it, `S` how far the tool and the circles of its arcs reach, along the axis or away from it, `P` the
//! largest extent of the part, both in the tool's unit. No place of the tool is farther than `√2 S` from its tip. Poses and meshes are taken as given: their doubles are exact. Only triangles that
//! reach the tool count, so that no corner is farther from the tip than `M = √2 S + √3 P`, and no edge longer
//! than `W = √3 P`. Sums of three products err by 3u of the sum of their sizes (Higham, *Accuracy and
//! Stability of Numerical Algorithms*, 2002, section 3.1), and a rotation whose rows are taken as positive
//! is no longer than √3.
//!
//! | what | errs by |
//! |---|--:|
//! | a corner from the tip: three differences | 1 uM |
//! | the factors of the rotation by the unit of length: 2u each | 4 uM |
//! | the rotation: `RᵀR` is the identity to 6u in each entry ([`Pose`](crate::Pose) derives it), so it is within 9u of one | 9 uM |
//! | its product with the corner: three sums of three products | 6 uM |
//! | **a corner in the tool's frame** | **20 uM** |
//! | an edge from its corners, and the place on it at `t ≤ 1` | 2 uW + 1 uM |
//! | its parts along and across the way that it goes on the level | 7 uM |
//! | how far it has gone there, and its distance from the axis | 3 uW + 3 uM |
//! | the height at which it is cut | 4 uM |
//! | **a place of an edge in the half plane, beside that of the true edge** | **15 uM + 5 uW** |
//! | a tangent of the hyperbola: it is one at a place 2 uM beside, with a slope that errs by 4u | 8 uM |
//! | the meridian's base and way, given the normal, and where it is cut | 18 uM |
//! | a piece of the profile, whose ends, centre and radius are doubles | 4 uS |
//! | the distance from it | 14 uS |
//!
//! A triangle whose corners are moved has every place moved by no more than these, and depth changes by no
//! more than the way. An upper bound has all of these errors, `61 uM + 5 uW + 18 uS`, which is less than
//! `105 uS + 115 uP`. [`place`] allows 128 u for both.
//!
//! **Motions.** A motion turns by the exact fraction of its stored angle, from the rotation nearest to its stored start. By norms: a
//! matrix whose `RᵀR` is the identity to 6u in each entry (every start, frame and pose) is within 9u of a rotation; an
//! angle of less than half a turn, rounded, with its sine and cosine adds 5u, columns that are sums of two products 4u, and the
//! step toward the nearest rotation 7u of its own. That is 25 uM, less than `36 uS + 44 uP`: half of [`place`], which has 128 u of
//! each. With spin the frame adds 9u and its product, sums of three, another 9u: 43 uM, less than `61 uS + 75 uP`. A whole [`place`] is allowed
//! for that.
//!
//! **Meridians.** The cross product of two edges `e` and `f` errs by 6u of `|e| |f|`. Of the two shorter
//! edges that is no more than the shortest, `s`, times the longest; so the normal is off by an angle
//! `η ≤ 6u s / h`, where `h` is the height over the longest edge. Let `x` be a place of the true meridian at
//! the distance `d` from the axis, and let the triangle be inclined by `θ`. The azimuth of the normal is off
//! by `η / sin θ`. If `sin θ ≥ 1/2`, the plane through the axis at the wrong azimuth passes `x` at `2 η d`.
//! If not, `x` turned about the axis to that azimuth stays at `d`, and its height in the triangle's plane
//! changes by no more than `2 tan θ · d`, and by `tan θ · d · α² / 2` after a small turn `α`: in all by `2 η d` at
//! most. If it leaves the triangle meanwhile, it does so through an edge, on which depth is looked for too. The
//! computed plane passes that place at another `2 η r`, `r` being how far corners are from the tip. So some place
//! of the computed meridian or of an edge is within `4 η r` of one that is as deep as `x`, the [`skew`]; what is
//! owned within the skew is taken for owned. And no place of a triangle is farther than its
//! [`height`] from its longest edge, on which depth is looked for too: where that is less, there is no meridian.

use crate::tool::Card;

/// How far a place is known in the tool's frame, and how deep it is, beside a part whose largest extent is `part`.
pub(super) fn place(card: &Card, part: f64) -> f64 {
    let circles = card.outline.iter().filter_map(|piece| piece.circle);
    let reach = circles.map(|circle| circle.centre[0].hypot(circle.centre[1]) + circle.radius);
    64.0 * f64::EPSILON * (reach.fold(card.size(), f64::max) + part)
}

/// How much less a place so far from the tool is known: its distance in the place of `M`.
pub(super) fn far(distance: f64) -> f64 {
    64.0 * f64::EPSILON * distance
}

/// How far the meridian of a triangle can be from the true one, by the height over its longest edge, its
/// shortest edge, and how far its corners are from the tip: `4 η r` with `η ≤ 6u s / h`.
pub(super) fn skew(height: f64, shortest: f64, far: f64) -> f64 {
    12.0 * f64::EPSILON * far * (shortest / height)
}

/// How far a place of a triangle can be from its longest edge, by its height and its shortest edge: `8u s` may be
/// rounding.
pub(super) fn height(height: f64, shortest: f64) -> f64 {
    height + 4.0 * f64::EPSILON * shortest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a regular triangle skew is rounding, and so it is of a needle, whose shortest edge is as short as it is high.
    /// Of a sliver with three long edges it is more than its height.
    #[test]
    fn skew_is_that_of_the_normal() {
        assert!(skew(0.8, 1.0, 2.0) < 1e-14);
        assert!(skew(1e-8, 1e-8, 1.0) < 1e-14);
        assert!((1e-10..1e-6).contains(&skew(1e-8, 1.0, 1.0)));
        assert!(skew(1e-12, 1.0, 1.0) > height(1e-12, 1.0));
        assert!(skew(0.0, 1.0, 1.0) > height(0.0, 1.0));
    }
}
