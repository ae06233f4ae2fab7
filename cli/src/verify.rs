//! `touchoff verify`: a program checked against a part. Prints one line per finding, as compilers do, and a
//! summary.

use crate::arguments::Verify;
use crate::failure::Failure;
use crate::files::{Found, figure, length};
use crate::output::Output;
use crate::part::{self, NO_INSIDE};
use crate::program;
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::io::Write;
use std::process::ExitCode;
use touchoff::Unit;
use touchoff::certify::{TriangleBvh, Witness};
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::verify::{Finding, FindingKind, Verifier, VerifyReport};

/// The exit status if there are findings.
const FOUND: u8 = 1;

/// The exit status if nothing could be checked, the same as for wrong options.
pub(crate) const NOT_CHECKED: u8 = 2;

/// One finding.
#[derive(Serialize)]
struct Row<'a> {
    file: &'a str,
    line: usize,
    /// The line at which the motion begins.
    from: Option<usize>,
    /// The index of the cutter location at which it ends, from 0.
    stop: usize,
    rapid: bool,
    /// The fraction of the motion, from 0 to 1.
    part: f64,
    tip: [f64; 3],
    axis: [f64; 3],
    /// For a solid without an axis, whose pose needs the spin: `qx, qy, qz, qw`.
    #[serde(skip_serializing_if = "Option::is_none")]
    quaternion: Option<[f64; 4]>,
    kind: &'static str,
    surface: Option<&'a str>,
    cutting: Option<bool>,
    #[serde(flatten)]
    measured: Option<Measured>,
    #[serde(flatten)]
    place: Option<Place>,
}

/// The measurements of a finding.
#[derive(Serialize)]
#[serde(untagged)]
enum Measured {
    Deep { allowed: f64, depth: [f64; 2], most: f64, through: bool },
    Near { margin: f64, distance: [f64; 2], least: f64 },
}

/// A point on the part.
#[derive(Serialize)]
struct Place {
    triangle: u32,
    point: [f64; 3],
}

impl Place {
    fn of(witness: &Witness) -> Place {
        Place { triangle: witness.triangle, point: witness.point.into() }
    }
}

impl<'a> Row<'a> {
    fn of(found: &Finding, info: &'a ToolInfo, file: &'a str) -> Row<'a> {
        let (kind, measured, place) = match found.kind {
            FindingKind::Deep { allowed, depth, most, through, witness, .. } => {
                let deep = Measured::Deep { allowed, depth, most, through };
                ("deep", Some(deep), Some(Place::of(&witness)))
            }
            FindingKind::Near { margin, distance, least, witness, .. } => {
                let near = Measured::Near { margin, distance, least };
                ("near", Some(near), Some(Place::of(&witness)))
            }
            FindingKind::Inside { .. } => ("inside", None, None),
            FindingKind::Undecided { .. } => ("undecided", None, None),
            FindingKind::Ambiguous(_) => ("ambiguous", None, None),
        };
        let surface = found.kind.surface().map(|surface| &info.surfaces[surface]);
        let (tip, axis): (Point3<f64>, Vector3<f64>) = (found.pose.tip(), found.pose.axis());
        let quaternion = match info.symmetry {
            Symmetry::Revolved => None,
            Symmetry::Solid { .. } => Some(found.pose.to_isometry().rotation.coords.into()),
        };
        Row {
            file,
            line: found.line,
            from: found.from,
            stop: found.location,
            rapid: found.rapid,
            part: found.time,
            tip: tip.into(),
            axis: axis.into(),
            quaternion,
            kind,
            surface: surface.map(|surface| &*surface.name),
            cutting: surface.map(|surface| surface.cutting),
            measured,
            place,
        }
    }
}

/// Checks a program against a part, and returns the exit status.
pub(crate) fn verify(wanted: &Verify, json: bool) -> Result<ExitCode, Failure> {
    let found = Found::find(&wanted.tool, &wanted.given)?;
    let unit = wanted.mesh.unit;
    let program = program::read(&wanted.program, found.tool().info(), unit)?;
    program.check_motions()?;
    let mesh = part::mesh(&wanted.mesh.part, unit, "verify")?;
    let bvh = TriangleBvh::new(&mesh);
    let mut verifier = Verifier::new(&bvh, found.tool())?.with_tolerance(wanted.tolerance)?;
    if let Some(resolution) = wanted.resolution {
        verifier = verifier.with_resolution(resolution)?;
    }
    for (surface, allowed) in &wanted.allow {
        verifier = verifier.with_allowance(surface, *allowed)?;
    }
    let report = verifier.check(&program)?;
    let file = wanted.program.display().to_string();
    let info = verifier.info();
    let mut out = Output::rows();
    for finding in &report.findings {
        if json {
            serde_json::to_writer(&mut out, &Row::of(finding, info, &file))?;
            writeln!(out)?;
        } else {
            let (line, said) = (finding.line, shown(finding, info, unit));
            writeln!(out, "{file}:{line}: {said}")?;
        }
    }
    out.flush()?;
    program::print(&report, &program, unit);
    say!("{}", summary(&report, info, unit));
    Ok(ExitCode::from(status(&report, wanted)))
}

