//! Corners where pieces meet. Leaves return points that rounding may bring astray near a corner to one of its
//! owners.

use super::Tree;
use super::section::{Owners, Planner};
use crate::formula::CurveIndex;
use crate::geometry::cut::{Cut, Cutter, NEAR, Piece};
use crate::geometry::outline::{Point, minus};
use crate::geometry::shape::CurveFunction;
use std::rc::Rc;

/// A point where pieces meet, with the owners of these pieces.
pub(super) struct Corner {
    at: Point,
    owners: Vec<Option<usize>>,
}

/// Returns the points where whole pieces meet. Each piece comes with its bounding box.
pub(super) fn corners(
    mut places: Vec<Point>,
    whole: &[(Rc<Piece>, [Point; 2])],
    (shapes, size): (&[CurveFunction<'_>], f64),
) -> Vec<Corner> {
    let close = NEAR * size;
    let near = |p: Point, q: Point| (p[0] - q[0]).abs() < close && (p[1] - q[1]).abs() < close;
    places.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    places.dedup_by(|p, q| near(*p, *q));
    let corner = |at: Point| {
        let mut owners = Vec::new();
        for (piece, [middle, half]) in whole {
            let [u, v] = minus(at, *middle);
            if u.abs() <= half[0] + close
                && v.abs() <= half[1] + close
                && !owners.contains(&piece.owner)
                && (piece.vertices.iter().any(|p| near(*p, at))
                    || piece.has_on_edge(at, shapes, size))
            {
                owners.push(piece.owner);
            }
        }
        Corner { at, owners }
    };
    places.into_iter().map(corner).collect()
}

impl Planner<'_> {
    /// Returns the corners that rounding may place on a side of a curve.
    pub(super) fn corners_on(&self, side: i8, curve: CurveIndex, corners: &[usize]) -> Vec<usize> {
        let there = |at: &usize| self.shapes[curve].side(self.corners[*at].at, self.size) != -side;
        corners.iter().copied().filter(there).collect()
    }

    /// Returns a leaf for an owner, with the corners split off at which only pieces of other owners meet.
    /// Rounding may bring a point near such a corner here, where its owner has no piece.
    pub(super) fn leaf(
        &self,
        owner: Option<usize>,
        pieces: &[Rc<Piece>],
        corners: &[usize],
    ) -> Owners {
        let stray = |at: &&usize| !self.corners[**at].owners.contains(&owner);
        let Some(corner) = corners.iter().find(stray).map(|at| &self.corners[*at]) else {
            return Tree::Leaf(owner);
        };
        let Some(first) = corner.owners.first() else { return Tree::Leaf(owner) };
        if pieces.is_empty() {
            return Tree::Leaf(*first);
        }
        let mut curves: Vec<(CurveIndex, i8)> = (0..self.shapes.len())
            .map(|curve| (curve, self.shapes[curve].side(corner.at, self.size)))
            .filter(|(_, side)| *side != 0)
            .collect();
        curves.sort_by(|a, b| self.costs[a.0].total_cmp(&self.costs[b.0]));
        let apart = curves.into_iter().find(|(curve, side)| {
            let cutter = Cutter { shapes: self.shapes, curve: *curve, size: self.size };
            let off = |piece: &Rc<Piece>| match piece.cut(cutter) {
                Cut::Below => *side > 0,
                Cut::Above => *side < 0,
                Cut::Nothing => true,
                Cut::Both(..) => false,
            };
            pieces.iter().all(off)
        });
        let Some((curve, side)) = apart else { return Tree::Leaf(owner) };
        let [here, there] = [side, -side].map(|side| self.corners_on(side, curve, corners));
        let (here, there) = (self.leaf(*first, &[], &here), self.leaf(owner, pieces, &there));
        let (below, above) = if side < 0 { (here, there) } else { (there, here) };
        Tree::split(curve, side < 0, below, above)
    }
}
