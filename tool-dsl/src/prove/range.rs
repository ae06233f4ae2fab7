//! The range of a region's niceness, over the points of the region alone.
//!
//! An enclosure over a box that extends beyond the region also holds for points outside the tool, where
//! `1 - depth/r` is more than 1. Boxes are therefore divided by branch and bound, and in each the niceness is
//! enclosed together with the depth.

use super::cover::Cover;
use super::slope::{Slope, Slopes};
use crate::expr::interval::{Cell, Interval, halves};
use crate::model::Region;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The largest number of boxes divided for one end of a range.
const MAX_BOXES: usize = 2_000;

/// The accuracy of ends, relative to the range or to 1.
const RELATIVE_ACCURACY: f64 = 1e-4;

/// A box, and an upper bound of the required end in it.
struct OpenBox {
    bound: f64,
    cell: Cell,
}

impl Ord for OpenBox {
    fn cmp(&self, other: &OpenBox) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for OpenBox {
    fn partial_cmp(&self, other: &OpenBox) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for OpenBox {
    fn eq(&self, other: &OpenBox) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for OpenBox {}

/// The inputs of a range.
pub(super) struct Ranges<'s, 't> {
    pub(super) cover: &'s mut Cover<'t>,
    pub(super) slopes: &'s mut Slopes<'t>,
    pub(super) whole: Cell,
}

impl Ranges<'_, '_> {
    /// Encloses the niceness of a region that is known to lie within `known`.
    pub(super) fn niceness(&mut self, index: usize, region: &Region, known: Interval) -> Interval {
        // A constant is known as well as can be.
        if known.low == known.high {
            return known;
        }
        let high = self.upper_bound(index, region, 1.0, known.high);
        let low = -self.upper_bound(index, region, -1.0, -known.low);
        Interval { low, high }
    }

    /// Returns an upper bound of `sign` times the niceness.
    fn upper_bound(&mut self, index: usize, region: &Region, sign: f64, known: f64) -> f64 {
        let mut open = BinaryHeap::from([OpenBox { bound: known, cell: self.whole }]);
        let mut largest = f64::NEG_INFINITY;
        for _ in 0..MAX_BOXES {
            let Some(OpenBox { bound, cell }) = open.pop() else { return largest };
            // The largest bound of all open boxes is near a value that is attained: boxes come in that order.
            if bound - largest <= RELATIVE_ACCURACY * bound.abs().max(1.0) {
                return bound;
            }
            for cell in halves(cell) {
                let claims = self.cover.claims(cell);
                if !claims.iter().any(|claim| claim.owner == Some(index)) {
                    continue;
                }
                let Some((box_bound, middle)) = self.enclose(region, sign, cell) else { continue };
                let centre = Cell::point(cell.middle());
                let is_owned =
                    self.cover.claims(centre).iter().all(|claim| claim.owner == Some(index));
                if is_owned {
                    largest = largest.max(middle);
                }
                // A part of a box is bounded by the whole, too.
                open.push(OpenBox { bound: box_bound.min(bound), cell });
            }
        }
        open.peek().map_or(largest, |open| open.bound)
    }

    /// Returns an upper bound of `sign` times the niceness in a box, and its value at the centre; `None` if
    /// the box has no point that is inside.
    fn enclose(&mut self, region: &Region, sign: f64, cell: Cell) -> Option<(f64, f64)> {
        self.slopes.set(Cell::point(cell.middle()));
        let [depth, centre_niceness] =
            [region.depth, region.niceness].map(|id| self.slopes.get(id).value);
        self.slopes.set(cell);
        let (depth_slope, niceness_slope) =
            (self.slopes.get(region.depth), self.slopes.get(region.niceness));
        // Depth is at least 0 inside.
        if depth_slope.value.high < 0.0 {
            return None;
        }
        let signed = |value: Interval| value.times(Interval::new(sign, sign));
        let direct_bound = signed(niceness_slope.value).high;
        let rate = -sign * rate(&depth_slope, &niceness_slope);
        let rate_interval = Interval::new(rate, rate);
        // With the rate `λ` at which niceness falls with depth, `s = niceness + λ depth` hardly changes in the box. By the
        // mean value theorem it is within `s(centre) + (∇niceness + λ ∇depth)·(box - centre)`. If `λ` is not negative,
        // niceness is at most the upper end of that minus `λ` times the least depth. For a niceness that is affine in
        // depth, the overestimate falls with the square of the box's size.
        let mut sum = signed(centre_niceness).plus(rate_interval.times(depth));
        for axis in 0..3 {
            let slope = signed(niceness_slope.partials[axis])
                .plus(rate_interval.times(depth_slope.partials[axis]));
            let middle = cell.middle()[axis];
            sum = sum.plus(slope.times(cell.sides[axis].plus(Interval::new(-middle, -middle))));
        }
        // Points of the box with a depth below 0 are not in the region.
        let inside = Interval { low: depth_slope.value.low.max(0.0), high: depth_slope.value.high };
        let bound = sum.plus(rate_interval.times(inside).negated()).high;
        // Infinite slopes cancel to NaN; the direct enclosure still holds.
        let bound = if bound.is_nan() { direct_bound } else { bound.min(direct_bound) };
        Some((bound, signed(centre_niceness).middle()))
    }
}

/// Returns the rate at which niceness changes with depth, from the midpoints of their slopes; 0 where that is
/// not finite.
fn rate(depth: &Slope, niceness: &Slope) -> f64 {
    let rate = dot_product(depth, niceness) / dot_product(depth, depth);
    if rate.is_finite() { rate } else { 0.0 }
}

fn dot_product(one: &Slope, other: &Slope) -> f64 {
    (0..3).map(|k| one.partials[k].middle() * other.partials[k].middle()).sum()
}

#[cfg(test)]
mod tests {
    use super::super::Certificate;
    use crate::compile;
    use crate::source::Source;

    /// Returns the ranges of a tool's regions, with their names.
    fn ranges(text: &str) -> Vec<(String, [f64; 2])> {
        let compiled = compile(&Source::new("a.tool", text));
        let tool = compiled.into_tool().expect("a tool");
        let facts = Certificate::prove(&tool).regions;
        let names = tool.model.regions.iter().map(|region| region.name.clone());
        names.zip(facts.iter().map(|facts| [facts.niceness.low, facts.niceness.high])).collect()
    }

    #[test]
    fn niceness_is_bounded_over_the_region_only() {
        let ball = "tool Ball { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting;
                    line to (3, 20), (0, 20) as shank; } niceness cutting: 1 - depth/3; }";
        for (name, [low, high]) in
            ranges(ball).into_iter().filter(|(name, _)| name.contains("ball"))
        {
            assert!((-1e-3..=0.0).contains(&low), "{name}: {low}");
            assert!((1.0..=1.0 + 2e-4).contains(&high), "{name}: {high}");
        }
    }

    /// A niceness that is not a function of depth: 1 at half the flute's height, 0 at its ends.
    #[test]
    fn niceness_by_height_is_bounded() {
        let mill = "tool Mill { units mm; profile { start (0, 0); line to (3, 0) as face;
                    line to (3, 20) as flute cutting; line to (0, 20) as top; }
                    niceness cutting: 1 - ((z - 10)/10)^2; }";
        let found = ranges(mill);
        let (_, [low, high]) =
            found.iter().find(|(name, _)| name.contains("flute")).expect("a flute");
        assert!((-1e-3..=1e-9).contains(low) && (1.0..=1.0 + 2e-4).contains(high), "{low} {high}");
    }
}
