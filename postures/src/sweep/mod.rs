//! Automatic search for postures at every triangle, with every tool and direction.
//!
//! A tool is placed so that one of its cutting surfaces touches the triangle's centroid, with its axis in one
//! of the directions. Either the certifier proves that this is acceptable, or a point of the part is shown to
//! be in the way. Some postures need no search: directions that no cutting surface faces, contacts that are not
//! nice enough, and above all obstructions known from a neighbour. A point that was in the way of the
//! neighbouring triangle, in the same direction, is usually in the way of this one. Testing that point costs
//! one evaluation.
//!
//! One point says little about a large triangle. A [`Refiner`] divides triangles where it matters, and
//! [`PostureSweep::run_pieces`] judges the pieces as if they were triangles.

mod refine;
mod worker;

pub use refine::{Refinement, Refiner, TriangleReach};

use super::{Directions, MapRow, Piece, Rules, RulesError, ValidatorError};
use std::fmt;
use std::num::{NonZeroU16, NonZeroUsize};
use std::ops::{AddAssign, ControlFlow};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use touchoff::cancellation;
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Tool, TriangleId};
use worker::Worker;

/// Number of neighbouring triangles, or pieces of them, in a batch of rows.
pub const BATCH_TRIANGLES: usize = 256;

/// A part, and tools to try at all of its triangles.
pub struct PostureSweep<'a> {
    mesh: &'a Mesh,
    bvh: &'a TriangleBvh,
    tools: Vec<&'a dyn Tool>,
    directions: &'a Directions,
    rules: Rules,
    keep: NonZeroU16,
    threads: NonZeroUsize,
}

impl fmt::Debug for PostureSweep<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PostureSweep")
            .field("tools", &self.tools.len())
            .field("rules", &self.rules)
            .field("keep", &self.keep)
            .finish_non_exhaustive()
    }
}

/// A reason for which a sweep cannot run.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A tool has no cutting surface.
    #[error("nothing of {0} cuts: write `cutting` behind the surface in its file")]
    NoCuttingSurface(String),
    /// The rules are invalid.
    #[error(transparent)]
    Rules(#[from] RulesError),
    /// A tool's postures cannot be validated.
    #[error(transparent)]
    Validator(#[from] ValidatorError),
    /// The size of pieces is not a finite length above 0.
    #[error("pieces of triangles cannot have edges of {0}: give a finite length above 0")]
    PieceSize(f64),
    /// The triangles would be divided into too many pieces.
    #[error(
        "pieces with edges down to {finest} are more than {limit}: refine down to a larger length"
    )]
    TooManyPieces {
        /// The length of edges down to which pieces are divided.
        finest: f64,
        /// The largest number of pieces.
        limit: usize,
    },
}

touchoff::debug_as_sentence!(SweepError);

/// Number of postures by the rule that decided them. A posture is a triangle, a tool and a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SweepStats {
    /// Pairs of a tool and a triangle, or a piece of one, that were processed.
    pub triangles: u64,
    /// Postures in which no cutting surface faces the triangle: the tool would be on its other side, or would
    /// touch it with a surface that does not cut.
    pub not_facing: u64,
    /// Postures whose contact is not nice enough.
    pub below_niceness: u64,
    /// Postures obstructed by a point of the part that was in the way of a neighbouring posture in the same
    /// direction.
    pub cached_obstruction: u64,
    /// Postures for which a search of the part's tree found an obstruction.
    pub obstructed: u64,
    /// Postures so close to a limit that rounding decides; they count as not acceptable.
    pub undecided: u64,
    /// Postures that are proved acceptable.
    pub acceptable: u64,
}

/// The rule that decided a posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PostureDecision {
    BelowNiceness,
    CachedObstruction,
    Obstructed,
    Undecided,
    Acceptable,
}

impl SweepStats {
    fn count_of(&mut self, decision: PostureDecision) -> &mut u64 {
        match decision {
            PostureDecision::BelowNiceness => &mut self.below_niceness,
            PostureDecision::CachedObstruction => &mut self.cached_obstruction,
            PostureDecision::Obstructed => &mut self.obstructed,
            PostureDecision::Undecided => &mut self.undecided,
            PostureDecision::Acceptable => &mut self.acceptable,
        }
    }

    /// Returns the number of all postures.
    pub fn postures(&self) -> u64 {
        self.not_facing + self.below_niceness + self.searched() + self.cached_obstruction
    }

    /// Returns the number of postures for which the part's tree was searched.
    pub fn searched(&self) -> u64 {
        self.obstructed + self.undecided + self.acceptable
    }
}

impl AddAssign for SweepStats {
    fn add_assign(&mut self, other: SweepStats) {
        self.triangles += other.triangles;
        self.not_facing += other.not_facing;
        self.below_niceness += other.below_niceness;
        self.cached_obstruction += other.cached_obstruction;
        self.obstructed += other.obstructed;
        self.undecided += other.undecided;
        self.acceptable += other.acceptable;
    }
}

