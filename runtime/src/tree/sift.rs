//! Which points of the leaves may be inside a tool.

use super::view::Reach;
use super::walk::{Nodes, Triple, load, seen, within};
use super::{Candidates, Sight, Tree, View, WIDTH};
use crate::tool::{Evaluators, Single, Singles};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};
use std::marker::PhantomData;

/// A part seen from a tool at a pose, leaves that the tool may reach, and room for those of their
/// points that may be inside.
pub struct Search<'a> {
    pub(crate) level: Level,
    pub(crate) tree: &'a Tree,
    pub(crate) sight: &'a Sight,
    pub(crate) view: &'a View,
    pub(crate) leaves: &'a Nodes,
    /// Whether what the part has at a point, its normal and weight, is wanted.
    pub(crate) skin: bool,
    pub(crate) candidates: &'a mut Candidates,
    /// Leaves with points that may be inside, and which of them.
    pub(crate) some_in: &'a mut Vec<(u32, u32)>,
}

/// A way to rule points out. Lanes that are NaN are no points.
pub(crate) trait Test {
    /// A bit for each lane that may be inside; `slabs` are those that reach its leaf.
    fn may_be_inside<S: Simd>(&self, simd: S, slabs: u32, p: &Triple<S>) -> u32;
}

/// By the tool's envelope.
struct ByReach<'a>(&'a Reach);

impl Test for ByReach<'_> {
    #[inline(always)]
    fn may_be_inside<S: Simd>(&self, simd: S, slabs: u32, p: &Triple<S>) -> u32 {
        within(simd, self.0, slabs, p, &[f32x16::splat(simd, 0.0); 3]).0
    }
}

/// By the tool's own test of membership, with these bounds.
pub(crate) struct ByTool<'a, T>(&'a [f32], PhantomData<T>);

impl<'a, T: Evaluators> ByTool<'a, T> {
    /// The test, if single precision is sharp enough for it.
    pub(crate) fn of(search: &Search<'a>) -> Option<ByTool<'a, T>> {
        search.sight.bounds.as_ref().map(|bounds| ByTool(bounds, PhantomData))
    }

    /// The same of one point.
    fn one_may_be_inside(&self, p: [f32; 3]) -> bool {
        T::near_lanes(p.map(Single), self.0)
    }
}

impl<T: Evaluators> Test for ByTool<'_, T> {
    #[inline(always)]
    fn may_be_inside<S: Simd>(&self, _: S, _: u32, p: &Triple<S>) -> u32 {
        let p = [Singles(p[0]), Singles(p[1]), Singles(p[2])];
        T::near_lanes(p, self.0).to_bitmask() as u32
    }
}

impl Search<'_> {
    /// Takes the points that the tool's envelope reaches.
    pub(crate) fn by_reach(&mut self) {
        let test = ByReach(&self.sight.reach);
        dispatch!(self.level, simd => self.by(simd, &test));
    }

    /// Takes the points that pass a test.
    #[inline(always)]
    pub(crate) fn by<S: Simd>(&mut self, simd: S, test: &impl Test) {
        let (tree, fits, rows) = (self.tree, self.sight.fits, self.view.rows);
        // First which leaves have some: a branch at each leaf would be mispredicted at every other.
        let mut count = 0;
        self.some_in.resize(self.leaves.len() + 1, (0, 0));
        let some_in = &mut self.some_in[..];
        for at in 0..self.leaves.len() {
            let leaf = self.leaves.get(at);
            let offset = load(simd, &tree.leaves[leaf.index as usize].offset);
            let hits = if fits {
                test.may_be_inside(simd, leaf.slabs, &seen(&offset, &rows, leaf.middle))
            } else {
                offset[0].simd_le(f32::INFINITY).to_bitmask() as u32
            };
            some_in[count] = (leaf.index, hits);
            count += usize::from(hits != 0);
        }
        self.candidates.room(count, self.skin);
        let boxes = &tree.levels[tree.levels.len() - 1];
        for (leaf, hits) in &self.some_in[..count] {
            let index = *leaf as usize;
            let (last, lane) = (&boxes[index / WIDTH].centre, index % WIDTH);
            let centre =
                [f64::from(last[0][lane]), f64::from(last[1][lane]), f64::from(last[2][lane])];
            let base = self.view.leaf_from_tip(centre);
            let offset = load(simd, &tree.leaves[index].offset);
            self.candidates.take(simd, self.view, (*leaf, base), &offset, *hits);
            if self.skin {
                self.candidates.take_skin(simd, &tree.skins[index], *hits);
            }
            self.candidates.took(hits.count_ones() as usize);
        }
    }

    /// The same, to the bit, point by point.
    pub(crate) fn one_by_one<T: Evaluators>(&mut self, test: &ByTool<T>) {
        self.candidates.room(self.leaves.len(), self.skin);
        for at in 0..self.leaves.len() {
            let leaf = self.leaves.get(at);
            let points = &self.tree.leaves[leaf.index as usize].offset;
            for lane in 0..WIDTH {
                let offset = [points[0][lane], points[1][lane], points[2][lane]];
                let turned = |axis: usize| {
                    let row = self.view.rows[axis];
                    offset[0] * row[0] + offset[1] * row[1] + offset[2] * row[2]
                };
                let p = std::array::from_fn(|axis| turned(axis) + leaf.middle[axis]);
                if test.one_may_be_inside(p) {
                    let index = leaf.index as usize * WIDTH + lane;
                    self.candidates.take_one(self.tree, self.view, index, self.skin);
                }
            }
        }
    }
}
