//! The order of splits: a binary space partition of the tool's domain by its curves.
//!
//! Every test takes a curve's zero to one side, that of the region listed earlier; where both
//! sides want it, the curve is split once more. A side that provably has no point is not tested
//! for (`empty`). So a tree gives every point its owner as the regions' list does (in real
//! arithmetic; a test that is left out can no longer fail by rounding), and only the order of the
//! tests is chosen: greedily by the information that they give about
//! samples of the domain, cheap curves first, `bsp` before all.

mod corners;
mod empty;
mod samples;
mod section;
mod signs;
mod zeros;

use crate::bound::Extent;
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::expr::{Coord, Id};
use crate::formula::{Curve, CurveIndex};
use crate::model::Model;
use crate::number::Number;
use signs::by_signs;

/// The most tests of one tree.
const LARGEST: usize = 20_000;

/// A binary decision tree over the curves' signs.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree<L> {
    /// Decided.
    Leaf(L),
    /// To be decided by one more sign.
    Split {
        /// Which curve.
        curve: CurveIndex,
        /// Whether its zeros go to `above`: the test is `c < 0` rather than `c ≤ 0`.
        strict: bool,
        /// Where the test holds.
        below: Box<Tree<L>>,
        /// Where it does not.
        above: Box<Tree<L>>,
    },
}

impl<L: Clone + PartialEq> Tree<L> {
    /// A split, or its common leaf if it makes no difference.
    fn split(curve: CurveIndex, strict: bool, below: Tree<L>, above: Tree<L>) -> Tree<L> {
        if below == above {
            return below;
        }
        Tree::Split { curve, strict, below: Box::new(below), above: Box::new(above) }
    }

    /// The tree with other leaves; `None` is a leaf that nobody asks for and joins its sibling.
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

    /// The tree where a test is known to hold or to fail.
    fn knowing(&self, known: CurveIndex, strictly: bool, holds: bool) -> Tree<L> {
        match self {
            Tree::Leaf(_) => self.clone(),
            Tree::Split { curve, strict, below, above } if *curve == known => {
                match (holds, strictly, *strict) {
                    // c < 0 implies c ≤ 0, and c > 0 that neither holds.
                    (true, true, _) | (true, false, false) => below.knowing(known, strictly, holds),
                    (false, false, _) | (false, true, true) => {
                        above.knowing(known, strictly, holds)
                    }
                    _ => Tree::split(
                        *curve,
                        *strict,
                        below.knowing(known, strictly, holds),
                        above.knowing(known, strictly, holds),
                    ),
                }
            }
            Tree::Split { curve, strict, below, above } => Tree::split(
                *curve,
                *strict,
                below.knowing(known, strictly, holds),
                above.knowing(known, strictly, holds),
            ),
        }
    }

    /// How many tests there are.
    pub fn tests(&self) -> usize {
        match self {
            Tree::Leaf(_) => 0,
            Tree::Split { below, above, .. } => 1 + below.tests() + above.tests(),
        }
    }

    /// The leaf of a point where the curves have these values.
    pub fn at(&self, value: &impl Fn(CurveIndex) -> f64) -> &L {
        match self {
            Tree::Leaf(leaf) => leaf,
            Tree::Split { curve, strict, below, above } => {
                let value_here = value(*curve);
                let holds = if *strict { value_here < 0.0 } else { value_here <= 0.0 };
                if holds { below.at(value) } else { above.at(value) }
            }
        }
    }
}

/// The trees of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which region a point belongs to, by its place in the list.
    pub owner: Tree<Option<usize>>,
    /// Whether a point belongs to any.
    pub inside: Tree<bool>,
    /// The distance to the tool of a point outside; without a profile, a lower bound.
    pub outside: Tree<Id>,
}

/// A tool with the order of its splits.
#[derive(Clone, Debug)]
pub struct PlannedTool {
    /// The tool, with the curves that its plan adds behind those of the file.
    pub model: Model,
    /// The reach of the solid.
    pub extent: Extent,
    /// The order of splits.
    pub plan: Plan,
}

/// Plans a tool's splits.
pub(crate) fn plan(mut model: Model, extent: Extent) -> Result<PlannedTool, Diagnostic> {
    let plan = trees(&mut model, &extent)?;
    Ok(PlannedTool { model, extent, plan })
}

