//! Slopes on the two sides of a border, where depth is not smooth.

use super::borders::MAX_TANGENT_SLOPE;
use super::slope::Slope;
use crate::expr::interval::{Interval, ZERO};

/// The tolerance for neglected slopes, by which `c` is lowered. Niceness also counts as falling with depth if
/// the product of both gradients is at most this part of the product of their lengths.
///
/// Neglected are, at a point with an owner whose depth has a slope of at least `c`:
///
/// - on a border, a difference of two slopes up to [`SLOPE_TOLERANCE`]: a combination of them is shorter than either by
///   at most that, and by twice that where a third region lies between;
/// - on the axis, a slope away from it up to [`SLOPE_TOLERANCE`]: the remaining slope along the axis is shorter by at
///   most that;
/// - on a border of distances that is nearly smooth, the slope across it: `1 - √(1 - t²) ≤ t²`, with
///   [`MAX_TANGENT_SLOPE`] for `t`.
///
/// The sum is `3 SLOPE_TOLERANCE + t²`.
pub(super) const SLOPE_MARGIN: f64 = 1e-9;

/// The difference up to which two slopes count as equal; slopes have no unit.
pub(super) const SLOPE_TOLERANCE: f64 = 2.5e-10;

const _: () =
    assert!(3.0 * SLOPE_TOLERANCE + MAX_TANGENT_SLOPE * MAX_TANGENT_SLOPE <= SLOPE_MARGIN);

/// A bound of the error of `acos`. On common platforms it is one or two ulps of the result; no angle has a
/// larger ulp than π, 2^-51. This is four of these.
const ACOS_ERROR: f64 = 8.0 * f64::EPSILON;

/// Encloses the angle between two unit vectors, in radians.
pub(super) fn angle(a: [Interval; 3], b: [Interval; 3]) -> Interval {
    let product = (0..3).fold(ZERO, |sum, k| sum.plus(a[k].times(b[k])));
    let [low, high] = [product.high, product.low].map(|cos| cos.clamp(-1.0, 1.0).acos());
    Interval { low: (low - ACOS_ERROR).max(0.0), high: high + ACOS_ERROR }
}

/// Returns a lower bound of the rate at which depth falls toward one of the sides of a border on which two
/// depths agree, and its uncertainty.
///
/// Where each is the smaller on its own side, descents lead to both sides. Otherwise depth falls along every
/// combination of the two slopes, and therefore at least at the rate of the shortest (Clarke 1983).
pub(super) fn fall_rate_across(own: Slope, other: Slope, curve: Slope, below: bool) -> (f64, f64) {
    let products = [0, 1, 2]
        .map(|k| own.partials[k].plus(other.partials[k].negated()).times(curve.partials[k]));
    let rise = products.into_iter().fold(ZERO, Interval::plus);
    let components = [0, 1, 2].map(|k| [own.partials[k].middle(), other.partials[k].middle()]);
    let widths = own.partials.iter().chain(&other.partials).map(|part| part.high - part.low);
    let slack = widths.fold(0.0, f64::max);
    let falls = if below { rise.low } else { -rise.high };
    // The two slopes differ only along the curve's gradient, since depths agree on the curve: by -falls
    // divided by its length.
    if falls >= 0.0 || falls >= -SLOPE_TOLERANCE * curve.length.low {
        return (f64::INFINITY, 0.0);
    }
    let difference = components.map(|[a, b]| b - a);
    let [start, squared_length] = [components.map(|[a, _]| a), difference]
        .map(|v| v.iter().zip(difference).map(|(a, b)| a * b).sum::<f64>());
    let part = if squared_length > 0.0 { (-start / squared_length).clamp(0.0, 1.0) } else { 0.0 };
    let nearest = components.map(|[a, b]| a + part * (b - a));
    // Each component is known to half its width, and the vector to √3 times that.
    let shortest = nearest.iter().map(|part| part * part).sum::<f64>().sqrt() - slack;
    (shortest.min(shortest_along(nearest, [own, other])), slack)
}

/// Returns a lower bound of the length of any combination of slopes, from their components along a direction.
/// The bound holds for any direction, so rounding in its choice does no harm.
fn shortest_along(direction: [f64; 3], slopes: [Slope; 2]) -> f64 {
    let direction = direction.map(|part| Interval::new(part, part));
    let squares = direction.map(Interval::square);
    let per_length = squares.into_iter().fold(ZERO, Interval::plus).sqrt().reciprocal();
    let component = |slope: Slope| {
        let parts = [0, 1, 2].map(|k| slope.partials[k].times(direction[k]));
        parts.into_iter().fold(ZERO, Interval::plus).times(per_length).low
    };
    slopes.map(component).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::slope::Slopes;
    use super::*;
    use crate::domain::Domain;
    use crate::expr::interval::Cell;
    use crate::expr::{Coord, Graph};
    use crate::number::Number;

    /// Two depths whose slopes differ by 2e-7 along z, and a curve whose gradient is a thousand times smaller
    /// where it points along z than elsewhere in the box. Each depth is the smaller on the other's side, and
    /// the shortest combination counts.
    #[test]
    fn slopes_are_compared_by_the_flattest_part_of_a_curve() {
        let mut graph = Graph::default();
        let mut number = |text: &str| graph.number(Number::parse_decimal(text).expect("a number"));
        let [less, more, flat] = ["0.9999999", "1.0000001", "0.001"].map(&mut number);
        let [d, z] = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
        let [own, other, linear_part] = [less, more, flat].map(|factor| graph.mul(factor, z));
        let square = graph.mul(d, d);
        let curve = graph.add(square, linear_part);
        let mut slopes = Slopes::new(&graph, Domain::HalfPlane, [own, other, curve]);
        slopes.set(Cell::half_plane(Interval::new(0.0, 1.0), Interval::new(-1.0, 1.0)));
        let [own, other, curve] = [own, other, curve].map(|id| slopes.get(id));
        let (fall, _) = fall_rate_across(own, other, curve, true);
        assert!((0.99..1.0).contains(&fall), "{fall}");
        // With the sides exchanged each is the smaller on its own.
        assert_eq!(fall_rate_across(own, other, curve, false).0, f64::INFINITY);
    }
}
