//! Interval enclosures of a tool's formula over boxes: upper bounds of depth, and the regions that have points in
//! a box.

use crate::certify::space::Point;
use crate::certify::tool_model::field::{Field, Scratch};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Depth;
use crate::certify::triangle::subdivision::SubTriangle;
use crate::interval::Interval;
use crate::tool::{EvaluationEnclosure, Symmetry};

impl Field<'_> {
    fn is_revolved(&self) -> bool {
        self.info().symmetry == Symmetry::Revolved
    }

    /// Encloses the evaluation of all points within a distance of a point.
    fn about(
        &self,
        scratch: &mut Scratch,
        [x, y, z]: Point,
        displacement: f64,
    ) -> Option<EvaluationEnclosure> {
        let around = |at: f64| Interval::new(at - displacement, at + displacement);
        if self.is_revolved() {
            let d = x.hypot(y);
            let Interval { low, high } = around(d);
            let sides = [Interval::new(low.max(0.0), high), Interval::default(), around(z)];
            return self.tool.enclose(sides, [d, 0.0, z], &mut scratch.evaluations);
        }
        self.tool.enclose([around(x), around(y), around(z)], [x, y, z], &mut scratch.evaluations)
    }

    /// Returns the depth of a point if owners have it, or have a point within the error bound of it.
    pub(super) fn owned(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
        depth: Depth,
    ) -> Option<Depth> {
        if depth.value < 0.0 || owners.is_owned(depth.feature) {
            return Some(depth);
        }
        if !owners.own_some(self.about(scratch, point, self.error)?.regions) {
            return None;
        }
        // One of its neighbours has to be owned.
        scratch.points.clear();
        for axis in 0..3 {
            for side in [-self.error, self.error] {
                let mut neighbour = point;
                neighbour[axis] += side;
                scratch.points.push(neighbour);
            }
        }
        let neighbours = self.depths(scratch, 6);
        let own = |other: &&Depth| other.value >= 0.0 && owners.is_owned(other.feature);
        let feature = neighbours[..6].iter().find(own)?.feature;
        Some(Depth { feature, ..depth })
    }

    /// Returns the depth of a point if it is owned or outside; otherwise less than 0.
    pub(crate) fn depth_of(&self, scratch: &mut Scratch, owners: &Owners, point: Point) -> Depth {
        let depth = self.depth(scratch, point);
        let none = Depth { value: f64::NEG_INFINITY, ..depth };
        self.owned(scratch, owners, point, depth).unwrap_or(none)
    }

    /// Returns whether no point within a distance of another is owned and deeper than a limit.
    pub(crate) fn passes(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
        displacement: f64,
        limit: f64,
    ) -> bool {
        self.about(scratch, point, displacement).is_some_and(|found| {
            let deep = found.max_depth() + self.error > limit;
            !(found.inside && owners.own_some(found.regions) && deep)
        })
    }

    /// Returns at least the depth of every owned point of a piece. `from` is a point of the piece.
    pub(super) fn at_most(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        piece: &SubTriangle,
        from: Point,
    ) -> f64 {
        let corners = piece.corners();
        let span = |at: f64, of: &dyn Fn(&Point) -> f64| {
            let [a, b, c] = corners.each_ref().map(of);
            Interval::new(at.min(a).min(b).min(c), at.max(a).max(b).max(c))
        };
        let far = from[0].hypot(from[1]);
        // The radial direction at the point. No point is nearer to the axis than its extent in that direction.
        let out = if far > 0.0 { [from[0] / far, from[1] / far] } else { [1.0, 0.0] };
        let outward = |p: &Point| p[0] * out[0] + p[1] * out[1];
        let z = span(from[2], &|p| p[2]);
        let (sides, at) = if self.is_revolved() {
            let max_radius = span(far, &|p| p[0].hypot(p[1])).high;
            let min_radius = span(far, &outward).low.max(0.0);
            ([Interval::new(min_radius, max_radius), Interval::default(), z], [far, 0.0, from[2]])
        } else {
            ([span(from[0], &|p| p[0]), span(from[1], &|p| p[1]), z], from)
        };
        let Some(found) = self.tool.enclose(sides, at, &mut scratch.evaluations) else {
            return f64::INFINITY;
        };
        if !found.inside {
            return self.error;
        }
        if !owners.own_some(found.regions) {
            return f64::NEG_INFINITY;
        }
        let offsets = corners.map(|p| {
            let along = |k: usize| Interval::new(p[k] - from[k], p[k] - from[k]);
            if self.is_revolved() {
                // The distance from the axis is convex: its change is at most that at the corner, and at least that in
                // the radial direction.
                let max_change = p[0].hypot(p[1]) - far;
                let min_change = (outward(&p) - far).min(max_change);
                [Interval::new(min_change, max_change), Interval::default(), along(2)]
            } else {
                [along(0), along(1), along(2)]
            }
        });
        // Unknown slopes give NaN.
        found.max_depth().min(found.max_depth_in_hull(offsets)) + self.error
    }
}
