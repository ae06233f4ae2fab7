//! A view of a section: its shapes on the sheet, and which of them it names.

use crate::curves::Plane;
use crate::regions::{self, Marks};
use crate::section::Section;
use crate::shape::Shape;
use crate::sheet::Sheet;
use crate::view::View;
use crate::{Content, ROUNDING_FRACTION, notes, paint};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::model::Model;
use touchoff_plane::Point;

/// The largest extent of a tool on the sheet: full width and height, in sheet units.
const MAX_TOOL_EXTENT: [f64; 2] = [330.0, 500.0];

/// A view of a section.
pub(super) struct Picture<'m> {
    pub(super) model: &'m Model,
    pub(super) content: Content,
    pub(super) part: Part,
    pub(super) section: Section,
    pub(super) view: View,
    /// The regions' shapes on the sheet, in the order of the model's regions, and their colours.
    pub(super) shapes: Vec<Shape>,
    pub(super) fills: Vec<&'static str>,
    /// The tool's size, the scale of tolerances for rounding.
    pub(super) size: f64,
}

/// The part of a tool that a view describes by names and dimensions, so that no label is drawn twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// All of it.
    Whole,
    /// The part outside the detail, which ends at this distance from the axis and at this height.
    OutsideDetail(Point),
    /// A detail that ends at this distance from the axis and at this height.
    Detail(Point),
}

impl<'m> Picture<'m> {
    /// Returns the view of a whole tool with an axis.
    pub(super) fn new(tool: &'m CheckedTool, content: Content) -> Picture<'m> {
        let extent = &tool.extent;
        let unit = ((extent.high - extent.low) / MAX_TOOL_EXTENT[1]).min(extent.radius / 60.0);
        let section = meridian_section(tool, unit);
        let view = View::new(&section, MAX_TOOL_EXTENT);
        let fills = paint::area_colours(tool.model.regions.len(), &section.splits);
        let size = (extent.high - extent.low).max(extent.radius);
        Picture::of(&tool.model, content, section, size, view, fills)
    }

    pub(super) fn of(
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
    pub(super) fn draw(&self, sheet: &mut Sheet) -> Marks {
        let marks = regions::draw(self, sheet);
        notes::draw(self, &marks, sheet);
        marks
    }

    /// Returns whether something is named and measured in this view, by its largest coordinates.
    pub(super) fn describes(&self, [d, z]: Point) -> bool {
        let near = ROUNDING_FRACTION * self.size;
        match self.part {
            Part::Whole => true,
            Part::OutsideDetail([radius, top]) => d > radius + near || z > top + near,
            Part::Detail([radius, top]) => d < radius - near && z < top - near,
        }
    }

    /// Returns whether a region is named in this view, by a point in the middle of it on the sheet. A detail names all
    /// its regions.
    pub(super) fn names(&self, middle: Point) -> bool {
        matches!(self.part, Part::Detail(_)) || self.describes(self.view.point(middle))
    }
}

/// Returns the section of a tool through its axis.
pub(super) fn meridian_section(tool: &CheckedTool, unit: f64) -> Section {
    let extent = &tool.extent;
    let height = extent.high - extent.low;
    // Odd shares, so that no side of the lattice runs along a curve.
    let low = [0.0, extent.low - 0.0213 * height];
    let high = [1.0371 * extent.radius, extent.high + 0.0197 * height];
    Section::new(tool, Plane::Meridian, [low, high], unit)
}
