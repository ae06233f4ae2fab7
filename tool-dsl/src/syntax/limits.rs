//! Size limits of a text. Nesting is checked before pest runs, because pest recurses as deep as the text is nested. The
//! check uses the lexemes of pest's own tokens, so brackets in comments and texts do not count.

use super::Rule;
use super::lexeme::{Kind, Lexeme, lexemes};
use crate::diagnostic::{Diagnostic, SyntaxKind};
use crate::source::{MAX_SOURCE_BYTES, Span};
use pest::iterators::{Pair, Pairs};

/// The maximum length of a name, in bytes.
const MAX_NAME_BYTES: usize = 100;
/// The maximum number of items in a file.
const MAX_ITEMS: usize = 4096;
/// The maximum depth of nested brackets, and of nested comments.
pub(super) const MAX_NESTING: usize = 64;
/// The maximum height of an expression, in operations, both as written and between a value and a coordinate. Functions
/// that walk an expression recurse as deep.
pub(crate) const MAX_EXPRESSION_HEIGHT: u32 = 300;

/// Returns an error for a name or a list of items above the limits, which no person would write.
pub(super) fn too_much(pairs: Pairs<'_, Rule>) -> Option<Diagnostic> {
    let span = |pair: &Pair<'_, Rule>, length: usize| {
        let start = pair.as_span().start();
        Span { start, end: start + length }
    };
    let name = |pair: &Pair<'_, Rule>| pair.as_rule() == Rule::name;
    let long =
        pairs.clone().flatten().find(|pair| name(pair) && pair.as_str().len() > MAX_NAME_BYTES);
    if let Some(pair) = long {
        return Some(Diagnostic::new(
            span(&pair, MAX_NAME_BYTES),
            SyntaxKind::NameTooLong { letters: pair.as_str().len(), limit: MAX_NAME_BYTES },
        ));
    }
    let is_root = |pair: &Pair<'_, Rule>| matches!(pair.as_rule(), Rule::tool | Rule::solid);
    let beyond = pairs.flatten().find(is_root)?.into_inner().nth(MAX_ITEMS)?;
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
