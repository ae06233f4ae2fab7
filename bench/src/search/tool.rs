//! All that is hunted for of one tool.

use super::asked::Asked;
use super::borders::Bars;
use super::{Answer, Effort, Find, borders, certified, clouds, evaluator, wrenches};
use touchoff::Tool;
use touchoff_tests::accuracy::Judge;
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::{self, Nearest, restated};
use touchoff_tests::points::points;

/// What was found of a tool.
#[derive(Clone, Debug)]
pub struct Hunted {
    /// Its name.
    pub name: String,
    /// The word for its unit.
    pub unit: &'static str,
    /// Whether 256 bits know it.
    pub judged: bool,
    /// The answers.
    pub answers: Vec<Answer>,
    /// Points that all forms were asked about.
    pub compared: usize,
    /// Where forms differ.
    pub unlike: Vec<Find>,
}

/// The names of the library's tools, in the order of the page.
pub fn names() -> Vec<String> {
    let mut names: Vec<String> =
        tools_library::TOOLS.iter().map(|tool| tool.card().name.to_string()).collect();
    names.sort();
    names
}

/// Hunts a tool of the library.
///
/// # Panics
/// If the library has no tool of that name.
pub fn hunt(name: &str, effort: Effort, seed: u64) -> Hunted {
    let tool = tools_library::find(name).expect("a tool of the library");
    let (interpreted, checked) = touchoff_tests::library::read(name);
    let mut asked = Asked::new(tool, &interpreted);
    let mut draw = Draw::new(
        seed ^ name
            .bytes()
            .fold(0, |sum: u64, byte| sum.wrapping_mul(31).wrapping_add(u64::from(byte))),
    );
    let restated = restated::of(name);
    let known = restated.as_ref().map(|tool| (Nearest::new(tool), Reference::new(tool)));
    let judge = known.as_ref().map(|(oracle, reference)| Judge::new(tool, reference, oracle));
    let seeds = match &known {
        Some((oracle, _)) => points(oracle, effort.seeds, draw.bits()),
        None => beside_curves(name, effort.seeds, &mut draw),
    };
    let mut answers = match &judge {
        Some(judge) => evaluator::hunt(&mut asked, judge, &seeds, effort, &mut draw),
        None => Vec::new(),
    };
    let bars = Bars::new(&asked, &checked);
    let ulp = scale(tool) * f64::EPSILON;
    for found in borders::hunt(&mut asked, judge.as_ref(), (&seeds, ulp), bars, effort, &mut draw) {
        take(&mut answers, found);
    }
    answers.extend(wrenches::hunt(tool, effort, &mut draw));
    if let Some((oracle, reference)) = &known {
        answers.extend(clouds::hunt(tool, (oracle, reference), effort, &mut draw));
        answers.extend(certified::hunt(tool, (oracle, reference), effort, &mut draw));
    }
    asked.compare();
    Hunted {
        name: name.to_owned(),
        unit: tool.card().unit.word(),
        judged: judge.is_some(),
        answers,
        compared: asked.compared,
        unlike: asked.unlike,
    }
}

/// Of two answers to one question the worse.
fn take(answers: &mut Vec<Answer>, found: Answer) {
    match answers.iter_mut().find(|known| known.question == found.question) {
        Some(known) => {
            let Find { error, at, points } = found.find;
            known.find.see(error, || (at, points));
            known.seeds = known.seeds.max(found.seeds);
        }
        None => answers.push(found),
    }
}

/// The next power of two above a tool's largest coordinate, S.
pub fn scale(tool: &dyn Tool) -> f64 {
    let card = tool.card();
    let [low, high] = card.reach();
    let size = card.radius().max(low.abs()).max(high.abs());
    // What bounds the tool is rounded outward.
    let size = size * (1.0 - 1e-9);
    2f64.powi(size.log2().floor() as i32 + 1)
}

/// Points on and beside what the oracle of a tool without a restatement knows of borders, and anywhere.
fn beside_curves(name: &str, count: usize, draw: &mut Draw) -> Vec<[f64; 3]> {
    let oracle = oracle::all().into_iter().find(|oracle| oracle.name() == name);
    let oracle = oracle.expect("every tool has an oracle");
    let curves: Vec<[f64; 3]> =
        oracle.curve_points().into_iter().flatten().chain(oracle.corner_points()).collect();
    let [radius, height] = oracle.extent();
    let pick = |draw: &mut Draw| {
        if draw.bits().is_multiple_of(4) {
            let across = [0; 2].map(|_| draw.between(-1.1 * radius, 1.1 * radius));
            return [across[0], across[1], draw.between(-0.05 * height, 1.05 * height)];
        }
        let from = curves[draw.bits() as usize % curves.len()];
        let size = 10f64.powf(draw.between(-16.0, -3.0)) * radius;
        let way = draw.direction().map(|c| size * c);
        oracle::moved(&*oracle, from, way, draw.between(0.0, std::f64::consts::TAU))
    };
    let mut all: Vec<[f64; 3]> = curves.clone();
    all.extend((0..count).map(|_| pick(draw)));
    all
}
