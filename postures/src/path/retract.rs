//! Moves off the surface, around the part, and back.

use super::PathPlanner;
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_3;
use touchoff::{Mesh, Pose};

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
pub(super) struct RetractLeg {
    pub(super) lead_end: Pose,
    pub(super) outer: Pose,
}

/// Returns directions on a great circle from one to another, at most 60 degrees apart, both ends included.
fn around(first: Vector3<f64>, last: Vector3<f64>) -> Vec<Vector3<f64>> {
    let turn = first.angle(&last);
    let axis = Unit::try_new(first.cross(&last), 1e-9)
        .or_else(|| Unit::try_new(first.cross(&Vector3::x()), 1e-3))
        .unwrap_or_else(Vector3::y_axis);
    let segments = (turn / FRAC_PI_3).ceil().max(1.0);
    let direction =
        |k: usize| nalgebra::Rotation3::from_axis_angle(&axis, turn * k as f64 / segments) * first;
    (0..=segments as usize).map(direction).collect()
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
    pub(super) fn retracted(&self, pose: &Pose) -> Option<Pose> {
        pose.translated(pose.axis() * self.lead).ok()
    }

    /// Returns the move off the surface from a posture, if it is proved.
    pub(super) fn leg(&self, planner: &mut PathPlanner<'_>, pose: &Pose) -> Option<RetractLeg> {
        let (from, axis) = (pose.tip() - self.centre, pose.axis());
        // Distance along the axis at which a ray from inside leaves the sphere.
        let height = from.dot(&axis);
        let exit =
            (height * height + self.radius * self.radius - from.norm_squared()).sqrt() - height;
        let lead_end = pose.translated(axis * self.lead.min(0.5 * exit)).ok()?;
        let outer = pose.translated(axis * exit).ok()?;
        (planner.is_clear(pose, &lead_end) && planner.is_clear(&lead_end, &outer))
            .then_some(RetractLeg { lead_end, outer })
    }

    /// Returns the poses between two poses on the sphere, without these: upright, around, and over to the
    /// second axis. Where the outward direction exceeds the largest tilt, the axis stays at that tilt, and the way
    /// leads over the top. Returns `None` if a motion is not proved.
    pub(super) fn between(
        &self,
        planner: &mut PathPlanner<'_>,
        from: &Pose,
        to: &Pose,
    ) -> Option<Vec<Pose>> {
        let [first, last] = [from, to].map(|pose| (pose.tip() - self.centre) / self.radius);
        let mut directions = around(first, last);
        if !directions.iter().all(|direction| planner.tilt.allows(direction)) {
            let top = Vector3::z();
            directions = around(first, top);
            directions.extend(around(top, last).into_iter().skip(1));
        }
        let upright = |direction: &Vector3<f64>| {
            let tip = self.centre + direction * self.radius;
            Pose::from_axis(tip, planner.tilt.clamped(direction)).ok()
        };
        let poses: Vec<Pose> = directions.iter().map(upright).collect::<Option<_>>()?;
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
