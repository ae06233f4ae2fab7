//! A tool known only by its depth function, which is not a distance, and by the function's Lipschitz constant.
//!
//! Depth changes by at most `L` times the displacement, which bounds it near a point. Tighter bounds come from
//! interval enclosures of the formula over the box of a piece: its values and, by the mean value theorem, its
//! slopes from the piece's middle. A triangle is halved, longest side first, until no piece can be deeper than
//! the deepest point found. Boxes of the tool itself are halved in the same way to find its deepest point.

use crate::certify::space::Point;
use crate::certify::tool_model::section::{Depth, Owners};
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch};
use crate::certify::triangle::{SubTriangle, TrianglePiece};
use crate::handle::ToolHandle;
use crate::interval::Interval;
use crate::tool::{
    EvaluationEnclosure, Evaluations, LANES, Outputs, PointBatch, Symmetry, ToolInfo,
};
use fearless_simd::Level;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A depth function with its bounds.
#[derive(Clone)]
pub(crate) struct Field<'a> {
    tool: ToolHandle<'a>,
    /// The Lipschitz constant `L` of depth, at least 1.
    pub(crate) steep: f64,
    /// The error bound of a depth.
    pub(crate) error: f64,
    pub(crate) level: Level,
}

/// An item of a search and an upper bound of the depth in it, by which items are ordered.
#[derive(Clone, Copy, Default)]
struct Bounded<T> {
    bound: f64,
    item: T,
}

