//! Draws a checked tool as SVG: the section with its regions on the right half and hatched on the left half, with
//! dimensions and names, in the style of figs. 7.3 and 7.4 of Ho (1999).
//!
//! ```text
//! plan ──section──▶ pieces ──borders──▶ lines and arcs with their neighbours ──view──▶ the sheet
//! ```
//!
//! The drawing is derived only from the plan's tree and its curves, so profiles and regions written by hand are drawn
//! the same way. Corners are computed as intersections of curves, to full precision, so the dimensions are exact. Text
//! is drawn in strokes of a built-in alphabet (`lettering`). The same tool always gives the same bytes.

mod borders;
mod colours;
mod contour;
mod curves;
mod glyphs;
mod legend;
pub mod lettering;
mod map;
mod marks;
mod notes;
mod regions;
mod section;
mod shape;
mod sheet;
mod stroke;
mod view;

use crate::checked::CheckedTool;
use crate::domain::Domain;
use crate::model::Model;
use borders::{Border, Nearness, Side};
use curves::Curves;
use section::Fineness;
use shape::Shape;
pub use sheet::TextRendering;
use sheet::{Anchor, Look, Sheet};
use view::View;

/// The content of a drawing.
struct Picture<'m> {
    model: &'m Model,
    borders: Vec<Border>,
    view: View,
    /// The regions' shapes on the sheet, in the order of the model's regions.
    shapes: Vec<Shape>,
    /// The tool's size, the scale of tolerances for rounding.
    size: f64,
}

/// Draws a tool as SVG, on a white background. The drawing has a title and needs no caption.
///
/// Returns `None` for a solid: it has no axis, so no section shows all of it.
pub fn svg(tool: &CheckedTool, lettering: TextRendering) -> Option<String> {
    if tool.model.domain == Domain::Space {
        return None;
    }
    let picture = Picture::new(tool);
    let mut sheet = Sheet::new(lettering);
    let marks = regions::draw(&picture, &mut sheet);
    notes::draw(&picture, &marks, &mut sheet);
    legend::draw(&picture, &marks, &mut sheet);
    title(tool, &mut sheet);
    let name = &tool.model.name;
    Some(sheet.finish(&match &tool.model.title {
        Some(title) => format!("{name}: {title}"),
        None => name.clone(),
    }))
}

