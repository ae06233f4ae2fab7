//! Pictures of parts: values by colour, in several views on one sheet.

pub(crate) mod render;
mod scale;

use crate::failure::Failure;
use nalgebra::Point3;
use render::{Camera, Facet, Image, VIEWS, render};
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::{Options, Tree};
use std::fmt::Write;
use touchoff::Unit;
use touchoff_drawing::lettering::{scale, strokes, width};
use touchoff_postures::colormap;

pub(crate) use scale::{Measure, Scale};

/// Colour of triangles without a value.
pub(crate) const NOTHING: [u8; 3] = [205, 205, 205];

/// Height of the title and of the legend, in pixels.
const TITLE: usize = 78;
const LEGEND: usize = 110;

/// The meaning of a picture's colours.
pub(crate) enum Legend<'a> {
    /// Values of a quantity.
    Scale(&'a Scale),
    /// A meaning per colour.
    Keys(&'a [([u8; 3], String)]),
}

/// The lines above a picture.
pub(crate) struct Heading {
    pub(crate) title: String,
    pub(crate) subtitle: String,
}

/// Draws facets in all views on one sheet, with title, axes, scale of length and legend, as a PNG. Views are `side` pixels
/// wide.
///
/// # Errors
/// If the picture cannot be made.
pub(crate) fn sheet(
    facets: &[Facet],
    heading: &Heading,
    legend: &Legend<'_>,
    unit: Unit,
    side: usize,
) -> Result<Vec<u8>, Failure> {
    let (columns, rows) = (2 * side, TITLE + 2 * side + LEGEND);
    let mut sheet = Sheet::new([columns, rows])?;
    for (index, view) in VIEWS.iter().enumerate() {
        let camera = Camera::fitted(view, facets.iter().flat_map(|facet| facet.corners));
        let at = [index % 2 * side, TITLE + index / 2 * side];
        let viewport = Viewport { at, size: [side, side] };
        sheet.view(facets.iter().copied(), &camera, viewport, unit);
        let [x, y] = at.map(|at| at as f64);
        sheet.overlay.text([x + 16.0, y + 24.0], LETTER, view.name);
    }
    let width = columns as f64 - 48.0;
    let title = TextBox { at: [24.0, 34.0], size: 1.3 * LETTER, width };
    sheet.overlay.title(title, &heading.title);
    let subtitle = TextBox { at: [24.0, 64.0], size: 0.9 * LETTER, width };
    sheet.overlay.title(subtitle, &heading.subtitle);
    match legend {
        Legend::Scale(scale) => scale_legend(&mut sheet.overlay, scale, [columns, rows - LEGEND]),
        Legend::Keys(keys) => {
            for (index, (colour, text)) in keys.iter().enumerate() {
                let top = (rows - LEGEND) as f64 + 34.0 * index as f64;
                sheet.overlay.rectangle([24.0, top + 4.0], [26.0; 2], *colour);
                sheet.overlay.text([64.0, top + 24.0], LETTER, text);
            }
        }
    }
    sheet.png()
}

/// Draws what a camera sees, with axes, a scale of length and the legend, as a PNG.
///
/// # Errors
/// If the picture cannot be made.
pub(crate) fn close_up(
    facets: impl Iterator<Item = Facet>,
    camera: &Camera,
    heading: &Heading,
    scale: &Scale,
    unit: Unit,
    [columns, rows]: [usize; 2],
) -> Result<Vec<u8>, Failure> {
    const TITLE: usize = 52;
    const LEGEND: usize = 34;
    let mut sheet = Sheet::new([columns, TITLE + rows + LEGEND])?;
    sheet.view(facets, camera, Viewport { at: [0, TITLE], size: [columns, rows] }, unit);
    let room = columns as f64 - 24.0;
    let title = TextBox { at: [12.0, 22.0], size: 0.9 * LETTER, width: room };
    sheet.overlay.title(title, &heading.title);
    let subtitle = TextBox { at: [12.0, 43.0], size: 0.75 * LETTER, width: room };
    sheet.overlay.title(subtitle, &heading.subtitle);
    if scale.has_values {
        let (size, base) = (0.7 * LETTER, (TITLE + rows) as f64 + 21.0);
        let [low, high] = &scale.ends;
        let left = 12.0 + width(low, size) + 8.0;
        let wide = 0.5 * columns as f64 - left;
        sheet.overlay.text([12.0, base], size, low);
        ramp(&mut sheet.overlay, [left, base - 11.0], [wide, 12.0]);
        sheet.overlay.text([left + wide + 8.0, base], size, high);
        let start = left + wide + 24.0 + width(high, size);
        let legend = TextBox { at: [start, base], size, width: room - start };
        sheet.overlay.title(legend, &scale.quantity);
    }
    sheet.png()
}

/// A part of a picture: its upper left corner and its size, in pixels.
#[derive(Clone, Copy)]
struct Viewport {
    at: [usize; 2],
    size: [usize; 2],
}

/// A picture that is made of views and text.
struct Sheet {
    pixels: Pixmap,
    overlay: Overlay,
}

/// Returns the failure to make a picture.
pub(crate) fn pixels(reason: impl std::fmt::Display) -> Failure {
    Failure::Pixels(reason.to_string())
}

impl Sheet {
    fn new(size: [usize; 2]) -> Result<Sheet, Failure> {
        let [columns, rows] = size.map(|side| side as u32);
        let mut map = Pixmap::new(columns, rows).ok_or_else(|| pixels("it has no size"))?;
        map.pixels_mut().fill(opaque([255; 3]));
        Ok(Sheet { pixels: map, overlay: Overlay::new(size) })
    }

    /// Draws what a camera sees into a part of the picture, with axes and a scale of length.
    fn view(
        &mut self,
        facets: impl Iterator<Item = Facet>,
        camera: &Camera,
        Viewport { at, size }: Viewport,
        unit: Unit,
    ) {
        let Image { size: [width, height], pixels } = render(facets, camera, size);
        let columns = self.pixels.width() as usize;
        let paper = self.pixels.pixels_mut();
        for y in 0..height {
            for x in 0..width {
                paper[(at[1] + y) * columns + at[0] + x] = opaque(pixels[y * width + x]);
            }
        }
        let [left, top] = at.map(|at| at as f64);
        let [right, bottom] = [left + width as f64, top + height as f64];
        self.overlay.axes([left + 62.0, bottom - 62.0], camera);
        let [per_length, room] = [camera.pixels_per_length(size), 0.25 * width as f64];
        self.overlay.scale_bar([right - 20.0, bottom - 18.0], per_length, room, unit);
    }

    fn png(mut self) -> Result<Vec<u8>, Failure> {
        let svg = self.overlay.finish();
        let tree = Tree::from_str(&svg, &Options::default()).map_err(pixels)?;
        resvg::render(&tree, Transform::identity(), &mut self.pixels.as_mut());
        self.pixels.encode_png().map_err(pixels)
    }
}

fn opaque([r, g, b]: [u8; 3]) -> PremultipliedColorU8 {
    PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(PremultipliedColorU8::TRANSPARENT)
}

/// Height of capital letters, in pixels.
const LETTER: f64 = 15.0;

/// Colours of the axes x, y and z.
const AXES: [(&str, &str); 3] = [("x", "#b3261e"), ("y", "#1b7a34"), ("z", "#1f4fbf")];
/// Length of an axis that lies in the picture, in pixels.
const AXIS: f64 = 42.0;

/// The place of a line of text: where it starts, the size of its letters, and the width that it may take, in pixels.
#[derive(Clone, Copy)]
struct TextBox {
    at: [f64; 2],
    size: f64,
    width: f64,
}

/// The look of a line: its colour, and its width in pixels.
#[derive(Clone, Copy)]
struct Stroke<'a> {
    colour: &'a str,
    width: f64,
}

