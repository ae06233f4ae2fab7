//! Converts syntax errors to diagnostics in the terms of the language.

mod bracket;
mod expected;
mod spelling;

use super::Rule;
use crate::diagnostic::{Diagnostic, Expected, Names, SyntaxKind, is_hidden, nearest};
use crate::source::Span;
use expected::expected;
use pest::error::{Error, InputLocation};

/// The keywords that begin a file.
pub(super) const FILE_KEYWORDS: [&str; 2] = ["tool", "solid"];
const ITEM_KEYWORDS: [&str; 13] = [
    "units",
    "let",
    "param",
    "curve",
    "tip",
    "spindle",
    "profile",
    "mount",
    "regions",
    "region",
    "bsp",
    "magnitude",
    "niceness",
];
/// The words after `allow`, for a direction and for a niceness.
pub(super) const OBLIQUE_KEYWORD: &str = "oblique";
pub(super) const RISING_KEYWORD: &str = "rising";
const PROPERTY_KEYWORDS: [&str; 4] = ["depth", "magnitude", "direction", "niceness"];

/// Returns the error for a comparison that a closed region cannot have.
pub(super) fn comparison(span: Span, written: &str) -> Diagnostic {
    Diagnostic::new(span, SyntaxKind::StrictComparison { written: written.to_owned() })
}

/// Returns the error for an `allow` with a word that is not allowed there, or nowhere.
pub(super) fn allowance(span: Span, written: &str) -> Diagnostic {
    Diagnostic::new(span, SyntaxKind::UnknownAllowance { written: written.to_owned() })
}

/// The position in a text at which parsing stopped.
struct StopPosition<'t> {
    text: &'t str,
    /// The offset of the text among all sources.
    offset: usize,
    at: usize,
}

impl<'t> StopPosition<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// Returns the text before the position, without trailing blanks.
    fn before(&self) -> &'t str {
        self.text[..self.at].trim_end_matches(BLANK_CHARACTERS)
    }

    /// Returns the span between two positions of the text.
    fn span(&self, start: usize, end: usize) -> Span {
        Span { start, end }.offset_by(self.offset)
    }

    /// Returns the span of the next `length` bytes, and at least of the next character.
    fn next(&self, length: usize) -> Span {
        let character = self.rest().chars().next().map_or(0, char::len_utf8);
        self.span(self.at, self.at + length.max(character))
    }

    /// Returns the last word before the position, if nothing else follows it.
    fn last_word(&self) -> &'t str {
        let before = self.before();
        &before[before.trim_end_matches(in_name).len()..]
    }
}

/// The characters that pest skips.
const BLANK_CHARACTERS: [char; 4] = [' ', '\t', '\r', '\n'];

/// Converts a syntax error of pest, in a text that begins at `offset` of the source.
pub(super) fn syntax(text: &str, offset: usize, error: &Error<Rule>) -> Diagnostic {
    let stop = StopPosition { text, offset, at: error_offset(text, error) };
    let wants_end = error.parse_attempts().is_some_and(|attempts| {
        let ends = attempts.expected_tokens().iter().any(|token| token.to_string() == ";");
        ends && attempts.max_position >= rule_at(error)
    });
    let (rest, before) = (stop.rest(), stop.before());
    if let Some(diagnostic) = spelling::character_error(&stop)
        .or_else(|| item(&stop))
        .or_else(|| bracket::unmatched(&stop))
        .or_else(|| spelling::notation_error(&stop))
        .or_else(|| spelling::unclosed_error(&stop))
    {
        return diagnostic;
    }
    if wants_end && ends_a_value(before) && (rest.starts_with('}') || starts_a_word(rest)) {
        let end = before.len();
        return Diagnostic::new(
            stop.span(end.saturating_sub(1), end),
            SyntaxKind::MissingSemicolon,
        );
    }
    let expected = expected(error);
    does_not_fit(
        &stop,
        if expected.is_empty() { Expected::Unknown } else { Expected::OneOf(expected) },
    )
}

/// Returns an error for a quoted text that has a character unsafe to show on a screen.
pub(super) fn hidden(text: &str, place: Span) -> Option<Diagnostic> {
    let found = text.chars().find(|c| is_hidden(*c))?;
    Some(Diagnostic::new(place, SyntaxKind::HiddenCharacter { code: u32::from(found) }))
}

