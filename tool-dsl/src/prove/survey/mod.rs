//! The traversal of boxes: bounds of the quantities in each region, and of their changes from one region to
//! the next; and the certificate that follows from all boxes.

use super::borders::BorderProver;
use super::cover::{Boxes, Claim, Cover, half_diagonal};
use super::depths::Depths;
use super::direction::{self, DirectionFacts, angle_to_descent};
use super::existence::box_without_root;
use super::range::Ranges;
use super::root::Forms;
use super::rounding::RoundingErrors;
use super::slope::{SLOPE_MARGIN, Slopes};
use super::witness::Witness;
use super::{
    Border, CertainValue, Certificate, JumpPoint, MAX_BOXES, OpenProof, Pair, RegionFacts,
    SMALL_BOX_FRACTION, TOLERANCE,
};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, dot};
use crate::formula::CurveIndex;
use crate::number;
use crate::plan::PlannedTool;
use std::collections::{BTreeMap, BTreeSet};

mod descent;
mod meet;
mod profile;

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

/// Proves as much as possible about regions by hand. This includes, if `check_overlaps` is set, that no two of them overlap. The
/// tool's graph receives the parts of depths.
pub(super) fn by_hand(tool: &mut PlannedTool, check_overlaps: bool) -> Certificate {
    let without_root = box_without_root(tool);
    let mut certificate = by_boxes(tool, check_overlaps);
    // First, because all else rests on it.
    let open = without_root.map(|cell| OpenProof { cell, statement: Statement::RealRoots });
    certificate.undecided.splice(0..0, open);
    certificate
}

/// Proves as much as possible about regions by hand whose conditions have a sign everywhere.
fn by_boxes(tool: &mut PlannedTool, check_overlaps: bool) -> Certificate {
    let depths = Depths::of(&mut tool.model);
    let boxes = budget(tool);
    for (point_box_fraction, thirds) in POINT_BOX_FRACTIONS_AND_BUDGET_THIRDS {
        let mut survey = Survey::by_hand(tool, &depths, point_box_fraction, check_overlaps);
        // With an open proof, larger point boxes may still finish it, at the price of more slack.
        if survey.run(thirds * boxes / 3, false) && survey.undecided.is_empty() {
            return survey.certificate();
        }
    }
    let mut survey = Survey::by_hand(tool, &depths, LAST_POINT_BOX_FRACTION, check_overlaps);
    survey.run(boxes, true);
    survey.certificate()
}

/// Describes a profile, whose depth is proved to differ from the distance by no more than `deviation`; if it is not proved,
/// jumps of depth are looked for. Ranges of niceness are close if `is_complete` is set.
pub(super) fn of_profile(
    tool: &PlannedTool,
    deviation: Option<f64>,
    is_complete: bool,
) -> Certificate {
    let mut survey =
        Survey::new(tool, None, POINT_BOX_FRACTIONS_AND_BUDGET_THIRDS[0].0, is_complete);
    survey.deviation = deviation;
    if deviation.is_none() {
        let (cell, statement) = (tool.extent.cell(), Statement::DistanceFromProfile);
        survey.undecided.push(OpenProof { cell, statement });
    }
    survey.run(budget(tool), true);
    survey.certificate()
}

/// Returns the number of boxes for a try.
fn budget(tool: &PlannedTool) -> usize {
    MAX_BOXES.min(MAX_BOXES_TIMES_REGIONS / tool.model.regions.len().max(1))
}

/// Returns an upper bound of the sum of two lengths. Adding 0 is exact.
fn sum_rounded_up(a: f64, b: f64) -> f64 {
    Interval::new(a, a).plus(Interval::new(b, b)).high
}

/// Returns a length, or 0 if it is rounding of 256-bit constants. The limit is 2^-95 of the tool's size, the
/// root of the residue of a cancelling sum of squares.
pub(super) fn unless_rounding(length: f64, size: f64) -> f64 {
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
    /// The proof of the borders of regions by hand; `None` for a profile.
    border_prover: Option<BorderProver<'t>>,
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
    /// The greatest difference of a profile's depth from the distance, if it is proved.
    deviation: Option<f64>,
    /// The owners that meet in a box where no others do.
    neighbours: BTreeSet<Pair>,
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
    /// The largest difference of depths on each border where the profile is nearly smooth.
    smooth_border_jumps: BTreeMap<(Pair, CurveIndex), f64>,
    undecided: Vec<OpenProof>,
    /// True if regions are checked for overlaps.
    check_overlaps: bool,
    boxes: usize,
}

