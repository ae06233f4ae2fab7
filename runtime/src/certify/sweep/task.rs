//! The task of a sweep, and the depth of a point in it.

use crate::certify::query::DepthQuery;
use crate::certify::search::QuerySetting;
use crate::certify::space::Point;
use crate::certify::tool_model::field::Scratch;
use crate::certify::tool_model::owners::Owners;
use crate::certify::triangle::line_search::DeepestCandidate;
use crate::motion::Motion;

/// The query, motion and limits of a sweep. Lengths are in the tool's unit.
pub(crate) struct SweepTask<'a> {
    pub(crate) setting: &'a QuerySetting<'a>,
    pub(crate) query: &'a DepthQuery,
    pub(crate) motion: &'a Motion,
    /// The allowed depth of the query's owners. If negative, its magnitude is the distance that they have to keep. It
    /// is the query's own limit or, if that is at least 0, any larger value.
    pub(crate) limit: f64,
    /// The rounding error bound of a point along this motion.
    pub(crate) error: f64,
    /// The excess over the limit that need not be reported.
    pub(crate) tolerance: f64,
}

impl SweepTask<'_> {
    /// Returns the depth up to which nothing needs to be examined.
    pub(super) fn threshold(&self) -> f64 {
        self.limit + self.tolerance
    }

    /// Returns the same threshold for bounds that are raised by the distance to be kept, less the rounding error
    /// bound.
    pub(super) fn above(&self) -> f64 {
        self.threshold() + self.required_clearance() - self.error
    }

    /// Returns the smallest distance that the owners have to keep.
    pub(super) fn required_clearance(&self) -> f64 {
        (-self.threshold()).max(0.0)
    }

    /// Returns the depth of a point; negative values are distances.
    pub(super) fn depth(&self, scratch: &mut Scratch, point: Point) -> DeepPoint {
        let (tool_model, owners) = (&self.setting.tool_model, &self.query.owners);
        let inside = if self.limit < 0.0 {
            Some(tool_model.distance(scratch, owners, point))
        } else {
            tool_model.depth(scratch, owners, point).filter(|depth| depth.value >= 0.0)
        };
        let depth =
            inside.unwrap_or_else(|| tool_model.distance(scratch, &Owners::default(), point));
        DeepPoint { point, depth: depth.value, feature: depth.feature }
    }

    /// Returns whether a point exceeds the limit even after all rounding errors.
    pub(super) fn too_deep(&self, found: &DeepPoint) -> bool {
        found.depth > self.limit + 2.0 * self.error
    }
}

/// A point in the tool's frame and its depth.
#[derive(Clone, Copy)]
pub(super) struct DeepPoint {
    pub(super) point: Point,
    pub(super) depth: f64,
    pub(super) feature: usize,
}

impl DeepPoint {
    pub(super) fn best(&self, index: u32) -> DeepestCandidate {
        DeepestCandidate { point: self.point, feature: self.feature, index }
    }
}
