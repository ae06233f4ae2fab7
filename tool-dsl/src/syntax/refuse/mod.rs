//! What does not parse, said in the words of the language.

mod bracket;
mod expected;
mod spelling;

use super::Rule;
use crate::report::{Report, is_hidden, nearest};
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
pub(super) fn comparison(span: Span, written: &str) -> Report {
    let remedy = match written {
        "<" => "write `<=`",
        ">" => "write `>=`",
        "=" | "==" => "write two conditions, `a <= b` and `a >= b`, if a single line is meant",
        _ => "write `<=` or `>=`",
    };
    Report::error(span, format!("`{written}` is no comparison here: a region is closed"))
        .help(format!("{remedy}; a border belongs to the region listed first"))
}

/// An `allow` of something that is not allowed there, or nowhere.
pub(super) fn allowance(span: Span, written: &str) -> Report {
    Report::error(span, format!("`allow {written}` does not fit here"))
        .help(format!("write `direction: … allow {OBLIQUE};` or `niceness: … allow {RISING};`"))
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
pub(super) fn syntax(text: &str, offset: usize, error: &Error<Rule>) -> Report {
    let stop = Stop { text, offset, at: place(text, error) };
    let wants_end = error.parse_attempts().is_some_and(|attempts| {
        let ends = attempts.expected_tokens().iter().any(|token| token.to_string() == ";");
        ends && attempts.max_position >= rule_at(error)
    });
    let (rest, before) = (stop.rest(), stop.before());
    if let Some(report) = spelling::character(&stop)
        .or_else(|| item(&stop))
        .or_else(|| bracket::unmatched(&stop))
        .or_else(|| spelling::habit(&stop))
        .or_else(|| spelling::unended(&stop))
    {
        return report;
    }
    if wants_end && ends_a_value(before) && (rest.starts_with('}') || starts_a_word(rest)) {
        let end = before.len();
        return Report::error(stop.span(end.saturating_sub(1), end), "`;` is missing after this")
            .help("write `;` here");
    }
    let report = does_not_fit(&stop);
    match expected(error) {
        expected if expected.is_empty() => report,
        expected => report.help(format!("expected {expected}")),
    }
}

/// A text between quotes with a character that must not come onto a screen.
pub(super) fn hidden(text: &str, place: Span) -> Option<Report> {
    let found = text.chars().find(|c| is_hidden(*c))?;
    let message =
        format!("this text has the character U+{:04X}, which cannot be seen", found as u32);
    Some(Report::error(place, message).help("delete it: texts are shown as they are written"))
}

/// A text without a tool.
pub(super) fn nothing(text: &str) -> Report {
    let stop = Stop { text, offset: 0, at: text.len() };
    spelling::no_tool(&stop)
}

/// A syntax error in what a tool's params are given.
pub(super) fn given(text: &str, error: &Error<Rule>) -> Report {
    let stop = Stop { text, offset: 0, at: place(text, error) };
    spelling::character(&stop)
        .or_else(|| bracket::unmatched(&stop))
        .or_else(|| spelling::habit(&stop))
        .unwrap_or_else(|| {
            does_not_fit(&stop).help("write `PARAM = VALUE`, as in `D = 0.25inch, flute = 18`")
        })
}

fn does_not_fit(stop: &Stop<'_>) -> Report {
    match first_token(stop.rest()) {
        "" => Report::error(stop.next(0), "the text ends here"),
        token => Report::error(stop.next(token.len()), format!("`{token}` does not fit here")),
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
fn item(stop: &Stop<'_>) -> Option<Report> {
    let whole = stop.text.trim_start_matches(BLANK);
    let first = word(whole);
    if first.is_empty() {
        return None;
    }
    let start = stop.text.len() - whole.len();
    let place = stop.span(start, start + first.len());
    // A whole file comes with its header, an item without.
    if stop.offset == 0 && stop.at == start && !FILES.contains(&first) {
        let report = Report::error(place, format!("a file does not begin with `{first}`"));
        return Some(match nearest(first, FILES) {
            Some(meant) => report.help(format!("did you mean `{meant}`?")),
            None => report.help("write `tool Name { … }`, or `solid Name { … }` without an axis"),
        });
    }
    if !FILES.contains(&first) && !ITEMS.contains(&first) {
        let report = Report::error(place, format!("no item begins with `{first}`"));
        return Some(match (first, nearest(first, ITEMS.into_iter().chain(FILES))) {
            ("depth" | "direction", _) => {
                report.help(format!("`{first}:` belongs inside a `region`"))
            }
            (_, Some(meant)) => report.help(format!("did you mean `{meant}`?")),
            _ => report
                .help(format!("an item is one of {}", ITEMS.map(|i| format!("`{i}`")).join(", "))),
        });
    }
    let wrong = word(stop.rest());
    if first == "region" && !wrong.is_empty() && stop.before().contains('{') {
        let after = stop.rest()[wrong.len()..].trim_start_matches(BLANK);
        if after.starts_with(':') && !PROPERTIES.contains(&wrong) {
            let report =
                Report::error(stop.next(wrong.len()), format!("a region has no `{wrong}`"));
            return Some(match nearest(wrong, PROPERTIES) {
                Some(meant) => report.help(format!("did you mean `{meant}`?")),
                None => report.help("a region says `depth`, `magnitude`, `direction`, `niceness`"),
            });
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
