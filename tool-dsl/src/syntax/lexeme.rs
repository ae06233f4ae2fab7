//! Splits text into lexemes at the boundaries of the grammar's tokens, to tell comments and texts from the rest.

use super::limits::MAX_NESTING;
use super::refuse::{FILE_KEYWORDS, in_name};

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
