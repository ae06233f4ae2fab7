//! Spelling mistakes: foreign characters, and habits from other languages.

use super::{BLANK_CHARACTERS, FILE_KEYWORDS, Stop, ends_a_value, in_name, word};
use crate::diagnostic::{Diagnostic, NameStart, SpellingKind, SyntaxKind};

/// Characters that resemble the intended ones.
const REPLACEMENTS: [(char, &str); 15] = [
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
    ('[', "("),
    (']', ")"),
];

/// Words after which a name follows.
const NAMING_KEYWORDS: [&str; 7] = ["tool", "solid", "let", "param", "curve", "region", "as"];

/// Returns an error for a mistake that its first character identifies.
pub(super) fn character(stop: &Stop<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let next = rest.chars().next()?;
    let next_character = stop.next(0);
    let diagnostic = |kind: SpellingKind| Some(Diagnostic::new(next_character, kind));
    let digits = |s: &str| s.chars().take_while(char::is_ascii_digit).collect::<String>();
    let number = number_before(before);
    if let Some(digits) = number.strip_suffix('.') {
        let span = stop.span(before.len() - number.len(), before.len());
        let diagnostic =
            Diagnostic::new(span, SpellingKind::TrailingPoint { digits: digits.to_owned() });
        return Some(diagnostic);
    }
    let glued = before.len() == stop.at;
    // The span of `begun` with this character after it.
    let is_whole = |begun: &str| {
        let end = stop.at + next.len_utf8();
        stop.span(if glued { stop.at - begun.len() } else { stop.at }, end)
    };
    match next {
        '.' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            diagnostic(SpellingKind::LeadingPoint { fraction: digits(&rest[1..]) })
        }
        '°' if !number.is_empty() => {
            let diagnostic = Diagnostic::new(
                is_whole(number),
                SpellingKind::DegreeSign { number: number.to_owned() },
            );
            Some(diagnostic)
        }
        '²' | '³' => {
            let power = if next == '²' { 2 } else { 3 };
            let base = stop.last_word();
            let diagnostic = Diagnostic::new(
                is_whole(base),
                SpellingKind::Superscript { base: base.to_owned(), sign: next, power },
            );
            Some(diagnostic)
        }
        '⌀' | 'ø' | 'Ø' => diagnostic(SpellingKind::DiameterSign { sign: next }),
        '\'' => diagnostic(SpellingKind::SingleQuote),
        '^' => diagnostic(SpellingKind::ChainedPower),
        '"' if glued && !number.is_empty() => {
            diagnostic(SpellingKind::InchSign { number: number.to_owned() })
        }
        '"' if stop.text.matches('"').count() % 2 == 1 => unended(stop),
        '"' => diagnostic(SpellingKind::MisplacedText),
        '_' if glued && !number.is_empty() => diagnostic(SpellingKind::UnderscoreInNumber),
        '_' => diagnostic(SpellingKind::InvalidNameStart { start: NameStart::Underscore }),
        _ => match REPLACEMENTS.iter().find(|(wrong, _)| *wrong == next) {
            Some((_, suggestion)) => {
                diagnostic(SpellingKind::Lookalike { written: next, suggestion })
            }
            None => foreign(next).and_then(diagnostic),
        },
    }
}

