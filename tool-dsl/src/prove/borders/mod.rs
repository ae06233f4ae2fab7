//! Separation of two owners of a box: a curve with the owners on its two sides, and whether depth is
//! continuous across it.

mod agreement;
mod order;
mod signs;

use super::cover::{Claim, Cover, half_diagonal};
use super::root::{Agreement, Difference, Forms, RootForm};
use super::sum::RootSum;
use super::tangent::{DepthDifference, Tangency};
use crate::elimination::Linear;
use crate::expr::Id;
use crate::expr::interval::Cell;
use crate::expr::polynomial::{ClearSide, Polynomial};
use crate::expr::value::Evaluator;
use crate::formula::{ANY_SIGN, CurveIndex, Formula, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::number::ROUNDING;
use order::{ExcessBesideLine, LowerByLinear};
use std::cell::OnceCell;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// The number of boxes in which the contact of two conics is searched for.
const MAX_CONTACT_BOXES: u32 = 12;

/// Bounds for the border of a profile that is nearly smooth. The first limits the difference of depths,
/// relative to the tool's size, and is added to the slack. The second limits the difference of their slopes
/// across the border. A descent that stays on either side is then as steep up to the square of the second, by
/// which `c` is lowered: see [`SLOPE_MARGIN`](super::nonsmooth::SLOPE_MARGIN).
const MAX_TANGENT_JUMP: f64 = 4e-9;
pub(super) const MAX_TANGENT_SLOPE: f64 = 1e-5;

/// A region and its neighbour, or `None` for the outside, where depth is 0.
pub(super) type Pair = (usize, Option<usize>);

/// The continuity of depth from one owner to another.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Joint {
    /// Nothing is known.
    None,
    /// No jump. Each of two depths is the smaller on its own side, or both are 0.
    Lower,
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
    /// The largest difference of two joined depths in the box: rounding, where a profile is nearly smooth.
    pub(super) difference: f64,
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
pub(super) type Curve = (Polynomial, Option<Polynomial>);

pub(super) struct BorderProver<'m> {
    model: &'m Model,
    size: f64,
    /// The depths of [`Model::depths`], and their forms.
    ids: Vec<Id>,
    depths: Vec<Option<RootForm>>,
    /// True if depths of adjacent regions may differ by rounding, whatever their slopes.
    may_jump: bool,
    /// The largest such difference.
    max_jump: f64,
    /// True if owners are checked against the list of regions.
    check_listed_owners: bool,
    curves: Vec<Option<Curve>>,
    /// The curves that are straight.
    is_straight: Vec<bool>,
    /// The curves that are not polynomials but sums of roots.
    sums: Vec<Option<RootSum>>,
    differences: BTreeMap<[usize; 2], Rc<Vec<(CurveIndex, bool)>>>,
    /// For a depth, whether it is the greater of two, a straight curve, and the side below it: its excess there.
    beside_line: HashMap<(usize, bool, CurveIndex, bool), Option<ExcessBesideLine>>,
    zero: RootForm,
    /// The curves on which the depths of two owners agree.
    joints: BTreeMap<Pair, Vec<CurveIndex>>,
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
    lower: HashMap<[Leaf; 2], LowerByLinear>,
    /// True if the first or the second depth is at most a third one that continues the other.
    lower_by_third: HashMap<([Leaf; 2], usize), bool>,
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
        cell: Cell,
        forms: &mut Forms<'_>,
        may_jump: bool,
        point_box_fraction: f64,
    ) -> BorderProver<'m> {
        let (size, ids) = (half_diagonal(&cell), model.depths());
        let depths: Vec<Option<RootForm>> = ids.iter().map(|depth| forms.of(*depth)).collect();
        let values = || model.curves.iter().map(|curve| curve.value);
        let curves: Vec<_> = values().map(|value| forms.of(value)?.curve()).collect();
        let sums = values().zip(&curves).map(|(value, curve)| match curve {
            Some(_) => None,
            None => RootSum::of(&model.graph, forms, value),
        });
        let square = |curve: &Option<Curve>| {
            let (curve, _) = curve.as_ref()?;
            curve.times(curve)
        };
        let is_straight =
            |curve: &Option<Curve>| curve.as_ref().is_some_and(|(curve, _)| curve.is_linear());
        BorderProver {
            model,
            size,
            depth_differences: BTreeMap::new(),
            squares: curves.iter().map(square).collect(),
            may_jump,
            max_jump: point_box_fraction.min(MAX_TANGENT_JUMP) * size,
            check_listed_owners: !model.is_exact(),
            values: Evaluator::new(&model.graph, ids.iter().copied()),
            ids,
            sums: sums.collect(),
            differences: BTreeMap::new(),
            agreements: vec![Vec::new(); depths.len()],
            depths,
            is_straight: curves.iter().map(is_straight).collect(),
            clear_sides: vec![Vec::new(); curves.len()],
            curves,
            zero: RootForm::zero(),
            joints: BTreeMap::new(),
            by_linear: HashMap::new(),
            linear: Linear::with_depths(model, cell),
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

    /// Returns whether a region's depth is the distance to a line, a circle or a point.
    pub(super) fn is_distance(&self, region: usize) -> bool {
        self.depths[region].as_ref().is_some_and(RootForm::is_distance)
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
        // A claim with a zero sign is a line or a point.
        if claim.signs.iter().any(|(_, signs)| *signs == ZERO) {
            return true;
        }
        let model = self.model;
        let mut sign = |curve: CurveIndex| self.sign_on(claim, curve, cover);
        let is_in_region =
            |owner: usize| model.regions[owner].inside.decide_with(&mut sign) == Some(true);
        if !claim.owner.is_none_or(is_in_region) {
            return false;
        }
        !check_overlaps
            || (0..model.regions.len()).all(|other| {
                let mut open_signs = |curve: CurveIndex| self.sign_on(claim, curve, cover) & !ZERO;
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
        let linear = &self.linear;
        // Tests one of the alternatives, with borders left out.
        let empty = |demands: &[&Formula]| {
            let mut demanded_signs = vec![ANY_SIGN; signs_on_path.len()];
            demands.iter().for_each(|formula| formula.narrow_signs(&mut demanded_signs));
            let mut signs = signs_on_path.clone();
            for (sign, demanded) in signs.iter_mut().zip(demanded_signs) {
                *sign &= if demanded == ANY_SIGN { ANY_SIGN } else { demanded & !ZERO };
            }
            signs.contains(&0) || linear.contradictory(&signs)
        };
        let inside = &self.model.regions[region].inside;
        let is_excluded =
            |choices: &&[Formula]| choices.iter().all(|choice| empty(&[inside, choice]));
        let excluded = empty(&[inside]) || inside.disjunctions().iter().any(is_excluded);
        self.excluded.insert(key, excluded);
        excluded
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
        let agreed = curves.iter().copied().find(|curve| self.agreement(pair, *curve).is_some());
        let joint = agreed.or_else(|| {
            self.joints(pair).into_iter().find(|curve| {
                let [of_a, of_b] = claims.map(|claim| self.sign_on(claim, *curve, cover));
                of_a & of_b & !ZERO == 0
            })
        });
        match joint {
            Some(joint) => self.separation_by_joint(pair, claims, joint, cover, depths_differ),
            None => self.separation_without_joint(pair, claims, &curves, cover, depths_differ),
        }
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
        let branch = agreement.and_then(|found| Some(found.branch.as_ref()?.over(&self.cell)));
        let is_other_branch = branch.is_some_and(|branch| branch.high < 0.0);
        let is_this_branch = branch.is_none_or(|branch| branch.low > 0.0);
        let joint = if depths_differ || is_other_branch {
            if is_this_branch {
                return None;
            }
            // The depths may agree on the root's other branch, so nothing is known about this one.
            Joint::None
        } else if smooth {
            Joint::Smooth
        } else {
            Joint::Kinked
        };
        Some(Separation { curve, joint, below, difference: 0.0 })
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
        if let Some(smooth) = self.smooth_separation(pair, curves) {
            return Some(smooth);
        }
        let Some(difference) = self.lower(pair, claims, curves, cover) else {
            return Some(Separation { curve, joint: Joint::None, below: false, difference: 0.0 });
        };
        let difference = self.without_rounding(difference);
        let meet = !depths_differ || difference != 0.0;
        meet.then_some(Separation { curve, joint: Joint::Lower, below: false, difference })
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
                curve: *curve,
                joint: Joint::Smooth,
                below: false,
                difference: jump,
            })
        })
    }

    /// Returns a difference of depths, or 0 for rounding of 256-bit constants.
    fn without_rounding(&self, difference: f64) -> f64 {
        if difference <= self.size * ROUNDING.sqrt() { 0.0 } else { difference }
    }

    /// Returns the difference of two regions' depths on a straight curve in the current box.
    fn tangency(&mut self, pair: Pair, curve: CurveIndex) -> Option<DepthDifference> {
        let (own, Some(other)) = pair else { return None };
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
        let is_opposite =
            b.signs.iter().any(|(other, others)| other == curve && signs & others & !ZERO == 0);
        if is_opposite && !curves.contains(curve) {
            curves.push(*curve);
        }
    }
    curves
}
