//! Measures the accuracy of compiled evaluators, point by point against 256 bits.
//!
//! Both forms are evaluated, the one for a single point and the one for lanes. They must have the same bits, so
//! their error is measured once.

use super::points::points;
use crate::oracle::big::Big;
use crate::oracle::reference::{QueryPoint, Reference};
use crate::oracle::restated::{self, Restated};
use crate::oracle::{Meridian, Nearest, Oracle};
use touchoff::tool::{Evaluations, Outputs, PointBatch, ToolInfo};
use touchoff::{Level, Tool};

/// Distance in ulp(S) from the surface, or between two owners, within which either answer is right.
pub const AMBIGUITY_ULPS: f64 = 2.0;

/// Number of points that are evaluated at a time.
const POINTS_PER_CHUNK: usize = 1 << 15;

/// The largest error of one kind, and its point.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// The error.
    pub error: f64,
    /// The point, and the region that the evaluator gave it.
    pub location: Option<([f64; 3], String)>,
}

impl Worst {
    fn update(&mut self, error: f64, p: [f64; 3], region: &str) {
        if error.is_nan() || error > self.error {
            *self = Worst { error, location: Some((p, region.to_owned())) };
        }
    }

    /// Formats the point to the last bit.
    pub fn location_exact(&self) -> String {
        let location = self.location.as_ref();
        location.map_or_else(String::new, |(p, region)| format!("`{region}` at {p:?}"))
    }

    /// Formats the point for people: region, d and z.
    pub fn location_rounded(&self) -> String {
        let Some((p, region)) = &self.location else { return String::new() };
        let [d, z] = Meridian::of(*p).dz;
        format!("{region} ({d:.6}, {z:.6})")
    }
}

/// Something that must not happen: its number of occurrences, and the worst case.
#[derive(Clone, Debug, Default)]
pub struct ErrorCount {
    /// Number of occurrences.
    pub count: usize,
    /// The worst case, in ulp(S).
    pub worst: Worst,
}

impl ErrorCount {
    fn add(&mut self, by: f64, p: [f64; 3], region: &str) {
        self.count += 1;
        self.worst.update(by, p, region);
    }
}

/// Results for a tool.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The tool's name.
    pub name: String,
    /// The symbol of its unit.
    pub unit: &'static str,
    /// The next power of two above its largest coordinate, S.
    pub scale: f64,
    /// Number of points evaluated.
    pub points: usize,
    /// Number of points that the evaluator takes for inside.
    pub inside: usize,
    /// Error of the depth, in ulp(S).
    pub depth: Worst,
    /// Points on the wrong side, beyond 2 ulp(S).
    pub wrong_sides: ErrorCount,
    /// Points whose owner is farther than the nearest by more than 2 ulp(S).
    pub wrong_owners: ErrorCount,
    /// Error of the direction's length, in ε.
    pub length: Worst,
    /// Error of the direction, over 8 ε max(1, S/ρ).
    pub direction: Worst,
    /// Error of the distance outside, in ulp(S); 0 if the tool only has a bound of it.
    pub clearance: Worst,
    /// Number of points at which the lanes and the form for a single point differ in a bit.
    pub different_bits: usize,
    /// Number of points with a number that is not finite, a depth or niceness below 0, or a region without an
    /// owner.
    pub invalid: usize,
}

impl Row {
    /// Returns the violations of the contract, section 1 of the accuracy reference.
    pub fn violations(&self) -> Vec<String> {
        let mut violations = Vec::new();
        let mut bar = |what: &str, worst: &Worst, bound: f64| {
            if worst.error > bound || worst.error.is_nan() {
                violations.push(format!(
                    "{what} {:.3} > {bound} in {}",
                    worst.error,
                    worst.location_exact()
                ));
            }
        };
        bar("depth in ulp(S)", &self.depth, 1.0);
        bar("||u| - 1| in ε", &self.length, 4.0);
        bar("direction over its bound", &self.direction, 1.0);
        for (what, wrong) in
            [("wrong sides", &self.wrong_sides), ("wrong owners", &self.wrong_owners)]
        {
            if wrong.count > 0 {
                let (by, location) = (wrong.worst.error, wrong.worst.location_exact());
                violations.push(format!(
                    "{} {what}, the worst by {by:.3} ulp(S) in {location}",
                    wrong.count
                ));
            }
        }
        for (what, count) in [("lanes unlike", self.different_bits), ("senseless", self.invalid)] {
            if count > 0 {
                violations.push(format!("{what}: {count} points"));
            }
        }
        violations
    }
}

