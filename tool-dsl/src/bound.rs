//! Proved bounds of the solid by interval branch and bound: its extent, and its largest radius over intervals
//! of the axis. The runtime skips everything that these rule out.

use crate::boxes::BoxTree;
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::domain::Domain;
use crate::elimination::Linear;
use crate::expr::Id;
use crate::expr::interval::{Cell, Interval};
use crate::expr::polynomial::Polynomial;
use crate::formula::ANY_SIGN;
use crate::geometry::outline::{self, Segment};
use crate::model::Model;

/// The exponent of the power of two that bounds the extent of a solid.
const MAX_EXTENT_EXPONENT: i32 = 280;
/// The largest coordinate, 2^300.
const MAX_COORDINATE: f64 = 2.037035976334486e90;
/// The number of boxes per query. It gives a few percent where an expression mentions a coordinate several
/// times, and rounding accuracy where it does so once.
const BOXES_PER_QUERY: usize = 100;
/// The number of boxes for a cylinder about the axis of space, which boxes fit badly: again a few percent.
const BOXES_PER_CYLINDER_QUERY: usize = 400;
/// The number of halvings in the search for a radius, if there is no profile.
const RADIUS_HALVINGS: usize = 12;

/// The distance of points from the sides of a box whose corner they stand for, relative to these sides: more than the rounding
/// of the box, and little enough for the halvings of a bound.
const CORNER_INSET: f64 = 1e-9;
/// The largest number of corners that are tried for the radius of a slab.
const MAX_CORNERS: usize = 16;

/// The position of a box relative to the solid.
#[derive(Clone, Copy, PartialEq)]
enum BoxPosition {
    Inside,
    Outside,
    Unknown,
}

/// Decides whether the solid reaches into boxes.
struct Prover<'m> {
    model: &'m Model,
    /// A box that contains each region, according to linear curves, which boxes would find slowly.
    reaches: Vec<Cell>,
    /// The boxes of queries about one cell.
    boxes: BoxTree<'m>,
    /// Knowledge about each of them.
    known: Vec<KnownBox>,
}

/// Knowledge of queries about a box.
struct KnownBox {
    /// An upper bound of the distance of its points from the axis.
    widest: f64,
    /// Its position, once a query has asked for it.
    position: Option<BoxPosition>,
    /// The regions that may have points of it. They decide its halves, since those that are decided here are decided in the
    /// same way there.
    regions: Vec<usize>,
}

