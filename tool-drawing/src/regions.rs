//! Draws the section of a tool about its axis; of regions, also names, directions and singular points.

use super::lettering::width;
use super::picture::{Part, Picture};
use super::shape::{Frame, Shape};
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, lines};
use super::stroke::Stroke;
use super::view::View;
use super::{Content, ROUNDING_FRACTION, paint};
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::model::Model;
use touchoff_plane::{Point, cross, minus, norm};

/// The error of a direction's length beyond which it is undefined, as at a centre.
const MAX_LENGTH_ERROR: f64 = 1e-3;

/// Results of drawing the section that the notes and the legend need.
#[derive(Default)]
pub(super) struct Marks {
    /// Regions whose name does not fit inside, each with a point in it.
    pub(super) unnamed: Vec<(usize, Point)>,
    /// Points on the sheet at which directions are undefined.
    pub(super) singular: Vec<Point>,
    /// True if there are borders between regions.
    pub(super) splits: bool,
    /// True if a long cylinder is shortened.
    pub(super) shortened: bool,
}

impl Marks {
    /// Adds what the legend explains of another view.
    pub(super) fn add(&mut self, other: Marks) {
        self.singular.extend(other.singular);
        self.splits |= other.splits;
        self.shortened |= other.shortened;
    }
}

/// Text sizes to try for a region's name, largest first.
const TEXT_SIZES: [f64; 3] = [8.5, 7.5, 6.5];
/// The distance between candidate positions of arrows, and the minimum distance between arrows, in sheet units.
const ARROW_STEP: f64 = 9.0;
const MIN_ARROW_DISTANCE: f64 = 40.0;
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
    let rings: Vec<Frame> = singular.iter().map(|p| around(*p, SINGULAR_POINT_RADIUS)).collect();
    let (mut arrows, mut unnamed) = (Vec::new(), Vec::new());
    for (region, shape) in picture.shapes.iter().enumerate() {
        if shape.is_empty() {
            continue;
        }
        let (mut place, _) = shape.pole(1.0);
        if !picture.names(place) {
            continue;
        }
        let mut arrows_beside =
            |taken: &[Frame]| directions.arrows(region, shape, view, &[&rings, taken].concat());
        let dot = around(place, 2.0);
        let mut name = name(picture, region, shape, &rings);
        let mut own = arrows_beside(&[name.as_ref().map_or(dot, |name| name.frame)]);
        // A name that leaves no room for an arrow is written outside, if that helps.
        if own.is_empty() && name.is_some() {
            own = arrows_beside(&[dot]);
            name = name.filter(|_| own.is_empty());
        } else if own.is_empty() {
            // The leader begins at the arrow's tail.
            own = arrows_beside(&[]);
            place = own.first().map_or(place, |arrow| arrow[0]);
        }
        match name {
            Some(Name { size, at, .. }) => {
                let text = &picture.model.regions[region].name;
                sheet.text(text, at, Look::plain(size, Anchor::Middle));
            }
            None => unnamed.push((region, place)),
        }
        arrows.extend(own);
    }
    draw_arrows(&arrows, sheet);
    singular_points(&singular, sheet);
    Marks { unnamed, singular, ..Marks::default() }
}

/// Returns the box around a point with this half side.
fn around([x, y]: Point, half: f64) -> Frame {
    [[x - half, y - half], [x + half, y + half]]
}

