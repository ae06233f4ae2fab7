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
mod regions;
mod section;
mod shape;
mod sheet;
mod solid;
mod stroke;
mod trace;
mod view;

use curves::Plane;
use detail::Detail;
use regions::Marks;
use section::Section;
use shape::Shape;
pub use sheet::TextRendering;
use sheet::{Anchor, Look, Sheet};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::domain::Domain;
use touchoff_dsl::model::Model;
use touchoff_dsl::vector::Point;
use view::View;

/// The largest extent of a tool on the sheet: full width and height, in sheet units.
const MAX_TOOL_EXTENT: [f64; 2] = [330.0, 500.0];

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

/// A view of a section.
struct Picture<'m> {
    model: &'m Model,
    content: Content,
    part: Part,
    section: Section,
    view: View,
    /// The regions' shapes on the sheet, in the order of the model's regions, and their colours.
    shapes: Vec<Shape>,
    fills: Vec<&'static str>,
    /// The tool's size, the scale of tolerances for rounding.
    size: f64,
}

/// The part of a tool that a view describes by names and dimensions, so that no label is drawn twice.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// All of it.
    Whole,
    /// The part outside the detail, which ends at this distance from the axis and at this height.
    OutsideDetail(Point),
    /// A detail that ends at this distance from the axis and at this height.
    Detail(Point),
}

impl<'m> Picture<'m> {
    /// Returns the view of a whole tool with an axis.
    fn new(tool: &'m CheckedTool, content: Content) -> Picture<'m> {
        let extent = &tool.extent;
        let unit = ((extent.high - extent.low) / MAX_TOOL_EXTENT[1]).min(extent.radius / 60.0);
        let section = meridian_section(tool, unit);
        let view = View::new(&section, MAX_TOOL_EXTENT);
        let fills = paint::area_colours(tool.model.regions.len(), &section.splits);
        let size = (extent.high - extent.low).max(extent.radius);
        Picture::of(&tool.model, content, section, size, view, fills)
    }

    fn of(
        model: &'m Model,
        content: Content,
        section: Section,
        size: f64,
        view: View,
        fills: Vec<&'static str>,
    ) -> Picture<'m> {
        let mut shapes = Vec::new();
        for polygons in &section.areas {
            let mut shape = Shape::new(polygons, &view);
            let half = view.half + 1.0;
            // Marks keep off the break lines.
            for y in view.seams() {
                shape.keep_off(
                    [-5.0, 0.0, 5.0].map(|shift| [[-half, y + shift], [half, y + shift]]),
                );
            }
            shapes.push(shape);
        }
        Picture { model, content, part: Part::Whole, section, view, shapes, fills, size }
    }

    /// Draws the section with its notes.
    fn draw(&self, sheet: &mut Sheet) -> Marks {
        let marks = regions::draw(self, sheet);
        notes::draw(self, &marks, sheet);
        marks
    }

    /// Returns whether something is named and measured in this view, by its largest coordinates.
    fn describes(&self, [d, z]: Point) -> bool {
        let near = ROUNDING_FRACTION * self.size;
        match self.part {
            Part::Whole => true,
            Part::OutsideDetail([radius, top]) => d > radius + near || z > top + near,
            Part::Detail([radius, top]) => d < radius - near && z < top - near,
        }
    }

    /// Returns whether a region is named in this view, by a point in the middle of it on the sheet. A detail names all
    /// its regions.
    fn names(&self, middle: Point) -> bool {
        matches!(self.part, Part::Detail(_)) || self.describes(self.view.point(middle))
    }
}

/// Returns the section of a tool through its axis.
fn meridian_section(tool: &CheckedTool, unit: f64) -> Section {
    let extent = &tool.extent;
    let height = extent.high - extent.low;
    // Odd shares, so that no side of the lattice runs along a curve.
    let low = [0.0, extent.low - 0.0213 * height];
    let high = [1.0371 * extent.radius, extent.high + 0.0197 * height];
    Section::new(tool, Plane::Meridian, [low, high], unit)
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
