//! From a text to a checked tool, and what is reported on the way.

use crate::checked::{self, CheckedTool};
use crate::report::{self, Missing, Refusal, Report, Reported, Severity, any_error, without_error};
use crate::resolve;
use crate::source::{Source, Sources, Span};
use crate::syntax;
use std::collections::BTreeSet;

/// The result of compiling a text: a tool, or the errors for which there is none.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The tool and its warnings, or why it is refused.
    pub outcome: Result<Accepted, Refusal>,
    /// The tool's name, if the text got so far.
    pub name: Option<String>,
    /// The texts that the reports speak of.
    pub sources: Sources,
}

/// A tool without an error.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The tool.
    pub tool: Box<CheckedTool>,
    /// Warnings about it, in the order of the text.
    pub warnings: Vec<Report>,
}

impl Compiled {
    /// The same tool as another Rust type.
    #[must_use]
    pub fn named(mut self, name: &str) -> Compiled {
        if let Ok(accepted) = &mut self.outcome {
            accepted.tool.rename(name);
        }
        self.name = self.name.map(|_| name.to_owned());
        self
    }

    /// The tool, if it is not refused.
    pub fn tool(&self) -> Option<&CheckedTool> {
        self.outcome.as_ref().ok().map(|accepted| &*accepted.tool)
    }

    /// The tool itself, if it is not refused.
    pub fn into_tool(self) -> Option<Box<CheckedTool>> {
        self.outcome.ok().map(|accepted| accepted.tool)
    }

    /// Errors and warnings, in the order of the text.
    pub fn reports(&self) -> &[Report] {
        match &self.outcome {
            Ok(accepted) => &accepted.warnings,
            Err(refusal) => refusal.reports(),
        }
    }
}

/// Compiles a tool's text as far as a checked tool. The files that it mounts are read beside the
/// file that holds it.
pub fn compile(source: &Source) -> Compiled {
    compile_with(source, &[])
}

/// Compiles a tool of which some params are given: `D = 0.25inch, flute = 18`, with constant
/// expressions of the language. What is given replaces the default; a bare number is in the tool's
/// unit.
pub fn compile_with(source: &Source, given: &[Source]) -> Compiled {
    let mut sources = Sources::new(source.clone(), given.iter().cloned());
    let mut reports = Vec::new();
    let mut name = None;
    let start = Span { start: 0, end: 0 };
    let outcome = match compiled(&mut sources, &mut name, &mut reports) {
        Ok(tool) => Ok(Accepted { tool: Box::new(tool), warnings: report::readable(reports) }),
        Err(reported) => {
            name_given(&sources, given.len(), &mut reports);
            Err(Refusal::new(reports, start, reported))
        }
    };
    Compiled { outcome, name, sources }
}

/// Names what the params are given beside each error of the tool's own text: a value may have broken it.
fn name_given(sources: &Sources, count: usize, reports: &mut [Report]) {
    let given = &sources.all()[1..=count];
    if given.is_empty() {
        return;
    }
    let texts: Vec<String> =
        given.iter().map(|source| format!("`{}`", source.text.trim())).collect();
    let note = format!("given: {}", texts.join(", "));
    let is_given = |report: &Report| {
        let (source, _) = sources.locate(report.span);
        given.iter().any(|given| given.base == source.base)
    };
    for report in reports.iter_mut() {
        if report.severity == Severity::Error && !report.is_follow_up() && !is_given(report) {
            report.help = Some(match report.help.take() {
                Some(help) => format!("{help}; {note}"),
                None => note.clone(),
            });
        }
    }
}

/// Compiles the first of the sources with what the others give its params. Fails only with an error
/// among the reports, and never succeeds with one.
fn compiled(
    sources: &mut Sources,
    name: &mut Option<String>,
    reports: &mut Vec<Report>,
) -> Result<CheckedTool, Reported> {
    let tree = syntax::parse(sources.own(), reports);
    let mut settings = Vec::new();
    for source in &sources.all()[1..] {
        settings.extend(syntax::given(source, reports));
    }
    let tree = tree?;
    *name = Some(tree.name.word.clone()).filter(|name| syntax::is_type_name(name));
    let mut found = Vec::new();
    let model = resolve::resolve(&tree, &settings, sources, &mut found);
    let broken: BTreeSet<&str> = tree.broken.iter().map(String::as_str).collect();
    let unread = any_error(reports);
    reports.extend(found.into_iter().filter(|report| !unread || !follows(report, &broken)));
    let model = model?;
    without_error(reports)?;
    checked::check(model, reports)
}

/// Returns whether a report only says that what a broken item would have said is missing.
fn follows(report: &Report, broken: &BTreeSet<&str>) -> bool {
    let has = |word: &str| broken.contains(word);
    match &report.missing {
        None => false,
        Some(Missing::Name(word) | Missing::Definition(word)) => has(word),
        Some(Missing::Surface(word)) => has(word) || has("region"),
        Some(Missing::Use | Missing::Region) => true,
        Some(Missing::Unit) => has("units"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reports are told by what is missing, however they are worded.
    #[test]
    fn words_decide_nothing() {
        let at = Span { start: 0, end: 0 };
        let broken = BTreeSet::from(["flute", "units"]);
        let follows = |message: &str, missing: Option<Missing>| {
            let report = Report { missing, ..Report::error(at, message) };
            follows(&report, &broken)
        };
        let flute = || "flute".to_owned();
        for message in ["unknown name `flute`", "there is no flute"] {
            assert!(!follows(message, None));
            assert!(follows(message, Some(Missing::Name(flute()))));
            assert!(follows(message, Some(Missing::Surface(flute()))));
            assert!(!follows(message, Some(Missing::Definition("shank".to_owned()))));
            assert!(!follows(message, Some(Missing::Surface("shank".to_owned()))));
            assert!(follows(message, Some(Missing::Unit)) && follows(message, Some(Missing::Use)));
        }
    }
}
