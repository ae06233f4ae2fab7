//! Item 5: the whole scene scaled: the points, and the tool, written out with all lengths multiplied.

use super::judge::{Answer, Judge, answers};
use super::ledger::{Kind, Ledger};
use super::text::{by_hand, flattened, power_of_two, profile};
use super::truth::{Claim, Place, Profiled, Subject, Truth};
use tool_dsl::source::Source;
use touchoff::Level;
use touchoff::tool::{Interpreted, ToolError};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::restated;

/// Exponents at which every tool is accepted and has the same bits.
const RANGE: std::ops::RangeInclusive<i32> = -40..=160;
const SAME: Kind = Kind::never("2^k, -40 ≤ k ≤ 160: other bits than unscaled");
/// The derivative of a magnitude is simplified if a radius is 1, so it may be rounded differently.
const SLOPE: Kind = Kind::of("2^k, -40 ≤ k ≤ 160: gradient", "ε", 4.0);
const REFUSED: Kind = Kind::never("2^k, -40 ≤ k ≤ 160: refused");
/// Number of scales beyond that range with other bits, and number of those rejected.
const UNLIKE: Kind = Kind::told("2^k beyond: other bits", "steps");
const BEYOND: Kind = Kind::told("2^k beyond: refused", "steps");
/// Errors if an arc's radius exceeds S: the distance from its centre is rounded relative to the larger number.
const LARGE: Kind = Kind::of("depth, a radius above S", "ulp(S)", 2.0);
const LARGE_OUTSIDE: Kind = Kind::of("distance outside, a radius above S", "ulp(S)", 2.0);

/// True values with all lengths multiplied by a factor.
struct Scaled<'a> {
    own: &'a dyn Truth,
    by: Big,
    scale: f64,
}

impl<'a> Scaled<'a> {
    /// Scales true values. `size` is the unscaled tool's largest coordinate.
    fn new(own: &'a dyn Truth, by: f64, size: f64) -> Scaled<'a> {
        let mut scale = 2f64.powi((size * by).log2().floor() as i32);
        while scale <= size * by {
            scale *= 2.0;
        }
        Scaled { own, by: Big::decimal(by), scale }
    }

    fn back(&self, p: &Place) -> Place {
        std::array::from_fn(|k| &p[k] / &self.by)
    }
}

impl Truth for Scaled<'_> {
    fn scale(&self) -> f64 {
        self.scale
    }

    fn depth(&self, p: &Place) -> Big {
        &self.own.depth(&self.back(p)) * &self.by
    }

    fn owner(&self, p: &Place) -> Option<usize> {
        self.own.owner(&self.back(p))
    }

    fn claim(&self, p: &Place, region: usize) -> Option<Claim> {
        let claim = self.own.claim(&self.back(p), region)?;
        let by = self.by.to_f64();
        Some(Claim {
            depth: &claim.depth * &self.by,
            behind: claim.behind * by,
            singular: claim.singular * by,
            ..claim
        })
    }
}

/// Compiles a tool with its lengths multiplied by the expression `scale`.
fn written(subject: &Subject, scale: &str) -> Result<Interpreted, ToolError> {
    let name = subject.name();
    let text = by_hand(name, scale).unwrap_or_else(|| {
        let tool = restated::of(name).expect("what is not written by hand is restated");
        profile(&flattened(&tool), scale)
    });
    Interpreted::parse(&Source::new(name, text))
}

/// Returns points near the tool's curves, at its corners, on its axis and anywhere.
fn points(subject: &Subject, count: usize, draw: &mut Rng) -> Vec<[f64; 3]> {
    let curves: Vec<[f64; 3]> = subject.oracle.curve_points().into_iter().flatten().collect();
    let mut points: Vec<[f64; 3]> = subject.oracle.corner_points();
    let [radius, height] = subject.oracle.extent();
    while points.len() < count {
        let on = curves[draw.bits() as usize % curves.len()];
        let reach = 10f64.powf(draw.between(-16.0, -1.0));
        let step = draw.direction().map(|c| reach * c * radius);
        let angle = draw.between(0.0, std::f64::consts::TAU);
        points.push(touchoff_tests::oracle::moved(&*subject.oracle, on, step, angle));
        let across = [0; 2].map(|_| draw.between(-1.1 * radius, 1.1 * radius));
        points.push([across[0], across[1], draw.between(-0.05, 1.05) * height]);
        points.push([0.0, 0.0, draw.between(0.0, height)]);
    }
    points
}