/// Returns the tools of the library that are profiles, with their restatements.
pub fn tools() -> Vec<(&'static dyn Tool, Restated)> {
    let restated = restated::all().into_iter();
    restated.filter_map(|tool| Some((tools_library::find(tool.name)?, tool))).collect()
}

/// Measures a tool on about `count` points.
pub fn measure(tool: &dyn Tool, restated: &Restated, count: usize, seed: u64) -> Row {
    let (oracle, reference) = (Nearest::new(restated), Reference::new(restated));
    let points = points(&oracle, count, seed);
    let scale = reference.scale();
    let info = tool.info();
    let mut row = Row {
        name: info.name.to_string(),
        unit: info.unit.symbol(),
        scale,
        points: points.len(),
        ..Row::default()
    };
    let checker = PointChecker::new(tool, &reference, &oracle);
    for chunk in points.chunks(POINTS_PER_CHUNK) {
        let mut list = PointBatch::default();
        chunk.iter().for_each(|p| list.push(*p));
        let [one, lanes] = [Level::baseline(), Level::new()].map(|level| {
            let mut evaluation = Evaluations::default();
            tool.evaluate(level, Outputs::EVERYTHING, &list, 1.0, &mut evaluation);
            evaluation
        });
        for (i, p) in chunk.iter().enumerate() {
            row.different_bits += usize::from(bits(&one, i) != bits(&lanes, i));
            row.add(*p, &checker.check(*p, &one, i), info);
        }
    }
    row
}

/// Returns the oracle's owners for each region of a tool: those of its name, or else all of the surface of that
/// name.
pub fn owners(tool: &dyn Tool, oracle: &Nearest) -> Vec<Vec<usize>> {
    let (names, surfaces) = (oracle.regions(), oracle.surfaces());
    let surfaces: Vec<&str> = surfaces.map(|(surface, _)| surface).collect();
    let indices = |list: &[&str], name: &str| -> Vec<usize> {
        (0..list.len()).filter(|k| list[*k] == name).collect()
    };
    let of = |name: &str| match indices(&names, name) {
        none if none.is_empty() => indices(&surfaces, name),
        some => some,
    };
    tool.info().regions.iter().map(|region| of(&region.name)).collect()
}

/// Returns whether point `i` of an evaluation is inside.
pub fn is_inside(evaluation: &Evaluations, i: usize) -> bool {
    evaluation.inside[i / 8] >> (i % 8) & 1 == 1
}

/// Returns region, depth, magnitude, niceness and direction at point `i`; `None` outside.
fn numbers(evaluation: &Evaluations, i: usize) -> Option<[f64; 7]> {
    is_inside(evaluation, i).then(|| {
        let [x, y, z] = [0, 1, 2].map(|k| evaluation.direction[k][i]);
        [
            evaluation.region[i],
            evaluation.depth[i],
            evaluation.magnitude[i],
            evaluation.niceness[i],
            x,
            y,
            z,
        ]
    })
}

/// Returns the bits of all outputs at point `i`; `None` outside.
pub fn bits(evaluation: &Evaluations, i: usize) -> Option<[u64; 10]> {
    numbers(evaluation, i).map(|n| {
        let g = [0, 1, 2].map(|k| evaluation.gradient[k][i]);
        [n[0], n[1], n[2], n[3], n[4], n[5], n[6], g[0], g[1], g[2]].map(f64::to_bits)
    })
}

/// Checks a tool's evaluations by the contract of section 1 of the accuracy reference.
pub struct PointChecker<'a> {
    tool: &'a dyn Tool,
    reference: &'a Reference,
    owners: Vec<Vec<usize>>,
    /// One ulp(S), the unit of errors.
    pub ulp: f64,
}

/// Distance from the surface, in S, up to which a tool must have its distance outside. Farther than 64 sizes it has
/// a bound.
const MAX_DISTANCE_IN_SIZES: f64 = 16.0;

/// Results for one point.
#[derive(Clone, Debug)]
pub struct PointErrors {
    /// Distance from the surface in ulp(S) if the point is put on the wrong side; 0 if the side is right.
    pub side: f64,
    /// Error of the distance outside, in ulp(S), where the tool has it.
    pub clearance: Option<f64>,
    /// Results for a point that the tool takes for one inside.
    pub inside: Option<InsideErrors>,
}

