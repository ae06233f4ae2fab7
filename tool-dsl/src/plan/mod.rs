//! The order of splits: a binary space partition of the tool's domain by its curves.
//!
//! Every test sends the zeros of a curve to one side, that of the region listed earlier. If both sides need
//! them, the curve is split once more. A side that provably has no point is not tested (`empty`). A tree
//! therefore gives every point the owner that the rule of the text gives it, in real arithmetic; a test that
//! is left out can no longer fail by rounding. Only the order of the tests is free. It is chosen greedily by
//! the information that tests give about samples of the domain, with cheap curves preferred and the curves of
//! `bsp` first. Where samples tell nothing about the cells of a profile, it is chosen by the cells that are left on both
//! sides.

mod cells;
mod meetings;
mod profile;
mod samples;
mod signs;

use crate::bound::Extent;
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{Curve, CurveIndex};
use crate::model::Model;
use crate::number::Number;
use crate::regionalise::pieces::SampledPiece;
pub(crate) use cells::proved_deviation;
use signs::by_signs;

/// The information, in bits, that must justify one addition.
const BITS_PER_ADDITION: f64 = 0.01;
/// The largest number of tests in one tree.
pub(crate) const MAX_TESTS: usize = 20_000;

/// A binary decision tree over the signs of curves.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// The index of the region that owns a point; `None` outside.
    Leaf(Option<usize>),
    /// A test of one more sign.
    Split {
        /// The index of the curve.
        curve: CurveIndex,
        /// True if its zeros go to `above`: the test is `c < 0` rather than `c ≤ 0`.
        strict: bool,
        /// The subtree where the test holds.
        below: Box<Tree>,
        /// The subtree where it does not.
        above: Box<Tree>,
    },
}

impl Tree {
    /// Returns a split, or the common subtree if both sides are equal.
    fn split(curve: CurveIndex, strict: bool, below: Tree, above: Tree) -> Tree {
        // The test decides nothing.
        if below == above {
            return below;
        }
        Tree::Split { curve, strict, below: Box::new(below), above: Box::new(above) }
    }

    /// Simplifies the tree, given that a test of the curve `known` holds or fails.
    fn simplified(&self, known: CurveIndex, strictly: bool, holds: bool) -> Tree {
        match self {
            Tree::Leaf(_) => self.clone(),
            Tree::Split { curve, strict, below, above } if *curve == known => {
                match (holds, strictly, *strict) {
                    // c < 0 implies c ≤ 0; if c ≤ 0 fails, so does c < 0.
                    (true, true, _) | (true, false, false) => {
                        below.simplified(known, strictly, holds)
                    }
                    (false, false, _) | (false, true, true) => {
                        above.simplified(known, strictly, holds)
                    }
                    _ => Tree::split(
                        *curve,
                        *strict,
                        below.simplified(known, strictly, holds),
                        above.simplified(known, strictly, holds),
                    ),
                }
            }
            Tree::Split { curve, strict, below, above } => Tree::split(
                *curve,
                *strict,
                below.simplified(known, strictly, holds),
                above.simplified(known, strictly, holds),
            ),
        }
    }

    /// Returns the owners of the leaves, those below a test first.
    pub(crate) fn owners(&self) -> Vec<Option<usize>> {
        let (mut owners, mut pending) = (Vec::new(), vec![self]);
        while let Some(tree) = pending.pop() {
            match tree {
                Tree::Leaf(owner) => owners.push(*owner),
                Tree::Split { below, above, .. } => pending.extend([&**above, &**below]),
            }
        }
        owners
    }

    /// Returns the number of tests.
    pub fn test_count(&self) -> usize {
        match self {
            Tree::Leaf(_) => 0,
            Tree::Split { below, above, .. } => 1 + below.test_count() + above.test_count(),
        }
    }

