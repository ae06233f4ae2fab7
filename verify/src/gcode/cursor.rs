//! A place in the text of a program, from which the readers of all languages read on.

use std::marker::PhantomData;

/// Text that stands between words and means nothing.
pub(super) trait Blanks: Copy {
    /// Returns its length at the beginning of a text.
    fn length(text: &str) -> usize;
}

/// Blanks and tabs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spaces;

impl Blanks for Spaces {
    fn length(text: &str) -> usize {
        text.bytes().take_while(|byte| matches!(byte, b' ' | b'\t')).count()
    }
}

/// A place in the text of a line, or of a block of several lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a, B: Blanks = Spaces> {
    text: &'a str,
    at: usize,
    blanks: PhantomData<B>,
}

impl<'a, B: Blanks> Cursor<'a, B> {
    pub(super) fn new(text: &'a str) -> Cursor<'a, B> {
        Cursor { text, at: 0, blanks: PhantomData }
    }

    /// Returns the byte here, a blank included.
    pub(super) fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Passes over blanks, and returns the byte after them.
    pub(super) fn peek(&mut self) -> Option<u8> {
        self.at += B::length(self.rest());
        self.byte()
    }

    /// Passes over the next byte that is no blank if it is the given one.
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// Passes over one byte, which has to be ASCII.
    pub(super) fn advance(&mut self) {
        self.advance_by(1);
    }

    /// Passes over a text of so many bytes.
    pub(super) fn advance_by(&mut self, length: usize) {
        self.at += length;
    }

    /// Passes over bytes as long as they satisfy the condition, and returns their text. The condition holds for ASCII only.
    pub(super) fn take_while(&mut self, condition: impl Fn(u8) -> bool) -> &'a str {
        let rest = self.rest();
        let length = rest.bytes().position(|byte| !condition(byte)).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// Passes over a text, in either case, if it comes next, whatever follows it.
    pub(super) fn take_text(&mut self, text: &str) -> bool {
        self.peek();
        let next = self.rest().as_bytes().get(..text.len());
        let found = next.is_some_and(|next| next.eq_ignore_ascii_case(text.as_bytes()));
        self.at += if found { text.len() } else { 0 };
        found
    }

    /// Passes over blanks, and returns the letters after them.
    pub(super) fn letters(&mut self) -> &'a str {
        self.peek();
        self.take_while(|byte| byte.is_ascii_alphabetic())
    }

    /// Passes over the text up to a delimiter and the delimiter, and returns the text before it.
    pub(super) fn take_until(&mut self, delimiter: char) -> Option<&'a str> {
        let (before, _) = self.rest().split_once(delimiter)?;
        self.at += before.len() + delimiter.len_utf8();
        Some(before)
    }

    /// Returns the text after this place.
    pub(super) fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// Returns the text from here to another place in it; empty if that is before.
    pub(super) fn text_to(&self, other: &Cursor<'a, B>) -> &'a str {
        &self.text[self.at..other.at.max(self.at)]
    }
}
