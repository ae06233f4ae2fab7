//! Text as strokes of a built-in alphabet, so that a drawing needs no font and looks the same everywhere, as SVG and as
//! PNG.
//!
//! All strokes are one line wide. Capitals and digits are 14 units high, lower-case letters 10; descenders reach 4 units
//! below the baseline. The y axis points downward, and the baseline is at 0.

use std::fmt::Write;

/// The glyphs without diacritics, one per line: the characters, the width, and the strokes, each with its start point and
/// relative SVG path data. Fields are separated by tabs.
const ALPHABET: &str = include_str!("alphabet.txt");
/// The width and the strokes of an unknown character.
const UNKNOWN: (f64, &str) = (8.0, "0 0v-14h8v14z");
/// The height of capitals, in units of the alphabet.
const CAPITAL_HEIGHT: f64 = 14.0;
/// The space between two letters, in units of the alphabet.
const LETTER_SPACING: f64 = 3.4;

/// Returns the width of a line of text whose capitals are `size` high.
pub fn width(text: &str, size: f64) -> f64 {
    let letters = text.chars().map(|letter| glyph(letter).0 + LETTER_SPACING).sum::<f64>();
    (letters - LETTER_SPACING).max(0.0) * scale(size)
}

/// Returns the path data of a line of text in units of the alphabet, from (0, 0) to the right.
pub fn strokes(text: &str) -> String {
    let mut data = String::new();
    let mut pen = 0.0;
    for letter in text.chars() {
        let (advance, strokes) = glyph(letter);
        write_strokes(&mut data, strokes, [pen, 0.0]);
        if let Some((base, mark)) = marked(letter) {
            let raised = if base.is_uppercase() { -4.0 } else { 0.0 };
            write_strokes(&mut data, mark, [pen, raised]);
        }
        pen += advance + LETTER_SPACING;
    }
    data
}

/// Appends the path data of strokes, moved by an offset.
fn write_strokes(data: &mut String, strokes: &str, offset: [f64; 2]) {
    for stroke in strokes.split('\t') {
        let (start, path) = stroke.split_at(stroke.find(char::is_alphabetic).unwrap_or(0));
        let Some((x, y)) = start.split_once(' ') else { continue };
        let moved = |text: &str, by: f64| {
            let value: f64 = text.parse().unwrap_or(0.0);
            ((value + by) * 10.0).round() / 10.0
        };
        // Writing to a `String` cannot fail.
        let _ = write!(data, "M{} {}{path}", moved(x, offset[0]), moved(y, offset[1]));
    }
}

/// Returns the scale factor from units of the alphabet to text whose capitals are `size` high.
pub fn scale(size: f64) -> f64 {
    size / CAPITAL_HEIGHT
}

/// Breaks text at spaces into lines no wider than `room`.
pub(super) fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + size <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Returns the width and the strokes of a character, without its diacritic.
fn glyph(letter: char) -> (f64, &'static str) {
    let base = marked(letter).map_or(letter, |(base, _)| base);
    for line in ALPHABET.lines() {
        let mut fields = line.splitn(3, '\t');
        if fields.next().is_some_and(|letters| letters.contains(base)) {
            let width = fields.next().and_then(|width| width.parse().ok());
            return (width.unwrap_or(UNKNOWN.0), fields.next().unwrap_or(""));
        }
    }
    UNKNOWN
}

/// Splits a character into its base character and the strokes of its diacritic above a lower-case letter.
fn marked(letter: char) -> Option<(char, &'static str)> {
    let rows = [
        ("äëïöüÄËÖÜ", "aeıouAEOU", "2 -13.5v-.4m4 0v.4"),
        ("áéíóúýÁÉÓÚ", "aeıouyAEOU", "3 -12l3-2.5"),
        ("àèìòùÀÈÒÙ", "aeıouAEOU", "5 -12l-3-2.5"),
        ("âêîôûÂÊÔÛ", "aeıouAEOU", "1.5 -12l2.5-2.5 2.5 2.5"),
        ("ãñõÃÑÕ", "anoANO", "1 -12.8c1.5-2 3-1.4 3.4-.9s1.8 1 3.2-.9"),
        ("åÅů", "aAu", "4 -15.5a1.6 1.6 0 1 0 .01 0z"),
        ("čěřšžČŘŠŽ", "cerszCRSZ", "1.5 -14.5l2.5 2.5 2.5-2.5"),
        ("çÇ", "cC", "4.5 0v1.4c1.6 0 1.6 2.4-.8 2.4"),
    ];
    for (with, without, mark) in rows {
        if let Some(index) = with.chars().position(|other| other == letter) {
            return Some((without.chars().nth(index)?, mark));
        }
    }
    None
}
