//! Points that may be inside, carried to the tool's frame.

use super::{View, WIDTH};
use crate::tool::{LANES, Points};

/// Candidates by their place in the tree, and in the tool's frame in the tool's unit.
#[derive(Default)]
pub(crate) struct Candidates {
    indices: Vec<u32>,
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
        }
        let (scale, base, rows) = (view.scale, view.leaf_from_tip(centre), view.carry);
        // All lanes together, in the order of operations that one alone would take.
        let mut p = [[0.0; WIDTH]; 3];
        for (axis, list) in p.iter_mut().enumerate() {
            for (value, offset) in list.iter_mut().zip(&offset[axis]) {
                *value = base[axis] + scale * f64::from(*offset);
            }
        }
        let mut carried = [[0.0; WIDTH]; 3];
        for (row, list) in rows.iter().zip(&mut carried) {
            for (lane, value) in list.iter_mut().enumerate() {
                *value = row[0] * p[0][lane] + row[1] * p[1][lane] + row[2] * p[2][lane];
            }
        }
        let at = self.points.len();
        let indices = &mut self.indices[at..at + WIDTH];
        let points = self.points.next(WIDTH);
        let (mut left, mut count) = (hits, 0);
        while left != 0 {
            let lane = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            let to = count % WIDTH;
            indices[to] = first + lane as u32;
            for axis in 0..3 {
                points[axis][to] = carried[axis][lane];
            }
            count += 1;
        }
        self.points.took(count);
    }
}
