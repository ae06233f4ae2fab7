//! Queries of the points inside a tool, which may change from query to query, unlike those of a [`Probe`](crate::Probe).

use crate::bvh::{PoseTransform, QuerySetup};
use crate::interval::Interval;
use crate::point_bvh::{Candidates, PointBvh, Traversal, TraversalInput, filter};
use crate::pose::Pose;
use crate::tool::{EnvelopeSlab, Evaluations, Outputs, Symmetry, Tool, ToolInfo};
use crate::unit::Unit;
use fearless_simd::Level;
use std::borrow::Cow;

/// The number of nodes that a test of the reach may visit. A tool far from all points needs a few dozen; one
/// that reaches the points would visit thousands.
const MAX_REACH_NODES: usize = 64;

/// A point inside a tool.
#[derive(Clone, Copy, Debug)]
pub struct InsidePoint {
    /// The point's slot in the tree.
    pub slot: usize,
    /// The depth, in the points' unit.
    pub depth: f64,
    /// The region of the tool.
    pub region: usize,
}

/// The space around a tool in which points are found, prepared for one tree.
#[derive(Clone, Debug)]
pub struct ToolEnvelope {
    setup: QuerySetup,
    /// The length of the tool's unit in that of the points.
    length: f64,
}

impl ToolEnvelope {
    /// Prepares the envelope of a tool for points in `unit`.
    pub fn new(tree: &PointBvh, info: &ToolInfo, unit: Unit) -> ToolEnvelope {
        let length = info.unit.factor_to(unit);
        ToolEnvelope { setup: QuerySetup::new(&tree.frame, info, length), length }
    }

    /// Prepares the envelope of a tool, widened by a distance in `unit` on all sides.
    pub fn widened(tree: &PointBvh, info: &ToolInfo, unit: Unit, distance: f64) -> ToolEnvelope {
        let length = info.unit.factor_to(unit);
        let distance = distance / length;
        let slabs = info.envelope.iter().map(|slab| {
            EnvelopeSlab::new(slab.low - distance, slab.high + distance, slab.radius + distance)
        });
        // The setup reads nothing but the envelope, the symmetry and the unit.
        let envelope = ToolInfo {
            name: Cow::Borrowed(""),
            title: Cow::Borrowed(""),
            surfaces: Cow::Borrowed(&[]),
            regions: Cow::Borrowed(&[]),
            envelope: slabs.collect(),
            symmetry: match info.symmetry {
                Symmetry::Revolved => Symmetry::Revolved,
                Symmetry::Solid { extent } => Symmetry::Solid {
                    extent: extent
                        .map(|side| Interval::new(side.low - distance, side.high + distance)),
                },
            },
            outline: Cow::Borrowed(&[]),
            ..*info
        };
        ToolEnvelope { setup: QuerySetup::new(&tree.frame, &envelope, length), length }
    }
}

/// Memory of queries of the points inside a tool.
#[derive(Default)]
pub struct InsideQuery {
    view: PoseTransform,
    traversal: Traversal,
    candidates: Candidates,
    evaluations: Evaluations,
}

crate::debug::debug!([] InsideQuery, "InsideQuery", |this| { found: this.candidates.points.len() });

impl InsideQuery {
    /// Replaces the contents of `points` by the points inside a tool at a pose. A pose so far away that the
    /// tool reaches no point has none.
    pub fn inside(
        &mut self,
        tree: &PointBvh,
        tool: &dyn Tool,
        envelope: &ToolEnvelope,
        pose: &Pose,
        points: &mut Vec<InsidePoint>,
    ) {
        points.clear();
        let ToolEnvelope { setup, length } = envelope;
        if !setup.set_pose(&tree.frame, pose, &mut self.view) {
            return;
        }
        let (level, input) = (Level::new(), TraversalInput { tree, setup, view: &self.view });
        self.traversal.leaves(level, input, usize::MAX);
        filter(level, input, self.traversal.found(), false, &mut self.candidates);
        let (candidates, evaluations) = (&self.candidates, &mut self.evaluations);
        if candidates.points.is_empty() {
            return;
        }
        // Only what the result holds is computed.
        let outputs = Outputs { depth: true, region: true, ..Outputs::INSIDE };
        tool.evaluate(level, outputs, &candidates.points, *length, evaluations);
        points.extend(evaluations.inside_indices().map(|candidate| InsidePoint {
            slot: candidates.indices()[candidate] as usize,
            depth: evaluations.depth[candidate] * length,
            region: evaluations.region[candidate] as usize,
        }));
    }

    /// Returns whether an envelope at a pose is proved to reach no point. A test that would take long ends
    /// with `false`.
    pub fn is_out_of_reach(
        &mut self,
        tree: &PointBvh,
        envelope: &ToolEnvelope,
        pose: &Pose,
    ) -> bool {
        if !envelope.setup.set_pose(&tree.frame, pose, &mut self.view) {
            return true;
        }
        let input = TraversalInput { tree, setup: &envelope.setup, view: &self.view };
        let visited = self.traversal.leaves(Level::new(), input, MAX_REACH_NODES);
        // An aborted descent has found nothing yet, which proves nothing.
        visited.is_some() && self.traversal.found().len() == 0
    }
}
