//! How far rounding can take a computed value from the true one, operation by operation: forward
//! error analysis (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, chapter 3) over
//! boxes, to first order.

use crate::Checked;
use crate::domain::Domain;
use crate::expr::interval::{Cell, EVERYTHING, Interval, ZERO};
use crate::expr::{Coord, Graph, Id, Node};
use std::collections::HashMap;

/// The unit roundoff of `f64` and of `f32`.
const UNITS: [f64; 2] = [1.110_223_024_625_156_5e-16, 5.960_464_477_539_063e-8];
/// What products of errors add, as a part of their sum.
const SECOND_ORDER: f64 = 1e-4;

/// A value over a box, and its error in unit roundoffs of `f64` and of `f32`.
#[derive(Clone, Copy)]
struct Rounded {
    value: Interval,
    error: [f64; 2],
}

/// How far rounding can take any region's computed depth, of `f64` and of `f32`, from its true value, over
/// the whole of a tool's box.
pub(super) fn over(tool: &Checked) -> [f64; 2] {
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
            self.values[id.index()] = self.node(id, cell);
        }
        let error = self.values[root.index()].error;
        [0, 1].map(|format| error[format] * UNITS[format] * (1.0 + SECOND_ORDER))
    }

    fn node(&self, id: Id, cell: &Cell) -> Rounded {
        let v = |id: &Id| self.values[id.index()];
        let size = |value: Interval| value.abs().high;
        // An operation's own rounding, on what its operands bring.
        let rounded = |value: Interval, brought: [f64; 2]| Rounded {
            value,
            error: brought.map(|error| error + size(value)),
        };
        let both = |a: Rounded, b: Rounded, of: &dyn Fn(f64, f64) -> f64| {
            [of(a.error[0], b.error[0]), of(a.error[1], b.error[1])]
        };
        match self.graph.node(id) {
            Node::Const(number) => {
                let value = Interval::about(number);
                let near = number.to_f64();
                let wide = if value.low == value.high { 0.0 } else { near.abs() };
                let narrow =
                    if wide == 0.0 && f64::from(near as f32) == near { 0.0 } else { near.abs() };
                Rounded { value, error: [wide, narrow] }
            }
            Node::Coord(coord) => self.coordinate(*coord, cell),
            Node::Neg(a) => Rounded { value: v(a).value.negated(), ..v(a) },
            Node::Abs(a) => Rounded { value: v(a).value.abs(), ..v(a) },
            Node::Add(a, b) => {
                let (a, b) = (v(a), v(b));
                rounded(a.value.plus(b.value), both(a, b, &|e, f| e + f))
            }
            Node::Sub(a, b) => {
                let (a, b) = (v(a), v(b));
                rounded(a.value.plus(b.value.negated()), both(a, b, &|e, f| e + f))
            }
            Node::Mul(a, b) => {
                let value = if a == b { v(a).value.square() } else { v(a).value.times(v(b).value) };
                let (a, b) = (v(a), v(b));
                let brought =
                    both(a, b, &|e, f| product(e, size(b.value)) + product(f, size(a.value)));
                let exact = [a.value, b.value].iter().any(|factor| is_power_of_two(*factor));
                if exact { Rounded { value, error: brought } } else { rounded(value, brought) }
            }
            Node::Div(a, b) | Node::Quotient(a, b) => {
                let (a, b) = (v(a), v(b));
                let value = a.value.times(b.value.reciprocal());
                let least = b.value.abs().low;
                rounded(value, both(a, b, &|e, f| (e + product(f, size(value))) / least))
            }
            Node::Min(a, b) | Node::Max(a, b) => {
                let smaller = matches!(self.graph.node(id), Node::Min(..));
                let (a, b) = (v(a), v(b));
                let value = if smaller { a.value.min(b.value) } else { a.value.max(b.value) };
                Rounded { value, error: both(a, b, &f64::max) }
            }
            Node::Sqrt(a) => {
                if let Some(parts) = self.graph.squares_of(*a) {
                    // As a length, x² + y² brings what its root would without the root's own rounding.
                    let axis = || {
                        let value = cell.radius();
                        Rounded { value, error: [value.abs().high; 2] }
                    };
                    let part = |part: &Option<Id>| part.as_ref().map_or_else(axis, v);
                    let parts: Vec<Rounded> = parts.iter().map(part).collect();
                    let sum =
                        parts.iter().map(|part| part.value.square()).fold(ZERO, Interval::plus);
                    let value = sum.sqrt();
                    // Squares and their sums are each right to one unit of themselves.
                    let own = (parts.len() as f64 / 2.0 + 1.0) * size(value);
                    let brought = |k: usize| {
                        parts.iter().map(|part| part.error[k] * part.error[k]).sum::<f64>().sqrt()
                    };
                    return Rounded { value, error: [0, 1].map(|k| brought(k) + own) };
                }
                let a = v(a);
                let value = a.value.sqrt();
                let twice = 2.0 * value.low;
                rounded(value, a.error.map(|error| if error == 0.0 { 0.0 } else { error / twice }))
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
        let twice = |value: Interval| Rounded { value, error: [2.0 * value.abs().high; 2] };
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

/// An error times a size, 0 if there is no error.
fn product(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error * size }
}

/// Whether a factor is known and only moves the exponent.
fn is_power_of_two(factor: Interval) -> bool {
    factor.low == factor.high && factor.low != 0.0 && factor.low.abs().to_bits() << 12 == 0
}
