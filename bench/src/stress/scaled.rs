//! Item 5: the whole scene scaled: the points, and the tool, written out with all lengths multiplied.

use super::ledger::{Kind, Ledger};
use super::text::{hand_written_text, power_of_two, profile_text, with_plain_names};
use super::truth::{ExactPoint, Profiled, RegionValues, Subject, Truth};
use super::validator::{PointEvaluation, Validator, evaluate_points};
use tool_dsl::source::Source;
use touchoff::Level;
use touchoff::tool::{Interpreted, ToolError};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::restated;
use touchoff_tests::oracle::rng::Rng;

/// Exponents at which every tool is accepted and has the same bits.
const EXACT_EXPONENTS: std::ops::RangeInclusive<i32> = -40..=160;
const CHANGED_BITS: Kind = Kind::forbidden_event("2^k, -40 ≤ k ≤ 160: other bits than unscaled");
/// The derivative of a magnitude is simplified if a radius is 1, so it may be rounded differently.
const GRADIENT_ERROR: Kind = Kind::with_limit("2^k, -40 ≤ k ≤ 160: gradient", "ε", 4.0);
const REJECTED: Kind = Kind::forbidden_event("2^k, -40 ≤ k ≤ 160: refused");
/// Number of scales beyond that range with other bits, and number of those rejected.
const CHANGED_BITS_BEYOND: Kind = Kind::informational("2^k beyond: other bits", "steps");
const REJECTED_BEYOND: Kind = Kind::informational("2^k beyond: refused", "steps");
/// Errors if an arc's radius exceeds S: the distance from its centre is rounded relative to the larger number.
const LARGE_RADIUS_DEPTH: Kind = Kind::with_limit("depth, a radius above S", "ulp(S)", 2.0);
const LARGE_RADIUS_CLEARANCE: Kind =
    Kind::with_limit("distance outside, a radius above S", "ulp(S)", 2.0);

/// True values with all lengths multiplied by a factor.
struct Scaled<'a> {
    unscaled: &'a dyn Truth,
    factor: Big,
    scale: f64,
}

impl<'a> Scaled<'a> {
    /// Scales true values. `size` is the unscaled tool's largest coordinate.
    fn new(unscaled: &'a dyn Truth, factor: f64, size: f64) -> Scaled<'a> {
        let mut scale = 2f64.powi((size * factor).log2().floor() as i32);
        while scale <= size * factor {
            scale *= 2.0;
        }
        Scaled { unscaled, factor: Big::decimal(factor), scale }
    }

    fn to_unscaled(&self, p: &ExactPoint) -> ExactPoint {
        std::array::from_fn(|k| &p[k] / &self.factor)
    }
}

impl Truth for Scaled<'_> {
    fn scale(&self) -> f64 {
        self.scale
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        &self.unscaled.depth(&self.to_unscaled(p)) * &self.factor
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        self.unscaled.owner(&self.to_unscaled(p))
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let values = self.unscaled.region_values(&self.to_unscaled(p), region)?;
        let factor = self.factor.to_f64();
        Some(RegionValues {
            depth: &values.depth * &self.factor,
            excess_distance: values.excess_distance * factor,
            singularity_distance: values.singularity_distance * factor,
            ..values
        })
    }
}

/// Compiles a tool with its lengths multiplied by the expression `scale`.
fn compile_scaled(subject: &Subject, scale: &str) -> Result<Interpreted, ToolError> {
    let name = subject.name();
    let text = hand_written_text(name, scale).unwrap_or_else(|| {
        let tool = restated::of(name).expect("what is not written by hand is restated");
        profile_text(&with_plain_names(&tool), scale)
    });
    Interpreted::parse(&Source::new(name, text))
}

/// Returns points near the tool's curves, at its corners, on its axis and anywhere.
fn points(subject: &Subject, count: usize, rng: &mut Rng) -> Vec<[f64; 3]> {
    let curves: Vec<[f64; 3]> = subject.oracle.curve_points().into_iter().flatten().collect();
    let mut points: Vec<[f64; 3]> = subject.oracle.corner_points();
    let [radius, height] = subject.oracle.extent();
    while points.len() < count {
        let origin = curves[rng.bits() as usize % curves.len()];
        let distance = 10f64.powf(rng.between(-16.0, -1.0));
        let step = rng.direction().map(|c| distance * c * radius);
        let angle = rng.between(0.0, std::f64::consts::TAU);
        points.push(touchoff_tests::oracle::displaced(&*subject.oracle, origin, step, angle));
        let xy = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
        points.push([xy[0], xy[1], rng.between(-0.05, 1.05) * height]);
        points.push([0.0, 0.0, rng.between(0.0, height)]);
    }
    points
}

