//! Separation of two owners of a box: a curve with the owners on its two sides, and whether depth is
//! continuous across it.

use super::Pair;
use super::cover::{Claim, Cover, half_diagonal};
use super::depths::{DepthCorner, Depths};
use super::distances::{DepthDifference, Tangency};
use super::root::{Agreement, Forms, RootForm};
use crate::elimination::Linear;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::expr::polynomial::Polynomial;
use crate::expr::{Id, Node};
use crate::formula::{ANY_SIGN, CurveIndex, Formula, NEGATIVE, POSITIVE, Signs, ZERO, one_side};
use crate::model::Model;
use crate::number::{Number, ROUNDING};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

/// Bounds for the border of a profile that is nearly smooth. The first limits the difference of depths,
/// relative to the tool's size, and is added to the slack. The second limits the difference of their slopes
/// across the border. A descent that stays on either side is then as steep up to the square of the second, by
/// which `c` is lowered: see [`SLOPE_MARGIN`](super::slope::SLOPE_MARGIN).
const MAX_TANGENT_JUMP: f64 = 4e-9;
pub(super) const MAX_TANGENT_SLOPE: f64 = 1e-5;

/// The continuity of depth from one owner to another.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Joint {
    /// Nothing is known.
    None,
    /// No jump. Each of two depths is the smaller on its own side, or a region ends there.
    Lower,
    /// No jump between two regions: both depths are 0 where they meet.
    Zero,
    /// No jump.
    Kinked,
    /// No jump of depth or of its slope.
    Smooth,
}

/// The separation of two claims to a box.
pub(super) struct Separation {
    pub(super) curve: CurveIndex,
    pub(super) joint: Joint,
    /// True if the first claim is where the curve is negative.
    pub(super) below: bool,
    /// True if depths agree on the curve next to the box, and in it perhaps no longer.
    pub(super) ends_here: bool,
    /// The largest difference of two joined depths in the box: rounding, where a profile is nearly smooth.
    pub(super) difference: f64,
}

impl Separation {
    fn new(curve: CurveIndex, joint: Joint) -> Separation {
        Separation { curve, joint, below: false, ends_here: false, difference: 0.0 }
    }
}

/// A curve as a polynomial, and a second polynomial that must be positive for the first to have the curve's
/// sign.
type Curve = (Polynomial, Option<Polynomial>);

pub(super) struct BorderProver<'m> {
    model: &'m Model,
    size: f64,
    /// The depths, their forms, and which of them are the larger or the smaller of two others.
    ids: Vec<Id>,
    depths: Vec<Option<RootForm>>,
    corners: Vec<Option<DepthCorner>>,
    /// The largest such difference.
    max_jump: f64,
    curves: Vec<Option<Curve>>,
    /// For curves that compare `d²` with a constant, what compares `d` with its root.
    cylinders: Vec<Option<Polynomial>>,
    differences: BTreeMap<[usize; 2], Rc<Vec<(CurveIndex, bool)>>>,
    zero: RootForm,
    /// The curves on which the depths of two owners agree, by the owners and by their depths' parts.
    joints: BTreeMap<(Pair, Pair), Vec<CurveIndex>>,
    /// The agreements of two owners' depths on curves.
    agreements: HashMap<(Pair, CurveIndex), Option<Rc<Agreement>>>,
    linear: Linear,
    tangencies: HashMap<(Pair, CurveIndex), Option<Tangency>>,
    /// The current box.
    cell: Cell,
}

