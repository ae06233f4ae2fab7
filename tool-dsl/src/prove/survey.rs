//! Box after box: what is felt in each region, and what changes from one to the next.

use super::cover::{Boxes, Claim, Cover, reach};
use super::parting::{Joint, Pair, Parted, Parting};
use super::rounding::Errors;
use super::slope::{Slope, Slopes};
use super::{Border, Certificate, RegionFacts, TOLERANCE, Undecided};
use crate::Checked;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::expr::value::{At, Evaluator};
use crate::formula::CurveIndex;
use crate::plan::spread;
use std::collections::{BTreeMap, BTreeSet};

/// Boxes on a border are divided to this part of the tool's size, in the half plane and in space.
const FINE: f64 = 1.0 / 56.0;
const FINE_OF_SPACE: f64 = 1.0 / 14.0;
/// Where depths differ, it is looked whether their owners are neighbours in boxes of this part.
const SMALL: f64 = 1.0 / 1024.0;
/// Boxes where nothing explains a border are divided to this part of the tool's size.
const FINEST: f64 = TOLERANCE / 10.0;
/// More claims to a box are not compared two by two.
const CROWD: usize = 48;
/// Points at which shares are counted.
const SPREAD: usize = 10_000;
/// Inside a region a box is divided until its slope is known so well.
const SLACK: f64 = 0.02;
/// A border where depth may fall less steeply is looked at in smaller boxes.
const SLOPING: f64 = 0.9;
/// And in still smaller ones, as long as slopes are known no better than that.
const VAGUE: f64 = 0.1;
/// How far it is looked about points, as parts of the tool's size.
const STEPS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// What of a slope is rounding.
const ROUNDING: f64 = 1e-9;

/// Proves what can be proved in so many boxes.
pub(super) fn survey(tool: &Checked, boxes: usize) -> Certificate {
    let mut survey = Survey::new(tool);
    survey.run(boxes);
    survey.certificate()
}

/// How small a box is.
#[derive(Clone, Copy, PartialEq)]
enum Grain {
    Coarse,
    /// Small enough for a border that is explained.
    Fine,
    /// As good as a point.
    Point,
    /// Not small, but no more are divided.
    Last,
}

impl Grain {
    fn is_last(self) -> bool {
        matches!(self, Grain::Point | Grain::Last)
    }
}

/// Two claims to a box that a curve parts.
struct Met {
    pair: Pair,
    by: Parted,
    /// Whether points of both were seen side by side.
    seen: bool,
}

struct Survey<'t> {
    tool: &'t Checked,
    cover: Cover<'t>,
    slopes: Slopes<'t>,
    values: Evaluator<'t>,
    errors: Errors<'t>,
    parting: Parting<'t>,
    size: f64,
    /// Boxes on a border are divided to this part of the tool's size.
    fine: f64,
    regions: Vec<Option<RegionFacts>>,
    borders: BTreeMap<(Pair, CurveIndex), Border>,
    /// Where two owners were seen side by side, with a jump between.
    jumping: BTreeSet<(Pair, CurveIndex)>,
    /// The least slope toward the surface.
    least: f64,
    /// The same from boxes that are as good as points.
    least_from_points: f64,
    undecided: Vec<Undecided>,
    boxes: usize,
}