/// Returns the error for a character that the language does not use. An invisible one is shown by its code point.
fn foreign(next: char) -> Option<SpellingKind> {
    let visible = !(next.is_control()
        || next.is_whitespace()
        || matches!(next, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(next, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffd}'));
    match next {
        '\u{feff}' => Some(SpellingKind::ByteOrderMark),
        _ if next.is_ascii() && !next.is_control() => None,
        _ if visible => Some(SpellingKind::ForeignCharacter { written: next }),
        _ => Some(SpellingKind::InvisibleCharacter { code: u32::from(next) }),
    }
}

/// Returns an error for a habit from elsewhere: a unit apart from its number, `and`, a name with a dash.
pub(super) fn habit(stop: &Stop<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let next = word(rest);
    let number = number_before(before);
    if ["mm", "inch", "m", "deg", "rad", "in"].contains(&next) && !number.is_empty() {
        let unit = if next == "in" { "inch" } else { next }.to_owned();
        return Some(Diagnostic::new(
            stop.next(next.len()),
            SpellingKind::SpaceBeforeUnit {
                written: next.to_owned(),
                number: number.to_owned(),
                unit,
            },
        ));
    }
    if ["and", "or"].contains(&next) || rest.starts_with("&&") || rest.starts_with("||") {
        let length = next.len().max(2);
        return Some(Diagnostic::new(stop.next(length), SpellingKind::LogicalOperator));
    }
    if let Some(diagnostic) = name(stop).or_else(|| operator(stop)) {
        return Some(diagnostic);
    }
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    if rest.starts_with(',') && digit(before.chars().last()) && digit(rest.chars().nth(1)) {
        let fraction: String = rest[1..].chars().take_while(char::is_ascii_digit).collect();
        return Some(Diagnostic::new(
            stop.next(1),
            SpellingKind::DecimalComma { number: number.to_owned(), fraction },
        ));
    }
    if rest.starts_with(';') && before.is_empty() {
        return Some(Diagnostic::new(stop.next(1), SpellingKind::ExtraSemicolon));
    }
    if FILE_KEYWORDS.contains(&next) {
        return Some(Diagnostic::new(
            stop.next(next.len()),
            SpellingKind::SecondTool { keyword: next.to_owned() },
        ));
    }
    None
}

/// Returns an error for a text or a comment that does not end, or for an empty file.
pub(super) fn unended(stop: &Stop<'_>) -> Option<Diagnostic> {
    let comment = |at: usize| Diagnostic::new(stop.span(at, at + 2), SyntaxKind::UnclosedComment);
    if stop.rest().starts_with("/*") {
        return Some(comment(stop.at));
    }
    let read = stop.text.trim_matches(BLANK_CHARACTERS);
    if stop.offset == 0 && stop.rest().is_empty() && word(read).is_empty() {
        return Some(no_tool(stop));
    }
    let mut start = 0;
    for line in stop.text.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        if let (1, Some(at)) = (code.matches('"').count() % 2, code.rfind('"')) {
            let span = stop.span(start + at, start + at + 1);
            return Some(Diagnostic::new(span, SpellingKind::UnclosedText));
        }
        start += line.len();
    }
    let before = stop.before();
    let is_in_comment = before.matches("/*").count() > before.matches("*/").count();
    is_in_comment.then(|| comment(before.rfind("/*").unwrap_or_default()))
}

/// Returns the error for a text that ends without a tool.
pub(super) fn no_tool(stop: &Stop<'_>) -> Diagnostic {
    Diagnostic::new(stop.next(0), SyntaxKind::NoTool)
}

/// Returns an error for a name with a dash, or one that begins with a digit.
fn name(stop: &Stop<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let of_tool = |naming: &str| FILE_KEYWORDS.contains(&naming);
    if rest.starts_with(|c: char| c.is_ascii_digit()) && NAMING_KEYWORDS.contains(&stop.last_word())
    {
        let length = rest.find(|c| !in_name(c)).unwrap_or(rest.len());
        let start = match of_tool(stop.last_word()) {
            true => NameStart::DigitOfTool,
            false => NameStart::Digit,
        };
        return Some(Diagnostic::new(stop.next(length), SpellingKind::InvalidNameStart { start }));
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
        let suggestion = if of_tool(naming) {
            whole_name.replace('-', "")
        } else {
            whole_name.replace('-', "_")
        };
        return Some(Diagnostic::new(
            span,
            SpellingKind::DashInName { written: whole_name, suggestion },
        ));
    }
    None
}

/// Returns an error for an operator of another language.
fn operator(stop: &Stop<'_>) -> Option<Diagnostic> {
    let (rest, before) = (stop.rest(), stop.before());
    let both = || stop.span(stop.at - 1, stop.at + 1);
    let glued = before.len() == stop.at;
    if rest.starts_with('*') && glued && before.ends_with('*') {
        return Some(Diagnostic::new(both(), SpellingKind::DoubleStar));
    }
    if rest.starts_with(['<', '>']) {
        let sign = &rest[..1];
        if glued && before.ends_with('=') {
            return Some(Diagnostic::new(
                both(),
                SpellingKind::ReversedComparison { sign: sign.to_owned() },
            ));
        }
        if ends_a_value(before) {
            return Some(if stop.text.trim_start().starts_with("region") {
                Diagnostic::new(stop.next(1), SpellingKind::TooManyComparisons)
            } else {
                Diagnostic::new(stop.next(1), SpellingKind::ComparisonOutside)
            });
        }
    }
    None
}

/// Returns the number at the end of a text.
fn number_before(before: &str) -> &str {
    let digits = before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    let number = &before[digits.len()..];
    let begins = number.starts_with(|c: char| c.is_ascii_digit());
    if begins && !digits.ends_with(in_name) { number } else { "" }
}
