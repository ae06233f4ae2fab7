//! What a tool's formula says of boxes: how deep places are at most, and which regions have them.

use crate::certify::body::field::{Field, Scratch};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::Depth;
use crate::certify::space::Point;
use crate::certify::triangle::piece::Piece;
use crate::tool::{Enclosed, Shape};

impl Field<'_> {
    fn is_revolved(&self) -> bool {
        self.card().shape == Shape::Revolved
    }

    /// What is felt within a distance of a place.
    fn about(&self, scratch: &mut Scratch, [x, y, z]: Point, goes: f64) -> Option<Enclosed> {
        let around = |at: f64| [at - goes, at + goes];
        if self.is_revolved() {
            let d = x.hypot(y);
            let [low, high] = around(d);
            let sides = [[low.max(0.0), high], [0.0; 2], around(z)];
            return self.tool.enclose(sides, [d, 0.0, z], &mut scratch.felt);
        }
        self.tool.enclose([around(x), around(y), around(z)], [x, y, z], &mut scratch.felt)
    }

    /// How deep a place is, if owners have it, or a place beside it that is as near as places are known.
    pub(super) fn owned(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
        depth: Depth,
    ) -> Option<Depth> {
        if depth.value < 0.0 || owners.own(depth.feature) {
            return Some(depth);
        }
        if !owners.own_some(self.about(scratch, point, self.error)?.regions) {
            return None;
        }
        // One of its neighbours has to be.
        scratch.points.clear();
        for axis in 0..3 {
            for side in [-self.error, self.error] {
                let mut beside = point;
                beside[axis] += side;
                scratch.points.push(beside);
            }
        }
        let beside = self.depths(scratch, 6);
        let own = |other: &&Depth| other.value >= 0.0 && owners.own(other.feature);
        let feature = beside[..6].iter().find(own)?.feature;
        Some(Depth { feature, ..depth })
    }

    /// How deep owners are at a place, or less than 0.
    pub(crate) fn depth_of(&self, scratch: &mut Scratch, owners: &Owners, point: Point) -> Depth {
        let depth = self.depth(scratch, point);
        let none = Depth { value: f64::NEG_INFINITY, ..depth };
        self.owned(scratch, owners, point, depth).unwrap_or(none)
    }

    /// Whether no place within a distance of another is deeper than a limit and owned.
    pub(crate) fn passes(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
        (goes, limit): (f64, f64),
    ) -> bool {
        self.about(scratch, point, goes).is_some_and(|found| {
            let deep = found.most() + self.error > limit;
            !(found.inside && owners.own_some(found.regions) && deep)
        })
    }

    /// No less than the depth of any place of a piece that owners have, given a place of it.
    pub(super) fn at_most(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        piece: &Piece,
        from: Point,
    ) -> f64 {
        let corners = piece.corners();
        let span = |at: f64, of: &dyn Fn(&Point) -> f64| {
            let [a, b, c] = corners.each_ref().map(of);
            [at.min(a).min(b).min(c), at.max(a).max(b).max(c)]
        };
        let far = from[0].hypot(from[1]);
        // Away from the axis as seen from the place; no place is nearer to the axis than it is out that way.
        let out = if far > 0.0 { [from[0] / far, from[1] / far] } else { [1.0, 0.0] };
        let outward = |p: &Point| p[0] * out[0] + p[1] * out[1];
        let z = span(from[2], &|p| p[2]);
        let (sides, at) = if self.is_revolved() {
            let most = span(far, &|p| p[0].hypot(p[1]))[1];
            let least = span(far, &outward)[0].max(0.0);
            ([[least, most], [0.0; 2], z], [far, 0.0, from[2]])
        } else {
            ([span(from[0], &|p| p[0]), span(from[1], &|p| p[1]), z], from)
        };
        let Some(found) = self.tool.enclose(sides, at, &mut scratch.felt) else {
            return f64::INFINITY;
        };
        if !found.inside {
            return self.error;
        }
        if !owners.own_some(found.regions) {
            return f64::NEG_INFINITY;
        }
        let ways = corners.map(|p| {
            let along = |k: usize| [p[k] - from[k]; 2];
            if self.is_revolved() {
                // The distance from the axis is convex: it grows by no more than to the corner, and by no less
                // than outward.
                let most = p[0].hypot(p[1]) - far;
                [[(outward(&p) - far).min(most), most], [0.0; 2], along(2)]
            } else {
                [along(0), along(1), along(2)]
            }
        });
        // Slopes that are not known make no number.
        found.most().min(found.most_between(ways)) + self.error
    }
}
