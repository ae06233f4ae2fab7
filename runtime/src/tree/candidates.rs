//! Points that may be inside, carried to the tool's frame.

use super::{View, WIDTH};
use crate::tool::{LANES, Points};

/// Candidates by their place in the tree, relative to the tip in the part's frame, and in the
/// tool's frame in the tool's unit.
#[derive(Default)]
pub(crate) struct Candidates {
    indices: Vec<u32>,
    /// As long as the lists of `points`.
    from_tip: [Vec<f64>; 3],
    pub(crate) points: Points,
}

impl Candidates {
    pub(crate) fn clear(&mut self) {
        self.points.clear();
    }

    /// Where the candidates are in the tree.
    pub(crate) fn indices(&self) -> &[u32] {
        &self.indices[..self.points.len()]
    }

    /// The candidates from the tip, in the part's frame; behind the last, what fills the block.
    pub(crate) fn relative(&self) -> &[Vec<f64>; 3] {
        &self.from_tip
    }

    /// Takes the points of a leaf whose bits are set: `Rᵀ (p − t)`, the difference first, in `f64`.
    /// `centre` is the leaf's, in the tree's unit; `first` the place of its first point.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        view: &View,
        first: u32,
        centre: [f64; 3],
        offset: &[[f32; WIDTH]; 3],
        hits: u32,
    ) {
        self.points.room(WIDTH);
        let room = (self.points.len() + WIDTH).next_multiple_of(LANES);
        if self.indices.len() < room {
            self.indices.resize(room, 0);
            self.from_tip.iter_mut().for_each(|list| list.resize(room, 0.0));
        }
        let (scale, tip, rows) = (view.scale, view.from_tip, view.carry);
        let base =
            [tip[0] + scale * centre[0], tip[1] + scale * centre[1], tip[2] + scale * centre[2]];
        let mut left = hits;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            let p = [
                base[0] + scale * f64::from(offset[0][lane]),
                base[1] + scale * f64::from(offset[1][lane]),
                base[2] + scale * f64::from(offset[2][lane]),
            ];
            let at = self.points.len();
            self.indices[at] = first + lane as u32;
            self.from_tip[0][at] = p[0];
            self.from_tip[1][at] = p[1];
            self.from_tip[2][at] = p[2];
            self.points.put([
                rows[0][0] * p[0] + rows[0][1] * p[1] + rows[0][2] * p[2],
                rows[1][0] * p[0] + rows[1][1] * p[1] + rows[1][2] * p[2],
                rows[2][0] * p[0] + rows[2][1] * p[1] + rows[2][2] * p[2],
            ]);
        }
    }
}
