//! Variables by which a control reports its state.
//!
//! Fanuc and Haas: B-64694, "System variables" (#4001 to #4130 modal information, #5001 to #5046 positions, #5201 to #5328 work
//! offsets). LinuxCNC: "G-Code overview" (#5161 to #5428, predefined names). Lengths are in the unit of the program. A variable that
//! is not listed here has a value that only the machine knows: timers, probing, signals.

use super::expression::Language;
use crate::gcode::control::{Control, Report};
use crate::gcode::state::WorkOffset;

/// Names that LinuxCNC predefines and whose value only the machine knows, or that are reported.
const PREDEFINED: [&str; 57] = [
    "_vmajor",
    "_vminor",
    "_line",
    "_motion_mode",
    "_plane",
    "_ccomp",
    "_metric",
    "_imperial",
    "_absolute",
    "_incremental",
    "_inverse_time",
    "_units_per_minute",
    "_units_per_rev",
    "_coord_system",
    "_tool_offset",
    "_retract_r_plane",
    "_retract_old_z",
    "_spindle_rpm_mode",
    "_spindle_css_mode",
    "_ijk_absolute_mode",
    "_lathe_diameter_mode",
    "_lathe_radius_mode",
    "_spindle_on",
    "_spindle_cw",
    "_mist",
    "_flood",
    "_speed_override",
    "_feed_override",
    "_adaptive_feed",
    "_feed_hold",
    "_feed",
    "_rpm",
    "_x",
    "_y",
    "_z",
    "_a",
    "_b",
    "_c",
    "_u",
    "_v",
    "_w",
    "_abs_x",
    "_abs_y",
    "_abs_z",
    "_abs_a",
    "_abs_b",
    "_abs_c",
    "_abs_u",
    "_abs_v",
    "_abs_w",
    "_current_tool",
    "_current_pocket",
    "_selected_tool",
    "_selected_pocket",
    "_task",
    "_call_level",
    "_remap_level",
];

/// Returns whether LinuxCNC predefines a name.
pub(super) fn is_predefined(name: &str) -> bool {
    PREDEFINED.contains(&name)
}

/// Returns the axis of a numbered variable, counted from the first of six.
fn axis(number: u32, first: u32) -> Option<usize> {
    let axis = number.checked_sub(first)?;
    (axis < 6).then_some(axis as usize)
}

/// Returns the work offset and the axis of a numbered variable, counted from that of X of G54 in steps of 20.
fn work_offset(number: u32) -> Option<(WorkOffset, usize)> {
    let index = number.checked_sub(5221)?;
    let (offset, axis) = (index / 20, index % 20);
    (offset < 9 && axis < 6).then(|| (WorkOffset::Standard(offset as u8 + 1), axis as usize))
}

/// Returns the value of a variable of the control, if the control knows it.
pub(super) fn numbered(number: u32, language: Language, control: &Control) -> Option<f64> {
    let report = |report| control.report(report);
    // LinuxCNC keeps these in the unit of the machine.
    let of_machine = |of: Report| report(of).filter(|_| control.is_in_machine_unit());
    match language {
        Language::Fanuc => {
            if let Some((offset, axis)) = work_offset(number).filter(|_| number <= 5326) {
                return report(Report::Origin(offset, axis));
            }
            // The end of the block before: the tip in the workpiece's coordinates.
            if let Some(axis) = axis(number, 5001) {
                return report(Report::Position(axis));
            }
            if let Some(axis) = axis(number, 5021) {
                return report(Report::Machine(axis));
            }
            match number {
                4001 => report(Report::Path),
                4002 => report(Report::Plane),
                4003 => report(Report::Distance),
                4005 => report(Report::FeedMode),
                4006 => report(Report::Unit),
                4010 => report(Report::Retract),
                4109 => report(Report::Feed),
                4111 => report(Report::Register),
                // The last T, or the tool in the spindle.
                4120 => {
                    report(Report::Tool).filter(|tool| report(Report::StagedTool) == Some(*tool))
                }
                _ => None,
            }
        }
        // Releases differ in #5021 to #5029 and in #5081 to #5089. G92.2 ends a shift that #5211 to #5219 keep.
        Language::LinuxCnc => {
            if let Some((offset, axis)) = work_offset(number) {
                return of_machine(Report::Origin(offset, axis));
            }
            if let Some(axis) = axis(number, 5420) {
                return report(Report::Position(axis));
            }
            let homes = [(5161, Report::Home as fn(usize) -> Report), (5181, Report::SecondHome)];
            for (first, of_axis) in homes {
                if let Some(axis) = axis(number, first) {
                    return of_machine(of_axis(axis));
                }
            }
            match number {
                5220 => match report(Report::WorkOffset)? {
                    offset if offset < 59.5 && offset.fract() == 0.0 => Some(offset - 53.0),
                    offset => Some(6.0 + (10.0 * (offset - 59.0)).round()),
                },
                5400 => report(Report::Tool),
                // The offset in force, or that of the tool in the spindle, by the release.
                5403 => of_machine(Report::ToolLength),
                _ => None,
            }
        }
    }
}

/// Returns the value of a predefined name of LinuxCNC, if the control knows it.
pub(super) fn named(name: &str, control: &Control) -> Option<f64> {
    let report = |report| control.report(report);
    let is = |of: Report, value: f64| {
        control.report(of).map(|found| f64::from(u8::from(found == value)))
    };
    if let Some(axis) = ["_x", "_y", "_z", "_a", "_b", "_c"].iter().position(|known| *known == name)
    {
        return report(Report::Position(axis));
    }
    if let Some(letter) = name.strip_prefix("_abs_") {
        let axis = ["x", "y", "z", "a", "b", "c"].iter().position(|known| *known == letter)?;
        return report(Report::Machine(axis));
    }
    match name {
        "_line" => report(Report::Line),
        "_motion_mode" => report(Report::Motion).map(|motion| 10.0 * motion),
        "_plane" => report(Report::Plane).map(|plane| 10.0 * plane),
        "_coord_system" => report(Report::WorkOffset).map(|offset| (10.0 * offset).round()),
        "_metric" => is(Report::Unit, 21.0),
        "_imperial" => is(Report::Unit, 20.0),
        "_absolute" => is(Report::Distance, 90.0),
        "_incremental" => is(Report::Distance, 91.0),
        "_inverse_time" => is(Report::FeedMode, 93.0),
        "_units_per_minute" => is(Report::FeedMode, 94.0),
        "_units_per_rev" => is(Report::FeedMode, 95.0),
        "_retract_old_z" => is(Report::Retract, 98.0),
        "_retract_r_plane" => is(Report::Retract, 99.0),
        "_feed" => report(Report::Feed),
        "_current_tool" => report(Report::Tool),
        "_selected_tool" => report(Report::StagedTool),
        _ => None,
    }
}
