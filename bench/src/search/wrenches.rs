//! The largest jumps of the wrench: two poses one double apart in one number, between which points of a part change their region.

use super::poses::{Numbers, pose, told};
use super::{Answer, Climb, Effort, Find, Question, neighbours, tool};
use nalgebra::{Point3, Vector3};
use touchoff::{Cloud, Contact, Law, Part, Probe, Tool, Unit};
use touchoff_tests::oracle::draw::Draw;

/// Points along each side of the patch.
const SIDE: i32 = 16;

/// A stretch of poses: the numbers of one, and a way that the stretch goes to either side.
type Stretch = [f64; 12];

/// What changes between two neighbouring poses.
#[derive(Clone, Copy, Debug, Default)]
pub struct Change {
    /// Of the force, by what the points that changed can do: twice their push, as steep as it is, and rounding.
    pub force: f64,
    /// Of `Σ w·m`, by 16 ulp(S) as steep as depth is: what the way, carrying and rounding do to depths at both poses.
    pub integral: f64,
    /// Of the force, by the sum of all pushes.
    pub share: f64,
    /// How many points changed.
    pub points: usize,
}

/// A patch of a plane as wide as the tool: a grid, so that whole rows change at once, of weight 1 together.
///
/// # Panics
/// If the tool has no size.
pub fn patch(tool: &dyn Tool) -> Part {
    let card = tool.card();
    let half = card.radius() * card.unit.to(Unit::Millimetre);
    let step = |k: i32| half * f64::from(2 * k - SIDE + 1) / f64::from(SIDE);
    let points: Vec<_> =
        (0..SIDE * SIDE).map(|k| Point3::new(step(k % SIDE), step(k / SIDE), 0.0)).collect();
    let count = points.len();
    let (normals, ids) = (vec![Vector3::z(); count], (0..count as u32).collect());
    let weights = vec![1.0 / count as f64; count];
    let cloud = Cloud::new(points, normals, ids, weights, Unit::Millimetre);
    Part::from_cloud(&cloud.expect("a grid in a plane"))
}

fn across(probe: &mut Probe<'_>, stretch: Stretch) -> Option<[Numbers; 2]> {
    let [from, to] = [-1.0, 1.0]
        .map(|sign| -> Numbers { std::array::from_fn(|k| stretch[k] + sign * stretch[k + 6]) });
    neighbours(from, to, |numbers| {
        let contacts = pose(*numbers).map(|pose| probe.contacts(&pose));
        let pairs = contacts.into_iter().flatten().map(|c| (c.triangle, c.region));
        pairs.collect::<Vec<_>>()
    })
}

/// What the wrench does between two neighbouring poses.
///
/// # Panics
/// If the numbers are no poses.
pub fn change(probe: &mut Probe<'_>, pair: [Numbers; 2], law: Law, tool: &dyn Tool) -> Change {
    let [a, b] = pair.map(|numbers| {
        let pose = pose(numbers).expect("it was one");
        (probe.wrench(&pose), probe.contacts(&pose).to_vec())
    });
    let moved = |one: &[Contact], other: &[Contact]| -> Vec<Contact> {
        let same =
            |c: &&Contact| !other.iter().any(|o| (o.triangle, o.region) == (c.triangle, c.region));
        one.iter().filter(same).copied().collect()
    };
    let gone = moved(&a.1, &b.1);
    let come = moved(&b.1, &a.1);
    let all = gone.iter().chain(&come);
    let length = tool.card().unit.to(Unit::Millimetre);
    let steep = tool.card().depth.lipschitz.unwrap_or(f64::INFINITY).max(1.0);
    let push = all.map(|c| c.weight * c.magnitude).sum::<f64>();
    let most = match law {
        Law::Gradient => push * steep,
        Law::Thesis | Law::Facing => 2.0 * push,
    };
    let ulp = tool::scale(tool) * length * f64::EPSILON;
    let turn = a.0.integral.max(b.0.integral) * 64.0 * f64::EPSILON;
    let jump = (a.0.force - b.0.force).norm();
    Change {
        force: jump / (most + turn + 16.0 * ulp),
        integral: (a.0.integral - b.0.integral).abs() / (16.0 * steep * ulp),
        share: jump / a.0.integral.max(b.0.integral).max(f64::MIN_POSITIVE),
        points: gone.len().max(come.len()),
    }
}

