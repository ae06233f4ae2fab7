//! Queries for the depth of some surfaces of a tool in a part, or for their distance from it, and the branch-and-bound
//! search of the part's triangles that answers them. The search keeps its state between queries.

use crate::bvh::{PoseTransform, QuerySetup};
use crate::cancellation;
use crate::certify::bounds::batch::Batch;
use crate::certify::bounds::descent::{BoundedTree, Descent};
use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::shell::Shell;
use crate::certify::part::{TriangleBvh, flat};
use crate::certify::rounding;
use crate::certify::space::MeridianPoint;
use crate::certify::space::Point;
use crate::certify::tool_model::ToolModel;
use crate::certify::tool_model::field::{Field, Scratch};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::profile::ProfileModel;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch, Goal, LineMaximum};
use crate::certify::triangle::{LocalTriangle, SubTriangle, nearest};
use crate::certify::verdict::{ToolPoint, Witness};
use crate::handle::{Handle, ToolHandle};
use crate::pose::Pose;
use crate::tool::{LANES, ToolInfo};
use fearless_simd::Level;
use nalgebra::{Point3, Vector3};

/// A set of surfaces and the structures that bound their depth. Lengths are in the tool's unit.
#[derive(Clone)]
pub(crate) struct DepthQuery {
    pub(crate) owners: Owners,
    pub(crate) hull: Hull<f32>,
    pub(crate) exact: Hull<f64>,
    shell: Shell,
    /// Rectangles of the half plane that hold all points deeper than the limit that the owners can own, if it is at least 0
    /// and the tool has a profile.
    pub(crate) zones: Vec<Rectangle>,
    /// The allowed depth of the owners. If negative, its magnitude is the distance that they have to keep.
    pub(crate) limit: f64,
}

impl DepthQuery {
    /// A query for the features of some surfaces. `margin` is the rounding error of a point in `f32`.
    fn new(
        profile: &ProfileModel,
        margin: f64,
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> DepthQuery {
        let section = &profile.section;
        let error = section.outline.error;
        if limit < 0.0 {
            let owners = Owners::near(section, surfaces);
            return DepthQuery {
                hull: Hull::holding(profile, &owners, margin),
                exact: Hull::holding(profile, &owners, error),
                shell: Shell::new(section, &owners, margin),
                zones: Vec::new(),
                owners,
                limit,
            };
        }
        let owners = Owners::of(section, surfaces);
        let zones = owners.zones(section, limit - rounding::ROOM * error);
        DepthQuery {
            hull: Hull::new(profile, &zones, margin),
            exact: Hull::new(profile, &zones, error),
            shell: Shell::new(section, &owners, margin),
            zones: zones.into_iter().flatten().collect(),
            owners,
            limit,
        }
    }

    /// A query for some surfaces of a tool that is known by its depth field. `errors` are the rounding errors of a
    /// point in `f32` and in `f64`.
    fn of_field(
        field: &Field<'_>,
        errors: [f64; 2],
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> DepthQuery {
        let info = field.info();
        DepthQuery {
            owners: Owners::of_regions(info, |_, region| surfaces(region.surface.0)),
            hull: Hull::about(info, field.steep, errors[0]),
            exact: Hull::about(info, field.steep, errors[1]),
            shell: Shell::about(info, errors[0]),
            zones: Vec::new(),
            limit,
        }
    }

    /// Returns the heights between which points of a triangle come within a distance of the owners' zones; `None` if none
    /// does.
    pub(crate) fn heights(&self, triangle: &SubTriangle, distance: f64) -> Option<[f64; 2]> {
        let rectangle = triangle.rectangle(distance);
        let near = self.zones.iter().filter(|zone| zone.meets(&rectangle));
        let heights = near.map(|zone| [zone.low[1] - distance, zone.high[1] + distance]);
        heights.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])
    }

