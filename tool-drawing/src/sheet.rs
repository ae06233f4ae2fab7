//! The sheet: writes compact SVG, the same for the same drawing every time.

use super::lettering::{scale, strokes, width};
use super::stroke::Stroke;
use std::fmt::Write;
use touchoff_plane::Point;

/// The end of a line of text that is anchored at its position.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
}

/// Near-black, the default colour of text and lines.
pub(super) const DEFAULT_COLOUR: &str = "#22272e";
/// The colour of dimension lines and leaders.
pub(super) const SECONDARY_COLOUR: &str = "#6b7280";

/// The rendering of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextRendering {
    /// Strokes of the built-in alphabet: text looks the same everywhere and needs no font.
    Strokes,
    /// SVG text in the font of the page that embeds the drawing: text can be searched, and the file is smaller.
    Page,
}

/// The drawing so far. Text lies above everything else.
pub(super) struct Sheet {
    pub(super) lettering: TextRendering,
    drawn: String,
    halos: String,
    texts: String,
    frame: Option<[Point; 2]>,
}

impl Sheet {
    /// Returns an empty sheet.
    pub(super) fn new(lettering: TextRendering) -> Sheet {
        let empty = String::new;
        Sheet { lettering, drawn: empty(), halos: empty(), texts: empty(), frame: None }
    }

    /// Adds a part, whose origin is placed at a point of this sheet.
    pub(super) fn place(&mut self, part: &Sheet, [x, y]: Point) {
        let open = format!("<g transform=\"translate({} {})\">", short(x), short(y));
        let layers = [
            (&mut self.drawn, &part.drawn),
            (&mut self.halos, &part.halos),
            (&mut self.texts, &part.texts),
        ];
        for (layer, more) in layers.into_iter().filter(|(_, more)| !more.is_empty()) {
            let _ = write!(layer, "{open}{more}</g>");
        }
        for corner in part.frame() {
            self.reach([corner[0] + x, corner[1] + y]);
        }
    }

    /// Draws shapes that share attributes. Writes nothing if there are no shapes.
    pub(super) fn group(&mut self, attributes: &str, draw: impl FnOnce(&mut Sheet)) {
        let open = format!("<g {attributes}>");
        self.drawn.push_str(&open);
        let before = self.drawn.len();
        draw(self);
        if self.drawn.len() == before {
            self.drawn.truncate(before - open.len());
        } else {
            self.drawn.push_str("</g>");
        }
    }

    /// Draws a path. Writes nothing if `data` is empty.
    pub(super) fn path(&mut self, attributes: &str, data: &str) {
        if !data.is_empty() {
            let space = if attributes.is_empty() { "" } else { " " };
            // Writing to a `String` cannot fail.
            let _ = write!(self.drawn, "<path{space}{attributes} d=\"{data}\"/>");
        }
    }

