//! Planning of paths through postures: a 5-axis program that is proved.
//!
//! ```text
//! mesh ──slice──▶ lines ──axes──▶ runs of postures ──smooth──▶ even turns ──link──▶ stops
//!                          ▲                                                  ▲
//!                     where a sweep reached                              check_motion
//! ```
//!
//! Parallel planes slice the part into lines. Along each line the tool takes postures that a sweep found
//! reachable, in the directions that turn least from point to point. Every posture and every motion between two
//! of them is proved. Where a straight motion is too deep, the tool is led over the edges between the two
//! points, with as many intermediate cutter locations as needed. Points that cannot be joined on the surface
//! are joined off it, by the shortest proved way of several: out along the axis, across or around the part, and in
//! along the next axis. The runs of all planes are followed by nearness, so that few such ways are needed.

mod axes;
mod drawn;
mod order;
mod range;
mod retract;
mod slice;
mod tilt;

use super::placement::{CandidatePosture, SurfacePoint, ToolPlacement};
use super::{Directions, Rules, Validator, ValidatorError};
use axes::PathPosture;
use drawn::DrawnPath;
use nalgebra::{Point3, Vector3};
use order::OpenRuns;
use range::AxisRange;
pub use range::ToolAxisLimits;
use rayon::prelude::*;
pub(crate) use retract::RetractSphere;
use slice::{Planes, SlicePoint, length_of_lines, slices};
use std::fmt;
use tilt::TiltLimit;
use touchoff::certify::{Certifier, MotionVerdict, PoseVerdict, TriangleBvh};
use touchoff::{Mesh, Motion, Pose, Tool};

/// The pattern of lines that covers a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// Normal of the slicing planes, of any length.
    pub normal: [f64; 3],
    /// Distance between planes, in the part's unit. It is adjusted so that the planes are evenly spaced.
    pub stepover: f64,
    /// Largest distance between points on a line, in the part's unit.
    pub step: f64,
}

/// A reason for which there is no path.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// A length of the pattern is not finite or not above 0.
    #[error("{what} of {value} is not a length above 0: give one in the part's unit, such as 1")]
    Pattern {
        /// The name of the length.
        what: &'static str,
        /// The given value.
        value: f64,
    },
    /// The planes have no normal.
    #[error("the planes' normal is no direction: give three numbers that are not all 0")]
    Normal,
    /// The pattern has too many planes.
    #[error("{planes:.0} planes are more than {limit}: take a larger stepover")]
    TooMany {
        /// Number of planes of the pattern.
        planes: f64,
        /// Largest number allowed.
        limit: usize,
    },
    /// The pattern has too many points on the lines.
    #[error("{points:.0} points are more than {limit}: take a larger step or stepover")]
    TooFine {
        /// Estimated number of points.
        points: f64,
        /// Largest number allowed.
        limit: usize,
    },
    /// The largest tilt is no angle that limits the tool axis.
    #[error("a tilt of {0} rad is no limit: give an angle above 0 and up to π (180°)")]
    Tilt(f64),
    /// The rules are invalid, or the tool cannot be validated.
    #[error(transparent)]
    Validator(#[from] ValidatorError),
    /// No direction that was swept is one that the tool axis may take.
    #[error(
        "none of the directions that were swept is within the limits of the tool axis: allow a larger tilt, sweep with \
         more directions, or take a machine that tilts the tool farther"
    )]
    NoDirection,
    /// No posture was found for the path.
    #[error(
        "the tool reaches none of the places where the planes cut the part: sweep with it first, take planes \
         of another normal, or allow the axis a larger tilt"
    )]
    NoPosture,
}

touchoff::debug_as_sentence!(PathError);

/// A path and its statistics.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ToolPath {
    /// Cutter locations, each with a flag that is set if the tool arrives in rapid traverse. The first and the
    /// last are above the part, with the axis along +z, if the axis may point there and the way is proved, and
    /// otherwise away from the part in another direction.
    pub locations: Vec<(Pose, bool)>,
    /// Number of points at which the part is touched.
    pub contact_points: usize,
    /// The points on the lines that are left out.
    pub left_out: Vec<LeftOut>,
    /// Number of times that the tool leaves the surface and comes back.
    pub retracts: usize,
    /// Root mean square turn of the axis from point to point along the lines, in radians, before and after
    /// smoothing.
    pub turns: [f64; 2],
}

/// A point on the lines that is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// The point on the part.
    pub point: Point3<f64>,
    /// The reason.
    pub reason: LeftOutReason,
}

/// The reason for which a path leaves out a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOutReason {
    /// No posture at the point is proved acceptable, within the limits of the tool axis.
    NotReached,
    /// No motion to the point is proved acceptable.
    NoMotion,
}

impl ToolPath {
    /// Returns the number of points that are left out for a reason.
    pub fn count_left_out(&self, reason: LeftOutReason) -> usize {
        self.left_out.iter().filter(|left_out| left_out.reason == reason).count()
    }
}

