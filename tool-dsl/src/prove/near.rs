//! How sure single precision is of a curve's sign.

use super::rounding::Errors;
use super::slope::Slopes;
use crate::Checked;
use crate::domain::Domain;
use crate::expr::Id;
use crate::expr::interval::{Cell, Interval};
use crate::formula::CurveIndex;
use std::collections::BTreeMap;

/// The unit roundoff of `f32`.
const ROUNDOFF: f64 = 5.960_464_477_539_063e-8;
/// How far a point may be off, as a part of the tool's size.
const FARTHEST: f64 = 1.0 / 1024.0;

/// How far a curve's value that is computed in `f32`, of a point that is off by δ, can be from its
/// value at the point itself: `slope · δ + rounding`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slack {
    /// The steepest that the curve's value is.
    pub slope: f64,
    /// What rounding adds, of the comparison with a constant or of two parts too.
    pub rounding: f64,
}

/// A curve, the nodes that its test compares and the size of the constant among them.
pub(crate) type Compared = (CurveIndex, Vec<Id>, f64);

/// The slack of curves for points of the tool. A curve whose values are not bounded has none.
pub(crate) fn slacks(tool: &Checked, curves: &[Compared]) -> BTreeMap<CurveIndex, Slack> {
    let model = &tool.model;
    let values = || curves.iter().map(|(curve, ..)| model.curves[*curve].value);
    let parts = curves.iter().flat_map(|(_, parts, _)| parts.iter().copied());
    let mut errors = Errors::new(&model.graph, model.domain, values());
    let mut slopes = Slopes::new(&model.graph, model.domain, values().chain(parts));
    let cell = wider(&tool.extent.cell(), model.domain, FARTHEST * tool.extent.scale());
    slopes.set(cell);
    let mut known = BTreeMap::new();
    for (curve, parts, constant) in curves {
        let value = model.curves[*curve].value;
        let slope = slopes.get(value).length.high;
        let sizes = parts.iter().map(|part| slopes.get(*part).value.abs().high);
        let sizes = sizes.fold(constant.abs(), |sum, size| sum + size);
        // The bound is a sum of three, rounded each time, and may be squared.
        let rounding = 1.0001 * (errors.over(value, &cell)[1] + 8.0 * ROUNDOFF * sizes);
        if slope.is_finite() && rounding.is_finite() {
            known.insert(*curve, Slack { slope: 1.0001 * slope, rounding });
        }
    }
    known
}

fn wider(cell: &Cell, domain: Domain, by: f64) -> Cell {
    let mut sides = cell.sides.map(|side| Interval::new(side.low - by, side.high + by));
    if domain == Domain::HalfPlane {
        sides[0].low = sides[0].low.max(0.0);
        sides[1] = cell.sides[1];
    }
    Cell { sides }
}
