//! `touchoff check`: errors and warnings of files, and certificates of those without errors.

mod text;

use crate::arguments::{Check, ParamArguments};
use crate::failure::Failure;
use crate::loaded_tool::read_source;
use crate::output::{Output, show};
use crate::progress::Progress;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use touchoff_dsl::diagnostic::{self, Diagnostic, Severity};
use touchoff_dsl::domain::Domain;
use touchoff_dsl::expr::interval::{Cell, Interval};
use touchoff_dsl::model::Model;
use touchoff_dsl::prove::{Border, Certificate, RegionFacts};
use touchoff_dsl::{CheckedTool, Compiled, compile_with_arguments};

/// The exit status if there are only warnings; files with errors give 1, wrong options 2.
const WARNED: u8 = 3;

/// Shows the diagnostics of files, and the certificates of those that compile.
pub(crate) fn check(arguments: &Check, json: bool) -> Result<ExitCode, Failure> {
    let Check { files, params, verbose } = arguments;
    let form = match (json, verbose) {
        (true, _) => Form::Json,
        (false, true) => Form::Table,
        (false, false) => Form::Summary,
    };
    let mut out = Output::lines();
    let (mut wrong, mut warned) = (0, false);
    let progress = match files.len() {
        1 => Progress::spinner("proving", json),
        count => Progress::steps(count, "files", json),
    };
    for file in files {
        let checked = CheckedFile::read(file, params);
        progress.advance(1);
        progress.suspend(|| match &checked {
            Ok(checked) => {
                let [errors, warnings] = checked.counts();
                wrong += usize::from(errors > 0);
                warned |= warnings > 0;
                checked.print(&mut out, file, form)
            }
            Err(error) => {
                message!("error: {error}");
                wrong += 1;
                Ok(())
            }
        })?;
    }
    drop(progress);
    out.flush()?;
    match (wrong, warned) {
        (0, false) => Ok(ExitCode::SUCCESS),
        (0, true) => Ok(ExitCode::from(WARNED)),
        _ => Err(Failure::Files { wrong, all: files.len() }),
    }
}

/// The form in which a certificate is printed.
#[derive(Clone, Copy)]
enum Form {
    Json,
    Table,
    Summary,
}

/// A compiled file, its diagnostics, and the certificate if it has no errors.
struct CheckedFile {
    compiled: Compiled,
    diagnostics: Vec<Diagnostic>,
    certificate: Option<Certificate>,
}

impl CheckedFile {
    fn read(file: &Path, params: &ParamArguments) -> Result<CheckedFile, Failure> {
        let compiled = compile_with_arguments(&read_source(file, params)?, &params.sources());
        Ok(CheckedFile::of(compiled))
    }

    fn of(compiled: Compiled) -> CheckedFile {
        let mut diagnostics = compiled.diagnostics().to_vec();
        let certificate = compiled.tool().map(|tool| Certificate::prove(tool));
        if let (Some(tool), Some(certificate)) = (compiled.tool(), &certificate) {
            // The certificate finds again some of what compilation found, and has more boxes for what that left open.
            let found = certificate.diagnostics(tool);
            let is_open = |diagnostic: &Diagnostic| diagnostic.code() == "T0624";
            if found.iter().any(is_open) {
                diagnostics.retain(|known| !is_open(known));
            }
            for diagnostic in found {
                if !diagnostics.iter().any(|known| known.span == diagnostic.span) {
                    diagnostics.push(diagnostic);
                }
            }
        }
        CheckedFile { compiled, diagnostics, certificate }
    }

    /// Returns the numbers of errors and of warnings.
    fn counts(&self) -> [usize; 2] {
        [Severity::Error, Severity::Warning].map(|severity| {
            self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count()
        })
    }

