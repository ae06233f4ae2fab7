//! The largest jumps between neighbours: two points one double apart, on the two sides of a border of regions.

use super::asked::Asked;
use super::{Answer, Climb, Effort, Find, Question, neighbours};
use tool_dsl::CheckedTool;
use tool_dsl::prove::Certificate;
use touchoff::tool::Felt;
use touchoff_tests::accuracy::{Judge, inside};
use touchoff_tests::oracle::draw::Draw;

/// What is asked of neighbours.
pub const ASKED: [Question; 6] = [
    Question::DepthJump,
    Question::MagnitudeJump,
    Question::PushJump,
    Question::NicenessJump,
    Question::Side,
    Question::Owner,
];

/// A stretch across a border: a point and a way, which the stretch goes to either side.
type Stretch = [f64; 6];

/// The neighbours on a stretch that have different owners, or lie on two sides of the axis: there directions turn as well.
fn across(asked: &mut Asked<'_>, [x, y, z, vx, vy, vz]: Stretch) -> Option<[[f64; 3]; 2]> {
    let [from, to] = [[x - vx, y - vy, z - vz], [x + vx, y + vy, z + vz]];
    neighbours(from, to, |p| (asked.region(*p), p[0] < 0.0, p[1] < 0.0))
}

fn jump(question: Question, [a, b]: [&Felt; 2], ulp: f64) -> f64 {
    let of = |list: fn(&Felt) -> &Vec<f64>| (list(a)[0] - list(b)[0]).abs();
    match question {
        Question::DepthJump => of(|felt| &felt.depth) / ulp,
        Question::MagnitudeJump => of(|felt| &felt.magnitude) / ulp,
        Question::NicenessJump => of(|felt| &felt.niceness),
        _ => {
            let push = |felt: &Felt, k: usize| felt.depth[0] * felt.direction[k][0];
            (0..3).map(|k| (push(a, k) - push(b, k)).powi(2)).sum::<f64>().sqrt()
        }
    }
}

/// What a question finds in two neighbours.
pub fn measured(
    question: Question,
    pair: [[f64; 3]; 2],
    asked: &mut Asked<'_>,
    judge: Option<&Judge<'_>>,
    ulp: f64,
) -> f64 {
    let felt = pair.map(|p| asked.at(p).clone());
    let within = felt.each_ref().map(|felt| inside(felt, 0));
    match question {
        Question::Side | Question::Owner => {
            let Some(judge) = judge else { return f64::NEG_INFINITY };
            // Of borders inside only owners can be wrong, elsewhere only sides.
            if (within == [true; 2]) != (question == Question::Owner) {
                return f64::NEG_INFINITY;
            }
            let judged = [0, 1].map(|k| judge.judge(pair[k], &felt[k], 0));
            judged.iter().map(|at| super::evaluator::error(question, at)).fold(0.0, f64::max)
        }
        _ if within == [true; 2] => jump(question, felt.each_ref(), ulp),
        _ if within == [false; 2] => f64::NEG_INFINITY,
        // Beside the surface depth and magnitude go to 0.
        Question::DepthJump | Question::MagnitudeJump => {
            let inner = &felt[usize::from(within[1])];
            let deep =
                if question == Question::DepthJump { &inner.depth } else { &inner.magnitude };
            deep[0] / ulp
        }
        _ => 0.0,
    }
}

