//! Tools with one generated defect each. A defective source text that the compiler accepts must keep the bounds proved
//! for it. A defect introduced after compilation must be detected by the tool's own certificate.
//!
//! `DEFECTS=20 cargo test --release -p touchoff-tests --test compiler mutants -- --nocapture` makes 20 mutants of every
//! library tool, and prints how they were detected.

use rayon::prelude::*;
use touchoff_dsl::diagnostic::any_error;
use touchoff_dsl::expr::Id;
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::number::Number;
use touchoff_dsl::plan::{PlannedTool, Tree};
use touchoff_dsl::prove::Certificate;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};
use touchoff_tests::count::case_count;
use touchoff_tests::library::{self, library};
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::vector::{dot, norm};

/// Number of points at which a mutant is compared with the original tool.
const COMPARED_POINTS: usize = 20_000;
/// Relative difference, in units of the tool's size, below which two depths count as equal.
const SAME_DEPTH_TOLERANCE: f64 = 1e-5;

const KINDS: [&str; 10] = [
    "a depth's sign",
    "a depth's constant",
    "a depth's unit",
    "a direction reversed",
    "a direction turned",
    "a region missing",
    "a region felt as another",
    "an inequality",
    "a curve's constant",
    "a curve's slope",
];

struct Mutant {
    /// Index into [`KINDS`].
    kind: usize,
    location: String,
    tool: PlannedTool,
}

/// The evidence that a mutant is defective.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Detection {
    Error,
    /// A warning, while some part of the proof is undecided.
    Undecided,
    /// A warning, with no part of the proof undecided.
    Warning,
    /// Only a difference from the certificate of the original tool, which no user has.
    ByComparison,
    Undetected,
}

/// Returns up to `count` mutants of a tool. The kinds of defects take turns, from tool to tool as well, and each defect has a random
/// location. A mutant is left out if the tool has no location for it.
fn mutants(tool: &PlannedTool, count: usize, index: usize) -> Vec<Mutant> {
    let mut rng = Rng::new(1000 + index as u64);
    (index..index + count).filter_map(|k| mutant(tool, k % KINDS.len(), &mut rng)).collect()
}

fn mutant(original: &PlannedTool, kind: usize, rng: &mut Rng) -> Option<Mutant> {
    let mut tool = original.clone();
    let size = tool.extent.scale();
    let mut pick = |count: usize| (rng.bits() % count.max(1) as u64) as usize;
    let region = pick(tool.model.regions.len());
    let mut location = tool.model.regions[region].name.clone();
    let graph = &mut tool.model.graph;
    let changed = &mut tool.model.regions[region];
    let number = |value: f64| Number::from_f64(value).expect("a finite number");
    match kind {
        0 => changed.depth = graph.neg(changed.depth),
        1 => {
            let shift = graph.number(number(0.01 * size));
            changed.depth = graph.add(changed.depth, shift);
        }
        2 => {
            let factor = graph.number(number(25.4));
            changed.depth = graph.mul(factor, changed.depth);
        }
        3 => {
            changed.raw_direction.0 = changed.raw_direction.0.map(|component| graph.neg(component));
        }
        4 => {
            // Turns the direction by a right angle in the half plane, or exchanges components in space.
            let [x, y, z] = changed.raw_direction.0;
            changed.raw_direction.0 = [z, y, graph.neg(x)];
        }
        5 => tool.tree = owned(&tool.tree, &|owner| owner.filter(|o| *o != region)),
        6 => {
            let other = (region + 1 + pick(tool.model.regions.len().max(2) - 1))
                .checked_rem(tool.model.regions.len())
                .filter(|other| *other != region)?;
            location = format!("{location} as {}", tool.model.regions[other].name);
            let new_owner =
                |owner: Option<usize>| owner.map(|o| if o == region { other } else { o });
            tool.tree = owned(&tool.tree, &new_owner);
        }
        7 => {
            let mut split = pick(tool.tree.test_count());
            location = format!("split {split}");
            tool.tree = with_split_exchanged(&tool.tree, &mut split);
        }
        _ => {
            let curve = pick(tool.model.curves.len());
            location = format!("curve {curve}");
            let value = tool.model.curves[curve].value;
            let change = match kind {
                8 => graph.number(number(0.01 * size)),
                _ => {
                    let factor = graph.number(number(0.03));
                    let z = graph.coord(touchoff_dsl::expr::Coord::Z);
                    graph.mul(factor, z)
                }
            };
            tool.model.curves[curve].value = graph.add(value, change);
        }
    }
    Some(Mutant { kind, location, tool })
}