/// Results for a point inside.
#[derive(Clone, Debug)]
pub struct InsideErrors {
    /// The region that the evaluator gave it.
    pub region: usize,
    /// True if a number is not finite, a depth or niceness is below 0, or the region has no owner.
    pub invalid: bool,
    /// Error of the depth, in ulp(S).
    pub depth: f64,
    /// Distance in ulp(S) by which the owner is farther than the nearest.
    pub owner: f64,
    /// Error of the direction's length, in ε.
    pub length: f64,
    /// Error of the direction, over its bound.
    pub direction: f64,
}

impl<'a> PointChecker<'a> {
    /// Creates a checker of a tool by the reference of its profile.
    pub fn new(tool: &'a dyn Tool, reference: &'a Reference, oracle: &Nearest) -> PointChecker<'a> {
        let owners = owners(tool, oracle);
        PointChecker { tool, reference, owners, ulp: reference.scale() * f64::EPSILON }
    }

    /// Checks point `p`, which is entry `i` of an evaluation.
    pub fn check(&self, p: [f64; 3], evaluation: &Evaluations, i: usize) -> PointErrors {
        let at = QueryPoint::new(p);
        let exact = self.reference.depth(&at);
        let depth = exact.to_f64();
        let answer = numbers(evaluation, i);
        let wrong = answer.is_some() != (depth > 0.0);
        let side = if wrong { depth.abs() / self.ulp } else { 0.0 };
        let Some(answer) = answer else {
            let clearance_error = || (self.tool.clearance(p) + depth).abs() / self.ulp;
            let has_clearance = self.tool.info().is_exact()
                && -depth < MAX_DISTANCE_IN_SIZES * self.reference.scale();
            let clearance = has_clearance.then(clearance_error);
            return PointErrors { side, clearance, inside: None };
        };
        PointErrors { side, clearance: None, inside: Some(self.inside(&at, &exact, answer)) }
    }

    fn inside(&self, at: &QueryPoint, exact: &Big, answer: [f64; 7]) -> InsideErrors {
        let [region, computed_depth, _, niceness, ux, uy, uz] = answer;
        let (region, depth) = (region as usize, exact.to_f64());
        let finite = answer.iter().all(|v| v.is_finite());
        let distance = |owner: &usize| self.reference.distance_to(at, *owner).to_f64();
        let owner =
            self.owners[region].iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied();
        let mut inside = InsideErrors {
            region,
            invalid: !finite || computed_depth < 0.0 || niceness < 0.0 || owner.is_none(),
            depth: f64::NAN,
            owner: 0.0,
            length: 0.0,
            direction: 0.0,
        };
        if !finite {
            return inside;
        }
        // A point that only rounding puts inside has depth 0.
        let depth_error = if depth > 0.0 {
            exact - &Big::exactly(computed_depth)
        } else {
            Big::exactly(computed_depth)
        };
        inside.depth = depth_error.abs().to_f64() / self.ulp;
        let Some(owner) = owner else { return inside };
        if depth > 0.0 {
            inside.owner = (distance(&owner) - depth).max(0.0) / self.ulp;
        }
        let u = [ux, uy, uz].map(Big::exactly);
        let norm = (&(&(&u[0] * &u[0]) + &(&u[1] * &u[1])) + &(&u[2] * &u[2])).sqrt();
        inside.length = (norm.to_f64() - 1.0).abs() / f64::EPSILON;
        let expected = self.reference.direction(at, owner);
        let squared_difference =
            u.iter().zip(&expected).map(|(a, b)| (a - b).to_f64().powi(2)).sum::<f64>();
        let rho = self.reference.singularity_distance(at, owner);
        // Exactly where no direction exists, the one that the language fixes is required.
        let amplification = if rho == 0.0 { 1.0 } else { (self.reference.scale() / rho).max(1.0) };
        inside.direction = squared_difference.sqrt() / (8.0 * f64::EPSILON * amplification);
        inside
    }
}

impl Row {
    /// Adds the results for a point.
    fn add(&mut self, p: [f64; 3], errors: &PointErrors, info: &ToolInfo) {
        if errors.side > AMBIGUITY_ULPS {
            self.wrong_sides.add(errors.side, p, "");
        }
        if let Some(clearance_error) = errors.clearance {
            self.clearance.update(clearance_error, p, "");
        }
        let Some(inside) = &errors.inside else { return };
        let name = &info.regions[inside.region].name;
        self.inside += 1;
        self.invalid += usize::from(inside.invalid);
        self.depth.update(inside.depth, p, name);
        if inside.owner > AMBIGUITY_ULPS {
            self.wrong_owners.add(inside.owner, p, name);
        }
        self.length.update(inside.length, p, name);
        self.direction.update(inside.direction, p, name);
    }
}
