//! A tool known only by its depth function, which is not a distance, and by the function's Lipschitz constant.
//!
//! Depth changes by at most `L` times the displacement, which bounds it near a point. Tighter bounds come from
//! interval enclosures of the formula over the box of a piece: its values and, by the mean value theorem, its
//! slopes from the piece's middle. A triangle is halved, longest side first, until no piece can be deeper than
//! the deepest point found. Boxes of the tool itself are halved in the same way to find its deepest point.

use crate::cancellation;
use crate::certify::space::{Point, dot, minus};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Depth;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch};
use crate::certify::triangle::{SubTriangle, TrianglePiece};
use crate::handle::ToolHandle;
use crate::interval::Interval;
use crate::tool::{
    EnvelopeSlab, EvaluationEnclosure, Evaluations, LANES, Outputs, PointBatch, Symmetry, ToolInfo,
    bit,
};
use fearless_simd::Level;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// A depth function with its bounds.
#[derive(Clone)]
pub(crate) struct Field<'a> {
    tool: ToolHandle<'a>,
    /// The Lipschitz constant `L` of depth, at least 1.
    pub(crate) steep: f64,
    /// The error bound of a depth.
    pub(crate) error: f64,
    /// The error bound of a point.
    point_error: f64,
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
    /// Distances of cells outside the tool, by the grid and the cell's place in it: [`Field::free_cells`].
    free_cells: HashMap<(i32, [i64; 3]), f64>,
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
    /// Creates the field of a tool, given the error bound of a point; `None` if no Lipschitz constant of its depth is proved.
    pub(crate) fn new(tool: ToolHandle<'a>, level: Level, point_error: f64) -> Option<Field<'a>> {
        let info = tool.info();
        let steep = info.depth.lipschitz?.max(1.0);
        // Let u be the unit roundoff. Halving rounds a midpoint by u of its distance from the tip. A relevant piece of
        // length `l` is no farther from the tip than √2 size + l. Two or three halvings of a triangle halve `l`, which
        // adds up to at most 10 u of the part's extent, and each later halving adds 1.5 u size. `rounding::point_error_bound` has
        // room for the first term, since no meridian is used here. 256 u size are 160 halvings: 120 of them end at
        // 2^-40 of the tool's size, the finest depth that is reported, and 10 u size are left for the middle and the
        // radius of the last piece.
        let error = info.depth.rounding + 128.0 * f64::EPSILON * steep * info.size();
        Some(Field { tool, steep, error, point_error, level })
    }

    /// Returns the depths of the points; outside, minus a lower bound of the distance from the tool, which is below 0 even where
    /// nothing is known of that distance.
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
                depth.value = -self.info().distance_from_outside(point).max(f64::MIN_POSITIVE);
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

    /// Returns a lower bound of the distance of a point outside from the tool, at least `known`: of the grids that are finer and
    /// finer, the first whose cell about the point has free cells around it tells how many.
    fn free_radius(&self, scratch: &mut Scratch, point: Point, known: f64) -> f64 {
        let [x, y, z] = point;
        let place = if self.is_revolved() { [x.hypot(y), 0.0, z] } else { point };
        let rounding = 4.0 * f64::EPSILON * self.info().size();
        for level in 0..CELL_LEVELS {
            let side = 0.125 * self.info().size() * 0.5f64.powi(level);
            if MAX_FREE_CELLS * side <= known {
                break;
            }
            let cell = place.map(|at| (at / side).floor());
            let mut middle = cell.map(|at| (at + 0.5) * side);
            if self.is_revolved() {
                middle[1] = 0.0;
            }
            let key = (level, cell.map(|at| at as i64));
            let free = match scratch.free_cells.get(&key) {
                Some(free) => *free,
                None => {
                    let free = self.free_cells(scratch, middle, side);
                    if scratch.free_cells.len() >= MAX_KEPT_CELLS {
                        scratch.free_cells.clear();
                    }
                    scratch.free_cells.insert(key, free);
                    free
                }
            };
            if free > 0.0 {
                let off = [0, 1, 2].map(|k| (place[k] - middle[k]).abs());
                let off = off.into_iter().fold(0.0, f64::max);
                return known.max(free * side - off - rounding);
            }
        }
        known
    }

    /// Returns a lower bound of a piece's distance from the tool, which is within its envelope. Distances from a slab are convex, so
    /// they are nowhere below their tangent plane at the piece's centre.
    fn distance_from_envelope(&self, piece: &SubTriangle, centre: Point) -> f64 {
        let [x, y, z] = centre;
        let d = x.hypot(y);
        let from_slab = |slab: &EnvelopeSlab| {
            let (out, up) = ((d - slab.radius).max(0.0), z - z.clamp(slab.low, slab.high));
            let distance = out.hypot(up);
            if distance == 0.0 {
                return 0.0;
            }
            let radial = if d > 0.0 { out / distance / d } else { 0.0 };
            let slope = [x * radial, y * radial, up / distance];
            let corners = piece.corners().map(|corner| dot(slope, minus(corner, centre)));
            distance + corners[0].min(corners[1]).min(corners[2])
        };
        self.info().envelope.iter().map(from_slab).fold(f64::INFINITY, f64::min)
    }

    /// Returns the number of cells from the middle of one over which enclosures show that the tool is not there; 0 if they are too
    /// few for the grid.
    fn free_cells(&self, scratch: &mut Scratch, middle: Point, side: f64) -> f64 {
        let mut is_free = |cells: f64| {
            self.about(scratch, middle, cells * side).is_some_and(|found| !found.inside)
        };
        let mut free = MIN_FREE_CELLS;
        if !is_free(free) {
            return 0.0;
        }
        while free < MAX_FREE_CELLS && is_free(free + 1.0) {
            free += 1.0;
        }
        free
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
            cancellation::check();
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
                let known = -depth.value;
                depth.value = self.searched_value(depth.value, outside);
                // Enclosures cost more than the evaluation did.
                let near = reach[lane].max(self.info().size() / 64.0);
                if outside && known > 0.0 && known < near {
                    depth.value = -self.free_radius(scratch, centres[lane], known);
                    // That is not sharp, so that a piece this small tells no more than its middle.
                    if reach[lane] < RESOLVED_FRACTION * -depth.value {
                        depth.value += reach[lane];
                        reach[lane] = 0.0;
                    }
                }
                let point = centres[lane];
                // A point outside is no contact, however small the known bound of its distance.
                if depth.value > search.best
                    && (outside || depth.value >= 0.0)
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
                let steep = if outside { 1.0 } else { self.steep };
                let bound = depths[lane].value + steep * reach[lane] + self.error;
                let mut bound = before.min(bound);
                if outside && bound > search.threshold() {
                    let far = self.distance_from_envelope(&piece, centres[lane]);
                    bound = bound.min(self.error - far);
                }
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

    /// Returns an interval with room for the error of a point.
    fn widened(&self, Interval { low, high }: Interval) -> Interval {
        Interval::new(low - self.point_error, high + self.point_error)
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
            let radii = self.widened(Interval::new(min_radius, max_radius));
            let radii = Interval::new(radii.low.max(0.0), radii.high);
            ([radii, Interval::default(), self.widened(z)], [far, 0.0, from[2]])
        } else {
            let [x, y] = [0, 1].map(|k| hull(from[k], corners.map(|p| p[k])));
            ([x, y, z].map(|side| self.widened(side)), from)
        };
        let Some(found) = self.tool.enclose(sides, at, &mut scratch.evaluations) else {
            return f64::INFINITY;
        };
        if !found.inside {
            return f64::NEG_INFINITY;
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

/// A box in the tool's frame. For a tool with an axis it lies in the half plane.
#[derive(Clone, Copy)]
struct Cell {
    low: Point,
    high: Point,
}

impl Cell {
    fn middle(&self) -> Point {
        [0, 1, 2].map(|k| f64::midpoint(self.low[k], self.high[k]))
    }

    fn size(&self) -> Point {
        [0, 1, 2].map(|k| self.high[k] - self.low[k])
    }

    /// Returns the distance from its middle to its corners.
    fn reach(&self) -> f64 {
        0.5 * self.size().iter().map(|side| side * side).sum::<f64>().sqrt()
    }

    /// Returns the smallest box about both.
    fn hull(&self, other: &Cell) -> Cell {
        Cell {
            low: [0, 1, 2].map(|k| self.low[k].min(other.low[k])),
            high: [0, 1, 2].map(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Returns whether both have a point in common.
    fn meets(&self, other: &Cell) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Returns both halves of its longest side.
    fn halves(self) -> [Cell; 2] {
        let size = self.size();
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

/// The number of grids of cells about points outside, each half as wide as the one before, and the cells that are kept.
const CELL_LEVELS: i32 = 18;
const MAX_KEPT_CELLS: usize = 1 << 16;

/// The least and the greatest number of free cells about a point outside. A grid with fewer is too coarse; with more the one
/// before it would have been fine enough.
const MIN_FREE_CELLS: f64 = 6.0;
const MAX_FREE_CELLS: f64 = 14.0;

/// Pieces smaller than this fraction of their distance are not halved in the search for the least one.
const RESOLVED_FRACTION: f64 = 0.125;

/// A translation of a box into another one.
struct Way {
    way: Point,
    /// The square of its length.
    length: f64,
    /// The length by which the box is larger than the other.
    lack: f64,
}

/// A ball that stands for connected pieces of the restricted interior.
#[derive(Clone, Copy)]
pub(crate) struct FieldCore {
    /// A point of a piece, or the middle of a box that may have pieces. For a tool with an axis it stands for a circle.
    pub(crate) point: Point,
    /// `None` for a point of a piece, else the radius of a ball about the box.
    pub(crate) radius: Option<f64>,
    pub(crate) region: usize,
}

impl Field<'_> {
    /// Returns the smallest box about the tool that is known.
    fn extent(&self) -> Cell {
        let info = self.info();
        let Interval { low: bottom, high: top } = info.reach();
        // For a tool with an axis the half plane is enough.
        let [x, y] = match info.symmetry {
            Symmetry::Revolved => [Interval::new(0.0, info.radius()), Interval::default()],
            Symmetry::Solid { extent } => extent,
        };
        Cell { low: [x.low, y.low, bottom], high: [x.high, y.high, top] }
    }

    /// Returns an enclosure of the evaluation over a box.
    fn enclose(&self, scratch: &mut Scratch, cell: &Cell) -> Option<EvaluationEnclosure> {
        let sides = [0, 1, 2].map(|k| Interval::new(cell.low[k], cell.high[k]));
        self.tool.enclose(sides, cell.middle(), &mut scratch.evaluations)
    }

    /// Returns balls of which at least one contains a point of each connected piece of the restricted interior: the points
    /// that are deeper than the limit of their region by more than a tolerance. Returns `None` if the tool has no enclosures.
    ///
    /// Boxes are halved. Those that enclosures show to be wholly in the interior are joined where they meet, and one point is
    /// enough for all that are. Of the others, whose points may be inside, each is compared with a box near it that is
    /// wholly inside: if depth does not fall on the way there, and no point of the way has another limit, each of its points
    /// is connected with that box. What is left stands for itself.
    pub(crate) fn core_points(&self, limits: &[f64], tolerance: f64) -> Option<Vec<FieldCore>> {
        let mut scratch = Scratch::default();
        let (mut full, mut open) = (Vec::new(), vec![self.extent()]);
        for level in 0..=HALVINGS {
            for cell in std::mem::take(&mut open) {
                let found = self.enclose(&mut scratch, &cell)?;
                let [min_limit, max_limit] = range(limits, found.regions);
                if !found.inside || found.max_depth() <= min_limit + tolerance {
                    continue;
                }
                if !found.outside && found.min_depth() > max_limit + tolerance {
                    full.push(cell);
                } else {
                    open.push(cell);
                }
            }
            if level >= COARSE_HALVINGS {
                open.retain(|cell| !self.is_connected(&mut scratch, cell, &full, limits));
            }
            if level == HALVINGS || 2 * open.len() > MAX_OPEN_CELLS {
                break;
            }
            open = open.into_iter().flat_map(Cell::halves).collect();
        }
        let mut cores: Vec<FieldCore> = Vec::new();
        // The largest boxes come first.
        while let Some(first) = full.first().copied() {
            let region = self.depth(&mut scratch, first.middle()).feature;
            cores.push(FieldCore { point: first.middle(), radius: None, region });
            let mut joined = vec![first];
            while let Some(cell) = joined.pop() {
                let (near, rest) = full.into_iter().partition(|other| other.meets(&cell));
                full = rest;
                joined.extend::<Vec<Cell>>(near);
            }
        }
        // A piece that has no such box may still have one of these points.
        let mut deepest: Vec<Option<(f64, Point)>> = vec![None; limits.len()];
        for cell in &open {
            let Depth { value, feature, .. } = self.depth(&mut scratch, cell.middle());
            cores.push(FieldCore {
                point: cell.middle(),
                radius: Some(cell.reach()),
                region: feature,
            });
            let excess = value - limits[feature] - tolerance - self.error;
            if value >= 0.0 && excess > deepest[feature].map_or(0.0, |(excess, _)| excess) {
                deepest[feature] = Some((excess, cell.middle()));
            }
        }
        let found = deepest.into_iter().enumerate();
        cores.extend(found.filter_map(|(region, deepest)| {
            deepest.map(|(_, point)| FieldCore { point, radius: None, region })
        }));
        Some(cores)
    }

    /// Returns whether every point of the restricted interior in a box is connected with one of some boxes that are wholly in
    /// it.
    fn is_connected(
        &self,
        scratch: &mut Scratch,
        cell: &Cell,
        full: &[Cell],
        limits: &[f64],
    ) -> bool {
        // The shortest way into another box, if there is room for this one but for rounding.
        let room = |to: &Cell| {
            let least = [0, 1, 2].map(|k| to.low[k] - cell.low[k]);
            let most = [0, 1, 2].map(|k| to.high[k] - cell.high[k]);
            let lack = (0..3).map(|k| least[k] - most[k]).fold(0.0, f64::max);
            (lack <= self.point_error).then(|| {
                let way = [0, 1, 2].map(|k| {
                    let middle = f64::midpoint(least[k], most[k]);
                    if least[k] <= most[k] { 0.0f64.clamp(least[k], most[k]) } else { middle }
                });
                Way { way, length: way.iter().map(|part| part * part).sum(), lack }
            })
        };
        let mut ways: Vec<Way> = full.iter().filter_map(room).collect();
        let tried = MAX_WAYS.min(ways.len());
        if tried < ways.len() {
            ways.select_nth_unstable_by(tried, |a, b| a.length.total_cmp(&b.length));
        }
        ways[..tried].iter().any(|Way { way, lack, .. }| {
            let moved = Cell {
                low: [0, 1, 2].map(|k| cell.low[k] + way[k]),
                high: [0, 1, 2].map(|k| cell.high[k] + way[k]),
            };
            self.enclose(scratch, &cell.hull(&moved)).is_some_and(|found| {
                let [min_limit, max_limit] = range(limits, found.regions);
                // Points that would end beside the other box take a way that differs by less than the lack of room. A rate of 0 is
                // rounded down.
                let min_rise = 2.0 * self.steep * lack - f64::MIN_POSITIVE;
                min_limit == max_limit && found.min_rise(*way) >= min_rise
            })
        })
    }

    /// Returns an upper bound on the depth of the owners' points, at most 1 % above the depth of one of them unless the budget is
    /// spent first; `None` if it is spent before any such point is found.
    pub(crate) fn greatest_depth(&self, owners: &Owners) -> Option<f64> {
        let mut scratch = Scratch::default();
        let mut cells = BinaryHeap::from([Bounded { bound: f64::INFINITY, item: self.extent() }]);
        let mut deepest = 0.0;
        for _ in 0..BUDGET {
            let Some(Bounded { bound, item: cell }) = cells.pop() else { break };
            if bound <= 1.01 * deepest {
                return Some(bound + self.error);
            }
            let (middle, reach) = (cell.middle(), cell.reach());
            let depth = self.depth(&mut scratch, middle);
            if depth.value > deepest
                && let Some(depth) = self.owned(&mut scratch, owners, middle, depth)
            {
                deepest = depth.value;
            }
            if self.passes(&mut scratch, owners, middle, reach, 0.0) {
                continue;
            }
            // The depth of a point outside is minus a lower bound of its distance, and depth grows from the surface
            // inward.
            let bound = bound.min(depth.value + self.steep * reach);
            cells.extend(cell.halves().map(|item| Bounded { bound, item }));
        }
        // No owner's point outside the boxes that are left is deeper than the deepest one.
        let max_remaining = cells.peek().map_or(0.0, |cell| cell.bound);
        (deepest > 0.0 || cells.is_empty()).then(|| deepest.max(max_remaining) + self.error)
    }
}

/// The number of times that a tool is halved in the search for pieces, and the number from which on boxes are connected.
const HALVINGS: usize = 16;
const COARSE_HALVINGS: usize = 8;

/// The largest number of boxes of which it is open whether they are inside.
const MAX_OPEN_CELLS: usize = 1 << 12;

/// The number of boxes to which a way is tried.
const MAX_WAYS: usize = 6;

/// Returns the least and the greatest limit of some regions, a [bit] each.
fn range(limits: &[f64], regions: u64) -> [f64; 2] {
    let known = limits.iter().enumerate().filter(|(index, _)| regions & bit(*index) != 0);
    known.fold([f64::INFINITY, 0.0], |[low, high], (_, limit)| [low.min(*limit), high.max(*limit)])
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
    use crate::certify::{Certifier, Goal, PoseVerdict, TriangleBvh};
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
    fn the_greatest_depth_of_a_ball_is_that_of_its_centre() {
        let field = Field::new(ToolHandle::Borrowed(&*SPHERE), Level::new(), 1e-15);
        let field = field.expect("a Lipschitz constant");
        let greatest_depth = |is_owned: bool| {
            field.greatest_depth(&Owners::of_regions(field.info(), |_, _| is_owned))
        };
        assert!(greatest_depth(true).is_some_and(|depth| (1.0..=1.0101).contains(&depth)));
        assert!(greatest_depth(false).is_some_and(|depth| depth < 1e-12));
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

    /// The free box about a point 0.1 beside the ball reaches up to 0.1: six cells and more, of which one may be lost at the end, and
    /// half of one by the place of the point in its own.
    #[test]
    fn a_free_radius_is_known_to_a_fifth() {
        let field = Field::new(ToolHandle::Borrowed(&*SPHERE), Level::new(), 1e-15);
        let field = field.expect("a Lipschitz constant");
        let found = field.free_radius(&mut Scratch::default(), [1.1, 0.0, 1.0], 0.0);
        assert!((0.078..=0.1).contains(&found), "{found}");
    }

    /// A depth of 0.5 to within 0.01 may exceed 0.505.
    #[test]
    fn a_depth_within_its_error_of_the_threshold_stays_open() {
        let field = Field::new(ToolHandle::Borrowed(&*SPHERE), Level::new(), 1e-15);
        let field = Field { error: 0.01, ..field.expect("a Lipschitz constant") };
        let (mut search, mut scratch) = (DepthSearch::default(), Scratch::default());
        let stop_depth = f64::INFINITY;
        search.begin(Goal { threshold: 0.505, tolerance: 0.0, stop_depth, budget: 1000 });
        scratch.hold([[0.5, 0.0, 1.0], [0.5, 1e-6, 1.0], [0.5, 0.0, 1.0 + 1e-6]], 0);
        let owners = Owners::of_regions(field.info(), |_, _| true);
        assert!(field.search_triangles(&mut search, &mut scratch, &owners, false).is_none());
        assert!(search.has_open());
    }
}