    /// Returns the queries that check the allowances of all surfaces, given in the order of the tool's list: one query
    /// per allowance, for all surfaces that have it. The largest allowance comes first; infinite ones need no query.
    pub(crate) fn all(setting: &QuerySetting<'_>, allowances: &[f64]) -> Vec<DepthQuery> {
        let depths =
            allowances.iter().map(|allowance| allowance.max(0.0)).filter(|depth| depth.is_finite());
        let gaps = allowances.iter().copied().filter(|allowance| *allowance < 0.0);
        let mut limits: Vec<f64> = depths.chain(gaps).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        // The largest first: a deep contact is found at once, and ends the check.
        limits
            .into_iter()
            .rev()
            .map(|limit| {
                setting.depth_query(limit, |surface| {
                    let allowance = allowances[surface];
                    if limit < 0.0 { allowance == limit } else { allowance.max(0.0) == limit }
                })
            })
            .collect()
    }
}

/// The data that all queries of a tool at a part share. Lengths are in the tool's unit.
#[derive(Clone)]
pub(crate) struct QuerySetting<'a> {
    pub(crate) bvh: Handle<'a, TriangleBvh>,
    pub(crate) tool: ToolHandle<'a>,
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
    pub(crate) fn info(&self) -> &ToolInfo {
        self.tool.info()
    }

    /// Makes the query for some surfaces, given by their indices in the tool's list. For a tool without a profile the
    /// limit must be at least 0.
    pub(crate) fn depth_query(&self, limit: f64, surfaces: impl Fn(usize) -> bool) -> DepthQuery {
        let margin = self.setup.margin;
        match &self.tool_model {
            ToolModel::Profile(profile) => DepthQuery::new(profile, margin, limit, surfaces),
            ToolModel::Field(field) => {
                DepthQuery::of_field(field, [margin, self.error], limit, surfaces)
            }
        }
    }

    /// Sets the pose, and returns whether the tool may reach the part there.
    pub(crate) fn set_pose(&self, state: &mut SearchState, pose: &Pose) -> bool {
        self.setup.set_pose(&self.bvh.frame, pose, &mut state.view)
    }

    /// Returns a point of the tool's frame in world coordinates.
    pub(crate) fn to_world(&self, pose: &Pose, point: Point) -> Point3<f64> {
        pose.tip() + pose.rotation() * Vector3::from(point) * self.length
    }

    /// Returns a candidate as a point of the part in world coordinates, with its triangle and the tool's surface.
    pub(crate) fn witness(&self, best: &DeepestCandidate, pose: &Pose) -> Witness {
        Witness {
            point: self.to_world(pose, best.point),
            triangle: self.bvh.ids[best.index as usize],
            surface: self.tool_model.surface(best.feature),
        }
    }

    /// Returns the point of the tool's surface that is the nearest to a candidate; `None` without a profile.
    pub(crate) fn tool_point(&self, best: &DeepestCandidate, pose: &Pose) -> Option<ToolPoint> {
        let ToolModel::Profile(ProfileModel { section, .. }) = &self.tool_model else {
            return None;
        };
        let [x, y, z] = best.point;
        let d = x.hypot(y);
        let [cosine, sine] = if d > 0.0 { [x / d, y / d] } else { [1.0, 0.0] };
        let to_tool = |[d, z]: MeridianPoint| Vector3::new(cosine * d, sine * d, z);
        let foot = to_tool(section.outline.features[best.feature].segment.foot([d, z]));
        Some(ToolPoint {
            point: self.to_world(pose, foot.into()),
            normal: pose.rotation() * to_tool(section.normal(best.feature, [d, z])),
        })
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
#[derive(Clone, Default)]
pub(crate) struct SearchState {
    view: PoseTransform,
    pub(crate) search: DepthSearch,
    pub(crate) descent: Descent,
    batch: Batch,
    faces: Faces,
    scratch: Scratch,
    pub(crate) best: Option<DeepestCandidate>,
    /// The triangle at which the last query ended.
    last: Option<u32>,
}

/// The pose of the tool, and the transform to the tool's frame there.
#[derive(Clone, Copy)]
struct PlacedTool<'a> {
    pose: &'a Pose,
    view: &'a PoseTransform,
}

