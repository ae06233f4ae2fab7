//! Joining of runs to one path: along the surface, or off it, around the part, and back.

use super::axes::{PathPosture, PostureRun};
use super::{LeftOut, LeftOutReason, PathError, PathPlanner, ToolPath};
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_3;
use touchoff::{Mesh, Pose};

/// A path under construction.
#[derive(Default)]
pub(super) struct DrawnPath {
    locations: Vec<(Pose, bool)>,
    /// The last approach from outside: the index of its cutter location on the surface, and its leg.
    last_approach: Option<(usize, RetractLeg)>,
    /// The last posture on the surface.
    last: Option<PathPosture>,
    contact_points: usize,
    left_out: Vec<LeftOut>,
    retracts: usize,
    steps: usize,
    squared_turns: [f64; 2],
}

impl DrawnPath {
    /// Leaves out points that the tool does not reach.
    pub(super) fn leave_out(&mut self, unreached: Vec<Point3<f64>>) {
        let reason = LeftOutReason::NotReached;
        self.left_out.extend(unreached.into_iter().map(|point| LeftOut { point, reason }));
    }

    pub(super) fn count(&mut self, run: &PostureRun) {
        self.contact_points += run.postures.len();
        self.steps += run.postures.len() - 1;
        self.squared_turns[0] += run.squared_turns;
        self.squared_turns[1] += run.turns();
    }

    /// Returns the index of the run with the nearest end, and whether that is its last posture.
    pub(super) fn nearest(&self, runs: &[PostureRun]) -> Option<(usize, bool)> {
        let ends = runs.iter().enumerate().filter_map(|(index, run)| {
            let (first, last) = (run.postures.first()?, run.postures.last()?);
            Some([(self.distance_to(first), index, false), (self.distance_to(last), index, true)])
        });
        let nearest = ends.flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, index, reverse)| (index, reverse))
    }

    /// Returns the distance of the tip from the last posture to another; 0 for the first.
    fn distance_to(&self, posture: &PathPosture) -> f64 {
        self.last.as_ref().map_or(0.0, |last| (posture.pose.tip() - last.pose.tip()).norm())
    }

    fn push_location(&mut self, pose: Pose, rapid: bool) {
        self.locations.push((pose, rapid));
    }

    /// Moves to a run and along it. Two points that cannot be joined on the surface are joined above it or
    /// around the part; a point that cannot be joined at all is dropped.
    pub(super) fn follow(
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
                let point = posture.surface_point.point;
                self.left_out.push(LeftOut { point, reason: LeftOutReason::NoMotion });
                self.contact_points -= 1;
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
                // The way out leads nowhere, so the tool stays where it was.
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

    pub(super) fn end(
        mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
    ) -> Result<ToolPath, PathError> {
        self.leave(planner, sphere).ok_or(PathError::NoPosture)?;
        let steps = self.steps.max(1) as f64;
        Ok(ToolPath {
            contact_points: self.contact_points,
            left_out: self.left_out,
            retracts: self.retracts,
            turns: self.squared_turns.map(|squared_turns| (squared_turns / steps).sqrt()),
            locations: self.locations,
        })
    }
}

/// A sphere about the part, twice as large as one that holds the tips of all tools that touch the part. A tool
/// that has moved there along its axis has that axis within 30 degrees of the outward direction, and the whole
/// part below its tip.
pub(super) struct RetractSphere {
    centre: Point3<f64>,
    radius: f64,
    /// Distance from a surface at which feed changes to rapid traverse, in the part's unit.
    lead: f64,
}

/// A move off the surface along the tool's axis: a short lead in feed, and then out to the sphere.
#[derive(Clone, Copy)]
struct RetractLeg {
    lead_end: Pose,
    outer: Pose,
}

/// Returns directions on a great circle from one to another, at most 60 degrees apart, both ends included.
fn around(first: Vector3<f64>, last: Vector3<f64>) -> Vec<Vector3<f64>> {
    let turn = first.angle(&last);
    // Between opposite directions any great circle will do, and between equal ones there is no turn.
    let axis = Unit::try_new(first.cross(&last), 1e-9)
        .or_else(|| Unit::try_new(first.cross(&Vector3::x()), 1e-3))
        .unwrap_or_else(Vector3::y_axis);
    // The chord of 60 degrees stays 0.87 radii from the centre, outside the sphere of half the radius that holds the tips.
    let segments = (turn / FRAC_PI_3).ceil().max(1.0);
    let directions = (0..=segments as usize)
        .map(|k| nalgebra::Rotation3::from_axis_angle(&axis, turn * k as f64 / segments) * first);
    directions.collect()
}

/// Length of the lead in feed, as a fraction of half the diagonal of the part's box.
const LEAD: f64 = 1.0 / 32.0;

impl RetractSphere {
    /// Creates the sphere about a mesh. `reach` is the largest distance between the tip and a contact.
    pub(super) fn new(mesh: &Mesh, reach: f64) -> RetractSphere {
        let [low, high] = mesh.bounds();
        let half = 0.5 * (high - low).norm();
        RetractSphere {
            centre: low + 0.5 * (high - low),
            radius: 2.0 * (half + reach),
            lead: LEAD * half,
        }
    }

    /// Returns the pose moved off the surface by the lead, along the axis.
    fn retracted(&self, pose: &Pose) -> Option<Pose> {
        pose.translated(pose.axis() * self.lead).ok()
    }

    /// Returns the move off the surface from a posture, if it is proved.
    fn leg(&self, planner: &mut PathPlanner<'_>, pose: &Pose) -> Option<RetractLeg> {
        let (from, axis) = (pose.tip() - self.centre, pose.axis());
        // Distance along the axis at which a ray from inside leaves the sphere.
        let height = from.dot(&axis);
        let exit =
            (height * height + self.radius * self.radius - from.norm_squared()).sqrt() - height;
        // The lead ends before the sphere, so that both motions have a length.
        let lead_end = pose.translated(axis * self.lead.min(0.5 * exit)).ok()?;
        let outer = pose.translated(axis * exit).ok()?;
        (planner.is_clear(pose, &lead_end) && planner.is_clear(&lead_end, &outer))
            .then_some(RetractLeg { lead_end, outer })
    }

    /// Returns the poses between two poses on the sphere, without these: upright, around, and over to the
    /// second axis. Where the outward direction exceeds the largest tilt, the axis stays at that tilt, and the way
    /// leads over the top. Returns `None` if a motion is not proved.
    fn between(&self, planner: &mut PathPlanner<'_>, from: &Pose, to: &Pose) -> Option<Vec<Pose>> {
        let [first, last] = [from, to].map(|pose| (pose.tip() - self.centre) / self.radius);
        let mut directions = around(first, last);
        if !directions.iter().all(|direction| planner.tilt.allows(direction)) {
            let top = Vector3::z();
            directions = around(first, top);
            directions.extend(around(top, last).into_iter().skip(1));
        }
        let poses = directions.iter().map(|direction| {
            let tip = self.centre + direction * self.radius;
            Pose::from_axis(tip, planner.tilt.clamped(direction)).ok()
        });
        let poses: Vec<Pose> = poses.collect::<Option<_>>()?;
        let mut current = *from;
        for next in poses.iter().chain([to]) {
            if !planner.is_clear(&current, next) {
                return None;
            }
            current = *next;
        }
        Some(poses)
    }
}
