//! The lines of a program text, and its end.

use super::block::Block;
use super::expression::Parameters;
use super::label::Place;
use touchoff::Unit;

/// Returns the line at a place, and the place after it. Lines end in LF or CRLF.
pub(super) fn line(text: &str, place: Place) -> Option<(&str, Place)> {
    let rest = text.get(place.offset..).filter(|rest| !rest.is_empty())?;
    let (found, length) = match rest.split_once('\n') {
        Some((found, _)) => (found, found.len() + 1),
        None => (rest, rest.len()),
    };
    let after = Place { offset: place.offset + length, line: place.line + 1 };
    Some((found.strip_suffix('\r').unwrap_or(found), after))
}

/// Returns the text of a line before the first semicolon.
pub(super) fn before_semicolon(line: &str) -> &str {
    line.split(';').next().unwrap_or_default()
}

/// Returns whether a line is the `%` that encloses a program. A name may follow the first one.
pub(super) fn is_percent(line: &str, is_first: bool) -> bool {
    match line.trim().strip_prefix('%') {
        Some("") => true,
        Some(rest) => {
            let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let rest = rest.trim();
            rest.starts_with(['(', ';']) || is_first && rest.chars().all(is_name)
        }
        None => false,
    }
}

/// Returns the unit of the head of a DIN/ISO program of Heidenhain, `%NAME G71 *`, or of its last line, which a block number
/// may precede.
fn head(line: &str) -> Option<Unit> {
    let line = line.trim().trim_end_matches('*').trim_end();
    let line = match line.strip_prefix(['N', 'n']) {
        Some(rest) => rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start(),
        None => line,
    };
    let (name, unit) = line.strip_prefix('%')?.trim_end().rsplit_once(char::is_whitespace)?;
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_-. ".contains(c);
    match unit.to_ascii_uppercase().as_str() {
        _ if !name.chars().all(is_name) => None,
        "G70" => Some(Unit::Inch),
        "G71" => Some(Unit::Millimetre),
        _ => None,
    }
}

/// Returns whether a line has no words: it is blank, or one comment.
fn is_empty(line: &str) -> bool {
    let line = line.trim();
    line.is_empty()
        || line.starts_with(';')
        || line.starts_with('(') && line.find(')') == Some(line.len() - 1)
}

/// Reads a line on its own, as far as it depends on no parameter.
pub(super) fn block(line: &str) -> Option<Block> {
    let mut block = Block::default();
    block.parse(line, &mut Parameters::default()).ok().map(|()| block)
}

/// The extent of a program in its file.
#[derive(Debug)]
pub(super) struct Extent<'a> {
    /// The text without what follows the last `%`.
    pub(super) text: &'a str,
    /// The first line of the program.
    pub(super) start: Place,
    /// Set if `%` ends the program.
    pub(super) closed: bool,
    /// The line of the first text after it, and whether there are blocks in that text.
    pub(super) left_out: Option<(usize, bool)>,
    /// The unit that the head states.
    pub(super) unit: Option<Unit>,
}

/// Returns the line of the first carriage return without a line feed.
pub(super) fn lone_return(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let is_lone = |index: &usize| bytes[*index] == b'\r' && bytes.get(index + 1) != Some(&b'\n');
    let index = (0..bytes.len()).find(is_lone)?;
    Some(1 + bytes[..index].iter().filter(|byte| **byte == b'\n').count())
}

/// Finds the first line and the end of a program.
pub(super) fn extent(text: &str) -> Extent<'_> {
    let mut extent = Extent {
        text,
        start: Place { offset: 0, line: 1 },
        closed: false,
        left_out: None,
        unit: None,
    };
    let mut place = extent.start;
    let mut is_first = true;
    while let Some((found, after)) = line(text, place) {
        if extent.closed {
            if !found.trim().is_empty() && !is_percent(found, false) {
                let (_, has_blocks) = extent.left_out.get_or_insert((place.line, false));
                *has_blocks |= block(found).is_some_and(|block| block.has_effect());
            }
        } else if is_percent(found, is_first) || head(found).is_some() {
            if is_first {
                (extent.start, extent.unit) = (after, head(found));
            } else {
                extent.text = &text[..place.offset];
                extent.closed = true;
            }
        }
        is_first &= is_empty(found);
        place = after;
    }
    extent
}
