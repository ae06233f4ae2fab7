//! Intervals of real numbers.

use std::fmt;

/// The numbers between two ends, which are included. An answer with a proved error is an interval that contains the
/// true value.
///
/// ```
/// use touchoff::Interval;
///
/// let depth = Interval::new(0.25, 0.75);
/// assert!(depth.contains(0.5) && depth.width() == 0.5);
/// assert_eq!(depth.scaled_by(2.0).high, 1.5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// Returns the interval between two ends, of which the first is the lower one.
    pub const fn new(low: f64, high: f64) -> Interval {
        Interval { low, high }
    }

    /// Returns the width.
    pub const fn width(self) -> f64 {
        self.high - self.low
    }

    /// Returns whether a number lies between the ends or is one of them.
    pub const fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Returns the interval with both ends multiplied by a factor above 0.
    #[must_use]
    pub const fn scaled_by(self, factor: f64) -> Interval {
        Interval { low: self.low * factor, high: self.high * factor }
    }
}

impl From<Interval> for [f64; 2] {
    fn from(interval: Interval) -> [f64; 2] {
        [interval.low, interval.high]
    }
}

/// Writes `low to high`, with the precision that the format asks for.
impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.low.fmt(f)?;
        f.write_str(" to ")?;
        self.high.fmt(f)
    }
}
