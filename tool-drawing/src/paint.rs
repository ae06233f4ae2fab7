//! Paints a section: areas, hatching, borders between regions, surfaces, break lines, and the axis.

use super::borders::Side;
use super::colours;
use super::shape::Shape;
use super::sheet::{Sheet, data, lines};
use super::stroke::Stroke;
use super::view::{is_outline, mirrored};
use super::{Content, Picture};
use tool_dsl::vector::Point;

/// The look of hatch lines, and their distance in sheet units.
const HATCH: &str = "fill=\"none\" stroke=\"#c3c9d2\" stroke-width=\".6\"";
const HATCH_STEP: f64 = 9.0;
/// The look of hatched areas, and of areas without regions.
const HATCHED_AREA: &str = "fill=\"#f4f5f7\" fill-rule=\"evenodd\"";
const PLAIN_AREA: &str = "fill=\"#e3e9f1\" fill-rule=\"evenodd\"";
/// The height of a break line's waves, in sheet units.
const WAVE_HEIGHT: f64 = 2.5;

/// Draws the areas of a tool: those of the regions on the right half, and the hatched section on the left half.
pub(super) fn halves(picture: &Picture<'_>, sheet: &mut Sheet) {
    let material = material(picture);
    match picture.content {
        Content::Regions => regions(picture, sheet),
        Content::Outline => sheet.path(PLAIN_AREA, &data(material.loops.iter().flatten())),
    }
    let mirrored_strokes: Vec<Stroke> = material.loops.iter().flatten().map(mirrored).collect();
    sheet.path(HATCHED_AREA, &data(&mirrored_strokes));
    // The shape is the right half, so its hatch lines are mirrored for the left half.
    let hatches = material.hatched(HATCH_STEP);
    let mirrored = hatches.iter().map(|row| row.map(|[x, y]| [-x, y]));
    sheet.path(HATCH, &lines(mirrored));
}

/// Draws the area of a solid's section: regions, or hatched.
pub(super) fn whole(picture: &Picture<'_>, sheet: &mut Sheet) {
    match picture.content {
        Content::Regions => regions(picture, sheet),
        Content::Outline => {
            let material = material(picture);
            sheet.path(HATCHED_AREA, &data(material.loops.iter().flatten()));
            sheet.path(HATCH, &lines(material.hatched(HATCH_STEP)));
        }
    }
}

/// Returns the area of all regions.
pub(super) fn material(picture: &Picture<'_>) -> Shape {
    Shape::new(&picture.borders, &picture.view, |side| matches!(side, Side::Region(_)))
}

/// Draws the regions' areas.
fn regions(picture: &Picture<'_>, sheet: &mut Sheet) {
    // A thin outline in the area's own colour hides the seams between areas.
    sheet.group("fill-rule=\"evenodd\" stroke-width=\".6\" opacity=\".62\"", |sheet| {
        for (shape, colour) in picture.shapes.iter().zip(&picture.fills) {
            let all = data(shape.loops.iter().flatten());
            sheet.path(&format!("fill=\"{colour}\" stroke=\"{colour}\""), &all);
        }
    });
}

/// Draws the curves between regions as dashed lines. Returns whether there are any.
pub(super) fn splits(picture: &Picture<'_>, sheet: &mut Sheet) -> bool {
    let between: Vec<Stroke> = picture
        .borders
        .iter()
        .filter(|border| matches!(border.sides, [Side::Region(_), Side::Region(_)]))
        .flat_map(|border| border.strokes.iter().map(|stroke| picture.view.stroke(stroke)))
        .collect();
    let look = "fill=\"none\" stroke=\"#3f4650\" stroke-width=\".9\" stroke-dasharray=\"5 3\"";
    sheet.path(look, &data(&between));
    !between.is_empty()
}

/// Draws the surfaces, cutting surfaces on top. Those of a tool are drawn on both halves.
pub(super) fn outline(picture: &Picture<'_>, both_halves: bool, sheet: &mut Sheet) {
    let colours = colours::surfaces(picture.model);
    let look = "fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
    sheet.group(look, |sheet| {
        for cutting in [false, true] {
            for (index, surface) in picture.model.surfaces.iter().enumerate() {
                if surface.cutting != cutting {
                    continue;
                }
                let mut strokes: Vec<Stroke> = picture
                    .borders
                    .iter()
                    .filter(|border| is_outline(border))
                    .filter(|border| {
                        matches!(border.sides[0], Side::Region(r) if picture.surface(r) == index)
                    })
                    .flat_map(|border| border.strokes.iter().map(|s| picture.view.stroke(s)))
                    .collect();
                if both_halves {
                    let mirrored_strokes: Vec<Stroke> = strokes.iter().map(mirrored).collect();
                    strokes.extend(mirrored_strokes);
                }
                let (colour, wide) = (colours[index], if cutting { 3.0 } else { 2.0 });
                sheet
                    .path(&format!("stroke=\"{colour}\" stroke-width=\"{wide}\""), &data(&strokes));
            }
        }
    });
}

/// Draws the break lines where a long cylinder is shortened.
pub(super) fn seams(picture: &Picture<'_>, sheet: &mut Sheet) {
    for y in picture.view.seams() {
        let (above, below) = (wave(picture, y - 3.0), wave(picture, y + 3.0));
        broken(&above, &below, &[&above, &below], sheet);
    }
}

/// Draws the break line at the upper edge of a detail.
pub(super) fn upper_edge(picture: &Picture<'_>, sheet: &mut Sheet) {
    // The whole wave lies in the material.
    let edge = wave(picture, WAVE_HEIGHT - picture.view.height);
    let above = wave(picture, -2.0 * WAVE_HEIGHT - picture.view.height);
    broken(&above, &edge, &[&edge], sheet);
}

/// Returns one wave across the section, somewhat wider than it.
fn wave(picture: &Picture<'_>, y: f64) -> Vec<Point> {
    let half = picture.view.half + 7.0;
    (0..=24)
        .map(|k| {
            let share = f64::from(k) / 12.0 - 1.0;
            [share * half, y + WAVE_HEIGHT * (share * std::f64::consts::PI).sin()]
        })
        .collect()
}

/// Clears the band between two waves, and draws break lines.
fn broken(above: &[Point], below: &[Point], visible: &[&[Point]], sheet: &mut Sheet) {
    let band: Vec<Point> = above.iter().chain(below.iter().rev()).copied().collect();
    sheet.path("fill=\"#fff\"", &lines([&band]));
    sheet.path("fill=\"none\" stroke=\"#6b7280\" stroke-width=\".9\"", &lines(visible));
}

/// Draws the axis, slightly longer than the tool.
pub(super) fn axis_line(picture: &Picture<'_>, sheet: &mut Sheet) {
    let row = [[0.0, 12.0], [0.0, -picture.view.height - 12.0]];
    let look = "fill=\"none\" stroke=\"#22272e\" stroke-width=\".8\" stroke-dasharray=\"12 3 2 3\"";
    sheet.path(look, &lines([&row]));
    row.into_iter().for_each(|p| sheet.reach(p));
}