    /// Returns the owner of a point where the curves have these values.
    pub fn owner_at(&self, value: &impl Fn(CurveIndex) -> f64) -> Option<usize> {
        match self {
            Tree::Leaf(owner) => *owner,
            Tree::Split { curve, strict, below, above } => {
                let value_here = value(*curve);
                let holds = if *strict { value_here < 0.0 } else { value_here <= 0.0 };
                if holds { below.owner_at(value) } else { above.owner_at(value) }
            }
        }
    }
}

/// A tool with the order of its splits.
#[derive(Clone, Debug)]
pub struct PlannedTool {
    /// The tool, with the curves that its plan adds after those of the file.
    pub model: Model,
    /// The extent of the solid.
    pub extent: Extent,
    /// The order of splits.
    pub tree: Tree,
    /// The greatest difference of depth from the distance where the tree gives a point to an owner that is not the
    /// nearest, in the file's unit: rounding, or what the plan was indifferent to. 0 for regions written by hand.
    pub deviation: f64,
}

/// Plans the splits of a tool, of whose profile these are the pieces.
///
/// # Errors
/// If a tree would have more than [`MAX_TESTS`] tests, or a profile's cells cannot be separated.
pub(crate) fn plan(
    mut model: Model,
    extent: Extent,
    sampled: &[SampledPiece],
) -> Result<PlannedTool, Diagnostic> {
    let (tree, deviation) = match &model.profile {
        None => (by_signs(&model, &extent)?, 0.0),
        Some(profile) => {
            let plan = profile::plan(&model, profile, sampled)?;
            for line in plan.lines {
                let value = line.expression(&mut model.graph);
                model.curves.push(Curve { name: None, value });
            }
            match plan.has_owner_far_outside {
                true => (limited_to_box(&mut model, &extent, plan.tree), plan.deviation),
                false => (plan.tree, plan.deviation),
            }
        }
    };
    Ok(PlannedTool { model, extent, tree, deviation })
}

/// Returns a tree that tests the section's box first, since curves may recur beyond it.
fn limited_to_box(model: &mut Model, extent: &Extent, tree: Tree) -> Tree {
    let graph = &mut model.graph;
    let [d, z] = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
    let [radius, low, high] =
        [extent.radius, extent.low, extent.high].map(|value| constant(graph, value));
    let sides = [graph.sub(d, radius), graph.sub(low, z), graph.sub(z, high)];
    sides.into_iter().fold(tree, |tree, value| {
        // The file may have the side as a curve.
        let known = model.curves.iter().position(|curve| curve.value == value);
        let curve = known.unwrap_or_else(|| {
            model.curves.push(Curve { name: None, value });
            model.curves.len() - 1
        });
        // Inside the side, the tree need not test it again.
        Tree::split(curve, false, tree.simplified(curve, false, true), Tree::Leaf(None))
    })
}

/// Returns the error for a tree that exceeds its limit.
fn too_large(model: &Model) -> Diagnostic {
    Diagnostic::new(model.name_span, CheckKind::TooManyTests { limit: MAX_TESTS })
}

/// Returns the cost of evaluating each curve, in additions.
fn costs(model: &Model) -> Vec<f64> {
    let graph = &model.graph;
    let nodes = model.curves.iter().map(|curve| graph.dependencies([curve.value]));
    nodes.map(|nodes| nodes.into_iter().map(|id| cost(graph.node(id))).sum()).collect()
}

/// Returns the cost of a node, in additions. A root or a quotient takes about eight times as long as a sum.
fn cost(node: &Node) -> f64 {
    match node {
        Node::Const(_) | Node::Coord(Coord::X | Coord::Y | Coord::Z) => 0.0,
        Node::Sqrt(_) | Node::Div(..) | Node::Quotient(..) => 8.0,
        _ => 1.0,
    }
}

/// Adds the constant of an extent to a graph.
fn constant(graph: &mut Graph, value: f64) -> Id {
    graph.number(Number::from_f64(value).unwrap_or_else(|| Number::int(0)))
}

/// Returns the information content of a part of a whole in bits, multiplied by the part's weight.
fn bits(part: f64, whole: f64) -> f64 {
    if part > 0.0 { -part * (part / whole).log2() } else { 0.0 }
}
