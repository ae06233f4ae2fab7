//! Polygons of the section with possibly curved edges, and their division by curves.

use super::outline::{Point, cross, dot, minus, norm};
use super::shape::{CurveFunction, ON, between};
use crate::formula::CurveIndex;

/// The distance below which points coincide, relative to the size of the section.
pub(crate) const NEAR: f64 = 1e-9;
/// The largest distance of a curve from its chord, in chord lengths. A point farther away belongs to another
/// branch.
const BULGE: f64 = 0.15;
/// The step, in chord lengths, of the differences that locate an extremum of a curve's value.
const NARROW: f64 = 1e-3;

/// The shape of a polygon's edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edge {
    Straight,
    /// A chord of one of the tool's curves.
    Along(CurveIndex),
    /// A chord of some other curve.
    Chord,
}

/// A part of the section with one owner, convex except for the bulge of its curved edges. Edge `k` leads from
/// vertex `k` to the next.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) owner: Option<usize>,
    /// The index, in the caller's list, of the piece that this one was cut from.
    pub(crate) origin: usize,
    pub(crate) vertices: Vec<Point>,
    pub(crate) edges: Vec<Edge>,
}

/// The position of a piece relative to a curve, or the parts that the curve cuts it into.
pub(crate) enum Cut {
    Below,
    Above,
    /// The piece is degenerate: its border has no interior.
    Nothing,
    Both(Option<Piece>, Option<Piece>),
}

/// A vertex with its side and the edge that follows it.
type Corner = (Point, i8, Edge);

/// The curve that cuts, as an index into all curves.
#[derive(Clone, Copy)]
pub(crate) struct Cutter<'a, 'g> {
    pub(crate) shapes: &'a [CurveFunction<'g>],
    pub(crate) curve: CurveIndex,
    pub(crate) size: f64,
}

impl Piece {
    /// Divides the piece into the parts on the two sides of a curve.
    pub(crate) fn cut(&self, cutter: Cutter<'_, '_>) -> Cut {
        let corners = cutter.corners(self);
        let has = |side: i8| corners.iter().any(|corner| corner.1 == side);
        match (has(-1), has(1)) {
            (true, true) => {
                let [below, above] = [-1, 1].map(|side| {
                    let (vertices, edges) = cutter.half(&corners, side)?;
                    let part = Piece { vertices, edges, ..*self };
                    (!is_thin(&part.vertices, cutter.size)).then_some(part)
                });
                Cut::Both(below, above)
            }
            (true, false) => Cut::Below,
            (false, true) => Cut::Above,
            // No vertex is clearly on a side: the centre decides, unless the piece is degenerate.
            (false, false) if is_thin(&self.vertices, cutter.size) => Cut::Nothing,
            (false, false) if cutter.shape().below(self.middle()) => Cut::Below,
            (false, false) => Cut::Above,
        }
    }

