//! Moves off the surface, around the part, and back.

use super::PathPlanner;
use crate::mesh::Mesh;
use crate::pose::Pose;
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_3;

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
    pub(super) near: Pose,
    pub(super) far: Pose,
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
    pub(super) fn lifted(&self, pose: &Pose) -> Option<Pose> {
        pose.translated(pose.axis() * self.lead).ok()
    }

    /// Returns the move off the surface from a posture, if it is proved.
    pub(super) fn leg(&self, leader: &mut PathPlanner<'_>, pose: &Pose) -> Option<RetractLeg> {
        let (from, axis) = (pose.tip() - self.centre, pose.axis());
        // Distance along the axis at which a ray from inside leaves the sphere.
        let along = from.dot(&axis);
        let out = (along * along + self.radius * self.radius - from.norm_squared()).sqrt() - along;
        let near = pose.translated(axis * self.lead.min(0.5 * out)).ok()?;
        let far = pose.translated(axis * out).ok()?;
        (leader.goes(pose, &near) && leader.goes(&near, &far)).then_some(RetractLeg { near, far })
    }

    /// Returns the poses between two poses on the sphere, without these: upright, around, and over to the
    /// second axis. Returns `None` if a motion is not proved.
    pub(super) fn between(
        &self,
        leader: &mut PathPlanner<'_>,
        from: &Pose,
        to: &Pose,
    ) -> Option<Vec<Pose>> {
        let [first, last] = [from, to].map(|pose| (pose.tip() - self.centre) / self.radius);
        let turn = first.angle(&last);
        let about = Unit::try_new(first.cross(&last), 1e-9)
            .or_else(|| Unit::try_new(first.cross(&Vector3::x()), 1e-3))
            .unwrap_or_else(Vector3::y_axis);
        let pieces = (turn / FRAC_PI_3).ceil().max(1.0);
        let upright = |k: usize| {
            let part = nalgebra::Rotation3::from_axis_angle(&about, turn * k as f64 / pieces);
            let way = part * first;
            Pose::from_axis(self.centre + way * self.radius, way).ok()
        };
        let stops: Option<Vec<Pose>> = (0..=pieces as usize).map(upright).collect();
        let stops = stops?;
        let mut at = *from;
        for stop in stops.iter().chain([to]) {
            if !leader.goes(&at, stop) {
                return None;
            }
            at = *stop;
        }
        Some(stops)
    }
}