/// Returns the tree with another owner for each one.
fn owned(tree: &Tree, other: &impl Fn(Option<usize>) -> Option<usize>) -> Tree {
    match tree {
        Tree::Leaf(owner) => Tree::Leaf(other(*owner)),
        Tree::Split { curve, strict, below, above } => {
            let [below, above] = [below, above].map(|side| Box::new(owned(side, other)));
            Tree::Split { curve: *curve, strict: *strict, below, above }
        }
    }
}

/// Returns the tree with the two sides of one split exchanged. `remaining` is the number of that split in preorder.
fn with_split_exchanged(tree: &Tree, remaining: &mut usize) -> Tree {
    let Tree::Split { curve, strict, below, above } = tree else { return tree.clone() };
    let is_chosen = *remaining == 0;
    *remaining = remaining.wrapping_sub(1);
    let low = Box::new(with_split_exchanged(below, remaining));
    let high = Box::new(with_split_exchanged(above, remaining));
    let (below, above) = if is_chosen { (high, low) } else { (low, high) };
    Tree::Split { curve: *curve, strict: *strict, below, above }
}

/// The depth at a point, and the direction before normalisation.
type Value = (f64, [f64; 3]);

fn evaluation(
    tool: &PlannedTool,
    evaluator: &mut Evaluator<'_>,
    [x, y, z]: [f64; 3],
) -> Option<Value> {
    evaluator.evaluate(EvaluationPoint::new(x, y, z));
    let owner = tool.tree.owner_at(&|curve: usize| evaluator.get(tool.model.curves[curve].value));
    let region = &tool.model.regions[owner?];
    let direction = region.raw_direction.0.map(|component| evaluator.get(component));
    Some((evaluator.get(region.depth), direction))
}

fn evaluator(tool: &PlannedTool) -> Evaluator<'_> {
    let outputs = |region: &touchoff_dsl::model::Region| -> Vec<Id> {
        region.raw_direction.0.into_iter().chain([region.depth]).collect()
    };
    let model = &tool.model;
    let curves = model.curves.iter().map(|curve| curve.value);
    Evaluator::new(&model.graph, model.regions.iter().flat_map(outputs).chain(curves))
}

/// Returns whether a mutant differs from the original in solid, depth or direction at any of `COMPARED_POINTS` random points.
fn differs(original: &PlannedTool, mutant: &PlannedTool, seed: u64) -> bool {
    let mut rng = Rng::new(seed);
    let (mut original_values, mut mutant_values) = (evaluator(original), evaluator(mutant));
    let sides = original.extent.cell().sides;
    let slack = SAME_DEPTH_TOLERANCE * original.extent.scale();
    (0..COMPARED_POINTS).any(|_| {
        let p = sides.map(|side| rng.between(side.low, side.high));
        let first = evaluation(original, &mut original_values, p);
        match (first, evaluation(mutant, &mut mutant_values, p)) {
            (None, None) => false,
            (Some((a, u)), Some((b, v))) => {
                (a - b).abs() > slack || dot(&u, &v) < 0.999 * norm(&u) * norm(&v)
            }
            // Within rounding of the surface, inside and outside may differ.
            (first, second) => first.or(second).is_some_and(|(depth, _)| depth.abs() > slack),
        }
    })
}

