//! Tools compiled from the `.tool` files of this package's folder `tools/`.
//!
//! Each file is a type of its own; [`TOOLS`] lists them all, [`find`] finds one by name.

touchoff::tool_library!("tools");

use touchoff::Tool;

/// The tool of a name.
pub fn find(name: &str) -> Option<&'static dyn Tool> {
    TOOLS.iter().find(|tool| tool.card().name == name).copied()
}
