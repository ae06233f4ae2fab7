//! Diagnostics: errors and warnings that state the location, the reason and the remedy.
//!
//! A [`Diagnostic`] holds data only: a [`Kind`] with a stable code, and its locations. The texts of all kinds
//! are in one table, family by family, so that rewording one changes no decision. `docs/errors.md` is
//! generated from it.

use crate::source::{Source, Sources, Span};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::ops::Range;

mod checks;
mod data;
mod kind;
mod mounts;
mod profile;
mod refusal;
mod regions;
mod spelling;
mod syntax;
mod table;
mod values;

pub use checks::CheckKind;
pub use data::{
    CycleLinks, Expected, FormattedNumber, MountChain, NameRemedy, NameStart, Names, Operation,
    ParamRemedy, Role, Statement, Subject, SurfaceRemedy, format_number, nearest,
};
pub use kind::{FAMILIES, Family, Kind, entries, entry};
pub use mounts::MountKind;
pub use profile::ProfileKind;
pub use refusal::{MAX_DIAGNOSTICS, Refusal, Reported, any_error};
pub(crate) use refusal::{enough, readable, without_error};
pub use regions::RegionKind;
pub use spelling::SpellingKind;
pub use syntax::SyntaxKind;
pub use table::{Entry, Example};
pub use values::ValueKind;

pub use crate::dimension::Dimension;

/// The severity of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// A note needs no change of the text.
    Note,
    /// A warning does not prevent code from being emitted.
    Warning,
    /// An error prevents code from being emitted.
    Error,
}

/// An error, a warning or a note.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Error, warning or note.
    pub severity: Severity,
    /// The reason.
    pub kind: Kind,
    /// The location.
    pub span: Span,
    /// A second location with a label of its own.
    pub secondary: Option<(Span, String)>,
    /// Evidence of the error that this one follows from. Such a diagnostic is not shown.
    caused_by: Option<Reported>,
    /// The arguments of params that may have caused it, as they were written.
    pub(crate) arguments: Box<[String]>,
}

impl Diagnostic {
    /// Makes a diagnostic at a location, with the severity of its kind.
    pub fn new(span: Span, kind: impl Into<Kind>) -> Diagnostic {
        let kind = kind.into();
        let severity = kind.severity();
        Diagnostic {
            severity,
            kind,
            span,
            secondary: None,
            caused_by: None,
            arguments: Box::default(),
        }
    }

    /// Returns the code of its kind.
    pub fn code(&self) -> &'static str {
        self.kind.code()
    }

    /// Returns the reason, in the terms of the domain.
    pub fn message(&self) -> String {
        self.kind.message()
    }

    /// Returns the remedy, and the arguments of params that may be the cause.
    pub fn help(&self) -> String {
        let help = self.kind.help();
        if self.arguments.is_empty() {
            return help;
        }
        format!("{help}; given: {}", Names(self.arguments.to_vec()))
    }

    /// Marks the diagnostic as a consequence of another error in the list. It is then not shown.
    #[must_use]
    pub(crate) fn caused_by(self, cause: Reported) -> Diagnostic {
        Diagnostic { caused_by: Some(cause), ..self }
    }

    /// Adds a second location.
    #[must_use]
    pub fn with_label(mut self, span: Span, label: impl Into<String>) -> Diagnostic {
        self.secondary = Some((span, label.into()));
        self
    }

    /// Moves the locations to a text that begins at `base`.
    pub(crate) fn offset_by(mut self, base: usize) -> Diagnostic {
        self.span = self.span.offset_by(base);
        self.secondary = self.secondary.map(|(span, label)| (span.offset_by(base), label));
        self
    }

    /// Renders code and message, the source's line with a caret, and the remedy. `styled` adds terminal
    /// colours.
    pub fn render(&self, sources: &Sources, styled: bool) -> String {
        let renderer = if styled { Renderer::styled() } else { Renderer::plain() };
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
            Severity::Note => Level::NOTE,
        };
        let (source, span) = sources.locate(self.span);
        let primary = AnnotationKind::Primary.span(visible(source, span));
        let mut snippet = excerpt(source).annotation(primary);
        let mut elsewhere = None;
        if let Some((span, label)) = &self.secondary {
            let (other, span) = sources.locate(*span);
            let second =
                AnnotationKind::Context.span(visible(other, span)).label(escaped_lines(label));
            if std::ptr::eq(other, source) {
                snippet = snippet.annotation(second);
            } else {
                elsewhere = Some(excerpt(other).annotation(second));
            }
        }
        let title = level.primary_title(escaped_lines(&self.message())).id(self.code());
        let mut group: Group<'_> = title.element(snippet);
        if let Some(elsewhere) = elsewhere {
            group = group.element(elsewhere);
        }
        group = group.element(Level::HELP.message(escaped_lines(&self.help())));
        renderer.render(&[group])
    }
}

fn excerpt(source: &Source) -> Snippet<'_, Annotation<'_>> {
    Snippet::source(harmless(&source.text)).path(escaped(&source.name))
}

/// Returns the part of a location that can be shown: whole characters of the text.
fn visible(source: &Source, span: Span) -> Range<usize> {
    let start = source.text.floor_char_boundary(span.start.min(source.text.len()));
    start..source.text.ceil_char_boundary(span.end.min(source.text.len())).max(start)
}

/// Returns whether a character is a control character, or a mark that changes the text direction. A name or a
/// text must not bring either onto a terminal.
pub(crate) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{feff}')
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Returns a name or other text with an escape such as `\u{1b}` in place of every control character and every
/// mark that changes the text direction.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let escaped = text.chars().map(|c| match is_hidden(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    });
    Cow::Owned(escaped.collect())
}

/// Returns the lines of a text for display, with every byte at its offset. The renderer itself replaces
/// one-byte control characters.
fn harmless(text: &str) -> Cow<'_, str> {
    let replaced = |c: &char| is_hidden(*c) && c.len_utf8() > 1;
    if !text.chars().any(|c| replaced(&c)) {
        return Cow::Borrowed(text);
    }
    // The replacements have as many bytes as what they replace.
    let shown = text.chars().map(|c| match c.len_utf8() {
        _ if !replaced(&c) => c,
        2 => '\u{bf}',
        _ => '\u{fffd}',
    });
    Cow::Owned(shown.collect())
}

/// Returns the lines of a message, each escaped.
fn escaped_lines(text: &str) -> String {
    text.split('\n').map(escaped).collect::<Vec<_>>().join("\n")
}
