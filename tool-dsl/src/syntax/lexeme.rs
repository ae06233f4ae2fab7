//! The text in the pieces that the grammar's tokens have: what is a comment or a text, and what is not.

use super::limits::DEEPEST;
use super::refuse::{FILES, in_name};

/// One piece of a text, from its start to its end in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lexeme {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) kind: Kind,
}

/// The kinds of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A blank or a comment, which the grammar skips.
    Skipped,
    /// A block comment that does not end, as far as the end of the text.
    Unended,
    /// A block comment with more comments in each other than the limit, as far as the first of those.
    TooDeep,
    /// A text between quotes.
    Text,
    /// A name, a number, or both glued together.
    Word,
    /// Any other character.
    Mark(char),
}

/// Returns whether the first word of a text is that of a tool's or a solid's file, with a name behind it.
pub(crate) fn begins_a_tool(text: &str) -> bool {
    let mut words = lexemes(text).filter(|lexeme| lexeme.kind != Kind::Skipped);
    let first = words.next().map_or("", |first| &text[first.start..first.end]);
    FILES.contains(&first) && words.next().is_some_and(|name| name.kind == Kind::Word)
}

/// The pieces of a text in order, without gaps. A quote that no other one ends on its line is a mark, as it is
/// for the grammar.
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

/// A block comment, which may hold others.
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
            _ if depth > DEEPEST => return (at, Kind::TooDeep),
            _ => {}
        }
    }
    (bytes.len(), Kind::Unended)
}

/// The length of the text that begins here, if it ends on its line and no name is glued to it.
fn text_length(rest: &str) -> Option<usize> {
    let end = 1 + rest[1..].find(['"', '\\', '\n', '\r'])?;
    let closed = rest.as_bytes()[end] == b'"' && !rest[end + 1..].starts_with(in_name);
    closed.then_some(end + 1)
}
