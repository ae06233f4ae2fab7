//! Tools as the command line names them: built in, or from `.tool` files.

use crate::arguments::{ParamArguments, ToolArguments};
use crate::failure::Failure;
use crate::output::{extension, show, show_lines};
use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;
use touchoff::tool::Interpreted;
use touchoff::{Escaped, Tool, is_within};
use touchoff_dsl::diagnostic::escaped;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile_with_arguments};
use touchoff_import::{Libraries, find_in_folder};
use touchoff_tools::{SOURCES, TOOLS};

/// A built-in tool, or one from a `.tool` file.
pub(crate) enum LoadedTool {
    BuiltIn(&'static dyn Tool),
    File(Box<Interpreted>),
}

impl LoadedTool {
    /// Loads the tool that `--tool` names.
    ///
    /// # Errors
    /// If there is no such tool, its file cannot be loaded, or a built-in tool is given values.
    pub(crate) fn load(name: &OsStr, arguments: &ToolArguments) -> Result<LoadedTool, Failure> {
        LoadedTool::load_from(name, arguments, &mut Libraries::default())
    }

    /// Loads one of several tools, whose libraries are read once.
    ///
    /// # Errors
    /// As [`LoadedTool::load`].
    pub(crate) fn load_from(
        name: &OsStr,
        arguments: &ToolArguments,
        libraries: &mut Libraries,
    ) -> Result<LoadedTool, Failure> {
        let params = &arguments.params;
        if let Some(library) = &arguments.library {
            let tool = load(&in_library(name, library, params, libraries, true)?, params)?;
            return Ok(LoadedTool::File(Box::new(tool)));
        }
        if is_tool_file(name) {
            return Ok(LoadedTool::File(Box::new(load_file(Path::new(name), params)?)));
        }
        let tool = built_in(&name.to_string_lossy(), params.root())?;
        if params.is_empty() {
            Ok(LoadedTool::BuiltIn(tool))
        } else {
            Err(Failure::FixedParams(tool.info().name.to_string()))
        }
    }

    pub(crate) fn tool(&self) -> &dyn Tool {
        self.as_ref()
    }
}

impl AsRef<dyn Tool> for LoadedTool {
    fn as_ref(&self) -> &(dyn Tool + 'static) {
        match self {
            LoadedTool::BuiltIn(tool) => *tool,
            LoadedTool::File(tool) => &**tool,
        }
    }
}

/// Compiles the tool that `--tool` names, for what its values at run time do not tell: its drawing and its proof.
///
/// # Errors
/// As [`LoadedTool::load`].
pub(crate) fn compile_named(
    name: &OsStr,
    arguments: &ToolArguments,
    libraries: &mut Libraries,
) -> Result<Compiled, Failure> {
    let params = &arguments.params;
    if let Some(library) = &arguments.library {
        let source = in_library(name, library, params, libraries, false)?;
        return Ok(compile_source(&source, params));
    }
    if is_tool_file(name) {
        return Ok(compile_source(&read_source(Path::new(name), params)?, params));
    }
    let SourceFiles { file, text, mounted } = source_files(&name.to_string_lossy())?;
    // Nothing is written: a temporary folder would stay if the program is ended.
    let files = std::iter::once((file, text)).chain(mounted.iter().copied());
    let files = files.map(|(file, text)| (file.into(), text.to_owned())).collect();
    let source = Source::new(file, text).with_path(file).with_files(Arc::new(files));
    Ok(compile_source(&source, params))
}

/// Compiles a tool. Its diagnostics are not shown.
fn compile_source(source: &Source, params: &ParamArguments) -> Compiled {
    compile_with_arguments(source, &params.sources())
}

/// The files of a built-in tool. Their paths are relative to the library's folder.
pub(crate) struct SourceFiles {
    pub(crate) file: &'static str,
    pub(crate) text: &'static str,
    /// The files that it mounts, each with its text.
    pub(crate) mounted: &'static [(&'static str, &'static str)],
}

/// Returns the files of a built-in tool.
///
/// # Errors
/// As [`built_in`].
pub(crate) fn source_files(name: &str) -> Result<SourceFiles, Failure> {
    let info = built_in(name, None)?.info();
    let position = TOOLS.iter().position(|tool| tool.info().name == info.name);
    let Some([(file, text), mounted @ ..]) = position.map(|position| SOURCES[position]) else {
        unreachable!("every built-in tool has a source")
    };
    Ok(SourceFiles { file, text, mounted })
}

/// Reads a tool of a library, or of a folder of `.tool` files. Prints what the import noted if `notes` is set.
fn in_library(
    name: &OsStr,
    library: &Path,
    params: &ParamArguments,
    libraries: &mut Libraries,
    notes: bool,
) -> Result<Source, Failure> {
    if library.is_dir() {
        return read_source(&find_in_folder(library, name)?, params);
    }
    let tool = libraries.read(library, params.root())?.select(&name.to_string_lossy())?;
    if notes {
        for note in &tool.entry.notes {
            message!("warning: {}: {note}", Escaped(tool.entry.label()));
        }
    }
    Ok(tool.source())
}

/// Returns whether a name is that of a `.tool` file.
fn is_tool_file(name: &OsStr) -> bool {
    extension(Path::new(name)).as_deref() == Some("tool")
}

/// Returns a built-in tool by its name.
///
/// # Errors
/// [`Failure::UnknownTool`], with a hint at what may be meant: at files within `root` alone, if it is given.
fn built_in(name: &str, root: Option<&Path>) -> Result<&'static dyn Tool, Failure> {
    touchoff_tools::find(name).ok_or_else(|| {
        // A name of any length is not compared as a whole.
        let known = TOOLS.iter().map(|tool| &*tool.info().name);
        let near = known.filter(|known| name.len() <= 2 * known.len()).map(|known| {
            let distance = strsim::damerau_levenshtein(&known.to_lowercase(), &name.to_lowercase());
            (distance, known)
        });
        // A longer name has room for more slips.
        let near = near.filter(|(distance, _)| *distance <= 1 + name.len() / 4);
        let is_file = |file: &Path| file.is_file() && root.is_none_or(|root| is_within(file, root));
        let hint = if is_tool_file(OsStr::new(name)) {
            "`touchoff tools` lists them; this command takes no files".to_owned()
        } else if Path::new(name).components().count() == 1 && is_file(Path::new(name)) {
            "a tool's file ends in `.tool`: rename it".to_owned()
        } else if is_file(&Path::new(name).with_extension("tool")) {
            format!("did you mean the file `{}.tool`?", escaped(name))
        } else if let Some((_, nearest)) = near.min_by_key(|(distance, _)| *distance) {
            format!("did you mean `{nearest}`? `touchoff tools` lists them")
        } else {
            "`touchoff tools` lists them; the name of a tool's file ends in `.tool`".to_owned()
        };
        Failure::UnknownTool { name: escaped(name).into_owned(), hint }
    })
}

