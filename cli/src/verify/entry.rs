//! Findings of all kinds as they are printed: text, JSON, and what SARIF needs.

use super::CheckedPair;
use super::json::Row;
use super::machine::MachineFinding;
use super::rule;
use super::stock::StockFinding;
use super::text::describe;
use anstyle::{AnsiColor, Style};
use serde::Serialize;
use touchoff::Unit;
use touchoff::verify::FindingKind;

/// A finding as it is printed.
pub(super) struct Entry<'a> {
    pub(super) rule: &'static str,
    pub(super) severity: Severity,
    /// The line of the worst motion, and of the first and the last one.
    pub(super) line: usize,
    pub(super) lines: [usize; 2],
    pub(super) text: String,
    pub(super) row: EntryRow<'a>,
}

/// The consequence of a finding.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Severity {
    /// A rule is violated.
    Violation,
    /// A motion could not be checked in full.
    Undecided,
    /// The exit status does not depend on it.
    Remark,
}

impl Severity {
    /// Returns the style of a finding's file and line on a terminal.
    pub(super) fn style(self) -> Style {
        let color = match self {
            Severity::Violation => AnsiColor::Red,
            Severity::Undecided => AnsiColor::Yellow,
            Severity::Remark => AnsiColor::Cyan,
        };
        color.on_default().bold()
    }
}

/// A finding as a JSON object.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum EntryRow<'a> {
    Surface(Box<Row<'a>>),
    Machine(&'a MachineFinding<'a>),
    Stock(&'a StockFinding),
}

/// Returns all findings: those of surfaces by severity, then those of the machine and of the stock.
pub(super) fn entries<'a>(
    pairs: &'a [CheckedPair<'a>],
    machine: &'a [MachineFinding<'a>],
    stock: &'a [StockFinding],
    (file, unit): (&'a str, Unit),
) -> Vec<Entry<'a>> {
    let groups = |pair: &'a CheckedPair<'a>| {
        pair.groups.iter().zip(&pair.remedies).map(move |(group, remedy)| (pair, group, *remedy))
    };
    let mut surfaces: Vec<_> = pairs.iter().flat_map(groups).collect();
    surfaces.sort_by(|one, other| other.1.worst.kind.severity(&one.1.worst.kind));
    let surfaces = surfaces.into_iter().map(|(pair, group, remedy)| {
        let kind = &group.worst.kind;
        let open = matches!(kind, FindingKind::Undecided { .. } | FindingKind::Ambiguous(_));
        Entry {
            rule: rule(kind),
            severity: if open { Severity::Undecided } else { Severity::Violation },
            line: group.worst.line,
            lines: [group.first.line, group.last.line],
            text: describe(group, remedy, &pair.scope),
            row: EntryRow::Surface(Box::new(Row::of((group, remedy), &pair.scope, file))),
        }
    });
    let machine = machine.iter().map(|finding| Entry {
        rule: finding.rule(),
        severity: finding.severity(),
        line: finding.line,
        lines: [finding.line; 2],
        text: finding.describe(),
        row: EntryRow::Machine(finding),
    });
    let stock = stock.iter().map(|finding| Entry {
        rule: "stock",
        severity: Severity::Violation,
        line: finding.line,
        lines: [finding.first_line, finding.last_line],
        text: finding.describe(unit),
        row: EntryRow::Stock(finding),
    });
    surfaces.chain(machine).chain(stock).collect()
}
