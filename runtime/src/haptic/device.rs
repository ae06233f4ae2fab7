//! What a hand holds.

use crate::motion::{Motion, MotionError};
use crate::pose::{Pose, PoseError};
use nalgebra::Vector3;

/// A force in N and a torque in N·mm about the tool's compliance centre, in the world's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// The force.
    pub force: Vector3<f64>,
    /// The torque.
    pub torque: Vector3<f64>,
}

impl Push {
    /// The same, so much as large.
    #[must_use]
    pub fn scaled(&self, by: f64) -> Push {
        Push { force: self.force * by, torque: self.torque * by }
    }

    /// Both together.
    #[must_use]
    pub fn and(&self, other: &Push) -> Push {
        Push { force: self.force + other.force, torque: self.torque + other.torque }
    }
}

/// What turns a device knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Where the tip is and how the axis stands; the spin is neither known nor pushed.
    Five,
    /// All.
    Six,
}

/// What a device can do to a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Which turns it knows.
    pub axes: Axes,
    /// The largest force, N.
    pub force: f64,
    /// The largest torque, N·mm.
    pub torque: f64,
    /// The stiffest spring that it can render to a hand without shaking, N/mm.
    pub stiffness: f64,
    /// The same against turning, N·mm/rad.
    pub turning: f64,
}

/// A desktop device of middling strength.
impl Default for Limits {
    fn default() -> Limits {
        Limits { axes: Axes::Five, force: 8.0, torque: 200.0, stiffness: 1.0, turning: 1000.0 }
    }
}

/// A device could not say where it is, or could not push.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// What it said is no pose.
    #[error("the device says that it is nowhere: {0}")]
    Pose(#[from] PoseError),
    /// It does not answer; it may again.
    #[error("the device does not answer: {0}")]
    Gone(std::io::Error),
    /// There is nothing left to play.
    #[error("the device has played all it had")]
    Ended,
}

/// A haptic device: says where the hand wants the tool, and pushes the hand. Both are called once a cycle
/// in the loop, where nothing may wait: what has no news says again what it said last.
pub trait Device {
    /// Where the tool is wanted, in the world and the part's unit.
    ///
    /// # Errors
    /// If the device does not know. The loop holds on to the pose before, and asks again.
    fn pose(&mut self) -> Result<Pose, DeviceError>;

    /// Pushes the hand from now on.
    ///
    /// # Errors
    /// If the device cannot. The loop goes on.
    fn push(&mut self, push: &Push) -> Result<(), DeviceError>;

    /// What it can do.
    fn limits(&self) -> Limits;
}

/// Poses one after another, as a function says; pushes nobody.
pub struct Scripted<F> {
    script: F,
    limits: Limits,
    cycle: u64,
}

impl<F: FnMut(u64) -> Result<Pose, DeviceError>> Scripted<F> {
    /// The pose of each cycle, counted from 0.
    pub fn new(limits: Limits, script: F) -> Scripted<F> {
        Scripted { script, limits, cycle: 0 }
    }
}

impl<F: FnMut(u64) -> Result<Pose, DeviceError>> Device for Scripted<F> {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let cycle = self.cycle;
        self.cycle += 1;
        (self.script)(cycle)
    }

    fn push(&mut self, _: &Push) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> Limits {
        self.limits
    }
}

/// A path that was recorded or programmed, played once from its first pose to its last.
pub struct Recorded {
    poses: Vec<Pose>,
    motions: Vec<Motion>,
    /// Poses of the path a cycle.
    pace: f64,
    limits: Limits,
    cycle: u64,
}

impl Recorded {
    /// A path that lasts so many cycles; as many cycles come between any two poses that follow each other. Full
    /// poses are played as they are given, without what is between.
    ///
    /// # Errors
    /// If between two poses the axis turns to its opposite.
    pub fn new(poses: Vec<Pose>, cycles: u64, limits: Limits) -> Result<Recorded, MotionError> {
        let full = poses.iter().all(Pose::is_full);
        let motions = match full {
            true => Vec::new(),
            false => {
                let pairs = poses.windows(2);
                pairs.map(|pair| Motion::new(&pair[0], &pair[1])).collect::<Result<_, _>>()?
            }
        };
        let pace = poses.len().saturating_sub(1) as f64 / cycles.max(1) as f64;
        Ok(Recorded { poses, motions, pace, limits, cycle: 0 })
    }
}

impl Device for Recorded {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let at = self.cycle as f64 * self.pace;
        let place = at as usize;
        self.cycle += 1;
        if at > self.poses.len().saturating_sub(1) as f64 {
            return Err(DeviceError::Ended);
        }
        match self.motions.get(place) {
            Some(motion) => Ok(motion.pose(at - place as f64)),
            None => self.poses.get(place).copied().ok_or(DeviceError::Ended),
        }
    }

    fn push(&mut self, _: &Push) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> Limits {
        self.limits
    }
}
