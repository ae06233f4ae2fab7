//! Lists of diagnostics: evidence of an error, refusals, and the limit on their number.

use super::{CheckKind, Diagnostic, Severity};
use crate::source::Span;

/// Evidence that the list of diagnostics contains an error. It is required to refuse a tool, and to omit an
/// error that follows from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported(());

impl Reported {
    /// Adds an error to the diagnostics. An error that [follows](Diagnostic::caused_by) from another is
    /// evidence too, since it was made from the evidence for that one.
    pub(crate) fn push(diagnostics: &mut Vec<Diagnostic>, diagnostic: Diagnostic) -> Reported {
        diagnostics.push(Diagnostic { severity: Severity::Error, ..diagnostic });
        Reported(())
    }

    /// Returns the evidence if the list contains an error.
    pub(crate) fn among(diagnostics: &[Diagnostic]) -> Option<Reported> {
        any_error(diagnostics).then_some(Reported(()))
    }
}

/// Checks that no diagnostic is an error.
///
/// # Errors
/// The evidence, if one is.
pub(crate) fn without_error(diagnostics: &[Diagnostic]) -> Result<(), Reported> {
    Reported::among(diagnostics).map_or(Ok(()), Err)
}

/// The reasons for refusing a tool: at least one error, and its warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The diagnostics in the order of the text, including at least one error.
    diagnostics: Vec<Diagnostic>,
}

impl Refusal {
    /// Makes a refusal from the diagnostics of a tool. `place` locates the fallback error.
    pub(crate) fn new(diagnostics: Vec<Diagnostic>, place: Span, _: Reported) -> Refusal {
        let mut diagnostics = readable(diagnostics);
        if !any_error(&diagnostics) {
            // Evidence without an error is a defect of the compiler; the user gets a message even then.
            diagnostics.push(Diagnostic::new(place, CheckKind::Unexplained));
        }
        Refusal { diagnostics }
    }

    /// Returns the errors and the warnings, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Returns the errors alone, at least one.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// Returns the diagnostics in the order of the text, without duplicates and at most as many as can be read.
/// Warnings are dropped first.
pub(crate) fn readable(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.retain(|diagnostic| diagnostic.caused_by.is_none());
    diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
    // A file that is mounted twice reports each error once.
    let mut shown_here: Vec<Diagnostic> = Vec::new();
    diagnostics.retain(|diagnostic| {
        shown_here.retain(|other| other.span.start == diagnostic.span.start);
        let new = !shown_here.contains(diagnostic);
        if new {
            shown_here.push(diagnostic.clone());
        }
        new
    });
    if diagnostics.len() > MAX_DIAGNOSTICS && any_error(&diagnostics) {
        diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
    }
    if let Some(next) =
        diagnostics.get(MAX_DIAGNOSTICS).map(|diagnostic| (diagnostic.severity, diagnostic.span))
    {
        diagnostics.truncate(MAX_DIAGNOSTICS);
        diagnostics.push(match next {
            (Severity::Error, span) => Diagnostic::new(span, CheckKind::MoreErrors),
            (Severity::Warning | Severity::Note, span) => {
                Diagnostic::new(span, CheckKind::MoreWarnings)
            }
        });
    }
    diagnostics
}

/// The largest number of diagnostics shown at once.
pub const MAX_DIAGNOSTICS: usize = 50;

/// Returns whether there are so many diagnostics that more would not help.
pub(crate) fn enough(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().filter(|diagnostic| diagnostic.caused_by.is_none()).count()
        >= MAX_DIAGNOSTICS
}

/// Returns whether the list contains an error.
pub fn any_error(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}
