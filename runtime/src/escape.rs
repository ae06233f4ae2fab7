//! Escaping of text from files and file names for display.

use std::fmt::{self, Display, Formatter};

/// Text without the characters that a terminal interprets. Control characters (C0, C1, delete),
/// characters that change the direction of writing, separators of lines and characters without a width are shown
/// as `\u001b`, with four hexadecimal digits of their code as in JSON. Line breaks are escaped too, so the text stays on one line.
///
/// All text from a file, and every file name, is escaped before it is shown.
///
/// ```
/// assert_eq!(touchoff::Escaped("a\u{1b}[2J\nb").to_string(), r"a\u001b[2J\u000ab");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Escaped<'a>(pub &'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for piece in self.0.split_inclusive(is_terminal_control) {
            match piece.char_indices().next_back().filter(|(_, last)| is_terminal_control(*last)) {
                Some((at, last)) => write!(f, "{}\\u{:04x}", &piece[..at], u32::from(last))?,
                None => f.write_str(piece)?,
            }
        }
        Ok(())
    }
}

/// [`Escaped`] for whole lines: line breaks and tabs are kept.
///
/// ```
/// assert_eq!(touchoff::EscapedLines("a\u{7f}\n").to_string(), "a\\u007f\n");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct EscapedLines<'a>(pub &'a str);

impl Display for EscapedLines<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for piece in self.0.split_inclusive(['\n', '\t']) {
            let line = piece.trim_end_matches(['\n', '\t']);
            write!(f, "{}", Escaped(line))?;
            f.write_str(&piece[line.len()..])?;
        }
        Ok(())
    }
}

/// Returns whether a terminal interprets a character instead of showing it. These are control characters, the marks, embeddings,
/// overrides and isolates of Unicode's bidirectional algorithm (UAX 9, section 2), separators of lines, and characters that nobody
/// sees. The joiners of scripts (U+200C, U+200D) are text.
fn is_terminal_control(c: char) -> bool {
    let is_of_direction = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_unseen =
        matches!(c, '\u{ad}' | '\u{200b}' | '\u{2028}' | '\u{2029}' | '\u{2060}' | '\u{feff}');
    c.is_control() || is_of_direction || is_unseen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_every_terminal_control() {
        for code in (0..0x20)
            .chain(0x7f..0xa0)
            .chain([0x61c, 0x200b, 0x200e, 0x2028, 0x202e, 0x2066, 0xfeff])
        {
            let text = format!("a{}é", char::from_u32(code).expect("a character"));
            assert_eq!(Escaped(&text).to_string(), format!("a\\u{code:04x}é"));
        }
        for text in ["", "é ~", "\\", "工具"] {
            assert_eq!(Escaped(text).to_string(), text);
        }
        assert_eq!(EscapedLines("a\tb\r\n\u{9b}\n\n").to_string(), "a\tb\\u000d\n\\u009b\n\n");
    }
}
