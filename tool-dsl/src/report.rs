//! What the compiler says about a tool: errors and warnings that name the place, the reason and
//! the remedy.

use crate::source::{Source, Sources, Span};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing; code is emitted all the same.
    Warning,
    /// Nothing is emitted.
    Error,
}

/// Something that a text does not have. Whether a report only follows from another one is decided by it, not by its words.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Missing {
    /// The definition of a name.
    Name(String),
    /// A function, a curve or a unit of that name.
    Definition(String),
    /// A surface of that name.
    Surface(String),
    /// A use of what is defined.
    Use,
    /// A region, or a profile.
    Region,
    /// The unit of length.
    Unit,
}

/// One thing to say.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Report {
    /// Error or warning.
    pub severity: Severity,
    /// The reason, in the words of the domain.
    pub message: String,
    /// The place.
    pub span: Span,
    /// A second culprit with its own word.
    pub second: Option<(Span, String)>,
    /// The remedy.
    pub help: Option<String>,
    /// What is missing, if the report is about that.
    pub(crate) missing: Option<Missing>,
}

impl Report {
    /// An error at a place.
    pub fn error(span: Span, message: impl Into<String>) -> Report {
        Report {
            severity: Severity::Error,
            message: message.into(),
            span,
            second: None,
            help: None,
            missing: None,
        }
    }

    /// A warning at a place.
    pub fn warning(span: Span, message: impl Into<String>) -> Report {
        Report { severity: Severity::Warning, ..Report::error(span, message) }
    }

    /// With what is missing.
    #[must_use]
    pub(crate) fn missing(self, missing: Missing) -> Report {
        Report { missing: Some(missing), ..self }
    }

    /// An error that only follows from another one, which is reported; this one is not shown.
    pub(crate) fn follow_up(span: Span, _: Reported) -> Report {
        Report::error(span, "")
    }

    /// Returns whether the report only follows from another one.
    pub(crate) fn is_follow_up(&self) -> bool {
        self.message.is_empty()
    }

    /// With a second place.
    #[must_use]
    pub fn and(mut self, span: Span, label: impl Into<String>) -> Report {
        self.second = Some((span, label.into()));
        self
    }

    /// With the remedy.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Report {
        self.help = Some(help.into());
        self
    }

    /// The same report of a text that begins at `base`.
    pub(crate) fn behind(mut self, base: usize) -> Report {
        self.span = self.span.behind(base);
        self.second = self.second.map(|(span, label)| (span.behind(base), label));
        self
    }

    /// The report as text: the source's line, a caret, the remedy. `styled` adds terminal colours.
    pub fn render(&self, sources: &Sources, styled: bool) -> String {
        let renderer = if styled { Renderer::styled() } else { Renderer::plain() };
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let (source, span) = sources.locate(self.span);
        let primary = AnnotationKind::Primary.span(visible(source, span));
        let mut snippet = excerpt(source).annotation(primary);
        let mut elsewhere = None;
        if let Some((span, label)) = &self.second {
            let (other, span) = sources.locate(*span);
            let second =
                AnnotationKind::Context.span(visible(other, span)).label(escaped_lines(label));
            if std::ptr::eq(other, source) {
                snippet = snippet.annotation(second);
            } else {
                elsewhere = Some(excerpt(other).annotation(second));
            }
        }
        let mut group: Group<'_> =
            level.primary_title(escaped_lines(&self.message)).element(snippet);
        if let Some(elsewhere) = elsewhere {
            group = group.element(elsewhere);
        }
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(escaped_lines(help)));
        }
        renderer.render(&[group])
    }
}

fn excerpt(source: &Source) -> Snippet<'_, Annotation<'_>> {
    Snippet::source(harmless(&source.text)).path(escaped(&source.name))
}

/// Returns whether a character is a control character, or one of the marks that turn the order of a line around: what a
/// name or a text must not bring onto a screen.
pub(crate) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{feff}')
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Returns a text that names something, with an escape `\u{1b}` in place of every control character and every
/// mark that turns the order of a line around.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let escape = |c: char| match is_hidden(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    Cow::Owned(text.chars().map(escape).collect())
}

/// The lines of a text to be shown, every byte in its place. The renderer replaces one-byte control characters
/// itself.
fn harmless(text: &str) -> Cow<'_, str> {
    let replaced = |c: &char| is_hidden(*c) && c.len_utf8() > 1;
    if !text.chars().any(|c| replaced(&c)) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| match c.len_utf8() {
        _ if !replaced(&c) => c,
        2 => '\u{bf}',
        _ => '\u{fffd}',
    };
    Cow::Owned(text.chars().map(shown).collect())
}

