//! What many timings come to.

use std::time::Duration;

/// Average, median, 99th percentile and longest, in nanoseconds.
pub(crate) struct Timing {
    pub(crate) avg: f64,
    pub(crate) p50: u64,
    pub(crate) p99: u64,
    pub(crate) max: u64,
}

impl Timing {
    /// Of some timings, at least one; they are sorted on the way.
    pub(crate) fn of(all: &mut [u64]) -> Timing {
        all.sort_unstable();
        let at = |part: f64| all[((all.len() - 1) as f64 * part).round() as usize];
        let sum: u64 = all.iter().sum();
        Timing { avg: sum as f64 / all.len() as f64, p50: at(0.5), p99: at(0.99), max: at(1.0) }
    }
}

/// A duration in whole nanoseconds.
pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
