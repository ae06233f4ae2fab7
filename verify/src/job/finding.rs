//! The findings of a report, joined over its readings, and their text.

use super::JobTool;
use super::machine::MachineFindingKind;
use super::report::{FindingDetail, JobFinding, JobReport, PairReport, Remedy, Severity};
use crate::check::Rank;
use crate::codes::{Entry, Family};
use crate::gcode::SubprogramLine;
use crate::{Finding, FindingGroup, FindingKind, Tilt};
use std::cmp::Ordering;
use std::fmt::{self, Write as _};
use touchoff::{Interval, SurfaceId, Unit};

/// Declares the rules with their rows of the table of codes.
macro_rules! rules {
    ($($(#[doc = $doc:literal])+ $code:ident $name:ident $keyword:literal $message:literal)*) => {
        /// The rule that a finding violates.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FindingRule {
            $($(#[doc = $doc])+ $name,)*
        }

        impl FindingRule {
            /// The rows of the rules.
            pub(crate) const FAMILY: Family = Family::new(
                "V01",
                "Findings",
                &[$(Some(Entry::new(stringify!($code), &[$($doc),+], $message))),*],
            );

            /// All rules, in the order of their codes.
            pub const ALL: &'static [FindingRule] = &[$(FindingRule::$name),*];

            /// Returns the stable code of the [table](crate::codes).
            pub fn code(self) -> &'static str {
                match self { $(FindingRule::$name => stringify!($code)),* }
            }

            /// Returns the keyword, which rows of JSON have as `kind`.
            pub fn keyword(self) -> &'static str {
                match self { $(FindingRule::$name => $keyword),* }
            }
        }
    };
}

rules! {
    /// A surface that is deeper in a body than allowed.
    ///
    /// It is a surface of a tool, or of a body of the machine, in the part, a fixture or another body. `tolerance` and `allow` state the
    /// allowed depth; in rapid traverse it is the tolerance.
    V0101 Deep "deep" "{surface} is {depth} deep in {body} at {point}: lift or tilt the tool there, or take another one"
    /// A surface that comes nearer to a body than its margin.
    V0102 Near "near" "{surface} is {distance} from {body} at {point}, less than its margin: lift or tilt the tool there, or lower `margin`"
    /// A tool, or a piece of it, that is inside the material.
    ///
    /// It touches no surface of the material there, so that no depth is measured.
    V0103 Inside "inside" "{surface} is inside {body}, away from its surface: check the work offset, the unit and the length of the tool"
    /// A surface of which it is not decided whether it exceeds its limit.
    ///
    /// The effort of a proof is bounded, and the surface is near its limit on this motion.
    V0104 Undecided "undecided" "it is not decided whether {surface} is too deep in {body}: try a larger `--resolution`"
    /// A motion whose rotation is ambiguous, of which only the end was checked.
    ///
    /// Its axis turns to the opposite, for which all ways are as short.
    V0105 Ambiguous "ambiguous" "start and end axes are antiparallel, so the rotation is ambiguous: add a position between"
    /// A feed motion with a spindle that does not turn, or turns the wrong way round.
    V0106 Spindle "spindle" "{tool} feeds with the spindle off, without a speed, or turning the wrong way round: write M3 or M4 and S before, or state `hand` of the tool"
    /// A feed motion with the length offset of another tool.
    V0107 Length "length" "{tool} feeds with the length offset H{register}, which has another length: correct H, or the lengths of the job"
    /// An axis of the machine that goes beyond its limit.
    V0108 Limit "limit" "{axis} goes to {value}, beyond its limit: move the part on the table, or choose another machine"
    /// A rotary axis that turns far while the tool axis hardly moves.
    ///
    /// It is a remark: the control slows down there, and the verdict does not depend on it.
    V0109 Singular "singular" "{axis} turns by {angle} while the tool axis hardly moves: tilt the part or the tool axis away from the pole"
    /// A surface that does not cut, or a rapid motion, in material that is still there.
    V0110 Stock "stock" "{surface} touches the stock, {depth} deep at {point}: clear the material before, or move around it"
}

impl fmt::Display for FindingRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.keyword())
    }
}

impl FindingRule {
    /// Returns the rule of a finding's kind.
    pub(super) fn of(kind: &FindingKind) -> FindingRule {
        match kind {
            FindingKind::Deep { .. } => FindingRule::Deep,
            FindingKind::Near { .. } => FindingRule::Near,
            FindingKind::Inside { .. } => FindingRule::Inside,
            FindingKind::Undecided { .. } => FindingRule::Undecided,
            FindingKind::Ambiguous(_) => FindingRule::Ambiguous,
        }
    }
}

