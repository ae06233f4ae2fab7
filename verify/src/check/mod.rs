//! Verification of a program against the finished part: it finds motions in which the tool is deeper in the
//! part than allowed.
//!
//! ```text
//! program ──two locations──▶ move ──free space──▶ clear
//! G-code ──machine──────────▶ move     └─check_motion──▶ clear
//!                                          └──────▶ each surface ──motion_depth──▶ finding
//! ```
//!
//! Every two consecutive positions form a [`Move`], which is checked over its whole length, so that a gouge between
//! two points is found. A motion that keeps within a region that is known to be free touches nothing. If a motion is
//! not proved clear, each surface of the tool is queried separately, so that a flute that gouges does not hide a shank
//! that rubs. There is one finding per motion and surface.
//!
//! **Guarantees.** A motion without a finding is nowhere deeper than allowed by more than the
//! [resolution](Verifier::with_resolution). A finding is deeper than that at the pose it names: its interval
//! contains the depth there, and its `max_depth` bounds the depth over the whole motion. The depth is that of the
//! tool's profile at rest: neither runout nor deflection counts. Motions are taken as [`Motion`](touchoff::Motion) defines
//! them, rapid ones too.
//!
//! **Joint motions.** A motion in which a control interpolates the axes of a machine is a
//! [`Trajectory`](touchoff::certify::Trajectory): the sweep halves it until motions at constant speed decide, whose
//! deviation is bounded. Depths are those at the true poses, to within the error that the control's own path may have.

mod approach;
mod checker;
mod finding;
mod machine_program;
mod moves;
mod remedy;

pub use approach::Approach;
pub(crate) use finding::Rank;
pub use finding::{Finding, FindingGroup, FindingKind, VerifyError, VerifyReport};
pub use machine_program::{
    Assumption, BlindWay, BlockError, BlockFault, Gap, GapWeight, Level, MAX_READINGS, MAX_VALUES,
    MachineProgram, MachineProgramError, MachineSummary, Obstacle, ProgramStop, StepFault,
    ToolSelection, ToolUse, TopWay, UnknownCause, UnknownMotions,
};
pub(crate) use machine_program::{CheckGap, MoveRequest};
pub use moves::{JointPath, Move, MovePath, RapidBox};
pub use remedy::Tilt;

use crate::gcode::WorkOffset;
use crate::program::ClData;
pub(crate) use approach::ApproachSearch;
use checker::Checker;
use std::fmt;
use std::sync::{Arc, Mutex};
use touchoff::cancellation;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::tool::{Tool, ToolInfo};
use touchoff::{SurfaceId, Unit};

/// Checks programs of a tool against a part.
///
/// Lengths are in the part's unit. All surfaces may be as deep as the tolerance, unless another depth is
/// [allowed](Verifier::with_allowance). In rapid traverse nothing may be deeper than the tolerance.
///
/// ```
/// use nalgebra::Point3;
/// use touchoff::certify::TriangleBvh;
/// use touchoff_verify::{FindingKind, Verifier};
/// use touchoff::{Interval, Unit, mesh::shapes};
/// use touchoff_verify::ClData;
///
/// touchoff::tool! {
///     tool Ball "6 mm" {
///         units mm;
///         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (low, high) = (Point3::new(-5., -5., -9.), Point3::new(5., 5., 0.));
/// let block = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
/// // Both points are clear of the block; the way between them is not.
/// let program = ClData::parse("-20,0,-0.5,0,0,1\n20,0,-0.5,0,0,1\n", "across.csv")?;
/// let report = Verifier::new(&block, &Ball)?.with_tolerance(0.01)?.check(&program)?;
/// let [finding] = &report.findings[..] else { panic!("{report:?}") };
/// assert_eq!((finding.from, finding.line), (Some(1), 2));
/// assert!(matches!(finding.kind, FindingKind::Deep { depth: Interval { low, .. }, .. } if low > 0.499));
/// # Ok(()) }
/// ```
pub struct Verifier<'a> {
    bvh: &'a TriangleBvh,
    tool: &'a dyn Tool,
    tolerance: f64,
    resolution: f64,
    /// Allowances by the surfaces' indices in the tool's list; `None` where the tolerance applies.
    allowed: Vec<Option<f64>>,
    budget: u32,
}

impl fmt::Debug for Verifier<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Verifier")
            .field("tool", &self.tool.info().name)
            .field("tolerance", &self.tolerance)
            .field("allowed", &self.allowed)
            .finish_non_exhaustive()
    }
}

/// The default resolution in mm, a micrometre: meshes seldom represent their geometry as closely.
const RESOLUTION: f64 = 1e-3;