impl<'t> Survey<'t> {
    fn by_hand(
        tool: &'t PlannedTool,
        depths: &Depths,
        point_box_fraction: f64,
        check_overlaps: bool,
    ) -> Survey<'t> {
        let prover =
            BorderProver::new(&tool.model, depths.clone(), tool.extent.cell(), point_box_fraction);
        Survey::new(tool, Some(prover), point_box_fraction, check_overlaps)
    }

    fn new(
        tool: &'t PlannedTool,
        border_prover: Option<BorderProver<'t>>,
        point_box_fraction: f64,
        check_overlaps: bool,
    ) -> Survey<'t> {
        let model = &tool.model;
        let size = half_diagonal(&tool.extent.cell());
        let mut forms = Forms::new(&model.graph);
        let directions = model.regions.iter().map(|region| {
            let depth = forms.of(region.depth);
            DirectionFacts::new(direction::is_parallel(model, region, depth.as_ref()))
        });
        let directions = directions.collect();
        Survey {
            tool,
            cover: Cover::new(model, &tool.tree),
            slopes: Slopes::new(&model.graph, model.domain, model.roots()),
            errors: RoundingErrors::new(
                &model.graph,
                model.domain,
                model.regions.iter().map(|region| region.depth),
            ),
            witness: Witness::new(tool, size),
            border_prover,
            deviation: None,
            neighbours: BTreeSet::new(),
            size,
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
                // Statements that are not proved in such a box stay open.
                _ if boxes.count > budget => BoxSize::Last,
                reach if reach <= self.border_box_fraction => BoxSize::Fine,
                _ => BoxSize::Coarse,
            };
            let done = match owners.as_slice() {
                // Outside there is no depth, but no region of the list may contain the box either.
                [None] => self.check_owners(cell, &claims, box_size),
                [Some(owner)] => {
                    self.check_owners(cell, &claims, box_size)
                        && self.examine_interior(*owner, cell, box_size)
                }
                // A border in a large box encloses too wide ranges of depths and turns.
                _ if box_size == BoxSize::Coarse => false,
                // Division leaves fewer claims; their pairs would be too many here.
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
        // In a point box, borders that touch cannot be told apart; its depths are compared instead.
        let prover = self.border_prover.as_mut().filter(|_| box_size != BoxSize::Point);
        let Some(prover) = prover else { return true };
        let wrong = claims.iter().find(|claim| {
            !prover.is_listed_owner(claim, &mut self.cover, cell, self.check_overlaps)
        });
        if let (Some(claim), BoxSize::Last) = (wrong, box_size) {
            let statement = Statement::SingleOwner(self.region_name(claim.owner));
            self.undecided.push(OpenProof { cell, statement });
            return true;
        }
        wrong.is_none()
    }

    /// Returns whether enough is known about a box with one owner.
    fn examine_interior(&mut self, owner: usize, cell: Cell, box_size: BoxSize) -> bool {
        self.slopes.set(cell);
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        let is_profile = self.border_prover.is_none();
        // Wide slopes would make `L` too large and `c` too small.
        let known = is_profile
            || depth.length.high - depth.length.low <= SLOPE_ACCURACY * depth.length.high;
        let is_positive = depth.value.low >= -TOLERANCE * self.size;
        let falls = is_profile || self.fall_rate(owner, &[Some(owner)], cell) > 0.0;
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
        // Only a box that is not divided further comes here with a depth that may be below 0.
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
        if self.border_prover.is_none() {
            if !self.describe_borders(cell, owners, box_size) {
                return false;
            }
        } else {
            let mut regions = owners.iter().flatten();
            let falls = regions.all(|owner| self.fall_rate(*owner, owners, cell) > 0.0);
            if !box_size.is_last() && !falls {
                return false;
            }
            if claims.len() > MAX_CLAIMS {
                let statement = Statement::MeetingRegions(owners.len());
                self.undecided.push(OpenProof { cell, statement });
            } else if !self.examine_borders(cell, claims, box_size) {
                return false;
            }
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
        let dot_product = dot(depth.partials, niceness.partials);
        let facts_here = RegionFacts {
            // A point of the region is not outside.
            depth: Interval { low: depth.value.low.max(0.0), ..depth.value },
            gradient_length: depth.length,
            steep_at: (!depth.length.high.is_finite()).then(|| cell.middle()),
            magnitude: self.slopes.get(region.magnitude).value,
            niceness: niceness.value,
            // Without bounds of the slopes nothing is known of their product.
            niceness_never_rises: depth.length.high * niceness.length.high < f64::INFINITY
                && dot_product.high <= SLOPE_MARGIN * depth.length.high * niceness.length.high,
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
                steep_at: known.steep_at.or(facts_here.steep_at),
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

/// The largest angle, in radians, at which a direction counts as that of steepest descent. Components written
/// with four decimals turn it by no more.
const ANGLE_TOLERANCE: f64 = 1e-4;

/// The facts about a region that are certain at single points.
#[derive(Clone, Default)]
struct CertainFacts {
    /// The largest angle between the direction and that of steepest descent, in radians.
    oblique: Option<CertainValue>,
    /// The largest rate at which niceness rises per unit of depth.
    rises: Option<CertainValue>,
}

fn keep_larger(known: &mut Option<CertainValue>, value: f64, point: [f64; 3]) {
    if known.is_none_or(|largest| value > largest.value) {
        *known = Some(CertainValue { value, point });
    }
}

impl Survey<'_> {
    /// Examines the centre of the current box, if it belongs to `owner` and the box may contain more than is
    /// known: a larger angle, or a niceness that rises.
    fn examine_centre(&mut self, owner: usize, cell: Cell, angle: f64, may_rise: bool) {
        let known =
            self.certain_facts[owner].oblique.map_or(ANGLE_TOLERANCE, |largest| largest.value);
        if angle <= known && !may_rise {
            return;
        }
        let middle = cell.middle();
        let point = Cell::point(middle);
        let claims = self.cover.claims(point);
        // The point would prove nothing about the region if it might be another's.
        if !matches!(claims.as_slice(), [claim] if claim.owner == Some(owner)) {
            return;
        }
        self.slopes.set(point);
        let region = &self.tool.model.regions[owner];
        let depth = self.slopes.get(region.depth);
        let niceness = self.slopes.get(region.niceness);
        let direction = self.raw_direction(owner);
        // An enclosure over a point is nearly a value, so its lower end is certain.
        let certain = &mut self.certain_facts[owner];
        if let Some(angle) = angle_to_descent(direction, depth, self.directions[owner].is_parallel)
            && angle.low > ANGLE_TOLERANCE
        {
            keep_larger(&mut certain.oblique, angle.low, middle);
        }
        let dot_product = dot(depth.partials, niceness.partials);
        // Niceness below 0 counts as 0.
        if dot_product.low > SLOPE_MARGIN * depth.length.high * niceness.length.high
            && niceness.value.low > 0.0
        {
            // Along the gradient of depth, over a length of 1/|∇depth| per unit of depth.
            let rate = dot_product.low / (depth.length.high * depth.length.high);
            keep_larger(&mut certain.rises, rate, middle);
        }
        self.slopes.set(cell);
    }
}

impl Survey<'_> {
    /// Returns the certificate that follows from all boxes.
    fn certificate(mut self) -> Certificate {
        let shares = self.witness.shares();
        let (min_slope, slack) = match self.border_prover {
            Some(_) => {
                let (min_slope, missed_distance) = self.min_slope();
                let slack = sum_rounded_up(0.0, min_slope.max(0.0) * missed_distance);
                (min_slope, sum_rounded_up(self.jump_bound(), slack))
            }
            None => (1.0, unless_rounding(self.deviation.unwrap_or(0.0), self.size)),
        };
        let mut ranges = Ranges {
            cover: &mut self.cover,
            slopes: &mut self.slopes,
            whole: self.tool.extent.cell(),
        };
        if self.check_overlaps {
            for (index, region) in self.tool.model.regions.iter().enumerate() {
                if let Some(facts) = &mut self.regions[index] {
                    facts.niceness = ranges.niceness(index, region, facts.niceness);
                }
            }
        }
        let mut regions = Vec::new();
        for (region, direction) in self.directions.into_iter().enumerate() {
            let facts = self.regions[region].take().unwrap_or(RegionFacts::NONE);
            let is_distance = match &self.border_prover {
                Some(prover) => prover.is_distance(region),
                None => self.deviation.is_some(),
            };
            // The identity is exact, where enclosures of the slope have rounding.
            let exact_length = Interval::new(1.0, 1.0);
            regions.push(RegionFacts {
                share: shares[region],
                is_distance,
                gradient_length: if is_distance { exact_length } else { facts.gradient_length },
                steep_at: facts.steep_at.filter(|_| !is_distance),
                direction_error: direction.angle_to_descent,
                oblique_witness: self.certain_facts[region].oblique,
                rising_witness: self.certain_facts[region].rises,
                singular_cells: direction.singular,
                turns_on_axis: direction.on_axis,
                ..facts
            });
        }
        let mut borders = self.borders;
        // Regions of a profile that meet in points only have no border.
        borders
            .retain(|(pair, _), _| self.border_prover.is_some() || self.neighbours.contains(pair));
        Certificate {
            min_slope,
            slack,
            regions,
            borders: borders.into_values().collect(),
            undecided: self.undecided,
            tolerance: TOLERANCE * self.size,
            examined_boxes: self.boxes,
        }
    }

    /// Returns an upper bound of the amount that depth may gain by jumps along a straight path, and by
    /// differing from an exact distance.
    fn jump_bound(&self) -> f64 {
        let steps = self.smooth_border_jumps.values().copied().fold(0.0, sum_rounded_up);
        // Depths of regions by hand may be steep outside their regions, so every jump counts. A straight path
        // in space is a branch of a hyperbola in the half plane, on which `z` is linear and `d` convex. It
        // passes a box at most twice, since `d` is below an upper end on one interval and above a lower end on
        // two. It crosses a line at most twice, too.
        let passes = match self.tool.model.domain {
            Domain::HalfPlane => 2.0,
            Domain::Space => 1.0,
        };
        passes * sum_rounded_up(self.jumps, 2.0 * steps)
    }
}
