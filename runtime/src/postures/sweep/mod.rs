//! Postures without a hand: every triangle, tool and direction.
//!
//! A tool stands at a triangle so that a surface of it that cuts touches the triangle's middle, its axis in
//! one of the directions. Whether that is acceptable is proved by the certifier, or something of the part is
//! shown to be in the way. What is skipped: directions that nothing that cuts faces, contacts that are not
//! nice enough, and first of all what a neighbour knows: a place that was in the way of the triangle beside, of
//! the same direction, is most often in the way of this one, which takes one look instead of a search.

mod tally;
mod worker;

pub use tally::Tally;

use super::{Directions, JudgeError, Row, Rules, RulesError};
use crate::certify::Facets;
use crate::mesh::Mesh;
use crate::tool::Tool;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use worker::Worker;

/// Triangles that are done together, neighbours: a batch of rows.
pub const BATCH: usize = 256;

/// A part and tools that are to be tried at all of its triangles.
pub struct Sweep<'a> {
    mesh: &'a Mesh,
    facets: &'a Facets,
    tools: Vec<&'a dyn Tool>,
    directions: &'a Directions,
    rules: Rules,
    keep: NonZeroU16,
}

/// Why a sweep cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SweepError {
    /// A tool has no surface that cuts.
    #[error("nothing of {0} cuts: write `cutting` behind the surface in its file")]
    Blunt(String),
    /// The rules mean nothing.
    #[error(transparent)]
    Rules(#[from] RulesError),
    /// Nothing of a tool can be held to them.
    #[error(transparent)]
    Judge(#[from] JudgeError),
}

/// Rows of neighbours, by the ids of their triangles, and what they took.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The rows.
    pub rows: Vec<(u32, Row)>,
    /// How the postures of the batch were decided.
    pub tally: Tally,
}

impl<'a> Sweep<'a> {
    /// A sweep of a mesh and its triangles, keeping so many of the best postures of each.
    ///
    /// # Errors
    /// If the rules or the tools mean nothing; see [`SweepError`].
    pub fn new(
        (mesh, facets): (&'a Mesh, &'a Facets),
        tools: Vec<&'a dyn Tool>,
        directions: &'a Directions,
        rules: Rules,
        keep: NonZeroU16,
    ) -> Result<Sweep<'a>, SweepError> {
        rules.check(&tools)?;
        let sweep = Sweep { mesh, facets, tools, directions, rules, keep };
        for tool in &sweep.tools {
            if !tool.card().surfaces.iter().any(|surface| surface.cutting) {
                return Err(SweepError::Blunt(tool.card().name.to_string()));
            }
        }
        // What a worker would be refused is refused here.
        Worker::new(&sweep)?;
        Ok(sweep)
    }

    /// How many batches there are.
    pub fn batches(&self) -> usize {
        self.facets.ids.len().div_ceil(BATCH)
    }

    /// The triangles of a batch, by their ids.
    pub fn triangles(&self, batch: usize) -> &[u32] {
        let ids = &self.facets.ids;
        &ids[batch * BATCH..((batch + 1) * BATCH).min(ids.len())]
    }

    /// Does those batches on all cores, and hands over each as it is done, in no order, until all are or it
    /// is told to stop. A batch is the same whoever does it, and whenever.
    pub fn run<B>(
        &self,
        batches: &[usize],
        mut each: impl FnMut(Batch) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        std::thread::scope(|scope| {
            let (done, batch) = mpsc::sync_channel(2 * workers);
            for _ in 0..workers.min(batches.len()) {
                let (done, next, stop) = (done.clone(), &next, &stop);
                scope.spawn(move || {
                    let Ok(mut worker) = Worker::new(self) else { return };
                    while !stop.load(Ordering::Relaxed)
                        && let Some(index) = batches.get(next.fetch_add(1, Ordering::Relaxed))
                    {
                        if done.send(worker.batch(self.triangles(*index))).is_err() {
                            return;
                        }
                    }
                });
            }
            drop(done);
            while let Ok(batch) = batch.recv() {
                let goes_on = each(batch);
                if goes_on.is_break() {
                    stop.store(true, Ordering::Relaxed);
                    return goes_on;
                }
            }
            ControlFlow::Continue(())
        })
    }
}
