//! Queries about motions: clearance along the whole motion, and the greatest depth of a surface, with proved bounds.
//!
//! A sweep either finds a point that is too deep or proves that there is none. The greatest depth is therefore bounded
//! by repeated sweeps for something deeper than the deepest point known. That point is found by hill climbing in time,
//! from a few times of the motion and from the points that sweeps return. A sweep proceeds in order of time and is slow
//! near points whose depth is close to its limit. It is therefore used last, and with no finer limit than pays off.

use super::containment::{Containment, CorePoints};
use super::search::{MAX_F32_MARGIN, QuerySetting, SearchState};
use super::sweep::{SweepEnd, SweepTask, Sweeper};
use super::tool_model::ToolModel;
use super::trajectory::Trajectory;
use super::triangle::line_search::Goal;
use super::verdict::{MotionDepth, MotionVerdict, Witness};
use super::{
    Certifier, ContactVerdict, NoSuchSurface, PenetrationGoal, max_possible_depth, penetration,
    rounding, touches,
};
use crate::certify::search::DepthQuery;
use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::tool::{Symmetry, ToolInfo};

/// The errors of a point of the tool along a motion, in the tool's unit.
#[derive(Clone, Copy)]
struct MotionErrors {
    /// The rounding error bound of the point: `rounding` derives it.
    rounding: f64,
    /// The greatest difference of depths from those in the motion that is meant.
    trajectory: f64,
}

impl MotionErrors {
    fn new(setting: &QuerySetting<'_>, motion: &dyn Trajectory) -> MotionErrors {
        let turned = if motion.has_spin() { setting.error } else { 0.5 * setting.error };
        let moved = rounding::distance_error_bound(motion.max_speed(0.0) / setting.length);
        MotionErrors {
            rounding: setting.error + turned + moved,
            trajectory: setting.tool_model.lipschitz() * motion.error() / setting.length,
        }
    }

    /// Returns the least tolerance of a sweep.
    fn min_sweep_tolerance(&self) -> f64 {
        MIN_SWEEP_TOLERANCE * self.rounding + MIN_SWEEP_ERRORS * self.trajectory
    }
}

/// Returns whether a motion determines the tool's position. For a tool without an axis it has to include the spin.
fn determines_pose(info: &ToolInfo, motion: &dyn Trajectory) -> bool {
    info.symmetry == Symmetry::Revolved || motion.has_spin()
}

/// The tolerance of a sweep is at least this times the error bound of a point. A point is found to be too deep from 2 error
/// bounds above the limit, and a bound rules it out up to 1 below the tolerance: 3 would leave no point undecided. The rest is
/// for the displacements in an interval of time, which need not become as short as the errors.
pub(super) const MIN_SWEEP_TOLERANCE: f64 = 16.0;

/// To that comes this number of times the error of the trajectory. A point is found to be too deep from 1 error above the
/// limit, as it is that far from where the approximating motion has it, and it is ruled out up to 1 below the tolerance.
pub const MIN_SWEEP_ERRORS: f64 = 8.0;

/// The tolerance of a motion's greatest depth is at least this times that of a sweep: half of it is for the sweep.
const MIN_DEPTH_TOLERANCE: f64 = 2.0;

/// Depths at single times are computed to within the tolerance divided by this: no finer than the error bound of a point.
const CLIMB_DIVISOR: f64 = MIN_DEPTH_TOLERANCE * MIN_SWEEP_TOLERANCE;

/// The maximum number of sweeps for something deeper than the deepest point known.
const MAX_ROUNDS: u32 = 16;

/// A motion is probed at its beginning and at this number of later times before it is swept.
const INITIAL_TIMES: u32 = 8;

/// The greatest depth along a motion is bounded to within this fraction of the excess over the allowance.
const GAP_FRACTION: f64 = 0.125;

/// Each sweep for that bound gets this fraction of the budget (1/64): the bound is not needed to prove a motion clear.
const BUDGET_DIVISOR: u32 = 64;

