//! Text, axes and scales of pictures, in strokes of the drawings' alphabet.

use super::camera::Camera;
use std::fmt::Write;
use tool_drawing::lettering::{scale, strokes, width};
use touchoff::Unit;

/// Height of capital letters, in pixels.
pub(super) const LETTER: f64 = 15.0;

/// Colours of the axes x, y and z.
const AXES: [(&str, &str); 3] = [("x", "#b3261e"), ("y", "#1b7a34"), ("z", "#1f4fbf")];
/// Length of an axis that lies in the picture, in pixels.
const AXIS: f64 = 42.0;

/// The text and lines over a picture, as SVG.
pub(super) struct Overlay {
    svg: String,
}

impl Overlay {
    pub(super) fn new([columns, rows]: [usize; 2]) -> Overlay {
        let open = "<svg xmlns=\"http://www.w3.org/2000/svg\"";
        Overlay { svg: format!("{open} width=\"{columns}\" height=\"{rows}\">") }
    }

    pub(super) fn finish(self) -> String {
        self.svg + "</svg>"
    }

    /// Writes a line of text from a point to the right, on white so that it can be read over a picture.
    pub(super) fn text(&mut self, at: [f64; 2], size: f64, text: &str) {
        self.coloured_text(at, size, text, "#222");
    }

    fn coloured_text(&mut self, [x, y]: [f64; 2], size: f64, text: &str, colour: &str) {
        let data = strokes(text);
        for (colour, stroke) in [("#fff", 5.0), (colour, 1.4)] {
            // Writing to a String does not fail.
            let _ = write!(
                self.svg,
                "<path transform=\"translate({x} {y})scale({})\" d=\"{data}\" fill=\"none\" stroke=\"{colour}\" \
                 stroke-width=\"{stroke}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>",
                scale(size),
            );
        }
    }

    /// Writes a line of text that is shortened to a width.
    pub(super) fn title(&mut self, at: [f64; 2], (size, room): (f64, f64), text: &str) {
        let mut shown = text.to_owned();
        let mut kept = text.to_owned();
        while width(&shown, size) > room && kept.pop().is_some() {
            shown = format!("{kept}...");
        }
        self.text(at, size, &shown);
    }

    pub(super) fn rectangle(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], [r, g, b]: [u8; 3]) {
        let _ = write!(
            self.svg,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"rgb({r},{g},{b})\"/>"
        );
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], (colour, stroke): (&str, f64)) {
        let ([x, y], [u, v]) = (from, to);
        let _ = write!(
            self.svg,
            "<path d=\"M{x} {y}L{u} {v}\" stroke=\"{colour}\" stroke-width=\"{stroke}\" stroke-linecap=\"round\"/>"
        );
    }

    /// Draws the axes of the part's frame as a camera sees them, around a point.
    pub(super) fn axes(&mut self, [x, y]: [f64; 2], camera: &Camera) {
        let [right, up, toward] = camera.frame();
        let mut order = [0, 1, 2];
        // Those that point away from the eye are drawn first.
        order.sort_by(|one, other| toward[*one].total_cmp(&toward[*other]));
        for axis in order {
            let (name, colour) = AXES[axis];
            let end = [x + AXIS * right[axis], y - AXIS * up[axis]];
            self.line([x, y], end, ("#fff", 5.0));
            self.line([x, y], end, (colour, 2.5));
            let beyond = [x + 1.28 * AXIS * right[axis], y - 1.28 * AXIS * up[axis]];
            let size = 0.8 * LETTER;
            let start = [beyond[0] - 0.5 * width(name, size), beyond[1] + 0.4 * size];
            // An axis along the view is a point, and its letter would hide the origin.
            if right[axis].hypot(up[axis]) > 0.3 {
                self.coloured_text(start, size, name, colour);
            }
        }
    }

    /// Draws a bar of a round length that ends at a point.
    pub(super) fn scale_bar(&mut self, [x, y]: [f64; 2], per_length: f64, room: f64, unit: Unit) {
        let length = round_length(room / per_length);
        let from = x - length * per_length;
        for (colour, stroke) in [("#fff", 6.0), ("#222", 2.5)] {
            self.line([from, y], [x, y], (colour, stroke));
            for end in [from, x] {
                self.line([end, y - 5.0], [end, y + 5.0], (colour, stroke));
            }
        }
        let text = bar_label(length, unit);
        let size = 0.85 * LETTER;
        self.text([x - width(&text, size), y - 12.0], size, &text);
    }
}

/// Returns the text of a bar. A round length prints with its own digits.
fn bar_label(length: f64, unit: Unit) -> String {
    format!("{length} {unit}")
}

/// Returns the greatest of 1, 2 and 5 times a power of ten that is at most a length above 0.
fn round_length(length: f64) -> f64 {
    let power = length.log10().floor();
    let factors = [5.0, 2.0, 1.0].into_iter();
    // Powers are made from decimal text, so that the number prints with few digits.
    let rounded = factors.filter_map(|factor| format!("{factor}e{power}").parse::<f64>().ok());
    rounded.into_iter().find(|rounded| *rounded <= length).unwrap_or(length)
}

#[cfg(test)]
mod tests {
    use super::{bar_label, round_length};
    use touchoff::Unit;

    #[test]
    fn scales_are_round() {
        for (length, round) in
            [(1.0, 1.0), (0.0299, 0.02), (7.3, 5.0), (499.0, 200.0), (1e-5, 1e-5)]
        {
            assert_eq!(round_length(length), round);
        }
    }

    #[test]
    fn bars_have_round_labels_in_every_unit() {
        let label = |length, unit| bar_label(round_length(length), unit);
        assert_eq!(label(0.0374, Unit::Inch), "0.02 inch");
        assert_eq!(label(0.0062, Unit::Inch), "0.005 inch");
        assert_eq!(label(0.0119, Unit::Metre), "0.01 m");
        assert_eq!(label(0.000_213, Unit::Metre), "0.0002 m");
        assert_eq!(label(23.0, Unit::Millimetre), "20 mm");
    }
}
