//! All evaluators of a tool have the bits of the reference, which follows the rule of the text.

use super::points::{format_point, scale};
use super::{LENGTHS, evaluate};
use crate::prelude::*;
use touchoff::Interval;
use touchoff::tool::{Evaluations, Outputs, PointBatch, Symmetry};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::Interpreter;
use touchoff_tests::evaluations::{at, batch, bits, is_inside, levels, of_reference};

/// The region, and the bits of depth, magnitude, niceness, direction and gradient; `None` outside.
type Answer = Option<(usize, [u64; 9])>;

/// The largest distance from a border, in ulp(S), at which the plan may differ from the rule of the text. The plan
/// leaves out tests that cannot fail in real arithmetic, and where three borders meet rounding has points that
/// geometry has not.
const CORNER: f64 = 1.0;

/// Compares all evaluators at some points. Those that follow the plan (generated code and the tool loaded at run time, on
/// numbers and on vectors) have the same bits everywhere; the reference has them too, but for [`CORNER`]s.
pub(crate) fn of(
    tool: &dyn Tool,
    oracle: &dyn Oracle,
    checked: &CheckedTool,
    loaded: &Interpreted,
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
        for (name, level) in levels() {
            assert_same_bits(name, &everything(tool, name, level, &list, length));
            let loaded = everything(loaded, &format!("loaded, {name}"), level, &list, length);
            assert_same_bits(&format!("loaded, {name}"), &loaded);
        }
        for (p, code) in points.iter().zip(&code).step_by(7) {
            let alone = everything(loaded, "alone", Level::new(), &batch(&[*p]), length);
            assert_eq!(alone, [*code], "alone at {}", format_point(*p));
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
        "{:20} {:7} points: code and the loaded tool alike at {}; reference too, but for {corners} answers at corners",
        tool.info().name,
        points.len(),
        levels().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
    );
}

/// Compares the evaluators that follow the plan on dual numbers at some points and, without a profile, on boxes about them.
pub(crate) fn of_slopes_and_boxes(
    tool: &dyn Tool,
    size: f64,
    loaded: &Interpreted,
    points: &[[f64; 3]],
) {
    let mut rng = Rng::new(3);
    let (mut ours, mut others) = (Evaluations::default(), Evaluations::default());
    for p in points {
        let [code, plan] =
            [tool.derivatives(*p, 2.0, &mut ours), loaded.derivatives(*p, 2.0, &mut others)]
                .map(|found| [found.direction, found.gradient].map(|rows| rows.map(exact)));
        assert_eq!(plan, code, "derivatives at {}", format_point(*p));
        let revolved = matches!(tool.info().symmetry, Symmetry::Revolved);
        let [x, y, z] = *p;
        let at = if revolved { [x.hypot(y), 0.0, z] } else { *p };
        let half = size * 10f64.powf(rng.between(-4.0, 0.0));
        let mut sides = at.map(|middle| Interval { low: middle - half, high: middle + half });
        if revolved {
            sides[0].low = sides[0].low.max(0.0);
            sides[1] = Interval { low: 0.0, high: 0.0 };
        }
        let found = (tool.enclose(sides, at, &mut ours), loaded.enclose(sides, at, &mut others));
        let (Some(code), Some(plan)) = found else {
            assert!(tool.info().is_exact() && found.0.is_none() && found.1.is_none());
            continue;
        };
        let [code_values, plan_values] = [&code, &plan].map(|found| {
            let depths = [found.min_depth(), found.max_depth(), found.min_rise([0.6, 0.0, 0.8])];
            (found.inside, found.regions, exact(depths))
        });
        assert_eq!(plan_values, code_values, "{sides:?}");
        // Code does not record that regions side by side leave nothing outside.
        assert!(code.outside || !plan.outside, "{sides:?}");
    }
}

/// Returns the bits of numbers, without the signs of zeros and NaNs: a constant as an operand is a number in code and a dual in
/// the plan, and the slopes of both are 0.
fn exact(numbers: [f64; 3]) -> [u64; 3] {
    numbers
        .map(|number| if number.is_nan() { f64::NAN.to_bits() } else { (number + 0.0).to_bits() })
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