/// Returns whether two evaluations agree to the last bit: lengths up to `factor`, niceness and direction as they are.
fn same_bits(a: Option<&PointEvaluation>, b: Option<&PointEvaluation>, factor: f64) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return a.is_none() == b.is_none() };
    let mut scaled = a.numbers;
    scaled[0] *= factor;
    scaled[1] *= factor;
    a.region == b.region && scaled.map(f64::to_bits)[..6] == b.bits()[..6]
}

/// Returns the largest difference between the components of two gradients, in units of ε.
fn gradient_difference(a: Option<&PointEvaluation>, b: Option<&PointEvaluation>) -> f64 {
    let (Some(a), Some(b)) = (a, b) else { return 0.0 };
    let differences = (6..9).map(|k| (a.numbers[k] - b.numbers[k]).abs());
    differences.fold(0.0, f64::max) / f64::EPSILON
}

/// Scales by powers of two, and by factors that are not powers of two.
pub(super) fn scaled_scenes(
    subject: &Subject,
    (count, powers): (usize, &[i32]),
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let points = points(subject, count, rng);
    let base = compile_scaled(subject, "1").expect("the tool that is restated");
    let unscaled = evaluate_points(&base, Level::new(), &points);
    let mut outside_range = [Vec::new(), Vec::new()];
    for &k in powers {
        let in_range = EXACT_EXPONENTS.contains(&k);
        let tool = match compile_scaled(subject, &power_of_two(k)) {
            Ok(tool) => tool,
            Err(error) => {
                if in_range {
                    ledger.count(REJECTED, true, || format!("k = {k}: {error}"));
                } else {
                    outside_range[1].push(k);
                }
                continue;
            }
        };
        if in_range {
            ledger.count(REJECTED, false, String::new);
        }
        let factor = 2f64.powi(k);
        let scaled_points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * factor)).collect();
        let scaled = evaluate_points(&tool, Level::new(), &scaled_points);
        let mut all_equal = true;
        for ((p, a), b) in points.iter().zip(&unscaled).zip(&scaled) {
            // Skip points so close to 0 that scaling loses bits.
            if p.iter().any(|c| (c * factor) / factor != *c) {
                continue;
            }
            let equal = same_bits(a.as_ref(), b.as_ref(), factor);
            all_equal &= equal;
            if in_range {
                ledger.count(CHANGED_BITS, !equal, || format!("{p:?} at k = {k}: {a:?}, {b:?}"));
                let difference = gradient_difference(a.as_ref(), b.as_ref());
                ledger.record(GRADIENT_ERROR, difference, || format!("{p:?} at k = {k}"));
            }
        }
        if !all_equal && !in_range {
            outside_range[0].push(k);
        }
    }
    for (kind, steps) in [CHANGED_BITS_BEYOND, REJECTED_BEYOND].into_iter().zip(&outside_range) {
        ledger.record_info(kind, 1, steps.len() as f64, &format!("k = {steps:?}"));
    }
    for (text, factor) in [("1e-9", 1e-9), ("25.4", 25.4), ("1e6", 1e6)] {
        let tool = match compile_scaled(subject, text) {
            Ok(tool) => tool,
            Err(error) => {
                ledger.count(REJECTED, true, || format!("{text}: {error}"));
                continue;
            }
        };
        let profiled = restated::of(subject.name())
            .map(|restatement| Profiled::new(&tool, &with_plain_names(&restatement)));
        let truth_of_tool: &dyn Truth =
            profiled.as_ref().map_or(&*subject.truth, |profiled| profiled);
        let truth = Scaled::new(truth_of_tool, factor, max_coordinate(subject));
        let scaled_points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * factor)).collect();
        let validator = Validator::new(&tool, &truth);
        if largest_radius(subject) * factor > truth.scale() {
            Validator { depth: LARGE_RADIUS_DEPTH, clearance: LARGE_RADIUS_CLEARANCE, ..validator }
                .validate(&scaled_points, ledger);
        } else {
            validator.validate(&scaled_points, ledger);
        }
    }
}

/// Returns the largest coordinate of the tool's corners.
fn max_coordinate(subject: &Subject) -> f64 {
    let corners = subject.oracle.corner_points().into_iter().flatten();
    corners.fold(0.0, |max: f64, c| max.max(c.abs()))
}

/// Returns the largest radius of the tool's arcs.
fn largest_radius(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.0 };
    let radius = |segment: &restated::Segment| {
        let centre = segment.centre.as_ref()?;
        let [d, z] = [0, 1].map(|k| (&segment.to[k] - &centre[k]).to_f64());
        Some(d.hypot(z))
    };
    tool.segments.iter().filter_map(radius).fold(0.0, f64::max)
}
