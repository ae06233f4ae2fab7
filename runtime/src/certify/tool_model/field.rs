//! A tool known only by its depth function, which is not a distance, and by the function's Lipschitz constant.
//!
//! Depth changes by at most `L` times the displacement, which bounds it near a point. Tighter bounds come from
//! interval enclosures of the formula over the box of a piece: its values and, by the mean value theorem, its
//! slopes from the piece's middle. A triangle is halved, longest side first, until no piece can be deeper than
//! the deepest point found.

use crate::certify::space::Point;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Depth;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch};
use crate::certify::triangle::subdivision::SubTriangle;
use crate::tool::{Evaluations, LANES, Outputs, PointBatch, Tool, ToolInfo};
use fearless_simd::Level;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A depth function with its bounds.
pub(crate) struct Field<'a> {
    pub(super) tool: &'a dyn Tool,
    /// The Lipschitz constant `L` of depth, at least 1.
    pub(crate) steep: f64,
    /// The error bound of a depth.
    pub(crate) error: f64,
    pub(crate) level: Level,
}

/// A piece of a triangle and an upper bound of its depth.
#[derive(Clone, Copy, Default)]
struct DepthCandidate {
    piece: SubTriangle,
    /// The index of the triangle.
    index: u32,
    bound: f64,
}

/// Memory that a search keeps between triangles.
#[derive(Default)]
pub(crate) struct Scratch {
    /// The pieces that are still open, the deepest on top.
    pieces: BinaryHeap<DepthCandidate>,
    pub(super) points: PointBatch,
    pub(super) evaluations: Evaluations,
}

impl Ord for DepthCandidate {
    fn cmp(&self, other: &DepthCandidate) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for DepthCandidate {
    fn partial_cmp(&self, other: &DepthCandidate) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for DepthCandidate {
    fn eq(&self, other: &DepthCandidate) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for DepthCandidate {}

impl Scratch {
    /// Adds a triangle to the open pieces.
    pub(crate) fn hold(&mut self, corners: [Point; 3], index: u32) {
        let bound = f64::INFINITY;
        self.pieces.push(DepthCandidate { piece: SubTriangle::new(corners), index, bound });
    }

    /// Drops all open pieces.
    pub(crate) fn clear(&mut self) {
        self.pieces.clear();
    }
}

impl<'a> Field<'a> {
    /// Creates the field of a tool; `None` if no Lipschitz constant of its depth is proved.
    pub(crate) fn new(tool: &'a dyn Tool, level: Level) -> Option<Field<'a>> {
        let info = tool.info();
        let steep = info.depth.lipschitz?.max(1.0);
        // Let u be the unit roundoff. Halving rounds a midpoint by u of its distance from the tip. A relevant piece of
        // length `l` is no farther from the tip than √2 size + l. Two or three halvings of a triangle halve `l`, which
        // adds up to at most 10 u of the part's extent, and each later halving adds 1.5 u size. `rounding::place` has
        // room for the first term, since no meridian is used here. 256 u size are 160 halvings: 120 of them end at
        // 2^-40 of the tool's size, the finest depth that is reported, and 10 u size are left for the middle and the
        // radius of the last piece.
        let error = info.depth.rounding + 128.0 * f64::EPSILON * steep * info.size();
        Some(Field { tool, steep, error, level })
    }

    /// Returns the depths of the points; outside, minus a lower bound of the distance from the tool.
    pub(super) fn depths(&self, scratch: &mut Scratch, count: usize) -> [Depth; LANES] {
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
        let value = |depth: f64| match (outside, depth < 0.0) {
            (true, _) => depth.min(0.0),
            (false, true) => self.steep * depth,
            (false, false) => depth,
        };
        let mut best = None;
        loop {
            let mut candidates = [DepthCandidate::default(); LANES];
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
                    scratch.pieces.clear();
                    break;
                }
                let (centre, far) = candidate.piece.ball();
                scratch.points.push(centre);
                (candidates[count], centres[count], reach[count]) = (candidate, centre, far);
                count += 1;
            }
            if count == 0 {
                break;
            }
            let mut depths = self.depths(scratch, count);
            for (lane, depth) in depths.iter_mut().enumerate().take(count) {
                depth.value = value(depth.value);
                let point = centres[lane];
                if depth.value > search.best
                    && let Some(depth) = self.owned(scratch, owners, point, *depth)
                    && search.take(&depth)
                {
                    let (feature, index) = (depth.feature, candidates[lane].index);
                    best = Some(DeepestCandidate { point, feature, index });
                }
            }
            for lane in 0..count {
                let candidate = candidates[lane];
                let bound = depths[lane].value + self.steep * reach[lane] + self.error;
                let mut bound = candidate.bound.min(bound);
                if bound > search.threshold() && !outside {
                    let closer = self.at_most(scratch, owners, &candidate.piece, centres[lane]);
                    bound = bound.min(closer);
                }
                if bound <= search.threshold() {
                    continue;
                }
                let before = scratch.pieces.len();
                scratch.pieces.extend(candidate.piece.halves().map(|piece| DepthCandidate {
                    piece,
                    bound,
                    ..candidate
                }));
                if scratch.pieces.len() == before {
                    search.leave(bound);
                }
            }
        }
        best
    }
}
