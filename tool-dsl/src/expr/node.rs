//! Nodes of expressions: one operation and its operands each.

use crate::number::Number;

/// The id of a node of a [`Graph`](super::Graph). A node's operands have smaller ids than the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(pub(super) u32);

impl Id {
    /// Returns the node's index in the list of nodes.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A coordinate of the point of evaluation, in the tool's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Coord {
    /// x, across the axis
    X,
    /// y, across the axis
    Y,
    /// z, along the axis toward the spindle, from the tip
    Z,
    /// The distance from the axis, `sqrt(x² + y²)`
    D,
    /// Its square, `x² + y²`
    Q,
    /// The length of the file's unit in units of the part
    Length,
    /// Its reciprocal
    PerLength,
}

/// The operation of a node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant.
    Const(Number),
    /// A coordinate.
    Coord(Coord),
    /// `-a`
    Neg(Id),
    /// `a + b`
    Add(Id, Id),
    /// `a - b`
    Sub(Id, Id),
    /// `a · b`
    Mul(Id, Id),
    /// `a / b`
    Div(Id, Id),
    /// `a / b`, and 0 where `b` is 0: a derivative where the function is not smooth
    Quotient(Id, Id),
    /// The smaller
    Min(Id, Id),
    /// The larger
    Max(Id, Id),
    /// `|a|`
    Abs(Id),
    /// `√a`
    Sqrt(Id),
    /// `then` where `low ≤ high`, `other` elsewhere
    Select {
        /// The left side of the comparison.
        low: Id,
        /// The right side of the comparison.
        high: Id,
        /// The value where the comparison holds.
        then: Id,
        /// The value elsewhere.
        other: Id,
    },
}

impl Node {
    /// Returns the node's operands.
    pub fn operands(&self) -> impl Iterator<Item = Id> {
        let four = match *self {
            Node::Const(_) | Node::Coord(_) => [None; 4],
            Node::Neg(a) | Node::Abs(a) | Node::Sqrt(a) => [Some(a), None, None, None],
            Node::Add(a, b)
            | Node::Sub(a, b)
            | Node::Mul(a, b)
            | Node::Div(a, b)
            | Node::Quotient(a, b)
            | Node::Min(a, b)
            | Node::Max(a, b) => [Some(a), Some(b), None, None],
            Node::Select { low, high, then, other } => {
                [Some(low), Some(high), Some(then), Some(other)]
            }
        };
        four.into_iter().flatten()
    }
}
