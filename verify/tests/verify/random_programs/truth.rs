//! The truth about a collision: capsules inside the tool, and around it, against boxes.

use super::kinematics::ToolPose;
use nalgebra::Vector3;

/// Depth from which a tool collides for certain, in mm.
const MARGIN: f64 = 0.05;
/// Distance from which it is free for certain, in mm: more than it moves between two samples.
const CLEARANCE: f64 = 3.0;

/// A box in the frame of the part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cuboid {
    pub(crate) centre: Vector3<f64>,
    pub(crate) half: Vector3<f64>,
}

/// The surfaces that must not be in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limited {
    All,
    /// Those that do not cut.
    NotCutting,
}

/// A piece of the axis from the tip, and a distance from it.
struct Capsule {
    from: f64,
    to: f64,
    radius: f64,
}

/// Capsules inside [`Mounted`](crate::oracle::Mounted): a ball of 3 mm, cutting up to 10, a shank, and a nut of 8 mm from 25 to 40.
const INSIDE: [Capsule; 2] =
    [Capsule { from: 3.0, to: 37.0, radius: 3.0 }, Capsule { from: 32.5, to: 32.5, radius: 7.5 }];
/// The same of the surfaces that do not cut.
const NOT_CUTTING: [Capsule; 2] =
    [Capsule { from: 13.0, to: 37.0, radius: 3.0 }, Capsule { from: 32.5, to: 32.5, radius: 7.5 }];
/// Capsules that contain it.
const AROUND: [Capsule; 2] =
    [Capsule { from: 3.0, to: 40.0, radius: 3.0 }, Capsule { from: 25.0, to: 40.0, radius: 8.0 }];

impl Cuboid {
    fn distance(&self, point: Vector3<f64>) -> f64 {
        ((point - self.centre).abs() - self.half).map(|beyond| beyond.max(0.0)).norm()
    }

    /// Returns the depth of a capsule in the box; below 0 its distance from it.
    fn depth(&self, pose: &ToolPose, capsule: &Capsule) -> f64 {
        let [mut low, mut high] = [capsule.from, capsule.to];
        // The distance from a convex body is convex along a line.
        while high - low > 1e-3 {
            let [first, second] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            let [near, far] = [first, second].map(|at| self.distance(pose.tip + at * pose.axis));
            if near <= far { high = second } else { low = first }
        }
        capsule.radius - self.distance(pose.tip + 0.5 * (low + high) * pose.axis)
    }

    /// Returns whether a ball around the box is away from the tool.
    fn is_far(&self, pose: &ToolPose, distance: f64) -> bool {
        let from_tip = self.centre - pose.tip;
        let along = from_tip.dot(&pose.axis).clamp(0.0, 40.0);
        (from_tip - along * pose.axis).norm() > 8.0 + self.half.norm() + distance
    }

    pub(crate) fn collides(&self, pose: &ToolPose, limited: Limited) -> bool {
        let capsules = if limited == Limited::All { &INSIDE } else { &NOT_CUTTING };
        !self.is_far(pose, 0.0) && capsules.iter().any(|capsule| self.depth(pose, capsule) > MARGIN)
    }

    pub(crate) fn is_clear(&self, pose: &ToolPose) -> bool {
        self.is_far(pose, CLEARANCE)
            || AROUND.iter().all(|capsule| self.depth(pose, capsule) < -CLEARANCE)
    }
}
