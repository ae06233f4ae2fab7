//! The state of a query: a part, how it is asked, and memory that is kept between queries.
//!
//! ```text
//! set_pose ──▶ traverse ──▶ filter ──▶ evaluate ──▶ reduce
//!   in reach?    leaves       points     the tool     force, torque, …
//! ```
//!
//! Nothing here depends on the tool's type but [`QueryState::evaluate`], so it is compiled once, in this crate.

use crate::bvh::{PoseTransform, QuerySetup, WIDTH};
use crate::pose::Pose;
use crate::probe::contacts::Contact;
use crate::probe::law::{Law, Weights};
use crate::probe::wrench::{self, Wrench};
use crate::tool::{Card, Felt, Senses, Wanted};
use crate::tree::{Candidates, Traversal, Tree, filter};
use crate::unit::Unit;
use fearless_simd::Level;
use nalgebra::Point3;

/// A part, how it is asked, and memory for the answer.
pub(super) struct QueryState<'a> {
    pub(super) tree: &'a Tree,
    /// The part's.
    pub(super) unit: Unit,
    /// The tool's unit of length in the part's.
    pub(super) length: f64,
    /// How far the tool reaches from its tip, in its unit.
    pub(super) reach: f64,
    pub(super) law: Law,
    pub(super) weights: Weights,
    pub(super) centre: Point3<f64>,
    pub(super) level: Level,
    setup: QuerySetup,
    pub(super) view: PoseTransform,
    traversal: Traversal,
    pub(super) candidates: Candidates,
    /// A leaf that had a point inside when it was asked last whether any has.
    hit: u32,
    pub(super) felt: Felt,
    /// Memory that tools keep between questions about single points.
    pub(super) room: Felt,
    pub(super) contacts: Vec<Contact>,
}

impl<'a> QueryState<'a> {
    /// Makes the state of queries to a part's points in their tree, whose lengths are in that unit.
    pub(super) fn new(tree: &'a Tree, unit: Unit, card: &Card) -> QueryState<'a> {
        let length = card.unit.to(unit);
        QueryState {
            tree,
            unit,
            length,
            reach: card.size(),
            law: Law::Thesis,
            weights: Weights::Area,
            centre: Point3::origin(),
            level: Level::new(),
            setup: QuerySetup::new(&tree.frame, card, length),
            view: PoseTransform::default(),
            traversal: Traversal::default(),
            candidates: Candidates::default(),
            hit: 0,
            felt: Felt::default(),
            room: Felt::default(),
            contacts: Vec::new(),
        }
    }

    /// Reserves memory for a contact of all points, without touching it.
    pub(super) fn reserve(&mut self) {
        self.traversal.reserve(self.tree);
        self.candidates.reserve(self.tree.leaves.len(), true);
    }

    /// Sets the pose. Returns whether the tool may reach the part.
    #[inline]
    pub(super) fn set_pose(&mut self, pose: &Pose) -> bool {
        self.setup.set_pose(&self.tree.frame, pose, &mut self.view)
    }

    /// Finds the leaves that the tool may reach, looking at no more nodes and leaves than that. Returns how many it looked at.
    pub(super) fn traverse(&mut self, most: usize) -> Option<usize> {
        let seen = (self.tree, &self.setup, &self.view);
        self.traversal.leaves(self.level, seen, most)
    }

    /// Finds the nodes above the leaves that the tool may reach. Returns how many there are.
    pub(super) fn traverse_to_nodes(&mut self) -> usize {
        self.traversal.nodes(self.level, (self.tree, &self.setup, &self.view))
    }

    /// Finds the leaves that the tool may reach under one of these nodes.
    pub(super) fn traverse_under(&mut self, node: usize) {
        self.traversal.under(self.level, (self.tree, &self.setup, &self.view), node);
    }

    /// Takes the leaf that was hit last, and no other.
    pub(super) fn traverse_to_last_hit(&mut self) {
        self.traversal.only(self.hit, (self.tree, &self.setup, &self.view));
    }

    /// Finds the points of the leaves that were found last that may be inside; with `attributes`, their normals and weights too.
    pub(super) fn filter(&mut self, attributes: bool) {
        let seen = (self.tree, &self.setup, &self.view);
        filter(self.level, seen, self.traversal.found(), attributes, &mut self.candidates);
    }

    /// Evaluates the tool at these points. Returns whether any is inside.
    pub(super) fn evaluate<W: Wanted, T: Senses + ?Sized>(&mut self, tool: &T) -> bool {
        if self.candidates.points.is_empty() {
            return false;
        }
        tool.feel::<W>(self.level, &self.candidates.points, self.length, &mut self.felt);
        self.felt.inside.iter().any(|block| *block != 0)
    }

    /// Sums the evaluations of the points inside.
    pub(super) fn reduce(&self, pose: &Pose) -> Wrench {
        wrench::sum(self, pose)
    }

    /// Notes the leaf of a point inside.
    pub(super) fn remember_hit(&mut self) {
        if let Some(place) = self.felt.places().next() {
            self.hit = self.candidates.indices()[place] / WIDTH as u32;
        }
    }
}