/// Number of consecutive motions that share certifiers. It makes results independent of the number of cores.
const MOVES_PER_TASK: usize = 32;

/// Number of motions that are held in memory at once.
const MOVES_PER_BATCH: usize = 1 << 13;

impl<'a> Verifier<'a> {
    /// Creates a verifier of a tool at a part, with a tolerance of 0.
    ///
    /// # Errors
    /// If the tool cannot be certified.
    pub fn new(bvh: &'a TriangleBvh, tool: &'a dyn Tool) -> Result<Verifier<'a>, VerifyError> {
        let info = tool.info();
        Certifier::new(bvh, tool)?;
        Ok(Verifier {
            bvh,
            tool,
            tolerance: 0.0,
            resolution: Verifier::default_resolution(bvh.unit()),
            allowed: vec![None; info.surfaces.len()],
            budget: 1 << 17,
        })
    }

    /// Sets the tolerance: the depth, 0 or more, of any surface without an allowance of its own.
    ///
    /// # Errors
    /// If the tolerance is negative, infinite or NaN.
    pub fn with_tolerance(mut self, tolerance: f64) -> Result<Verifier<'a>, VerifyError> {
        if !(0.0..f64::INFINITY).contains(&tolerance) {
            return Err(VerifyError::Tolerance { tolerance });
        }
        self.tolerance = tolerance;
        Ok(self)
    }

    /// Sets the depth that a surface is allowed where it is the nearest: infinity for any depth, below 0 a
    /// margin that it has to keep from the whole part.
    ///
    /// # Errors
    /// If there is no such surface, or it cannot have this allowance.
    pub fn with_allowance(self, surface: &str, allowed: f64) -> Result<Verifier<'a>, VerifyError> {
        self.with_allowances([(surface, allowed)])
    }

    /// Sets the depths that several surfaces are allowed, as [`Verifier::with_allowance`] does. The last one of a surface
    /// holds.
    ///
    /// # Errors
    /// All that are wrong.
    pub fn with_allowances<'n>(
        mut self,
        allowances: impl IntoIterator<Item = (&'n str, f64)> + Clone,
    ) -> Result<Verifier<'a>, VerifyError> {
        // Accept exactly what a certifier accepts.
        Certifier::new(self.bvh, self.tool)?.with_allowances(allowances.clone())?;
        for (surface, allowed) in allowances {
            if let Some(SurfaceId(index)) = self.tool.info().surface_named(surface) {
                self.allowed[index] = Some(allowed);
            }
        }
        Ok(self)
    }

    /// Returns the resolution where none is set, 0.001 mm.
    pub fn default_resolution(unit: Unit) -> f64 {
        RESOLUTION / unit.millimetres()
    }

    /// Sets the resolution: an excess of depth up to this length may or may not be found. A resolution below
    /// what rounding adds is taken as that. The default is 0.001 mm.
    ///
    /// # Errors
    /// If the resolution is negative, infinite or NaN.
    pub fn with_resolution(mut self, resolution: f64) -> Result<Verifier<'a>, VerifyError> {
        if !(0.0..f64::INFINITY).contains(&resolution) {
            return Err(VerifyError::Tolerance { tolerance: resolution });
        }
        self.resolution = resolution;
        Ok(self)
    }

    /// Sets the [budget](Certifier::with_budget) of each query. The default is 2^17, some 50 ms.
    #[must_use]
    pub fn with_budget(mut self, budget: u32) -> Verifier<'a> {
        self.budget = budget;
        self
    }

    /// Returns the tool's info: the surface of a finding is an index in its list.
    pub fn info(&self) -> &ToolInfo {
        self.tool.info()
    }

    /// Checks a program: its first cutter location, and every motion from one cutter location to the next. With
    /// the feature `parallel` this uses all cores; the findings are the same, in the program's order.
    ///
    /// # Errors
    /// If the program states another unit than the part's, or another cutter than the tool, or if its poses
    /// have no spin and the tool is a solid without an axis.
    pub fn check(&self, program: &ClData) -> Result<VerifyReport, VerifyError> {
        self.check_with_progress(program, &|_| ())
    }

    /// Checks a program like [`Verifier::check`]. Calls `progress` with the number of cutter locations checked since
    /// the last call, from any thread and in any order; the numbers add up to all cutter locations.
    ///
    /// # Errors
    /// As for [`Verifier::check`].
    pub fn check_with_progress(
        &self,
        program: &ClData,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<VerifyReport, VerifyError> {
        program.check_unit(self.bvh.unit())?;
        program.check_poses(self.tool.info())?;
        program.check_cutter(self.tool.info(), self.bvh.unit())?;
        let moves = Move::all(program, self.tool.info().symmetry);
        self.check_moves(moves, progress)
    }

    /// Checks motions, of which only a bounded number is held in memory. The first is that to the first position, from
    /// that position. `progress` is called as by [`Verifier::check_with_progress`].
    ///
    /// # Errors
    /// If the tool cannot be certified.
    pub fn check_moves(
        &self,
        moves: impl IntoIterator<Item = Move>,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<VerifyReport, VerifyError> {
        let mut check = MoveCheck::new(self, self.max_depths()?)?;
        for step in moves {
            check.add(step, progress)?;
        }
        check.finish(progress)
    }

    /// Returns the greatest depth that each surface can have, which is the tool's, at any part.
    ///
    /// # Errors
    /// If the tool cannot be certified.
    pub(crate) fn max_depths(&self) -> Result<Arc<[f64]>, VerifyError> {
        let certifier = Certifier::new(self.bvh, self.tool)?;
        let max_depths = (0..self.allowed.len()).map(|index| {
            let depth = certifier.max_possible_depth(SurfaceId(index));
            depth.expect("a surface of the tool").unwrap_or(f64::INFINITY)
        });
        Ok(max_depths.collect())
    }

    /// Returns whether a surface of the tool could violate its limit or its margin in feed or in rapid traverse, as far
    /// as `modes` has them in this order. `max_depths` has the greatest possible depth of each surface.
    fn restricts(&self, modes: [bool; 2], max_depths: &[f64]) -> bool {
        used(modes).any(|rapid| self.can_violate(rapid, max_depths).contains(&true))
    }

    /// Returns the surfaces that are nowhere as deep as the tolerance, as the thin disc of a saw: no finding of them is possible in feed,
    /// if nothing states an allowance for them, or in rapid traverse, as far as `modes` has them in this order.
    fn unchecked_surfaces(&self, modes: [bool; 2], max_depths: &[f64]) -> Vec<SurfaceId> {
        let mut is_unchecked = vec![false; self.allowed.len()];
        for rapid in used(modes) {
            for (index, can_violate) in self.can_violate(rapid, max_depths).into_iter().enumerate()
            {
                // An allowance is for cutting.
                is_unchecked[index] |= !can_violate && (rapid || self.allowed[index].is_none());
            }
        }
        (0..is_unchecked.len()).filter(|index| is_unchecked[*index]).map(SurfaceId).collect()
    }

    /// Returns for each surface whether it could violate its limit or its margin.
    fn can_violate(&self, rapid: bool, max_depths: &[f64]) -> Vec<bool> {
        let limits = self.limits(rapid).into_iter().zip(max_depths);
        limits
            .map(|(limit, max_depth)| limit < 0.0 || limit + self.resolution < *max_depth)
            .collect()
    }

    /// Returns an upper bound on the distance of the tool's points from its tip, in the part's unit.
    pub fn reach(&self) -> f64 {
        self.tool.info().max_distance_from_tip(self.bvh.unit())
    }

    /// Returns a bound on the change of depth per length: 1 for a profile, or that of the depth function.
    fn lipschitz(&self) -> f64 {
        let info = self.tool.info();
        // By a profile, depth is a distance. The certifier refuses another tool of which no constant is proved.
        let unproved = if info.is_exact() { 1.0 } else { f64::INFINITY };
        info.depth.lipschitz.unwrap_or(unproved).max(1.0)
    }

    /// Returns the depth that each surface is allowed.
    fn limits(&self, rapid: bool) -> Vec<f64> {
        let limits = self.allowed.iter().map(|allowed| {
            let allowed = allowed.unwrap_or(self.tolerance);
            // An allowance is for cutting: in rapid traverse no surface may be deeper than the tolerance.
            if rapid { allowed.min(self.tolerance) } else { allowed }
        });
        limits.collect()
    }
}

/// Returns the modes that a program uses, `true` for rapid traverse; `modes` has feed and rapid traverse in this order.
fn used(modes: [bool; 2]) -> impl Iterator<Item = bool> {
    [false, true].into_iter().filter(move |rapid| modes[usize::from(*rapid)])
}

/// A check of motions that are added one by one, in the order of the program.
pub(super) struct MoveCheck<'a> {
    verifier: &'a Verifier<'a>,
    max_depths: Arc<[f64]>,
    /// The checkers that no task uses: one per core in the end.
    checkers: Mutex<Vec<Checker<'a>>>,
    approach: ApproachSearch<'a>,
    findings: Vec<Finding>,
    /// The motions that wait for the next batch.
    batch: Vec<Move>,
    /// Number of motions before them.
    count: usize,
    /// Set if the program has motions in feed, and in rapid traverse.
    modes: [bool; 2],
}

