//! Haptic devices: the trait, force and torque limits, and devices that play back poses.

use super::setting::{SettingError, above_zero};
use nalgebra::Vector3;
use std::fmt;
use touchoff::{Motion, MotionError, Pose, PoseError};

/// A force in N and a torque in N·mm about the tool's compliance centre, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceWrench {
    /// The force, N.
    pub force: Vector3<f64>,
    /// The torque, N·mm.
    pub torque: Vector3<f64>,
}

impl DeviceWrench {
    /// Returns the wrench multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, by: f64) -> DeviceWrench {
        DeviceWrench { force: self.force * by, torque: self.torque * by }
    }

    /// Returns the sum of two wrenches.
    #[must_use]
    pub fn and(&self, other: &DeviceWrench) -> DeviceWrench {
        DeviceWrench { force: self.force + other.force, torque: self.torque + other.torque }
    }
}

/// The rotational degrees of freedom of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceAxes {
    /// The tip's position and the axis's direction; spin is neither measured nor driven.
    Five,
    /// All rotations.
    Six,
}

/// Force, torque and stiffness limits of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceLimits {
    /// The rotational degrees of freedom.
    pub axes: DeviceAxes,
    /// The largest force, N.
    pub force: f64,
    /// The largest torque, N·mm.
    pub torque: f64,
    /// The largest stiffness that the device can render without instability, N/mm.
    pub stiffness: f64,
    /// The largest rotational stiffness that the device can render, N·mm/rad.
    pub turning_stiffness: f64,
}

impl DeviceLimits {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        above_zero("largest force of the device in N", self.force)?;
        above_zero("largest torque of the device in N·mm", self.torque)?;
        above_zero("stiffness of the device in N/mm", self.stiffness)?;
        above_zero("rotational stiffness of the device in N·mm/rad", self.turning_stiffness)
    }
}

/// Values of a desktop device of medium strength.
impl Default for DeviceLimits {
    fn default() -> DeviceLimits {
        DeviceLimits {
            axes: DeviceAxes::Five,
            force: 8.0,
            torque: 200.0,
            stiffness: 1.0,
            turning_stiffness: 1000.0,
        }
    }
}

/// Reasons why a device could not report its pose or apply a wrench.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// The reported data is not a valid pose.
    #[error("the device reports an invalid pose: {0}")]
    Pose(#[from] PoseError),
    /// The device does not answer at the moment.
    #[error("the device does not answer: {0}")]
    NotResponding(std::io::Error),
    /// The recorded poses have all been played.
    #[error("the device has played all it had")]
    Ended,
}

touchoff::debug_as_sentence!(DeviceError);

/// A haptic device: reports the tool pose that the hand commands, and applies a wrench to the hand. The loop calls both
/// functions once per cycle, so neither may block: a device without new data returns the previous pose.
pub trait Device {
    /// Returns the commanded tool pose, in the world frame and the part's unit.
    ///
    /// # Errors
    /// Fails if the device does not know the pose. The loop keeps the previous pose and asks again.
    fn pose(&mut self) -> Result<Pose, DeviceError>;

    /// Applies a wrench to the hand until the next call.
    ///
    /// # Errors
    /// Fails if the device cannot apply the wrench. The loop continues, and counts the work of the wrench before, which goes on
    /// to act.
    fn apply(&mut self, wrench: &DeviceWrench) -> Result<(), DeviceError>;

    /// Returns the limits of the device.
    fn limits(&self) -> DeviceLimits;
}

/// A device that reports poses computed by a function and ignores wrenches.
pub struct ScriptedDevice<F> {
    script: F,
    limits: DeviceLimits,
    cycle: u64,
}

impl<F> fmt::Debug for ScriptedDevice<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ScriptedDevice")
            .field("cycle", &self.cycle)
            .field("limits", &self.limits)
            .finish_non_exhaustive()
    }
}

impl<F: FnMut(u64) -> Result<Pose, DeviceError>> ScriptedDevice<F> {
    /// Creates a device whose pose in each cycle, counted from 0, is computed by `script`.
    pub fn new(limits: DeviceLimits, script: F) -> ScriptedDevice<F> {
        ScriptedDevice { script, limits, cycle: 0 }
    }
}

impl<F: FnMut(u64) -> Result<Pose, DeviceError>> Device for ScriptedDevice<F> {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let cycle = self.cycle;
        self.cycle += 1;
        (self.script)(cycle)
    }

    fn apply(&mut self, _: &DeviceWrench) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }
}

/// A device that plays a recorded or programmed path once, from its first pose to its last.
#[derive(Clone, Debug)]
pub struct PlaybackDevice {
    poses: Vec<Pose>,
    motions: Vec<Motion>,
    /// Poses of the path per cycle.
    poses_per_cycle: f64,
    limits: DeviceLimits,
    cycle: u64,
}

impl PlaybackDevice {
    /// Creates a device that plays a path in `cycles` cycles, with the same number of cycles between any
    /// two successive poses. If all poses have a spin, they are played as given, without interpolation.
    ///
    /// # Errors
    /// Fails if poses are interpolated and the axes of two successive poses are antiparallel.
    pub fn new(
        poses: Vec<Pose>,
        cycles: u64,
        limits: DeviceLimits,
    ) -> Result<PlaybackDevice, MotionError> {
        // Interpolation would choose the spins between poses that have none, and lose those that poses have.
        let all_have_spin = poses.iter().all(Pose::has_spin);
        let motions = match all_have_spin {
            true => Vec::new(),
            false => {
                let pairs = poses.windows(2);
                pairs.map(|pair| Motion::new(&pair[0], &pair[1])).collect::<Result<_, _>>()?
            }
        };
        let poses_per_cycle = poses.len().saturating_sub(1) as f64 / cycles.max(1) as f64;
        Ok(PlaybackDevice { poses, motions, poses_per_cycle, limits, cycle: 0 })
    }
}

impl Device for PlaybackDevice {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        // A product instead of a running sum, whose rounding would add up.
        let position = self.cycle as f64 * self.poses_per_cycle;
        let index = position as usize;
        self.cycle += 1;
        if position > self.poses.len().saturating_sub(1) as f64 {
            return Err(DeviceError::Ended);
        }
        match self.motions.get(index) {
            Some(motion) => Ok(motion.pose(position - index as f64)),
            None => self.poses.get(index).copied().ok_or(DeviceError::Ended),
        }
    }

    fn apply(&mut self, _: &DeviceWrench) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }
}
