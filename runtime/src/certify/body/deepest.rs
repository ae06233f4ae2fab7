//! A deep point of a tool that is known by its field alone.

use crate::certify::body::field::{Field, Scratch};
use crate::certify::space::Point;
use crate::tool::{Card, Shape};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A box of the tool's frame, and how deep a point of it is at most.
struct Cell {
    low: Point,
    high: Point,
    bound: f64,
}

impl Ord for Cell {
    fn cmp(&self, other: &Cell) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Cell) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cell {
    fn eq(&self, other: &Cell) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cell {}

/// How many points are looked at before none is said to be found.
const BUDGET: u32 = 1 << 18;

impl Field<'_> {
    /// Returns a point that is deeper than `tolerance`, no less deep than half of what the deepest is, and
    /// the surface that it is told to be nearest to; no point if it is proved that none is so deep. `None`
    /// outside if the budget was spent before either.
    ///
    /// The tool is taken to be one connected piece.
    pub(crate) fn core(&self, card: &Card, tolerance: f64) -> Option<Option<(Point, usize)>> {
        let [bottom, top] = card.reach();
        // Of a tool with an axis the half plane is enough.
        let [x, y] = match card.shape {
            Shape::Revolved => [[0.0, card.radius()], [0.0; 2]],
            Shape::Solid { across } => across,
        };
        let (low, high) = ([x[0], y[0], bottom], [x[1], y[1], top]);
        let mut scratch = Scratch::default();
        let mut cells = BinaryHeap::from([Cell { low, high, bound: f64::INFINITY }]);
        let mut best: Option<(f64, Point, usize)> = None;
        for _ in 0..BUDGET {
            let deepest = best.map_or(0.0, |(depth, ..)| depth);
            let Some(Cell { low, high, bound }) = cells.pop() else { break };
            if bound <= tolerance || (deepest > tolerance && bound <= 2.0 * deepest) {
                return Some(best.filter(|_| deepest > tolerance).map(|(_, p, k)| (p, k)));
            }
            let middle = [0, 1, 2].map(|k| f64::midpoint(low[k], high[k]));
            let wide = [0, 1, 2].map(|k| high[k] - low[k]);
            let reach = 0.5 * wide.iter().map(|side| side * side).sum::<f64>().sqrt();
            let found = self.depth(&mut scratch, middle);
            if found.value > deepest {
                best = Some((found.value, middle, found.feature));
            }
            // Outside, a point is as far from the tool as is told, and depth grows from the surface on.
            let bound = bound.min(if found.value < 0.0 {
                self.steep * (reach + found.value)
            } else {
                found.value + self.steep * reach
            });
            let longest = (0..3).fold(0, |most, k| if wide[k] > wide[most] { k } else { most });
            let (mut first, mut second) = ((low, high), (low, high));
            first.1[longest] = middle[longest];
            second.0[longest] = middle[longest];
            cells.extend([first, second].map(|(low, high)| Cell { low, high, bound }));
        }
        // A core that is not half as deep as can be is one nonetheless.
        best.filter(|(depth, ..)| *depth > tolerance).map(|(_, p, k)| Some((p, k)))
    }
}
