//! Bounds of the difference of two distances on a straight border. Depths there agree up to rounding: lines and arcs whose
//! ends were written with the digits of a double are not exactly tangent. The difference is affine along the line, up to that.

use super::root::{RootForm, RootTerm};
use crate::expr::Coord;
use crate::expr::interval::{Cell, Interval};
use crate::expr::polynomial::{Monomial, Polynomial, monomial_of};
use crate::number::Number;

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
        };
        tangency.add(a, false, line, only)?;
        tangency.add(b, true, line, only)?;
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

    /// Returns the difference of the two depths on the line in a box; `None` if a root's foot may be there.
    pub(super) fn over_box(&self, cell: &Cell) -> Option<DepthDifference> {
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
    use crate::prove::root::Forms;

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
