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
    #[error("{what} of {value} is no length above 0: give one in the part's unit, such as 1")]
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
    #[error("{planes:.0} planes are more than {most}: take a larger stepover")]
    TooMany {
        /// Number of planes of the pattern.
        planes: f64,
        /// Largest number allowed.
        most: usize,
    },
    /// The pattern has too many points on the lines.
    #[error("{places:.0} places are more than {most}: take a larger step or stepover")]
    TooFine {
        /// Estimated number of points.
        places: f64,
        /// Largest number allowed.
        most: usize,
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
const MOST: usize = 100_000;

/// Largest number of points, estimated from the length of the lines: some gigabytes, and weeks on any machine.
const MOST_PLACES: usize = 20_000_000;

/// Fraction of the tolerance reserved for motions between cutter locations.
const BETWEEN: f64 = 1.0 / 8.0;

/// Number of lines per unit of parallel work.
const TOGETHER: usize = 8;

/// Search budget of a query. A motion that takes more to prove is left to an alternative.
const BUDGET: u32 = 1 << 18;

/// Plans the path of a tool over a part.
pub(super) struct PathPlanner<'a> {
    touching: ToolPlacement<'a>,
    judge: Validator<'a>,
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
        if planes > MOST as f64 {
            return Err(PathError::TooMany { planes, most: MOST });
        }
        let places = length_of_lines(mesh, &normal, pattern.stepover) / pattern.step;
        if places > MOST_PLACES as f64 {
            return Err(PathError::TooFine { places, most: MOST_PLACES });
        }
        let mut leader = PathPlanner::new(bvh, tool, rules)?;
        let around = RetractSphere::new(mesh, leader.touching.reach());
        let planes = slices(mesh, &normal, [pattern.stepover, pattern.step]);
        let lines: Vec<(usize, &Vec<SlicePoint>)> = planes
            .iter()
            .enumerate()
            .flat_map(|(k, lines)| lines.iter().map(move |line| (k, line)))
            .collect();
        let runs = parallel::ranges(lines.len(), TOGETHER, |range| {
            // Errors were reported for the planner above.
            let Ok(mut leader) = PathPlanner::new(bvh, tool, rules) else { return Vec::new() };
            let run = |(plane, line): &(usize, &Vec<SlicePoint>)| {
                leader.judge.certifier.forget();
                (*plane, leader.runs(mesh, (directions, accessibility), line))
            };
            lines[range].iter().map(run).collect()
        });
        let mut path = DrawnPath {
            seen: lines.iter().map(|(_, line)| line.len()).sum(),
            ..DrawnPath::default()
        };
        let mut runs = runs.into_iter().flatten().peekable();
        while let Some((plane, mut here)) = runs.next() {
            while let Some((_, more)) = runs.next_if(|(other, _)| *other == plane) {
                here.extend(more);
            }
            here.iter().for_each(|run| path.count(run));
            // Continue with the remaining run whose end is nearest.
            while let Some((next, reverse)) = path.nearest(&here) {
                let mut run = here.swap_remove(next);
                if reverse {
                    run.reverse();
                }
                path.follow(&mut leader, &around, &run, 3.0 * pattern.stepover);
            }
        }
        path.end(&mut leader, &around)
    }
}

impl<'a> PathPlanner<'a> {
    fn new(
        bvh: &'a TriangleBvh,
        tool: &'a dyn Tool,
        rules: &'a Rules,
    ) -> Result<PathPlanner<'a>, ValidatorError> {
        let at_stops = Rules { tolerance: rules.tolerance * (1.0 - BETWEEN), ..rules.clone() };
        let mut judge = Validator::new(bvh, tool, &at_stops)?;
        judge.certifier = judge.certifier.with_budget(BUDGET);
        let touching = ToolPlacement::new(tool, bvh.unit());
        Ok(PathPlanner { touching, judge, rules, postures: Vec::new() })
    }

    /// Returns the posture at a surface point with a given axis, if it is proved acceptable.
    fn stand(&mut self, spot: &SurfacePoint, axis: Vector3<f64>) -> Option<PathPosture> {
        self.touching.list(*spot, [axis], &mut self.postures);
        let nice = self.postures.iter().filter(|posture| posture.niceness > self.rules.niceness);
        let mut poses = nice.filter_map(|posture| Pose::from_axis(posture.tip, axis).ok());
        let pose = poses.find(|pose| self.judge.accepts(pose))?;
        Some(PathPosture { spot: *spot, pose, axis })
    }

    /// Returns whether the tool is proved to be no deeper than the tolerance during a motion (`true`), or to be
    /// deeper (`false`); `None` if neither is proved or the motion is ambiguous.
    fn sweep(&mut self, from: &Pose, to: &Pose) -> Option<bool> {
        let motion = Motion::new(from, to).ok()?;
        let more = BETWEEN * self.rules.tolerance;
        match self.judge.certifier.check_motion(&motion, more) {
            MotionVerdict::Clear | MotionVerdict::SurfaceOnly => Some(true),
            MotionVerdict::Touching(..) | MotionVerdict::Inside(_) => Some(false),
            MotionVerdict::Undecided(_) => None,
        }
    }

    /// Returns whether the tool is proved to be no deeper than the tolerance during a motion.
    fn goes(&mut self, from: &Pose, to: &Pose) -> bool {
        self.sweep(from, to) == Some(true)
    }
}

