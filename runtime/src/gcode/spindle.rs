//! The spindle.

use super::block::Block;
use super::motion::Control;
use super::rules::{Choice, Rule};

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
    /// A tapping cycle turns it.
    Tapping,
}

/// What the program has said about the spindle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpindleWords {
    /// M3 (`false`) or M4 (`true`), if the spindle is on; `None` before any word.
    on: Option<Option<bool>>,
    speed: Option<f64>,
    /// Set from a stop on, until the next word about the spindle.
    paused: bool,
}

impl Control {
    /// Reads S and the words of the spindle.
    pub(super) fn spindle_words(&mut self, block: &mut Block) {
        if let Some(speed) = block.take('S') {
            self.spindle.speed = Some(speed);
        }
        for code in &block.passed_over {
            let on = match (code.letter, code.tenths) {
                ('M', 30 | 130) => Some(false),
                ('M', 40 | 140) => Some(true),
                ('M', 50 | 190) => None,
                _ => continue,
            };
            (self.spindle.on, self.spindle.paused) = (Some(on), false);
        }
    }

    /// Notes a stop of the program (M0, M1).
    pub(super) fn pause_spindle(&mut self) {
        self.spindle.paused = true;
    }

    /// Stops the spindle for a tool change. It stays unstated if it was.
    pub(super) fn stop_spindle(&mut self) {
        self.spindle.on = self.spindle.on.map(|_| None);
    }

    /// Returns the spindle for a motion at feed rate or in rapid traverse.
    pub(super) fn spindle(&mut self, rapid: bool) -> Spindle {
        let Some(on) = self.spindle.on else { return Spindle::NotStated };
        let Some(reverse) = on else { return Spindle::Stopped };
        if self.spindle.paused && !rapid {
            self.spindle.paused = false;
            if self.choice(Rule::Stop) == Choice::StopsSpindle {
                self.spindle.on = Some(None);
                return Spindle::Stopped;
            }
        }
        match (self.spindle.speed, reverse) {
            (None, _) => Spindle::WithoutSpeed,
            (Some(0.0), _) => Spindle::Stopped,
            (Some(_), false) => Spindle::Clockwise,
            (Some(_), true) => Spindle::CounterClockwise,
        }
    }
}
