//! Work on all cores with the feature `parallel`, on one core without it. The results are the same.

use std::ops::Range;

/// Applies `make` to consecutive ranges of `0..count` of `together` indices each, and returns the
/// results in order.
pub(crate) fn ranges<R: Send>(
    count: usize,
    together: usize,
    make: impl Fn(Range<usize>) -> R + Sync,
) -> Vec<R> {
    let range = |k: usize| k * together..((k + 1) * together).min(count);
    let pieces = count.div_ceil(together);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..pieces).into_par_iter().map(|k| make(range(k))).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..pieces).map(|k| make(range(k))).collect()
    }
}

/// Sorts unstably; equal items must be indistinguishable.
pub(crate) fn sort<T: Ord + Send>(list: &mut [T]) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        list.par_sort_unstable();
    }
    #[cfg(not(feature = "parallel"))]
    {
        list.sort_unstable();
    }
}

/// Runs both functions, in parallel if possible, and returns their results.
pub(crate) fn both<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    {
        rayon::join(one, other)
    }
    #[cfg(not(feature = "parallel"))]
    {
        (one(), other())
    }
}