/// Largest number of planes.
const MAX_PLANES: usize = 100_000;

/// Largest number of points, estimated from the length of the lines: some gigabytes, and weeks on any machine.
const MAX_POINTS: usize = 20_000_000;

/// Fraction of the tolerance reserved for motions between cutter locations. During these, a surface that does not
/// cut may be that deep.
pub const MOTION_TOLERANCE_FRACTION: f64 = 1.0 / 8.0;

/// Number of lines per unit of parallel work.
const LINES_PER_TASK: usize = 8;

/// Search budget of a query. A motion that takes more to prove is left to an alternative.
const QUERY_BUDGET: u32 = 1 << 18;

/// Plans the path of a tool over a part.
pub(super) struct PathPlanner<'a> {
    placement: ToolPlacement<'a>,
    validator: Validator<'a>,
    /// The stock, which no surface may touch in rapid traverse.
    stock: Option<Certifier<'a>>,
    rules: &'a Rules,
    range: AxisRange<'a>,
    postures: Vec<CandidatePosture>,
}

/// The part, the tool and the pattern of a path to plan.
#[derive(Clone, Copy)]
pub struct PathRequest<'a> {
    /// The part's mesh.
    pub mesh: &'a Mesh,
    /// The mesh's triangles in a hierarchy.
    pub bvh: &'a TriangleBvh,
    /// The stock in the frame of the part, a solid: the tool moves through it in feed and keeps clear of it in rapid
    /// traverse. `None` if there is nothing but the part.
    pub stock: Option<&'a TriangleBvh>,
    /// The tool.
    pub tool: &'a dyn Tool,
    /// The limits of acceptable postures.
    pub rules: &'a Rules,
    /// The directions that the sweep tried.
    pub directions: &'a Directions,
    /// Per triangle id the directions from which the sweep found that the tool reaches it, in the format of
    /// [`Accessibility`](super::Accessibility); an empty list where it does not.
    pub accessibility: &'a [Vec<u64>],
    /// The lines to follow.
    pub pattern: &'a Pattern,
    /// Largest angle of the tool axis from +z of the part, in radians, at cutter locations and between them:
    /// above 0; π for any axis.
    pub max_tilt: f64,
    /// The limits of a machine's rotary axes; `None` for any axis. Every cutter location is within them.
    pub axis_limits: Option<&'a dyn ToolAxisLimits>,
}

impl fmt::Debug for PathRequest<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PathRequest")
            .field("tool", &self.tool.info().name)
            .field("rules", &self.rules)
            .field("pattern", &self.pattern)
            .finish_non_exhaustive()
    }
}

impl PathRequest<'_> {
    /// Plans a path of the tool over all that it reaches of the part. The tool is no deeper than the rules' tolerance
    /// at cutter locations and between them, where the tip moves straight and the axis turns evenly. At every point
    /// it is nicer than the rules require.
    ///
    /// # Errors
    /// If the pattern or the rules are invalid, or no point can be reached; see [`PathError`].
    pub fn plan(&self) -> Result<ToolPath, PathError> {
        let PathRequest {
            mesh, bvh, stock, tool, rules, directions, accessibility, pattern, ..
        } = *self;
        for (what, value) in [("a stepover", pattern.stepover), ("a step", pattern.step)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(PathError::Pattern { what, value });
            }
        }
        // Divide by the largest component first, so that no square overflows or underflows.
        let normal = Vector3::from(pattern.normal);
        let normal = (normal / normal.amax()).try_normalize(0.0).filter(|n| n.norm().is_finite());
        let normal = normal.ok_or(PathError::Normal)?;
        let [low, high] = mesh.bounds();
        let planes = (high - low).norm() / pattern.stepover;
        if planes > MAX_PLANES as f64 {
            return Err(PathError::TooMany { planes, limit: MAX_PLANES });
        }
        let points = length_of_lines(mesh, &normal, pattern.stepover) / pattern.step;
        if points > MAX_POINTS as f64 {
            return Err(PathError::TooFine { points, limit: MAX_POINTS });
        }
        let tilt = TiltLimit::new(self.max_tilt).ok_or(PathError::Tilt(self.max_tilt))?;
        let range = AxisRange { tilt, machine: self.axis_limits };
        let (accessibility, any_direction) = range.filter(directions, accessibility);
        if !any_direction {
            return Err(PathError::NoDirection);
        }
        let mut planner = PathPlanner::new(bvh, stock, tool, rules, range)?;
        let sphere = RetractSphere::new(bvh, stock, planner.placement.reach());
        let planes = Planes::new(mesh, &normal, pattern.stepover);
        let slices = slices(mesh, &planes, pattern.step);
        let lines: Vec<(usize, &Vec<SlicePoint>)> = slices
            .iter()
            .enumerate()
            .flat_map(|(k, lines)| lines.iter().map(move |line| (k, line)))
            .collect();
        let runs = lines.par_chunks(LINES_PER_TASK).map(|lines| {
            // Errors were reported for the planner above.
            let Ok(mut planner) = PathPlanner::new(bvh, stock, tool, rules, range) else {
                return Vec::new();
            };
            let runs = lines.iter().map(|(plane, line)| {
                // So that the runs of a line do not depend on the lines before it.
                planner.validator.certifier.clear_caches();
                (*plane, planner.runs(mesh, directions, &accessibility, line))
            });
            runs.collect::<Vec<_>>()
        });
        let runs: Vec<Vec<_>> = runs.collect();
        let mut path = DrawnPath::default();
        let mut open = OpenRuns::new(planes, planner.placement.reach(), sphere.lead());
        for (plane, (runs, unreached)) in runs.into_iter().flatten() {
            path.leave_out(unreached);
            runs.iter().for_each(|run| path.count(run));
            open.extend(plane, runs);
        }
        while let Some(run) = open.take_nearest(path.last()) {
            path.follow(&mut planner, &sphere, &run, 3.0 * pattern.stepover);
        }
        path.end(&mut planner, &sphere)
    }
}

