//! Bounds of the rounding error of computed values, operation by operation: forward error analysis (Higham,
//! *Accuracy and Stability of Numerical Algorithms*, 2002, chapter 3) over boxes.
//!
//! Let `u` be the unit roundoff, and let operands `a` and `b` have errors `e u` and `f u`. Computed operands
//! are at most `|a| + e u` and at least `|b| - f u`. A value that may exceed the largest double has no bound.
//! Only underflow is neglected, which adds less than 1e-308 per operation:
//!
//! | operation | propagated error, in `u` | own rounding, in `u` |
//! |---|---|---|
//! | a sum or difference | `e + f` | the size of the rounded value |
//! | a product | `e |b| + f |a| + e f u` | the same |
//! | a quotient `q` | `(e + f |q|) / (|b| - f u)` | the same |
//! | a root | `e / (√a + √(a - e u))` | the same |
//! | the length of `n` parts: at most `n` roundings below the root, one of it | the length of their errors | `γ(n/2 + 1)` of the rounded value |
//! | the smaller, the larger | the larger of `e` and `f` | none |
//!
//! Here `γ(m) = m / (1 - m u)`, which is at least `((1 + u)^m - 1) / u`. The size of the rounded value
//! includes the propagated error.

use crate::domain::Domain;
use crate::expr::interval::{Cell, ENTIRE, Interval, ZERO};
use crate::expr::{Coord, Graph, Id, Node};
use crate::plan::PlannedTool;
use std::collections::HashMap;

/// The unit roundoff.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// A factor that covers the rounding of the error bounds themselves. An operation rounds positive terms at
/// most 16 times, besides the roundings of its operands. Each rounding loses at most half of the epsilon.
const ERROR_BOUND_FACTOR: f64 = 1.0 + 16.0 * f64::EPSILON;

/// A value over a box, and its error in unit roundoffs.
#[derive(Clone, Copy)]
struct Rounded {
    value: Interval,
    error: f64,
}

impl Rounded {
    /// Returns the result of an operation that rounds once.
    fn of(value: Interval, propagated: f64) -> Rounded {
        // The value with the propagated error is rounded.
        Rounded { value, error: propagated + (value.abs().high + propagated * UNIT_ROUNDOFF) }
    }
}

/// Returns a bound of the error of any region's computed depth over a tool's whole box.
pub(super) fn bound_over_tool(tool: &PlannedTool) -> f64 {
    let model = &tool.model;
    let depths = || model.regions.iter().map(|region| region.depth);
    let mut errors = RoundingErrors::new(&model.graph, model.domain, depths());
    let cell = tool.extent.cell();
    depths().map(|depth| errors.over(depth, &cell)).fold(0.0, f64::max)
}

/// Error bounds of chosen nodes of a graph over one box after another. The coordinates x, y and z of a point
/// have no error.
pub(super) struct RoundingErrors<'g> {
    graph: &'g Graph,
    domain: Domain,
    needed: HashMap<Id, Vec<Id>>,
    values: Vec<Rounded>,
}

