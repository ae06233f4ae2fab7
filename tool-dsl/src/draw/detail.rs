//! The detail: the cutting part of a tool at a larger scale, beside the view of the whole tool.

use super::borders::Side;
use super::curves::{Curves, Plane};
use super::regions::Marks;
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, lines};
use super::stroke::Stroke;
use super::view::{View, is_outline};
use super::{Content, Part, Picture, trace};
use crate::checked::CheckedTool;
use crate::geometry::outline::Point;
use crate::model::Model;

/// The largest extent of the detail on the sheet: full width and height, in sheet units.
const MAX_EXTENT: [f64; 2] = [240.0, 360.0];
/// The cutting part is small if its height or its radius on the sheet is less than this fraction of the tool's.
const SMALL_FRACTION: f64 = 0.4;
/// What is shown above the cutting part, as fractions of its height and of its radius, whichever is more; and beside it,
/// as a fraction of its radius. Odd shares, so that no edge of the detail runs along a curve.
const MARGIN_ABOVE: [f64; 2] = [0.1527, 0.4519];
const MARGIN_BESIDE: f64 = 0.2537;
/// The scale factors of details, without powers of ten (ISO 5455, with intermediate factors).
const SCALE_FACTORS: [f64; 6] = [1.0, 2.0, 2.5, 4.0, 5.0, 8.0];
/// The distance between the views, and of the frame around the cutting part, in sheet units.
const VIEW_DISTANCE: f64 = 44.0;
const FRAME_DISTANCE: f64 = 7.0;

/// A view of the cutting part.
pub(super) struct Detail<'m> {
    picture: Picture<'m>,
    /// The height at which the detail ends.
    pub(super) top: f64,
    /// The radius of the cutting part.
    radius: f64,
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
        let CuttingPart { low, high, radius } = CuttingPart::new(whole)?;
        let [above, beside] = [MARGIN_ABOVE[0] * (high - low), MARGIN_ABOVE[1] * radius];
        let top = high + above.max(beside);
        let [_, y] = whole.view.to_sheet([0.0, top]);
        let is_small = -y < SMALL_FRACTION * whole.view.height
            || radius * whole.view.scale < SMALL_FRACTION * whole.view.half;
        if !is_small {
            return None;
        }
        let size = (top - low).max(radius);
        let unit = ((top - low) / MAX_EXTENT[1]).min(radius / 60.0);
        let mut curves = Curves::new(whole.model, &tool.extent, Plane::Meridian);
        let borders = trace(&mut curves, tool, window(low, top, radius), [unit, size]);
        let view = View::new(&borders, MAX_EXTENT);
        let factor = scale_factor(view.scale / whole.view.scale)?;
        let view = view.rescaled(factor * whole.view.scale);
        let fills = whole.fills.clone();
        let picture = Picture::of(whole.model, whole.content, (borders, size), view, fills);
        let picture = Picture { part: Part::Detail(top), ..picture };
        Some(Detail { picture, top, radius, factor })
    }

    /// Marks the detail in the whole view by a frame and a letter.
    pub(super) fn mark(&self, whole: &Picture<'_>, sheet: &mut Sheet) {
        let x = self.radius * whole.view.scale + FRAME_DISTANCE;
        let [_, y] = whole.view.to_sheet([0.0, self.top]);
        let corners = [[-x, y], [x, y], [x, FRAME_DISTANCE], [-x, FRAME_DISTANCE], [-x, y]];
        let look = format!("fill=\"none\" stroke=\"{DEFAULT_COLOUR}\" stroke-width=\".7\"");
        sheet.path(&look, &lines([&corners]));
        let letter = Look { halo: true, ..Look::plain(9.0, Anchor::Left) };
        sheet.text("A", [x + 5.0, (y + FRAME_DISTANCE) / 2.0], letter);
    }

    /// Draws the detail to the right of everything drawn so far.
    pub(super) fn draw(&self, sheet: &mut Sheet) -> Marks {
        let mut part = sheet.part();
        let marks = self.picture.draw(&mut part);
        let title = format!("A ({} : 1)", self.factor);
        let [[left, upper], _] = part.frame();
        part.text(&title, [0.0, upper - 14.0], Look::plain(9.0, Anchor::Middle));
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
        let outline = || {
            whole.borders.iter().filter(|border| is_outline(border)).flat_map(|border| {
                border.strokes.iter().map(move |stroke| (border.sides[0], stroke))
            })
        };
        let cuts = |side: Side| matches!(side, Side::Region(r) if whole.model.surfaces[whole.surface(r)].cutting);
        let high = outline()
            .filter(|(side, _)| cuts(*side))
            .map(|(_, stroke)| stroke.span()[1])
            .reduce(f64::max)?;
        let within = |stroke: &Stroke| stroke.span()[1] <= high + 1e-6 * whole.size;
        let radius = outline()
            .filter(|(_, stroke)| within(stroke))
            .map(|(_, stroke)| stroke.widest())
            .fold(0.0, f64::max);
        let low = outline().map(|(_, stroke)| stroke.span()[0]).fold(high, f64::min);
        Some(CuttingPart { low, high, radius })
    }
}

/// Returns whether a tool consists of mounted files: their surfaces have names such as `cutter.ball`.
fn is_assembly(model: &Model) -> bool {
    model.surfaces.iter().any(|surface| surface.name.contains('.'))
}

/// Returns the window of the section that a detail shows: from below the lowest point up to `top`.
///
/// The division begins at the lower corner with square cells, so the height is a multiple of the width.
fn window(low: f64, top: f64, radius: f64) -> [Point; 2] {
    let width = (1.0 + MARGIN_BESIDE) * radius;
    // By rounding alone there must not be one cell more.
    let height = (1.02 * (top - low) / width).ceil() * width * (1.0 - 1e-12);
    [[0.0, top - height], [width, top]]
}

/// Returns the largest usual scale factor up to a number, if it is at least 2.
pub(super) fn scale_factor(most: f64) -> Option<f64> {
    if most < 2.0 {
        return None;
    }
    let power = 10.0_f64.powi(most.log10().floor() as i32);
    SCALE_FACTORS.into_iter().map(|factor| factor * power).filter(|factor| *factor <= most).last()
}