/// The largest jump of every question, from stretches between seeds and points near them.
pub fn hunt(
    asked: &mut Asked<'_>,
    judge: Option<&Judge<'_>>,
    (seeds, ulp): (&[[f64; 3]], f64),
    bars: Bars,
    effort: Effort,
    draw: &mut Draw,
) -> Vec<Answer> {
    let size = ulp / f64::EPSILON;
    let mut stretches = Vec::new();
    for k in 0..4 * effort.seeds {
        let seed = seeds[(k * 7919) % seeds.len()];
        let reach = size * 10f64.powf(draw.between(-9.0, -0.5));
        let way = draw.direction().map(|c| reach * c);
        let [[x, y, z], [vx, vy, vz]] = [seed, way];
        let stretch = [x, y, z, vx, vy, vz];
        if let Some(pair) = across(asked, stretch) {
            stretches.push((stretch, pair));
        }
    }
    let judged = |question: &Question| {
        judge.is_some() || !matches!(question, Question::Side | Question::Owner)
    };
    let answer = |question| {
        let values: Vec<f64> = stretches
            .iter()
            .enumerate()
            // Judging is dear: of questions that want it, some of the seeds.
            .map(|(k, (_, pair))| match question {
                Question::Side | Question::Owner if k % 8 > 0 => f64::NEG_INFINITY,
                _ => measured(question, *pair, asked, judge, ulp),
            })
            .collect();
        let mut order: Vec<usize> = (0..stretches.len()).collect();
        order.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
        let mut find = Find::default();
        for start in order.iter().take(effort.starts) {
            let climb = Climb { steps: effort.steps / 2, reach: 1e-2 * size };
            let best =
                climb.from(stretches[*start].0, draw, |stretch| match across(asked, stretch) {
                    Some(pair) => measured(question, pair, asked, judge, ulp),
                    None => f64::NEG_INFINITY,
                });
            let Some(pair) = across(asked, best.place) else { continue };
            find.see(best.value, || (told(asked, pair), pair.to_vec()));
        }
        let seeds = order.first().map_or(0.0, |first| values[*first].max(0.0));
        Answer { question, find, seeds, bar: bars.of(question) }
    };
    ASKED.into_iter().filter(judged).map(answer).collect()
}

fn told(asked: &mut Asked<'_>, pair: [[f64; 3]; 2]) -> String {
    let [a, b] = pair.map(|p| {
        let region = asked.region(p);
        let regions = &asked.tool.card().regions;
        region.map_or_else(|| "outside".to_owned(), |region| regions[region].name.to_string())
    });
    format!("`{a}` | `{b}` at {:?} | {:?}", pair[0], pair[1])
}

/// What jumps may be.
#[derive(Clone, Copy, Debug)]
pub struct Bars {
    /// Of depth and magnitude, in ulp(S): half of one for the way, and an error of one on both sides or, beside the surface, one and two
    /// of doubt; all as steep as depth is.
    pub depth: Option<f64>,
    /// Of direction times depth, as proved of the borders, in the file's unit.
    pub push: Option<f64>,
    /// Of niceness: no more than there is of it.
    pub niceness: Option<f64>,
}

impl Bars {
    /// What the card and the certificate say.
    pub fn new(asked: &Asked<'_>, checked: &CheckedTool) -> Bars {
        let certificate = Certificate::of(checked);
        let lipschitz = asked.tool.card().depth.lipschitz;
        let regions = &certificate.regions;
        let turned =
            |depth: f64, turn: f64| 2.0 * depth * (turn.min(std::f64::consts::PI) / 2.0).sin();
        let inner = certificate.borders.iter().filter(|border| border.between.1.is_some());
        let joins = inner.map(|b| turned(b.depth.high, b.turn.high) + b.jump.high);
        // On an axis and at a centre the direction is any.
        let free = regions.iter().filter(|region| region.on_axis || !region.singular.is_empty());
        let push = joins.chain(free.map(|region| 2.0 * region.depth.high)).fold(0.0, f64::max);
        let niceness = regions.iter().map(|region| region.niceness.high).fold(0.0, f64::max);
        Bars {
            depth: lipschitz.map(|steep| 3.5 * steep.max(1.0)),
            push: certificate.undecided.is_empty().then_some(push),
            niceness: Some(niceness),
        }
    }

    fn of(self, question: Question) -> Option<f64> {
        match question {
            Question::DepthJump | Question::MagnitudeJump => self.depth,
            Question::PushJump => self.push,
            Question::NicenessJump => self.niceness,
            _ => Some(touchoff_tests::accuracy::DOUBT),
        }
    }
}