impl<'m> BorderProver<'m> {
    /// Finds the forms of a tool's depths and curves, in its box. On a straight border depths may differ by rounding, by no more
    /// than `point_box_fraction` of the tool's size.
    pub(super) fn new(
        model: &'m Model,
        Depths { ids, corners }: Depths,
        cell: Cell,
        point_box_fraction: f64,
    ) -> BorderProver<'m> {
        let size = half_diagonal(&cell);
        let forms = &mut Forms::new(&model.graph);
        let depths: Vec<Option<RootForm>> = ids.iter().map(|depth| forms.of(*depth)).collect();
        let curves: Vec<_> = model.curve_values().map(|value| forms.of(value)?.curve()).collect();
        let cylinders = curves.iter().map(|curve| curve.as_ref()?.0.without_square_of_d());
        let cylinders = cylinders.collect();
        BorderProver {
            model,
            size,
            // No more than what a point box may hide: a later try of the proof, with larger boxes, accepts more.
            max_jump: point_box_fraction.min(MAX_TANGENT_JUMP) * size,
            differences: BTreeMap::new(),
            agreements: HashMap::new(),
            depths,
            curves,
            cylinders,
            zero: RootForm::zero(),
            joints: BTreeMap::new(),
            linear: Linear::with_depths(model, &ids),
            ids,
            corners,
            tangencies: HashMap::new(),
            cell,
        }
    }

    /// Returns whether a depth is the distance to a line, a circle or a point, or the least of several.
    pub(super) fn is_distance(&self, depth: usize) -> bool {
        match self.corners[depth] {
            Some(DepthCorner { is_larger, parts }) => {
                !is_larger && parts.into_iter().all(|part| self.is_distance(part))
            }
            None => self.depths[depth].as_ref().is_some_and(RootForm::is_distance),
        }
    }

    /// Returns whether a region's depth is a root without further terms.
    pub(super) fn is_length(&self, region: usize) -> bool {
        self.depths[region].as_ref().is_some_and(RootForm::is_length)
    }

    /// Returns whether the list of regions gives the claim's points to its owner, except on borders. If
    /// `check_overlaps` is set, also checks that no other region contains them.
    pub(super) fn is_listed_owner(
        &mut self,
        claim: &Claim,
        cover: &mut Cover<'_>,
        cell: Cell,
        check_overlaps: bool,
    ) -> bool {
        self.cell = cell;
        // A claim on a curve is a line or a point, unless that curve is 0 on an area, as `max(0, d - 2)` is.
        let is_thin = |curve: CurveIndex| self.curves[curve].is_some();
        if claim.signs.iter().any(|(curve, signs)| *signs == ZERO && is_thin(*curve)) {
            return true;
        }
        let model = self.model;
        let mut sign = |curve: CurveIndex| self.sign_on(claim, curve, cover);
        let is_in_region =
            |owner: usize| model.regions[owner].condition.decide_with(&mut sign) == Some(true);
        // A point outside needs no region; that none contains it is the question of overlaps below.
        if !claim.owner.is_none_or(is_in_region) {
            return false;
        }
        !check_overlaps
            || (0..model.regions.len()).all(|other| {
                let mut open_signs = |curve: CurveIndex| self.sign_on(claim, curve, cover) & !ZERO;
                // Borders belong to both neighbours, so the other regions are tested without theirs.
                Some(other) == claim.owner
                    || model.regions[other].condition.decide_with(&mut open_signs) == Some(false)
                    || self.excluded(claim, other)
            })
    }

    /// Returns whether linear curves prove that no point of a claim is in a region, except on borders.
    fn excluded(&self, claim: &Claim, region: usize) -> bool {
        let signs_on_path = self.signs(claim);
        let inside = &self.model.regions[region].condition;
        // A region with alternatives has no point here if each alternative has none.
        self.contradict(&signs_on_path, &[inside])
            || inside.disjunctions().iter().any(|choices| {
                choices.iter().all(|choice| self.contradict(&signs_on_path, &[inside, choice]))
            })
    }

    /// Returns whether linear curves prove that no point with these signs satisfies all of some formulas, with borders
    /// left out.
    fn contradict(&self, signs: &[Signs], demands: &[&Formula]) -> bool {
        let mut demanded_signs = vec![ANY_SIGN; signs.len()];
        demands.iter().for_each(|formula| formula.narrow_signs(&mut demanded_signs));
        let mut signs = signs.to_vec();
        for (sign, demanded) in signs.iter_mut().zip(demanded_signs) {
            // A curve that no formula mentions may be 0 there.
            *sign &= if demanded == ANY_SIGN { ANY_SIGN } else { demanded & !ZERO };
        }
        signs.contains(&0) || self.linear.contradictory(&signs)
    }

    /// Returns a curve with two claims to a box on its two sides, and the continuity of depth there. Returns
    /// `None` if the claims do not meet in the box, given that their depths are known to differ (`depths_differ`).
    pub(super) fn separation(
        &mut self,
        pair: Pair,
        claims: [&Claim; 2],
        cover: &mut Cover<'_>,
        cell: Cell,
        depths_differ: bool,
    ) -> Option<Separation> {
        self.cell = cell;
        let curves = separating_curves(claims);
        let owners = pair;
        let pair = Pair { own: self.active(pair.own), other: pair.other.map(|k| self.active(k)) };
        if let (Some(curve), true) = (curves.first(), Some(pair.own) == pair.other) {
            // The same depth on both sides.
            return Some(Separation::new(*curve, Joint::Smooth));
        }
        // A curve on both paths separates the claims without further proof, so it is tried first.
        let agreed = curves.iter().copied().find(|curve| self.agreement(pair, *curve).is_some());
        let joint = agreed.or_else(|| {
            self.joints(owners, pair).into_iter().find(|curve| {
                let [of_a, of_b] = claims.map(|claim| self.sign_on(claim, *curve, cover));
                // On opposite sides, and together on the curve at most, where the depths agree.
                of_a & of_b & !ZERO == 0
            })
        });
        let Some(joint) = joint else {
            return self.separation_without_joint(pair, claims, &curves, cover, depths_differ);
        };
        let mut separation = self.separation_by_joint(pair, claims, joint, cover, depths_differ)?;
        // Parts agree on more curves than whole depths do. The order of the depths on the claims' paths says more than
        // that they agree.
        if pair != owners
            && separation.joint == Joint::Kinked
            && self.linear_order(pair, claims) == LowerByLinear::Each([true; 2])
        {
            separation.joint = Joint::Lower;
        }
        Some(separation)
    }

    /// Returns the separation of two claims by a curve on which their depths agree.
    fn separation_by_joint(
        &mut self,
        pair: Pair,
        claims: [&Claim; 2],
        curve: CurveIndex,
        cover: &mut Cover<'_>,
        depths_differ: bool,
    ) -> Option<Separation> {
        let [of_a, of_b] = claims.map(|claim| self.sign_on(claim, curve, cover));
        let below = of_a & POSITIVE == 0 || of_b & NEGATIVE == 0;
        // A curve without an agreement is where the two depths do not differ.
        let agreement = self.agreement(pair, curve);
        let smooth = agreement.as_ref().is_some_and(|agreement| agreement.smooth);
        let is_this_branch = agreement.is_none_or(|agreement| {
            agreement.branch.as_ref().is_none_or(|branch| {
                branch.over(&self.cell).low >= 0.0 || self.is_multiple_of_depth(branch, pair)
            })
        });
        let joint = if !is_this_branch {
            // The depths may agree with the root's other branch, so nothing is known about this one.
            Joint::None
        } else if depths_differ {
            // The claims meet only where the depths agree, and here these differ: they do not meet.
            return None;
        } else if smooth {
            Joint::Smooth
        } else {
            Joint::Kinked
        };
        let ends_here = joint == Joint::None;
        Some(Separation { below, ends_here, ..Separation::new(curve, joint) })
    }

    /// Returns whether a polynomial is a positive multiple of one of a pair's depths, which are not negative where the
    /// two meet.
    fn is_multiple_of_depth(&self, polynomial: &Polynomial, Pair { own, other }: Pair) -> bool {
        let mut depths = [Some(own), other].into_iter().flatten();
        depths.any(|owner| {
            let depth = self.depths[owner].as_ref().and_then(RootForm::polynomial);
            let ratio = depth.and_then(|depth| polynomial.ratio(depth));
            ratio.is_some_and(|ratio| !ratio.is_negative())
        })
    }

    /// Returns the separation of two claims by the first of the curves for which their paths demand opposite
    /// sides, or by a straight one of them across which depth is nearly smooth.
    fn separation_without_joint(
        &mut self,
        pair: Pair,
        claims: [&Claim; 2],
        curves: &[CurveIndex],
        cover: &mut Cover<'_>,
        depths_differ: bool,
    ) -> Option<Separation> {
        let curve = *curves.first()?;
        // Arcs and lines written with doubles are tangent only up to rounding, which no argument below explains.
        if let Some(smooth) = self.smooth_separation(pair, curves) {
            return Some(smooth);
        }
        let Some(difference) = self.lower(pair, claims, curves, cover) else {
            return Some(Separation::new(curve, Joint::None));
        };
        let difference = self.without_rounding(difference);
        // Ordered depths are equal where the claims meet, so depths that differ show that these do not. A
        // difference that is only bounded shows nothing.
        let meet = !depths_differ || difference != 0.0;
        let joint = match (self.linear_order(pair, claims), pair.other) {
            (LowerByLinear::Zero, Some(_)) => Joint::Zero,
            _ => Joint::Lower,
        };
        meet.then_some(Separation { difference, ..Separation::new(curve, joint) })
    }

    /// Returns a straight curve that separates two claims, if depth is continuous across it up to rounding,
    /// and also its slope where that matters.
    fn smooth_separation(
        &mut self,
        pair: Pair,
        separating_curves: &[CurveIndex],
    ) -> Option<Separation> {
        separating_curves.iter().find_map(|curve| {
            let DepthDifference { jump, slope_across: across } = self.tangency(pair, *curve)?;
            let is_smooth = across <= MAX_TANGENT_SLOPE;
            (jump <= self.max_jump && is_smooth).then_some(Separation {
                difference: jump,
                ..Separation::new(*curve, Joint::Smooth)
            })
        })
    }

    /// Returns a difference of depths, or 0 for rounding of 256-bit constants.
    fn without_rounding(&self, difference: f64) -> f64 {
        if difference <= self.size * ROUNDING.sqrt() { 0.0 } else { difference }
    }

    /// Returns the difference of two regions' depths on a straight curve in the current box.
    fn tangency(&mut self, pair: Pair, curve: CurveIndex) -> Option<DepthDifference> {
        let Pair { own, other: Some(other) } = pair else { return None };
        let tangency = self.tangencies.entry((pair, curve)).or_insert_with(|| {
            let [own, other] = [&self.depths[own], &self.depths[other]];
            let (line, _) = self.curves[curve].as_ref()?;
            Tangency::of(own.as_ref()?, other.as_ref()?, line)
        });
        let DepthDifference { jump, slope_across: across } =
            tangency.as_ref()?.over_box(&self.cell)?;
        Some(DepthDifference { jump: self.without_rounding(jump), slope_across: across })
    }
}

