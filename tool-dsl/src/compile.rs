//! From a text to a checked tool, and what is reported on the way.

use crate::checked::{self, CheckedTool};
use crate::diagnostic::{
    Diagnostic, Kind, Refusal, RegionKind, Reported, Severity, ValueKind, any_error, readable,
    without_error,
};
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
    /// The texts that the diagnostics speak of.
    pub sources: Sources,
}

/// A tool without an error.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The tool.
    pub tool: Box<CheckedTool>,
    /// Warnings about it, in the order of the text.
    pub warnings: Vec<Diagnostic>,
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
    pub fn diagnostics(&self) -> &[Diagnostic] {
        match &self.outcome {
            Ok(accepted) => &accepted.warnings,
            Err(refusal) => refusal.diagnostics(),
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
    let mut diagnostics = Vec::new();
    let mut name = None;
    let start = Span { start: 0, end: 0 };
    let outcome = match compiled(&mut sources, &mut name, &mut diagnostics) {
        Ok(tool) => Ok(Accepted { tool: Box::new(tool), warnings: readable(diagnostics) }),
        Err(reported) => {
            name_given(&sources, given.len(), &mut diagnostics);
            Err(Refusal::new(diagnostics, start, reported))
        }
    };
    Compiled { outcome, name, sources }
}

/// Names what the params are given beside each error of the tool's own text: a value may have broken it.
fn name_given(sources: &Sources, count: usize, diagnostics: &mut [Diagnostic]) {
    let given = &sources.all()[1..=count];
    if given.is_empty() {
        return;
    }
    let texts: Vec<String> = given.iter().map(|source| source.text.trim().to_owned()).collect();
    let is_given = |diagnostic: &Diagnostic| {
        let (source, _) = sources.locate(diagnostic.span);
        given.iter().any(|given| given.base == source.base)
    };
    for diagnostic in diagnostics.iter_mut() {
        if diagnostic.severity == Severity::Error && !is_given(diagnostic) {
            diagnostic.given = texts.clone().into();
        }
    }
}

/// Compiles the first of the sources with what the others give its params. Fails only with an error
/// among the diagnostics, and never succeeds with one.
fn compiled(
    sources: &mut Sources,
    name: &mut Option<String>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<CheckedTool, Reported> {
    let tree = syntax::parse(sources.own(), diagnostics);
    let mut settings = Vec::new();
    for source in &sources.all()[1..] {
        settings.extend(syntax::given(source, diagnostics));
    }
    let tree = tree?;
    *name = Some(tree.name.word.clone()).filter(|name| syntax::is_type_name(name));
    let mut found = Vec::new();
    let model = resolve::resolve(&tree, &settings, sources, &mut found);
    let broken: BTreeSet<&str> = tree.broken.iter().map(String::as_str).collect();
    let unread = any_error(diagnostics);
    diagnostics
        .extend(found.into_iter().filter(|diagnostic| !unread || !follows(diagnostic, &broken)));
    let model = model?;
    without_error(diagnostics)?;
    checked::check(model, diagnostics)
}

/// Returns whether a diagnostic only says that what a broken item would have said is missing.
fn follows(diagnostic: &Diagnostic, broken: &BTreeSet<&str>) -> bool {
    let has = |word: &str| broken.contains(word);
    match &diagnostic.kind {
        Kind::ValueKind(kind) => match kind {
            ValueKind::UnknownName { word, .. }
            | ValueKind::UnknownFunction { word, .. }
            | ValueKind::UnknownUnit { word, .. }
            | ValueKind::UnknownFileUnit { word, .. } => has(word),
            ValueKind::UnusedName { .. } => true,
            ValueKind::NoUnit => has("units"),
            _ => false,
        },
        Kind::RegionKind(kind) => match kind {
            RegionKind::UnknownCurve { word, .. } => has(word),
            RegionKind::UnknownSurface { word, .. } => has(word) || has("region"),
            RegionKind::NoRegion { .. } => true,
            _ => false,
        },
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::{NameRemedy, SurfaceRemedy};

    /// What follows from a broken item is decided by the kind and its names, not by a message.
    #[test]
    fn words_decide_nothing() {
        let at = Span { start: 0, end: 0 };
        let broken = BTreeSet::from(["flute", "units"]);
        let follows = |kind: Kind| follows(&Diagnostic::new(at, kind), &broken);
        let name = |word: &str| {
            let (word, remedy) = (word.to_owned(), NameRemedy::Define);
            ValueKind::UnknownName { word, remedy }.into()
        };
        let surface = |word: &str| {
            let (word, remedy) = (word.to_owned(), SurfaceRemedy::OfProfile);
            RegionKind::UnknownSurface { word, remedy }.into()
        };
        assert!(follows(name("flute")) && !follows(name("shank")));
        assert!(follows(surface("flute")) && !follows(surface("shank")));
        assert!(follows(ValueKind::NoUnit.into()));
        assert!(follows(ValueKind::UnusedName { word: "shank".to_owned() }.into()));
        // A name of a broken item in another kind is no reason to be silent.
        assert!(!follows(ValueKind::DefinedTwice { word: "flute".to_owned() }.into()));
    }
}
