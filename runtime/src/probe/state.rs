//! The state of a query: a part, the settings of the query, and memory that is kept between queries.
//!
//! ```text
//! set_pose ──▶ traverse ──▶ filter ──▶ evaluate ──▶ reduce
//!   in reach?    leaves       points     the tool     force, torque, …
//! ```
//!
//! Only [`QueryState::evaluate`] depends on the tool's type, so everything else is compiled once, in this crate.

use crate::bvh::{PoseTransform, QuerySetup, WIDTH};
use crate::keywords::keyword_enum;
use crate::part::Part;
use crate::point_bvh::{Candidates, PointBvh, Traversal, TraversalInput, filter};
use crate::pose::Pose;
use crate::tool::{BatchEvaluator, Evaluations, OutputSelection, ToolInfo};
use crate::unit::Unit;
use fearless_simd::Level;
use nalgebra::Point3;
use std::ops::Deref;
use std::sync::Arc;

/// The force on the tool as a function of a contact's magnitude. `m` is the magnitude, `w` the weight, `n` the part's
/// outward normal, `u` the direction to the tool's nearest surface.
///
/// `Gradient` is the default everywhere: of all laws it alone has an energy, so that no path gains any, the stiffness of a contact is
/// symmetric, and a haptic loop can account for what it stores. The law leaves out directions that a tool's file writes, and a factor of
/// a magnitude counts squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Law {
    /// `w m (n − u)` (Ho 1999, eq. 5.1, without the factor ½). Not conservative.
    Thesis,
    /// `w m ∇m`, the gradient of the energy `½ Σ w m²`: conservative.
    #[default]
    Gradient,
    /// The law `Thesis` without points whose normal faces away (`u · n > 0`), for thin sheets.
    Facing,
}

/// The weight of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Weights {
    /// The point's share of the surface: forces converge as the cloud gets denser.
    #[default]
    Area,
    /// 1 for every point, as in the thesis: forces grow with the density.
    Unit,
}

keyword_enum!(Law, "thesis, gradient, facing", Thesis "thesis", Gradient "gradient", Facing "facing");
keyword_enum!(Weights, "area, unit", Area "area", Unit "unit");

/// A part's points: those of one of its levels, or the finest of a part that is shared.
#[derive(Clone)]
pub(crate) enum PartPoints<'a> {
    Level(&'a PointBvh),
    Shared(Arc<Part>),
}

impl Deref for PartPoints<'_> {
    type Target = PointBvh;

    #[inline]
    fn deref(&self) -> &PointBvh {
        match self {
            PartPoints::Level(tree) => tree,
            PartPoints::Shared(part) => part.tree(),
        }
    }
}

/// A part, the settings of a query, and memory for the results.
pub(super) struct QueryState<'a> {
    pub(super) tree: PartPoints<'a>,
    /// The part's unit of length.
    pub(super) unit: Unit,
    /// The length of the tool's unit in the part's unit.
    pub(super) length: f64,
    /// The tool's size: its largest reach from the tip along the axis, or its radius, in the tool's unit.
    pub(super) tool_size: f64,
    pub(super) law: Law,
    pub(super) weights: Weights,
    pub(super) centre: Point3<f64>,
    pub(super) level: Level,
    setup: QuerySetup,
    pub(super) view: PoseTransform,
    traversal: Traversal,
    pub(super) candidates: Candidates,
    /// A leaf that had a point inside when [`Probe::detect`](super::Probe::detect) found one last.
    hit: u32,
    pub(super) evaluations: Evaluations,
    /// Memory that tools keep between evaluations of single points.
    pub(super) scratch: Evaluations,
}

impl<'a> QueryState<'a> {
    /// Makes the state of queries on a part's points in their tree, whose lengths are in `unit`.
    pub(super) fn new(tree: PartPoints<'a>, unit: Unit, info: &ToolInfo) -> QueryState<'a> {
        let length = info.unit.factor_to(unit);
        QueryState {
            unit,
            length,
            tool_size: info.size(),
            law: Law::default(),
            weights: Weights::default(),
            centre: Point3::origin(),
            level: Level::new(),
            setup: QuerySetup::new(&tree.frame, info, length),
            tree,
            view: PoseTransform::default(),
            traversal: Traversal::default(),
            candidates: Candidates::default(),
            hit: 0,
            evaluations: Evaluations::default(),
            scratch: Evaluations::default(),
        }
    }

    /// Reserves memory for a contact of all points, without touching it.
    pub(super) fn reserve(&mut self) {
        self.traversal.reserve(&self.tree);
        self.candidates.reserve(self.tree.leaves.len(), true);
    }

    /// Sets the pose. Returns whether the tool may reach the part.
    #[inline]
    pub(super) fn set_pose(&mut self, pose: &Pose) -> bool {
        self.setup.set_pose(&self.tree.frame, pose, &mut self.view)
    }

    /// Finds the leaves that the tool may reach, visiting at most `max_nodes` nodes and leaves. Returns their number;
    /// `None` if that limit does not suffice.
    pub(super) fn traverse(&mut self, max_nodes: usize) -> Option<usize> {
        let input = TraversalInput { tree: &self.tree, setup: &self.setup, view: &self.view };
        self.traversal.leaves(self.level, input, max_nodes)
    }

    /// Finds the nodes above the leaves that the tool may reach. Returns the number of these nodes.
    pub(super) fn traverse_to_nodes(&mut self) -> usize {
        let input = TraversalInput { tree: &self.tree, setup: &self.setup, view: &self.view };
        self.traversal.nodes(self.level, input)
    }

    /// Finds the leaves that the tool may reach under one of these nodes.
    pub(super) fn traverse_under(&mut self, node: usize) {
        let input = TraversalInput { tree: &self.tree, setup: &self.setup, view: &self.view };
        self.traversal.under(self.level, input, node);
    }

    /// Selects the leaf that was hit last, and no other.
    pub(super) fn traverse_to_last_hit(&mut self) {
        let input = TraversalInput { tree: &self.tree, setup: &self.setup, view: &self.view };
        self.traversal.only(self.hit, input);
    }

    /// Finds the points that may be inside among those of the leaves found last; with `attributes`, their normals and
    /// weights too.
    pub(super) fn filter(&mut self, attributes: bool) {
        let input = TraversalInput { tree: &self.tree, setup: &self.setup, view: &self.view };
        filter(self.level, input, self.traversal.found(), attributes, &mut self.candidates);
    }

    /// Evaluates the tool at these points. Returns whether any point is inside.
    pub(super) fn evaluate<W: OutputSelection, T: BatchEvaluator + ?Sized>(
        &mut self,
        tool: &T,
    ) -> bool {
        // The evaluations are those of the query before, and must not be read.
        if self.candidates.points.is_empty() {
            return false;
        }
        tool.evaluate_outputs::<W>(
            self.level,
            &self.candidates.points,
            self.length,
            &mut self.evaluations,
        );
        self.evaluations.inside.iter().any(|block| *block != 0)
    }

    /// Records the leaf of the first point inside.
    pub(super) fn remember_hit(&mut self) {
        if let Some(candidate) = self.evaluations.inside_indices().next() {
            self.hit = self.candidates.indices()[candidate] / WIDTH as u32;
        }
    }
}
