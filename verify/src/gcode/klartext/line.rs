//! The text of a block: the lines that belong to it, and the words on them.
//!
//! A block is a line, and the lines after it as long as each ends in `~`. A comment begins with `;` and ends with its line, or with a later
//! one if it is wrapped. Numbers
//! have a point or a comma.

use crate::gcode::cursor::{self, Blanks};
use crate::gcode::{ExpressionFault, GcodeFault, LARGEST_NUMBER, shown, unquoted};
use touchoff::Unit;

/// A place in the text: the byte at which a block begins, and the number of its line from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) offset: usize,
    pub(super) line: usize,
}

/// Returns the block at a place, and the place after it.
pub(super) fn block(text: &str, place: Place) -> Option<(&str, Place)> {
    let rest = text.get(place.offset..).filter(|rest| !rest.is_empty())?;
    let (mut length, mut lines) = (0, 0);
    loop {
        let tail = &rest[length..];
        let (line, whole) = match tail.split_once('\n') {
            Some((line, _)) => (line, line.len() + 1),
            None => (tail, tail.len()),
        };
        (length, lines) = (length + whole, lines + 1);
        if length == rest.len() || !line.trim_end().ends_with('~') {
            break;
        }
    }
    Some((&rest[..length], Place { offset: place.offset + length, line: place.line + lines }))
}

/// Returns a block without the sign of an optional block and its number, and whether it has the sign.
pub(super) fn begin(block: &str) -> (Cursor<'_>, bool) {
    let mut cursor = Cursor::new(block);
    let mut is_optional = cursor.take(b'/');
    cursor.peek();
    cursor.take_while(|byte| byte.is_ascii_digit());
    is_optional |= cursor.take(b'/');
    (cursor, is_optional)
}

/// Returns the unit of a line that is the head of a program, `BEGIN PGM NAME MM`.
pub(super) fn head(block: &str) -> Option<Unit> {
    let (mut cursor, _) = begin(block);
    let is_head = cursor.take_word("BEGIN") && cursor.take_word("PGM");
    let text = cursor.rest().split(';').next().unwrap_or_default().trim_end();
    match text.rsplit_once(char::is_whitespace).filter(|_| is_head)?.1 {
        unit if unit.eq_ignore_ascii_case("MM") => Some(Unit::Millimetre),
        unit if unit.eq_ignore_ascii_case("INCH") => Some(Unit::Inch),
        _ => None,
    }
}

/// Blanks, ends of lines, comments and the signs of continued lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Continued;

impl Blanks for Continued {
    fn length(text: &str) -> usize {
        let mut length = 0;
        loop {
            match text.as_bytes().get(length) {
                Some(b' ' | b'\t' | b'\r' | b'\n' | b'~') => length += 1,
                Some(b';') => length += comment(&text[length..]),
                _ => return length,
            }
        }
    }
}

/// A place in the text of a block.
pub(super) type Cursor<'a> = cursor::Cursor<'a, Continued>;

impl<'a> Cursor<'a> {
    /// Passes over a word of letters, in either case, if it is next.
    pub(super) fn take_word(&mut self, word: &str) -> bool {
        let mut ahead = *self;
        let found = ahead.letters().eq_ignore_ascii_case(word);
        if found {
            *self = ahead;
        }
        found
    }

    /// Passes over a text in quotes, and returns it.
    pub(super) fn quoted(&mut self) -> Result<&'a str, GcodeFault> {
        let rest = self.rest();
        let name = rest[1..].split(['"', '\n']).next().unwrap_or_default();
        match rest[1 + name.len()..].starts_with('"') {
            true => {
                self.advance_by(name.len() + 2);
                Ok(name)
            }
            false => Err(expected(rest, "the second quotation mark of a name")),
        }
    }

    /// Returns whether only blanks and comments follow.
    pub(super) fn is_at_end(&mut self) -> bool {
        self.peek().is_none()
    }

    /// Refuses what follows, if something does.
    pub(super) fn check_end(&mut self) -> Result<(), GcodeFault> {
        match self.is_at_end() {
            true => Ok(()),
            false => Err(self.unexpected("nothing more in this block")),
        }
    }

    /// Returns the fault of what follows.
    pub(super) fn unexpected(&mut self, wanted: &'static str) -> GcodeFault {
        self.peek();
        expected(self.rest(), wanted)
    }

    /// Reads a number without a sign.
    pub(super) fn number(&mut self) -> Result<f64, GcodeFault> {
        let start = self.rest();
        let digits = self.take_while(|byte| byte.is_ascii_digit() || byte == b'.');
        // A comma is the point of controls in German.
        let mut number = digits.parse::<f64>();
        if self.byte() == Some(b',') && !digits.contains('.') {
            self.advance();
            let places = self.take_while(|byte| byte.is_ascii_digit());
            number = format!("{digits}.{places}").parse();
        }
        let number = number.map_err(|_| {
            let shown = shown(start.split_whitespace().next().unwrap_or_default());
            ExpressionFault::Number { shown }
        })?;
        match number <= LARGEST_NUMBER {
            true => Ok(number),
            false => Err(ExpressionFault::NotFinite { operation: "a number" }.into()),
        }
    }
}

/// Words that can begin a line that continues a block, beside those with numbers.
const CONTINUING: [&str; 26] = [
    "AUTO", "C", "CALL", "COORD", "CYCL", "DEF", "DIST", "DR", "F", "FMAX", "FU", "FZ", "L", "M",
    "MAX", "MB", "MOVE", "PLANE", "POS", "REP", "RL", "ROT", "RR", "STAY", "TABLE", "TURN",
];

/// Returns the length of a comment at the start of a text, up to the end of its line.
///
/// A comment that is too long for its line goes on after a `~` that follows its last word at once. The text after such a sign is that
/// of the comment if its first word has a letter in lower case, no digit and no sign, and is none that a block has. Any other text is
/// taken for words of the block.
fn comment(text: &str) -> usize {
    let mut length = 0;
    loop {
        let rest = &text[length..];
        let line = rest.split('\n').next().unwrap_or_default();
        let next = rest[line.len()..].split_whitespace().next().unwrap_or_default();
        length += line.len();
        let before = line.trim_end().strip_suffix('~');
        let is_wrapped =
            before.is_some_and(|before| before.ends_with(|c: char| !c.is_whitespace()));
        let is_word = CONTINUING.iter().any(|word| word.eq_ignore_ascii_case(next));
        let is_prose = !is_word
            && next.contains(|c: char| c.is_lowercase())
            && !next.contains(|c: char| c.is_ascii_digit() || "+-=".contains(c));
        if !is_wrapped || !is_prose {
            return length;
        }
        // The end of the line.
        length += 1;
    }
}

/// Returns the fault of a text that is not what is understood at its place.
pub(super) fn expected(text: &str, wanted: &'static str) -> GcodeFault {
    let line = text.lines().next().unwrap_or_default().trim_end();
    GcodeFault::Sentence { shown: unquoted(line), expected: wanted }
}
