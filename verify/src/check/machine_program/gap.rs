//! Gaps: everything that a verdict about a program leaves open.

use super::{MachineProgram, MachineSummary, UnknownCause, UnknownMotions};
use crate::gcode::{ControlRules, NoteKind, Rule, Spindle};
use std::fmt;

/// Something that was not checked, or that was taken for granted.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Gap {
    /// The line of its first occurrence, 1-based.
    pub line: usize,
    /// Set if there is no verdict with it: a collision could be missed that the program alone makes.
    pub is_open: bool,
    /// The subject that was not checked, the cause, and the remedy. A sentence without a full stop.
    pub reason: String,
}

impl Gap {
    /// Creates a gap that leaves a verdict possible.
    pub fn said(line: usize, reason: String) -> Gap {
        Gap { line, is_open: false, reason }
    }

    /// Creates a gap that allows no verdict.
    pub fn open(line: usize, reason: String) -> Gap {
        Gap { line, is_open: true, reason }
    }
}

/// The reason with its line.
impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => f.write_str(&self.reason),
            line => write!(f, "line {line}: {}", self.reason),
        }
    }
}

impl MachineProgram {
    /// Returns what the readings of a program leave open: first what allows no verdict, each in the order of lines.
    pub fn gaps(readings: &[MachineProgram]) -> Vec<Gap> {
        let mut gaps: Vec<(Gap, Vec<&ControlRules>)> = Vec::new();
        for program in readings {
            for gap in program.summary.gaps() {
                match gaps.iter_mut().find(|(known, _)| *known == gap) {
                    Some((_, rules)) => rules.push(&program.assumed),
                    None => gaps.push((gap, vec![&program.assumed])),
                }
            }
        }
        let described = |(mut gap, rules): (Gap, Vec<&ControlRules>)| {
            if let Some(under) = MachineProgram::under(readings, &rules) {
                gap.reason = format!("{} ({under})", gap.reason);
            }
            gap
        };
        let mut gaps: Vec<Gap> = gaps.into_iter().map(described).collect();
        gaps.sort_by_key(|gap| (!gap.is_open, gap.line));
        gaps
    }

    /// Names the readings for which something holds, by what they assume: `under rotary = "shortest"`. `None` if it holds for
    /// all.
    pub fn under(readings: &[MachineProgram], holds: &[&ControlRules]) -> Option<String> {
        if holds.len() == readings.len() {
            return None;
        }
        // A rule with one choice in all of these, and with another elsewhere, is a condition.
        let first = holds.first()?;
        let mut common = ControlRules::default();
        for rule in Rule::all() {
            let Some(choice) = first.get(rule) else { continue };
            if holds.iter().all(|rules| rules.get(rule) == Some(choice)) {
                common = common.with(rule, choice);
            }
        }
        match common == ControlRules::default() {
            false => Some(format!("under {common}")),
            true if holds.len() <= 3 => {
                let each: Vec<String> = holds.iter().map(|rules| rules.to_string()).collect();
                Some(format!("under {}", each.join(", or ")))
            }
            true => Some(format!("under {} of {} readings", holds.len(), readings.len())),
        }
    }
}

impl MachineSummary {
    /// Returns what this reading leaves open.
    fn gaps(&self) -> Vec<Gap> {
        let mut gaps = Vec::new();
        let mut add = |line: usize, is_open: bool, reason: String| {
            gaps.push(Gap { line, is_open, reason });
        };
        for UnknownMotions { cause, count, line, open_line } in &self.unknown {
            let plural = if *count == 1 { "" } else { "s" };
            let reason =
                format!("{count} motion{plural} not checked, first at line {line}: {cause}");
            add(open_line.unwrap_or(*line), open_line.is_some(), reason);
        }
        for (tool, line) in &self.unchecked_tools {
            add(*line, true, format!("no motion of T{tool} is checked"));
        }
        if let Some(line) = self.any_rotary_rapid {
            let reason = "the path of several axes in rapid traverse, one of them rotary, is checked on the straight line \
                          only: state `rapid` of the control, or the `rapid` rates of the machine's axes";
            add(line, true, reason.to_owned());
        }
        if let Some(line) = self.open_rules.get(&Rule::Unit) {
            let reason = "no G20 or G21 before a length, which is read in mm: write one, or state `unit` of the control";
            add(*line, true, reason.to_owned());
        }
        if let Some(line) = self.open_rules.get(&Rule::StartOffset) {
            let reason = "no work offset before a position, which is taken in G54: write G54, or state `start_offset` of the \
                          control";
            add(*line, true, reason.to_owned());
        }
        let first_feed = |turn: Spindle| self.spindle.iter().find(|(.., spindle)| *spindle == turn);
        if let (Some((line, ..)), false) = (first_feed(Spindle::NotStated), self.states_spindle()) {
            let reason = "the program feeds and never starts the spindle: write M3 with S before";
            add(*line, true, reason.to_owned());
        }
        if let Some((line, ..)) = first_feed(Spindle::AfterTapping) {
            let reason = "a tapping cycle before a feed leaves the spindle standing or turning, by the control: write M3 after G80";
            add(*line, true, reason.to_owned());
        }
        if let Some(line) = self.no_offset {
            let names_tool = self.tools.iter().any(|tool| tool.number.is_some());
            let remedy = match names_tool {
                true => {
                    ": write G43, or state the lengths of the tools in the job (0 if Z of the work offset is that of the tip)"
                }
                false => "",
            };
            let reason = format!(
                "no tool length offset (G43) is in force: positions are taken as those of the tip, as if the work offset were \
                 set with the tool{remedy}"
            );
            add(line, names_tool, reason);
        }
        if let Some(line) = self.tcp_without_length {
            let reason =
                format!("tips are taken as programmed, but {}", UnknownCause::TcpWithoutLength);
            add(line, true, reason);
        }
        if self.limits_unchecked {
            let reason = "the limits of X, Y and Z are not checked: state the origin of G54 in `work_offsets`";
            add(0, false, reason.to_owned());
        }
        for note in &self.notes {
            let is_open = matches!(
                note.kind,
                NoteKind::OtherProgram
                    | NoteKind::OptionalSwitches
                    | NoteKind::TwoRadii
                    | NoteKind::RoundedRadius
                    | NoteKind::OffsetOrShift
                    | NoteKind::LeftModes { .. }
            );
            let times =
                if note.count > 1 { format!(" ({} times)", note.count) } else { String::new() };
            if !matches!(note.kind, NoteKind::PassedOver { .. }) {
                add(note.line, is_open, format!("{}{times}", note.kind));
            }
        }
        gaps
    }

    /// Returns whether the program says something about the spindle before some feed. Otherwise it leaves the spindle to the
    /// operator.
    pub fn states_spindle(&self) -> bool {
        let is_stated =
            |spindle: Spindle| !matches!(spindle, Spindle::NotStated | Spindle::AfterTapping);
        self.spindle.iter().any(|(.., spindle)| is_stated(*spindle))
    }
}
