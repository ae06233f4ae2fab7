//! Curves of the section in doubles, and polygons with possibly curved edges that these curves divide.

use super::outline::{Point, cross, dot, minus, norm};
use crate::expr::polynomial::Polynomials;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::expr::{Graph, Id};
use crate::formula::CurveIndex;

/// The distance below which points coincide, relative to the size of the section.
pub(crate) const COINCIDENCE_FRACTION: f64 = 1e-9;
/// The largest distance of a curve from its chord, in chord lengths. A point farther away belongs to another
/// branch.
const MAX_SAGITTA_IN_CHORDS: f64 = 0.15;
/// The step, in chord lengths, of the differences that locate an extremum of a curve's value.
const DIFFERENCE_STEP_IN_CHORDS: f64 = 1e-3;

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

/// The position of a piece relative to a curve.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Position {
    Below,
    Above,
    Across,
    /// The piece is degenerate: its border has no interior.
    Degenerate,
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
        match self.position(cutter, &corners) {
            Position::Below => Cut::Below,
            Position::Above => Cut::Above,
            Position::Degenerate => Cut::Nothing,
            Position::Across => {
                let [below, above] = [-1, 1].map(|side| {
                    let (vertices, edges) = cutter.half(&corners, side)?;
                    let part = Piece { vertices, edges, ..*self };
                    // A part without area has no points to own.
                    (!is_thin(&part.vertices, cutter.size)).then_some(part)
                });
                Cut::Both(below, above)
            }
        }
    }

    /// Returns the position of the piece relative to a curve: that of a cut, without its parts.
    pub(crate) fn position_to(&self, cutter: Cutter<'_, '_>) -> Position {
        self.position(cutter, &cutter.corners(self))
    }

    fn position(&self, cutter: Cutter<'_, '_>, corners: &[Corner]) -> Position {
        let has = |side: i8| corners.iter().any(|corner| corner.1 == side);
        match (has(-1), has(1)) {
            (true, true) => Position::Across,
            (true, false) => Position::Below,
            (false, true) => Position::Above,
            // No vertex is clearly on a side: the centre decides, unless the piece is degenerate.
            (false, false) if is_thin(&self.vertices, cutter.size) => Position::Degenerate,
            (false, false) if cutter.shape().below(self.middle()) => Position::Below,
            (false, false) => Position::Above,
        }
    }

    /// Returns the centre and half the sides of a box that certainly contains the piece, with the bulge of
    /// its edges.
    pub(crate) fn bounding_box(&self) -> [Point; 2] {
        let [low, high] = self.vertices.iter().fold(
            [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
            |[low, high], p| {
                [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
            },
        );
        let half = [(high[0] - low[0]) / 2.0, (high[1] - low[1]) / 2.0];
        // A chord is no longer than the box's diagonal, which is at most twice this sum.
        let bulge = 2.0 * MAX_SAGITTA_IN_CHORDS * (half[0] + half[1]);
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
        let length = self.vertices.iter().map(|p| norm(minus(*p, first))).fold(0.0, f64::max);
        self.area() < 0.05 * length * length
    }

    /// Returns whether a point lies on an edge, or may lie on the curve that an edge is a chord of.
    pub(crate) fn has_on_edge(&self, p: Point, shapes: &[CurveFunction<'_>], size: f64) -> bool {
        let tolerance = COINCIDENCE_FRACTION * size;
        let count = self.vertices.len();
        (0..count).any(|k| {
            let ends @ [a, b] = [self.vertices[k], self.vertices[(k + 1) % count]];
            let bulge = MAX_SAGITTA_IN_CHORDS * norm(minus(b, a)) + tolerance;
            match self.edges[k] {
                Edge::Straight => is_along(p, ends, tolerance),
                Edge::Along(curve) => shapes[curve].side(p, size) == 0 && is_along(p, ends, bulge),
                Edge::Chord => is_along(p, ends, bulge),
            }
        })
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
            if sides[k] * sides[next] < 0 {
                corners.push((self.crossing(a, b, edge), 0, edge));
            } else if let Some((top, side)) =
                self.farthest_crossing([a, b], [sides[k], sides[next]], edge)
            {
                // From a vertex on the curve, the crossing is the vertex itself.
                if sides[k] != 0 {
                    corners.push((self.crossing(a, top, edge), 0, edge));
                }
                corners.push((top, side, edge));
                if sides[next] != 0 {
                    corners.push((self.crossing(top, b, edge), 0, edge));
                }
            }
        }
        corners
    }

    /// Returns the point at which an edge reaches farthest onto a side that neither end is on, with that
    /// side.
    fn farthest_crossing(
        &self,
        [a, b]: [Point; 2],
        sides: [i8; 2],
        edge: Edge,
    ) -> Option<(Point, i8)> {
        let shape = self.shape();
        let on_other_side = |top: Point| {
            let side = shape.side(top, self.size);
            (side != 0 && !sides.contains(&side)).then_some((top, side))
        };
        let other = match edge {
            Edge::Straight => return on_other_side(between(a, b, self.extremum(a, b)?)),
            Edge::Along(other) if other != self.curve => other,
            // An edge along the cutting curve does not cross it, and the curve of other chords is not known.
            Edge::Along(_) | Edge::Chord => return None,
        };
        // A curve deviates from its chord and may therefore reach across.
        let along = Cutter { curve: other, ..*self };
        let chord = norm(minus(b, a));
        let is_near = |p: Point| {
            let value_at = shape.at(p);
            value_at.value.abs() <= MAX_SAGITTA_IN_CHORDS * chord * norm(value_at.gradient)
        };
        if is_near(a) && is_near(b) {
            let fractions = [0.5, 0.15, 0.85, 0.03, 0.97, 0.3, 0.7];
            return fractions.into_iter().find_map(|part| on_other_side(along.bend(a, b, part)?));
        }
        // The edge may begin on the curve and leave to one side while its chord leaves to the other.
        if let Some(found) = self.leaving_point([a, b], sides, other) {
            return Some(found);
        }
        // A narrow curve may cross the edge twice, far from both ends.
        let mut part = self.extremum(a, b)?;
        let top = between(a, b, part);
        if on_other_side(top).is_none() && !is_near(top) {
            return None;
        }
        for _ in 0..6 {
            let values = [part - DIFFERENCE_STEP_IN_CHORDS, part, part + DIFFERENCE_STEP_IN_CHORDS]
                .map(|fraction| along.bend(a, b, fraction).map_or(f64::NAN, |p| shape.value(p)));
            let [previous_value, value, next_value] = values;
            let step = DIFFERENCE_STEP_IN_CHORDS / 2.0 * (previous_value - next_value)
                / (previous_value - 2.0 * value + next_value);
            // The value does not bend, or the edge has no such point.
            if !step.is_finite() {
                return None;
            }
            part = (part + step).clamp(0.0, 1.0);
        }
        on_other_side(along.bend(a, b, part)?)
    }

    /// Returns a point at which an edge along `other` lies on the opposite side from its far end, if the edge
    /// begins on the cutting curve and leaves toward that side.
    fn leaving_point(
        &self,
        ends: [Point; 2],
        sides: [i8; 2],
        other: CurveIndex,
    ) -> Option<(Point, i8)> {
        let (from, far_side) = match sides {
            [0, far_side] if far_side != 0 => (0, far_side),
            [far_side, 0] if far_side != 0 => (1, far_side),
            _ => return None,
        };
        let (a, b) = (ends[from], ends[1 - from]);
        let (own, along) = (self.shape().at(a).gradient, self.shapes[other].at(a).gradient);
        let (way, chord) = ([-along[1], along[0]], minus(b, a));
        let slope = dot(own, way) * dot(way, chord).signum();
        // It leaves to the side of its far end, where nothing is cut off.
        if slope * f64::from(far_side) >= -ON_CURVE_FRACTION * norm(own) * norm(along) {
            return None;
        }
        let edge = Cutter { curve: other, ..*self };
        (1..40).find_map(|halvings| {
            let top = edge.bend(a, b, 0.5f64.powi(halvings))?;
            (self.shape().side(top, self.size) == -far_side).then_some((top, -far_side))
        })
    }

    /// Returns the parameter of the extremum of the curve's value between two points, if there is one.
    fn extremum(&self, a: Point, b: Point) -> Option<f64> {
        let [_, slope, bend] = self.shape().quadratic_along(a, b);
        let extremum = -slope / (2.0 * bend);
        (extremum > 0.0 && extremum < 1.0).then_some(extremum)
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
            let previous_side = corners[(start + k - 1) % count].1;
            let next_side = corners[(start + k + 1) % count].1;
            // A vertex that only touches the curve does not belong to this side.
            if own == side || (own == 0 && (previous_side == side || next_side == side)) {
                vertices.push(p);
                edges.push(if own == 0 && next_side != side { along } else { edge });
            }
        }
        // A part between the curve and its chord has no area until a point of the curve is added.
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
            let determinant = a * d - b * c;
            let step = [
                (own.value * d - other.value * b) / determinant,
                (other.value * a - own.value * c) / determinant,
            ];
            p = minus(p, step);
            // Rounding permits no better.
            if norm(step) <= 1e-17 * self.size {
                break;
            }
        }
        let (edge_vector, chord) = (minus(b, a), norm(minus(b, a)));
        let part = dot(minus(p, a), edge_vector) / (chord * chord);
        if norm(minus(p, on_chord)) < MAX_SAGITTA_IN_CHORDS * chord && (0.0..=1.0).contains(&part) {
            return p;
        }
        // Newton's method found another crossing of the two curves. Where they hardly cross at all, the point
        // on the chord is as good.
        let along = Cutter { curve: other, ..*self };
        let (mut low, mut high) = (0.0, 1.0);
        let below = shape.below(a);
        for _ in 0..50 {
            let middle = (low + high) / 2.0;
            let Some(value) = along.bend(a, b, middle) else { return on_chord };
            if shape.below(value) == below { low = middle } else { high = middle }
        }
        along.bend(a, b, low).unwrap_or(on_chord)
    }

    /// Returns the point of the curve on the normal of a chord at a parameter of it.
    fn bend(&self, a: Point, b: Point, part: f64) -> Option<Point> {
        let shape = self.shape();
        let normal = [-(b[1] - a[1]), b[0] - a[0]];
        let from = between(a, b, part);
        let point_at = |s: f64| [from[0] + s * normal[0], from[1] + s * normal[1]];
        if matches!(shape, CurveFunction::Conic { .. }) {
            let [v0, slope, bend] = shape.quadratic_along(from, point_at(1.0));
            // The root nearer to the chord, in the form that does not cancel.
            let root = (slope * slope - 4.0 * bend * v0).sqrt();
            let s = -2.0 * v0 / (slope + root.copysign(slope));
            return (s.abs() < 4.0 * MAX_SAGITTA_IN_CHORDS).then_some(point_at(s));
        }
        // Secant steps along the chord's normal.
        let (mut s0, mut s1) = (0.0, 0.05);
        let (mut v0, mut v1) = (shape.value(point_at(s0)), shape.value(point_at(s1)));
        for _ in 0..12 {
            if v1 == v0 {
                break;
            }
            let next = s1 - v1 * (s1 - s0) / (v1 - v0);
            (s0, v0) = (s1, v1);
            (s1, v1) = (next, shape.value(point_at(next)));
        }
        (s1.abs() < 4.0 * MAX_SAGITTA_IN_CHORDS).then_some(point_at(s1))
    }
}

