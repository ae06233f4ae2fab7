//! Interval arithmetic, rounded outward (Moore, *Interval Analysis*, 1966).

use crate::interval::Interval;

pub(super) const ZERO: Interval = Interval { low: 0.0, high: 0.0 };
/// No number at all.
pub(super) const EMPTY: Interval = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
pub(super) const ENTIRE: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

impl Interval {
    pub(super) fn point(value: f64) -> Interval {
        Interval { low: value, high: value }
    }

    /// Rounds outward. Returns all numbers if an end is NaN.
    pub(super) fn outward(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return ENTIRE;
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    pub(super) fn hull(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    pub(super) fn plus(self, other: Interval) -> Interval {
        // A sum with 0 is exact.
        match (self, other) {
            (ZERO, sum) | (sum, ZERO) => sum,
            _ => Interval::outward(self.low + other.low, self.high + other.high),
        }
    }

    pub(super) fn negated(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }

    pub(super) fn times(self, other: Interval) -> Interval {
        if self == ZERO || other == ZERO {
            return ZERO;
        }
        // An infinite end bounds finite numbers, so its product with 0 is 0.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let ends = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        // A product with ±1 is exact, and many slopes are ±1.
        if [self, other].iter().any(|factor| factor.low == factor.high && factor.low.abs() == 1.0) {
            return Interval { low: ends[0].min(ends[3]), high: ends[0].max(ends[3]) };
        }
        let low = ends.into_iter().fold(f64::INFINITY, f64::min);
        Interval::outward(low, ends.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    pub(super) fn reciprocal(self) -> Interval {
        if self.low <= 0.0 && self.high >= 0.0 {
            return ENTIRE;
        }
        Interval::outward(1.0 / self.high, 1.0 / self.low)
    }

    /// Returns the square root. The argument is taken as non-negative, even if rounding made its lower end negative.
    pub(super) fn sqrt(self) -> Interval {
        let root = Interval::outward(self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt());
        Interval { low: root.low.max(0.0), ..root }
    }

    pub(super) fn min(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    pub(super) fn abs(self) -> Interval {
        match self {
            Interval { low, .. } if low >= 0.0 => self,
            Interval { high, .. } if high <= 0.0 => self.negated(),
            Interval { low, high } => Interval { low: 0.0, high: high.max(-low) },
        }
    }
}
