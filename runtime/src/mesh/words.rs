//! The words of a text file, and where they stand.

use std::fmt;

/// Where in a file something stands: lines count from 1, bytes from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text.
    Line(usize),
    /// A byte of a binary file.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// The words of a text and the lines they stand on, whether those end in LF, CR LF or CR.
#[derive(Clone)]
pub(super) struct Words<'a> {
    pub(super) rest: &'a [u8],
    pub(super) line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Words<'a> {
        let rest = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        Words { rest, line: 1 }
    }

    /// The next word; `line` is then its line.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let end = self.rest.iter().position(|&byte| is_space(byte)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// The next word, unless it is on a later line.
    pub(super) fn next_on_line(&mut self) -> Option<&'a [u8]> {
        let mut ahead = self.clone();
        let word = ahead.next()?;
        if ahead.line != self.line {
            return None;
        }
        *self = ahead;
        Some(word)
    }

    /// Up to the next word, over the ends of lines.
    pub(super) fn skip_space(&mut self) {
        while let [space, rest @ ..] = self.rest
            && is_space(*space)
        {
            let ends_line = *space == b'\n' || (*space == b'\r' && rest.first() != Some(&b'\n'));
            self.line += usize::from(ends_line);
            self.rest = rest;
        }
    }

    pub(super) fn skip_line(&mut self) {
        let ends = |&byte: &u8| byte == b'\n' || byte == b'\r';
        let end = self.rest.iter().position(ends).unwrap_or(self.rest.len());
        self.rest = &self.rest[end..];
    }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0B
}

/// A word as a number. The many spellings of NaN and infinity (`-nan(ind)`, `1.#INF`) count as
/// NaN: exporters write them where a normal cannot be computed.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = str::from_utf8(word).ok()?;
    let is_odd = || {
        let text = text.to_ascii_lowercase();
        ["nan", "inf", "#ind"].iter().any(|odd| text.contains(odd))
    };
    text.parse().ok().or_else(|| is_odd().then_some(f64::NAN))
}

/// A word fit to be printed: binary data can be long and unprintable.
pub(super) fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(256)]);
    let start: String = text.chars().take(32).collect();
    let ellipsis = if start.len() < text.len() { "…" } else { "" };
    format!("{}{ellipsis}", start.escape_debug())
}
