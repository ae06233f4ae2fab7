//! Bounds of the difference of two distances: everywhere, and on a straight border.
//!
//! *Everywhere*, over the plane or space, they follow from `|p - a| + |p - b| ≥ |a - b| ≥ |p - a| - |p - b|`.
//! Along any path from a point, a linear function with a gradient of length 1 grows by at most the distance
//! from that point.
//!
//! *On a straight border* where a profile is smooth, depths agree up to rounding: lines and arcs whose ends were
//! written with the digits of a double are not exactly tangent. The difference is affine along the line, up to that.

use super::root::{RootForm, RootTerm};
use crate::expr::Coord;
use crate::expr::interval::{Cell, Interval};
use crate::expr::polynomial::{Monomial, Polynomial, monomial_of};
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
                // A sum of two distances grows without bound.
                _ => return None,
            };
            vec![a.rest, -&b.rest, signed]
        }
        _ => return None,
    };
    // The terms may cancel, as for a circle within another that it touches. What then remains is rounding.
    let (max_excess, size) = Number::sum(&terms);
    let max_excess = max_excess.to_f64();
    Some(if max_excess <= ROUNDING * size { 0.0 } else { max_excess.next_up() })
}

/// The difference of two depths on a straight line, whose points are identified by one coordinate.
#[derive(Clone, Debug)]
pub(super) struct Tangency {
    /// The coordinate's index in a point.
    axis: usize,
    /// The affine part `slope · t + rest`, without roots.
    slope: Number,
    rest: Number,
    roots: Vec<Root>,
    /// For each combination of roots before whose feet a point may be, as bits: the affine part with these
    /// roots in place of their distances from the feet.
    affine: Vec<[Interval; 2]>,
    /// The largest slope of a depth across the line, without roots.
    slope_across: f64,
    /// The radicands of two roots with the same factor, if the difference consists of these alone, and their
    /// difference.
    radicands: Option<[Polynomial; 3]>,
}

/// `factor · √((t - foot)² + (distance/scale)²)`, which differs from `factor · |t - foot|` by at most
/// `factor · distance/scale`.
#[derive(Clone, Debug)]
struct Root {
    factor: Number,
    foot: Number,
    enclosed_foot: Interval,
    /// The distance of the root's point from the line.
    distance: f64,
    /// The length along the line per unit of its coordinate.
    scale: f64,
}

/// The difference of two depths on a line in a box.
#[derive(Clone, Copy)]
pub(super) struct DepthDifference {
    /// An upper bound of the difference.
    pub(super) jump: f64,
    /// The largest slope of one of them across the line.
    pub(super) slope_across: f64,
}

impl Tangency {
    /// Returns the difference of two depths on a line; `None` unless both are linear functions or distances
    /// from points of the half plane.
    pub(super) fn of(a: &RootForm, b: &RootForm, line: &Polynomial) -> Option<Tangency> {
        if !line.is_linear() {
            return None;
        }
        let axis_and_monomial =
            [(0, Coord::D), (2, Coord::Z)].into_iter().find_map(|(axis, coord)| {
                let monomial_of_axis = monomial_of(coord);
                // The coordinate is free if the line's equation, solved for one of the two, leaves it.
                let remainder =
                    Polynomial::from_constant(&Number::int(1)).plus(&Polynomial::coordinate(coord));
                let is_free = remainder
                    .on_line(line)?
                    .terms()
                    .any(|(monomial, _)| monomial == monomial_of_axis);
                is_free.then_some((axis, monomial_of_axis))
            });
        let (axis, only) = axis_and_monomial?;
        let mut tangency = Tangency {
            axis,
            slope: Number::int(0),
            rest: Number::int(0),
            roots: Vec::new(),
            affine: Vec::new(),
            slope_across: 0.0,
            radicands: None,
        };
        tangency.add(a, false, line, only)?;
        tangency.add(b, true, line, only)?;
        if let (Some(of_a), Some(of_b)) = (a.root(), b.root())
            && of_a.factor.nearly_equals(&of_b.factor)
            && tangency.rest.is_zero()
        {
            // The difference is then that of the roots alone, which `by_roots` bounds.
            let [p, q] = [of_a.radicand.on_line(line)?, of_b.radicand.on_line(line)?];
            let difference = p.clone().plus(&q.scaled(&Number::int(-1)));
            tangency.radicands = Some([p, q, difference]);
        }
        let combinations = 0..1 << tangency.roots.len();
        tangency.affine = combinations.map(|before| tangency.affine_before(before)).collect();
        Some(tangency)
    }