/// Returns the evidence that a tool is defective: the diagnostics of its own certificate, or else a difference from the
/// certificate of the original tool. The original must have no diagnostics.
fn detect(original: &Certificate, mutant: &PlannedTool) -> Detection {
    let certificate = Certificate::prove(mutant);
    let diagnostics = certificate.diagnostics(mutant);
    let same = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs(),
        (a, b) => a == b,
    };
    let mut regions = original.regions.iter().zip(&certificate.regions);
    let has_larger_error = regions.any(|(a, b)| {
        let [a, b] = [a, b].map(|region| region.direction_error.map_or(0.0, |error| error.high));
        b > a + 1e-6
    });
    let has_same_bounds = same(original.lower_slope(), certificate.lower_slope())
        && same(original.lipschitz(), certificate.lipschitz());
    let differs = has_larger_error || !has_same_bounds;
    match (any_error(&diagnostics), diagnostics.is_empty(), certificate.undecided.is_empty()) {
        (true, ..) => Detection::Error,
        (false, true, _) if differs => Detection::ByComparison,
        (false, true, _) => Detection::Undetected,
        (false, false, true) => Detection::Warning,
        (false, false, false) => Detection::Undecided,
    }
}

/// Number of points at which bounds are tested.
const POINTS: usize = 400;
/// Number of directions in which the surface is searched for.
const DIRECTIONS: usize = 64;

/// Returns variants of a text: each number slightly larger, and each comparison and each sign reversed, one at a time.
/// Comments, strings and everything before the first brace are left unchanged.
fn variants_with_one_defect(text: &str) -> Vec<String> {
    let mut variants = Vec::new();
    let start = text.find('{').map_or(0, |brace| brace + 1);
    let mut add = |position: usize, length: usize, new: &str| {
        variants.push(format!("{}{new}{}", &text[..position], &text[position + length..]));
    };
    let bytes = text.as_bytes();
    let mut position = start;
    while position < bytes.len() {
        let rest = &text[position..];
        let in_word = position > 0
            && (bytes[position - 1].is_ascii_alphanumeric() || bytes[position - 1] == b'_');
        if rest.starts_with("//") {
            position += rest.find('\n').unwrap_or(rest.len());
        } else if let Some(quoted) = rest.strip_prefix('"') {
            position += 2 + quoted.find('"').unwrap_or(quoted.len());
        } else if bytes[position].is_ascii_digit() && !in_word {
            let not_in_number = |c: char| !(c.is_ascii_digit() || c == '.');
            let length = rest.find(not_in_number).unwrap_or(rest.len());
            if let Ok(value) = rest[..length].parse::<f64>() {
                add(position, length, &format!("{}", value * 1.07 + 0.01));
            }
            position += length;
        } else {
            for (old, new) in [("<=", ">="), (">=", "<="), (" + ", " - "), (" - ", " + ")] {
                if rest.starts_with(old) {
                    add(position, old.len(), new);
                }
            }
            position += 1;
        }
    }
    variants
}

/// Returns an upper bound of the distance from a point inside to the outside: the nearest point outside along some
/// directions.
fn distance(interpreter: &mut Interpreter<'_>, [d, z]: [f64; 2], size: f64) -> f64 {
    let mut inside = |p: [f64; 2]| interpreter.evaluate([p[0].abs(), 0.0, p[1]], 1.0).is_some();
    let mut min_distance = size;
    for k in 0..DIRECTIONS {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
        let point_at = |s: f64| [d + s * cos, z + s * sin];
        // Coarse steps up to the least distance so far, then bisection.
        let steps = 40;
        let Some(first) = (1..=steps)
            .map(|step| min_distance * f64::from(step) / f64::from(steps))
            .find(|s| !inside(point_at(*s)))
        else {
            continue;
        };
        let (mut low, mut high) = ((first - min_distance / f64::from(steps)).max(0.0), first);
        for _ in 0..30 {
            let midpoint = (low + high) / 2.0;
            if inside(point_at(midpoint)) { low = midpoint } else { high = midpoint }
        }
        min_distance = min_distance.min(high);
    }
    min_distance
}

