//! Plausibility filter for device poses.

use super::DeviceError;
use super::frame::{Frame, halves};
use crate::pose::Pose;

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
    On(Pose),
    /// A pose at which the motion begins, or begins again after a jump.
    Anew(Pose),
    /// No usable pose; the last good one is held.
    Held,
}

/// A filter that holds the last good pose until there is another.
pub(super) struct InputFilter {
    fastest: SpeedLimit,
    period: f64,
    last: Option<Pose>,
    /// A pose too far from the last one, and the number of cycles that the device has stayed near it.
    elsewhere: Option<(Pose, u64)>,
    pub(super) faults: DeviceFaults,
}

/// Time that a device must stay near a pose after a jump before the pose is accepted, s.
const SETTLED: f64 = 0.05;

impl InputFilter {
    pub(super) fn new(fastest: SpeedLimit, period: f64) -> InputFilter {
        InputFilter {
            fastest,
            period,
            last: None,
            elsewhere: None,
            faults: DeviceFaults::default(),
        }
    }

    pub(super) fn take(&mut self, said: Result<Pose, DeviceError>, frame: &Frame) -> FilteredInput {
        let pose = match said {
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
        let Some(last) = self.last else {
            self.last = Some(pose);
            return FilteredInput::Anew(pose);
        };
        if self.near(&last, &pose, frame) {
            self.last = Some(pose);
            self.elsewhere = None;
            return FilteredInput::On(pose);
        }
        self.faults.jumps += 1;
        let stayed = match &self.elsewhere {
            Some((there, stayed)) if self.near(there, &pose, frame) => stayed + 1,
            _ => 0,
        };
        self.elsewhere = Some((pose, stayed));
        if stayed as f64 * self.period < SETTLED {
            return FilteredInput::Held;
        }
        self.last = Some(pose);
        self.elsewhere = None;
        FilteredInput::Anew(pose)
    }

    fn near(&self, from: &Pose, to: &Pose, frame: &Frame) -> bool {
        let [way, turn] = halves(&frame.between(from, to)).map(|part| part.norm());
        way <= self.fastest.linear * self.period && turn <= self.fastest.angular * self.period
    }
}
