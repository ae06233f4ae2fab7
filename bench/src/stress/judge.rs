//! Validation of an evaluator at given points against 256 bits: the contract in section 1 of the accuracy reference.

use super::ledger::{Kind, Ledger};
use super::truth::{Claim, Truth, place};
use touchoff::tool::{Evaluations, Outputs, PointBatch};
use touchoff::{Level, Tool};
use touchoff_tests::oracle::big::Big;

/// Distance in ulp(S) from a border within which both sides, or both owners, are accepted.
pub const DOUBT: f64 = 2.0;

/// Error of the depth, |m - m_exact|.
pub const DEPTH: Kind = Kind::of("depth", "ulp(S)", 1.0);
/// A point on the wrong side of the surface, beyond doubt.
pub const SIDES: Kind = Kind::never("wrong side");
/// A point whose region is not the nearest, beyond doubt.
pub const OWNERS: Kind = Kind::never("wrong owner");
/// Error of the direction's length, | |u| - 1 |.
pub const LENGTH: Kind = Kind::of("length of u", "ε", 4.0);
/// Error of the direction, |u - u_exact|.
pub const DIRECTION: Kind = Kind::of("u", "8 ε max(1, S/ρ)", 1.0);
/// Error of the distance outside. If the tool gives only a lower bound, the excess over the distance.
pub const CLEARANCE: Kind = Kind::of("distance outside", "ulp(S)", 1.0);
/// A number that is not finite, or a negative depth, niceness or distance.
pub const SENSELESS: Kind = Kind::never("senseless number");
/// Different bits in the evaluation of a single point and of a lane.
pub const UNLIKE: Kind = Kind::never("unlike bits");

/// The evaluation of a tool at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The index of the region.
    pub region: usize,
    /// Depth, magnitude, niceness, direction and gradient.
    pub numbers: [f64; 9],
}

impl Answer {
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
pub fn answers(tool: &dyn Tool, level: Level, points: &[[f64; 3]]) -> Vec<Option<Answer>> {
    let (mut list, mut evaluation) = (PointBatch::default(), Evaluations::default());
    points.iter().for_each(|p| list.push(*p));
    tool.evaluate(level, Outputs::EVERYTHING, &list, 1.0, &mut evaluation);
    let one = |at: usize| {
        (evaluation.inside[at / 8] >> (at % 8) & 1 == 1).then(|| {
            let [ux, uy, uz] = [0, 1, 2].map(|k| evaluation.direction[k][at]);
            let [gx, gy, gz] = [0, 1, 2].map(|k| evaluation.gradient[k][at]);
            let (depth, magnitude) = (evaluation.depth[at], evaluation.magnitude[at]);
            Answer {
                region: evaluation.region[at] as usize,
                numbers: [depth, magnitude, evaluation.niceness[at], ux, uy, uz, gx, gy, gz],
            }
        })
    };
    (0..points.len()).map(one).collect()
}

/// A tool under validation.
pub struct Judge<'a> {
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

impl<'a> Judge<'a> {
    /// Makes a validator of a tool by its true values, with the kinds [`DEPTH`] and [`CLEARANCE`].
    pub fn new(tool: &'a dyn Tool, truth: &'a dyn Truth) -> Judge<'a> {
        let ulp = f64::EPSILON * truth.scale();
        Judge { tool, truth, ulp, depth: DEPTH, clearance: CLEARANCE }
    }

    /// Validates all points and returns their evaluations for further checks.
    pub fn points(&self, points: &[[f64; 3]], ledger: &mut Ledger) -> Vec<Option<Answer>> {
        let lanes = answers(self.tool, Level::new(), points);
        let singly = answers(self.tool, Level::baseline(), points);
        for ((p, one), other) in points.iter().zip(&lanes).zip(&singly) {
            let bits = |answer: &Option<Answer>| answer.map(|a| (a.region, a.bits()));
            ledger.count(UNLIKE, bits(one) != bits(other), || format!("{p:?}"));
            self.point(*p, one.as_ref(), ledger);
        }
        lanes
    }

