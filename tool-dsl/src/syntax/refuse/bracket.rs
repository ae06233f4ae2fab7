//! Unmatched brackets.

use super::super::lexeme::{Kind, Lexeme, lexemes};
use super::{ITEM_KEYWORDS, StopPosition, first_token};
use crate::diagnostic::{Diagnostic, SyntaxKind};

/// Returns whether a word begins an item and nothing else.
fn begins_an_item(word: &str) -> bool {
    ITEM_KEYWORDS.contains(&word) && !["magnitude", "niceness"].contains(&word)
}

/// Returns an error for an unmatched bracket, if parsing stopped because of it.
pub(super) fn unmatched(stop: &StopPosition<'_>) -> Option<Diagnostic> {
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
        let line = |line: &str| {
            let from = start;
            start += line.len();
            (from, line.find(|c: char| !c.is_ascii_whitespace()))
        };
        Lines(text.split_inclusive('\n').map(line).collect())
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
        let is_whole_file = super::FILE_KEYWORDS.contains(&super::word(text.trim_start()));
        let file = text.find('{').filter(|_| is_whole_file);
        for Lexeme { start: at, end, kind } in lexemes(text) {
            match kind {
                Kind::Mark(c @ ('(' | '{')) => open_brackets.push((at, c)),
                Kind::Mark(c @ (')' | '}')) => {
                    let fits = |(_, other): &(usize, char)| (*other == '(') == (c == ')');
                    match open_brackets.last().copied().filter(fits) {
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
