//! What does not parse, said in the words of the language.

mod bracket;
mod expected;
mod spelling;

use super::Rule;
use crate::diagnostic::{Diagnostic, Expected, Names, SyntaxKind, is_hidden, nearest};
use crate::source::Span;
use expected::expected;
use pest::error::{Error, InputLocation};

/// What a file is.
pub(super) const FILES: [&str; 2] = ["tool", "solid"];
const ITEMS: [&str; 13] = [
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
/// The words behind `allow`, of a direction and of a niceness.
pub(super) const OBLIQUE: &str = "oblique";
pub(super) const RISING: &str = "rising";
const PROPERTIES: [&str; 4] = ["depth", "magnitude", "direction", "niceness"];

/// A comparison that a closed region cannot have.
pub(super) fn comparison(span: Span, written: &str) -> Diagnostic {
    Diagnostic::new(span, SyntaxKind::StrictComparison { written: written.to_owned() })
}

/// An `allow` of something that is not allowed there, or nowhere.
pub(super) fn allowance(span: Span, written: &str) -> Diagnostic {
    Diagnostic::new(span, SyntaxKind::UnknownAllowance { written: written.to_owned() })
}

/// A text that stopped to fit somewhere.
struct Stop<'t> {
    text: &'t str,
    /// Where the text begins among all sources.
    offset: usize,
    at: usize,
}

impl<'t> Stop<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// What was read, without blanks at its end.
    fn before(&self) -> &'t str {
        self.text[..self.at].trim_end_matches(BLANK)
    }

    /// The stretch between two places of the text.
    fn span(&self, start: usize, end: usize) -> Span {
        Span { start, end }.behind(self.offset)
    }

    /// The next bytes, or the next character.
    fn next(&self, length: usize) -> Span {
        let character = self.rest().chars().next().map_or(0, char::len_utf8);
        self.span(self.at, self.at + length.max(character))
    }

    /// The last word that was read, if nothing stands behind it.
    fn last_word(&self) -> &'t str {
        let before = self.before();
        &before[before.trim_end_matches(in_name).len()..]
    }
}

/// What pest skips.
const BLANK: [char; 4] = [' ', '\t', '\r', '\n'];

/// A syntax error of pest's, at a place in a text that begins at `offset` of the source.
pub(super) fn syntax(text: &str, offset: usize, error: &Error<Rule>) -> Diagnostic {
    let stop = Stop { text, offset, at: place(text, error) };
    let wants_end = error.parse_attempts().is_some_and(|attempts| {
        let ends = attempts.expected_tokens().iter().any(|token| token.to_string() == ";");
        ends && attempts.max_position >= rule_at(error)
    });
    let (rest, before) = (stop.rest(), stop.before());
    if let Some(diagnostic) = spelling::character(&stop)
        .or_else(|| item(&stop))
        .or_else(|| bracket::unmatched(&stop))
        .or_else(|| spelling::habit(&stop))
        .or_else(|| spelling::unended(&stop))
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

/// A text between quotes with a character that must not come onto a screen.
pub(super) fn hidden(text: &str, place: Span) -> Option<Diagnostic> {
    let found = text.chars().find(|c| is_hidden(*c))?;
    Some(Diagnostic::new(place, SyntaxKind::HiddenCharacter { code: u32::from(found) }))
}

/// A text without a tool.
pub(super) fn nothing(text: &str) -> Diagnostic {
    let stop = Stop { text, offset: 0, at: text.len() };
    spelling::no_tool(&stop)
}

/// A syntax error in what a tool's params are given.
pub(super) fn given(text: &str, error: &Error<Rule>) -> Diagnostic {
    let stop = Stop { text, offset: 0, at: place(text, error) };
    spelling::character(&stop)
        .or_else(|| bracket::unmatched(&stop))
        .or_else(|| spelling::habit(&stop))
        .unwrap_or_else(|| does_not_fit(&stop, Expected::Setting))
}

fn does_not_fit(stop: &Stop<'_>, expected: Expected) -> Diagnostic {
    match first_token(stop.rest()) {
        "" => Diagnostic::new(stop.next(0), SyntaxKind::TextEnds { expected }),
        token => {
            let kind = SyntaxKind::DoesNotFit { token: token.to_owned(), expected };
            Diagnostic::new(stop.next(token.len()), kind)
        }
    }
}

/// Where a rule was tried that did not fit.
fn rule_at(error: &Error<Rule>) -> usize {
    match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    }
}

/// Where a text stopped to fit.
fn place(text: &str, error: &Error<Rule>) -> usize {
    // Rules are tried where they begin; a token may have been missing further on.
    let token_at = error.parse_attempts().map_or(0, |attempts| attempts.max_position);
    let at = rule_at(error).max(token_at);
    text.len() - text[at..].trim_start_matches(BLANK).len()
}

/// An item or property that begins with a word that none does.
fn item(stop: &Stop<'_>) -> Option<Diagnostic> {
    let whole = stop.text.trim_start_matches(BLANK);
    let first = word(whole);
    if first.is_empty() {
        return None;
    }
    let start = stop.text.len() - whole.len();
    let place = stop.span(start, start + first.len());
    // A whole file comes with its header, an item without.
    if stop.offset == 0 && stop.at == start && !FILES.contains(&first) {
        let kind = SyntaxKind::UnknownFile { word: first.to_owned(), meant: nearest(first, FILES) };
        return Some(Diagnostic::new(place, kind));
    }
    if !FILES.contains(&first) && !ITEMS.contains(&first) {
        let kind = SyntaxKind::UnknownItem {
            word: first.to_owned(),
            meant: nearest(first, ITEMS.into_iter().chain(FILES)),
            known: Names::new(ITEMS),
        };
        return Some(Diagnostic::new(place, kind));
    }
    let wrong = word(stop.rest());
    if first == "region" && !wrong.is_empty() && stop.before().contains('{') {
        let after = stop.rest()[wrong.len()..].trim_start_matches(BLANK);
        if after.starts_with(':') && !PROPERTIES.contains(&wrong) {
            let kind = SyntaxKind::UnknownProperty {
                word: wrong.to_owned(),
                meant: nearest(wrong, PROPERTIES),
            };
            return Some(Diagnostic::new(stop.next(wrong.len()), kind));
        }
    }
    None
}

/// Whether a character may stand in a name.
pub(super) fn in_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The name that a text begins with.
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
    ITEMS.into_iter().chain(PROPERTIES).any(|item| word(rest) == item)
}