/// The fraction of a surface's [greatest possible depth](Certifier::max_possible_depth) from which on it passes right through the
/// part: [`Certifier::motion_depth`] searches for nothing deeper.
pub const THROUGH_FRACTION: f64 = 0.98;

/// Time steps shorter than this fraction of a motion are not resolved.
const MIN_TIME_STEP: f64 = 1e-12;

impl Certifier<'_> {
    /// Checks whether the tool stays clear of the part along a whole motion, or exceeds the depth that is
    /// [allowed](Certifier::with_allowance) by no more than a tolerance, in the part's unit. A tolerance below 16
    /// times the rounding error bound, or NaN, is replaced by that; to the bound comes half the [error](Trajectory::error)
    /// of a trajectory. The motion is a [`Motion`](crate::Motion) or any other [`Trajectory`].
    ///
    /// The verdict is undecided for a solid without an axis on a motion without [spin](crate::Motion::with_spin), and for
    /// tools and parts larger than some 1e15 of the tool's unit.
    ///
    /// ```
    /// # use nalgebra::{Point3, Vector3};
    /// # use touchoff::certify::{Certifier, MotionVerdict, TriangleBvh};
    /// # use touchoff::{Motion, Pose, Unit, mesh::shapes};
    /// touchoff::tool! {
    ///     tool EndMill "12 mm across, 20 mm of it cut" {
    ///         units mm;
    ///         profile {
    ///             start (0, 0);
    ///             line to (6, 0) as face cutting;
    ///             line to (6, 20) as flute cutting;
    ///             line to (6, 60), (0, 60) as shank;
    ///         }
    ///         niceness cutting: 1;
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (low, high) = (Point3::new(0., -30., 0.), Point3::new(40., 30., 25.));
    /// let wall = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
    /// let pose = |y: f64, z: f64| Pose::from_axis(Point3::new(-4.0, y, z), Vector3::z());
    /// let mut certifier = Certifier::new(&wall, &EndMill)?
    ///     .with_allowance("face", f64::INFINITY)?
    ///     .with_allowance("flute", f64::INFINITY)?;
    /// // The flute cuts 2 mm into the wall, as high as that is; lower, the shank would rub.
    /// let cut = Motion::new(&pose(-20.0, 6.0)?, &pose(20.0, 6.0)?)?;
    /// assert_eq!(certifier.check_motion(&cut, 1e-6), MotionVerdict::Clear);
    /// let lower = Motion::new(&pose(-20.0, 6.0)?, &pose(20.0, 4.0)?)?;
    /// assert!(matches!(certifier.check_motion(&lower, 1e-6), MotionVerdict::Touching(at, _) if at >= 0.5));
    /// # Ok(()) }
    /// ```
    pub fn check_motion(&mut self, motion: &dyn Trajectory, tolerance: f64) -> MotionVerdict {
        if !determines_pose(self.setting.info(), motion) || self.setting.margin() > MAX_F32_MARGIN {
            return MotionVerdict::Undecided(0.0);
        }
        let Certifier { setting, whole_query, allowances, core_points, state, sweeper, .. } = self;
        let [depths, margins] = allowances.queries(setting, whole_query);
        let errors = MotionErrors::new(setting, motion);
        // Written so that a NaN tolerance is replaced.
        let tolerance = errors.min_sweep_tolerance().max(tolerance / setting.length);
        let mut check = MotionCheck {
            setting,
            motion,
            error: errors.rounding,
            tolerance,
            budget: self.budget,
            state,
            sweeper,
        };
        let undecided_from = match check.first(depths) {
            Some(FirstContact::At(at, witness)) => return MotionVerdict::Touching(at, witness),
            Some(FirstContact::Undecided(0.0)) => return MotionVerdict::Undecided(0.0),
            Some(FirstContact::Undecided(at)) => Some(at),
            None => None,
        };
        // A piece of the tool may be inside the material where no triangle shows it. It is then at some distance from its surface,
        // too: margins come last.
        let clear = match setting.containment(core_points, &motion.pose(0.0), tolerance) {
            Containment::Inside(surface) => return MotionVerdict::Inside(surface),
            Containment::Undecided => return MotionVerdict::Undecided(0.0),
            Containment::Outside => MotionVerdict::Clear,
            Containment::Unknown => MotionVerdict::SurfaceOnly,
        };
        if let Some(at) = undecided_from {
            return MotionVerdict::Undecided(at);
        }
        match check.first(margins) {
            Some(FirstContact::At(at, witness)) => MotionVerdict::Near(at, witness),
            Some(FirstContact::Undecided(at)) => MotionVerdict::Undecided(at),
            None => clear,
        }
    }

    /// Computes the greatest depth of a surface along a motion, at points to which it is the nearest surface. If it
    /// exceeds `allowed` by more than a tolerance, the result has the deepest point found and an upper bound. Both
    /// lengths are in the part's unit; a tolerance below twice the least of [`Certifier::check_motion`], or NaN, is
    /// replaced by that. The depths of a [`Trajectory`] are widened by its error. A negative `allowed` is a margin: the
    /// distance that the surface has to keep from all of the part.
    ///
    /// [Allowances](Certifier::with_allowance) of the certifier do not count, and an `allowed` of NaN counts as 0.
    /// The result is undecided for a solid without an axis on a motion without [spin](crate::Motion::with_spin), and for a
    /// margin of a tool without a profile.
    ///
    /// ```
    /// # use nalgebra::{Point3, Vector3};
    /// # use touchoff::certify::{Certifier, MotionDepth, TriangleBvh};
    /// # use touchoff::{Interval, Motion, SurfaceId, Pose, Unit, mesh::shapes};
    /// # touchoff::tool! {
    /// #     tool Ball "6 mm" {
    /// #         units mm;
    /// #         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
    /// #         niceness cutting: 1;
    /// #     }
    /// # }
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (low, high) = (Point3::new(-5., -5., -9.), Point3::new(5., 5., 0.));
    /// let block = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
    /// let pose = |x: f64| Pose::from_axis(Point3::new(x, 0.0, -0.5), Vector3::z());
    /// // Both ends are clear of the block; between them the ball is 0.5 deep.
    /// let motion = Motion::new(&pose(-20.0)?, &pose(20.0)?)?;
    /// let found = Certifier::new(&block, &Ball)?.motion_depth(SurfaceId(0), &motion, 0.0, 1e-6)?;
    /// let MotionDepth::Deeper { depth: Interval { low, high }, max_depth, .. } = found else { panic!("{found:?}") };
    /// assert!(low <= 0.5 && 0.5 <= high && high - low < 1.1e-6 && max_depth < 0.57);
    /// # Ok(()) }
    /// ```
    ///
    /// # Errors
    /// If there is no such surface.
    pub fn motion_depth(
        &mut self,
        surface: SurfaceId,
        motion: &dyn Trajectory,
        allowed: f64,
        tolerance: f64,
    ) -> Result<MotionDepth, NoSuchSurface> {
        let surface = self.checked(surface)?;
        if !determines_pose(self.setting.info(), motion) {
            return Ok(MotionDepth::Undecided(0.0));
        }
        let setting = &self.setting;
        let errors = MotionErrors::new(setting, motion);
        let min_tolerance = MIN_DEPTH_TOLERANCE * errors.min_sweep_tolerance();
        // Written so that a NaN tolerance is replaced.
        let tolerance = min_tolerance.max(tolerance / setting.length);
        let limit = if allowed.is_nan() { 0.0 } else { allowed / setting.length };
        let inside_query = self.surface_queries[surface]
            .get_or_insert_with(|| setting.depth_query(0.0, |other| other == surface));
        let max_depth = *self.surface_max_depths[surface].get_or_insert_with(|| {
            // No point of the tool is farther from its surface than the largest radius.
            let steepest = setting.tool_model.depth_error(0.0)
                + setting.tool_model.lipschitz() * setting.info().radius();
            max_possible_depth(setting, surface).map_or(steepest, |depth| depth.min(steepest))
        });
        let inside_limit = limit.max(0.0);
        let core_points = match &mut self.surface_core_points[surface] {
            Some((known, core_points)) if *known == inside_limit => core_points,
            other => {
                let surfaces = 0..setting.info().surfaces.len();
                let limits =
                    surfaces.map(|k| if k == surface { inside_limit } else { f64::INFINITY });
                &mut other.insert((inside_limit, CorePoints::new(limits))).1
            }
        };
        let mut search = MotionSearch {
            setting,
            core_points,
            state: &mut self.state,
            sweeper: &mut self.sweeper,
            motion,
            errors,
            query: inside_query,
            max_depth,
            tolerance,
            budget: self.budget,
        };
        // With a margin, first whether the surface is in the part at all: that is the graver finding.
        let found = search.deepest(inside_limit);
        if limit >= 0.0 || !matches!(found, MotionDepth::Within) {
            return Ok(found);
        }
        // Without a profile the distance of a surface from outside points is unknown.
        if let ToolModel::Field(_) = &setting.tool_model {
            return Ok(MotionDepth::Undecided(0.0));
        }
        let margin_query = setting.depth_query(limit, |other| other == surface);
        search.query = &margin_query;
        search.max_depth = 0.0;
        Ok(match search.deepest(limit) {
            MotionDepth::Within => found,
            nearer => nearer,
        })
    }
}

