//! Findings and gaps as JSON objects, and findings as a log in SARIF 2.1.0, the format in which services of continuous
//! integration take the results of analyses.
//!
//! Own types: the crate `serde-sarif` generates those of the whole standard while it is built, and findings need these.

use super::machine::MachineRow;
use super::report::{
    FindingDetail, JobFinding, JobReport, NoVerdict, PairReport, Remedy, Severity, Verdict,
};
use super::stock::StockRow;
use super::{FindingRule, JobTool};
use crate::gcode::SubprogramLine;
use crate::{FindingGroup, FindingKind};
use serde::Serialize;
use std::borrow::Cow;
use touchoff::Escaped;
use touchoff::certify::Witness;
use touchoff::tool::{Symmetry, ToolInfo};

impl JobReport<'_> {
    /// Returns a finding as an object for JSON.
    pub fn row<'r>(&'r self, finding: &'r JobFinding) -> impl Serialize + 'r {
        FindingRow::of(self, finding)
    }

    /// Returns the verdict as an object for JSON.
    pub fn verdict_row(&self) -> impl Serialize {
        let reasons = self.refusals().into_iter();
        VerdictRow {
            verdict: self.verdict().keyword(),
            text: self.headline(),
            reasons: reasons.map(|reason| format!("{reason} [{}]", reason.code())).collect(),
        }
    }

    /// Returns what is left open as objects for JSON, and the reasons beside it for which there is no verdict.
    pub fn gap_rows(&self) -> impl Iterator<Item = impl Serialize + '_> {
        let gaps = self.gaps.iter().map(|gap| GapRow {
            file: self.job.program.name(),
            line: gap.line,
            within: SubprogramRow::of(self, gap.within),
            kind: "not-checked",
            code: gap.code(),
            open: gap.is_open(),
            reason: Cow::Borrowed(&gap.reason),
        });
        let is_gap =
            |reason: &NoVerdict| matches!(reason, NoVerdict::Unread { .. } | NoVerdict::Open(_));
        let others = self.refusals().into_iter().filter(move |reason| !is_gap(reason));
        gaps.chain(others.map(|reason| GapRow {
            file: self.job.program.name(),
            line: 0,
            within: None,
            kind: "not-checked",
            code: reason.code(),
            open: true,
            reason: Cow::Owned(reason.to_string()),
        }))
    }

    /// Returns the findings in SARIF 2.1.0, for services of continuous integration. `job` tells the run from those of other jobs, which
    /// such a service refuses to take together otherwise.
    pub fn sarif(&self, job: &str) -> impl Serialize + use<> {
        log(self, job)
    }
}

/// The verdict as a JSON object.
#[derive(Serialize)]
struct VerdictRow {
    verdict: &'static str,
    /// The sentence, with the numbers of findings.
    text: String,
    /// The reasons for which there is none.
    reasons: Vec<String>,
}

/// A finding as a JSON object.
#[derive(Serialize)]
struct FindingRow<'a> {
    /// The code of the rule.
    code: &'static str,
    severity: &'static str,
    /// The sentence.
    text: &'a str,
    #[serde(flatten)]
    kind: KindRow<'a>,
    /// The line of the worst motion in the file of subprograms that has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    within: Option<SubprogramRow<'a>>,
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
    fn of(report: &'a JobReport<'_>, finding: &'a JobFinding) -> FindingRow<'a> {
        let file = report.job.program.name();
        let kind = match &finding.detail {
            FindingDetail::Surface { pair, groups, motions, remedy } => {
                let pair = &report.pairs[*pair];
                let row = SurfaceRow {
                    first_line: finding.lines[0],
                    last_line: finding.lines[1],
                    motions: *motions,
                    groups: GroupRow::all(report.info(pair), groups),
                    ..SurfaceRow::of(report, pair, &groups[0], *remedy)
                };
                KindRow::Surface(Box::new(row))
            }
            FindingDetail::Machine(finding) => KindRow::Machine(finding.row(file)),
            FindingDetail::Stock(finding) => KindRow::Stock(finding.row(file, report.job.unit())),
        };
        let within = SubprogramRow::of(report, finding.within);
        FindingRow {
            code: finding.rule.code(),
            severity: finding.severity.keyword(),
            text: &finding.text,
            kind,
            within,
            under: finding.under.as_deref(),
        }
    }
}

