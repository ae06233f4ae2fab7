//! The contract of an evaluator, at given points.

use crate::prelude::*;
use crate::truth::{RegionValues, Truth};
use touchoff::tool::PointEvaluation;
use touchoff::{Level, Tool};
use touchoff_tests::evaluations::{bits, evaluate_points, numbers};
use touchoff_tests::oracle::space::{distance, exactly};
use touchoff_tests::oracle::vector::norm;

/// Distance in ulp(S) from a border within which both sides, or both owners, are accepted.
const AMBIGUITY_ULPS: f64 = 2.0;

pub(crate) const DEPTH: &str = "depth [ulp(S)]";
pub(crate) const WRONG_SIDE: &str = "wrong side";
const WRONG_OWNER: &str = "wrong owner";
const SENSELESS_NUMBER: &str = "senseless number";

/// A tool, its true values, and the limits of its errors.
pub(crate) struct Validator<'a> {
    pub(crate) tool: &'a dyn Tool,
    pub(crate) truth: &'a dyn Truth,
    /// Limit of the errors of depths, and of distances outside, in ulp(S).
    pub(crate) limit: f64,
    /// True if directions one ulp beside a singular point are accepted there: a centre on the axis need not be a double.
    pub(crate) centres_are_rounded: bool,
}

impl<'a> Validator<'a> {
    pub(crate) fn new(tool: &'a dyn Tool, truth: &'a dyn Truth) -> Validator<'a> {
        Validator { tool, truth, limit: 1.0, centres_are_rounded: true }
    }

    pub(crate) fn validate(
        &self,
        points: &[[f64; 3]],
        checks: &mut Checks,
    ) -> Vec<Option<PointEvaluation>> {
        let lanes = evaluate_points(self.tool, Level::new(), points);
        let baseline = evaluate_points(self.tool, Level::baseline(), points);
        for ((p, lane), baseline) in points.iter().zip(&lanes).zip(&baseline) {
            let [a, b] = [lane, baseline].map(|e| e.as_ref().map(bits));
            checks.never("unlike bits", a != b, || format!("{p:?}"));
            self.validate_point(*p, lane.as_ref(), checks);
        }
        lanes
    }

    fn validate_point(
        &self,
        p: [f64; 3],
        evaluation: Option<&PointEvaluation>,
        checks: &mut Checks,
    ) {
        let at = exactly(p);
        let exact = self.truth.depth(&at);
        let is_near_border = exact.to_f64().abs() <= AMBIGUITY_ULPS * self.truth.ulp();
        let is_wrong_side = evaluation.is_some() == exact.is_negative() && !is_near_border;
        let Some(evaluation) = evaluation else {
            checks.never(WRONG_SIDE, is_wrong_side, || format!("{p:?}"));
            return self.validate_outside(p, &exact, checks);
        };
        let place = || format!("{p:?} in `{}`", self.tool.info().regions[evaluation.region].name);
        checks.never(WRONG_SIDE, is_wrong_side, place);
        let PointEvaluation { region, depth, magnitude, niceness, .. } = *evaluation;
        let is_finite = numbers(evaluation).iter().all(|v| v.is_finite());
        let is_sensible = is_finite && [depth, magnitude, niceness].iter().all(|v| *v >= 0.0);
        checks.never(SENSELESS_NUMBER, !is_sensible, place);
        if !is_finite {
            return;
        }
        // A point that is inside only by rounding has depth 0.
        let exact_depth = if exact.is_negative() { Big::zero() } else { exact.clone() };
        let error = (&Big::exactly(depth) - &exact_depth).abs().to_f64();
        checks.within(DEPTH, error / self.truth.ulp(), self.limit, place);
        let values = self.truth.region_values(&at, region);
        let is_wrong_owner = values.as_ref().is_none_or(|values| {
            values.excess_distance > AMBIGUITY_ULPS * self.truth.ulp() && !exact.is_negative()
        });
        checks.never(WRONG_OWNER, is_wrong_owner, place);
        let Some(values) = values else { return };
        let length = norm(&exactly(evaluation.direction));
        let length_error = (&length - &Big::exactly(1.0)).abs().to_f64();
        checks.within("length of u [ε]", length_error / f64::EPSILON, 4.0, place);
        let error_from = |values: &RegionValues| distance(&values.direction, evaluation.direction);
        let (rho, scale) = (values.singularity_distance, self.truth.scale());
        // At a singular point the direction fixed by the language is expected.
        let amplification = if rho == 0.0 { 1.0 } else { (scale / rho).max(1.0) };
        let mut error = error_from(&values);
        if rho == 0.0 && self.centres_are_rounded {
            for ulps in [-1.0, 1.0] {
                let [x, y, z] = at.clone();
                let beside = [x, y, &z + &Big::exactly(ulps * self.truth.ulp())];
                let values = self.truth.region_values(&beside, region);
                error = values.map_or(error, |values| error.min(error_from(&values)));
            }
        }
        let error = error / (8.0 * f64::EPSILON * amplification);
        checks.within("u [8 ε max(1, S/ρ)]", error, 1.0, place);
    }

    fn validate_outside(&self, p: [f64; 3], exact: &Big, checks: &mut Checks) {
        let clearance = self.tool.clearance(p);
        let is_sensible = clearance.is_finite() && clearance >= 0.0;
        checks.never(SENSELESS_NUMBER, !is_sensible, || format!("{p:?}, {clearance} outside"));
        if !is_sensible {
            return;
        }
        // A point that is outside only by rounding has distance 0.
        let distance = if exact.is_negative() { -exact } else { Big::zero() };
        let excess = &Big::exactly(clearance) - &distance;
        // Some tools know only a lower bound of the distance.
        let is_lower_bound = !self.tool.info().is_exact() && excess.is_negative();
        let error = if is_lower_bound { 0.0 } else { excess.abs().to_f64() };
        // Beyond the tool's size, rounding grows with the coordinates: of the point, and of its place in the half plane.
        let [x, y, z] = p;
        let power_above = x.hypot(y).hypot(z).log2().ceil().exp2();
        let ulp = self.truth.ulp().max(f64::EPSILON * power_above);
        checks.within("distance outside [ulp(S)]", error / ulp, self.limit, || format!("{p:?}"));
    }
}