/// Returns whether a point is within this distance of the line segment between two others.
pub(crate) fn is_along(p: Point, [a, b]: [Point; 2], tolerance: f64) -> bool {
    let (chord_vector, off) = (minus(b, a), minus(p, a));
    let length = norm(chord_vector);
    let along = (chord_vector[0] * off[0] + chord_vector[1] * off[1]) / length;
    cross(chord_vector, off).abs() / length < tolerance && (0.0..=length).contains(&along)
}

/// Returns the vertex that is farthest from a point.
fn farthest_from(a: Point, vertices: &[Point]) -> Point {
    let (mut most, mut farthest) = (0.0, a);
    for b in vertices {
        let offset = minus(*b, a);
        let square = offset[0] * offset[0] + offset[1] * offset[1];
        if square > most {
            (most, farthest) = (square, *b);
        }
    }
    farthest
}

/// Returns whether all vertices lie on one line, up to rounding.
fn is_thin(vertices: &[Point], size: f64) -> bool {
    let Some(&first) = vertices.first() else { return true };
    // The vertex farthest from any one is an end of the longest extent, nearly, and the one farthest from it the other.
    let last = farthest_from(first, vertices);
    let extent = minus(last, farthest_from(last, vertices));
    // Points that coincide have no direction, and are thin.
    let min_width = ON_CURVE_FRACTION * size * norm(extent);
    !vertices.iter().any(|p| cross(extent, minus(*p, last)).abs() > min_width)
}

