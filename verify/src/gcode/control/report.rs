//! Reports of the control about its state, which macros read as variables.

use super::{Control, FeedMode, Motion};
use crate::gcode::Plane;
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{LengthOffset, Rotation, WorkOffset};
use touchoff::Unit;

/// A quantity that a control reports. Lengths are in the unit of the program, angles in degrees, modes as the numbers of their G words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gcode) enum Report {
    /// The programmed position along an axis, in program coordinates.
    Position(usize),
    /// The position along an axis in machine coordinates.
    Machine(usize),
    /// The origin of a work offset along an axis.
    Origin(WorkOffset, usize),
    /// The reference position along an axis (G28).
    Home(usize),
    /// The second reference position along an axis (G30).
    SecondHome(usize),
    /// The number of the tool in the spindle.
    Tool,
    /// The number of the tool that the next M6 changes to.
    StagedTool,
    /// The length of the tool in the spindle, if it is the length offset in force.
    ToolLength,
    /// The last H.
    Register,
    /// F.
    Feed,
    /// The line of the block.
    Line,
    /// G0 to G3, a canned cycle, or G80.
    Motion,
    /// G0 to G3 alone.
    Path,
    /// G17 to G19.
    Plane,
    /// G90 or G91.
    Distance,
    /// G93 to G95.
    FeedMode,
    /// G20 or G21.
    Unit,
    /// G98 or G99.
    Retract,
    /// G54 to G59.3, as a number with a decimal.
    WorkOffset,
}

impl Control {
    /// Returns a quantity, if it is known here.
    pub(in crate::gcode) fn report(&self, report: Report) -> Option<f64> {
        let modal = &self.modal;
        // The unit of a program that has not stated it decides about lengths.
        let length = |axis: usize, value: f64| match axis < 3 {
            true => modal.unit_stated.then(|| value / modal.millimetres(1.0)),
            false => Some(value),
        };
        let on = |axis: usize, value: Option<f64>| value.and_then(|value| length(axis, value));
        let number = |motion| match motion {
            Motion::Rapid => 0.0,
            Motion::Feed | Motion::Tap(_) => 1.0,
            Motion::Arc { clockwise: true } => 2.0,
            Motion::Arc { clockwise: false } => 3.0,
            Motion::Cycle(number) => f64::from(number),
        };
        match report {
            Report::Position(axis) => {
                on(axis, self.position[axis].filter(|_| self.is_position_plain(axis)))
            }
            // The centre of the tool is not at the programmed position.
            Report::Machine(_) if self.compensation.is_some() => None,
            Report::Machine(axis) => on(axis, self.state.to_machine(self.position)[axis]),
            Report::Origin(offset, axis) => on(axis, self.origin_of(offset).0[axis]),
            Report::Home(axis) => on(axis, self.home[axis]),
            Report::SecondHome(axis) => on(axis, self.second_home.map(|home| home[axis])),
            Report::Tool => self.state.tool.map(f64::from),
            Report::StagedTool => self.staged.map(f64::from),
            Report::ToolLength => {
                let LengthOffset::On { register, .. } = self.state.length else { return None };
                let length = self.state.length.length();
                on(2, length.filter(|_| self.state.tool == Some(register)))
            }
            Report::Register => self.last_register.map(f64::from),
            Report::Feed => modal.feed,
            Report::Line => Some(self.line as f64),
            Report::Motion => Some(modal.motion.map_or(80.0, number)),
            Report::Path => modal.path.map(number),
            Report::Plane => Some(match modal.plane {
                Plane::Xy => 17.0,
                Plane::Zx => 18.0,
                Plane::Yz => 19.0,
            }),
            Report::Distance => Some(if modal.incremental { 91.0 } else { 90.0 }),
            Report::FeedMode => Some(match modal.feed_mode {
                FeedMode::InverseTime => 93.0,
                FeedMode::PerMinute => 94.0,
                FeedMode::PerRevolution => 95.0,
            }),
            Report::Unit => {
                modal.unit_stated.then_some(if modal.unit == Unit::Inch { 20.0 } else { 21.0 })
            }
            Report::Retract => modal.retract_to_r.map(|to_r| if to_r { 99.0 } else { 98.0 }),
            Report::WorkOffset => match self.state.work_offset {
                WorkOffset::Standard(number @ 1..=6) => Some(f64::from(53 + number)),
                WorkOffset::Standard(number) => Some(59.0 + 0.1 * f64::from(number - 6)),
                WorkOffset::Additional(_) | WorkOffset::Off => None,
            },
        }
    }

    /// Returns whether the position along an axis is what controls report: neither a compensated one nor one in a rotated or mirrored
    /// frame, nor a height under a length offset that a return can have cancelled.
    fn is_position_plain(&self, axis: usize) -> bool {
        let keeps_length = self.stated(Rule::ReferenceReturn) == Some(Choice::KeepsLength);
        self.compensation.is_none()
            && self.state.rotation == Rotation::Off
            && self.mirror == [None; 3]
            && (axis != 2 || self.returned.is_none() || keeps_length)
    }

    /// Returns whether the lengths of the program are in the unit of the machine, as far as that is stated.
    pub(in crate::gcode) fn is_in_machine_unit(&self) -> bool {
        let unit = match self.stated(Rule::Unit) {
            Some(Choice::Inch) => Unit::Inch,
            Some(_) => Unit::Millimetre,
            None => return false,
        };
        self.modal.unit == unit
    }
}
