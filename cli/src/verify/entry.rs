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
use touchoff::verify::{Finding, FindingKind};

/// A finding as it is printed.
pub(crate) struct Entry<'a> {
    pub(crate) rule: &'static str,
    pub(crate) severity: Severity,
    /// The line of the worst motion, and of the first and the last one.
    pub(crate) line: usize,
    pub(crate) lines: [usize; 2],
    pub(crate) text: String,
    pub(crate) row: EntryRow<'a>,
    pub(crate) source: EntrySource<'a>,
}

/// The finding that an entry is about.
#[derive(Clone, Copy)]
pub(crate) enum EntrySource<'a> {
    /// The worst motion of a group, with the index of its pair of tool and body.
    Surface(usize, &'a Finding),
    Machine,
    Stock(&'a StockFinding),
}

/// The consequence of a finding.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Severity {
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
pub(crate) enum EntryRow<'a> {
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
    let groups = |(index, pair): (usize, &'a CheckedPair<'a>)| {
        let groups = pair.groups.iter().zip(&pair.remedies);
        groups.map(move |(group, remedy)| (index, group, *remedy))
    };
    let mut surfaces: Vec<_> = pairs.iter().enumerate().flat_map(groups).collect();
    surfaces.sort_by(|one, other| other.1.worst.kind.severity(&one.1.worst.kind));
    let surfaces = surfaces.into_iter().map(|(index, group, remedy)| {
        let pair = &pairs[index];
        let kind = &group.worst.kind;
        let open = matches!(kind, FindingKind::Undecided { .. } | FindingKind::Ambiguous(_));
        Entry {
            rule: rule(kind),
            severity: if open { Severity::Undecided } else { Severity::Violation },
            line: group.worst.line,
            lines: [group.first.line, group.last.line],
            text: describe(group, remedy, &pair.scope),
            row: EntryRow::Surface(Box::new(Row::of((group, remedy), &pair.scope, file))),
            source: EntrySource::Surface(index, &group.worst),
        }
    });
    let machine = machine.iter().map(|finding| Entry {
        rule: finding.rule(),
        severity: finding.severity(),
        line: finding.line,
        lines: [finding.line; 2],
        text: finding.describe(),
        row: EntryRow::Machine(finding),
        source: EntrySource::Machine,
    });
    let stock = stock.iter().map(|finding| Entry {
        rule: "stock",
        severity: Severity::Violation,
        line: finding.line,
        lines: [finding.first_line, finding.last_line],
        text: finding.describe(unit),
        row: EntryRow::Stock(finding),
        source: EntrySource::Stock(finding),
    });
    surfaces.chain(machine).chain(stock).collect()
}
