//! `touchoff check`: errors and warnings of files, and certificates of those without errors.

mod json;
mod summary;
mod table;

use crate::arguments::{Check, ParamArguments};
use crate::failure::Failure;
use crate::loaded_tool::read_source;
use crate::output::{Output, show};
use crate::progress::Progress;
use json::CertificateRow;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use tool_dsl::diagnostic::{self, Diagnostic, Severity};
use tool_dsl::domain::Domain;
use tool_dsl::expr::interval::Interval;
use tool_dsl::prove::{Certificate, RegionFacts};
use tool_dsl::{CheckedTool, Compiled, compile_with_arguments};

/// The exit status if there are only warnings; files with errors give 1, wrong options 2.
const WARNED: u8 = 3;

/// Shows the diagnostics of files, and the certificates of those that compile.
pub(crate) fn check(arguments: &Check, json: bool) -> Result<ExitCode, Failure> {
    let Check { files, params, verbose } = arguments;
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
                checked.print(&mut out, file, (json, *verbose))
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
            // The certificate finds again some of what compilation found.
            for diagnostic in certificate.diagnostics(tool) {
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

    fn print(
        &self,
        out: &mut Output,
        file: &Path,
        (json, verbose): (bool, bool),
    ) -> Result<(), Failure> {
        for diagnostic in &self.diagnostics {
            show(diagnostic, &self.compiled.sources);
        }
        let (Some(tool), Some(certificate)) = (self.compiled.tool(), &self.certificate) else {
            return Ok(());
        };
        if json {
            serde_json::to_writer(&mut *out, &CertificateRow::of(tool, certificate))?;
            writeln!(out)?;
            return Ok(());
        }
        let [_, warnings] = self.counts();
        let name = file.display().to_string();
        writeln!(out, "{}: {}", diagnostic::escaped(&name), describe(tool, warnings))?;
        if verbose {
            table::write(out, tool, certificate)?;
        } else {
            summary::write(out, tool, certificate)?;
        }
        Ok(())
    }
}

/// Returns a description of a compiled tool, and what is proved about it in a few lines. `None` if it has errors.
///
/// # Errors
/// Never: the lines are written to memory.
pub(crate) fn proof(compiled: Compiled) -> std::io::Result<Option<(String, String)>> {
    let checked = CheckedFile::of(compiled);
    let (Some(tool), Some(certificate)) = (checked.compiled.tool(), &checked.certificate) else {
        return Ok(None);
    };
    let mut lines = Vec::new();
    summary::write(&mut lines, tool, certificate)?;
    let [_, warnings] = checked.counts();
    Ok(Some((describe(tool, warnings), String::from_utf8_lossy(&lines).into_owned())))
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
