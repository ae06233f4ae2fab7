//! `touchoff verify`: a program checked against a part. Prints one line per finding, as compilers do, and a
//! summary.

use crate::arguments::Verify;
use crate::failure::Failure;
use crate::lengths::{format_length, format_number};
use crate::loaded_tool::LoadedTool;
use crate::output::Output;
use crate::part::{self, NO_INSIDE};
use crate::program;
use crate::progress::Progress;
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::io::Write;
use std::process::ExitCode;
use touchoff::certify::{TriangleBvh, Witness};
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::verify::{Finding, FindingKind, Verifier, VerifyReport};
use touchoff::{Interval, SurfaceId, Unit};

/// The exit status if there are findings.
const FOUND: u8 = 1;

/// The exit status if there is no verdict, even with findings; the same as for wrong options.
pub(crate) const NOT_CHECKED: u8 = 2;

/// One finding.
#[derive(Serialize)]
struct Row<'a> {
    file: &'a str,
    line: usize,
    /// The line at which the motion begins.
    from_line: Option<usize>,
    /// The index of the cutter location at which it ends, from 0.
    location: usize,
    rapid: bool,
    /// The fraction of the motion at which the tool is at `tip` and `axis`, from 0 to 1.
    fraction: f64,
    /// Unit of lengths.
    unit: &'static str,
    tip: [f64; 3],
    axis: [f64; 3],
    /// For a solid without an axis, whose pose needs the spin: `qx, qy, qz, qw`.
    #[serde(skip_serializing_if = "Option::is_none")]
    quaternion: Option<[f64; 4]>,
    kind: &'static str,
    surface: Option<&'a str>,
    cutting: Option<bool>,
    #[serde(flatten)]
    measurement: Option<Measurement>,
    #[serde(flatten)]
    point: Option<PartPoint>,
}

/// The measurements of a finding.
#[derive(Serialize)]
#[serde(untagged)]
enum Measurement {
    Deep { allowed_depth: f64, depth: [f64; 2], depth_bound: f64, through: bool },
    Near { margin: f64, distance: [f64; 2], distance_bound: f64 },
}

/// A point on the part.
#[derive(Serialize)]
struct PartPoint {
    triangle: u32,
    point: [f64; 3],
}

impl PartPoint {
    fn of(witness: &Witness) -> PartPoint {
        PartPoint { triangle: witness.triangle.0, point: witness.point.into() }
    }
}

impl<'a> Row<'a> {
    fn of(finding: &Finding, info: &'a ToolInfo, (file, unit): (&'a str, Unit)) -> Row<'a> {
        let (kind, measurement, point) = match finding.kind {
            FindingKind::Deep { allowed, depth, max_depth, through, witness, .. } => {
                let deep = Measurement::Deep {
                    allowed_depth: allowed,
                    depth: depth.into(),
                    depth_bound: max_depth,
                    through,
                };
                ("deep", Some(deep), Some(PartPoint::of(&witness)))
            }
            FindingKind::Near { margin, distance, min_distance, witness, .. } => {
                let near = Measurement::Near {
                    margin,
                    distance: distance.into(),
                    distance_bound: min_distance,
                };
                ("near", Some(near), Some(PartPoint::of(&witness)))
            }
            FindingKind::Inside { .. } => ("inside", None, None),
            FindingKind::Undecided { .. } => ("undecided", None, None),
            FindingKind::Ambiguous(_) => ("ambiguous", None, None),
        };
        let surface = finding.kind.surface().map(|surface| &info.surfaces[surface.0]);
        let (tip, axis): (Point3<f64>, Vector3<f64>) = (finding.pose.tip(), finding.pose.axis());
        let quaternion = match info.symmetry {
            Symmetry::Revolved => None,
            Symmetry::Solid { .. } => Some(finding.pose.to_isometry().rotation.coords.into()),
        };
        Row {
            file,
            line: finding.line,
            from_line: finding.from,
            location: finding.location,
            rapid: finding.rapid,
            fraction: finding.time,
            unit: unit.symbol(),
            tip: tip.into(),
            axis: axis.into(),
            quaternion,
            kind,
            surface: surface.map(|surface| &*surface.name),
            cutting: surface.map(|surface| surface.cutting),
            measurement,
            point,
        }
    }
}

/// Checks a program against a part, and returns the exit status.
pub(crate) fn verify(arguments: &Verify, json: bool) -> Result<ExitCode, Failure> {
    let loaded = LoadedTool::load(&arguments.tool, &arguments.params)?;
    let unit = arguments.mesh.unit;
    let program = program::read(&arguments.program, loaded.tool().info(), unit)?;
    program.check_motions()?;
    let mesh = part::mesh(&arguments.mesh.part, unit, "verify")?;
    let bvh = TriangleBvh::new(&mesh);
    let mut verifier = Verifier::new(&bvh, loaded.tool())?.with_tolerance(arguments.tolerance)?;
    if let Some(resolution) = arguments.resolution {
        verifier = verifier.with_resolution(resolution)?;
    }
    for (surface, allowed) in &arguments.allow {
        verifier = verifier.with_allowance(surface, *allowed)?;
    }
    let progress = Progress::steps(program.locations.len(), "motions", json);
    let report = verifier.check_with_progress(&program, &|count| progress.advance(count))?;
    drop(progress);
    let file = arguments.program.display().to_string();
    let info = verifier.info();
    let mut out = Output::rows();
    for finding in &report.findings {
        if json {
            serde_json::to_writer(&mut out, &Row::of(finding, info, (&file, unit)))?;
            writeln!(out)?;
        } else {
            let (line, text) = (finding.line, describe(finding, info, unit));
            writeln!(out, "{file}:{line}: {text}")?;
        }
    }
    out.flush()?;
    program::print(&report, &program, unit);
    message!("{}", summary(&report, info, unit));
    Ok(ExitCode::from(status(&report, arguments)))
}

