//! What is wrong with files, and what is proved about those that are right.

use crate::arguments::Given;
use crate::failure::Failure;
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use tool_dsl::domain::Domain;
use tool_dsl::expr::interval::Interval;
use tool_dsl::prove::{Border, Certificate, RegionFacts};
use tool_dsl::report::{self, Severity, figure};
use tool_dsl::{Checked, compile_with};
use touchoff::tool::Interpreted;

/// Shows what is wrong with files, and of those that are right what is proved.
pub(crate) fn check(files: &[PathBuf], given: &Given, json: bool) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let styled = std::io::stderr().is_terminal();
    let mut wrong = 0;
    for file in files {
        let source = match Interpreted::source(file) {
            Ok(source) => source,
            Err(error) => {
                say!("error: {error}");
                wrong += 1;
                continue;
            }
        };
        let compiled = compile_with(&source, &given.sources());
        for report in &compiled.reports {
            say!("{}\n", report.render(&compiled.sources, styled));
        }
        let Some(tool) = &compiled.tool else {
            wrong += 1;
            continue;
        };
        let is_warning = |r: &&report::Report| r.severity == Severity::Warning;
        let warnings = compiled.reports.iter().filter(is_warning).count();
        let certificate = Certificate::of(tool);
        if json {
            serde_json::to_writer(&mut out, &Proved::of(tool, &certificate))?;
            writeln!(out)?;
        } else {
            writeln!(out, "{}: {}", file.display(), described(tool, warnings))?;
            table(&mut out, tool, &certificate)?;
        }
    }
    out.flush()?;
    if wrong > 0 { Err(Failure::Files { wrong, all: files.len() }) } else { Ok(()) }
}

fn described(tool: &Checked, warnings: usize) -> String {
    let model = &tool.model;
    let unit = model.unit.word();
    let cutting: Vec<&str> =
        model.surfaces.iter().filter(|s| s.cutting).map(|s| s.name.as_str()).collect();
    let extent = &tool.extent;
    let size = match model.domain {
        Domain::HalfPlane => format!(
            "{} {unit} long and {} {unit} in radius",
            report::figure(extent.high - extent.low),
            report::figure(extent.radius),
        ),
        Domain::Space => {
            let sides = extent.cell().sides;
            let [x, y, z] = sides.map(|side| report::figure(side.high - side.low));
            format!("a solid of {x} by {y} by {z} {unit}")
        }
    };
    format!(
        "{} is {size}; {} regions, {} curves, cutting: {}; {warnings} {}",
        model.name,
        model.regions.len(),
        model.curves.len(),
        if cutting.is_empty() { "nothing".to_owned() } else { cutting.join(", ") },
        if warnings == 1 { "warning" } else { "warnings" },
    )
}

/// The certificate for people.
fn table(out: &mut impl Write, tool: &Checked, certificate: &Certificate) -> std::io::Result<()> {
    let model = &tool.model;
    writeln!(out, "\n  {}\n", verdict(certificate))?;
    let wide = |names: &mut dyn Iterator<Item = usize>| names.max().unwrap_or(0).max(8);
    let names = wide(&mut model.regions.iter().map(|region| region.name.len()));
    writeln!(
        out,
        "  {:<names$}  {:>7}  {:>13}  {:>15}  {:>13}  {:>8}  is",
        "region", "share", "depth", "steepness", "niceness", "rounding"
    )?;
    for (region, facts) in model.regions.iter().zip(&certificate.regions) {
        writeln!(
            out,
            "  {:<names$}  {:>5.1} %  {:>13}  {:>15}  {:>13}  {:>8.0e}  {}",
            region.name,
            100.0 * facts.share,
            range(facts.depth),
            range(facts.steepness),
            range(niceness(facts)),
            facts.rounding[0],
            kind(facts),
        )?;
    }
    let borders: Vec<(&Border, String)> = certificate
        .borders
        .iter()
        .filter(|border| border.jump.high > certificate.tolerance || border.is_joined())
        .filter(|border| border.between.1.is_some() || !border.is_joined())
        .map(|border| (border, pair(tool, border)))
        .collect();
    if borders.is_empty() {
        return writeln!(out);
    }
    let names = wide(&mut borders.iter().map(|(_, name)| name.len()));
    writeln!(
        out,
        "\n  {:<names$}  {:>13}  {:>13}  {:>15}  {:>15}",
        "border", "depth", "jump", "turn", "on the surface"
    )?;
    for (border, name) in borders {
        let on_surface = border.turn_on_surface.map_or("-".to_owned(), degrees);
        writeln!(
            out,
            "  {name:<names$}  {:>13}  {:>13}  {:>15}  {on_surface:>15}",
            range(border.depth),
            if border.is_joined() { "none".to_owned() } else { range(border.jump) },
            degrees(border.turn),
        )?;
    }
    for undecided in &certificate.undecided {
        let [x, _, z] = undecided.cell.sides.map(|side| figure(side.low));
        writeln!(out, "  not decided: {} near ({x}, {z})", undecided.what)?;
    }
    writeln!(out)
}

