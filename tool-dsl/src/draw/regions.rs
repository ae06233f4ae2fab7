//! Draws the section: regions, surfaces, splitting curves, directions, singular points.

use super::Picture;
use super::borders::Side;
use super::colours;
use super::lettering::width;
use super::marks::{Arrow, Directions, head};
use super::shape::{Frame, Shape};
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, data, lines};
use super::stroke::Stroke;
use super::view::{is_outline, mirrored};
use crate::geometry::outline::Point;

/// Results of drawing the section that the notes and the legend need.
pub(super) struct Marks {
    /// Regions whose name does not fit inside, each with a point in it.
    pub(super) unnamed: Vec<(usize, Point)>,
    /// Points on the sheet at which directions are undefined.
    pub(super) singular: Vec<Point>,
    /// True if any region has a radial direction next to the axis; on the axis, there is none.
    pub(super) axis: bool,
    /// True if there are borders between regions.
    pub(super) splits: bool,
}

/// Text sizes to try for a region's name, largest first.
const TEXT_SIZES: [f64; 3] = [8.5, 7.5, 6.5];
/// The radius of the circles around singular points.
const SINGULAR_POINT_RADIUS: f64 = 4.0;

/// Draws the section about the axis.
pub(super) fn draw(picture: &Picture<'_>, sheet: &mut Sheet) -> Marks {
    let view = &picture.view;
    let mut directions = Directions::new(picture.model);
    let singular = singular(picture, &mut directions);
    let rings: Vec<Frame> = singular
        .iter()
        .map(|[x, y]| {
            [
                [x - SINGULAR_POINT_RADIUS, y - SINGULAR_POINT_RADIUS],
                [x + SINGULAR_POINT_RADIUS, y + SINGULAR_POINT_RADIUS],
            ]
        })
        .collect();
    areas(picture, sheet);
    let splits = splits(picture, sheet);
    outline(picture, sheet);
    seams(picture, sheet);
    axis_line(picture, sheet);
    let (mut arrows, mut unnamed) = (Vec::new(), Vec::new());
    for (region, shape) in picture.shapes.iter().enumerate() {
        if shape.is_empty() {
            continue;
        }
        let mut draw = |around_frames: &[Frame]| {
            let taken: Vec<Frame> = rings.iter().chain(around_frames).copied().collect();
            directions.arrows(region, shape, view, &taken)
        };
        let (mut place, _) = shape.pole(1.0);
        let dot = [[place[0] - 2.0, place[1] - 2.0], [place[0] + 2.0, place[1] + 2.0]];
        // A name that leaves no room for an arrow is written outside, if that helps.
        let name = name(picture, region, shape, &rings);
        let mut own = draw(&[name.as_ref().map_or(dot, |name| name.frame)]);
        let mut outside = name.is_none();
        if own.is_empty() && !outside {
            own = draw(&[dot]);
            outside = !own.is_empty();
        }
        if own.is_empty() && outside {
            // The leader begins at the arrow's tail.
            own = draw(&[]);
            place = own.first().map_or(place, |arrow| arrow[0]);
        }
        match name.filter(|_| !outside) {
            Some(Name { size, at, .. }) => {
                let text = &picture.model.regions[region].name;
                sheet.text(text, at, Look::plain(size, Anchor::Middle));
            }
            None => unnamed.push((region, place)),
        }
        arrows.extend(own);
    }
    draw_arrows(&arrows, sheet);
    sheet.group(&format!("fill=\"#fff\" stroke=\"{DEFAULT_COLOUR}\""), |sheet| {
        singular.iter().for_each(|p| sheet.ring(*p, SINGULAR_POINT_RADIUS));
    });
    sheet.group(&format!("fill=\"{DEFAULT_COLOUR}\""), |sheet| {
        singular.iter().for_each(|p| sheet.ring(*p, 1.1));
    });
    let axis = axis(picture, &mut directions);
    for corner in [[-view.half, -view.height], [view.half, 0.0]] {
        sheet.reach(corner);
    }
    Marks { unnamed, singular, axis, splits }
}

/// Draws the regions' areas on the right half and the hatched section on the left half.
fn areas(picture: &Picture<'_>, sheet: &mut Sheet) {
    let colours = colours::areas(picture.shapes.len(), &picture.borders);
    // A thin outline in the area's own colour hides the seams between areas.
    sheet.group("fill-rule=\"evenodd\" stroke-width=\".6\" opacity=\".62\"", |sheet| {
        for (shape, colour) in picture.shapes.iter().zip(colours) {
            let all = data(shape.loops.iter().flatten());
            sheet.path(&format!("fill=\"{colour}\" stroke=\"{colour}\""), &all);
        }
    });
    let solid = Shape::new(&picture.borders, &picture.view, |side| matches!(side, Side::Region(_)));
    let mirrored_strokes: Vec<Stroke> = solid.loops.iter().flatten().map(mirrored).collect();
    sheet.path("fill=\"#f4f5f7\" fill-rule=\"evenodd\"", &data(&mirrored_strokes));
    // The shape is the right half, so its hatch lines are mirrored for the left half.
    let hatches = solid.hatched(9.0);
    let mirrored = hatches.iter().map(|row| row.map(|[x, y]| [-x, y]));
    sheet.path("fill=\"none\" stroke=\"#c3c9d2\" stroke-width=\".6\"", &lines(mirrored));
}