/// The check of one motion against allowances; lengths are in the tool's unit.
struct MotionCheck<'a, 's> {
    setting: &'a QuerySetting<'s>,
    motion: &'a dyn Trajectory,
    /// The error bound of a point along the motion.
    error: f64,
    tolerance: f64,
    budget: u32,
    state: &'a mut SearchState,
    sweeper: &'a mut Sweeper,
}

/// The end of the check of a motion that is not clear.
enum FirstContact {
    At(f64, Witness),
    /// The motion is clear up to this fraction of it; the rest is unknown.
    Undecided(f64),
}

impl MotionCheck<'_, '_> {
    /// Returns the first contact beyond the limit of a query.
    fn first(&mut self, queries: &[DepthQuery]) -> Option<FirstContact> {
        let MotionCheck { setting, motion, error, tolerance, budget, .. } = *self;
        let mut first: Option<SweepEnd> = None;
        // A margin no larger than the tolerance requires no check.
        for query in
            queries.iter().filter(|query| query.limit >= 0.0 || query.limit + tolerance < 0.0)
        {
            let limit = query.limit;
            let task = SweepTask { setting, query, trajectory: motion, limit, error, tolerance };
            if let Some(end) = self.sweeper.run(&task, budget)
                && first.as_ref().is_none_or(|first| end.before(first))
            {
                first = Some(end);
            }
        }
        Some(match first? {
            SweepEnd::Deeper { at, pose, best } => {
                FirstContact::At(at, setting.witness(&best, &pose))
            }
            // A proof is out of reach, but a contact later in the motion may still be found.
            SweepEnd::Spent { at } => self.probe(queries, at),
        })
    }

