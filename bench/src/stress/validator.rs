//! Validation of an evaluator at given points against 256 bits: the contract in section 1 of the accuracy reference.

use super::ledger::{Kind, Ledger};
use super::truth::{RegionValues, Truth, to_exact};
use touchoff::tool::{Evaluations, Outputs, PointBatch};
use touchoff::{Level, Tool};
use touchoff_tests::oracle::big::Big;

/// Distance in ulp(S) from a border within which both sides, or both owners, are accepted.
pub const AMBIGUITY_ULPS: f64 = 2.0;

/// Error of the depth, |m - m_exact|.
pub const DEPTH: Kind = Kind::with_limit("depth", "ulp(S)", 1.0);
/// A point on the wrong side of the surface, beyond the ambiguity.
pub const WRONG_SIDE: Kind = Kind::forbidden_event("wrong side");
/// A point whose region is not the nearest, beyond the ambiguity.
pub const WRONG_OWNER: Kind = Kind::forbidden_event("wrong owner");
/// Error of the direction's length, | |u| - 1 |.
pub const LENGTH: Kind = Kind::with_limit("length of u", "ε", 4.0);
/// Error of the direction, |u - u_exact|.
pub const DIRECTION: Kind = Kind::with_limit("u", "8 ε max(1, S/ρ)", 1.0);
/// Error of the distance outside. If the tool gives only a lower bound, the excess over the distance.
pub const CLEARANCE: Kind = Kind::with_limit("distance outside", "ulp(S)", 1.0);
/// A number that is not finite, or a negative depth, niceness or distance.
pub const INVALID_NUMBER: Kind = Kind::forbidden_event("senseless number");
/// Different bits in the evaluation of a single point and of a lane.
pub const DIFFERENT_BITS: Kind = Kind::forbidden_event("unlike bits");

/// The evaluation of a tool at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointEvaluation {
    /// The index of the region.
    pub region: usize,
    /// Depth, magnitude, niceness, direction and gradient.
    pub numbers: [f64; 9],
}

impl PointEvaluation {
    /// Returns the depth.
    pub fn depth(&self) -> f64 {
        self.numbers[0]
    }

    /// Returns the direction.
    pub fn direction(&self) -> [f64; 3] {
        [self.numbers[3], self.numbers[4], self.numbers[5]]
    }

    /// Returns the bits of all numbers.
    pub fn bits(&self) -> [u64; 9] {
        self.numbers.map(f64::to_bits)
    }
}

/// Evaluates a tool at points, at a SIMD level. The result is `None` for points outside.
pub fn evaluate_points(
    tool: &dyn Tool,
    level: Level,
    points: &[[f64; 3]],
) -> Vec<Option<PointEvaluation>> {
    let (mut batch, mut evaluation) = (PointBatch::default(), Evaluations::default());
    points.iter().for_each(|p| batch.push(*p));
    tool.evaluate(level, Outputs::EVERYTHING, &batch, 1.0, &mut evaluation);
    let answer_at = |index: usize| {
        (evaluation.inside[index / 8] >> (index % 8) & 1 == 1).then(|| {
            let [ux, uy, uz] = [0, 1, 2].map(|k| evaluation.direction[k][index]);
            let [gx, gy, gz] = [0, 1, 2].map(|k| evaluation.gradient[k][index]);
            let (depth, magnitude) = (evaluation.depth[index], evaluation.magnitude[index]);
            PointEvaluation {
                region: evaluation.region[index] as usize,
                numbers: [depth, magnitude, evaluation.niceness[index], ux, uy, uz, gx, gy, gz],
            }
        })
    };
    (0..points.len()).map(answer_at).collect()
}

/// A tool under validation.
pub struct Validator<'a> {
    /// The tool.
    pub tool: &'a dyn Tool,
    /// The true values.
    pub truth: &'a dyn Truth,
    /// 1 ulp(S).
    pub ulp: f64,
    /// The kind of depth errors.
    pub depth: Kind,
    /// The kind of errors of the distance outside.
    pub clearance: Kind,
}

