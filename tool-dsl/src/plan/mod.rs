//! The order of splits: a binary space partition of the tool's domain by its curves.
//!
//! Every test sends the zeros of a curve to one side, that of the region listed earlier. If both sides need
//! them, the curve is split once more. A side that provably has no point is not tested (`empty`). A tree
//! therefore gives every point the owner that the list of regions gives it, in real arithmetic; a test that
//! is left out can no longer fail by rounding. Only the order of the tests is free. It is chosen greedily by
//! the information that tests give about samples of the domain, with cheap curves preferred and the curves of
//! `bsp` first.

mod samples;
mod section;
mod signs;

use crate::bound::Extent;
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{Curve, CurveIndex};
use crate::model::Model;
use crate::number::Number;
use signs::by_signs;

/// The information, in bits, that must justify one addition.
const BITS_PER_ADDITION: f64 = 0.01;
/// The largest number of tests in one tree.
pub(crate) const MAX_TESTS: usize = 20_000;

/// A binary decision tree over the signs of curves.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree<L> {
    /// A decision.
    Leaf(L),
    /// A test of one more sign.
    Split {
        /// The index of the curve.
        curve: CurveIndex,
        /// True if its zeros go to `above`: the test is `c < 0` rather than `c ≤ 0`.
        strict: bool,
        /// The subtree where the test holds.
        below: Box<Tree<L>>,
        /// The subtree where it does not.
        above: Box<Tree<L>>,
    },
}

impl<L: Clone + PartialEq> Tree<L> {
    /// Returns a split, or the common subtree if both sides are equal.
    fn split(curve: CurveIndex, strict: bool, below: Tree<L>, above: Tree<L>) -> Tree<L> {
        // The test decides nothing.
        if below == above {
            return below;
        }
        Tree::Split { curve, strict, below: Box::new(below), above: Box::new(above) }
    }

    /// Replaces the leaves. A leaf mapped to `None` is never reached; its sibling takes its place.
    pub fn map<M: Clone + PartialEq>(&self, leaf: &impl Fn(&L) -> Option<M>) -> Option<Tree<M>> {
        match self {
            Tree::Leaf(own) => leaf(own).map(Tree::Leaf),
            Tree::Split { curve, strict, below, above } => {
                match (below.map(leaf), above.map(leaf)) {
                    (Some(below), Some(above)) => Some(Tree::split(*curve, *strict, below, above)),
                    (one, other) => one.or(other),
                }
            }
        }
    }

    /// Simplifies the tree, given that a test of the curve `known` holds or fails.
    fn simplified(&self, known: CurveIndex, strictly: bool, holds: bool) -> Tree<L> {
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

    /// Returns the leaves, those below a test first.
    pub fn leaves(&self) -> Vec<&L> {
        let (mut leaves, mut pending) = (Vec::new(), vec![self]);
        while let Some(tree) = pending.pop() {
            match tree {
                Tree::Leaf(leaf) => leaves.push(leaf),
                Tree::Split { below, above, .. } => pending.extend([&**above, &**below]),
            }
        }
        leaves
    }

    /// Returns the number of tests.
    pub fn test_count(&self) -> usize {
        match self {
            Tree::Leaf(_) => 0,
            Tree::Split { below, above, .. } => 1 + below.test_count() + above.test_count(),
        }
    }

    /// Returns the leaf of a point where the curves have these values.
    pub fn leaf_at(&self, value: &impl Fn(CurveIndex) -> f64) -> &L {
        match self {
            Tree::Leaf(leaf) => leaf,
            Tree::Split { curve, strict, below, above } => {
                let value_here = value(*curve);
                let holds = if *strict { value_here < 0.0 } else { value_here <= 0.0 };
                if holds { below.leaf_at(value) } else { above.leaf_at(value) }
            }
        }
    }
}

/// The trees of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The index of the region that owns a point.
    pub owner: Tree<Option<usize>>,
    /// The distance from a point outside to the tool; without a profile, a lower bound of it.
    pub clearance: Tree<Id>,
}

