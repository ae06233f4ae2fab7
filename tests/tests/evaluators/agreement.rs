//! All evaluators of a tool have the bits of the reference, which follows the text region by
//! region.

use super::LENGTHS;
use super::points::{scale, shown};
use tool_dsl::Checked;
use tool_dsl::interpret::Interpreter;
use touchoff::Level;
use touchoff::tool::{Ask, Evaluators, Felt, Interpreted, Points, Tool};
use touchoff_tests::oracle::Oracle;

/// The region, and the bits of depth, magnitude, niceness, direction and gradient; `None` outside.
type Answer = Option<(usize, [u64; 9])>;

/// Answers that differ.
#[derive(Default)]
struct Differing {
    what: String,
    count: usize,
    /// The largest distance of such a point from the surface and all splitting curves, in ulp(S).
    farthest: f64,
    examples: Vec<String>,
}

/// Compares answers with others, point by point.
fn compared(
    what: &str,
    oracle: &dyn Oracle,
    points: &[[f64; 3]],
    got: impl Fn(usize) -> Answer,
    expected: impl Fn(usize) -> Answer,
) -> Differing {
    let ulp = scale(oracle) * f64::EPSILON;
    let mut differing = Differing { what: what.to_owned(), ..Differing::default() };
    for (i, p) in points.iter().enumerate() {
        let (got, expected) = (got(i), expected(i));
        if numbers(got) != numbers(expected) {
            differing.count += 1;
            let border = oracle.border(*p) / ulp;
            if differing.examples.len() < 3 || border > differing.farthest {
                let (got, expected) = (numbers(got), numbers(expected));
                let example = format!(
                    "{}, {border:.2} ulp(S) from a border\n  got {got:?}\n  not {expected:?}",
                    shown(*p)
                );
                differing.examples.push(example);
            }
            differing.farthest = differing.farthest.max(border);
        }
    }
    differing
}

/// Compares them all on some points.
pub(crate) fn of<T: Evaluators>(
    tool: T,
    oracle: &dyn Oracle,
    checked: &Checked,
    tape: &Interpreted,
    points: &[[f64; 3]],
) {
    let mut list = Points::default();
    points.iter().for_each(|p| list.push(*p));
    let levels = levels();
    let mut all = Vec::new();
    let mut inside = 0;
    let lost = points.iter().filter(|p| T::contains(**p) != T::owner(**p).is_some()).count();
    for length in LENGTHS {
        let mut reference = Interpreter::new(checked);
        let expected: Vec<Answer> =
            points.iter().map(|p| answer_of(reference.at(*p, length))).collect();
        inside = expected.iter().flatten().count();
        let code: Vec<Answer> = points.iter().map(|p| scalar::<T>(*p, length)).collect();
        all.push(compared("scalar - reference", oracle, points, |i| code[i], |i| expected[i]));
        let felt = evaluated(tape, Level::fallback(), Ask::Everything, &list, length);
        all.push(compared("tape - scalar", oracle, points, |i| at(&felt, i), |i| code[i]));
        all.push(compared("tape - reference", oracle, points, |i| at(&felt, i), |i| expected[i]));
        for ask in [Ask::Inside, Ask::Direction, Ask::Gradient] {
            let part = evaluated(tape, Level::fallback(), ask, &list, length);
            same("the tape", ask, &part, &felt, points.len());
        }
        for (name, level) in &levels {
            let felt = evaluated(&tool, *level, Ask::Everything, &list, length);
            all.push(compared(name, oracle, points, |i| at(&felt, i), |i| code[i]));
            for ask in [Ask::Inside, Ask::Direction, Ask::Gradient] {
                let part = evaluated(&tool, *level, ask, &list, length);
                same(name, ask, &part, &felt, points.len());
            }
        }
    }
    println!(
        "{:20} {:7} points, {inside:7} inside, contains and owner differ at {lost}",
        T::card().name,
        points.len()
    );
    for d in &all {
        if d.count > 0 {
            println!(
                "   {} differs at {}, up to {:.3} ulp(S) from a border\n{}",
                d.what,
                d.count,
                d.farthest,
                d.examples.join("\n")
            );
        }
    }
}

/// Every level of this machine, the best among them twice.
fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = vec![("fallback", Level::fallback()), ("best", best)];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(|token| ("sse2", Level::Sse2(token))));
        levels.extend(best.as_sse4_2().map(|token| ("sse4.2", Level::Sse4_2(token))));
        levels.extend(best.as_avx2().map(|token| ("avx2", Level::Avx2(token))));
        levels.extend(best.as_avx512().map(|token| ("avx512", Level::Avx512(token))));
    }
    levels
}

fn evaluated(tool: &dyn Tool, level: Level, ask: Ask, points: &Points, length: f64) -> Felt {
    let mut felt = Felt::default();
    tool.evaluate(level, ask, points, length, &mut felt);
    felt
}

fn bits(depth: f64, magnitude: f64, niceness: f64, u: [f64; 3], g: [f64; 3]) -> [u64; 9] {
    [depth, magnitude, niceness, u[0], u[1], u[2], g[0], g[1], g[2]].map(f64::to_bits)
}

fn numbers(answer: Answer) -> Option<(usize, [f64; 9])> {
    answer.map(|(region, bits)| (region, bits.map(f64::from_bits)))
}

fn answer_of(felt: Option<tool_dsl::interpret::Felt>) -> Answer {
    felt.map(|f| (f.region, bits(f.depth, f.magnitude, f.niceness, f.direction, f.gradient)))
}

fn scalar<T: Evaluators>(p: [f64; 3], length: f64) -> Answer {
    let owner = T::owner(p);
    owner.filter(|_| T::contains(p)).map(|region| {
        let felt = bits(
            T::depth(p),
            T::magnitude(p, length),
            T::niceness(p),
            T::direction(p),
            T::gradient(p, length),
        );
        (region, felt)
    })
}

fn inside(felt: &Felt, i: usize) -> bool {
    felt.inside[i / 8] >> (i % 8) & 1 == 1
}

fn at(felt: &Felt, i: usize) -> Answer {
    inside(felt, i).then(|| {
        let felt_here = bits(
            felt.depth[i],
            felt.magnitude[i],
            felt.niceness[i],
            [0, 1, 2].map(|k| felt.direction[k][i]),
            [0, 1, 2].map(|k| felt.gradient[k][i]),
        );
        (felt.region[i] as usize, felt_here)
    })
}

/// Asking for less gives the same of it.
fn same(what: &str, ask: Ask, part: &Felt, everything: &Felt, count: usize) {
    assert_eq!(part.inside, everything.inside, "{what}, {ask:?}");
    let lists = |felt: &Felt, i: usize| -> Vec<u64> {
        let mut numbers = Vec::new();
        if ask != Ask::Inside {
            numbers.extend([felt.depth[i], felt.magnitude[i], felt.niceness[i]]);
        }
        if ask.direction() {
            numbers.extend(felt.direction.iter().map(|list| list[i]));
        }
        if ask.gradient() {
            numbers.extend(felt.gradient.iter().map(|list| list[i]));
        }
        numbers.into_iter().map(f64::to_bits).collect()
    };
    for i in (0..count).filter(|i| inside(everything, *i)) {
        assert_eq!(lists(part, i), lists(everything, i), "{what}, {ask:?}, point {i}");
    }
}
