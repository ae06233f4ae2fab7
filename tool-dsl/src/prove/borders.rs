//! Separation of two owners of a box: a curve with the owners on its two sides, and whether depth is
//! continuous across it.

use super::SMALL_BOX_FRACTION;
use super::cover::{Claim, Cover, half_diagonal};
use super::depths::{DepthCorner, Depths};
use super::distances::{DepthDifference, Tangency, excess};
use super::root::{Agreement, Difference, Forms, RootForm, RootSum};
use super::tangency::Contact;
use crate::elimination::Linear;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::expr::polynomial::{ClearSide, Polynomial};
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::expr::{Id, Node};
use crate::formula::{ANY_SIGN, CurveIndex, Formula, NEGATIVE, POSITIVE, Signs, ZERO, one_side};
use crate::model::Model;
use crate::number::{Number, ROUNDING};
use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

/// The number of boxes in which the contact of two conics is searched for.
const MAX_CONTACT_BOXES: u32 = 12;

/// Bounds for the border of a profile that is nearly smooth. The first limits the difference of depths,
/// relative to the tool's size, and is added to the slack. The second limits the difference of their slopes
/// across the border. A descent that stays on either side is then as steep up to the square of the second, by
/// which `c` is lowered: see [`SLOPE_MARGIN`](super::slope::SLOPE_MARGIN).
const MAX_TANGENT_JUMP: f64 = 4e-9;
pub(super) const MAX_TANGENT_SLOPE: f64 = 1e-5;

/// A region and its neighbour, or `None` for the outside, where depth is 0. Of two regions, the one listed earlier is
/// first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Pair {
    pub(super) own: usize,
    pub(super) other: Option<usize>,
}

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

/// An owner and the number of a path down the tree to it. What follows from the signs on that path alone is
/// the same for all claims with it, in any box.
type Leaf = (Option<usize>, usize);

/// The search for the contact of two curves.
#[derive(Clone, Copy)]
enum ContactSearch {
    /// The number of boxes near which there was none.
    Failed(u32),
    /// The signs that the second curve can have where the first is negative, and where it is positive. They
    /// follow from the two curves alone, and so hold in every box.
    Found([Signs; 2]),
}

/// The agreement of a pair's depths on each curve, if they agree there. A cell is empty until it is asked for.
type AgreementsByCurve = Vec<OnceCell<Option<Rc<Agreement>>>>;

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
    /// True if depths of adjacent regions may differ by rounding, whatever their slopes.
    may_jump: bool,
    /// The largest such difference.
    max_jump: f64,
    /// True if owners are checked against the list of regions.
    check_listed_owners: bool,
    curves: Vec<Option<Curve>>,
    /// For curves that compare `d²` with a constant, what compares `d` with its root.
    cylinders: Vec<Option<Polynomial>>,
    /// The curves that are straight.
    is_straight: Vec<bool>,
    /// The curves that are not polynomials but sums of roots.
    sums: Vec<Option<RootSum>>,
    differences: BTreeMap<[usize; 2], Rc<Vec<(CurveIndex, bool)>>>,
    /// For a depth, whether it is the greater of two, a straight curve, and the side below it: its excess there.
    beside_line: HashMap<(usize, bool, CurveIndex, bool), Option<ExcessBesideLine>>,
    zero: RootForm,
    /// The curves on which the depths of two owners agree, by the owners and by their depths' parts.
    joints: BTreeMap<(Pair, Pair), Vec<CurveIndex>>,
    /// For a depth, and for the outside and then each depth, the agreements of the two. Rows are empty until
    /// something is known.
    agreements: Vec<Vec<AgreementsByCurve>>,
    /// The differences of the depths of two owners, and the squares of curves, to which agreements compare them.
    depth_differences: BTreeMap<Pair, Option<Difference>>,
    squares: Vec<Option<Polynomial>>,
    /// The sides of lines on which conics have one sign: a row by line, of entries by curve. Rows are empty
    /// until something is known.
    clear_sides: Vec<Vec<OnceCell<Option<ClearSide>>>>,
    /// The signs of a curve that linear curves leave possible.
    by_linear: HashMap<(Leaf, CurveIndex), Signs>,
    linear: Linear,
    /// The order of two depths, each at its own claim, according to linear curves.
    lower: HashMap<([Leaf; 2], Pair), LowerByLinear>,
    /// True if the first of two depths, at its own leaf, is at most a third one that continues the other.
    lower_by_third: HashMap<([Leaf; 2], [usize; 2]), bool>,
    /// True if a claim has no point of a region.
    excluded: HashMap<(usize, usize), bool>,
    /// True if a depth is at most another at a leaf's points, according to linear curves.
    no_deeper: HashMap<(Leaf, [usize; 2]), bool>,
    /// An upper bound of the excess of one depth over another.
    excesses: HashMap<(usize, usize), Option<f64>>,
    contacts: HashMap<(CurveIndex, CurveIndex), ContactSearch>,
    tangencies: HashMap<(Pair, CurveIndex), Option<Tangency>>,
    values: Evaluator<'m>,
    /// The point at which depths were evaluated last.
    evaluated_at: Option<[f64; 3]>,
    /// The current box.
    cell: Cell,
}