/// Returns the error for a text without a tool.
pub(super) fn nothing(text: &str) -> Diagnostic {
    let stop = StopPosition { text, offset: 0, at: text.len() };
    spelling::no_tool(&stop)
}

/// Converts a syntax error in the arguments of a tool's parameters.
pub(super) fn given(text: &str, error: &Error<Rule>) -> Diagnostic {
    let stop = StopPosition { text, offset: 0, at: error_offset(text, error) };
    spelling::character_error(&stop)
        .or_else(|| bracket::unmatched(&stop))
        .or_else(|| spelling::notation_error(&stop))
        .unwrap_or_else(|| does_not_fit(&stop, Expected::Argument))
}

fn does_not_fit(stop: &StopPosition<'_>, expected: Expected) -> Diagnostic {
    match first_token(stop.rest()) {
        "" => Diagnostic::new(stop.next(0), SyntaxKind::UnexpectedEnd { expected }),
        token => {
            let kind = SyntaxKind::UnexpectedToken { token: token.to_owned(), expected };
            Diagnostic::new(stop.next(token.len()), kind)
        }
    }
}

/// Returns the position at which the failed rule was tried.
fn rule_at(error: &Error<Rule>) -> usize {
    match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    }
}

/// Returns the position at which the text stops to match.
fn error_offset(text: &str, error: &Error<Rule>) -> usize {
    // Rules are tried where they begin; a token may have been missing further on.
    let token_at = error.parse_attempts().map_or(0, |attempts| attempts.max_position);
    let at = rule_at(error).max(token_at);
    text.len() - text[at..].trim_start_matches(BLANK_CHARACTERS).len()
}

/// Returns an error for an item or property that begins with an unknown word.
fn item(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let rest = stop.text.trim_start_matches(BLANK_CHARACTERS);
    let first = word(rest);
    if first.is_empty() {
        return None;
    }
    let start = stop.text.len() - rest.len();
    let span = stop.span(start, start + first.len());
    // A whole file includes its header; an item does not.
    if stop.offset == 0 && stop.at == start && !FILE_KEYWORDS.contains(&first) {
        let kind = SyntaxKind::UnknownFileKeyword {
            keyword: first.to_owned(),
            suggestion: nearest(first, FILE_KEYWORDS),
        };
        return Some(Diagnostic::new(span, kind));
    }
    if !FILE_KEYWORDS.contains(&first) && !ITEM_KEYWORDS.contains(&first) {
        let kind = SyntaxKind::UnknownItem {
            keyword: first.to_owned(),
            suggestion: nearest(first, ITEM_KEYWORDS.into_iter().chain(FILE_KEYWORDS)),
            known: Names::new(ITEM_KEYWORDS),
        };
        return Some(Diagnostic::new(span, kind));
    }
    let wrong = word(stop.rest());
    if first == "region" && !wrong.is_empty() && stop.before().contains('{') {
        let after = stop.rest()[wrong.len()..].trim_start_matches(BLANK_CHARACTERS);
        if after.starts_with(':') && !PROPERTY_KEYWORDS.contains(&wrong) {
            let kind = SyntaxKind::UnknownProperty {
                name: wrong.to_owned(),
                suggestion: nearest(wrong, PROPERTY_KEYWORDS),
            };
            return Some(Diagnostic::new(stop.next(wrong.len()), kind));
        }
    }
    None
}

/// Returns whether a character may be part of a name.
pub(super) fn in_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Returns the name at the beginning of a text.
fn word(text: &str) -> &str {
    let end = text.find(|c| !in_name(c)).unwrap_or(text.len());
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) { &text[..end] } else { "" }
}

fn first_token(text: &str) -> &str {
    match word(text) {
        "" => &text[..text.chars().next().map_or(0, char::len_utf8)],
        word => word,
    }
}

fn ends_a_value(before: &str) -> bool {
    before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == ')' || c == '_')
}

fn starts_a_word(rest: &str) -> bool {
    ITEM_KEYWORDS.into_iter().chain(PROPERTY_KEYWORDS).any(|item| word(rest) == item)
}
