//! Tokens with the properties that the layout needs.

use crate::diagnostic::Diagnostic;
use crate::syntax::{self, Rule};

/// The role of a token, which decides the spaces around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A keyword, where the name is one.
    Word,
    /// A name, a number or a text.
    Value,
    /// A plus or minus before a single operand.
    Sign,
    /// An operator or other punctuation.
    Mark,
    /// A comment after which the line may continue.
    Inline,
    /// A comment that ends its line: `// …`, or one of several lines.
    Ending,
}

/// A token or a comment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'t> {
    pub(super) text: &'t str,
    pub(super) kind: Kind,
    /// The number of line ends between it and the token before.
    pub(super) newlines: usize,
}

impl Token<'_> {
    pub(super) fn is(&self, text: &str) -> bool {
        self.text == text
    }

    pub(super) fn is_comment(&self) -> bool {
        matches!(self.kind, Kind::Inline | Kind::Ending)
    }
}

/// Keywords that are not directly followed by a name, a point or a value; all others are.
const KEYWORDS_WITHOUT_OPERAND: [&str; 7] =
    ["arc", "away", "concave", "cutting", "line", "nearest", "regions"];

/// The last token, which determines the kind of the next. An operand never follows an operand, so a name that
/// does is a keyword.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Last {
    Nothing,
    Operand,
    Operator,
    DirectionColon,
}

/// Returns the tokens of a text.
pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, Diagnostic> {
    let (mut last, mut first, mut end) = (Last::Nothing, "", 0);
    let mut tokens = Vec::new();
    for pair in syntax::tokens(text)? {
        let (written, span) = (pair.as_str(), pair.as_span());
        let (kind, next) = match pair.as_rule() {
            Rule::EOI => break,
            Rule::line_comment => (Kind::Ending, last),
            Rule::block_comment if written.contains('\n') => (Kind::Ending, last),
            Rule::block_comment => (Kind::Inline, last),
            Rule::name => name(written, last),
            Rule::number | Rule::text => (Kind::Value, Last::Operand),
            _ => match written {
                "+" | "-" if last != Last::Operand => (Kind::Sign, Last::Operator),
                ")" => (Kind::Mark, Last::Operand),
                ";" | "{" | "}" => (Kind::Mark, Last::Nothing),
                ":" if first == "direction" => (Kind::Mark, Last::DirectionColon),
                _ => (Kind::Mark, Last::Operator),
            },
        };
        if last == Last::Nothing && kind == Kind::Word {
            first = written;
        }
        let newlines = text[end..span.start()].matches('\n').count();
        tokens.push(Token { text: written.trim_end(), kind, newlines });
        (last, end) = (next, span.end());
    }
    Ok(tokens)
}

fn name(written: &str, last: Last) -> (Kind, Last) {
    let is_word = match last {
        Last::Nothing | Last::Operand => true,
        Last::Operator => false,
        Last::DirectionColon => ["away", "toward"].contains(&written),
    };
    match is_word {
        true if KEYWORDS_WITHOUT_OPERAND.contains(&written) => (Kind::Word, Last::Operand),
        true => (Kind::Word, Last::Operator),
        false => (Kind::Value, Last::Operand),
    }
}
