//! One statement: its spaces, and its line breaks if it is too long.

use super::token::{Kind, Token};
use super::{INDENT_WIDTH, LINE_WIDTH};
use std::iter::repeat_n;

/// Keywords before which a line may be broken.
const BREAKABLE_KEYWORDS: [&str; 7] = ["allow", "as", "at", "center", "radius", "where", "with"];
/// The number of ranks of breaks within one bracket. Those of an inner bracket are all higher.
const RANKS_PER_BRACKET: usize = 5;

/// A token with its layout in a statement.
struct Piece<'t> {
    text: &'t str,
    kind: Kind,
    /// True if a space precedes it, unless it begins a line.
    space: bool,
    /// The rank of a line break here, if it is allowed. A lower rank is preferred.
    rank: Option<usize>,
    /// True if a line must begin here.
    begins: bool,
}

impl Piece<'_> {
    fn is_where(&self) -> bool {
        self.kind == Kind::Word && self.text == "where"
    }

    fn is_brace(&self) -> bool {
        self.kind == Kind::Mark && ["{", "}"].contains(&self.text)
    }

    /// Returns the number of columns it takes, which is 0 for a comment that ends the line.
    fn width(&self) -> usize {
        if self.kind == Kind::Ending {
            0
        } else {
            self.text.chars().count() + usize::from(self.space)
        }
    }
}

/// Writes tokens on one line.
pub(super) fn joined(tokens: &[Token<'_>]) -> String {
    let mut text = String::new();
    run(&pieces(tokens), &mut text);
    text
}

/// Writes a statement, without a line end after it.
pub(super) fn write(tokens: &[Token<'_>], indent: usize, page: &mut String) {
    let mut pieces = pieces(tokens);
    let width: usize = pieces.iter().map(Piece::width).sum();
    if indent + width > LINE_WIDTH || pieces.iter().any(|piece| piece.begins) {
        part(&mut pieces);
    }
    let (mut own, mut hang) = (indent, indent + INDENT_WIDTH);
    let mut rest = pieces.as_slice();
    while let Some(first) = rest.first() {
        let behind = rest.iter().skip(1).position(|piece| piece.begins);
        let (segment, others) = rest.split_at(behind.map_or(rest.len(), |at| at + 1));
        if first.is_where() {
            hang = indent + 2 * INDENT_WIDTH;
        }
        fill(segment, if first.is_brace() { indent } else { own }, hang, page);
        if !others.is_empty() {
            page.push('\n');
        }
        (own, rest) = (hang, others);
    }
}

/// Makes the parts of a long statement begin lines: the conditions, the list in braces, and the brace.
fn part(pieces: &mut [Piece<'_>]) {
    let Some(last) = pieces.len().checked_sub(1) else { return };
    if pieces.iter().all(|piece| piece.rank.is_none() && !piece.begins) {
        return;
    }
    for at in 1..=last {
        let in_list = pieces[at - 1].is_brace();
        let piece = &mut pieces[at];
        piece.begins |= piece.is_where() || in_list || (at == last && piece.is_brace());
    }
}

/// Writes pieces on as many lines as necessary, with `own` as the indent of the first and `hang` as that of
/// the others.
fn fill(mut rest: &[Piece<'_>], own: usize, hang: usize, page: &mut String) {
    let mut indent = own;
    while !rest.is_empty() {
        let mut column = indent - usize::from(rest[0].space).min(indent);
        let mut best: Option<(usize, usize)> = None;
        let mut fits = true;
        for (at, piece) in rest.iter().enumerate() {
            if let Some(rank) = piece.rank.filter(|_| at > 0) {
                // The last break of the lowest rank that fits, or else the first of all.
                if best.is_none_or(|(lowest, _)| fits && rank <= lowest) {
                    best = Some((rank, at));
                }
            }
            column += piece.width();
            fits &= column <= LINE_WIDTH;
            if !fits && best.is_some() {
                break;
            }
        }
        let end = best.filter(|_| !fits).map_or(rest.len(), |(_, at)| at);
        page.extend(repeat_n(' ', indent));
        run(&rest[..end], page);
        rest = &rest[end..];
        if !rest.is_empty() {
            page.push('\n');
        }
        indent = hang;
    }
}

fn run(pieces: &[Piece<'_>], page: &mut String) {
    for (at, piece) in pieces.iter().enumerate() {
        if at > 0 && piece.space {
            page.push(' ');
        }
        page.push_str(piece.text);
    }
}

fn pieces<'t>(tokens: &[Token<'t>]) -> Vec<Piece<'t>> {
    let mut depth = 0usize;
    let mut pieces = Vec::with_capacity(tokens.len());
    for (at, token) in tokens.iter().enumerate() {
        if token.is(")") {
            depth = depth.saturating_sub(1);
        }
        let before = at.checked_sub(1).map(|before| &tokens[before]);
        let begins = before.is_some_and(|before| {
            before.kind == Kind::Ending || (token.kind == Kind::Ending && token.newlines > 0)
        });
        pieces.push(Piece {
            text: token.text,
            kind: token.kind,
            space: before.is_some_and(|before| space(before, token)),
            rank: before
                .and_then(|before| rank(before, token))
                .map(|rank| depth * RANKS_PER_BRACKET + rank),
            begins,
        });
        if token.is("(") {
            depth += 1;
        }
    }
    pieces
}

fn space(before: &Token<'_>, token: &Token<'_>) -> bool {
    let one_of =
        |token: &Token<'_>, marks: &[&str]| token.kind == Kind::Mark && marks.contains(&token.text);
    if one_of(before, &["(", "."]) || one_of(token, &[",", ";", ":", ")", "."]) {
        return false;
    }
    if before.is_comment() || token.is_comment() {
        return true;
    }
    let tight = ["*", "/", "^"];
    if before.kind == Kind::Sign || one_of(before, &tight) || one_of(token, &tight) {
        return false;
    }
    let calls = before.kind == Kind::Value && token.is("(");
    !calls
}

/// Returns the rank of a line break before `token`, if it is allowed.
fn rank(before: &Token<'_>, token: &Token<'_>) -> Option<usize> {
    if token.kind == Kind::Ending {
        return None;
    }
    match (token.kind, token.text) {
        (Kind::Word, word) if BREAKABLE_KEYWORDS.contains(&word) => return Some(0),
        (Kind::Mark, "<=" | ">=" | "<" | ">" | "==" | "!=") => return Some(1),
        (Kind::Mark, "+" | "-") => return Some(2),
        (Kind::Mark, "*" | "/") => return Some(4),
        _ => {}
    }
    match (before.kind, before.text) {
        (Kind::Mark, ",") => Some(0),
        (Kind::Mark, "=" | ":") => Some(3),
        _ => None,
    }
}