/// Reads a `.tool` file.
///
/// # Errors
/// If it cannot be read; with a hint if a built-in tool is named instead.
pub(crate) fn read_source(file: &Path, params: &ParamArguments) -> Result<Source, Failure> {
    params.source(file).map_err(|error| {
        let tool = file.to_str().and_then(touchoff_tools::find).filter(|_| !file.exists());
        match tool {
            Some(tool) => Failure::FileExpected(tool.info().name.to_string()),
            None => error.into(),
        }
    })
}

/// Loads the tool of a file, and prints its warnings.
pub(crate) fn load_file(file: &Path, params: &ParamArguments) -> Result<Interpreted, Failure> {
    load(&read_source(file, params)?, params)
}

/// Loads a tool, and prints its warnings.
fn load(source: &Source, params: &ParamArguments) -> Result<Interpreted, Failure> {
    let tool = Interpreted::parse_with(source, &params.sources())?;
    if !tool.warnings().is_empty() {
        show_lines(tool.warnings());
    }
    Ok(tool)
}

/// Compiles the tool of a file, and shows its diagnostics.
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn compile_file(file: &Path, params: &ParamArguments) -> Result<Compiled, Failure> {
    let compiled = compile_source(&read_source(file, params)?, params);
    for diagnostic in compiled.diagnostics() {
        show(diagnostic, &compiled.sources);
    }
    Ok(compiled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A library of n tools would be read n times.
    #[test]
    fn a_library_is_read_once_for_all_its_tools() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = folder.path().join("library.json");
        let tool = |number: u32| {
            format!(
                "{{ \"type\": \"ball end mill\", \"unit\": \"millimeters\", \"post-process\": {{ \"number\": {number} }}, \
                 \"geometry\": {{ \"DC\": 4, \"RE\": 2, \"LCF\": 10, \"OAL\": 50, \"SFDM\": 4 }} }}"
            )
        };
        let text = format!("{{ \"data\": [{}, {}] }}", tool(1), tool(2));
        std::fs::write(&library, text).expect("written");
        let params = ParamArguments::new(Vec::new(), None);
        let arguments = ToolArguments { library: Some(library.clone()), params };
        let mut libraries = Libraries::default();
        let mut load =
            |name: &str| LoadedTool::load_from(name.as_ref(), &arguments, &mut libraries).is_ok();
        assert!(load("T1"));
        std::fs::remove_file(&library).expect("removed");
        assert!(load("T2") && !load("T3"));
    }
}
