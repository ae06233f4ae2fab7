//! Holes of Sinumerik's drilling cycles, in absolute levels along Z.

use super::{Control, Spindle, TapTurn};
use crate::gcode::block::{Block, Distance, Number};
use crate::gcode::error::combination;
use crate::gcode::state::Tcp;
use crate::gcode::{GcodeFault, Plane};

/// A hole at the present position: a call of a drilling cycle. Levels are in the unit of the program.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gcode) struct Hole {
    pub(in crate::gcode) cycle: &'static str,
    /// The retract plane.
    pub(in crate::gcode) retract: f64,
    /// The safety distance above the reference plane, to which it moves in rapid traverse.
    pub(in crate::gcode) safe: f64,
    pub(in crate::gcode) depth: f64,
    /// Set where the tool leaves the hole at feed rate.
    pub(in crate::gcode) returns_at_feed: bool,
    /// Set where the cycle has a feed of its own.
    pub(in crate::gcode) has_feed: bool,
    pub(in crate::gcode) tapping: Option<Tapping>,
}

/// What a tapping cycle does with the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gcode) struct Tapping {
    pub(in crate::gcode) turn: TapTurn,
    /// The M word that turns the spindle after it, 3, 4 or 5, or another number.
    pub(in crate::gcode) after: u32,
}

impl Control {
    /// Refuses a hole where the cycle cannot be executed.
    pub(in crate::gcode) fn check_hole(&self, hole: &Hole) -> Result<(), GcodeFault> {
        self.check_corner()?;
        self.check_uncompensated(hole.cycle)?;
        let (condition, remedy) = if self.modal.plane != Plane::Xy {
            ("G18 or G19 is in force", "write G17 before")
        } else if self.state.tcp != Tcp::Off {
            ("tool centre point control is on", self.tcp_remedy())
        } else {
            return Ok(());
        };
        Err(combination(hole.cycle, condition, remedy))
    }

    /// Drills a hole at the present position.
    pub(in crate::gcode) fn drill(&mut self, hole: &Hole) -> Result<(), GcodeFault> {
        self.check_hole(hole)?;
        self.call_cycle();
        if !hole.has_feed {
            self.check_feed(hole.cycle)?;
        }
        self.unit_of_lengths(true);
        // The checks of a position along Z in G90.
        let mut block = Block::default();
        block.add('Z', Number { value: hole.depth, is_whole: false, is_computed: false })?;
        block.set_distance('Z', Distance::Absolute);
        self.returned_length(&block);
        self.length_without_word();
        self.check_offset(&block)?;
        self.check_tilted(&block)?;
        self.check_position(&block)?;
        let [retract, safe, depth] =
            [hole.retract, hole.safe, hole.depth].map(|level| Some(self.modal.millimetres(level)));
        let axis = Plane::Xy.normal();
        if self.position[axis] != safe {
            self.move_along(axis, true, safe);
        }
        let motion = self.modal.motion;
        if let Some(Tapping { turn, .. }) = hole.tapping {
            self.modal.motion = self.tapping_motion(turn);
        }
        self.move_along(axis, false, depth);
        if hole.returns_at_feed {
            self.move_along(axis, false, safe);
        }
        self.modal.motion = motion;
        if self.position[axis] != retract {
            self.move_along(axis, true, retract);
        }
        if let Some(Tapping { after, .. }) = hole.tapping {
            self.spindle.turn = match after {
                3 => Spindle::Clockwise,
                4 => Spindle::CounterClockwise,
                5 => Spindle::Stopped,
                _ => Spindle::AfterTapping,
            };
        }
        Ok(())
    }
}
