//! The findings of a report, joined over its readings, and their text.

use super::JobTool;
use super::machine::MachineFindingKind;
use super::report::{FindingDetail, JobFinding, JobReport, PairReport, Remedy, Severity};
use crate::{Finding, FindingGroup, FindingKind, Tilt};
use std::fmt::Write as _;
use touchoff::{Interval, SurfaceId, Unit};

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
            // The machine cannot keep a limit, but a singular pass only slows it down.
            severity: match finding.kind {
                MachineFindingKind::Singular { .. } => Severity::Remark,
                _ => Severity::Violation,
            },
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
    let named = joined.into_iter().map(|(mut finding, readings)| {
        if let Some(under) = report.job.program.under(&readings) {
            finding.text = format!("{}; {under}", finding.text);
            finding.under = Some(under);
        }
        finding
    });
    named.collect()
}

/// Returns the findings of surfaces, the worst first, each with the index of its reading.
fn surfaces(report: &JobReport<'_>) -> Vec<(usize, JobFinding)> {
    let mut surfaces: Vec<(usize, FindingGroup, Remedy)> = Vec::new();
    for (index, pair) in report.pairs.iter().enumerate() {
        let groups = pair.groups.iter().zip(&pair.remedies);
        surfaces.extend(groups.map(|(group, remedy)| (index, *group, *remedy)));
    }
    surfaces.sort_by(|one, other| other.1.worst.kind.severity(&one.1.worst.kind));
    let findings = surfaces.into_iter().map(|(index, group, remedy)| {
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
    });
    findings.collect()
}

/// Joins what several readings have alike: each with the readings that have it, in the order of the first.
fn by_reading<T>(
    found: impl Iterator<Item = (usize, T)>,
    is_same: impl Fn(&T, &T) -> bool,
) -> Vec<(T, Vec<usize>)> {
    let mut joined: Vec<(T, Vec<usize>)> = Vec::new();
    for (reading, item) in found {
        // The first reading has nothing to be joined with.
        let mut known = joined.iter_mut().filter(|_| reading > 0);
        match known.find(|(known, _)| is_same(known, &item)) {
            Some((_, readings)) if !readings.contains(&reading) => readings.push(reading),
            _ => joined.push((item, vec![reading])),
        }
    }
    joined
}

impl JobReport<'_> {
    /// Summarises the findings of each tool at each body, those of several readings in one line if they are alike.
    pub fn summaries(&self) -> Vec<String> {
        let texts = self.pairs.iter().map(|pair| (pair.reading, summary(self, pair)));
        let joined = by_reading(texts, |known, text| known == text).into_iter();
        let named = joined.map(|(text, readings)| match self.job.program.under(&readings) {
            Some(under) => format!("{under}: {text}"),
            None => text,
        });
        named.collect()
    }
}

/// A bound on depth is sought within an eighth of the depth found. It is not finished if it exceeds the depth by more than
/// this fraction, since the budget of a sweep was spent.
const MAX_BOUND_EXCESS: f64 = 0.25;

/// Formats a bound on the depth over a whole motion, given the depth at its deepest known point; nothing if that is the
/// bound.
fn format_bound(depth: f64, max_depth: f64, unit: Unit) -> String {
    if max_depth <= depth {
        return String::new();
    }
    let is_finished = max_depth <= (1.0 + MAX_BOUND_EXCESS) * depth;
    let rest = if is_finished { "" } else { ", a bound that is not finished" };
    format!("; at most {} {unit}{rest}", format_small(max_depth, unit))
}

/// Describes the findings of consecutive motions.
///
/// The remedy is that of the worst motion.
fn describe(
    report: &JobReport<'_>,
    pair: &PairReport,
    group: &FindingGroup,
    remedy: Remedy,
) -> String {
    let (info, unit) = (report.info(pair), report.job.unit());
    let body = &report.body(pair).name;
    let finding = &group.worst;
    let name = |surface: SurfaceId| &*info.surface(surface).name;
    let at = place(report, group);
    let text = match &finding.kind {
        FindingKind::Deep { surface, through: true, witness, .. } => {
            let point = unit.format_point(&witness.point);
            format!("{} passes right through {body} at {point}, {at}", name(*surface))
        }
        FindingKind::Deep {
            surface, depth: Interval { low, high }, max_depth, witness, ..
        } => {
            let bound = match finding.from {
                Some(_) => format_bound(*high, *max_depth, unit),
                None => String::new(),
            };
            let (name, depth) = (name(*surface), format_interval(*low, *high, unit));
            let point = unit.format_point(&witness.point);
            format!("{name} is {depth} {unit} deep in {body} at {point}, {at}{bound}")
        }
        FindingKind::Near {
            surface, margin, distance: Interval { low, high }, witness, ..
        } => format!(
            "{} is {} {unit} from {body} at {}, less than its margin of {margin} {unit}, {at}",
            name(*surface),
            format_interval(*low, *high, unit),
            unit.format_point(&witness.point),
        ),
        FindingKind::Inside { surface: None } => match report.revolved(pair) {
            Some(_) => format!("it is wholly inside {body}, {at}"),
            None => format!("the tool is wholly inside {body}, {at}"),
        },
        FindingKind::Inside { surface: Some(surface) } => {
            format!("{} is inside {body}, away from its surface, {at}", name(*surface))
        }
        FindingKind::Undecided { surface } => format!(
            "it is not decided whether {} is too deep in {body} from here on, {at}: try a larger `--resolution`",
            name(*surface)
        ),
        FindingKind::Ambiguous(error) => format!("{error}; only this position was checked"),
    };
    let cutting = finding.kind.surface().is_some_and(|surface| info.surface(surface).cutting);
    let mut text = match remedy.lift {
        // A gouge of a flank is not mended by a lift.
        Some(_) if cutting => text,
        Some(lift) => match report.revolved(pair) {
            Some(_) => {
                format!("{text}; with a tool that is {} longer it is clear", unit.format(lift))
            }
            None => format!("{text}; with {} more reach it is clear", unit.format(lift)),
        },
        None => text,
    };
    if let Some(Tilt { angle, axis }) = remedy.tilt {
        // Adding 0 to a rounded value makes -0 a 0.
        let [i, j, k] = [axis.x, axis.y, axis.z].map(|value| (value * 1e5).round() * 1e-5 + 0.0);
        // Writing to a String does not fail.
        let _ = write!(
            text,
            "; with the axis tilted by {:.2}° to ({i:.5}, {j:.5}, {k:.5}) no surface is too deep there",
            angle.to_degrees()
        );
    }
    let number = report.tool(pair).and_then(JobTool::number);
    match (report.revolved(pair), number) {
        (Some(moving), _) => format!("{}: {text}", moving.name),
        (None, Some(number)) => format!("T{number} {text}"),
        (None, None) => text,
    }
}