/// The text and lines over a picture, as SVG, in strokes of the drawings' alphabet.
struct Overlay {
    svg: String,
}

impl Overlay {
    fn new([columns, rows]: [usize; 2]) -> Overlay {
        let open = "<svg xmlns=\"http://www.w3.org/2000/svg\"";
        Overlay { svg: format!("{open} width=\"{columns}\" height=\"{rows}\">") }
    }

    fn finish(self) -> String {
        self.svg + "</svg>"
    }

    /// Writes a line of text from a point to the right, on white so that it can be read over a picture.
    fn text(&mut self, at: [f64; 2], size: f64, text: &str) {
        self.coloured_text(at, size, text, "#222");
    }

    fn coloured_text(&mut self, [x, y]: [f64; 2], size: f64, text: &str, colour: &str) {
        let data = strokes(text);
        // A white halo under the letters keeps them readable over any colour.
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

    /// Writes a line of text, shortened to the width of its box.
    fn title(&mut self, place: TextBox, text: &str) {
        let mut shown = text.to_owned();
        let mut kept = text.to_owned();
        while width(&shown, place.size) > place.width && kept.pop().is_some() {
            shown = format!("{kept}...");
        }
        self.text(place.at, place.size, &shown);
    }

    fn rectangle(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], [r, g, b]: [u8; 3]) {
        let _ = write!(
            self.svg,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"rgb({r},{g},{b})\"/>"
        );
    }

