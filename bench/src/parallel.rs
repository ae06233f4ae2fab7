//! Parallel computation of table rows.

use rayon::prelude::*;

/// Returns `row(k)` for each `k` below `count`, in order. Threads take one number at a time, since rows differ in
/// computing time.
pub fn rows<R: Send>(count: usize, row: impl Fn(usize) -> R + Sync) -> Vec<R> {
    (0..count).into_par_iter().with_max_len(1).map(&row).collect()
}