impl<T> Ord for Bounded<T> {
    fn cmp(&self, other: &Bounded<T>) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl<T> PartialOrd for Bounded<T> {
    fn partial_cmp(&self, other: &Bounded<T>) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> PartialEq for Bounded<T> {
    fn eq(&self, other: &Bounded<T>) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T> Eq for Bounded<T> {}

/// Memory that a search keeps between triangles.
#[derive(Clone, Default)]
pub(crate) struct Scratch {
    /// The pieces that are still open, the deepest on top.
    pieces: BinaryHeap<Bounded<TrianglePiece>>,
    points: PointBatch,
    evaluations: Evaluations,
}

impl Scratch {
    /// Adds a triangle to the open pieces.
    pub(crate) fn hold(&mut self, corners: [Point; 3], index: u32) {
        let item = TrianglePiece { index, piece: SubTriangle::new(corners) };
        self.pieces.push(Bounded { bound: f64::INFINITY, item });
    }

    /// Drops all open pieces.
    pub(crate) fn clear(&mut self) {
        self.pieces.clear();
    }
}

impl<'a> Field<'a> {
    /// Creates the field of a tool; `None` if no Lipschitz constant of its depth is proved.
    pub(crate) fn new(tool: ToolHandle<'a>, level: Level) -> Option<Field<'a>> {
        let info = tool.info();
        let steep = info.depth.lipschitz?.max(1.0);
        // Let u be the unit roundoff. Halving rounds a midpoint by u of its distance from the tip. A relevant piece of
        // length `l` is no farther from the tip than √2 size + l. Two or three halvings of a triangle halve `l`, which
        // adds up to at most 10 u of the part's extent, and each later halving adds 1.5 u size. `rounding::point_error_bound` has
        // room for the first term, since no meridian is used here. 256 u size are 160 halvings: 120 of them end at
        // 2^-40 of the tool's size, the finest depth that is reported, and 10 u size are left for the middle and the
        // radius of the last piece.
        let error = info.depth.rounding + 128.0 * f64::EPSILON * steep * info.size();
        Some(Field { tool, steep, error, level })
    }

    /// Returns the depths of the points; outside, minus a lower bound of the distance from the tool.
    fn depths(&self, scratch: &mut Scratch, count: usize) -> [Depth; LANES] {
        let Scratch { points, evaluations, .. } = scratch;
        let ask = Outputs { depth: true, region: true, ..Outputs::INSIDE };
        self.tool.evaluate(self.level, ask, points, 1.0, evaluations);
        let lists = points.lists();
        let mut depths = [Depth { value: f64::NAN, gradient: [0.0; 2], feature: 0 }; LANES];
        for (lane, depth) in depths.iter_mut().enumerate().take(count) {
            if evaluations.inside[0] >> lane & 1 == 1 {
                depth.value = evaluations.depth[lane];
                depth.feature = evaluations.region[lane] as usize;
            } else {
                let point = [0, 1, 2].map(|axis| lists[axis][lane]);
                depth.value = -self.tool.clearance(point);
            }
        }
        depths
    }

    /// Returns the tool's info.
    pub(crate) fn info(&self) -> &ToolInfo {
        self.tool.info()
    }

    /// Returns the depth of a point.
    pub(crate) fn depth(&self, scratch: &mut Scratch, point: Point) -> Depth {
        scratch.points.clear();
        scratch.points.push(point);
        self.depths(scratch, 1)[0]
    }

    /// Returns the depth that a search inside or outside the tool compares: with `outside`, points inside count as 0.
    /// Otherwise the distance of a point outside is multiplied by the Lipschitz constant: over so much of a piece's
    /// reach depth does not rise above 0.
    fn searched_value(&self, depth: f64, outside: bool) -> f64 {
        match (outside, depth < 0.0) {
            (true, _) => depth.min(0.0),
            (false, true) => self.steep * depth,
            (false, false) => depth,
        }
    }

    /// Searches the open pieces, the deepest first. Returns the deepest point found if it is deeper than the best so
    /// far. With `outside`, where the best is below 0, returns the point nearest to the tool; points inside then
    /// count as 0.
    pub(crate) fn search_triangles(
        &self,
        search: &mut DepthSearch,
        scratch: &mut Scratch,
        owners: &Owners,
        outside: bool,
    ) -> Option<DeepestCandidate> {
        let mut best = None;
        loop {
            let mut candidates = [Bounded::<TrianglePiece>::default(); LANES];
            let (mut reach, mut count) = ([0.0; LANES], 0);
            let mut centres = [[0.0; 3]; LANES];
            scratch.points.clear();
            while count < LANES
                && let Some(candidate) = scratch.pieces.pop()
            {
                if candidate.bound <= search.threshold()
                    || search.is_done()
                    || !search.spend(candidate.bound)
                {
                    // The pieces come in order of their bounds: what holds for this one holds for the rest.
                    scratch.pieces.clear();
                    break;
                }
                let (centre, far) = candidate.item.piece.ball();
                scratch.points.push(centre);
                (candidates[count], centres[count], reach[count]) = (candidate, centre, far);
                count += 1;
            }
            if count == 0 {
                break;
            }
            let mut depths = self.depths(scratch, count);
            for (lane, depth) in depths.iter_mut().enumerate().take(count) {
                depth.value = self.searched_value(depth.value, outside);
                let point = centres[lane];
                if depth.value > search.best
                    && let Some(depth) = self.owned(scratch, owners, point, *depth)
                    && search.take(&depth)
                {
                    let (feature, index) = (depth.feature, candidates[lane].item.index);
                    best = Some(DeepestCandidate { point, feature, index });
                }
            }
            for lane in 0..count {
                let Bounded { bound: before, item: TrianglePiece { index, piece } } =
                    candidates[lane];
                let bound = depths[lane].value + self.steep * reach[lane] + self.error;
                let mut bound = before.min(bound);
                // Enclosures cost more than the evaluation did, and bound no distance.
                if bound > search.threshold() && !outside {
                    let closer = self.at_most(scratch, owners, &piece, centres[lane]);
                    bound = bound.min(closer);
                }
                if bound <= search.threshold() {
                    continue;
                }
                let count_before = scratch.pieces.len();
                scratch.pieces.extend(
                    piece
                        .halves()
                        .map(|piece| Bounded { bound, item: TrianglePiece { index, piece } }),
                );
                // A piece too short to be halved in `f64` stays open with its bound.
                if scratch.pieces.len() == count_before {
                    search.leave(bound);
                }
            }
        }
        best
    }
}

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
        if self.is_revolved() {
            let d = x.hypot(y);
            let Interval { low, high } = around(d, displacement);
            let sides =
                [Interval::new(low.max(0.0), high), Interval::default(), around(z, displacement)];
            return self.tool.enclose(sides, [d, 0.0, z], &mut scratch.evaluations);
        }
        let sides = [x, y, z].map(|at| around(at, displacement));
        self.tool.enclose(sides, [x, y, z], &mut scratch.evaluations)
    }

    /// Returns the depth of a point if owners have it, or have a point within the error bound of it.
    fn owned(
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
        // An enclosure may name an owner that has no point there, so a neighbour has to be owned.
        scratch.points.clear();
        for axis in 0..3 {
            for side in [-self.error, self.error] {
                let mut neighbour = point;
                neighbour[axis] += side;
                scratch.points.push(neighbour);
            }
        }
        let neighbours = self.depths(scratch, 6);
        let mut owned = neighbours[..6].iter().filter(|other| owners.is_owned(other.feature));
        let feature = owned.find(|other| other.value >= 0.0)?.feature;
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
    fn at_most(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        piece: &SubTriangle,
        from: Point,
    ) -> f64 {
        let corners = piece.corners();
        let far = from[0].hypot(from[1]);
        // The radial direction at the point. No point is nearer to the axis than its extent in that direction.
        let out = if far > 0.0 { [from[0] / far, from[1] / far] } else { [1.0, 0.0] };
        let outward = corners.map(|p| p[0] * out[0] + p[1] * out[1]);
        let z = hull(from[2], corners.map(|p| p[2]));
        let (sides, at) = if self.is_revolved() {
            let max_radius = hull(far, corners.map(|p| p[0].hypot(p[1]))).high;
            let min_radius = hull(far, outward).low.max(0.0);
            ([Interval::new(min_radius, max_radius), Interval::default(), z], [far, 0.0, from[2]])
        } else {
            let [x, y] = [0, 1].map(|k| hull(from[k], corners.map(|p| p[k])));
            ([x, y, z], from)
        };
        let Some(found) = self.tool.enclose(sides, at, &mut scratch.evaluations) else {
            return f64::INFINITY;
        };
        if !found.inside {
            // Nothing is inside, up to the error of a depth.
            return self.error;
        }
        if !owners.own_some(found.regions) {
            return f64::NEG_INFINITY;
        }
        let offsets = [0, 1, 2].map(|corner| {
            let p = corners[corner];
            let [x, y, z] = [0, 1, 2].map(|k| Interval::new(p[k] - from[k], p[k] - from[k]));
            if self.is_revolved() {
                // The distance from the axis is convex: its change is at most that at the corner, and at least that in
                // the radial direction.
                let max_change = p[0].hypot(p[1]) - far;
                let min_change = (outward[corner] - far).min(max_change);
                [Interval::new(min_change, max_change), Interval::default(), z]
            } else {
                [x, y, z]
            }
        });
        // Unknown slopes give NaN.
        found.max_depth().min(found.max_depth_in_hull(offsets)) + self.error
    }
}

/// The result of a search for the deepest point of some owners, in the tool's frame and unit.
pub(crate) enum DeepestPoint {
    /// A point, its depth, and an upper bound on the depth of all the owners' points.
    Found { point: Point, depth: Depth, max_depth: f64 },
    /// Proof that no point is deeper than the least depth asked for.
    NoneDeeper,
    /// No point was found before the budget was spent.
    BudgetSpent,
}

/// A box in the tool's frame.
#[derive(Clone, Copy)]
struct Cell {
    low: Point,
    high: Point,
}

impl Cell {
    /// Returns both halves of its longest side.
    fn halves(self) -> [Cell; 2] {
        let size = [0, 1, 2].map(|k| self.high[k] - self.low[k]);
        let longest = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
        let middle = f64::midpoint(self.low[longest], self.high[longest]);
        let (mut lower, mut upper) = (self, self);
        lower.high[longest] = middle;
        upper.low[longest] = middle;
        [lower, upper]
    }
}

/// The number of boxes that are examined before the search gives up.
const BUDGET: u32 = 1 << 18;

impl Field<'_> {
    /// Searches for a point of the owners that is deeper than `min_depth`. The bound on the depth of all their points is
    /// at most `factor`, which is more than 1, times the depth found unless the budget is spent first.
    pub(crate) fn deepest(&self, owners: &Owners, min_depth: f64, factor: f64) -> DeepestPoint {
        let info = self.info();
        let Interval { low: bottom, high: top } = info.reach();
        // For a tool with an axis the half plane is enough.
        let [x, y] = match info.symmetry {
            Symmetry::Revolved => [Interval::new(0.0, info.radius()), Interval::default()],
            Symmetry::Solid { extent } => extent,
        };
        let (low, high) = ([x.low, y.low, bottom], [x.high, y.high, top]);
        let mut scratch = Scratch::default();
        let mut cells =
            BinaryHeap::from([Bounded { bound: f64::INFINITY, item: Cell { low, high } }]);
        let mut best: Option<(Point, Depth)> = None;
        for _ in 0..BUDGET {
            let deepest = best.map_or(0.0, |(_, depth)| depth.value);
            let Some(Bounded { bound, item: cell }) = cells.pop() else { break };
            let Cell { low, high } = cell;
            if bound <= min_depth || (deepest > min_depth && bound <= factor * deepest) {
                return match best.filter(|_| deepest > min_depth) {
                    Some((point, depth)) => {
                        DeepestPoint::Found { point, depth, max_depth: depth.value.max(bound) }
                    }
                    None => DeepestPoint::NoneDeeper,
                };
            }
            let middle = [0, 1, 2].map(|k| f64::midpoint(low[k], high[k]));
            let size = [0, 1, 2].map(|k| high[k] - low[k]);
            let reach = 0.5 * size.iter().map(|side| side * side).sum::<f64>().sqrt();
            let depth = self.depth(&mut scratch, middle);
            if depth.value > deepest
                && let Some(depth) = self.owned(&mut scratch, owners, middle, depth)
            {
                best = Some((middle, depth));
            }
            if self.passes(&mut scratch, owners, middle, reach, min_depth) {
                continue;
            }
            // The depth of a point outside is minus a lower bound of its distance, and depth grows from the surface
            // inward.
            let bound = bound.min(depth.value + self.steep * reach);
            cells.extend(cell.halves().map(|item| Bounded { bound, item }));
        }
        // No owner's point outside the cells that are left is deeper than the best one, or than `min_depth`.
        let max_remaining = cells.peek().map_or(0.0, |cell| cell.bound);
        match best.filter(|(_, depth)| depth.value > min_depth) {
            Some((point, depth)) => {
                DeepestPoint::Found { point, depth, max_depth: depth.value.max(max_remaining) }
            }
            // Every box was discarded: none has an owner's point that is deeper.
            None if cells.is_empty() => DeepestPoint::NoneDeeper,
            None => DeepestPoint::BudgetSpent,
        }
    }
}

/// Returns the interval about a number.
fn around(at: f64, displacement: f64) -> Interval {
    Interval::new(at - displacement, at + displacement)
}

/// Returns the hull of a number and of three more.
fn hull(at: f64, [a, b, c]: [f64; 3]) -> Interval {
    Interval::new(at.min(a).min(b).min(c), at.max(a).max(b).max(c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::{Certifier, PoseVerdict, TriangleBvh};
    use crate::mesh::shapes;
    use crate::tool::Interpreted;
    use crate::{Pose, Unit};
    use fearless_simd::Level;
    use nalgebra::{Point3, Vector3};
    use std::sync::LazyLock;

    static SPHERE: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Sphere "a ball of radius 1" {
            units mm;
            tip z = -1;
            curve sphere = hypot(d, z) - 1;
            region sphere where sphere <= 0 {
                depth: -sphere;
                direction: away from (0, 0);
            }
        }"#
        .parse()
        .expect("a tool")
    });

    #[test]
    fn a_search_that_discards_every_box_proves_that_no_point_is_deeper() {
        let field =
            Field::new(ToolHandle::Borrowed(&*SPHERE), Level::new()).expect("a Lipschitz constant");
        let of_regions = |is_owned: bool| Owners::of_regions(field.info(), |_, _| is_owned);
        let DeepestPoint::Found { depth, max_depth, .. } =
            field.deepest(&of_regions(true), 0.5, 1.01)
        else {
            panic!("the centre is 1 deep")
        };
        assert!(depth.value <= 1.0 && 1.0 <= max_depth && max_depth <= 1.01 * depth.value);
        let deeper = field.deepest(&of_regions(true), 100.0, 1.01);
        assert!(matches!(deeper, DeepestPoint::NoneDeeper));
        let without_owners = field.deepest(&of_regions(false), 0.0, 1.01);
        assert!(matches!(without_owners, DeepestPoint::NoneDeeper));
    }

    #[test]
    fn a_tool_that_is_allowed_more_than_its_depth_is_clear()
    -> Result<(), Box<dyn std::error::Error>> {
        let (low, high) = (Point3::new(-5.0, -5.0, -5.0), Point3::new(5.0, 5.0, 0.0));
        let block = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
        let mut certifier = Certifier::new(&block, &*SPHERE)?.with_allowance("sphere", 100.0)?;
        let pose = Pose::from_axis(Point3::new(0.0, 0.0, 3.0), Vector3::z())?;
        assert!(matches!(certifier.check_pose(&pose), PoseVerdict::Clear));
        Ok(())
    }
}