/// The findings of consecutive motions.
#[derive(Serialize)]
struct SurfaceRow<'a> {
    file: &'a str,
    /// The line of the worst motion, and of the first and the last one.
    line: usize,
    first_line: usize,
    last_line: usize,
    /// Number of motions.
    motions: usize,
    /// The groups of consecutive motions, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<GroupRow<'a>>,
    /// The line at which the worst motion begins.
    from_line: Option<usize>,
    /// The index of the position at which it ends, from 0.
    location: usize,
    rapid: bool,
    /// On some dog-leg of axes whose rates are not known, and not on the straight line.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    any_rates: bool,
    /// The fraction of the motion at which the tool is at `tip` and `axis`, from 0 to 1.
    fraction: f64,
    /// Unit of lengths.
    unit: &'static str,
    tip: [f64; 3],
    axis: [f64; 3],
    /// For a solid without an axis, whose pose needs the spin: `qx, qy, qz, qw`.
    #[serde(skip_serializing_if = "Option::is_none")]
    quaternion: Option<[f64; 4]>,
    /// The part, the fixture, or the mesh of the machine.
    body: &'a str,
    /// The tool, or the body of the machine.
    tool: &'a str,
    tool_number: Option<u32>,
    kind: &'static str,
    surface: Option<&'a str>,
    cutting: Option<bool>,
    #[serde(flatten)]
    measurement: Option<Measurement>,
    #[serde(flatten)]
    point: Option<BodyPoint>,
    /// The least travel along the tool's axis that clears the surface at this pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    lift: Option<f64>,
    /// The least tilt about the tip that clears the tool at this pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt: Option<TiltRow>,
}

/// A line of a file of subprograms.
#[derive(Serialize)]
struct SubprogramRow<'a> {
    file: &'a str,
    line: usize,
}

impl<'a> SubprogramRow<'a> {
    fn of(report: &'a JobReport<'_>, place: Option<SubprogramLine>) -> Option<SubprogramRow<'a>> {
        place.map(|place| SubprogramRow {
            file: report.job.program.file_name(place.file),
            line: place.line,
        })
    }
}

/// Consecutive motions on which the tool, or a surface of it, passes right through a body.
#[derive(Serialize)]
struct GroupRow<'a> {
    surface: Option<&'a str>,
    first_line: usize,
    last_line: usize,
    motions: usize,
}

