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

/// How closely answers must agree.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Demand {
    /// Any two zeros are alike; and a plan, which leaves out tests that in real arithmetic cannot
    /// fail, may answer otherwise than the list of regions within 1 ulp(S) of a border: where three
    /// of them meet, rounding has points that geometry has not.
    Numbers,
    /// Every bit at every point.
    Bits,
}

/// The largest distance from a border at which [`Demand::Numbers`] lets answers differ, in ulp(S).
const CORNER: f64 = 1.0;

/// Compares all evaluators on some points.
pub(crate) fn of<T: Evaluators>(
    tool: T,
    oracle: &dyn Oracle,
    checked: &Checked,
    tape: &Interpreted,
    points: &[[f64; 3]],
    demand: Demand,
) {
    let mut list = Points::default();
    points.iter().for_each(|p| list.push(*p));
    let mut seen = Seen { oracle, points, demand, corner: 0, wrong: Vec::new() };
    for (i, p) in points.iter().enumerate() {
        let (contained, owned) = (T::contains(*p), T::owner(*p).is_some());
        if contained != owned {
            seen.differ(i, || format!("contains = {contained}, but an owner: {owned}"));
        }
    }
    for length in LENGTHS {
        let mut reference = Interpreter::new(checked);
        let expected: Vec<Answer> =
            points.iter().map(|p| answer_of(reference.at(*p, length))).collect();
        let code: Vec<Answer> = points.iter().map(|p| scalar::<T>(*p, length)).collect();
        let run = everything(tape, "the tape", Level::fallback(), &list, length);
        seen.compare("scalar code against the reference", &code, &expected);
        seen.compare("the tape against the reference", &run, &expected);
        seen.compare("the tape against scalar code", &run, &code);
        for (name, level) in levels() {
            // Lanes and scalar code are one plan: no corner and no zero excuses them.
            let lanes = everything(&tool, name, level, &list, length);
            let differing = (0..points.len()).find(|i| lanes[*i] != code[*i]);
            if let Some(i) = differing {
                let (got, expected) = (numbers(lanes[i]), numbers(code[i]));
                panic!("{name}: {got:?}, not {expected:?} as scalar code at {}", shown(points[i]));
            }
        }
    }
    println!(
        "{:20} {:7} points: scalar code, tape and reference agree but for {} answers at corners; lanes at {} too",
        T::card().name,
        points.len(),
        seen.corner,
        levels().map(|(name, _)| name).collect::<Vec<_>>().join(", "),
    );
    let count = seen.wrong.len();
    assert_eq!(count, 0, "{}", seen.wrong[..count.min(6)].join("\n"));
}

/// What differs so far.
struct Seen<'a> {
    oracle: &'a dyn Oracle,
    points: &'a [[f64; 3]],
    demand: Demand,
    /// Differences that are let pass.
    corner: usize,
    wrong: Vec<String>,
}

impl Seen<'_> {
    fn compare(&mut self, what: &str, got: &[Answer], expected: &[Answer]) {
        for (i, (got, expected)) in got.iter().zip(expected).enumerate() {
            let alike = match self.demand {
                Demand::Numbers => numbers(*got) == numbers(*expected),
                Demand::Bits => got == expected,
            };
            if !alike {
                let (got, expected) = (numbers(*got), numbers(*expected));
                self.differ(i, || format!("{what}: {got:?}, not {expected:?}"));
            }
        }
    }

    fn differ(&mut self, i: usize, what: impl FnOnce() -> String) {
        let p = self.points[i];
        let border = self.oracle.border(p) / (scale(self.oracle) * f64::EPSILON);
        if self.demand == Demand::Numbers && border <= CORNER {
            self.corner += 1;
        } else {
            self.wrong.push(format!("{}, {border:.3} ulp(S) from a border; {}", shown(p), what()));
        }
    }
}

/// Every level of this machine, the best among them twice.
fn levels() -> impl Iterator<Item = (&'static str, Level)> {
    let best = Level::new();
    let mut levels = vec![("fallback", Level::fallback()), ("best", best)];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(|token| ("sse2", Level::Sse2(token))));
        levels.extend(best.as_sse4_2().map(|token| ("sse4.2", Level::Sse4_2(token))));
        levels.extend(best.as_avx2().map(|token| ("avx2", Level::Avx2(token))));
        levels.extend(best.as_avx512().map(|token| ("avx512", Level::Avx512(token))));
    }
    levels.into_iter()
}

fn evaluated(tool: &dyn Tool, level: Level, ask: Ask, points: &Points, length: f64) -> Felt {
    let mut felt = Felt::default();
    tool.evaluate(level, ask, points, length, &mut felt);
    felt
}

/// All that a tool says, after a look at whether it says the same when asked for less.
fn everything(
    tool: &dyn Tool,
    what: &str,
    level: Level,
    list: &Points,
    length: f64,
) -> Vec<Answer> {
    let felt = evaluated(tool, level, Ask::Everything, list, length);
    for ask in [Ask::Inside, Ask::Direction, Ask::Gradient] {
        let part = evaluated(tool, level, ask, list, length);
        same(what, ask, &part, &felt, list.len());
    }
    (0..list.len()).map(|i| at(&felt, i)).collect()
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
