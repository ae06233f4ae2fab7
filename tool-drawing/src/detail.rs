//! The detail: the cutting part of a tool at a larger scale, beside the view of the whole tool.

use super::picture::{Part, Picture, meridian_section};
use super::regions::Marks;
use super::section::clipped_stroke;
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, lines};
use super::view::View;
use super::{Content, ROUNDING_FRACTION};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::model::Model;
use touchoff_plane::Point;

/// The largest extent of the detail on the sheet: full width and height, in sheet units.
const MAX_EXTENT: [f64; 2] = [240.0, 500.0];
/// The cutting part is small if its height or its radius on the sheet is less than this fraction of the tool's.
const SMALL_FRACTION: f64 = 0.4;
/// The margin above the cutting part, as fractions of its height and of its radius, whichever is more; and beside it,
/// as a fraction of its radius. Odd shares, so that no edge of the detail runs along a curve.
const MARGIN_ABOVE: [f64; 2] = [0.1527, 0.4519];
const MARGIN_BESIDE: f64 = 0.2537;
/// The largest radius that is shown above the cutting part, relative to its own.
const MAX_WIDENING: f64 = 2.0;
/// The scale factors of details, without powers of ten (ISO 5455, with intermediate factors).
const SCALE_FACTORS: [f64; 6] = [1.0, 2.0, 2.5, 4.0, 5.0, 8.0];
/// The distance between the views, and of the frame around the cutting part, in sheet units.
const VIEW_DISTANCE: f64 = 44.0;
const FRAME_DISTANCE: f64 = 7.0;
/// The height of the detail's letter, in sheet units.
const LETTER_SIZE: f64 = 9.0;

/// A view of the cutting part.
pub(super) struct Detail<'m> {
    picture: Picture<'m>,
    /// The distance from the axis and the height at which the detail ends.
    pub(super) corner: Point,
    cutting: CuttingPart,
    /// The scale relative to the whole view.
    factor: f64,
}

impl<'m> Detail<'m> {
    /// Returns the detail of a tool whose cutting part is small in the whole view.
    pub(super) fn new(tool: &'m CheckedTool, whole: &Picture<'m>) -> Option<Detail<'m>> {
        // The regions of a single file are few, and their drawing shows how they meet.
        if whole.content == Content::Regions && !is_assembly(whole.model) {
            return None;
        }
        let cutting = CuttingPart::new(whole)?;
        let corner @ [width, top] = cutting.corner(whole);
        let [_, y] = whole.view.to_sheet(corner);
        let is_small = -y < SMALL_FRACTION * whole.view.height
            || cutting.radius * whole.view.scale < SMALL_FRACTION * whole.view.half;
        if !is_small {
            return None;
        }
        let height = top - cutting.low;
        let unit = (height / MAX_EXTENT[1]).min(cutting.radius / 60.0);
        let section = meridian_section(tool, unit).clipped(corner);
        let view = View::new(&section, MAX_EXTENT);
        let factor = scale_factor(view.scale / whole.view.scale)?;
        let view = view.rescaled(factor * whole.view.scale);
        let fills = whole.fills.clone();
        let size = height.max(width);
        let mut picture = Picture::of(whole.model, whole.content, section, size, view, fills);
        picture.part = Part::Detail(corner);
        let View { half, height, .. } = picture.view;
        // No name and no arrow lies on the break line.
        let edge = [4.0, 8.0].map(|y| [[-half, y - height], [half, y - height]]);
        picture.shapes.iter_mut().for_each(|shape| shape.keep_off(edge));
        Some(Detail { picture, corner, cutting, factor })
    }

    /// Marks the detail in the whole view by a frame and a letter.
    pub(super) fn mark(&self, whole: &Picture<'_>, sheet: &mut Sheet) {
        let [right, top] = whole.view.to_sheet(self.corner);
        let [outermost, end] = whole.view.to_sheet([self.cutting.radius, self.cutting.high]);
        // The frame leaves room for the letter beside the dimension line.
        let widest = whole.view.half + FRAME_DISTANCE;
        let right = right.max(outermost + FRAME_DISTANCE).min(widest);
        let bottom = FRAME_DISTANCE;
        let corners =
            [[-right, top], [right, top], [right, bottom], [-right, bottom], [-right, top]];
        let look = format!("fill=\"none\" stroke=\"{DEFAULT_COLOUR}\" stroke-width=\".7\"");
        sheet.path(&look, &lines([&corners]));
        // Below a shoulder where the cutting part ends, and above the height of the tip.
        let y = (end + LETTER_SIZE).min(-1.2 * LETTER_SIZE);
        let letter = Look { halo: true, ..Look::plain(LETTER_SIZE, Anchor::Left) };
        sheet.text("A", [right + 5.0, y], letter);
    }

    /// Draws the detail to the right of everything drawn so far.
    pub(super) fn draw(&self, sheet: &mut Sheet) -> Marks {
        let mut part = Sheet::new(sheet.lettering);
        let marks = self.picture.draw(&mut part);
        let title = format!("A ({} : 1)", self.factor);
        let [[left, upper], _] = part.frame();
        part.text(&title, [0.0, upper - 14.0], Look::plain(LETTER_SIZE, Anchor::Middle));
        let [_, [right, _]] = sheet.frame();
        sheet.place(&part, [right + VIEW_DISTANCE - left, 0.0]);
        marks
    }
}

