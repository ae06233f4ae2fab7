//! Findings of a check, as the page lists them.

use serde::Serialize;
use touchoff::SurfaceId;
use touchoff::tool::ToolInfo;
use touchoff_verify::job::{FindingDetail, Severity};
use touchoff_verify::{Finding, FindingGroup, FindingKind, JobReport};

/// The result of a check.
#[derive(Debug, Serialize)]
pub(crate) struct CheckResult {
    motions: usize,
    /// `true` if it is proved that nothing is deeper than allowed on the motions that were checked, in every reading of the program.
    clear: bool,
    /// `false` if the part has no inside, so that a tool wholly inside it is not found.
    inside_known: bool,
    /// Upper bound on the least distance between tool and part; 0 if they touch.
    distance: f64,
    /// `true` if the tool stays farther from the part than its diameter.
    far: bool,
    /// The factor by which all positions in feed, outside the part's box, would fit into it.
    unit_factor: Option<f64>,
    /// The findings at the part in the first reading, the worst first.
    findings: Vec<FindingRow>,
    /// Sentences about other violations: of the machine, and in other readings.
    others: Vec<String>,
    /// Sentences about what the machine does that is no violation.
    remarks: Vec<String>,
    /// Sentences about what allows no verdict.
    open: Vec<String>,
}

/// A finding on consecutive motions.
#[derive(Debug, Serialize)]
struct FindingRow {
    kind: &'static str,
    surface: Option<String>,
    /// Position of the worst in the program: the index of the cutter location before it, and the fraction of the motion.
    at: f64,
    /// Indices of the cutter locations at which the first and the last motion end.
    span: [usize; 2],
    /// Line of the worst, of the first and of the last motion.
    lines: [usize; 3],
    rapid: bool,
    /// Proved bounds of depth or distance at the worst.
    measured: Option<[f64; 2]>,
    /// The allowed depth, or the margin.
    limit: Option<f64>,
    /// The point of the part, and its triangle.
    point: Option<[f64; 3]>,
    triangle: Option<u32>,
}

impl CheckResult {
    /// Summarises the check of one tool at the part.
    pub(crate) fn of(report: &JobReport<'_>) -> CheckResult {
        let (mut findings, mut others, mut remarks) = (Vec::new(), Vec::new(), Vec::new());
        for finding in report.findings() {
            match &finding.detail {
                FindingDetail::Surface { pair: 0, group, .. } => {
                    findings.push(FindingRow::of(group, report.job.tools[0].tool.info()));
                }
                _ => {
                    let is_remark = finding.severity == Severity::Remark;
                    let list = if is_remark { &mut remarks } else { &mut others };
                    list.push(format!("line {}: {}", finding.line, finding.text));
                }
            }
        }
        let open = report.gaps.iter().filter(|gap| gap.is_open);
        let first = &report.pairs[0].report;
        CheckResult {
            motions: first.motions,
            clear: report.pairs.iter().all(|pair| pair.report.is_clear()),
            inside_known: first.inside_known,
            distance: first.approach.distance,
            far: first.approach.is_far(),
            unit_factor: first.approach.unit_factor,
            findings,
            others,
            remarks,
            open: open.map(ToString::to_string).collect(),
        }
    }
}

impl FindingRow {
    fn of(group: &FindingGroup, info: &ToolInfo) -> FindingRow {
        let Finding { location, line, rapid, time, kind, .. } = group.worst;
        let name = |surface: SurfaceId| info.surface(surface).name.to_string();
        let (label, measured, limit, witness) = match kind {
            FindingKind::Deep { allowed, depth, through, witness, .. } => {
                let label = if through { "right through" } else { "deep" };
                (label, Some([depth.low, depth.high]), Some(allowed), Some(witness))
            }
            FindingKind::Near { margin, distance, witness, .. } => {
                ("near", Some([distance.low, distance.high]), Some(margin), Some(witness))
            }
            FindingKind::Inside { .. } => ("inside", None, None, None),
            FindingKind::Undecided { .. } => ("undecided", None, None, None),
            FindingKind::Ambiguous(_) => ("ambiguous", None, None, None),
        };
        FindingRow {
            kind: label,
            surface: kind.surface().map(name),
            at: (location as f64 - 1.0 + time).max(0.0),
            span: [group.first.location, group.last.location],
            lines: [line, group.first.line, group.last.line],
            rapid,
            measured,
            limit,
            point: witness.map(|witness| witness.point.coords.into()),
            triangle: witness.map(|witness| witness.triangle.0),
        }
    }
}