    fn add(
        &mut self,
        depth: &RootForm,
        is_subtracted: bool,
        line: &Polynomial,
        monomial_of_axis: Monomial,
    ) -> Option<()> {
        if !depth.is_distance() {
            return None;
        }
        let signed = |n: Number| if is_subtracted { -&n } else { n };
        let [rest, slope, square] = coefficients(&depth.part().on_line(line)?, monomial_of_axis)?;
        // The part without the root is linear for a distance.
        if !square.is_zero() {
            return None;
        }
        self.slope = &self.slope + &signed(slope);
        self.rest = &self.rest + &signed(rest);
        let Some(RootTerm { factor, radicand }) = depth.root() else {
            // The depth's slope across the line is its product with the line's unit normal.
            let size = line.slope_squared()?.to_f64().sqrt();
            let slopes = [Coord::D, Coord::Z].map(|coord| {
                let by = monomial_of(coord);
                depth.part().factor(by) * line.factor(by)
            });
            // With unit roundoff u, each product has an error of 3u, and their sum, the root and the quotient
            // of u each: 6u in total, relative to a product of lengths that is the line's.
            let slope_across = (slopes[0] + slopes[1]).abs() / size + 4.0 * f64::EPSILON;
            self.slope_across = self.slope_across.max(slope_across);
            return Some(());
        };
        let [rest, slope, square] = coefficients(&radicand.on_line(line)?, monomial_of_axis)?;
        // With `square · t² + slope · t + rest`, this is the least value's place, and what is left over is the
        // squared distance from the line.
        let foot = -&slope.checked_div(&(&Number::int(2) * &square))?;
        let squared_distance = &rest - &(&(&foot * &foot) * &square);
        let scale = square.sqrt()?;
        self.roots.push(Root {
            factor: signed(factor * &scale),
            enclosed_foot: Interval::enclosing(&foot),
            foot,
            // Rounding may make a square of 0 negative.
            distance: squared_distance.to_f64().max(0.0).sqrt().next_up(),
            scale: scale.to_f64(),
        });
        Some(())
    }

    /// Returns the difference of the two depths on the line in a box; `None` if a root's foot may be there
    /// and the radicands give no bound.
    pub(super) fn over_box(&self, cell: &Cell) -> Option<DepthDifference> {
        let [by_feet, by_roots] = [self.by_feet(cell), self.by_roots(cell)];
        match (by_feet, by_roots) {
            (Some(a), Some(b)) => Some(if a.jump <= b.jump { a } else { b }),
            (one, other) => one.or(other),
        }
    }

    /// `|√P - √Q| = |P - Q| / (√P + √Q)`
    fn by_roots(&self, cell: &Cell) -> Option<DepthDifference> {
        let [p, q, difference] = self.radicands.as_ref()?;
        let difference = difference.over(cell).abs();
        let lengths = p.over(cell).sqrt().plus(q.over(cell).sqrt());
        // At a common foot both roots are 0, and the quotient says nothing.
        (lengths.low > 0.0).then(|| DepthDifference {
            jump: difference.times(lengths.reciprocal()).high,
            // No slope of a distance is more than 1.
            slope_across: 1.0,
        })
    }

    fn by_feet(&self, cell: &Cell) -> Option<DepthDifference> {
        let t = cell.sides[self.axis];
        let (mut error, mut slope_across) = (0.0f64, self.slope_across);
        let mut before_feet = 0;
        for (k, root) in self.roots.iter().enumerate() {
            let from_foot = t.plus(root.enclosed_foot.negated());
            // At the foot, `|t - foot|` has a kink, so the difference is not affine.
            if from_foot.low <= 0.0 && from_foot.high >= 0.0 {
                return None;
            }
            before_feet |= usize::from(from_foot.high < 0.0) << k;
            // `√(t² + e²)` differs from `|t|` by at most `e`, the distance of the root's point from the line. Twice that
            // also covers the rounding of `distance` and of the sum.
            error += 2.0 * root.distance;
            slope_across =
                slope_across.max(2.0 * root.distance / (root.scale * from_foot.abs().low));
        }
        let [slope, rest] = self.affine[before_feet];
        let affine = slope.times(t).plus(rest);
        Some(DepthDifference { jump: affine.abs().high + error, slope_across })
    }

