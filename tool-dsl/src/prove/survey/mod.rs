//! The traversal of boxes: bounds of the quantities in each region, and of their changes from one region to
//! the next.

mod certain;
mod conclude;
mod descent;
mod meet;

use super::borders::{BorderProver, Pair};
use super::cover::{Boxes, Claim, Cover, reach};
use super::direction::{self, DirectionFacts};
use super::foot::Feet;
use super::nonsmooth::ROUNDING;
use super::root::Forms;
use super::rounding::Errors;
use super::slope::Slopes;
use super::witness::Witness;
use super::{Border, Certificate, FEW, JumpPoint, OpenProof, RegionFacts, SMALL, TOLERANCE};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::formula::CurveIndex;
use crate::number;
use crate::plan::PlannedTool;
use certain::Certain;
use std::collections::BTreeMap;

/// The size to which boxes on a border are divided, relative to the tool's size, in the half plane and in
/// space.
const FINE: f64 = 1.0 / 56.0;
const FINE_OF_SPACE: f64 = 1.0 / 7.0;
/// The tries of a proof. Each gives the size, relative to the tool's size, to which boxes with an unexplained
/// border are divided, and its part of the budget of boxes, in thirds. Tools whose borders do not touch need
/// few boxes. Where curves touch, the number of boxes grows with the inverse square root of their size. The
/// difference of depths in such boxes is added to the slack.
const TRIES: [(f64, usize); 3] = [(1e-12, 1), (1e-10, 3), (1e-8, 9)];
/// The size for the last try, which always finishes.
const COARSEST: f64 = 1e-7;
/// The largest distance of feet past the ends of segments, relative to the tool's size, and in half diagonals
/// of a point box. The actual distance is added to the slack, so these only decide whether a box is divided.
const BEYOND: f64 = 1e-11;
const FAR: f64 = 4096.0;
/// The largest number of claims to a box that are compared pairwise.
const CROWD: usize = 48;
/// The largest number of boxes times regions in a proof, since a box takes longer the more regions there are.
/// Up to 200 regions, only the budget of boxes counts.
const WORK: usize = 7_000_000;
/// The relative accuracy of the slope up to which a box inside a region is divided.
const SLACK: f64 = 0.02;
/// The slope below which a border is examined in smaller boxes.
const SLOPING: f64 = 0.9;
/// The uncertainty of that slope above which boxes become still smaller.
const VAGUE: f64 = 0.1;

/// Proves as much as possible with a number of boxes. For regions by hand this includes, if `alone` is set,
/// that no two of them overlap.
pub(super) fn survey(tool: &PlannedTool, boxes: usize, alone: bool) -> Certificate {
    let boxes = boxes.min(WORK / tool.model.regions.len().max(1));
    let hasty = [(TRIES[0].0, 3)];
    for (finest, thirds) in if boxes > FEW { &TRIES[..] } else { &hasty } {
        let mut survey = Survey::new(tool, *finest, alone);
        if survey.run(thirds * boxes / 3, false) && survey.undecided.is_empty() {
            return survey.certificate();
        }
    }
    let mut survey = Survey::new(tool, COARSEST, alone);
    survey.run(boxes, true);
    survey.certificate()
}

/// Returns an upper bound of the sum of two lengths. Adding 0 is exact.
fn up(a: f64, b: f64) -> f64 {
    Interval::new(a, a).plus(Interval::new(b, b)).high
}

/// Returns a length, or 0 if it is rounding of 256-bit constants. The limit is 2^-95 of the tool's size, the
/// root of the residue of a cancelling sum of squares.
fn unless_rounding(length: f64, size: f64) -> f64 {
    if length > size * number::ROUNDING.sqrt() { length } else { 0.0 }
}

/// The size class of a box.
#[derive(Clone, Copy, PartialEq)]
enum BoxSize {
    Coarse,
    /// Small enough for a border that is explained.
    Fine,
    /// As small as a point: not divided further.
    Point,
    /// Not small, but the budget is exhausted.
    Last,
}

impl BoxSize {
    fn is_last(self) -> bool {
        matches!(self, BoxSize::Point | BoxSize::Last)
    }
}

