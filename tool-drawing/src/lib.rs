//! Draws a checked tool as SVG: its section, hatched on the left half, with names and dimensions of its surfaces, and
//! optionally its regions on the right half, in the style of figs. 7.3 and 7.4 of Ho (1999). Solids are drawn in three
//! sections.
//!
//! ```text
//! plan ──section──▶ pieces ──borders──▶ lines and arcs with their neighbours ──view──▶ the sheet
//! ```
//!
//! The drawing is derived only from the plan's tree and its curves, so profiles and regions written by hand are drawn
//! the same way. Corners are computed as intersections of curves, to full precision, so the dimensions are exact. Text
//! is drawn in strokes of a built-in alphabet (`lettering`). The same tool always gives the same bytes.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

// The code block of this page is a test, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod borders;
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
mod view;

use borders::{Border, Nearness, Side};
use curves::{Curves, Plane};
use detail::Detail;
use regions::Marks;
use section::Fineness;
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
        marks = marks.joined(detail.draw(sheet));
    }
    legend::draw(&[legend::surfaces(&tool.model), legend::signs(content, &marks)], sheet);
}

/// A view of a section.
struct Picture<'m> {
    model: &'m Model,
    content: Content,
    part: Part,
    borders: Vec<Border>,
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

/// The borders of a section, and its size, the scale of tolerances for rounding.
struct Traced {
    borders: Vec<Border>,
    size: f64,
}

/// Traces the borders in a window of a section. `unit` is a lower bound on one unit of the sheet and `size` the section's
/// size, both in the tool's unit.
fn trace(
    curves: &mut Curves<'_>,
    tool: &CheckedTool,
    window: [Point; 2],
    [unit, size]: [f64; 2],
) -> Traced {
    let fineness = Fineness { cell: 10.0 * unit, flat: 0.06 * unit, same: 1e-10 * size };
    let pieces = section::divide(curves, &tool.tree, window, fineness);
    let near = Nearness { weld: 1e-9 * size, visible_length: 0.1 * unit, reach: unit };
    Traced { borders: borders::borders(curves, &pieces, near), size }
}

impl<'m> Picture<'m> {
    /// Returns the view of a whole tool with an axis.
    fn new(tool: &'m CheckedTool, content: Content) -> Picture<'m> {
        let (model, extent) = (&tool.model, &tool.extent);
        let height = extent.high - extent.low;
        let unit = (height / 500.0).min(extent.radius / 60.0);
        // Odd shares, so that no side of a cell runs along a curve.
        let low = [0.0, extent.low - 0.0213 * height];
        let high = [1.0371 * extent.radius, extent.high + 0.0197 * height];
        let mut curves = Curves::new(model, extent, Plane::Meridian);
        let size = height.max(extent.radius);
        let traced = trace(&mut curves, tool, [low, high], [unit, size]);
        let view = View::new(&traced.borders, MAX_TOOL_EXTENT);
        let fills = paint::area_colours(model.regions.len(), &traced.borders);
        Picture::of(model, content, traced, view, fills)
    }

    fn of(
        model: &'m Model,
        content: Content,
        Traced { borders, size }: Traced,
        view: View,
        fills: Vec<&'static str>,
    ) -> Picture<'m> {
        let shapes = (0..model.regions.len()).map(|region| {
            let mut shape = Shape::new(&borders, &view, |side| side == Side::Region(region));
            let half = view.half + 1.0;
            // Marks keep off the break lines.
            for y in view.seams() {
                shape.keep_off(
                    [-5.0, 0.0, 5.0].map(|shift| [[-half, y + shift], [half, y + shift]]),
                );
            }
            shape
        });
        let shapes = shapes.collect();
        Picture { model, content, part: Part::Whole, borders, view, shapes, fills, size }
    }

    /// Returns the index of a region's surface.
    fn surface(&self, region: usize) -> usize {
        self.model.regions[region].surface
    }

    /// Draws the section with its notes.
    fn draw(&self, sheet: &mut Sheet) -> Marks {
        let marks = regions::draw(self, sheet);
        notes::draw(self, &marks, sheet);
        marks
    }

    /// Returns whether something is named and measured in this view, by its largest coordinates.
    fn describes(&self, [d, z]: Point) -> bool {
        let near = 1e-6 * self.size;
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

/// Writes name, description and unit above the drawing.
fn title(tool: &CheckedTool, sheet: &mut Sheet) {
    let model = &tool.model;
    let [low, high] = sheet.frame();
    let available_width = (high[0] - low[0]).max(400.0);
    let unit = model.unit.symbol();
    let mut lines = Vec::new();
    if let Some(title) = &model.title {
        lines = lettering::wrapped(title, 8.5, available_width);
    }
    let mut y = low[1] - 22.0;
    let small = Look { colour: sheet::SECONDARY_COLOUR, ..Look::plain(7.5, Anchor::Left) };
    let origin = match model.domain {
        Domain::HalfPlane => ", z from the tip",
        Domain::Space => "",
    };
    sheet.text(&format!("lengths in {unit}{origin}"), [low[0], y], small);
    y -= 17.0;
    for line in lines.iter().rev() {
        sheet.text(line, [low[0], y], Look::plain(8.5, Anchor::Left));
        y -= 15.0;
    }
    let large = Look { bold: true, ..Look::plain(12.5, Anchor::Left) };
    sheet.text(&model.name, [low[0], y - 5.0], large);
}

#[cfg(test)]
mod tests;