/// Draws circles around singular points.
pub(super) fn singular_points(points: &[Point], sheet: &mut Sheet) {
    for (look, radius) in [("fill=\"#fff\" stroke", SINGULAR_POINT_RADIUS), ("fill", 1.1)] {
        sheet.group(&format!("{look}=\"{DEFAULT_COLOUR}\""), |sheet| {
            points.iter().for_each(|p| sheet.ring(*p, radius));
        });
    }
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
    if shape.is_empty() {
        return None;
    }
    let text = &picture.model.regions[region].name;
    let across = TEXT_SIZES[1] / width(text, TEXT_SIZES[1]).max(TEXT_SIZES[1]);
    let (pole, _) = shape.pole(across);
    for size in TEXT_SIZES {
        let (wide, tall) = (width(text, size) / 2.0 + 3.0, size / 2.0 + 3.0);
        // Shifted positions are tried too, to avoid the circles of singular points.
        for shift in [0.0, 9.0, -9.0, 16.0, -16.0] {
            let at @ [x, y] = [pole[0], pole[1] + shift];
            let frame @ [low, high] = [[x - wide, y - tall], [x + wide, y + tall]];
            let meets = |ring: &Frame| (0..2).all(|k| ring[0][k] < high[k] && ring[1][k] > low[k]);
            if shape.contains(frame) && !rings.iter().any(meets) {
                return Some(Name { size, at, frame });
            }
        }
    }
    None
}

/// Returns the isolated points at which regions' directions are undefined, without duplicates. The axis is handled
/// separately.
fn singular(picture: &Picture<'_>, directions: &mut Directions<'_>) -> Vec<Point> {
    let mut found: Vec<Point> = Vec::new();
    for (region, shape) in picture.shapes.iter().enumerate() {
        let Some(focus) = directions.focus(region, shape, &picture.view) else { continue };
        let p = picture.view.to_sheet(focus);
        let is_new = !found.iter().any(|q| norm(minus(p, *q)) < 0.5);
        if is_new && picture.describes(focus) {
            found.push(p);
        }
    }
    found
}

/// An arrow on the sheet, as tail and head.
pub(super) type Arrow = [Point; 2];

/// Evaluates the directions of a tool's regions.
struct Directions<'m> {
    model: &'m Model,
    evaluator: Evaluator<'m>,
}