/// Returns the signs in the closure of the set with these signs.
fn closure(signs: Signs) -> Signs {
    if signs & (NEGATIVE | POSITIVE) != 0 { signs | ZERO } else { signs }
}

/// Returns the curves for which the paths to two claims demand opposite sides.
fn separating_curves([a, b]: [&Claim; 2]) -> Vec<CurveIndex> {
    let mut curves = Vec::new();
    for (curve, signs) in &a.signs {
        // 0 may be on both paths, since only one of the two has the curve itself.
        let is_opposite =
            b.signs.iter().any(|(other, others)| other == curve && signs & others & !ZERO == 0);
        if is_opposite && !curves.contains(curve) {
            curves.push(*curve);
        }
    }
    curves
}

impl BorderProver<'_> {
    /// Returns the depth itself, or its part that it equals throughout the current box.
    fn active(&self, depth: usize) -> usize {
        let Some(DepthCorner { is_larger, parts: [a, b] }) = self.corners[depth] else {
            return depth;
        };
        if self.is_less_in_box([Some(a), Some(b)]) {
            self.active(if is_larger { b } else { a })
        } else if self.is_less_in_box([Some(b), Some(a)]) {
            self.active(if is_larger { a } else { b })
        } else {
            depth
        }
    }

    /// Returns the curves on which the depths of two owners agree, given as their parts in the current box.
    fn joints(&mut self, owners: Pair, pair: Pair) -> Vec<CurveIndex> {
        if let Some(known) = self.joints.get(&(owners, pair)) {
            return known.clone();
        }
        // The border of neighbours is among their own conditions.
        let mut atoms = Vec::new();
        for owner in [Some(owners.own), owners.other].into_iter().flatten() {
            self.model.regions[owner]
                .condition
                .undecided_atoms(&vec![ANY_SIGN; self.curves.len()], &mut atoms);
        }
        let condition_curves: BTreeSet<CurveIndex> =
            atoms.into_iter().map(|(curve, _)| curve).collect();
        let differences = self.differences(pair);
        let mut joints: Vec<CurveIndex> = differences.iter().map(|(curve, _)| *curve).collect();
        joints.extend(
            condition_curves.into_iter().filter(|curve| self.agreement(pair, *curve).is_some()),
        );
        self.joints.insert((owners, pair), joints.clone());
        joints
    }

    /// Returns how two owners' depths agree on a curve, if they do.
    fn agreement(&mut self, pair: Pair, curve: CurveIndex) -> Option<Rc<Agreement>> {
        let agreement = self.agreements.entry((pair, curve)).or_insert_with(|| {
            let other = pair.other.map_or(Some(&self.zero), |other| self.depths[other].as_ref());
            let difference = self.depths[pair.own].as_ref()?.difference(other?)?;
            let (polynomial, _) = self.curves[curve].as_ref()?;
            let agreement = difference
                .agreement_on(polynomial)
                .or_else(|| difference.agreement_on(self.cylinders[curve].as_ref()?));
            agreement.map(Rc::new)
        });
        agreement.clone()
    }

    /// Returns the curves that are the difference of two depths by their expressions. Each comes with whether it is positive where the first depth is larger.
    fn differences(&mut self, Pair { own, other }: Pair) -> Rc<Vec<(CurveIndex, bool)>> {
        let Some(other) = other else { return Rc::default() };
        if let Some(known) = self.differences.get(&[own, other]) {
            return known.clone();
        }
        let curves = 0..self.model.curves.len();
        let found = curves
            .filter_map(|curve| Some((curve, self.is_positive_where_larger(curve, [own, other])?)));
        let found = Rc::new(found.collect());
        self.differences.insert([own, other], Rc::clone(&found));
        found
    }

    /// Returns whether a curve is positive where the first of two depths is larger, if it is their difference.
    fn is_positive_where_larger(
        &self,
        curve: CurveIndex,
        [own, other]: [usize; 2],
    ) -> Option<bool> {
        let [a, b] = [own, other].map(|depth| self.ids[depth]);
        match *self.model.graph.node(self.model.curves[curve].value) {
            Node::Sub(more, less) if [more, less] == [a, b] => Some(true),
            Node::Sub(more, less) if [more, less] == [b, a] => Some(false),
            _ => None,
        }
    }
}

