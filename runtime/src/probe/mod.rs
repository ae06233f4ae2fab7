//! A tool feeling a part, pose by pose.
//!
//! ```text
//! pose ──look──▶ leaves near the tool ──sift──▶ candidates, in the tool's frame
//!                                                                   │ feel
//!   detect, deepest, posture, wrench, contacts ◀──sum or list──  what is felt
//! ```

mod contacts;
mod graded;
mod law;
mod once;
mod posture;
pub mod precision;
mod stiffness;
mod wrench;

pub use contacts::{Contact, Summary, summary};
pub use graded::{BudgetError, Graded, GradedWrench};
pub use law::{Law, Weights};
pub(crate) use once::Once;
pub use posture::{Deepest, Posture};
pub use stiffness::Stiffness;
pub use wrench::{Rounding, Wrench};

use crate::bvh::{Sight, View, WIDTH};
use crate::pose::Pose;
use crate::tool::{Ask, Felt, Senses, Tool, Wanted, reserve};
use crate::tree::{Search, Tree};
use crate::unit::Unit;
use fearless_simd::Level;
use nalgebra::Point3;
use precision::{Filtered, Precision};

/// A tool beside a part, ready to be asked at one pose after another. A solid without an axis wants
/// [full](Pose::is_full) poses: one from an axis leaves open how it is turned.
///
/// Memory is kept between questions: one allocates only where more points are near the tool than in
/// any before, and never after [`Probe::reserved`]. The answers have the same bits on every machine
/// and at every [`Level`].
///
/// What a question does not need is not computed. Of a tool whose type is known, as in
/// `Probe::new(&part, &Ball)`, a program has code only for the questions that it asks; of a
/// `&dyn Tool` for all of them.
pub struct Probe<'a, T: ?Sized = dyn Tool + 'a, P: Precision = Filtered> {
    tool: &'a T,
    beside: Beside<'a, P>,
}

/// What is beside a tool: a part, how it is to be felt, and room to find out.
pub struct Beside<'a, P: Precision> {
    tree: &'a Tree,
    /// The part's.
    unit: Unit,
    /// The tool's unit of length in the part's.
    length: f64,
    /// How far the tool reaches from its tip, in its unit.
    reach: f64,
    law: Law,
    weights: Weights,
    centre: Point3<f64>,
    level: Level,
    sight: Sight<P::Rough>,
    view: View<P::Rough>,
    search: Search<P::Rough, P::Number>,
    /// A leaf that had a point inside when it was asked last whether any has.
    hit: u32,
    felt: Felt<P::Number>,
    /// For what tools keep between questions in `f64`.
    room: Felt,
    contacts: Vec<Contact>,
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
        Probe::exactly(tree, unit, tool)
    }
}

