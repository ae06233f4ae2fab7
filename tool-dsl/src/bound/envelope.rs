//! The envelope: the largest radius of the solid over intervals of the axis, which the runtime uses to skip
//! points.

use super::{Extent, Prover, inward};
use crate::expr::Id;
use crate::expr::interval::Interval;
use crate::expr::polynomial::Polynomial;
use crate::geometry::outline;
use crate::model::Model;

/// The largest number of slabs in an envelope.
const MAX_SLABS: usize = 24;
/// The number of additional slabs before neighbours are merged.
const SPARE_SLABS: usize = 8;
/// The number of equal intervals of the axis whose ends are ends of the first slabs.
const EVEN_INTERVALS: u32 = 8;
/// The distance within which two ends count as one, relative to the solid's length.
const SAME_END_FRACTION: f64 = 1e-6;
/// The number of halvings in the search for a slab's radius, if there is no profile.
const RADIUS_HALVINGS: usize = 12;
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
    let mut prover = Prover::of_regions(model);
    let mut slabs: Vec<EnvelopeSlab> = first_ends(model, extent)
        .windows(2)
        .map(|ends| slab_between(&mut prover, extent, ends[0], ends[1], extent.radius))
        .collect();
    split_until_full(&mut slabs, &mut prover, extent);
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

/// Returns the slab between two heights, where no point of the solid is farther from the axis than `widest`.
fn slab_between(
    prover: &mut Prover<'_>,
    extent: &Extent,
    low: f64,
    high: f64,
    widest: f64,
) -> EnvelopeSlab {
    if let Some(section) = &prover.model.section {
        let radius = outline::radius_between(&section.outline, low, high);
        return EnvelopeSlab { low, high, radius };
    }
    let within = extent.cell().with_side(2, Interval::new(low, high));
    let none_beyond = |radius| prover.none_beyond(radius, widest, within);
    EnvelopeSlab { low, high, radius: inward(widest, 0.0, RADIUS_HALVINGS, none_beyond) }
}

/// Halves the slab whose halving saves most area, while that is enough, up to [`SPARE_SLABS`] slabs too many.
fn split_until_full(slabs: &mut Vec<EnvelopeSlab>, prover: &mut Prover<'_>, extent: &Extent) {
    let mut halves: Vec<Option<[EnvelopeSlab; 2]>> = vec![None; slabs.len()];
    while slabs.len() < MAX_SLABS + SPARE_SLABS {
        for (slab, halves) in slabs.iter().zip(&mut halves) {
            halves.get_or_insert_with(|| {
                let ends = [slab.low, slab.low / 2.0 + slab.high / 2.0, slab.high];
                [0, 1].map(|k| slab_between(prover, extent, ends[k], ends[k + 1], slab.radius))
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
    let short = if steps >= 1.0 { count / steps } else { count * (1.0 / steps) };
    if short >= value { short } else { (count + 1.0) / steps }
}

/// Returns heights at which the radius may jump.
fn levels(model: &Model) -> Vec<f64> {
    match &model.section {
        Some(section) => section.outline.iter().flat_map(|s| s.ends()).map(|end| end[1]).collect(),
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
