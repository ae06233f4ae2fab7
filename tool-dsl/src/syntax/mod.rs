//! Text to syntax tree.
//!
//! The grammar accepts a little more than the language; what it accepts too much is refused by
//! name, with a remedy (`refuse`). Items are parsed each for itself, so that one mistake does
//! not hide the next.

mod expression;
mod lexeme;
mod limits;
mod mount;
mod parse;
mod refuse;
pub mod tree;

pub(crate) use lexeme::begins_a_tool;
pub(crate) use limits::TALLEST;
pub use mount::given;
pub(crate) use parse::tokens;
pub use parse::{is_type_name, parse};

/// pest's generated parser, in a module of its own because it documents nothing.
mod grammar {
    #![allow(missing_docs)]
    #[derive(pest_derive::Parser)]
    #[grammar = "syntax/grammar.pest"]
    pub(crate) struct Grammar;
}
use grammar::Grammar;
pub(crate) use grammar::Rule;
