//! Tools: built in, from a text or a file, or from a library of a CAM system.

use crate::error::{reading, refused, tool as tool_error};
use crate::pool::in_own_thread;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchoff::tool::{Interpreted, ToolError, ToolInfo};
use touchoff_drawing::{Content, TextRendering, svg};
use touchoff_dsl::compile_with_arguments;
use touchoff_dsl::source::Source;
use touchoff_import::{ImportError, ImportedTool, Libraries, Library, find_in_folder};
use touchoff_tools::{SOURCES, TOOLS};

/// A cutting tool.
#[pyclass(frozen, module = "touchoff._touchoff")]
pub(crate) struct Tool {
    loaded: LoadedTool,
}

pub(crate) enum LoadedTool {
    BuiltIn(&'static dyn touchoff::Tool),
    Interpreted {
        tool: Box<Interpreted>,
        /// The text that it was compiled from, for the drawing.
        text: ToolText,
        params: Vec<String>,
    },
}

/// The text of a tool.
pub(crate) enum ToolText {
    File {
        path: PathBuf,
        /// The folder within which the file may mount others, if not its own.
        root: Option<PathBuf>,
    },
    Text {
        name: String,
        text: String,
    },
    /// Texts by their paths, among which `own` is the tool's.
    Files {
        own: PathBuf,
        texts: Arc<BTreeMap<PathBuf, String>>,
    },
}

impl ToolText {
    /// Takes texts by their paths, among which `own` is the tool's.
    fn files(own: impl Into<PathBuf>, texts: impl Iterator<Item = (PathBuf, String)>) -> ToolText {
        ToolText::Files { own: own.into(), texts: Arc::new(texts.collect()) }
    }

    /// Returns the source to compile. A source is bound to a thread, so it is made where it is needed.
    fn source(&self) -> Result<Source, ToolError> {
        match self {
            ToolText::File { path, root } => {
                let source = Interpreted::source(path)?;
                Ok(match root {
                    Some(root) => source.with_root(root),
                    None => source,
                })
            }
            ToolText::Text { name, text } => Ok(Source::new(name, text)),
            ToolText::Files { own, texts } => {
                let text = texts.get(own).map_or("", String::as_str);
                let source = Source::new(own.display().to_string(), text).with_path(own);
                Ok(source.with_files(Arc::clone(texts)))
            }
        }
    }
}

fn arguments(params: &[String]) -> Vec<Source> {
    params.iter().map(|text| Source::new("params", text)).collect()
}

impl AsRef<dyn touchoff::Tool> for LoadedTool {
    fn as_ref(&self) -> &(dyn touchoff::Tool + 'static) {
        match self {
            LoadedTool::BuiltIn(tool) => *tool,
            LoadedTool::Interpreted { tool, .. } => &**tool,
        }
    }
}

impl LoadedTool {
    fn compile(text: ToolText, params: &[String]) -> Result<LoadedTool, ToolError> {
        let tool = Box::new(Interpreted::parse_with(&text.source()?, &arguments(params))?);
        Ok(LoadedTool::Interpreted { tool, text, params: params.to_vec() })
    }

    /// Loads a tool by the name of a built-in tool, by its file, or from a library. The files that these name lie within `root`, if
    /// it is given.
    pub(crate) fn named(
        name: &OsStr,
        library: Option<&Path>,
        params: &[String],
        root: Option<&Path>,
        libraries: &mut Libraries,
    ) -> Result<LoadedTool, LoadError> {
        let read = |file: &Path| {
            let text = ToolText::File { path: file.to_owned(), root: root.map(Path::to_owned) };
            LoadedTool::compile(text, params).map_err(LoadError::Tool)
        };
        if let Some(library) = library {
            if library.is_dir() {
                return read(&find_in_folder(library, name)?);
            }
            let tool = libraries.read(library, root)?.select(&name.to_string_lossy())?;
            return Ok(LoadedTool::imported(tool, params)?);
        }
        if Path::new(name).extension().is_some_and(|extension| extension == "tool") {
            return read(Path::new(name));
        }
        let name = name.to_string_lossy().into_owned();
        match touchoff_tools::find(&name) {
            Some(_) if !params.is_empty() => Err(LoadError::Fixed { name }),
            Some(tool) => Ok(LoadedTool::BuiltIn(tool)),
            None => Err(LoadError::Unknown { name }),
        }
    }

    fn imported(imported: &ImportedTool, params: &[String]) -> Result<LoadedTool, ToolError> {
        let texts = imported.files.iter().map(|file| (file.path.clone().into(), file.text.clone()));
        LoadedTool::compile(ToolText::files(imported.path(), texts), params)
    }

    fn info(&self) -> &ToolInfo {
        self.as_ref().info()
    }
}

/// A reason for which a tool cannot be loaded.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LoadError {
    #[error(transparent)]
    Tool(#[from] ToolError),
    #[error(transparent)]
    Import(#[from] ImportError),
    #[error(transparent)]
    Find(#[from] touchoff_import::FindError),
    #[error(
        "no built-in tool is called `{name}`: `touchoff.tool_names()` lists them; a file ends in `.tool`"
    )]
    Unknown { name: String },
    #[error("the built-in tool `{name}` takes no params: load it from its file")]
    Fixed { name: String },
}

impl From<LoadError> for PyErr {
    fn from(error: LoadError) -> PyErr {
        match error {
            LoadError::Tool(error) => tool_error(error),
            other => reading(other),
        }
    }
}

impl Tool {
    pub(crate) fn get(&self) -> &(dyn touchoff::Tool + 'static) {
        self.loaded.as_ref()
    }
}

#[pymethods]
impl Tool {
    /// A built-in tool, with values for its params if there are any.
    #[staticmethod]
    fn library(py: Python<'_>, name: String, params: Vec<String>) -> PyResult<Tool> {
        let load = move || match (source_files(&name), params.is_empty()) {
            (Some(text), false) => Ok(LoadedTool::compile(text, &params)?),
            _ => LoadedTool::named(name.as_ref(), None, &params, None, &mut Libraries::default()),
        };
        Ok(Tool { loaded: in_own_thread(py, load)?? })
    }