    fn print(&self, out: &mut Output, file: &Path, form: Form) -> Result<(), Failure> {
        for diagnostic in &self.diagnostics {
            show(diagnostic, &self.compiled.sources);
        }
        let (Some(tool), Some(certificate)) = (self.compiled.tool(), &self.certificate) else {
            return Ok(());
        };
        if !matches!(form, Form::Json) {
            let [_, warnings] = self.counts();
            let name = file.display().to_string();
            writeln!(out, "{}: {}", diagnostic::escaped(&name), describe(tool, warnings))?;
        }
        match form {
            Form::Json => {
                out.json(&CertificateRow::of(tool, certificate))?;
            }
            Form::Table => text::write_table(out, tool, certificate)?,
            Form::Summary => text::write_summary(out, tool, certificate)?,
        }
        Ok(())
    }
}

/// A tool, and what is proved about it in a few lines.
pub(crate) struct Proved {
    pub(crate) description: String,
    pub(crate) certificate: String,
}

/// Proves a compiled tool. `None` if it has errors.
///
/// # Errors
/// Never: the lines are written to memory.
pub(crate) fn prove(compiled: Compiled) -> std::io::Result<Option<Proved>> {
    let checked = CheckedFile::of(compiled);
    let (Some(tool), Some(certificate)) = (checked.compiled.tool(), &checked.certificate) else {
        return Ok(None);
    };
    let mut lines = Vec::new();
    text::write_summary(&mut lines, tool, certificate)?;
    let [_, warnings] = checked.counts();
    let description = describe(tool, warnings);
    Ok(Some(Proved { description, certificate: String::from_utf8_lossy(&lines).into_owned() }))
}

/// Describes a tool: its name, size, cutting surfaces and number of warnings.
fn describe(tool: &CheckedTool, warnings: usize) -> String {
    let model = &tool.model;
    let unit = model.unit.symbol();
    let cutting: Vec<&str> =
        model.surfaces.iter().filter(|s| s.cutting).map(|s| s.name.as_str()).collect();
    let extent = &tool.extent;
    let size = match model.domain {
        Domain::HalfPlane => format!(
            "{} {unit} long and {} {unit} in radius",
            diagnostic::format_number(extent.high - extent.low),
            diagnostic::format_number(extent.radius),
        ),
        Domain::Space => {
            let sides = extent.cell().sides;
            let [x, y, z] = sides.map(|side| diagnostic::format_number(side.high - side.low));
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

/// Returns a region's niceness with negative values as 0.
fn niceness(facts: &RegionFacts) -> Interval {
    let [low, high] = [facts.niceness.low, facts.niceness.high].map(|end| end.max(0.0));
    Interval::new(low, high)
}

/// The certificate for programs.
#[derive(Serialize)]
struct CertificateRow<'t> {
    tool: &'t str,
    unit: &'static str,
    /// `depth ≤ L · distance`
    lipschitz: Option<f64>,
    /// `depth ≥ c · distance`
    lower_slope: Option<f64>,
    exact: bool,
    continuous: bool,
    tolerance: f64,
    /// Amount by which all bounds may be off
    slack: f64,
    boxes: usize,
    regions: Vec<RegionRow<'t>>,
    borders: Vec<BorderRow<'t>>,
    undecided: Vec<OpenProofRow>,
}

#[derive(Serialize)]
struct RegionRow<'t> {
    name: &'t str,
    /// Estimated fraction of the section's area, or of a solid's volume
    fraction: f64,
    depth: [f64; 2],
    steepness: [f64; 2],
    is_distance: bool,
    niceness: [f64; 2],
    niceness_never_rises: bool,
    /// Bound on the error of the computed depth, in the file's unit
    rounding_error: f64,
    /// Angle between the direction and the steepest descent of depth, if it is known
    direction_error_degrees: Option<[f64; 2]>,
    /// The largest such angle that is certain at a point, and the point in the tool's frame
    oblique_degrees: Option<f64>,
    oblique_point: Option<[f64; 3]>,
    /// A point in the tool's frame where niceness rises with depth
    niceness_rises_point: Option<[f64; 3]>,
    /// Middles of the boxes where the direction vanishes, in the tool's frame
    singular_points: Vec<[f64; 3]>,
    /// True if the direction turns on the axis
    turns_on_axis: bool,
}

#[derive(Serialize)]
struct BorderRow<'t> {
    between: [&'t str; 2],
    depth_jump: [f64; 2],
    magnitude_jump: [f64; 2],
    /// A point where depth jumps, in the tool's frame
    jump_point: Option<[f64; 3]>,
    turn_degrees: [f64; 2],
    turn_on_surface_degrees: Option<[f64; 2]>,
    depth: [f64; 2],
}

#[derive(Serialize)]
struct OpenProofRow {
    statement: String,
    /// Middle of the box, in the tool's frame
    point: [f64; 3],
}

impl<'t> CertificateRow<'t> {
    fn of(tool: &'t CheckedTool, certificate: &'t Certificate) -> CertificateRow<'t> {
        let model = &tool.model;
        let regions = model.regions.iter().zip(&certificate.regions);
        let borders = certificate.borders.iter();
        CertificateRow {
            tool: &model.name,
            unit: model.unit.symbol(),
            lipschitz: certificate.lipschitz(),
            lower_slope: certificate.lower_slope(),
            exact: certificate.is_exact(),
            continuous: certificate.is_continuous(),
            tolerance: certificate.tolerance,
            slack: certificate.slack,
            boxes: certificate.examined_boxes,
            regions: regions.map(|(region, facts)| RegionRow::of(&region.name, facts)).collect(),
            borders: borders.map(|border| BorderRow::of(model, border)).collect(),
            undecided: certificate
                .undecided
                .iter()
                .map(|not| OpenProofRow {
                    statement: not.statement.to_string(),
                    point: not.cell.middle(),
                })
                .collect(),
        }
    }
}

