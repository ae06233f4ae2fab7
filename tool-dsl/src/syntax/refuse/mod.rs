//! Converts syntax errors to diagnostics in the terms of the language.

use super::Rule;
use super::lexeme::{FILE_KEYWORDS, Kind, Lexeme, in_name, lexemes};
use crate::diagnostic::{Diagnostic, Expected, Names, SyntaxKind, is_hidden, nearest};
use crate::source::Span;
use pest::error::{Error, ErrorVariant, InputLocation};

mod spelling;

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

    /// Returns whether no blank stands before the position.
    fn is_glued(&self) -> bool {
        self.before().len() == self.at
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
        .or_else(|| unmatched(&stop))
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
    let expected = expected_input(error);
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
        .or_else(|| unmatched(&stop))
        .or_else(|| spelling::notation_error(&stop))
        .unwrap_or_else(|| does_not_fit(&stop, Expected::Argument))
}

fn does_not_fit(stop: &StopPosition<'_>, expected: Expected) -> Diagnostic {
    match first_token(stop.rest()) {
        "" => Diagnostic::new(stop.next(0), SyntaxKind::UnexpectedEnd { expected }),
        token => {
            let similar = match &expected {
                Expected::OneOf(words) => {
                    let words =
                        words.iter().filter_map(|word| word.strip_prefix('`')?.strip_suffix('`'));
                    nearest(token, words.filter(|word| !word.contains('`'))).map(str::to_owned)
                }
                _ => None,
            };
            let in_profile = word(stop.text.trim_start_matches(BLANK_CHARACTERS)) == "profile";
            let expected = match similar {
                Some(similar) => Expected::Similar(similar),
                None if in_profile && token == "start" => Expected::OneStart,
                None => expected,
            };
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

/// Returns descriptions of the rules and tokens that would have matched.
fn expected_input(error: &Error<Rule>) -> Vec<String> {
    let attempts = error.parse_attempts();
    let token_at = attempts.as_ref().map_or(0, |attempts| attempts.max_position);
    let rules: &[Rule] = match &error.variant {
        ErrorVariant::ParsingError { positives, .. } if token_at <= rule_at(error) => positives,
        _ => &[],
    };
    let tokens = attempts.as_ref().map_or(Vec::new(), |attempts| attempts.expected_tokens());
    let tokens: Vec<String> = tokens.iter().map(ToString::to_string).collect();
    let mut words: Vec<String> = rules.iter().filter_map(|r| rule(*r)).map(str::to_owned).collect();
    let ruled = !words.is_empty();
    words.extend(tokens.iter().filter_map(|t| token(t, ruled)));
    words.sort_unstable();
    words.dedup();
    words
}

/// Describes a token. Word tokens are described only if no rule is.
fn token(token: &str, ruled: bool) -> Option<String> {
    match token {
        "+" | "-" | "*" | "/" | "^" if !ruled => Some("an operator".to_owned()),
        ";" | "," | ":" | "=" | "{" | "}" | "(" | ")" => Some(format!("`{token}`")),
        "<=" | ">=" => Some("`<=` or `>=`".to_owned()),
        "as" => Some("`as NAME`".to_owned()),
        keyword if !ruled && word(keyword).len() == keyword.len() && keyword.len() > 1 => {
            Some(format!("`{keyword}`"))
        }
        _ => None,
    }
}

fn rule(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::expr
        | Rule::product
        | Rule::signed
        | Rule::power
        | Rule::number
        | Rule::signed_atom => "an expression",
        Rule::call | Rule::variable | Rule::group => "an expression",
        Rule::name => "a name",
        Rule::text => "a text between `\"`",
        Rule::tuple => "a point in parentheses",
        Rule::plus | Rule::times | Rule::minus => "an operator",
        Rule::compare => "`<=` or `>=`",
        Rule::condition => "a condition",
        Rule::surface => "`as NAME`",
        Rule::where_ => "`where`",
        Rule::with | Rule::k_with => "`with`",
        Rule::at | Rule::k_at => "`at`",
        Rule::setting => "`PARAM = VALUE`",
        Rule::cutting | Rule::k_cutting => "`cutting`",
        Rule::allow | Rule::k_allow => "`allow`",
        Rule::scalar | Rule::direction => "`depth:`, `magnitude:`, `direction:`, `niceness:`",
        Rule::sign => "`+` or `-`",
        Rule::k_z => "`z`",
        Rule::k_tool | Rule::tool => "`tool Name { … }`",
        Rule::k_solid | Rule::solid => "`solid Name { … }`",
        Rule::k_from => "`from`",
        Rule::which | Rule::path => "a surface's name",
        Rule::EOI => "the end",
        Rule::stray | Rule::tool_item | Rule::units => "an item",
        _ => return None,
    })
}

/// Returns whether a word begins an item and nothing else.
fn begins_an_item(word: &str) -> bool {
    ITEM_KEYWORDS.contains(&word) && !["magnitude", "niceness"].contains(&word)
}

/// Returns an error for an unmatched bracket, if parsing stopped because of it.
fn unmatched(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let Brackets { unclosed, extra } = Brackets::of(stop.text);
    if let Some((at, bracket)) = extra.filter(|(at, _)| *at == stop.at) {
        let diagnostic =
            Diagnostic::new(stop.span(at, at + 1), SyntaxKind::UnmatchedBracket { bracket });
        return Some(diagnostic);
    }
    let (at, bracket) = unclosed.filter(|(at, _)| *at < stop.at)?;
    let closing_bracket = if bracket == '{' { '}' } else { ')' };
    let kind = SyntaxKind::UnclosedBracket { bracket, closing_bracket };
    let diagnostic = Diagnostic::new(stop.span(at, at + 1), kind);
    Some(match first_token(stop.rest()) {
        "" => diagnostic,
        next => diagnostic.with_label(stop.next(next.len()), "still open here"),
    })
}

/// The start of each line of a text, and the indentation of its first character that is not a blank.
struct Lines(Vec<(usize, Option<usize>)>);

impl Lines {
    fn of(text: &str) -> Lines {
        let mut start = 0;
        let lines = text.split_inclusive('\n').map(|line| {
            let from = start;
            start += line.len();
            (from, line.find(|c: char| !c.is_ascii_whitespace()))
        });
        Lines(lines.collect())
    }

    /// Returns the indentation of the line at a position, and whether the position is the line's first character that
    /// is not a blank. `None` in the first line.
    fn indent(&self, at: usize) -> Option<(usize, bool)> {
        let line = self.0.partition_point(|(start, _)| *start <= at).checked_sub(1)?;
        let (start, width) = self.0[line];
        width.filter(|_| line > 0).map(|width| (width, start + width == at))
    }
}

/// The first unmatched brackets of a text.
#[derive(Default)]
struct Brackets {
    unclosed: Option<(usize, char)>,
    extra: Option<(usize, char)>,
}

impl Brackets {
    fn of(text: &str) -> Brackets {
        let mut found = Brackets::default();
        let lines = Lines::of(text);
        let mut open_brackets: Vec<(usize, char)> = Vec::new();
        let mut begins = true;
        // The braces that contain the start of another item, so they were not closed.
        let mut swallows = None;
        let is_whole_file = FILE_KEYWORDS.contains(&word(text.trim_start()));
        let file = text.find('{').filter(|_| is_whole_file);
        for Lexeme { start: at, end, kind } in lexemes(text) {
            match kind {
                Kind::Mark(c @ ('(' | '{')) => open_brackets.push((at, c)),
                Kind::Mark(c @ (')' | '}')) => {
                    let last = open_brackets.last().copied();
                    match last.filter(|(_, other)| (*other == '(') == (c == ')')) {
                        Some((begun, _)) => {
                            // A closing brace indented less than its block belongs to the enclosing block.
                            let indents = lines.indent(at).zip(lines.indent(begun));
                            if c == '}'
                                && indents.is_some_and(|(own, other)| own.1 && own.0 < other.0)
                            {
                                swallows = swallows.or(Some((begun, '{')));
                            }
                            open_brackets.pop();
                        }
                        None if open_brackets.is_empty() || c == ')' => {
                            found.extra = found.extra.or(Some((at, c)));
                        }
                        // A `}` closes all parentheses that are open inside its braces.
                        None => {
                            found.unclosed = found.unclosed.or(open_brackets.last().copied());
                            while open_brackets.pop().is_some_and(|(_, bracket)| bracket != '{') {}
                        }
                    }
                }
                Kind::Word if begins && swallows.is_none() && begins_an_item(&text[at..end]) => {
                    let innermost = open_brackets.iter().rev().find(|(_, bracket)| *bracket == '{');
                    swallows = innermost.copied().filter(|(first, _)| Some(*first) != file);
                }
                _ => {}
            }
            if kind != Kind::Skipped {
                begins = matches!(kind, Kind::Mark(';' | '{' | '}'));
            }
        }
        if !open_brackets.is_empty() {
            found.unclosed = found.unclosed.or(swallows).or(open_brackets.last().copied());
        }
        found
    }
}
