//! The questions to a cloud's points, pose by pose.
//!
//! ```text
//! pose ──set_pose, traverse──▶ leaves near the tool ──filter──▶ candidates, in the tool's frame
//!                                                                       │ evaluate
//!   detect, deepest, posture, wrench, contacts ◀──reduce or list──  evaluations
//! ```

mod contacts;
mod graded;
mod law;
mod posture;
mod state;
mod stiffness;
mod wrench;

pub use contacts::{Contact, Summary, summary};
pub use graded::{BudgetError, Graded, GradedWrench};
pub use law::{Law, Weights};
pub use posture::{Deepest, Posture};
pub use stiffness::Stiffness;
pub use wrench::{Rounding, Wrench};

use crate::bvh::WIDTH;
use crate::pose::Pose;
use crate::tool::{Ask, Senses, Tool, Wanted, reserve};
use crate::tree::Tree;
use crate::unit::Unit;
use fearless_simd::Level;
use nalgebra::Point3;
use state::QueryState;

/// A tool beside a part, ready to be asked at one pose after another. A solid without an axis wants
/// [full](Pose::is_full) poses: one from an axis leaves open how it is turned.
///
/// Points are ruled out in `f32`, with a margin for what that rounds; those that are left are evaluated in `f64`,
/// and sums are taken in `f64`.
///
/// Memory is kept between questions: one allocates only where more points are near the tool than in
/// any before, and never after [`Probe::reserved`]. The answers have the same bits on every machine
/// and at every [`Level`].
///
/// What a question does not need is not computed. Of a tool whose type is known, as in
/// `Probe::new(&part, &Ball)`, a program has code only for the questions that it asks; of a
/// `&dyn Tool` for all of them.
pub struct Probe<'a, T: ?Sized = dyn Tool + 'a> {
    tool: &'a T,
    state: QueryState<'a>,
}

/// What is asked for, question by question.
struct Inside;
struct Depths;
struct Postures;
struct AlongDirections;
struct AlongGradients;
struct Everything;

impl Wanted for Inside {
    const ASK: Ask = Ask::INSIDE;
}
impl Wanted for Depths {
    const ASK: Ask = Ask { depth: true, ..Ask::INSIDE };
}
impl Wanted for Postures {
    const ASK: Ask = Ask { depth: true, niceness: true, region: true, ..Ask::INSIDE };
}
impl Wanted for AlongDirections {
    const ASK: Ask = Ask::DIRECTION;
}
impl Wanted for AlongGradients {
    const ASK: Ask = Ask::GRADIENT;
}
impl Wanted for Everything {
    const ASK: Ask = Ask::EVERYTHING;
}

