//! Symbolic derivatives, by the rules of calculus.

use super::{Coord, Graph, Id, Node};
use std::collections::HashMap;

/// Returns the derivative of `of` with respect to a coordinate: `d` or `z` of a tool, or `x`, `y` or `z` of a
/// solid, which `d` depends on.
///
/// Where a root, a minimum or an absolute value is not smooth, the result is one of its one-sided
/// derivatives; for a root of 0 it is 0. So the result is finite wherever the function is.
pub fn derivative(graph: &mut Graph, of: Id, by: Coord) -> Id {
    let mut known = HashMap::new();
    for id in graph.dependencies([of]) {
        let result = rule(graph, id, by, &known);
        known.insert(id, result);
    }
    known[&of]
}

fn rule(graph: &mut Graph, id: Id, by: Coord, known: &HashMap<Id, Id>) -> Id {
    let d = |id: &Id| known[id];
    match graph.node(id).clone() {
        Node::Const(_) => graph.int(0),
        Node::Coord(Coord::Q) if by == Coord::D => {
            let two = graph.int(2);
            let radius = graph.coord(Coord::D);
            graph.mul(two, radius)
        }
        Node::Coord(Coord::Q) if matches!(by, Coord::X | Coord::Y) => {
            let two = graph.int(2);
            let across = graph.coord(by);
            graph.mul(two, across)
        }
        Node::Coord(Coord::D) if matches!(by, Coord::X | Coord::Y) => {
            let across = graph.coord(by);
            graph.quotient(across, id)
        }
        Node::Coord(coord) => graph.int(i64::from(coord == by)),
        Node::Neg(a) => graph.neg(d(&a)),
        Node::Add(a, b) => graph.add(d(&a), d(&b)),
        Node::Sub(a, b) => graph.sub(d(&a), d(&b)),
        Node::Mul(a, b) if a == b => {
            let two = graph.int(2);
            let slope = graph.mul(a, d(&a));
            graph.mul(two, slope)
        }
        Node::Mul(a, b) => {
            let first_term = graph.mul(d(&a), b);
            let right = graph.mul(a, d(&b));
            graph.add(first_term, right)
        }
        // (a/b)' = (a' - (a/b) b') / b
        Node::Div(a, b) | Node::Quotient(a, b) => {
            let quotient = graph.quotient(a, b);
            let down = graph.mul(quotient, d(&b));
            let up = graph.sub(d(&a), down);
            graph.quotient(up, b)
        }
        Node::Min(a, b) => graph.select(a, b, d(&a), d(&b)),
        Node::Max(a, b) => graph.select(b, a, d(&a), d(&b)),
        Node::Abs(a) => {
            let zero = graph.int(0);
            let down = graph.neg(d(&a));
            graph.select(zero, a, d(&a), down)
        }
        Node::Sqrt(a) => {
            let half =
                graph.number(&crate::number::Number::int(1) / &crate::number::Number::int(2));
            let up = graph.mul(half, d(&a));
            graph.quotient(up, id)
        }
        Node::Select { low, high, then, other } => graph.select(low, high, d(&then), d(&other)),
    }
}