/// Returns whether two evaluations agree to the last bit: lengths up to the factor `by`, niceness and direction as they
/// are.
fn same(a: Option<&Answer>, b: Option<&Answer>, by: f64) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return a.is_none() == b.is_none() };
    let mut scaled = a.numbers;
    scaled[0] *= by;
    scaled[1] *= by;
    a.region == b.region && scaled.map(f64::to_bits)[..6] == b.bits()[..6]
}

/// Returns the largest difference between the components of two gradients, in units of ε.
fn turned(a: Option<&Answer>, b: Option<&Answer>) -> f64 {
    let (Some(a), Some(b)) = (a, b) else { return 0.0 };
    let apart = (6..9).map(|k| (a.numbers[k] - b.numbers[k]).abs());
    apart.fold(0.0, f64::max) / f64::EPSILON
}

/// Scales by powers of two, and by factors that are not powers of two.
pub(super) fn scaled(
    subject: &Subject,
    (count, powers): (usize, &[i32]),
    draw: &mut Rng,
    ledger: &mut Ledger,
) {
    let points = points(subject, count, draw);
    let base = written(subject, "1").expect("the tool that is restated");
    let unscaled = answers(&base, Level::new(), &points);
    let mut beyond = [Vec::new(), Vec::new()];
    for &k in powers {
        let within = RANGE.contains(&k);
        let tool = match written(subject, &power_of_two(k)) {
            Ok(tool) => tool,
            Err(error) => {
                if within {
                    ledger.count(REFUSED, true, || format!("k = {k}: {error}"));
                } else {
                    beyond[1].push(k);
                }
                continue;
            }
        };
        if within {
            ledger.count(REFUSED, false, String::new);
        }
        let by = 2f64.powi(k);
        let there: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * by)).collect();
        let scaled = answers(&tool, Level::new(), &there);
        let mut all = true;
        for ((p, a), b) in points.iter().zip(&unscaled).zip(&scaled) {
            // Skip points so close to 0 that scaling loses bits.
            if p.iter().any(|c| (c * by) / by != *c) {
                continue;
            }
            let like = same(a.as_ref(), b.as_ref(), by);
            all &= like;
            if within {
                ledger.count(SAME, !like, || format!("{p:?} at k = {k}: {a:?}, {b:?}"));
                let slope = turned(a.as_ref(), b.as_ref());
                ledger.see(SLOPE, slope, || format!("{p:?} at k = {k}"));
            }
        }
        if !all && !within {
            beyond[0].push(k);
        }
    }
    for (kind, steps) in [UNLIKE, BEYOND].into_iter().zip(&beyond) {
        ledger.tell(kind, 1, steps.len() as f64, &format!("k = {steps:?}"));
    }
    for (text, by) in [("1e-9", 1e-9), ("25.4", 25.4), ("1e6", 1e6)] {
        let tool = match written(subject, text) {
            Ok(tool) => tool,
            Err(error) => {
                ledger.count(REFUSED, true, || format!("{text}: {error}"));
                continue;
            }
        };
        let own = restated::of(subject.name()).map(|own| Profiled::new(&tool, &flattened(&own)));
        let own: &dyn Truth = own.as_ref().map_or(&*subject.truth, |own| own);
        let truth = Scaled::new(own, by, size(subject));
        let there: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * by)).collect();
        let judge = Judge::new(&tool, &truth);
        if largest_radius(subject) * by > truth.scale() {
            Judge { depth: LARGE, clearance: LARGE_OUTSIDE, ..judge }.points(&there, ledger);
        } else {
            judge.points(&there, ledger);
        }
    }
}

/// Returns the largest coordinate of the tool's corners.
fn size(subject: &Subject) -> f64 {
    let corners = subject.oracle.corner_points().into_iter().flatten();
    corners.fold(0.0, |most: f64, c| most.max(c.abs()))
}

/// Returns the largest radius of the tool's arcs.
fn largest_radius(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.0 };
    let radius = |way: &restated::Way| {
        let centre = way.centre.as_ref()?;
        let [d, z] = [0, 1].map(|k| (&way.to[k] - &centre[k]).to_f64());
        Some(d.hypot(z))
    };
    tool.ways.iter().filter_map(radius).fold(0.0, f64::max)
}
