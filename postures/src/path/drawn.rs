//! Joining of runs to one path: along the surface, or off it and back.

use super::axes::{PathPosture, PostureRun};
use super::retract::{RetractLeg, RetractSphere};
use super::{LeftOut, LeftOutReason, PathError, PathPlanner, ToolPath};
use nalgebra::Point3;
use touchoff::Pose;

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

    /// Returns the last posture on the surface.
    pub(super) fn last(&self) -> Option<&PathPosture> {
        self.last.as_ref()
    }

    fn push_location(&mut self, pose: Pose, rapid: bool) {
        self.locations.push((pose, rapid));
    }

    fn push_rapids(&mut self, poses: &[Pose]) {
        poses.iter().for_each(|pose| self.push_location(*pose, true));
    }

    /// Moves to a run and along it. Two points that cannot be joined on the surface are joined off it; a point that
    /// cannot be joined at all is dropped.
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

    /// Moves to a posture off the surface. Does nothing and returns `false` if no way is proved.
    fn hop(
        &mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
        posture: &PathPosture,
    ) -> bool {
        let Some(last) = &self.last else { return false };
        let Some(locations) = sphere.link(planner, &last.pose, &posture.pose) else {
            return false;
        };
        self.locations.extend(locations);
        self.retracts += 1;
        true
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
            let Some(way) = sphere.way(planner, &from, &leg.outer) else {
                // The way out leads nowhere, so the tool stays where it was.
                self.locations.truncate(location_count);
                return false;
            };
            self.push_rapids(&way[1..]);
            self.retracts += 1;
        } else {
            // The machine comes from above, so that the first approach is proved from there on.
            let way = sphere.top().and_then(|top| sphere.way(planner, &top, &leg.outer));
            self.push_rapids(&way.unwrap_or_else(|| vec![leg.outer]));
        }
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

    /// Leaves the part, and ends above it if the way there is proved.
    pub(super) fn end(
        mut self,
        planner: &mut PathPlanner<'_>,
        sphere: &RetractSphere,
    ) -> Result<ToolPath, PathError> {
        let outer = self.leave(planner, sphere).ok_or(PathError::NoPosture)?;
        if let Some(way) = sphere.top().and_then(|top| sphere.way(planner, &outer, &top)) {
            self.push_rapids(&way[1..]);
        }
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