/// What a tool's depth is to the distance to its surface.
fn verdict(certificate: &Certificate) -> String {
    let proved = |bound: Option<f64>| bound.map(figure);
    let boxes = certificate.boxes;
    match (proved(certificate.least()), proved(certificate.lipschitz())) {
        _ if certificate.is_exact() => {
            format!("proved in {boxes} boxes: depth is the distance to the surface")
        }
        (Some(least), Some(most)) => format!(
            "proved in {boxes} boxes: depth is {least} to {most} times the distance to the surface"
        ),
        (None, Some(most)) => format!(
            "proved in {boxes} boxes: depth is at most {most} times the distance to the surface and \
             changes by at most {most} times the way; how much less it may be is not proved"
        ),
        _ => format!(
            "not proved in {boxes} boxes: that depth goes on without jumps; depth bounds no distance"
        ),
    }
}

fn kind(facts: &RegionFacts) -> &'static str {
    if facts.distance { "a distance" } else { "no distance" }
}

/// What counts of a region's niceness.
fn niceness(facts: &RegionFacts) -> Interval {
    let [low, high] = [facts.niceness.low, facts.niceness.high].map(|end| end.max(0.0));
    Interval::new(low, high)
}

fn pair(tool: &Checked, border: &Border) -> String {
    let regions = &tool.model.regions;
    let (own, other) = border.between;
    let other = other.map_or("outside", |other| regions[other].name.as_str());
    format!("{} | {other}", regions[own].name)
}

fn range(value: Interval) -> String {
    let [low, high] = [value.low, value.high].map(short);
    if low == high { low } else { format!("{low} to {high}") }
}

fn degrees(turn: Interval) -> String {
    let [low, high] = [turn.low, turn.high].map(|end| short(end.to_degrees()));
    if low == high { format!("{low}°") } else { format!("{low}° to {high}°") }
}

/// Four digits are enough to read.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    if !text.contains('.') {
        return text;
    }
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The certificate for programs.
#[derive(Serialize)]
struct Proved<'t> {
    tool: &'t str,
    unit: &'static str,
    /// `depth ≤ L · distance`
    lipschitz: Option<f64>,
    /// `depth ≥ c · distance`
    least: Option<f64>,
    exact: bool,
    continuous: bool,
    tolerance: f64,
    boxes: usize,
    regions: Vec<ProvedRegion<'t>>,
    borders: Vec<ProvedBorder<'t>>,
    undecided: Vec<ProvedNot<'t>>,
}

#[derive(Serialize)]
struct ProvedRegion<'t> {
    name: &'t str,
    share: f64,
    depth: [f64; 2],
    steepness: [f64; 2],
    distance: bool,
    niceness: [f64; 2],
    falls: bool,
    /// Of depth in f64 and in f32
    rounding: [f64; 2],
}

#[derive(Serialize)]
struct ProvedBorder<'t> {
    between: [&'t str; 2],
    jump: [f64; 2],
    turn_degrees: [f64; 2],
    turn_on_surface_degrees: Option<[f64; 2]>,
    depth: [f64; 2],
}

#[derive(Serialize)]
struct ProvedNot<'t> {
    what: &'t str,
    near: [f64; 3],
}

impl<'t> Proved<'t> {
    fn of(tool: &'t Checked, certificate: &'t Certificate) -> Proved<'t> {
        let model = &tool.model;
        let ends = |value: Interval| [value.low, value.high];
        let turned = |value: Interval| ends(value).map(f64::to_degrees);
        let region = |(region, facts): (&'t tool_dsl::model::Region, &RegionFacts)| ProvedRegion {
            name: &region.name,
            share: facts.share,
            depth: ends(facts.depth),
            steepness: ends(facts.steepness),
            distance: facts.distance,
            niceness: ends(niceness(facts)),
            falls: facts.falls,
            rounding: facts.rounding,
        };
        let name = |owner: Option<usize>| {
            owner.map_or("outside", |owner| model.regions[owner].name.as_str())
        };
        let border = |border: &Border| ProvedBorder {
            between: [name(Some(border.between.0)), name(border.between.1)],
            jump: ends(border.jump),
            turn_degrees: turned(border.turn),
            turn_on_surface_degrees: border.turn_on_surface.map(turned),
            depth: ends(border.depth),
        };
        Proved {
            tool: &model.name,
            unit: model.unit.word(),
            lipschitz: certificate.lipschitz(),
            least: certificate.least(),
            exact: certificate.is_exact(),
            continuous: certificate.is_continuous(),
            tolerance: certificate.tolerance,
            boxes: certificate.boxes,
            regions: model.regions.iter().zip(&certificate.regions).map(region).collect(),
            borders: certificate.borders.iter().map(border).collect(),
            undecided: certificate
                .undecided
                .iter()
                .map(|not| ProvedNot { what: &not.what, near: not.cell.sides.map(|side| side.low) })
                .collect(),
        }
    }
}