    /// Draws a circle.
    pub(super) fn ring(&mut self, [x, y]: Point, radius: f64) {
        let (x, y, radius) = (short(x), short(y), short(radius));
        let _ = write!(self.drawn, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>");
    }

    /// Draws a line of text, vertically centred at `at`. `halo` adds a translucent white background.
    pub(super) fn text(&mut self, text: &str, at: Point, style: Look) {
        let wide = width(text, style.size);
        let left = match style.anchor {
            Anchor::Left => at[0],
            Anchor::Middle => at[0] - wide / 2.0,
            Anchor::Right => at[0] - wide,
        };
        let base = at[1] + style.size / 2.0;
        self.reach([left - 2.0, base - style.size - 3.0]);
        self.reach([left + wide + 2.0, base + 4.0]);
        if style.halo {
            let (x, y) = (short(left - 2.5), short(base - style.size - 2.5));
            let (wide, tall) = (short(wide + 5.0), short(style.size + 5.0));
            let size = format!("width=\"{wide}\" height=\"{tall}\"");
            let _ = write!(self.halos, "<rect x=\"{x}\" y=\"{y}\" {size}/>");
        }
        let label = escaped(text);
        // Writing to a `String` cannot fail.
        let _ = match self.lettering {
            TextRendering::Strokes => {
                let colour = coloured("stroke", style.colour);
                let bold = if style.bold { " stroke-width=\"2.3\"" } else { "" };
                let (x, y, scale) = (short(left), short(base), short(scale(style.size)));
                let data = strokes(text);
                let placed = format!("transform=\"translate({x} {y})scale({scale})\" d=\"{data}\"");
                write!(self.texts, "<path aria-label=\"{label}\"{colour}{bold} {placed}/>")
            }
            // The width in the page's font is unknown, so the text is anchored at the given end.
            TextRendering::Page => {
                let colour = coloured("fill", style.colour);
                let bold = if style.bold { " font-weight=\"bold\"" } else { "" };
                let anchor = match style.anchor {
                    Anchor::Left => "",
                    Anchor::Middle => " text-anchor=\"middle\"",
                    Anchor::Right => " text-anchor=\"end\"",
                };
                // Capitals are about 0.72 of the font size.
                let (x, y, size) = (short(at[0]), short(base), short(style.size / 0.72));
                let placed =
                    format!("x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{anchor}{colour}{bold}");
                write!(self.texts, "<text {placed}>{label}</text>")
            }
        };
    }

    /// Extends the sheet to contain a point.
    pub(super) fn reach(&mut self, p: Point) {
        let [low, high] = self.frame.get_or_insert([p, p]);
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }

    /// Returns the bounding box of the drawing.
    pub(super) fn frame(&self) -> [Point; 2] {
        self.frame.unwrap_or_default()
    }

    /// Returns the SVG document, on a white background.
    pub(super) fn finish(self, title: &str) -> String {
        const MARGIN: f64 = 12.0;
        let [low, high] = self.frame();
        let [x, y] = low.map(|part| (part - MARGIN).floor());
        let (wide, tall) = ((high[0] + MARGIN - x).ceil(), (high[1] + MARGIN - y).ceil());
        let letters = match self.lettering {
            TextRendering::Strokes => format!(
                "fill=\"none\" stroke=\"{DEFAULT_COLOUR}\" stroke-width=\"1.6\" stroke-linecap=\"round\" \
                 stroke-linejoin=\"round\""
            ),
            TextRendering::Page => format!("fill=\"{DEFAULT_COLOUR}\""),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{wide}\" height=\"{tall}\" \
             viewBox=\"{x} {y} {wide} {tall}\" style=\"max-width:100%;height:auto\">\
             <title>{}</title>\
             <rect x=\"{x}\" y=\"{y}\" width=\"{wide}\" height=\"{tall}\" fill=\"#fff\"/>\
             {}<g fill=\"#fff\" fill-opacity=\".85\">{}</g><g {letters}>{}</g></svg>",
            escaped(title),
            self.drawn,
            self.halos,
            self.texts,
        )
    }
}

/// The appearance of a line of text.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// The height of capitals, in sheet units.
    pub(super) size: f64,
    pub(super) anchor: Anchor,
    pub(super) colour: &'static str,
    pub(super) bold: bool,
    pub(super) halo: bool,
}

impl Look {
    /// Returns plain text of a size.
    pub(super) fn plain(size: f64, anchor: Anchor) -> Look {
        Look { size, anchor, colour: DEFAULT_COLOUR, bold: false, halo: false }
    }
}

/// Returns the path data of strokes. Strokes that continue the previous one need no move command.
pub(super) fn data<'s>(strokes: impl IntoIterator<Item = &'s Stroke>) -> String {
    let mut data = String::new();
    let mut pen: Option<[String; 2]> = None;
    for stroke in strokes {
        let [from, to] = [stroke.from, stroke.to].map(|p| p.map(short));
        if pen.as_ref() != Some(&from) {
            let _ = write!(data, "M{} {}", from[0], from[1]);
        }
        if stroke.circle.is_none() && from == to {
            continue;
        }
        let _ = match stroke.circle {
            // The y axis points downward, so a left turn in a y-up plane appears as a right turn here.
            Some((_, radius)) => {
                let (radius, sweep) = (short(radius), u8::from(stroke.left()));
                write!(data, "A{radius} {radius} 0 0 {sweep} {} {}", to[0], to[1])
            }
            None if from[0] == to[0] => write!(data, "V{}", to[1]),
            None if from[1] == to[1] => write!(data, "H{}", to[0]),
            None => write!(data, "L{} {}", to[0], to[1]),
        };
        pen = Some(to);
    }
    data
}

/// Returns the path data of polylines.
pub(super) fn lines<R: AsRef<[Point]>>(rows: impl IntoIterator<Item = R>) -> String {
    let mut points = Vec::new();
    for row in rows {
        points.extend(row.as_ref().windows(2).map(|pair| Stroke::line(pair[0], pair[1])));
    }
    data(&points)
}

/// Formats a number with at most two decimals.
fn short(value: f64) -> String {
    trimmed(&format!("{value:.2}"))
}

/// Returns a decimal number without trailing zeros.
pub(super) fn trimmed(text: &str) -> String {
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Returns a colour attribute, or nothing for the default colour.
fn coloured(what: &str, colour: &str) -> String {
    if colour == DEFAULT_COLOUR { String::new() } else { format!(" {what}=\"{colour}\"") }
}

fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            letter if letter.is_control() => escaped.push(' '),
            letter => escaped.push(letter),
        }
    }
    escaped
}
