//! Evaluates the splitting curves in the plane of a section, each prepared when it is first used.

use std::cell::RefCell;
use touchoff_dsl::bound::Extent;
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::formula::CurveIndex;
use touchoff_dsl::model::Model;
use touchoff_plane::{Point, cross, minus, norm};

/// The step of central differences, in the tool's size.
const DIFFERENCE_STEP: f64 = 1e-6;

/// The sine of the angle between two curves below which they would meet far away, or anywhere.
const NEARLY_PARALLEL_SINE: f64 = 1e-3;

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
            Plane::Across { axis: 0, at } => EvaluationPoint::new(at, u, v),
            Plane::Across { axis: 1, at } => EvaluationPoint::new(u, at, v),
            Plane::Across { at, .. } => EvaluationPoint::new(u, v, at),
        }
    }
}

/// All curves of a tool. A curve is prepared when it is first used.
pub(super) struct Curves<'m> {
    model: &'m Model,
    plane: Plane,
    evaluators: RefCell<Vec<Option<Evaluator<'m>>>>,
    /// The step of the finite differences, in the tool's unit.
    step: f64,
}

impl<'m> Curves<'m> {
    pub(super) fn new(model: &'m Model, extent: &Extent, plane: Plane) -> Curves<'m> {
        let evaluators = RefCell::new(model.curves.iter().map(|_| None).collect());
        let step = DIFFERENCE_STEP * (extent.high - extent.low).max(extent.radius);
        Curves { model, plane, evaluators, step }
    }

    /// Returns whether the plane ends at an axis.
    pub(super) fn has_axis(&self) -> bool {
        matches!(self.plane, Plane::Meridian)
    }

    /// Returns a curve's value at a point; +∞ where it is undefined.
    pub(super) fn value(&self, curve: CurveIndex, p: Point) -> f64 {
        let Model { graph, curves, .. } = self.model;
        let id = curves[curve].value;
        let mut evaluators = self.evaluators.borrow_mut();
        let evaluator = evaluators[curve].get_or_insert_with(|| Evaluator::new(graph, [id]));
        evaluator.evaluate(self.plane.point(p));
        let value = evaluator.get(id);
        // As in the emitted code, where no test of NaN holds.
        if value.is_nan() { f64::INFINITY } else { value }
    }

    /// Returns a curve's value and its gradient at a point, by finite differences. `None` stands for the axis.
    fn value_and_slope(&self, curve: Option<CurveIndex>, p @ [u, v]: Point) -> (f64, Point) {
        let Some(curve) = curve else { return (u, [1.0, 0.0]) };
        let h = self.step;
        // A difference across the axis would see the mirror image.
        let low = if self.has_axis() { (u - h).max(0.0) } else { u - h };
        let along = (self.value(curve, [u + h, v]) - self.value(curve, [low, v])) / (u + h - low);
        let up = (self.value(curve, [u, v + h]) - self.value(curve, [u, v - h])) / (2.0 * h);
        (self.value(curve, p), [along, up])
    }

    /// Returns the intersection of two curves near a point, by Newton's method, and the sine of the angle at which they
    /// meet. `None` in `pair` stands for the axis. Returns `None` if they meet at too small an angle, or farther away than
    /// `reach`.
    pub(super) fn meet(
        &self,
        [first, second]: [Option<CurveIndex>; 2],
        from: Point,
        reach: f64,
    ) -> Option<(f64, Point)> {
        let (mut p, mut sine) = (from, 0.0);
        for _ in 0..5 {
            let (a, slope_a) = self.value_and_slope(first, p);
            let (b, slope_b) = self.value_and_slope(second, p);
            let determinant = cross(slope_a, slope_b);
            sine = determinant.abs() / (norm(slope_a) * norm(slope_b));
            if sine.is_nan() || sine < NEARLY_PARALLEL_SINE {
                return None;
            }
            for k in 0..2 {
                let step = a * slope_b[1 - k] - b * slope_a[1 - k];
                p[k] -= if k == 0 { step } else { -step } / determinant;
            }
            // Beyond the axis there is no section.
            if self.has_axis() {
                p[0] = p[0].max(0.0);
            }
        }
        (norm(minus(p, from)) <= reach).then_some((sine, p))
    }
}
