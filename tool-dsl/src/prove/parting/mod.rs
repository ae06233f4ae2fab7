//! What parts two owners of a box: a curve on whose two sides they are, and whether depth goes on
//! across it without a jump.

mod order;
mod signs;

use super::cover::{Claim, Cover, reach};
use super::root::{Agreement, Forms, Rooted};
use super::sum::RootSum;
use super::tangent::{Off, Tangency};
use super::touch::Touch;
use crate::elimination::Linear;
use crate::expr::interval::Cell;
use crate::expr::polynomial::Polynomial;
use crate::expr::value::Evaluator;
use crate::expr::{Id, Node};
use crate::formula::{ANY, CurveIndex, Formula, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::number::ROUNDING;
use order::LowerByLinear;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

/// Boxes from which it is looked where two conics touch.
const TRIES: u32 = 12;

/// Bounds on the border of a profile that is all but smooth: depths differ by no more than the first, as a part of the tool's
/// size, which adds to the slack, and their slopes across it are no more than the second, so that a way down that stays on
/// either side falls as steeply but for its square, by which `c` is lowered: see [`ROUNDING`](super::kink::ROUNDING).
const TANGENT_JUMP: f64 = 4e-9;
pub(super) const TANGENT_SLOPE: f64 = 1e-5;

/// A region and another, `None` for the outside, where depth is 0.
pub(super) type Pair = (usize, Option<usize>);

/// How depth goes on from one owner to another.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Joint {
    /// Nothing is known.
    None,
    /// Without a jump; of two depths each is the lesser on its own side, or both are 0.
    Lower,
    /// Without a jump.
    Kinked,
    /// Without a jump, and neither does its slope.
    Smooth,
}

/// What parts two claims to a box.
pub(super) struct Parted {
    pub(super) curve: CurveIndex,
    pub(super) joint: Joint,
    /// Whether the first is where the curve is negative.
    pub(super) below: bool,
    /// By how much two depths that are joined may differ in the box: rounding, where a profile is all but smooth.
    pub(super) off: f64,
}

/// The signs that a way down the tree demands.
type Ways = Vec<(CurveIndex, Signs)>;

/// Where two curves touch, and how often that was looked for.
type Tried = (u32, Option<Touch>);

/// A curve as a polynomial, and what must be positive for that to have its sign.
pub(super) type Curve = (Polynomial, Option<Polynomial>);

pub(super) struct Parting<'m> {
    model: &'m Model,
    size: f64,
    /// The depths of [`Model::depths`], and their forms.
    ids: Vec<Id>,
    depths: Vec<Option<Rooted>>,
    /// True if depths of regions that meet may differ by rounding, however their slopes do.
    may_step: bool,
    /// The most that they may differ by.
    largest_step: f64,
    /// Whether it is looked whether owners are those that the list of regions says.
    listed: bool,
    curves: Vec<Option<Curve>>,
    /// The curves that are no polynomials but sums of roots.
    sums: Vec<Option<RootSum>>,
    differences: BTreeMap<[usize; 2], Rc<Vec<(CurveIndex, bool)>>>,
    /// Straight curves with a slope of 1.
    lines: HashMap<CurveIndex, Option<Polynomial>>,
    nothing: Rooted,
    /// The curves on which the depths of two owners agree.
    joints: BTreeMap<Pair, Vec<CurveIndex>>,
    agree: BTreeMap<(Pair, CurveIndex), Option<Rc<Agreement>>>,
    /// The sign that a conic has on a whole side of a line, and whether that is below it.
    apart: BTreeMap<(CurveIndex, CurveIndex), Option<(bool, bool)>>,
    /// The signs of a curve that linear curves leave.
    by_linear: HashMap<(Option<usize>, Ways, CurveIndex), Signs>,
    linear: Linear,
    /// The order of two depths, each at its own claim, by what is linear.
    lower: HashMap<(Pair, [Ways; 2]), LowerByLinear>,
    /// The first or the second of them is lesser than a third that goes on as the other.
    lower_by_third: HashMap<((Pair, [Ways; 2]), usize), bool>,
    /// Whether a claim has no point of a region.
    excluded: HashMap<(usize, Ways), bool>,
    /// A depth is no more than another where curves have these signs.
    no_deeper: HashMap<(Vec<Signs>, usize, usize), bool>,
    /// By how much a depth exceeds another at most.
    excesses: HashMap<(usize, usize), Option<f64>>,
    touches: HashMap<(CurveIndex, CurveIndex), Tried>,
    tangencies: HashMap<(Pair, CurveIndex), Option<Tangency>>,
    values: Evaluator<'m>,
    /// The present box.
    cell: Cell,
}

