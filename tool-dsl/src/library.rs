//! The tools of the library, on which fast and slow paths are compared.

use crate::checked::CheckedTool;
use crate::compile;
use crate::source::Source;
use std::path::Path;

/// Compiles every tool of the library.
pub(crate) fn tools() -> Vec<CheckedTool> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools");
    let mut tools = Vec::new();
    for entry in folder.read_dir().expect("the library's folder") {
        let path = entry.expect("an entry of the folder").path();
        if path.extension().is_some_and(|extension| extension == "tool") {
            let source = Source::read(&path).expect("a file of the library");
            tools.push(*compile(&source).into_tool().expect("a tool without errors"));
        }
    }
    tools
}

/// Compiles the tools of the library whose regions are written by hand.
pub(crate) fn tools_by_hand() -> Vec<CheckedTool> {
    tools().into_iter().filter(|tool| tool.model.profile.is_none()).collect()
}
