//! The expression graph: its nodes, one operation with its operands each, and the rules by which it is folded
//! during construction.

use crate::number::Number;
use std::collections::HashMap;

/// For each node that is a root, the nodes that it needs, operands first and without constants; an empty list for the others.
///
/// Boxed slices, since evaluation indexes them all the time: without optimisation, every index into a `Vec` is a call.
pub(crate) type EvaluationOrders = Box<[Box<[Id]>]>;

/// Expressions with shared subexpressions.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    /// The number of operations between each node and its farthest leaf.
    heights: Vec<u32>,
    known: HashMap<Node, Id>,
    /// Alternative forms of expressions, for proofs.
    proof_forms: HashMap<Id, Id>,
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

    /// States that two expressions are the same function: one that is computed, since it rounds little, and
    /// one whose form proofs can use.
    pub(crate) fn add_proof_alias(&mut self, computed: Id, seen: Id) {
        self.proof_forms.insert(computed, seen);
        let opposite = [computed, seen].map(|id| self.neg(id));
        self.proof_forms.insert(opposite[0], opposite[1]);
    }

    /// Returns the form of an expression that proofs use: the expression itself, unless
    /// [another form](Graph::add_proof_alias) was stated.
    pub(crate) fn proof_form(&self, id: Id) -> Id {
        self.proof_forms.get(&id).copied().unwrap_or(id)
    }

    /// Returns the id of a node, if it is in the graph.
    pub(crate) fn find(&self, node: &Node) -> Option<Id> {
        self.known.get(node).copied()
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

    /// `-a`
    pub fn neg(&mut self, a: Id) -> Id {
        match self.node(a).clone() {
            Node::Const(value) => self.number(-&value),
            Node::Neg(inner) => inner,
            Node::Sub(u, v) => self.sub(v, u),
            Node::Add(u, v) if self.constant(v).is_some() => {
                let shift = self.neg(v);
                self.sub(shift, u)
            }
            Node::Mul(c, v) if self.constant(c).is_some() => {
                let factor = self.neg(c);
                self.mul(factor, v)
            }
            _ => self.put(Node::Neg(a)),
        }
    }

    /// Splits a node into `rest + constant`, if it visibly is such a sum.
    fn split(&self, id: Id) -> Option<(Id, Number)> {
        match self.node(id) {
            Node::Add(rest, shift) => Some((*rest, self.constant(*shift)?.clone())),
            _ => None,
        }
    }

    /// `a + b`. Constants move outward, so that the frame's shift and the file's own numbers meet and are
    /// rounded once.
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        match (self.node(a).clone(), self.node(b).clone()) {
            (Node::Const(x), Node::Const(y)) => return self.number(&x + &y),
            (Node::Const(x), _) if x.is_zero() => return b,
            (_, Node::Const(y)) if y.is_zero() => return a,
            (Node::Const(_), _) => return self.add(b, a),
            (Node::Sub(c, v), Node::Const(y)) => {
                if let Some(x) = self.constant(c).cloned() {
                    let shift = self.number(&x + &y);
                    return self.sub(shift, v);
                }
            }
            (_, Node::Neg(v)) => return self.sub(a, v),
            (Node::Neg(v), _) => return self.sub(b, v),
            _ => {}
        }
        if let Some((rest, shift)) = self.split(a) {
            let (sum, shift) = match (self.constant(b).cloned(), self.split(b)) {
                (Some(more), _) => (rest, &shift + &more),
                (None, Some((other, more))) => (self.add(rest, other), &shift + &more),
                (None, None) => (self.add(rest, b), shift),
            };
            let shift = self.number(shift);
            return self.add(sum, shift);
        }
        if let Some((rest, shift)) = self.split(b) {
            let sum = self.add(a, rest);
            let shift = self.number(shift);
            return self.add(sum, shift);
        }
        if self.is_square(a, Coord::X) && self.is_square(b, Coord::Y) {
            return self.coord(Coord::Q);
        }
        // (c - v) + b = (b - v) + c
        for (difference, other) in [(a, b), (b, a)] {
            if let Node::Sub(c, v) = *self.node(difference)
                && self.constant(c).is_some()
                && self.constant(other).is_none()
            {
                let rest = self.sub(other, v);
                return self.add(rest, c);
            }
        }
        self.put(Node::Add(a, b))
    }

    fn is_square(&self, id: Id, of: Coord) -> bool {
        matches!(*self.node(id), Node::Mul(a, b) if a == b && *self.node(a) == Node::Coord(of))
    }

    /// `a - b`
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        if a == b {
            return self.int(0);
        }
        match (self.node(a).clone(), self.node(b).clone()) {
            (Node::Const(x), Node::Const(y)) => return self.number(&x - &y),
            (_, Node::Const(y)) => {
                let shift = self.number(-&y);
                return self.add(a, shift);
            }
            (_, Node::Neg(v)) => return self.add(a, v),
            (Node::Const(x), _) => {
                if let Some((rest, shift)) = self.split(b) {
                    let shift = self.number(&x - &shift);
                    return self.sub(shift, rest);
                }
                if let Node::Sub(c, v) = *self.node(b)
                    && let Some(y) = self.constant(c).cloned()
                {
                    let shift = self.number(&x - &y);
                    return self.add(v, shift);
                }
                if x.is_zero() {
                    return self.neg(b);
                }
                if let Node::Sub(u, v) = *self.node(b) {
                    // c - (u - v) = (v - u) + c
                    let rest = self.sub(v, u);
                    return self.add(rest, a);
                }
                return self.put(Node::Sub(a, b));
            }
            _ => {}
        }
        if let Some((rest, shift)) = self.split(a) {
            let (difference, shift) = match self.split(b) {
                Some((other, less)) => (self.sub(rest, other), &shift - &less),
                None => (self.sub(rest, b), shift),
            };
            let shift = self.number(shift);
            return self.add(difference, shift);
        }
        if let Some((rest, shift)) = self.split(b) {
            let difference = self.sub(a, rest);
            let shift = self.number(-&shift);
            return self.add(difference, shift);
        }
        if let Node::Sub(c, v) = *self.node(a)
            && self.constant(c).is_some()
        {
            // (c - v) - b = c - (v + b)
            let sum = self.add(v, b);
            return self.sub(c, sum);
        }
        if let Node::Sub(c, v) = *self.node(b)
            && self.constant(c).is_some()
        {
            // a - (c - v) = (a + v) - c
            let sum = self.add(a, v);
            return self.sub(sum, c);
        }
        self.put(Node::Sub(a, b))
    }

    /// `a · b`, with a constant factor first. `d · d` becomes `Q`, which needs no root.
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        match (self.node(a).clone(), self.node(b).clone()) {
            (Node::Const(x), Node::Const(y)) => return self.number(&x * &y),
            (_, Node::Const(_)) => return self.mul(b, a),
            (Node::Const(x), _) if x.is_zero() => return a,
            (Node::Const(x), _) if x == Number::int(1) => return b,
            (Node::Const(x), _) if x == Number::int(-1) => return self.neg(b),
            (Node::Const(x), Node::Mul(c, v)) => {
                if let Some(y) = self.constant(c).cloned() {
                    let factor = self.number(&x * &y);
                    return self.mul(factor, v);
                }
            }
            (Node::Const(x), Node::Neg(v)) => {
                let factor = self.number(-&x);
                return self.mul(factor, v);
            }
            (Node::Neg(u), Node::Neg(v)) => return self.mul(u, v),
            (Node::Sub(c, v), _) if a == b && self.constant(c).is_some() => {
                // (c - v)² = (v - c)², so that a square has one form only.
                let root = self.sub(v, c);
                return self.mul(root, root);
            }
            (Node::Neg(u), _) => {
                let product = self.mul(u, b);
                return self.neg(product);
            }
            (_, Node::Neg(v)) => {
                let product = self.mul(a, v);
                return self.neg(product);
            }
            (Node::Coord(Coord::D), Node::Coord(Coord::D)) => return self.coord(Coord::Q),
            (Node::Mul(c, v), _) if self.constant(c).is_some() => {
                let product = self.mul(v, b);
                return self.mul(c, product);
            }
            (_, Node::Mul(c, v)) if self.constant(c).is_some() => {
                let product = self.mul(a, v);
                return self.mul(c, product);
            }
            _ => {}
        }
        let (a, b) = (a.min(b), a.max(b));
        self.put(Node::Mul(a, b))
    }

    /// `a / b`; `None` if `b` is the constant 0. A constant divisor becomes a factor.
    pub fn div(&mut self, a: Id, b: Id) -> Option<Id> {
        if let Some(divisor) = self.constant(b).cloned() {
            let factor = Number::int(1).checked_div(&divisor)?;
            if let Some(value) = self.constant(a).cloned() {
                return Some(self.number(&value / &divisor));
            }
            let factor = self.number(factor);
            return Some(self.mul(factor, a));
        }
        if self.is_int(a, 0) {
            return Some(a);
        }
        Some(if a == b { self.int(1) } else { self.put(Node::Div(a, b)) })
    }

    /// `a / b`, and 0 where `b` is 0.
    pub fn quotient(&mut self, a: Id, b: Id) -> Id {
        match self.constant(b).cloned() {
            Some(divisor) if divisor.is_zero() => self.int(0),
            Some(divisor) => {
                let factor = self.number(&Number::int(1) / &divisor);
                self.mul(factor, a)
            }
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
