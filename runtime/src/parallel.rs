//! Work on all cores with the feature `parallel`, on one core without it. The results are the same. Tasks end when the
//! computation that they belong to is cancelled.

use crate::cancellation;
use std::ops::Range;

/// Splits `0..count` into consecutive ranges of `chunk_size` indices, applies `map` to each, and returns
/// the results in order.
pub(crate) fn ranges<R: Send>(
    count: usize,
    chunk_size: usize,
    map: impl Fn(Range<usize>) -> R + Sync,
) -> Vec<R> {
    let range = |k: usize| {
        cancellation::check();
        k * chunk_size..((k + 1) * chunk_size).min(count)
    };
    let chunks = count.div_ceil(chunk_size);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        let current = cancellation::current();
        let chunks = (0..chunks).into_par_iter();
        chunks.map_init(|| current.enter(), |_, k| map(range(k))).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..chunks).map(|k| map(range(k))).collect()
    }
}

/// Applies `map` to each index below `count`, in tasks of many, and returns the results in order.
pub(crate) fn each<R: Send>(count: usize, map: impl Fn(usize) -> R + Send + Sync) -> Vec<R> {
    let map = |index: usize| {
        cancellation::check();
        map(index)
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        let current = cancellation::current();
        let indices = (0..count).into_par_iter().with_min_len(64);
        indices.map_init(|| current.enter(), |_, index| map(index)).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(map).collect()
    }
}

/// Applies `map` to each item, in their order, in stretches of `size`, each with a worker that `worker` makes for some of them.
#[cfg(feature = "parallel")]
pub(crate) fn stretches<I: Sync, W, R: Send>(
    items: &[I],
    size: usize,
    worker: impl Fn() -> W + Send + Sync,
    map: impl Fn(&mut W, &[I]) -> Vec<R> + Send + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    let current = cancellation::current();
    let stretches = items.par_chunks(size);
    let worker = || (current.enter(), worker());
    stretches.map_init(worker, |(_, worker), items| map(worker, items)).flatten_iter().collect()
}

/// Sorts unstably; equal items must be indistinguishable.
pub(crate) fn sort<T: Ord + Send>(list: &mut [T]) {
    cancellation::check();
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
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    cancellation::check();
    #[cfg(feature = "parallel")]
    {
        let current = cancellation::current();
        let entered = || {
            let entered = current.enter();
            cancellation::check();
            entered
        };
        let first = || {
            let _entered = entered();
            first()
        };
        let second = || {
            let _entered = entered();
            second()
        };
        rayon::join(first, second)
    }
    #[cfg(not(feature = "parallel"))]
    {
        (first(), second())
    }
}