    /// Returns the enclosures of the slope and the constant of the sum without the roots' distances, where `t`
    /// is before the feet of some roots: those of the bits that are set.
    fn affine_before(&self, before_feet: usize) -> [Interval; 2] {
        let (mut slope, mut rest) = (self.slope.clone(), self.rest.clone());
        for (k, root) in self.roots.iter().enumerate() {
            let is_before = before_feet >> k & 1 != 0;
            let factor = if is_before { -&root.factor } else { root.factor.clone() };
            rest = &rest - &(&factor * &root.foot);
            slope = &slope + &factor;
        }
        [slope, rest].each_ref().map(Interval::enclosing)
    }
}

/// Returns the coefficients of a polynomial of degree 2 in one coordinate, the constant first.
fn coefficients(polynomial: &Polynomial, monomial_of_axis: Monomial) -> Option<[Number; 3]> {
    let mut coefficients = [(); 3].map(|()| Number::int(0));
    for (monomial, value) in polynomial.terms() {
        let degree = usize::from(monomial.iter().sum::<u8>());
        let powers =
            monomial_of_axis.map(|exponent| exponent * u8::try_from(degree).unwrap_or(u8::MAX));
        if degree > 2 || monomial != powers {
            return None;
        }
        coefficients[degree] = value.clone();
    }
    Some(coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;
    use crate::expr::polynomial::Polynomial;
    use crate::prove::root::Forms;

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

    /// Returns the largest difference between an arc's depth and a line's, on the arc's normal at the line's
    /// end in a box on it, and its proved bound. The arc's centre is `distance` beside the normal.
    fn largest_difference_and_bound(distance: f64) -> (f64, DepthDifference) {
        let mut graph = Graph::default();
        let number = |value: f64| Number::from_f64(value).expect("finite");
        let [d, z] = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
        let [centre_d, centre_z, radius] =
            [3.0 + distance, 5.0, 2.0].map(|value| graph.number(number(value)));
        let [from_d, from_z] = [graph.sub(d, centre_d), graph.sub(z, centre_z)];
        let [square_d, square_z] = [graph.mul(from_d, from_d), graph.mul(from_z, from_z)];
        let under = graph.add(square_d, square_z);
        let length = graph.sqrt(under).expect("a root");
        // The arc's lowest point, below its centre, is at z = 3, and so is the line.
        let arc = graph.sub(radius, length);
        let three = graph.number(number(3.0));
        let line = graph.sub(z, three);
        let normal = graph.sub(d, three);
        let mut forms = Forms::new(&graph);
        let [arc, line, normal] = [arc, line, normal].map(|id| forms.of(id).expect("a form"));
        let normal = normal.polynomial().expect("linear").clone();
        let tangency = Tangency::of(&arc, &line, &normal).expect("lines and distances");
        let [low, high] = [3.25, 3.75];
        let cell = Cell::half_plane(Interval::new(2.9, 3.1), Interval::new(low, high));
        let differences = (0..=100).map(|k| {
            let z = low + (high - low) * f64::from(k) / 100.0;
            // The distance minus the length along the normal, without cancellation.
            let (t, length) = (5.0 - z, (5.0 - z).hypot(distance));
            distance * distance / (t + length)
        });
        (differences.fold(0.0, f64::max), tangency.over_box(&cell).expect("the foot is elsewhere"))
    }

    #[test]
    fn the_bound_holds_for_arcs_that_are_nearly_tangent_to_lines() {
        for distance in [0.0, 1e-16, 1e-12, 1e-9, 1e-3] {
            let distance = 3.0 + distance - 3.0;
            let (largest, bound) = largest_difference_and_bound(distance);
            assert!(
                bound.jump >= largest && bound.jump <= 2.0 * distance * (1.0 + 1e-12) + 1e-60,
                "{distance}: {largest} {}",
                bound.jump
            );
            assert!(
                bound.slope_across >= distance / 1.75_f64.hypot(distance)
                    && bound.slope_across <= 2.0 * distance + 1e-15
            );
        }
    }
}
