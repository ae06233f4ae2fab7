//! The spindle: how it turns during a motion.

use super::{Control, Motion};
use crate::gcode::block::Block;
use crate::gcode::rules::{Choice, Rule};

/// The spindle during a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spindle {
    /// The program has not said yet whether it turns.
    NotStated,
    /// It stands: before M3 or M4, after M5, M19, M6 or a stop that stops it, or at S0.
    Stopped,
    /// M3 or M4 is in force, and the program has given no speed S.
    WithoutSpeed,
    /// It turns clockwise, seen from the spindle (M3).
    Clockwise,
    /// It turns counter-clockwise (M4).
    CounterClockwise,
    /// A tapping cycle turns it, which states no pitch.
    Tapping,
    /// A cycle that taps a right-hand thread turns it.
    RightTap,
    /// A cycle that taps a left-hand thread turns it.
    LeftTap,
    /// A tapping cycle has ended, which leaves it standing or turning, by the control and by rigid tapping.
    AfterTapping,
}

/// The hand of a thread that is tapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gcode) enum Thread {
    Right,
    Left,
}

impl Thread {
    /// Returns the hand that the sign of a pitch states; `None` for 0.
    pub(in crate::gcode) fn of_pitch(pitch: f64) -> Option<Thread> {
        match pitch {
            _ if pitch > 0.0 => Some(Thread::Right),
            _ if pitch < 0.0 => Some(Thread::Left),
            _ => None,
        }
    }
}

/// The turn of the spindle in a tapping cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gcode) enum TapTurn {
    /// The cycle turns it into a thread, if it states its pitch.
    OfCycle(Option<Thread>),
    /// It turns as before the cycle, which has a floating holder.
    OfSpindle,
}

/// The words of the program about the spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpindleWords {
    /// The last word, without regard to the speed.
    pub(super) turn: Spindle,
    pub(super) speed: Option<f64>,
    /// Set from a stop on, until the next word about the spindle.
    pub(super) paused: bool,
    /// Set by M29: the tapping cycles after it turn the spindle themselves.
    pub(super) rigid: bool,
    /// The thread of the tapping cycle that left the spindle, and found it turning.
    pub(super) tapping: Option<Thread>,
}

impl SpindleWords {
    pub(super) fn new() -> SpindleWords {
        SpindleWords {
            turn: Spindle::NotStated,
            speed: None,
            paused: false,
            rigid: false,
            tapping: None,
        }
    }
}

impl Control {
    /// Reads S and the words of the spindle, and returns the word that changes whether and how it turns, if there is one.
    pub(super) fn spindle_words(&mut self, block: &mut Block) -> Option<String> {
        let before = self.spindle;
        let mut word = None;
        if let Some(speed) = block.take('S') {
            self.spindle.speed = Some(speed);
            // From one speed to another it turns on. S0 stops it, and S after that starts it.
            let stood = before.speed.is_none_or(|speed| speed == 0.0);
            let is_on = matches!(before.turn, Spindle::Clockwise | Spindle::CounterClockwise);
            word = (is_on && stood != (speed == 0.0)).then(|| "S".to_owned());
        }
        let dialect = self.stated(Rule::Dialect);
        let stops_at_m89 =
            matches!(dialect, None | Some(Choice::Iso)) && self.spindle.turn != Spindle::NotStated;
        for code in &block.passed_over {
            let turn = match (code.letter, code.tenths) {
                ('M', 30) => Spindle::Clockwise,
                ('M', 40) => Spindle::CounterClockwise,
                ('M', 50 | 190) => {
                    self.spindle.rigid = false;
                    Spindle::Stopped
                }
                // Haas stops it before M89 (coolant through the spindle off), and does not start it again.
                ('M', 890) if !stops_at_m89 => continue,
                ('M', 890) => Spindle::Stopped,
                ('M', 290) => {
                    self.spindle.rigid = true;
                    continue;
                }
                _ => continue,
            };
            (self.spindle.turn, self.spindle.paused) = (turn, false);
            self.spindle.tapping = None;
            if (turn, false) != (before.turn, before.paused) {
                word = Some(code.to_string());
            }
        }
        word
    }

    /// Notes a stop of the program (M0, M1).
    pub(in crate::gcode) fn pause_spindle(&mut self) {
        self.spindle.paused = true;
    }

    /// Returns whether a tapping cycle finds the spindle as it needs it: turning into its thread, unless the cycle turns it itself
    /// (M29), or the same cycle was before.
    pub(super) fn can_tap(&mut self, thread: Thread) -> bool {
        self.spindle.rigid || self.thread_of_spindle() == Some(thread)
    }

    /// Returns the thread that the spindle taps as it turns, or as it did before the same cycle.
    fn thread_of_spindle(&mut self) -> Option<Thread> {
        match self.spindle(false) {
            Spindle::Clockwise => Some(Thread::Right),
            Spindle::CounterClockwise => Some(Thread::Left),
            Spindle::AfterTapping => self.spindle.tapping,
            _ => None,
        }
    }

    /// Returns the motion of a stroke of a tap. A cycle that does not turn the spindle feeds where that does not tap.
    pub(super) fn tapping_motion(&mut self, turn: TapTurn) -> Option<Motion> {
        match turn {
            TapTurn::OfCycle(thread) => Some(Motion::Tap(thread)),
            TapTurn::OfSpindle => match self.thread_of_spindle() {
                None => Some(Motion::Feed),
                thread => Some(Motion::Tap(thread)),
            },
        }
    }

    /// Notes the end of a tapping cycle, which leaves the spindle standing or turning.
    pub(super) fn end_tapping(&mut self, thread: Option<Thread>) {
        self.spindle.turn = Spindle::AfterTapping;
        self.spindle.tapping = thread.filter(|_| !self.spindle.rigid);
    }

    /// Stops the spindle for a tool change. It stays unstated if it was.
    pub(super) fn stop_spindle(&mut self) {
        self.spindle.rigid = false;
        self.spindle.tapping = None;
        // A program that leaves the spindle to the operator does so after the change, too.
        if self.spindle.turn != Spindle::NotStated {
            self.spindle.turn = Spindle::Stopped;
        }
    }

    /// Returns the spindle for a motion at feed rate or in rapid traverse.
    pub(super) fn spindle(&mut self, rapid: bool) -> Spindle {
        if matches!(
            self.spindle.turn,
            Spindle::NotStated | Spindle::Stopped | Spindle::AfterTapping
        ) {
            return self.spindle.turn;
        }
        // The state after the stop matters at the next feed, and the rule is asked there only.
        if self.spindle.paused && !rapid {
            self.spindle.paused = false;
            if self.choice(Rule::Stop) == Choice::StopsSpindle {
                self.spindle.turn = Spindle::Stopped;
                return Spindle::Stopped;
            }
        }
        match self.spindle.speed {
            None => Spindle::WithoutSpeed,
            Some(0.0) => Spindle::Stopped,
            Some(_) => self.spindle.turn,
        }
    }
}
