//! Item 5: points scaled together with the tool, which is written as a `.tool` file with all lengths multiplied,
//! compiled and interpreted.
//!
//! - By 2^k, -40 ≤ k ≤ 160: the same bits up to the scale. Only a gradient's last bits may differ, since a radius of 1 is
//!   simplified away. Beyond, tools whose sizes' fourth powers leave the range of doubles are refused, and so are
//!   numbers that are not between 1e-90 and 1e90; and regions by hand that are much smaller than 1e-9 of their unit are
//!   divided by a tolerance that is not small beside them. There nothing may panic.
//! - By 1e-9, 25.4 and 1e6: the contract in the new ulp(S). If an arc's radius exceeds S (by 25.4 those of `Barrel` and
//!   `Oval`), the distance from its centre is rounded relative to the larger number: depths and distances outside are
//!   within 2 ulp(S) there, and miss the contract's 1 ulp(S).

use crate::prelude::*;
use crate::text::{hand_written_text, power_of_two, profile_text, with_plain_names};
use crate::truth::{ExactPoint, Profiled, RegionValues, Truth};
use std::f64::consts::TAU;
use touchoff::Level;
use touchoff::tool::{Interpreted, PointEvaluation, ToolError};
use touchoff_dsl::source::Source;
use touchoff_tests::evaluations::evaluate_points;
use touchoff_tests::oracle::displaced;
use touchoff_tests::oracle::reference::power_above;
use touchoff_tests::oracle::restated;

#[test]
fn scaled_scenes_have_scaled_values() {
    let count = extent(60, 2_000);
    // The sample has two powers, anything more has all.
    let powers: Vec<i32> =
        if extent(1, 2) == 1 { vec![-30, 150] } else { (-300..=300).step_by(10).collect() };
    check_tools(5, |subject, rng, checks| {
        let points = points(subject, count, rng);
        let base = compile_scaled(subject, "1").expect("the tool that is restated");
        let unscaled = evaluate_points(&base, Level::new(), &points);
        for k in &powers {
            let tool = compile_scaled(subject, &power_of_two(*k));
            let is_in_range = (-40..=160).contains(k);
            if is_in_range {
                let refusal = tool.as_ref().err();
                checks.never("2^k: refused", refusal.is_some(), || format!("k = {k}: {refusal:?}"));
            }
            let Ok(tool) = tool else { continue };
            let factor = 2f64.powi(*k);
            let scaled = evaluate_points(&tool, Level::new(), &multiplied(&points, factor));
            for ((p, a), b) in points.iter().zip(&unscaled).zip(&scaled) {
                // Skip points so close to 0 that scaling loses bits.
                if is_in_range && p.iter().all(|c| (c * factor) / factor == *c) {
                    let place = || format!("{p:?} at k = {k}: {a:?}, {b:?}");
                    let differ = bits_but_gradient(a, factor) != bits_but_gradient(b, 1.0);
                    checks.never("2^k: other bits than unscaled", differ, place);
                    checks.within("2^k: gradient [ε]", gradient_difference(a, b), 4.0, place);
                }
            }
        }
        for scale in ["1e-9", "25.4", "1e6"] {
            check_contract(subject, &points, scale, checks);
        }
    });
}

/// Returns points near the tool's curves, at its corners, on its axis and anywhere.
fn points(subject: &Subject, count: usize, rng: &mut Rng) -> Vec<[f64; 3]> {
    let curves: Vec<[f64; 3]> = subject.oracle.curve_points().into_iter().flatten().collect();
    let mut points: Vec<[f64; 3]> = subject.oracle.corner_points();
    let [radius, height] = subject.oracle.extent();
    while points.len() < count {
        let origin = curves[rng.index(curves.len())];
        let distance = rng.power(-16.0, -1.0);
        let step = rng.direction().map(|c| distance * c * radius);
        points.push(displaced(&*subject.oracle, origin, step, rng.between(0.0, TAU)));
        let xy = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
        points.push([xy[0], xy[1], rng.between(-0.05, 1.05) * height]);
        points.push([0.0, 0.0, rng.between(0.0, height)]);
    }
    points
}

fn compile_scaled(subject: &Subject, scale: &str) -> Result<Interpreted, ToolError> {
    let name = subject.name();
    let text = hand_written_text(name, scale).unwrap_or_else(|| {
        let tool = restated::of(name).expect("what is not written by hand is restated");
        profile_text(&with_plain_names(&tool), scale)
    });
    Interpreted::parse(&Source::new(name, text))
}

fn multiplied(points: &[[f64; 3]], factor: f64) -> Vec<[f64; 3]> {
    points.iter().map(|p| p.map(|c| c * factor)).collect()
}

/// Returns the region and the bits of all numbers but the gradient, with lengths multiplied by `factor`.
fn bits_but_gradient(e: &Option<PointEvaluation>, factor: f64) -> Option<(usize, [u64; 6])> {
    e.map(|e| {
        let [x, y, z] = e.direction;
        let numbers = [e.depth * factor, e.magnitude * factor, e.niceness, x, y, z];
        (e.region, numbers.map(f64::to_bits))
    })
}

/// Returns the largest difference between the components of two gradients, in units of ε.
fn gradient_difference(a: &Option<PointEvaluation>, b: &Option<PointEvaluation>) -> f64 {
    let (Some(a), Some(b)) = (a, b) else { return 0.0 };
    let differences = a.gradient.iter().zip(b.gradient).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / f64::EPSILON
}

/// Checks the contract of a tool whose lengths are multiplied by a decimal.
fn check_contract(subject: &Subject, points: &[[f64; 3]], scale: &str, checks: &mut Checks) {
    let tool = compile_scaled(subject, scale);
    let refusal = tool.as_ref().err();
    checks.never("refused", refusal.is_some(), || format!("{scale}: {refusal:?}"));
    let Ok(tool) = tool else { return };
    let factor: f64 = scale.parse().expect("a number");
    let profiled = restated::of(subject.name())
        .map(|restated| Profiled::new(&tool, &with_plain_names(&restated)));
    let unscaled = profiled.as_ref().map_or(&*subject.truth, |profiled| profiled as &dyn Truth);
    let truth = Scaled::new(unscaled, factor, max_coordinate(subject));
    let limit = if max_radius(subject) * factor > truth.scale { 2.0 } else { 1.0 };
    let validator = Validator { limit, ..Validator::new(&tool, &truth) };
    validator.validate(&multiplied(points, factor), checks);
}

fn max_coordinate(subject: &Subject) -> f64 {
    let corners = subject.oracle.corner_points().into_iter().flatten();
    corners.fold(0.0, |max: f64, c| max.max(c.abs()))
}

fn max_radius(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.0 };
    let circles = tool.profile.segments().iter().filter_map(|segment| segment.circle.as_ref());
    circles.map(|circle| circle.radius.to_f64()).fold(0.0, f64::max)
}

/// True values with all lengths multiplied by a factor.
struct Scaled<'a> {
    unscaled: &'a dyn Truth,
    factor: Big,
    scale: f64,
}

impl<'a> Scaled<'a> {
    /// Scales true values. `size` is the unscaled tool's largest coordinate.
    fn new(unscaled: &'a dyn Truth, factor: f64, size: f64) -> Scaled<'a> {
        Scaled { unscaled, factor: Big::decimal(factor), scale: power_above(size * factor) }
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
