//! Tools: the library's texts, and tools compiled from text, with diagnostics where the editor shows them, and a drawing.

use crate::error::EngineError;
use include_dir::{Dir, DirEntry, include_dir};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchoff::Tool;
use touchoff::tool::{Interpreted, Symmetry};
use touchoff_drawing::{Content, TextRendering, svg};
use touchoff_dsl::compile;
use touchoff_dsl::diagnostic::{Diagnostic, Severity};
use touchoff_dsl::source::{Source, Sources, Span};

static TOOLS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../tools-library/tools");

/// A tool of the library.
#[derive(Debug, Serialize)]
pub(crate) struct LibraryTool {
    file: String,
    name: String,
    title: String,
}

/// The result of compiling a text.
#[derive(Debug, Serialize)]
pub(crate) struct CompiledTool {
    /// The tool; `None` if the text has errors.
    pub(crate) tool: Option<ToolFacts>,
    diagnostics: Vec<Shown>,
}

/// The facts about a tool that the page shows.
#[derive(Debug, Serialize)]
pub(crate) struct ToolFacts {
    name: String,
    title: String,
    unit: &'static str,
    /// `true` if the tool has no axis of symmetry, so that its spin matters.
    has_spin: bool,
    surfaces: Vec<SurfaceFacts>,
    /// The drawing.
    svg: String,
}

#[derive(Debug, Serialize)]
struct SurfaceFacts {
    name: String,
    cutting: bool,
}

/// An error or a warning, in the editor's terms.
#[derive(Debug, Serialize)]
struct Shown {
    severity: &'static str,
    code: &'static str,
    message: String,
    help: String,
    /// The range, in UTF-16 units of the text.
    from: usize,
    to: usize,
    /// The file, if it is not the text itself.
    file: Option<String>,
}

/// Returns the texts of all files of the library, holders included, by path.
fn library_files() -> BTreeMap<PathBuf, String> {
    let mut files = BTreeMap::new();
    let mut folders = vec![&TOOLS];
    while let Some(folder) = folders.pop() {
        for entry in folder.entries() {
            match entry {
                DirEntry::Dir(folder) => folders.push(folder),
                DirEntry::File(file) => {
                    let text = file.contents_utf8().unwrap_or_default();
                    files.insert(file.path().to_owned(), text.to_owned());
                }
            }
        }
    }
    files
}

/// Lists the tools of the library, by file.
pub(crate) fn library() -> Vec<LibraryTool> {
    let files = library_files();
    // Files in folders are holders, which are only mounted.
    let own = files.iter().filter(|(path, _)| path.components().count() == 1);
    let listed = own.map(|(path, text)| {
        // The head has both; nothing is compiled for a list.
        let head = text
            .lines()
            .find(|line| ["tool ", "solid "].iter().any(|keyword| line.starts_with(keyword)))
            .unwrap_or_default();
        LibraryTool {
            file: path.display().to_string(),
            name: head.split_whitespace().nth(1).unwrap_or_default().to_owned(),
            title: head.split('"').nth(1).unwrap_or_default().to_owned(),
        }
    });
    listed.collect()
}

/// Returns the text of a library tool.
///
/// # Errors
/// Fails if the library has no such file.
pub(crate) fn library_text(file: &str) -> Result<String, EngineError> {
    let text = library_files().remove(Path::new(file));
    text.ok_or_else(|| EngineError::UnknownTool(file.to_owned()))
}

/// Compiles a text. It can mount the library's files and those given, which are a JSON object from path to text. Returns
/// the tool as well, unless the text has errors.
///
/// # Errors
/// Fails if the files are not such an object.
pub(crate) fn compiled(
    name: &str,
    text: &str,
    files: &str,
) -> Result<(CompiledTool, Option<Interpreted>), EngineError> {
    let given: BTreeMap<PathBuf, String> = serde_json::from_str(files)?;
    let mut all = library_files();
    all.extend(given);
    let source = Source::new(name, text).with_path(name).with_files(Arc::new(all));
    let compiled = compile(&source);
    let diagnostics = compiled.diagnostics().iter().map(|one| shown(one, &compiled.sources));
    let diagnostics = diagnostics.collect();
    let drawing = compiled.tool().map(|tool| svg(tool, Content::Outline, TextRendering::Strokes));
    let interpreted = drawing.as_ref().and_then(|_| Interpreted::parse(&source).ok());
    let facts = drawing.zip(interpreted.as_ref()).map(|(svg, tool)| facts_of(tool, svg));
    Ok((CompiledTool { tool: facts, diagnostics }, interpreted))
}

fn facts_of(tool: &Interpreted, svg: String) -> ToolFacts {
    let info = tool.info();
    let surfaces = info
        .surfaces
        .iter()
        .map(|surface| SurfaceFacts { name: surface.name.to_string(), cutting: surface.cutting });
    ToolFacts {
        name: info.name.to_string(),
        title: info.title.to_string(),
        unit: info.unit.symbol(),
        has_spin: matches!(info.symmetry, Symmetry::Solid { .. }),
        surfaces: surfaces.collect(),
        svg,
    }
}

/// Returns a diagnostic as the editor shows it. One in a mounted file is at the start of the text.
fn shown(diagnostic: &Diagnostic, sources: &Sources) -> Shown {
    let (source, Span { start, end }) = sources.locate(diagnostic.span);
    let main = sources.main();
    let is_main = std::ptr::eq(source, main);
    // The editor counts in UTF-16 units, as JavaScript does.
    let [from, to] = [start, end].map(|offset| {
        let offset = main.text.floor_char_boundary(offset.min(main.text.len()));
        if is_main { main.text[..offset].encode_utf16().count() } else { 0 }
    });
    Shown {
        severity: match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "info",
        },
        code: diagnostic.code(),
        message: diagnostic.message(),
        help: diagnostic.help(),
        from,
        to,
        file: (!is_main).then(|| source.name.clone()),
    }
}