impl<'m> Directions<'m> {
    fn new(model: &'m Model) -> Directions<'m> {
        let roots = model.regions.iter().flat_map(|region| region.direction);
        Directions { model, evaluator: Evaluator::new(&model.graph, roots) }
    }

    /// Returns the direction to the surface at a point of a region; `None` if it is undefined there.
    fn at(&mut self, region: usize, [d, z]: Point) -> Option<Point> {
        self.evaluator.evaluate(EvaluationPoint::on_meridian(d, z));
        let [across, _, along] = self.model.regions[region].direction;
        let direction = [across, along].map(|id| self.evaluator.get(id));
        ((norm(direction) - 1.0).abs() < MAX_LENGTH_ERROR).then_some(direction)
    }

    /// Returns the point toward or away from which all directions of a region point, if there is one; directions are
    /// undefined there. It is the common intersection of the lines along three directions.
    fn focus(&mut self, region: usize, shape: &Shape, view: &View) -> Option<Point> {
        if shape.is_empty() {
            return None;
        }
        let (middle, room) = shape.pole(1.0);
        let mut rays: Vec<(Point, Point)> = Vec::new();
        for [x, y] in [[0.1, 0.5], [0.4, -0.3], [-0.4, -0.2]] {
            let p = view.point([middle[0] + room * x, middle[1] + room * y]);
            rays.push((p, self.at(region, p)?));
        }
        let (from, along) = rays[0];
        let mut crossings = [[0.0; 2]; 2];
        for (crossing, (other, direction)) in crossings.iter_mut().zip(&rays[1..]) {
            let sine = cross(along, *direction);
            if sine.abs() < ROUNDING_FRACTION {
                return None;
            }
            let share = cross(minus(*other, from), *direction) / sine;
            *crossing = [0, 1].map(|k| from[k] + share * along[k]);
        }
        let [p, q] = crossings;
        let is_one = norm(minus(p, q)) < ROUNDING_FRACTION * norm(minus(p, from)).max(norm(p));
        (is_one && shape.clearance(view.to_sheet(p), 1.0) > -0.05).then_some(p)
    }

    /// Returns a few arrows, placed where there is room for them.
    fn arrows(&mut self, region: usize, shape: &Shape, view: &View, taken: &[Frame]) -> Vec<Arrow> {
        let [low, high] = shape.frame();
        let counts = [0, 1].map(|k| ((high[k] - low[k]) / ARROW_STEP).floor() + 1.0);
        let mut candidates: Vec<(f64, Point)> = Vec::new();
        for i in 0..counts[0] as usize {
            for j in 0..counts[1] as usize {
                let shares = [(i as f64 + 0.5) / counts[0], (j as f64 + 0.5) / counts[1]];
                let p = [0, 1].map(|k| low[k] + shares[k] * (high[k] - low[k]));
                let room = shape.clearance(p, 1.0).min(clear(p, taken));
                if room > 3.5 {
                    candidates.push((room, p));
                }
            }
        }
        let max_arrows = (shape.area() / 2600.0).ceil().clamp(1.0, 5.0) as usize;
        let mut arrows: Vec<Arrow> = Vec::new();
        while arrows.len() < max_arrows {
            // Prefers positions with room around them and far from the other arrows.
            let mut best = (0.0, 0);
            for (index, (room, p)) in candidates.iter().enumerate() {
                let mut distance = 90.0f64;
                for [tail, head] in &arrows {
                    distance = distance.min(norm(minus(*p, Stroke::line(*tail, *head).at(0.5))));
                }
                let score = room.min(24.0) + 0.3 * distance;
                if distance > MIN_ARROW_DISTANCE && score > best.0 {
                    best = (score, index);
                }
            }
            if best.0 == 0.0 {
                break;
            }
            let (_, p) = candidates.remove(best.1);
            let Some([d, z]) = self.at(region, view.point(p)) else { continue };
            // Short arrows are used only for a region without any other.
            let shortest = if arrows.is_empty() { 7.0 } else { 14.0 };
            for length in [18.0, 14.0, 10.0, 7.0].into_iter().filter(|length| *length >= shortest) {
                let half = [d * length / 2.0, -z * length / 2.0];
                let arrow = [minus(p, half), [p[0] + half[0], p[1] + half[1]]];
                let fits =
                    |end: &Point| shape.clearance(*end, 1.0) > 2.0 && clear(*end, taken) > 1.0;
                if arrow.iter().all(fits) {
                    arrows.push(arrow);
                    break;
                }
            }
        }
        arrows
    }
}

/// Returns the distance of a point from the nearest box; -1 inside one.
fn clear(p: Point, taken: &[Frame]) -> f64 {
    let mut nearest = f64::INFINITY;
    for [low, high] in taken {
        let out = [0, 1].map(|k| (low[k] - p[k]).max(p[k] - high[k]));
        let is_inside = out[0].max(out[1]) < 0.0;
        nearest = nearest.min(if is_inside { -1.0 } else { norm(out.map(|part| part.max(0.0))) });
    }
    nearest
}

/// Draws arrows of directions.
pub(super) fn draw_arrows(arrows: &[Arrow], sheet: &mut Sheet) {
    sheet.path("fill=\"none\" stroke=\"#2b3440\"", &lines(arrows));
    sheet.path("fill=\"#2b3440\"", &heads(arrows, 5.0));
}

/// Returns the path data of arrows' heads, as filled triangles.
pub(super) fn heads(arrows: &[Arrow], length: f64) -> String {
    let mut triangles: Vec<[Point; 4]> = Vec::new();
    for [tail, head] in arrows {
        let direction = minus(*head, *tail);
        let [x, y] = direction.map(|part| part / norm(direction) * length);
        let foot = [head[0] - x, head[1] - y];
        let corner = [foot[0] - 0.36 * y, foot[1] + 0.36 * x];
        triangles.push([corner, *head, [foot[0] + 0.36 * y, foot[1] - 0.36 * x], corner]);
    }
    lines(&triangles)
}
