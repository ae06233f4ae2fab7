//! What a device says, held to what can be.

use super::DeviceError;
use super::frame::{Frame, halves};
use crate::pose::Pose;

/// How fast a hand may be: what moves faster between two cycles is no hand's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fastest {
    /// Of the compliance centre, mm/s.
    pub way: f64,
    /// rad/s
    pub turn: f64,
}

impl Default for Fastest {
    /// Twice what a hand that strikes reaches: 10 m/s and 100 rad/s.
    fn default() -> Fastest {
        Fastest { way: 1e4, turn: 100.0 }
    }
}

/// How often something was not as it should be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Cycles in which the device said something that is no pose, NaN or an axis without direction.
    pub no_pose: u64,
    /// Cycles in which it was farther away than a hand can get.
    pub jumps: u64,
    /// Cycles in which it did not answer.
    pub gone: u64,
    /// Cycles in which it could not push.
    pub not_pushed: u64,
    /// Whether it has nothing left to play.
    pub ended: bool,
}

/// What came of a pose.
pub(super) enum Taken {
    /// It goes on from the one before.
    On(Pose),
    /// Here the hand begins, or begins again.
    Anew(Pose),
    /// Nothing new; the last good one is held.
    Held,
}

/// Holds the last good pose until there is another.
pub(super) struct Guard {
    fastest: Fastest,
    period: f64,
    last: Option<Pose>,
    /// A pose too far away, and how long the device has stayed about there.
    elsewhere: Option<(Pose, u64)>,
    pub(super) faults: Faults,
}

/// So long a device has to go on from where it jumped to, s.
const SETTLED: f64 = 0.05;

impl Guard {
    pub(super) fn new(fastest: Fastest, period: f64) -> Guard {
        Guard { fastest, period, last: None, elsewhere: None, faults: Faults::default() }
    }

    pub(super) fn take(&mut self, said: Result<Pose, DeviceError>, frame: &Frame) -> Taken {
        let pose = match said {
            Ok(pose) => pose,
            Err(error) => {
                match error {
                    DeviceError::Pose(_) => self.faults.no_pose += 1,
                    DeviceError::Gone(_) => self.faults.gone += 1,
                    DeviceError::Ended => self.faults.ended = true,
                }
                return Taken::Held;
            }
        };
        let Some(last) = self.last else {
            self.last = Some(pose);
            return Taken::Anew(pose);
        };
        if self.near(&last, &pose, frame) {
            self.last = Some(pose);
            self.elsewhere = None;
            return Taken::On(pose);
        }
        self.faults.jumps += 1;
        let stayed = match &self.elsewhere {
            Some((there, stayed)) if self.near(there, &pose, frame) => stayed + 1,
            _ => 0,
        };
        self.elsewhere = Some((pose, stayed));
        if stayed as f64 * self.period < SETTLED {
            return Taken::Held;
        }
        self.last = Some(pose);
        self.elsewhere = None;
        Taken::Anew(pose)
    }

    fn near(&self, from: &Pose, to: &Pose, frame: &Frame) -> bool {
        let [way, turn] = halves(&frame.between(from, to)).map(|part| part.norm());
        way <= self.fastest.way * self.period && turn <= self.fastest.turn * self.period
    }
}
