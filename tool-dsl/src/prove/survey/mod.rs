//! Box after box: what is felt in each region, and what changes from one to the next.

mod certain;
mod conclude;
mod descent;
mod meet;

use super::aim::{self, Aim};
use super::cover::{Boxes, Claim, Cover, reach};
use super::foot::Feet;
use super::kink::ROUNDING;
use super::parting::{Pair, Parting};
use super::root::Forms;
use super::rounding::Errors;
use super::slope::Slopes;
use super::witness::Witness;
use super::{Border, Certificate, FEW, RegionFacts, SMALL, Seen, TOLERANCE, Undecided};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::formula::CurveIndex;
use crate::number;
use crate::plan::PlannedTool;
use certain::Certain;
use std::collections::BTreeMap;

/// Boxes on a border are divided to this part of the tool's size, in the half plane and in space.
const FINE: f64 = 1.0 / 56.0;
const FINE_OF_SPACE: f64 = 1.0 / 7.0;
/// Tries of a proof: boxes where nothing explains a border are divided to this part of the tool's size, and no more boxes are
/// looked at than these thirds of what it may take. Tools of which no borders touch need few; where curves touch it takes so many
/// more boxes as the root of their size is smaller. How far depths may differ in such boxes adds to the slack.
const TRIES: [(f64, usize); 3] = [(1e-12, 1), (1e-10, 3), (1e-8, 9)];
/// The same of the last try, which comes to an end.
const COARSEST: f64 = 1e-7;
/// Feet may be beyond the ends of pieces by this part of the tool's size, and by so many times the half diagonal of a box
/// that is as good as a point. By how much they are adds to the slack, so these only say when a box is divided.
const BEYOND: f64 = 1e-11;
const FAR: f64 = 4096.0;
/// More claims to a box are not compared two by two.
const CROWD: usize = 48;
/// Boxes times regions that a proof may take: a box takes longer the more regions there are. Up to 200 regions, the
/// budget of boxes alone counts.
const WORK: usize = 7_000_000;
/// Inside a region a box is divided until its slope is known so well.
const SLACK: f64 = 0.02;
/// A border where depth may fall less steeply is looked at in smaller boxes.
const SLOPING: f64 = 0.9;
/// And in still smaller ones, as long as slopes are known no better than that.
const VAGUE: f64 = 0.1;

/// Proves what can be proved in so many boxes, and of regions by hand whether any has points `alone`, if
/// that is asked for.
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

/// Returns the sum of two lengths, no less than it is; nothing is rounded where one is 0.
fn up(a: f64, b: f64) -> f64 {
    Interval::new(a, a).plus(Interval::new(b, b)).high
}

/// Returns a length, or 0 for one that is rounding of constants with 256 bits, less than 2^-95 of the tool's size: the root
/// of what a sum of squares keeps when it cancels.
fn unless_rounding(length: f64, size: f64) -> f64 {
    if length > size * number::ROUNDING.sqrt() { length } else { 0.0 }
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

struct Survey<'t> {
    tool: &'t PlannedTool,
    cover: Cover<'t>,
    slopes: Slopes<'t>,
    witness: Witness<'t>,
    errors: Errors<'t>,
    parting: Parting<'t>,
    size: f64,
    /// Boxes on a border are divided to this part of the tool's size.
    fine: f64,
    /// Boxes that are as good as points.
    finest: f64,
    regions: Vec<Option<RegionFacts>>,
    aims: Vec<Aim>,
    certain: Vec<Certain>,
    borders: BTreeMap<(Pair, CurveIndex), Border>,
    /// A point where two owners are side by side, with a jump between.
    jumping: BTreeMap<(Pair, CurveIndex), Seen>,
    /// The pieces of a profile. With them it is shown that depth is no less than the distance to the surface; without,
    /// by ways along which depth falls.
    feet: Option<Feet<'t>>,
    /// By how much feet are beyond a piece's end at most.
    beyond: f64,
    /// The least slope toward the surface.
    least: f64,
    /// Ways down from boxes that are as good as points.
    descents: Vec<descent::Descent>,
    /// How far points of such boxes are from the outside at most, where nothing else is known of how depth falls.
    near: f64,
    /// The sum, over boxes where several regions meet that no curve joins, of the largest difference of two depths there.
    jumps: f64,
    /// The largest difference of the depths of each pair of regions in such boxes.
    widest: BTreeMap<Pair, f64>,
    /// The largest difference of depths on each border where the profile is all but smooth.
    steps: BTreeMap<(Pair, CurveIndex), f64>,
    undecided: Vec<Undecided>,
    /// Whether it is looked whether regions overlap.
    alone: bool,
    boxes: usize,
}

