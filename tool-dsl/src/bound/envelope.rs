//! The envelope: the largest radius of the solid over intervals of the axis, which the runtime uses to skip
//! points.

use super::{Extent, Prover, inward};
use crate::expr::interval::Interval;
use crate::expr::polynomial::Polynomial;
use crate::geometry::outline;
use crate::model::Model;

/// The largest number of slabs in an envelope.
const MAX_SLABS: usize = 24;
/// The number of additional slabs before neighbours are merged.
const SPARE_SLABS: usize = 8;

/// An interval of the axis with the largest radius of the solid in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeSlab {
    /// The lower end, in the tool's frame and the file's unit.
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

/// Returns the largest radius over intervals of the axis, from the tip up.
pub fn envelope(model: &Model, extent: &Extent) -> Vec<EnvelopeSlab> {
    let mut prover = Prover::of_regions(model);
    let mut slab = |low: f64, high: f64, widest: f64| {
        if let Some(section) = &model.section {
            let radius = outline::radius_between(&section.outline, low, high);
            return EnvelopeSlab { low, high, radius };
        }
        let within = extent.cell().with_side(2, Interval::new(low, high));
        let radius = inward(widest, 0.0, 12, |r| prover.none_beyond(r, widest, within));
        EnvelopeSlab { low, high, radius }
    };
    let mut ends: Vec<f64> = (0..=8)
        .map(|k| extent.low + (extent.high - extent.low) * f64::from(k) / 8.0)
        .chain(levels(model))
        .filter(|z| (extent.low..=extent.high).contains(z))
        .collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < 1e-6 * (extent.high - extent.low));
    // `dedup_by` drops the later of two ends that nearly coincide, but the last one must remain.
    if let Some(last) = ends.last_mut() {
        *last = extent.high;
    }
    let mut slabs: Vec<EnvelopeSlab> =
        ends.windows(2).map(|pair| slab(pair[0], pair[1], extent.radius)).collect();
    // Halve the slab whose halving saves most area, while that is more than 1 %.
    let mut halves: Vec<Option<[EnvelopeSlab; 2]>> = vec![None; slabs.len()];
    while slabs.len() < MAX_SLABS + SPARE_SLABS {
        for (own, half) in slabs.iter().zip(&mut halves) {
            half.get_or_insert_with(|| {
                let middle = own.low / 2.0 + own.high / 2.0;
                [slab(own.low, middle, own.radius), slab(middle, own.high, own.radius)]
            });
        }
        let saved =
            |i: usize| halves[i].map_or(0.0, |[a, b]| slabs[i].area() - a.area() - b.area());
        let best = (0..slabs.len()).max_by(|&i, &j| saved(i).total_cmp(&saved(j)));
        let Some(best) = best.filter(|&i| saved(i) > 0.01 * slabs[i].area()) else { break };
        let Some([a, b]) = halves[best].take() else { break };
        slabs[best] = a;
        slabs.insert(best + 1, b);
        halves.insert(best + 1, None);
    }
    // Merge the neighbours whose common slab adds least area.
    while slabs.len() > 1 {
        let added = |i: usize| {
            slabs[i].merged(&slabs[i + 1]).area() - slabs[i].area() - slabs[i + 1].area()
        };
        let best = (0..slabs.len() - 1).min_by(|&i, &j| added(i).total_cmp(&added(j)));
        let Some(best) = best else { break };
        if slabs.len() <= MAX_SLABS && added(best) > 0.001 * slabs[best].area() {
            break;
        }
        slabs[best] = slabs[best].merged(&slabs[best + 1]);
        slabs.remove(best + 1);
    }
    let steps = extent.steps();
    for slab in &mut slabs {
        slab.low = -above(-slab.low, steps);
        slab.high = above(slab.high, steps);
        slab.radius = above(slab.radius, steps);
    }
    slabs
}

/// Returns the ranges of x and y of a solid without an axis, rounded outward as in `ToolInfo`.
pub fn lateral_extent(extent: &Extent) -> [[f64; 2]; 2] {
    let steps = extent.steps();
    extent.lateral.map(|side| [-above(-side.low, steps), above(side.high, steps)])
}

/// Returns a short decimal that is at least `value`: a multiple of `1 / steps`.
fn above(value: f64, steps: f64) -> f64 {
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
fn level(model: &Model, value: crate::expr::Id) -> Option<f64> {
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