impl<'m> BorderProver<'m> {
    /// Finds the forms of a tool's depths and curves, in its box. With `may_jump`, depths may differ by
    /// rounding, because slopes across borders do not matter; by no more than `point_box_fraction` of the
    /// tool's size.
    pub(super) fn new(
        model: &'m Model,
        Depths { ids, corners }: Depths,
        cell: Cell,
        forms: &mut Forms<'_>,
        may_jump: bool,
        point_box_fraction: f64,
    ) -> BorderProver<'m> {
        let size = half_diagonal(&cell);
        let depths: Vec<Option<RootForm>> = ids.iter().map(|depth| forms.of(*depth)).collect();
        let curves: Vec<_> = model.curve_values().map(|value| forms.of(value)?.curve()).collect();
        let cylinders = curves.iter().map(|curve| curve.as_ref()?.0.without_square_of_d());
        let cylinders = cylinders.collect();
        let sums = model.curve_values().zip(&curves).map(|(value, curve)| match curve {
            Some(_) => None,
            None => RootSum::of(&model.graph, forms, value),
        });
        let is_straight =
            |curve: &Option<Curve>| curve.as_ref().is_some_and(|(curve, _)| curve.is_linear());
        BorderProver {
            model,
            size,
            depth_differences: BTreeMap::new(),
            squares: curves
                .iter()
                .map(|curve| curve.as_ref().and_then(|(curve, _)| curve.times(curve)))
                .collect(),
            may_jump,
            // No more than what a point box may hide: a later try of the proof, with larger boxes, accepts more.
            max_jump: point_box_fraction.min(MAX_TANGENT_JUMP) * size,
            // Where depth is the distance, the owner is proved to be the nearest instead.
            check_listed_owners: !model.is_exact(),
            values: Evaluator::new(&model.graph, ids.iter().copied()),
            sums: sums.collect(),
            differences: BTreeMap::new(),
            agreements: vec![Vec::new(); depths.len()],
            depths,
            is_straight: curves.iter().map(is_straight).collect(),
            clear_sides: vec![Vec::new(); curves.len()],
            curves,
            cylinders,
            zero: RootForm::zero(),
            joints: BTreeMap::new(),
            by_linear: HashMap::new(),
            linear: Linear::with_depths(model, &ids, cell),
            ids,
            corners,
            lower: HashMap::new(),
            lower_by_third: HashMap::new(),
            excluded: HashMap::new(),
            no_deeper: HashMap::new(),
            excesses: HashMap::new(),
            beside_line: HashMap::new(),
            evaluated_at: None,
            contacts: HashMap::new(),
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

    /// Returns the form of a region's depth.
    pub(super) fn depth(&self, region: usize) -> Option<&RootForm> {
        self.depths[region].as_ref()
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
        let is_thin =
            |curve: CurveIndex| self.curves[curve].is_some() || self.sums[curve].is_some();
        if claim.signs.iter().any(|(curve, signs)| *signs == ZERO && is_thin(*curve)) {
            return true;
        }
        let model = self.model;
        let mut sign = |curve: CurveIndex| self.sign_on(claim, curve, cover);
        let is_in_region =
            |owner: usize| model.regions[owner].inside.decide_with(&mut sign) == Some(true);
        // A point outside needs no region; that none contains it is the question of overlaps below.
        if !claim.owner.is_none_or(is_in_region) {
            return false;
        }
        !check_overlaps
            || (0..model.regions.len()).all(|other| {
                let mut open_signs = |curve: CurveIndex| self.sign_on(claim, curve, cover) & !ZERO;
                // Borders belong to both neighbours, so the other regions are tested without theirs.
                Some(other) == claim.owner
                    || model.regions[other].inside.decide_with(&mut open_signs) == Some(false)
                    || self.excluded(claim, other)
            })
    }

    /// Returns whether linear curves prove that no point of a claim is in a region, except on borders.
    fn excluded(&mut self, claim: &Claim, region: usize) -> bool {
        let key = (region, claim.path);
        if let Some(known) = self.excluded.get(&key) {
            return *known;
        }
        let signs_on_path = self.signs(claim);
        let inside = &self.model.regions[region].inside;
        // A region with alternatives has no point here if each alternative has none.
        let excluded = self.contradict(&signs_on_path, &[inside])
            || inside.disjunctions().iter().any(|choices| {
                choices.iter().all(|choice| self.contradict(&signs_on_path, &[inside, choice]))
            });
        self.excluded.insert(key, excluded);
        excluded
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
            let is_smooth = self.may_jump || across <= MAX_TANGENT_SLOPE;
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

fn leaf(claim: &Claim) -> Leaf {
    (claim.owner, claim.path)
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
                .inside
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
        // Rows grow when they are needed, since most pairs of a large tool never meet.
        let row = &mut self.agreements[pair.own];
        row.resize(self.depths.len() + 1, Vec::new());
        let by_curve = &mut row[pair.other.map_or(0, |other| other + 1)];
        by_curve.resize(self.curves.len(), OnceCell::new());
        let agreement = by_curve[curve].get_or_init(|| {
            let difference = self.depth_differences.entry(pair).or_insert_with(|| {
                let other =
                    pair.other.map_or(Some(&self.zero), |other| self.depths[other].as_ref());
                self.depths[pair.own].as_ref()?.difference(other?)
            });
            let (polynomial, _) = self.curves[curve].as_ref()?;
            let (square, difference) = (self.squares[curve].as_ref(), difference.as_ref()?);
            let agreement = difference
                .agreement_on(polynomial, square)
                .or_else(|| difference.agreement_on(self.cylinders[curve].as_ref()?, None));
            agreement.map(Rc::new)
        });
        agreement.clone()
    }

    /// Returns the curves on which two depths are equal, recognised by their expressions or their sums of
    /// roots. Each comes with whether it is positive where the first depth is larger.
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

    /// Returns whether a curve is positive where the first of two depths is larger, if it is their difference up to a
    /// factor.
    fn is_positive_where_larger(
        &self,
        curve: CurveIndex,
        [own, other]: [usize; 2],
    ) -> Option<bool> {
        let [a, b] = [own, other].map(|depth| self.ids[depth]);
        match *self.model.graph.node(self.model.curves[curve].value) {
            Node::Sub(more, less) if [more, less] == [a, b] => Some(true),
            Node::Sub(more, less) if [more, less] == [b, a] => Some(false),
            _ => {
                let (own, other) = (self.depths[own].as_ref()?, self.depths[other].as_ref()?);
                let ratio = self.sums[curve].as_ref()?.ratio_to_difference(own, other)?;
                Some(!ratio.is_negative())
            }
        }
    }
}

impl BorderProver<'_> {
    /// Returns the signs that a curve can have at a claim's points in the current box. They follow from the
    /// box, from the path down the tree, and from straight curves on that path.
    fn sign_on(&mut self, claim: &Claim, curve: CurveIndex, cover: &mut Cover<'_>) -> Signs {
        let mut signs = cover.sign_at_claim(claim, curve);
        for (other, side) in &claim.signs {
            // A curve that may have both signs implies nothing about another.
            if *side & NEGATIVE == 0 || *side & POSITIVE == 0 {
                signs &= self.implied(*other, *side & NEGATIVE != 0, curve);
            }
        }
        if signs & NEGATIVE != 0 && signs & POSITIVE != 0 {
            // The costlier arguments are asked only while both sides are possible.
            signs &= self.signs_by_linear(claim, curve);
        }
        if signs & NEGATIVE != 0 && signs & POSITIVE != 0 {
            signs &= self.signs_by_contact(claim, curve);
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
            // Between a line and a conic, `implied` decides.
            if self.is_straight[*other] || self.is_straight[curve] {
                continue;
            }
            let (Some(conic), Some(own)) = (self.signed(*other), self.signed(curve)) else {
                continue;
            };
            let key = (*other, curve);
            let search = match self.contacts.get(&key) {
                // Newton steps from another box may find a contact that was too far from the last one.
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
    fn signs(&self, claim: &Claim) -> Vec<Signs> {
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
            // Elimination proves a side empty; that it finds no contradiction proves nothing.
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
        match (self.clear_side(known, curve), self.clear_side(curve, known)) {
            // The points are beside the line, on the side where the conic has one sign.
            (Some(clear), _) if clear.is_below == below => closed_side(clear.is_positive),
            // The points are inside the conic, which lies on the other side of the line.
            (_, Some(clear)) if clear.is_positive == below => closed_side(clear.is_below),
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
    ContactSearch::Found([-1, 1].map(|from| {
        // If the second curve is at least 0 there, it is not negative, and vice versa.
        let excluded = [(1, NEGATIVE), (-1, POSITIVE)];
        let implied = excluded.into_iter().filter(|(to, _)| contact.implies(from, *to));
        implied.fold(ANY_SIGN, |possible, (_, sign)| possible & !sign)
    }))
}

/// Returns the signs on one side of a curve and on the curve itself.
fn closed_side(positive: bool) -> Signs {
    ZERO | if positive { POSITIVE } else { NEGATIVE }
}

/// The largest difference, in half diagonals of the box, between a candidate third depth and the depths of
/// the two regions that meet there.
const MAX_DIFFERENCE_IN_HALF_DIAGONALS: f64 = 8.0;

/// The order of two depths, according to the linear curves on the paths to their claims.
#[derive(Clone, Copy, PartialEq)]
enum LowerByLinear {
    /// Both are 0 where the claims meet.
    Zero,
    /// For each, whether it is proved to be the smaller at its own claim's points.
    Each([bool; 2]),
}

/// The excess of one of two depths over the other, one of which is the distance from a line.
enum ExcessBesideLine {
    /// The excess itself.
    Polynomial(Polynomial),
    /// An upper bound of it everywhere.
    Bound(f64),
}

/// The index of a depth in [`Depths`]; `None` for the outside, whose depth is 0.
type Owner = Option<usize>;

impl BorderProver<'_> {
    /// Returns an upper bound of the difference of two claims' depths where they meet in the current box. It
    /// is found if each of two regions' depths is the smaller at its own claim's points, or if a region's
    /// depth is 0 where it meets the outside.
    fn lower(
        &mut self,
        pair: Pair,
        claims: [&Claim; 2],
        separating_curves: &[CurveIndex],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        // Both depths are 0 where the claims meet.
        let LowerByLinear::Each(lesser) = self.linear_order(pair, claims) else { return Some(0.0) };
        let key = claims.map(leaf);
        let Pair { own, other: Some(other) } = pair else {
            let own = Some(pair.own);
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
            // One half is proved. The other depth may be no more than a third, which continues its neighbour's
            // across the border.
            [Some(excess), None] => (1, excess),
            [None, Some(excess)] => (0, excess),
        };
        let lower = match self.lower_by_third.get(&(key, owners[side])) {
            Some(known) => *known,
            None => {
                let signs = self.listed_signs(claims[side]);
                let lower = self.lesser_than_third(owners[side], &signs, separating_curves);
                self.lower_by_third.insert((key, owners[side]), lower);
                lower
            }
        };
        lower.then_some(excess)
    }

    /// Returns the order of two depths at their claims' points by linear curves, found once for each pair of leaves.
    fn linear_order(&mut self, pair: Pair, claims: [&Claim; 2]) -> LowerByLinear {
        let key = (claims.map(leaf), pair);
        if let Some(known) = self.lower.get(&key) {
            return *known;
        }
        let signs = claims.map(|claim| self.listed_signs(claim));
        let order = self.lower_by_linear(pair, &signs);
        self.lower.insert(key, order);
        order
    }

    /// Returns an upper bound of the excess of the first depth over the second at a claim's points in the
    /// current box, or at those on given borders. It is proved by the sign of a curve on the claim's path, or
    /// by a third depth between the two. The third is compared with one of them by such a sign, and with the
    /// other everywhere or on such a border. A depth with a corner is compared by its parts.
    fn excess_on(
        &mut self,
        claim: &Claim,
        borders: &[CurveIndex],
        [less, more]: [Owner; 2],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        let corner = |owner: Owner| self.corners[owner?];
        // The excess over the smaller of two, like that of the larger, is the larger of two excesses; the other two
        // cases come after these, because a part that suffices for one of two may not suffice for both.
        let (parts, both) = match (corner(less), corner(more)) {
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
            (None, None) => return self.excess_of_smooth(claim, borders, [less, more], cover),
        };
        let excesses = parts.map(|pair| self.excess_on(claim, borders, pair, cover));
        match excesses {
            [Some(a), Some(b)] => Some(if both { a.max(b) } else { a.min(b) }),
            [known, other] if !both => known.or(other),
            _ => None,
        }
    }

    /// The same for depths without a corner.
    fn excess_of_smooth(
        &mut self,
        claim: &Claim,
        borders: &[CurveIndex],
        [less, more]: [Owner; 2],
        cover: &mut Cover<'_>,
    ) -> Option<f64> {
        // The third depths come last: each costs a comparison with both.
        if self.ordered([less, more], claim, cover) || self.is_less_in_box([less, more]) {
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
                // With a gradient of length 1, the line is a distance like the depth.
                let line = line.is_linear().then(|| line.with_unit_slope())??;
                let sign = Number::int(if is_below == is_more { -1 } else { 1 });
                // With this sign the line is at most 0 where the depth is bounded above, and at least 0 where it is
                // bounded below: it lies between the depth and 0.
                let line = RootForm::from_polynomial(&line.scaled(&sign));
                let [less, more] = if is_more { [&line, depth] } else { [depth, &line] };
                match (less.polynomial(), more.polynomial()) {
                    // A difference of two polynomials is enclosed in each box. With a root, it has one bound
                    // everywhere.
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

    /// Returns an upper bound of the excess of one region's depth over another's: everywhere, or by linear
    /// curves at a claim's points.
    fn excess(&mut self, claim: &Claim, [less, more]: [Owner; 2]) -> Option<f64> {
        let [less, more] = [less?, more?];
        let (a, b) = (self.depths[less].as_ref()?, self.depths[more].as_ref()?);
        let excess = *self.excesses.entry((less, more)).or_insert_with(|| excess(a, b));
        // Elimination could not improve on this.
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
        let pair = Pair { own: a.min(b), other: Some(a.max(b)) };
        let jumps = borders.iter().filter_map(|curve| match self.agreement(pair, *curve) {
            Some(agreement) => agreement
                .branch
                .as_ref()
                .is_none_or(|branch| branch.over(&self.cell).low > 0.0)
                .then_some(0.0),
            None => Some(self.tangency(pair, *curve)?.jump),
        });
        jumps.reduce(f64::min)
    }

    /// Returns candidates for a depth between two others throughout the current box, if that is small. The
    /// choice affects only the run time.
    fn third_depths(&mut self, pair: [Owner; 2]) -> Vec<Owner> {
        // In a large box too many depths are near the two, and few of them lie between.
        let reach = half_diagonal(&self.cell);
        if reach > SMALL_BOX_FRACTION * self.size {
            return Vec::new();
        }
        let middle @ [x, y, z] = self.cell.middle();
        // All pairs of a box ask for the same point.
        if self.evaluated_at != Some(middle) {
            self.evaluated_at = Some(middle);
            self.values.evaluate(EvaluationPoint::new(x, y, z));
        }
        let depth = |owner: Owner| owner.map_or(0.0, |owner| self.values.get(self.ids[owner]));
        let (depths, max_difference) = (pair.map(depth), MAX_DIFFERENCE_IN_HALF_DIAGONALS * reach);
        let others = (0..self.ids.len()).map(Some).filter(|third| !pair.contains(third));
        others
            .filter(|third| depths.iter().all(|own| (depth(*third) - own).abs() <= max_difference))
            .collect()
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
