//! Compilation of a text to a checked tool, with its diagnostics.

use crate::checked::{self, CheckedTool};
use crate::diagnostic::{
    Diagnostic, Kind, Refusal, RegionKind, Reported, Severity, ValueKind, any_error, readable,
    without_error,
};
use crate::source::{Source, Sources, Span};
use crate::{resolve, syntax, validate};
use std::collections::BTreeSet;

/// The result of compiling a text: a tool, or the errors that prevent it.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The tool and its warnings, or the errors that refuse it.
    pub outcome: Result<Accepted, Refusal>,
    /// The tool's name, if the text could be parsed that far.
    pub name: Option<String>,
    /// The texts that the diagnostics refer to.
    pub sources: Sources,
}

/// A tool without errors.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The tool.
    pub tool: Box<CheckedTool>,
    /// The warnings about it, in the order of the text.
    pub warnings: Vec<Diagnostic>,
}

impl Compiled {
    /// Renames the tool, and with it the Rust type.
    #[must_use]
    pub fn renamed(mut self, name: &str) -> Compiled {
        if let Ok(accepted) = &mut self.outcome {
            accepted.tool.rename(name);
        }
        self.name = self.name.map(|_| name.to_owned());
        self
    }

    /// Returns the tool, unless it was refused.
    pub fn tool(&self) -> Option<&CheckedTool> {
        self.outcome.as_ref().ok().map(|accepted| &*accepted.tool)
    }

    /// Returns the tool by value, unless it was refused.
    pub fn into_tool(self) -> Option<Box<CheckedTool>> {
        self.outcome.ok().map(|accepted| accepted.tool)
    }

    /// Returns errors and warnings, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        match &self.outcome {
            Ok(accepted) => &accepted.warnings,
            Err(refusal) => refusal.diagnostics(),
        }
    }
}

/// Compiles a tool's text to a checked tool. Mounted files are read relative to the file that contains the
/// text.
pub fn compile(source: &Source) -> Compiled {
    compile_with_arguments(source, &[])
}

/// Compiles a tool with arguments for its params: `D = 0.25inch, flute = 18`, where the values are constant
/// expressions of the language. An argument replaces the default; a bare number is in the tool's unit.
pub fn compile_with_arguments(source: &Source, arguments: &[Source]) -> Compiled {
    let mut sources = Sources::new(source.clone(), arguments.iter().cloned());
    let mut diagnostics = Vec::new();
    let mut name = None;
    let start = Span { start: 0, end: 0 };
    let outcome = match compiled(&mut sources, &mut name, &mut diagnostics) {
        Ok(tool) => Ok(Accepted { tool: Box::new(tool), warnings: readable(diagnostics) }),
        Err(reported) => {
            attach_arguments(&sources, arguments.len(), &mut diagnostics);
            Err(Refusal::new(diagnostics, start, reported))
        }
    };
    Compiled { outcome, name, sources }
}

/// Adds the params' arguments to each error in the tool's own text, since one of their values may be the
/// cause.
fn attach_arguments(sources: &Sources, count: usize, diagnostics: &mut [Diagnostic]) {
    let given = &sources.all()[1..=count];
    if given.is_empty() {
        return;
    }
    let texts: Vec<String> = given.iter().map(|source| source.text.trim().to_owned()).collect();
    for diagnostic in diagnostics.iter_mut() {
        let (source, _) = sources.locate(diagnostic.span);
        let is_given = given.iter().any(|given| given.base == source.base);
        if diagnostic.severity == Severity::Error && !is_given {
            diagnostic.arguments = texts.clone().into();
        }
    }
}

/// Compiles the first of the sources with the others as arguments of its params.
///
/// # Errors
/// If and only if the diagnostics contain an error.
fn compiled(
    sources: &mut Sources,
    name: &mut Option<String>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<CheckedTool, Reported> {
    let tree = syntax::parse(sources.main(), diagnostics);
    let mut settings = Vec::new();
    for source in &sources.all()[1..] {
        settings.extend(syntax::parse_argument(source, diagnostics));
    }
    let tree = tree?;
    *name = Some(tree.name.text.clone()).filter(|name| syntax::is_type_name(name));
    let mut found = Vec::new();
    let model = resolve::resolve(&tree, &settings, sources, &mut found);
    let broken: BTreeSet<&str> = tree.unparsed.iter().map(String::as_str).collect();
    let unread = any_error(diagnostics);
    diagnostics
        .extend(found.into_iter().filter(|diagnostic| !unread || !follows(diagnostic, &broken)));
    let model = model?;
    without_error(diagnostics)?;
    debug_assert_eq!(validate::model(&model), Ok(()), "`resolve` keeps its guarantees");
    checked::check(model, diagnostics)
}

/// Returns whether a diagnostic only reports the absence of what a broken item would have defined.
fn follows(diagnostic: &Diagnostic, broken: &BTreeSet<&str>) -> bool {
    let has = |word: &str| broken.contains(word);
    match &diagnostic.kind {
        Kind::ValueKind(kind) => match kind {
            ValueKind::UnknownName { name, .. }
            | ValueKind::UnknownFunction { name, .. }
            | ValueKind::UnknownUnit { unit: name, .. }
            | ValueKind::UnknownFileUnit { unit: name, .. } => has(name),
            ValueKind::UnusedName { .. } => true,
            ValueKind::MissingUnit => has("units"),
            _ => false,
        },
        Kind::RegionKind(kind) => match kind {
            RegionKind::UnknownCurve { name, .. } => has(name),
            RegionKind::UnknownSurface { name, .. } => has(name) || has("region"),
            RegionKind::NoCuttingSurface { .. } => has("region") || has("profile"),
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

    /// The consequences of a broken item are recognised by kind and names, not by a message's text.
    #[test]
    fn consequences_are_recognised_by_kind_and_name() {
        let at = Span { start: 0, end: 0 };
        let broken = BTreeSet::from(["flute", "units"]);
        let follows = |kind: Kind| follows(&Diagnostic::new(at, kind), &broken);
        let name = |name: &str| {
            let (name, remedy) = (name.to_owned(), NameRemedy::Define);
            ValueKind::UnknownName { name, remedy }.into()
        };
        let surface = |name: &str| {
            let (name, remedy) = (name.to_owned(), SurfaceRemedy::OfProfile);
            RegionKind::UnknownSurface { name, remedy }.into()
        };
        assert!(follows(name("flute")) && !follows(name("shank")));
        assert!(follows(surface("flute")) && !follows(surface("shank")));
        assert!(follows(ValueKind::MissingUnit.into()));
        assert!(follows(ValueKind::UnusedName { name: "shank".to_owned() }.into()));
        // The same name in another kind of diagnostic is no reason to suppress it.
        assert!(!follows(ValueKind::DuplicateDefinition { name: "flute".to_owned() }.into()));
    }
}
