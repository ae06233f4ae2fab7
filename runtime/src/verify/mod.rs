//! Verification of a program against the finished part: it finds motions in which the tool is deeper in the
//! part than allowed.
//!
//! ```text
//! program ──two locations──▶ motion ──check_motion──▶ clear
//!                                          └──────▶ each surface ──motion_depth──▶ finding
//! ```
//!
//! Every two consecutive cutter locations form a [`Motion`], which is checked over its whole length, so that a
//! gouge between two points is found. If a motion is not proved clear, each surface of the tool is queried
//! separately, so that a flute that gouges does not hide a shank that rubs. There is one finding per motion and
//! surface.
//!
//! **Guarantees.** A motion without a finding is nowhere deeper than allowed by more than the
//! [resolution](Verifier::with_resolution). A finding is deeper than that at the pose it names: its interval
//! contains the depth there, and its `max_depth` bounds the depth over the whole motion. The depth is that of the
//! tool's profile at rest: neither runout nor deflection counts. Motions are taken as [`Motion`] defines them,
//! rapid ones too.

mod approach;
mod finding;

pub use approach::Approach;
pub use finding::{Finding, FindingKind, VerifyError, VerifyReport};

use crate::certify::{Certifier, MotionDepth, MotionVerdict, TriangleBvh};
use crate::debug::debug;
use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::motion::{Motion, MotionError};
use crate::parallel;
use crate::pose::Pose;
use crate::program::{CutterLocation, Program};
use crate::tool::{Symmetry, Tool, ToolInfo};

/// Checks programs of a tool against a part.
///
/// Lengths are in the part's unit. All surfaces may be as deep as the tolerance, unless another depth is
/// [allowed](Verifier::with_allowance). In rapid traverse nothing may be deeper than the tolerance.
///
/// ```
/// use nalgebra::Point3;
/// use touchoff::certify::TriangleBvh;
/// use touchoff::verify::{FindingKind, Verifier};
/// use touchoff::{Interval, Program, Unit, mesh::shapes};
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
/// let program = Program::parse("-20,0,-0.5,0,0,1\n20,0,-0.5,0,0,1\n", "across.csv")?;
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

debug!([] Verifier<'_>, "Verifier", |this| {
    tool: this.tool.info().name, tolerance: this.tolerance, allowed: this.allowed,
});

/// The default resolution in mm, a micrometre: meshes seldom represent their geometry as closely.
const RESOLUTION: f64 = 1e-3;

/// Number of consecutive motions that share certifiers. It makes results independent of the number of cores.
const LOCATIONS_PER_TASK: usize = 32;

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
            resolution: RESOLUTION / bvh.unit().millimetres(),
            allowed: vec![None; info.surfaces.len()],
            budget: 1 << 20,
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
    pub fn with_allowance(
        mut self,
        surface: &str,
        allowed: f64,
    ) -> Result<Verifier<'a>, VerifyError> {
        // Accept exactly what a certifier accepts.
        Certifier::new(self.bvh, self.tool)?.with_allowance(surface, allowed)?;
        if let Some(SurfaceId(index)) = self.tool.info().surface_named(surface) {
            self.allowed[index] = Some(allowed);
        }
        Ok(self)
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

    /// Sets the [budget](Certifier::with_budget) of each query.
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
    pub fn check(&self, program: &Program) -> Result<VerifyReport, VerifyError> {
        self.check_with_progress(program, &|_| ())
    }

    /// Checks a program like [`Verifier::check`]. Calls `progress` with the number of cutter locations checked since
    /// the last call, from any thread and in any order; the numbers add up to all cutter locations.
    ///
    /// # Errors
    /// As for [`Verifier::check`].
    pub fn check_with_progress(
        &self,
        program: &Program,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<VerifyReport, VerifyError> {
        program.check_unit(self.bvh.unit())?;
        program.check_poses(self.tool.info())?;
        program.check_cutter(self.tool.info(), self.bvh.unit())?;
        let locations = &program.locations;
        let certifier = Certifier::new(self.bvh, self.tool)?;
        let surfaces = 0..self.allowed.len();
        let max_depth = |surface| {
            let depth = certifier.max_possible_depth(surface).expect("a surface of the tool");
            depth.unwrap_or(f64::INFINITY)
        };
        let max_depths: Vec<f64> = surfaces.map(SurfaceId).map(max_depth).collect();
        let found = parallel::ranges(locations.len(), LOCATIONS_PER_TASK, |range| {
            let mut checker = Checker::new(self, &max_depths)?;
            let count = range.len();
            let findings = range
                .flat_map(|index| checker.check_location(locations, index))
                .collect::<Vec<_>>();
            progress(count);
            Ok(findings)
        });
        let found: Vec<_> = found.into_iter().collect::<Result<_, VerifyError>>()?;
        let findings: Vec<Finding> = found.into_iter().flatten().collect();
        Ok(VerifyReport {
            motions: locations.len().saturating_sub(1),
            approach: self.approach(locations, &findings)?,
            findings,
            inside_known: self.bvh.has_inside(),
            unrestricted: !self.restricts(locations, &max_depths),
        })
    }

    /// Returns whether a surface of the tool could violate its limit or its margin. `max_depths` has the greatest
    /// possible depth of each surface.
    fn restricts(&self, locations: &[CutterLocation], max_depths: &[f64]) -> bool {
        let modes = [false, true]
            .into_iter()
            .filter(|mode| locations.iter().any(|location| location.rapid == *mode));
        modes
            .flat_map(|rapid| self.limits(rapid).into_iter().zip(max_depths))
            .any(|(limit, max_depth)| limit < 0.0 || limit + self.resolution < *max_depth)
    }

    /// Returns the motion from one pose to another, without the spin for a tool of revolution.
    fn motion(&self, from: &Pose, to: &Pose) -> Result<Motion, MotionError> {
        match self.tool.info().symmetry {
            Symmetry::Revolved => Motion::new(from, to),
            Symmetry::Solid { .. } => Motion::with_spin(from, to),
        }
    }

    /// Returns the depth that each surface is allowed.
    fn limits(&self, rapid: bool) -> Vec<f64> {
        let limit = |allowed: &Option<f64>| {
            let allowed = allowed.unwrap_or(self.tolerance);
            if rapid { allowed.min(self.tolerance) } else { allowed }
        };
        self.allowed.iter().map(limit).collect()
    }
}

