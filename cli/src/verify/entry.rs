//! Findings of all kinds as they are printed: text, JSON, and what SARIF needs.

use super::json::Row;
use super::machine::MachineFinding;
use super::stock::StockFinding;
use super::text::describe;
use super::{CheckedPair, Verification, by_reading, rule};
use anstyle::{AnsiColor, Style};
use serde::Serialize;
use touchoff_verify::{Finding, FindingKind};

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
pub(crate) struct EntryRow<'a> {
    #[serde(flatten)]
    kind: KindRow<'a>,
    /// The readings of the program under which it holds, if not under all.
    #[serde(skip_serializing_if = "Option::is_none")]
    under: Option<String>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum KindRow<'a> {
    Surface(Box<Row<'a>>),
    Machine(&'a MachineFinding<'a>),
    Stock(&'a StockFinding),
}

/// Returns all findings: those of surfaces by severity, then those of the machine and of the stock. A finding of several
/// readings is one.
pub(super) fn entries<'a>(verification: &'a Verification<'a>) -> Vec<Entry<'a>> {
    let Verification { inputs, pairs, machine, cuts, .. } = verification;
    let (file, unit) = (&*inputs.file, inputs.job.unit);
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
        let row = Row::of((group, remedy), &pair.scope, file);
        let entry = Entry {
            rule: rule(kind),
            severity: if open { Severity::Undecided } else { Severity::Violation },
            line: group.worst.line,
            lines: [group.first.line, group.last.line],
            text: describe(group, remedy, &pair.scope),
            row: EntryRow { kind: KindRow::Surface(Box::new(row)), under: None },
            source: EntrySource::Surface(index, &group.worst),
        };
        (pair.reading, entry)
    });
    let machine = machine.iter().map(|(reading, finding)| {
        let entry = Entry {
            rule: finding.rule(),
            severity: finding.severity(),
            line: finding.line,
            lines: [finding.line; 2],
            text: finding.describe(),
            row: EntryRow { kind: KindRow::Machine(finding), under: None },
            source: EntrySource::Machine,
        };
        (*reading, entry)
    });
    let stock = cuts.iter().enumerate().flat_map(|(reading, cut)| {
        let entry = |finding: &'a StockFinding| Entry {
            rule: "stock",
            severity: Severity::Violation,
            line: finding.line,
            lines: [finding.first_line, finding.last_line],
            text: finding.describe(unit),
            row: EntryRow { kind: KindRow::Stock(finding), under: None },
            source: EntrySource::Stock(finding),
        };
        cut.findings.iter().map(move |finding| (reading, entry(finding)))
    });
    let found = surfaces.chain(machine).chain(stock);
    let is_same =
        |one: &Entry<'a>, other: &Entry<'a>| (one.line, &one.text) == (other.line, &other.text);
    let named = |(mut entry, readings): (Entry<'a>, Vec<usize>)| {
        if let Some(under) = inputs.program.under(&readings) {
            entry.text = format!("{}; {under}", entry.text);
            entry.row.under = Some(under);
        }
        entry
    };
    by_reading(found, is_same).into_iter().map(named).collect()
}
