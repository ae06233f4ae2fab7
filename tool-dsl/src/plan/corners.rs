//! Corners where pieces meet. Leaves return points that rounding may bring astray near a corner to one of its
//! owners.

use super::Tree;
use super::section::{Owners, Planner};
use crate::formula::CurveIndex;
use crate::geometry::cut::{COINCIDENCE_FRACTION, Cut, Cutter, Piece};
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
    mut points: Vec<Point>,
    whole: &[(Rc<Piece>, [Point; 2])],
    shapes: &[CurveFunction<'_>],
    size: f64,
) -> Vec<Corner> {
    let tolerance = COINCIDENCE_FRACTION * size;
    let are_near =
        |p: Point, q: Point| (p[0] - q[0]).abs() < tolerance && (p[1] - q[1]).abs() < tolerance;
    points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    points.dedup_by(|p, q| are_near(*p, *q));
    let corner = |point: Point| {
        let mut owners = Vec::new();
        for (piece, [middle, half]) in whole {
            let [u, v] = minus(point, *middle);
            if u.abs() <= half[0] + tolerance
                && v.abs() <= half[1] + tolerance
                && !owners.contains(&piece.owner)
                && (piece.vertices.iter().any(|p| are_near(*p, point))
                    || piece.has_on_edge(point, shapes, size))
            {
                owners.push(piece.owner);
            }
        }
        Corner { at: point, owners }
    };
    points.into_iter().map(corner).collect()
}

impl Planner<'_> {
    /// Returns the corners that rounding may place on a side of a curve.
    pub(super) fn corners_on(&self, side: i8, curve: CurveIndex, corners: &[usize]) -> Vec<usize> {
        let is_on_side =
            |at: &usize| self.shapes[curve].side(self.corners[*at].at, self.size) != -side;
        corners.iter().copied().filter(is_on_side).collect()
    }

    /// Returns a leaf for an owner, with the corners split off at which only pieces of other owners meet.
    /// Rounding may bring a point near such a corner here, where its owner has no piece.
    pub(super) fn leaf(
        &self,
        owner: Option<usize>,
        pieces: &[Rc<Piece>],
        corners: &[usize],
    ) -> Owners {
        let is_foreign = |at: &&usize| !self.corners[**at].owners.contains(&owner);
        let Some(corner) = corners.iter().find(is_foreign).map(|at| &self.corners[*at]) else {
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
        let separating = curves.into_iter().find(|(curve, side)| {
            let cutter = Cutter { shapes: self.shapes, curve: *curve, size: self.size };
            let is_on_other_side = |piece: &Rc<Piece>| match piece.cut(cutter) {
                Cut::Below => *side > 0,
                Cut::Above => *side < 0,
                Cut::Nothing => true,
                Cut::Both(..) => false,
            };
            pieces.iter().all(is_on_other_side)
        });
        let Some((curve, side)) = separating else { return Tree::Leaf(owner) };
        let [corners_here, corners_beyond] =
            [side, -side].map(|side| self.corners_on(side, curve, corners));
        let (corners_here, corners_beyond) =
            (self.leaf(*first, &[], &corners_here), self.leaf(owner, pieces, &corners_beyond));
        let (below, above) =
            if side < 0 { (corners_here, corners_beyond) } else { (corners_beyond, corners_here) };
        Tree::split(curve, side < 0, below, above)
    }
}
