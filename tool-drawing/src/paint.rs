//! Paints a section: areas, hatching, borders between regions, surfaces, break lines, and the axis.
//!
//! The colours can be told apart with colour vision deficiency: Paul Tol's "light" scheme for areas with dark text on
//! them, and his "bright" scheme for more (SRON/EPS/TN/09-002, 2021), reds for cutting surfaces, dark colours for the
//! others.

use super::section::{Polygon, Split};
use super::shape::Shape;
use super::sheet::{Sheet, data, lines};
use super::stroke::Stroke;
use super::{Content, Picture};
use std::f64::consts::PI;
use touchoff_dsl::model::Model;
use touchoff_plane::Point;

/// The look of hatch lines, and their distance in sheet units.
const HATCH: &str = "fill=\"none\" stroke=\"#c3c9d2\" stroke-width=\".6\"";
const HATCH_STEP: f64 = 9.0;
/// The look of hatched areas, and of areas without regions.
const HATCHED_AREA: &str = "fill=\"#f4f5f7\" fill-rule=\"evenodd\"";
const PLAIN_AREA: &str = "fill=\"#e3e9f1\" fill-rule=\"evenodd\"";
/// The looks of borders between regions, and of the axis.
pub(super) const SPLIT: &str = "stroke=\"#3f4650\" stroke-width=\".9\" stroke-dasharray=\"5 3\"";
pub(super) const AXIS: &str =
    "stroke=\"#22272e\" stroke-width=\".8\" stroke-dasharray=\"12 3 2 3\"";
/// The height of a break line's waves, in sheet units.
const WAVE_HEIGHT: f64 = 2.5;

/// Draws the areas of a tool: those of the regions on the right half, and the hatched section on the left half.
pub(super) fn halves(picture: &Picture<'_>, sheet: &mut Sheet) {
    match picture.content {
        Content::Regions => regions(picture, sheet),
        Content::Outline => sheet.path(PLAIN_AREA, &areas(&material(picture).polygons)),
    }
    hatched(picture, -1.0, sheet);
}

/// Draws the area of a solid's section: regions, or hatched.
pub(super) fn whole(picture: &Picture<'_>, sheet: &mut Sheet) {
    match picture.content {
        Content::Regions => regions(picture, sheet),
        Content::Outline => hatched(picture, 1.0, sheet),
    }
}

/// Draws the hatched material, on the left half if `side` is -1.
fn hatched(picture: &Picture<'_>, side: f64, sheet: &mut Sheet) {
    let material = material(picture);
    let mut polygons = material.polygons.clone();
    let mut hatches = material.hatched(HATCH_STEP);
    for p in polygons.iter_mut().flatten().chain(hatches.as_flattened_mut()) {
        p[0] *= side;
    }
    sheet.path(HATCHED_AREA, &areas(&polygons));
    sheet.path(HATCH, &lines(hatches));
}

/// Returns the area of all regions.
pub(super) fn material(picture: &Picture<'_>) -> Shape {
    Shape::new(&picture.section.material, &picture.view)
}

/// Returns the path data of polygons.
fn areas(polygons: &[Polygon]) -> String {
    let mut data = String::new();
    for polygon in polygons {
        data.push_str(&lines([polygon]));
        data.push('z');
    }
    data
}

/// Draws the regions' areas.
fn regions(picture: &Picture<'_>, sheet: &mut Sheet) {
    // A thin outline in the area's own colour hides the seams between areas.
    sheet.group("fill-rule=\"evenodd\" stroke-width=\".6\" opacity=\".62\"", |sheet| {
        for (shape, colour) in picture.shapes.iter().zip(&picture.fills) {
            let look = format!("fill=\"{colour}\" stroke=\"{colour}\"");
            sheet.path(&look, &areas(&shape.polygons));
        }
    });
}

/// Draws the curves between regions as dashed lines. Returns whether there are any.
pub(super) fn splits(picture: &Picture<'_>, sheet: &mut Sheet) -> bool {
    let mut rows: Vec<Vec<Point>> = Vec::new();
    for Split { line, .. } in &picture.section.splits {
        rows.push(line.iter().map(|p| picture.view.to_sheet(*p)).collect());
    }
    sheet.path(&format!("fill=\"none\" {SPLIT}"), &lines(&rows));
    !rows.is_empty()
}

