//! Statistics of times.

use std::fmt;
use std::time::Duration;

/// Mean, median, 99th percentile and maximum, in nanoseconds.
pub(crate) struct Timing {
    pub(crate) mean: f64,
    pub(crate) p50: u64,
    pub(crate) p99: u64,
    pub(crate) max: u64,
}

impl Timing {
    /// Computes the statistics of times, which it sorts.
    ///
    /// # Panics
    /// Panics if there are no times.
    pub(crate) fn of(all: &mut [u64]) -> Timing {
        all.sort_unstable();
        let [p50, p99, max] = [0.5, 0.99, 1.0]
            .map(|fraction| all[((all.len() - 1) as f64 * fraction).round() as usize]);
        let sum: u64 = all.iter().sum();
        Timing { mean: sum as f64 / all.len() as f64, p50, p99, max }
    }
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [p50, p99, max] = [self.p50, self.p99, self.max].map(|ns| ns as f64 / 1e3);
        let mean = self.mean / 1e3;
        write!(f, "mean {mean:.2} µs, median {p50:.2}, p99 {p99:.2}, max {max:.2}")
    }
}

/// Returns a duration in whole nanoseconds, `u64::MAX` if it is longer.
pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
