//! Findings about the machine's axes.

use super::entry::Severity;
use super::job::Hand;
use super::tools::ProgramTool;
use serde::Serialize;
use touchoff_verify::MachineProgram;
use touchoff_verify::gcode::Spindle;
use touchoff_verify::machine::Letter;

/// A finding about the machine.
#[derive(Serialize)]
pub(crate) struct MachineFinding<'a> {
    file: &'a str,
    pub(super) line: usize,
    #[serde(flatten)]
    kind: Kind,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Kind {
    /// A feed motion with a spindle that does not cut.
    Spindle { fault: SpindleFault, tool_number: Option<u32> },
    /// A feed motion with the length offset of another tool.
    Length { register: u32, tool_number: u32 },
    /// An axis beyond its limit: its worst value.
    Limit { joint: String, unit: &'static str, value: f64, limit: f64 },
    /// A singular pass: the turn of the axis.
    Singular { joint: String, unit: &'static str, turn: f64 },
}

/// The reason for which a spindle does not cut.
#[derive(Clone, Copy, Serialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum SpindleFault {
    Off,
    NoSpeed,
    Reverse,
}

/// Returns the unit of a joint.
fn unit(letter: Letter) -> &'static str {
    if letter.is_rotary() { "degrees" } else { "mm" }
}

impl<'a> MachineFinding<'a> {
    /// Returns the findings of a program on its machine: the spindle, length offsets, limits, then singular passes.
    pub(super) fn all(
        program: &MachineProgram,
        file: &'a str,
        tools: &[ProgramTool],
    ) -> Vec<MachineFinding<'a>> {
        let summary = program.summary();
        // A program that never starts the spindle has a gap instead.
        let starts = summary.states_spindle();
        let spindle = summary.spindle.iter().filter_map(|(line, number, spindle)| {
            let tool = tools.iter().find(|tool| tool.number.is_none() || tool.number == *number);
            let hand = tool.map_or(Hand::Right, |tool| tool.hand);
            let fault = match (spindle, hand) {
                (Spindle::NotStated, _) if !starts => return None,
                (Spindle::NotStated | Spindle::Stopped, _) => SpindleFault::Off,
                (Spindle::WithoutSpeed, _) => SpindleFault::NoSpeed,
                (Spindle::CounterClockwise, Hand::Right) | (Spindle::Clockwise, Hand::Left) => {
                    SpindleFault::Reverse
                }
                _ => return None,
            };
            Some((*line, Kind::Spindle { fault, tool_number: *number }))
        });
        let finding = |line: usize, kind: Kind| MachineFinding { file, line, kind };
        let lengths = summary.other_lengths.iter().map(|(line, register, tool)| {
            finding(*line, Kind::Length { register: *register, tool_number: *tool })
        });
        let limits = summary.limits.iter().map(|(line, violation)| {
            let letter = violation.letter;
            let (value, limit) = (violation.value, violation.limit);
            let (joint, unit) = (letter.to_string(), unit(letter));
            finding(*line, Kind::Limit { joint, unit, value, limit })
        });
        let singular = summary.singular.iter().map(|(line, pass)| {
            let (joint, unit) = (pass.letter.to_string(), unit(pass.letter));
            finding(*line, Kind::Singular { joint, unit, turn: pass.turn })
        });
        let spindle = spindle.map(|(line, kind)| finding(line, kind));
        spindle.chain(lengths).chain(limits).chain(singular).collect()
    }

    /// Returns the keyword of the kind.
    pub(super) fn rule(&self) -> &'static str {
        match self.kind {
            Kind::Spindle { .. } => "spindle",
            Kind::Length { .. } => "length",
            Kind::Limit { .. } => "limit",
            Kind::Singular { .. } => "singular",
        }
    }

    /// Returns the severity. The machine cannot keep a limit, but a singular pass only slows it down.
    pub(super) fn severity(&self) -> Severity {
        match self.kind {
            Kind::Spindle { .. } | Kind::Length { .. } | Kind::Limit { .. } => Severity::Violation,
            Kind::Singular { .. } => Severity::Remark,
        }
    }

    /// Describes the finding.
    pub(super) fn describe(&self) -> String {
        match &self.kind {
            Kind::Spindle { fault, tool_number } => {
                let tool = tool_number.map_or("the tool".to_owned(), |number| format!("T{number}"));
                let fault = match fault {
                    SpindleFault::Off => "the spindle off: write M3 or M4 before",
                    SpindleFault::NoSpeed => "no speed of the spindle: write S before",
                    SpindleFault::Reverse => {
                        "the spindle turning the wrong way round for it: write M3 for a right-hand tool and M4 for a \
                         left-hand one (`hand` of the tool in the job)"
                    }
                };
                format!("{tool} feeds with {fault}")
            }
            Kind::Length { register, tool_number } => format!(
                "T{tool_number} feeds with the length offset H{register}, which has another length: correct H, or the \
                 lengths of the job"
            ),
            Kind::Limit { joint, unit, value, limit } => {
                let unit = if *unit == "degrees" { "°" } else { " mm" };
                format!("{joint} goes to {value:.4}{unit}, beyond its limit of {limit}{unit}")
            }
            Kind::Singular { joint, turn, .. } => format!(
                "{joint} turns by {turn:.0}° while the tool axis hardly moves: a singular pass, in which the control slows \
                 down"
            ),
        }
    }
}
