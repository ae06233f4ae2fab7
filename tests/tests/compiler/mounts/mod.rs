//! Tools joined from several files, and values that tools are given from outside.

mod given;
mod joined;
mod laws;
mod macros;
mod refused;

use std::path::Path;
use touchoff_dsl::interpret::{Evaluation, Interpreter};
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};
use touchoff_tests::checks::assert_near;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::texts::rendered;

/// Returns a text that lies among the tools beside these tests.
fn source(text: &str) -> Source {
    let tools = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compiler/mounts/tools");
    Source::new("own.tool", text).with_path(tools.join("own.tool"))
}

/// Returns the tool of a text that must have no diagnostics, except that a mount may clamp a cutting surface, that a
/// niceness may be above 1, and that a magnitude may be steeper than the depth.
fn tool(text: &str) -> Box<CheckedTool> {
    let compiled = compile(&source(text));
    let expected = ["T0522", "T0626", "T0628"];
    let is_expected = compiled.diagnostics().iter().all(|report| expected.contains(&report.code()));
    assert!(is_expected, "{text}\n{}", rendered(&compiled));
    compiled.into_tool().expect("a tool without errors")
}

fn mounts(items: &str) -> String {
    format!("tool T {{ units mm; {items} }}")
}

/// Asserts that both are the same solid with the same regions, and evaluate alike.
fn same(a: &CheckedTool, b: &CheckedTool) {
    let regions = |tool: &CheckedTool| -> Vec<(usize, bool)> {
        let cuts = |surface: usize| tool.model.surfaces[surface].cutting;
        tool.model.regions.iter().map(|r| (r.surface, cuts(r.surface))).collect()
    };
    assert_eq!(regions(a), regions(b));
    assert_near(a.extent.high, b.extent.high, 1e-3, "high");
    assert_near(a.extent.low, b.extent.low, 1e-3, "low");
    let (mut first, mut second) = (Interpreter::new(a), Interpreter::new(b));
    let mut rng = Rng::new(5);
    let mut evaluation = 0;
    for _ in 0..20_000 {
        let [x, y] = [0, 1].map(|_| rng.between(-1.1 * a.extent.radius, 1.1 * a.extent.radius));
        let p = [x, y, rng.between(-0.05 * a.extent.high, 1.05 * a.extent.high)];
        let [a, b] = [first.evaluate(p, 1.0), second.evaluate(p, 1.0)];
        evaluation += usize::from(a.is_some());
        let values = |e: Evaluation| (e.region, e.depth, e.direction, e.magnitude, e.niceness);
        assert_eq!(a.map(values), b.map(values), "{p:?}");
    }
    assert!(evaluation > 1_000, "{evaluation}");
}
