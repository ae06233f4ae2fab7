//! The largest radius of the solid over stretches of the axis: what the runtime skips by.

use super::{Extent, Prover, inward};
use crate::expr::interval::Interval;
use crate::expr::polynomial::Polynomial;
use crate::geometry::outline;
use crate::model::Model;

/// The most slabs of an envelope.
const SLABS: usize = 24;
/// How many more there are before neighbours are merged.
const SPARE: usize = 8;

/// A stretch of the axis with the largest radius that the solid has there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The lower end, in the tool's frame.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// No point of the solid with a z between the ends is farther from the axis.
    pub radius: f64,
}

impl Slab {
    /// Its area in the section: what the merging and halving of slabs weigh.
    fn area(&self) -> f64 {
        self.radius * (self.high - self.low)
    }

    /// One slab for two neighbours.
    fn merged(&self, above: &Slab) -> Slab {
        Slab { low: self.low, high: above.high, radius: self.radius.max(above.radius) }
    }
}

/// The largest radius over stretches of the axis, from the tip up.
pub fn envelope(model: &Model, extent: &Extent) -> Vec<Slab> {
    let mut prover = Prover::of_regions(model);
    let mut slab = |low: f64, high: f64, widest: f64| {
        if let Some(section) = &model.section {
            let radius = outline::radius_between(&section.outline, low, high);
            return Slab { low, high, radius };
        }
        let within = extent.cell().with(2, Interval::new(low, high));
        let radius = inward(widest, 0.0, 12, |r| prover.none_beyond(r, widest, within));
        Slab { low, high, radius }
    };
    let mut ends: Vec<f64> = (0..=8)
        .map(|k| extent.low + (extent.high - extent.low) * f64::from(k) / 8.0)
        .chain(levels(model))
        .filter(|z| (extent.low..=extent.high).contains(z))
        .collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < 1e-6 * (extent.high - extent.low));
    // Of two ends that are nearly one the later is dropped, but never the last.
    if let Some(last) = ends.last_mut() {
        *last = extent.high;
    }
    let mut slabs: Vec<Slab> =
        ends.windows(2).map(|pair| slab(pair[0], pair[1], extent.radius)).collect();
    // Halve where the halves are slimmer, as long as it saves most.
    let mut halves: Vec<Option<[Slab; 2]>> = vec![None; slabs.len()];
    while slabs.len() < SLABS + SPARE {
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
    // Merge the neighbours whose common slab adds least.
    while slabs.len() > 1 {
        let added = |i: usize| {
            slabs[i].merged(&slabs[i + 1]).area() - slabs[i].area() - slabs[i + 1].area()
        };
        let best = (0..slabs.len() - 1).min_by(|&i, &j| added(i).total_cmp(&added(j)));
        let Some(best) = best else { break };
        if slabs.len() <= SLABS && added(best) > 0.001 * slabs[best].area() {
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

/// The x and y that a solid without an axis reaches, as the card says them.
pub fn across(extent: &Extent) -> [[f64; 2]; 2] {
    let steps = extent.steps();
    extent.across.map(|side| [-above(-side.low, steps), above(side.high, steps)])
}

/// A short decimal that is no smaller than a value, in units of which there are `steps` to 1.
fn above(value: f64, steps: f64) -> f64 {
    let count = (value * steps).ceil();
    let short = if steps >= 1.0 { count / steps } else { count * (1.0 / steps) };
    if short >= value { short } else { (count + 1.0) / steps }
}

/// Heights at which the radius may jump.
fn levels(model: &Model) -> Vec<f64> {
    match &model.section {
        Some(section) => section.outline.iter().flat_map(|s| s.ends()).map(|end| end[1]).collect(),
        None => model.curves.iter().filter_map(|curve| level(model, curve.value)).collect(),
    }
}

/// The z of a curve that is a plane across the axis.
fn level(model: &Model, value: crate::expr::Id) -> Option<f64> {
    let polynomial = Polynomial::of(&model.graph, value)?;
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