struct Survey<'t> {
    tool: &'t PlannedTool,
    cover: Cover<'t>,
    slopes: Slopes<'t>,
    witness: Witness<'t>,
    errors: Errors<'t>,
    parting: BorderProver<'t>,
    size: f64,
    /// The size to which boxes on a border are divided, relative to the tool's size.
    fine: f64,
    /// The size of point boxes, relative to the tool's size.
    finest: f64,
    regions: Vec<Option<RegionFacts>>,
    aims: Vec<DirectionFacts>,
    certain: Vec<Certain>,
    borders: BTreeMap<(Pair, CurveIndex), Border>,
    /// A point where two owners are side by side, with a jump between.
    jumping: BTreeMap<(Pair, CurveIndex), JumpPoint>,
    /// The segments of a profile. They prove that depth is at least the distance to the surface. Without
    /// them, descents of depth prove it.
    feet: Option<Feet<'t>>,
    /// The largest distance of a foot past the end of its segment.
    beyond: f64,
    /// The least slope toward the surface.
    least: f64,
    /// The descents from point boxes.
    descents: Vec<descent::Descent>,
    /// The largest distance from points of such boxes to the outside, where nothing else is known about the
    /// fall of depth.
    near: f64,
    /// The sum, over boxes where several regions meet that no curve joins, of the largest difference of two
    /// depths there.
    jumps: f64,
    /// The largest difference of the depths of each pair of regions in such boxes.
    widest: BTreeMap<Pair, f64>,
    /// The largest difference of depths on each border where the profile is nearly smooth.
    steps: BTreeMap<(Pair, CurveIndex), f64>,
    undecided: Vec<OpenProof>,
    /// True if regions are checked for overlaps.
    alone: bool,
    boxes: usize,
}