impl<'a> Validator<'a> {
    /// Makes a validator of a tool by its true values, with the kinds [`DEPTH`] and [`CLEARANCE`].
    pub fn new(tool: &'a dyn Tool, truth: &'a dyn Truth) -> Validator<'a> {
        let ulp = f64::EPSILON * truth.scale();
        Validator { tool, truth, ulp, depth: DEPTH, clearance: CLEARANCE }
    }

    /// Validates all points and returns their evaluations for further checks.
    pub fn validate(
        &self,
        points: &[[f64; 3]],
        ledger: &mut Ledger,
    ) -> Vec<Option<PointEvaluation>> {
        let lanes = evaluate_points(self.tool, Level::new(), points);
        let baseline = evaluate_points(self.tool, Level::baseline(), points);
        for ((p, answer), baseline_answer) in points.iter().zip(&lanes).zip(&baseline) {
            let bits = |answer: &Option<PointEvaluation>| answer.map(|a| (a.region, a.bits()));
            ledger
                .count(DIFFERENT_BITS, bits(answer) != bits(baseline_answer), || format!("{p:?}"));
            self.validate_point(*p, answer.as_ref(), ledger);
        }
        lanes
    }

    fn validate_point(&self, p: [f64; 3], answer: Option<&PointEvaluation>, ledger: &mut Ledger) {
        let exact_point = to_exact(p);
        let exact = self.truth.depth(&exact_point);
        let depth = exact.to_f64();
        let regions = &self.tool.info().regions;
        let describe = || match answer {
            Some(answer) => format!("{p:?} in `{}`", regions[answer.region].name),
            None => format!("{p:?}"),
        };
        let is_wrong_side =
            answer.is_some() == exact.is_negative() && depth.abs() > AMBIGUITY_ULPS * self.ulp;
        ledger.count(WRONG_SIDE, is_wrong_side, describe);
        let Some(answer) = answer else { return self.validate_outside(p, &exact, ledger) };
        let [_, magnitude, niceness, ..] = answer.numbers;
        let finite = answer.numbers.iter().all(|v| v.is_finite());
        let is_sensible = finite && answer.depth() >= 0.0 && magnitude >= 0.0 && niceness >= 0.0;
        ledger.count(INVALID_NUMBER, !is_sensible, describe);
        if !finite {
            return;
        }
        // A point that is inside only by rounding has depth 0.
        let computed = Big::exactly(answer.depth());
        let error = if exact.is_negative() { computed } else { &exact - &computed };
        ledger.record(self.depth, error.abs().to_f64() / self.ulp, describe);
        let Some(values) = self.truth.region_values(&exact_point, answer.region) else {
            return ledger.count(WRONG_OWNER, true, describe);
        };
        let is_wrong_owner =
            values.excess_distance > AMBIGUITY_ULPS * self.ulp && !exact.is_negative();
        ledger.count(WRONG_OWNER, is_wrong_owner, describe);
        let u = answer.direction().map(Big::exactly);
        let norm = (&(&(&u[0] * &u[0]) + &(&u[1] * &u[1])) + &(&u[2] * &u[2])).sqrt();
        let length_error = &norm - &Big::exactly(1.0);
        ledger.record(LENGTH, length_error.abs().to_f64() / f64::EPSILON, describe);
        let distance_to = |values: &RegionValues| {
            let squares = u.iter().zip(&values.direction).map(|(a, b)| (a - b).to_f64().powi(2));
            squares.sum::<f64>().sqrt()
        };
        let (rho, scale) = (values.singularity_distance, self.truth.scale());
        // At a singular point the direction fixed by the language is expected. A centre on the axis need not be a
        // double, so the directions one ulp beside it along z are accepted too.
        let (amplification, direction_error) = if rho == 0.0 {
            let neighbours = [-1.0, 0.0, 1.0].map(|ulps| {
                let [x, y, z] = exact_point.clone();
                let p = [x, y, &z + &Big::exactly(ulps * self.ulp)];
                self.truth
                    .region_values(&p, answer.region)
                    .map_or(f64::INFINITY, |values| distance_to(&values))
            });
            (1.0, neighbours.into_iter().fold(distance_to(&values), f64::min))
        } else {
            ((scale / rho).max(1.0), distance_to(&values))
        };
        ledger.record(DIRECTION, direction_error / (8.0 * f64::EPSILON * amplification), describe);
    }

    fn validate_outside(&self, p: [f64; 3], exact: &Big, ledger: &mut Ledger) {
        let clearance = self.tool.clearance(p);
        let is_sensible = clearance.is_finite() && clearance >= 0.0;
        ledger.count(INVALID_NUMBER, !is_sensible, || format!("{p:?}, {clearance} outside"));
        if !is_sensible {
            return;
        }
        let excess = &Big::exactly(clearance) - &-exact;
        // A point inside by less than the doubt has distance 0.
        let excess = if exact.is_negative() { excess } else { Big::exactly(clearance) };
        let is_lower_bound = !self.tool.info().is_exact() && excess.is_negative();
        let error = if is_lower_bound { 0.0 } else { excess.abs().to_f64() };
        // Beyond the tool's size, rounding grows with the point's coordinates.
        let max_coordinate = p.iter().fold(0.0, |max: f64, c| max.max(c.abs()));
        let ulp = self.ulp.max(f64::EPSILON * max_coordinate);
        ledger.record(self.clearance, error / ulp, || format!("{p:?}"));
    }
}