impl<'m> Prover<'m> {
    fn new(model: &'m Model) -> Prover<'m> {
        let linear = Linear::new(model);
        let reaches = model.regions.iter().map(|region| {
            let mut signs = vec![ANY_SIGN; model.curves.len()];
            region.condition.narrow_signs(&mut signs);
            let mut reach = linear.bounding_box(&signs);
            for choices in region.condition.disjunctions() {
                // A point of the region satisfies one of the choices.
                let hull = choices
                    .iter()
                    .map(|choice| {
                        let mut signs = signs.clone();
                        choice.narrow_signs(&mut signs);
                        linear.bounding_box(&signs)
                    })
                    .reduce(|a, b| a.hull(&b));
                reach = hull.map_or(reach, |hull| reach.common(&hull));
            }
            reach
        });
        Prover { model, reaches: reaches.collect(), boxes: BoxTree::new(model), known: Vec::new() }
    }

    /// Selects the cell of the next queries.
    fn set_cell(&mut self, cell: Cell) {
        self.boxes.restart(cell);
        self.known.clear();
        self.add_box((0..self.model.regions.len()).collect());
    }

    /// Adds what is known about the next box: the regions that may have points of it.
    fn add_box(&mut self, regions: Vec<usize>) {
        let widest = self.boxes.cell(self.known.len()).radius().high;
        self.known.push(KnownBox { widest, position: None, regions });
    }

    fn position(&mut self, index: usize) -> BoxPosition {
        if let Some(position) = self.known[index].position {
            return position;
        }
        let position = self.classify(index);
        self.known[index].position = Some(position);
        position
    }

    fn classify(&mut self, index: usize) -> BoxPosition {
        let (model, cell) = (self.model, *self.boxes.cell(index));
        let mut undecided = Vec::new();
        for &region in &self.known[index].regions {
            // The linear curves exclude the region here.
            if !self.reaches[region].meets(&cell) {
                continue;
            }
            let mut signs = |curve| self.boxes.signs(index, curve);
            match model.regions[region].condition.decide_with(&mut signs) {
                Some(true) => return BoxPosition::Inside,
                Some(false) => {}
                // A later region may still contain the whole box.
                None => undecided.push(region),
            }
        }
        let is_empty = undecided.is_empty();
        self.known[index].regions = undecided;
        if is_empty { BoxPosition::Outside } else { BoxPosition::Unknown }
    }

    /// Returns the halves of a box whose position is known.
    fn halves(&mut self, index: usize) -> [usize; 2] {
        let halves = self.boxes.halves(index);
        while self.known.len() <= halves[1] {
            self.add_box(self.known[index].regions.clone());
        }
        halves
    }

    /// Returns whether the solid provably does not reach into a cell.
    fn is_empty(&mut self, cell: Cell) -> bool {
        self.set_cell(cell);
        self.none_beyond(0.0, BOXES_PER_QUERY)
    }

    /// Returns whether the solid provably has no point in the selected cell at this distance from the axis or farther, with
    /// a budget of boxes.
    fn none_beyond(&mut self, radius: f64, budget: usize) -> bool {
        let mut pending = vec![0];
        let mut remaining = budget;
        while let Some(index) = pending.pop() {
            // The box is nearer to the axis than the points in question.
            if self.known[index].widest < radius {
                continue;
            }
            match self.position(index) {
                BoxPosition::Outside => {}
                BoxPosition::Inside => return false,
                BoxPosition::Unknown if remaining == 0 => return false,
                BoxPosition::Unknown => {
                    remaining -= 1;
                    pending.extend(self.halves(index));
                }
            }
        }
        true
    }

    /// Returns the least radius found, at most `widest`, beyond which the solid provably has no point in a cell. No point of
    /// the cell is farther from the axis than `widest`.
    fn radius_within(&mut self, widest: f64, cell: Cell) -> f64 {
        if self.model.domain == Domain::HalfPlane {
            return inward(widest, 0.0, RADIUS_HALVINGS, |radius| {
                self.is_empty(cell.with_side(0, Interval::new(radius, widest)))
            });
        }
        // No proof can succeed up to a point of the solid, so none is tried: it would use up its budget.
        let reached = self.farthest_corner(cell);
        // A cylinder about the axis does not change the boxes, so all proofs share them.
        self.set_cell(cell);
        inward(widest, 0.0, RADIUS_HALVINGS, |radius| {
            radius > reached && self.none_beyond(radius, BOXES_PER_CYLINDER_QUERY)
        })
    }

    /// Returns a distance from the axis at which the solid provably has a point in a cell: that of the farthest corner of a
    /// region's box that is in the solid. Returns 0 if none is found.
    fn farthest_corner(&mut self, cell: Cell) -> f64 {
        let reached = |corner: &Cell| corner.radius().low;
        let mut corners = self.corners(cell);
        corners.sort_by(|a, b| reached(b).total_cmp(&reached(a)));
        corners.truncate(MAX_CORNERS);
        corners.iter().find(|corner| self.is_inside(**corner)).map_or(0.0, reached)
    }

    /// Returns points in a cell near the corners of the boxes that contain the regions.
    fn corners(&self, cell: Cell) -> Vec<Cell> {
        let mut corners: Vec<Cell> = Vec::new();
        for sides in self.reaches.iter().map(|reach| reach.common(&cell).sides) {
            // Unequal insets, since regions that share a corner often meet on its diagonal.
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let (side, fraction) = (sides[axis], CORNER_INSET * (axis + 1) as f64);
                let inset = fraction * (side.high - side.low);
                [side.low + inset, side.high - inset]
            });
            for index in 0..8 {
                let corner = Cell::point([x[index & 1], y[index >> 1 & 1], z[index >> 2]]);
                // An unbounded box has no corners, and one outside the cell has none in it.
                let is_finite = corner.sides.iter().all(|side| side.low.is_finite());
                if is_finite && cell.meets(&corner) && !corners.contains(&corner) {
                    corners.push(corner);
                }
            }
        }
        corners
    }

    /// Returns whether a point is provably in the solid.
    fn is_inside(&mut self, point: Cell) -> bool {
        self.set_cell(point);
        self.position(0) == BoxPosition::Inside
    }
}