/// The depth bounds of the part's flat faces, computed on first use in a query.
#[derive(Clone, Default)]
struct Faces {
    batch: Batch,
    /// The number of the query, and per face the last query that asked for it and its bound.
    generation: u32,
    cached: Vec<(u32, f64)>,
}

impl Faces {
    fn begin(&mut self, bvh: &TriangleBvh) {
        self.generation = self.generation.wrapping_add(1);
        // A part with other faces, or a count that begins again at 0, would find bounds of other queries.
        if self.generation == 0 || self.cached.len() != bvh.coplanar_faces.faces.len() {
            self.generation = 1;
            self.cached.clear();
            self.cached.resize(bvh.coplanar_faces.faces.len(), (0, 0.0));
        }
    }

    /// Returns an upper bound on the depth of some faces.
    fn depth(
        &mut self,
        setting: &QuerySetting<'_>,
        query: &DepthQuery,
        placed: PlacedTool<'_>,
        faces: &[u32],
    ) -> f64 {
        // A point of the face may be off the rectangle's plane by the tolerance, and deeper by as much.
        let bvh = &*setting.bvh;
        let more = setting.tool_model.lipschitz() * flat(&bvh.frame) / setting.length;
        let mut max_depth = f64::NEG_INFINITY;
        for indices in faces.chunks(LANES / 2) {
            self.batch.clear();
            for face in indices {
                let (generation, depth) = self.cached[*face as usize];
                if generation == self.generation {
                    max_depth = max_depth.max(depth);
                } else {
                    self.batch.rectangle(
                        &bvh.coplanar_faces.faces[*face as usize],
                        placed.pose,
                        *face,
                    );
                }
            }
            if self.batch.len() == 0 {
                continue;
            }
            self.batch.turn(placed.view);
            self.batch.bound(setting.level, &query.exact, f64::NEG_INFINITY);
            // Two triangles per rectangle.
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
        setting: &QuerySetting<'_>,
        query: &DepthQuery,
        pose: &Pose,
        goal: Goal,
    ) {
        self.best = None;
        self.search.begin(goal);
        self.descent.clear();
        if !setting.set_pose(self, pose) {
            return;
        }
        // The triangle that was deepest last time is likely to be deep again.
        if let Some(last) = self.last {
            self.batch.begin(&setting.bvh, pose, &[last]);
            self.bound_batch(setting, query);
        }
        self.descend(setting, query, pose, Side::Inside, setting.margin());
    }

    /// Searches for the nearest point, if no point is inside. The pose must be set.
    pub(crate) fn outside(
        &mut self,
        setting: &QuerySetting<'_>,
        query: &DepthQuery,
        pose: &Pose,
        goal: Goal,
    ) {
        // Distances in `f32` err by a few units of roundoff, 2^-24, of their size.
        let margin = setting.margin() + self.max_distance() / f64::from(1 << 20);
        self.best = None;
        self.search.begin(goal);
        if let Some(last) = self.last {
            self.batch.begin(&setting.bvh, pose, &[last]);
            self.search_outside(setting, query);
        }
        self.descend(setting, query, pose, Side::Outside, margin);
    }

    /// Resets the starting triangle, as if no query had been made.
    pub(crate) fn clear_cache(&mut self) {
        self.last = None;
    }

    /// Returns the depth of a point in the tool's frame if it is owned, or less than 0.
    pub(crate) fn depth(
        &mut self,
        setting: &QuerySetting<'_>,
        query: &DepthQuery,
        point: Point,
    ) -> f64 {
        let depth = setting.tool_model.depth(&mut self.scratch, &query.owners, point);
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
        setting: &QuerySetting<'_>,
        query: &DepthQuery,
        pose: &Pose,
        side: Side,
        margin: f64,
    ) {
        // Once per query: a handle is a branch.
        let bvh = &*setting.bvh;
        self.descent.begin();
        self.faces.begin(bvh);
        self.scratch.clear();
        let mut opened = 0;
        let mut nodes_per_face = NODES_PER_FACE;
        while let Some(node) = self.descent.pop() {
            if self.search.is_done() {
                break;
            }
            let bound = f64::from(node.bound) + margin;
            if bound <= self.search.threshold() || !self.search.spend(bound) {
                continue;
            }
            // Bounds in `f32` may be too low by the margin.
            let threshold = (self.search.threshold() - margin) as f32;
            if node.is_triangle(bvh) {
                let indices = self.descent.triangles(bvh, node, threshold);
                if let Side::Inside = side
                    && opened > NODES_BEFORE_FACES
                {
                    indices.retain(|index| {
                        bvh.coplanar_faces.of_triangle(*index).is_none_or(|face| {
                            let placed = PlacedTool { pose, view: &self.view };
                            self.faces.depth(setting, query, placed, &[face])
                                > self.search.threshold()
                        })
                    });
                }
                if indices.is_empty() {
                    continue;
                }
                cancellation::check();
                self.batch.begin(bvh, pose, indices);
                match side {
                    Side::Inside => self.search_batch(setting, query),
                    Side::Outside => self.search_outside(setting, query),
                }
                continue;
            }
            let (level, view) = (setting.level, &self.view);
            let placed = PlacedTool { pose, view };
            opened += 1;
            if let Side::Inside = side
                && let Some(faces) = node.faces(bvh)
                && opened > nodes_per_face * faces.len()
            {
                if self.faces.depth(setting, query, placed, faces) <= self.search.threshold() {
                    nodes_per_face = (nodes_per_face - 1).max(1);
                    continue;
                }
                nodes_per_face = (nodes_per_face + 1).min(MAX_NODES_PER_FACE);
            }
            // The plane of a node in `f64` may decide where `f32` cannot.
            if let Side::Inside = side
                && bound - 2.0 * margin <= self.search.threshold()
                && let Some(ring) = node.ring(bvh, view)
                && query.exact.of_ring(&ring) <= self.search.threshold()
            {
                continue;
            }
            let descent = &mut self.descent;
            match side {
                _ if margin > MAX_F32_MARGIN => descent.open_all(bvh, node),
                Side::Inside => {
                    let tree = BoundedTree { bvh, bounds: &query.hull, view };
                    descent.open(level, &tree, node, threshold);
                }
                Side::Outside => {
                    let tree = BoundedTree { bvh, bounds: &query.shell, view };
                    descent.open(level, &tree, node, threshold);
                }
            }
        }
        if let ToolModel::Field(field) = &setting.tool_model {
            let outside = matches!(side, Side::Outside);
            let scratch = &mut self.scratch;
            // Only now, since all triangles share one queue: the deepest piece of any of them comes first.
            let found = field.search_triangles(&mut self.search, scratch, &query.owners, outside);
            self.best = found.or(self.best);
        }
        // Without contact nothing is remembered: the next query begins at the root.
        self.last = self.best.map(|best| best.index);
    }

    /// Bounds the triangles of the batch and evaluates the points where they may be deepest.
    fn bound_batch(&mut self, setting: &QuerySetting<'_>, query: &DepthQuery) {
        self.batch.turn(&self.view);
        self.batch.bound(setting.level, &query.exact, self.search.threshold());
        self.evaluate_candidates(setting, query);
    }

    /// Searches the triangles of the batch, which are outside the tool.
    fn search_outside(&mut self, setting: &QuerySetting<'_>, query: &DepthQuery) {
        self.batch.turn(&self.view);
        for lane in 0..self.batch.len() {
            if self.search.spend(0.0) {
                self.search_triangle(setting, query, lane, Side::Outside);
            }
        }
    }

    fn evaluate_candidates(&mut self, setting: &QuerySetting<'_>, query: &DepthQuery) {
        for lane in 0..self.batch.len() {
            if self.batch.bounds[lane] > self.search.threshold() {
                // For a thin triangle the point may lie off the triangle.
                let point = nearest(self.batch.point(lane), &self.batch.corners(lane));
                let index = self.batch.index(lane);
                if let Some(depth) =
                    setting.tool_model.depth(&mut self.scratch, &query.owners, point)
                    && self.search.take(&depth)
                {
                    self.best = Some(DeepestCandidate { point, feature: depth.feature, index });
                }
            }
        }
    }

    /// Searches the triangles of the batch until none can be deeper.
    fn search_batch(&mut self, setting: &QuerySetting<'_>, query: &DepthQuery) {
        self.bound_batch(setting, query);
        for _ in 0..MAX_REFINEMENTS {
            if !self.batch.any_above(self.search.threshold()) {
                return;
            }
            self.batch.refine(setting.level, &query.exact, self.search.threshold());
            self.evaluate_candidates(setting, query);
        }
        for lane in 0..self.batch.len() {
            let bound = self.batch.bounds[lane];
            if bound > self.search.threshold() && self.search.spend(bound) {
                self.search_triangle(setting, query, lane, Side::Inside);
            }
        }
    }

    /// Searches one triangle of the batch. For a tool without a profile all triangles are searched together later.
    fn search_triangle(
        &mut self,
        setting: &QuerySetting<'_>,
        query: &DepthQuery,
        lane: usize,
        side: Side,
    ) {
        let (corners, index) = (self.batch.corners(lane), self.batch.index(lane));
        let profile = match &setting.tool_model {
            ToolModel::Profile(profile) => profile,
            ToolModel::Field(_) => return self.scratch.hold(corners, index),
        };
        let triangle = LocalTriangle::new(corners);
        self.search.skew = self.search.skew.max(triangle.skew);
        let owners = &query.owners;
        let section = &profile.section;
        let heights = profile.circles.heights.iter().chain(&owners.peaks);
        let levels = heights.filter_map(|height| triangle.level(*height));
        // Points beside the computed meridian may be deeper by the skew. Contact checks start lower by two errors,
        // which covers a skew up to one error; a larger skew lowers the threshold for this triangle.
        let best = self.best;
        let is_covered = triangle.skew <= setting.error;
        let before = if is_covered { None } else { self.search.lower(triangle.skew) };
        for line in triangle.search_lines().chain(levels) {
            let found = match side {
                Side::Inside => self.search.inside(section, owners, triangle.skew, &line),
                Side::Outside => self.search.outside(section, owners, &line),
            };
            if let Some(LineMaximum { t, feature }) = found {
                self.best = Some(DeepestCandidate { point: line.point(t), feature, index });
            }
        }
        if let Side::Inside = side {
            let whole = SubTriangle::new(corners);
            whole.leave_unresolved(profile, owners, setting.error, &mut self.search);
        }
        if before.is_some_and(|before| self.search.raise(before, triangle.skew)) {
            self.best = best;
        }
    }
}

/// The number of nodes that are opened per face of a node before its faces are bounded: those bounds pay off where many
/// triangles are equally deep, and such a query opens many nodes. Each node that its faces rule out lowers the number by
/// one, each that they do not raises it.
const NODES_PER_FACE: usize = 10;
const MAX_NODES_PER_FACE: usize = 16;

/// The number of opened nodes before each triangle's face is bounded.
const NODES_BEFORE_FACES: usize = 32;

/// The largest margin at which `f32` decides anything; squares overflow beyond it.
pub(crate) const MAX_F32_MARGIN: f64 = 1e9;

/// The number of refined bounds before the edges of triangles are searched.
const MAX_REFINEMENTS: usize = 2;
