//! The texts of the library's tools.

use std::path::{Path, PathBuf};
use touchoff::tool::Tool;
use touchoff_dsl::CheckedTool;
use touchoff_dsl::source::Source;

/// Returns the folder of the library's `.tool` files.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools")
}

/// Returns the files of the library's tools, in the order of their names.
pub fn files() -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder()).expect("the library's folder");
    let mut files: Vec<PathBuf> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    files.retain(|path| path.extension().is_some_and(|end| end == "tool"));
    files.sort();
    files
}

/// Reads every tool of the library, in the order of file names.
pub fn library() -> Vec<Source> {
    let read = |path| Source::read(path).expect("the library has the file");
    files().into_iter().map(read).collect()
}

/// Returns a compiled tool of the library.
pub fn tool(name: &str) -> &'static dyn Tool {
    touchoff_tools::find(name).unwrap_or_else(|| panic!("the library has no {name}"))
}

/// Reads a file of the library, by its name without the ending.
pub fn source(name: &str) -> Source {
    Source::read(folder().join(name).with_extension("tool")).expect("the library has the file")
}

/// Checks a file of the library, by its name without the ending.
pub fn checked(name: &str) -> Box<CheckedTool> {
    let compiled = touchoff_dsl::compile(&source(name));
    compiled.outcome.unwrap_or_else(|refusal| panic!("{name}: {refusal:?}")).tool
}
