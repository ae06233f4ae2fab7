//! Spelling mistakes: foreign characters, and constructs of other languages.

use super::{BLANK_CHARACTERS, StopPosition, ends_a_value, word};
use crate::diagnostic::{Diagnostic, Kind, NameStart, SpellingKind, SyntaxKind};
use crate::source::Span;
use crate::syntax::lexeme::{FILE_KEYWORDS, in_name};

/// Typographic characters, each with the ASCII that replaces it.
const REPLACEMENTS: [(char, &str); 13] = [
    ('×', "*"),
    ('·', "*"),
    ('÷', "/"),
    ('−', "-"),
    ('–', "-"),
    ('—', "-"),
    ('≤', "<="),
    ('≥', ">="),
    ('π', "pi"),
    ('√', "sqrt(…)"),
    ('“', "\""),
    ('”', "\""),
    ('„', "\""),
];

/// Words after which a name follows.
const NAMING_KEYWORDS: [&str; 7] = ["tool", "solid", "let", "param", "curve", "region", "as"];

/// Returns the error of a kind at a place.
fn error(span: Span, kind: impl Into<Kind>) -> Option<Diagnostic> {
    Some(Diagnostic::new(span, kind))
}

/// Returns the digits with which a text begins.
fn digits(text: &str) -> &str {
    &text[..text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len())]
}

/// Returns the error that the next character identifies, or a number before it that ends in a decimal point.
pub(super) fn character_error(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let next = rest.chars().next()?;
    let next_character = stop.next(0);
    let at_character = |kind: SpellingKind| Some(Diagnostic::new(next_character, kind));
    let number = number_before(before);
    if let Some(digits) = number.strip_suffix('.') {
        let span = stop.span(before.len() - number.len(), before.len());
        return error(span, SpellingKind::TrailingPoint { digits: digits.to_owned() });
    }
    let glued = stop.is_glued();
    // The span of `begun` and this character, or of this character alone if blanks separate them.
    let joined_span = |begun: &str| {
        let end = stop.at + next.len_utf8();
        stop.span(if glued { stop.at - begun.len() } else { stop.at }, end)
    };
    match next {
        '.' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            at_character(SpellingKind::LeadingPoint { fraction: digits(&rest[1..]).to_owned() })
        }
        '°' if !number.is_empty() => {
            error(joined_span(number), SpellingKind::DegreeSign { number: number.to_owned() })
        }
        '²' | '³' => {
            let power = if next == '²' { 2 } else { 3 };
            let base = stop.last_word();
            let kind = SpellingKind::Superscript { base: base.to_owned(), sign: next, power };
            error(joined_span(base), kind)
        }
        '⌀' | 'ø' | 'Ø' => at_character(SpellingKind::DiameterSign { sign: next }),
        '\'' => at_character(SpellingKind::SingleQuote),
        '[' => at_character(SpellingKind::SquareBracket { written: '[', suggestion: '(' }),
        ']' => at_character(SpellingKind::SquareBracket { written: ']', suggestion: ')' }),
        // Elsewhere `^` is an unexpected token like any other.
        '^' if ends_a_value(before) && before.contains('^') => {
            at_character(SpellingKind::ChainedPower)
        }
        '\u{feff}' if stop.offset + stop.at == 0 => at_character(SpellingKind::ByteOrderMark),
        '"' if glued && !number.is_empty() => {
            at_character(SpellingKind::InchSign { number: number.to_owned() })
        }
        '"' if stop.text.matches('"').count() % 2 == 1 => unclosed_error(stop),
        '"' => at_character(SpellingKind::MisplacedText),
        '_' if glued && !number.is_empty() => at_character(SpellingKind::UnderscoreInNumber),
        '_' => at_character(SpellingKind::InvalidNameStart { start: NameStart::Underscore }),
        _ => match REPLACEMENTS.iter().find(|(wrong, _)| *wrong == next) {
            Some((_, suggestion)) => {
                at_character(SpellingKind::Lookalike { written: next, suggestion })
            }
            None => foreign_character_error(next).and_then(at_character),
        },
    }
}

