//! Why a value is no number.

use crate::expr::value::Evaluator;
use crate::expr::{Graph, Id, Node};
use crate::report::Report;
use crate::source::Span;

/// Why a value is no number.
pub(super) enum Fault {
    Root,
    Quotient,
    Size,
}

impl Fault {
    /// Where a value stops to be a number.
    pub(super) fn of(graph: &Graph, at: &Evaluator<'_>, mut id: Id) -> Fault {
        let finite = |id: &Id| at.get(*id).is_finite();
        loop {
            let node = graph.node(id);
            let operands: Vec<Id> = match *node {
                Node::Select { low, high, then, other } => {
                    let [low, high] = [low, high].map(|id| at.get(id));
                    vec![if low <= high { then } else { other }]
                }
                _ => node.operands().collect(),
            };
            match operands.iter().find(|id| !finite(id)) {
                Some(operand) => id = *operand,
                None => {
                    return match *node {
                        Node::Sqrt(_) => Fault::Root,
                        Node::Div(_, by) if at.get(by) == 0.0 => Fault::Quotient,
                        _ => Fault::Size,
                    };
                }
            }
        }
    }

    pub(super) fn report(&self, span: Span, place: &str) -> Report {
        let (what, help) = match self {
            Fault::Root => (
                "square root of a negative number",
                "bound the region by what is under the root, or take `max(0, …)` of that",
            ),
            Fault::Quotient => ("division by zero", "bound the region away from there"),
            Fault::Size => (
                "a number beyond all bounds",
                "powers of large numbers grow so: divide by a length of the tool first",
            ),
        };
        Report::error(span, format!("{what} {place}")).help(help)
    }
}
