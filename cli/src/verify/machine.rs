//! Findings about the machine's axes.

use serde::Serialize;
use touchoff::machine::Letter;
use touchoff::verify::MachineProgram;

/// An axis beyond its limit, a singular pass, or the length offset of another tool.
#[derive(Serialize)]
pub(super) struct MachineFinding {
    file: String,
    pub(super) line: usize,
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<String>,
    /// The register of the length offset, and the tool in the spindle.
    #[serde(skip_serializing_if = "Option::is_none")]
    register: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tool_number: Option<u32>,
    /// The worst joint value and the limit, in mm or degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<f64>,
    /// The turn of the axis, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    turn: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
}

impl MachineFinding {
    /// Returns the findings of a program on its machine: length offsets, limits, then singular passes.
    pub(super) fn all(program: &MachineProgram, file: &str) -> Vec<MachineFinding> {
        let summary = program.summary();
        let finding = |line: usize, kind: &'static str, letter: Option<Letter>| MachineFinding {
            file: file.to_owned(),
            line,
            kind,
            joint: letter.map(|letter| letter.to_string()),
            unit: letter.map(|letter| if letter.is_rotary() { "degrees" } else { "mm" }),
            register: None,
            tool_number: None,
            value: None,
            limit: None,
            turn: None,
        };
        let lengths = summary.other_lengths.iter().map(|(line, register, tool)| MachineFinding {
            register: Some(*register),
            tool_number: Some(*tool),
            ..finding(*line, "length", None)
        });
        let limits = summary.limits.iter().map(|(line, violation)| MachineFinding {
            value: Some(violation.value),
            limit: Some(violation.limit),
            ..finding(*line, "limit", Some(violation.letter))
        });
        let singular = summary.singular.iter().map(|(line, pass)| MachineFinding {
            turn: Some(pass.turn),
            ..finding(*line, "singular", Some(pass.letter))
        });
        lengths.chain(limits).chain(singular).collect()
    }

    /// Returns the keyword of the kind.
    pub(super) fn kind(&self) -> &'static str {
        self.kind
    }

    /// Returns whether the machine cannot make the motion. A singular pass only slows it down.
    pub(super) fn is_violation(&self) -> bool {
        self.turn.is_none()
    }

    /// Describes the finding.
    pub(super) fn describe(&self) -> String {
        if let (Some(register), Some(tool)) = (self.register, self.tool_number) {
            return format!(
                "T{tool} feeds with the length offset H{register}, which has another length: correct H, or the lengths of \
                 the job"
            );
        }
        let unit = if self.unit == Some("degrees") { "°" } else { " mm" };
        let axis = self.joint.as_deref().unwrap_or_default();
        match (self.value, self.limit, self.turn) {
            (Some(value), Some(limit), _) => {
                format!("{axis} goes to {value:.4}{unit}, beyond its limit of {limit}{unit}")
            }
            (_, _, turn) => format!(
                "{axis} turns by {:.0}° while the tool axis hardly moves: a singular pass, in which the control slows down",
                turn.unwrap_or_default()
            ),
        }
    }
}