/// A tool with the order of its splits.
#[derive(Clone, Debug)]
pub struct PlannedTool {
    /// The tool, with the curves that its plan adds after those of the file.
    pub model: Model,
    /// The extent of the solid.
    pub extent: Extent,
    /// The order of splits.
    pub plan: Plan,
}

/// Plans the splits of a tool.
///
/// # Errors
/// If a tree would have more than [`MAX_TESTS`] tests, or a profile's cells cannot be separated.
pub(crate) fn plan(mut model: Model, extent: Extent) -> Result<PlannedTool, Diagnostic> {
    let plan = trees(&mut model, &extent)?;
    Ok(PlannedTool { model, extent, plan })
}

fn trees(model: &mut Model, extent: &Extent) -> Result<Plan, Diagnostic> {
    let (owner, clearance) = match &model.section {
        Some(section) => {
            let (owner, clearance) = section::trees(model, section)?;
            let is_owned_far_outside = section::has_owner_far_outside(model, section, &owner);
            let owner =
                if is_owned_far_outside { limited_to_box(model, extent, owner) } else { owner };
            (owner, limited_outside(model, extent, clearance))
        }
        None => (by_signs(model, extent)?, Tree::Leaf(distance_to_box(model, extent))),
    };
    Ok(Plan { owner, clearance })
}

/// Returns a tree that tests the section's box first, since curves may recur beyond it.
fn limited_to_box(
    model: &mut Model,
    extent: &Extent,
    tree: Tree<Option<usize>>,
) -> Tree<Option<usize>> {
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

/// The distance up to which the division of the outside is used, in sizes of the tool from the middle of its
/// axis.
const OUTSIDE_RANGE_IN_SIZES: f64 = 48.0;

/// Returns a tree of the distances to the nearest feature up to [`OUTSIDE_RANGE_IN_SIZES`] sizes,
/// and of the distance to the cylinder farther out.
fn limited_outside(model: &mut Model, extent: &Extent, tree: Tree<Id>) -> Tree<Id> {
    let bound = distance_to_box(model, extent);
    let graph = &mut model.graph;
    let (height, middle) = (extent.high - extent.low, extent.high / 2.0 + extent.low / 2.0);
    let limit = OUTSIDE_RANGE_IN_SIZES * height.hypot(extent.radius);
    let (z, q) = (graph.coord(Coord::Z), graph.coord(Coord::Q));
    // Squares, so that the test needs no root.
    let (middle, limit) = (constant(graph, middle), constant(graph, limit * limit));
    let up = graph.sub(z, middle);
    let up = graph.mul(up, up);
    let squared_distance = graph.add(q, up);
    let value = graph.sub(squared_distance, limit);
    model.curves.push(Curve { name: None, value });
    Tree::split(model.curves.len() - 1, false, tree, Tree::Leaf(bound))
}

/// Returns the distance to the box around the solid; for a tool, to its cylinder.
fn distance_to_box(model: &mut Model, extent: &Extent) -> Id {
    let graph = &mut model.graph;
    let zero = graph.int(0);
    let mut square = zero;
    for (coord, axis, _) in model.domain.coordinates().iter().rev() {
        let coordinate = graph.coord(*coord);
        let side = extent.cell().sides[*axis];
        let [low, high] = [side.low, side.high].map(|value| constant(graph, value));
        let mut excess = graph.sub(coordinate, high);
        // The half plane has no points beyond the axis.
        if *coord != Coord::D {
            let below = graph.sub(low, coordinate);
            excess = graph.max(below, excess);
        }
        let excess = graph.max(zero, excess);
        let square_of_excess = graph.mul(excess, excess);
        square = graph.add(square, square_of_excess);
    }
    graph.sqrt(square).unwrap_or(zero)
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
