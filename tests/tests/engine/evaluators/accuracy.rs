//! A tool's evaluators against its oracle, within the contract of a generated evaluator: depth to 1 ulp(S), the
//! side certain beyond 2 ulp(S), unit directions to 8 ε · max(1, S/ρ). S is the next power of two above the tool's
//! largest coordinate, and ρ the distance to the nearest point at which the direction does not exist.

use super::points::{format_point, scale};
use super::{LENGTHS, evaluate};
use touchoff::Level;
use touchoff::tool::{Outputs, PointEvaluation, Tool};
use touchoff_tests::evaluations::{at, batch};
use touchoff_tests::oracle::reference::{QueryPoint, Reference};
use touchoff_tests::oracle::{Oracle, OracleEvaluation, restated};

/// Distance from a border, as a fraction of S, within which either neighbour may own a point.
const BORDER_DISTANCE_FRACTION: f64 = 1e-12;

/// Error in ulp(S) beyond which the oracle, itself in doubles, is doubted, and 256 bits decide.
const ULPS_IN_DOUBT: f64 = 0.5;

/// The largest error of one kind, and its point.
#[derive(Default)]
struct Worst {
    error: f64,
    place: String,
}

impl Worst {
    fn see(&mut self, error: f64, p: [f64; 3], more: impl FnOnce() -> String) {
        if error.is_nan() || error > self.error {
            *self = Worst { error, place: format!("{}; {}", format_point(p), more()) };
        }
    }

    fn within(&self, bound: f64, what: &str) {
        // A NaN fails this comparison.
        assert!(self.error <= bound, "{what}: {} > {bound} at {}", self.error, self.place);
    }
}

/// Results for a tool.
#[derive(Default)]
struct Findings {
    /// Error of the depth, in ulp(S).
    depth: Worst,
    /// Error of the magnitude, in ulp(S), with the change of the unit of length taken out.
    magnitude: Worst,
    /// Error of the direction, in ε · max(1, S/ρ).
    direction: Worst,
    /// Error of the direction's length, in ε.
    length: Worst,
    /// Error of the gradient, in ε · max(1, S/ρ), relative to the gradient's size where that is above 1.
    gradient: Worst,
    /// Error of the niceness, in ulp(S).
    niceness: Worst,
    sides: Vec<String>,
    owners: Vec<String>,
}

/// Compares a tool with its oracle at some points, prints a row and asserts the contract.
pub(crate) fn of(tool: &dyn Tool, oracle: &dyn Oracle, points: &[[f64; 3]]) {
    let s = scale(oracle);
    let ulp = s * f64::EPSILON;
    let reference = restated::of(oracle.name()).map(|tool| Reference::new(&tool));
    let mut found = Findings::default();
    let mut inside = 0;
    let list = batch(points);
    let by_length =
        LENGTHS.map(|length| evaluate(tool, Level::baseline(), Outputs::EVERYTHING, &list, length));
    for (i, &p) in points.iter().enumerate() {
        let distance = oracle.signed_distance(p);
        let contained = at(&by_length[0], i).is_some();
        if distance.abs() > 2.0 * ulp && contained != (distance < 0.0) {
            found.sides.push(format!(
                "contains = {contained}, distance {distance:e}: {}",
                format_point(p)
            ));
        }
        let owner = at(&by_length[0], i).map(|evaluated| evaluated.region);
        let expected = oracle.evaluate(p);
        if oracle.border_distance(p) > BORDER_DISTANCE_FRACTION * s
            && owner != expected.map(|expected| expected.owner)
        {
            found.owners.push(format!("{owner:?}, not {expected:?}: {}", format_point(p)));
        }
        if let [Some(one), Some(other)] = by_length.each_ref().map(|list| at(list, i)) {
            inside += 1;
            evaluation(oracle, p, [one, other], expected, ulp, reference.as_ref(), &mut found);
        }
    }
    println!(
        "{:20} {:7} points {inside:7} inside | ulp(S): depth {:.3}, magnitude {:.3}, niceness {:.3} \
         | ε·max(1, S/ρ): direction {:.3}, gradient {:.3} | ||u|-1| {:.2} ε | wrong sides {}, owners {}",
        oracle.name(),
        points.len(),
        found.depth.error,
        found.magnitude.error,
        found.niceness.error,
        found.direction.error,
        found.gradient.error,
        found.length.error,
        found.sides.len(),
        found.owners.len(),
    );
    assert!(found.sides.is_empty(), "wrong sides: {:#?}", &found.sides[..found.sides.len().min(5)]);
    assert!(
        found.owners.is_empty(),
        "wrong owners: {:#?}",
        &found.owners[..found.owners.len().min(5)]
    );
    found.length.within(4.0, "||u| - 1| in ε");
    found.direction.within(8.0, "direction in ε · max(1, S/ρ)");
    found.gradient.within(8.0, "gradient in ε · max(1, S/ρ)");
    found.depth.within(1.0, "depth in ulp(S)");
    found.magnitude.within(1.0, "magnitude in ulp(S)");
    found.niceness.within(1.0, "niceness in ulp(S)");
}

