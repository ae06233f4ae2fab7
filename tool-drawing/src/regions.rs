//! Draws the section of a tool about its axis; of regions, also names, directions and singular points.

use super::lettering::width;
use super::shape::{Frame, Shape};
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, lines};
use super::view::View;
use super::{Content, Part, Picture, paint};
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::model::Model;
use touchoff_dsl::vector::{Point, cross, minus, norm};

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
        if !found.iter().any(|q| (p[0] - q[0]).hypot(p[1] - q[1]) < 0.5) {
            found.push(p);
        }
    }
    found
}

/// Returns whether directions next to the axis have a radial component.
fn axis(picture: &Picture<'_>, directions: &mut Directions<'_>) -> bool {
    picture.section.axis.iter().any(|(region, [_, z])| {
        let direction = directions.at(*region, [1e-6 * picture.size, *z]);
        // A direction toward a centre on the axis points along the axis, as seen from beside it.
        direction.is_some_and(|direction| direction[0].abs() > 1e-3)
    })
}

/// An arrow on the sheet, as tail and head.
type Arrow = [Point; 2];

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
        ((norm(direction) - 1.0).abs() < 1e-3).then_some(direction)
    }

    /// Returns the point toward or away from which all directions of a region point, if there is one; directions are
    /// undefined there. It is the common intersection of the lines along three directions.
    fn focus(&mut self, region: usize, shape: &Shape, view: &View) -> Option<Point> {
        let [low, high] = shape.frame();
        let (middle, _) = shape.pole(1.0);
        let probe_offsets =
            [[0.0, 0.0], [0.31, 0.17], [-0.23, 0.29], [0.19, -0.33], [-0.27, -0.21]];
        let mut samples: Vec<(Point, Point)> = Vec::new();
        // The sampled neighbourhood shrinks if the region is too small for it.
        for near in [1.0, 0.4, 0.1] {
            samples.clear();
            for [u, v] in probe_offsets {
                let [wide, tall] = [0, 1].map(|k| near * (high[k] - low[k]));
                let at = [middle[0] + u * wide, middle[1] + v * tall];
                let p = view.point(at);
                if shape.clearance(at, 1.0) > 0.0
                    && let Some(direction) = self.at(region, p)
                {
                    samples.push((p, direction));
                }
            }
            if samples.len() >= 3 {
                break;
            }
        }
        let intersection = |a: (Point, Point), b: (Point, Point)| {
            let sine = cross(a.1, b.1);
            let share = cross(minus(b.0, a.0), b.1) / sine;
            (sine.abs() > 1e-6).then(|| [0, 1].map(|k| a.0[k] + share * a.1[k]))
        };
        let [a, b, c, ..] = samples.as_slice() else { return None };
        let (p, q) = (intersection(*a, *b)?, intersection(*a, *c)?);
        let near = norm(minus(p, q)) < 1e-6 * norm(minus(a.0, b.0)).max(norm(p));
        let on_sheet = view.to_sheet(p);
        (near && shape.clearance(on_sheet, 1.0) > -0.05).then_some(p)
    }

    /// Returns a few arrows, placed where there is room for them.
    fn arrows(&mut self, region: usize, shape: &Shape, view: &View, taken: &[Frame]) -> Vec<Arrow> {
        /// The distance between candidate positions, and the minimum distance between arrows, in sheet units.
        const STEP: f64 = 9.0;
        const MIN_ARROW_DISTANCE: f64 = 40.0;
        let [low, high] = shape.frame();
        let mut candidates: Vec<(f64, Point)> = Vec::new();
        let [columns, rows] = [0, 1].map(|k| ((high[k] - low[k]) / STEP).floor() as usize + 1);
        for i in 0..columns {
            for j in 0..rows {
                let at = |k: usize, n: usize, of: usize| {
                    low[k] + (high[k] - low[k]) * (n as f64 + 0.5) / of as f64
                };
                let p = [at(0, i, columns), at(1, j, rows)];
                let free_distance = shape.clearance(p, 1.0).min(clear(p, taken));
                if free_distance > 3.5 {
                    candidates.push((free_distance, p));
                }
            }
        }
        let max_arrows = (shape.area() / 2600.0).ceil().clamp(1.0, 5.0) as usize;
        let mut arrows: Vec<Arrow> = Vec::new();
        let mut middles: Vec<Point> = Vec::new();
        while arrows.len() < max_arrows {
            // Prefers positions with room around them and far from the other arrows.
            let score = |(free_distance, p): &(f64, Point)| {
                let distance_to_chosen =
                    middles.iter().map(|m| norm(minus(*m, *p))).fold(f64::INFINITY, f64::min);
                if distance_to_chosen < MIN_ARROW_DISTANCE {
                    -1.0
                } else {
                    free_distance.min(24.0) + 0.3 * distance_to_chosen.min(90.0)
                }
            };
            // `max_by` returns the last of equal candidates, and the first one counts.
            let best = (0..candidates.len())
                .rev()
                .max_by(|a, b| score(&candidates[*a]).total_cmp(&score(&candidates[*b])));
            let Some(best) = best.filter(|best| score(&candidates[*best]) > 0.0) else { break };
            let (_, p) = candidates.swap_remove(best);
            let Some([d, z]) = self.at(region, view.point(p)) else { continue };
            // Short arrows are used only for a region without any other.
            let lengths =
                if arrows.is_empty() { &[18.0, 14.0, 10.0, 7.0][..] } else { &[18.0, 14.0] };
            let fitting = lengths.iter().find_map(|length| {
                let half = [d * length / 2.0, -z * length / 2.0];
                let ends = [[p[0] - half[0], p[1] - half[1]], [p[0] + half[0], p[1] + half[1]]];
                let clear = ends
                    .iter()
                    .all(|end| shape.clearance(*end, 1.0) > 2.0 && clear(*end, taken) > 1.0);
                clear.then_some(ends)
            });
            if let Some(arrow) = fitting {
                arrows.push(arrow);
                middles.push(p);
            }
        }
        arrows
    }
}

/// Returns the distance of a point from the nearest box; -1 inside one.
fn clear(p: Point, taken: &[Frame]) -> f64 {
    taken
        .iter()
        .map(|frame| {
            let out = [0, 1].map(|k| (frame[0][k] - p[k]).max(p[k] - frame[1][k]));
            if out[0].max(out[1]) < 0.0 { -1.0 } else { norm(out.map(|part| part.max(0.0))) }
        })
        .fold(f64::INFINITY, f64::min)
}

/// Returns an arrow's head as a filled triangle.
pub(super) fn head([tail, head]: Arrow, length: f64) -> [Point; 3] {
    let direction = minus(head, tail);
    let size = norm(direction);
    let [x, y] = [direction[0] / size * length, direction[1] / size * length];
    let foot = [head[0] - x, head[1] - y];
    [[foot[0] - 0.36 * y, foot[1] + 0.36 * x], head, [foot[0] + 0.36 * y, foot[1] - 0.36 * x]]
}
