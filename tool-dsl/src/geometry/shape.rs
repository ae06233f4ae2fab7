//! Curves of the section in doubles: their values, and the sides on which points and boxes lie.

use super::outline::{Point, norm};
use crate::expr::polynomial::Polynomials;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::expr::{Graph, Id};

/// The distance below which a point lies on a curve, relative to the section's size.
pub(crate) const ON_CURVE_FRACTION: f64 = 1e-10;
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
pub(crate) struct Value {
    pub(crate) value: f64,
    pub(crate) gradient: Point,
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
            match monomial {
                [0, 0, 0, 0] => factors[0] += c,
                [1, 0, 0, 0] => add(&mut factors, &[(0, c * m), (1, c)]),
                [0, 0, 0, 1] => add(&mut factors, &[(0, c * n), (2, c)]),
                [2, 0, 0, 0] => add(&mut factors, &[(0, c * m * m), (1, 2.0 * c * m), (3, c)]),
                [0, 0, 0, 2] => add(&mut factors, &[(0, c * n * n), (2, 2.0 * c * n), (5, c)]),
                [1, 0, 0, 1] => {
                    add(&mut factors, &[(0, c * m * n), (1, c * n), (2, c * m), (4, c)]);
                }
                _ => return other(),
            }
        }
        CurveFunction::Conic { middle, factors }
    }

    pub(crate) fn is_line(&self) -> bool {
        matches!(self, CurveFunction::Conic { factors, .. } if factors[3..].iter().all(|c| *c == 0.0))
    }

    pub(crate) fn at(&self, p: Point) -> Value {
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
        let max_change = a.abs() * u + b.abs() * v;
        let max_change = max_change + c[3].abs() * u * u + c[4].abs() * u * v + c[5].abs() * v * v;
        if value.abs() <= 1.001 * max_change + 2.0 * ROUNDING * terms {
            return 0;
        }
        if value < 0.0 { -1 } else { 1 }
    }

    /// Returns the coefficients of `v0 + slope t + bend t²`, the value along the segment between two points
    /// for t from 0 to 1. They are exact for a conic and approximate for other curves.
    pub(crate) fn quadratic_along(&self, a: Point, b: Point) -> [f64; 3] {
        let [v0, vm, v1] = [a, between(a, b, 0.5), b].map(|p| self.value(p));
        [v0, 4.0 * vm - 3.0 * v0 - v1, 2.0 * (v0 - 2.0 * vm + v1)]
    }

    /// Returns the parameter of the zero between two points on different sides.
    pub(crate) fn zero_between(&self, a: Point, b: Point) -> f64 {
        if matches!(self, CurveFunction::Conic { .. }) {
            let [v0, slope, bend] = self.quadratic_along(a, b);
            let root = (slope * slope - 4.0 * bend * v0).max(0.0).sqrt();
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

pub(crate) fn between(a: Point, b: Point, t: f64) -> Point {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

fn add(factors: &mut [f64; 6], terms: &[(usize, f64)]) {
    for (index, value) in terms {
        factors[*index] += value;
    }
}
