//! A program held to a part: a line a finding, as compilers print them, a summary at the end.

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
use touchoff::certify::{Facets, Witness};
use touchoff::tool::{Card, Shape};
use touchoff::verify::{Finding, Kind, Report, Verifier};

/// The exit status where something is found.
const FOUND: u8 = 1;

/// The exit status where nothing could be checked, as that of wrong options.
pub(crate) const NOT_CHECKED: u8 = 2;

/// One finding.
#[derive(Serialize)]
struct Row<'a> {
    file: &'a str,
    line: usize,
    /// The line that the motion begins at.
    from: Option<usize>,
    /// The stop that it ends at, from 0.
    stop: usize,
    rapid: bool,
    /// The part of the way, from 0 to 1.
    part: f64,
    tip: [f64; 3],
    axis: [f64; 3],
    /// Of a solid without an axis, whose axis does not place it: `qx, qy, qz, qw`.
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

/// What a finding measures.
#[derive(Serialize)]
#[serde(untagged)]
enum Measured {
    Deep { allowed: f64, depth: [f64; 2], most: f64, through: bool },
    Near { margin: f64, distance: [f64; 2], least: f64 },
}

/// Where on the part.
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
    fn of(found: &Finding, card: &'a Card, file: &'a str) -> Row<'a> {
        let (kind, measured, place) = match found.kind {
            Kind::Deep { allowed, depth, most, through, witness, .. } => {
                let deep = Measured::Deep { allowed, depth, most, through };
                ("deep", Some(deep), Some(Place::of(&witness)))
            }
            Kind::Near { margin, distance, least, witness, .. } => {
                let near = Measured::Near { margin, distance, least };
                ("near", Some(near), Some(Place::of(&witness)))
            }
            Kind::Inside { .. } => ("inside", None, None),
            Kind::Undecided { .. } => ("undecided", None, None),
            Kind::Ambiguous(_) => ("ambiguous", None, None),
        };
        let surface = found.kind.surface().map(|surface| &card.surfaces[surface]);
        let (tip, axis): (Point3<f64>, Vector3<f64>) = (found.pose.tip(), found.pose.axis());
        let quaternion = match card.shape {
            Shape::Revolved => None,
            Shape::Solid { .. } => Some(found.pose.isometry().rotation.coords.into()),
        };
        Row {
            file,
            line: found.line,
            from: found.from,
            stop: found.stop,
            rapid: found.rapid,
            part: found.part,
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

/// Holds a program to a part.
pub(crate) fn verify(wanted: &Verify, json: bool) -> Result<ExitCode, Failure> {
    let found = Found::find(&wanted.tool, &wanted.given)?;
    let unit = wanted.mesh.unit;
    let program = program::read(&wanted.program, found.tool().card(), unit)?;
    program.check_motions()?;
    let mesh = part::mesh(&wanted.mesh.part, unit, "verify")?;
    let facets = Facets::new(&mesh);
    let mut verifier = Verifier::new(&facets, found.tool())?.tolerance(wanted.tolerance)?;
    if let Some(resolution) = wanted.resolution {
        verifier = verifier.resolution(resolution)?;
    }
    for (surface, allowed) in &wanted.allow {
        verifier = verifier.allow(surface, *allowed)?;
    }
    let report = verifier.check(&program)?;
    let file = wanted.program.display().to_string();
    let card = verifier.card();
    let mut out = Output::rows();
    for finding in &report.findings {
        if json {
            serde_json::to_writer(&mut out, &Row::of(finding, card, &file))?;
            writeln!(out)?;
        } else {
            let (line, said) = (finding.line, shown(finding, card, unit));
            writeln!(out, "{file}:{line}: {said}")?;
        }
    }
    out.flush()?;
    program::print(&report, &program, unit);
    say!("{}", summary(&report, card, unit));
    Ok(ExitCode::from(status(&report, wanted)))
}

/// The exit status: why there is no verdict is said.
fn status(report: &Report, wanted: &Verify) -> u8 {
    let mut status = if report.findings.is_empty() { 0 } else { FOUND };
    if !report.inside_known {
        if wanted.surface_only {
            say!("{NO_INSIDE}; only its surface was checked");
        } else {
            say!("not verified: {NO_INSIDE}; mend the mesh, or give `--surface-only`");
            status = NOT_CHECKED;
        }
    }
    if report.nothing_restricted {
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

/// A finding for people.
fn shown(found: &Finding, card: &Card, unit: Unit) -> String {
    let name = |surface: usize| &*card.surfaces[surface].name;
    let at = match found.from {
        Some(from) => format!("{:.2} of the way from line {from}", found.part),
        None => "where the program begins".to_owned(),
    };
    let at = if found.rapid { format!("{at}, in rapid traverse") } else { at };
    match &found.kind {
        Kind::Deep { surface, through: true, witness, .. } => {
            format!("{} goes right through triangle {}, {at}", name(*surface), witness.triangle)
        }
        Kind::Deep { surface, depth: [low, high], most, witness, .. } => {
            let more = if most > high && found.from.is_some() {
                format!(", nowhere on it more than {}", fine(*most, unit))
            } else {
                String::new()
            };
            let (name, depth) = (name(*surface), between(*low, *high, unit));
            format!("{name} is {depth} {unit} deep in triangle {}, {at}{more}", witness.triangle)
        }
        Kind::Near { surface, margin, distance: [low, high], witness, .. } => format!(
            "{} is {} {unit} from triangle {}, not {margin}, {at}",
            name(*surface),
            between(*low, *high, unit),
            witness.triangle,
        ),
        Kind::Inside { surface: None } => {
            format!("the tool is wholly inside the material, {at}")
        }
        Kind::Inside { surface: Some(surface) } => {
            format!("{} is inside the material, where no triangle is, {at}", name(*surface))
        }
        Kind::Undecided { surface } => format!(
            "whether {} is too deep is not decided, beginning {at}: try a larger `--resolution`",
            name(*surface)
        ),
        Kind::Ambiguous(error) => format!("{error}; only this stop was checked"),
    }
}

/// From where to where, as far as figures differ.
fn between(low: f64, high: f64, unit: Unit) -> String {
    let [low, high] = [low, high].map(|value| fine(value, unit));
    if low == high { high } else { format!("{low} to {high}") }
}

/// A length as elsewhere, or with its power of ten where that would leave little of it.
fn fine(value: f64, unit: Unit) -> String {
    let shown = figure(value, unit);
    let digits = shown.chars().filter(|c| ('1'..='9').contains(c)).count();
    if value == 0.0 || digits > 1 || value.abs() >= 0.01 / unit.millimetres() {
        shown
    } else {
        format!("{value:.2e}")
    }
}

/// What all findings came to: of each surface how many, and its deepest.
fn summary(report: &Report, card: &Card, unit: Unit) -> String {
    let motions = report.motions;
    let plural = |count: usize| if count == 1 { "" } else { "s" };
    let count = report.findings.len();
    if count == 0 {
        return format!("no findings in {motions} motion{}", plural(motions));
    }
    let mut each = Vec::new();
    for (index, surface) in card.surfaces.iter().enumerate() {
        let of = || report.findings.iter().filter(|found| found.kind.surface() == Some(index));
        let deepest = of().filter_map(|found| match found.kind {
            Kind::Deep { depth, .. } => Some((depth[1], found.line)),
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
    let count_of =
        |is: fn(&Kind) -> bool| report.findings.iter().filter(|found| is(&found.kind)).count();
    let inside = count_of(|kind| *kind == Kind::Inside { surface: None });
    let ambiguous = count_of(|kind| matches!(kind, Kind::Ambiguous(_)));
    for (word, count) in [("wholly inside", inside), ("ambiguous", ambiguous)] {
        if count > 0 {
            each.push(format!("{word} {count}"));
        }
    }
    let each = each.join(", ");
    format!("{count} finding{} in {motions} motion{}: {each}", plural(count), plural(motions))
}