/// Rows of neighbouring triangles, with counters.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Batch {
    /// The rows, each with the id of its triangle.
    pub rows: Vec<(TriangleId, MapRow)>,
    /// Counters of the rules that decided the postures of the batch.
    pub stats: SweepStats,
}

/// Rows of neighbouring pieces of triangles, with counters.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PieceBatch {
    /// The rows, each with its piece.
    pub rows: Vec<(Piece, MapRow)>,
    /// Counters of the rules that decided the postures of the batch.
    pub stats: SweepStats,
}

impl<'a> PostureSweep<'a> {
    /// Creates a sweep over a mesh and its triangles that keeps the best `keep` postures per triangle.
    ///
    /// # Errors
    /// If the rules are invalid, or a tool cannot be used; see [`SweepError`].
    pub fn new(
        mesh: &'a Mesh,
        bvh: &'a TriangleBvh,
        tools: Vec<&'a dyn Tool>,
        directions: &'a Directions,
        rules: Rules,
        keep: NonZeroU16,
    ) -> Result<PostureSweep<'a>, SweepError> {
        rules.check(&tools)?;
        let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let sweep = PostureSweep { mesh, bvh, tools, directions, rules, keep, threads };
        for tool in &sweep.tools {
            if !tool.info().surfaces.iter().any(|surface| surface.cutting) {
                return Err(SweepError::NoCuttingSurface(tool.info().name.to_string()));
            }
        }
        // Report here the errors that workers would meet in their threads.
        Worker::new(&sweep)?;
        Ok(sweep)
    }

    /// Sets the number of threads, in place of one per core.
    #[must_use]
    pub fn with_threads(mut self, threads: NonZeroUsize) -> PostureSweep<'a> {
        self.threads = threads;
        self
    }

    /// Returns the number of batches.
    pub fn batches(&self) -> usize {
        self.bvh.len().div_ceil(BATCH_TRIANGLES)
    }

    /// Returns the ids of the triangles in a batch.
    pub fn triangles(&self, batch: usize) -> &[TriangleId] {
        let ids = self.bvh.triangle_ids();
        &ids[batch * BATCH_TRIANGLES..((batch + 1) * BATCH_TRIANGLES).min(ids.len())]
    }

    /// Processes the given batches on all cores, or on the threads of [`PostureSweep::with_threads`], and passes each to `each` as it
    /// is done, in no particular order, until all are done, `each` breaks, or the computation is [cancelled](touchoff::cancellation). The
    /// content of a batch depends neither on the thread nor on the time.
    pub fn run<B>(
        &self,
        batches: &[usize],
        each: impl FnMut(Batch) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        self.parallel(
            batches,
            |worker, batch| {
                let triangles = self.triangles(batch);
                let (rows, stats) = worker.rows(triangles.iter().map(|id| Piece::whole(*id)));
                Batch { rows: triangles.iter().copied().zip(rows).collect(), stats }
            },
            each,
        )
    }

    /// Judges pieces of triangles at their centroids, on all cores, in batches of [`BATCH_TRIANGLES`]. `batches`
    /// has the indices of those to process; for the rest see [`PostureSweep::run`].
    pub fn run_pieces<B>(
        &self,
        pieces: &[Piece],
        batches: &[usize],
        each: impl FnMut(PieceBatch) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        self.parallel(
            batches,
            |worker, batch| {
                let pieces = pieces.chunks(BATCH_TRIANGLES).nth(batch).unwrap_or_default();
                let (rows, stats) = worker.rows(pieces.iter().copied());
                PieceBatch { rows: pieces.iter().copied().zip(rows).collect(), stats }
            },
            each,
        )
    }

    fn parallel<T: Send, B>(
        &self,
        batches: &[usize],
        judge: impl Fn(&mut Worker<'_>, usize) -> T + Sync,
        mut each: impl FnMut(T) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let workers = self.threads.get();
        let current = cancellation::current();
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        std::thread::scope(|scope| {
            // Bounded, so that workers wait for an `each` that is slower than they are, and rows do not pile up in memory.
            let (done, batch) = mpsc::sync_channel(2 * workers);
            for _ in 0..workers.min(batches.len()) {
                let (done, next, stop, judge) = (done.clone(), &next, &stop, &judge);
                let current = &current;
                scope.spawn(move || {
                    // `new` has reported the errors.
                    let Ok(mut worker) = Worker::new(self) else { return };
                    while !stop.load(Ordering::Relaxed)
                        && let Some(index) = batches.get(next.fetch_add(1, Ordering::Relaxed))
                    {
                        // A thread whose work is cancelled ends in order: the caller's thread unwinds.
                        let Ok(batch) = current.run(|| judge(&mut worker, *index)) else { return };
                        if done.send(batch).is_err() {
                            return;
                        }
                    }
                });
            }
            // Only the workers' senders are left, so the channel closes when the last of them is done.
            drop(done);
            while let Ok(batch) = batch.recv() {
                let flow = each(batch);
                if flow.is_break() {
                    stop.store(true, Ordering::Relaxed);
                    return flow;
                }
            }
            // The channel also closes when all workers were cancelled.
            cancellation::check();
            ControlFlow::Continue(())
        })
    }
}