impl BorderProver<'_> {
    /// Returns the signs that a curve can have at a claim's points in the current box. They follow from the
    /// box, from the path down the tree, and from straight curves on that path.
    fn sign_on(&mut self, claim: &Claim, curve: CurveIndex, cover: &mut Cover<'_>) -> Signs {
        let mut signs = cover.sign_at_claim(claim, curve);
        if signs & NEGATIVE != 0 && signs & POSITIVE != 0 {
            // The costlier argument is asked only while both sides are possible.
            signs &= self.signs_by_linear(claim, curve);
        }
        signs
    }

    /// Returns a curve as a polynomial, if that has the curve's sign throughout the current box.
    fn signed(&self, curve: CurveIndex) -> Option<&Polynomial> {
        let (polynomial, positive) = self.curves[curve].as_ref()?;
        let has_curve_sign =
            positive.as_ref().is_none_or(|positive| positive.over(&self.cell).low > 0.0);
        has_curve_sign.then_some(polynomial)
    }

    /// Returns the signs that a claim's path leaves possible.
    fn signs(&self, claim: &Claim) -> Vec<Signs> {
        let mut signs = vec![ANY_SIGN; self.curves.len()];
        for (curve, known) in &claim.signs {
            signs[*curve] &= known;
        }
        signs
    }

    /// Returns the signs that a curve can have according to all linear curves on a claim's path together.
    fn signs_by_linear(&self, claim: &Claim, curve: CurveIndex) -> Signs {
        let mut signs = self.signs(claim);
        let mut possible = ANY_SIGN;
        for side in [NEGATIVE, POSITIVE] {
            signs[curve] = side;
            // Elimination proves a side empty; that it finds no contradiction proves nothing.
            if self.linear.contradictory_in(claim.owner, &signs) {
                possible &= !side;
            }
        }
        possible
    }
}