/// The part of a tool from its lowest point up to the end of its cutting surfaces.
struct CuttingPart {
    low: f64,
    high: f64,
    radius: f64,
}

impl CuttingPart {
    fn new(whole: &Picture<'_>) -> Option<CuttingPart> {
        let (mut low, mut high, mut radius) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
        for edge in &whole.section.edges {
            for stroke in &edge.strokes {
                // From the tool's lowest point, even if that does not cut.
                low = low.min(stroke.span()[0]);
                if whole.model.surfaces[edge.surface].cutting {
                    high = high.max(stroke.span()[1]);
                    radius = radius.max(stroke.widest());
                }
            }
        }
        let radius = radius.max(radius_below(whole, high));
        high.is_finite().then_some(CuttingPart { low, high, radius })
    }

    /// Returns the distance from the axis and the height at which the detail ends.
    fn corner(&self, whole: &Picture<'_>) -> Point {
        let above = MARGIN_ABOVE[0] * (self.high - self.low);
        let top = self.high + above.max(MARGIN_ABOVE[1] * self.radius);
        // A cone above the cutting part is shown, a shoulder is cut off.
        let widest = radius_below(whole, top);
        let shown = if widest < MAX_WIDENING * self.radius { widest } else { self.radius };
        [(1.0 + MARGIN_BESIDE) * shown, top]
    }
}

/// Returns the largest radius of the tool below a height.
fn radius_below(whole: &Picture<'_>, top: f64) -> f64 {
    let near = ROUNDING_FRACTION * whole.size;
    let mut radius = 0.0f64;
    for stroke in whole.section.surface().filter(|stroke| stroke.span()[0] < top - near) {
        for part in clipped_stroke(stroke, [f64::INFINITY, top + near]) {
            radius = radius.max(part.widest());
        }
    }
    radius
}

/// Returns whether a tool consists of mounted files: their surfaces have names such as `cutter.ball`.
fn is_assembly(model: &Model) -> bool {
    model.surfaces.iter().any(|surface| surface.name.contains('.'))
}

/// Returns the largest usual scale factor up to a number, if it is at least 2.
pub(super) fn scale_factor(most: f64) -> Option<f64> {
    if most < 2.0 {
        return None;
    }
    let power = 10.0_f64.powi(most.log10().floor() as i32);
    SCALE_FACTORS.into_iter().map(|factor| factor * power).rfind(|factor| *factor <= most)
}
