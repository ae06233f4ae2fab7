//! The smaller of two depths at a claim's points, and bounds on their difference where claims meet that no
//! curve joins.

use super::super::SMALL_BOX_FRACTION;
use super::super::cover::{Claim, Cover, half_diagonal};
use super::super::excess::excess;
use super::super::root::RootForm;
use super::Pair;
use super::{BorderProver, closure, leaf};
use crate::expr::polynomial::Polynomial;
use crate::expr::value::EvaluationPoint;
use crate::formula::{CurveIndex, Signs, one_side};
use crate::number::Number;

/// The largest difference, in half diagonals of the box, between a candidate third depth and the depths of
/// the two regions that meet there.
const MAX_DIFFERENCE_IN_HALF_DIAGONALS: f64 = 8.0;

/// The order of two depths, according to the linear curves on the paths to their claims.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum LowerByLinear {
    /// Both are 0 where the claims meet.
    Zero,
    /// For each, whether it is proved to be the smaller at its own claim's points.
    Each([bool; 2]),
}

/// The excess of one of two depths over the other, one of which is the distance from a line.
pub(super) enum ExcessBesideLine {
    /// The excess itself.
    Polynomial(Polynomial),
    /// An upper bound of it everywhere.
    Bound(f64),
}

/// The index of a depth in [`Model::depths`](crate::model::Model::depths); `None` for the outside, whose
/// depth is 0.
type Owner = Option<usize>;

