//! The text of a line: a place in it, and the parts that stand before its first word.

pub(super) use crate::gcode::cursor::Cursor;

impl<'a> Cursor<'a> {
    /// Returns whether no word follows: at the end of the line, and at a comment.
    pub(super) fn is_at_end(&mut self) -> bool {
        matches!(self.peek(), None | Some(b';'))
    }

    /// Passes over a `=` that is not the first half of `==`.
    pub(super) fn take_assignment(&mut self) -> bool {
        let is_one = self.peek() == Some(b'=') && !self.rest().starts_with("==");
        if is_one {
            self.advance();
        }
        is_one
    }

    /// Passes over a name: letters, digits and underscores. It is empty if there is none.
    pub(super) fn name(&mut self) -> &'a str {
        self.peek();
        match self.byte() {
            Some(byte) if byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'$') => {
                self.take_while(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'$'))
            }
            _ => "",
        }
    }

    /// Passes over a name if it is the given one, in either case.
    pub(super) fn take_name(&mut self, name: &str) -> bool {
        let mut ahead = *self;
        let found = ahead.name().eq_ignore_ascii_case(name);
        if found {
            *self = ahead;
        }
        found
    }

    /// Passes over text between quotes, which begins here, and returns it.
    pub(super) fn quoted(&mut self) -> Option<&'a str> {
        let text = self.rest().strip_prefix('"')?;
        let (inside, _) = text.split_once('"')?;
        self.advance_by(inside.len() + 2);
        Some(inside)
    }

    /// Passes over text in brackets, which begins here with `open`, and returns what is between them. Quoted text may have
    /// brackets of its own.
    pub(super) fn bracketed(&mut self, [open, close]: [u8; 2]) -> Option<&'a str> {
        let rest = self.rest();
        let (mut depth, mut is_quoted) = (0usize, false);
        for (index, byte) in rest.bytes().enumerate() {
            match byte {
                b'"' => is_quoted = !is_quoted,
                _ if is_quoted => {}
                b';' => return None,
                _ if byte == open => depth += 1,
                _ if byte == close => {
                    depth = depth.checked_sub(1)?;
                    if depth == 0 {
                        self.advance_by(index + 1);
                        return Some(&rest[1..index]);
                    }
                }
                _ if depth == 0 => return None,
                _ => {}
            }
        }
        None
    }
}

/// The parts of a line before its first word.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<'a> {
    /// The digits after `/`, if the line begins with it.
    pub(super) switch: Option<&'a str>,
    /// The block number with its N, if there is one.
    pub(super) number: Option<&'a str>,
    /// The label, if there is one.
    pub(super) label: Option<&'a str>,
    /// The place of the first word.
    pub(super) words: Cursor<'a>,
}

/// Reads the parts of a line before its first word.
pub(super) fn start(line: &str) -> Start<'_> {
    let mut words = Cursor::new(line);
    let switch = words.take(b'/').then(|| words.take_while(|byte| byte.is_ascii_digit()));
    words.peek();
    let mut ahead = words;
    let mut number = None;
    if matches!(ahead.byte(), Some(b'N' | b'n')) {
        ahead.advance();
        if !ahead.take_while(|byte| byte.is_ascii_digit()).is_empty() {
            number = Some(words.text_to(&ahead));
            words = ahead;
        }
    }
    let mut ahead = words;
    let name = ahead.name();
    let is_label = name.len() > 1 && ahead.take(b':') && ahead.byte() != Some(b'=');
    let label = is_label.then_some(name);
    if is_label {
        words = ahead;
    }
    Start { switch, number, label, words }
}