/// What is climbed, what it is of a change, and what it may be.
type Asked = (Question, fn(&Change) -> f64, Option<f64>);

const ASKED: [Asked; 3] = [
    (Question::ForceShare, |change| change.share, None),
    (Question::ForceJump, |change| change.force, Some(1.0)),
    (Question::IntegralJump, |change| change.integral, Some(1.0)),
];

/// The largest jumps of a tool at a patch, under each law in turn.
pub fn hunt(tool: &dyn Tool, effort: Effort, draw: &mut Draw) -> Vec<Answer> {
    let part = patch(tool);
    let mut answers =
        ASKED.map(|(question, _, bar)| Answer { question, find: Find::default(), seeds: 0.0, bar });
    for law in [Law::Thesis, Law::Gradient, Law::Facing] {
        under(law, (tool, &part), &mut answers, effort, draw);
    }
    answers.into()
}

fn under(
    law: Law,
    (tool, part): (&dyn Tool, &Part),
    answers: &mut [Answer; 3],
    effort: Effort,
    draw: &mut Draw,
) {
    let card = tool.card();
    let size = tool::scale(tool) * card.unit.to(Unit::Millimetre);
    let reach = card.reach().map(|z| z * card.unit.to(Unit::Millimetre));
    let mut probe = Probe::new(part, tool).law(law);
    let mut stretches = Vec::new();
    for k in 0..effort.seeds / 8 {
        let stretch = stretch(k, size, reach, draw);
        if let Some(pair) = across(&mut probe, stretch) {
            stretches.push((stretch, change(&mut probe, pair, law, tool)));
        }
    }
    for (answer, (_, of, _)) in answers.iter_mut().zip(ASKED) {
        stretches.sort_by(|a, b| of(&b.1).total_cmp(&of(&a.1)));
        answer.seeds = stretches.first().map_or(0.0, |s| of(&s.1)).max(answer.seeds);
        for (start, _) in stretches.iter().take(effort.starts / 4) {
            let climb = Climb { steps: effort.steps / 16, reach: 1e-2 * size };
            let best = climb.from(*start, draw, |stretch| {
                let pair = across(&mut probe, stretch);
                pair.map_or(0.0, |pair| of(&change(&mut probe, pair, law, tool)))
            });
            let Some(pair) = across(&mut probe, best.place) else { continue };
            let found = change(&mut probe, pair, law, tool);
            answer.find.see(of(&found), || {
                let [a, b] = pair.map(told);
                let Change { share, points, .. } = found;
                let what = format!("{law}, {points} points, {share:.3} of Σ w·m: {a} | {b}");
                (what, Vec::new())
            });
        }
    }
}

/// Upright, so that rows of the grid change together, or any way; the tool's axis in the patch or somewhere near.
fn stretch(k: usize, size: f64, [low, high]: [f64; 2], draw: &mut Draw) -> Stretch {
    let mut stretch = [0.0; 12];
    let upright = k.is_multiple_of(2);
    if !upright {
        let way = draw.direction();
        let turn = draw.between(0.0, 1.0);
        stretch[3..6].iter_mut().zip(way).for_each(|(to, c)| *to = turn * c);
    }
    let across = if k.is_multiple_of(4) { 0.0 } else { 0.3 * size };
    for to in &mut stretch[..2] {
        *to = draw.between(-across, across);
    }
    stretch[2] = -draw.between(low, high);
    let reach = size * 10f64.powf(draw.between(-6.0, -1.0));
    let along = if k.is_multiple_of(3) { 2..3 } else { 0..6 };
    for axis in along {
        stretch[6 + axis] = draw.between(-1.0, 1.0) * if axis < 3 { reach } else { reach / size };
    }
    stretch
}