/// Returns the exit status, and reports why there is no verdict.
fn status(report: &VerifyReport, arguments: &Verify) -> u8 {
    let mut status = if report.findings.is_empty() { 0 } else { FOUND };
    if !report.inside_known {
        if arguments.surface_only {
            message!("{NO_INSIDE}; only its surface was checked");
        } else {
            message!(
                "not verified: {NO_INSIDE}: repair the mesh, or check its surface alone with `--surface-only`"
            );
            status = NOT_CHECKED;
        }
    }
    if report.unrestricted {
        message!(
            "not verified: `--tolerance`, `--allow` and `--resolution` allow every surface its greatest possible \
             depth, so nothing could be found: lower them"
        );
        status = NOT_CHECKED;
    }
    if report.approach.is_far() && !arguments.allow_distant {
        message!(
            "not verified: the program never comes within the tool's diameter of the part: check the part, its \
             position and its unit, or accept the program with `--allow-distant`"
        );
        status = NOT_CHECKED;
    }
    status
}

/// Formats a finding for people.
fn describe(finding: &Finding, info: &ToolInfo, unit: Unit) -> String {
    let name = |surface| &*info.surface(surface).name;
    let at = match finding.from {
        Some(from) => format!("at fraction {:.2} of the motion from line {from}", finding.time),
        None => "at the first cutter location".to_owned(),
    };
    let at = if finding.rapid { format!("{at}, in rapid traverse") } else { at };
    match &finding.kind {
        FindingKind::Deep { surface, through: true, witness, .. } => {
            format!("{} passes right through triangle {}, {at}", name(*surface), witness.triangle)
        }
        FindingKind::Deep {
            surface, depth: Interval { low, high }, max_depth, witness, ..
        } => {
            let more = if max_depth > high && finding.from.is_some() {
                format!("; at most {} {unit} during this motion", format_small(*max_depth, unit))
            } else {
                String::new()
            };
            let (name, depth) = (name(*surface), format_interval(*low, *high, unit));
            format!("{name} is {depth} {unit} deep in triangle {}, {at}{more}", witness.triangle)
        }
        FindingKind::Near {
            surface, margin, distance: Interval { low, high }, witness, ..
        } => format!(
            "{} is {} {unit} from triangle {}, less than its margin of {margin} {unit}, {at}",
            name(*surface),
            format_interval(*low, *high, unit),
            witness.triangle,
        ),
        FindingKind::Inside { surface: None } => {
            format!("the tool is wholly inside the material, {at}")
        }
        FindingKind::Inside { surface: Some(surface) } => {
            format!("{} is inside the material, away from all triangles, {at}", name(*surface))
        }
        FindingKind::Undecided { surface } => format!(
            "it is not decided whether {} is too deep from here on, {at}: try a larger `--resolution`",
            name(*surface)
        ),
        FindingKind::Ambiguous(error) => format!("{error}; only this cutter location was checked"),
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
    let text = format_number(value, unit);
    let digits = text.chars().filter(|c| ('1'..='9').contains(c)).count();
    if value == 0.0 || digits > 1 || value.abs() >= 0.01 / unit.millimetres() {
        text
    } else {
        format!("{value:.2e}")
    }
}

/// Summarises all findings: per surface, their number and the deepest.
fn summary(report: &VerifyReport, info: &ToolInfo, unit: Unit) -> String {
    let motions = report.motions;
    let plural = |count: usize| if count == 1 { "" } else { "s" };
    let count = report.findings.len();
    if count == 0 {
        return format!("no findings in {motions} motion{}", plural(motions));
    }
    let mut each = Vec::new();
    for (index, surface) in info.surfaces.iter().enumerate() {
        let of = || {
            report
                .findings
                .iter()
                .filter(|finding| finding.kind.surface() == Some(SurfaceId(index)))
        };
        let deepest = of().filter_map(|finding| match finding.kind {
            FindingKind::Deep { depth, .. } => Some((depth.high, finding.line)),
            _ => None,
        });
        let deepest = deepest.max_by(|(one, _), (other, _)| one.total_cmp(other));
        let deepest = deepest.map_or(String::new(), |(depth, line)| {
            format!(" (deepest {}, line {line})", format_length(depth, unit))
        });
        if of().next().is_some() {
            each.push(format!("{} {}{deepest}", surface.name, of().count()));
        }
    }
    let count_of = |is: fn(&FindingKind) -> bool| {
        report.findings.iter().filter(|finding| is(&finding.kind)).count()
    };
    let inside = count_of(|kind| *kind == FindingKind::Inside { surface: None });
    let ambiguous = count_of(|kind| matches!(kind, FindingKind::Ambiguous(_)));
    for (word, count) in [("wholly inside", inside), ("ambiguous", ambiguous)] {
        if count > 0 {
            each.push(format!("{word} {count}"));
        }
    }
    let each = each.join(", ");
    format!("{count} finding{} in {motions} motion{}: {each}", plural(count), plural(motions))
}