/// Checks motions one after another.
struct Checker<'a> {
    verifier: &'a Verifier<'a>,
    /// The certifiers for feed and for rapid traverse, in this order.
    modes: [Mode<'a>; 2],
}

/// A certifier with the allowances of feed or of rapid traverse.
struct Mode<'a> {
    certifier: Certifier<'a>,
    limits: Vec<f64>,
    /// The greatest possible depth of each surface.
    max_depths: &'a [f64],
}

/// Fraction of a surface's greatest possible depth from which on it counts as passing right through the part.
const THROUGH_FRACTION: f64 = 0.98;

impl<'a> Checker<'a> {
    fn new(verifier: &'a Verifier<'a>, max_depths: &'a [f64]) -> Result<Checker<'a>, VerifyError> {
        let mode = |rapid| {
            let limits = verifier.limits(rapid);
            let mut certifier =
                Certifier::new(verifier.bvh, verifier.tool)?.with_budget(verifier.budget);
            for (surface, limit) in verifier.tool.info().surfaces.iter().zip(&limits) {
                certifier = certifier.with_allowance(&surface.name, *limit)?;
            }
            Ok::<_, VerifyError>(Mode { certifier, limits, max_depths })
        };
        Ok(Checker { verifier, modes: [mode(false)?, mode(true)?] })
    }

    /// Returns the findings of the motion to a cutter location.
    fn check_location(&mut self, locations: &[CutterLocation], index: usize) -> Vec<Finding> {
        let to = locations[index];
        let before = index.checked_sub(1).map(|before| locations[before]);
        let from = before.map_or(to.pose, |before| before.pose);
        let finding = |part: f64, pose: Pose, kind: FindingKind| Finding {
            location: index,
            line: to.line,
            from: before.map(|before| before.line),
            rapid: to.rapid,
            time: part,
            pose,
            kind,
        };
        let mode = &mut self.modes[usize::from(to.rapid)];
        let mut findings = Vec::new();
        // Where the motion is ambiguous, check the cutter location itself.
        let motion = self.verifier.motion(&from, &to.pose).or_else(|error| {
            findings.push(finding(1.0, to.pose, FindingKind::Ambiguous(error)));
            self.verifier.motion(&to.pose, &to.pose)
        });
        if let Ok(motion) = motion {
            for (part, kind) in mode.motion(&motion, self.verifier.resolution) {
                findings.push(finding(part, motion.pose(part), kind));
            }
        }
        findings
    }
}

impl Mode<'_> {
    /// Returns the findings of a motion, each with its time on the motion from 0 to 1.
    fn motion(&mut self, motion: &Motion, resolution: f64) -> Vec<(f64, FindingKind)> {
        let swept = self.certifier.check_motion(motion, resolution);
        if matches!(swept, MotionVerdict::Clear | MotionVerdict::SurfaceOnly) {
            return Vec::new();
        }
        let mut found = Vec::new();
        let mut inside = Vec::new();
        for (index, allowed) in self.limits.iter().copied().enumerate() {
            if allowed == f64::INFINITY {
                continue;
            }
            let surface = SurfaceId(index);
            let depth = self.certifier.motion_depth(surface, motion, allowed, resolution);
            match depth.expect("a surface of the tool") {
                MotionDepth::Within => (),
                MotionDepth::Deeper { at, depth: Interval { low, high }, max_depth, witness }
                    if low < 0.0 =>
                {
                    let [from, to, min_distance] =
                        [-high, -low, -max_depth].map(|distance| distance.max(0.0));
                    let (margin, distance) = (-allowed, Interval::new(from, to));
                    found.push((
                        at,
                        FindingKind::Near { surface, margin, distance, min_distance, witness },
                    ));
                }
                MotionDepth::Deeper { at, depth, max_depth, witness } => {
                    let through = depth.high >= THROUGH_FRACTION * self.max_depths[index];
                    found.push((
                        at,
                        FindingKind::Deep { surface, allowed, depth, max_depth, through, witness },
                    ));
                }
                MotionDepth::Inside => inside.push(surface),
                MotionDepth::Undecided(at) => found.push((at, FindingKind::Undecided { surface })),
            }
        }
        if let (MotionVerdict::Inside(surface), []) = (swept, &inside[..]) {
            inside.push(surface);
        }
        if !inside.is_empty() && self.certifier.is_buried(&motion.pose(0.0)) == Some(true) {
            found.push((0.0, FindingKind::Inside { surface: None }));
        } else {
            let finding = |surface| (0.0, FindingKind::Inside { surface: Some(surface) });
            found.extend(inside.into_iter().map(finding));
        }
        found
    }
}
