//! How much of everything a text may hold. Nesting is counted before pest runs, which goes as deep.

use super::Rule;
use crate::report::Report;
use crate::source::{LONGEST, Span};
use pest::iterators::{Pair, Pairs};

/// The longest name.
const LONGEST_NAME: usize = 100;
/// The most items of a file.
const MOST: usize = 4096;
/// The deepest nesting of brackets.
const DEEPEST: usize = 64;
/// A name, or a list of items, that is longer than any that people write.
pub(super) fn too_much(pairs: Pairs<'_, Rule>) -> Option<Report> {
    let place = |pair: &Pair<'_, Rule>, length: usize| {
        let start = pair.as_span().start();
        Span { start, end: start + length }
    };
    let name = |pair: &Pair<'_, Rule>| pair.as_rule() == Rule::name;
    let long =
        pairs.clone().flatten().find(|pair| name(pair) && pair.as_str().len() > LONGEST_NAME);
    if let Some(pair) = long {
        let message = format!("this name is {} letters long", pair.as_str().len());
        return Some(
            Report::error(place(&pair, LONGEST_NAME), message)
                .help(format!("a name has at most {LONGEST_NAME}")),
        );
    }
    let whole = |pair: &Pair<'_, Rule>| matches!(pair.as_rule(), Rule::tool | Rule::solid);
    let beyond = pairs.flatten().find(whole)?.into_inner().nth(MOST)?;
    Some(
        Report::error(place(&beyond, 1), format!("more than {MOST} items"))
            .help("a file describes one tool"),
    )
}

/// The text's length, its comments and its brackets.
pub(super) fn within_limits(text: &str) -> Result<(), Report> {
    if text.len() > LONGEST {
        let end = Span { start: 0, end: 1 };
        return Err(Report::error(end, format!("the text is {} bytes long", text.len()))
            .help(format!("a tool's text has at most {LONGEST} bytes")));
    }
    let (mut comments, mut at) = (0usize, 0);
    while let Some(pair) = text.as_bytes().get(at..at + 2) {
        match pair {
            b"/*" => comments += 1,
            b"*/" => comments = comments.saturating_sub(1),
            _ => {
                at += 1;
                continue;
            }
        }
        if comments > DEEPEST {
            let span = Span { start: at, end: at + 2 };
            return Err(Report::error(
                span,
                format!("comments are nested more than {DEEPEST} deep"),
            )
            .help("close them with `*/`"));
        }
        at += 2;
    }
    let mut depth = 0usize;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'(' | b'{' | b'[' => depth += 1,
            b')' | b'}' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEEPEST {
            return Err(Report::error(
                Span { start: at, end: at + 1 },
                format!("brackets are nested more than {DEEPEST} deep"),
            )
            .help("name a part of the expression with `let` or `curve`"));
        }
    }
    Ok(())
}
