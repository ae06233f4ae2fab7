//! Points that may be inside, carried to the tool's frame.

use crate::pose::Pose;
use crate::tool::{LANES, Points};
use crate::tree::{Tree, WIDTH};

/// Candidates by their place in the tree, relative to the tip in the part's frame, and in the
/// tool's frame in the tool's unit.
#[derive(Default)]
pub(super) struct Candidates {
    pub(super) indices: Vec<u32>,
    /// Padded like [`Points`].
    pub(super) from_tip: [Vec<f64>; 3],
    pub(super) points: Points,
}

impl Candidates {
    pub(super) fn clear(&mut self) {
        self.indices.clear();
        self.from_tip.iter_mut().for_each(Vec::clear);
        self.points.clear();
    }

    /// Carries the points of `indices` to the tool: `Rᵀ (p − t)`, the difference first, in `f64`.
    pub(super) fn carry(&mut self, tree: &Tree, pose: &Pose, length: f64) {
        let rotation = pose.rotation();
        let tip = tree.origin - pose.tip();
        // The change of unit, once for the query.
        let rows: [[f64; 3]; 3] =
            std::array::from_fn(|axis| std::array::from_fn(|k| rotation[(k, axis)] / length));
        for index in &self.indices {
            let (leaf, lane) = (*index as usize / WIDTH, *index as usize % WIDTH);
            let centre = tree.centre(leaf);
            let offset = &tree.leaves[leaf].offset;
            let p: [f64; 3] = std::array::from_fn(|axis| {
                (tip[axis] + centre[axis]) + tree.scale * f64::from(offset[axis][lane])
            });
            for (list, value) in self.from_tip.iter_mut().zip(p) {
                list.push(value);
            }
            self.points.push(rows.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2]));
        }
        self.points.pad();
        let padded = self.indices.len().next_multiple_of(LANES);
        self.from_tip.iter_mut().for_each(|list| list.resize(padded, 0.0));
    }
}
