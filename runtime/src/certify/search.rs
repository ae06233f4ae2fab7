//! The branch-and-bound search of a part's triangles, and the state that it keeps between queries.

use crate::bvh::{PoseTransform, QuerySetup};
use crate::certify::bounds::batch::Batch;
use crate::certify::bounds::descent::Descent;
use crate::certify::part::{TriangleBvh, flat};
use crate::certify::query::DepthQuery;
#[cfg(feature = "postures")]
use crate::certify::space::Point;
use crate::certify::tool_model::ToolModel;
use crate::certify::tool_model::field::Scratch;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch, Goal, LineMaximum};
use crate::certify::triangle::local::{LocalTriangle, nearest};
use crate::certify::verdict::Witness;
use crate::id::TriangleId;
use crate::pose::Pose;
use crate::tool::LANES;
use fearless_simd::Level;
use nalgebra::Vector3;

/// The data that all queries of a tool at a part share. Lengths are in the tool's unit.
pub(crate) struct QuerySetting<'a> {
    pub(crate) bvh: &'a TriangleBvh,
    pub(crate) body: ToolModel<'a>,
    /// The extent of the tool from its tip, along the axis or away from it.
    pub(crate) size: f64,
    /// True if the depth of a point outside is the negative of its exact distance.
    pub(crate) exact: bool,
    pub(crate) setup: QuerySetup,
    pub(crate) level: Level,
    /// The tool's unit of length in the part's unit.
    pub(crate) length: f64,
    /// The rounding error bound of a point.
    pub(crate) error: f64,
}

impl QuerySetting<'_> {
    /// Makes the query for some surfaces, given by their indices in the tool's list. For a tool without a profile the
    /// limit must be at least 0.
    pub(crate) fn depth_query(&self, limit: f64, surfaces: impl Fn(usize) -> bool) -> DepthQuery {
        let margin = self.setup.margin;
        match &self.body {
            ToolModel::Profile(section) => DepthQuery::new(section, margin, limit, surfaces),
            ToolModel::Field(field) => {
                DepthQuery::of_field(field, [margin, self.error], limit, surfaces)
            }
        }
    }

    /// Sets the pose, and returns whether the tool may reach the part there.
    pub(crate) fn set_pose(&self, work: &mut SearchState, pose: &Pose) -> bool {
        self.setup.set_pose(&self.bvh.frame, pose, &mut work.view)
    }

    /// Returns a candidate as a point of the part in world coordinates, with its triangle and the tool's surface.
    pub(crate) fn witness(&self, best: &DeepestCandidate, pose: &Pose) -> Witness {
        Witness {
            point: pose.tip() + pose.rotation() * Vector3::from(best.point) * self.length,
            triangle: TriangleId(self.bvh.ids[best.index as usize]),
            surface: self.body.surface(best.feature),
        }
    }

    /// Returns the largest error of a bound in `f32`: planes have slopes of at most 2, so their errors are three
    /// times those of a point, plus a few roundings.
    pub(crate) fn margin(&self) -> f64 {
        if self.setup.fits {
            4.0 * self.body.lipschitz() * self.setup.margin
        } else {
            f64::INFINITY
        }
    }
}

/// The state and the result of a search.
#[derive(Default)]
pub(crate) struct SearchState {
    pub(crate) view: PoseTransform,
    pub(crate) search: DepthSearch,
    pub(crate) descent: Descent,
    batch: Batch,
    faces: Faces,
    scratch: Scratch,
    pub(crate) best: Option<DeepestCandidate>,
    /// The largest skew of a triangle examined.
    pub(crate) skew: f64,
    /// The triangle at which the last query ended.
    last: Option<u32>,
}

/// The depth bounds of the part's flat faces, computed on first use in a query.
#[derive(Default)]
struct Faces {
    batch: Batch,
    /// The number of the query, and per face the last query that asked for it and its bound.
    question: u32,
    known: Vec<(u32, f64)>,
}

impl Faces {
    fn begin(&mut self, bvh: &TriangleBvh) {
        self.question = self.question.wrapping_add(1);
        if self.question == 0 || self.known.len() != bvh.flats.faces.len() {
            self.question = 1;
            self.known.clear();
            self.known.resize(bvh.flats.faces.len(), (0, 0.0));
        }
    }

