//! Lists of diagnostics: evidence of an error, refusals, and how many are shown.

use super::{CheckKind, Diagnostic, Severity};
use crate::source::Span;

/// Evidence that an error is in the list of diagnostics. Refusing a tool takes one, and so does leaving
/// out an error that follows from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported(());

impl Reported {
    /// Adds an error to the diagnostics. One that [follows](Diagnostic::caused_by) from another error is evidence
    /// too: it was made from the evidence for that.
    pub(crate) fn push(diagnostics: &mut Vec<Diagnostic>, diagnostic: Diagnostic) -> Reported {
        diagnostics.push(Diagnostic { severity: Severity::Error, ..diagnostic });
        Reported(())
    }

    /// Finds the evidence in a list of diagnostics, if one of them is an error.
    pub(crate) fn among(diagnostics: &[Diagnostic]) -> Option<Reported> {
        any_error(diagnostics).then_some(Reported(()))
    }
}

/// Fails if one of the diagnostics is an error.
pub(crate) fn without_error(diagnostics: &[Diagnostic]) -> Result<(), Reported> {
    Reported::among(diagnostics).map_or(Ok(()), Err)
}

/// The reasons for which a tool is refused: at least one error, and the warnings beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// In the order of the text; one of them is an error.
    diagnostics: Vec<Diagnostic>,
}

impl Refusal {
    /// Refuses a tool for what was reported of it, at its name.
    pub(crate) fn new(diagnostics: Vec<Diagnostic>, place: Span, _: Reported) -> Refusal {
        let mut diagnostics = readable(diagnostics);
        if !any_error(&diagnostics) {
            // Evidence without an error is a defect; a user is told so rather than nothing.
            diagnostics.push(Diagnostic::new(place, CheckKind::Unexplained));
        }
        Refusal { diagnostics }
    }

    /// The errors and the warnings, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The errors alone, of which there is at least one.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// Returns the diagnostics in the order of the text, each once, and no more than can be read. Warnings
/// make room for errors.
pub(crate) fn readable(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.retain(|diagnostic| diagnostic.caused_by.is_none());
    diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
    // A file that is mounted twice has its mistakes once.
    let mut here: Vec<Diagnostic> = Vec::new();
    diagnostics.retain(|diagnostic| {
        here.retain(|other| other.span.start == diagnostic.span.start);
        let new = !here.contains(diagnostic);
        if new {
            here.push(diagnostic.clone());
        }
        new
    });
    if diagnostics.len() > MOST && any_error(&diagnostics) {
        diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
    }
    if let Some(next) =
        diagnostics.get(MOST).map(|diagnostic| (diagnostic.severity, diagnostic.span))
    {
        diagnostics.truncate(MOST);
        diagnostics.push(match next {
            (Severity::Error, span) => Diagnostic::new(span, CheckKind::MoreErrors),
            (Severity::Warning, span) => Diagnostic::new(span, CheckKind::MoreWarnings),
        });
    }
    diagnostics
}

/// The most mistakes that are shown at once.
pub const MOST: usize = 50;

/// Returns whether so much is wrong that looking for more helps nobody.
pub(crate) fn enough(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().filter(|diagnostic| diagnostic.caused_by.is_none()).count() >= MOST
}

/// Returns whether any of them is an error.
pub fn any_error(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}
