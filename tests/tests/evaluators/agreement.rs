//! All evaluators of a tool have the bits of the reference, which follows the text region by
//! region.

use super::LENGTHS;
use super::points::shown;
use tool_dsl::Checked;
use tool_dsl::interpret::Interpreter;
use touchoff::Level;
use touchoff::tool::{Ask, Evaluators, Felt, Interpreted, Points, Tool};

/// The region, and the bits of depth, magnitude, niceness, direction and gradient; `None` outside.
type Answer = Option<(usize, [u64; 9])>;

/// Compares them all on some points.
pub(crate) fn of<T: Evaluators>(
    tool: T,
    checked: &Checked,
    tape: &Interpreted,
    points: &[[f64; 3]],
) {
    let mut list = Points::default();
    points.iter().for_each(|p| list.push(*p));
    let levels = levels();
    let names: Vec<&str> = levels.iter().map(|(name, _)| *name).collect();
    let mut inside = 0;
    for length in LENGTHS {
        let mut reference = Interpreter::new(checked);
        let expected: Vec<Answer> =
            points.iter().map(|p| answer_of(reference.at(*p, length))).collect();
        inside = expected.iter().flatten().count();
        let compare = |what: &str, got: &dyn Fn(usize) -> Answer| {
            let differing: Vec<usize> =
                (0..points.len()).filter(|i| got(*i) != expected[*i]).collect();
            let shown: String = differing
                .iter()
                .take(5)
                .map(|&i| {
                    let (got, expected) = (numbers(got(i)), numbers(expected[i]));
                    format!("\n{}\n  got {got:?}\n  not {expected:?}", shown(points[i]))
                })
                .collect();
            let count = differing.len();
            assert_eq!(count, 0, "{what} at length {length} differs from the reference{shown}");
        };
        compare("scalar code", &|i| scalar::<T>(points[i], length));
        let everything = evaluated(tape, Level::fallback(), Ask::Everything, &list, length);
        compare("the tape", &|i| at(&everything, i));
        for (name, level) in &levels {
            let everything = evaluated(&tool, *level, Ask::Everything, &list, length);
            compare(name, &|i| at(&everything, i));
            for ask in [Ask::Inside, Ask::Direction, Ask::Gradient] {
                let part = evaluated(&tool, *level, ask, &list, length);
                same(name, ask, &part, &everything, points.len());
            }
        }
        for ask in [Ask::Inside, Ask::Direction, Ask::Gradient] {
            let part = evaluated(tape, Level::fallback(), ask, &list, length);
            same("the tape", ask, &part, &everything, points.len());
        }
    }
    println!(
        "{:20} {:7} points, {inside:7} inside: scalar, tape, {} have the reference's bits",
        T::card().name,
        points.len(),
        names.join(", "),
    );
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
    assert_eq!(T::contains(p), owner.is_some(), "inside and without an owner: {}", shown(p));
    owner.map(|region| {
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
