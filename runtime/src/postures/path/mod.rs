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
//! are joined above it: a little back along the axis, across, and in along the next axis. Where that fails too,
//! the tool moves out, around the part, and in.

mod axes;
mod retract;
mod slice;

use super::placement::{CandidatePosture, SurfacePoint, ToolPlacement};
use super::{Directions, Rules, Validator, ValidatorError};
use crate::certify::{MotionVerdict, TriangleBvh};
use crate::debug::debug;
use crate::mesh::Mesh;
use crate::motion::Motion;
use crate::parallel;
use crate::pose::Pose;
use crate::tool::Tool;
use axes::{PathPosture, PostureRun};
use nalgebra::Vector3;
use retract::{RetractLeg, RetractSphere};
use slice::{SlicePoint, length_of_lines, slices};

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
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// The rules are invalid, or the tool cannot be validated.
    #[error(transparent)]
    Validator(#[from] ValidatorError),
    /// No posture was found for the path.
    #[error(
        "the tool reaches none of the places where the planes cut the part: sweep with it first, or take \
         planes of another normal"
    )]
    NoPosture,
}

/// A path and its statistics.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ToolPath {
    /// Cutter locations, each with a flag that is set if the tool arrives in rapid traverse. The first and the
    /// last are away from the part.
    pub locations: Vec<(Pose, bool)>,
    /// Number of points at which the part is touched.
    pub contact_points: usize,
    /// Number of points on the lines that are left out: the tool does not reach them, or no motion to them was
    /// proved.
    pub left_out: usize,
    /// Number of times that the tool leaves the surface.
    pub retracts: usize,
    /// Root mean square turn of the axis from point to point along the lines, in radians, before and after
    /// smoothing.
    pub turns: [f64; 2],
}

/// Largest number of planes.
const MAX_PLANES: usize = 100_000;

/// Largest number of points, estimated from the length of the lines: some gigabytes, and weeks on any machine.
const MAX_POINTS: usize = 20_000_000;

/// Fraction of the tolerance reserved for motions between cutter locations.
const MOTION_TOLERANCE_FRACTION: f64 = 1.0 / 8.0;

/// Number of lines per unit of parallel work.
const LINES_PER_TASK: usize = 8;

/// Search budget of a query. A motion that takes more to prove is left to an alternative.
const QUERY_BUDGET: u32 = 1 << 18;

/// Plans the path of a tool over a part.
pub(super) struct PathPlanner<'a> {
    placement: ToolPlacement<'a>,
    validator: Validator<'a>,
    rules: &'a Rules,
    postures: Vec<CandidatePosture>,
}

/// The part, the tool and the pattern of a path to plan.
#[derive(Clone, Copy)]
pub struct PathRequest<'a> {
    /// The part's mesh.
    pub mesh: &'a Mesh,
    /// The mesh's triangles in a hierarchy.
    pub bvh: &'a TriangleBvh,
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
}

debug!([] PathRequest<'_>, "PathRequest", |this| { tool: this.tool.info().name, rules: this.rules, pattern: this.pattern });

impl PathRequest<'_> {
    /// Plans a path of the tool over all that it reaches of the part. The tool is no deeper than the rules' tolerance
    /// at cutter locations and between them, where the tip moves straight and the axis turns evenly. At every point
    /// it is nicer than the rules require.
    ///
    /// # Errors
    /// If the pattern or the rules are invalid, or no point can be reached; see [`PathError`].
    pub fn plan(&self) -> Result<ToolPath, PathError> {
        let PathRequest { mesh, bvh, tool, rules, directions, accessibility, pattern } = *self;
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
        let mut planner = PathPlanner::new(bvh, tool, rules)?;
        let sphere = RetractSphere::new(mesh, planner.placement.reach());
        let planes = slices(mesh, &normal, [pattern.stepover, pattern.step]);
        let lines: Vec<(usize, &Vec<SlicePoint>)> = planes
            .iter()
            .enumerate()
            .flat_map(|(k, lines)| lines.iter().map(move |line| (k, line)))
            .collect();
        let runs = parallel::ranges(lines.len(), LINES_PER_TASK, |range| {
            // Errors were reported for the planner above.
            let Ok(mut planner) = PathPlanner::new(bvh, tool, rules) else { return Vec::new() };
            let run = |(plane, line): &(usize, &Vec<SlicePoint>)| {
                planner.validator.certifier.clear_caches();
                (*plane, planner.runs(mesh, (directions, accessibility), line))
            };
            lines[range].iter().map(run).collect()
        });
        let mut path = DrawnPath {
            point_count: lines.iter().map(|(_, line)| line.len()).sum(),
            ..DrawnPath::default()
        };
        let mut runs = runs.into_iter().flatten().peekable();
        while let Some((plane, mut plane_runs)) = runs.next() {
            while let Some((_, more)) = runs.next_if(|(other, _)| *other == plane) {
                plane_runs.extend(more);
            }
            plane_runs.iter().for_each(|run| path.count(run));
            // Continue with the remaining run whose end is nearest.
            while let Some((next, reverse)) = path.nearest(&plane_runs) {
                let mut run = plane_runs.swap_remove(next);
                if reverse {
                    run.reverse();
                }
                path.follow(&mut planner, &sphere, &run, 3.0 * pattern.stepover);
            }
        }
        path.end(&mut planner, &sphere)
    }
}

