//! A tool's text as it is usually written.
//!
//! ```text
//! text ──token──▶ tokens and comments ──block──▶ statements ──line──▶ text
//! ```
//!
//! The syntax tree has no comments, so the layout goes by the tokens. Statements end in `;` or have
//! a block; that is all it knows of the items, and a new one needs nothing here. What it writes has
//! the same tokens and comments in the same order, and formatting it again changes nothing.
//!
//! An item has a line. Several blank lines become one. A line is broken where it outgrows 100
//! columns and after a line comment, nowhere else; a region of one property may stay on its line.
//! `*`, `/`, `^` and signs stand tight, all other operators between spaces.

mod block;
mod line;
#[cfg(test)]
mod tests;
mod token;

use crate::diagnostic::{Diagnostic, any_error};
use crate::source::Source;
use crate::syntax;

/// Columns of a line; comments at its end may reach further.
const WIDTH: usize = 100;
/// Columns of a step inwards.
const STEP: usize = 4;

/// Lays out a tool's text. One with errors of syntax gives these instead.
pub fn format(source: &Source) -> Result<String, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    if syntax::parse(source, &mut diagnostics).is_err() || any_error(&diagnostics) {
        return Err(diagnostics);
    }
    layout(&source.text).map_err(|diagnostic| vec![diagnostic])
}

/// Lays out a text that may be more than the grammar knows. Lines end as the file's do.
fn layout(text: &str) -> Result<String, Diagnostic> {
    if text.contains("\r\n") {
        return Ok(lines(&text.replace("\r\n", "\n"))?.replace('\n', "\r\n"));
    }
    lines(text)
}

fn lines(text: &str) -> Result<String, Diagnostic> {
    let tokens = token::tokens(text)?;
    Ok(block::write(&block::nodes(&tokens)))
}
