//! Findings about the machine's axes.

use super::entry::Severity;
use serde::Serialize;
use touchoff::machine::Letter;
use touchoff::verify::MachineProgram;

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
    /// A feed motion with the length offset of another tool.
    Length { register: u32, tool_number: u32 },
    /// An axis beyond its limit: its worst value.
    Limit { joint: String, unit: &'static str, value: f64, limit: f64 },
    /// A singular pass: the turn of the axis.
    Singular { joint: String, unit: &'static str, turn: f64 },
}

/// Returns the unit of a joint.
fn unit(letter: Letter) -> &'static str {
    if letter.is_rotary() { "degrees" } else { "mm" }
}

impl<'a> MachineFinding<'a> {
    /// Returns the findings of a program on its machine: length offsets, limits, then singular passes.
    pub(super) fn all(program: &MachineProgram, file: &'a str) -> Vec<MachineFinding<'a>> {
        let summary = program.summary();
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
        lengths.chain(limits).chain(singular).collect()
    }

    /// Returns the keyword of the kind.
    pub(super) fn rule(&self) -> &'static str {
        match self.kind {
            Kind::Length { .. } => "length",
            Kind::Limit { .. } => "limit",
            Kind::Singular { .. } => "singular",
        }
    }

    /// Returns the severity. The machine cannot keep a limit, but a singular pass only slows it down.
    pub(super) fn severity(&self) -> Severity {
        match self.kind {
            Kind::Length { .. } | Kind::Limit { .. } => Severity::Violation,
            Kind::Singular { .. } => Severity::Remark,
        }
    }

    /// Describes the finding.
    pub(super) fn describe(&self) -> String {
        match &self.kind {
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
