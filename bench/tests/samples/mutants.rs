//! Tools with one generated defect each. A defective source text that the compiler accepts must keep the bounds proved
//! for it. A defect introduced after compilation must be detected.

use std::path::Path;
use tool_dsl::interpret::Interpreter;
use tool_dsl::prove::Certificate;
use tool_dsl::source::Source;
use tool_dsl::{CheckedTool, compile};
use touchoff_bench::mutants::{Caught, KINDS, Mutant, caught, changes, mutants};
use touchoff_bench::parallel;
use touchoff_tests::library::library;
use touchoff_tests::oracle::draw::Rng;

/// Number of points at which bounds are tested.
const POINTS: usize = 400;
/// Number of directions in which the surface is searched for.
const WAYS: usize = 64;

/// Returns variants of a text: each number slightly larger, and each comparison and each sign reversed, one at a time.
/// Comments, strings and everything before the first brace are left unchanged.
fn broken(text: &str) -> Vec<String> {
    let mut all = Vec::new();
    let start = text.find('{').map_or(0, |at| at + 1);
    let mut put = |at: usize, length: usize, new: &str| {
        all.push(format!("{}{new}{}", &text[..at], &text[at + length..]));
    };
    let bytes = text.as_bytes();
    let mut at = start;
    while at < bytes.len() {
        let rest = &text[at..];
        let word = at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if let Some(quoted) = rest.strip_prefix('"') {
            at += 2 + quoted.find('"').unwrap_or(quoted.len());
        } else if bytes[at].is_ascii_digit() && !word {
            let number = |c: char| !(c.is_ascii_digit() || c == '.');
            let length = rest.find(number).unwrap_or(rest.len());
            if let Ok(value) = rest[..length].parse::<f64>() {
                put(at, length, &format!("{}", value * 1.07 + 0.01));
            }
            at += length;
        } else {
            for (old, new) in [("<=", ">="), (">=", "<="), (" + ", " - "), (" - ", " + ")] {
                if rest.starts_with(old) {
                    put(at, old.len(), new);
                }
            }
            at += 1;
        }
    }
    all
}

/// Returns an upper bound of the distance from a point inside to the outside: the nearest point outside along some
/// directions.
fn distance(interpreter: &mut Interpreter<'_>, [d, z]: [f64; 2], size: f64) -> f64 {
    let mut inside = |p: [f64; 2]| interpreter.at([p[0].abs(), 0.0, p[1]], 1.0).is_some();
    let mut least = size;
    for k in 0..WAYS {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / WAYS as f64).sin_cos();
        let at = |s: f64| [d + s * cos, z + s * sin];
        // Coarse steps up to the least distance so far, then bisection.
        let steps = 40;
        let Some(first) = (1..=steps)
            .map(|step| least * f64::from(step) / f64::from(steps))
            .find(|s| !inside(at(*s)))
        else {
            continue;
        };
        let (mut low, mut high) = ((first - least / f64::from(steps)).max(0.0), first);
        for _ in 0..30 {
            let middle = (low + high) / 2.0;
            if inside(at(middle)) { low = middle } else { high = middle }
        }
        least = least.min(high);
    }
    least
}

/// Returns a violation of the bounds proved for a tool, if there is one.
fn wrong(tool: &CheckedTool, proved: &Certificate, draw: &mut Rng) -> Option<String> {
    let cell = tool.extent.cell();
    let size = cell.sides.iter().map(|side| side.high - side.low).fold(0.0, f64::max);
    let mut interpreter = Interpreter::new(tool);
    let most = proved.lipschitz();
    for _ in 0..POINTS {
        let [x, _, z] = cell.sides;
        let p = [draw.between(x.low, x.high), draw.between(z.low, z.high)];
        let Some(evaluation) = interpreter.at([p[0], 0.0, p[1]], 1.0) else { continue };
        let way = draw.direction();
        let step = 10f64.powf(draw.between(-5.0, -1.0));
        let q = [(p[0] + step * way[0]).abs(), p[1] + step * way[1]];
        let there =
            interpreter.at([q[0], 0.0, q[1]], 1.0).map_or(0.0, |evaluation| evaluation.depth);
        let moved = (q[0] - p[0]).hypot(q[1] - p[1]);
        let slack = 1e-9 + proved.tolerance;
        if let Some(most) = most
            && (there - evaluation.depth).abs() > most * moved + slack
        {
            return Some(format!("{} to {there} over {moved} at {p:?}", evaluation.depth));
        }
        if let Some(least) = proved.lower_slope() {
            // Between two of the directions, the surface may be slightly nearer.
            let away = distance(&mut interpreter, p, size);
            if evaluation.depth < least * away * 0.99 - slack {
                return Some(format!("{} deep and {away} from outside at {p:?}", evaluation.depth));
            }
        }
    }
    None
}

#[test]
fn what_passes_keeps_its_bounds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools");
    let (mut refused, mut jumps, mut bounded, mut open) = (0, 0, 0, 0);
    for name in ["fig_7_3.tool", "cylinder.tool", "unit_sphere.tool"] {
        let text = std::fs::read_to_string(folder.join(name)).expect("the library has the file");
        let mut draw = Rng::new(5);
        for text in broken(&text) {
            let Some(tool) = compile(&Source::new(name, &text)).into_tool() else {
                refused += 1;
                continue;
            };
            let proved = Certificate::of(&tool);
            if let Some(found) = wrong(&tool, &proved, &mut draw) {
                panic!("{found}\n{text}");
            }
            match (proved.undecided.is_empty(), proved.is_continuous()) {
                (_, true) => bounded += 1,
                (true, false) => jumps += 1,
                (false, false) => open += 1,
            }
        }
    }
    println!("{refused} refused, {jumps} with jumps, {bounded} bounded, {open} open");
    assert!(refused > 50 && bounded > 10, "{refused} {jumps} {bounded} {open}");
}

/// A sample of the page `proofs.md`, with mutants of every tool.
#[test]
fn broken_tools_of_the_library_are_seen_without_the_whole_ones() {
    // A source stays on its thread.
    let found = parallel::rows(library().len(), |at| {
        let whole = *compile(&library()[at]).into_tool().expect("the library compiles");
        let proved = Certificate::of(&whole);
        let reports = proved.diagnostics(&whole);
        assert!(reports.is_empty(), "{}: {reports:#?}", whole.model.name);
        // Other mutants than those in the table.
        let mut mutants = mutants(&whole, 4, 1000 + at as u64);
        mutants.retain(|mutant| changes(&whole, &mutant.tool, 1));
        let place =
            |kind: usize, place: &str| format!("{}: {} at {place}", whole.model.name, KINDS[kind]);
        let seen =
            |mutant: &Mutant| (caught(&proved, &mutant.tool), place(mutant.kind, &mutant.place));
        mutants.iter().map(seen).collect::<Vec<_>>()
    });
    let (mut seen, mut compared, mut missed) = (0, Vec::new(), Vec::new());
    for (how, place) in found.into_iter().flatten() {
        match how {
            Caught::Error | Caught::Open | Caught::Warning => seen += 1,
            Caught::Compared => compared.push(place),
            Caught::Not => missed.push(place),
        }
    }
    println!("{seen} seen, {} by comparing, {} not", compared.len(), missed.len());
    assert!(
        seen > 100 && 9 * compared.len() <= seen,
        "{seen} seen, by comparing only {compared:#?}"
    );
    assert!(missed.is_empty(), "{missed:#?}");
}