/// Draws the surfaces, cutting surfaces on top. Those of a tool are drawn on both halves.
pub(super) fn outline(picture: &Picture<'_>, both_halves: bool, sheet: &mut Sheet) {
    let mut surfaces: Vec<(usize, String)> =
        surface_looks(picture.model).into_iter().enumerate().collect();
    surfaces.sort_by_key(|(surface, _)| picture.model.surfaces[*surface].cutting);
    let look = "fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
    sheet.group(look, |sheet| {
        for (surface, look) in surfaces {
            let mut strokes: Vec<Stroke> = Vec::new();
            for edge in picture.section.edges.iter().filter(|edge| edge.surface == surface) {
                strokes.extend(edge.strokes.iter().map(|stroke| picture.view.stroke(stroke)));
            }
            if both_halves {
                strokes.extend(strokes.clone().into_iter().map(Stroke::mirrored));
            }
            sheet.path(&look, &data(&strokes));
        }
    });
}

/// Draws the break lines where a long cylinder is shortened.
pub(super) fn seams(picture: &Picture<'_>, sheet: &mut Sheet) {
    for y in picture.view.seams() {
        let [above, below] = [y - 3.0, y + 3.0].map(|y| wave(0.0, picture.view.half + 7.0, y));
        broken(&above, &below, &[&above, &below], sheet);
    }
}

/// Draws the break line at the upper edge of a detail.
pub(super) fn upper_edge(picture: &Picture<'_>, sheet: &mut Sheet) {
    // The whole wave lies in the material.
    let [above, edge] = [-2.0 * WAVE_HEIGHT, WAVE_HEIGHT]
        .map(|y| wave(0.0, picture.view.half + 7.0, y - picture.view.height));
    broken(&above, &edge, &[&edge], sheet);
}

/// Returns one wave about a point, to half its width on both sides.
pub(super) fn wave(x: f64, half: f64, y: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for k in 0..=24 {
        let share = f64::from(k) / 12.0 - 1.0;
        points.push([x + share * half, y + WAVE_HEIGHT * (share * PI).sin()]);
    }
    points
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
    sheet.path(&format!("fill=\"none\" {AXIS}"), &lines([&row]));
    row.into_iter().for_each(|p| sheet.reach(p));
}

const REGION_FILLS: [&str; 9] = [
    "#77aadd", "#eedd88", "#ffaabb", "#99ddff", "#44bb99", "#ee8866", "#bbcc33", "#dddddd",
    "#aaaa00",
];
const MORE_REGION_FILLS: [&str; 7] =
    ["#4477aa", "#ccbb44", "#ee6677", "#66ccee", "#228833", "#aa3377", "#bbbbbb"];
const CUTTING_STROKES: [&str; 4] = ["#c1121f", "#e8590c", "#a61e6b", "#ff5d5d"];
const NON_CUTTING_STROKES: [&str; 8] =
    ["#1f2933", "#1d5fa8", "#6b4a1f", "#2f6f4f", "#6d4aa5", "#0e8a93", "#8a7a00", "#7f8794"];

/// Returns a colour for each region, different for neighbours as far as the palette allows.
pub(super) fn area_colours(regions: usize, splits: &[Split]) -> Vec<&'static str> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut used = [0; REGION_FILLS.len()];
    for region in 0..regions {
        let mut is_near = [false; REGION_FILLS.len()];
        for Split { regions: [a, b], .. } in splits {
            let (first, last) = (a.min(b), a.max(b));
            if *last == region && *first < region {
                is_near[chosen[*first]] = true;
            }
        }
        // The least used colour, so that the palette is used evenly.
        let free = (0..REGION_FILLS.len()).filter(|colour| !is_near[*colour]);
        let colour = free.min_by_key(|colour| used[*colour]);
        // Neighbours may have all of them.
        let colour = colour.unwrap_or(region % REGION_FILLS.len());
        used[colour] += 1;
        chosen.push(colour);
    }
    chosen.into_iter().map(|colour| REGION_FILLS[colour]).collect()
}

/// Returns a colour for each region, different for all as far as both palettes allow.
pub(super) fn distinct_area_colours(regions: usize) -> Vec<&'static str> {
    REGION_FILLS.into_iter().chain(MORE_REGION_FILLS).cycle().take(regions).collect()
}

/// Returns the colour of each surface.
pub(super) fn surface_colours(model: &Model) -> Vec<&'static str> {
    let (mut cutting, mut others) = (0, 0);
    let mut colours = Vec::new();
    for surface in &model.surfaces {
        let (palette, used) = if surface.cutting {
            (&CUTTING_STROKES[..], &mut cutting)
        } else {
            (&NON_CUTTING_STROKES[..], &mut others)
        };
        colours.push(palette[*used % palette.len()]);
        *used += 1;
    }
    colours
}

/// Returns the look of each surface's lines.
pub(super) fn surface_looks(model: &Model) -> Vec<String> {
    let mut looks = Vec::new();
    for (surface, colour) in model.surfaces.iter().zip(surface_colours(model)) {
        let wide = if surface.cutting { 3 } else { 2 };
        looks.push(format!("stroke=\"{colour}\" stroke-width=\"{wide}\""));
    }
    looks
}
