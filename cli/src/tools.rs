//! `touchoff tools`: lists the built-in tools or those of `.tool` files and libraries, and prints the source of a built-in tool.

use crate::arguments::{ParamArguments, Tools, ToolsCommand};
use crate::failure::Failure;
use crate::import;
use crate::loaded_tool::{SourceFiles, load_file, source_files};
use crate::output::{Output, extension, unwritable, write_file};
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use touchoff::tool::{Interpreted, Symmetry, ToolInfo};
use touchoff::{Escaped, FileKind, Tool, read_regular_file};
use touchoff_tools::TOOLS;

/// One line of `tools list --json`.
#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    title: &'a str,
    unit: &'static str,
    /// Range along the axis, in `unit`.
    z_range: [f64; 2],
    /// Upper bound on the distance from the axis, in `unit`.
    radius: f64,
    /// Range along x, in `unit`; only for a solid without an axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    x_range: Option<[f64; 2]>,
    /// Range along y, in `unit`; only for a solid without an axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    y_range: Option<[f64; 2]>,
    surfaces: Vec<SurfaceRow<'a>>,
    regions: Vec<&'a str>,
}

#[derive(Serialize)]
struct SurfaceRow<'a> {
    name: &'a str,
    cutting: bool,
}

impl<'a> Row<'a> {
    fn of(info: &'a ToolInfo) -> Row<'a> {
        let [x_range, y_range] = match info.symmetry {
            Symmetry::Revolved => [None, None],
            Symmetry::Solid { extent } => extent.map(|side| Some(side.into())),
        };
        Row {
            name: &info.name,
            title: &info.title,
            unit: info.unit.symbol(),
            z_range: info.reach().into(),
            radius: info.radius(),
            x_range,
            y_range,
            surfaces: info
                .surfaces
                .iter()
                .map(|s| SurfaceRow { name: &s.name, cutting: s.cutting })
                .collect(),
            regions: info.regions.iter().map(|region| &*region.name).collect(),
        }
    }
}

/// Runs `touchoff tools`, `tools list` and `tools show`.
pub(crate) fn tools(arguments: &Tools, json: bool) -> Result<(), Failure> {
    match &arguments.command {
        None => list(&arguments.files, &ParamArguments::default(), json),
        Some(ToolsCommand::List { files, params }) => list(files, params, json),
        Some(ToolsCommand::Show { name, output }) => show(name, output.as_deref(), json),
    }
}

/// Lists the tools in files; without files, the built-in tools.
fn list(files: &[PathBuf], params: &ParamArguments, json: bool) -> Result<(), Failure> {
    let (libraries, files): (Vec<&PathBuf>, Vec<&PathBuf>) =
        files.iter().partition(|file| extension(file).is_some_and(|ending| ending != "tool"));
    let mut out = Output::lines();
    for library in &libraries {
        import::list(library, json, &mut out)?;
    }
    if !libraries.is_empty() && files.is_empty() {
        return Ok(out.flush()?);
    }
    let files: Vec<Interpreted> =
        files.into_iter().map(|file| load_file(file, params)).collect::<Result<_, _>>()?;
    let infos: Vec<&ToolInfo> = match files.as_slice() {
        [] if params.is_empty() => TOOLS.iter().map(|tool| tool.info()).collect(),
        [] => return Err(Failure::UnusedParams("name the files to list")),
        files => files.iter().map(Tool::info).collect(),
    };
    for info in infos {
        if json {
            out.json(&Row::of(info))?;
        } else {
            writeln!(out, "{:<20} {:<5} {}", info.name, info.unit.symbol(), Escaped(&info.title))?;
        }
    }
    Ok(out.flush()?)
}

/// The source files of a built-in tool.
#[derive(Serialize)]
struct SourceRow<'a> {
    name: &'a str,
    /// The tool's own file first, then those that it mounts.
    files: Vec<FileRow>,
}

#[derive(Serialize)]
struct FileRow {
    /// Path relative to the library's folder.
    file: &'static str,
    text: &'static str,
}

/// Prints the source of a built-in tool. With `output`, writes it there, and the files that it mounts below the same
/// folder.
fn show(name: &str, output: Option<&Path>, json: bool) -> Result<(), Failure> {
    let files = source_files(name)?;
    if let Some(output) = output {
        return write_tool(name, output, &files);
    }
    let SourceFiles { file, text, mounted } = files;
    let mut out = Output::bytes();
    if json {
        let files = [(file, text)].into_iter().chain(mounted.iter().copied());
        let files = files.map(|(file, text)| FileRow { file, text }).collect();
        out.json(&SourceRow { name, files })?;
    } else {
        write!(out, "{text}")?;
    }
    out.flush()?;
    if !mounted.is_empty() && !json {
        let files: Vec<String> = mounted.iter().map(|(file, _)| format!("`{file}`")).collect();
        message!(
            "`{name}` mounts {}. To write these files too: `touchoff tools show {name} -o FILE.tool`. They are written \
             below FILE.tool's folder",
            files.join(", ")
        );
    }
    Ok(())
}

/// Writes a tool's source to `output`, and the files that it mounts below `output`'s folder. Makes the folders that are
/// missing.
///
/// # Errors
/// If `output` does not end in `.tool`, if a mounted file exists with other content or has the name of `output`, or if
/// a file cannot be written.
fn write_tool(name: &str, output: &Path, files: &SourceFiles) -> Result<(), Failure> {
    if extension(output).as_deref() != Some("tool") {
        return Err(Failure::extension("a tool's file ends in `.tool`", output, "tool"));
    }
    let folder = output.parent().unwrap_or(Path::new(""));
    let mounted = files.mounted.iter().map(|(file, text)| (folder.join(file), *text));
    let mounted: Vec<(PathBuf, &str)> = mounted.collect();
    // Nothing is written before it is certain that nothing is overwritten.
    for (file, text) in &mounted {
        let differs = match read_regular_file(file, FileKind::Settings) {
            Ok(present) => present != text.as_bytes(),
            Err(error) => error.kind() != ErrorKind::NotFound,
        };
        // A mounted file must not overwrite the tool itself.
        if differs || file == output {
            let (file, name) = (file.display().to_string(), name.to_owned());
            return Err(Failure::MountedFileExists { file, name });
        }
    }
    // The tool comes last: once it is there, so is all that it mounts.
    let tool = (output.to_owned(), files.text);
    for (file, text) in mounted.iter().chain([&tool]) {
        let folder = file.parent().unwrap_or(folder);
        std::fs::create_dir_all(folder).map_err(|source| unwritable(folder, source))?;
        write_file(file, text)?;
        message!("{}: written", file.display());
    }
    Ok(())
}
