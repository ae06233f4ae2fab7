//! Profiles: the regions that the compiler derives, smooths or is given, against brute force.

mod bad;
mod compare;
mod derived;
mod draw;
mod hand;
mod outline;
mod random;
mod smooth;
mod valid;

use touchoff_dsl::CheckedTool;
use touchoff_tests::count::case_count;
use touchoff_tests::texts::{compiled, rendered};

/// Returns the tool of a text, or its diagnostics.
fn tool(text: &str) -> Result<Box<CheckedTool>, String> {
    let compiled = compiled(text);
    let said = rendered(&compiled);
    compiled.into_tool().filter(|_| said.is_empty()).ok_or(said)
}

fn profiles() -> usize {
    case_count("PROFILES", 60)
}
