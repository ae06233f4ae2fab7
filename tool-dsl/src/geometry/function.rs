//! Curves of the section as functions in doubles.

use super::outline::{Point, Segment, bounding_box, dot, minus, norm};
use super::polygon::{Polygon, contains, range};
use crate::expr::polynomial::Polynomials;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::expr::{Graph, Id};
use crate::formula::{ANY_SIGN, Curve, NEGATIVE, POSITIVE, Signs};
use crate::number::Number;
use touchoff_plane::Circle;

/// The step of central differences: the root of the rounding of values is some 1e-8, and their curvature errs by its square.
const DIFFERENCE_STEP: f64 = 1e-6;

/// The distance below which a point lies on a curve, relative to the section's size.
const ON_CURVE_FRACTION: f64 = 1e-10;
/// The rounding error of a polynomial's value, relative to the sum of the absolute values of its terms.
const ROUNDING: f64 = 2e-14;

/// A curve as a function on the section.
pub(crate) enum CurveFunction<'g> {
    /// `constant + slope · (u, v)`, with `u` and `v` relative to the section's centre.
    Line { middle: Point, constant: f64, slope: Point },
    /// `Σ cᵢⱼ uⁱ vʲ` for `i + j ≤ 2`, with the same `u` and `v`, where a term of degree 2 is not 0.
    Conic { middle: Point, factors: [f64; 6] },
    /// Any other curve.
    Other {
        evaluator: std::cell::RefCell<Evaluator<'g>>,
        id: Id,
        /// The two signed distances whose difference has the sign of the value, if it is one.
        distances: Option<[Distance; 2]>,
    },
}

/// A signed distance, positive on the side of the material.
#[derive(Clone, Copy)]
pub(crate) enum Distance {
    /// 0: that of a test for one side.
    None,
    /// That from a line, by a point of it and its unit normal.
    Line { from: Point, normal: Point },
    /// `sign (|p - centre| - radius)`: that from a circle, or from a point.
    Circle { centre: Point, radius: f64, sign: f64 },
}

impl Distance {
    /// Returns the distance from a segment's line or circle.
    pub(crate) fn of(segment: &Segment) -> Distance {
        match segment.geometry.circle {
            None => {
                let [d, z] = segment.geometry.tangent(0);
                Distance::Line { from: segment.geometry.ends[0], normal: [-z, d] }
            }
            Some(Circle { centre, radius, convex }) => {
                Distance::Circle { centre, radius, sign: if convex { -1.0 } else { 1.0 } }
            }
        }
    }