    /// A tool from its text.
    #[staticmethod]
    fn parse(py: Python<'_>, text: String, params: Vec<String>, name: String) -> PyResult<Tool> {
        let text = ToolText::Text { name, text };
        let loaded = in_own_thread(py, move || LoadedTool::compile(text, &params))?;
        Ok(Tool { loaded: loaded.map_err(tool_error)? })
    }

    /// A tool from its file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, params: Vec<String>) -> PyResult<Tool> {
        let text = ToolText::File { path, root: None };
        let loaded = in_own_thread(py, move || LoadedTool::compile(text, &params))?;
        Ok(Tool { loaded: loaded.map_err(tool_error)? })
    }

    /// A number that two tools share if all their values at all points are the same.
    #[getter]
    fn digest(&self) -> u64 {
        self.loaded.info().digest
    }

    #[getter]
    fn name(&self) -> &str {
        &self.loaded.info().name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.loaded.info().title
    }

    #[getter]
    fn unit(&self) -> &'static str {
        self.loaded.info().unit.symbol()
    }

    /// The surfaces in the order of their indices, each with whether it cuts.
    #[getter]
    fn surfaces(&self) -> Vec<(String, bool)> {
        let surfaces = self.loaded.info().surfaces.iter();
        surfaces.map(|surface| (surface.name.to_string(), surface.cutting)).collect()
    }

    /// The largest distance from the axis, in the tool's unit; of a solid, an upper bound.
    #[getter]
    fn radius(&self) -> f64 {
        let info = self.loaded.info();
        let widest = info.outline.iter().map(|segment| segment.geometry().bounding_box()[1][0]);
        widest.reduce(f64::max).unwrap_or_else(|| info.radius())
    }

    /// Tells whether depth is proved to be the distance to the tool's surface.
    #[getter]
    fn is_exact(&self) -> bool {
        self.loaded.info().is_exact()
    }

    /// The compiler's warnings; empty if there are none.
    #[getter]
    fn warnings(&self) -> &str {
        match &self.loaded {
            LoadedTool::BuiltIn(_) => "",
            LoadedTool::Interpreted { tool, .. } => tool.warnings(),
        }
    }

    /// The drawing of the tool, as SVG.
    fn svg(&self) -> PyResult<String> {
        let compiled = match &self.loaded {
            LoadedTool::BuiltIn(tool) => {
                let text = source_files(&tool.info().name);
                let text = text.ok_or_else(|| refused("the tool has no text to draw from"))?;
                compile_with_arguments(&text.source().map_err(tool_error)?, &[])
            }
            LoadedTool::Interpreted { text, params, .. } => {
                compile_with_arguments(&text.source().map_err(tool_error)?, &arguments(params))
            }
        };
        match compiled.tool() {
            Some(tool) => Ok(svg(tool, Content::Regions, TextRendering::Page)),
            None => {
                Err(refused("the tool has no text to draw from: load it from its `.tool` file"))
            }
        }
    }
}

/// Returns the files of a built-in tool.
fn source_files(name: &str) -> Option<ToolText> {
    let position = TOOLS.iter().position(|known| known.info().name == name)?;
    let files = SOURCES[position];
    let (own, _) = files.first()?;
    Some(ToolText::files(*own, files.iter().map(|(file, text)| (file.into(), (*text).to_owned()))))
}

/// The names of the built-in tools.
#[pyfunction]
pub(crate) fn tool_names() -> Vec<&'static str> {
    TOOLS.iter().map(|tool| &*tool.info().name).collect()
}

/// A tool of a library, with its number, its title and the notes of the import.
type ImportedEntry = (Tool, Option<u32>, String, Vec<String>);

/// The tools, and the names and reasons of those that are left out.
type Imported = (Vec<ImportedEntry>, Vec<(String, String)>);

/// The tools of a library of a CAM system, and the names and reasons of those that are left out.
#[pyfunction]
pub(crate) fn import_library(py: Python<'_>, path: PathBuf) -> PyResult<Imported> {
    let read = in_own_thread(py, move || {
        let library = Library::read(&path)?;
        let mut skipped: Vec<(String, String)> =
            library.skipped().iter().map(|one| (one.name.clone(), one.reason.clone())).collect();
        let mut tools = Vec::new();
        for imported in library.tools() {
            match LoadedTool::imported(imported, &[]) {
                Ok(loaded) => {
                    let entry = &imported.entry;
                    let notes = entry.notes.iter().map(ToString::to_string).collect();
                    tools.push((Tool { loaded }, entry.number, entry.label().to_owned(), notes));
                }
                Err(error) => skipped.push((imported.name.clone(), error.to_string())),
            }
        }
        Ok((tools, skipped))
    })?;
    read.map_err(|error: ImportError| LoadError::Import(error).into())
}
