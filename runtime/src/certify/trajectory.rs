//! Trajectories: any smooth path of the tool's pose, in intervals of time on which motions at constant speed are close to it.

use crate::motion::Motion;
use crate::pose::Pose;

/// The poses of a tool over time, from 0 to 1. Lengths are in the part's unit.
///
/// A query about a motion halves its time until bounds on an interval decide. On each interval it takes the motion at
/// constant speed between both ends in place of the trajectory, and adds how far that may be from it: a tool that comes
/// nowhere near the part, or that is deep in it, is decided on long intervals, where the two differ by much. [`Motion`] is
/// a trajectory that does not differ from its own.
pub trait Trajectory {
    /// Returns the pose at a time.
    fn pose(&self, at: f64) -> Pose;

    /// Approximates the trajectory between two times, or returns `None` if they are too far apart.
    ///
    /// At any time between them, each point of the tool's frame within `reach` of the tip is at most
    /// [`Approximation::deviation`] from where the trajectory has it; the spin of a tool of revolution does not count.
    /// With shorter intervals the deviation decreases to [`Trajectory::error`].
    fn approximation(&self, times: [f64; 2], reach: f64) -> Option<Approximation>;

    /// Returns an upper bound on the distance of any point of the tool from its place in the motion that is meant: the
    /// error of the poses.
    fn error(&self) -> f64;

    /// Returns an upper bound on the speed of points within `reach` of the tip, per unit of time.
    fn max_speed(&self, reach: f64) -> f64;

    /// Returns whether the poses include the spin about the tool axis, which a solid without an axis needs.
    fn has_spin(&self) -> bool;
}

/// A motion at constant speed in place of a trajectory on an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approximation {
    /// The motion.
    pub motion: Motion,
    /// The times of the motion at both ends of the interval.
    pub times: [f64; 2],
    /// Upper bound on the distance between the places of a point in both, in the part's unit.
    pub deviation: f64,
}

impl Trajectory for Motion {
    fn pose(&self, at: f64) -> Pose {
        self.pose(at)
    }

    fn approximation(&self, times: [f64; 2], _reach: f64) -> Option<Approximation> {
        Some(Approximation { motion: *self, times, deviation: 0.0 })
    }

    fn error(&self) -> f64 {
        0.0
    }

    fn max_speed(&self, reach: f64) -> f64 {
        self.displacement().norm() + self.angle() * reach
    }

    fn has_spin(&self) -> bool {
        self.has_spin()
    }
}
