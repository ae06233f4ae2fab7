//! The expression graph: its nodes, one operation with its operands each, and the rules by which it is folded
//! during construction.

use crate::number::Number;
use std::collections::HashMap;

/// For each node that is a root, the nodes that it needs, operands first and without constants; an empty list for the others.
///
/// Boxed slices, since evaluation indexes them all the time: without optimisation, every index into a `Vec` is a call.
pub(crate) type EvaluationOrders = Box<[Box<[Id]>]>;

/// Expressions with shared subexpressions.
///
/// # Normal form
///
/// Expressions are rewritten while they are built, so that constants meet, and that one function seldom has two forms. The nodes
/// have these forms, where `x` is a constant and `e` and `f` are other nodes:
///
/// | node | form |
/// |---|---|
/// | `Neg` | `-e`, where `e` is no `Neg`, no `Sub`, and neither `f + x` nor `x · f` |
/// | `Add` | `e + x` with `x ≠ 0`, or `e + f`. No operand is a `Neg` |
/// | `Sub` | `x - e` with `x ≠ 0`, where `e` is no `Sub`, or `e - f` with `e ≠ f`. The second operand is no `Neg` |
/// | `Add`, `Sub` | Operands have no constant of their own: they are neither `f + x` nor `x - f` |
/// | `Mul` | Operands are in the order of ids. One of them may be a constant other than 0, 1 and -1. None is a `Neg` or `x · f`. A square is not `d · d` and not `(x - e)²` |
/// | `Div`, `Quotient` | The divisor is no constant, the dividend is not 0. `e / e` is a `Quotient` only |
/// | `Min`, `Max` | Operands differ and are in the order of ids. One of them may be a constant |
/// | `Abs` | The operand is no constant, `Neg`, `Abs`, `Sqrt`, `D` or `Q` |
/// | `Sqrt` | The operand is no constant and not `Q` |
/// | `Select` | The sides differ. One of the compared expressions may be a constant |
///
/// Here `x · e` is a product whose first operand is the constant. A constant that was added later than the other operand stands
/// second, and stays where it is.
///
/// Every rule is an identity of real numbers, so it keeps values exactly. Only arithmetic between constants rounds, to 256 bits. The
/// rules that drop an operand (`e - e`, `e / e`, `0 · e`, `0 / e`) may define an expression at more points. Recursion ends: apart from
/// a swap of the operands, every rule computes with constants, removes a `Neg`, or takes an operand apart.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    /// The number of operations between each node and its farthest leaf.
    heights: Vec<u32>,
    known: HashMap<Node, Id>,
}

impl Graph {
    /// Returns the node of an id.
    pub fn node(&self, id: Id) -> &Node {
        &self.nodes[id.index()]
    }

    /// Returns the number of operations between a node and its farthest leaf.
    pub fn height(&self, id: Id) -> u32 {
        self.heights[id.index()]
    }

    /// Returns all nodes, operands first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns the nodes that some roots need, operands first.
    pub fn dependencies(&self, roots: impl IntoIterator<Item = Id>) -> Vec<Id> {
        let mut pending: Vec<Id> = roots.into_iter().collect();
        let mut is_needed = vec![false; self.nodes.len()];
        let mut needed_ids = Vec::new();
        while let Some(id) = pending.pop() {
            if !is_needed[id.index()] {
                is_needed[id.index()] = true;
                needed_ids.push(id);
                pending.extend(self.node(id).operands());
            }
        }
        needed_ids.sort_unstable();
        needed_ids
    }

    /// Returns the orders in which some roots are evaluated, and the constants that they need, each once.
    pub(crate) fn evaluation_orders(
        &self,
        roots: impl IntoIterator<Item = Id>,
    ) -> (EvaluationOrders, Vec<Id>) {
        let mut orders = vec![Box::default(); self.nodes.len()].into_boxed_slice();
        let mut is_known_constant = vec![false; self.nodes.len()];
        let mut constants = Vec::new();
        for root in roots {
            let mut order = self.dependencies([root]);
            order.retain(|id| {
                let is_constant = self.constant(*id).is_some();
                if is_constant && !is_known_constant[id.index()] {
                    is_known_constant[id.index()] = true;
                    constants.push(*id);
                }
                !is_constant
            });
            orders[root.index()] = order.into_boxed_slice();
        }
        (orders, constants)
    }

    /// Returns the nodes whose squares a node is the sum of, if it visibly is such a sum. `None` in the list
    /// is the distance from the axis.
    pub(crate) fn squares_of(&self, id: Id) -> Option<Vec<Option<Id>>> {
        match self.node(id) {
            Node::Mul(a, b) if a == b => Some(vec![Some(*a)]),
            Node::Coord(Coord::Q) => Some(vec![None]),
            Node::Add(a, b) => {
                let mut parts = self.squares_of(*a)?;
                parts.extend(self.squares_of(*b)?);
                Some(parts)
            }
            _ => None,
        }
    }

