//! Points on a splitting curve: the side they go to, or their own tree if both sides need them.

use super::Tree;
use super::samples::SampleSubset;
use super::section::{Halves, Owners, Planner};
use crate::diagnostic::Diagnostic;
use crate::formula::CurveIndex;
use crate::geometry::cut::{COINCIDENCE_FRACTION, Edge, Piece, is_along};
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
    /// same side along the whole curve; otherwise the side below. Where some points belong only to the solid
    /// below and others only to the solid above, both sides need the curve's points.
    pub(super) fn zeros(&self, curve: CurveIndex, halves: &Halves) -> Zeros {
        let [below, above] =
            [&halves.below, &halves.above].map(|half| self.border_points(curve, half));
        // For the sides below and above: a point that belongs to the solid on this side only; a point whose first
        // listed owner is on this side.
        let (mut is_required, mut is_preferred) = ([false; 2], [false; 2]);
        let mut points: Vec<Point> =
            below.points.iter().chain(&above.points).map(|(p, _)| *p).collect();
        points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
        // Vertices that pieces share agree except for their last bits.
        let tolerance = 1e-12 * self.size;
        points.dedup_by(|p, q| (p[0] - q[0]).abs() < tolerance && (p[1] - q[1]).abs() < tolerance);
        for p in points {
            let [b, a] = [&below, &above]
                .map(|border_points| border_points.first_at(p, COINCIDENCE_FRACTION * self.size));
            let inside = [b, a].map(|rank| rank != usize::MAX);
            match (inside, b.cmp(&a)) {
                ([true, false], _) => is_required[0] = true,
                ([false, true], _) => is_required[1] = true,
                (_, Ordering::Less) => is_preferred[0] = true,
                (_, Ordering::Greater) => is_preferred[1] = true,
                _ => {}
            }
        }
        match (is_required, is_preferred) {
            ([true, true], _) => Zeros::Both,
            ([false, true], _) | ([false, false], [false, true]) => Zeros::Above,
            _ => Zeros::Below,
        }
    }

    /// Returns the points and edges of some pieces that lie on a curve.
    fn border_points(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> BorderPoints {
        let shape = &self.shapes[curve];
        let mut border_points = BorderPoints::default();
        for piece in pieces {
            let rank = piece.owner.unwrap_or(usize::MAX);
            let is_on_curve: Vec<bool> =
                piece.vertices.iter().map(|p| shape.side(*p, self.size) == 0).collect();
            for (k, p) in piece.vertices.iter().enumerate().filter(|(k, _)| is_on_curve[*k]) {
                border_points.points.push((*p, rank));
                let next = (k + 1) % is_on_curve.len();
                // The chord of a curved edge is on the curve only at its ends.
                if is_on_curve[next] && piece.edges[k] == Edge::Straight {
                    border_points.edges.push(([*p, piece.vertices[next]], rank));
                }
            }
        }
        border_points
    }

    /// Returns the owners of the points on a curve: at each, the first listed of those on both sides.
    pub(super) fn zero_set_tree(
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
        let [corners_below, corners_above] =
            [-1, 1].map(|side| self.corners_on(side, curve, corners));
        let none = SampleSubset::default();
        let below = self.tree(&below, &none, &corners_below, open.to_vec())?;
        let above = self.tree(&above, &none, &corners_above, open.to_vec())?;
        Ok(first(&below, &above))
    }
}

/// Points and straight edges on a curve, with the rank of their owner: its index in the list of regions, or
/// `usize::MAX` for the outside.
#[derive(Default)]
struct BorderPoints {
    points: Vec<(Point, usize)>,
    edges: Vec<([Point; 2], usize)>,
}

impl BorderPoints {
    /// Returns the rank of the first listed owner that touches a point.
    fn first_at(&self, p: Point, tolerance: f64) -> usize {
        let is_near = |q: Point| (p[0] - q[0]).abs() < tolerance && (p[1] - q[1]).abs() < tolerance;
        let points = self.points.iter().filter(|(q, _)| is_near(*q)).map(|(_, rank)| *rank);
        let edges = self
            .edges
            .iter()
            .filter(|(edge, _)| is_along(p, *edge, tolerance))
            .map(|(_, rank)| *rank);
        points.chain(edges).min().unwrap_or(usize::MAX)
    }
}

/// Returns a tree whose leaves are the first listed of the owners in two trees.
fn first(a: &Owners, b: &Owners) -> Owners {
    match a {
        Tree::Leaf(own) => {
            let rank = |owner: &Option<usize>| owner.unwrap_or(usize::MAX);
            let first_listed =
                |other: &Option<usize>| Some(if rank(other) < rank(own) { *other } else { *own });
            b.map(&first_listed).unwrap_or(Tree::Leaf(*own))
        }
        Tree::Split { curve, strict, below, above } => {
            let [low, high] = [true, false].map(|holds| b.simplified(*curve, *strict, holds));
            Tree::split(*curve, *strict, first(below, &low), first(above, &high))
        }
    }
}