/// Draws the curves between regions as dashed lines. Returns whether there are any.
fn splits(picture: &Picture<'_>, sheet: &mut Sheet) -> bool {
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

/// Draws the surfaces on both halves, cutting surfaces on top.
fn outline(picture: &Picture<'_>, sheet: &mut Sheet) {
    let colours = colours::surfaces(picture.model);
    let look = "fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
    sheet.group(look, |sheet| {
        for cutting in [false, true] {
            for (surface, around_frames) in picture.model.surfaces.iter().enumerate() {
                if around_frames.cutting != cutting {
                    continue;
                }
                let right: Vec<Stroke> = picture
                    .borders
                    .iter()
                    .filter(|border| is_outline(border))
                    .filter(|border| {
                        matches!(border.sides[0], Side::Region(r) if picture.surface(r) == surface)
                    })
                    .flat_map(|border| border.strokes.iter().map(|s| picture.view.stroke(s)))
                    .collect();
                let mirrored_strokes: Vec<Stroke> = right.iter().map(mirrored).collect();
                let all = data(right.iter().chain(&mirrored_strokes));
                let (colour, wide) = (colours[surface], if cutting { 3.0 } else { 2.0 });
                sheet.path(&format!("stroke=\"{colour}\" stroke-width=\"{wide}\""), &all);
            }
        }
    });
}

/// Draws the break lines where a long cylinder is shortened.
fn seams(picture: &Picture<'_>, sheet: &mut Sheet) {
    let half = picture.view.half + 7.0;
    for y in picture.view.seams() {
        let wave = |shift: f64| -> Vec<Point> {
            (0..=24)
                .map(|k| {
                    let share = f64::from(k) / 12.0 - 1.0;
                    [share * half, y + shift + 2.5 * (share * std::f64::consts::PI).sin()]
                })
                .collect()
        };
        let (above, below) = (wave(-3.0), wave(3.0));
        let band: Vec<Point> = above.iter().chain(below.iter().rev()).copied().collect();
        sheet.path("fill=\"#fff\"", &lines([&band]));
        sheet
            .path("fill=\"none\" stroke=\"#6b7280\" stroke-width=\".9\"", &lines([&above, &below]));
    }
}

/// Draws the axis, slightly longer than the tool.
fn axis_line(picture: &Picture<'_>, sheet: &mut Sheet) {
    let row = [[0.0, 12.0], [0.0, -picture.view.height - 12.0]];
    let look = "fill=\"none\" stroke=\"#22272e\" stroke-width=\".8\" stroke-dasharray=\"12 3 2 3\"";
    sheet.path(look, &lines([&row]));
    row.into_iter().for_each(|p| sheet.reach(p));
}

/// A region's name on the sheet: text size, position and bounding box.
struct Name {
    size: f64,
    at: Point,
    frame: Frame,
}

/// Returns a position for a region's name inside the region, if there is one.
fn name(picture: &Picture<'_>, region: usize, shape: &Shape, rings: &[Frame]) -> Option<Name> {
    let text = &picture.model.regions[region].name;
    let across = TEXT_SIZES[1] / width(text, TEXT_SIZES[1]).max(TEXT_SIZES[1]);
    let (pole, _) = shape.pole(across);
    // Shifted positions are tried too, to avoid the circles of singular points.
    let tries =
        TEXT_SIZES.into_iter().flat_map(|size| [0.0, 9.0, -9.0, 16.0, -16.0].map(|s| (size, s)));
    tries
        .map(|(size, shift)| {
            let (wide, tall) = (width(text, size) / 2.0 + 3.0, size / 2.0 + 3.0);
            let [x, y] = [pole[0], pole[1] + shift];
            Name { size, at: [x, y], frame: [[x - wide, y - tall], [x + wide, y + tall]] }
        })
        .find(|Name { frame, .. }| {
            let meets =
                |ring: &Frame| (0..2).all(|k| ring[0][k] < frame[1][k] && ring[1][k] > frame[0][k]);
            shape.contains(*frame) && !rings.iter().any(meets)
        })
}

fn draw_arrows(arrows: &[Arrow], sheet: &mut Sheet) {
    sheet.group("stroke=\"#2b3440\" stroke-width=\"1\" fill=\"#2b3440\"", |sheet| {
        sheet.path("fill=\"none\"", &lines(arrows));
        let heads: Vec<[Point; 4]> = arrows
            .iter()
            .map(|arrow| {
                let [a, b, c] = head(*arrow, 5.0);
                [a, b, c, a]
            })
            .collect();
        sheet.path("stroke=\"none\"", &lines(&heads));
    });
}

/// Returns the isolated points at which regions' directions are undefined, without duplicates. The axis is handled
/// separately.
fn singular(picture: &Picture<'_>, directions: &mut Directions<'_>) -> Vec<Point> {
    let mut found: Vec<Point> = Vec::new();
    for (region, shape) in picture.shapes.iter().enumerate() {
        let Some(focus) =
            (!shape.is_empty()).then(|| directions.focus(region, shape, &picture.view)).flatten()
        else {
            continue;
        };
        let p = picture.view.to_sheet(focus);
        let near = |q: &Point| (p[0] - q[0]).hypot(p[1] - q[1]) < 0.5;
        if !found.iter().any(near) {
            found.push(p);
        }
    }
    found
}

/// Returns whether directions next to the axis have a radial component.
fn axis(picture: &Picture<'_>, directions: &mut Directions<'_>) -> bool {
    picture.borders.iter().any(|border| {
        let ([Side::Region(region), Side::Axis], Some(stroke)) =
            (border.sides, border.strokes.first())
        else {
            return false;
        };
        let [_, z] = stroke.at(0.5);
        let direction = directions.at(region, [1e-6 * picture.size, z]);
        // A direction toward a centre on the axis points along the axis, as seen from beside it.
        direction.is_some_and(|direction| direction[0].abs() > 1e-3)
    })
}