/// Returns the exit status, and reports why there is no verdict.
fn status(report: &VerifyReport, wanted: &Verify) -> u8 {
    let mut status = if report.findings.is_empty() { 0 } else { FOUND };
    if !report.inside_known {
        if wanted.surface_only {
            say!("{NO_INSIDE}; only its surface was checked");
        } else {
            say!("not verified: {NO_INSIDE}; mend the mesh, or give `--surface-only`");
            status = NOT_CHECKED;
        }
    }
    if report.unrestricted {
        say!(
            "not verified: no surface of the tool can be deeper than it may be by more than the resolution; lower \
             `--tolerance`, `--allow` or `--resolution`"
        );
        status = NOT_CHECKED;
    }
    if report.approach.is_far() && !wanted.anyway {
        say!(
            "not verified: the program never comes within the tool's diameter of the part; is it the right part, \
             place and unit? `--anyway` takes it as it is"
        );
        status = NOT_CHECKED;
    }
    status
}

/// Formats a finding for people.
fn shown(found: &Finding, info: &ToolInfo, unit: Unit) -> String {
    let name = |surface: usize| &*info.surfaces[surface].name;
    let at = match found.from {
        Some(from) => format!("{:.2} of the way from line {from}", found.time),
        None => "where the program begins".to_owned(),
    };
    let at = if found.rapid { format!("{at}, in rapid traverse") } else { at };
    match &found.kind {
        FindingKind::Deep { surface, through: true, witness, .. } => {
            format!("{} goes right through triangle {}, {at}", name(*surface), witness.triangle)
        }
        FindingKind::Deep { surface, depth: [low, high], most, witness, .. } => {
            let more = if most > high && found.from.is_some() {
                format!(", nowhere on it more than {}", fine(*most, unit))
            } else {
                String::new()
            };
            let (name, depth) = (name(*surface), between(*low, *high, unit));
            format!("{name} is {depth} {unit} deep in triangle {}, {at}{more}", witness.triangle)
        }
        FindingKind::Near { surface, margin, distance: [low, high], witness, .. } => format!(
            "{} is {} {unit} from triangle {}, not {margin}, {at}",
            name(*surface),
            between(*low, *high, unit),
            witness.triangle,
        ),
        FindingKind::Inside { surface: None } => {
            format!("the tool is wholly inside the material, {at}")
        }
        FindingKind::Inside { surface: Some(surface) } => {
            format!("{} is inside the material, where no triangle is, {at}", name(*surface))
        }
        FindingKind::Undecided { surface } => format!(
            "whether {} is too deep is not decided, beginning {at}: try a larger `--resolution`",
            name(*surface)
        ),
        FindingKind::Ambiguous(error) => format!("{error}; only this stop was checked"),
    }
}

/// Formats an interval, as one number if both ends print alike.
fn between(low: f64, high: f64, unit: Unit) -> String {
    let [low, high] = [low, high].map(|value| fine(value, unit));
    if low == high { high } else { format!("{low} to {high}") }
}

/// Formats a length as elsewhere, or with an exponent if it is small and would keep fewer than two digits other
/// than 0.
fn fine(value: f64, unit: Unit) -> String {
    let shown = figure(value, unit);
    let digits = shown.chars().filter(|c| ('1'..='9').contains(c)).count();
    if value == 0.0 || digits > 1 || value.abs() >= 0.01 / unit.millimetres() {
        shown
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
        let of = || report.findings.iter().filter(|found| found.kind.surface() == Some(index));
        let deepest = of().filter_map(|found| match found.kind {
            FindingKind::Deep { depth, .. } => Some((depth[1], found.line)),
            _ => None,
        });
        let deepest = deepest.max_by(|(one, _), (other, _)| one.total_cmp(other));
        let deepest = deepest.map_or(String::new(), |(depth, line)| {
            format!(" (deepest {}, line {line})", length(depth, unit))
        });
        if of().next().is_some() {
            each.push(format!("{} {}{deepest}", surface.name, of().count()));
        }
    }
    let count_of = |is: fn(&FindingKind) -> bool| {
        report.findings.iter().filter(|found| is(&found.kind)).count()
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
