//! Pictures of parts: values by colour, in several views on one sheet.

pub(crate) mod camera;
mod lettering;
pub(crate) mod render;
mod scale;

use crate::failure::Failure;
use camera::{Camera, VIEWS};
use lettering::{LETTER, Overlay};
use nalgebra::Point3;
use render::{Facet, Image, render};
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::{Options, Tree};
use tool_drawing::lettering::width;
use touchoff::Unit;
use touchoff_postures::colormap;

pub(crate) use scale::Scale;

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
    let corners = || facets.iter().flat_map(|facet| facet.corners);
    let mut sheet = Sheet::new([columns, rows])?;
    for (index, view) in VIEWS.iter().enumerate() {
        let camera = Camera::fitted(view, corners());
        let at = [index % 2 * side, TITLE + index / 2 * side];
        sheet.view(facets.iter().copied(), &camera, (at, [side, side]), unit);
        let [x, y] = at.map(|at| at as f64);
        sheet.overlay.text([x + 16.0, y + 24.0], LETTER, view.name);
    }
    let room = columns as f64 - 48.0;
    sheet.overlay.title([24.0, 34.0], (1.3 * LETTER, room), &heading.title);
    sheet.overlay.title([24.0, 64.0], (0.9 * LETTER, room), &heading.subtitle);
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
    sheet.view(facets, camera, ([0, TITLE], [columns, rows]), unit);
    let room = columns as f64 - 24.0;
    sheet.overlay.title([12.0, 22.0], (0.9 * LETTER, room), &heading.title);
    sheet.overlay.title([12.0, 43.0], (0.75 * LETTER, room), &heading.subtitle);
    if scale.has_values {
        let (size, base) = (0.7 * LETTER, (TITLE + rows) as f64 + 21.0);
        let [low, high] = &scale.ends;
        let left = 12.0 + width(low, size) + 8.0;
        let wide = 0.5 * columns as f64 - left;
        sheet.overlay.text([12.0, base], size, low);
        ramp(&mut sheet.overlay, [left, base - 11.0], [wide, 12.0]);
        sheet.overlay.text([left + wide + 8.0, base], size, high);
        let legend = [left + wide + 24.0 + width(high, size), base];
        sheet.overlay.title(legend, (size, room - legend[0]), &scale.quantity);
    }
    sheet.png()
}

/// A picture that is made of views and text.
struct Sheet {
    pixels: Pixmap,
    overlay: Overlay,
}

fn pixels(reason: &dyn std::fmt::Display) -> Failure {
    Failure::Pixels(reason.to_string())
}

impl Sheet {
    fn new(size: [usize; 2]) -> Result<Sheet, Failure> {
        let [columns, rows] = size.map(|side| side as u32);
        let mut map = Pixmap::new(columns, rows).ok_or_else(|| pixels(&"it has no size"))?;
        map.pixels_mut().fill(opaque([255; 3]));
        Ok(Sheet { pixels: map, overlay: Overlay::new(size) })
    }

    /// Draws what a camera sees into a part of the picture, with axes and a scale of length.
    fn view(
        &mut self,
        facets: impl Iterator<Item = Facet>,
        camera: &Camera,
        (at, size): ([usize; 2], [usize; 2]),
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
        let tree = Tree::from_str(&svg, &Options::default()).map_err(|error| pixels(&error))?;
        resvg::render(&tree, Transform::identity(), &mut self.pixels.as_mut());
        self.pixels.encode_png().map_err(|error| pixels(&error))
    }
}

fn opaque([r, g, b]: [u8; 3]) -> PremultipliedColorU8 {
    PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(PremultipliedColorU8::TRANSPARENT)
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
