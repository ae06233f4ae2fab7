//! All evaluators of a tool have the bits of the reference, which follows the text region by region.

use super::points::{format_point, scale};
use super::{LENGTHS, evaluate};
use crate::prelude::*;
use touchoff::tool::{Evaluations, Outputs, PointBatch};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::Interpreter;
use touchoff_tests::evaluations::{at, batch, bits, is_inside, levels, of_reference};

/// The region, and the bits of depth, magnitude, niceness, direction and gradient; `None` outside.
type Answer = Option<(usize, [u64; 9])>;

/// The largest distance from a border, in ulp(S), at which the plan may differ from the list of regions. The plan
/// leaves out tests that cannot fail in real arithmetic, and where three borders meet rounding has points that
/// geometry has not.
const CORNER: f64 = 1.0;

/// Compares all evaluators at some points. Those that follow the plan (code on numbers and on vectors, the tape) have the same
/// bits everywhere; the reference has them too, but for [`CORNER`]s.
pub(crate) fn of(
    tool: &dyn Tool,
    oracle: &dyn Oracle,
    checked: &CheckedTool,
    tape: &Interpreted,
    points: &[[f64; 3]],
) {
    let list = batch(points);
    let mut corners = 0;
    for length in LENGTHS {
        let mut reference = Interpreter::new(checked);
        let code = everything(tool, "baseline", Level::baseline(), &list, length);
        let assert_same_bits = |what: &str, got: &[Answer]| {
            for ((got, expected), p) in got.iter().zip(&code).zip(points) {
                assert_eq!(got, expected, "{what} at {}: {:?}", format_point(*p), numbers(*got));
            }
        };
        assert_same_bits("tape", &everything(tape, "the tape", Level::baseline(), &list, length));
        for (name, level) in levels() {
            assert_same_bits(name, &everything(tool, name, level, &list, length));
        }
        for (p, code) in points.iter().zip(&code) {
            let expected = reference.evaluate(*p, length).map(of_reference).as_ref().map(bits);
            if *code != expected {
                let border = oracle.border_distance(*p) / (scale(oracle) * f64::EPSILON);
                let (code, expected) = (numbers(*code), numbers(expected));
                let point = format_point(*p);
                assert!(border <= CORNER, "{code:?}, not {expected:?} as the reference at {point}");
                corners += 1;
            }
        }
    }
    println!(
        "{:20} {:7} points: code, tape and lanes at {} alike; reference too, but for {corners} answers at corners",
        tool.info().name,
        points.len(),
        levels().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
    );
}

/// Returns all outputs of a tool, after a check that a request for fewer outputs gives the same values.
fn everything(
    tool: &dyn Tool,
    what: &str,
    level: Level,
    list: &PointBatch,
    length: f64,
) -> Vec<Answer> {
    let evaluation = evaluate(tool, level, Outputs::EVERYTHING, list, length);
    for ask in [Outputs::INSIDE, Outputs::DIRECTION, Outputs::GRADIENT] {
        let part = evaluate(tool, level, ask, list, length);
        same(what, ask, &part, &evaluation, list.len());
    }
    (0..list.len()).map(|i| at(&evaluation, i).as_ref().map(bits)).collect()
}

fn numbers(answer: Answer) -> Option<(usize, [f64; 9])> {
    answer.map(|(region, bits)| (region, bits.map(f64::from_bits)))
}

/// Asserts that a request for fewer outputs gives the same values of these.
fn same(what: &str, ask: Outputs, part: &Evaluations, everything: &Evaluations, count: usize) {
    assert_eq!(part.inside, everything.inside, "{what}, {ask:?}");
    let lists = |evaluation: &Evaluations, i: usize| -> Vec<u64> {
        let mut numbers = Vec::new();
        if ask != Outputs::INSIDE {
            numbers.extend([evaluation.depth[i], evaluation.magnitude[i], evaluation.niceness[i]]);
        }
        if ask.direction {
            numbers.extend(evaluation.direction.iter().map(|list| list[i]));
        }
        if ask.gradient {
            numbers.extend(evaluation.gradient.iter().map(|list| list[i]));
        }
        numbers.into_iter().map(f64::to_bits).collect()
    };
    for i in (0..count).filter(|i| is_inside(everything, *i)) {
        assert_eq!(lists(part, i), lists(everything, i), "{what}, {ask:?}, point {i}");
    }
}
