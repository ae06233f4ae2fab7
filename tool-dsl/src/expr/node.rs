//! Nodes: what one step of an expression computes, of what.

use crate::number::Number;

/// A node of a [`Graph`](super::Graph). A larger id never is an operand of a smaller one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(pub(super) u32);

impl Id {
    /// The node's place in the list.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A coordinate of the point that is felt, in the tool's frame.
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
    /// How many of the part's units of length one of the file's is
    Length,
    /// Its reciprocal
    PerLength,
}

/// What a node computes.
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
    /// `a / b`, and 0 where `b` is 0: a derivative at a kink
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
        /// Left of the comparison.
        low: Id,
        /// Right of the comparison.
        high: Id,
        /// The value where it holds.
        then: Id,
        /// The value elsewhere.
        other: Id,
    },
}

impl Node {
    /// The node's operands.
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