    /// Returns an upper bound on the depth of some faces.
    fn depth(
        &mut self,
        of: &QuerySetting<'_>,
        question: &DepthQuery,
        (pose, view): (&Pose, &PoseTransform),
        faces: &[u32],
    ) -> f64 {
        let more = of.body.lipschitz() * flat(&of.bvh.frame) / of.length;
        let mut most = f64::NEG_INFINITY;
        for some in faces.chunks(LANES / 2) {
            self.batch.clear();
            for face in some {
                let (asked, depth) = self.known[*face as usize];
                if asked == self.question {
                    most = most.max(depth);
                } else {
                    self.batch.rectangle(&of.bvh.flats.faces[*face as usize], (pose, *face));
                }
            }
            if self.batch.len() == 0 {
                continue;
            }
            self.batch.turn(view);
            self.batch.bound(of.level, &question.exact, f64::NEG_INFINITY);
            for half in (0..self.batch.len()).step_by(2) {
                let depth = self.batch.bounds[half].max(self.batch.bounds[half + 1]) + more;
                self.known[self.batch.index(half) as usize] = (self.question, depth);
                most = most.max(depth);
            }
        }
        most
    }
}

/// The side of the tool's surface that is searched: inside, or outside if no point is inside.
#[derive(Clone, Copy)]
enum Side {
    Inside,
    Outside,
}

impl SearchState {
    /// Searches for the deepest point.
    pub(crate) fn inside(
        &mut self,
        of: &QuerySetting<'_>,
        question: &DepthQuery,
        pose: &Pose,
        goal: Goal,
    ) {
        self.best = None;
        self.skew = 0.0;
        self.search.begin(goal);
        self.descent.clear();
        if !of.set_pose(self, pose) {
            return;
        }
        // The triangle that was deepest last time is likely to be deep again.
        if let Some(last) = self.last {
            self.batch.begin(of.bvh, pose, &[last]);
            self.bound_batch(of, question);
        }
        self.descend(of, question, pose, Side::Inside, of.margin());
    }

    /// Searches for the nearest point, if no point is inside. The pose must be set.
    pub(crate) fn outside(
        &mut self,
        of: &QuerySetting<'_>,
        question: &DepthQuery,
        pose: &Pose,
        goal: Goal,
    ) {
        let margin = of.margin() + self.far() / f64::from(1 << 20);
        self.best = None;
        self.search.begin(goal);
        if let Some(last) = self.last {
            self.batch.begin(of.bvh, pose, &[last]);
            self.search_outside(of, question);
        }
        self.descend(of, question, pose, Side::Outside, margin);
    }

    /// Resets the starting triangle, as if no query had been made.
    #[cfg(feature = "postures")]
    pub(crate) fn forget(&mut self) {
        self.last = None;
    }

    /// Returns the depth of a point in the tool's frame if it is owned, or less than 0.
    #[cfg(feature = "postures")]
    pub(crate) fn depth(
        &mut self,
        of: &QuerySetting<'_>,
        question: &DepthQuery,
        place: Point,
    ) -> f64 {
        let depth = of.body.depth(&mut self.scratch, &question.owners, place);
        depth.map_or(f64::NEG_INFINITY, |depth| depth.value)
    }

    /// Returns the largest coordinate of the part's origin in the tool's frame and unit.
    pub(crate) fn far(&self) -> f64 {
        self.view.origin.iter().fold(0.0, |far: f64, part| far.max(f64::from(part.abs())))
    }

    /// Traverses the tree. `margin` is the error bound of depths in `f32`.
    fn descend(
        &mut self,
        of: &QuerySetting<'_>,
        question: &DepthQuery,
        pose: &Pose,
        side: Side,
        margin: f64,
    ) {
        self.descent.begin();
        self.faces.begin(of.bvh);
        self.scratch.clear();
        let mut opened = 0;
        while let Some(node) = self.descent.pop() {
            if self.search.enough() {
                break;
            }
            let bound = f64::from(node.bound) + margin;
            if bound <= self.search.wanted() || !self.search.spend(bound) {
                continue;
            }
            let wanted = (self.search.wanted() - margin) as f32;
            if node.is_triangle(of.bvh) {
                let some = self.descent.triangles(of.bvh, node, wanted);
                if let Side::Inside = side
                    && opened > TIED
                {
                    some.retain(|index| {
                        of.bvh.flats.of_triangle(*index).is_none_or(|face| {
                            let view = (pose, &self.view);
                            self.faces.depth(of, question, view, &[face]) > self.search.wanted()
                        })
                    });
                }
                if some.is_empty() {
                    continue;
                }
                self.batch.begin(of.bvh, pose, some);
                match side {
                    Side::Inside => self.search_batch(of, question),
                    Side::Outside => self.search_outside(of, question),
                }
                continue;
            }
            let (level, bvh, view) = (of.level, of.bvh, &self.view);
            // The plane of a node may decide where `f32` or the boxes cannot.
            opened += 1;
            if let Side::Inside = side
                && opened > TIED
                && let Some(faces) = node.faces(bvh)
                && self.faces.depth(of, question, (pose, &self.view), faces) <= self.search.wanted()
            {
                continue;
            }
            if let Side::Inside = side
                && (bound - 2.0 * margin <= self.search.wanted() || opened > MANY)
                && let Some(ring) = node.ring(bvh, view)
                && question.exact.of_ring(&ring) <= self.search.wanted()
            {
                continue;
            }
            let descent = &mut self.descent;
            match side {
                _ if margin > MARGIN => descent.open_all(bvh, node),
                Side::Inside => descent.open(level, (bvh, &question.hull, view), node, wanted),
                Side::Outside => descent.open(level, (bvh, &question.shell, view), node, wanted),
            }
        }
        if let ToolModel::Field(field) = &of.body {
            let outside = matches!(side, Side::Outside);
            let scratch = &mut self.scratch;
            let found = field.look(&mut self.search, scratch, &question.owners, outside);
            self.best = found.or(self.best);
        }
        self.last = self.best.map(|best| best.index);
    }

