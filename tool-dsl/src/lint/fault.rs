//! The reasons why a value is not a finite number.

use crate::diagnostic::{CheckKind, Subject};
use crate::expr::value::Evaluator;
use crate::expr::{Graph, Id, Node};

/// The reason why a value is not a finite number.
pub(super) enum Fault {
    Root,
    Quotient,
    Size,
}

impl Fault {
    /// Returns the first operation, from the operands up, whose result is not finite.
    pub(super) fn of(graph: &Graph, evaluator: &Evaluator<'_>, mut id: Id) -> Fault {
        let is_finite = |id: &Id| evaluator.get(*id).is_finite();
        loop {
            let node = graph.node(id);
            let operands: Vec<Id> = match *node {
                Node::Select { low, high, then, other } => {
                    let [low, high] = [low, high].map(|id| evaluator.get(id));
                    vec![if low <= high { then } else { other }]
                }
                _ => node.operands().collect(),
            };
            match operands.iter().find(|id| !is_finite(id)) {
                Some(operand) => id = *operand,
                None => {
                    return match *node {
                        Node::Sqrt(_) => Fault::Root,
                        Node::Div(_, by) if evaluator.get(by) == 0.0 => Fault::Quotient,
                        _ => Fault::Size,
                    };
                }
            }
        }
    }

    /// Returns the diagnostic for an expression that has no value at a point.
    pub(super) fn kind(&self, location: String, subject: Subject) -> CheckKind {
        match self {
            Fault::Root => CheckKind::RootOfNegative { location, subject },
            Fault::Quotient => CheckKind::DivisionByZero { location, subject },
            Fault::Size => CheckKind::NumericOverflow { location, subject },
        }
    }
}