/// The extent of the solid, in the tool's frame and the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The lowest z.
    pub low: f64,
    /// The highest z.
    pub high: f64,
    /// The largest distance from the axis.
    pub radius: f64,
    /// The ranges of x and y in the domain; for a tool, 0 to the radius, and 0.
    pub lateral: [Interval; 2],
}

impl Extent {
    /// Returns the extent of a solid inside a box of the domain and a radius about the axis.
    pub(crate) fn of(cell: Cell, radius: f64) -> Extent {
        let [x, y, z] = cell.sides;
        Extent { low: z.low, high: z.high, radius, lateral: [x, y] }
    }

    /// Returns the box of the domain.
    pub fn cell(&self) -> Cell {
        let [x, y] = self.lateral;
        Cell { sides: [x, y, Interval::new(self.low, self.high)] }
    }

    /// Returns the smallest power of two above the largest coordinate: the S of the accuracy contract.
    pub fn scale(&self) -> f64 {
        let sides = self.cell().sides;
        let largest = sides.iter().fold(0.0, |m: f64, s| m.max(s.high.abs()).max(s.low.abs()));
        let mut scale = 2f64.powi(largest.log2().floor() as i32);
        // Once, and again if the logarithm was rounded down.
        while scale <= largest {
            scale *= 2.0;
        }
        scale
    }

    /// Returns the number of rounding steps per unit of length for the values of `ToolInfo`.
    fn steps(&self) -> f64 {
        10f64.powf(5.0 - self.scale().log10().floor())
    }
}

/// Returns points spread evenly over the extent's box and a `margin` around it, by the additive recurrences
/// R2 in the half plane and R3 in space (Roberts 2018). The margin is relative to each side.
pub(crate) fn spread(
    domain: Domain,
    extent: &Extent,
    count: usize,
    margin: f64,
) -> impl Iterator<Item = [f64; 3]> {
    // The real roots of x³ = x + 1 and x⁴ = x + 1.
    const PLASTIC: f64 = 1.324_717_957_244_746;
    const PLASTIC_IN_SPACE: f64 = 1.220_744_084_605_759_5;
    let cell = extent.cell();
    let step = |root: f64, power: i32| 1.0 / root.powi(power);
    let (low_end, steps) = match domain {
        // The half plane has no points beyond the axis.
        Domain::HalfPlane => (0.0, [step(PLASTIC, 1), 0.0, step(PLASTIC, 2)]),
        Domain::Space => (margin, [1, 2, 3].map(|power| step(PLASTIC_IN_SPACE, power))),
    };
    let ends = [low_end, low_end, margin].map(|below| [below, below + margin]);
    (1..=count).map(move |k| {
        [0, 1, 2].map(|axis| {
            let (side, [below, both]) = (cell.sides[axis], ends[axis]);
            let (width, part) = (side.high - side.low, (0.5 + steps[axis] * k as f64).fract());
            side.low - below * width + part * width * (1.0 + both)
        })
    })
}