    /// Probes the motion for contact at some times after the one at which the budget was spent. A sweep takes longest
    /// just before contact, whereas deep contact is found at once.
    fn probe(&mut self, queries: &[DepthQuery], from: f64) -> FirstContact {
        for step in 1..=INITIAL_TIMES {
            let at = from + (1.0 - from) * f64::from(step) / f64::from(INITIAL_TIMES);
            let pose = self.motion.pose(at);
            let found = touches(self.setting, queries, self.state, &pose, self.error, self.budget);
            if let ContactVerdict::Yes(witness) = found {
                return FirstContact::At(at, witness);
            }
        }
        FirstContact::Undecided(from)
    }
}

/// The search for the greatest depth of one surface along one motion; lengths are in the tool's unit.
struct MotionSearch<'a, 's> {
    setting: &'a QuerySetting<'s>,
    /// Points of the region that the surface owns and that may not be inside the part.
    core_points: &'a mut CorePoints,
    state: &'a mut SearchState,
    sweeper: &'a mut Sweeper,
    motion: &'a dyn Trajectory,
    errors: MotionErrors,
    query: &'a DepthQuery,
    /// An upper bound on the depth that the query can find.
    max_depth: f64,
    tolerance: f64,
    budget: u32,
}

/// The depth at one time of a motion.
#[derive(Clone, Copy)]
struct DepthPeak {
    depth: Interval,
    at: f64,
    witness: Witness,
}