    /// Returns the value of a constant node.
    pub fn constant(&self, id: Id) -> Option<&Number> {
        match self.node(id) {
            Node::Const(value) => Some(value),
            _ => None,
        }
    }

    fn is_int(&self, id: Id, value: i64) -> bool {
        self.constant(id).is_some_and(|c| *c == Number::int(value))
    }

    fn put(&mut self, node: Node) -> Id {
        if let Some(id) = self.known.get(&node) {
            return *id;
        }
        let id = Id(self.nodes.len() as u32);
        let below = node.operands().map(|operand| self.heights[operand.index()]).max();
        self.heights.push(below.map_or(0, |height| height + 1));
        self.nodes.push(node.clone());
        self.known.insert(node, id);
        id
    }

    /// Adds the operation of a node on other operands, as it is.
    pub(crate) fn with_operands(&mut self, id: Id, operands: &[Id]) -> Id {
        let node = match (self.node(id), operands) {
            (Node::Neg(_), [a]) => Node::Neg(*a),
            (Node::Abs(_), [a]) => Node::Abs(*a),
            (Node::Sqrt(_), [a]) => Node::Sqrt(*a),
            (Node::Add(..), [a, b]) => Node::Add(*a, *b),
            (Node::Sub(..), [a, b]) => Node::Sub(*a, *b),
            (Node::Mul(..), [a, b]) => Node::Mul(*a, *b),
            (Node::Div(..), [a, b]) => Node::Div(*a, *b),
            (Node::Quotient(..), [a, b]) => Node::Quotient(*a, *b),
            (Node::Min(..), [a, b]) => Node::Min(*a, *b),
            (Node::Max(..), [a, b]) => Node::Max(*a, *b),
            (Node::Select { .. }, [low, high, then, other]) => {
                Node::Select { low: *low, high: *high, then: *then, other: *other }
            }
            _ => return id,
        };
        self.put(node)
    }

    /// Adds a node that stands for one of several constants, of which this is an example. It is no other node's equal.
    pub(crate) fn parameter(&mut self, example: f64) -> Id {
        let id = Id(self.nodes.len() as u32);
        self.nodes.push(Node::Const(Number::from_f64(example).unwrap_or(Number::int(0))));
        self.heights.push(0);
        id
    }

    /// Adds the opposite of a node, as it is.
    pub(crate) fn opposite(&mut self, id: Id) -> Id {
        self.put(Node::Neg(id))
    }

    /// Adds a constant.
    pub fn number(&mut self, value: Number) -> Id {
        self.put(Node::Const(value))
    }

    /// Adds an integer constant.
    pub fn int(&mut self, value: i64) -> Id {
        self.number(Number::int(value))
    }

    /// Adds a coordinate.
    pub fn coord(&mut self, coord: Coord) -> Id {
        self.put(Node::Coord(coord))
    }

    /// Reads the form of a node.
    fn form(&self, id: Id) -> Form {
        let constant = |id| self.constant(id).cloned();
        match *self.node(id) {
            Node::Const(ref x) => Form::Constant(x.clone()),
            Node::Neg(e) => Form::Opposite(e),
            Node::Add(e, c) if let Some(x) = constant(c) => Form::Shifted(e, x),
            Node::Sub(c, e) if let Some(x) = constant(c) => Form::Mirrored(x, e),
            Node::Mul(c, e) if let Some(x) = constant(c) => Form::Scaled(x, e),
            _ => Form::Other,
        }
    }

    /// `e + x`
    fn shifted(&mut self, e: Id, x: Number) -> Id {
        let c = self.number(x);
        self.add(e, c)
    }

    /// `x - e`
    fn mirrored(&mut self, x: Number, e: Id) -> Id {
        let c = self.number(x);
        self.sub(c, e)
    }

    /// `x · e`
    fn scaled(&mut self, x: Number, e: Id) -> Id {
        let c = self.number(x);
        self.mul(c, e)
    }

    /// `-a`
    pub fn neg(&mut self, a: Id) -> Id {
        match self.form(a) {
            Form::Constant(x) => self.number(-&x),
            Form::Opposite(e) => e,
            Form::Shifted(e, x) => self.mirrored(-&x, e),
            Form::Scaled(x, e) => self.scaled(-&x, e),
            Form::Mirrored(..) | Form::Other => match *self.node(a) {
                Node::Sub(u, v) => self.sub(v, u),
                _ => self.put(Node::Neg(a)),
            },
        }
    }