impl<'m> Picture<'m> {
    fn new(tool: &'m CheckedTool) -> Picture<'m> {
        let (model, extent) = (&tool.model, &tool.extent);
        let height = extent.high - extent.low;
        // A lower bound on one unit of the sheet, in the tool's unit.
        let unit = (height / 500.0).min(extent.radius / 60.0);
        // Odd shares, so that no side of a cell runs along a curve.
        let low = [0.0, extent.low - 0.0213 * height];
        let high = [1.0371 * extent.radius, extent.high + 0.0197 * height];
        let mut curves = Curves::new(model, extent);
        let size = height.max(extent.radius);
        let fineness = Fineness { cell: 10.0 * unit, flat: 0.06 * unit, same: 1e-10 * size };
        let pieces = section::divide(&mut curves, &tool.plan.owner, [low, high], fineness);
        let near = Nearness { weld: 1e-9 * size, visible_length: 0.1 * unit, reach: unit };
        let borders = borders::borders(&mut curves, &pieces, near);
        let view = View::new(&borders);
        let shape = |region| {
            let mut shape = Shape::new(&borders, &view, |side| side == Side::Region(region));
            let half = view.half + 1.0;
            for y in view.seams() {
                shape.keep_off(
                    [-5.0, 0.0, 5.0].map(|shift| [[-half, y + shift], [half, y + shift]]),
                );
            }
            shape
        };
        let shapes = (0..model.regions.len()).map(shape).collect();
        Picture { model, borders, view, shapes, size }
    }

    /// Returns the index of a region's surface.
    fn surface(&self, region: usize) -> usize {
        self.model.regions[region].surface
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
    sheet.text(&format!("lengths in {unit}, z from the tip"), [low[0], y], small);
    y -= 17.0;
    for line in lines.iter().rev() {
        sheet.text(line, [low[0], y], Look::plain(8.5, Anchor::Left));
        y -= 15.0;
    }
    let large = Look { bold: true, ..Look::plain(12.5, Anchor::Left) };
    sheet.text(&model.name, [low[0], y - 5.0], large);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use crate::source::Source;

    fn tool(text: &str) -> Box<CheckedTool> {
        let compiled = compile(&Source::new("test.tool", text));
        compiled.outcome.unwrap_or_else(|refusal| panic!("{refusal:?}")).tool
    }

    /// The areas of the regions of the exact fig. 7.3 have closed forms.
    #[test]
    fn regions_have_their_areas() {
        let tool = tool(include_str!("../../../tools-library/tools/fig_7_3_exact.tool"));
        let picture = Picture::new(&tool);
        let sqrt = f64::sqrt(2.0);
        // The lines from (3, 13) and from (1, 15) to the axis.
        let spindle = 3.0 * (5.0 - 3.0 * sqrt) + 4.5 * (sqrt - 1.0);
        let taper = 10.0 - 0.5 - spindle;
        let expected = [
            12.5,
            187.0 / 6.0,
            2.0,
            28.0 / 3.0,
            spindle,
            taper,
            0.5,
            4.0,
            std::f64::consts::FRAC_PI_4,
        ];
        // The profile runs from the tip upward; the thesis lists the regions from the housing downward.
        for (region, expected) in expected.into_iter().rev().enumerate() {
            let scale = picture.view.scale;
            let area = picture.shapes[region].area() / (scale * scale);
            let name = &tool.model.regions[region].name;
            // Areas are computed from chords that are a third of a sheet unit off at most.
            assert!((area - expected).abs() < 0.03, "{name}: {area}, not {expected}");
        }
    }

    /// Asserts that at every joint as many borders of a region end as begin.
    fn closed(picture: &Picture<'_>) {
        for region in 0..picture.model.regions.len() {
            let mut open = std::collections::BTreeMap::new();
            for border in &picture.borders {
                for (k, sign) in [(0, 1), (1, -1)] {
                    if border.sides[k] == Side::Region(region) {
                        *open.entry(border.ends[0]).or_insert(0) += sign;
                        *open.entry(border.ends[1]).or_insert(0) -= sign;
                    }
                }
            }
            let name = &picture.model.regions[region].name;
            assert!(open.values().all(|count| *count == 0), "{name} is open: {open:?}");
            assert!(!picture.shapes[region].is_empty(), "{name} is nowhere");
        }
    }

    /// The regions of all these tools meet without a gap, whatever curves bound them.
    #[test]
    fn regions_are_closed() {
        let profiles = [
            "start (0, 0); line to (10.1, 0), (10.5, 0.4), (10.5, 9), (5, 9), (5, 29), (6, 30),
             (6, 74), (0, 74) as a;",
            "start (0, 0); line to (16, 0), (16, 12), (31.5, 12), (31.5, 20), (26.5, 22.5),
             (26.5, 27.5), (31.5, 30), (31.5, 38), (0, 38) as a;",
            "start (0, 0); arc to (5, 1) radius 20 as a; arc to (5, 13) radius 40 as b;
             line to (4, 15), (4, 40), (0, 40) as c;",
            "start (0, 0); line to (4, 0), (4, 20) as a; arc to (8, 24) radius 4 concave as b;
             line to (12, 24), (12, 32), (0, 32) as c;",
            "start (0, 0); arc to (3, 3) center (0, 3) as a; arc to (1.8, 5.4) center (0, 3) as a;
             line to (1.8, 30), (0, 30) as b;",
        ];
        for segments in profiles {
            let text = format!("tool T {{ units mm; profile {{ {segments} }} }}");
            closed(&Picture::new(&tool(&text)));
        }
        for text in [
            include_str!("../../../tools-library/tools/half_sphere_cylinder.tool"),
            include_str!("../../../tools-library/tools/fig_7_3.tool"),
            include_str!("../../../tools-library/tools/unit_sphere.tool"),
        ] {
            closed(&Picture::new(&tool(text)));
        }
    }

    /// The surface is connected: from the axis, from joint to joint, back to the axis.
    #[test]
    fn a_drawn_profile_matches_its_outline() {
        let text = r#"tool Slot "of a profile with an undercut and a fillet" {
            units mm;
            profile {
                start (0, 0);
                line to (6, 0)                          as face cutting;
                arc  to (7, 1) center (6, 1)            as corner cutting;
                line to (7, 4), (3, 4), (3, 8)          as side cutting;
                arc  to (5, 10) radius 2 concave        as neck;
                line to (9, 10), (9, 12), (0, 12)       as neck;
            }
        }"#;
        let tool = tool(text);
        let picture = Picture::new(&tool);
        let outline: Vec<&Border> =
            picture.borders.iter().filter(|border| view::is_outline(border)).collect();
        let mut points: Vec<[f64; 2]> =
            outline.iter().flat_map(|border| &border.strokes).map(|stroke| stroke.from).collect();
        points.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
        let expected = [
            [0.0, 0.0],
            [6.0, 0.0],
            [7.0, 1.0],
            [3.0, 4.0],
            [7.0, 4.0],
            [3.0, 8.0],
            [5.0, 10.0],
            [9.0, 10.0],
            [9.0, 12.0],
        ];
        assert_eq!(points.len(), expected.len(), "{points:?}");
        for (point, expected) in points.iter().zip(expected) {
            let distance = (point[0] - expected[0]).hypot(point[1] - expected[1]);
            assert!(distance < 1e-9, "{point:?}, not {expected:?}");
        }
        let arcs: Vec<f64> = outline
            .iter()
            .filter(|border| border.exact)
            .flat_map(|border| &border.strokes)
            .filter_map(|stroke| stroke.circle.map(|(_, radius)| radius))
            .collect();
        assert_eq!(arcs.len(), 2);
        assert!(arcs.iter().all(|r| (r - 1.0).abs() < 1e-9 || (r - 2.0).abs() < 1e-9), "{arcs:?}");
    }
}