    /// Returns the range on a convex polygon.
    fn range_over(self, polygon: &[Point]) -> [f64; 2] {
        match self {
            Distance::None => [0.0; 2],
            Distance::Line { from, normal } => {
                let values = polygon.iter().map(|p| dot(normal, minus(*p, from)));
                range(values)
            }
            Distance::Circle { centre, radius, sign } => {
                // The farthest point from the centre is a vertex. The nearest is on an edge, or the centre itself.
                let feet = (0..polygon.len()).map(|k| {
                    let (from, to) = (polygon[k], polygon[(k + 1) % polygon.len()]);
                    let along = minus(to, from);
                    let t = dot(minus(centre, from), along) / dot(along, along);
                    between(from, to, if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) })
                });
                let points = polygon.iter().copied().chain(feet);
                let within = contains(polygon, centre).then_some(centre);
                let values = points.chain(within).map(|p| sign * (norm(minus(p, centre)) - radius));
                range(values)
            }
        }
    }
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
        let other = || {
            let evaluator = Evaluator::new(graph, [id]).into();
            CurveFunction::Other { evaluator, id, distances: None }
        };
        let Some(polynomial) = polynomials.of(graph, id) else { return other() };
        let [Some(m), Some(n)] = middle.map(Number::from_f64) else { return other() };
        // In doubles, terms as large as the square of a coordinate would cancel.
        let mut factors = [(); 6].map(|()| Number::int(0));
        for (monomial, c) in polynomial.terms() {
            // The monomial in u = d - m and v = z - n, as terms that are added to the factors.
            let of = |k: usize, by: &[&Number]| (k, by.iter().fold(c.clone(), |c, x| &c * *x));
            let two = Number::int(2);
            let terms = match monomial {
                [0, 0, 0, 0] => vec![of(0, &[])],
                [1, 0, 0, 0] => vec![of(0, &[&m]), of(1, &[])],
                [0, 0, 0, 1] => vec![of(0, &[&n]), of(2, &[])],
                [2, 0, 0, 0] => vec![of(0, &[&m, &m]), of(1, &[&two, &m]), of(3, &[])],
                [0, 0, 0, 2] => vec![of(0, &[&n, &n]), of(2, &[&two, &n]), of(5, &[])],
                [1, 0, 0, 1] => {
                    vec![of(0, &[&m, &n]), of(1, &[&n]), of(2, &[&m]), of(4, &[])]
                }
                _ => return other(),
            };
            for (index, value) in terms {
                factors[index] = &factors[index] + &value;
            }
        }
        let factors = factors.map(|factor| factor.to_f64());
        match factors {
            [constant, slope_u, slope_v, 0.0, 0.0, 0.0] => {
                CurveFunction::Line { middle, constant, slope: [slope_u, slope_v] }
            }
            _ => CurveFunction::Conic { middle, factors },
        }
    }

    pub(crate) fn is_line(&self) -> bool {
        matches!(self, CurveFunction::Line { .. })
    }

    fn at(&self, p: Point) -> Value {
        match self {
            CurveFunction::Line { middle, constant, slope } => {
                let [a, b] = [0, 1].map(|k| slope[k] * (p[k] - middle[k]));
                Value {
                    value: constant + a + b,
                    gradient: *slope,
                    terms: constant.abs() + a.abs() + b.abs(),
                }
            }
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
            CurveFunction::Other { evaluator, id, .. } => {
                let mut evaluator = evaluator.borrow_mut();
                let mut value = |d: f64, z: f64| {
                    evaluator.evaluate(EvaluationPoint::on_meridian(d, z));
                    evaluator.get(*id)
                };
                // Without a polynomial, the gradient is that of central differences.
                let value_here = value(p[0], p[1]);
                let step = DIFFERENCE_STEP * (norm(p) + 1e-3);
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

    #[inline]
    pub(crate) fn value(&self, p: Point) -> f64 {
        match self {
            CurveFunction::Line { middle, constant, slope } => {
                constant + slope[0] * (p[0] - middle[0]) + slope[1] * (p[1] - middle[1])
            }
            CurveFunction::Conic { middle, factors: c } => {
                let (u, v) = (p[0] - middle[0], p[1] - middle[1]);
                c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v
            }
            CurveFunction::Other { evaluator, id, .. } => {
                let mut evaluator = evaluator.borrow_mut();
                evaluator.evaluate(EvaluationPoint::on_meridian(p[0], p[1]));
                evaluator.get(*id)
            }
        }
    }

    /// Returns the sign of the values on a convex polygon, up to points at a distance of `tolerance` from the curve; any sign if
    /// the curve crosses it.
    pub(crate) fn signs_over(&self, polygon: &Polygon, tolerance: f64) -> Signs {
        let [low, high] = self.range_over(polygon);
        let slack = self.slack_over(polygon, tolerance);
        match (low >= -slack, high <= slack) {
            (true, false) => POSITIVE,
            (false, true) => NEGATIVE,
            _ => ANY_SIGN,
        }
    }

    /// Returns whether all points of a convex polygon are on the same side, farther than `tolerance` from the curve.
    pub(crate) fn is_beside(&self, polygon: &Polygon, tolerance: f64) -> bool {
        self.sides_over(polygon, tolerance) != [true; 2]
    }

    /// Returns whether points of a convex polygon may be below the curve, and above it. Within `tolerance` of it they may be either.
    pub(crate) fn sides_over(&self, polygon: &Polygon, tolerance: f64) -> [bool; 2] {
        let [low, high] = self.range_over(polygon);
        let slack = self.slack_over(polygon, tolerance);
        [low <= slack, high >= -slack]
    }

    /// Returns the value at a point and its gradient.
    pub(crate) fn value_and_gradient(&self, p: Point) -> (f64, Point) {
        let Value { value, gradient, .. } = self.at(p);
        (value, gradient)
    }

    /// Returns the point of a convex polygon where a conic has no gradient.
    pub(crate) fn stationary_point(&self, polygon: &[Point]) -> Option<Point> {
        let CurveFunction::Conic { middle, factors: c } = self else { return None };
        let determinant = 4.0 * c[3] * c[5] - c[4] * c[4];
        let u = (c[4] * c[2] - 2.0 * c[5] * c[1]) / determinant;
        let v = (c[4] * c[1] - 2.0 * c[3] * c[2]) / determinant;
        let p = [middle[0] + u, middle[1] + v];
        (p.iter().all(|part| part.is_finite()) && contains(polygon, p)).then_some(p)
    }

    /// Notes that the value has the sign of the difference of two distances, where it is no conic.
    pub(crate) fn set_distances(&mut self, of_value: [Distance; 2]) {
        if let CurveFunction::Other { distances, .. } = self {
            *distances = Some(of_value);
        }
    }

    /// Returns the range of the values on a convex polygon; of the difference of distances for a curve that is none;
    /// infinite for any other.
    fn range_over(&self, polygon: &[Point]) -> [f64; 2] {
        if let [p] = polygon {
            return [self.value(*p); 2];
        }
        match self {
            CurveFunction::Line { .. } => return range(polygon.iter().map(|p| self.value(*p))),
            CurveFunction::Conic { .. } => {}
            CurveFunction::Other { distances: Some(distances), .. } => {
                let mut ranges = distances.map(|distance| distance.range_over(polygon));
                // Two features may be compared by their squared distances, which have no sign.
                if !distances.iter().any(|distance| matches!(distance, Distance::None)) {
                    ranges = ranges.map(|[low, high]| [low, high.max(-low)]);
                }
                let [first, second] = ranges;
                return [first[0] - second[1], first[1] - second[0]];
            }
            CurveFunction::Other { .. } => return [f64::NEG_INFINITY, f64::INFINITY],
        }
        let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
        let mut include = |value: f64| (low, high) = (low.min(value), high.max(value));
        for (k, p) in polygon.iter().enumerate() {
            include(self.value(*p));
            let q = polygon[(k + 1) % polygon.len()];
            let [start, slope, bend] = self.quadratic_along(*p, q);
            // The extreme value along the edge.
            let t = -slope / (2.0 * bend);
            if t > 0.0 && t < 1.0 {
                include(start + t * (slope + t * bend));
            }
        }
        if let Some(p) = self.stationary_point(polygon) {
            include(self.value(p));
        }
        [low, high]
    }

    /// Returns the values at the vertices of a polygon if the curve is a line. They are 0 within `tolerance` of it.
    pub(crate) fn linear_values(&self, polygon: &[Point], tolerance: f64) -> Option<Vec<f64>> {
        self.is_line().then(|| {
            let slack = self.slack(polygon[0], tolerance);
            let values = polygon.iter().map(|p| self.value(*p));
            values.map(|value| if value.abs() <= slack { 0.0 } else { value }).collect()
        })
    }

    fn slack_over(&self, polygon: &Polygon, tolerance: f64) -> f64 {
        polygon.iter().map(|p| self.slack(*p, tolerance)).fold(0.0, f64::max)
    }

    /// Returns the least value at a point that says on which side it is: that of points at a distance of `tolerance`, or of
    /// rounding.
    pub(crate) fn slack(&self, p: Point, tolerance: f64) -> f64 {
        let Value { gradient, terms, .. } = self.at(p);
        (tolerance * norm(gradient)).max(4.0 * f64::EPSILON * terms)
    }

    /// Returns the coefficients of `v0 + slope t + bend t²`, the value along the segment between two points
    /// for t from 0 to 1. They are exact for a conic and approximate for other curves.
    fn quadratic_along(&self, a: Point, b: Point) -> [f64; 3] {
        let (v0, vm, v1) = (self.value(a), self.value(between(a, b, 0.5)), self.value(b));
        [v0, 4.0 * vm - 3.0 * v0 - v1, 2.0 * (v0 - 2.0 * vm + v1)]
    }

    /// Returns whether the value is at most 0, without tolerance.
    #[inline]
    pub(crate) fn below(&self, p: Point) -> bool {
        self.value(p) <= 0.0
    }
}

fn between(a: Point, b: Point, t: f64) -> Point {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

/// Returns curves as functions about the centre of the outline's bounding box, and the diagonal of that box.
pub(crate) fn functions<'g>(
    graph: &'g Graph,
    curves: &[Curve],
    outline: &[Segment],
) -> (Vec<CurveFunction<'g>>, f64) {
    let [low, high] = bounding_box(outline);
    let middle = [0, 1].map(|k| low[k] / 2.0 + high[k] / 2.0);
    let mut polynomials = Polynomials::default();
    let shapes =
        curves.iter().map(|curve| CurveFunction::new(graph, curve.value, middle, &mut polynomials));
    (shapes.collect(), norm(minus(high, low)))
}
