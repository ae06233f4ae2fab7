//! `.tool` files: listing, loading, expanding.

use crate::arguments::{ParamArguments, Stage};
use crate::failure::Failure;
use crate::output::{Output, show};
use serde::Serialize;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use tool_dsl::diagnostic::escaped;
use tool_dsl::{CheckedTool, compile_with, emit};
use tools_library::TOOLS;
use touchoff::tool::{Interpreted, Symmetry, ToolInfo};
use touchoff::{Escaped, Tool, Unit};

#[derive(Serialize)]
struct Listed<'a> {
    name: &'a str,
    title: &'a str,
    unit: &'static str,
    low: f64,
    high: f64,
    radius: f64,
    /// The extent of a solid along x and along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    across: Option<[[f64; 2]; 2]>,
    surfaces: Vec<ListedSurface<'a>>,
    regions: Vec<&'a str>,
}

#[derive(Serialize)]
struct ListedSurface<'a> {
    name: &'a str,
    cutting: bool,
}

impl<'a> Listed<'a> {
    fn of(info: &'a ToolInfo) -> Listed<'a> {
        let [low, high] = info.reach();
        Listed {
            name: &info.name,
            title: &info.title,
            unit: info.unit.symbol(),
            low,
            high,
            radius: info.radius(),
            across: match info.symmetry {
                Symmetry::Revolved => None,
                Symmetry::Solid { across } => Some(across),
            },
            surfaces: info
                .surfaces
                .iter()
                .map(|s| ListedSurface { name: &s.name, cutting: s.cutting })
                .collect(),
            regions: info.regions.iter().map(|region| &*region.name).collect(),
        }
    }
}

/// Lists the compiled tools, or the tools of files.
pub(crate) fn tools(files: &[PathBuf], given: &ParamArguments, json: bool) -> Result<(), Failure> {
    let files: Vec<Interpreted> =
        files.iter().map(|file| load(file, given)).collect::<Result<_, _>>()?;
    let cards: Vec<&ToolInfo> = match files.as_slice() {
        [] if given.is_none() => TOOLS.iter().map(|tool| tool.info()).collect(),
        [] => return Err(Failure::NothingToSet("name one")),
        files => files.iter().map(Tool::info).collect(),
    };
    let mut out = Output::lines();
    for info in cards {
        if json {
            serde_json::to_writer(&mut out, &Listed::of(info))?;
            writeln!(out)?;
        } else {
            writeln!(out, "{:<20} {:<5} {}", info.name, info.unit.symbol(), Escaped(&info.title))?;
        }
    }
    out.flush()?;
    Ok(())
}

/// Loads the tool of a file, and prints its warnings.
fn load(file: &Path, given: &ParamArguments) -> Result<Interpreted, Failure> {
    let tool = Interpreted::parse_with(&given.source(file)?, &given.sources())?;
    if !tool.warnings().is_empty() {
        say!("{}", tool.warnings());
    }
    Ok(tool)
}

/// A compiled tool by name, or a `.tool` file.
pub(crate) enum Found {
    Compiled(&'static dyn Tool),
    File(Box<Interpreted>),
}

impl Found {
    /// Finds the tool that `--tool` names.
    ///
    /// # Errors
    /// If there is no such tool, its file cannot be loaded, or a compiled tool is given values.
    pub(crate) fn find(name: &OsStr, given: &ParamArguments) -> Result<Found, Failure> {
        if Path::new(name).extension().is_some_and(|extension| extension == "tool") {
            return Ok(Found::File(Box::new(load(Path::new(name), given)?)));
        }
        let name = &*name.to_string_lossy();
        if !given.is_none() {
            return Err(Failure::NothingToSet("a compiled tool has its values"));
        }
        tools_library::find(name).map(Found::Compiled).ok_or_else(|| {
            let distance = |known: &str| {
                strsim::damerau_levenshtein(&known.to_lowercase(), &name.to_lowercase())
            };
            let known = TOOLS.iter().map(|tool| &*tool.info().name);
            let nearest = known.min_by_key(|known| distance(known));
            let meant = nearest.map_or(String::new(), |known| format!("; did you mean `{known}`?"));
            Failure::UnknownTool { name: escaped(name).into_owned(), meant }
        })
    }

    pub(crate) fn tool(&self) -> &dyn Tool {
        match self {
            Found::Compiled(tool) => *tool,
            Found::File(tool) => &**tool,
        }
    }
}

/// Compiles the tool of a file, and shows its diagnostics.
///
/// # Errors
/// If the file cannot be read or has errors.
pub(crate) fn checked(file: &Path, given: &ParamArguments) -> Result<Box<CheckedTool>, Failure> {
    let source = given.source(file)?;
    let compiled = compile_with(&source, &given.sources());
    for diagnostic in compiled.diagnostics() {
        show(diagnostic, &compiled.sources);
    }
    compiled.into_tool().ok_or(Failure::Files { wrong: 1, all: 1 })
}

/// Prints the Rust code of files, or an earlier stage of their compilation.
pub(crate) fn expand(
    files: &[PathBuf],
    stage: Stage,
    given: &ParamArguments,
) -> Result<(), Failure> {
    let mut out = Output::lines();
    for file in files {
        let tool = checked(file, given)?;
        let text = match stage {
            Stage::Ast => emit::tree(&given.source(file)?),
            Stage::Model => emit::model(&tool),
            Stage::Regions => emit::regions(&tool),
            Stage::Plan => emit::dot(&tool),
            Stage::Rust => emit::rust(&tool),
        };
        write!(out, "{text}")?;
    }
    out.flush()?;
    Ok(())
}

/// Returns a file's extension in lower case.
pub(crate) fn ending(file: &Path) -> Option<String> {
    file.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase)
}

/// Formats a length with its unit.
pub(crate) fn length(value: f64, unit: Unit) -> String {
    format!("{} {unit}", figure(value, unit))
}

/// Formats a length to a tenth of a micrometre, or about as finely in its unit.
pub(crate) fn figure(value: f64, unit: Unit) -> String {
    let decimals = match unit {
        Unit::Millimetre => 4,
        Unit::Inch => 5,
        Unit::Metre => 7,
    };
    format!("{value:.decimals$}")
}
