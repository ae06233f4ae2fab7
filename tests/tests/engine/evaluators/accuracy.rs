//! A tool's evaluators against its oracle, within the contract of a generated evaluator: depth to 1 ulp(S), the
//! side certain beyond 2 ulp(S), unit directions to 8 ε · max(1, S/ρ). S is the next power of two above the tool's
//! largest coordinate, and ρ the distance to the nearest point at which the direction does not exist.

use super::points::{format_point, scale};
use super::{LENGTHS, evaluate};
use crate::prelude::*;
use touchoff::tool::{Outputs, PointEvaluation};
use touchoff_tests::checks::{Checks, assert_no_misses};
use touchoff_tests::evaluations::{at, batch};
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::space::exactly;
use touchoff_tests::oracle::vector::{distance, norm};
use touchoff_tests::oracle::{Meridian, OracleEvaluation, restated};

/// Distance from a border, as a fraction of S, within which either neighbour may own a point.
const BORDER_DISTANCE_FRACTION: f64 = 1e-12;

const DEPTH: &str = "depth [ulp(S)]";

/// Error in ulp(S) beyond which the oracle, itself in doubles, is doubted, and 256 bits decide.
const ULPS_IN_DOUBT: f64 = 0.5;

/// Compares a tool with its oracle at some points, prints a row and asserts the contract.
pub(crate) fn of(tool: &dyn Tool, oracle: &dyn Oracle, points: &[[f64; 3]]) {
    let s = scale(oracle);
    let ulp = s * f64::EPSILON;
    let reference = restated::of(oracle.name()).map(|tool| Reference::new(&tool));
    let mut checks = Checks::new(oracle.name());
    let list = batch(points);
    let by_length =
        LENGTHS.map(|length| evaluate(tool, Level::baseline(), Outputs::EVERYTHING, &list, length));
    for (i, &p) in points.iter().enumerate() {
        let distance = oracle.signed_distance(p);
        let contained = at(&by_length[0], i).is_some();
        let is_wrong_side = distance.abs() > 2.0 * ulp && contained != (distance < 0.0);
        let place = || format!("{}: {contained}, {distance:e} outside", format_point(p));
        checks.never("wrong side", is_wrong_side, place);
        let owner = at(&by_length[0], i).map(|evaluated| evaluated.region);
        let expected = oracle.evaluate(p);
        let is_wrong_owner = oracle.border_distance(p) > BORDER_DISTANCE_FRACTION * s
            && owner != expected.map(|expected| expected.owner);
        let place = || format!("{}: {owner:?}, not {expected:?}", format_point(p));
        checks.never("wrong owner", is_wrong_owner, place);
        if let [Some(one), Some(other)] = by_length.each_ref().map(|list| at(list, i)) {
            evaluation(oracle, p, [one, other], expected, ulp, reference.as_ref(), &mut checks);
        }
    }
    checks.print_line(DEPTH);
    assert_no_misses(&[checks]);
}

/// Compares the evaluations at one point inside, one for each of [`LENGTHS`].
fn evaluation(
    oracle: &dyn Oracle,
    p: [f64; 3],
    by_length: [PointEvaluation; 2],
    expected: Option<OracleEvaluation>,
    ulp: f64,
    reference: Option<&Reference>,
    checks: &mut Checks,
) {
    let PointEvaluation { region: owner, depth, niceness, direction, .. } = by_length[0];
    let whole = [depth, niceness].into_iter().chain(direction);
    let is_sensible = whole.clone().all(f64::is_finite) && depth >= 0.0 && niceness >= 0.0;
    assert!(is_sensible, "{:?} at {}", whole.collect::<Vec<_>>(), format_point(p));
    // The oracle has no evaluation of a point that rounding alone puts inside: its depth is 0.
    let mut deep = expected.map_or(0.0, |expected| expected.depth);
    if (depth - deep).abs() > ULPS_IN_DOUBT * ulp
        && let Some(reference) = reference
    {
        deep = reference.depth(&Meridian::of(exactly(p))).to_f64().max(0.0);
    }
    let is_depth = oracle.magnitude_is_depth();
    let hard = if is_depth { deep } else { expected.map_or(0.0, |expected| expected.magnitude) };
    let place = |what: String| format!("{}; {what}", format_point(p));
    let compared = || place(format!("{depth:e}, not {deep:e}"));
    checks.within(DEPTH, (depth - deep).abs() / ulp, 1.0, compared);
    for (length, PointEvaluation { magnitude, gradient, .. }) in LENGTHS.into_iter().zip(by_length)
    {
        let unit = if is_depth { length } else { 1.0 };
        let error = (magnitude / unit - hard).abs() / ulp;
        let compared = || place(format!("{magnitude:e} at length {length}"));
        checks.within("magnitude [ulp(S)]", error, 1.0, compared);
        assert!(gradient.into_iter().all(f64::is_finite), "{gradient:?} at {}", format_point(p));
    }
    let size = norm(&direction);
    let error = (size - 1.0).abs() / f64::EPSILON;
    checks.within("||u| - 1| [ε]", error, 4.0, || place(format!("{direction:?}")));
    // On a border each of the two neighbours has its own direction.
    let Some(expected) = expected.filter(|expected| expected.owner == owner) else { return };
    let rho = oracle.singularity_distance(p);
    // Exactly where no direction exists, the one that the language fixes is required; but off the axes `hypot` only
    // rounds to such a point.
    let exact = p[0] == 0.0 || p[1] == 0.0;
    let closeness = match rho {
        0.0 if exact => 1.0,
        rho => (ulp / f64::EPSILON / rho.max(ulp)).max(1.0),
    };
    let doubt = closeness * f64::EPSILON;
    let error = distance(&direction, &expected.direction) / doubt;
    let compared = || place(format!("{direction:?}, not {expected:?}, rho {rho:e}"));
    checks.within("direction [ε max(1, S/ρ)]", error, 8.0, compared);
    let error = (niceness - expected.niceness).abs() / ulp;
    let compared = || place(format!("{niceness:e}, not {:e}", expected.niceness));
    checks.within("niceness [ulp(S)]", error, 1.0, compared);
    if rho == 0.0 {
        // A distance has no gradient at a centre; the language fixes a direction only.
        return;
    }
    let slope = oracle.gradient(p).expect("the oracle has the point inside");
    for (length, evaluated) in LENGTHS.into_iter().zip(by_length) {
        let per = if is_depth { 1.0 } else { length };
        let gradient = evaluated.gradient.map(|part| part * per);
        let error = distance(&gradient, &slope) / norm(&slope).max(1.0) / doubt;
        let compared = || place(format!("{gradient:?}, not {slope:?}"));
        checks.within("gradient [ε max(1, S/ρ)]", error, 8.0, compared);
    }
}