impl<'a> MoveCheck<'a> {
    /// Begins a check. `max_depths` are those of the tool, whose checks at several parts share them: they take longer than some
    /// hundreds of motions.
    ///
    /// # Errors
    /// If the tool cannot be certified.
    pub(super) fn new(
        verifier: &'a Verifier<'a>,
        max_depths: Arc<[f64]>,
    ) -> Result<MoveCheck<'a>, VerifyError> {
        let unit = verifier.bvh.unit();
        let least = Certifier::new(verifier.bvh, verifier.tool)?.least_motion_tolerance();
        // A resolution below the default one is taken as what rounding adds.
        if least > verifier.resolution.max(Verifier::default_resolution(unit)) {
            return Err(VerifyError::Rounding { least, unit: unit.symbol() });
        }
        Ok(MoveCheck {
            verifier,
            max_depths,
            checkers: Mutex::default(),
            approach: ApproachSearch::new(verifier)?,
            findings: Vec::new(),
            batch: Vec::new(),
            count: 0,
            modes: [false; 2],
        })
    }

    /// States the work offsets at which other parts stand: positions under them tell nothing about the unit of this one.
    pub(crate) fn with_other_parts(
        mut self,
        offsets: impl IntoIterator<Item = WorkOffset>,
    ) -> MoveCheck<'a> {
        self.approach.other_parts = offsets.into_iter().collect();
        self
    }

    /// Adds a motion, and checks those that wait if they fill a batch.
    ///
    /// # Errors
    /// If the tool cannot be certified.
    pub(super) fn add(
        &mut self,
        step: Move,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<(), VerifyError> {
        cancellation::check();
        self.batch.push(step);
        match self.batch.len() < MOVES_PER_BATCH {
            true => Ok(()),
            false => self.check_batch(progress),
        }
    }

    fn check_batch(&mut self, progress: &(dyn Fn(usize) + Sync)) -> Result<(), VerifyError> {
        let MoveCheck { verifier, max_depths, checkers, count, .. } = &*self;
        let found = map_tasks(&self.batch, |first, moves| {
            // The queries of a tool take longer to prepare than most tasks, so that a checker is used again.
            let free = checkers.lock().expect("no task panics with it").pop();
            let mut checker = match free {
                Some(checker) => checker,
                None => Checker::new(verifier, max_depths.clone())?,
            };
            // Without memory of the task before, results are independent of the number of cores.
            checker.clear_caches();
            let numbered = (count + first..).zip(moves);
            let findings = numbered.flat_map(|(index, step)| checker.check(index, step)).collect();
            checkers.lock().expect("no task panics with it").push(checker);
            progress(moves.len());
            Ok::<Vec<Finding>, VerifyError>(findings)
        });
        let found: Vec<_> = found.into_iter().collect::<Result<_, VerifyError>>()?;
        let found: Vec<Finding> = found.into_iter().flatten().collect();
        self.approach.add(&self.batch, &found);
        self.batch.iter().for_each(|step| self.modes[usize::from(step.rapid)] = true);
        self.findings.extend(found);
        self.count += self.batch.len();
        self.batch.clear();
        Ok(())
    }

    /// Checks the motions that wait, and returns the result.
    ///
    /// # Errors
    /// If the tool cannot be certified.
    pub(super) fn finish(
        mut self,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<VerifyReport, VerifyError> {
        self.check_batch(progress)?;
        let MoveCheck { verifier, max_depths, count, modes, .. } = self;
        Ok(VerifyReport {
            moves: count,
            motions: count.saturating_sub(1),
            approach: self.approach.finish(),
            findings: self.findings,
            inside_known: verifier.bvh.has_inside(),
            unchecked_surfaces: verifier.unchecked_surfaces(modes, &max_depths),
            unrestricted: count > 0 && !verifier.restricts(modes, &max_depths),
        })
    }
}

/// Applies a function to consecutive moves that share certifiers, with the feature `parallel` on all cores. It is given the index
/// of the first.
fn map_tasks<R: Send>(moves: &[Move], map: impl Fn(usize, &[Move]) -> R + Sync) -> Vec<R> {
    let current = cancellation::current();
    let task = |(task, moves): (usize, &[Move])| {
        let _entered = current.enter();
        cancellation::check();
        map(task * MOVES_PER_TASK, moves)
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        moves.par_chunks(MOVES_PER_TASK).enumerate().map(task).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        moves.chunks(MOVES_PER_TASK).enumerate().map(task).collect()
    }
}
