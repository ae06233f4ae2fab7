//! Mutation tests of the proofs: compiled tools with one defect each, and the certificates of the mutants.

use tool_dsl::diagnostic::any_error;
use tool_dsl::expr::Id;
use tool_dsl::expr::value::{EvaluationPoint, Evaluator};
use tool_dsl::number::Number;
use tool_dsl::plan::{PlannedTool, Tree};
use tool_dsl::prove::Certificate;
use touchoff_tests::oracle::rng::Rng;

/// Number of points at which a mutant is compared with the original tool.
const POINTS: usize = 20_000;
/// Relative difference, in units of the tool's size, below which two depths count as equal.
const SAME_DEPTH_TOLERANCE: f64 = 1e-5;

/// The kinds of defects.
pub const KINDS: [&str; 10] = [
    "a depth's sign",
    "a depth's constant",
    "a depth's unit",
    "a direction reversed",
    "a direction turned",
    "a region missing",
    "a region felt as another",
    "an inequality",
    "a curve's constant",
    "a curve's slope",
];

/// A tool with one defect.
pub struct Mutant {
    /// Index into [`KINDS`].
    pub kind: usize,
    /// Description of the location of the defect.
    pub location: String,
    /// The defective tool.
    pub tool: PlannedTool,
}

/// The evidence that a mutant is defective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detection {
    /// An error.
    Error,
    /// A warning, while some part of the proof is undecided.
    Undecided,
    /// A warning, with no part of the proof undecided.
    Warning,
    /// Only a difference from the certificate of the original tool, which no user has.
    ByComparison,
    /// No evidence.
    Undetected,
}

/// Returns up to `count` mutants of a tool. The kinds of defects take turns, and each defect has a random location. A
/// mutant is left out if the tool has no location for it.
pub fn mutants(tool: &PlannedTool, count: usize, seed: u64) -> Vec<Mutant> {
    let mut rng = Rng::new(seed);
    (0..count).filter_map(|k| mutant(tool, k % KINDS.len(), &mut rng)).collect()
}

fn mutant(original: &PlannedTool, kind: usize, rng: &mut Rng) -> Option<Mutant> {
    let mut tool = original.clone();
    let size = tool.extent.scale();
    let mut pick = |count: usize| (rng.bits() % count.max(1) as u64) as usize;
    let region = pick(tool.model.regions.len());
    let mut location = tool.model.regions[region].name.clone();
    let graph = &mut tool.model.graph;
    let changed = &mut tool.model.regions[region];
    let number = |value: f64| Number::from_f64(value).expect("a finite number");
    match kind {
        0 => changed.depth = graph.neg(changed.depth),
        1 => {
            let shift = graph.number(number(0.01 * size));
            changed.depth = graph.add(changed.depth, shift);
        }
        2 => {
            let factor = graph.number(number(25.4));
            changed.depth = graph.mul(factor, changed.depth);
        }
        3 => {
            changed.raw_direction.0 = changed.raw_direction.0.map(|component| graph.neg(component));
        }
        4 => {
            // Turns the direction by a right angle in the half plane, or exchanges components in space.
            let [x, y, z] = changed.raw_direction.0;
            changed.raw_direction.0 = [z, y, graph.neg(x)];
        }
        5 => tool.plan.owner = leaves(&tool.plan.owner, &|owner| owner.filter(|o| *o != region)),
        6 => {
            let other = (region + 1 + pick(tool.model.regions.len().max(2) - 1))
                .checked_rem(tool.model.regions.len())
                .filter(|other| *other != region)?;
            location = format!("{location} as {}", tool.model.regions[other].name);
            let new_owner =
                |owner: Option<usize>| owner.map(|o| if o == region { other } else { o });
            tool.plan.owner = leaves(&tool.plan.owner, &new_owner);
        }
        7 => {
            let mut split = pick(tool.plan.owner.test_count());
            location = format!("split {split}");
            tool.plan.owner = with_split_exchanged(&tool.plan.owner, &mut split);
        }
        _ => {
            let curve = pick(tool.model.curves.len());
            location = format!("curve {curve}");
            let value = tool.model.curves[curve].value;
            let change = match kind {
                8 => graph.number(number(0.01 * size)),
                _ => {
                    let factor = graph.number(number(0.03));
                    let z = graph.coord(tool_dsl::expr::Coord::Z);
                    graph.mul(factor, z)
                }
            };
            tool.model.curves[curve].value = graph.add(value, change);
        }
    }
    Some(Mutant { kind, location, tool })
}