impl<'g> RoundingErrors<'g> {
    pub(super) fn new(
        graph: &'g Graph,
        domain: Domain,
        roots: impl IntoIterator<Item = Id>,
    ) -> RoundingErrors<'g> {
        let needed = roots.into_iter().map(|root| (root, graph.dependencies([root]))).collect();
        let unknown = Rounded { value: ENTIRE, error: f64::INFINITY };
        RoundingErrors { graph, domain, needed, values: vec![unknown; graph.nodes().len()] }
    }

    /// Returns a bound of the error of a node over a box.
    pub(super) fn over(&mut self, root: Id, cell: &Cell) -> f64 {
        for &id in self.needed.get(&root).into_iter().flatten() {
            let Rounded { value, error } = self.node(id, cell);
            let error = error * ERROR_BOUND_FACTOR;
            // A value that may overflow is computed as infinity.
            let computed = value.abs().high + error * UNIT_ROUNDOFF;
            let error = if computed <= f64::MAX { error } else { f64::INFINITY };
            self.values[id.index()] = Rounded { value, error };
        }
        self.values[root.index()].error * UNIT_ROUNDOFF * ERROR_BOUND_FACTOR
    }

    fn node(&self, id: Id, cell: &Cell) -> Rounded {
        let v = |id: &Id| self.values[id.index()];
        match self.graph.node(id) {
            Node::Const(number) => {
                let value = Interval::enclosing(number);
                // A number that is no double is emitted as the nearest one.
                let exact = value.low == value.high;
                Rounded { value, error: if exact { 0.0 } else { number.to_f64().abs() } }
            }
            Node::Coord(coord) => self.coordinate(*coord, cell),
            Node::Neg(a) => Rounded { value: v(a).value.negated(), ..v(a) },
            Node::Abs(a) => Rounded { value: v(a).value.abs(), ..v(a) },
            Node::Add(a, b) => {
                let (a, b) = (v(a), v(b));
                Rounded::of(a.value.plus(b.value), a.error + b.error)
            }
            Node::Sub(a, b) => {
                let (a, b) = (v(a), v(b));
                Rounded::of(a.value.plus(b.value.negated()), a.error + b.error)
            }
            Node::Mul(a, b) => {
                let value = if a == b { v(a).value.square() } else { v(a).value.times(v(b).value) };
                let (a, b) = (v(a), v(b));
                let first =
                    product(a.error, b.value.abs().high) + product(b.error, a.value.abs().high);
                let propagated = first + product(a.error, product(b.error, UNIT_ROUNDOFF));
                let exact = [a.value, b.value].iter().any(|factor| is_power_of_two(*factor));
                if exact {
                    Rounded { value, error: propagated }
                } else {
                    Rounded::of(value, propagated)
                }
            }
            Node::Div(a, b) | Node::Quotient(a, b) => {
                let (a, b) = (v(a), v(b));
                let value = a.value.times(b.value.reciprocal());
                let min_value = b.value.abs().low - b.error * UNIT_ROUNDOFF;
                let numerator = a.error + product(b.error, value.abs().high);
                Rounded::of(
                    value,
                    if min_value > 0.0 { numerator / min_value } else { f64::INFINITY },
                )
            }
            Node::Min(a, b) | Node::Max(a, b) => {
                let smaller = matches!(self.graph.node(id), Node::Min(..));
                let (a, b) = (v(a), v(b));
                let value = if smaller { a.value.min(b.value) } else { a.value.max(b.value) };
                Rounded { value, error: a.error.max(b.error) }
            }
            Node::Sqrt(a) => {
                if let Some(parts) = self.graph.squares_of(*a) {
                    // As part of a length, x² + y² contributes like its root, but without the root's own
                    // rounding.
                    let parts = parts.iter().map(|part| match part {
                        Some(part) => v(part),
                        None => {
                            let value = cell.radius();
                            // Two roundings below the root count as one of it.
                            Rounded { value, error: value.abs().high }
                        }
                    });
                    let parts: Vec<Rounded> = parts.collect();
                    let sum =
                        parts.iter().map(|part| part.value.square()).fold(ZERO, Interval::plus);
                    let value = sum.sqrt();
                    // Squares and their sums are each accurate to one unit roundoff of themselves.
                    let propagated = parts.iter().map(|part| part.error * part.error);
                    let propagated = propagated.sum::<f64>().sqrt();
                    let own_rounding = gamma(parts.len() as f64 / 2.0 + 1.0);
                    let error =
                        propagated + own_rounding * (value.abs().high + propagated * UNIT_ROUNDOFF);
                    return Rounded { value, error };
                }
                let a = v(a);
                let value = a.value.sqrt();
                let min_value = a.value.low - a.error * UNIT_ROUNDOFF;
                let propagated = match a.error {
                    0.0 => 0.0,
                    // A value that may be computed as negative may have no root.
                    _ if min_value < 0.0 => f64::INFINITY,
                    error => error / (value.low + min_value.sqrt()),
                };
                Rounded::of(value, propagated)
            }
            Node::Select { low, high, then, other } => {
                let (low, high) = (v(low).value, v(high).value);
                match (low.high < high.low, low.low > high.high) {
                    (true, _) => v(then),
                    (_, true) => v(other),
                    // Rounding may choose the other side.
                    _ => {
                        Rounded { value: v(then).value.hull(v(other).value), error: f64::INFINITY }
                    }
                }
            }
        }
    }

    fn coordinate(&self, coord: Coord, cell: &Cell) -> Rounded {
        let without_error = |axis: usize| Rounded { value: cell.sides[axis], error: 0.0 };
        // Every operation of x² + y² rounds once; the root halves their error and adds its own.
        let two_roundings =
            |value: Interval| Rounded { value, error: gamma(2.0) * value.abs().high };
        match coord {
            Coord::X if self.domain == Domain::Space => without_error(0),
            Coord::Y => without_error(1),
            Coord::Z => without_error(2),
            Coord::X | Coord::D => two_roundings(cell.radius()),
            Coord::Q => two_roundings(cell.squared_radius()),
            Coord::Length | Coord::PerLength => Rounded { value: ENTIRE, error: f64::INFINITY },
        }
    }
}

/// Returns the largest relative change by a number of roundings, in unit roundoffs.
fn gamma(count: f64) -> f64 {
    count / (1.0 - count * UNIT_ROUNDOFF)
}

/// Returns an error times a size, or 0 if there is no error.
fn product(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error * size }
}

/// Returns whether a factor is known and is a power of two, so that multiplication is exact.
fn is_power_of_two(factor: Interval) -> bool {
    factor.low == factor.high && factor.low != 0.0 && factor.low.abs().to_bits() << 12 == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Number;

    /// On the circle `d = 1` only the product of both factors' errors remains of `(d - 1)²`. A quotient whose
    /// divisor may be computed as 0 has no bound, and neither has a value that may exceed all doubles.
    #[test]
    fn products_of_errors_are_included() {
        let mut graph = Graph::default();
        let one = graph.number(Number::int(1));
        let d = graph.coord(Coord::D);
        let difference = graph.sub(d, one);
        let square = graph.mul(difference, difference);
        let quotient = graph.quotient(one, difference);
        let mut errors = RoundingErrors::new(&graph, Domain::HalfPlane, [square, quotient]);
        let circle = Cell::half_plane(Interval::new(1.0, 1.0), ZERO);
        // `d` is computed to within two unit roundoffs.
        let expected = (2.0 * UNIT_ROUNDOFF) * (2.0 * UNIT_ROUNDOFF);
        let bound = errors.over(square, &circle);
        assert!((expected..2.0 * expected).contains(&bound), "{bound:e}");
        let low = 1.0 + f64::EPSILON;
        let near_circle = Cell::half_plane(Interval::new(low, 1.5), ZERO);
        assert_eq!(errors.over(quotient, &near_circle), f64::INFINITY);
        let at_radius = |at: f64| Cell::half_plane(Interval::new(at, at), ZERO);
        assert!(errors.over(square, &at_radius(1e20)) < 1e25);
        assert_eq!(errors.over(square, &at_radius(1e160)), f64::INFINITY);
    }
}