impl<'a> GroupRow<'a> {
    /// Returns the groups of a finding that has several; none of one with a single group.
    fn all(info: &'a ToolInfo, groups: &[FindingGroup]) -> Vec<GroupRow<'a>> {
        if groups.len() == 1 {
            return Vec::new();
        }
        let rows = groups.iter().map(|group| GroupRow {
            surface: group.worst.kind.surface().map(|surface| &*info.surface(surface).name),
            first_line: group.first.line,
            last_line: group.last.line,
            motions: group.motions,
        });
        rows.collect()
    }
}

/// A tilt of the axis about the tip.
#[derive(Serialize)]
struct TiltRow {
    degrees: f64,
    /// The tilted axis.
    axis: [f64; 3],
}

/// The measurements of a finding.
#[derive(Serialize)]
#[serde(untagged)]
enum Measurement {
    Deep { allowed_depth: f64, depth: [f64; 2], depth_bound: f64, through: bool },
    Near { margin: f64, distance: [f64; 2], distance_bound: f64 },
}

/// A point on the part or the fixture.
#[derive(Serialize)]
struct BodyPoint {
    triangle: u32,
    point: [f64; 3],
}

impl BodyPoint {
    fn of(witness: &Witness) -> BodyPoint {
        BodyPoint { triangle: witness.triangle.0, point: witness.point.into() }
    }
}

impl<'a> SurfaceRow<'a> {
    fn of(
        report: &'a JobReport<'_>,
        pair: &PairReport,
        group: &FindingGroup,
        remedy: Remedy,
    ) -> SurfaceRow<'a> {
        let info = report.info(pair);
        let finding = &group.worst;
        let (measurement, point) = match finding.kind {
            FindingKind::Deep { allowed, depth, max_depth, through, witness, .. } => {
                let deep = Measurement::Deep {
                    allowed_depth: allowed,
                    depth: depth.into(),
                    depth_bound: max_depth,
                    through,
                };
                (Some(deep), Some(BodyPoint::of(&witness)))
            }
            FindingKind::Near { margin, distance, min_distance, witness, .. } => {
                let near = Measurement::Near {
                    margin,
                    distance: distance.into(),
                    distance_bound: min_distance,
                };
                (Some(near), Some(BodyPoint::of(&witness)))
            }
            FindingKind::Inside { .. }
            | FindingKind::Undecided { .. }
            | FindingKind::Ambiguous(_) => (None, None),
        };
        let surface = finding.kind.surface().map(|surface| &info.surfaces[surface.0]);
        let quaternion = match info.symmetry {
            Symmetry::Revolved => None,
            Symmetry::Solid { .. } => Some(finding.pose.to_isometry().rotation.coords.into()),
        };
        SurfaceRow {
            file: report.job.program.name(),
            line: finding.line,
            first_line: group.first.line,
            last_line: group.last.line,
            motions: group.motions,
            groups: Vec::new(),
            from_line: finding.from,
            location: finding.location,
            rapid: finding.rapid,
            any_rates: finding.any_rates,
            fraction: finding.time,
            unit: report.job.unit().symbol(),
            tip: finding.pose.tip().into(),
            axis: finding.pose.axis().into(),
            quaternion,
            body: &report.body(pair).name,
            tool: report.revolved(pair).map_or(&*info.name, |body| &*body.name),
            tool_number: report.tool(pair).and_then(JobTool::number),
            kind: FindingRule::of(&finding.kind).keyword(),
            surface: surface.map(|surface| &*surface.name),
            cutting: surface.map(|surface| surface.cutting),
            measurement,
            point,
            lift: remedy.lift,
            tilt: remedy
                .tilt
                .map(|tilt| TiltRow { degrees: tilt.angle.to_degrees(), axis: tilt.axis.into() }),
        }
    }
}

/// A gap as a JSON object.
#[derive(Serialize)]
struct GapRow<'a> {
    file: &'a str,
    line: usize,
    /// The line in the file of subprograms that has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    within: Option<SubprogramRow<'a>>,
    kind: &'static str,
    /// The code of its cause.
    code: &'static str,
    /// Set if it allows no verdict.
    open: bool,
    reason: Cow<'a, str>,
}

