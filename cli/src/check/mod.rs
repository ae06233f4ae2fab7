//! `touchoff check`: errors and warnings of files, and certificates of those without errors.

mod json;
pub(crate) mod table;

use crate::arguments::ParamArguments;
use crate::failure::Failure;
use crate::output::{Output, show};
use json::Proved;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use tool_dsl::diagnostic::{self, Severity};
use tool_dsl::domain::Domain;
use tool_dsl::expr::interval::Interval;
use tool_dsl::prove::{Certificate, RegionFacts};
use tool_dsl::{CheckedTool, compile_with};

/// The exit status if there are only warnings; files with errors give 1, wrong options 2.
const WARNED: u8 = 3;

/// Shows the diagnostics of files, and the certificates of those that compile.
pub(crate) fn check(
    files: &[PathBuf],
    given: &ParamArguments,
    json: bool,
) -> Result<ExitCode, Failure> {
    let mut out = Output::lines();
    let (mut wrong, mut warned) = (0, false);
    for file in files {
        let source = match given.source(file) {
            Ok(source) => source,
            Err(error) => {
                say!("error: {error}");
                wrong += 1;
                continue;
            }
        };
        let compiled = compile_with(&source, &given.sources());
        let mut diagnostics = compiled.diagnostics().to_vec();
        let proved = compiled.tool().map(|tool| (tool, Certificate::of(tool)));
        if let Some((tool, certificate)) = &proved {
            // The certificate finds again some of what compilation found.
            for diagnostic in certificate.diagnostics(tool) {
                if !diagnostics.iter().any(|known| known.span == diagnostic.span) {
                    diagnostics.push(diagnostic);
                }
            }
        }
        for diagnostic in &diagnostics {
            show(diagnostic, &compiled.sources);
        }
        let count = |severity: Severity| {
            diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count()
        };
        let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
        wrong += usize::from(errors > 0);
        warned |= warnings > 0;
        let Some((tool, certificate)) = &proved else { continue };
        if json {
            serde_json::to_writer(&mut out, &Proved::of(tool, certificate))?;
            writeln!(out)?;
        } else {
            let shown = file.display().to_string();
            writeln!(out, "{}: {}", diagnostic::escaped(&shown), described(tool, warnings))?;
            table::write(&mut out, tool, certificate)?;
        }
    }
    out.flush()?;
    match (wrong, warned) {
        (0, false) => Ok(ExitCode::SUCCESS),
        (0, true) => Ok(ExitCode::from(WARNED)),
        _ => Err(Failure::Files { wrong, all: files.len() }),
    }
}

fn described(tool: &CheckedTool, warnings: usize) -> String {
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