/// Returns a violation of the bounds proved for a tool, if there is one.
fn bound_violation(tool: &CheckedTool, proved: &Certificate, rng: &mut Rng) -> Option<String> {
    let cell = tool.extent.cell();
    let size = cell.sides.iter().map(|side| side.high - side.low).fold(0.0, f64::max);
    let mut interpreter = Interpreter::new(tool);
    let lipschitz = proved.lipschitz();
    for _ in 0..POINTS {
        let [x, _, z] = cell.sides;
        let p = [rng.between(x.low, x.high), rng.between(z.low, z.high)];
        let Some(evaluation) = interpreter.evaluate([p[0], 0.0, p[1]], 1.0) else { continue };
        let direction = rng.direction();
        let step = rng.power(-5.0, -1.0);
        let q = [(p[0] + step * direction[0]).abs(), p[1] + step * direction[1]];
        let other_depth =
            interpreter.evaluate([q[0], 0.0, q[1]], 1.0).map_or(0.0, |evaluation| evaluation.depth);
        let distance_moved = (q[0] - p[0]).hypot(q[1] - p[1]);
        let slack = 1e-9 + proved.tolerance;
        let depth = evaluation.depth;
        let change = (other_depth - depth).abs();
        if lipschitz.is_some_and(|lipschitz| change > lipschitz * distance_moved + slack) {
            return Some(format!("{depth} to {other_depth} over {distance_moved} at {p:?}"));
        }
        if let Some(lower_slope) = proved.lower_slope() {
            // Between two of the directions, the surface may be slightly nearer.
            let outside_distance = distance(&mut interpreter, p, size);
            if depth < lower_slope * outside_distance * 0.99 - slack {
                return Some(format!("{depth} deep, {outside_distance} from outside at {p:?}"));
            }
        }
    }
    None
}

#[test]
fn accepted_variants_keep_their_proved_bounds() {
    let (mut rejected, mut jumps, mut bounded, mut open) = (0, 0, 0, 0);
    for name in ["fig_7_3", "cylinder", "unit_sphere"] {
        let text = library::source(name).text;
        let mut rng = Rng::new(5);
        // Half of them in the gate.
        let step = if case_count("DEFECTS", 1) > 1 { 1 } else { 2 };
        for text in variants_with_one_defect(&text).into_iter().step_by(step) {
            let Some(tool) = compile(&Source::new(name, &text)).into_tool() else {
                rejected += 1;
                continue;
            };
            let proved = Certificate::prove(&tool);
            if let Some(violation) = bound_violation(&tool, &proved, &mut rng) {
                panic!("{violation}\n{text}");
            }
            match (proved.undecided.is_empty(), proved.is_continuous()) {
                (_, true) => bounded += 1,
                (true, false) => jumps += 1,
                (false, false) => open += 1,
            }
        }
    }
    println!("{rejected} refused, {jumps} with jumps, {bounded} bounded, {open} open");
    assert!(rejected > 50 && bounded > 10, "{rejected} {jumps} {bounded} {open}");
}

#[test]
fn defects_of_library_tools_are_detected_without_the_originals() {
    let count = case_count("DEFECTS", 1);
    // A source stays on its thread.
    let results = (0..library().len()).into_par_iter().flat_map_iter(|index| {
        let original = *compile(&library()[index]).into_tool().expect("the library compiles");
        let proved = Certificate::prove(&original);
        let diagnostics = proved.diagnostics(&original);
        assert!(diagnostics.is_empty(), "{}: {diagnostics:#?}", original.model.name);
        let mut mutants = mutants(&original, count, index);
        mutants.retain(|mutant| differs(&original, &mutant.tool, 1));
        let detected = |mutant: Mutant| {
            let Mutant { kind, location, tool } = mutant;
            let defect = format!("{}: {} at {location}", original.model.name, KINDS[kind]);
            (detect(&proved, &tool), defect)
        };
        mutants.into_iter().map(detected).collect::<Vec<_>>()
    });
    let results: Vec<(Detection, String)> = results.collect();
    let detected_by = |detection: Detection| {
        let found = results.iter().filter(|(by, _)| *by == detection).map(|(_, defect)| defect);
        found.collect::<Vec<_>>()
    };
    let [errors, open, warnings] = [Detection::Error, Detection::Undecided, Detection::Warning]
        .map(|detection| detected_by(detection).len());
    let compared = detected_by(Detection::ByComparison);
    let undetected = detected_by(Detection::Undetected);
    println!(
        "{} mutants: {errors} by errors, {open} by open proofs, {warnings} by warnings, {} by comparison, {} not",
        results.len(),
        compared.len(),
        undetected.len(),
    );
    let detected = errors + open + warnings;
    assert!(detected > 20 && 9 * compared.len() <= detected, "by comparison only {compared:#?}");
    assert!(undetected.is_empty(), "{undetected:#?}");
}
