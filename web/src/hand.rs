//! A device whose pose follows a target that is set once per frame.

use crate::error::EngineError;
use nalgebra::Point3;
use touchoff::tool::Symmetry;
use touchoff::{Motion, Pose};
use touchoff_haptics::{Device, DeviceError, DeviceLimits, DeviceWrench};

/// Greatest distance in mm and angle in rad per cycle: half of the speed that a session takes for plausible at 1 kHz.
const MAX_STEP: [f64; 2] = [5.0, 0.05];

/// A device that moves from its pose to a target in a number of cycles, and stays there.
#[derive(Debug)]
pub(crate) struct Hand {
    pose: Pose,
    target: Pose,
    motion: Option<Motion>,
    /// The cycles since the target was set, and those that the motion takes.
    cycle: f64,
    cycles: f64,
    limits: DeviceLimits,
}

impl Hand {
    pub(crate) fn new(pose: Pose, limits: DeviceLimits) -> Hand {
        Hand { pose, target: pose, motion: None, cycle: 0.0, cycles: 0.0, limits }
    }

    /// Sets the target, to be reached in `cycles` cycles, or in more if that were too fast for a hand. `unit` is the
    /// length of the part's unit in mm.
    pub(crate) fn move_to(&mut self, target: Pose, cycles: f64, symmetry: Symmetry, unit: f64) {
        let motion = match symmetry {
            Symmetry::Revolved => Motion::new(&self.pose, &target),
            Symmetry::Solid { .. } => Motion::with_spin(&self.pose, &target),
        };
        // An ambiguous rotation is a jump, which the session accepts once the hand stays.
        self.motion = motion.ok();
        let distance = (target.tip() - self.pose.tip()).norm() * unit;
        let turn = self.pose.rotation().transpose() * target.rotation();
        let angle = ((turn.trace() - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
        let [longest, widest] = MAX_STEP;
        self.cycles = cycles.max(distance / longest).max(angle / widest);
        self.cycle = 0.0;
        self.target = target;
    }

    pub(crate) fn limits(&self) -> DeviceLimits {
        self.limits
    }
}

impl Device for Hand {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        self.cycle += 1.0;
        self.pose = match &self.motion {
            Some(motion) if self.cycle < self.cycles => motion.pose(self.cycle / self.cycles),
            _ => self.target,
        };
        Ok(self.pose)
    }

    fn apply(&mut self, _: &DeviceWrench) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }
}

/// Returns the pose of seven values: the tip, and a quaternion x, y, z, w.
///
/// # Errors
/// Fails for another number of values, and if they are no pose.
pub(crate) fn pose(values: &[f64]) -> Result<Pose, EngineError> {
    let values: [f64; 7] = values.try_into().map_err(|_| EngineError::PoseLength(values.len()))?;
    let [x, y, z, rotation @ ..] = values;
    Ok(Pose::from_quaternion(Point3::new(x, y, z), rotation)?)
}
