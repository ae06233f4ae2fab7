//! The contract of an evaluator at given points, against 256 bits (section 1 of the accuracy reference).

use super::ledger::{Kind, Ledger};
use super::truth::{Claim, Truth, place};
use touchoff::tool::{Ask, Felt, Points};
use touchoff::{Level, Tool};
use touchoff_tests::oracle::big::Big;

/// Nearer to the surface than so many ulp(S), either side is right; and so of two owners.
pub const DOUBT: f64 = 2.0;

/// |m - m_exact|.
pub const DEPTH: Kind = Kind::of("depth", "ulp(S)", 1.0);
/// A point inside that is felt outside, or the other way round, beyond doubt.
pub const SIDES: Kind = Kind::never("wrong side");
/// A point whose region is not the nearest, beyond doubt.
pub const OWNERS: Kind = Kind::never("wrong owner");
/// | |u| - 1 |.
pub const LENGTH: Kind = Kind::of("length of u", "ε", 4.0);
/// |u - u_exact|.
pub const DIRECTION: Kind = Kind::of("u", "8 ε max(1, S/ρ)", 1.0);
/// The distance outside, or how far its lower bound is above it.
pub const CLEARANCE: Kind = Kind::of("distance outside", "ulp(S)", 1.0);
/// Numbers that are not finite; depths, nicenesses and distances below 0.
pub const SENSELESS: Kind = Kind::never("senseless number");
/// Other bits for one point than for lanes.
pub const UNLIKE: Kind = Kind::never("unlike bits");

/// What an evaluator says of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The region.
    pub region: usize,
    /// Depth, magnitude, niceness, direction, gradient.
    pub numbers: [f64; 9],
}

impl Answer {
    /// The depth.
    pub fn depth(&self) -> f64 {
        self.numbers[0]
    }

    /// The direction.
    pub fn direction(&self) -> [f64; 3] {
        [self.numbers[3], self.numbers[4], self.numbers[5]]
    }

    /// All its bits.
    pub fn bits(&self) -> [u64; 9] {
        self.numbers.map(f64::to_bits)
    }
}

/// What a tool says of points, at a level.
pub fn answers(tool: &dyn Tool, level: Level, points: &[[f64; 3]]) -> Vec<Option<Answer>> {
    let (mut list, mut felt) = (Points::default(), Felt::default());
    points.iter().for_each(|p| list.push(*p));
    tool.evaluate(level, Ask::EVERYTHING, &list, 1.0, &mut felt);
    let one = |at: usize| {
        (felt.inside[at / 8] >> (at % 8) & 1 == 1).then(|| {
            let [ux, uy, uz] = [0, 1, 2].map(|k| felt.direction[k][at]);
            let [gx, gy, gz] = [0, 1, 2].map(|k| felt.gradient[k][at]);
            let (depth, magnitude) = (felt.depth[at], felt.magnitude[at]);
            Answer {
                region: felt.region[at] as usize,
                numbers: [depth, magnitude, felt.niceness[at], ux, uy, uz, gx, gy, gz],
            }
        })
    };
    (0..points.len()).map(one).collect()
}

/// A tool under judgement.
pub struct Judge<'a> {
    /// The tool.
    pub tool: &'a dyn Tool,
    /// What is true of it.
    pub truth: &'a dyn Truth,
    /// 1 ulp(S).
    pub ulp: f64,
    /// What errors of depth are held to.
    pub depth: Kind,
    /// What errors of the distance outside are.
    pub clearance: Kind,
}

impl<'a> Judge<'a> {
    /// A judge of a tool by a truth.
    pub fn new(tool: &'a dyn Tool, truth: &'a dyn Truth) -> Judge<'a> {
        let ulp = f64::EPSILON * truth.scale();
        Judge { tool, truth, ulp, depth: DEPTH, clearance: CLEARANCE }
    }

    /// Judges all points; what the tool says of them, for more.
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
        let regions = &self.tool.card().regions;
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
        // Where rounding alone puts a point inside, its depth is 0.
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
        // Exactly where no direction exists, the one that the language fixes is wanted; but of a centre on the axis that is no double
        // either way is right.
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
        // Inside by less than doubt the distance is 0.
        let over = if exact.is_negative() { over } else { Big::exactly(clearance) };
        let bound = !self.tool.card().exact() && over.is_negative();
        let off = if bound { 0.0 } else { over.abs().to_f64() };
        // Farther out than the tool is large, what is rounded is as large as the point is far.
        let far = p.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let ulp = self.ulp.max(f64::EPSILON * far);
        ledger.see(self.clearance, off / ulp, || format!("{p:?}"));
    }
}