impl<'a> PathPlanner<'a> {
    fn new(
        bvh: &'a TriangleBvh,
        tool: &'a dyn Tool,
        rules: &'a Rules,
    ) -> Result<PathPlanner<'a>, ValidatorError> {
        let location_rules = Rules {
            tolerance: rules.tolerance * (1.0 - MOTION_TOLERANCE_FRACTION),
            ..rules.clone()
        };
        let mut validator = Validator::new(bvh, tool, &location_rules)?;
        validator.certifier = validator.certifier.with_budget(QUERY_BUDGET);
        let placement = ToolPlacement::new(tool, bvh.unit());
        Ok(PathPlanner { placement, validator, rules, postures: Vec::new() })
    }

    /// Returns the posture at a surface point with a given axis, if it is proved acceptable.
    fn posture_at(
        &mut self,
        surface_point: &SurfacePoint,
        axis: Vector3<f64>,
    ) -> Option<PathPosture> {
        self.placement.list(*surface_point, [axis], &mut self.postures);
        let nice = self.postures.iter().filter(|posture| posture.niceness > self.rules.niceness);
        let mut poses = nice.filter_map(|posture| Pose::from_axis(posture.tip, axis).ok());
        let pose = poses.find(|pose| self.validator.accepts(pose))?;
        Some(PathPosture { surface_point: *surface_point, pose, axis })
    }

    /// Returns whether the tool is proved to be no deeper than the tolerance during a motion (`true`), or to be
    /// deeper (`false`); `None` if neither is proved or the motion is ambiguous.
    fn check_motion(&mut self, from: &Pose, to: &Pose) -> Option<bool> {
        let motion = Motion::new(from, to).ok()?;
        let more = MOTION_TOLERANCE_FRACTION * self.rules.tolerance;
        match self.validator.certifier.check_motion(&motion, more) {
            MotionVerdict::Clear | MotionVerdict::SurfaceOnly => Some(true),
            MotionVerdict::Touching(..) | MotionVerdict::Inside(_) => Some(false),
            MotionVerdict::Undecided(_) => None,
        }
    }

    /// Returns whether the tool is proved to be no deeper than the tolerance during a motion.
    fn is_clear(&mut self, from: &Pose, to: &Pose) -> bool {
        self.check_motion(from, to) == Some(true)
    }
}

/// A path under construction.
#[derive(Default)]
struct DrawnPath {
    locations: Vec<(Pose, bool)>,
    /// The last approach from outside: the index of its cutter location on the surface, and its leg.
    last_approach: Option<(usize, RetractLeg)>,
    /// The last posture on the surface.
    last: Option<PathPosture>,
    point_count: usize,
    contact_points: usize,
    dropped: usize,
    retracts: usize,
    steps: usize,
    squared_turns: [f64; 2],
}

impl DrawnPath {
    fn count(&mut self, run: &PostureRun) {
        self.contact_points += run.postures.len();
        self.steps += run.postures.len() - 1;
        self.squared_turns[0] += run.squared_turns;
        self.squared_turns[1] += run.turns();
    }

