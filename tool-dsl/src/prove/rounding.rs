//! How far rounding can take a computed value from the true one, operation by operation: forward
//! error analysis (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, chapter 3) over
//! boxes.
//!
//! Let `u` be the unit roundoff, and let operands `a` and `b` err by `e u` and `f u`. Computed operands are at most `|a| + e u`
//! and at least `|b| - f u`. A value that may be larger than the format's largest has no bound. Only underflow is left out,
//! which adds less than 1e-38 of `f32` to an operation (1e-308 of `f64`):
//!
//! | operation | brings, in `u` | own rounding, in `u` |
//! |---|---|---|
//! | a sum or difference | `e + f` | the size of what is rounded |
//! | a product | `e |b| + f |a| + e f u` | the same |
//! | a quotient `q` | `(e + f |q|) / (|b| - f u)` | the same |
//! | a root | `e / (√a + √(a - e u))` | the same |
//! | the length of `n` parts: no more than `n` roundings below the root, one of it | the length of their errors | `γ(n/2 + 1)` of what is rounded |
//! | the lesser, the larger | the larger of `e` and `f` | none |
//!
//! with `γ(m) = m / (1 - m u)`, which is no less than `((1 + u)^m - 1) / u`. What is rounded is as large as the true value
//! and what was brought.

use crate::domain::Domain;
use crate::expr::interval::{Cell, EVERYTHING, Interval, ZERO};
use crate::expr::{Coord, Graph, Id, Node};
use crate::plan::PlannedTool;
use std::collections::HashMap;

/// The unit roundoff of `f64` and of `f32`.
const UNITS: [f64; 2] = [1.110_223_024_625_156_5e-16, 5.960_464_477_539_063e-8];
/// The largest number of `f64` and of `f32`.
const LARGEST: [f64; 2] = [f64::MAX, f32::MAX as f64];
/// Covers the rounding of the error bounds themselves. No operation takes more than 16 roundings of positive terms beside those of an
/// operand each, which lose half of this each at most.
const KEPT: f64 = 1.0 + 16.0 * f64::EPSILON;

/// A value over a box, and its error in unit roundoffs of `f64` and of `f32`.
#[derive(Clone, Copy)]
struct Rounded {
    value: Interval,
    error: [f64; 2],
}

/// How far rounding can take any region's computed depth, of `f64` and of `f32`, from its true value, over
/// the whole of a tool's box.
pub(super) fn over(tool: &PlannedTool) -> [f64; 2] {
    let model = &tool.model;
    let depths = || model.regions.iter().map(|region| region.depth);
    let mut errors = Errors::new(&model.graph, model.domain, depths());
    let cell = tool.extent.cell();
    depths()
        .map(|depth| errors.over(depth, &cell))
        .fold([0.0; 2], |most, error| [most[0].max(error[0]), most[1].max(error[1])])
}

/// Errors of chosen nodes of a graph over one box after another. The coordinates x, y and z of a
/// point are given without error in either format.
pub(super) struct Errors<'g> {
    graph: &'g Graph,
    domain: Domain,
    needed: HashMap<Id, Vec<Id>>,
    values: Vec<Rounded>,
}

