//! Draws the section of a tool about its axis; of regions, also names, directions and singular points.

use super::borders::Side;
use super::lettering::width;
use super::marks::{Arrow, Directions, head};
use super::shape::{Frame, Shape};
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, lines};
use super::{Content, Part, Picture, paint};
use tool_dsl::vector::Point;

/// Results of drawing the section that the notes and the legend need.
#[derive(Default)]
pub(super) struct Marks {
    /// Regions whose name does not fit inside, each with a point in it.
    pub(super) unnamed: Vec<(usize, Point)>,
    /// Points on the sheet at which directions are undefined.
    pub(super) singular: Vec<Point>,
    /// True if any region has a radial direction next to the axis; on the axis, there is none.
    pub(super) axis: bool,
    /// True if there are borders between regions.
    pub(super) splits: bool,
    /// True if a long cylinder is shortened.
    pub(super) shortened: bool,
}

impl Marks {
    /// Returns what the legend of two views explains.
    pub(super) fn joined(mut self, other: Marks) -> Marks {
        self.singular.extend(other.singular);
        Marks {
            axis: self.axis || other.axis,
            splits: self.splits || other.splits,
            shortened: self.shortened || other.shortened,
            ..self
        }
    }
}

/// Text sizes to try for a region's name, largest first.
const TEXT_SIZES: [f64; 3] = [8.5, 7.5, 6.5];
/// The radius of the circles around singular points.
const SINGULAR_POINT_RADIUS: f64 = 4.0;

/// Draws the section about the axis.
pub(super) fn draw(picture: &Picture<'_>, sheet: &mut Sheet) -> Marks {
    let view = &picture.view;
    paint::halves(picture, sheet);
    let splits = picture.content == Content::Regions && paint::splits(picture, sheet);
    paint::outline(picture, true, sheet);
    paint::seams(picture, sheet);
    if matches!(picture.part, Part::Detail(_)) {
        paint::upper_edge(picture, sheet);
    }
    paint::axis_line(picture, sheet);
    let marks = match picture.content {
        Content::Regions => describe(picture, sheet),
        Content::Outline => Marks::default(),
    };
    for corner in [[-view.half, -view.height], [view.half, 0.0]] {
        sheet.reach(corner);
    }
    Marks { splits, shortened: !view.seams().is_empty(), ..marks }
}

/// Draws names, directions and singular points of the regions.
fn describe(picture: &Picture<'_>, sheet: &mut Sheet) -> Marks {
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
    let (mut arrows, mut unnamed) = (Vec::new(), Vec::new());
    for (region, shape) in picture.shapes.iter().enumerate() {
        if shape.is_empty() {
            continue;
        }
        let (mut place, _) = shape.pole(1.0);
        if !picture.names(place) {
            continue;
        }
        let mut draw = |around_frames: &[Frame]| {
            let taken: Vec<Frame> = rings.iter().chain(around_frames).copied().collect();
            directions.arrows(region, shape, view, &taken)
        };
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
    Marks { unnamed, singular, axis, ..Marks::default() }
}

/// A region's name on the sheet: text size, position and bounding box.
pub(super) struct Name {
    pub(super) size: f64,
    pub(super) at: Point,
    frame: Frame,
}

/// Returns a position for a region's name inside the region, if there is one. It avoids `rings`.
pub(super) fn name(
    picture: &Picture<'_>,
    region: usize,
    shape: &Shape,
    rings: &[Frame],
) -> Option<Name> {
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
        if !picture.describes(focus) {
            continue;
        }
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
