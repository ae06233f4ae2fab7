//! The signs that a curve can have at a claim's points in a box.

use super::super::cover::{Claim, Cover};
use super::super::tangency::Contact;
use super::{BorderProver, ContactSearch, MAX_CONTACT_BOXES, leaf};
use crate::expr::polynomial::{ClearSide, Polynomial};
use crate::formula::{ANY_SIGN, CurveIndex, NEGATIVE, POSITIVE, Signs, ZERO};
use std::cell::OnceCell;

impl BorderProver<'_> {
    /// Returns the signs that a curve can have at a claim's points in the current box. They follow from the
    /// box, from the path down the tree, and from straight curves on that path.
    pub(super) fn sign_on(
        &mut self,
        claim: &Claim,
        curve: CurveIndex,
        cover: &mut Cover<'_>,
    ) -> Signs {
        let mut signs = cover.sign_at_claim(claim, curve);
        for (other, side) in &claim.signs {
            if *side & NEGATIVE == 0 || *side & POSITIVE == 0 {
                signs &= self.implied(*other, *side & NEGATIVE != 0, curve);
            }
        }
        if signs & NEGATIVE != 0 && signs & POSITIVE != 0 {
            signs &= self.signs_by_linear(claim, curve);
        }
        if signs & NEGATIVE != 0 && signs & POSITIVE != 0 {
            signs &= self.signs_by_contact(claim, curve);
        }
        signs
    }

    /// Returns a curve as a polynomial, if that has the curve's sign throughout the current box.
    pub(super) fn signed(&self, curve: CurveIndex) -> Option<&Polynomial> {
        let (polynomial, positive) = self.curves[curve].as_ref()?;
        let has_curve_sign =
            positive.as_ref().is_none_or(|positive| positive.over(&self.cell).low > 0.0);
        has_curve_sign.then_some(polynomial)
    }

    /// Returns the signs that a curve can have next to a conic on a claim's path, if the two touch nearby.
    fn signs_by_contact(&mut self, claim: &Claim, curve: CurveIndex) -> Signs {
        let box_corner = [self.cell.sides[0], self.cell.sides[2]].map(|side| side.low);
        let mut signs = ANY_SIGN;
        for (other, known) in &claim.signs {
            let side = match known & !ZERO {
                NEGATIVE => 0,
                POSITIVE => 1,
                _ => continue,
            };
            if self.is_straight[*other] || self.is_straight[curve] {
                continue;
            }
            let (Some(conic), Some(own)) = (self.signed(*other), self.signed(curve)) else {
                continue;
            };
            let key = (*other, curve);
            let search = match self.contacts.get(&key) {
                Some(ContactSearch::Failed(attempts)) if *attempts < MAX_CONTACT_BOXES => {
                    search_contact([conic, own], box_corner, self.size, *attempts)
                }
                Some(known) => *known,
                None => search_contact([conic, own], box_corner, self.size, 0),
            };
            self.contacts.insert(key, search);
            if let ContactSearch::Found(possible) = search {
                signs &= possible[side];
            }
        }
        signs
    }

    /// Returns the signs that a claim's path leaves possible.
    pub(super) fn signs(&self, claim: &Claim) -> Vec<Signs> {
        let mut signs = vec![ANY_SIGN; self.curves.len()];
        for (curve, known) in &claim.signs {
            signs[*curve] &= known;
        }
        signs
    }

    /// Returns the signs that a curve can have according to all linear curves on a claim's path together.
    fn signs_by_linear(&mut self, claim: &Claim, curve: CurveIndex) -> Signs {
        let key = (leaf(claim), curve);
        if let Some(known) = self.by_linear.get(&key) {
            return *known;
        }
        let mut signs = self.signs(claim);
        let mut possible = ANY_SIGN;
        for side in [NEGATIVE, POSITIVE] {
            signs[curve] = side;
            if self.linear.contradictory_in(claim.owner, &signs) {
                possible &= !side;
            }
        }
        self.by_linear.insert(key, possible);
        possible
    }

    /// Returns the signs that a curve can have on one side of another, if one of them is straight and the two
    /// do not cross.
    fn implied(&mut self, known: CurveIndex, below: bool, curve: CurveIndex) -> Signs {
        let side = |positive: bool| ZERO | if positive { POSITIVE } else { NEGATIVE };
        match (self.clear_side(known, curve), self.clear_side(curve, known)) {
            (Some(clear), _) if clear.is_below == below => side(clear.is_positive),
            // The points are inside the conic, which lies on the other side of the line.
            (_, Some(clear)) if clear.is_positive == below => side(clear.is_below),
            _ => ANY_SIGN,
        }
    }

    /// Returns the side of a line on which a conic has one sign. `None` if the curves are not that, or if no such
    /// side is known.
    fn clear_side(&mut self, line: CurveIndex, conic: CurveIndex) -> Option<ClearSide> {
        let row = &mut self.clear_sides[line];
        row.resize(self.curves.len(), OnceCell::new());
        *row[conic].get_or_init(|| match (&self.curves[line], &self.curves[conic]) {
            (Some((line, None)), Some((curve, None))) if !self.is_straight[conic] => {
                curve.clear_side_of(line)
            }
            _ => None,
        })
    }
}

/// Searches for the contact of two curves near a point, after some attempts that failed elsewhere.
fn search_contact(
    [conic, other]: [&Polynomial; 2],
    near: [f64; 2],
    size: f64,
    attempts: u32,
) -> ContactSearch {
    let Some(contact) = Contact::near(conic, other, near, size) else {
        return ContactSearch::Failed(attempts + 1);
    };
    let possible = |from: i64| {
        let excluded = [(1, NEGATIVE), (-1, POSITIVE)];
        let implied = excluded.into_iter().filter(|(to, _)| contact.implies(from, *to));
        implied.fold(ANY_SIGN, |possible, (_, sign)| possible & !sign)
    };
    ContactSearch::Found([possible(-1), possible(1)])
}