impl<'a> PathPlanner<'a> {
    fn new(
        bvh: &'a TriangleBvh,
        stock: Option<&'a TriangleBvh>,
        tool: &'a dyn Tool,
        rules: &'a Rules,
        range: AxisRange<'a>,
    ) -> Result<PathPlanner<'a>, ValidatorError> {
        // The rest of the tolerance is for motions, which are deeper between cutter locations than at them.
        let location_rules = Rules {
            tolerance: rules.tolerance * (1.0 - MOTION_TOLERANCE_FRACTION),
            ..rules.clone()
        };
        let mut validator = Validator::new(bvh, tool, &location_rules)?;
        validator.certifier = validator.certifier.with_budget(QUERY_BUDGET);
        let stock = stock.map(|stock| Certifier::new(stock, tool)).transpose()?;
        let stock = stock.map(|certifier| certifier.with_budget(QUERY_BUDGET));
        let placement = ToolPlacement::new(tool, bvh.unit());
        Ok(PathPlanner { placement, validator, stock, rules, range, postures: Vec::new() })
    }

    /// Returns the posture at a surface point with a given axis, if it is proved acceptable.
    fn posture_at(
        &mut self,
        surface_point: &SurfacePoint,
        axis: Vector3<f64>,
    ) -> Option<PathPosture> {
        if !self.range.allows(&axis) {
            return None;
        }
        self.placement.list(*surface_point, [axis], &mut self.postures);
        let nice = self.postures.iter().filter(|posture| posture.niceness > self.rules.niceness);
        let mut poses = nice.filter_map(|posture| Pose::from_axis(posture.tip, axis).ok());
        let pose = poses.find(|pose| self.validator.accepts(pose))?;
        Some(PathPosture { surface_point: *surface_point, pose, axis })
    }

    /// Returns whether the tool is proved to be no deeper than the tolerance during a motion (`true`), or to be
    /// deeper (`false`); `None` if neither is proved, the motion is ambiguous, or the axis leaves its range.
    fn check_motion(&mut self, from: &Pose, to: &Pose) -> Option<bool> {
        if !self.range.allows_turn(&from.axis(), &to.axis()) {
            return None;
        }
        let motion = Motion::new(from, to).ok()?;
        let more = MOTION_TOLERANCE_FRACTION * self.rules.tolerance;
        match self.validator.certifier.check_motion(&motion, more) {
            MotionVerdict::Clear | MotionVerdict::SurfaceOnly => Some(true),
            MotionVerdict::Touching(..) | MotionVerdict::Near(..) | MotionVerdict::Inside(_) => {
                Some(false)
            }
            MotionVerdict::Undecided(_) => None,
        }
    }

    /// Returns whether the tool is proved to be no deeper than the tolerance during a motion.
    fn is_clear(&mut self, from: &Pose, to: &Pose) -> bool {
        self.check_motion(from, to) == Some(true)
    }

    /// Returns whether a motion is proved for rapid traverse: it is clear, and touches no stock.
    fn is_free(&mut self, from: &Pose, to: &Pose) -> bool {
        let off_stock = match (&mut self.stock, Motion::new(from, to)) {
            (None, _) => true,
            (Some(stock), Ok(motion)) => {
                matches!(stock.check_motion(&motion, 0.0), MotionVerdict::Clear)
            }
            (Some(_), Err(_)) => false,
        };
        off_stock && self.is_clear(from, to)
    }

    /// Returns whether the tool is proved to touch no stock.
    fn is_off_stock(&mut self, pose: &Pose) -> bool {
        let stock = self.stock.as_mut();
        stock.is_none_or(|stock| matches!(stock.check_pose(pose), PoseVerdict::Clear))
    }
}