impl<'g> Errors<'g> {
    pub(super) fn new(
        graph: &'g Graph,
        domain: Domain,
        roots: impl IntoIterator<Item = Id>,
    ) -> Errors<'g> {
        let needed = roots.into_iter().map(|root| (root, graph.needed([root]))).collect();
        let unknown = Rounded { value: EVERYTHING, error: [f64::INFINITY; 2] };
        Errors { graph, domain, needed, values: vec![unknown; graph.nodes().len()] }
    }

    /// The largest error of a node over a box, computed in `f64` and in `f32`.
    pub(super) fn over(&mut self, root: Id, cell: &Cell) -> [f64; 2] {
        for &id in self.needed.get(&root).into_iter().flatten() {
            let Rounded { value, error } = self.node(id, cell);
            let error = [0, 1].map(|format| {
                let error = error[format] * KEPT;
                let computed = value.abs().high + error * UNITS[format];
                if computed <= LARGEST[format] { error } else { f64::INFINITY }
            });
            self.values[id.index()] = Rounded { value, error };
        }
        let error = self.values[root.index()].error;
        [0, 1].map(|format| error[format] * UNITS[format] * KEPT)
    }

    fn node(&self, id: Id, cell: &Cell) -> Rounded {
        let v = |id: &Id| self.values[id.index()];
        let size = |value: Interval| value.abs().high;
        // An operation's own rounding, on what its operands bring.
        let rounded = |value: Interval, brought: [f64; 2]| Rounded {
            value,
            error: [0, 1].map(|k| brought[k] + (size(value) + brought[k] * UNITS[k])),
        };
        let both = |a: Rounded, b: Rounded, of: &dyn Fn(f64, f64, f64) -> f64| {
            [0, 1].map(|k| of(a.error[k], b.error[k], UNITS[k]))
        };
        match self.graph.node(id) {
            Node::Const(number) => {
                let value = Interval::about(number);
                let near = number.to_f64();
                let wide = if value.low == value.high { 0.0 } else { near.abs() };
                // Rounded twice, to `f64` and to `f32`.
                let twice = near.abs() * (1.0 + 2.0 * UNITS[0] / UNITS[1]);
                let narrow =
                    if wide == 0.0 && f64::from(near as f32) == near { 0.0 } else { twice };
                Rounded { value, error: [wide, narrow] }
            }
            Node::Coord(coord) => self.coordinate(*coord, cell),
            Node::Neg(a) => Rounded { value: v(a).value.negated(), ..v(a) },
            Node::Abs(a) => Rounded { value: v(a).value.abs(), ..v(a) },
            Node::Add(a, b) => {
                let (a, b) = (v(a), v(b));
                rounded(a.value.plus(b.value), both(a, b, &|e, f, _| e + f))
            }
            Node::Sub(a, b) => {
                let (a, b) = (v(a), v(b));
                rounded(a.value.plus(b.value.negated()), both(a, b, &|e, f, _| e + f))
            }
            Node::Mul(a, b) => {
                let value = if a == b { v(a).value.square() } else { v(a).value.times(v(b).value) };
                let (a, b) = (v(a), v(b));
                let brought = both(a, b, &|e, f, unit| {
                    let first = product(e, size(b.value)) + product(f, size(a.value));
                    first + product(e, product(f, unit))
                });
                let exact = [a.value, b.value].iter().any(|factor| is_power_of_two(*factor));
                if exact { Rounded { value, error: brought } } else { rounded(value, brought) }
            }
            Node::Div(a, b) | Node::Quotient(a, b) => {
                let (a, b) = (v(a), v(b));
                let value = a.value.times(b.value.reciprocal());
                let least = b.value.abs().low;
                let brought = both(a, b, &|e, f, unit| {
                    let least = least - f * unit;
                    let more = e + product(f, size(value));
                    if least > 0.0 { more / least } else { f64::INFINITY }
                });
                rounded(value, brought)
            }
            Node::Min(a, b) | Node::Max(a, b) => {
                let smaller = matches!(self.graph.node(id), Node::Min(..));
                let (a, b) = (v(a), v(b));
                let value = if smaller { a.value.min(b.value) } else { a.value.max(b.value) };
                Rounded { value, error: both(a, b, &|e, f, _| e.max(f)) }
            }
            Node::Sqrt(a) => {
                if let Some(parts) = self.graph.squares_of(*a) {
                    // As a length, x² + y² brings what its root would without the root's own rounding.
                    let axis = || {
                        let value = cell.radius();
                        // Two roundings below the root are one of it.
                        Rounded { value, error: [value.abs().high; 2] }
                    };
                    let part = |part: &Option<Id>| part.as_ref().map_or_else(axis, v);
                    let parts: Vec<Rounded> = parts.iter().map(part).collect();
                    let sum =
                        parts.iter().map(|part| part.value.square()).fold(ZERO, Interval::plus);
                    let value = sum.sqrt();
                    // Squares and their sums are each right to one unit of themselves.
                    let error = [0, 1].map(|k| {
                        let brought = parts.iter().map(|part| part.error[k] * part.error[k]);
                        let brought = brought.sum::<f64>().sqrt();
                        let own = gamma(parts.len() as f64 / 2.0 + 1.0, UNITS[k]);
                        brought + own * (size(value) + brought * UNITS[k])
                    });
                    return Rounded { value, error };
                }
                let a = v(a);
                let value = a.value.sqrt();
                let brought = |k: usize| match a.error[k] {
                    0.0 => 0.0,
                    error => error / (value.low + (a.value.low - error * UNITS[k]).max(0.0).sqrt()),
                };
                // What may be computed to be below 0 may have no root.
                let lost = |k: usize| a.error[k] * UNITS[k] > a.value.low;
                rounded(value, [0, 1].map(|k| if lost(k) { f64::INFINITY } else { brought(k) }))
            }
            Node::Select { low, high, then, other } => {
                let (low, high) = (v(low).value, v(high).value);
                match (low.high < high.low, low.low > high.high) {
                    (true, _) => v(then),
                    (_, true) => v(other),
                    // Rounding may take the other side.
                    _ => Rounded {
                        value: v(then).value.hull(v(other).value),
                        error: [f64::INFINITY; 2],
                    },
                }
            }
        }
    }

    fn coordinate(&self, coord: Coord, cell: &Cell) -> Rounded {
        let given = |axis: usize| Rounded { value: cell.sides[axis], error: [0.0; 2] };
        // Of x² + y² every operation rounds once; the root halves their error and adds its own.
        let twice = |value: Interval| Rounded {
            value,
            error: UNITS.map(|unit| gamma(2.0, unit) * value.abs().high),
        };
        match coord {
            Coord::X if self.domain == Domain::Space => given(0),
            Coord::Y => given(1),
            Coord::Z => given(2),
            Coord::X | Coord::D => twice(cell.radius()),
            Coord::Q => twice(cell.squared_radius()),
            Coord::Length | Coord::PerLength => {
                Rounded { value: EVERYTHING, error: [f64::INFINITY; 2] }
            }
        }
    }
}

