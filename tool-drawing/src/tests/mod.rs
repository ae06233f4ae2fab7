//! Tests of drawings.

mod borders;
mod labels;
mod views;

use super::{Content, Picture};
use std::path::{Path, PathBuf};
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};

fn checked(source: &Source) -> Box<CheckedTool> {
    compile(source).outcome.unwrap_or_else(|refusal| panic!("{refusal:?}")).tool
}

fn tool(text: &str) -> Box<CheckedTool> {
    checked(&Source::new("test.tool", text))
}

/// Returns the folder of the library's tools.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools")
}

/// Returns a tool of the library by the name of its file.
fn library(name: &str) -> Box<CheckedTool> {
    let path = folder().join(name).with_extension("tool");
    checked(&Source::read(path).expect("the library has the file"))
}

fn whole(tool: &CheckedTool) -> Picture<'_> {
    Picture::new(tool, Content::Regions)
}
