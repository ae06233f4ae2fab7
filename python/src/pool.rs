//! Work on all cores, without the interpreter's lock, that a signal can interrupt.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// The threads, and the process that started them.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Poses between two looks at signals: some milliseconds of work. A multiple of the stretch after which certifiers begin
/// anew, so that results do not depend on it.
const POSES_PER_LOOK: usize = 1 << 14;

/// Runs a function whose parallel parts use the threads of this process.
///
/// A process that was forked has none of its parent's threads, so it starts its own.
///
/// # Errors
/// `RuntimeError` if no threads can be started.
pub(crate) fn on_all_cores<R: Send>(run: impl FnOnce() -> R + Send) -> PyResult<R> {
    let process = std::process::id();
    let pool = {
        let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        match &*pool {
            Some((owner, threads)) if *owner == process => Arc::clone(threads),
            _ => {
                // The parent's pool cannot be joined from here.
                std::mem::forget(pool.take());
                let threads = ThreadPoolBuilder::new().build();
                let threads = threads.map_err(|error| {
                    PyRuntimeError::new_err(format!("no threads can be started: {error}"))
                })?;
                let threads = Arc::new(threads);
                *pool = Some((process, Arc::clone(&threads)));
                threads
            }
        }
    };
    Ok(pool.install(run))
}

/// Runs a query on stretches of a list, passes the results of each to `take`, and looks at signals in between.
///
/// # Errors
/// That of a handler of signals, such as `KeyboardInterrupt`.
pub(crate) fn interruptible<I: Sync, R: Send>(
    py: Python<'_>,
    items: &[I],
    query: impl Fn(&[I]) -> Vec<R> + Sync,
    mut take: impl FnMut(Vec<R>),
) -> PyResult<()> {
    for stretch in items.chunks(POSES_PER_LOOK) {
        take(py.detach(|| on_all_cores(|| query(stretch)))?);
        py.check_signals()?;
    }
    Ok(())
}
