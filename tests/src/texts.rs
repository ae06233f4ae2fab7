//! Texts of tools, and what the compiler says of them.

use touchoff_dsl::diagnostic::Diagnostic;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, Compiled, compile};

/// Compiles a text that comes from no file.
pub fn compiled(text: impl Into<String>) -> Compiled {
    compile(&Source::new("t.tool", text))
}

/// Returns the tool of a text, whatever its warnings.
pub fn tool(text: impl Into<String>) -> Box<CheckedTool> {
    accepted(compiled(text))
}

/// Returns the tool that was compiled, whatever its warnings.
pub fn accepted(compiled: Compiled) -> Box<CheckedTool> {
    let said = rendered(&compiled);
    compiled.into_tool().unwrap_or_else(|| panic!("{said}"))
}

/// Returns all diagnostics as they are shown.
pub fn rendered(compiled: &Compiled) -> String {
    let render = |report: &Diagnostic| report.render(&compiled.sources, false);
    compiled.diagnostics().iter().map(render).collect::<Vec<_>>().join("\n")
}

/// Returns what was compiled.
#[track_caller]
pub fn with_one_error(compiled: Compiled) -> Compiled {
    let said = rendered(&compiled);
    assert_eq!(said.matches("error[").count(), 1, "{said}");
    compiled
}

/// Asserts that a text is refused, and that all of some words are shown.
#[track_caller]
pub fn assert_refused(compiled: &Compiled, words: &[&str]) {
    let said = rendered(compiled);
    assert!(compiled.tool().is_none(), "taken, not refused for {words:?}");
    for word in words {
        assert!(said.contains(word), "`{word}` is missing in:\n{said}");
    }
}

/// Asserts that each line `items => word | word` is [refused][assert_refused].
#[track_caller]
pub fn assert_each_refused(cases: &str, compiled: impl Fn(&str) -> Compiled) {
    for case in cases.trim().lines() {
        let (items, words) = case.split_once(" => ").expect("items and words");
        assert_refused(&compiled(items), &words.split(" | ").collect::<Vec<_>>());
    }
}

/// Asserts that each line `items => message => place` is refused with a message of these words, at a place that begins
/// so; one without a message has no diagnostics.
pub fn assert_mistakes(cases: &str, text: impl Fn(&str) -> String) {
    let mut wrong = Vec::new();
    for case in cases.lines() {
        let mut parts = case.split(" => ");
        let said = said(&text(parts.next().unwrap_or_default()));
        let (words, place) = (parts.next(), parts.next().unwrap_or_default());
        let is_said = |words| {
            said.iter().any(|(message, at)| message.contains(words) && at.starts_with(place))
        };
        if !words.map_or(said.is_empty(), is_said) {
            wrong.push(format!("{case}\n  has {said:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the messages about a text, each with the text of its place.
pub fn said(text: &str) -> Vec<(String, String)> {
    let compiled = compiled(text);
    let place = |report: &Diagnostic| compiled.sources.text(report.span).to_owned();
    let reports = compiled.diagnostics().iter();
    let said: Vec<_> = reports.map(|report| (report.message(), place(report))).collect();
    assert!(compiled.tool().is_some() || !said.is_empty(), "refused without a word: {text}");
    said
}