/// The distance below which a point lies on a curve, relative to the section's size.
const ON_CURVE_FRACTION: f64 = 1e-10;
/// The rounding error of a polynomial's value, relative to the sum of the absolute values of its terms.
const ROUNDING: f64 = 2e-14;

/// A curve as a function on the section.
pub(crate) enum CurveFunction<'g> {
    /// `Σ cᵢⱼ uⁱ vʲ` for `i + j ≤ 2`, with `u` and `v` relative to the section's centre.
    Conic { middle: Point, factors: [f64; 6] },
    /// Any other curve.
    Other(std::cell::RefCell<Evaluator<'g>>, Id),
}

/// A curve's value at a point, its gradient, and the sum of the absolute values of its terms.
struct Value {
    value: f64,
    gradient: Point,
    terms: f64,
}

impl<'g> CurveFunction<'g> {
    pub(crate) fn new(
        graph: &'g Graph,
        id: Id,
        middle: Point,
        polynomials: &mut Polynomials,
    ) -> CurveFunction<'g> {
        let other = || CurveFunction::Other(Evaluator::new(graph, [id]).into(), id);
        let Some(polynomial) = polynomials.of(graph, id) else { return other() };
        let mut factors = [0.0; 6];
        let [m, n] = middle;
        for (monomial, factor) in polynomial.terms() {
            let c = factor.to_f64();
            // The monomial in u = d - m and v = z - n, as terms that are added to the factors.
            let terms: &[(usize, f64)] = match monomial {
                [0, 0, 0, 0] => &[(0, c)],
                [1, 0, 0, 0] => &[(0, c * m), (1, c)],
                [0, 0, 0, 1] => &[(0, c * n), (2, c)],
                [2, 0, 0, 0] => &[(0, c * m * m), (1, 2.0 * c * m), (3, c)],
                [0, 0, 0, 2] => &[(0, c * n * n), (2, 2.0 * c * n), (5, c)],
                [1, 0, 0, 1] => &[(0, c * m * n), (1, c * n), (2, c * m), (4, c)],
                _ => return other(),
            };
            for (index, value) in terms {
                factors[*index] += value;
            }
        }
        CurveFunction::Conic { middle, factors }
    }

    fn is_line(&self) -> bool {
        matches!(self, CurveFunction::Conic { factors, .. } if factors[3..].iter().all(|c| *c == 0.0))
    }

    fn at(&self, p: Point) -> Value {
        match self {
            CurveFunction::Conic { middle, factors: c } => {
                let (u, v) = (p[0] - middle[0], p[1] - middle[1]);
                let (a, b) = (c[1] * u, c[2] * v);
                let (uu, uv, vv) = (c[3] * u * u, c[4] * u * v, c[5] * v * v);
                Value {
                    value: c[0] + a + b + uu + uv + vv,
                    gradient: [c[1] + 2.0 * c[3] * u + c[4] * v, c[2] + c[4] * u + 2.0 * c[5] * v],
                    terms: c[0].abs() + a.abs() + b.abs() + uu.abs() + uv.abs() + vv.abs(),
                }
            }
            CurveFunction::Other(evaluator, id) => {
                let mut evaluator = evaluator.borrow_mut();
                let mut value = |d: f64, z: f64| {
                    evaluator.evaluate(EvaluationPoint::on_meridian(d, z));
                    evaluator.get(*id)
                };
                // Without a polynomial, the gradient is that of central differences.
                let value_here = value(p[0], p[1]);
                let step = 1e-6 * (norm(p) + 1e-3);
                let gradient = [0, 1].map(|k| {
                    let (mut a, mut b) = (p, p);
                    a[k] -= step;
                    b[k] += step;
                    (value(b[0], b[1]) - value(a[0], a[1])) / (2.0 * step)
                });
                Value { value: value_here, gradient, terms: norm(p) * norm(gradient) }
            }
        }
    }

    /// Returns the side of the curve on which a point lies: -1 or 1, or 0 if the point is on the curve within
    /// tolerance.
    pub(crate) fn side(&self, p: Point, size: f64) -> i8 {
        let Value { value, gradient, terms } = self.at(p);
        if value.abs() <= ON_CURVE_FRACTION * size * norm(gradient)
            || value.abs() <= ROUNDING * terms
        {
            return 0;
        }
        if value < 0.0 { -1 } else { 1 }
    }

    pub(crate) fn value(&self, p: Point) -> f64 {
        match self {
            CurveFunction::Conic { middle, factors: c } => {
                let (u, v) = (p[0] - middle[0], p[1] - middle[1]);
                c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v
            }
            CurveFunction::Other(evaluator, id) => {
                let mut evaluator = evaluator.borrow_mut();
                evaluator.evaluate(EvaluationPoint::on_meridian(p[0], p[1]));
                evaluator.get(*id)
            }
        }
    }

    /// Returns the side of the curve on which a whole box lies, if a rough bound proves it: -1 or 1, else 0.
    pub(crate) fn side_of_box(&self, middle: Point, half: Point) -> i8 {
        let CurveFunction::Conic { factors: c, .. } = self else { return 0 };
        let Value { value, gradient: [a, b], terms } = self.at(middle);
        let [u, v] = half;
        // By Taylor's formula about the centre, which is exact for a conic.
        let max_change = a.abs() * u + b.abs() * v;
        let max_change = max_change + c[3].abs() * u * u + c[4].abs() * u * v + c[5].abs() * v * v;
        if value.abs() <= 1.001 * max_change + 2.0 * ROUNDING * terms {
            return 0;
        }
        if value < 0.0 { -1 } else { 1 }
    }

    /// Returns the coefficients of `v0 + slope t + bend t²`, the value along the segment between two points
    /// for t from 0 to 1. They are exact for a conic and approximate for other curves.
    fn quadratic_along(&self, a: Point, b: Point) -> [f64; 3] {
        let (v0, vm, v1) = (self.value(a), self.value(between(a, b, 0.5)), self.value(b));
        [v0, 4.0 * vm - 3.0 * v0 - v1, 2.0 * (v0 - 2.0 * vm + v1)]
    }

    /// Returns the parameter of the zero between two points on different sides.
    fn zero_between(&self, a: Point, b: Point) -> f64 {
        if matches!(self, CurveFunction::Conic { .. }) {
            let [v0, slope, bend] = self.quadratic_along(a, b);
            let root = (slope * slope - 4.0 * bend * v0).max(0.0).sqrt();
            // The form of both roots that does not cancel.
            let q = -(slope + root.copysign(slope)) / 2.0;
            if let Some(t) = [v0 / q, q / bend].into_iter().find(|t| (0.0..=1.0).contains(t)) {
                return t;
            }
        }
        let (mut low, mut high) = (0.0, 1.0);
        let below = self.below(a);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if self.below(between(a, b, middle)) == below { low = middle } else { high = middle }
        }
        low
    }

    /// Returns whether the value is at most 0, without tolerance.
    pub(crate) fn below(&self, p: Point) -> bool {
        self.value(p) <= 0.0
    }
}

fn between(a: Point, b: Point, t: f64) -> Point {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}