/// The lines of a message, each escaped.
fn escaped_lines(text: &str) -> String {
    text.split('\n').map(escaped).collect::<Vec<_>>().join("\n")
}

/// Evidence that an error is in the list of reports. Refusing a tool takes one, and so does leaving
/// out an error that follows from another.
#[derive(Clone, Copy, Debug)]
pub struct Reported(());

impl Reported {
    /// Adds an error to the reports. A [follow-up](Report::follow_up) is evidence too: it was made
    /// from the evidence for the error that it follows from.
    pub(crate) fn push(reports: &mut Vec<Report>, report: Report) -> Reported {
        reports.push(Report { severity: Severity::Error, ..report });
        Reported(())
    }

    /// Finds the evidence in a list of reports, if one of them is an error.
    pub(crate) fn among(reports: &[Report]) -> Option<Reported> {
        any_error(reports).then_some(Reported(()))
    }
}

/// Fails if one of the reports is an error.
pub(crate) fn without_error(reports: &[Report]) -> Result<(), Reported> {
    Reported::among(reports).map_or(Ok(()), Err)
}

/// The reasons for which a tool is refused: at least one error, and the warnings beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// In the order of the text; one of them is an error with a message.
    reports: Vec<Report>,
}

impl Refusal {
    /// Refuses a tool for what was reported of it, at its name.
    pub(crate) fn new(reports: Vec<Report>, place: Span, _: Reported) -> Refusal {
        let mut reports = readable(reports);
        if !any_error(&reports) {
            // Evidence without a message is a defect; a user is told so rather than nothing.
            reports.push(
                Report::error(place, "this tool is refused, and the compiler did not say why")
                    .help("this is a defect of the compiler: please report it with the file"),
            );
        }
        Refusal { reports }
    }

    /// The errors and the warnings, in the order of the text.
    pub fn reports(&self) -> &[Report] {
        &self.reports
    }

    /// The errors alone, of which there is at least one.
    pub fn errors(&self) -> impl Iterator<Item = &Report> {
        self.reports.iter().filter(|report| report.severity == Severity::Error)
    }
}

/// Returns the reports in the order of the text, each once, and no more than can be read. Warnings
/// make room for errors.
pub(crate) fn readable(mut reports: Vec<Report>) -> Vec<Report> {
    reports.retain(|report| !report.is_follow_up());
    reports.sort_by_key(|report| report.span.start);
    // A file that is mounted twice has its mistakes once.
    let mut seen = HashSet::new();
    reports.retain(|report| seen.insert(report.clone()));
    if reports.len() > MOST && any_error(&reports) {
        reports.retain(|report| report.severity == Severity::Error);
    }
    if let Some(next) = reports.get(MOST).map(|report| (report.severity, report.span)) {
        reports.truncate(MOST);
        reports.push(match next {
            (Severity::Error, span) => Report::error(span, "more is wrong from here on")
                .help("mend what stands above first"),
            (Severity::Warning, span) => Report::warning(span, "more is warned of from here on")
                .help("look at what stands above first"),
        });
    }
    reports
}

/// What can be shown of a place: whole characters of the text.
fn visible(source: &Source, span: Span) -> Range<usize> {
    let start = source.text.floor_char_boundary(span.start.min(source.text.len()));
    start..source.text.ceil_char_boundary(span.end.min(source.text.len())).max(start)
}

/// A number for people: six significant digits.
pub fn figure(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !(1e-4..1e15).contains(&size) {
        return if size == 0.0 { "0".to_owned() } else { format!("{value:.5e}") };
    }
    let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// The most mistakes that are told at once.
pub const MOST: usize = 50;

/// Whether so much is wrong that looking for more helps nobody.
pub(crate) fn enough(reports: &[Report]) -> bool {
    reports.iter().filter(|report| !report.is_follow_up()).count() >= MOST
}

/// Whether any of them is an error.
pub fn any_error(reports: &[Report]) -> bool {
    reports.iter().any(|report| report.severity == Severity::Error)
}

/// The word of `known` that is nearest to `word`, if it is near enough to be meant.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(edits, candidate)| *edits <= candidate.len().max(word.len()).div_ceil(3))
        .min()
        .map(|(_, candidate)| candidate)
}