/// Describes the motions of a group.
fn place(report: &JobReport<'_>, group: &FindingGroup) -> String {
    let Finding { from, time, rapid, within, .. } = group.worst;
    let rapid = if rapid { ", in rapid traverse" } else { "" };
    let within = within.map_or(String::new(), |within| {
        format!(" ({}, line {})", report.job.program.file_name(within.file), within.line)
    });
    match (group.motions, from) {
        (1, Some(from)) if group.worst.any_rates => format!(
            "in rapid traverse from line {from} at some rates of its axes (the straight line is clear; `rapid` of the \
             control or of the machine's axes states the path){within}"
        ),
        (1, Some(from)) => {
            format!("at fraction {time:.2} of the motion from line {from}{rapid}{within}")
        }
        (1, None) => format!("at the first position{rapid}{within}"),
        (motions, _) => format!(
            "on {motions} motions, lines {} to {}{rapid}{within}",
            group.first.line, group.last.line
        ),
    }
}

/// Formats an interval, as one number if both ends print alike.
fn format_interval(low: f64, high: f64, unit: Unit) -> String {
    let [low, high] = [low, high].map(|value| format_small(value, unit));
    if low == high { high } else { format!("{low} to {high}") }
}

/// Formats a length with the usual decimals. A length below 0.01 mm of which these show fewer than two nonzero
/// digits is written with an exponent.
fn format_small(value: f64, unit: Unit) -> String {
    let text = unit.format_number(value);
    let digits = text.chars().filter(|c| ('1'..='9').contains(c)).count();
    if value == 0.0 || digits > 1 || value.abs() >= 0.01 / unit.millimetres() {
        text
    } else {
        format!("{value:.2e}")
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// Summarises the findings of a tool at a body: per surface, the number of motions and the deepest.
fn summary(report: &JobReport<'_>, pair: &PairReport) -> String {
    let (info, unit, body) = (report.info(pair), report.job.unit(), report.body(pair));
    let number = report.tool(pair).and_then(JobTool::number);
    let tool = match (report.revolved(pair), number) {
        (Some(moving), _) => format!("{} at {}: ", moving.name, body.name),
        (None, Some(number)) => format!("T{number} at {}: ", body.name),
        (None, None) if body.is_part() => String::new(),
        (None, None) => format!("{}: ", body.name),
    };
    let PairReport { report, groups, .. } = pair;
    let motions = report.motions;
    let count = groups.len();
    if count == 0 {
        return format!("{tool}no findings in {motions} motion{}", plural(motions));
    }
    let mut each = Vec::new();
    for (index, surface) in info.surfaces.iter().enumerate() {
        let mut on = 0;
        let mut deepest: Option<(f64, usize)> = None;
        for finding in &report.findings {
            if finding.kind.surface() != Some(SurfaceId(index)) {
                continue;
            }
            on += 1;
            let depth = match finding.kind {
                FindingKind::Deep { through: true, .. } => f64::INFINITY,
                FindingKind::Deep { depth, .. } => depth.high,
                _ => continue,
            };
            // The last one of equal depths is named.
            if deepest.is_none_or(|(known, _)| depth >= known) {
                deepest = Some((depth, finding.line));
            }
        }
        let deepest = match deepest {
            None => String::new(),
            Some((f64::INFINITY, line)) => format!(" (right through, line {line})"),
            Some((depth, line)) => {
                format!(" (deepest {}, line {line})", unit.format(depth))
            }
        };
        if on > 0 {
            each.push(format!("{} on {on} motion{}{deepest}", surface.name, plural(on)));
        }
    }
    let kinds = || report.findings.iter().map(|finding| finding.kind);
    let inside = kinds().filter(|kind| *kind == FindingKind::Inside { surface: None }).count();
    let ambiguous = kinds().filter(|kind| matches!(kind, FindingKind::Ambiguous(_))).count();
    for (word, count) in [("wholly inside", inside), ("ambiguous", ambiguous)] {
        if count > 0 {
            each.push(format!("{word} on {count} motion{}", plural(count)));
        }
    }
    let each = each.join(", ");
    format!("{tool}{count} finding{} in {motions} motion{}: {each}", plural(count), plural(motions))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_far_above_the_depth_is_not_finished() {
        let text = |max_depth| format_bound(2.0, max_depth, Unit::Millimetre);
        assert_eq!(text(2.0), "");
        assert_eq!(text(2.25), "; at most 2.2500 mm");
        assert_eq!(text(2.51), "; at most 2.5100 mm, a bound that is not finished");
    }
}
