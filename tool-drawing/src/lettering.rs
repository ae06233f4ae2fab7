//! Text as strokes of a built-in alphabet, so that a drawing needs no font and looks the same everywhere, as SVG and as
//! PNG.

use super::glyphs::{Stroke, glyph, marked};
use std::fmt::Write;

/// The height of capitals, in units of the alphabet.
const CAPITAL_HEIGHT: f64 = 14.0;
/// The space between two letters, in units of the alphabet.
const LETTER_SPACING: f32 = 3.4;

/// The strokes drawn for an unknown character.
const UNKNOWN_GLYPH: &[Stroke] = &[(0.0, 0.0, "v-14h8v14z")];

/// Returns the width of a line of text whose capitals are `size` high.
pub fn width(text: &str, size: f64) -> f64 {
    let letters = text.chars().map(|letter| advance(letter) + LETTER_SPACING).sum::<f32>();
    f64::from((letters - LETTER_SPACING).max(0.0)) * size / CAPITAL_HEIGHT
}

/// Returns the path data of a line of text in units of the alphabet, from (0, 0) to the right.
pub fn strokes(text: &str) -> String {
    let mut data = String::new();
    let mut pen = 0.0;
    for letter in text.chars() {
        let (base, mark) = marked(letter).unwrap_or((letter, &[]));
        let strokes = glyph(base).map_or(UNKNOWN_GLYPH, |(_, strokes)| strokes);
        let raised = if base.is_uppercase() { -4.0 } else { 0.0 };
        // Writing to a `String` cannot fail.
        for (x, y, rest) in strokes {
            let _ = write!(data, "M{} {}{rest}", short(pen + x), short(*y));
        }
        for (x, y, rest) in mark {
            let _ = write!(data, "M{} {}{rest}", short(pen + x), short(y + raised));
        }
        pen += advance(letter) + LETTER_SPACING;
    }
    data
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

fn advance(letter: char) -> f32 {
    let base = marked(letter).map_or(letter, |(base, _)| base);
    glyph(base).map_or(8.0, |(width, _)| width)
}

fn short(value: f32) -> f32 {
    (value * 10.0).round() / 10.0
}
