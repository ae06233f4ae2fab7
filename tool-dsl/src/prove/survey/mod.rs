//! The traversal of boxes: bounds of the quantities in each region, and of their changes from one region to
//! the next.

mod certain;
mod conclude;
mod descent;
mod meet;

use super::borders::{BorderProver, Pair};
use super::cover::{Boxes, Claim, Cover, half_diagonal};
use super::direction::{self, DirectionFacts};
use super::foot::ProfileFeet;
use super::nonsmooth::SLOPE_MARGIN;
use super::root::Forms;
use super::rounding::RoundingErrors;
use super::slope::Slopes;
use super::witness::Witness;
use super::{
    Border, Certificate, JumpPoint, MAX_BOXES_IN_COMPILATION, OpenProof, RegionFacts,
    SMALL_BOX_FRACTION, TOLERANCE,
};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::formula::CurveIndex;
use crate::number;
use crate::plan::PlannedTool;
use certain::CertainFacts;
use std::collections::BTreeMap;

/// The size to which boxes on a border are divided, relative to the tool's size, in the half plane and in
/// space.
const BORDER_BOX_FRACTION_IN_HALF_PLANE: f64 = 1.0 / 56.0;
const BORDER_BOX_FRACTION_IN_SPACE: f64 = 1.0 / 7.0;
/// The tries of a proof. Each gives the size, relative to the tool's size, to which boxes with an unexplained
/// border are divided, and its part of the budget of boxes, in thirds. Tools whose borders do not touch need
/// few boxes. Where curves touch, the number of boxes grows with the inverse square root of their size. The
/// difference of depths in such boxes is added to the slack.
const POINT_BOX_FRACTIONS_AND_BUDGET_THIRDS: [(f64, usize); 3] =
    [(1e-12, 1), (1e-10, 3), (1e-8, 9)];
/// The size for the last try, which always finishes.
const LAST_POINT_BOX_FRACTION: f64 = 1e-7;
/// The largest distance of feet past the ends of segments, relative to the tool's size, and in half diagonals
/// of a point box. The actual distance is added to the slack, so these only decide whether a box is divided.
const MAX_OVERSHOOT_FRACTION: f64 = 1e-11;
const MAX_OVERSHOOT_IN_HALF_DIAGONALS: f64 = 4096.0;
/// The largest number of claims to a box that are compared pairwise.
const MAX_CLAIMS: usize = 48;
/// The largest number of boxes times regions in a proof, since a box takes longer the more regions there are.
/// Up to 200 regions, only the budget of boxes counts.
const MAX_BOXES_TIMES_REGIONS: usize = 7_000_000;
/// The relative accuracy of the slope up to which a box inside a region is divided.
const SLOPE_ACCURACY: f64 = 0.02;
/// The slope below which a border is examined in smaller boxes.
const STEEP_SLOPE: f64 = 0.9;
/// The uncertainty of that slope above which boxes become still smaller.
const MAX_SLOPE_UNCERTAINTY: f64 = 0.1;

/// Proves as much as possible with a number of boxes. For regions by hand this includes, if
/// `check_overlaps` is set, that no two of them overlap.
pub(super) fn survey(tool: &PlannedTool, boxes: usize, check_overlaps: bool) -> Certificate {
    let boxes = boxes.min(MAX_BOXES_TIMES_REGIONS / tool.model.regions.len().max(1));
    let single_try = [(POINT_BOX_FRACTIONS_AND_BUDGET_THIRDS[0].0, 3)];
    for (point_box_fraction, thirds) in if boxes > MAX_BOXES_IN_COMPILATION {
        &POINT_BOX_FRACTIONS_AND_BUDGET_THIRDS[..]
    } else {
        &single_try
    } {
        let mut survey = Survey::new(tool, *point_box_fraction, check_overlaps);
        if survey.run(thirds * boxes / 3, false) && survey.undecided.is_empty() {
            return survey.certificate();
        }
    }
    let mut survey = Survey::new(tool, LAST_POINT_BOX_FRACTION, check_overlaps);
    survey.run(boxes, true);
    survey.certificate()
}

/// Returns an upper bound of the sum of two lengths. Adding 0 is exact.
fn sum_rounded_up(a: f64, b: f64) -> f64 {
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
    errors: RoundingErrors<'t>,
    border_prover: BorderProver<'t>,
    size: f64,
    /// The size to which boxes on a border are divided, relative to the tool's size.
    border_box_fraction: f64,
    /// The size of point boxes, relative to the tool's size.
    point_box_fraction: f64,
    regions: Vec<Option<RegionFacts>>,
    directions: Vec<DirectionFacts>,
    certain_facts: Vec<CertainFacts>,
    borders: BTreeMap<(Pair, CurveIndex), Border>,
    /// A point where two owners are side by side, with a jump between.
    jump_points: BTreeMap<(Pair, CurveIndex), JumpPoint>,
    /// The segments of a profile. They prove that depth is at least the distance to the surface. Without
    /// them, descents of depth prove it.
    feet: Option<ProfileFeet>,
    /// The largest distance of a foot past the end of its segment.
    overshoot: f64,
    /// The least slope toward the surface.
    min_slope: f64,
    /// The descents from point boxes.
    descents: Vec<descent::Descent>,
    /// The largest distance from points of such boxes to the outside, where nothing else is known about the
    /// fall of depth.
    surface_distance: f64,
    /// The sum, over boxes where several regions meet that no curve joins, of the largest difference of two
    /// depths there.
    jumps: f64,
    /// The largest difference of the depths of each pair of regions in such boxes.
    largest_jumps: BTreeMap<Pair, f64>,
    /// The largest difference of depths on each border where the profile is nearly smooth.
    smooth_border_jumps: BTreeMap<(Pair, CurveIndex), f64>,
    undecided: Vec<OpenProof>,
    /// True if regions are checked for overlaps.
    check_overlaps: bool,
    boxes: usize,
}