impl<'a, T: Senses<P::Number> + ?Sized, P: Precision> Probe<'a, T, P> {
    fn exactly(tree: &'a Tree, unit: Unit, tool: &'a T) -> Probe<'a, T, P> {
        let length = tool.card().unit.to(unit);
        let beside = Beside {
            tree,
            unit,
            length,
            reach: tool.card().size(),
            law: Law::Thesis,
            weights: Weights::Area,
            centre: Point3::origin(),
            level: Level::new(),
            sight: Sight::new(&tree.frame, tool.card(), length),
            view: View::default(),
            search: Search::default(),
            hit: 0,
            felt: Felt::default(),
            room: Felt::default(),
            contacts: Vec::new(),
        };
        Probe { tool, beside }
    }

    /// With another force law.
    #[must_use]
    pub fn law(mut self, law: Law) -> Probe<'a, T, P> {
        self.beside.law = law;
        self
    }

    /// With other weights.
    #[must_use]
    pub fn weights(mut self, weights: Weights) -> Probe<'a, T, P> {
        self.beside.weights = weights;
        self
    }

    /// With a compliance centre: a point of the tool's frame, in the part's unit, about which
    /// torque is taken.
    #[must_use]
    pub fn centre(mut self, centre: Point3<f64>) -> Probe<'a, T, P> {
        self.beside.centre = centre;
        self
    }

    /// With another SIMD level than the best of this machine. The answers do not change.
    #[must_use]
    pub fn level(mut self, level: Level) -> Probe<'a, T, P> {
        self.beside.level = level;
        self
    }

    /// With another precision than [`Filtered`]: `probe.precision::<Single>()`.
    #[must_use]
    pub fn precision<Q: Precision>(self) -> Probe<'a, T, Q>
    where
        T: Senses<Q::Number>,
    {
        let Beside { tree, unit, law, weights, centre, level, .. } = self.beside;
        Probe::exactly(tree, unit, self.tool).law(law).weights(weights).centre(centre).level(level)
    }

    /// With memory for a contact of all points of the part, so that no question to this probe allocates,
    /// however much larger its contact is than those before: 280 bytes per point, 28 MB for 100,000.
    /// Memory that no contact needs is never touched. Probes that are made from this one reserve nothing.
    #[must_use]
    pub fn reserved(mut self) -> Probe<'a, T, P> {
        self.reserve();
        let points = self.beside.tree.places();
        reserve(&mut self.beside.contacts, points);
        self
    }

    /// Reserves memory for all questions but [`Probe::contacts`]: 127 bytes per point.
    pub(crate) fn reserve(&mut self) {
        let Beside { tree, search, felt, room, .. } = &mut self.beside;
        search.reserve(tree, true);
        felt.reserve_for(tree.leaves.len() * WIDTH, Everything::ASK);
        self.tool.reserve_room(felt);
        self.tool.reserve(room);
    }

    /// Another probe like this one, for another thread.
    #[must_use]
    pub fn another(&self) -> Probe<'a, T, P> {
        let Beside { tree, unit, law, weights, centre, level, .. } = self.beside;
        Probe::exactly(tree, unit, self.tool).law(law).weights(weights).centre(centre).level(level)
    }

    /// The compliance centre in the tool's frame, and the part's unit in mm.
    #[cfg(feature = "haptic")]
    pub(crate) fn place(&self) -> (Point3<f64>, f64) {
        (self.beside.centre, self.beside.unit.to(Unit::Millimetre))
    }

    /// How far a depth that is felt can be from that of the point that was given, in the part's unit:
    /// by storing points in `f32` beside their leaf's centre, by carrying them to the tool's frame, and
    /// by what rounding does to the depth itself. `None` where no bound of how steep depth is was proved
    /// of the tool ([`crate::tool::Depth::lipschitz`]). What lies between points is not in it.
    pub fn error(&self) -> Option<f64> {
        const HALF: f64 = f64::EPSILON / 2.0;
        let (card, tree, length) = (self.tool.card(), self.beside.tree, self.beside.length);
        let tool = length * card.size();
        let frame = &tree.frame;
        let [leaf, part] = [tree.leaf_size, frame.size].map(|half| frame.scale * f64::from(half));
        // Of each coordinate: an offset in `f32`, of a centre that the origin is taken from.
        let stored = leaf / 2f64.powi(24) + 4.0 * HALF * part;
        let carried = P::carried(tool, leaf, part);
        let own = length * P::felt(&card.depth) + HALF * tool;
        card.depth.lipschitz.map(|steepest| steepest * 3f64.sqrt() * (stored + carried) + own)
    }

    /// How much deeper than its deepest point the part's surface can be: the points' covering radius
    /// times how steep depth is at most, and what rounding does ([`Probe::error`]). `None` where either
    /// is not known. As sure as the [cover](crate::Tree::cover), which may be an estimate.
    pub fn unseen(&self) -> Option<f64> {
        let (card, cover) = (self.tool.card(), self.beside.tree.cover()?);
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
        if !self.beside.look(pose) {
            return false;
        }
        P::again(&mut self.beside);
        let any = self.feel::<Inside>() || {
            // Sixteen leaves at a time.
            let nodes = P::nodes(&mut self.beside);
            (0..nodes).any(|node| {
                P::under(&mut self.beside, node);
                self.feel::<Inside>()
            })
        };
        if any {
            self.beside.remember();
        }
        any
    }

    /// The deepest point; `None` without contact.
    pub fn deepest(&mut self, pose: &Pose) -> Option<Deepest> {
        if self.ask::<Depths>(pose) { posture::deepest(&self.beside, pose) } else { None }
    }

    /// What a posture is judged by: niceness, and how deep which surfaces are.
    pub fn posture(&mut self, pose: &Pose) -> Posture {
        if self.ask::<Postures>(pose) {
            posture::posture(&self.beside, self.tool.card(), pose)
        } else {
            Posture::default()
        }
    }

    /// Force, torque, depth and niceness of the whole contact.
    pub fn wrench(&mut self, pose: &Pose) -> Wrench {
        let found = self.beside.look(pose);
        if found {
            P::all(&mut self.beside, true);
        }
        self.sum(pose, found)
    }

    /// Finds the leaves of the whole part that the tool may reach, if no more nodes are looked at than
    /// that; how many were.
    fn look_within(&mut self, pose: &Pose, budget: usize) -> Option<usize> {
        if self.beside.look(pose) { P::within(&mut self.beside, budget) } else { Some(0) }
    }

    /// [`Probe::wrench`] of the leaves that were found last.
    fn looked(&mut self, pose: &Pose) -> Wrench {
        let found = self.beside.look(pose);
        if found {
            P::found(&mut self.beside);
        }
        self.sum(pose, found)
    }

    /// Evaluates the candidates, if there are any, and sums what is felt.
    fn sum(&mut self, pose: &Pose, found: bool) -> Wrench {
        let any = found
            && match self.beside.law {
                Law::Gradient => self.feel::<AlongGradients>(),
                Law::Thesis | Law::Facing => self.feel::<AlongDirections>(),
            };
        let Beside { law, weights, .. } = self.beside;
        if any { P::sum(&self.beside, pose) } else { Wrench::nothing(law, weights) }
    }

    /// Every point of the part inside the tool, with all that is felt there.
    pub fn contacts(&mut self, pose: &Pose) -> &[Contact] {
        let mut contacts = std::mem::take(&mut self.beside.contacts);
        contacts.clear();
        if self.ask::<Everything>(pose) {
            contacts::list(&self.beside, self.tool.card(), pose, &mut contacts);
        }
        self.beside.contacts = contacts;
        &self.beside.contacts
    }

    /// The places in the tree of the points inside that are deeper than that.
    pub(crate) fn deeper(&mut self, pose: &Pose, depth: f64) -> Vec<usize> {
        if !self.ask::<Depths>(pose) {
            return vec![];
        }
        let Beside { felt, search, length, .. } = &self.beside;
        let deep = felt.places().filter(|at| felt.depth[*at].into() * length > depth);
        deep.map(|at| search.candidates.indices()[at] as usize).collect()
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
        ask: impl Fn(&mut Probe<'a, T, P>, &Pose) -> R + Sync,
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

    /// Finds the candidates of the whole part and evaluates them; whether any is inside.
    fn ask<W: Wanted>(&mut self, pose: &Pose) -> bool {
        if !self.beside.look(pose) {
            return false;
        }
        P::all(&mut self.beside, false);
        self.feel::<W>()
    }

    /// Evaluates the candidates; whether any is inside.
    fn feel<W: Wanted>(&mut self) -> bool {
        let Beside { level, search, length, felt, .. } = &mut self.beside;
        let candidates = &search.candidates;
        if candidates.points.is_empty() {
            return false;
        }
        self.tool.feel::<W>(*level, &candidates.points, *length, felt);
        felt.inside.iter().any(|block| *block != 0)
    }
}

impl<P: Precision> Beside<'_, P> {
    /// Looks from a pose; whether the tool may reach the part.
    fn look(&mut self, pose: &Pose) -> bool {
        self.sight.look(&self.tree.frame, pose, &mut self.view)
    }

    /// Notes the leaf of a point inside.
    fn remember(&mut self) {
        if let Some(place) = self.felt.places().next() {
            self.hit = self.search.candidates.indices()[place] / WIDTH as u32;
        }
    }
}