impl<'t> Survey<'t> {
    fn new(tool: &'t PlannedTool, finest: f64, alone: bool) -> Survey<'t> {
        let model = &tool.model;
        let evaluation = model.regions.iter().flat_map(|region| {
            let evaluation = [region.depth, region.magnitude, region.niceness];
            evaluation.into_iter().chain(region.direction).chain(region.raw_direction.0)
        });
        let roots = evaluation.chain(model.curves.iter().map(|curve| curve.value));
        let whole = tool.extent.cell();
        let mut forms = Forms::new(&model.graph);
        let feet = Feet::of(tool, &mut forms, reach(&whole));
        let parting = BorderProver::new(model, whole, &mut forms, (feet.is_some(), finest));
        let aim = |(index, region)| {
            DirectionFacts::new(direction::straight(model, region, parting.depth(index)))
        };
        let aims = model.regions.iter().enumerate().map(aim).collect();
        Survey {
            tool,
            cover: Cover::new(model, &tool.plan.owner),
            slopes: Slopes::new(&model.graph, model.domain, roots),
            errors: Errors::new(
                &model.graph,
                model.domain,
                model.regions.iter().map(|region| region.depth),
            ),
            witness: Witness::new(tool, reach(&whole)),
            parting,
            feet,
            beyond: 0.0,
            size: reach(&whole),
            finest,
            fine: match model.domain {
                Domain::HalfPlane => FINE,
                Domain::Space => FINE_OF_SPACE,
            },
            regions: vec![None; model.regions.len()],
            aims,
            certain: vec![Certain::default(); model.regions.len()],
            borders: BTreeMap::new(),
            jumping: BTreeMap::new(),
            least: f64::INFINITY,
            descents: Vec::new(),
            near: 0.0,
            jumps: 0.0,
            widest: BTreeMap::new(),
            steps: BTreeMap::new(),
            undecided: Vec::new(),
            alone,
            boxes: 0,
        }
    }

    /// Examines all boxes. Once the budget is exhausted it stops, or, with `to_the_end`, examines the
    /// remaining boxes without dividing them. Returns whether it finished.
    fn run(&mut self, budget: usize, to_the_end: bool) -> bool {
        let mut boxes = Boxes::new(self.tool.extent.cell());
        while let Some(cell) = boxes.next() {
            if boxes.count > budget && !to_the_end {
                return false;
            }
            let claims = self.cover.claims(cell);
            let mut owners: Vec<Option<usize>> = claims.iter().map(|claim| claim.owner).collect();
            owners.sort_unstable();
            owners.dedup();
            let grain = match reach(&cell) / self.size {
                reach if reach <= self.finest => BoxSize::Point,
                _ if boxes.count > budget => BoxSize::Last,
                reach if reach <= self.fine => BoxSize::Fine,
                _ => BoxSize::Coarse,
            };
            let done = match owners.as_slice() {
                [None] => self.owned(cell, &claims, grain),
                [Some(owner)] => {
                    self.owned(cell, &claims, grain) && self.within(*owner, cell, grain)
                }
                _ if grain == BoxSize::Coarse => false,
                _ if claims.len() > CROWD && grain == BoxSize::Fine => false,
                _ => {
                    self.owned(cell, &claims, grain) && self.between(cell, &claims, &owners, grain)
                }
            };
            if !done {
                boxes.divide(cell);
            }
        }
        self.boxes = boxes.count;
        true
    }

    /// Returns whether the owners of a box are proved to be those of the list of regions, as far as that is
    /// checked.
    fn owned(&mut self, cell: Cell, claims: &[Claim], grain: BoxSize) -> bool {
        if self.feet.is_some() {
            return self.footed(cell, claims, grain);
        }
        // If depth is the distance, the owner is the nearest.
        if self.tool.model.is_exact() || grain == BoxSize::Point {
            return true;
        }
        let wrong = claims
            .iter()
            .find(|claim| !self.parting.is_right(claim, (&mut self.cover, cell), self.alone));
        if let (Some(claim), BoxSize::Last) = (wrong, grain) {
            let statement = Statement::Alone(self.named(claim.owner));
            self.undecided.push(OpenProof { cell, statement });
            return true;
        }
        wrong.is_none()
    }

    /// Returns whether the feet of a box's points on the profile lie on their owners' segments.
    fn footed(&mut self, cell: Cell, claims: &[Claim], grain: BoxSize) -> bool {
        let Some(feet) = &mut self.feet else { return true };
        let allowed = match grain {
            BoxSize::Point => (FAR * reach(&cell)).min(TOLERANCE * self.size),
            _ => BEYOND * self.size,
        };
        for claim in claims {
            let beyond = feet.beyond(claim, &mut self.cover, cell);
            if beyond <= allowed {
                self.beyond = self.beyond.max(unless_rounding(beyond, self.size));
            } else if grain.is_last() {
                let statement = Statement::Nearest(self.named(claim.owner));
                self.undecided.push(OpenProof { cell, statement });
                return true;
            } else {
                return false;
            }
        }
        true
    }

    /// Returns whether enough is known about a box with one owner.
    fn within(&mut self, owner: usize, cell: Cell, grain: BoxSize) -> bool {
        self.slopes.set(cell);
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        let known = depth.length.high - depth.length.low <= SLACK * depth.length.high;
        let positive = depth.value.low >= -TOLERANCE * self.size;
        let falls = self.feet.is_some() || self.fall(owner, &[Some(owner)]) > 0.0;
        // In the half plane a direction vanishes at points, which small boxes locate well.
        let plane = self.tool.model.domain == Domain::HalfPlane;
        let large = grain == BoxSize::Coarse || plane && reach(&cell) > SMALL * self.size;
        if !grain.is_last() && large && direction::vanishes(self.course(owner)) {
            return false;
        }
        if !grain.is_last() && !(positive && falls && (known || grain == BoxSize::Fine)) {
            return false;
        }
        if !positive {
            let statement = Statement::NotNegative(self.named(Some(owner)));
            self.undecided.push(OpenProof { cell, statement });
        }
        self.evaluation(owner, cell);
        self.descend(&[Some(owner)], cell, grain);
        true
    }

    /// Returns whether enough is known about a box with several owners.
    fn between(
        &mut self,
        cell: Cell,
        claims: &[Claim],
        owners: &[Option<usize>],
        grain: BoxSize,
    ) -> bool {
        self.slopes.set(cell);
        let falls = self.feet.is_some()
            || owners.iter().flatten().all(|owner| self.fall(*owner, owners) > 0.0);
        if !grain.is_last() && !falls {
            return false;
        }
        if claims.len() > CROWD {
            let statement = Statement::Crowd(owners.len());
            self.undecided.push(OpenProof { cell, statement });
        } else if !self.meet(cell, claims, grain) {
            return false;
        }
        owners.iter().flatten().for_each(|owner| self.evaluation(*owner, cell));
        self.descend(owners, cell, grain);
        true
    }

    /// Returns the name of a region, or `None` for the outside.
    fn named(&self, owner: Option<usize>) -> Option<String> {
        owner.map(|owner| self.tool.model.regions[owner].name.clone())
    }

    /// Records the range of a region's quantities in the current box, which lies in the region wholly or in
    /// part.
    fn evaluation(&mut self, owner: usize, cell: Cell) {
        let region = &self.tool.model.regions[owner];
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
        let course = self.course(owner);
        let angle = self.aims[owner].note(course, depth, cell, self.tool.model.domain);
        self.look_at_middle(owner, cell, angle.unwrap_or(0.0), !here.falls);
        let facts = &mut self.regions[owner];
        *facts = Some(match facts.take() {
            None => here,
            Some(known) => RegionFacts {
                depth: known.depth.hull(here.depth),
                steepness: known.steepness.hull(here.steepness),
                magnitude: known.magnitude.hull(here.magnitude),
                niceness: known.niceness.hull(here.niceness),
                falls: known.falls && here.falls,
                rounding: known.rounding.max(here.rounding),
                ..known
            },
        });
    }

    fn course(&mut self, owner: usize) -> [Interval; 3] {
        self.tool.model.regions[owner].raw_direction.0.map(|part| self.slopes.get(part).value)
    }
}
