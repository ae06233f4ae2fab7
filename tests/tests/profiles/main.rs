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

use tool_dsl::source::Source;
use tool_dsl::{Checked, compile};

/// The tool of a text, or what is said of it.
fn tool(text: &str) -> Result<Box<Checked>, String> {
    let source = Source::new("t.tool", text);
    let compiled = compile(&source);
    let said: Vec<String> =
        compiled.reports().iter().map(|r| r.render(&compiled.sources, false)).collect();
    match compiled.into_tool() {
        Some(tool) if said.is_empty() => Ok(tool),
        _ => Err(said.join("\n")),
    }
}

/// What is said of a text, each with the text of its place.
fn said(text: &str) -> Vec<(String, String)> {
    let compiled = compile(&Source::new("t.tool", text));
    let place = |report: &tool_dsl::report::Report| compiled.sources.text(report.span).to_owned();
    let said = compiled.reports().iter();
    let said: Vec<_> = said.map(|report| (report.message.clone(), place(report))).collect();
    assert!(compiled.tool().is_some() || !said.is_empty(), "refused without a word: {text}");
    said
}
