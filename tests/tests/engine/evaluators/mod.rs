//! Every evaluator of every tool of the library: all of them against the reference interpreter to the last bit
//! ([`agreement`]), and against the independent oracles ([`accuracy`]), at the same points ([`points`]).
//!
//! `cargo test -p touchoff-tests --test engine evaluators -- --nocapture` prints a table.

mod accuracy;
mod agreement;
mod info;
mod partitions;
mod points;

use crate::prelude::*;
use touchoff::tool::{Evaluations, Outputs, PointBatch};
use touchoff_dsl::diagnostic::Severity;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};
use touchoff_tests::oracle::{self, Nearest, restated};
use touchoff_tools::TOOLS;

/// Lengths of the file's unit in the part's that are tested: the same unit, and mm in inches.
const LENGTHS: [f64; 2] = [1.0, 1.0 / 25.4];

/// Returns the tool of a text, checked for the reference interpreter.
fn checked(source: &Source) -> CheckedTool {
    let compiled = compile(source);
    let reports = compiled.diagnostics().iter().filter(|report| report.severity != Severity::Note);
    assert_eq!(reports.count(), 0, "a tool of the library has nothing to report but notes");
    *compiled.into_tool().expect("no report, so a tool")
}

/// Returns the tool of a text as it is loaded at run time.
fn interpreted(source: &Source) -> Interpreted {
    Interpreted::parse(source).expect("a tool of the library has no error")
}

fn evaluate(
    tool: &dyn Tool,
    level: Level,
    outputs: Outputs,
    points: &PointBatch,
    length: f64,
) -> Evaluations {
    let mut evaluations = Evaluations::default();
    tool.evaluate(level, outputs, points, length, &mut evaluations);
    evaluations
}

/// Runs a check on every tool of the library, each in a thread that has the tool's name, as its messages then do.
fn for_each_tool(check: fn(&'static dyn Tool, &dyn Oracle, &Source)) {
    let files = library::files();
    assert_eq!([files.len(), oracle::all().len()], [TOOLS.len(); 2]);
    std::thread::scope(|scope| {
        for (tool, file) in TOOLS.iter().zip(files) {
            let name = &tool.info().name;
            let read = move || Source::read(file).expect("the library has the file");
            let thread = std::thread::Builder::new().name(name.to_string());
            let check = move || check(*tool, &*oracle::of(name), &read());
            thread.spawn_scoped(scope, check).expect("a thread");
        }
    });
}

#[test]
fn all_evaluators_agree() {
    for_each_tool(|tool, oracle, source| {
        let points = points::all(oracle, 1);
        let loaded = interpreted(source);
        assert_eq!(loaded.info(), tool.info());
        agreement::of(tool, oracle, &checked(source), &loaded, &points);
        let size = points::scale(oracle);
        agreement::of_slopes_and_boxes(tool, size, &loaded, &points[..points.len().min(4_000)]);
    });
}

#[test]
fn the_card_agrees() {
    for_each_tool(|tool, _, _| match restated::of(&tool.info().name) {
        Some(restated) => info::of(tool, &Nearest::new(&restated)),
        None => assert!(tool.info().outline.is_empty(), "its profile is not restated"),
    });
}

#[test]
fn the_oracle_agrees() {
    for_each_tool(|tool, oracle, _| accuracy::of(tool, oracle, &points::all(oracle, 2)));
}

/// A vector operation that is called and not inlined takes many times as long as its instruction. It leaves a symbol in the
/// program, which has the evaluators of all tools. At AVX2 tests are optimised too little for all to be inlined.
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
#[test]
fn vector_operations_are_inlined() {
    let program = std::env::current_exe().expect("this program");
    let program = std::fs::read(program).expect("its bytes");
    let symbols = |operation: &str| {
        let has =
            |name: &&[u8], part: &str| name.windows(part.len()).any(|at| at == part.as_bytes());
        let names = program.split(|byte| *byte == 0).filter(|name| name.starts_with(b"_"));
        names.filter(|name| has(name, "Avx512") && has(name, operation)).count()
    };
    assert_ne!(symbols("vectorize_avx512"), 0, "no symbols");
    assert_eq!(symbols("__fearless_simd_kernel"), 0);
}