/// Returns the proved extent of the solid.
///
/// # Errors
/// If no bound is found, or the solid provably has no points.
pub fn extent(model: &Model) -> Result<Extent, Diagnostic> {
    if let Some(profile) = &model.profile {
        let [low, high] = outline::bounding_box(&profile.outline);
        let (d, z) = (Interval::new(0.0, high[0]), Interval::new(low[1], high[1]));
        return Ok(Extent::of(Cell::half_plane(d, z), high[0]));
    }
    let (domain, mut prover) = (model.domain, Prover::new(model));
    let power = reach(domain, &mut prover).ok_or_else(|| endless(model))?;
    let domain_box = domain.bounding_cell(2f64.powi(power));
    let mut cell = domain_box;
    // No proof can succeed beyond an end if one of these points of the solid is beyond it, so none is tried.
    let mut points = prover.corners(domain_box);
    points.retain(|corner| prover.is_inside(*corner));
    // Each end moves inward while the rest stays provably empty. The second pass tightens them, since the
    // solid is easier to bound between its ends.
    for pass in 0..2 {
        for (axis, high) in domain.axis_directions() {
            let side = cell.sides[*axis];
            // In the second pass the other end is already near the solid.
            let opposite = if pass == 0 { domain_box.sides[*axis] } else { side };
            let mut is_empty_beyond = |end: Interval| {
                let beyond = cell.with_side(*axis, end);
                !points.iter().any(|point| beyond.meets(point)) && prover.is_empty(beyond)
            };
            let end = if *high {
                inward(side.high, opposite.low, 52, |v| {
                    is_empty_beyond(Interval::new(v, side.high))
                })
            } else {
                inward(side.low, opposite.high, 52, |v| is_empty_beyond(Interval::new(side.low, v)))
            };
            let side_to_move = &mut cell.sides[*axis];
            if *high { side_to_move.high = end } else { side_to_move.low = end }
        }
        let is_empty = domain.coordinates().iter().any(|(_, axis, _)| {
            let side = cell.sides[*axis];
            side.low >= side.high
        });
        if is_empty {
            return Err(Diagnostic::new(
                model.name_span,
                CheckKind::NoPoints { domain: domain.keyword() },
            ));
        }
    }
    let widest = cell.radius().high;
    let radius = match domain {
        Domain::HalfPlane => cell.sides[0].high,
        Domain::Space => prover.radius_within(widest, cell),
    };
    Ok(Extent::of(cell, radius))
}

/// Returns the exponent of a power of two beyond which the solid provably has no point.
fn reach(domain: Domain, prover: &mut Prover<'_>) -> Option<i32> {
    let mut beyond = |size: f64| unbounded_direction(domain, prover, size).is_none();
    let mut power = MAX_EXTENT_EXPONENT;
    if !beyond(2f64.powi(power)) {
        return None;
    }
    // Large steps first: each costs a proof for all directions.
    for step in [64, 16, 4, 1] {
        while power - step > -280 && beyond(2f64.powi(power - step)) {
            power -= step;
        }
    }
    Some(power)
}

/// Returns a direction in which the solid may extend farther than `size`.
fn unbounded_direction(
    domain: Domain,
    prover: &mut Prover<'_>,
    size: f64,
) -> Option<(usize, bool)> {
    domain.axis_directions().iter().copied().find(|(axis, high)| {
        let outer = if *high {
            Interval::new(size, MAX_COORDINATE)
        } else {
            Interval::new(-MAX_COORDINATE, -size)
        };
        prover.set_cell(domain.bounding_cell(MAX_COORDINATE).with_side(*axis, outer));
        !prover.none_beyond(0.0, 20 * BOXES_PER_QUERY)
    })
}

/// Reports the first region for which no bound is found.
fn endless(model: &Model) -> Diagnostic {
    let domain = model.domain;
    let mut alone = model.clone();
    for region in &model.regions {
        // One region by itself shows which of them is unbounded.
        alone.regions = vec![region.clone()];
        let out =
            unbounded_direction(domain, &mut Prover::new(&alone), 2f64.powi(MAX_EXTENT_EXPONENT));
        let Some((axis, high)) = out else { continue };
        let coordinate = domain.coordinates().iter().find(|c| c.1 == axis).map_or("z", |c| c.2);
        let direction = if high { "large" } else { "small" };
        let bound = if high { "<= 40" } else { ">= 0" };
        return Diagnostic::new(
            region.span,
            CheckKind::UnboundedRegion {
                region: region.name.clone(),
                direction,
                coordinate,
                bound,
            },
        );
    }
    let kind = CheckKind::UnboundedRegions { domain: domain.keyword() };
    Diagnostic::new(model.name_span, kind)
}