/// What so many roundings take from 1 or add to it at most, in unit roundoffs.
fn gamma(count: f64, unit: f64) -> f64 {
    count / (1.0 - count * unit)
}

/// An error times a size, 0 if there is no error.
fn product(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error * size }
}

/// Whether a factor is known and only moves the exponent.
fn is_power_of_two(factor: Interval) -> bool {
    factor.low == factor.high && factor.low != 0.0 && factor.low.abs().to_bits() << 12 == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Number;

    /// On the circle `d = 1` only the product of both factors' errors is left of `(d - 1)²`. A quotient by what may be
    /// computed to be 0 may be anything, and so may a number that `f32` does not have.
    #[test]
    fn products_of_errors_count() {
        let mut graph = Graph::default();
        let one = graph.number(Number::int(1));
        let d = graph.coord(Coord::D);
        let off = graph.sub(d, one);
        let square = graph.mul(off, off);
        let quotient = graph.quotient(one, off);
        let mut errors = Errors::new(&graph, Domain::HalfPlane, [square, quotient]);
        let circle = Cell::half_plane(Interval::new(1.0, 1.0), ZERO);
        let found = errors.over(square, &circle);
        for (bound, unit) in found.into_iter().zip(UNITS) {
            // `d` is computed to two units.
            let most = (2.0 * unit) * (2.0 * unit);
            assert!((most..2.0 * most).contains(&bound), "{bound:e}");
        }
        let low = 1.0 + f64::EPSILON;
        let beside = Cell::half_plane(Interval::new(low, 1.5), ZERO);
        assert_eq!(errors.over(quotient, &beside)[1], f64::INFINITY);
        let far = Cell::half_plane(Interval::new(1e20, 1e20), ZERO);
        let [double, single] = errors.over(square, &far);
        assert!(double < 1e25 && single == f64::INFINITY, "{double:e}, {single:e}");
    }
}
