//! Splits text into lexemes at the boundaries of the grammar's tokens, and checks its size before pest runs.
//!
//! Pest recurses as deep as the text is nested. Lexemes tell comments and texts from the rest, so brackets in them
//! do not count.

use super::Rule;
use crate::diagnostic::{Diagnostic, SyntaxKind};
use crate::source::{MAX_SOURCE_BYTES, Span};
use pest::iterators::{Pair, Pairs};

/// The keywords that begin a file.
pub(super) const FILE_KEYWORDS: [&str; 2] = ["tool", "solid"];

/// A lexeme, as a range of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lexeme {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) kind: Kind,
}

/// The kinds of lexemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A blank or a comment, which the grammar skips.
    Skipped,
    /// A block comment that does not end, up to the end of the text.
    Unended,
    /// A block comment nested deeper than the limit, up to the start of the first comment beyond it.
    TooDeep,
    /// A quoted text.
    Text,
    /// A name, a number, or both glued together.
    Word,
    /// Any other character.
    Mark(char),
}

/// Returns whether a text begins with the keyword of a tool or a solid, followed by a name.
pub(crate) fn begins_a_tool(text: &str) -> bool {
    let mut words = lexemes(text).filter(|lexeme| lexeme.kind != Kind::Skipped);
    let first = words.next().map_or("", |first| &text[first.start..first.end]);
    FILE_KEYWORDS.contains(&first) && words.next().is_some_and(|name| name.kind == Kind::Word)
}

/// Returns the lexemes of a text in order, without gaps. A quote without a closing quote on its line is a mark, as it
/// is for the grammar.
pub(super) fn lexemes(text: &str) -> impl Iterator<Item = Lexeme> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = &text[at..];
        let next = rest.chars().next()?;
        let (length, kind) = match next {
            ' ' | '\t' | '\r' | '\n' => (1, Kind::Skipped),
            '/' if rest.starts_with("//") => (rest.find('\n').unwrap_or(rest.len()), Kind::Skipped),
            '/' if rest.starts_with("/*") => block_comment(rest.as_bytes()),
            '"' => text_length(rest).map_or((1, Kind::Mark('"')), |length| (length, Kind::Text)),
            _ if in_name(next) => (rest.find(|c| !in_name(c)).unwrap_or(rest.len()), Kind::Word),
            _ => (next.len_utf8(), Kind::Mark(next)),
        };
        let start = at;
        at += length;
        Some(Lexeme { start, end: at, kind })
    })
}

/// Returns whether a character may be part of a name.
pub(super) fn in_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Returns the length and kind of a block comment, which may contain others.
fn block_comment(bytes: &[u8]) -> (usize, Kind) {
    let (mut depth, mut at) = (0, 0);
    while let Some(pair) = bytes.get(at..at + 2) {
        match pair {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        match depth {
            0 => return (at, Kind::Skipped),
            _ if depth > MAX_NESTING => return (at, Kind::TooDeep),
            _ => {}
        }
    }
    (bytes.len(), Kind::Unended)
}

/// Returns the length of the quoted text at the beginning of `rest`, if it ends on its line and no name follows
/// directly.
fn text_length(rest: &str) -> Option<usize> {
    let end = 1 + rest[1..].find(['"', '\\', '\n', '\r'])?;
    let closed = rest.as_bytes()[end] == b'"' && !rest[end + 1..].starts_with(in_name);
    closed.then_some(end + 1)
}

/// The maximum length of a name, in bytes.
const MAX_NAME_BYTES: usize = 100;
/// The maximum number of items in a file.
const MAX_ITEMS: usize = 4096;
/// The maximum depth of nested brackets, and of nested comments.
const MAX_NESTING: usize = 64;
/// The maximum height of an expression, in operations, both as written and between a value and a coordinate. Functions
/// that walk an expression recurse as deep.
pub(crate) const MAX_EXPRESSION_HEIGHT: u32 = 300;

/// Returns an error for a name or a list of items above the limits, which no person would write.
pub(super) fn too_much(pairs: Pairs<'_, Rule>) -> Option<Diagnostic> {
    let span = |pair: &Pair<'_, Rule>, length: usize| {
        let start = pair.as_span().start();
        Span { start, end: start + length }
    };
    let long = pairs
        .clone()
        .flatten()
        .find(|pair| pair.as_rule() == Rule::name && pair.as_str().len() > MAX_NAME_BYTES);
    if let Some(pair) = long {
        return Some(Diagnostic::new(
            span(&pair, MAX_NAME_BYTES),
            SyntaxKind::NameTooLong { letters: pair.as_str().len(), limit: MAX_NAME_BYTES },
        ));
    }
    let beyond = pairs
        .flatten()
        .find(|pair| matches!(pair.as_rule(), Rule::tool | Rule::solid))?
        .into_inner()
        .nth(MAX_ITEMS)?;
    Some(Diagnostic::new(span(&beyond, 1), SyntaxKind::TooManyItems { limit: MAX_ITEMS }))
}

/// Checks the text's length, its comments and its brackets. A comment that does not end is rejected here: pest would
/// try the comments inside it in all combinations.
pub(super) fn within_limits(text: &str) -> Result<(), Diagnostic> {
    if text.len() > MAX_SOURCE_BYTES {
        let end = Span { start: 0, end: 1 };
        return Err(Diagnostic::new(
            end,
            SyntaxKind::TextTooLong { bytes: text.len(), limit: MAX_SOURCE_BYTES },
        ));
    }
    let mut depth = 0usize;
    for Lexeme { start, end, kind } in lexemes(text) {
        match kind {
            Kind::Mark('(' | '{' | '[') => depth += 1,
            Kind::Mark(')' | '}' | ']') => depth = depth.saturating_sub(1),
            Kind::Unended => {
                let opens = Span { start, end: start + 2 };
                return Err(Diagnostic::new(opens, SyntaxKind::UnclosedComment));
            }
            Kind::TooDeep => {
                let span = Span { start: end - 2, end };
                return Err(Diagnostic::new(
                    span,
                    SyntaxKind::CommentsTooDeep { limit: MAX_NESTING },
                ));
            }
            _ => {}
        }
        if depth > MAX_NESTING {
            return Err(Diagnostic::new(
                Span { start, end },
                SyntaxKind::BracketsTooDeep { limit: MAX_NESTING },
            ));
        }
    }
    Ok(())
}
