//! Plausibility filter for device poses.

use super::DeviceError;
use super::frame::{Frame, halves};
use touchoff::Pose;

/// Largest plausible speed of a hand: faster motion between two cycles is treated as a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// Speed of the compliance centre, mm/s.
    pub linear: f64,
    /// Angular speed, rad/s.
    pub angular: f64,
}

impl Default for SpeedLimit {
    /// Returns twice the speed of a striking hand: 10 m/s and 100 rad/s.
    fn default() -> SpeedLimit {
        SpeedLimit { linear: 1e4, angular: 100.0 }
    }
}

/// Counts of device faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceFaults {
    /// Cycles with an invalid pose: NaN, or an axis without direction.
    pub no_pose: u64,
    /// Cycles with a pose farther away than a hand can get.
    pub jumps: u64,
    /// Cycles in which the device did not answer.
    pub not_responding: u64,
    /// Cycles in which the device could not apply the wrench.
    pub failed_writes: u64,
    /// `true` if the device has played all of its poses.
    pub ended: bool,
}

/// The result of filtering a pose.
pub(super) enum FilteredInput {
    /// A pose that continues the motion.
    Continued(Pose),
    /// A pose at which the motion begins, or begins again after a jump.
    Restarted(Pose),
    /// No usable pose; the last good one is held.
    Held,
}

/// A filter that holds the last good pose until there is another.
pub(super) struct InputFilter {
    speed_limit: SpeedLimit,
    period: f64,
    last: Option<Pose>,
    /// A pose too far from the last one, and the number of cycles that the device has stayed near it.
    jumped_to: Option<(Pose, u64)>,
    pub(super) faults: DeviceFaults,
}

/// Time that a device must stay near a pose after a jump before the pose is accepted, s.
const SETTLE_TIME: f64 = 0.05;

impl InputFilter {
    pub(super) fn new(speed_limit: SpeedLimit, period: f64) -> InputFilter {
        InputFilter {
            speed_limit,
            period,
            last: None,
            jumped_to: None,
            faults: DeviceFaults::default(),
        }
    }

    pub(super) fn filter(
        &mut self,
        reading: Result<Pose, DeviceError>,
        frame: &Frame,
    ) -> FilteredInput {
        let pose = match reading {
            Ok(pose) => pose,
            Err(error) => {
                match error {
                    DeviceError::Pose(_) => self.faults.no_pose += 1,
                    DeviceError::NotResponding(_) => self.faults.not_responding += 1,
                    DeviceError::Ended => self.faults.ended = true,
                }
                return FilteredInput::Held;
            }
        };
        // Nothing is known of the first pose that it could be compared with.
        let Some(last) = self.last else {
            self.last = Some(pose);
            return FilteredInput::Restarted(pose);
        };
        if self.is_reachable(&last, &pose, frame) {
            self.last = Some(pose);
            self.jumped_to = None;
            return FilteredInput::Continued(pose);
        }
        self.faults.jumps += 1;
        let cycles = match &self.jumped_to {
            // A device that was moved while it did not answer stays near its new pose; a fault jumps again.
            Some((jumped, cycles)) if self.is_reachable(jumped, &pose, frame) => cycles + 1,
            _ => 0,
        };
        self.jumped_to = Some((pose, cycles));
        if cycles as f64 * self.period < SETTLE_TIME {
            return FilteredInput::Held;
        }
        self.last = Some(pose);
        self.jumped_to = None;
        FilteredInput::Restarted(pose)
    }

    fn is_reachable(&self, from: &Pose, to: &Pose, frame: &Frame) -> bool {
        let [translation, rotation] = halves(&frame.between(from, to)).map(|part| part.norm());
        translation <= self.speed_limit.linear * self.period
            && rotation <= self.speed_limit.angular * self.period
    }
}