impl<'t> Survey<'t> {
    fn new(tool: &'t PlannedTool, point_box_fraction: f64, check_overlaps: bool) -> Survey<'t> {
        let model = &tool.model;
        let outputs = model.regions.iter().flat_map(|region| {
            let evaluation = [region.depth, region.magnitude, region.niceness];
            evaluation.into_iter().chain(region.direction).chain(region.raw_direction.0)
        });
        let roots = outputs.chain(model.curves.iter().map(|curve| curve.value));
        let whole = tool.extent.cell();
        let mut forms = Forms::new(&model.graph);
        let feet = ProfileFeet::of(tool, &mut forms, half_diagonal(&whole));
        let border_prover =
            BorderProver::new(model, whole, &mut forms, feet.is_some(), point_box_fraction);
        let direction_facts = |(index, region)| {
            DirectionFacts::new(direction::is_parallel(model, region, border_prover.depth(index)))
        };
        let directions = model.regions.iter().enumerate().map(direction_facts).collect();
        Survey {
            tool,
            cover: Cover::new(model, &tool.plan.owner),
            slopes: Slopes::new(&model.graph, model.domain, roots),
            errors: RoundingErrors::new(
                &model.graph,
                model.domain,
                model.regions.iter().map(|region| region.depth),
            ),
            witness: Witness::new(tool, half_diagonal(&whole)),
            border_prover,
            feet,
            overshoot: 0.0,
            size: half_diagonal(&whole),
            point_box_fraction,
            border_box_fraction: match model.domain {
                Domain::HalfPlane => BORDER_BOX_FRACTION_IN_HALF_PLANE,
                Domain::Space => BORDER_BOX_FRACTION_IN_SPACE,
            },
            regions: vec![None; model.regions.len()],
            directions,
            certain_facts: vec![CertainFacts::default(); model.regions.len()],
            borders: BTreeMap::new(),
            jump_points: BTreeMap::new(),
            min_slope: f64::INFINITY,
            descents: Vec::new(),
            surface_distance: 0.0,
            jumps: 0.0,
            largest_jumps: BTreeMap::new(),
            smooth_border_jumps: BTreeMap::new(),
            undecided: Vec::new(),
            check_overlaps,
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
            let box_size = match half_diagonal(&cell) / self.size {
                reach if reach <= self.point_box_fraction => BoxSize::Point,
                _ if boxes.count > budget => BoxSize::Last,
                reach if reach <= self.border_box_fraction => BoxSize::Fine,
                _ => BoxSize::Coarse,
            };
            let done = match owners.as_slice() {
                [None] => self.check_owners(cell, &claims, box_size),
                [Some(owner)] => {
                    self.check_owners(cell, &claims, box_size)
                        && self.examine_interior(*owner, cell, box_size)
                }
                _ if box_size == BoxSize::Coarse => false,
                _ if claims.len() > MAX_CLAIMS && box_size == BoxSize::Fine => false,
                _ => {
                    self.check_owners(cell, &claims, box_size)
                        && self.examine_border(cell, &claims, &owners, box_size)
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
    fn check_owners(&mut self, cell: Cell, claims: &[Claim], box_size: BoxSize) -> bool {
        if self.feet.is_some() {
            return self.check_feet(cell, claims, box_size);
        }
        // If depth is the distance, the owner is the nearest.
        if self.tool.model.is_exact() || box_size == BoxSize::Point {
            return true;
        }
        let wrong = claims.iter().find(|claim| {
            let (prover, cover) = (&mut self.border_prover, &mut self.cover);
            !prover.is_listed_owner(claim, cover, cell, self.check_overlaps)
        });
        if let (Some(claim), BoxSize::Last) = (wrong, box_size) {
            let statement = Statement::SingleOwner(self.region_name(claim.owner));
            self.undecided.push(OpenProof { cell, statement });
            return true;
        }
        wrong.is_none()
    }

    /// Returns whether the feet of a box's points on the profile lie on their owners' segments.
    fn check_feet(&mut self, cell: Cell, claims: &[Claim], box_size: BoxSize) -> bool {
        let Some(feet) = &mut self.feet else { return true };
        let allowed = match box_size {
            BoxSize::Point => {
                (MAX_OVERSHOOT_IN_HALF_DIAGONALS * half_diagonal(&cell)).min(TOLERANCE * self.size)
            }
            _ => MAX_OVERSHOOT_FRACTION * self.size,
        };
        for claim in claims {
            let overshoot = feet.overshoot(claim, &mut self.cover, cell);
            if overshoot <= allowed {
                self.overshoot = self.overshoot.max(unless_rounding(overshoot, self.size));
            } else if box_size.is_last() {
                let statement = Statement::NearestFeatures(self.region_name(claim.owner));
                self.undecided.push(OpenProof { cell, statement });
                return true;
            } else {
                return false;
            }
        }
        true
    }

    /// Returns whether enough is known about a box with one owner.
    fn examine_interior(&mut self, owner: usize, cell: Cell, box_size: BoxSize) -> bool {
        self.slopes.set(cell);
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        let known = depth.length.high - depth.length.low <= SLOPE_ACCURACY * depth.length.high;
        let is_positive = depth.value.low >= -TOLERANCE * self.size;
        let falls = self.feet.is_some() || self.fall_rate(owner, &[Some(owner)], cell) > 0.0;
        // In the half plane a direction vanishes at points, which small boxes locate well.
        let is_plane = self.tool.model.domain == Domain::HalfPlane;
        let is_large = box_size == BoxSize::Coarse
            || is_plane && half_diagonal(&cell) > SMALL_BOX_FRACTION * self.size;
        if !box_size.is_last() && is_large && direction::vanishes(self.raw_direction(owner)) {
            return false;
        }
        if !box_size.is_last() && !(is_positive && falls && (known || box_size == BoxSize::Fine)) {
            return false;
        }
        if !is_positive {
            let statement = Statement::NonNegativeDepth(self.region_name(Some(owner)));
            self.undecided.push(OpenProof { cell, statement });
        }
        self.record_evaluation(owner, cell);
        self.record_descent(&[Some(owner)], cell, box_size);
        true
    }

    /// Returns whether enough is known about a box with several owners.
    fn examine_border(
        &mut self,
        cell: Cell,
        claims: &[Claim],
        owners: &[Option<usize>],
        box_size: BoxSize,
    ) -> bool {
        self.slopes.set(cell);
        let falls = self.feet.is_some()
            || owners.iter().flatten().all(|owner| self.fall_rate(*owner, owners, cell) > 0.0);
        if !box_size.is_last() && !falls {
            return false;
        }
        if claims.len() > MAX_CLAIMS {
            let statement = Statement::MeetingRegions(owners.len());
            self.undecided.push(OpenProof { cell, statement });
        } else if !self.examine_borders(cell, claims, box_size) {
            return false;
        }
        owners.iter().flatten().for_each(|owner| self.record_evaluation(*owner, cell));
        self.record_descent(owners, cell, box_size);
        true
    }

    /// Returns the name of a region, or `None` for the outside.
    fn region_name(&self, owner: Option<usize>) -> Option<String> {
        owner.map(|owner| self.tool.model.regions[owner].name.clone())
    }

    /// Records the range of a region's quantities in the current box, which lies in the region wholly or in
    /// part.
    fn record_evaluation(&mut self, owner: usize, cell: Cell) {
        let region = &self.tool.model.regions[owner];
        let depth = self.slopes.get(region.depth);
        let niceness = self.slopes.get(region.niceness);
        let dot_product =
            (0..3).fold(NOTHING, |sum, k| sum.plus(depth.partials[k].times(niceness.partials[k])));
        // A point of the region is not outside.
        let clamp_at_zero = |value: Interval| Interval { low: value.low.max(0.0), ..value };
        let facts_here = RegionFacts {
            depth: clamp_at_zero(depth.value),
            gradient_length: depth.length,
            magnitude: self.slopes.get(region.magnitude).value,
            niceness: niceness.value,
            niceness_never_rises: dot_product.high
                <= SLOPE_MARGIN * depth.length.high * niceness.length.high,
            rounding_error: self.errors.over(region.depth, &cell),
            ..RegionFacts::NONE
        };
        let raw_direction = self.raw_direction(owner);
        let angle =
            self.directions[owner].record(raw_direction, depth, cell, self.tool.model.domain);
        self.examine_centre(owner, cell, angle.unwrap_or(0.0), !facts_here.niceness_never_rises);
        let facts = &mut self.regions[owner];
        *facts = Some(match facts.take() {
            None => facts_here,
            Some(known) => RegionFacts {
                depth: known.depth.hull(facts_here.depth),
                gradient_length: known.gradient_length.hull(facts_here.gradient_length),
                magnitude: known.magnitude.hull(facts_here.magnitude),
                niceness: known.niceness.hull(facts_here.niceness),
                niceness_never_rises: known.niceness_never_rises && facts_here.niceness_never_rises,
                rounding_error: known.rounding_error.max(facts_here.rounding_error),
                ..known
            },
        });
    }

    fn raw_direction(&mut self, owner: usize) -> [Interval; 3] {
        self.tool.model.regions[owner].raw_direction.0.map(|part| self.slopes.get(part).value)
    }
}
