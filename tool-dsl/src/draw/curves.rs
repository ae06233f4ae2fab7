//! Evaluates the splitting curves for the drawing, each prepared when it is first used.

use crate::bound::Extent;
use crate::expr::interval::{Cell, Encloser, Interval};
use crate::expr::polynomial::Polynomial;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::formula::{ANY_SIGN, CurveIndex, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::geometry::outline::{Point, dot, minus, norm};
use crate::model::Model;

/// A curve prepared for evaluation at a point and for its signs in a box.
enum CurveEvaluator<'m> {
    /// The line `a d + b z + c`.
    Line([f64; 3]),
    /// Any other curve.
    Bent(Box<(Evaluator<'m>, Encloser<'m>)>),
}

/// All curves of a tool. A curve is prepared when it is first used.
pub(super) struct Curves<'m> {
    model: &'m Model,
    evaluators: Vec<Option<CurveEvaluator<'m>>>,
    /// The step of the finite differences, in the tool's unit.
    step: f64,
}

impl<'m> Curves<'m> {
    pub(super) fn new(model: &'m Model, extent: &Extent) -> Curves<'m> {
        let evaluators = model.curves.iter().map(|_| None).collect();
        Curves { model, evaluators, step: 1e-6 * (extent.high - extent.low).max(extent.radius) }
    }

    fn evaluator(&mut self, curve: CurveIndex) -> &mut CurveEvaluator<'m> {
        let (model, value) = (self.model, self.model.curves[curve].value);
        self.evaluators[curve].get_or_insert_with(|| match line(model, curve) {
            Some(line) => CurveEvaluator::Line(line),
            None => CurveEvaluator::Bent(Box::new((
                Evaluator::new(&model.graph, [value]),
                Encloser::new(&model.graph, [value]),
            ))),
        })
    }

    /// Returns whether a curve is a straight line.
    pub(super) fn straight(&mut self, curve: CurveIndex) -> bool {
        matches!(self.evaluator(curve), CurveEvaluator::Line(_))
    }

    /// Returns a curve's value at a point; +∞ where it is undefined.
    pub(super) fn value(&mut self, curve: CurveIndex, [d, z]: Point) -> f64 {
        let id = self.model.curves[curve].value;
        let value = match self.evaluator(curve) {
            CurveEvaluator::Line([a, b, c]) => *a * d + *b * z + *c,
            CurveEvaluator::Bent(bent) => {
                bent.0.evaluate(EvaluationPoint::on_meridian(d, z));
                bent.0.get(id)
            }
        };
        if value.is_nan() { f64::INFINITY } else { value }
    }

    /// Returns the signs that a curve can have in a box.
    pub(super) fn signs(&mut self, curve: CurveIndex, low: Point, high: Point) -> Signs {
        let id = self.model.curves[curve].value;
        let range = match self.evaluator(curve) {
            CurveEvaluator::Line([a, b, c]) => {
                let of = |factor: f64, low: f64, high: f64| {
                    if factor < 0.0 {
                        (factor * high, factor * low)
                    } else {
                        (factor * low, factor * high)
                    }
                };
                let (d, z) = (of(*a, low[0], high[0]), of(*b, low[1], high[1]));
                Interval::new(d.0 + z.0 + *c, d.1 + z.1 + *c)
            }
            CurveEvaluator::Bent(bent) => {
                let side = |k: usize| Interval::new(low[k], high[k]);
                bent.1.set(Cell::half_plane(side(0), side(1)));
                bent.1.get(id)
            }
        };
        let mut signs = 0;
        if range.low < 0.0 {
            signs |= NEGATIVE;
        }
        if range.high > 0.0 {
            signs |= POSITIVE;
        }
        if range.low <= 0.0 && range.high >= 0.0 {
            signs |= ZERO;
        }
        if signs == 0 { ANY_SIGN } else { signs }
    }

    /// Returns a curve's gradient at a point, by finite differences.
    fn slope(&mut self, curve: CurveIndex, [d, z]: Point) -> Point {
        let h = self.step;
        if let CurveEvaluator::Line([a, b, _]) = self.evaluator(curve) {
            return [*a, *b];
        }
        // The axis is a mirror: negative d is not sampled.
        let low = (d - h).max(0.0);
        let along = (self.value(curve, [d + h, z]) - self.value(curve, [low, z])) / (d + h - low);
        let up = (self.value(curve, [d, z + h]) - self.value(curve, [d, z - h])) / (2.0 * h);
        [along, up]
    }

    /// Returns the first-order estimate of a point's distance from a curve.
    pub(super) fn distance(&mut self, curve: CurveIndex, p: Point) -> f64 {
        self.value(curve, p).abs() / norm(self.slope(curve, p))
    }

    /// Returns the foot of a point on a curve by Newton's method, or the point itself if the foot is farther away than
    /// `reach`.
    pub(super) fn foot(&mut self, curve: CurveIndex, from: Point, reach: f64) -> Point {
        let mut p = from;
        for _ in 0..4 {
            let slope = self.slope(curve, p);
            let step = self.value(curve, p) / dot(slope, slope);
            p = [p[0] - step * slope[0], p[1] - step * slope[1]];
        }
        if norm(minus(p, from)) <= reach { p } else { from }
    }

    /// Returns the intersection of two constraints near a point, by Newton's method, and the sine of the angle at which
    /// they meet. `None` in `pair` stands for the axis. Returns `None` if they meet at too small an angle, or farther
    /// away than `reach`.
    pub(super) fn meet(
        &mut self,
        pair: [Option<CurveIndex>; 2],
        from: Point,
        reach: f64,
    ) -> Option<(f64, Point)> {
        let mut p = from;
        let mut square = 0.0;
        for _ in 0..5 {
            let [(u, gu), (v, gv)] = pair.map(|curve| match curve {
                Some(curve) => (self.value(curve, p), self.slope(curve, p)),
                None => (p[0], [1.0, 0.0]),
            });
            let sine = gu[0] * gv[1] - gu[1] * gv[0];
            square = sine.abs() / (norm(gu) * norm(gv));
            if square.is_nan() || square < 1e-3 {
                return None;
            }
            p = [p[0] - (u * gv[1] - v * gu[1]) / sine, p[1] - (v * gu[0] - u * gv[0]) / sine];
            p[0] = p[0].max(0.0);
        }
        (norm(minus(p, from)) <= reach).then_some((square, p))
    }
}

/// Returns the coefficients of a curve that is a straight line.
fn line(model: &Model, curve: CurveIndex) -> Option<[f64; 3]> {
    let polynomial = Polynomial::from_expression(&model.graph, model.curves[curve].value)?;
    let mut line = [0.0; 3];
    for (monomial, factor) in polynomial.terms() {
        let index = match monomial {
            [1, 0, 0, 0] => 0,
            [0, 0, 0, 1] => 1,
            [0, 0, 0, 0] => 2,
            _ => return None,
        };
        line[index] = factor.to_f64();
    }
    Some(line)
}
