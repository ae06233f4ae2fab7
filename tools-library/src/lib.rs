//! Tools compiled from the `.tool` files of this package's folder `tools/`.
//!
//! Each file is a type of its own; [`TOOLS`] lists them all, [`find`] finds one by name. A program that
//! wants a few of them turns the default features off and names their files as features: for the others
//! nothing is compiled.

touchoff::tool_library!("tools");

use touchoff::Tool;

/// The tool of a name.
pub fn find(name: &str) -> Option<&'static dyn Tool> {
    TOOLS.iter().find(|tool| tool.card().name == name).copied()
}
