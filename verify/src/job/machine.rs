//! Findings about the machine: spindle, length offsets, limits of axes, singular passes.

use super::{FindingRule, Hand, Job};
use crate::MachineProgram;
use crate::gcode::{BlockLine, Spindle};
use crate::machine::Letter;
use serde::Serialize;
use std::fmt;

/// A finding about the machine.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MachineFinding {
    /// The block of the first motion with it, or of the worst.
    pub block: BlockLine,
    /// Its kind.
    pub kind: MachineFindingKind,
}

/// Fault in the use of a machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum MachineFindingKind {
    /// A feed motion with a spindle that does not cut.
    Spindle {
        /// The reason.
        fault: SpindleFault,
        /// Number of the tool in the spindle.
        tool_number: Option<u32>,
    },
    /// A feed motion with the length offset of another tool.
    Length {
        /// The register.
        register: u32,
        /// Number of the tool in the spindle.
        tool_number: u32,
    },
    /// An axis beyond its limit.
    Limit {
        /// Letter of the axis.
        joint: Letter,
        /// `mm` or `degrees`.
        unit: &'static str,
        /// Its worst value.
        value: f64,
        /// The limit.
        limit: f64,
    },
    /// A singular pass.
    Singular {
        /// Letter of the axis that turns.
        joint: Letter,
        /// `degrees`.
        unit: &'static str,
        /// Its turn.
        turn: f64,
    },
}

/// The reason for which a spindle does not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpindleFault {
    /// It stands.
    Off,
    /// The program gives no speed.
    NoSpeed,
    /// It turns the wrong way round for the tool.
    Reverse,
}

/// A finding as a JSON object.
#[derive(Serialize)]
pub(super) struct MachineRow<'a> {
    file: &'a str,
    line: usize,
    #[serde(flatten)]
    kind: &'a MachineFindingKind,
}

/// Returns the unit of a joint.
fn unit(letter: Letter) -> &'static str {
    if letter.is_rotary() { "degrees" } else { "mm" }
}

impl MachineFinding {
    /// Returns the findings of all readings, each with the index of its reading.
    pub(super) fn all(job: &Job<'_>) -> Vec<(usize, MachineFinding)> {
        let mut all = Vec::new();
        for (index, program) in job.program.readings().iter().enumerate() {
            let findings = MachineFinding::of_reading(program, job);
            all.extend(findings.into_iter().map(|finding| (index, finding)));
        }
        all
    }

    /// Returns the findings of a program on its machine: the spindle, length offsets, limits, then singular passes.
    fn of_reading(program: &MachineProgram, job: &Job<'_>) -> Vec<MachineFinding> {
        let summary = program.summary();
        let mut findings = Vec::new();
        // A program that never starts the spindle has a gap instead.
        let starts = summary.states_spindle();
        for &(block, tool_number, spindle) in &summary.spindle {
            let stated = job.tool_of(tool_number).and_then(|tool| tool.hand);
            let fault = match (spindle, stated.unwrap_or_default()) {
                (Spindle::NotStated, _) if !starts => continue,
                (Spindle::NotStated | Spindle::Stopped, _) => SpindleFault::Off,
                (Spindle::WithoutSpeed, _) => SpindleFault::NoSpeed,
                (Spindle::CounterClockwise, Hand::Right)
                | (Spindle::Clockwise | Spindle::RightTap, Hand::Left) => SpindleFault::Reverse,
                // The cycle says what the tap is, unless it is stated.
                (Spindle::LeftTap, Hand::Right) if stated.is_some() => SpindleFault::Reverse,
                _ => continue,
            };
            findings.push(MachineFinding {
                block,
                kind: MachineFindingKind::Spindle { fault, tool_number },
            });
        }
        for &(block, register, tool_number) in &summary.other_lengths {
            findings.push(MachineFinding {
                block,
                kind: MachineFindingKind::Length { register, tool_number },
            });
        }
        for (block, violation) in &summary.limits {
            let (joint, value, limit) = (violation.letter, violation.value, violation.limit);
            let kind = MachineFindingKind::Limit { joint, unit: unit(joint), value, limit };
            findings.push(MachineFinding { block: *block, kind });
        }
        for (block, pass) in &summary.singular {
            let joint = pass.letter;
            let kind = MachineFindingKind::Singular { joint, unit: unit(joint), turn: pass.turn };
            findings.push(MachineFinding { block: *block, kind });
        }
        findings
    }

    /// Returns the rule of the kind.
    pub(super) fn rule(&self) -> FindingRule {
        match self.kind {
            MachineFindingKind::Spindle { .. } => FindingRule::Spindle,
            MachineFindingKind::Length { .. } => FindingRule::Length,
            MachineFindingKind::Limit { .. } => FindingRule::Limit,
            MachineFindingKind::Singular { .. } => FindingRule::Singular,
        }
    }

    pub(super) fn row<'a>(&'a self, file: &'a str) -> MachineRow<'a> {
        MachineRow { file, line: self.block.line, kind: &self.kind }
    }
}

impl fmt::Display for MachineFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            MachineFindingKind::Spindle { fault, tool_number } => {
                match tool_number {
                    Some(number) => write!(f, "T{number}")?,
                    None => f.write_str("the tool")?,
                }
                let fault = match fault {
                    SpindleFault::Off => "the spindle off: write M3 or M4 before",
                    SpindleFault::NoSpeed => "no speed of the spindle: write S before",
                    SpindleFault::Reverse => {
                        "the spindle turning the wrong way round for it: write M3 for a right-hand tool and M4 for a \
                         left-hand one (`hand` of the tool in the job)"
                    }
                };
                write!(f, " feeds with {fault}")
            }
            MachineFindingKind::Length { register, tool_number } => write!(
                f,
                "T{tool_number} feeds with the length offset H{register}, which has another length: correct H, or the \
                 lengths of the job"
            ),
            MachineFindingKind::Limit { joint, unit, value, limit } => {
                let unit = if *unit == "degrees" { "°" } else { " mm" };
                write!(f, "{joint} goes to {value:.4}{unit}, beyond its limit of {limit}{unit}")
            }
            MachineFindingKind::Singular { joint, turn, .. } => write!(
                f,
                "{joint} turns by {turn:.0}° while the tool axis hardly moves: a singular pass, in which the control slows \
                 down"
            ),
        }
    }
}
