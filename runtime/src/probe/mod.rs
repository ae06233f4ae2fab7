//! A tool feeling a part, pose by pose.
//!
//! ```text
//! pose ──view──▶ leaves near the tool ──filter──▶ candidates ──carry──▶ tool's frame
//!                                                                          │ evaluate
//!      detect, wrench, contacts  ◀──sum or list──  what is felt  ◀─────────┘
//! ```

mod contacts;
mod law;
mod wrench;

pub use contacts::{Contact, Summary, summary};
pub use law::{Law, UnknownWord, Weights};
pub use wrench::{Deepest, Wrench};

use crate::part::Part;
use crate::pose::Pose;
use crate::tool::{Ask, Felt, Tool};
use crate::tree::{Candidates, Search, Sight, View, Walker};
use fearless_simd::Level;
use nalgebra::Point3;

/// A tool beside a part, ready to be asked at one pose after another. A solid without an axis wants
/// [full](Pose::is_full) poses: one from an axis leaves open how it is turned.
///
/// Memory is kept between questions, so that after the first few none is allocated. The answers
/// have the same bits on every machine and at every [`Level`].
pub struct Probe<'a> {
    part: &'a Part,
    tool: &'a dyn Tool,
    /// The tool's unit of length in the part's.
    length: f64,
    law: Law,
    weights: Weights,
    centre: Point3<f64>,
    level: Level,
    sight: Sight,
    view: View,
    walker: Walker,
    candidates: Candidates,
    some_in: Vec<(u32, u32)>,
    felt: Felt,
    contacts: Vec<Contact>,
}

impl<'a> Probe<'a> {
    /// A probe with the thesis's law, area weights and the tip for a compliance centre.
    pub fn new(part: &'a Part, tool: &'a dyn Tool) -> Probe<'a> {
        let length = tool.card().unit.to(part.unit());
        Probe {
            part,
            tool,
            length,
            law: Law::Thesis,
            weights: Weights::Area,
            centre: Point3::origin(),
            level: Level::new(),
            sight: Sight::new(part.tree(), tool, length),
            view: View::default(),
            walker: Walker::default(),
            candidates: Candidates::default(),
            some_in: Vec::new(),
            felt: Felt::default(),
            contacts: Vec::new(),
        }
    }

    /// With another force law.
    #[must_use]
    pub fn law(mut self, law: Law) -> Probe<'a> {
        self.law = law;
        self
    }

    /// With other weights.
    #[must_use]
    pub fn weights(mut self, weights: Weights) -> Probe<'a> {
        self.weights = weights;
        self
    }

    /// With a compliance centre: a point of the tool's frame, in the part's unit, about which
    /// torque is taken.
    #[must_use]
    pub fn centre(mut self, centre: Point3<f64>) -> Probe<'a> {
        self.centre = centre;
        self
    }

    /// With another SIMD level than the best of this machine. The answers do not change.
    #[must_use]
    pub fn level(mut self, level: Level) -> Probe<'a> {
        self.level = level;
        self
    }

    /// How far a depth that is felt can be from that of the point that was given, in the part's unit:
    /// by storing points in `f32` beside their leaf's centre, by carrying them to the tool's frame, and
    /// by what rounding does to the depth itself. `None` where no bound of how steep depth is was proved
    /// of the tool ([`crate::tool::Depth::lipschitz`]). What lies between points is not in it.
    pub fn error(&self) -> Option<f64> {
        const HALF: f64 = f64::EPSILON / 2.0;
        let (card, tree) = (self.tool.card(), self.part.tree());
        let tool = self.length * card.size();
        let [leaf, part] = [tree.leaf_size, tree.size].map(|half| tree.scale * f64::from(half));
        // Of each coordinate: an offset in `f32`, of a centre that the origin is taken from.
        let stored = leaf / 2f64.powi(24) + 4.0 * HALF * part;
        // A point inside is no farther from the tip than the tool is large, so neither is the origin
        // but for the part's size: two sums, then three products and a change of unit.
        let carried = HALF * (2.0 * (tool + 4.0 * part) + 8.0 * tool);
        let own = self.length * card.depth.rounding + HALF * tool;
        card.depth.lipschitz.map(|steepest| steepest * 3f64.sqrt() * (stored + carried) + own)
    }

    /// Whether any point of the part is inside the tool or on its surface. Stops at the first.
    pub fn detect(&mut self, pose: &Pose) -> bool {
        let tree = self.part.tree();
        if !self.sight.look(tree, pose, &mut self.view) {
            return false;
        }
        let leaves = self.walker.leaves(self.level, tree, &self.sight, &self.view);
        // A few leaves at a time: the first hit ends the question.
        let some = (0..leaves.len()).step_by(4).map(|from| from..leaves.len().min(from + 4));
        for some in some {
            self.candidates.clear();
            self.tool.search(&mut Search {
                level: self.level,
                tree,
                sight: &self.sight,
                view: &self.view,
                leaves,
                some,
                skin: false,
                candidates: &mut self.candidates,
                some_in: &mut self.some_in,
            });
            let points = &self.candidates.points;
            if !points.is_empty() {
                self.tool.evaluate(self.level, Ask::INSIDE, points, self.length, &mut self.felt);
                if self.felt.inside.iter().any(|block| *block != 0) {
                    return true;
                }
            }
        }
        false
    }

    /// Force, torque, depth and niceness of the whole contact.
    pub fn wrench(&mut self, pose: &Pose) -> Wrench {
        let ask = if self.law == Law::Gradient { Ask::GRADIENT } else { Ask::DIRECTION };
        if self.feel(pose, ask, true) { wrench::sum(self, pose) } else { wrench::nothing(self) }
    }

    /// Every point of the part inside the tool, with all that is felt there.
    pub fn contacts(&mut self, pose: &Pose) -> &[Contact] {
        let mut contacts = std::mem::take(&mut self.contacts);
        contacts.clear();
        if self.feel(pose, Ask::EVERYTHING, false) {
            contacts::list(self, pose, &mut contacts);
        }
        self.contacts = contacts;
        &self.contacts
    }

    /// Finds the candidates and evaluates them; whether there are any.
    fn feel(&mut self, pose: &Pose, ask: Ask, skin: bool) -> bool {
        let tree = self.part.tree();
        if !self.sight.look(tree, pose, &mut self.view) {
            return false;
        }
        let leaves = self.walker.leaves(self.level, tree, &self.sight, &self.view);
        self.candidates.clear();
        self.tool.search(&mut Search {
            level: self.level,
            tree,
            sight: &self.sight,
            view: &self.view,
            leaves,
            some: 0..leaves.len(),
            skin,
            candidates: &mut self.candidates,
            some_in: &mut self.some_in,
        });
        let points = &self.candidates.points;
        if points.is_empty() {
            return false;
        }
        self.tool.evaluate(self.level, ask, points, self.length, &mut self.felt);
        true
    }
}
