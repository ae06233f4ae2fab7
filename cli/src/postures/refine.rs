//! `touchoff sweep --refine`: pieces of triangles, round by round.

use super::sweep::{Count, RefinementSummary};
use crate::failure::Failure;
use crate::progress::Progress;
use std::ops::ControlFlow;
use touchoff_postures::PostureMap;
use touchoff_postures::sweep::{BATCH_TRIANGLES, PieceBatch, PostureSweep, Refiner, SweepStats};

/// The sweep whose triangles are divided, and the map of their pieces.
pub(super) struct Pieces<'a> {
    pub(super) sweep: &'a PostureSweep<'a>,
    pub(super) map: Option<&'a PostureMap>,
    pub(super) json: bool,
}

impl Pieces<'_> {
    /// Judges pieces until the refiner, which has the rows of all triangles, asks for no more.
    ///
    /// # Errors
    /// If there are too many pieces, or the map cannot be read or written.
    pub(super) fn judge(
        &self,
        refiner: &mut Refiner<'_>,
        count: &mut Count,
    ) -> Result<SweepStats, Failure> {
        let mut known = self.map.map(PostureMap::piece_rows).transpose()?.unwrap_or_default();
        let mut stats = SweepStats::default();
        loop {
            let pieces = refiner.next_pieces()?;
            if pieces.is_empty() {
                return Ok(stats);
            }
            // A batch is in the map as a whole or not at all.
            let mut open = Vec::new();
            for (index, batch) in pieces.chunks(BATCH_TRIANGLES).enumerate() {
                if batch.iter().all(|piece| known.contains_key(piece)) {
                    for (piece, row) in batch.iter().filter_map(|piece| known.remove_entry(piece)) {
                        count.add_stickout(&row);
                        refiner.add(piece, &row);
                    }
                } else {
                    open.push(index);
                }
            }
            let progress = Progress::steps(open.len(), "batches of pieces", self.json);
            let stopped = self.sweep.run_pieces(&pieces, &open, |batch: PieceBatch| {
                stats += batch.stats;
                progress.advance(1);
                if let Some(Err(error)) = self.map.map(|map| map.record_pieces(&batch.rows)) {
                    return ControlFlow::Break(error);
                }
                for (piece, row) in &batch.rows {
                    count.add_stickout(row);
                    refiner.add(*piece, row);
                }
                ControlFlow::Continue(())
            });
            drop(progress);
            if let ControlFlow::Break(error) = stopped {
                return Err(error.into());
            }
        }
    }
}

impl Count {
    /// Replaces the counts of triangles by those of their pieces.
    pub(super) fn refine(&mut self, refiner: &Refiner<'_>, finest: f64) -> RefinementSummary {
        for tool in &mut self.tools {
            (tool.triangles_reached, tool.triangles_best) = (0, 0);
        }
        let mut summary = RefinementSummary {
            finest,
            triangles_divided: 0,
            pieces: 0,
            triangles_partly_reached: 0,
        };
        for reach in refiner.reach() {
            self.reached[reach.triangle.index()] = reach.area_fraction;
            for (tool, fraction) in self.tools.iter_mut().zip(&reach.by_tool) {
                tool.triangles_reached += usize::from(*fraction > 0.0);
            }
            if let Some(best) = reach.best {
                self.tools[usize::from(best)].triangles_best += 1;
            }
            if reach.pieces > 1 {
                summary.triangles_divided += 1;
                summary.pieces += reach.pieces;
            }
            let is_partial = reach.area_fraction > 0.0 && reach.area_fraction < 1.0;
            summary.triangles_partly_reached += usize::from(is_partial);
        }
        summary
    }
}