fn trees(model: &mut Model, extent: &Extent) -> Result<Plan, Diagnostic> {
    let (owner, outside) = match &model.section {
        Some(section) => {
            let (owner, outside) = section::trees(model, section)?;
            let far = section::claims_far(model, section, &owner);
            let owner = if far { boxed(model, extent, owner) } else { owner };
            (owner, within_reach(model, extent, outside))
        }
        None => (by_signs(model, extent)?, Tree::Leaf(beside(model, extent))),
    };
    // Of one tree, so that inside is where an owner is, to the last bit.
    let inside = owner.map(&|owner: &Option<usize>| Some(owner.is_some()));
    let inside = inside.unwrap_or(Tree::Leaf(false));
    Ok(Plan { owner, inside, outside })
}

/// A tree that asks for the section's box first: beyond, curves may come round again.
fn boxed(model: &mut Model, extent: &Extent, tree: Tree<Option<usize>>) -> Tree<Option<usize>> {
    let graph = &mut model.graph;
    let [d, z] = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
    let [radius, low, high] = [extent.radius, extent.low, extent.high].map(|value| {
        let number = Number::from_f64(value).unwrap_or_else(|| Number::int(0));
        graph.number(number)
    });
    let sides = [graph.sub(d, radius), graph.sub(low, z), graph.sub(z, high)];
    sides.into_iter().fold(tree, |tree, value| {
        let known = model.curves.iter().position(|curve| curve.value == value);
        let curve = known.unwrap_or_else(|| {
            model.curves.push(Curve { name: None, value });
            model.curves.len() - 1
        });
        Tree::split(curve, false, tree.knowing(curve, false, true), Tree::Leaf(None))
    })
}

/// How far the outside was divided, in tools' sizes from the middle of the axis.
const DIVIDED: f64 = 48.0;

/// Distances to the nearest feature as far as those are known, and farther out to the cylinder.
fn within_reach(model: &mut Model, extent: &Extent, tree: Tree<Id>) -> Tree<Id> {
    let bound = beside(model, extent);
    let graph = &mut model.graph;
    let number = |value: f64| Number::from_f64(value).unwrap_or_else(|| Number::int(0));
    let (height, middle) = (extent.high - extent.low, extent.high / 2.0 + extent.low / 2.0);
    let reach = DIVIDED * height.hypot(extent.radius);
    let (z, q) = (graph.coord(Coord::Z), graph.coord(Coord::Q));
    let (middle, reach) = (graph.number(number(middle)), graph.number(number(reach * reach)));
    let up = graph.sub(z, middle);
    let up = graph.mul(up, up);
    let away = graph.add(q, up);
    let value = graph.sub(away, reach);
    model.curves.push(Curve { name: None, value });
    Tree::split(model.curves.len() - 1, false, tree, Tree::Leaf(bound))
}

/// The distance to the box about the solid, of a tool to the cylinder.
fn beside(model: &mut Model, extent: &Extent) -> Id {
    let graph = &mut model.graph;
    let zero = graph.int(0);
    let mut square = zero;
    for (coord, axis, _) in model.domain.coordinates().iter().rev() {
        let here = graph.coord(*coord);
        let side = extent.cell().sides[*axis];
        let [low, high] = [side.low, side.high].map(|value| {
            let number = Number::from_f64(value).unwrap_or_else(|| Number::int(0));
            graph.number(number)
        });
        let mut beyond = graph.sub(here, high);
        // There is nothing beyond the axis.
        if *coord != Coord::D {
            let below = graph.sub(low, here);
            beyond = graph.max(below, beyond);
        }
        let beyond = graph.max(zero, beyond);
        let more = graph.mul(beyond, beyond);
        square = graph.add(square, more);
    }
    graph.sqrt(square).unwrap_or(zero)
}

/// That a tree outgrew its bound.
fn too_large(model: &Model) -> Diagnostic {
    Diagnostic::new(model.name_span, CheckKind::TooManyTests { most: LARGEST })
}

/// What a curve costs to evaluate, in additions.
fn costs(model: &Model) -> Vec<f64> {
    use crate::expr::{Coord, Node};
    let cost = |node: &Node| match node {
        Node::Const(_) | Node::Coord(Coord::X | Coord::Y | Coord::Z) => 0.0,
        Node::Sqrt(_) | Node::Div(..) | Node::Quotient(..) => 8.0,
        _ => 1.0,
    };
    let curve = |curve: &Curve| {
        model.graph.needed([curve.value]).into_iter().map(|id| cost(model.graph.node(id))).sum()
    };
    model.curves.iter().map(curve).collect()
}

/// The bits that a part of a whole has, times its weight.
fn bits(part: f64, whole: f64) -> f64 {
    if part > 0.0 { -part * (part / whole).log2() } else { 0.0 }
}