    /// `a + b`. Constants move outward, so that the frame's shift and the file's own numbers meet and are rounded once.
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        use Form::{Constant, Mirrored, Opposite, Shifted};
        match (self.form(a), self.form(b)) {
            (Constant(x), Constant(y)) => self.number(&x + &y),
            (Constant(x), _) if x.is_zero() => b,
            (_, Constant(y)) if y.is_zero() => a,
            (Constant(_), _) => self.add(b, a),
            (Mirrored(x, e), Constant(y)) => self.mirrored(&x + &y, e),
            (_, Opposite(f)) => self.sub(a, f),
            (Opposite(e), _) => self.sub(b, e),
            (Shifted(e, x), Constant(y)) => self.shifted(e, &x + &y),
            (Shifted(e, x), Shifted(f, y)) => {
                let sum = self.add(e, f);
                self.shifted(sum, &x + &y)
            }
            (Shifted(e, x), _) => {
                let sum = self.add(e, b);
                self.shifted(sum, x)
            }
            (_, Shifted(f, y)) => {
                let sum = self.add(a, f);
                self.shifted(sum, y)
            }
            (Mirrored(x, e), _) => {
                let difference = self.sub(b, e);
                self.shifted(difference, x)
            }
            (_, Mirrored(y, f)) => {
                let difference = self.sub(a, f);
                self.shifted(difference, y)
            }
            _ if self.is_square(a, Coord::X) && self.is_square(b, Coord::Y) => self.coord(Coord::Q),
            _ => self.put(Node::Add(a, b)),
        }
    }

    fn is_square(&self, id: Id, of: Coord) -> bool {
        matches!(*self.node(id), Node::Mul(a, b) if a == b && *self.node(a) == Node::Coord(of))
    }

    /// `a - b`
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        use Form::{Constant, Mirrored, Opposite, Shifted};
        match (self.form(a), self.form(b)) {
            _ if a == b => self.int(0),
            (Constant(x), Constant(y)) => self.number(&x - &y),
            (_, Constant(y)) => self.shifted(a, -&y),
            (_, Opposite(f)) => self.add(a, f),
            (Constant(x), Shifted(f, y)) => self.mirrored(&x - &y, f),
            (Constant(x), Mirrored(y, f)) => self.shifted(f, &x - &y),
            (Constant(x), _) if x.is_zero() => self.neg(b),
            (Constant(x), _) => match *self.node(b) {
                Node::Sub(u, v) => {
                    let opposite = self.sub(v, u);
                    self.shifted(opposite, x)
                }
                _ => self.put(Node::Sub(a, b)),
            },
            (Shifted(e, x), Shifted(f, y)) => {
                let difference = self.sub(e, f);
                self.shifted(difference, &x - &y)
            }
            (Shifted(e, x), _) => {
                let difference = self.sub(e, b);
                self.shifted(difference, x)
            }
            (_, Shifted(f, y)) => {
                let difference = self.sub(a, f);
                self.shifted(difference, -&y)
            }
            (Mirrored(x, e), _) => {
                let sum = self.add(e, b);
                self.mirrored(x, sum)
            }
            (_, Mirrored(y, f)) => {
                let sum = self.add(a, f);
                let c = self.number(y);
                self.sub(sum, c)
            }
            _ => self.put(Node::Sub(a, b)),
        }
    }

    /// `a · b`. `d · d` becomes `Q`, which needs no root, and `(x - e)²` becomes `(e - x)²`, so that a square has one form only.
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        use Form::{Constant, Mirrored, Opposite, Scaled};
        match (self.form(a), self.form(b)) {
            (Constant(x), Constant(y)) => self.number(&x * &y),
            (_, Constant(_)) => self.mul(b, a),
            (Constant(x), _) if x.is_zero() => a,
            (Constant(x), _) if x == Number::int(1) => b,
            (Constant(x), _) if x == Number::int(-1) => self.neg(b),
            (Constant(x), Scaled(y, f)) => self.scaled(&x * &y, f),
            (Constant(x), Opposite(f)) => self.scaled(-&x, f),
            (Opposite(e), Opposite(f)) => self.mul(e, f),
            (Opposite(e), _) => {
                let product = self.mul(e, b);
                self.neg(product)
            }
            (_, Opposite(f)) => {
                let product = self.mul(a, f);
                self.neg(product)
            }
            (Scaled(x, e), _) => {
                let product = self.mul(e, b);
                self.scaled(x, product)
            }
            (_, Scaled(y, f)) => {
                let product = self.mul(a, f);
                self.scaled(y, product)
            }
            (Mirrored(x, e), _) if a == b => {
                let root = self.shifted(e, -&x);
                self.mul(root, root)
            }
            _ if a == b && *self.node(a) == Node::Coord(Coord::D) => self.coord(Coord::Q),
            _ => self.put(Node::Mul(a.min(b), a.max(b))),
        }
    }

    /// `a / b`; `None` if `b` is the constant 0. Another constant divisor becomes a factor.
    pub fn div(&mut self, a: Id, b: Id) -> Option<Id> {
        Some(match (self.constant(a), self.constant(b)) {
            (_, Some(y)) if y.is_zero() => return None,
            (Some(x), Some(y)) => self.number(x / y),
            (None, Some(y)) => self.scaled(&Number::int(1) / y, a),
            (Some(x), None) if x.is_zero() => a,
            _ if a == b => self.int(1),
            _ => self.put(Node::Div(a, b)),
        })
    }

    /// `a / b`, and 0 where `b` is 0.
    pub fn quotient(&mut self, a: Id, b: Id) -> Id {
        match self.constant(b).cloned() {
            Some(divisor) if divisor.is_zero() => self.int(0),
            Some(divisor) => self.scaled(&Number::int(1) / &divisor, a),
            None if self.is_int(a, 0) => a,
            None => self.put(Node::Quotient(a, b)),
        }
    }

    /// The smaller of two expressions.
    pub fn min(&mut self, a: Id, b: Id) -> Id {
        match (self.constant(a).cloned(), self.constant(b).cloned()) {
            (Some(x), Some(y)) => self.number(x.min(y)),
            _ if a == b => a,
            _ => self.put(Node::Min(a.min(b), a.max(b))),
        }
    }

    /// The larger of two expressions.
    pub fn max(&mut self, a: Id, b: Id) -> Id {
        match (self.constant(a).cloned(), self.constant(b).cloned()) {
            (Some(x), Some(y)) => self.number(x.max(y)),
            _ if a == b => a,
            _ => self.put(Node::Max(a.min(b), a.max(b))),
        }
    }

    /// The absolute value.
    pub fn abs(&mut self, a: Id) -> Id {
        match self.node(a).clone() {
            Node::Const(value) => self.number(value.abs()),
            Node::Coord(Coord::D | Coord::Q) | Node::Abs(_) | Node::Sqrt(_) => a,
            Node::Neg(inner) => self.abs(inner),
            _ => self.put(Node::Abs(a)),
        }
    }

    /// The square root; `None` for a negative constant.
    pub fn sqrt(&mut self, a: Id) -> Option<Id> {
        match self.node(a).clone() {
            Node::Const(value) => value.sqrt().map(|root| self.number(root)),
            Node::Coord(Coord::Q) => Some(self.coord(Coord::D)),
            _ => Some(self.put(Node::Sqrt(a))),
        }
    }

    /// `base^(halves/2)`; `None` if a constant base has no such power.
    pub fn power(&mut self, base: Id, halves: i32) -> Option<Id> {
        if halves < 0 {
            let below = self.power(base, -halves)?;
            let one = self.int(1);
            return self.div(one, below);
        }
        let mut result = match halves % 2 {
            0 => self.int(1),
            _ => self.sqrt(base)?,
        };
        let mut square = base;
        let mut remaining = halves / 2;
        while remaining > 0 {
            if remaining % 2 == 1 {
                result = self.mul(result, square);
            }
            remaining /= 2;
            if remaining > 0 {
                square = self.mul(square, square);
            }
        }
        Some(result)
    }

    /// `then` where `low ≤ high`, `other` elsewhere.
    pub fn select(&mut self, low: Id, high: Id, then: Id, other: Id) -> Id {
        if then == other {
            return then;
        }
        match (self.constant(low), self.constant(high)) {
            (Some(a), Some(b)) if a <= b => then,
            (Some(_), Some(_)) => other,
            _ => self.put(Node::Select { low, high, then, other }),
        }
    }
}

/// The form of a node, as far as the rules for sums and products tell forms apart.
enum Form {
    /// `x`
    Constant(Number),
    /// `-e`
    Opposite(Id),
    /// `e + x`
    Shifted(Id, Number),
    /// `x - e`
    Mirrored(Number, Id),
    /// `x · e`
    Scaled(Number, Id),
    Other,
}

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
        let (ids, count) = match *self {
            Node::Const(_) | Node::Coord(_) => ([Id(0); 4], 0),
            Node::Neg(a) | Node::Abs(a) | Node::Sqrt(a) => ([a; 4], 1),
            Node::Add(a, b)
            | Node::Sub(a, b)
            | Node::Mul(a, b)
            | Node::Div(a, b)
            | Node::Quotient(a, b)
            | Node::Min(a, b)
            | Node::Max(a, b) => ([a, b, b, b], 2),
            Node::Select { low, high, then, other } => ([low, high, then, other], 4),
        };
        ids.into_iter().take(count)
    }
}
