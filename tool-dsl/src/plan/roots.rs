//! Points on a splitting curve: the side they go to, or their own tree if both sides need them.

use super::Tree;
use super::samples::SampleSubset;
use super::section::{Halves, Owners, Planner};
use crate::diagnostic::Diagnostic;
use crate::formula::CurveIndex;
use crate::geometry::cut::{Edge, NEAR, Piece, is_along};
use crate::geometry::outline::Point;
use std::cmp::Ordering;
use std::rc::Rc;

/// The side to which a curve's own points go.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Zeros {
    Below,
    Above,
    Both,
}

impl Planner<'_> {
    /// Returns the side to which the points on a curve go: the side of the solid, so that it includes its
    /// surface. Where the solid is on both sides, it is the side of the owner listed first, if that is the
    /// same side along the whole curve.
    pub(super) fn zeros(&self, curve: CurveIndex, halves: &Halves) -> Zeros {
        let [below, above] = [&halves.below, &halves.above].map(|half| self.rim(curve, half));
        let (mut must, mut prefers) = ([false; 2], [false; 2]);
        let mut places: Vec<Point> =
            below.points.iter().chain(&above.points).map(|(p, _)| *p).collect();
        places.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
        // Vertices that pieces share agree except for their last bits.
        let close = 1e-12 * self.size;
        places.dedup_by(|p, q| (p[0] - q[0]).abs() < close && (p[1] - q[1]).abs() < close);
        for p in places {
            let [b, a] = [&below, &above].map(|rim| rim.first_at(p, NEAR * self.size));
            let inside = [b, a].map(|rank| rank != usize::MAX);
            match (inside, b.cmp(&a)) {
                ([true, false], _) => must[0] = true,
                ([false, true], _) => must[1] = true,
                (_, Ordering::Less) => prefers[0] = true,
                (_, Ordering::Greater) => prefers[1] = true,
                _ => {}
            }
        }
        match (must, prefers) {
            ([true, true], _) => Zeros::Both,
            ([false, true], _) | ([false, false], [false, true]) => Zeros::Above,
            _ => Zeros::Below,
        }
    }

    /// Returns the points and edges of some pieces that lie on a curve.
    fn rim(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Rim {
        let shape = &self.shapes[curve];
        let mut rim = Rim::default();
        for piece in pieces {
            let rank = piece.owner.unwrap_or(usize::MAX);
            let on: Vec<bool> =
                piece.vertices.iter().map(|p| shape.side(*p, self.size) == 0).collect();
            for (k, p) in piece.vertices.iter().enumerate().filter(|(k, _)| on[*k]) {
                rim.points.push((*p, rank));
                let next = (k + 1) % on.len();
                if on[next] && piece.edges[k] == Edge::Straight {
                    rim.edges.push(([*p, piece.vertices[next]], rank));
                }
            }
        }
        rim
    }

    /// Returns the owners of the points on a curve: at each, the first listed of those on both sides.
    pub(super) fn touching(
        &mut self,
        curve: CurveIndex,
        halves: &Halves,
        corners: &[usize],
        open: &[CurveIndex],
    ) -> Result<Owners, Diagnostic> {
        let shape = &self.shapes[curve];
        let touches =
            |piece: &&Rc<Piece>| piece.vertices.iter().any(|p| shape.side(*p, self.size) == 0);
        let [below, above] = [&halves.below, &halves.above]
            .map(|pieces| pieces.iter().filter(touches).cloned().collect::<Vec<_>>());
        let [here, there] = [-1, 1].map(|side| self.corners_on(side, curve, corners));
        let below = self.tree(&below, (SampleSubset::default(), here), open.to_vec())?;
        let above = self.tree(&above, (SampleSubset::default(), there), open.to_vec())?;
        Ok(first(&below, &above))
    }
}

/// Points and straight edges on a curve, with the rank of their owner: its index in the list.
#[derive(Default)]
struct Rim {
    points: Vec<(Point, usize)>,
    edges: Vec<([Point; 2], usize)>,
}

impl Rim {
    /// Returns the rank of the first listed owner that touches a point.
    fn first_at(&self, p: Point, close: f64) -> usize {
        let near = |q: Point| (p[0] - q[0]).abs() < close && (p[1] - q[1]).abs() < close;
        let points = self.points.iter().filter(|(q, _)| near(*q)).map(|(_, rank)| *rank);
        let edges =
            self.edges.iter().filter(|(edge, _)| is_along(p, *edge, close)).map(|(_, rank)| *rank);
        points.chain(edges).min().unwrap_or(usize::MAX)
    }
}

/// Returns a tree whose leaves are the first listed of the owners in two trees.
fn first(a: &Owners, b: &Owners) -> Owners {
    match a {
        Tree::Leaf(own) => {
            let rank = |owner: &Option<usize>| owner.unwrap_or(usize::MAX);
            let least =
                |other: &Option<usize>| Some(if rank(other) < rank(own) { *other } else { *own });
            b.map(&least).unwrap_or(Tree::Leaf(*own))
        }
        Tree::Split { curve, strict, below, above } => {
            let [low, high] = [true, false].map(|holds| b.knowing(*curve, *strict, holds));
            Tree::split(*curve, *strict, first(below, &low), first(above, &high))
        }
    }
}