    fn point(&self, p: [f64; 3], answer: Option<&Answer>, ledger: &mut Ledger) {
        let at = place(p);
        let exact = self.truth.depth(&at);
        let depth = exact.to_f64();
        let regions = &self.tool.info().regions;
        let shown = || match answer {
            Some(answer) => format!("{p:?} in `{}`", regions[answer.region].name),
            None => format!("{p:?}"),
        };
        let wrong = answer.is_some() == exact.is_negative() && depth.abs() > DOUBT * self.ulp;
        ledger.count(SIDES, wrong, shown);
        let Some(answer) = answer else { return self.outside(p, &exact, ledger) };
        let [_, magnitude, niceness, ..] = answer.numbers;
        let finite = answer.numbers.iter().all(|v| v.is_finite());
        let sense = finite && answer.depth() >= 0.0 && magnitude >= 0.0 && niceness >= 0.0;
        ledger.count(SENSELESS, !sense, shown);
        if !finite {
            return;
        }
        // A point that is inside only by rounding has depth 0.
        let found = Big::exactly(answer.depth());
        let off = if exact.is_negative() { found } else { &exact - &found };
        ledger.see(self.depth, off.abs().to_f64() / self.ulp, shown);
        let Some(claim) = self.truth.claim(&at, answer.region) else {
            return ledger.count(OWNERS, true, shown);
        };
        let behind = claim.behind > DOUBT * self.ulp && !exact.is_negative();
        ledger.count(OWNERS, behind, shown);
        let u = answer.direction().map(Big::exactly);
        let size = (&(&(&u[0] * &u[0]) + &(&u[1] * &u[1])) + &(&u[2] * &u[2])).sqrt();
        let unit = &size - &Big::exactly(1.0);
        ledger.see(LENGTH, unit.abs().to_f64() / f64::EPSILON, shown);
        let apart = |claim: &Claim| {
            let parts = u.iter().zip(&claim.direction).map(|(a, b)| (a - b).to_f64().powi(2));
            parts.sum::<f64>().sqrt()
        };
        let (rho, scale) = (claim.singular, self.truth.scale());
        // At a singular point the direction fixed by the language is expected. A centre on the axis need not be a
        // double, so the directions one ulp beside it along z are accepted too.
        let (blur, apart) = if rho == 0.0 {
            let beside = [-1.0, 0.0, 1.0].map(|ulps| {
                let [x, y, z] = at.clone();
                let p = [x, y, &z + &Big::exactly(ulps * self.ulp)];
                self.truth.claim(&p, answer.region).map_or(f64::INFINITY, |c| apart(&c))
            });
            (1.0, beside.into_iter().fold(apart(&claim), f64::min))
        } else {
            ((scale / rho).max(1.0), apart(&claim))
        };
        ledger.see(DIRECTION, apart / (8.0 * f64::EPSILON * blur), shown);
    }

    fn outside(&self, p: [f64; 3], exact: &Big, ledger: &mut Ledger) {
        let clearance = self.tool.clearance(p);
        let sense = clearance.is_finite() && clearance >= 0.0;
        ledger.count(SENSELESS, !sense, || format!("{p:?}, {clearance} outside"));
        if !sense {
            return;
        }
        let over = &Big::exactly(clearance) - &-exact;
        // A point inside by less than the doubt has distance 0.
        let over = if exact.is_negative() { over } else { Big::exactly(clearance) };
        let bound = !self.tool.info().is_exact() && over.is_negative();
        let off = if bound { 0.0 } else { over.abs().to_f64() };
        // Beyond the tool's size, rounding grows with the point's coordinates.
        let far = p.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let ulp = self.ulp.max(f64::EPSILON * far);
        ledger.see(self.clearance, off / ulp, || format!("{p:?}"));
    }
}
