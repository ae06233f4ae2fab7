//! The worst points of an evaluator: errors of all that is felt at one point.

use super::asked::Asked;
use super::{Answer, Climb, Effort, Find, Question};
use std::cmp::Reverse;
use touchoff_tests::accuracy::{DOUBT, Judge, Judged};
use touchoff_tests::oracle::draw::Draw;

/// What is asked of single points, and what it may be.
pub const ASKED: [(Question, f64); 6] = [
    (Question::Depth, 1.0),
    (Question::Direction, 1.0),
    (Question::Length, 4.0),
    (Question::Clearance, f64::INFINITY),
    (Question::Side, DOUBT),
    (Question::Owner, DOUBT),
];

/// How wrong a judged point is.
pub fn error(question: Question, judged: &Judged) -> f64 {
    let inside = judged.inside.as_ref();
    if inside.is_some_and(|inside| inside.senseless) {
        return f64::NAN;
    }
    match question {
        Question::Depth => inside.map_or(0.0, |inside| inside.depth),
        Question::Direction => inside.map_or(0.0, |inside| inside.direction),
        Question::Length => inside.map_or(0.0, |inside| inside.length),
        Question::Owner => inside.map_or(0.0, |inside| inside.owner),
        Question::Clearance => judged.clearance.unwrap_or(0.0),
        _ => judged.side,
    }
}

/// What is found at a point, and how it was found.
fn judged(asked: &mut Asked<'_>, judge: &Judge<'_>, p: [f64; 3]) -> Judged {
    judge.judge(p, asked.at(p), 0)
}

/// The worst of every question, climbed from the worst of the seeds.
pub fn hunt(
    asked: &mut Asked<'_>,
    judge: &Judge<'_>,
    seeds: &[[f64; 3]],
    effort: Effort,
    draw: &mut Draw,
) -> Vec<Answer> {
    let all: Vec<Judged> = seeds.iter().map(|p| judged(asked, judge, *p)).collect();
    ASKED
        .map(|(question, bar)| hunted(asked, judge, (question, bar), (seeds, &all), effort, draw))
        .into()
}

fn hunted(
    asked: &mut Asked<'_>,
    judge: &Judge<'_>,
    (question, bar): (Question, f64),
    (seeds, all): (&[[f64; 3]], &[Judged]),
    effort: Effort,
    draw: &mut Draw,
) -> Answer {
    let errors: Vec<f64> = all.iter().map(|judged| error(question, judged)).collect();
    let mut order: Vec<usize> = (0..seeds.len()).collect();
    // What is not a number comes first.
    order.sort_by(|a, b| errors[*b].total_cmp(&errors[*a]));
    let mut find = Find::default();
    let before = order.first().map_or(0.0, |first| errors[*first]);
    let starts = apart(seeds, &order, effort.starts);
    let size = judge.ulp / f64::EPSILON;
    for start in starts {
        let climb = Climb { steps: effort.steps, reach: 1e-3 * size };
        let best = climb.from(seeds[start], draw, |p| error(question, &judged(asked, judge, p)));
        find.see(best.value, || {
            let region = asked.region(best.place);
            let regions = &asked.tool.card().regions;
            let name = region.map_or("outside", |region| &regions[region].name);
            (format!("`{name}` at {:?}", best.place), vec![best.place])
        });
    }
    Answer { question, find, seeds: before, bar: bar.is_finite().then_some(bar) }
}

/// The first places of an order, half of them the very first and half spread over the rest of its better tenth.
fn apart(seeds: &[[f64; 3]], order: &[usize], count: usize) -> Vec<usize> {
    let first = order.iter().take(count / 2);
    let tenth = &order[..seeds.len().div_ceil(10)];
    let stride = (tenth.len() / count.div_ceil(2)).max(1);
    let mut some: Vec<usize> = first.chain(tenth.iter().step_by(stride)).copied().collect();
    some.truncate(count);
    some.sort_by_key(|place| Reverse(*place));
    some.dedup();
    some
}