/// Returns the tree with the owner of each leaf mapped.
fn leaves(
    tree: &Tree<Option<usize>>,
    owner: &impl Fn(Option<usize>) -> Option<usize>,
) -> Tree<Option<usize>> {
    match tree {
        Tree::Leaf(leaf) => Tree::Leaf(owner(*leaf)),
        Tree::Split { curve, strict, below, above } => Tree::Split {
            curve: *curve,
            strict: *strict,
            below: Box::new(leaves(below, owner)),
            above: Box::new(leaves(above, owner)),
        },
    }
}

/// Returns the tree with the two sides of one split exchanged. `remaining` is the number of that split in preorder.
fn with_split_exchanged(tree: &Tree<Option<usize>>, remaining: &mut usize) -> Tree<Option<usize>> {
    let Tree::Split { curve, strict, below, above } = tree else { return tree.clone() };
    let is_chosen = *remaining == 0;
    *remaining = remaining.wrapping_sub(1);
    let low = Box::new(with_split_exchanged(below, remaining));
    let high = Box::new(with_split_exchanged(above, remaining));
    let (below, above) = if is_chosen { (high, low) } else { (low, high) };
    Tree::Split { curve: *curve, strict: *strict, below, above }
}

/// The depth at a point, and the direction before normalisation.
type Value = (f64, [f64; 3]);

fn evaluation(
    tool: &PlannedTool,
    evaluator: &mut Evaluator<'_>,
    [x, y, z]: [f64; 3],
) -> Option<Value> {
    evaluator.evaluate(EvaluationPoint::new(x, y, z));
    let owner =
        *tool.plan.owner.leaf_at(&|curve: usize| evaluator.get(tool.model.curves[curve].value));
    let region = &tool.model.regions[owner?];
    Some((
        evaluator.get(region.depth),
        region.raw_direction.0.map(|component| evaluator.get(component)),
    ))
}

fn evaluator(tool: &PlannedTool) -> Evaluator<'_> {
    let outputs = |region: &tool_dsl::model::Region| -> Vec<Id> {
        region.raw_direction.0.into_iter().chain([region.depth]).collect()
    };
    let model = &tool.model;
    let curves = model.curves.iter().map(|curve| curve.value);
    Evaluator::new(&model.graph, model.regions.iter().flat_map(outputs).chain(curves))
}

/// Returns whether a mutant differs from the original in solid, depth or direction at any of `POINTS` random points.
pub fn differs(original: &PlannedTool, mutant: &PlannedTool, seed: u64) -> bool {
    let mut rng = Rng::new(seed);
    let (mut original_values, mut mutant_values) = (evaluator(original), evaluator(mutant));
    let sides = original.extent.cell().sides;
    let slack = SAME_DEPTH_TOLERANCE * original.extent.scale();
    (0..POINTS).any(|_| {
        let p = sides.map(|side| rng.between(side.low, side.high));
        match (
            evaluation(original, &mut original_values, p),
            evaluation(mutant, &mut mutant_values, p),
        ) {
            (None, None) => false,
            (Some((a, u)), Some((b, v))) => {
                let dot: f64 = u.iter().zip(v).map(|(u, v)| u * v).sum();
                let norm = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
                (a - b).abs() > slack || dot < 0.999 * norm(u) * norm(v)
            }
            // Within rounding of the surface, inside and outside may differ.
            (first, second) => first.or(second).is_some_and(|(depth, _)| depth.abs() > slack),
        }
    })
}

/// Returns the evidence that a tool is defective: the diagnostics of its own certificate, or else a difference from the
/// certificate of the original tool. The original must have no diagnostics.
pub fn detect(original: &Certificate, mutant: &PlannedTool) -> Detection {
    let certificate = Certificate::prove(mutant);
    let diagnostics = certificate.diagnostics(mutant);
    let same = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs(),
        (a, b) => a == b,
    };
    let direction_errors = |certificate: &Certificate| -> Vec<f64> {
        certificate
            .regions
            .iter()
            .map(|region| region.direction_error.map_or(0.0, |error| error.high))
            .collect()
    };
    let has_larger_error = direction_errors(original)
        .into_iter()
        .zip(direction_errors(&certificate))
        .any(|(a, b)| b > a + 1e-6);
    let has_same_bounds = same(original.lower_slope(), certificate.lower_slope())
        && same(original.lipschitz(), certificate.lipschitz());
    if any_error(&diagnostics) {
        Detection::Error
    } else if diagnostics.is_empty() {
        if has_larger_error || !has_same_bounds {
            Detection::ByComparison
        } else {
            Detection::Undetected
        }
    } else if certificate.undecided.is_empty() {
        Detection::Warning
    } else {
        Detection::Undecided
    }
}