/// Returns the innermost position from `outer` toward `inner` for which `empty` still holds, by bisection.
fn inward(outer: f64, inner: f64, halvings: usize, mut empty: impl FnMut(f64) -> bool) -> f64 {
    let (mut good, mut bad) = (outer, inner);
    for _ in 0..halvings {
        let middle = good / 2.0 + bad / 2.0;
        if empty(middle) { good = middle } else { bad = middle }
    }
    good
}

/// The largest number of slabs in an envelope.
const MAX_SLABS: usize = 24;
/// The number of additional slabs before neighbours are merged.
const SPARE_SLABS: usize = 8;
/// The number of equal intervals of the axis whose ends are ends of the first slabs.
const EVEN_INTERVALS: u32 = 8;
/// The distance within which two ends count as one, relative to the solid's length.
const SAME_END_FRACTION: f64 = 1e-6;
/// The area that halving a slab must save, relative to the slab's.
const MIN_SAVED_FRACTION: f64 = 0.01;
/// The area that merging two slabs may add while there are few enough, relative to the lower slab's.
const MAX_ADDED_FRACTION: f64 = 0.001;

/// An interval of the axis with the largest radius of the solid in it, in the tool's frame and the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeSlab {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// An upper bound of the distance from the axis, for points of the solid between the ends.
    pub radius: f64,
}

impl EnvelopeSlab {
    /// Returns its area in the section, the cost that splitting and merging minimise.
    fn area(&self) -> f64 {
        self.radius * (self.high - self.low)
    }

    /// Merges two neighbours into one slab.
    fn merged(&self, above: &EnvelopeSlab) -> EnvelopeSlab {
        EnvelopeSlab { low: self.low, high: above.high, radius: self.radius.max(above.radius) }
    }
}

/// Returns the envelope: at most `MAX_SLABS` slabs from the tip up, which together cover the solid. Each begins
/// where the one before ends, or below by rounding, since all are rounded outward as in `ToolInfo`.
pub fn envelope(model: &Model, extent: &Extent) -> Vec<EnvelopeSlab> {
    let mut radii = match &model.profile {
        Some(profile) => Radii::Outline(&profile.outline),
        None => Radii::Proved(Box::new(Prover::new(model)), extent.cell()),
    };
    let mut slabs: Vec<EnvelopeSlab> = first_ends(model, extent)
        .windows(2)
        .map(|ends| radii.slab_between(ends[0], ends[1], extent.radius))
        .collect();
    split_until_full(&mut slabs, &mut radii);
    merge_neighbours(&mut slabs);
    let steps = extent.steps();
    for slab in &mut slabs {
        slab.low = -rounded_up(-slab.low, steps);
        slab.high = rounded_up(slab.high, steps);
        slab.radius = rounded_up(slab.radius, steps);
    }
    slabs
}

/// Returns the ends of the first slabs, in ascending order: equidistant heights, and those where the radius may jump.
fn first_ends(model: &Model, extent: &Extent) -> Vec<f64> {
    let length = extent.high - extent.low;
    let even = (0..=EVEN_INTERVALS)
        .map(|k| extent.low + length * f64::from(k) / f64::from(EVEN_INTERVALS));
    let all = even.chain(levels(model));
    let mut ends: Vec<f64> = all.filter(|z| (extent.low..=extent.high).contains(z)).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < SAME_END_FRACTION * length);
    // `dedup_by` drops the later of two ends that nearly coincide, but the last one must remain.
    if let Some(last) = ends.last_mut() {
        *last = extent.high;
    }
    ends
}