/// The order of two depths, according to the linear curves on the paths to their claims.
#[derive(Clone, Copy, PartialEq)]
enum LowerByLinear {
    /// Both are 0 where the claims meet.
    Zero,
    /// For each, whether it is proved to be the smaller at its own claim's points.
    Each([bool; 2]),
}

/// The index of a depth in [`Depths`]; `None` for the outside, whose depth is 0.
type Owner = Option<usize>;

impl BorderProver<'_> {
    /// Returns an upper bound of the difference of two claims' depths where they meet in the current box. It is found if each of
    /// two regions' depths is the smaller at its own claim's points, or if a region's depth is 0 where it meets the outside.
    fn lower(
        &mut self,
        pair: Pair,
        claims: [&Claim; 2],
        separating_curves: &[CurveIndex],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        // Both depths are 0 where the claims meet.
        let LowerByLinear::Each(lesser) = self.linear_order(pair, claims) else { return Some(0.0) };
        let Pair { own, other: Some(other) } = pair else {
            let own = Some(pair.own);
            let below = self.excess(claims[1], [own, None], cover)?;
            let above = self.excess(claims[0], [None, own], cover)?;
            return Some(below.max(above)).filter(|difference| *difference <= self.max_jump);
        };
        let owners = [[own, other], [other, own]];
        // Descents also require the order next to the border, not only on it.
        let is_less = [0, 1]
            .map(|k| lesser[k] || self.excess(claims[k], owners[k].map(Some), cover) == Some(0.0));
        let side = match is_less {
            [true, true] => return Some(0.0),
            [false, false] => return None,
            // One half is proved. The other depth may be no more than a third, which continues its neighbour's
            // across the border.
            [true, false] => 1,
            [false, true] => 0,
        };
        let signs = self.listed_signs(claims[side]);
        self.lesser_than_third(owners[side], &signs, separating_curves).then_some(0.0)
    }

    /// Returns the order of two depths at their claims' points by linear curves.
    fn linear_order(&self, pair: Pair, claims: [&Claim; 2]) -> LowerByLinear {
        let signs = claims.map(|claim| self.listed_signs(claim));
        self.lower_by_linear(pair, &signs)
    }

    /// Returns an upper bound of the excess of the first depth over the second at a claim's points in the current box, according
    /// to the sign of a curve on the claim's path, to enclosures, or to a line. A depth with a corner is compared by its parts.
    fn excess(
        &mut self,
        claim: &Claim,
        [less, more]: [Owner; 2],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        let corner = |owner: Owner| self.corners[owner?];
        // The excess over the smaller of two, like that of the larger, is the larger of two excesses; the other two
        // cases come after these, because a part that suffices for one of two may not suffice for both.
        let (pairs, both) = match (corner(less), corner(more)) {
            (Some(DepthCorner { is_larger: true, parts }), _) => {
                (parts.map(|part| [Some(part), more]), true)
            }
            (_, Some(DepthCorner { is_larger: false, parts })) => {
                (parts.map(|part| [less, Some(part)]), true)
            }
            (Some(DepthCorner { is_larger: false, parts }), _) => {
                (parts.map(|part| [Some(part), more]), false)
            }
            (_, Some(DepthCorner { is_larger: true, parts })) => {
                (parts.map(|part| [less, Some(part)]), false)
            }
            (None, None) => {
                let is_less =
                    self.ordered([less, more], claim, cover) || self.is_less_in_box([less, more]);
                return if is_less {
                    Some(0.0)
                } else {
                    self.excess_beside_line(claim, [less, more])
                };
            }
        };
        match pairs.map(|pair| self.excess(claim, pair, cover)) {
            [Some(a), Some(b)] => Some(if both { a.max(b) } else { a.min(b) }),
            [known, other] if !both => known.or(other),
            _ => None,
        }
    }

    /// Returns an upper bound of the amount by which a region's linear depth is above or below 0, on one side of a straight curve
    /// on the claim's path that differs from it by a constant.
    fn excess_beside_line(&self, claim: &Claim, sides: [Owner; 2]) -> Option<f64> {
        let (own, is_more) = match sides {
            [Some(own), None] => (own, false),
            [None, Some(own)] => (own, true),
            _ => return None,
        };
        let depth = self.depths[own].as_ref()?.polynomial()?;
        let lines = claim.signs.iter().filter_map(|(curve, signs)| {
            let is_below = one_side(*signs)?;
            let (line, _) = self.curves[*curve].as_ref()?;
            // With a gradient of length 1, the line is a distance like the depth. With this sign it is at most 0 where the depth is
            // bounded above, and at least 0 where it is bounded below: it lies between the depth and 0.
            let sign = Number::int(if is_below == is_more { 1 } else { -1 });
            let minus_line = line.with_unit_slope()?.scaled(&sign);
            let difference = Interval::enclosing(&minus_line.plus(depth).constant()?);
            Some(if is_more { -difference.low } else { difference.high }.max(0.0))
        });
        lines.reduce(f64::min)
    }

    /// Returns whether the first of two depths is nowhere larger than the second in the current box. This tells apart
    /// the parts of a depth, which do not all meet the neighbour's.
    fn is_less_in_box(&self, [less, more]: [Owner; 2]) -> bool {
        let enclosed = |owner: Owner| match owner {
            Some(owner) => self.enclosed(owner),
            None => Some(NOTHING),
        };
        let in_box = || enclosed(less).zip(enclosed(more)).is_some_and(|(a, b)| a.high <= b.low);
        less == more || in_box()
    }

    /// Encloses a depth in the current box, if it or its parts have forms.
    fn enclosed(&self, depth: usize) -> Option<Interval> {
        match self.corners[depth] {
            Some(DepthCorner { is_larger, parts: [a, b] }) => {
                let (a, b) = (self.enclosed(a)?, self.enclosed(b)?);
                Some(if is_larger { a.max(b) } else { a.min(b) })
            }
            None => Some(self.depths[depth].as_ref()?.over_box(&self.cell)),
        }
    }

    /// Returns whether the first of two depths is the smaller at a claim's points in the current box,
    /// according to the sign of a curve on which they agree.
    fn ordered(&mut self, [less, more]: [Owner; 2], claim: &Claim, cover: &mut Cover<'_>) -> bool {
        // Pairs are ordered with the outside last, and the region listed earlier first.
        let is_swapped = less.is_none() || more.is_some_and(|more| Some(more) < less);
        let ordered = if is_swapped { [more, less] } else { [less, more] };
        let [Some(own), other] = ordered else { return false };
        let by_difference =
            self.differences(Pair { own, other }).iter().any(|(curve, own_is_more)| {
                one_side(cover.sign_at_claim(claim, *curve)) == Some(*own_is_more != is_swapped)
            });
        let one_sided = claim.signs.iter().filter(|(_, signs)| one_side(*signs).is_some());
        by_difference
            || one_sided.into_iter().any(|(curve, _)| {
                let signs = cover.sign_at_claim(claim, *curve);
                let agreement = self.agreement(Pair { own, other }, *curve);
                let Some(order) = agreement.as_ref().and_then(|found| found.order.as_ref()) else {
                    return false;
                };
                self.signed(*curve).is_some() && order.is_lesser(is_swapped, signs, &self.cell)
            })
    }

    /// Returns the signs at a claim's points.
    fn listed_signs(&self, claim: &Claim) -> Vec<Signs> {
        let mut signs = self.signs(claim);
        // Owners are checked against the list of regions, so its conditions hold too.
        if let Some(owner) = claim.owner {
            self.model.regions[owner].condition.narrow_signs(&mut signs);
        }
        signs
    }

    /// Returns the order of two depths according to all linear curves on the paths to the claims.
    fn lower_by_linear(&self, pair: Pair, signs: &[Vec<Signs>; 2]) -> LowerByLinear {
        let Pair { own, other } = pair;
        let lesser = match other {
            Some(other) => [(0, own, other), (1, other, own)]
                .map(|(k, less, more)| self.linear.no_deeper(&signs[k], Some(less), Some(more))),
            // The outside's depth is 0, so that zeros of both, below, settle its border.
            None => [false; 2],
        };
        // The order of two regions says more than that both are 0: their depths may fall toward each other.
        if lesser != [true; 2] && self.are_zero_where_claims_meet(pair, [&signs[0], &signs[1]]) {
            return LowerByLinear::Zero;
        }
        LowerByLinear::Each(lesser)
    }

    fn are_zero_where_claims_meet(
        &self,
        Pair { own, other }: Pair,
        [at_a, at_b]: [&[Signs]; 2],
    ) -> bool {
        let common_signs: Vec<Signs> =
            at_a.iter().zip(at_b).map(|(a, b)| closure(*a) & closure(*b)).collect();
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
            third != own
                && third != other
                && separating_curves.iter().any(|curve| self.is_continued(other, third, *curve))
                && self.linear.no_deeper(signs, Some(own), Some(third))
        })
    }

    /// Returns whether a third depth continues a region's own one smoothly across a curve.
    fn is_continued(&mut self, own: usize, third: usize, curve: CurveIndex) -> bool {
        let Some(agreement) = self.agreement(Pair { own, other: Some(third) }, curve) else {
            return false;
        };
        // Without roots there is no other branch, and the slopes decide.
        let Some(branch) = &agreement.branch else { return agreement.smooth };
        agreement.smooth && self.is_multiple_of_depth(branch, Pair { own, other: None })
    }
}