impl<'a, T: Senses + ?Sized> Probe<'a, T> {
    /// Of a part's points in their tree, whose lengths are in that unit.
    pub(crate) fn of(tree: &'a Tree, unit: Unit, tool: &'a T) -> Probe<'a, T> {
        Probe { tool, state: QueryState::new(tree, unit, tool.card()) }
    }

    /// With another force law.
    #[must_use]
    pub fn law(mut self, law: Law) -> Probe<'a, T> {
        self.state.law = law;
        self
    }

    /// With other weights.
    #[must_use]
    pub fn weights(mut self, weights: Weights) -> Probe<'a, T> {
        self.state.weights = weights;
        self
    }

    /// With a compliance centre: a point of the tool's frame, in the part's unit, about which
    /// torque is taken.
    #[must_use]
    pub fn centre(mut self, centre: Point3<f64>) -> Probe<'a, T> {
        self.state.centre = centre;
        self
    }

    /// With another SIMD level than the best of this machine. The answers do not change.
    #[must_use]
    pub fn level(mut self, level: Level) -> Probe<'a, T> {
        self.state.level = level;
        self
    }

    /// With memory for a contact of all points of the part, so that no question to this probe allocates,
    /// however much larger its contact is than those before: 280 bytes per point, 28 MB for 100,000.
    /// Memory that no contact needs is never touched. Probes that are made from this one reserve nothing.
    #[must_use]
    pub fn reserved(mut self) -> Probe<'a, T> {
        self.reserve();
        let points = self.state.tree.places();
        reserve(&mut self.state.contacts, points);
        self
    }

    /// Reserves memory for all questions but [`Probe::contacts`]: 127 bytes per point.
    pub(crate) fn reserve(&mut self) {
        self.state.reserve();
        let QueryState { tree, felt, room, .. } = &mut self.state;
        felt.reserve_for(tree.leaves.len() * WIDTH, Everything::ASK);
        self.tool.reserve(felt);
        self.tool.reserve(room);
    }

    /// Another probe like this one, for another thread.
    #[must_use]
    pub fn another(&self) -> Probe<'a, T> {
        let QueryState { tree, unit, law, weights, centre, level, .. } = self.state;
        Probe::of(tree, unit, self.tool).law(law).weights(weights).centre(centre).level(level)
    }

    /// The compliance centre in the tool's frame, and the part's unit in mm.
    #[cfg(feature = "haptic")]
    pub(crate) fn place(&self) -> (Point3<f64>, f64) {
        (self.state.centre, self.state.unit.to(Unit::Millimetre))
    }

    /// How far a depth that is felt can be from that of the point that was given, in the part's unit:
    /// by storing points in `f32` beside their leaf's centre, by carrying them to the tool's frame, and
    /// by what rounding does to the depth itself. `None` where no bound of how steep depth is was proved
    /// of the tool ([`crate::tool::Depth::lipschitz`]). What lies between points is not in it.
    pub fn error(&self) -> Option<f64> {
        const HALF: f64 = f64::EPSILON / 2.0;
        let (card, tree, length) = (self.tool.card(), self.state.tree, self.state.length);
        let tool = length * card.size();
        let frame = &tree.frame;
        let [leaf, part] = [tree.leaf_size, frame.size].map(|half| frame.scale * f64::from(half));
        // Of each coordinate: an offset in `f32`, of a centre that the origin is taken from.
        let stored = leaf / 2f64.powi(24) + 4.0 * HALF * part;
        // A point inside is no farther from the tip than the tool is large, so neither is the origin but for the
        // part's size: two sums, then three products and a change of unit.
        let carried = HALF * (2.0 * (tool + 4.0 * part) + 8.0 * tool);
        let own = length * card.depth.rounding + HALF * tool;
        card.depth.lipschitz.map(|steepest| steepest * 3f64.sqrt() * (stored + carried) + own)
    }

    /// How much deeper than its deepest point the part's surface can be: the points' covering radius
    /// times how steep depth is at most, and what rounding does ([`Probe::error`]). `None` where either
    /// is not known. As sure as the [cover](crate::Tree::cover), which may be an estimate.
    pub fn unseen(&self) -> Option<f64> {
        let (card, cover) = (self.tool.card(), self.state.tree.cover()?);
        Some(card.depth.lipschitz? * cover.radius + self.error()?)
    }

    /// What no place of the part's surface is deeper than: the deepest point's depth, 0 without contact,
    /// and what may lie [between](Probe::unseen) the points. `None` where that is not known.
    pub fn depth_bound(&mut self, pose: &Pose) -> Option<f64> {
        let unseen = self.unseen()?;
        Some(self.deepest(pose).map_or(0.0, |deepest| deepest.depth) + unseen)
    }

    /// Whether any point of the part is inside the tool or on its surface. Stops at the first, and looks
    /// first where one was found last: tools move little from pose to pose.
    pub fn detect(&mut self, pose: &Pose) -> bool {
        if !self.state.set_pose(pose) {
            return false;
        }
        self.state.traverse_to_last_hit();
        let any = self.filter_and_evaluate::<Inside>() || {
            // Sixteen leaves at a time.
            let nodes = self.state.traverse_to_nodes();
            (0..nodes).any(|node| {
                self.state.traverse_under(node);
                self.filter_and_evaluate::<Inside>()
            })
        };
        if any {
            self.state.remember_hit();
        }
        any
    }

    /// The deepest point; `None` without contact.
    pub fn deepest(&mut self, pose: &Pose) -> Option<Deepest> {
        if self.ask::<Depths>(pose) { posture::deepest(&self.state, pose) } else { None }
    }

    /// What a posture is judged by: niceness, and how deep which surfaces are.
    pub fn posture(&mut self, pose: &Pose) -> Posture {
        if self.ask::<Postures>(pose) {
            posture::posture(&self.state, self.tool.card(), pose)
        } else {
            Posture::default()
        }
    }

    /// Force, torque, depth and niceness of the whole contact.
    pub fn wrench(&mut self, pose: &Pose) -> Wrench {
        if self.traverse_within(pose, usize::MAX) == Some(0) {
            return self.nothing();
        }
        self.reduce(pose)
    }

    /// Sets the pose and finds the leaves that the tool may reach, looking at no more nodes than that. Returns how many it looked at: 0 if the
    /// whole part is out of reach.
    fn traverse_within(&mut self, pose: &Pose, budget: usize) -> Option<usize> {
        if self.state.set_pose(pose) { self.state.traverse(budget) } else { Some(0) }
    }

    /// Returns what is felt without contact.
    fn nothing(&self) -> Wrench {
        Wrench::nothing(self.state.law, self.state.weights)
    }

    /// Returns the wrench of the leaves that were found last.
    fn reduce(&mut self, pose: &Pose) -> Wrench {
        self.state.filter(true);
        let any = match self.state.law {
            Law::Gradient => self.state.evaluate::<AlongGradients, T>(self.tool),
            Law::Thesis | Law::Facing => self.state.evaluate::<AlongDirections, T>(self.tool),
        };
        if any { self.state.reduce(pose) } else { self.nothing() }
    }

    /// Every point of the part inside the tool, with all that is felt there.
    pub fn contacts(&mut self, pose: &Pose) -> &[Contact] {
        let mut contacts = std::mem::take(&mut self.state.contacts);
        contacts.clear();
        if self.ask::<Everything>(pose) {
            contacts::list(&self.state, self.tool.card(), pose, &mut contacts);
        }
        self.state.contacts = contacts;
        &self.state.contacts
    }

    /// The places in the tree of the points inside that are deeper than that.
    pub(crate) fn deeper(&mut self, pose: &Pose, depth: f64) -> Vec<usize> {
        if !self.ask::<Depths>(pose) {
            return vec![];
        }
        let QueryState { felt, candidates, length, .. } = &self.state;
        let deep = felt.places().filter(|at| felt.depth[*at] * length > depth);
        deep.map(|at| candidates.indices()[at] as usize).collect()
    }

    /// Asks the same at many poses, on all cores: what each is asked, it is asked by itself, so the
    /// answers are those of one thread, in the order of the poses.
    ///
    /// ```
    /// # use touchoff::{Part, Pose, Probe, Tool};
    /// # fn deepest(part: &Part, tool: &dyn Tool, poses: &[Pose]) -> f64 {
    /// let depths = Probe::new(part, tool).map(poses, |probe, pose| probe.wrench(pose).depth());
    /// # depths.into_iter().fold(0.0, f64::max) }
    /// ```
    #[cfg(feature = "parallel")]
    pub fn map<R: Send>(
        &self,
        poses: &[Pose],
        ask: impl Fn(&mut Probe<'a, T>, &Pose) -> R + Sync,
    ) -> Vec<R> {
        use rayon::prelude::*;
        // So many that starting another probe is nothing beside them.
        const TOGETHER: usize = 256;
        poses
            .par_chunks(TOGETHER)
            .map_init(
                || self.another(),
                |probe, poses| poses.iter().map(|pose| ask(probe, pose)).collect::<Vec<R>>(),
            )
            .flatten_iter()
            .collect()
    }

    /// Evaluates the tool at all points of the part that may be inside. Returns whether any is.
    fn ask<W: Wanted>(&mut self, pose: &Pose) -> bool {
        if !self.state.set_pose(pose) {
            return false;
        }
        self.state.traverse(usize::MAX);
        self.filter_and_evaluate::<W>()
    }

    /// Evaluates the tool at the points of the leaves that were found last. Returns whether any is inside.
    fn filter_and_evaluate<W: Wanted>(&mut self) -> bool {
        self.state.filter(false);
        self.state.evaluate::<W, T>(self.tool)
    }
}