/// A finding of one reading, and its place in the order of severity.
struct Ranked {
    reading: usize,
    rank: Rank,
    finding: JobFinding,
}

/// Returns all findings of a report in the order of [`JobReport::findings`].
pub(super) fn all(report: &JobReport<'_>) -> Vec<JobFinding> {
    let mut found = surfaces(report);
    for (reading, finding) in &report.machine {
        // The machine cannot keep a limit, but a singular pass only slows it down.
        let (severity, measure) = match finding.kind {
            MachineFindingKind::Singular { turn, .. } => (Severity::Remark, turn.abs()),
            _ => (Severity::Violation, 0.0),
        };
        let rank = Rank::machine(measure);
        let finding = JobFinding {
            rule: finding.rule(),
            severity,
            line: finding.block.line,
            within: finding.block.within,
            lines: [finding.block.line; 2],
            text: format!("{finding}{}", within(report, finding.block.within)),
            under: None,
            detail: FindingDetail::Machine(finding.clone()),
        };
        found.push(Ranked { reading: *reading, rank, finding });
    }
    for (reading, cut) in report.cuts.iter().enumerate() {
        for finding in &cut.findings {
            let rank = Rank::deep(finding.depth - cut.tolerance);
            let finding = JobFinding {
                rule: FindingRule::Stock,
                severity: Severity::Violation,
                line: finding.block.line,
                within: finding.block.within,
                lines: [finding.first.line, finding.last.line],
                text: finding.describe(report.job.unit()) + &within(report, finding.block.within),
                under: None,
                detail: FindingDetail::Stock(finding.clone()),
            };
            found.push(Ranked { reading, rank, finding });
        }
    }
    // Equal ones stay in the order of readings, tools and lines.
    found.sort_by(|one, other| {
        let by_severity = one.finding.severity.cmp(&other.finding.severity);
        by_severity.then_with(|| other.rank.cmp(&one.rank))
    });
    let is_same =
        |one: &JobFinding, other: &JobFinding| (one.line, &one.text) == (other.line, &other.text);
    let found = found.into_iter().map(|Ranked { reading, finding, .. }| (reading, finding));
    let named = by_reading(found, is_same).into_iter().map(|(mut finding, readings)| {
        if let Some(under) = report.job.program.under(&readings) {
            finding.text = format!("{}; {under}", finding.text);
            finding.under = Some(under);
        }
        finding
    });
    named.collect()
}

/// Returns the findings of surfaces in the order of pairs, and those of a pair in the order of its groups.
fn surfaces(report: &JobReport<'_>) -> Vec<Ranked> {
    let mut found = Vec::new();
    for (index, pair) in report.pairs.iter().enumerate() {
        found.extend(joined(pair).into_iter().map(|(groups, remedy)| {
            let kind = groups[0].worst.kind;
            let open = matches!(kind, FindingKind::Undecided { .. } | FindingKind::Ambiguous(_));
            let runs = Run::all(&groups);
            let motions = match &groups[..] {
                [group] => group.motions,
                _ => motions_in(&runs, &pair.report.findings),
            };
            let last = groups.iter().map(|group| group.last).max_by_key(|last| last.location);
            let finding = JobFinding {
                rule: FindingRule::of(&kind),
                severity: if open { Severity::Undecided } else { Severity::Violation },
                line: groups[0].worst.line,
                within: groups[0].worst.within,
                lines: [groups[0].first.line, last.unwrap_or(groups[0].last).line],
                text: describe(report, pair, &groups, &runs, motions, remedy),
                under: None,
                detail: FindingDetail::Surface { pair: index, groups, motions, remedy },
            };
            Ranked { reading: pair.reading, rank: kind.rank(), finding }
        }));
    }
    found
}

/// Returns the groups of each finding of a pair, with its remedy: one group each, but for those on which the tool passes right
/// through the body in the same way.
fn joined(pair: &PairReport) -> Vec<(Vec<FindingGroup>, Remedy)> {
    let mut rows: Vec<(Vec<FindingGroup>, Remedy)> = Vec::new();
    // The rows that a further group may join: one per way of being right through.
    let mut open: Vec<usize> = Vec::new();
    for (group, remedy) in pair.groups.iter().zip(&pair.remedies) {
        // Rapid traverse at any rates has a sentence of its own.
        let joins = group.worst.kind.is_right_through() && !group.worst.any_rates;
        let is_alike = |row: &&usize| {
            let known = &rows[**row].0[0].worst.kind;
            joins && known.severity(&group.worst.kind) == Ordering::Equal
        };
        if let Some(row) = open.iter().find(is_alike) {
            rows[*row].0.push(*group);
            continue;
        }
        if joins {
            open.push(rows.len());
        }
        rows.push((vec![*group], *remedy));
    }
    rows
}

