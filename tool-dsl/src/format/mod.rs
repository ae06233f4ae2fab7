//! The formatter of a tool's text.
//!
//! ```text
//! text ──token──▶ tokens and comments ──block──▶ statements ──line──▶ text
//! ```
//!
//! The syntax tree has no comments, so the layout uses tokens. A statement ends in `;` or has a block. The
//! formatter knows nothing else about items, so a new item needs no change here. The output has the same
//! tokens and comments in the same order, and formatting it again changes nothing.
//!
//! Each item has its own line. Several blank lines become one. A line is broken only where it exceeds 100
//! columns and after a line comment; a region with one property may stay on its line. There is no space
//! around `*`, `/`, `^` and after a sign; all other operators have spaces on both sides.

mod block;
mod line;
#[cfg(test)]
mod tests;
mod token;

use crate::diagnostic::{Diagnostic, any_error};
use crate::source::Source;
use crate::syntax;

/// The number of columns in a line. Comments at its end may extend further.
const LINE_WIDTH: usize = 100;
/// The number of columns per level of indentation.
const INDENT_WIDTH: usize = 4;

/// Formats a tool's text.
///
/// # Errors
/// The diagnostics of a text with syntax errors.
pub fn format(source: &Source) -> Result<String, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    if syntax::parse(source, &mut diagnostics).is_err() || any_error(&diagnostics) {
        return Err(diagnostics);
    }
    layout(&source.text).map_err(|diagnostic| vec![diagnostic])
}

/// Formats a text that the grammar may not accept. Line ends stay as in the text.
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
