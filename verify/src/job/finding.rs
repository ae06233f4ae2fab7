//! Findings of all kinds, as they are printed.

use super::json::SurfaceRow;
use super::machine::{MachineFinding, MachineRow};
use super::report::{JobReport, PairReport, Remedy, by_reading};
use super::stock::{StockFinding, StockRow};
use super::text::describe;
use crate::{FindingGroup, FindingKind};
use serde::Serialize;

/// A finding of a job.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct JobFinding {
    /// The keyword of its kind: `deep`, `near`, `inside`, `undecided`, `ambiguous`, `spindle`, `length`, `limit`, `singular` or `stock`.
    pub rule: &'static str,
    /// Its consequence.
    pub severity: Severity,
    /// The line of the worst motion.
    pub line: usize,
    /// The lines of the first and the last motion.
    pub lines: [usize; 2],
    /// A sentence without a full stop, with the readings for which it holds.
    pub text: String,
    /// The readings of the program under which it holds, if not under all.
    pub under: Option<String>,
    /// The finding itself.
    pub detail: FindingDetail,
}

/// Subject of a finding.
#[derive(Clone, Debug)]
pub enum FindingDetail {
    /// A surface of a tool at the part or at a fixture.
    Surface {
        /// Index of the tool and the body in the report's pairs.
        pair: usize,
        /// The consecutive motions.
        group: Box<FindingGroup>,
        /// The changes that clear the worst.
        remedy: Remedy,
    },
    /// The machine.
    Machine(MachineFinding),
    /// The stock.
    Stock(StockFinding),
}

/// The consequence of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// A rule is violated.
    Violation,
    /// A motion could not be checked in full.
    Undecided,
    /// The verdict does not depend on it.
    Remark,
}

/// Returns the keyword of a finding's kind.
pub(super) fn rule(kind: &FindingKind) -> &'static str {
    match kind {
        FindingKind::Deep { .. } => "deep",
        FindingKind::Near { .. } => "near",
        FindingKind::Inside { .. } => "inside",
        FindingKind::Undecided { .. } => "undecided",
        FindingKind::Ambiguous(_) => "ambiguous",
    }
}

/// Returns all findings of a report: those of surfaces by severity, then those of the machine and of the stock.
pub(super) fn all(report: &JobReport<'_>) -> Vec<JobFinding> {
    let mut found = surfaces(report);
    for (reading, finding) in &report.machine {
        let finding = JobFinding {
            rule: finding.rule(),
            severity: finding.severity(),
            line: finding.line,
            lines: [finding.line; 2],
            text: finding.to_string(),
            under: None,
            detail: FindingDetail::Machine(finding.clone()),
        };
        found.push((*reading, finding));
    }
    for (reading, cut) in report.cuts.iter().enumerate() {
        for finding in &cut.findings {
            let finding = JobFinding {
                rule: "stock",
                severity: Severity::Violation,
                line: finding.line,
                lines: [finding.first_line, finding.last_line],
                text: finding.describe(report.job.unit()),
                under: None,
                detail: FindingDetail::Stock(finding.clone()),
            };
            found.push((reading, finding));
        }
    }
    let is_same =
        |one: &JobFinding, other: &JobFinding| (one.line, &one.text) == (other.line, &other.text);
    let joined = by_reading(found.into_iter(), is_same);
    let named = |(mut finding, readings): (JobFinding, Vec<usize>)| {
        if let Some(under) = report.job.program.under(&readings) {
            finding.text = format!("{}; {under}", finding.text);
            finding.under = Some(under);
        }
        finding
    };
    joined.into_iter().map(named).collect()
}

/// Returns the findings of surfaces, the worst first, each with the index of its reading.
fn surfaces(report: &JobReport<'_>) -> Vec<(usize, JobFinding)> {
    let groups = |(index, pair): (usize, &PairReport)| {
        let groups = pair.groups.iter().zip(&pair.remedies);
        groups.map(|(group, remedy)| (index, *group, *remedy)).collect::<Vec<_>>()
    };
    let mut surfaces: Vec<_> = report.pairs.iter().enumerate().flat_map(groups).collect();
    surfaces.sort_by(|one, other| other.1.worst.kind.severity(&one.1.worst.kind));
    let finding = |(index, group, remedy): (usize, FindingGroup, Remedy)| {
        let pair = &report.pairs[index];
        let kind = &group.worst.kind;
        let open = matches!(kind, FindingKind::Undecided { .. } | FindingKind::Ambiguous(_));
        let finding = JobFinding {
            rule: rule(kind),
            severity: if open { Severity::Undecided } else { Severity::Violation },
            line: group.worst.line,
            lines: [group.first.line, group.last.line],
            text: describe(report, pair, &group, remedy),
            under: None,
            detail: FindingDetail::Surface { pair: index, group: Box::new(group), remedy },
        };
        (pair.reading, finding)
    };
    surfaces.into_iter().map(finding).collect()
}

/// A finding as a JSON object.
#[derive(Serialize)]
pub(super) struct FindingRow<'a> {
    #[serde(flatten)]
    kind: KindRow<'a>,
    /// The readings of the program under which it holds, if not under all.
    #[serde(skip_serializing_if = "Option::is_none")]
    under: Option<&'a str>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum KindRow<'a> {
    Surface(Box<SurfaceRow<'a>>),
    Machine(MachineRow<'a>),
    Stock(StockRow<'a>),
}

impl<'a> FindingRow<'a> {
    pub(super) fn of(report: &'a JobReport<'_>, finding: &'a JobFinding) -> FindingRow<'a> {
        let file = report.job.program.name();
        let kind = match &finding.detail {
            FindingDetail::Surface { pair, group, remedy } => {
                let pair = &report.pairs[*pair];
                KindRow::Surface(Box::new(SurfaceRow::of(report, pair, group, *remedy)))
            }
            FindingDetail::Machine(finding) => KindRow::Machine(finding.row(file)),
            FindingDetail::Stock(finding) => KindRow::Stock(finding.row(file, report.job.unit())),
        };
        FindingRow { kind, under: finding.under.as_deref() }
    }
}
