//! The domain as boxes, each with the regions that it may have points of, according to the tests of the
//! emitted tree.

use crate::expr::interval::{Cell, Encloser, halves};
use crate::formula::{ANY_SIGN, CurveIndex, NEGATIVE, Signs, ZERO, possible};
use crate::model::Model;
use crate::plan::Tree;

/// A leaf that a box may have points of, and the signs demanded on its path down the tree.
#[derive(Clone, Debug)]
pub(super) struct Claim {
    pub(super) owner: Option<usize>,
    pub(super) signs: Vec<(CurveIndex, Signs)>,
}

/// Determines the leaves that a box may have points of.
pub(super) struct Cover<'m> {
    model: &'m Model,
    tree: &'m Tree,
    encloser: Encloser<'m>,
}

impl<'m> Cover<'m> {
    pub(super) fn new(model: &'m Model, tree: &'m Tree) -> Cover<'m> {
        let encloser = Encloser::new(&model.graph, model.curve_values());
        Cover { model, tree, encloser }
    }

    /// Returns the signs that a curve can have in the current box.
    fn sign(&mut self, curve: CurveIndex) -> Signs {
        possible(self.encloser.get(self.model.curves[curve].value))
    }

    /// Returns the signs that a curve can have at a claim's points in the current box, according to the box
    /// and the path down the tree.
    pub(super) fn sign_at_claim(&mut self, claim: &Claim, curve: CurveIndex) -> Signs {
        let own = claim.signs.iter().filter(|(other, _)| *other == curve);
        own.fold(self.sign(curve), |allowed, (_, signs)| allowed & signs)
    }

    /// Returns the claims to a box.
    pub(super) fn claims(&mut self, cell: Cell) -> Vec<Claim> {
        self.encloser.set(cell);
        let mut claims = Vec::new();
        self.descend(self.tree, &mut Vec::new(), &mut claims);
        claims
    }

    fn descend(
        &mut self,
        tree: &Tree,
        path: &mut Vec<(CurveIndex, Signs)>,
        claims: &mut Vec<Claim>,
    ) {
        let Tree::Split { curve, strict, below, above } = tree else {
            if let Tree::Leaf(owner) = tree {
                claims.push(Claim { owner: *owner, signs: path.clone() });
            }
            return;
        };
        // A path may test a curve more than once.
        let known = path.iter().filter(|(known, _)| known == curve).map(|(_, signs)| *signs);
        let possible_signs = known.fold(self.sign(*curve), |allowed, signs| allowed & signs);
        // The test is `c < 0` or `c ≤ 0`, and the curve itself belongs to one side only.
        let low = if *strict { NEGATIVE } else { NEGATIVE | ZERO };
        let sides = [(below, possible_signs & low), (above, possible_signs & !low & ANY_SIGN)];
        for (side, signs) in sides {
            if signs != 0 {
                path.push((*curve, signs));
                self.descend(side, path, claims);
                path.pop();
            }
        }
    }
}

/// The boxes that remain to be examined, as a stack.
pub(super) struct Boxes {
    stack: Vec<Cell>,
    /// The number of boxes examined.
    pub(super) count: usize,
}

impl Boxes {
    pub(super) fn new(whole: Cell) -> Boxes {
        Boxes { stack: vec![whole], count: 0 }
    }

    pub(super) fn next(&mut self) -> Option<Cell> {
        self.count += 1;
        self.stack.pop()
    }

    pub(super) fn divide(&mut self, cell: Cell) {
        self.stack.extend(halves(cell));
    }
}

/// Returns half of a box's diagonal.
pub(super) fn half_diagonal(cell: &Cell) -> f64 {
    let squares = cell.sides.iter().map(|side| (side.high - side.low) * (side.high - side.low));
    squares.sum::<f64>().sqrt() / 2.0
}
