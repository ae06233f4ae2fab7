//! Evaluates expressions at a point, in `f64`: one IEEE operation per node, in the order of ids. Emitted code and the
//! interpreter compute the same values. Their tests of a curve that is a difference compare its terms, with the same result.

use super::{Coord, EvaluationOrders, Graph, Id, Node};
use crate::number::Number;

/// Evaluates chosen nodes of a graph at one point after another.
#[derive(Clone, Debug)]
pub struct Evaluator<'g> {
    graph: &'g Graph,
    /// The nodes to evaluate, operands first, without constants.
    order: Vec<Id>,
    /// By node id. Constants are set once; nodes that no root needs stay 0.
    values: Vec<f64>,
}

/// A point of evaluation, in the tool's frame and the file's unit, with the quantities that all nodes share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvaluationPoint {
    /// x
    pub x: f64,
    /// y
    pub y: f64,
    /// z
    pub z: f64,
    /// Distance from the axis, `sqrt(x² + y²)`
    pub d: f64,
    /// Its square
    pub q: f64,
    /// The file's unit of length, in the part's unit
    pub length: f64,
}

impl EvaluationPoint {
    /// Returns a point of space. The part has the file's unit.
    pub fn new(x: f64, y: f64, z: f64) -> EvaluationPoint {
        let q = x * x + y * y;
        EvaluationPoint { x, y, z, d: q.sqrt(), q, length: 1.0 }
    }

    /// Returns a point of the half plane that contains the profile, `d ≥ 0`. The part has the file's unit. `d` is kept as
    /// given, where emitted code computes `sqrt(d²)`: values may differ from that code's by rounding.
    pub fn on_meridian(d: f64, z: f64) -> EvaluationPoint {
        EvaluationPoint { x: d, y: 0.0, z, d, q: d * d, length: 1.0 }
    }
}

impl<'g> Evaluator<'g> {
    /// Creates an evaluator of `roots` and of all nodes that they need.
    pub fn new(graph: &'g Graph, roots: impl IntoIterator<Item = Id>) -> Evaluator<'g> {
        let mut order = graph.dependencies(roots);
        let mut values = vec![0.0; graph.nodes().len()];
        // Constants are rounded once, not at every point.
        order.retain(|id| match graph.constant(*id) {
            Some(value) => {
                values[id.index()] = value.to_f64();
                false
            }
            None => true,
        });
        Evaluator { graph, order, values }
    }

    /// Evaluates all nodes that the roots need, at a point.
    pub fn evaluate(&mut self, at: EvaluationPoint) {
        let nodes = self.graph.nodes();
        for &id in &self.order {
            self.values[id.index()] = node_value(&nodes[id.index()], at, &self.values);
        }
    }

    /// Returns the value of a node at the point of the last evaluation. The node must be a root or an operand of one:
    /// others have the value 0, as have all but constants before the first evaluation.
    pub fn get(&self, id: Id) -> f64 {
        self.values[id.index()]
    }
}

/// Evaluates chosen nodes of a graph at one point after another. At each point only the requested nodes are computed, to the
/// same values as an [`Evaluator`] gives.
#[derive(Clone, Debug)]
pub(crate) struct LazyEvaluator<'g> {
    graph: &'g Graph,
    /// The nodes that each root needs, operands first, without constants; empty for nodes that are not roots.
    needed: EvaluationOrders,
    values: Box<[f64]>,
    /// The number of the point for which each value was last computed.
    computed_for: Box<[u64]>,
    point_number: u64,
    point: EvaluationPoint,
}

impl<'g> LazyEvaluator<'g> {
    /// Creates an evaluator of `roots`.
    pub(crate) fn new(graph: &'g Graph, roots: impl IntoIterator<Item = Id>) -> LazyEvaluator<'g> {
        let (needed, constants) = graph.evaluation_orders(roots);
        let mut values = vec![0.0; graph.nodes().len()].into_boxed_slice();
        for id in constants {
            values[id.index()] = graph.constant(id).map_or(0.0, Number::to_f64);
        }
        let computed_for = vec![0; values.len()].into_boxed_slice();
        let point = EvaluationPoint::new(0.0, 0.0, 0.0);
        LazyEvaluator { graph, needed, values, computed_for, point_number: 0, point }
    }

    /// Selects a point.
    pub(crate) fn set(&mut self, point: EvaluationPoint) {
        self.point = point;
        self.point_number += 1;
    }

    /// Returns the value at the selected point of one of the roots.
    pub(crate) fn get(&mut self, root: Id) -> f64 {
        if self.computed_for[root.index()] == self.point_number {
            return self.values[root.index()];
        }
        let nodes = self.graph.nodes();
        for &id in &self.needed[root.index()] {
            let index = id.index();
            if self.computed_for[index] != self.point_number {
                self.computed_for[index] = self.point_number;
                self.values[index] = node_value(&nodes[index], self.point, &self.values);
            }
        }
        self.values[root.index()]
    }
}

/// Returns the value of a node at a point where its operands have the given values, by their ids.
fn node_value(node: &Node, at: EvaluationPoint, values: &[f64]) -> f64 {
    let v = |id: Id| values[id.index()];
    match node {
        Node::Const(value) => value.to_f64(),
        Node::Coord(Coord::X) => at.x,
        Node::Coord(Coord::Y) => at.y,
        Node::Coord(Coord::Z) => at.z,
        Node::Coord(Coord::D) => at.d,
        Node::Coord(Coord::Q) => at.q,
        Node::Coord(Coord::Length) => at.length,
        Node::Coord(Coord::PerLength) => 1.0 / at.length,
        Node::Neg(a) => -v(*a),
        Node::Add(a, b) => v(*a) + v(*b),
        Node::Sub(a, b) => v(*a) - v(*b),
        Node::Mul(a, b) => v(*a) * v(*b),
        Node::Div(a, b) => v(*a) / v(*b),
        Node::Quotient(a, b) => quotient(v(*a), v(*b)),
        Node::Min(a, b) => min(v(*a), v(*b)),
        Node::Max(a, b) => max(v(*a), v(*b)),
        Node::Abs(a) => v(*a).abs(),
        Node::Sqrt(a) => v(*a).sqrt(),
        Node::Select { low, high, then, other } => {
            // A comparison with NaN is false, so `other` is taken.
            if v(*low) <= v(*high) { v(*then) } else { v(*other) }
        }
    }
}

/// Returns `a / b`, and 0 where `b` is 0.
pub fn quotient(a: f64, b: f64) -> f64 {
    if b == 0.0 { 0.0 } else { a / b }
}

/// Returns the smaller of two numbers; `b` if they are equal or one is NaN, as the vector instructions of x86 do.
pub fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers; `b` if they are equal or one is NaN, as the vector instructions of x86 do.
pub fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
