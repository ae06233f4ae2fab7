//! The branch-and-bound search of a part's triangles, and the state that it keeps between queries.

use crate::bvh::{PoseTransform, QuerySetup};
use crate::certify::bounds::batch::Batch;
use crate::certify::bounds::descent::Descent;
use crate::certify::part::{TriangleBvh, flat};
use crate::certify::query::DepthQuery;
use crate::certify::space::Point;
use crate::certify::tool_model::ToolModel;
use crate::certify::tool_model::field::Scratch;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch, Goal, LineMaximum};
use crate::certify::triangle::local::{LocalTriangle, nearest};
use crate::certify::verdict::Witness;
use crate::pose::Pose;
use crate::tool::LANES;
use fearless_simd::Level;
use nalgebra::Vector3;

/// The data that all queries of a tool at a part share. Lengths are in the tool's unit.
pub(crate) struct QuerySetting<'a> {
    pub(crate) bvh: &'a TriangleBvh,
    pub(crate) tool_model: ToolModel<'a>,
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
        match &self.tool_model {
            ToolModel::Profile(section) => DepthQuery::new(section, margin, limit, surfaces),
            ToolModel::Field(field) => {
                DepthQuery::of_field(field, [margin, self.error], limit, surfaces)
            }
        }
    }

    /// Sets the pose, and returns whether the tool may reach the part there.
    pub(crate) fn set_pose(&self, state: &mut SearchState, pose: &Pose) -> bool {
        self.setup.set_pose(&self.bvh.frame, pose, &mut state.view)
    }

    /// Returns a candidate as a point of the part in world coordinates, with its triangle and the tool's surface.
    pub(crate) fn witness(&self, best: &DeepestCandidate, pose: &Pose) -> Witness {
        Witness {
            point: pose.tip() + pose.rotation() * Vector3::from(best.point) * self.length,
            triangle: self.bvh.ids[best.index as usize],
            surface: self.tool_model.surface(best.feature),
        }
    }

    /// Returns the largest error of a bound in `f32`: planes have slopes of at most 2, so their errors are three
    /// times those of a point, plus a few roundings.
    pub(crate) fn margin(&self) -> f64 {
        if self.setup.fits {
            4.0 * self.tool_model.lipschitz() * self.setup.margin
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
    /// The triangle at which the last query ended.
    last: Option<u32>,
}

/// The depth bounds of the part's flat faces, computed on first use in a query.
#[derive(Default)]
struct Faces {
    batch: Batch,
    /// The number of the query, and per face the last query that asked for it and its bound.
    generation: u32,
    cached: Vec<(u32, f64)>,
}

impl Faces {
    fn begin(&mut self, bvh: &TriangleBvh) {
        self.generation = self.generation.wrapping_add(1);
        if self.generation == 0 || self.cached.len() != bvh.coplanar_faces.faces.len() {
            self.generation = 1;
            self.cached.clear();
            self.cached.resize(bvh.coplanar_faces.faces.len(), (0, 0.0));
        }
    }

    /// Returns an upper bound on the depth of some faces.
    fn depth(
        &mut self,
        of: &QuerySetting<'_>,
        query: &DepthQuery,
        (pose, view): (&Pose, &PoseTransform),
        faces: &[u32],
    ) -> f64 {
        let more = of.tool_model.lipschitz() * flat(&of.bvh.frame) / of.length;
        let mut max_depth = f64::NEG_INFINITY;
        for indices in faces.chunks(LANES / 2) {
            self.batch.clear();
            for face in indices {
                let (generation, depth) = self.cached[*face as usize];
                if generation == self.generation {
                    max_depth = max_depth.max(depth);
                } else {
                    self.batch.rectangle(&of.bvh.coplanar_faces.faces[*face as usize], pose, *face);
                }
            }
            if self.batch.len() == 0 {
                continue;
            }
            self.batch.turn(view);
            self.batch.bound(of.level, &query.exact, f64::NEG_INFINITY);
            for half in (0..self.batch.len()).step_by(2) {
                let depth = self.batch.bounds[half].max(self.batch.bounds[half + 1]) + more;
                self.cached[self.batch.index(half) as usize] = (self.generation, depth);
                max_depth = max_depth.max(depth);
            }
        }
        max_depth
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
        query: &DepthQuery,
        pose: &Pose,
        goal: Goal,
    ) {
        self.best = None;
        self.search.begin(goal);
        self.descent.clear();
        if !of.set_pose(self, pose) {
            return;
        }
        // The triangle that was deepest last time is likely to be deep again.
        if let Some(last) = self.last {
            self.batch.begin(of.bvh, pose, &[last]);
            self.bound_batch(of, query);
        }
        self.descend(of, query, pose, Side::Inside, of.margin());
    }

    /// Searches for the nearest point, if no point is inside. The pose must be set.
    pub(crate) fn outside(
        &mut self,
        of: &QuerySetting<'_>,
        query: &DepthQuery,
        pose: &Pose,
        goal: Goal,
    ) {
        let margin = of.margin() + self.max_distance() / f64::from(1 << 20);
        self.best = None;
        self.search.begin(goal);
        if let Some(last) = self.last {
            self.batch.begin(of.bvh, pose, &[last]);
            self.search_outside(of, query);
        }
        self.descend(of, query, pose, Side::Outside, margin);
    }

    /// Resets the starting triangle, as if no query had been made.
    pub(crate) fn clear_cache(&mut self) {
        self.last = None;
    }

    /// Returns the depth of a point in the tool's frame if it is owned, or less than 0.
    pub(crate) fn depth(&mut self, of: &QuerySetting<'_>, query: &DepthQuery, point: Point) -> f64 {
        let depth = of.tool_model.depth(&mut self.scratch, &query.owners, point);
        depth.map_or(f64::NEG_INFINITY, |depth| depth.value)
    }

    /// Returns the largest coordinate of the part's origin in the tool's frame and unit.
    pub(crate) fn max_distance(&self) -> f64 {
        self.view
            .origin
            .iter()
            .fold(0.0, |max_distance: f64, part| max_distance.max(f64::from(part.abs())))
    }

    /// Traverses the tree. `margin` is the error bound of depths in `f32`.
    fn descend(
        &mut self,
        of: &QuerySetting<'_>,
        query: &DepthQuery,
        pose: &Pose,
        side: Side,
        margin: f64,
    ) {
        self.descent.begin();
        self.faces.begin(of.bvh);
        self.scratch.clear();
        let mut opened = 0;
        while let Some(node) = self.descent.pop() {
            if self.search.is_done() {
                break;
            }
            let bound = f64::from(node.bound) + margin;
            if bound <= self.search.threshold() || !self.search.spend(bound) {
                continue;
            }
            let threshold = (self.search.threshold() - margin) as f32;
            if node.is_triangle(of.bvh) {
                let indices = self.descent.triangles(of.bvh, node, threshold);
                if let Side::Inside = side
                    && opened > FACE_CHECK_NODES
                {
                    indices.retain(|index| {
                        of.bvh.coplanar_faces.of_triangle(*index).is_none_or(|face| {
                            let view = (pose, &self.view);
                            self.faces.depth(of, query, view, &[face]) > self.search.threshold()
                        })
                    });
                }
                if indices.is_empty() {
                    continue;
                }
                self.batch.begin(of.bvh, pose, indices);
                match side {
                    Side::Inside => self.search_batch(of, query),
                    Side::Outside => self.search_outside(of, query),
                }
                continue;
            }
            let (level, bvh, view) = (of.level, of.bvh, &self.view);
            // The plane of a node may decide where `f32` or the boxes cannot.
            opened += 1;
            if let Side::Inside = side
                && opened > FACE_CHECK_NODES
                && let Some(faces) = node.faces(bvh)
                && self.faces.depth(of, query, (pose, &self.view), faces) <= self.search.threshold()
            {
                continue;
            }
            if let Side::Inside = side
                && (bound - 2.0 * margin <= self.search.threshold() || opened > PLANE_CHECK_NODES)
                && let Some(ring) = node.ring(bvh, view)
                && query.exact.of_ring(&ring) <= self.search.threshold()
            {
                continue;
            }
            let descent = &mut self.descent;
            match side {
                _ if margin > MARGIN => descent.open_all(bvh, node),
                Side::Inside => descent.open(level, (bvh, &query.hull, view), node, threshold),
                Side::Outside => descent.open(level, (bvh, &query.shell, view), node, threshold),
            }
        }
        if let ToolModel::Field(field) = &of.tool_model {
            let outside = matches!(side, Side::Outside);
            let scratch = &mut self.scratch;
            let found = field.search_triangles(&mut self.search, scratch, &query.owners, outside);
            self.best = found.or(self.best);
        }
        self.last = self.best.map(|best| best.index);
    }

    /// Bounds the triangles of the batch and evaluates the points where they may be deepest.
    fn bound_batch(&mut self, of: &QuerySetting<'_>, query: &DepthQuery) {
        self.batch.turn(&self.view);
        self.batch.bound(of.level, &query.exact, self.search.threshold());
        self.evaluate_candidates(of, query);
    }

    /// Searches the triangles of the batch, which are outside the tool.
    fn search_outside(&mut self, of: &QuerySetting<'_>, query: &DepthQuery) {
        self.batch.turn(&self.view);
        for lane in 0..self.batch.len() {
            if self.search.spend(0.0) {
                self.search_triangle(of, query, lane, Side::Outside);
            }
        }
    }

    fn evaluate_candidates(&mut self, of: &QuerySetting<'_>, query: &DepthQuery) {
        for lane in 0..self.batch.len() {
            if self.batch.bounds[lane] > self.search.threshold() {
                // For a thin triangle the point may lie off the triangle.
                let point = nearest(self.batch.point(lane), &self.batch.corners(lane));
                let index = self.batch.index(lane);
                if let Some(depth) = of.tool_model.depth(&mut self.scratch, &query.owners, point)
                    && self.search.take(&depth)
                {
                    self.best = Some(DeepestCandidate { point, feature: depth.feature, index });
                }
            }
        }
    }

    /// Searches the triangles of the batch until none can be deeper.
    fn search_batch(&mut self, of: &QuerySetting<'_>, query: &DepthQuery) {
        self.bound_batch(of, query);
        for _ in 0..MAX_REFINEMENTS {
            if !self.batch.any_above(self.search.threshold()) {
                return;
            }
            self.batch.refine(of.level, &query.exact, self.search.threshold());
            self.evaluate_candidates(of, query);
        }
        for lane in 0..self.batch.len() {
            let bound = self.batch.bounds[lane];
            if bound > self.search.threshold() && self.search.spend(bound) {
                self.search_triangle(of, query, lane, Side::Inside);
            }
        }
    }

    /// Searches one triangle of the batch. For a tool without a profile all triangles are searched together later.
    fn search_triangle(
        &mut self,
        of: &QuerySetting<'_>,
        query: &DepthQuery,
        lane: usize,
        side: Side,
    ) {
        let (corners, index) = (self.batch.corners(lane), self.batch.index(lane));
        let section = match &of.tool_model {
            ToolModel::Profile(section) => section,
            ToolModel::Field(_) => return self.scratch.hold(corners, index),
        };
        let triangle = LocalTriangle::new(corners);
        self.search.skew = self.search.skew.max(triangle.skew);
        let owners = &query.owners;
        let heights = section.circles.iter().chain(&owners.peaks);
        let levels = heights.filter_map(|height| triangle.level(*height));
        // Points beside the computed meridian may be deeper by the skew. Contact checks start lower by two errors,
        // which covers a skew up to one error; a larger skew lowers the threshold for this triangle.
        let best = self.best;
        let cached = triangle.skew <= of.error;
        let before = if cached { None } else { self.search.lower(triangle.skew) };
        for line in triangle.search_lines().chain(levels) {
            let found = match side {
                Side::Inside => self.search.inside(section, owners, triangle.skew, &line),
                Side::Outside => self.search.outside(section, owners, &line),
            };
            if let Some(LineMaximum { t, feature }) = found {
                self.best = Some(DeepestCandidate { point: line.point(t), feature, index });
            }
        }
        if before.is_some_and(|before| self.search.raise(before, triangle.skew)) {
            self.best = best;
        }
    }
}

/// A query that opened more nodes than these has many of equal depth.
const PLANE_CHECK_NODES: usize = 24;

/// A query that opened more nodes than these is likely to have equal depths along flat faces.
const FACE_CHECK_NODES: usize = 128;

/// With a larger margin `f32` decides nothing, and squares overflow in it.
pub(crate) const MARGIN: f64 = 1e9;

/// The number of refined bounds before the edges of triangles are searched.
const MAX_REFINEMENTS: usize = 2;