impl<'m> Parting<'m> {
    /// Finds the forms of a tool's depths and curves, for its box. Depths may differ by `steps` of rounding if ways down are
    /// not asked for.
    pub(super) fn new(
        model: &'m Model,
        cell: Cell,
        forms: &mut Forms<'_>,
        (steps, finest): (bool, f64),
    ) -> Parting<'m> {
        let (size, ids) = (reach(&cell), model.depths());
        let depths = ids.iter().map(|depth| forms.of(*depth)).collect();
        let values = || model.curves.iter().map(|curve| curve.value);
        let curves: Vec<_> = values().map(|value| forms.of(value)?.curve()).collect();
        let sums = values().zip(&curves).map(|(value, curve)| match curve {
            Some(_) => None,
            None => RootSum::of(&model.graph, forms, value),
        });
        Parting {
            model,
            size,
            may_step: steps,
            largest_step: finest.min(TANGENT_JUMP) * size,
            listed: !model.is_exact(),
            values: Evaluator::new(&model.graph, ids.iter().copied()),
            ids,
            sums: sums.collect(),
            differences: BTreeMap::new(),
            depths,
            curves,
            nothing: Rooted::zero(),
            joints: BTreeMap::new(),
            agree: BTreeMap::new(),
            apart: BTreeMap::new(),
            by_linear: HashMap::new(),
            linear: Linear::with_depths(model, cell),
            lower: HashMap::new(),
            lower_by_third: HashMap::new(),
            excluded: HashMap::new(),
            no_deeper: HashMap::new(),
            excesses: HashMap::new(),
            lines: HashMap::new(),
            touches: HashMap::new(),
            tangencies: HashMap::new(),
            cell,
        }
    }

    /// Whether a region's depth is the distance to a line, a circle or a point.
    pub(super) fn is_distance(&self, region: usize) -> bool {
        self.depths[region].as_ref().is_some_and(Rooted::is_distance)
    }

    /// Whether a region's depth is a root without more.
    pub(super) fn is_length(&self, region: usize) -> bool {
        self.depths[region].as_ref().is_some_and(Rooted::is_length)
    }

    /// The form of a region's depth.
    pub(super) fn depth(&self, region: usize) -> Option<&Rooted> {
        self.depths[region].as_ref()
    }

    /// Whether a claim's owner is one that the list of regions gives its points, but for borders, and if
    /// that is asked for, whether none other has them too.
    pub(super) fn is_right(
        &mut self,
        claim: &Claim,
        place: (&mut Cover<'_>, Cell),
        alone: bool,
    ) -> bool {
        let (cover, cell) = place;
        self.cell = cell;
        // A line or a point.
        if claim.signs.iter().any(|(_, signs)| *signs == ZERO) {
            return true;
        }
        let model = self.model;
        let mut sign = |curve: CurveIndex| self.sign_on(claim, curve, cover);
        let own = |owner: usize| model.regions[owner].inside.decided_by(&mut sign) == Some(true);
        if !claim.owner.is_none_or(own) {
            return false;
        }
        !alone
            || (0..model.regions.len()).all(|other| {
                let mut open = |curve: CurveIndex| self.sign_on(claim, curve, cover) & !ZERO;
                Some(other) == claim.owner
                    || model.regions[other].inside.decided_by(&mut open) == Some(false)
                    || self.excluded(claim, other)
            })
    }

    /// Whether, by what is linear, no point of a claim is a region's, but for borders.
    fn excluded(&mut self, claim: &Claim, region: usize) -> bool {
        let key = (region, ways(claim));
        if let Some(known) = self.excluded.get(&key) {
            return *known;
        }
        let way = self.signs(&key.1);
        let linear = &self.linear;
        // Borders left out, of one of its choices.
        let empty = |demands: &[&Formula]| {
            let mut demanded = vec![ANY; way.len()];
            demands.iter().for_each(|formula| formula.demand(&mut demanded));
            let mut signs = way.clone();
            for (sign, demanded) in signs.iter_mut().zip(demanded) {
                *sign &= if demanded == ANY { ANY } else { demanded & !ZERO };
            }
            signs.contains(&0) || linear.contradictory(&signs)
        };
        let inside = &self.model.regions[region].inside;
        let none = |choices: &&[Formula]| choices.iter().all(|choice| empty(&[inside, choice]));
        let excluded = empty(&[inside]) || inside.choices().iter().any(none);
        self.excluded.insert(key, excluded);
        excluded
    }

    /// A curve on whose sides two claims to a box are, and how their depths agree where they meet; none
    /// if they do not meet there, by what depths are known `apart`.
    pub(super) fn of(
        &mut self,
        pair: Pair,
        [a, b]: [&Claim; 2],
        (cover, cell): (&mut Cover<'_>, Cell),
        apart: bool,
    ) -> Option<Parted> {
        self.cell = cell;
        let parting = parting(a, b);
        let mut joint = parting.iter().copied().find(|curve| self.agree(pair, *curve).is_some());
        joint = joint.or_else(|| {
            self.joints(pair).into_iter().find(|curve| {
                let [a, b] = [a, b].map(|claim| self.sign_on(claim, *curve, cover));
                a & b & !ZERO == 0
            })
        });
        let Some(curve) = joint else {
            let curve = *parting.first()?;
            if let Some(parted) = self.tangent(pair, &parting) {
                return Some(parted);
            }
            let lower = self.lower(pair, [a, b], &parting, cover).map(|off| self.step(off));
            let parted = |joint| Parted { curve, joint, below: false, off: 0.0 };
            return match (lower, apart) {
                (Some(0.0), true) => None,
                (Some(off), _) => Some(Parted { off, ..parted(Joint::Lower) }),
                (None, _) => Some(parted(Joint::None)),
            };
        };
        let [of_a, of_b] = [a, b].map(|claim| self.sign_on(claim, curve, cover));
        let below = of_a & POSITIVE == 0 || of_b & NEGATIVE == 0;
        let parted = |joint| Parted { curve, joint, below, off: 0.0 };
        // A curve without an agreement is where the two do not differ.
        let agreement = self.agree(pair, curve);
        let smooth = agreement.as_ref().is_some_and(|agreement| agreement.smooth);
        // Where it may be the other branch that agrees, nothing is known of this one.
        let branch = agreement.and_then(|found| Some(found.branch.as_ref()?.over(&cell)));
        let other = branch.is_some_and(|branch| branch.high < 0.0);
        let sure = branch.is_none_or(|branch| branch.low > 0.0);
        match (other || apart, sure) {
            (true, true) => None,
            (true, false) => Some(parted(Joint::None)),
            _ if smooth => Some(parted(Joint::Smooth)),
            _ => Some(parted(Joint::Kinked)),
        }
    }

    /// Returns a straight curve that parts two claims if depth goes on across it but for rounding, and its slope too where
    /// that matters.
    fn tangent(&mut self, pair: Pair, parting: &[CurveIndex]) -> Option<Parted> {
        parting.iter().find_map(|curve| {
            let Off { jump, across } = self.tangency(pair, *curve)?;
            let is_smooth = self.may_step || across <= TANGENT_SLOPE;
            (jump <= self.largest_step && is_smooth).then_some(Parted {
                curve: *curve,
                joint: Joint::Smooth,
                below: false,
                off: jump,
            })
        })
    }

    /// Returns by how much depths differ, without what is rounding of constants with 256 bits.
    fn step(&self, off: f64) -> f64 {
        if off <= self.size * ROUNDING.sqrt() { 0.0 } else { off }
    }

    /// Returns how two regions' depths differ on a straight curve in the present box.
    fn tangency(&mut self, pair: Pair, curve: CurveIndex) -> Option<Off> {
        let (own, Some(other)) = pair else { return None };
        let tangency = self.tangencies.entry((pair, curve)).or_insert_with(|| {
            let [own, other] = [&self.depths[own], &self.depths[other]];
            let (line, _) = self.curves[curve].as_ref()?;
            Tangency::of(own.as_ref()?, other.as_ref()?, line)
        });
        let Off { jump, across } = tangency.as_ref()?.over(&self.cell)?;
        Some(Off { jump: self.step(jump), across })
    }

    /// The curves on which the depths of two owners agree.
    fn joints(&mut self, pair: Pair) -> Vec<CurveIndex> {
        if let Some(known) = self.joints.get(&pair) {
            return known.clone();
        }
        // Neighbours have their border among their own conditions.
        let mut atoms = Vec::new();
        for owner in [Some(pair.0), pair.1].into_iter().flatten() {
            self.model.regions[owner].inside.open(&vec![ANY; self.curves.len()], &mut atoms);
        }
        let asked: BTreeSet<CurveIndex> = atoms.into_iter().map(|(curve, _)| curve).collect();
        let differences = self.differences(pair);
        let mut joints: Vec<CurveIndex> = differences.iter().map(|(curve, _)| *curve).collect();
        joints.extend(asked.into_iter().filter(|curve| self.agree(pair, *curve).is_some()));
        self.joints.insert(pair, joints.clone());
        joints
    }

    /// How two owners' depths agree on a curve, if they do.
    fn agree(&mut self, pair: Pair, curve: CurveIndex) -> Option<Rc<Agreement>> {
        if let Some(known) = self.agree.get(&(pair, curve)) {
            return known.clone();
        }
        let other = pair.1.map_or(Some(&self.nothing), |other| self.depths[other].as_ref());
        let agree = match (&self.depths[pair.0], other, &self.curves[curve]) {
            (Some(own), Some(other), Some((curve, _))) => own.agrees_on(other, curve),
            _ => None,
        };
        let agree = agree.map(Rc::new);
        self.agree.insert((pair, curve), agree.clone());
        agree
    }

    /// The curves that are where two depths do not differ, by what is written or by their sums of roots; with each whether it is
    /// positive where the first is more.
    fn differences(&mut self, (own, other): Pair) -> Rc<Vec<(CurveIndex, bool)>> {
        let Some(other) = other else { return Rc::default() };
        if let Some(known) = self.differences.get(&[own, other]) {
            return known.clone();
        }
        let graph = &self.model.graph;
        let [a, b] = [own, other].map(|depth| self.ids[depth]);
        let forms = self.depths[own].as_ref().zip(self.depths[other].as_ref());
        let is_more = |curve: CurveIndex| match *graph.node(self.model.curves[curve].value) {
            Node::Sub(more, less) if [more, less] == [a, b] => Some(true),
            Node::Sub(more, less) if [more, less] == [b, a] => Some(false),
            _ => {
                let ratio = self.sums[curve].as_ref()?.by_difference(forms?.0, forms?.1)?;
                Some(!ratio.is_negative())
            }
        };
        let curves = 0..self.model.curves.len();
        let found = Rc::new(curves.filter_map(|curve| Some((curve, is_more(curve)?))).collect());
        self.differences.insert([own, other], Rc::clone(&found));
        found
    }
}

fn ways(claim: &Claim) -> Ways {
    claim.signs.iter().copied().filter(|(_, signs)| *signs != ANY).collect()
}

/// The signs at points that can be approached with these.
fn closed(signs: Signs) -> Signs {
    if signs & (NEGATIVE | POSITIVE) != 0 { signs | ZERO } else { signs }
}

/// The curves whose sides the ways to two claims demand against one another.
fn parting(a: &Claim, b: &Claim) -> Vec<CurveIndex> {
    let mut curves = Vec::new();
    for (curve, signs) in &a.signs {
        let against =
            b.signs.iter().any(|(other, others)| other == curve && signs & others & !ZERO == 0);
        if against && !curves.contains(curve) {
            curves.push(*curve);
        }
    }
    curves
}
