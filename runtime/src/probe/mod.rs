//! Queries on the points of a cloud, pose by pose.
//!
//! ```text
//! pose ──set_pose, traverse──▶ leaves near the tool ──filter──▶ candidates, in the tool's frame
//!                                                                       │ evaluate
//!   detect, deepest, posture, wrench, contacts ◀──reduce or list──  evaluations
//! ```

mod contacts;
mod inside;
mod lod;
mod state;
mod wrench;

pub use contacts::{Contact, DeepestPoint, Posture, Summary, summary};
pub use inside::{InsidePoint, InsideQuery, ToolEnvelope};
pub use lod::{BudgetError, LodProbe, LodWrench};
pub use state::{Law, Weights};
pub use wrench::{Stiffness, Wrench, WrenchRounding};

use crate::bvh::WIDTH;
use crate::debug::debug;
use crate::handle::Handle;
use crate::pose::Pose;
use crate::tool::{BatchEvaluator, OutputSelection, Outputs, Tool, reserve};
use crate::unit::Unit;
#[cfg(feature = "parallel")]
use crate::{cancellation, parallel};
use fearless_simd::Level;
use nalgebra::Point3;
pub(crate) use state::PartPoints;
use state::QueryState;

/// A tool paired with a part, ready for queries at one pose after another. A solid without an axis needs poses
/// [with a spin](Pose::has_spin): a pose made from an axis leaves its rotation about the axis open.
///
/// Points are ruled out in `f32`, with a margin for its rounding. The remaining points are evaluated in `f64`, and sums
/// are taken in `f64`.
///
/// Memory is kept between queries. A query allocates only where more points are near the tool than in any query before,
/// and never after [`Probe::with_reserved_memory`]. The results have the same bits on every machine and at every
/// [`Level`].
///
/// Only the outputs that a query needs are computed. For a tool whose type is known, as in `Probe::new(&part, &Ball)`,
/// a program has code only for the queries that it uses; for a `&dyn Tool` it has code for all of them.
pub struct Probe<'a, T: ?Sized = dyn Tool + 'a> {
    tool: Handle<'a, T>,
    state: QueryState<'a>,
    /// Memory of [`Probe::contacts`].
    contacts: Vec<Contact>,
}

debug!([T: ?Sized] Probe<'_, T>, "Probe", |this| {
    points: this.state.tree.len(), law: this.state.law, weights: this.state.weights,
});

/// The clone has the same settings, and memory of its own: queries of both may run at the same time.
impl<T: BatchEvaluator + ?Sized> Clone for Probe<'_, T> {
    fn clone(&self) -> Self {
        let QueryState { ref tree, unit, law, weights, centre, level, .. } = self.state;
        Probe::of(tree.clone(), unit, self.tool.clone())
            .with_law(law)
            .with_weights(weights)
            .with_centre(centre)
            .with_level(level)
    }
}

/// Output selections, one per kind of query.
struct Inside;
struct Depths;
struct Postures;
struct AlongDirections;
struct AlongGradients;
struct Everything;

impl OutputSelection for Inside {
    const OUTPUTS: Outputs = Outputs::INSIDE;
}
impl OutputSelection for Depths {
    const OUTPUTS: Outputs = Outputs { depth: true, ..Outputs::INSIDE };
}
impl OutputSelection for Postures {
    const OUTPUTS: Outputs =
        Outputs { depth: true, niceness: true, region: true, ..Outputs::INSIDE };
}
impl OutputSelection for AlongDirections {
    const OUTPUTS: Outputs = Outputs::DIRECTION;
}
impl OutputSelection for AlongGradients {
    const OUTPUTS: Outputs = Outputs::GRADIENT;
}
impl OutputSelection for Everything {
    const OUTPUTS: Outputs = Outputs::EVERYTHING;
}

