//! Tools with one generated defect each. A defective source text that the compiler accepts must keep the bounds proved
//! for it. A defect introduced after compilation must be detected.

use std::path::Path;
use tool_dsl::interpret::Interpreter;
use tool_dsl::prove::Certificate;
use tool_dsl::source::Source;
use tool_dsl::{CheckedTool, compile};
use touchoff_bench::mutants::{Detection, KINDS, Mutant, detect, differs, mutants};
use touchoff_bench::parallel;
use touchoff_tests::library::library;
use touchoff_tests::oracle::rng::Rng;

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
        let step = 10f64.powf(rng.between(-5.0, -1.0));
        let q = [(p[0] + step * direction[0]).abs(), p[1] + step * direction[1]];
        let other_depth =
            interpreter.evaluate([q[0], 0.0, q[1]], 1.0).map_or(0.0, |evaluation| evaluation.depth);
        let distance_moved = (q[0] - p[0]).hypot(q[1] - p[1]);
        let slack = 1e-9 + proved.tolerance;
        if let Some(lipschitz) = lipschitz
            && (other_depth - evaluation.depth).abs() > lipschitz * distance_moved + slack
        {
            return Some(format!(
                "{} to {other_depth} over {distance_moved} at {p:?}",
                evaluation.depth
            ));
        }
        if let Some(lower_slope) = proved.lower_slope() {
            // Between two of the directions, the surface may be slightly nearer.
            let outside_distance = distance(&mut interpreter, p, size);
            if evaluation.depth < lower_slope * outside_distance * 0.99 - slack {
                return Some(format!(
                    "{} deep and {outside_distance} from outside at {p:?}",
                    evaluation.depth
                ));
            }
        }
    }
    None
}

#[test]
fn accepted_variants_keep_their_proved_bounds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools");
    let (mut rejected, mut jumps, mut bounded, mut open) = (0, 0, 0, 0);
    for name in ["fig_7_3.tool", "cylinder.tool", "unit_sphere.tool"] {
        let text = std::fs::read_to_string(folder.join(name)).expect("the library has the file");
        let mut rng = Rng::new(5);
        for text in variants_with_one_defect(&text) {
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

/// A sample of the page `proofs.md`, with mutants of every tool.
#[test]
fn defects_of_library_tools_are_detected_without_the_originals() {
    // A source stays on its thread.
    let results = parallel::rows(library().len(), |index| {
        let original = *compile(&library()[index]).into_tool().expect("the library compiles");
        let proved = Certificate::prove(&original);
        let diagnostics = proved.diagnostics(&original);
        assert!(diagnostics.is_empty(), "{}: {diagnostics:#?}", original.model.name);
        // Other mutants than those in the table.
        let mut mutants = mutants(&original, 2, 1000 + index as u64);
        mutants.retain(|mutant| differs(&original, &mutant.tool, 1));
        let location = |kind: usize, location: &str| {
            format!("{}: {} at {location}", original.model.name, KINDS[kind])
        };
        let detected = |mutant: &Mutant| {
            (detect(&proved, &mutant.tool), location(mutant.kind, &mutant.location))
        };
        mutants.iter().map(detected).collect::<Vec<_>>()
    });
    let (mut detected, mut compared, mut undetected) = (0, Vec::new(), Vec::new());
    for (detection, location) in results.into_iter().flatten() {
        match detection {
            Detection::Error | Detection::Undecided | Detection::Warning => detected += 1,
            Detection::ByComparison => compared.push(location),
            Detection::Undetected => undetected.push(location),
        }
    }
    println!("{detected} seen, {} by comparing, {} not", compared.len(), undetected.len());
    assert!(
        detected > 50 && 9 * compared.len() <= detected,
        "{detected} seen, by comparing only {compared:#?}"
    );
    assert!(undetected.is_empty(), "{undetected:#?}");
}
