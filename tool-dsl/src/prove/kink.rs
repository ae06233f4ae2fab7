//! Slopes on the two sides of a border.

use super::slope::Slope;
use crate::expr::interval::{Interval, ZERO};

/// What of a slope is rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// The angle between two unit vectors, in radians.
pub(super) fn angle(a: [Interval; 3], b: [Interval; 3]) -> Interval {
    let product = (0..3).fold(ZERO, |sum, k| sum.plus(a[k].times(b[k])));
    let [low, high] = [product.high, product.low].map(|cos| cos.clamp(-1.0, 1.0).acos());
    // acos is known to a few units of the last place.
    Interval { low: (low - 1e-15).max(0.0), high: high + 1e-15 }
}

/// How steeply depth falls at least toward one of the sides of a border on which two depths agree, and
/// how well that is known.
///
/// Where each is the smaller on its own side, both ways lead down. Else depth falls along every
/// combination of the two slopes, and so by the shortest of them at least (Clarke 1983).
pub(super) fn across(own: Slope, other: Slope, curve: Slope, below: bool) -> (f64, f64) {
    let rises =
        [0, 1, 2].map(|k| own.parts[k].plus(other.parts[k].negated()).times(curve.parts[k]));
    let rise = rises.into_iter().fold(ZERO, Interval::plus);
    let combined = [0, 1, 2].map(|k| [own.parts[k].middle(), other.parts[k].middle()]);
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