impl<'a, T: BatchEvaluator + ?Sized> Probe<'a, T> {
    /// Makes a probe of a part's points in their tree, whose lengths are in `unit`.
    pub(crate) fn of(tree: PartPoints<'a>, unit: Unit, tool: Handle<'a, T>) -> Probe<'a, T> {
        let state = QueryState::new(tree, unit, tool.info());
        Probe { tool, state, contacts: Vec::new() }
    }

    /// Sets the force law.
    #[must_use]
    pub fn with_law(mut self, law: Law) -> Probe<'a, T> {
        self.state.law = law;
        self
    }

    /// Sets the weights of points.
    #[must_use]
    pub fn with_weights(mut self, weights: Weights) -> Probe<'a, T> {
        self.state.weights = weights;
        self
    }

    /// Sets the compliance centre, about which torque is taken: a point of the tool's frame, in the part's unit.
    #[must_use]
    pub fn with_centre(mut self, centre: Point3<f64>) -> Probe<'a, T> {
        self.state.centre = centre;
        self
    }

    /// Sets the SIMD level, instead of the best one of this machine. The results do not change.
    #[must_use]
    pub fn with_level(mut self, level: Level) -> Probe<'a, T> {
        self.state.level = level;
        self
    }

    /// Reserves memory for a contact of all points of the part, so that no query of this probe allocates, however much
    /// larger its contact is than earlier ones: 280 bytes per point, 28 MB for 100,000 points. Memory that no contact
    /// needs is never touched. Clones reserve nothing.
    #[must_use]
    pub fn with_reserved_memory(mut self) -> Probe<'a, T> {
        self.reserve();
        let points = self.state.tree.slots();
        reserve(&mut self.contacts, points);
        self
    }

    /// Reserves memory for all queries but [`Probe::contacts`]: 127 bytes per point.
    pub fn reserve(&mut self) {
        self.state.reserve();
        let QueryState { tree, evaluations, scratch, .. } = &mut self.state;
        evaluations.reserve_for(tree.leaves.len() * WIDTH, Everything::OUTPUTS);
        self.tool.reserve(evaluations);
        self.tool.reserve(scratch);
    }

    /// Returns the centre of torques and of compliance, in the tool's frame and the part's unit.
    pub fn centre(&self) -> Point3<f64> {
        self.state.centre
    }

    /// Returns the unit of the part, in which poses are given.
    pub fn unit(&self) -> Unit {
        self.state.unit
    }

    /// Returns an upper bound on the error of a computed depth against the depth of the given point, in the part's
    /// unit.
    ///
    /// It covers storing points in `f32` relative to their leaf's centre, transforming them to the tool's frame, and
    /// rounding in the depth itself. It does not cover the surface between points. `None` if no Lipschitz constant of
    /// the depth is proved for the tool ([`crate::tool::DepthBounds::lipschitz`]).
    pub fn rounding_error_bound(&self) -> Option<f64> {
        const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
        let (info, tree, length) = (self.tool.info(), &self.state.tree, self.state.length);
        let tool = length * info.size();
        let frame = &tree.frame;
        let [leaf, part] = [tree.leaf_size, frame.size].map(|half| frame.scale * f64::from(half));
        // Storage error per coordinate: an offset in `f32` from a centre that the origin is subtracted from.
        let storage_error = leaf / 2f64.powi(24) + 4.0 * UNIT_ROUNDOFF * part;
        // A point inside is at most √2 tool sizes from the tip, and the origin at most that plus the part's size. Two
        // sums, a sum of three products and a change of unit err by 2√2, 3√2 and √2 of a size: 8.5 of the 10 counted.
        let transform_error = UNIT_ROUNDOFF * (2.0 * (tool + 4.0 * part) + 8.0 * tool);
        let tool_error = length * info.depth.rounding + UNIT_ROUNDOFF * tool;
        info.depth.lipschitz.map(|lipschitz| {
            lipschitz * 3f64.sqrt() * (storage_error + transform_error) + tool_error
        })
    }

    /// Returns an upper bound on how much deeper the part's surface can be than its deepest point, in the part's unit.
    ///
    /// It is the covering radius of the points times the Lipschitz constant of the depth, plus
    /// [`Probe::rounding_error_bound`]. `None` if one of these is not known. It is as reliable as the
    /// [covering radius](crate::PointBvh::covering_radius), which may be an estimate.
    pub fn sampling_error_bound(&self) -> Option<f64> {
        let (info, cover) = (self.tool.info(), self.state.tree.covering_radius()?);
        Some(info.depth.lipschitz? * cover.radius + self.rounding_error_bound()?)
    }

    /// Returns an upper bound on the depth of the whole surface of the part: the depth of the deepest point, or 0
    /// without contact, plus the [sampling error bound](Probe::sampling_error_bound). `None` if that bound is not
    /// known.
    pub fn depth_bound(&mut self, pose: &Pose) -> Option<f64> {
        // Before the query: without a bound it would be in vain.
        let error_bound = self.sampling_error_bound()?;
        Some(self.deepest(pose).map_or(0.0, |deepest| deepest.depth) + error_bound)
    }

    /// Returns whether any point of the part is inside the tool or on its surface. Stops at the first such point, and
    /// begins at the leaf where one was found last, since tools move little from pose to pose.
    pub fn detect(&mut self, pose: &Pose) -> bool {
        if !self.state.set_pose(pose) {
            return false;
        }
        self.state.traverse_to_last_hit();
        // The remaining nodes are visited one by one, so that a hit ends the query early.
        let is_inside = self.filter_and_evaluate::<Inside>() || {
            // Each node has sixteen leaves.
            let nodes = self.state.traverse_to_nodes();
            (0..nodes).any(|node| {
                self.state.traverse_under(node);
                self.filter_and_evaluate::<Inside>()
            })
        };
        if is_inside {
            self.state.remember_hit();
        }
        is_inside
    }

    /// Returns the deepest point; `None` without contact.
    pub fn deepest(&mut self, pose: &Pose) -> Option<DeepestPoint> {
        if self.query::<Depths>(pose) { contacts::deepest(&self.state, pose) } else { None }
    }

    /// Returns the quantities that a posture is judged by: niceness, and the depth at cutting and other surfaces.
    pub fn posture(&mut self, pose: &Pose) -> Posture {
        if self.query::<Postures>(pose) {
            contacts::posture(&self.state, self.tool.info(), pose)
        } else {
            Posture::default()
        }
    }

    /// Returns force, torque, depth and niceness of the whole contact.
    pub fn wrench(&mut self, pose: &Pose) -> Wrench {
        if self.traverse_within(pose, usize::MAX) == Some(0) {
            return self.zero_wrench();
        }
        self.reduce(pose)
    }

    /// Sets the pose and finds the leaves that the tool may reach, visiting at most `budget` nodes. Returns the number
    /// of nodes visited, which is 0 if the whole part is out of reach; `None` if the budget does not suffice.
    fn traverse_within(&mut self, pose: &Pose, budget: usize) -> Option<usize> {
        if self.state.set_pose(pose) { self.state.traverse(budget) } else { Some(0) }
    }

    /// Returns the wrench without contact.
    pub(crate) fn zero_wrench(&self) -> Wrench {
        Wrench::nothing(self.state.law, self.state.weights)
    }

    /// Returns the wrench of the points in the leaves found last.
    fn reduce(&mut self, pose: &Pose) -> Wrench {
        self.state.filter(true);
        let is_inside = match self.state.law {
            Law::Gradient => self.state.evaluate::<AlongGradients, T>(&self.tool),
            Law::Thesis | Law::Facing => self.state.evaluate::<AlongDirections, T>(&self.tool),
        };
        if is_inside { self.state.reduce(pose) } else { self.zero_wrench() }
    }

    /// Returns every point of the part inside the tool, with all outputs there.
    pub fn contacts(&mut self, pose: &Pose) -> &[Contact] {
        self.contacts.clear();
        if self.query::<Everything>(pose) {
            contacts::collect(&self.state, self.tool.info(), pose, &mut self.contacts);
        }
        &self.contacts
    }

    /// Returns the tree indices of the points inside that are deeper than `depth`, which is in the part's unit.
    pub(crate) fn deeper(&mut self, pose: &Pose, depth: f64) -> Vec<usize> {
        if !self.query::<Depths>(pose) {
            return vec![];
        }
        let QueryState { evaluations, candidates, length, .. } = &self.state;
        let deeper_candidates = evaluations
            .inside_indices()
            .filter(|candidate| evaluations.depth[*candidate] * length > depth);
        deeper_candidates.map(|candidate| candidates.indices()[candidate] as usize).collect()
    }

    /// Runs the same query at many poses, on all cores. Each result is computed independently of the others, so the
    /// results equal those of one thread, in the order of the poses.
    ///
    /// ```
    /// # use touchoff::{Part, Pose, Probe, Tool};
    /// # fn deepest(part: &Part, tool: &dyn Tool, poses: &[Pose]) -> f64 {
    /// let depths = Probe::new(part, tool).par_map(poses, |probe, pose| probe.wrench(pose).depth());
    /// # depths.into_iter().fold(0.0, f64::max) }
    /// ```
    #[cfg(feature = "parallel")]
    pub fn par_map<R: Send>(
        &self,
        poses: &[Pose],
        query: impl Fn(&mut Probe<'a, T>, &Pose) -> R + Sync,
    ) -> Vec<R> {
        // Enough poses that cloning the probe costs nothing in comparison.
        const POSES_PER_TASK: usize = 256;
        let run = |probe: &mut Probe<'a, T>, poses: &[Pose]| {
            let one = |pose| {
                cancellation::check();
                query(probe, pose)
            };
            poses.iter().map(one).collect()
        };
        parallel::stretches(poses, POSES_PER_TASK, || self.clone(), run)
    }

    /// Evaluates the tool at all points of the part that may be inside. Returns whether any point is inside.
    fn query<W: OutputSelection>(&mut self, pose: &Pose) -> bool {
        if !self.state.set_pose(pose) {
            return false;
        }
        self.state.traverse(usize::MAX);
        self.filter_and_evaluate::<W>()
    }

    /// Evaluates the tool at the points of the leaves found last. Returns whether any point is inside.
    fn filter_and_evaluate<W: OutputSelection>(&mut self) -> bool {
        self.state.filter(false);
        self.state.evaluate::<W, T>(&self.tool)
    }
}