    /// Bounds the triangles of the batch and evaluates the points where they may be deepest.
    fn bound_batch(&mut self, of: &QuerySetting<'_>, question: &DepthQuery) {
        self.batch.turn(&self.view);
        self.batch.bound(of.level, &question.exact, self.search.wanted());
        self.evaluate_candidates(of, question);
    }

    /// Searches the triangles of the batch, which are outside the tool.
    fn search_outside(&mut self, of: &QuerySetting<'_>, question: &DepthQuery) {
        self.batch.turn(&self.view);
        for lane in 0..self.batch.len() {
            if self.search.spend(0.0) {
                self.search_triangle(of, question, (lane, Side::Outside));
            }
        }
    }

    fn evaluate_candidates(&mut self, of: &QuerySetting<'_>, question: &DepthQuery) {
        for lane in 0..self.batch.len() {
            if self.batch.bounds[lane] > self.search.wanted() {
                // For a thin triangle the point may lie off the triangle.
                let point = nearest(self.batch.place(lane), &self.batch.corners(lane));
                let index = self.batch.index(lane);
                if let Some(depth) = of.body.depth(&mut self.scratch, &question.owners, point)
                    && self.search.take(&depth)
                {
                    self.best = Some(DeepestCandidate { point, feature: depth.feature, index });
                }
            }
        }
    }

    /// Searches the triangles of the batch until none can be deeper.
    fn search_batch(&mut self, of: &QuerySetting<'_>, question: &DepthQuery) {
        self.bound_batch(of, question);
        for _ in 0..LOOKS {
            if !self.batch.any_above(self.search.wanted()) {
                return;
            }
            self.batch.closer(of.level, &question.exact, self.search.wanted());
            self.evaluate_candidates(of, question);
        }
        for lane in 0..self.batch.len() {
            let bound = self.batch.bounds[lane];
            if bound > self.search.wanted() && self.search.spend(bound) {
                self.search_triangle(of, question, (lane, Side::Inside));
            }
        }
    }

    /// Searches one triangle of the batch. For a tool without a profile all triangles are searched together later.
    fn search_triangle(
        &mut self,
        of: &QuerySetting<'_>,
        question: &DepthQuery,
        (lane, side): (usize, Side),
    ) {
        let (corners, index) = (self.batch.corners(lane), self.batch.index(lane));
        let section = match &of.body {
            ToolModel::Profile(section) => section,
            ToolModel::Field(_) => return self.scratch.hold(corners, index),
        };
        let facet = LocalTriangle::new(corners);
        self.skew = self.skew.max(facet.skew);
        let owners = &question.owners;
        let heights = section.circles.iter().chain(&owners.peaks);
        let levels = heights.filter_map(|height| facet.level(*height));
        // Points beside the computed meridian may be deeper by the skew. Contact checks start lower by two errors,
        // which covers a skew up to one error; a larger skew lowers the threshold for this triangle.
        let best = self.best;
        let known = facet.skew <= of.error;
        let before = if known { None } else { self.search.lower(facet.skew) };
        for course in facet.search_lines().chain(levels) {
            let found = match side {
                Side::Inside => self.search.inside((section, owners, facet.skew), &course),
                Side::Outside => self.search.outside((section, owners), &course),
            };
            if let Some(LineMaximum { t, feature }) = found {
                self.best = Some(DeepestCandidate { point: course.point(t), feature, index });
            }
        }
        if before.is_some_and(|before| self.search.raise(before, facet.skew)) {
            self.best = best;
        }
    }
}

/// A query that opened more nodes than these has many of equal depth.
const MANY: usize = 24;

/// A query that opened more nodes than these is likely to have equal depths along flat faces.
const TIED: usize = 128;

/// With a larger margin `f32` decides nothing, and squares overflow in it.
pub(crate) const MARGIN: f64 = 1e9;

/// The number of refined bounds before the edges of triangles are searched.
const LOOKS: usize = 2;
