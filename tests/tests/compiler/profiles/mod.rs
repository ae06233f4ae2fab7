//! Profiles: the regions that the compiler derives, smooths or is given, against brute force.

mod bad;
mod compare;
mod derived;
mod draw;
mod hand;
mod outline;
mod random;
mod rounded;
mod smooth;
mod valid;

use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};
use touchoff_tests::count::case_count;

/// Returns the tool of a text, or its diagnostics.
fn tool(text: &str) -> Result<Box<CheckedTool>, String> {
    let source = Source::new("t.tool", text);
    let compiled = compile(&source);
    let said: Vec<String> =
        compiled.diagnostics().iter().map(|r| r.render(&compiled.sources, false)).collect();
    match compiled.into_tool() {
        Some(tool) if said.is_empty() => Ok(tool),
        _ => Err(said.join("\n")),
    }
}

/// Returns the tool of a text, whatever its warnings.
fn warned(text: &str) -> Option<Box<CheckedTool>> {
    compile(&Source::new("t.tool", text)).into_tool()
}

/// Returns the diagnostics of a text, each with the text of its place.
fn said(text: &str) -> Vec<(String, String)> {
    let compiled = compile(&Source::new("t.tool", text));
    let place = |report: &touchoff_dsl::diagnostic::Diagnostic| {
        compiled.sources.text(report.span).to_owned()
    };
    let said = compiled.diagnostics().iter();
    let said: Vec<_> = said.map(|report| (report.message(), place(report))).collect();
    assert!(compiled.tool().is_some() || !said.is_empty(), "refused without a word: {text}");
    said
}

/// Returns the number of random profiles to test.
fn profiles() -> usize {
    case_count("PROFILES", 60)
}
