//! Cancellation of long computations by another thread.
//!
//! A computation runs within [`Cancellation::run`]. Long loops of this library call [`check`], which unwinds the
//! computation once it is cancelled. Threads that a computation starts take its cancellation with them: [`current`] and
//! [`Cancellation::enter`].
//!
//! ```
//! use touchoff::cancellation::{Cancellation, Cancelled, check};
//!
//! let cancellation = Cancellation::new();
//! assert_eq!(cancellation.run(|| 1), Ok(1));
//! cancellation.cancel();
//! let endless = || loop {
//!     check();
//! };
//! assert_eq!(cancellation.run(endless), Err::<(), Cancelled>(Cancelled));
//! ```

use std::cell::RefCell;
use std::fmt;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    /// The cancellation of the computation that this thread works at.
    static CURRENT: RefCell<Cancellation> = const { RefCell::new(Cancellation { flag: None }) };
}

/// A flag that ends the computations that run within it. Clones share the flag.
#[derive(Clone, Default)]
pub struct Cancellation {
    /// `None` for one that nobody can cancel.
    flag: Option<Arc<AtomicBool>>,
}

/// The result of a computation that was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the computation was cancelled")]
pub struct Cancelled;

/// The payload of the unwinding.
struct Unwinding;

impl fmt::Debug for Cancellation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cancellation").field("is_cancelled", &self.is_cancelled()).finish()
    }
}

impl Cancellation {
    /// Creates a cancellation that is not cancelled yet.
    pub fn new() -> Cancellation {
        Cancellation { flag: Some(Arc::default()) }
    }

    /// Ends all computations that run within it, at their next call of [`check`].
    pub fn cancel(&self) {
        if let Some(flag) = &self.flag {
            flag.store(true, Ordering::Relaxed);
        }
    }

    /// Returns whether it is cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Runs a computation, which [`check`] ends once this is cancelled. What the computation owns is dropped then; what it has changed
    /// outside stays as it is.
    ///
    /// # Errors
    /// If the computation was ended.
    pub fn run<R>(&self, work: impl FnOnce() -> R) -> Result<R, Cancelled> {
        let entered = self.enter();
        // The caller of a computation that was ended does not see what it computed.
        let result = catch_unwind(AssertUnwindSafe(work));
        drop(entered);
        result.map_err(|payload| match payload.is::<Unwinding>() {
            true => Cancelled,
            false => resume_unwind(payload),
        })
    }

    /// Makes this the cancellation of this thread's work until the result is dropped: for threads that a computation starts.
    pub fn enter(&self) -> Entered {
        let before = CURRENT.replace(self.clone());
        Entered { before, of_thread: PhantomData }
    }
}

/// A stretch of a thread's work that may be cancelled; see [`Cancellation::enter`].
#[derive(Debug)]
#[must_use = "the cancellation holds until this is dropped"]
pub struct Entered {
    before: Cancellation,
    /// The thread that entered is the one that leaves.
    of_thread: PhantomData<*const ()>,
}

impl Drop for Entered {
    fn drop(&mut self) {
        CURRENT.set(std::mem::take(&mut self.before));
    }
}

/// Returns the cancellation of this thread's work.
pub fn current() -> Cancellation {
    CURRENT.with_borrow(Cancellation::clone)
}

/// Ends the computation of this thread if it was cancelled: unwinds to [`Cancellation::run`]. Takes some nanoseconds.
#[inline]
pub fn check() {
    if CURRENT.with_borrow(Cancellation::is_cancelled) {
        // No panic, which would be reported.
        resume_unwind(Box::new(Unwinding));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cloud, Mesh, Sampling, Unit, mesh::shapes};

    #[test]
    fn a_computation_that_nobody_cancels_goes_on() {
        check();
        current().cancel();
        check();
        assert_eq!(Cancellation::new().run(|| 7), Ok(7));
    }

    #[test]
    fn only_what_runs_within_is_ended() {
        let (outer, inner) = (Cancellation::new(), Cancellation::new());
        inner.cancel();
        let both = outer.run(|| {
            let ended = inner.run(check);
            // The outer one holds again.
            check();
            ended
        });
        assert_eq!(both, Ok(Err(Cancelled)));
        outer.cancel();
        assert_eq!(outer.run(check), Err(Cancelled));
        check();
    }

    #[test]
    fn a_panic_stays_a_panic() {
        let cancellation = Cancellation::new();
        let panicking = || {
            let _ = cancellation.run(|| std::panic::resume_unwind(Box::new("other")));
        };
        let payload = catch_unwind(AssertUnwindSafe(panicking)).expect_err("it panics");
        assert_eq!(payload.downcast_ref::<&str>(), Some(&"other"));
    }

    fn sphere() -> Mesh {
        shapes::sphere(10.0, 4, Unit::Millimetre).expect("a sphere")
    }

    /// The tasks of other threads are ended, too: each step of a part, cancelled from the beginning.
    #[test]
    fn long_computations_are_ended() {
        let mesh = sphere();
        let cloud = Cloud::sample(&mesh, Sampling::new(5_000)).expect("a cloud");
        let mut ply = String::from("ply\nformat ascii 1.0\nelement vertex 3000\n");
        for name in ["x", "y", "z", "nx", "ny", "nz"] {
            ply += &format!("property double {name}\n");
        }
        ply += "end_header\n";
        ply += &"1 2 3 0 0 1\n".repeat(3_000);
        let mut stl = Vec::new();
        mesh.write_stl(&mut stl).expect("written");
        let steps: [(&str, &(dyn Fn() + Sync)); 6] = [
            ("sampling", &|| drop(Cloud::sample(&mesh, Sampling::new(5_000)))),
            ("tree of points", &|| drop(crate::PointBvh::new(&cloud))),
            ("tree of triangles", &|| drop(crate::certify::TriangleBvh::new(&mesh))),
            ("weights", &|| drop(cloud.clone().with_voronoi_weights(&mesh))),
            ("PLY", &|| {
                drop(crate::mesh::Geometry::from_bytes(ply.as_bytes(), "a.ply", Unit::Millimetre));
            }),
            ("STL", &|| drop(crate::mesh::Geometry::from_bytes(&stl, "a.stl", Unit::Millimetre))),
        ];
        for (name, step) in steps {
            let cancellation = Cancellation::new();
            assert_eq!(cancellation.run(step), Ok(()), "{name}");
            cancellation.cancel();
            assert_eq!(cancellation.run(step), Err(Cancelled), "{name}");
        }
    }
}