impl MotionSearch<'_, '_> {
    fn deepest(&mut self, limit: f64) -> MotionDepth {
        let mut deepest: Option<DepthPeak> = None;
        for k in 0..=INITIAL_TIMES {
            let threshold = deepest.map_or(limit, |peak| peak.depth.low);
            let probed = self.peak_at(f64::from(k) / f64::from(INITIAL_TIMES), threshold);
            deepest = probed.filter(|peak| peak.depth.low > threshold).or(deepest);
        }
        let first = match deepest {
            Some(peak) => peak,
            None => match self.sweep(limit, self.tolerance, self.budget) {
                None => return self.within(MotionDepth::Within),
                Some(SweepEnd::Spent { at: 0.0 }) => return MotionDepth::Undecided(0.0),
                Some(SweepEnd::Spent { at }) => return self.within(MotionDepth::Undecided(at)),
                Some(SweepEnd::Deeper { at, pose, best }) => {
                    let witness = self.setting.witness(&best, &pose);
                    let depth = Interval::new(limit, limit + self.tolerance);
                    // A sweep proves no more than that the point exceeds the limit; a probe at that time may tell
                    // its depth.
                    let swept = DepthPeak { depth, at, witness };
                    self.peak_at(at, limit).map_or(swept, |probed| deeper(swept, probed))
                }
            },
        };
        let (best, max_depth) = if self.is_through(&first) {
            (first, self.max_depth.max(first.depth.high))
        } else {
            let top = self.climb(first);
            self.bounded(top, limit)
        };
        let length = self.setting.length;
        let depth = best.depth.scaled_by(length);
        MotionDepth::Deeper {
            at: best.at,
            depth,
            max_depth: max_depth * length,
            witness: best.witness,
        }
    }

    /// Returns whether hardly anything can be deeper.
    fn is_through(&self, peak: &DepthPeak) -> bool {
        self.query.limit >= 0.0 && peak.depth.low >= THROUGH_FRACTION * self.max_depth
    }

    /// Returns the deepest point found and an upper bound on the depth over the motion.
    fn bounded(&mut self, mut best: DepthPeak, limit: f64) -> (DepthPeak, f64) {
        let mut gap_fraction = GAP_FRACTION;
        for _ in 0..MAX_ROUNDS {
            if self.is_through(&best) {
                break;
            }
            let Interval { low, high } = best.depth;
            let gap = self.tolerance.max(gap_fraction * (high - limit));
            // One half is for the tolerance of the sweep, the other for the gain of each round.
            let swept_limit = (low + 0.5 * gap).max(limit);
            if swept_limit + 0.5 * gap >= self.max_depth {
                break;
            }
            match self.sweep(swept_limit, 0.5 * gap, self.budget / BUDGET_DIVISOR) {
                None => return (best, high.max(swept_limit + 0.5 * gap)),
                // Near the limit a sweep is slow: a coarser limit needs less of the budget.
                Some(SweepEnd::Spent { .. }) => gap_fraction *= 4.0,
                Some(SweepEnd::Deeper { at, .. }) => match self.peak_at(at, low) {
                    Some(peak) if peak.depth.low > low => best = self.climb(peak),
                    // The point found is no deeper at its time: the bound, not the depth, is too coarse.
                    _ => gap_fraction *= 4.0,
                },
            }
        }
        (best, self.max_depth.max(best.depth.high))
    }