impl<'t> Survey<'t> {
    fn new(tool: &'t Checked) -> Survey<'t> {
        let model = &tool.model;
        let felt = model.regions.iter().flat_map(|region| {
            [region.depth, region.magnitude, region.niceness].into_iter().chain(region.direction)
        });
        let roots = felt.chain(model.curves.iter().map(|curve| curve.value));
        let depths = model.regions.iter().map(|region| region.depth);
        let asked = depths.chain(model.curves.iter().map(|curve| curve.value));
        let whole = tool.extent.cell();
        Survey {
            tool,
            cover: Cover::new(model, &tool.plan.owner),
            slopes: Slopes::new(&model.graph, model.domain, roots),
            errors: Errors::new(
                &model.graph,
                model.domain,
                model.regions.iter().map(|region| region.depth),
            ),
            values: Evaluator::new(&model.graph, asked),
            parting: Parting::new(model, reach(&whole), whole),
            size: reach(&whole),
            fine: match model.domain {
                Domain::HalfPlane => FINE,
                Domain::Space => FINE_OF_SPACE,
            },
            regions: vec![None; model.regions.len()],
            borders: BTreeMap::new(),
            jumping: BTreeSet::new(),
            least: f64::INFINITY,
            least_from_points: f64::INFINITY,
            undecided: Vec::new(),
            boxes: 0,
        }
    }

    fn run(&mut self, budget: usize) {
        let mut boxes = Boxes::new(self.tool.extent.cell());
        while let Some(cell) = boxes.next() {
            let claims = self.cover.claims(cell);
            let mut owners: Vec<Option<usize>> = claims.iter().map(|claim| claim.owner).collect();
            owners.sort_unstable();
            owners.dedup();
            let grain = match reach(&cell) / self.size {
                reach if reach <= FINEST => Grain::Point,
                _ if boxes.count > budget => Grain::Last,
                reach if reach <= self.fine => Grain::Fine,
                _ => Grain::Coarse,
            };
            let done = match owners.as_slice() {
                [None] => true,
                [Some(owner)] => self.within(*owner, cell, grain),
                _ if grain == Grain::Coarse => false,
                _ if claims.len() > CROWD && grain == Grain::Fine => false,
                _ => self.between(cell, &claims, &owners, grain),
            };
            if !done {
                boxes.divide(cell);
            }
        }
        self.boxes = boxes.count;
    }

    /// Whether enough is known of a box that one region has.
    fn within(&mut self, owner: usize, cell: Cell, grain: Grain) -> bool {
        self.slopes.set(cell);
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        let known = depth.length.high - depth.length.low <= SLACK * depth.length.high;
        let positive = depth.value.low >= -TOLERANCE * self.size;
        let falls = self.fall(owner) > 0.0;
        if !grain.is_last() && !(positive && falls && (known || grain == Grain::Fine)) {
            return false;
        }
        if !positive {
            let name = &self.tool.model.regions[owner].name;
            let what = format!("that depth is not negative in `{name}`");
            self.undecided.push(Undecided { cell, what });
        }
        self.felt(owner, cell);
        self.descend(&[Some(owner)], cell, grain);
        true
    }

    /// Whether enough is known of a box that several have.
    fn between(
        &mut self,
        cell: Cell,
        claims: &[Claim],
        owners: &[Option<usize>],
        grain: Grain,
    ) -> bool {
        self.slopes.set(cell);
        let falls = owners.iter().flatten().all(|owner| self.fall(*owner) > 0.0);
        if !grain.is_last() && !falls {
            return false;
        }
        if claims.len() > CROWD {
            let what = format!("which of {} regions meet", owners.len());
            self.undecided.push(Undecided { cell, what });
        } else if !self.meet(cell, claims, grain) {
            return false;
        }
        owners.iter().flatten().for_each(|owner| self.felt(*owner, cell));
        self.descend(owners, cell, grain);
        true
    }

    /// How steeply a region's depth falls at least in the present box.
    fn fall(&mut self, owner: usize) -> f64 {
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        // The kink of a length is where it is 0: at the surface.
        if self.parting.is_length(owner) { depth.length.low } else { depth.fall() }
    }

    /// Notes how steeply depth falls from any point of a box.
    fn descend(&mut self, owners: &[Option<usize>], cell: Cell, grain: Grain) {
        if grain == Grain::Point {
            let least = self.fall_from(owners, cell);
            self.least_from_points = self.least_from_points.min(least);
        } else {
            for owner in owners.iter().flatten() {
                self.least = self.least.min(self.fall(*owner));
            }
        }
    }

    /// How much less deep it is some way from a box that is as good as a point, by that way.
    fn fall_from(&mut self, owners: &[Option<usize>], cell: Cell) -> f64 {
        let middle = cell.sides.map(|side| side.low / 2.0 + side.high / 2.0);
        let deep = self.depth(middle);
        if deep <= TOLERANCE * self.size {
            return f64::INFINITY;
        }
        self.slopes.set(Cell { sides: middle.map(|at| Interval::new(at, at)) });
        let mut steepest = 0.0f64;
        for owner in owners.iter().flatten() {
            let slope = self.slopes.get(self.tool.model.regions[*owner].depth);
            let up = slope.parts.map(|part| part.low / 2.0 + part.high / 2.0);
            let long = up.iter().map(|part| part * part).sum::<f64>().sqrt();
            for part in STEPS {
                let way = (part * self.size).min(deep);
                let to = [0, 1, 2].map(|k| middle[k] - way * up[k] / long);
                if to.iter().all(|part| part.is_finite()) {
                    steepest = steepest.max((deep - self.depth(to)) / way);
                }
            }
        }
        steepest
    }

    /// The depth at a point, 0 outside.
    fn depth(&mut self, point: [f64; 3]) -> f64 {
        let owner = self.owner(point);
        owner.map_or(0.0, |owner| self.values.get(self.tool.model.regions[owner].depth))
    }

    /// Notes what is felt in a box, of a region that has all of it or a part.
    fn felt(&mut self, owner: usize, cell: Cell) {
        let region = &self.tool.model.regions[owner];
        self.slopes.set(cell);
        let depth = self.slopes.get(region.depth);
        let niceness = self.slopes.get(region.niceness);
        let along =
            (0..3).fold(NOTHING, |sum, k| sum.plus(depth.parts[k].times(niceness.parts[k])));
        // A point of the region is not outside.
        let positive = |value: Interval| Interval { low: value.low.max(0.0), ..value };
        let here = RegionFacts {
            depth: positive(depth.value),
            steepness: depth.length,
            magnitude: self.slopes.get(region.magnitude).value,
            niceness: niceness.value,
            falls: along.high <= ROUNDING * depth.length.high * niceness.length.high,
            rounding: self.errors.over(region.depth, &cell),
            ..RegionFacts::NONE
        };
        self.at_axis(depth, cell);
        let facts = &mut self.regions[owner];
        *facts = Some(match facts.take() {
            None => here,
            Some(known) => RegionFacts {
                depth: known.depth.hull(here.depth),
                steepness: known.steepness.hull(here.steepness),
                magnitude: known.magnitude.hull(here.magnitude),
                niceness: known.niceness.hull(here.niceness),
                falls: known.falls && here.falls,
                rounding: [0, 1].map(|k| known.rounding[k].max(here.rounding[k])),
                ..known
            },
        });
    }

    /// A depth that grows away from the axis has a kink there, at which only its slope along the
    /// axis leads down.
    fn at_axis(&mut self, depth: Slope, cell: Cell) {
        let tool = self.tool.model.domain == Domain::HalfPlane;
        if tool && cell.sides[0].low <= 0.0 && depth.parts[0].high > ROUNDING {
            self.least = self.least.min(depth.parts[2].abs().low);
        }
    }

    /// How much of the solid each region has, of evenly spread points.
    fn shares(&mut self) -> Vec<f64> {
        let mut counts = vec![0.0; self.regions.len()];
        for point in spread(self.tool.model.domain, &self.tool.extent, SPREAD, 0.0) {
            if let Some(owner) = self.owner(point) {
                counts[owner] += 1.0;
            }
        }
        let all: f64 = counts.iter().sum();
        counts.iter().map(|count| count / all.max(1.0)).collect()
    }

    /// Whether what happens between the owners of a box is known well enough.
    fn meet(&mut self, cell: Cell, claims: &[Claim], grain: Grain) -> bool {
        self.slopes.set(cell);
        let mut all = Vec::new();
        for (k, a) in claims.iter().enumerate() {
            for b in &claims[k + 1..] {
                // The region first, of two the one listed earlier.
                let (a, b) = match (a.owner, b.owner) {
                    (x, y) if x == y => continue,
                    (None, _) => (b, a),
                    (Some(x), Some(y)) if y < x => (b, a),
                    _ => (a, b),
                };
                let Some(own) = a.owner else { continue };
                let pair = (own, b.owner);
                let apart = self.jump(pair).low > 0.0;
                let place = (&mut self.cover, cell);
                if let Some(by) = self.parting.of(pair, [a, b], place, apart) {
                    all.push(Met { pair, by, seen: false });
                }
            }
        }
        let small = reach(&cell) <= SMALL * self.size;
        let (mut least, mut vague) = (f64::INFINITY, false);
        for met in &mut all {
            let apart = met.by.joint == Joint::None && self.jump(met.pair).low > 0.0;
            let place = (met.pair, met.by.curve);
            met.seen = apart
                && (small || grain.is_last())
                && (self.jumping.contains(&place) || self.beside(met.pair, cell));
            if met.seen {
                self.jumping.insert(place);
            }
            if met.by.joint == Joint::None && !met.seen && !grain.is_last() {
                return false;
            }
            // At points others come between.
            if grain != Grain::Point {
                let (fall, slack) = self.across(met);
                vague |= fall < SLOPING && slack > VAGUE;
                least = least.min(fall);
            }
        }
        // So flat may be only what a large box tells.
        if (vague || least < SLOPING && !small) && !grain.is_last() {
            return false;
        }
        self.least = self.least.min(least);
        all.iter().for_each(|met| self.note(met, cell));
        true
    }

    /// How steeply depth falls toward one of the sides of a border at least, and how well that is known.
    fn across(&mut self, met: &Met) -> (f64, f64) {
        let regions = &self.tool.model.regions;
        let (Joint::Kinked, (own, Some(other))) = (met.by.joint, met.pair) else {
            return (f64::INFINITY, 0.0);
        };
        let [own, other] = [own, other].map(|owner| self.slopes.get(regions[owner].depth));
        let curve = self.slopes.get(self.tool.model.curves[met.by.curve].value);
        across(own, other, curve, met.by.below)
    }

    /// Whether two owners have points side by side in a box, of a few.
    fn beside(&mut self, (own, other): Pair, cell: Cell) -> bool {
        let steps = 6;
        let at = |axis: usize, k: u32| {
            let side = cell.sides[axis];
            side.low + (side.high - side.low) * f64::from(k) / f64::from(steps)
        };
        let axes: &[usize] = match self.tool.model.domain {
            Domain::HalfPlane => &[0, 2],
            Domain::Space => &[0, 1, 2],
        };
        // Along diagonals and across, from each of a row of points to the next.
        let mut before = None;
        for first in 0..=steps {
            for second in 0..=steps {
                let mut p = cell.sides.map(|side| side.low / 2.0 + side.high / 2.0);
                for (k, axis) in axes.iter().enumerate() {
                    p[*axis] = at(*axis, if k == 0 { first } else { second });
                }
                let here = self.owner(p);
                if let Some((last, owner)) = before
                    && [[owner, here], [here, owner]].contains(&[Some(own), other])
                    && self.jumps([last, p], [owner, here])
                {
                    return true;
                }
                before = (second < steps).then_some((p, here));
            }
        }
        false
    }

    /// Whether two points of different owners have their border between them, and depth jumps there.
    fn jumps(&mut self, [mut a, mut b]: [[f64; 3]; 2], owners: [Option<usize>; 2]) -> bool {
        for _ in 0..60 {
            let middle = [0, 1, 2].map(|k| a[k] / 2.0 + b[k] / 2.0);
            match self.owner(middle) {
                owner if owner == owners[0] => a = middle,
                owner if owner == owners[1] => b = middle,
                _ => return false,
            }
        }
        let regions = &self.tool.model.regions;
        self.owner(a);
        let [first, second] =
            owners.map(|owner| owner.map_or(0.0, |owner| self.values.get(regions[owner].depth)));
        (first - second).abs() > TOLERANCE * self.size
    }

    fn owner(&mut self, [x, y, z]: [f64; 3]) -> Option<usize> {
        self.values.set(At::point(x, y, z));
        let curves = &self.tool.model.curves;
        *self.tool.plan.owner.at(&|curve: CurveIndex| self.values.get(curves[curve].value))
    }

    /// How far apart two depths are in the present box.
    fn jump(&mut self, (own, other): Pair) -> Interval {
        let regions = &self.tool.model.regions;
        let own = self.slopes.get(regions[own].depth).value;
        let other = other.map_or(NOTHING, |other| self.slopes.get(regions[other].depth).value);
        own.plus(other.negated()).abs()
    }

    fn note(&mut self, met: &Met, cell: Cell) {
        let regions = &self.tool.model.regions;
        let (own, other) = met.pair;
        let jump = if met.by.joint != Joint::None { NOTHING } else { self.jump(met.pair) };
        let depth = self.slopes.get(regions[own].depth);
        let turn = match other {
            None => NOTHING,
            Some(other) => {
                let [a, b] = [own, other]
                    .map(|owner| regions[owner].direction.map(|id| self.slopes.get(id).value));
                angle(a, b)
            }
        };
        // Where no more is divided, a jump that may be none is one of a corner.
        if met.by.joint == Joint::None && !met.seen && jump.high > TOLERANCE * self.size {
            let to = other.map_or_else(
                || "the outside".to_owned(),
                |other| format!("`{}`", regions[other].name),
            );
            let what = format!("that depth goes on from `{}` to {to}", regions[own].name);
            self.undecided.push(Undecided { cell, what });
        }
        let here = Border {
            between: met.pair,
            curve: met.by.curve,
            jump,
            turn,
            turn_on_surface: (depth.value.low <= 0.0).then_some(turn),
            depth: Interval { low: depth.value.low.max(0.0), ..depth.value },
        };
        self.borders
            .entry((met.pair, met.by.curve))
            .and_modify(|known| {
                known.jump = known.jump.hull(here.jump);
                known.turn = known.turn.hull(here.turn);
                known.turn_on_surface = match (known.turn_on_surface, here.turn_on_surface) {
                    (Some(a), Some(b)) => Some(a.hull(b)),
                    (one, other) => one.or(other),
                };
                known.depth = known.depth.hull(here.depth);
            })
            .or_insert(here);
    }

    fn certificate(mut self) -> Certificate {
        let shares = self.shares();
        let facts = self.regions.into_iter().zip(shares).enumerate();
        let regions: Vec<RegionFacts> = facts
            .map(|(index, (facts, share))| RegionFacts {
                share,
                distance: self.parting.is_distance(index),
                ..facts.unwrap_or(RegionFacts::NONE)
            })
            .collect();
        // From points it is as steep as it was seen to be, but for rounding.
        let from_points = self.least_from_points * (1.0 + ROUNDING);
        Certificate {
            least: if from_points < self.least { from_points } else { self.least },
            regions,
            borders: self.borders.into_values().collect(),
            undecided: self.undecided,
            tolerance: TOLERANCE * self.size,
            boxes: self.boxes,
        }
    }
}

/// The angle between two unit vectors, in radians.
fn angle(a: [Interval; 3], b: [Interval; 3]) -> Interval {
    let product = (0..3).fold(NOTHING, |sum, k| sum.plus(a[k].times(b[k])));
    let [low, high] = [product.high, product.low].map(|cos| cos.clamp(-1.0, 1.0).acos());
    // acos is known to a few units of the last place.
    Interval { low: (low - 1e-15).max(0.0), high: high + 1e-15 }
}

/// How steeply depth falls at least toward one of the sides of a border on which two depths agree, and
/// how well that is known.
///
/// Where each is the smaller on its own side, both ways lead down. Else depth falls along every
/// combination of the two slopes, and so by the shortest of them at least (Clarke 1983).
fn across(own: Slope, other: Slope, curve: Slope, below: bool) -> (f64, f64) {
    let middle = |part: Interval| part.low / 2.0 + part.high / 2.0;
    let rises =
        [0, 1, 2].map(|k| own.parts[k].plus(other.parts[k].negated()).times(curve.parts[k]));
    let rise = rises.into_iter().fold(NOTHING, Interval::plus);
    let combined = [0, 1, 2].map(|k| [middle(own.parts[k]), middle(other.parts[k])]);
    let widths = own.parts.iter().chain(&other.parts).map(|part| part.high - part.low);
    let slack = widths.fold(0.0, f64::max);
    let falls = if below { rise.low } else { -rise.high };
    if falls >= -ROUNDING * curve.length.high {
        return (f64::INFINITY, 0.0);
    }
    let way = combined.map(|[a, b]| b - a);
    let [start, long] =
        [combined.map(|[a, _]| a), way].map(|v| v.iter().zip(way).map(|(a, b)| a * b).sum::<f64>());
    let part = if long > 0.0 { (-start / long).clamp(0.0, 1.0) } else { 0.0 };
    let nearest = combined.map(|[a, b]| a + part * (b - a));
    // Each end is known to half its width.
    (nearest.iter().map(|part| part * part).sum::<f64>().sqrt() - slack, slack)
}