    fn line(&mut self, [x, y]: [f64; 2], [u, v]: [f64; 2], stroke: Stroke<'_>) {
        let Stroke { colour, width } = stroke;
        let _ = write!(
            self.svg,
            "<path d=\"M{x} {y}L{u} {v}\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
        );
    }

    /// Draws the axes of the part's frame as a camera sees them, around a point.
    fn axes(&mut self, [x, y]: [f64; 2], camera: &Camera) {
        let [right, up, toward] = camera.frame();
        let mut order = [0, 1, 2];
        // Those that point away from the eye are drawn first.
        order.sort_by(|one, other| toward[*one].total_cmp(&toward[*other]));
        for axis in order {
            let (name, colour) = AXES[axis];
            let end = [x + AXIS * right[axis], y - AXIS * up[axis]];
            self.line([x, y], end, Stroke { colour: "#fff", width: 5.0 });
            self.line([x, y], end, Stroke { colour, width: 2.5 });
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
    fn scale_bar(&mut self, [x, y]: [f64; 2], per_length: f64, room: f64, unit: Unit) {
        let length = round_length(room / per_length);
        let from = x - length * per_length;
        for (colour, width) in [("#fff", 6.0), ("#222", 2.5)] {
            let stroke = Stroke { colour, width };
            self.line([from, y], [x, y], stroke);
            for end in [from, x] {
                self.line([end, y - 5.0], [end, y + 5.0], stroke);
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

/// Draws the colour scale below the views.
fn scale_legend(overlay: &mut Overlay, scale: &Scale, [columns, top]: [usize; 2]) {
    let (columns, base) = (columns as f64, top as f64);
    let (left, right) = (columns * 0.2, columns * 0.8);
    let Scale { quantity, .. } = scale;
    let middle = 0.5 * (columns - width(quantity, LETTER));
    overlay.text([middle, base + 26.0], LETTER, quantity);
    overlay.rectangle([24.0, base + 40.0], [26.0; 2], NOTHING);
    overlay.text([24.0, base + 92.0], LETTER, scale.nothing);
    ramp(overlay, [left, base + 40.0], [right - left, 26.0]);
    if scale.has_values {
        for (share, label) in scale.labels() {
            let at = left + share * (right - left);
            overlay.text([at - 0.5 * width(label, LETTER), base + 92.0], LETTER, label);
        }
    }
}

/// Draws the colours from the lowest to the greatest value.
fn ramp(overlay: &mut Overlay, [left, top]: [f64; 2], [wide, high]: [f64; 2]) {
    const STEPS: usize = 120;
    let step = wide / STEPS as f64;
    for k in 0..STEPS {
        // A little wider than a step, so that no gap shows.
        let share = (k as f64 + 0.5) / STEPS as f64;
        overlay.rectangle([left + step * k as f64, top], [step + 0.5, high], colormap(share));
    }
}

/// Returns the facets of triangles with their values.
pub(crate) fn facets<'a>(
    triangles: impl Iterator<Item = [Point3<f64>; 3]> + 'a,
    values: &'a [Option<f64>],
    scale: &'a Scale,
) -> impl Iterator<Item = Facet> + 'a {
    triangles.zip(values).map(|(corners, value)| Facet { corners, paint: scale.paint(*value) })
}

#[cfg(test)]
mod tests {
    use super::*;

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