    /// Sweeps the motion: returns a point that exceeds a limit, if any point exceeds it by more than a tolerance.
    fn sweep(&mut self, limit: f64, tolerance: f64, budget: u32) -> Option<SweepEnd> {
        let MotionSearch { setting, query, motion, .. } = *self;
        // Nothing outside the tool is at a depth of 0 or more.
        if self.query.limit < 0.0 && limit + tolerance >= 0.0 {
            return None;
        }
        let error = self.errors.rounding;
        let task = SweepTask { setting, query, trajectory: motion, limit, error, tolerance };
        self.sweeper.run(&task, budget)
    }

    /// Returns the result if no triangle is too deep, or none up to where they are undecided: that of the triangles, unless the
    /// motion begins inside the material.
    fn within(&mut self, by_triangles: MotionDepth) -> MotionDepth {
        let MotionSearch { setting, motion, tolerance, .. } = *self;
        match setting.containment(self.core_points, &motion.pose(0.0), tolerance) {
            Containment::Inside(_) => MotionDepth::Inside,
            Containment::Outside | Containment::Unknown => by_triangles,
            Containment::Undecided => MotionDepth::Undecided(0.0),
        }
    }

    /// Climbs to a local maximum of depth over time. Steps that gain are taken; others are halved until they are too
    /// short to gain more than the tolerance.
    fn climb(&mut self, from: DepthPeak) -> DepthPeak {
        let QuerySetting { size, length, .. } = *self.setting;
        // No depth changes faster than the farthest point of the tool moves.
        let pace = self.motion.max_speed(size * length) / length;
        let mut best = from;
        let mut step = 0.5 / f64::from(INITIAL_TIMES);
        while step * pace > self.climb_tolerance() && step > MIN_TIME_STEP {
            // At an end of the motion there is one side.
            let sides = [best.at - step, best.at + step].map(|at| at.clamp(0.0, 1.0));
            let sides = sides.into_iter().filter(|at| *at != best.at);
            // A gain of less is not worth the search among points that are nearly as deep.
            let threshold = best.depth.low + self.climb_tolerance();
            let found = sides.filter_map(|at| self.peak_at(at, threshold)).fold(best, deeper);
            if found.depth.low > best.depth.low {
                best = found;
            } else {
                step *= 0.5;
            }
        }
        best
    }

    /// Returns the tolerance of depths at single times.
    fn climb_tolerance(&self) -> f64 {
        self.tolerance / CLIMB_DIVISOR
    }

    /// Returns the depth at a fraction of the motion, if any point is deeper than `threshold`. Nothing else is searched, which is
    /// much less.
    fn peak_at(&mut self, at: f64, threshold: f64) -> Option<DepthPeak> {
        let tolerance = self.climb_tolerance();
        let MotionSearch { setting, query, ref mut state, budget, .. } = *self;
        let pose = self.motion.pose(at);
        let MotionErrors { rounding, trajectory } = self.errors;
        let off = rounding + trajectory;
        if query.limit >= 0.0 {
            // `penetration` takes and returns lengths in the part's unit.
            let tolerance = tolerance * setting.length;
            let goal = PenetrationGoal { tolerance, threshold, budget };
            let found = penetration(setting, query, state, &pose, goal);
            let Interval { low, high } = found.depth;
            let low = (low / setting.length - off).max(0.0);
            let depth = Interval::new(low, high / setting.length + off);
            return found.witness.map(|witness| DepthPeak { depth, at, witness });
        }
        setting.set_pose(state, &pose);
        let goal = Goal {
            threshold: query.limit.max(threshold),
            tolerance,
            stop_depth: f64::INFINITY,
            budget,
        };
        state.outside(setting, query, &pose, goal);
        let best = state.best?;
        let found = state.search.best;
        let more = off + state.search.skew;
        let high = (found + tolerance).max(state.search.open_bound) + more;
        Some(DepthPeak {
            depth: Interval::new(found - more, high),
            at,
            witness: setting.witness(&best, &pose),
        })
    }
}

fn deeper(one: DepthPeak, other: DepthPeak) -> DepthPeak {
    if other.depth.low > one.depth.low { other } else { one }
}
