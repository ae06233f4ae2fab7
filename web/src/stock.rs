//! A stock that is cut as a program plays.

use crate::error::EngineError;
use nalgebra::Point3;
use touchoff::{Tool, Unit};
use touchoff_verify::Move;
use touchoff_verify::job::{JobError, JobStock, StockShape};
use touchoff_verify::stock::{MotionMode, Stock};

/// The number of points of a stock, about.
const POINTS: f64 = 200_000.0;

/// The lowest and the highest corner of a box of stock.
pub(crate) type Corners = [Point3<f64>; 2];

/// Returns the distance of neighbouring points.
fn spacing([low, high]: Corners) -> f64 {
    ((high - low).product() / POINTS).cbrt()
}

/// Returns the stock of a job.
pub(crate) fn of_job(corners: Corners) -> JobStock {
    JobStock { shape: StockShape::Box(corners), spacing: spacing(corners), tolerance: None }
}

/// A stock with the position of the program up to which it is cut.
#[derive(Debug)]
pub(crate) struct PlayedStock {
    stock: Stock,
    /// The position; before the first motion, which ends at 0, it is -1.
    at: f64,
}

impl PlayedStock {
    /// Makes a stock that is not cut.
    ///
    /// # Errors
    /// Fails if it cannot be made.
    pub(crate) fn new(corners: Corners, unit: Unit) -> Result<PlayedStock, EngineError> {
        let stock = Stock::from_box(corners, spacing(corners), unit).map_err(JobError::from)?;
        Ok(PlayedStock { stock, at: -1.0 })
    }

    /// Returns the position up to which it is cut.
    pub(crate) fn at(&self) -> f64 {
        self.at
    }

    /// Returns the index of the next motion that cuts it.
    pub(crate) fn next(&self) -> usize {
        (self.at.floor() + 1.0) as usize
    }

    /// Cuts it by the next motion, up to a position of the program that is not before its own.
    ///
    /// # Errors
    /// Fails if it cannot be cut.
    pub(crate) fn cut(
        &mut self,
        tool: &dyn Tool,
        step: &Move,
        position: f64,
    ) -> Result<(), EngineError> {
        let Move { path, rapid, alternative, .. } = step;
        let end = self.at.floor() + 1.0;
        let until = position.min(end);
        if *alternative {
            self.at = until;
            return Ok(());
        }
        let [from, to] = [self.at, until].map(|at| 1.0 - (end - at));
        let max_travel = path.max_speed(tool.info(), self.stock.unit()) * (to - from);
        let mode = if *rapid { MotionMode::Rapid } else { MotionMode::Feed };
        let tolerance = self.stock.step();
        let pose = |time: f64| path.pose(from + time * (to - from));
        self.stock.advance(tool, &pose, max_travel, mode, tolerance).map_err(JobError::from)?;
        self.at = until;
        Ok(())
    }

    /// Returns the number of points that remain.
    pub(crate) fn points(&self) -> usize {
        self.stock.len()
    }

    /// Returns the corners of the triangles of what remains, 9 values per triangle; none if nothing does.
    pub(crate) fn positions(&self) -> Vec<f32> {
        self.stock.remaining_mesh().as_ref().map(crate::part::positions).unwrap_or_default()
    }
}
