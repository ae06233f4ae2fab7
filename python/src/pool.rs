//! Work on all cores, without the interpreter's lock, that a signal ends.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::resume_unwind;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use touchoff::cancellation::Cancellation;

/// The threads, and the process that started them. It is locked only while the interpreter's lock is held, so that no process is
/// forked meanwhile.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Time between two looks at signals.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// Stack of a thread, in bytes: that of a program's first thread.
const STACK_SIZE: usize = 8 << 20;

/// Poses whose results are in memory at a time. A multiple of the stretch after which certifiers begin anew, so that results do not
/// depend on it.
const POSES_PER_STRETCH: usize = 1 << 14;

/// Returns the threads of this process. A process that was forked has none of its parent's threads, so it starts its own.
///
/// # Errors
/// `RuntimeError` if no threads can be started.
fn pool(_: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((owner, threads)) = &*pool
        && *owner == process
    {
        return Ok(Arc::clone(threads));
    }
    // The parent's pool cannot be joined from here.
    std::mem::forget(pool.take());
    let threads = ThreadPoolBuilder::new().stack_size(STACK_SIZE).build().map_err(no_threads)?;
    let threads = Arc::new(threads);
    *pool = Some((process, Arc::clone(&threads)));
    Ok(threads)
}

fn no_threads(error: impl std::fmt::Display) -> PyErr {
    PyRuntimeError::new_err(format!("no threads can be started: {error}"))
}

/// Runs a function on the threads of this process, also its parallel parts. All work of the library runs so: what it does on other
/// threads would use threads that a forked process does not have.
///
/// # Errors
/// That of a handler of signals, such as `KeyboardInterrupt`, which ends the function at its next
/// [`check`](touchoff::cancellation::check); `RuntimeError` if no threads can be started.
pub(crate) fn on_all_cores<R: Send>(py: Python<'_>, run: impl FnOnce() -> R + Send) -> PyResult<R> {
    let pool = pool(py)?;
    let cancellation = Cancellation::new();
    let result = py.detach(|| {
        pool.in_place_scope(|scope| {
            let (sender, receiver) = mpsc::sync_channel(1);
            let within = &cancellation;
            // The receiver waits until there is a result.
            scope.spawn(move |_| drop(sender.send(within.run(run))));
            receive(&receiver, || cancellation.cancel())
        })
    });
    match result {
        // A signal that came last is not lost.
        Some(Ok(Ok(result))) => py.check_signals().map(|()| result),
        Some(Err(interrupt)) => Err(interrupt),
        // Only an interrupt cancels, and a panic has unwound before.
        Some(Ok(Err(cancelled))) => Err(PyRuntimeError::new_err(cancelled.to_string())),
        None => Err(PyRuntimeError::new_err("the work ended without a result")),
    }
}

/// Runs a function that cannot be ended, in a thread of its own. A signal leaves it to itself.
///
/// # Errors
/// That of a handler of signals, such as `KeyboardInterrupt`; `RuntimeError` if no thread can be started.
pub(crate) fn in_own_thread<R: Send + 'static>(
    py: Python<'_>,
    run: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    let (sender, receiver) = mpsc::sync_channel(1);
    let thread = std::thread::Builder::new().stack_size(STACK_SIZE);
    let thread = thread.spawn(move || drop(sender.send(run()))).map_err(no_threads)?;
    // The receiver goes along, since threads cannot share it.
    let result = py.detach(move || receive(&receiver, || ()));
    match result {
        Some(result) => result.and_then(|result| py.check_signals().map(|()| result)),
        None => match thread.join() {
            Ok(()) => Err(PyRuntimeError::new_err("the work ended without a result")),
            Err(panic) => resume_unwind(panic),
        },
    }
}

/// Waits for a result while looking at signals, and calls `end` when one is to end the work. Returns `None` if there will be no
/// result, because of a panic.
fn receive<R>(receiver: &Receiver<R>, end: impl FnOnce()) -> Option<PyResult<R>> {
    loop {
        match receiver.recv_timeout(SIGNAL_INTERVAL) {
            Ok(result) => return Some(Ok(result)),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) => {
                if let Err(interrupt) = Python::attach(|py| py.check_signals()) {
                    end();
                    return Some(Err(interrupt));
                }
            }
        }
    }
}

/// Runs a query on stretches of a list, and passes the results of each to `take`.
///
/// # Errors
/// That of [`on_all_cores`].
pub(crate) fn in_stretches<I: Sync, R: Send>(
    py: Python<'_>,
    items: &[I],
    query: impl Fn(&[I]) -> Vec<R> + Sync,
    mut take: impl FnMut(Vec<R>),
) -> PyResult<()> {
    for stretch in items.chunks(POSES_PER_STRETCH) {
        take(on_all_cores(py, || query(stretch))?);
    }
    Ok(())
}