/// The largest radius of a solid between two heights.
enum Radii<'m> {
    /// That of its outline.
    Outline(&'m [Segment]),
    /// The least for which a proof is found, in the solid's box.
    Proved(Box<Prover<'m>>, Cell),
}

impl Radii<'_> {
    /// Returns the slab between two heights, where no point of the solid is farther from the axis than `widest`.
    fn slab_between(&mut self, low: f64, high: f64, widest: f64) -> EnvelopeSlab {
        let radius = match self {
            Radii::Outline(outline) => outline::radius_between(outline, low, high),
            Radii::Proved(prover, cell) => {
                prover.radius_within(widest, cell.with_side(2, Interval::new(low, high)))
            }
        };
        EnvelopeSlab { low, high, radius }
    }
}

/// Halves the slab whose halving saves most area, while that is enough, up to [`SPARE_SLABS`] slabs too many.
fn split_until_full(slabs: &mut Vec<EnvelopeSlab>, radii: &mut Radii<'_>) {
    let mut halves: Vec<Option<[EnvelopeSlab; 2]>> = vec![None; slabs.len()];
    while slabs.len() < MAX_SLABS + SPARE_SLABS {
        for (slab, halves) in slabs.iter().zip(&mut halves) {
            // A proof per half: those of other slabs are kept.
            halves.get_or_insert_with(|| {
                let ends = [slab.low, slab.low / 2.0 + slab.high / 2.0, slab.high];
                [0, 1].map(|k| radii.slab_between(ends[k], ends[k + 1], slab.radius))
            });
        }
        let saved =
            |i: usize| halves[i].map_or(0.0, |[a, b]| slabs[i].area() - a.area() - b.area());
        let best = (0..slabs.len()).max_by(|&i, &j| saved(i).total_cmp(&saved(j)));
        let best = best.filter(|&i| saved(i) > MIN_SAVED_FRACTION * slabs[i].area());
        let Some(best) = best else { return };
        let Some(best_halves) = halves[best].take() else { return };
        slabs.splice(best..=best, best_halves);
        halves.insert(best + 1, None);
    }
}

/// Merges the neighbours whose common slab adds least area, while there are too many slabs or it adds little.
fn merge_neighbours(slabs: &mut Vec<EnvelopeSlab>) {
    while slabs.len() > 1 {
        let added = |i: usize| {
            slabs[i].merged(&slabs[i + 1]).area() - slabs[i].area() - slabs[i + 1].area()
        };
        let best = (0..slabs.len() - 1).min_by(|&i, &j| added(i).total_cmp(&added(j)));
        let Some(best) = best else { return };
        // With few enough slabs, only mergers that add next to nothing.
        if slabs.len() <= MAX_SLABS && added(best) > MAX_ADDED_FRACTION * slabs[best].area() {
            return;
        }
        slabs[best] = slabs[best].merged(&slabs[best + 1]);
        slabs.remove(best + 1);
    }
}

/// Returns the ranges of x and y of a solid without an axis, rounded outward as in `ToolInfo`.
pub fn lateral_extent(extent: &Extent) -> [[f64; 2]; 2] {
    let steps = extent.steps();
    extent.lateral.map(|side| [-rounded_up(-side.low, steps), rounded_up(side.high, steps)])
}

/// Returns a short decimal that is at least `value`: a multiple of `1 / steps`.
fn rounded_up(value: f64, steps: f64) -> f64 {
    let count = (value * steps).ceil();
    // A quotient by a power of ten is the nearest double to the decimal; `1 / steps` is an integer otherwise.
    let short = if steps >= 1.0 { count / steps } else { count * (1.0 / steps) };
    if short >= value { short } else { (count + 1.0) / steps }
}

/// Returns heights at which the radius may jump.
fn levels(model: &Model) -> Vec<f64> {
    match &model.profile {
        Some(profile) => {
            profile.outline.iter().flat_map(|s| s.geometry.ends).map(|end| end[1]).collect()
        }
        None => model.curves.iter().filter_map(|curve| level(model, curve.value)).collect(),
    }
}

