//! Tools compiled from the `.tool` files in this package's folder `tools/`.
//!
//! Each file becomes a type; [`TOOLS`] lists them all, and [`find`] looks one up by name. A program that
//! needs only a few of them disables the default features and enables the features named after their files.
//! The other tools are then not compiled.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

touchoff::tool_library!("tools");

use touchoff::Tool;

/// Returns the tool with the given name, if there is one.
pub fn find(name: &str) -> Option<&'static dyn Tool> {
    TOOLS.iter().find(|tool| tool.info().name == name).copied()
}
