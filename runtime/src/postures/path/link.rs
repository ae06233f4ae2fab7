//! Ways off the surface, around the part, and back.

use super::Leader;
use crate::mesh::Mesh;
use crate::pose::Pose;
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_3;

/// A sphere about the part, twice as large as what holds the tips of all tools that touch it: a tool that went
/// there along its axis has that within 30 degrees of the way out, and all of the part below its tip.
pub(super) struct Around {
    centre: Point3<f64>,
    radius: f64,
    /// How far from a surface feed goes over into rapid traverse.
    lead: f64,
}

/// A way off the surface along the tool's axis: a little in feed, and out to the sphere.
#[derive(Clone, Copy)]
pub(super) struct Leg {
    pub(super) near: Pose,
    pub(super) far: Pose,
}

/// So far feed goes off the surface, as a part of the part's size.
const LEAD: f64 = 1.0 / 32.0;

impl Around {
    /// `reach` is how far from its tip the tool touches.
    pub(super) fn new(mesh: &Mesh, reach: f64) -> Around {
        let [low, high] = mesh.bounds();
        let half = 0.5 * (high - low).norm();
        Around { centre: low + 0.5 * (high - low), radius: 2.0 * (half + reach), lead: LEAD * half }
    }

    /// A little off the surface, along the axis.
    pub(super) fn lifted(&self, pose: &Pose) -> Option<Pose> {
        pose.shifted(pose.axis() * self.lead).ok()
    }

    /// The way off from a posture, if it is proved.
    pub(super) fn leg(&self, leader: &mut Leader<'_>, pose: &Pose) -> Option<Leg> {
        let (from, axis) = (pose.tip() - self.centre, pose.axis());
        // Where a ray from inside leaves the sphere.
        let along = from.dot(&axis);
        let out = (along * along + self.radius * self.radius - from.norm_squared()).sqrt() - along;
        let near = pose.shifted(axis * self.lead.min(0.5 * out)).ok()?;
        let far = pose.shifted(axis * out).ok()?;
        (leader.goes(pose, &near) && leader.goes(&near, &far)).then_some(Leg { near, far })
    }

    /// From one place on the sphere to another: upright, around, and over to the other's axis; without the
    /// first and the last. `None` where that is not proved.
    pub(super) fn between(
        &self,
        leader: &mut Leader<'_>,
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
