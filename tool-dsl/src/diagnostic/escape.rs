//! Escaping of text from files, for safe display on a terminal.

use std::borrow::Cow;

/// Returns whether a character is a control character, or a mark that changes the text direction. A name or a
/// text must not bring either onto a terminal.
pub(crate) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{feff}')
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Returns a name or other text with an escape such as `\u{1b}` in place of every control character and every
/// mark that changes the text direction.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let escape = |c: char| match is_hidden(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    Cow::Owned(text.chars().map(escape).collect())
}

/// Returns the lines of a text for display, with every byte at its offset. The renderer itself replaces
/// one-byte control characters.
pub(super) fn harmless(text: &str) -> Cow<'_, str> {
    let replaced = |c: &char| is_hidden(*c) && c.len_utf8() > 1;
    if !text.chars().any(|c| replaced(&c)) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| match c.len_utf8() {
        _ if !replaced(&c) => c,
        2 => '\u{bf}',
        _ => '\u{fffd}',
    };
    Cow::Owned(text.chars().map(shown).collect())
}

/// Returns the lines of a message, each escaped.
pub(super) fn escaped_lines(text: &str) -> String {
    text.split('\n').map(escaped).collect::<Vec<_>>().join("\n")
}