/// Compares the evaluations at one point inside, one for each of [`LENGTHS`].
fn evaluation(
    oracle: &dyn Oracle,
    p: [f64; 3],
    by_length: [PointEvaluation; 2],
    expected: Option<OracleEvaluation>,
    ulp: f64,
    reference: Option<&Reference>,
    found: &mut Findings,
) {
    let PointEvaluation { region: owner, depth, niceness, direction, .. } = by_length[0];
    let whole = [depth, niceness].into_iter().chain(direction);
    assert!(
        whole.clone().all(f64::is_finite),
        "{:?} at {}",
        whole.collect::<Vec<_>>(),
        format_point(p)
    );
    assert!(depth >= 0.0 && niceness >= 0.0, "{depth} {niceness} at {}", format_point(p));
    // The oracle has no evaluation of a point that rounding alone puts inside: its depth is 0.
    let mut deep = expected.map_or(0.0, |expected| expected.depth);
    if (depth - deep).abs() > ULPS_IN_DOUBT * ulp
        && let Some(reference) = reference
    {
        deep = reference.depth(&QueryPoint::new(p)).to_f64().max(0.0);
    }
    let is_depth = magnitude_is_depth(oracle);
    let hard = if is_depth { deep } else { expected.map_or(0.0, |expected| expected.magnitude) };
    found.depth.see((depth - deep).abs() / ulp, p, || format!("{depth:e}, not {deep:e}"));
    for (length, PointEvaluation { magnitude, gradient, .. }) in LENGTHS.into_iter().zip(by_length)
    {
        let unit = if is_depth { length } else { 1.0 };
        let error = (magnitude / unit - hard).abs() / ulp;
        found.magnitude.see(error, p, || format!("{magnitude:e} at length {length}"));
        assert!(gradient.into_iter().all(f64::is_finite), "{gradient:?} at {}", format_point(p));
    }
    let size = norm(direction);
    found.length.see((size - 1.0).abs() / f64::EPSILON, p, || format!("{direction:?}"));
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
    found.direction.see(distance(direction, expected.direction) / doubt, p, || {
        format!("{direction:?}, not {:?}, rho {rho:e}", expected.direction)
    });
    let error = (niceness - expected.niceness).abs() / ulp;
    found.niceness.see(error, p, || format!("{niceness:e}, not {:e}", expected.niceness));
    if rho == 0.0 {
        // A distance has no gradient at a centre; the language fixes a direction only.
        return;
    }
    let slope = oracle.gradient(p).expect("the oracle has the point inside");
    for (length, evaluated) in LENGTHS.into_iter().zip(by_length) {
        let per = if is_depth { 1.0 } else { length };
        let gradient = evaluated.gradient.map(|part| part * per);
        let error = distance(gradient, slope) / norm(slope).max(1.0) / doubt;
        found.gradient.see(error, p, || format!("{gradient:?}, not {slope:?}"));
    }
}

/// Returns whether a tool's magnitude is its depth. Only the thesis's own tool of the library writes `magnitude`; a
/// `magnitude` that is the depth is a length, and changes with the part's unit.
fn magnitude_is_depth(oracle: &dyn Oracle) -> bool {
    oracle.name() != "Fig73"
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|part| part * part).sum::<f64>().sqrt()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm([a[0] - b[0], a[1] - b[1], a[2] - b[2]])
}
