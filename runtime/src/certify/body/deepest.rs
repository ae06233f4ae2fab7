//! The deepest point of a tool that is known by its field alone.

use crate::certify::body::field::{Field, Scratch};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::Depth;
use crate::certify::space::Point;
use crate::tool::Shape;
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
    /// Returns the deepest point of owners that is deeper than `least`, but for a factor that is more than 1, and how
    /// deep it is; no point if it is proved that none is so deep. `None` outside if the budget was spent before
    /// either.
    pub(crate) fn deepest(
        &self,
        owners: &Owners,
        least: f64,
        factor: f64,
    ) -> Option<Option<(Point, Depth)>> {
        let card = self.card();
        let [bottom, top] = card.reach();
        // Of a tool with an axis the half plane is enough.
        let [x, y] = match card.shape {
            Shape::Revolved => [[0.0, card.radius()], [0.0; 2]],
            Shape::Solid { across } => across,
        };
        let (low, high) = ([x[0], y[0], bottom], [x[1], y[1], top]);
        let mut scratch = Scratch::default();
        let mut cells = BinaryHeap::from([Cell { low, high, bound: f64::INFINITY }]);
        let mut best: Option<(Point, Depth)> = None;
        for _ in 0..BUDGET {
            let deepest = best.map_or(0.0, |(_, depth)| depth.value);
            let Some(Cell { low, high, bound }) = cells.pop() else { break };
            if bound <= least || (deepest > least && bound <= factor * deepest) {
                return Some(best.filter(|_| deepest > least));
            }
            let middle = [0, 1, 2].map(|k| f64::midpoint(low[k], high[k]));
            let wide = [0, 1, 2].map(|k| high[k] - low[k]);
            let reach = 0.5 * wide.iter().map(|side| side * side).sum::<f64>().sqrt();
            let depth = self.depth(&mut scratch, middle);
            if depth.value > deepest
                && let Some(depth) = self.owned(&mut scratch, owners, middle, depth)
            {
                best = Some((middle, depth));
            }
            if self.passes(&mut scratch, owners, middle, (reach, least)) {
                continue;
            }
            // Outside, a point is as far from the tool as is told, and depth grows from the surface on.
            let bound = bound.min(depth.value + self.steep * reach);
            let longest = (0..3).fold(0, |most, k| if wide[k] > wide[most] { k } else { most });
            let (mut first, mut second) = ((low, high), (low, high));
            first.1[longest] = middle[longest];
            second.0[longest] = middle[longest];
            cells.extend([first, second].map(|(low, high)| Cell { low, high, bound }));
        }
        // A point that may not be nearly the deepest is one nonetheless.
        best.filter(|(_, depth)| depth.value > least).map(Some)
    }
}
