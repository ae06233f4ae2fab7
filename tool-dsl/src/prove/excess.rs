//! The largest excess of one distance over another, over the whole plane or space.
//!
//! The bounds follow from `|p - a| + |p - b| ≥ |a - b| ≥ |p - a| - |p - b|`. Along any path from a point, a
//! linear function with a gradient of length 1 grows by at most the distance from that point.

use super::root::RootForm;
use crate::expr::Coord;
use crate::expr::polynomial::monomial_of;
use crate::number::{Number, ROUNDING};

/// `sign · |p - centre| + rest`
struct FromPoint {
    sign: i64,
    centre: [Number; 3],
    rest: Number,
}

impl FromPoint {
    fn of(depth: &RootForm) -> Option<FromPoint> {
        let root = depth.root().filter(|_| depth.is_distance())?;
        let half = |coord| &root.radicand.exact_factor(monomial_of(coord)) / &Number::int(-2);
        // The half plane has D and Z, space has the other three; an absent coordinate is 0.
        let radial = half(Coord::D);
        let [x, y, z] = [Coord::X, Coord::Y, Coord::Z].map(half);
        let first = if radial.is_zero() { x } else { radial };
        Some(FromPoint {
            sign: if root.factor.is_negative() { -1 } else { 1 },
            centre: [first, y, z],
            rest: depth.part().exact_factor([0; 4]),
        })
    }

    fn distance(&self, other: &FromPoint) -> Option<Number> {
        let squares = self.centre.iter().zip(&other.centre).map(|(a, b)| &(a - b) * &(a - b));
        squares.fold(Number::int(0), |sum, square| &sum + &square).sqrt()
    }
}

/// Returns the terms of a linear function's value at a point.
fn linear_at(depth: &RootForm, [first, y, z]: &[Number; 3]) -> [Number; 5] {
    let term = |coord, value: &Number| &depth.part().exact_factor(monomial_of(coord)) * value;
    let rest = depth.part().exact_factor([0; 4]);
    [rest, term(Coord::D, first), term(Coord::X, first), term(Coord::Y, y), term(Coord::Z, z)]
}

/// Returns an upper bound of `a - b` everywhere, if one can be proved; 0 if it is not positive.
pub(super) fn excess(a: &RootForm, b: &RootForm) -> Option<f64> {
    if !a.is_distance() || !b.is_distance() {
        return None;
    }
    // A linear function minus a distance from a point is largest at that point. So is the negative of a
    // distance minus a linear function.
    let terms: Vec<Number> = match (FromPoint::of(a), FromPoint::of(b)) {
        (None, Some(b)) if b.sign > 0 => {
            linear_at(a, &b.centre).into_iter().chain([-&b.rest]).collect()
        }
        (Some(a), None) if a.sign < 0 => {
            linear_at(b, &a.centre).map(|term| -&term).into_iter().chain([a.rest]).collect()
        }
        (Some(a), Some(b)) => {
            let distance = a.distance(&b)?;
            let signed = match (a.sign, b.sign) {
                (-1, 1) => -&distance,
                (1, 1) | (-1, -1) => distance,
                _ => return None,
            };
            vec![a.rest, -&b.rest, signed]
        }
        _ => return None,
    };
    let (max_excess, size) = Number::sum(&terms);
    let max_excess = max_excess.to_f64();
    Some(if max_excess <= ROUNDING * size { 0.0 } else { max_excess.next_up() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::polynomial::Polynomial;

    /// A distance in the half plane: from a point, with a sign and a constant, or along a unit vector.
    #[derive(Clone, Copy)]
    enum Distance {
        Point(i64, [f64; 2], f64),
        Line([f64; 2], f64),
    }

    impl Distance {
        fn form(self) -> RootForm {
            let number = |value: f64| Number::from_f64(value).expect("finite");
            let [d, z] = [Coord::D, Coord::Z].map(Polynomial::coordinate);
            match self {
                Distance::Line([x, y], rest) => RootForm::from_polynomial(
                    &d.scaled(&number(x))
                        .plus(&z.scaled(&number(y)))
                        .plus(&Polynomial::from_constant(&number(rest))),
                ),
                Distance::Point(sign, point, rest) => {
                    let rest = Polynomial::from_constant(&number(rest));
                    let under = Polynomial::squared_distance(&point.map(number));
                    RootForm::new(rest, Number::int(sign), under)
                }
            }
        }

        fn value_at(self, [d, z]: [f64; 2]) -> f64 {
            match self {
                Distance::Line([x, y], rest) => x * d + y * z + rest,
                Distance::Point(sign, point, rest) => {
                    sign as f64 * (d - point[0]).hypot(z - point[1]) + rest
                }
            }
        }
    }

    #[test]
    fn the_bound_holds_on_a_grid_and_is_nearly_attained() {
        let [a, b] = [[1.0, 2.0], [4.0, -2.0]];
        let distances = [
            Distance::Point(1, a, -0.5),
            Distance::Point(-1, a, 3.0),
            Distance::Point(1, b, 1.0),
            Distance::Point(-1, b, 2.0),
            Distance::Line([0.0, 1.0], -1.0),
            Distance::Line([-1.0, 0.0], 2.5),
        ];
        let mut bounded = 0;
        for less in distances {
            for more in distances {
                let Some(max_excess) = excess(&less.form(), &more.form()) else { continue };
                bounded += 1;
                let mut largest = 0.0f64;
                for k in 0..400 * 400 {
                    let point = [k % 400, k / 400].map(|k| f64::from(k) * 0.05 - 10.0);
                    largest = largest.max(less.value_at(point) - more.value_at(point));
                }
                // On the line through both points, far away, differences of distances are largest.
                for t in [-1e6, -2.0, 0.0, 0.5, 1.0, 2.0, 1e6] {
                    let point = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
                    largest = largest.max(less.value_at(point) - more.value_at(point));
                }
                assert!(largest <= max_excess + 1e-9, "{largest} of {max_excess}");
                assert!(largest >= max_excess - 0.1, "{largest} of {max_excess}");
            }
        }
        // Twelve pairs of points, and pairs of a line and a point in both orders.
        assert_eq!(bounded, 12 + 4 + 4);
    }
}
