//! Sums with a `min`, a `max` or an `abs` among their terms, as the larger or the smaller of two sums.

use super::{Graph, Id, Node};
use std::collections::BTreeSet;

/// An expression that equals the larger or the smaller of two others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// True if it is the larger of the two.
    pub(crate) is_larger: bool,
    pub(crate) parts: [Id; 2],
}

impl Graph {
    /// Returns an expression as a corner, if it is a sum with a `min`, `max` or `abs` term. The two parts are added to
    /// the graph.
    pub(crate) fn corner(&mut self, value: Id) -> Option<Corner> {
        if !self.has_corner(value) {
            return None;
        }
        let lifted = |this: &mut Graph, term, with: &mut dyn FnMut(&mut Graph, Id) -> Id| {
            let Corner { is_larger, parts } = this.corner(term)?;
            Some(Corner { is_larger, parts: parts.map(|part| with(this, part)) })
        };
        let opposite =
            |Corner { is_larger, parts }: Corner| Corner { is_larger: !is_larger, parts };
        match *self.node(value) {
            Node::Max(a, b) => Some(Corner { is_larger: true, parts: [a, b] }),
            Node::Min(a, b) => Some(Corner { is_larger: false, parts: [a, b] }),
            Node::Abs(a) => Some(Corner { is_larger: true, parts: [a, self.neg(a)] }),
            Node::Neg(a) => lifted(self, a, &mut |graph, a| graph.neg(a)).map(opposite),
            Node::Add(a, b) if self.has_corner(a) => {
                lifted(self, a, &mut |graph, a| graph.add(a, b))
            }
            Node::Add(a, b) => lifted(self, b, &mut |graph, b| graph.add(a, b)),
            Node::Sub(a, b) if self.has_corner(a) => {
                lifted(self, a, &mut |graph, a| graph.sub(a, b))
            }
            Node::Sub(a, b) => lifted(self, b, &mut |graph, b| graph.sub(a, b)).map(opposite),
            Node::Mul(factor, a) => {
                let is_negative = self.constant(factor)?.is_negative();
                let corner = lifted(self, a, &mut |graph, a| graph.mul(factor, a))?;
                Some(if is_negative { opposite(corner) } else { corner })
            }
            _ => None,
        }
    }

    /// Returns whether a sum has a `min`, `max` or `abs` among its terms.
    fn has_corner(&self, value: Id) -> bool {
        let mut corners = BTreeSet::new();
        for id in self.dependencies([value]) {
            let has = match self.node(id) {
                Node::Max(..) | Node::Min(..) | Node::Abs(_) => true,
                Node::Neg(a) => corners.contains(a),
                Node::Add(a, b) | Node::Sub(a, b) => corners.contains(a) || corners.contains(b),
                Node::Mul(factor, a) => self.constant(*factor).is_some() && corners.contains(a),
                _ => false,
            };
            if has {
                corners.insert(id);
            }
        }
        corners.contains(&value)
    }
}