impl<'t> RegionRow<'t> {
    fn of(name: &'t str, facts: &RegionFacts) -> RegionRow<'t> {
        RegionRow {
            name,
            fraction: facts.share,
            depth: ends(facts.depth),
            steepness: ends(facts.gradient_length),
            is_distance: facts.is_distance,
            niceness: ends(niceness(facts)),
            niceness_never_rises: facts.niceness_never_rises,
            rounding_error: facts.rounding_error,
            direction_error_degrees: facts.direction_error.map(ends_in_degrees),
            oblique_degrees: facts.oblique_witness.map(|certain| certain.value.to_degrees()),
            oblique_point: facts.oblique_witness.map(|certain| certain.point),
            niceness_rises_point: facts.rising_witness.map(|certain| certain.point),
            singular_points: facts.singular_cells.iter().map(Cell::middle).collect(),
            turns_on_axis: facts.turns_on_axis,
        }
    }
}

impl<'t> BorderRow<'t> {
    fn of(model: &'t Model, border: &Border) -> BorderRow<'t> {
        BorderRow {
            between: sides(model, border),
            depth_jump: ends(border.depth_jump),
            magnitude_jump: ends(border.magnitude_jump),
            jump_point: border.jump_point.map(|jump| jump.point),
            turn_degrees: ends_in_degrees(border.direction_angle),
            turn_on_surface_degrees: border.direction_angle_on_surface.map(ends_in_degrees),
            depth: ends(border.depth),
        }
    }
}

/// Returns the names of the regions on both sides of a border.
fn sides<'t>(model: &'t Model, border: &Border) -> [&'t str; 2] {
    let other = border.sides.other;
    let other = other.map_or("outside", |other| model.regions[other].name.as_str());
    [&model.regions[border.sides.own].name, other]
}

fn ends(value: Interval) -> [f64; 2] {
    [value.low, value.high]
}

fn ends_in_degrees(value: Interval) -> [f64; 2] {
    ends(value).map(f64::to_degrees)
}