impl<'t> Survey<'t> {
    fn new(tool: &'t PlannedTool, finest: f64, alone: bool) -> Survey<'t> {
        let model = &tool.model;
        let felt = model.regions.iter().flat_map(|region| {
            let felt = [region.depth, region.magnitude, region.niceness];
            felt.into_iter().chain(region.direction).chain(region.course.0)
        });
        let roots = felt.chain(model.curves.iter().map(|curve| curve.value));
        let whole = tool.extent.cell();
        let mut forms = Forms::new(&model.graph);
        let feet = Feet::of(tool, &mut forms, reach(&whole));
        let parting = Parting::new(model, whole, &mut forms, (feet.is_some(), finest));
        let aim = |(index, region)| Aim::new(aim::straight(model, region, parting.depth(index)));
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

    /// Looks at all boxes; beyond the budget, at the large ones that are left, if it is to come to an end then. Returns
    /// whether it did.
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
                reach if reach <= self.finest => Grain::Point,
                _ if boxes.count > budget => Grain::Last,
                reach if reach <= self.fine => Grain::Fine,
                _ => Grain::Coarse,
            };
            let done = match owners.as_slice() {
                [None] => self.owned(cell, &claims, grain),
                [Some(owner)] => {
                    self.owned(cell, &claims, grain) && self.within(*owner, cell, grain)
                }
                _ if grain == Grain::Coarse => false,
                _ if claims.len() > CROWD && grain == Grain::Fine => false,
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

    /// Whether the owners of a box are those that the list of regions says, as far as that is looked at.
    fn owned(&mut self, cell: Cell, claims: &[Claim], grain: Grain) -> bool {
        if self.feet.is_some() {
            return self.footed(cell, claims, grain);
        }
        // The owner is the nearest if depth is the distance.
        if self.tool.model.is_exact() || grain == Grain::Point {
            return true;
        }
        let wrong = claims
            .iter()
            .find(|claim| !self.parting.is_right(claim, (&mut self.cover, cell), self.alone));
        if let (Some(claim), Grain::Last) = (wrong, grain) {
            let statement = Statement::Alone(self.named(claim.owner));
            self.undecided.push(Undecided { cell, statement });
            return true;
        }
        wrong.is_none()
    }

    /// Returns whether the points of a profile that are nearest to those of a box's claims are on their owners' pieces.
    fn footed(&mut self, cell: Cell, claims: &[Claim], grain: Grain) -> bool {
        let Some(feet) = &mut self.feet else { return true };
        let allowed = match grain {
            Grain::Point => (FAR * reach(&cell)).min(TOLERANCE * self.size),
            _ => BEYOND * self.size,
        };
        for claim in claims {
            let beyond = feet.beyond(claim, &mut self.cover, cell);
            if beyond <= allowed {
                self.beyond = self.beyond.max(unless_rounding(beyond, self.size));
            } else if grain.is_last() {
                let statement = Statement::Nearest(self.named(claim.owner));
                self.undecided.push(Undecided { cell, statement });
                return true;
            } else {
                return false;
            }
        }
        true
    }

    /// Whether enough is known of a box that one region has.
    fn within(&mut self, owner: usize, cell: Cell, grain: Grain) -> bool {
        self.slopes.set(cell);
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        let known = depth.length.high - depth.length.low <= SLACK * depth.length.high;
        let positive = depth.value.low >= -TOLERANCE * self.size;
        let falls = self.feet.is_some() || self.fall(owner, &[Some(owner)]) > 0.0;
        // Where a direction vanishes is told well in the half plane, where that is a point.
        let plane = self.tool.model.domain == Domain::HalfPlane;
        let large = grain == Grain::Coarse || plane && reach(&cell) > SMALL * self.size;
        if !grain.is_last() && large && aim::vanishes(self.course(owner)) {
            return false;
        }
        if !grain.is_last() && !(positive && falls && (known || grain == Grain::Fine)) {
            return false;
        }
        if !positive {
            let statement = Statement::NotNegative(self.named(Some(owner)));
            self.undecided.push(Undecided { cell, statement });
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
        let falls = self.feet.is_some()
            || owners.iter().flatten().all(|owner| self.fall(*owner, owners) > 0.0);
        if !grain.is_last() && !falls {
            return false;
        }
        if claims.len() > CROWD {
            let statement = Statement::Crowd(owners.len());
            self.undecided.push(Undecided { cell, statement });
        } else if !self.meet(cell, claims, grain) {
            return false;
        }
        owners.iter().flatten().for_each(|owner| self.felt(*owner, cell));
        self.descend(owners, cell, grain);
        true
    }

    /// A region or the outside, in words.
    fn named(&self, owner: Option<usize>) -> Option<String> {
        owner.map(|owner| self.tool.model.regions[owner].name.clone())
    }

    /// Notes what is felt in the present box, of a region that has all of it or a part.
    fn felt(&mut self, owner: usize, cell: Cell) {
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
        self.tool.model.regions[owner].course.0.map(|part| self.slopes.get(part).value)
    }
}
