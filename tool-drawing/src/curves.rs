//! Evaluates the splitting curves in the plane of a section, each prepared when it is first used.

use touchoff_dsl::bound::Extent;
use touchoff_dsl::expr::interval::{Cell, Encloser, Interval};
use touchoff_dsl::expr::polynomial::{Monomial, Polynomial};
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::formula::{ANY_SIGN, CurveIndex, NEGATIVE, POSITIVE, Signs, ZERO};
use touchoff_dsl::model::Model;
use touchoff_dsl::vector::{Point, minus, norm};

/// The plane of a section, which has two coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plane {
    /// The half plane of a tool: the distance from the axis, and z.
    Meridian,
    /// The plane of space perpendicular to an axis (0, 1, 2 for x, y, z) at a coordinate: the other two coordinates, in
    /// alphabetical order.
    Across { axis: usize, at: f64 },
}

impl Plane {
    fn point(self, [u, v]: Point) -> EvaluationPoint {
        match self {
            Plane::Meridian => EvaluationPoint::on_meridian(u, v),
            Plane::Across { axis, at } => {
                let [x, y, z] = inserted([u, v], axis, at);
                EvaluationPoint::new(x, y, z)
            }
        }
    }

    fn cell(self, low: Point, high: Point) -> Cell {
        let [u, v] = [0, 1].map(|k| Interval::new(low[k], high[k]));
        match self {
            Plane::Meridian => Cell::half_plane(u, v),
            Plane::Across { axis, at } => {
                Cell { sides: inserted([u, v], axis, Interval::new(at, at)) }
            }
        }
    }

