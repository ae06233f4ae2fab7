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

use std::ffi::OsStr;
use tool_dsl::source::Source;
use tool_dsl::{CheckedTool, compile};

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
    let place =
        |report: &tool_dsl::diagnostic::Diagnostic| compiled.sources.text(report.span).to_owned();
    let said = compiled.diagnostics().iter();
    let said: Vec<_> = said.map(|report| (report.message(), place(report))).collect();
    assert!(compiled.tool().is_some() || !said.is_empty(), "refused without a word: {text}");
    said
}

/// Returns the number of random profiles to test: the variable `PROFILES`, or 60 without it.
///
/// # Panics
/// If the variable is no whole number above 0: a typing error must not pass for a long run.
fn profiles() -> usize {
    match count(std::env::var_os("PROFILES").as_deref()) {
        Ok(count) => count,
        Err(text) => panic!("PROFILES is `{text}`: give a whole number above 0"),
    }
}

/// Returns the number that a variable holds, or its text where it is none.
fn count(value: Option<&OsStr>) -> Result<usize, String> {
    let Some(value) = value else { return Ok(60) };
    let number = value.to_str().and_then(|text| text.parse().ok());
    number.filter(|count| *count > 0).ok_or_else(|| value.to_string_lossy().into_owned())
}

#[test]
fn a_count_that_is_no_number_is_refused() {
    let counted = |text: &str| count(Some(OsStr::new(text)));
    assert_eq!((count(None), counted("1000")), (Ok(60), Ok(1000)));
    for wrong in ["", "0", "-1", "6O", "1e3", "60 ", "1_000", "99999999999999999999999"] {
        assert_eq!(counted(wrong), Err(wrong.to_owned()));
    }
}
