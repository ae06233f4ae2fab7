//! Evaluates expressions at a point, in `f64`: one IEEE operation per node, in the order of ids. Emitted code and the
//! interpreter compute the same values. Their tests of a curve that is a difference compare its terms, with the same result.

use super::{Coord, Graph, Id, Node};

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
        for &id in &self.order {
            let v = |id: Id| self.values[id.index()];
            self.values[id.index()] = match self.graph.node(id) {
                // Constants are not in `order`.
                Node::Const(_) => v(id),
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
            };
        }
    }

    /// Returns the value of a node at the point of the last evaluation. The node must be a root or an operand of one:
    /// others have the value 0, as have all but constants before the first evaluation.
    pub fn get(&self, id: Id) -> f64 {
        self.values[id.index()]
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