    /// Returns the place of a monomial of degree at most 1 in `a u + b v + c`, as the index of its coefficient, and the
    /// value by which it is multiplied there.
    fn linear_term(self, monomial: Monomial) -> Option<(usize, f64)> {
        match (self, monomial) {
            (_, [0, 0, 0, 0]) => Some((2, 1.0)),
            (Plane::Meridian, [1, 0, 0, 0]) => Some((0, 1.0)),
            (Plane::Meridian, [0, 0, 0, 1]) => Some((1, 1.0)),
            (Plane::Across { axis, at }, [0, exponents @ ..]) => {
                let [x, y, z] = inserted([(0, 1.0), (1, 1.0)], axis, (2, at));
                match exponents {
                    [1, 0, 0] => Some(x),
                    [0, 1, 0] => Some(y),
                    [0, 0, 1] => Some(z),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}

/// Returns the two values with a third one inserted at an index.
fn inserted<T: Copy>([u, v]: [T; 2], index: usize, third: T) -> [T; 3] {
    match index {
        0 => [third, u, v],
        1 => [u, third, v],
        _ => [u, v, third],
    }
}

/// A curve prepared for evaluation at a point and for its signs in a box.
enum CurveEvaluator<'m> {
    /// The line `a u + b v + c` in the coordinates of the plane.
    Line([f64; 3]),
    /// Any other curve.
    Bent(Box<(Evaluator<'m>, Encloser<'m>)>),
}

/// All curves of a tool. A curve is prepared when it is first used.
pub(super) struct Curves<'m> {
    model: &'m Model,
    plane: Plane,
    evaluators: Vec<Option<CurveEvaluator<'m>>>,
    /// The step of the finite differences, in the tool's unit.
    step: f64,
}

impl<'m> Curves<'m> {
    pub(super) fn new(model: &'m Model, extent: &Extent, plane: Plane) -> Curves<'m> {
        let evaluators = model.curves.iter().map(|_| None).collect();
        let step = 1e-6 * (extent.high - extent.low).max(extent.radius);
        Curves { model, plane, evaluators, step }
    }

    fn evaluator(&mut self, curve: CurveIndex) -> &mut CurveEvaluator<'m> {
        let (model, plane, value) = (self.model, self.plane, self.model.curves[curve].value);
        self.evaluators[curve].get_or_insert_with(|| match line(model, curve, plane) {
            Some(line) => CurveEvaluator::Line(line),
            None => CurveEvaluator::Bent(Box::new((
                Evaluator::new(&model.graph, [value]),
                Encloser::new(&model.graph, [value]),
            ))),
        })
    }

    /// Returns whether the plane ends at an axis.
    pub(super) fn has_axis(&self) -> bool {
        matches!(self.plane, Plane::Meridian)
    }

    /// Returns whether a curve is a straight line.
    pub(super) fn is_straight(&mut self, curve: CurveIndex) -> bool {
        matches!(self.evaluator(curve), CurveEvaluator::Line(_))
    }

    /// Returns whether a test of the plan's tree holds at a point.
    pub(super) fn holds(&mut self, curve: CurveIndex, strict: bool, p: Point) -> bool {
        let value = self.value(curve, p);
        if strict { value < 0.0 } else { value <= 0.0 }
    }

    /// Returns a curve's value at a point; +∞ where it is undefined.
    fn value(&mut self, curve: CurveIndex, p: Point) -> f64 {
        let (id, plane) = (self.model.curves[curve].value, self.plane);
        let value = match self.evaluator(curve) {
            CurveEvaluator::Line([a, b, c]) => *a * p[0] + *b * p[1] + *c,
            CurveEvaluator::Bent(bent) => {
                bent.0.evaluate(plane.point(p));
                bent.0.get(id)
            }
        };
        // As in the emitted code, where no test of NaN holds.
        if value.is_nan() { f64::INFINITY } else { value }
    }

    /// Returns the signs that a curve can have in a box.
    pub(super) fn signs(&mut self, curve: CurveIndex, low: Point, high: Point) -> Signs {
        let (id, plane) = (self.model.curves[curve].value, self.plane);
        let range = match self.evaluator(curve) {
            CurveEvaluator::Line([a, b, c]) => {
                let (mut least, mut most) = (*c, *c);
                for (k, factor) in [*a, *b].into_iter().enumerate() {
                    let [from, to] = [factor * low[k], factor * high[k]];
                    (least, most) = (least + from.min(to), most + from.max(to));
                }
                Interval::new(least, most)
            }
            CurveEvaluator::Bent(bent) => {
                bent.1.set(plane.cell(low, high));
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
    fn slope(&mut self, curve: CurveIndex, [u, v]: Point) -> Point {
        let h = self.step;
        if let CurveEvaluator::Line([a, b, _]) = self.evaluator(curve) {
            return [*a, *b];
        }
        // A difference across the axis would see the mirror image.
        let low = if self.has_axis() { (u - h).max(0.0) } else { u - h };
        let along = (self.value(curve, [u + h, v]) - self.value(curve, [low, v])) / (u + h - low);
        let up = (self.value(curve, [u, v + h]) - self.value(curve, [u, v - h])) / (2.0 * h);
        [along, up]
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
            // Nearly parallel curves would meet far away, or anywhere.
            if square.is_nan() || square < 1e-3 {
                return None;
            }
            p = [p[0] - (u * gv[1] - v * gu[1]) / sine, p[1] - (v * gu[0] - u * gv[0]) / sine];
            // Beyond the axis there is no section.
            if self.has_axis() {
                p[0] = p[0].max(0.0);
            }
        }
        (norm(minus(p, from)) <= reach).then_some((square, p))
    }
}

/// Returns the coefficients of a curve that is a straight line in a plane.
fn line(model: &Model, curve: CurveIndex, plane: Plane) -> Option<[f64; 3]> {
    let polynomial = Polynomial::from_expression(&model.graph, model.curves[curve].value)?;
    let mut line = [0.0; 3];
    for (monomial, factor) in polynomial.terms() {
        let (index, multiplier) = plane.linear_term(monomial)?;
        line[index] += multiplier * factor.to_f64();
    }
    Some(line)
}