    /// Returns the index of the run with the nearest end, and whether that is its last posture.
    fn nearest(&self, runs: &[PostureRun]) -> Option<(usize, bool)> {
        let from = self.last.as_ref().map(|last| last.pose.tip());
        let distance_to =
            |posture: &PathPosture| from.map_or(0.0, |from| (posture.pose.tip() - from).norm());
        let ends = runs.iter().enumerate().filter_map(|(index, run)| {
            let (first, last) = (run.postures.first()?, run.postures.last()?);
            Some([(distance_to(first), index, false), (distance_to(last), index, true)])
        });
        let nearest = ends.flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, index, reverse)| (index, reverse))
    }

    fn push_location(&mut self, pose: Pose, rapid: bool) {
        self.locations.push((pose, rapid));
    }

    /// Moves to a run and along it. Two points that cannot be joined on the surface are joined above it or
    /// around the part; a point that cannot be joined at all is dropped.
    fn follow(
        &mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
        run: &PostureRun,
        max_link: f64,
    ) {
        for (index, posture) in run.postures.iter().enumerate() {
            let links = match (index.checked_sub(1), &self.last) {
                // The pose tells whether the previous posture of the run was reached or dropped.
                (Some(before), Some(last)) if run.postures[before].pose == last.pose => {
                    run.links[before].clone()
                }
                (_, Some(last))
                    if (posture.surface_point.point - last.surface_point.point).norm()
                        <= max_link =>
                {
                    planner.link(last, posture, &[])
                }
                _ => None,
            };
            if let Some(locations) = links {
                locations.into_iter().for_each(|pose| self.push_location(pose, false));
            } else if !self.hop(planner, sphere, posture)
                && !self.move_around(planner, sphere, posture)
            {
                self.dropped += 1;
                continue;
            }
            self.push_location(posture.pose, false);
            self.last = Some(*posture);
        }
    }

    /// Retracts a little from the surface, moves across, and comes down to a posture. Does nothing and returns
    /// `false` if that is not proved.
    fn hop(
        &mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
        posture: &PathPosture,
    ) -> bool {
        let Some(last) = &self.last else { return false };
        let (from, to) = (last.pose, posture.pose);
        let (Some(up), Some(over)) = (sphere.retracted(&from), sphere.retracted(&to)) else {
            return false;
        };
        let proved = planner.is_clear(&from, &up)
            && planner.is_clear(&up, &over)
            && planner.is_clear(&over, &to);
        if proved {
            self.push_location(up, false);
            self.push_location(over, true);
            self.retracts += 1;
        }
        proved
    }

    /// Leaves the surface, and comes to a posture from outside. Returns `false` if that is not proved.
    fn move_around(
        &mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
        posture: &PathPosture,
    ) -> bool {
        let Some(leg) = sphere.leg(planner, &posture.pose) else { return false };
        let location_count = self.locations.len();
        if let Some(from) = self.leave(planner, sphere) {
            let Some(locations) = sphere.between(planner, &from, &leg.outer) else {
                self.locations.truncate(location_count);
                return false;
            };
            locations.into_iter().for_each(|pose| self.push_location(pose, true));
            self.retracts += 1;
        }
        self.push_location(leg.outer, true);
        self.push_location(leg.lead_end, true);
        self.last_approach = Some((self.locations.len(), leg));
        true
    }

    /// Leaves the surface and returns the outer pose; `None` if nothing was touched yet. Where the leg from the
    /// last cutter location is not proved, the tool first goes back along the earlier ones, hops included, at
    /// most to the last one that was approached from outside.
    fn leave(&mut self, planner: &mut PathPlanner<'_>, sphere: &RetractSphere) -> Option<Pose> {
        let (first, last_approach) = self.last_approach?;
        let mut index = self.locations.len() - 1;
        let leg = loop {
            if index == first {
                break last_approach;
            }
            if let Some(leg) = sphere.leg(planner, &self.locations[index].0) {
                break leg;
            }
            index -= 1;
            self.push_location(self.locations[index].0, false);
        };
        self.push_location(leg.lead_end, false);
        self.push_location(leg.outer, true);
        Some(leg.outer)
    }

    fn end(
        mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
    ) -> Result<ToolPath, PathError> {
        self.leave(planner, sphere).ok_or(PathError::NoPosture)?;
        let steps = self.steps.max(1) as f64;
        let contact_points = self.contact_points - self.dropped;
        Ok(ToolPath {
            contact_points,
            left_out: self.point_count - contact_points,
            retracts: self.retracts,
            turns: self.squared_turns.map(|squared_turns| (squared_turns / steps).sqrt()),
            locations: self.locations,
        })
    }
}