/// A path under construction.
#[derive(Default)]
struct DrawnPath {
    stops: Vec<(Pose, bool)>,
    /// The last approach from outside: the index of its cutter location on the surface, and its leg.
    came: Option<(usize, RetractLeg)>,
    /// The last posture on the surface.
    last: Option<PathPosture>,
    seen: usize,
    places: usize,
    dropped: usize,
    lifts: usize,
    steps: usize,
    turned: [f64; 2],
}

impl DrawnPath {
    fn count(&mut self, run: &PostureRun) {
        self.places += run.ways.len();
        self.steps += run.ways.len() - 1;
        self.turned[0] += run.turned;
        self.turned[1] += run.turns();
    }

    /// Returns the index of the run with the nearest end, and whether that is its last posture.
    fn nearest(&self, runs: &[PostureRun]) -> Option<(usize, bool)> {
        let from = self.last.as_ref().map(|last| last.pose.tip());
        let far = |way: &PathPosture| from.map_or(0.0, |from| (way.pose.tip() - from).norm());
        let ends = runs.iter().enumerate().filter_map(|(index, run)| {
            let (first, last) = (run.ways.first()?, run.ways.last()?);
            Some([(far(first), index, false), (far(last), index, true)])
        });
        let nearest = ends.flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, index, reverse)| (index, reverse))
    }

    fn stop(&mut self, pose: Pose, rapid: bool) {
        self.stops.push((pose, rapid));
    }

    /// Moves to a run and along it. Two points that cannot be joined on the surface are joined above it or
    /// around the part; a point that cannot be joined at all is dropped.
    fn follow(
        &mut self,
        leader: &mut PathPlanner<'_>,
        around: &RetractSphere,
        run: &PostureRun,
        near: f64,
    ) {
        for (index, way) in run.ways.iter().enumerate() {
            let joined = match (index.checked_sub(1), &self.last) {
                // The pose tells whether the previous posture of the run was reached or dropped.
                (Some(before), Some(last)) if run.ways[before].pose == last.pose => {
                    run.joined[before].clone()
                }
                (_, Some(last)) if (way.spot.point - last.spot.point).norm() <= near => {
                    leader.join(last, way, &[])
                }
                _ => None,
            };
            if let Some(stops) = joined {
                stops.into_iter().for_each(|pose| self.stop(pose, false));
            } else if !self.hop(leader, around, way) && !self.go_round(leader, around, way) {
                self.dropped += 1;
                continue;
            }
            self.stop(way.pose, false);
            self.last = Some(*way);
        }
    }

    /// Retracts a little from the surface, moves across, and comes down to a posture. Does nothing and returns
    /// `false` if that is not proved.
    fn hop(
        &mut self,
        leader: &mut PathPlanner<'_>,
        around: &RetractSphere,
        way: &PathPosture,
    ) -> bool {
        let Some(last) = &self.last else { return false };
        let (from, to) = (last.pose, way.pose);
        let (Some(up), Some(over)) = (around.lifted(&from), around.lifted(&to)) else {
            return false;
        };
        let proved = leader.goes(&from, &up) && leader.goes(&up, &over) && leader.goes(&over, &to);
        if proved {
            self.stop(up, false);
            self.stop(over, true);
            self.lifts += 1;
        }
        proved
    }

    /// Leaves the surface, and comes to a posture from outside. Returns `false` if that is not proved.
    fn go_round(
        &mut self,
        leader: &mut PathPlanner<'_>,
        around: &RetractSphere,
        way: &PathPosture,
    ) -> bool {
        let Some(leg) = around.leg(leader, &way.pose) else { return false };
        let left = self.stops.len();
        if let Some(from) = self.leave(leader, around) {
            let Some(stops) = around.between(leader, &from, &leg.far) else {
                self.stops.truncate(left);
                return false;
            };
            stops.into_iter().for_each(|pose| self.stop(pose, true));
            self.lifts += 1;
        }
        self.stop(leg.far, true);
        self.stop(leg.near, true);
        self.came = Some((self.stops.len(), leg));
        true
    }

    /// Leaves the surface and returns the outer pose; `None` if nothing was touched yet. Where the leg from the
    /// last cutter location is not proved, the tool first goes back along the earlier ones, hops included, at
    /// most to the last one that was approached from outside.
    fn leave(&mut self, leader: &mut PathPlanner<'_>, around: &RetractSphere) -> Option<Pose> {
        let (first, came) = self.came?;
        let mut at = self.stops.len() - 1;
        let leg = loop {
            if at == first {
                break came;
            }
            if let Some(leg) = around.leg(leader, &self.stops[at].0) {
                break leg;
            }
            at -= 1;
            self.stop(self.stops[at].0, false);
        };
        self.stop(leg.near, false);
        self.stop(leg.far, true);
        Some(leg.far)
    }

    fn end(
        mut self,
        leader: &mut PathPlanner<'_>,
        around: &RetractSphere,
    ) -> Result<ToolPath, PathError> {
        self.leave(leader, around).ok_or(PathError::NoPosture)?;
        let steps = self.steps.max(1) as f64;
        let places = self.places - self.dropped;
        Ok(ToolPath {
            contact_points: places,
            left_out: self.seen - places,
            retracts: self.lifts,
            turns: self.turned.map(|turned| (turned / steps).sqrt()),
            locations: self.stops,
        })
    }
}
