//! Parses text to the syntax tree.
//!
//! The grammar accepts slightly more than the language. The excess is rejected with a specific error and a remedy
//! (`refuse`). Items are parsed independently, so that one mistake does not hide the next.

mod lexeme;
mod parse;
mod refuse;
pub mod tree;

use grammar::Grammar;
pub(crate) use grammar::Rule;
pub(crate) use lexeme::MAX_EXPRESSION_HEIGHT;
pub(crate) use lexeme::begins_a_tool;
pub use parse::parse_argument;
pub(crate) use parse::tokens;
pub use parse::{is_type_name, parse};

/// The parser that pest generates. It has a module of its own because its items have no documentation.
mod grammar {
    #![allow(missing_docs)]
    #[derive(pest_derive::Parser)]
    #[grammar = "syntax/grammar.pest"]
    pub(crate) struct Grammar;
}
