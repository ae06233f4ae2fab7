//! Draws a checked tool as SVG: its section, hatched on the left half, with names and dimensions of its surfaces, and
//! optionally its regions on the right half, in the style of figs. 7.3 and 7.4 of Ho (1999). Solids are drawn in three
//! sections.
//!
//! ```text
//! profile ─────cells─▶ surface, areas and splits ──view──▶ the sheet
//! plan's tree ─trace─▶
//! ```
//!
//! The surface of a profile is its segments, and the borders of its regions are computed in closed form. Regions by hand
//! and solids are traced; their corners are computed as intersections of curves, to full precision, so that dimensions are
//! exact. Text is drawn in strokes of a built-in alphabet (`lettering`). The same tool always gives the same bytes.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

// The code block of this page is a test, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod cells;
mod curves;
mod detail;
mod legend;
pub mod lettering;
mod notes;
mod paint;
mod picture;
mod regions;
mod section;
mod shape;
mod sheet;
mod solid;
mod stroke;
mod trace;
mod view;

use detail::Detail;
use picture::{Part, Picture};
pub use sheet::TextRendering;
use sheet::{Anchor, Look, Sheet};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::domain::Domain;

/// Lengths below this part of the size, and sines below it, are rounding.
const ROUNDING_FRACTION: f64 = 1e-6;

/// The content of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// The section's outline with the surfaces and their dimensions.
    Outline,
    /// Also the regions, with their directions.
    Regions,
}

/// Draws a tool as SVG, on a white background. The drawing has a title and needs no caption.
///
/// A `tool` is drawn as its section through the axis, and its cutting part again at a larger scale if it is small. A
/// `solid` has no axis, so three sections through its middle are drawn.
pub fn svg(tool: &CheckedTool, content: Content, text: TextRendering) -> String {
    let mut sheet = Sheet::new(text);
    match tool.model.domain {
        Domain::HalfPlane => revolved(tool, content, &mut sheet),
        Domain::Space => solid::draw(tool, content, &mut sheet),
    }
    title(tool, &mut sheet);
    let name = &tool.model.name;
    sheet.finish(&match &tool.model.title {
        Some(title) => format!("{name}: {title}"),
        None => name.clone(),
    })
}

/// Draws the views of a tool with an axis, and their legend.
fn revolved(tool: &CheckedTool, content: Content, sheet: &mut Sheet) {
    let mut picture = Picture::new(tool, content);
    let detail = Detail::new(tool, &picture);
    picture.part = detail.as_ref().map_or(Part::Whole, |detail| Part::OutsideDetail(detail.corner));
    let mut marks = picture.draw(sheet);
    if let Some(detail) = detail {
        detail.mark(&picture, sheet);
        marks.add(detail.draw(sheet));
    }
    legend::draw(&[legend::surfaces(&tool.model), legend::signs(content, &marks)], sheet);
}

/// Writes name, description and unit above the drawing.
fn title(tool: &CheckedTool, sheet: &mut Sheet) {
    let model = &tool.model;
    let [low, high] = sheet.frame();
    let available_width = (high[0] - low[0]).max(400.0);
    let unit = model.unit.symbol();
    let mut y = low[1] - 22.0;
    let small = Look { colour: sheet::SECONDARY_COLOUR, ..Look::plain(7.5, Anchor::Left) };
    let origin = match model.domain {
        Domain::HalfPlane => ", z from the tip",
        Domain::Space => "",
    };
    sheet.text(&format!("lengths in {unit}{origin}"), [low[0], y], small);
    y -= 17.0;
    let title = model.title.as_deref().unwrap_or("");
    for line in lettering::wrapped(title, 8.5, available_width).iter().rev() {
        sheet.text(line, [low[0], y], Look::plain(8.5, Anchor::Left));
        y -= 15.0;
    }
    let large = Look { bold: true, ..Look::plain(12.5, Anchor::Left) };
    sheet.text(&model.name, [low[0], y - 5.0], large);
}

#[cfg(test)]
mod tests;