#[derive(Serialize)]
struct Log {
    #[serde(rename = "$schema")]
    schema: &'static str,
    version: &'static str,
    runs: [Run; 1],
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Run {
    tool: Tool,
    automation_details: AutomationDetails,
    invocations: [Invocation; 1],
    results: Vec<Finding>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Invocation {
    /// Set if there is a verdict.
    execution_successful: bool,
    /// The reasons for which there is none.
    tool_execution_notifications: Vec<Notification>,
}

#[derive(Serialize)]
struct AutomationDetails {
    id: String,
}

#[derive(Serialize)]
struct Notification {
    descriptor: Descriptor,
    level: &'static str,
    message: Text,
}

#[derive(Serialize)]
struct Descriptor {
    id: &'static str,
}

#[derive(Serialize)]
struct Tool {
    driver: Driver,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Driver {
    name: &'static str,
    version: &'static str,
    rules: Vec<Rule>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Rule {
    id: &'static str,
    /// The keyword.
    name: &'static str,
    short_description: Text,
    help: Text,
}

#[derive(Serialize)]
struct Text {
    text: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Finding {
    rule_id: &'static str,
    level: &'static str,
    message: Text,
    locations: [Location; 1],
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Location {
    physical_location: PhysicalLocation,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PhysicalLocation {
    artifact_location: Artifact,
    region: Region,
}

#[derive(Serialize)]
struct Artifact {
    uri: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: usize,
    end_line: usize,
}

/// Returns the rules, with what each finds.
fn rules() -> Vec<Rule> {
    let rules = FindingRule::ALL.iter().zip(FindingRule::FAMILY.entries());
    rules
        .map(|(rule, entry)| Rule {
            id: rule.code(),
            name: rule.keyword(),
            short_description: Text { text: entry.title() },
            help: Text { text: entry.help() },
        })
        .collect()
}

/// Returns the findings of a job as a SARIF log.
fn log(report: &JobReport<'_>, job: &str) -> Log {
    let uri = uri(report.job.program.name());
    let results = report
        .findings()
        .iter()
        .map(|finding| Finding {
            rule_id: finding.rule.code(),
            level: if finding.severity == Severity::Violation { "error" } else { "warning" },
            message: Text { text: message(&finding.text) },
            locations: [Location {
                physical_location: PhysicalLocation {
                    artifact_location: Artifact { uri: uri.clone() },
                    // Subprograms may stand before the blocks that call them.
                    region: Region {
                        start_line: finding.lines[0].min(finding.lines[1]),
                        end_line: finding.lines[0].max(finding.lines[1]),
                    },
                },
            }],
        })
        .collect();
    let driver = Driver { name: "touchoff", version: env!("CARGO_PKG_VERSION"), rules: rules() };
    Log {
        schema: "https://json.schemastore.org/sarif-2.1.0.json",
        version: "2.1.0",
        runs: [Run {
            tool: Tool { driver },
            // The part before the last `/` is the category (section 3.17.3 of SARIF 2.1.0).
            automation_details: AutomationDetails { id: format!("touchoff/{}/", Escaped(job)) },
            invocations: [Invocation {
                execution_successful: report.verdict() != Verdict::None,
                tool_execution_notifications: report
                    .refusals()
                    .iter()
                    .map(|reason| Notification {
                        descriptor: Descriptor { id: reason.code() },
                        level: "error",
                        message: Text { text: message(&reason.to_string()) },
                    })
                    .collect(),
            }],
            results,
        }],
    }
}

/// Returns a text as the message of a result, whose names are no links (section 3.11.6 of SARIF 2.1.0), no placeholders (3.11.5) and
/// no control characters.
fn message(text: &str) -> String {
    let mut message = String::new();
    for character in Escaped(text).to_string().chars() {
        match character {
            '\\' | '[' | ']' => message.push('\\'),
            '{' | '}' => message.push(character),
            _ => {}
        }
        message.push(character);
    }
    message
}

/// Returns a relative URI reference for a path, with all but unreserved characters and `/` percent-encoded (RFC 3986).
fn uri(path: &str) -> String {
    let mut uri = String::new();
    let path = if cfg!(windows) { path.replace('\\', "/") } else { path.to_owned() };
    for byte in path.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(char::from(byte));
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_no_links_and_no_other_files() {
        let name = "[a](http://b) \\[c\\](d) {0} \u{1b}[31m é";
        let shown = "\\[a\\](http://b) \\\\\\[c\\\\\\](d) {{0}} \\\\u001b\\[31m é";
        assert_eq!(message(name), shown);
        assert_eq!(uri("a b/%é.nc"), "a%20b/%25%C3%A9.nc");
        #[cfg(not(windows))]
        assert_eq!(uri("a\\b.nc"), "a%5Cb.nc");
    }
}
