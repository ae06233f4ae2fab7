//! Brackets that nothing closes, or that close nothing.

use super::{ITEMS, Stop, first_token, in_name};
use crate::report::Report;

/// Words that begin an item and nothing else.
fn begins_an_item(word: &str) -> bool {
    ITEMS.contains(&word) && !["magnitude", "niceness"].contains(&word)
}

/// A bracket without its other one, if the text stopped to fit because of it.
pub(super) fn unmatched(stop: &Stop<'_>) -> Option<Report> {
    let Brackets { open, extra } = Brackets::of(stop.text);
    if let Some((at, bracket)) = extra.filter(|(at, _)| *at == stop.at) {
        let report =
            Report::error(stop.span(at, at + 1), format!("this `{bracket}` closes nothing"));
        return Some(report.help("drop it, or open one before"));
    }
    let (at, bracket) = open.filter(|(at, _)| *at < stop.at)?;
    let place = stop.span(at, at + 1);
    let report = Report::error(place, format!("this `{bracket}` is not closed"));
    let close = if bracket == '{' { '}' } else { ')' };
    Some(match first_token(stop.rest()) {
        "" => report.help(format!("write `{close}` where its contents end")),
        next => report
            .and(stop.next(next.len()), "before this")
            .help(format!("write `{close}` where its contents end")),
    })
}

/// How far in a place's line begins, and whether it begins with that place.
fn indent(text: &str, at: usize) -> Option<(usize, bool)> {
    let start = text[..at].rfind('\n')? + 1;
    let width = text[start..].find(|c: char| !c.is_ascii_whitespace())?;
    Some((width, start + width == at))
}

/// The first brackets of a text that do not match.
#[derive(Default)]
struct Brackets {
    open: Option<(usize, char)>,
    extra: Option<(usize, char)>,
}

impl Brackets {
    fn of(text: &str) -> Brackets {
        let mut found = Brackets::default();
        let mut open: Vec<(usize, char)> = Vec::new();
        let (mut at, mut begins) = (0, true);
        // An item inside another's braces: those were not closed.
        let mut swallows = None;
        while let Some(c) = text[at..].chars().next() {
            let rest = &text[at..];
            let length = match c {
                '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
                '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
                '"' => rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2),
                _ if in_name(c) => rest.find(|c| !in_name(c)).unwrap_or(rest.len()),
                _ => c.len_utf8(),
            };
            match c {
                '(' | '{' => open.push((at, c)),
                ')' | '}' => {
                    let fits = |(_, other): &(usize, char)| (*other == '(') == (c == ')');
                    match open.last().copied().filter(fits) {
                        Some((begun, _)) => {
                            // A brace farther left than its block belongs to what is about that.
                            let left = indent(text, at).zip(indent(text, begun));
                            if c == '}' && left.is_some_and(|(own, other)| own.1 && own.0 < other.0)
                            {
                                swallows = swallows.or(Some((begun, '{')));
                            }
                            open.pop();
                        }
                        None if open.is_empty() || c == ')' => {
                            found.extra = found.extra.or(Some((at, c)));
                        }
                        // A `}` ends what was open in its braces.
                        None => {
                            found.open = found.open.or(open.last().copied());
                            while open.pop().is_some_and(|(_, bracket)| bracket != '{') {}
                        }
                    }
                }
                _ if begins && begins_an_item(&rest[..length]) && swallows.is_none() => {
                    let innermost = open.iter().rev().find(|(_, bracket)| *bracket == '{');
                    let whole = super::FILES.contains(&super::word(text.trim_start()));
                    let of_file = |first: usize| whole && Some(first) == text.find('{');
                    swallows = innermost.copied().filter(|(first, _)| !of_file(*first));
                }
                _ => {}
            }
            let blank = c.is_ascii_whitespace() || rest.starts_with("//") || rest.starts_with("/*");
            if !blank {
                begins = matches!(c, ';' | '{' | '}');
            }
            at += length;
        }
        if !open.is_empty() {
            found.open = found.open.or(swallows).or(open.last().copied());
        }
        found
    }
}