    /// Returns the centre and half the sides of a box that certainly contains the piece, with the bulge of
    /// its edges.
    pub(crate) fn about(&self) -> [Point; 2] {
        let [low, high] = self.vertices.iter().fold(
            [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
            |[low, high], p| {
                [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
            },
        );
        let half = [(high[0] - low[0]) / 2.0, (high[1] - low[1]) / 2.0];
        let bulge = 2.0 * BULGE * (half[0] + half[1]);
        [between(low, high, 0.5), [half[0] + bulge, half[1] + bulge]]
    }

    /// Returns the mean of its vertices.
    pub(crate) fn middle(&self) -> Point {
        let count = self.vertices.len() as f64;
        [0, 1].map(|k| self.vertices.iter().map(|p| p[k]).sum::<f64>() / count)
    }

    /// Returns its centre, and the midpoints between any two of its vertices.
    pub(crate) fn chords(&self) -> impl Iterator<Item = Point> {
        let pairs =
            self.vertices.iter().enumerate().flat_map(|(k, a)| {
                self.vertices[k + 1..].iter().map(move |b| between(*a, *b, 0.5))
            });
        std::iter::once(self.middle()).chain(pairs)
    }

    /// Returns whether it is so thin that it may lie between a curve and its chord.
    pub(crate) fn is_sliver(&self) -> bool {
        let first = self.vertices[0];
        let long = self.vertices.iter().map(|p| norm(minus(*p, first))).fold(0.0, f64::max);
        self.area() < 0.05 * long * long
    }

    /// Returns whether a point lies on an edge, or may lie on the curve that an edge is a chord of.
    pub(crate) fn has_on_edge(&self, p: Point, shapes: &[CurveFunction<'_>], size: f64) -> bool {
        let close = NEAR * size;
        let on = |[a, b]: [Point; 2], edge: Edge| {
            let bulge = BULGE * norm(minus(b, a)) + close;
            match edge {
                Edge::Straight => is_along(p, [a, b], close),
                Edge::Along(curve) => {
                    shapes[curve].side(p, size) == 0 && is_along(p, [a, b], bulge)
                }
                Edge::Chord => is_along(p, [a, b], bulge),
            }
        };
        let count = self.vertices.len();
        (0..count).any(|k| on([self.vertices[k], self.vertices[(k + 1) % count]], self.edges[k]))
    }

    /// Returns twice its area.
    pub(crate) fn area(&self) -> f64 {
        let first = self.vertices[0];
        let fan = self.vertices.windows(2);
        fan.map(|pair| cross(minus(pair[0], first), minus(pair[1], first))).sum::<f64>().abs()
    }
}

impl<'a, 'g> Cutter<'a, 'g> {
    fn shape(&self) -> &'a CurveFunction<'g> {
        &self.shapes[self.curve]
    }

    /// Returns the vertices with their sides, and the points where an edge crosses the curve.
    fn corners(&self, piece: &Piece) -> Vec<Corner> {
        let (shape, count) = (self.shape(), piece.vertices.len());
        let sides: Vec<i8> = piece.vertices.iter().map(|p| shape.side(*p, self.size)).collect();
        let mut corners = Vec::with_capacity(count + 4);
        for k in 0..count {
            let next = (k + 1) % count;
            let (a, b, edge) = (piece.vertices[k], piece.vertices[next], piece.edges[k]);
            corners.push((a, sides[k], edge));
            let mut add = |p: Point, side: i8| corners.push((p, side, edge));
            if sides[k] * sides[next] < 0 {
                add(self.crossing(a, b, edge), 0);
            } else if let Some((top, side)) = self.detour([a, b], [sides[k], sides[next]], edge) {
                if sides[k] != 0 {
                    add(self.crossing(a, top, edge), 0);
                }
                add(top, side);
                if sides[next] != 0 {
                    add(self.crossing(top, b, edge), 0);
                }
            }
        }
        corners
    }

    /// Returns the point at which an edge reaches farthest onto a side that neither end is on, with that
    /// side.
    fn detour(&self, [a, b]: [Point; 2], sides: [i8; 2], edge: Edge) -> Option<(Point, i8)> {
        let shape = self.shape();
        let there = |top: Point| {
            let side = shape.side(top, self.size);
            (side != 0 && !sides.contains(&side)).then_some((top, side))
        };
        let other = match edge {
            Edge::Straight => return there(between(a, b, self.turn(a, b)?)),
            Edge::Along(other) if other != self.curve => other,
            Edge::Along(_) | Edge::Chord => return None,
        };
        // A curve deviates from its chord and may therefore reach across.
        let along = Cutter { curve: other, ..*self };
        let chord = norm(minus(b, a));
        let near = |p: Point| {
            let at = shape.at(p);
            at.value.abs() <= BULGE * chord * norm(at.gradient)
        };
        if near(a) && near(b) {
            let parts = [0.5, 0.15, 0.85, 0.03, 0.97, 0.3, 0.7];
            return parts.into_iter().find_map(|part| there(along.bend(a, b, part)?));
        }
        // The edge may begin on the curve and leave to one side while its chord leaves to the other.
        if let Some(found) = self.leaves([a, b], sides, other) {
            return Some(found);
        }
        // A narrow curve may cross the edge twice, far from both ends.
        let mut part = self.turn(a, b)?;
        let top = between(a, b, part);
        if there(top).is_none() && !near(top) {
            return None;
        }
        for _ in 0..6 {
            let values = [part - NARROW, part, part + NARROW]
                .map(|part| along.bend(a, b, part).map_or(f64::NAN, |p| shape.value(p)));
            let [before, here, after] = values;
            let step = NARROW / 2.0 * (before - after) / (before - 2.0 * here + after);
            if !step.is_finite() {
                return None;
            }
            part = (part + step).clamp(0.0, 1.0);
        }
        there(along.bend(a, b, part)?)
    }

    /// Returns a point at which an edge along `other` lies on the opposite side from its far end, if the edge
    /// begins on the cutting curve and leaves toward that side.
    fn leaves(&self, ends: [Point; 2], sides: [i8; 2], other: CurveIndex) -> Option<(Point, i8)> {
        let (from, far) = match sides {
            [0, far] if far != 0 => (0, far),
            [far, 0] if far != 0 => (1, far),
            _ => return None,
        };
        let (a, b) = (ends[from], ends[1 - from]);
        let (own, along) = (self.shape().at(a).gradient, self.shapes[other].at(a).gradient);
        let (way, chord) = ([-along[1], along[0]], minus(b, a));
        let slope = dot(own, way) * dot(way, chord).signum();
        if slope * f64::from(far) >= -ON * norm(own) * norm(along) {
            return None;
        }
        let edge = Cutter { curve: other, ..*self };
        (1..40).find_map(|halvings| {
            let top = edge.bend(a, b, 0.5f64.powi(halvings))?;
            (self.shape().side(top, self.size) == -far).then_some((top, -far))
        })
    }

    /// Returns the parameter of the extremum of the curve's value between two points, if there is one.
    fn turn(&self, a: Point, b: Point) -> Option<f64> {
        let [_, slope, bend] = self.shape().course(a, b);
        let turn = -slope / (2.0 * bend);
        (turn > 0.0 && turn < 1.0).then_some(turn)
    }

    /// Returns the vertices and edges of the part on one side.
    fn half(&self, corners: &[Corner], side: i8) -> Option<(Vec<Point>, Vec<Edge>)> {
        let (mut vertices, mut edges) = (Vec::new(), Vec::new());
        let along = if self.shape().is_line() { Edge::Straight } else { Edge::Along(self.curve) };
        let count = corners.len();
        // Starting after a corner of the other side puts the edge along the curve last.
        let start = corners.iter().position(|corner| corner.1 == -side)?;
        for k in 1..=count {
            let (p, own, edge) = corners[(start + k) % count];
            let [before, after] = [k - 1, k + 1].map(|k| corners[(start + k) % count].1);
            // A vertex that only touches the curve does not belong to this side.
            if own == side || (own == 0 && (before == side || after == side)) {
                vertices.push(p);
                edges.push(if own == 0 && after != side { along } else { edge });
            }
        }
        if along != Edge::Straight && is_thin(&vertices, self.size) {
            let bend = self.bend(*vertices.last()?, *vertices.first()?, 0.5)?;
            vertices.push(bend);
            edges.push(along);
        }
        Some((vertices, edges))
    }

    /// Returns the point where an edge between points on different sides crosses the cutting curve, on the
    /// curve that the edge is a chord of.
    fn crossing(&self, a: Point, b: Point, edge: Edge) -> Point {
        let shape = self.shape();
        let on_chord = between(a, b, shape.zero_between(a, b));
        let Edge::Along(other) = edge else { return on_chord };
        let mut p = on_chord;
        for _ in 0..8 {
            let (own, other) = (shape.at(p), self.shapes[other].at(p));
            let ([a, b], [c, d]) = (own.gradient, other.gradient);
            let det = a * d - b * c;
            let step =
                [(own.value * d - other.value * b) / det, (other.value * a - own.value * c) / det];
            p = minus(p, step);
            if norm(step) <= 1e-17 * self.size {
                break;
            }
        }
        let (way, chord) = (minus(b, a), norm(minus(b, a)));
        let part = dot(minus(p, a), way) / (chord * chord);
        if norm(minus(p, on_chord)) < BULGE * chord && (0.0..=1.0).contains(&part) {
            return p;
        }
        // Newton's method found another crossing of the two curves. Where they hardly cross at all, the point
        // on the chord is as good.
        let along = Cutter { curve: other, ..*self };
        let (mut low, mut high) = (0.0, 1.0);
        let below = shape.below(a);
        for _ in 0..50 {
            let middle = (low + high) / 2.0;
            let Some(here) = along.bend(a, b, middle) else { return on_chord };
            if shape.below(here) == below { low = middle } else { high = middle }
        }
        along.bend(a, b, low).unwrap_or(on_chord)
    }

    /// Returns the point of the curve on the normal of a chord at a parameter of it.
    fn bend(&self, a: Point, b: Point, part: f64) -> Option<Point> {
        let shape = self.shape();
        let across = [-(b[1] - a[1]), b[0] - a[0]];
        let from = between(a, b, part);
        let at = |s: f64| [from[0] + s * across[0], from[1] + s * across[1]];
        if matches!(shape, CurveFunction::Conic { .. }) {
            let [v0, slope, bend] = shape.course(from, at(1.0));
            // The root nearer to the chord, in the form that does not cancel.
            let root = (slope * slope - 4.0 * bend * v0).sqrt();
            let s = -2.0 * v0 / (slope + root.copysign(slope));
            return (s.abs() < 4.0 * BULGE).then_some(at(s));
        }
        // Secant steps along the chord's normal.
        let (mut s0, mut s1) = (0.0, 0.05);
        let (mut v0, mut v1) = (shape.value(at(s0)), shape.value(at(s1)));
        for _ in 0..12 {
            if v1 == v0 {
                break;
            }
            let next = s1 - v1 * (s1 - s0) / (v1 - v0);
            (s0, v0) = (s1, v1);
            (s1, v1) = (next, shape.value(at(next)));
        }
        (s1.abs() < 4.0 * BULGE).then_some(at(s1))
    }
}

/// Returns whether a point is within this distance of the line segment between two others.
pub(crate) fn is_along(p: Point, [a, b]: [Point; 2], close: f64) -> bool {
    let (way, off) = (minus(b, a), minus(p, a));
    let length = norm(way);
    let along = (way[0] * off[0] + way[1] * off[1]) / length;
    cross(way, off).abs() / length < close && (0.0..=length).contains(&along)
}

/// Returns whether all vertices lie on one line, up to rounding.
fn is_thin(vertices: &[Point], size: f64) -> bool {
    let Some(&first) = vertices.first() else { return true };
    let far = |a: Point| {
        let (mut most, mut farthest) = (0.0, a);
        for b in vertices {
            let away = minus(*b, a);
            let square = away[0] * away[0] + away[1] * away[1];
            if square > most {
                (most, farthest) = (square, *b);
            }
        }
        farthest
    };
    let last = far(first);
    let way = minus(last, far(last));
    // Points that coincide have no direction, and are thin.
    let least = ON * size * norm(way);
    !vertices.iter().any(|p| cross(way, minus(*p, last)).abs() > least)
}