/// Returns the error for a character that the language does not use. An invisible one is shown by its code point.
fn foreign_character_error(next: char) -> Option<SpellingKind> {
    let visible = !(next.is_control()
        || next.is_whitespace()
        || matches!(next, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(next, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffd}'));
    match next {
        _ if next.is_ascii() && !next.is_control() => None,
        _ if visible => Some(SpellingKind::ForeignCharacter { written: next }),
        _ => Some(SpellingKind::InvisibleCharacter { code: u32::from(next) }),
    }
}

/// Returns the error for a construct of another language or notation: a space before a unit, `and` or `||`, a malformed
/// name, a foreign operator, a decimal comma, an extra `;`, or a second tool.
pub(super) fn notation_error(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let next = word(rest);
    let number = number_before(before);
    if ["mm", "inch", "m", "deg", "rad", "in"].contains(&next) && !number.is_empty() {
        let unit = if next == "in" { "inch" } else { next }.to_owned();
        return error(
            stop.next(next.len()),
            SpellingKind::SpaceBeforeUnit {
                written: next.to_owned(),
                number: number.to_owned(),
                unit,
            },
        );
    }
    if ["and", "or"].contains(&next) || rest.starts_with("&&") || rest.starts_with("||") {
        // `&&` and `||` are no words and have two bytes.
        let length = next.len().max(2);
        return error(stop.next(length), SpellingKind::LogicalOperator);
    }
    if let Some(diagnostic) = name_error(stop).or_else(|| operator_error(stop)) {
        return Some(diagnostic);
    }
    // A digit before the comma may end a name, as in `x1,2`, or a decimal number.
    let is_integer = !number.is_empty() && !number.contains('.');
    let after_comma = rest.strip_prefix(',').unwrap_or_default();
    if is_integer && after_comma.starts_with(|c: char| c.is_ascii_digit()) {
        let fraction = digits(after_comma).to_owned();
        return error(
            stop.next(1),
            SpellingKind::DecimalComma { number: number.to_owned(), fraction },
        );
    }
    if rest.starts_with(';') && before.is_empty() {
        return error(stop.next(1), SpellingKind::ExtraSemicolon);
    }
    if FILE_KEYWORDS.contains(&next) {
        return error(stop.next(next.len()), SpellingKind::SecondTool { keyword: next.to_owned() });
    }
    None
}

/// Returns the error for an empty file, or for text or a comment that is not closed.
pub(super) fn unclosed_error(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let comment = |at: usize| Diagnostic::new(stop.span(at, at + 2), SyntaxKind::UnclosedComment);
    if stop.rest().starts_with("/*") {
        return Some(comment(stop.at));
    }
    let read = stop.text.trim_matches(BLANK_CHARACTERS);
    if stop.offset == 0 && stop.rest().is_empty() && word(read).is_empty() {
        return Some(no_tool(stop));
    }
    // Quoted text cannot continue on the next line: one of an odd number of quotation marks on a line is unmatched.
    let mut start = 0;
    for line in stop.text.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        if let (1, Some(at)) = (code.matches('"').count() % 2, code.rfind('"')) {
            let span = stop.span(start + at, start + at + 1);
            return error(span, SpellingKind::UnclosedText);
        }
        start += line.len();
    }
    let before = stop.before();
    // A heuristic: comment marks inside quoted text are counted too.
    let is_in_comment = before.matches("/*").count() > before.matches("*/").count();
    is_in_comment.then(|| comment(before.rfind("/*").unwrap_or_default()))
}

/// Returns the error for a text that ends without a tool.
pub(super) fn no_tool(stop: &StopPosition<'_>) -> Diagnostic {
    Diagnostic::new(stop.next(0), SyntaxKind::NoTool)
}

/// Returns the error for a name with a dash, or one that begins with a digit.
fn name_error(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let names_a_file = |naming: &str| FILE_KEYWORDS.contains(&naming);
    if rest.starts_with(|c: char| c.is_ascii_digit()) && NAMING_KEYWORDS.contains(&stop.last_word())
    {
        let length = rest.find(|c| !in_name(c)).unwrap_or(rest.len());
        let start = match names_a_file(stop.last_word()) {
            true => NameStart::DigitOfTool,
            false => NameStart::Digit,
        };
        return error(stop.next(length), SpellingKind::InvalidNameStart { start });
    }
    let begun = stop.last_word();
    let naming = before[..before.len() - begun.len()].trim_end_matches(BLANK_CHARACTERS);
    let naming = &naming[naming.trim_end_matches(in_name).len()..];
    if rest.starts_with('-') && NAMING_KEYWORDS.contains(&naming) {
        // Tokens of an inline tool are separated by blanks.
        let tail = rest[1..].trim_start_matches(BLANK_CHARACTERS);
        let tail = &tail[..tail.find(|c| !in_name(c) && c != '-').unwrap_or(tail.len())];
        let whole_name = format!("{begun}-{tail}");
        let end = stop.at + rest.find(tail).unwrap_or(0) + tail.len();
        let span = stop.span(before.len() - begun.len(), end);
        let suggestion = if names_a_file(naming) {
            whole_name.replace('-', "")
        } else {
            whole_name.replace('-', "_")
        };
        return error(span, SpellingKind::DashInName { written: whole_name, suggestion });
    }
    None
}

/// Returns the error for an operator of another language, or for a comparison where none is allowed.
fn operator_error(stop: &StopPosition<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let with_previous = || stop.span(stop.at - 1, stop.at + 1);
    let glued = stop.is_glued();
    if rest.starts_with('*') && glued && before.ends_with('*') {
        return error(with_previous(), SpellingKind::DoubleStar);
    }
    if rest.starts_with(['<', '>']) {
        let sign = &rest[..1];
        if glued && before.ends_with('=') {
            return error(
                with_previous(),
                SpellingKind::ReversedComparison { sign: sign.to_owned() },
            );
        }
        if ends_a_value(before) {
            let item = word(stop.text.trim_start_matches(BLANK_CHARACTERS));
            let is_in_condition = item == "region" && !before.contains('{');
            let kind = if is_in_condition {
                SpellingKind::TooManyComparisons
            } else {
                SpellingKind::ComparisonOutside
            };
            return error(stop.next(1), kind);
        }
    }
    None
}

/// Returns the decimal number, without exponent, that a text ends with; empty if there is none, or if it is part of a
/// name.
fn number_before(before: &str) -> &str {
    let head = before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    let number = &before[head.len()..];
    let begins = number.starts_with(|c: char| c.is_ascii_digit());
    if begins && !head.ends_with(in_name) { number } else { "" }
}