impl BorderProver<'_> {
    /// Returns an upper bound of the difference of two claims' depths where they meet in the current box. It
    /// is found if each of two regions' depths is the smaller at its own claim's points, or if a region's
    /// depth is 0 where it meets the outside.
    pub(super) fn lower(
        &mut self,
        pair: Pair,
        claims: [&Claim; 2],
        separating_curves: &[CurveIndex],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        let key = claims.map(leaf);
        let linear = match self.lower.get(&key) {
            Some(known) => *known,
            None => {
                let signs = claims.map(|claim| self.listed_signs(claim));
                let known = self.lower_by_linear(pair, &signs);
                self.lower.insert(key, known);
                known
            }
        };
        let LowerByLinear::Each(lesser) = linear else { return Some(0.0) };
        let (own, Some(other)) = pair else {
            let own = Some(pair.0);
            let below = self.excess_on(claims[1], separating_curves, [own, None], cover)?;
            let above = self.excess_on(claims[0], separating_curves, [None, own], cover)?;
            return Some(below.max(above)).filter(|difference| *difference <= self.max_jump);
        };
        let owners = [[own, other], [other, own]];
        // Descents also require the order next to the border, not only on it.
        let (max_excess, borders) =
            if self.may_jump { (self.max_jump, separating_curves) } else { (0.0, &[][..]) };
        let excess = [0, 1].map(|k| {
            let owners = owners[k].map(Some);
            let zero = lesser[k].then_some(0.0);
            let excess = zero.or_else(|| self.excess_on(claims[k], borders, owners, cover));
            excess.filter(|excess| *excess <= max_excess)
        });
        let (side, excess) = match excess {
            [Some(a), Some(b)] => return Some(a.max(b)),
            [None, None] => return None,
            [Some(excess), None] => (1, excess),
            [None, Some(excess)] => (0, excess),
        };
        let lower = match self.lower_by_third.get(&(key, side)) {
            Some(known) => *known,
            None => {
                let signs = self.listed_signs(claims[side]);
                let lower = self.lesser_than_third(owners[side], &signs, separating_curves);
                self.lower_by_third.insert((key, side), lower);
                lower
            }
        };
        lower.then_some(excess)
    }

    /// Returns an upper bound of the excess of the first depth over the second at a claim's points in the
    /// current box, or at those on given borders. It is proved by the sign of a curve on the claim's path, or
    /// by a third depth between the two. The third is compared with one of them by such a sign, and with the
    /// other everywhere or on such a border.
    fn excess_on(
        &mut self,
        claim: &Claim,
        borders: &[CurveIndex],
        [less, more]: [Owner; 2],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        if self.ordered([less, more], claim, cover) {
            return Some(0.0);
        }
        let mut min_excess = self.excess_beside_line(claim, [less, more]);
        for third in self.third_depths([less, more]) {
            for (by_curve, everywhere) in
                [([less, third], [third, more]), ([third, more], [less, third])]
            {
                if self.ordered(by_curve, claim, cover) {
                    let everywhere_by = self.excess(claim, everywhere);
                    let found = [everywhere_by, self.jump_on_borders(borders, everywhere)];
                    min_excess = found.into_iter().flatten().chain(min_excess).reduce(f64::min);
                }
            }
        }
        min_excess
    }

    /// Returns an upper bound of the amount by which a region's depth is above or below 0, on one side of a
    /// straight curve on the claim's path that a circle of that depth touches.
    fn excess_beside_line(&mut self, claim: &Claim, sides: [Owner; 2]) -> Option<f64> {
        let (own, is_more) = match sides {
            [Some(own), None] => (own, false),
            [None, Some(own)] => (own, true),
            _ => return None,
        };
        let (curves, depth) = (&self.curves, self.depths[own].as_ref()?);
        let lines = claim.signs.iter().filter_map(|(curve, signs)| {
            let is_below = one_side(*signs)?;
            let entry = self.beside_line.entry((own, is_more, *curve, is_below));
            let known = entry.or_insert_with(|| {
                let (line, _) = curves[*curve].as_ref()?;
                let line = line.is_linear().then(|| line.with_unit_slope())??;
                let sign = Number::int(if is_below == is_more { -1 } else { 1 });
                let line = RootForm::from_polynomial(&line.scaled(&sign));
                let [less, more] = if is_more { [&line, depth] } else { [depth, &line] };
                match (less.polynomial(), more.polynomial()) {
                    (Some(less), Some(more)) => {
                        let minus = more.scaled(&Number::int(-1));
                        Some(ExcessBesideLine::Polynomial(less.clone().plus(&minus)))
                    }
                    _ => excess(less, more).map(ExcessBesideLine::Bound),
                }
            });
            match known.as_ref()? {
                ExcessBesideLine::Polynomial(excess) => Some(excess.over(&self.cell).high.max(0.0)),
                ExcessBesideLine::Bound(bound) => Some(*bound),
            }
        });
        lines.reduce(f64::min)
    }

    /// Returns whether the first of two depths is the smaller at a claim's points in the current box,
    /// according to the sign of a curve on which they agree.
    fn ordered(&mut self, [less, more]: [Owner; 2], claim: &Claim, cover: &mut Cover<'_>) -> bool {
        // Pairs are ordered with the outside last, and the region listed earlier first.
        let is_swapped = less.is_none() || more.is_some_and(|more| Some(more) < less);
        let ordered = if is_swapped { [more, less] } else { [less, more] };
        let [Some(own), other] = ordered else { return false };
        let by_difference = self.differences((own, other)).iter().any(|(curve, own_is_more)| {
            one_side(cover.sign_at_claim(claim, *curve)) == Some(*own_is_more != is_swapped)
        });
        let one_sided = claim.signs.iter().filter(|(_, signs)| one_side(*signs).is_some());
        by_difference
            || one_sided.into_iter().any(|(curve, _)| {
                let signs = cover.sign_at_claim(claim, *curve);
                let agreement = self.agreement((own, other), *curve);
                let Some(order) = agreement.as_ref().and_then(|found| found.order.as_ref()) else {
                    return false;
                };
                self.signed(*curve).is_some() && order.is_lesser(is_swapped, signs, &self.cell)
            })
    }

    /// Returns an upper bound of the excess of one region's depth over another's: everywhere, or by linear
    /// curves at a claim's points.
    fn excess(&mut self, claim: &Claim, [less, more]: [Owner; 2]) -> Option<f64> {
        let [less, more] = [less?, more?];
        let (a, b) = (self.depths[less].as_ref()?, self.depths[more].as_ref()?);
        let excess = *self.excesses.entry((less, more)).or_insert_with(|| excess(a, b));
        if excess == Some(0.0) {
            return excess;
        }
        let key = (leaf(claim), [less, more]);
        let no_deeper = match self.no_deeper.get(&key) {
            Some(known) => *known,
            None => {
                let no_deeper =
                    self.linear.no_deeper(&self.listed_signs(claim), Some(less), Some(more));
                self.no_deeper.insert(key, no_deeper);
                no_deeper
            }
        };
        if no_deeper { Some(0.0) } else { excess }
    }

    /// Returns an upper bound of the difference of two depths on one of several borders in the current box.
    fn jump_on_borders(&mut self, borders: &[CurveIndex], [a, b]: [Owner; 2]) -> Option<f64> {
        let [a, b] = [a?, b?];
        let pair = (a.min(b), Some(a.max(b)));
        let jumps = borders.iter().filter_map(|curve| match self.agreement(pair, *curve) {
            Some(agreement) => {
                let is_certain = |branch: &Polynomial| branch.over(&self.cell).low > 0.0;
                agreement.branch.as_ref().is_none_or(is_certain).then_some(0.0)
            }
            None => Some(self.tangency(pair, *curve)?.jump),
        });
        jumps.reduce(f64::min)
    }

    /// Returns candidates for a depth between two others throughout the current box, if that is small. The
    /// choice affects only the run time.
    fn third_depths(&mut self, pair: [Owner; 2]) -> Vec<Owner> {
        let reach = half_diagonal(&self.cell);
        if reach > SMALL_BOX_FRACTION * self.size {
            return Vec::new();
        }
        let middle @ [x, y, z] = self.cell.middle();
        if self.evaluated_at != Some(middle) {
            self.evaluated_at = Some(middle);
            self.values.evaluate(EvaluationPoint::new(x, y, z));
        }
        let depth = |owner: Owner| owner.map_or(0.0, |owner| self.values.get(self.ids[owner]));
        let is_near = |third: &Owner| {
            let difference = |owner: Owner| (depth(*third) - depth(owner)).abs();
            !pair.contains(third)
                && pair
                    .into_iter()
                    .all(|owner| difference(owner) <= MAX_DIFFERENCE_IN_HALF_DIAGONALS * reach)
        };
        (0..self.ids.len()).map(Some).filter(is_near).collect()
    }

    /// Returns the signs at a claim's points.
    fn listed_signs(&self, claim: &Claim) -> Vec<Signs> {
        let mut signs = self.signs(claim);
        // If owners are checked against the list of regions, its conditions hold too.
        if let (true, Some(owner)) = (self.check_listed_owners, claim.owner) {
            self.model.regions[owner].inside.narrow_signs(&mut signs);
        }
        signs
    }

    /// Returns the order of two depths according to all linear curves on the paths to the claims.
    fn lower_by_linear(&self, (own, other): Pair, signs: &[Vec<Signs>; 2]) -> LowerByLinear {
        if self.are_zero_where_claims_meet((own, other), [&signs[0], &signs[1]]) {
            return LowerByLinear::Zero;
        }
        let Some(other) = other else { return LowerByLinear::Each([false; 2]) };
        let lesser =
            |k: usize, own, other| self.linear.no_deeper(&signs[k], Some(own), Some(other));
        LowerByLinear::Each([lesser(0, own, other), lesser(1, other, own)])
    }

    fn are_zero_where_claims_meet(&self, (own, other): Pair, [at_a, at_b]: [&[Signs]; 2]) -> bool {
        let common = |(a, b): (&Signs, &Signs)| closure(*a) & closure(*b);
        let common_signs: Vec<Signs> = at_a.iter().zip(at_b).map(common).collect();
        self.linear.no_deeper(&common_signs, Some(own), None)
            && self.linear.no_deeper(&common_signs, other, None)
    }

    /// Returns whether a depth is, where its claim's signs hold, at most a third depth that continues the
    /// other one smoothly across one of the curves that separate them.
    fn lesser_than_third(
        &mut self,
        [own, other]: [usize; 2],
        signs: &[Signs],
        separating_curves: &[CurveIndex],
    ) -> bool {
        (0..self.depths.len()).any(|third| {
            let smooth = |curve: &CurveIndex| {
                let Some(agreement) = self.agreement((other, Some(third)), *curve) else {
                    return false;
                };
                // A depth is not negative in its own region.
                let depth = self.depths[other].as_ref().and_then(RootForm::polynomial);
                let ratio = |branch: &Polynomial| branch.ratio(depth?);
                let own = |branch| ratio(branch).is_some_and(|ratio| !ratio.is_negative());
                agreement.smooth && agreement.branch.as_ref().is_none_or(own)
            };
            third != own
                && third != other
                && separating_curves.iter().any(smooth)
                && self.linear.no_deeper(signs, Some(own), Some(third))
        })
    }
}
