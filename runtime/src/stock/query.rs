//! Queries of the points inside a tool, with memory that is kept between them. The points may change from
//! query to query, unlike those of a [`Probe`](crate::Probe).

use crate::bvh::{PoseTransform, QuerySetup};
use crate::interval::Interval;
use crate::point_bvh::{Candidates, PointBvh, Traversal, filter};
use crate::pose::Pose;
use crate::tool::{EnvelopeSlab, Evaluations, Outputs, Symmetry, Tool, ToolInfo};
use fearless_simd::Level;
use std::borrow::Cow;

/// The number of nodes that a test of the reach may visit. A tool far from all points needs a few dozen; one
/// that reaches the points would visit thousands.
const MAX_REACH_NODES: usize = 64;

/// A point inside a tool.
#[derive(Clone, Copy)]
pub(super) struct InsidePoint {
    /// The point's slot in the tree.
    pub(super) slot: usize,
    /// The depth, in the tool's unit.
    pub(super) depth: f64,
    /// The region of the tool.
    pub(super) region: usize,
}

/// Memory of queries.
#[derive(Default)]
pub(super) struct Query {
    view: PoseTransform,
    traversal: Traversal,
    candidates: Candidates,
    evaluations: Evaluations,
}

impl Query {
    /// Lists the points inside a tool at a pose. `length` is the length of the tool's unit in that of the
    /// points.
    pub(super) fn inside(
        &mut self,
        tree: &PointBvh,
        (tool, setup, length): (&dyn Tool, &QuerySetup, f64),
        pose: &Pose,
        points: &mut Vec<InsidePoint>,
    ) {
        points.clear();
        if !setup.set_pose(&tree.frame, pose, &mut self.view) {
            return;
        }
        let (level, input) = (Level::new(), (tree, setup, &self.view));
        self.traversal.leaves(level, input, usize::MAX);
        filter(level, input, self.traversal.found(), false, &mut self.candidates);
        let (candidates, evaluations) = (&self.candidates, &mut self.evaluations);
        if candidates.points.is_empty() {
            return;
        }
        let outputs = Outputs { depth: true, region: true, ..Outputs::INSIDE };
        tool.evaluate(level, outputs, &candidates.points, length, evaluations);
        points.extend(evaluations.inside_indices().map(|candidate| InsidePoint {
            slot: candidates.indices()[candidate] as usize,
            depth: evaluations.depth[candidate],
            region: evaluations.region[candidate] as usize,
        }));
    }

    /// Returns whether the envelope of `setup` at a pose is proved to reach no point.
    pub(super) fn is_out_of_reach(
        &mut self,
        tree: &PointBvh,
        setup: &QuerySetup,
        pose: &Pose,
    ) -> bool {
        if !setup.set_pose(&tree.frame, pose, &mut self.view) {
            return true;
        }
        let visited =
            self.traversal.leaves(Level::new(), (tree, setup, &self.view), MAX_REACH_NODES);
        visited.is_some() && self.traversal.found().len() == 0
    }
}

/// Returns the setup of queries of all points within a distance of a tool, in the tool's unit: of its
/// envelope, widened by the distance.
pub(super) fn widened(tree: &PointBvh, info: &ToolInfo, length: f64, distance: f64) -> QuerySetup {
    let wide = |Interval { low, high }| Interval::new(low - distance, high + distance);
    let slab = |slab: &EnvelopeSlab| {
        EnvelopeSlab::new(slab.low - distance, slab.high + distance, slab.radius + distance)
    };
    let envelope = ToolInfo {
        name: Cow::Borrowed(""),
        title: Cow::Borrowed(""),
        surfaces: Cow::Borrowed(&[]),
        regions: Cow::Borrowed(&[]),
        envelope: info.envelope.iter().map(slab).collect(),
        symmetry: match info.symmetry {
            Symmetry::Revolved => Symmetry::Revolved,
            Symmetry::Solid { extent } => Symmetry::Solid { extent: extent.map(wide) },
        },
        outline: Cow::Borrowed(&[]),
        ..*info
    };
    QuerySetup::new(&tree.frame, &envelope, length)
}