/// Consecutive motions, by the index and the line of the first and the last.
#[derive(Clone, Copy)]
struct Run {
    locations: [usize; 2],
    lines: [usize; 2],
}

impl Run {
    /// Returns the runs of groups in the order of their first motions. Groups that follow each other or overlap are one.
    fn all(groups: &[FindingGroup]) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for FindingGroup { first, last, .. } in groups {
            match runs.last_mut() {
                Some(run) if first.location <= run.locations[1] + 1 => {
                    if last.location > run.locations[1] {
                        (run.locations[1], run.lines[1]) = (last.location, last.line);
                    }
                }
                _ => runs.push(Run {
                    locations: [first.location, last.location],
                    lines: [first.line, last.line],
                }),
            }
        }
        runs
    }
}

/// Returns the number of blocks or cutter locations in runs of motions that all have findings.
fn motions_in(runs: &[Run], findings: &[Finding]) -> usize {
    let mut runs = runs.iter().peekable();
    let (mut motions, mut last) = (0, None);
    for finding in findings {
        while runs.next_if(|run| run.locations[1] < finding.location).is_some() {}
        let Some(run) = runs.peek() else { break };
        // A block may have several moves.
        if run.locations[0] <= finding.location && last != Some(finding.block()) {
            motions += 1;
            last = Some(finding.block());
        }
    }
    motions
}

/// Number of runs of motions that a finding names.
const NAMED_RUNS: usize = 4;

/// Names runs of motions by their lines.
fn lines_of(runs: &[Run]) -> String {
    let named = runs.iter().take(NAMED_RUNS).map(|run| match run.lines {
        [first, last] if first == last => first.to_string(),
        [first, last] => format!("{first} to {last}"),
    });
    let named = named.collect::<Vec<_>>().join(", ");
    match runs.get(NAMED_RUNS..).and_then(<[Run]>::last) {
        Some(run) => {
            let more = runs.len() - NAMED_RUNS;
            format!("{named} and {more} more ranges up to line {}", run.lines[1])
        }
        None => named,
    }
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

/// Describes the findings of consecutive motions, and for several groups first all of their motions.
///
/// The remedy is that of the worst motion of the first group.
fn describe(
    report: &JobReport<'_>,
    pair: &PairReport,
    groups: &[FindingGroup],
    runs: &[Run],
    motions: usize,
    remedy: Remedy,
) -> String {
    let first = describe_group(report, pair, &groups[0], remedy);
    let text = if groups.len() > 1 {
        let (info, body) = (report.info(pair), &report.body(pair).name);
        let mut surfaces: Vec<&str> = Vec::new();
        for surface in groups.iter().filter_map(|group| group.worst.kind.surface()) {
            let name = &*info.surface(surface).name;
            if !surfaces.contains(&name) {
                surfaces.push(name);
            }
        }
        let (names, verb) = match &surfaces[..] {
            [] if report.revolved(pair).is_some() => ("it".to_owned(), "is"),
            [] => ("the tool".to_owned(), "is"),
            [name] => ((*name).to_owned(), "is"),
            [names @ .., last] => (format!("{} and {last}", names.join(", ")), "are"),
        };
        let what = match groups[0].worst.kind {
            FindingKind::Inside { surface: None } => format!("{verb} wholly inside {body}"),
            FindingKind::Inside { .. } => format!("{verb} inside {body}, away from its surface,"),
            _ if verb == "is" => format!("passes right through {body}"),
            _ => format!("pass right through {body}"),
        };
        let ending = plural(motions);
        format!(
            "{names} {what} on {motions} motion{ending}, lines {}; first, {first}",
            lines_of(runs)
        )
    } else {
        first
    };
    let number = report.tool(pair).and_then(JobTool::number);
    match (report.revolved(pair), number) {
        (Some(moving), _) => format!("{}: {text}", moving.name),
        (None, Some(number)) => format!("T{number} {text}"),
        (None, None) => text,
    }
}

/// Describes the findings of consecutive motions of a tool or a body of the machine, without its name.
fn describe_group(
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
    text
}

/// Names a line in a file of subprograms.
fn within(report: &JobReport<'_>, place: Option<SubprogramLine>) -> String {
    report.job.program.name_within(place)
}

/// Describes the motions of a group.
fn place(report: &JobReport<'_>, group: &FindingGroup) -> String {
    let Finding { from, time, rapid, within: place, .. } = group.worst;
    let rapid = if rapid { ", in rapid traverse" } else { "" };
    let within = within(report, place);
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
    let count = joined(pair).len();
    let PairReport { report, .. } = pair;
    let motions = report.motions;
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
