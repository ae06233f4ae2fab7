//! Tools joined from several files, and values that tools are given from outside.

mod given;
mod joined;
mod laws;
mod macros;
mod refused;

use std::path::Path;
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, Compiled, compile};
use touchoff_tests::oracle::rng::Rng;

/// Returns a text that lies among the tools beside these tests.
fn source(text: &str) -> Source {
    let tools = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compiler/mounts/tools");
    Source::new("own.tool", text).with_path(tools.join("own.tool"))
}

fn said(compiled: &Compiled) -> String {
    let all: Vec<String> = compiled
        .diagnostics()
        .iter()
        .map(|report| report.render(&compiled.sources, false))
        .collect();
    all.join("\n")
}

/// Returns the tool of a text that must have no diagnostics, except that a mount may clamp a cutting surface.
fn tool(text: &str) -> Box<CheckedTool> {
    let compiled = compile(&source(text));
    let is_expected = compiled.diagnostics().iter().all(|report| report.code() == "T0522");
    assert!(is_expected, "{text}\n{}", said(&compiled));
    compiled.into_tool().expect("a tool without errors")
}

fn mounts(items: &str) -> String {
    format!("tool T {{ units mm; {items} }}")
}

/// Asserts that both are the same solid with the same regions, and evaluate alike to a fraction `part` of the
/// tool's size.
fn same(a: &CheckedTool, b: &CheckedTool, part: f64) {
    let regions = |tool: &CheckedTool| -> Vec<(usize, bool)> {
        let cuts = |surface: usize| tool.model.surfaces[surface].cutting;
        tool.model.regions.iter().map(|r| (r.surface, cuts(r.surface))).collect()
    };
    assert_eq!(regions(a), regions(b));
    let slack = part * a.extent.radius.max(a.extent.high);
    assert!(
        (a.extent.high - b.extent.high).abs() <= 1e-3
            && (a.extent.low - b.extent.low).abs() <= 1e-3
    );
    let (mut first, mut second) = (Interpreter::new(a), Interpreter::new(b));
    let mut rng = Rng::new(5);
    let mut evaluation = 0;
    for _ in 0..20_000 {
        let [x, y] = [0, 1].map(|_| rng.between(-1.1 * a.extent.radius, 1.1 * a.extent.radius));
        let p = [x, y, rng.between(-0.05 * a.extent.high, 1.05 * a.extent.high)];
        match (first.evaluate(p, 1.0), second.evaluate(p, 1.0)) {
            (None, None) => {}
            (Some(a), Some(b)) if part == 0.0 => {
                evaluation += 1;
                assert_eq!(
                    (a.region, a.depth, a.direction),
                    (b.region, b.depth, b.direction),
                    "{p:?}"
                );
                assert_eq!((a.magnitude, a.niceness), (b.magnitude, b.niceness), "{p:?}");
            }
            (Some(a), Some(b)) => {
                evaluation += 1;
                let near = |a: f64, b: f64| assert!((a - b).abs() <= slack, "{a}, {b} at {p:?}");
                near(a.depth, b.depth);
                near(a.magnitude, b.magnitude);
                near(a.niceness, b.niceness);
            }
            (a, b) => {
                let depth = a.or(b).map_or(0.0, |evaluation| evaluation.depth);
                assert!(part > 0.0 && depth <= slack, "one is inside at {p:?}");
            }
        }
    }
    assert!(evaluation > 1_000, "{evaluation}");
}
