//! Pictures of a map on its part, in a fixed set of views.

use super::render::{VIEWS, render};
use crate::arguments::postures::Quantity;
use crate::failure::Failure;
use crate::lengths::format_number;
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::{Options, Tree};
use std::fmt::Write;
use tool_dsl::draw::lettering::{scale, strokes, width};
use touchoff::postures::{Directions, MapRow, PostureMap, colormap};
use touchoff::{Mesh, Unit};

/// Side of a view, in pixels.
const SIDE: usize = 700;
/// Height of the legend, in pixels.
const LEGEND: usize = 110;
/// Height of capital letters, in pixels.
const LETTER: f64 = 15.0;
/// Colour of triangles without a value.
const NOTHING: [u8; 3] = [200, 200, 200];

/// Renders a map on its part as a PNG.
pub(super) fn of(
    map: &PostureMap,
    directions: &Directions,
    mesh: &Mesh,
    by: Quantity,
) -> Result<Vec<u8>, Failure> {
    let mut values = vec![None; mesh.triangles().len()];
    for entry in map.rows()? {
        let (triangle, row) = entry?;
        values[triangle.index()] = value(&row, directions, by);
    }
    let known = || values.iter().copied().flatten();
    let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(0.0, f64::max));
    // The scale begins at 0, except for stick-outs: the least of these is a property of the tool.
    let low = if by == Quantity::StickOut { low.min(high) } else { 0.0 };
    let share = |value: f64| if high > low { (value - low) / (high - low) } else { 1.0 };
    let colours: Vec<[u8; 3]> =
        values.iter().map(|value| value.map_or(NOTHING, |value| colormap(share(value)))).collect();
    let pixels = |reason: &dyn std::fmt::Display| Failure::Pixels(reason.to_string());
    let (columns, rows) = (2 * SIDE, 2 * SIDE + LEGEND);
    let mut sheet =
        Pixmap::new(columns as u32, rows as u32).ok_or_else(|| pixels(&"it has no size"))?;
    let paper = sheet.pixels_mut();
    for (index, view) in VIEWS.iter().enumerate() {
        let image = render(mesh, &colours, view, SIDE);
        let (left, top) = (index % 2 * SIDE, index / 2 * SIDE);
        for (at, [r, g, b]) in image.pixels.iter().enumerate() {
            let pixel = (top + at / image.side) * columns + left + at % image.side;
            paper[pixel] = opaque([*r, *g, *b]);
        }
    }
    paper[columns * 2 * SIDE..].fill(opaque([255; 3]));
    let legend = legend(by, [low, high], map.identity().part.unit, known().count() > 0);
    let tree = Tree::from_str(&legend, &Options::default()).map_err(|error| pixels(&error))?;
    resvg::render(&tree, Transform::identity(), &mut sheet.as_mut());
    sheet.encode_png().map_err(|error| pixels(&error))
}

fn opaque([r, g, b]: [u8; 3]) -> PremultipliedColorU8 {
    PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(PremultipliedColorU8::TRANSPARENT)
}

/// Returns the value shown for a triangle, if it has one.
fn value(row: &MapRow, directions: &Directions, by: Quantity) -> Option<f64> {
    match by {
        Quantity::Niceness => row.best.first().map(|best| best.niceness),
        Quantity::Accessibility => {
            // The union of the directions of all tools.
            let mut all = vec![0u64; row.access.first()?.directions.len()];
            for access in &row.access {
                all.iter_mut().zip(&access.directions).for_each(|(all, word)| *all |= word);
            }
            let angle = directions.solid_angle(&all);
            (angle > 0.0).then_some(angle)
        }
        Quantity::StickOut => {
            let stickouts = row.access.iter().filter_map(|access| access.stickout);
            stickouts.reduce(f64::min)
        }
    }
}

/// Returns the colour scale with its labels, and the names of the views, as an SVG of the sheet's size.
fn legend(by: Quantity, [low, high]: [f64; 2], unit: Unit, any: bool) -> String {
    let (columns, rows) = (2 * SIDE, 2 * SIDE + LEGEND);
    let mut svg =
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{columns}\" height=\"{rows}\">");
    let mut text = |[x, y]: [f64; 2], text: &str| {
        // Writing to a String does not fail.
        let _ = write!(
            svg,
            "<path transform=\"translate({x} {y})scale({})\" d=\"{}\" fill=\"none\" stroke=\"#222\" \
             stroke-width=\"1.4\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>",
            scale(LETTER),
            strokes(text),
        );
    };
    for (index, view) in VIEWS.iter().enumerate() {
        text([(index % 2 * SIDE) as f64 + 16.0, (index / 2 * SIDE) as f64 + 32.0], view.name);
    }
    let base = 2 * SIDE;
    let (left, right) = (SIDE as f64 * 0.4, SIDE as f64 * 1.6);
    let (words, ends) = match by {
        Quantity::Niceness => {
            ("niceness of the best posture", [low, high].map(|v| format!("{v:.3}")))
        }
        Quantity::Accessibility => {
            ("solid angle of access, steradians", [low, high].map(|v| format!("{v:.2}")))
        }
        Quantity::StickOut => (
            "least stick-out",
            [low, high].map(|value| format!("{} {unit}", format_number(value, unit))),
        ),
    };
    let below = base as f64 + 92.0;
    if any {
        text([left, below], &ends[0]);
        text([right - width(&ends[1], LETTER), below], &ends[1]);
    }
    text([(SIDE as f64) - 0.5 * width(words, LETTER), base as f64 + 28.0], words);
    let none = "none";
    text([32.0 + 26.0, base as f64 + 60.0], none);
    let swatch = |[x, wide]: [f64; 2], [r, g, b]: [u8; 3]| {
        let y = base as f64 + 40.0;
        format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{wide}\" height=\"26\" fill=\"rgb({r},{g},{b})\"/>"
        )
    };
    svg += &swatch([24.0, 26.0], NOTHING);
    const STEPS: usize = 120;
    let step = (right - left) / STEPS as f64;
    for k in 0..STEPS {
        // A little wider than a step, so that no gap shows.
        let span = [left + step * k as f64, step + 0.5];
        svg += &swatch(span, colormap((k as f64 + 0.5) / STEPS as f64));
    }
    svg + "</svg>"
}
