//! The contract of a compiled evaluator, checked against 256 bits at a few points per tool.
//!
//! `cargo run --release -p touchoff-bench -- accuracy` checks a million points per tool.

use touchoff_tests::accuracy::{measure, tools};

const POINTS: usize = 6_000;

#[test]
fn every_tool_meets_the_accuracy_contract() {
    let tools = tools();
    // All tools but the thesis's own, whose magnitudes are not distances, and the two solids.
    assert_eq!(tools.len(), tools_library::TOOLS.len() - 3);
    let mut missed = Vec::new();
    for (tool, restated) in tools {
        let row = measure(tool, &restated, POINTS, 2);
        missed.extend(
            row.violations().into_iter().map(|violation| format!("{}: {violation}", row.name)),
        );
    }
    assert!(missed.is_empty(), "{missed:#?}");
}
