//! Tokens of a text file and their locations.

use std::fmt;

/// A location in a file. Lines count from 1, bytes from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceLocation {
    /// A line of a text file.
    Line(usize),
    /// A byte offset in a binary file.
    Byte(usize),
}

impl fmt::Display for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SourceLocation::Line(line) => write!(f, "line {line}"),
            SourceLocation::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// The words of a text with their line numbers. Lines may end in LF, CR LF or CR.
#[derive(Clone)]
pub(super) struct Tokens<'a> {
    pub(super) rest: &'a [u8],
    pub(super) line: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Tokens<'a> {
        // Editors put a byte order mark before UTF-8.
        let rest = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        Tokens { rest, line: 1 }
    }

    /// Returns the next word and sets `line` to its line.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let end = self.rest.iter().position(|&byte| is_space(byte)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Returns the next word on the current line, if there is one.
    pub(super) fn next_on_line(&mut self) -> Option<&'a [u8]> {
        // A look ahead: the word is consumed only if it is on this line.
        let mut ahead = self.clone();
        let word = ahead.next()?;
        if ahead.line != self.line {
            return None;
        }
        *self = ahead;
        Some(word)
    }

    /// Skips white space, including ends of lines, up to the next word.
    pub(super) fn skip_space(&mut self) {
        while let [space, rest @ ..] = self.rest
            && is_space(*space)
        {
            // CR LF is one end of a line, and the LF counts.
            let ends_line = *space == b'\n' || (*space == b'\r' && rest.first() != Some(&b'\n'));
            self.line += usize::from(ends_line);
            self.rest = rest;
        }
    }

    pub(super) fn skip_line(&mut self) {
        let end = self.rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
        self.rest = &self.rest[end.unwrap_or(self.rest.len())..];
    }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0B
}

/// Parses a word as a number. The many spellings of NaN and infinity (`-nan(ind)`, `1.#INF`) count as
/// NaN: exporters write them where a normal cannot be computed.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        let text = text.to_ascii_lowercase();
        let is_non_finite = ["nan", "inf", "#ind"].iter().any(|spelling| text.contains(spelling));
        is_non_finite.then_some(f64::NAN)
    })
}

/// Returns a printable form of a word, escaped and at most 32 characters long: binary data can be long and unprintable.
pub(super) fn printable(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(256)]);
    let start: String = text.chars().take(32).collect();
    let ellipsis = if start.len() < text.len() { "…" } else { "" };
    format!("{}{ellipsis}", start.escape_debug())
}