/// Returns the z of a curve that is a plane perpendicular to the axis.
fn level(model: &Model, value: Id) -> Option<f64> {
    let polynomial = Polynomial::from_expression(&model.graph, value)?;
    let (mut slope, mut constant) = (None, 0.0);
    for (monomial, factor) in polynomial.terms() {
        match monomial {
            [0, 0, 0, 1] => slope = Some(factor.to_f64()),
            [0, 0, 0, 0] => constant = factor.to_f64(),
            _ => return None,
        }
    }
    slope.map(|slope| -constant / slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::interval::{Encloser, halves};
    use crate::formula::possible;
    use crate::library;

    /// Proves the same as [`Prover::none_beyond`] with new boxes that share and inherit nothing.
    fn none_beyond_without_memory(
        prover: &Prover<'_>,
        cell: Cell,
        radius: f64,
        budget: usize,
    ) -> bool {
        let model = prover.model;
        let mut encloser = Encloser::new(&model.graph, model.curve_values());
        let (mut pending, mut remaining) = (vec![cell], budget);
        while let Some(cell) = pending.pop() {
            if cell.radius().high < radius {
                continue;
            }
            encloser.set(cell);
            let mut sign = |curve: usize| possible(encloser.get(model.curves[curve].value));
            let mut regions = model.regions.iter().zip(&prover.reaches);
            let decided: Vec<Option<bool>> = regions
                .by_ref()
                .filter(|(_, reach)| reach.meets(&cell))
                .map(|(region, _)| region.condition.decide_with(&mut sign))
                .collect();
            if decided.contains(&Some(true)) || decided.contains(&None) && remaining == 0 {
                return false;
            }
            if decided.contains(&None) {
                remaining -= 1;
                pending.extend(halves(cell));
            }
        }
        true
    }

    #[test]
    fn shared_boxes_prove_what_new_ones_prove() {
        for tool in library::tools_by_hand() {
            let (extent, domain) = (tool.extent, tool.model.domain);
            let mut prover = Prover::new(&tool.model);
            for slab in 0..6 {
                let end = |k: i32| extent.low + (extent.high - extent.low) * f64::from(k) / 6.0;
                let cell = extent.cell().with_side(2, Interval::new(end(slab), end(slab + 1)));
                let found = prover.radius_within(extent.radius, cell);
                let expected = inward(extent.radius, 0.0, RADIUS_HALVINGS, |radius| match domain {
                    Domain::HalfPlane => {
                        let beyond = cell.with_side(0, Interval::new(radius, extent.radius));
                        none_beyond_without_memory(&prover, beyond, 0.0, BOXES_PER_QUERY)
                    }
                    Domain::Space => {
                        none_beyond_without_memory(&prover, cell, radius, BOXES_PER_CYLINDER_QUERY)
                    }
                });
                assert_eq!(found.to_bits(), expected.to_bits(), "{} {slab}", tool.model.name);
            }
        }
    }

    #[test]
    fn ends_are_those_found_without_known_points() {
        for tool in library::tools_by_hand() {
            let (extent, model) = (extent(&tool.model).expect("a bounded tool"), &tool.model);
            let mut prover = Prover::new(model);
            let power = reach(model.domain, &mut prover).expect("a bounded tool");
            let mut cell = model.domain.bounding_cell(2f64.powi(power));
            for pass in 0..2 {
                for &(axis, high) in model.domain.axis_directions() {
                    let side = cell.sides[axis];
                    let whole = model.domain.bounding_cell(2f64.powi(power)).sides[axis];
                    let opposite = if pass == 0 { whole } else { side };
                    let [outer, inner] =
                        if high { [side.high, opposite.low] } else { [side.low, opposite.high] };
                    let end = inward(outer, inner, 52, |v| {
                        let beyond = Interval::new(v.min(outer), v.max(outer));
                        prover.is_empty(cell.with_side(axis, beyond))
                    });
                    let side = &mut cell.sides[axis];
                    *(if high { &mut side.high } else { &mut side.low }) = end;
                }
            }
            assert_eq!(cell, extent.cell(), "{}", model.name);
        }
    }
}
