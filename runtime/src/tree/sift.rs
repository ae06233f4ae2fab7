//! Which points of the leaves may be inside a tool.

use super::candidates::Carried;
use super::walk::{Nodes, Seen, Walker, within};
use super::{Candidates, Leaf, Skin, Tree};
use crate::bvh::{Rough, Sixteen, Triple, WIDTH, load, seen};
use crate::tool::reserve;
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};

/// The search for the points of a part that may be inside a tool, with its memory kept between queries.
#[derive(Default)]
pub(crate) struct Search<R = f32, N = f64> {
    walker: Walker<R>,
    /// Leaves with points that may be inside, and a bit for each of these.
    some: Vec<(u32, u32)>,
    pub(crate) candidates: Candidates<N>,
}

impl<R: Rough, N: Carried> Search<R, N> {
    /// Reserves memory for all points of a part as candidates. `skin` as in [`Search::all`].
    pub(crate) fn reserve(&mut self, tree: &Tree, skin: bool) {
        let leaves = tree.leaves.len();
        self.walker.reserve(tree);
        reserve(&mut self.some, leaves + 1);
        self.candidates.reserve((leaves + 1) * WIDTH, skin);
    }

    /// Finds the candidates of a part. `skin` says whether what it has there, normals and weights, is
    /// wanted.
    pub(crate) fn all(&mut self, level: Level, seen: Seen<'_, R>, skin: bool) {
        self.within(level, seen, usize::MAX);
        self.found(level, seen, skin);
    }

    /// Finds the leaves of a part that the tool may reach, looking at so many nodes and leaves at most;
    /// how many it were.
    pub(crate) fn within(&mut self, level: Level, seen: Seen<'_, R>, most: usize) -> Option<usize> {
        self.walker.leaves(level, seen, most)
    }

    /// Finds the candidates of the leaves that were found last.
    pub(crate) fn found(&mut self, level: Level, seen: Seen<'_, R>, skin: bool) {
        self.candidates.clear();
        let Search { walker, some, candidates } = self;
        sift(level, some, seen, (walker.found(), skin), candidates);
    }

    /// Finds the nodes above the leaves that the tool may reach; how many there are.
    pub(crate) fn nodes(&mut self, level: Level, seen: Seen<'_, R>) -> usize {
        self.walker.nodes(level, seen)
    }

    /// Finds the candidates under one of them.
    pub(crate) fn under(&mut self, level: Level, seen: Seen<'_, R>, node: usize) {
        self.walker.under(level, seen, node);
        self.found(level, seen, false);
    }

    /// Finds the candidates of one leaf.
    pub(crate) fn leaf(&mut self, level: Level, seen: Seen<'_, R>, leaf: u32) {
        self.walker.only(leaf, seen);
        self.found(level, seen, false);
    }
}

/// Takes the points of some leaves that the tool's envelope reaches.
fn sift<R: Rough, N: Carried>(
    level: Level,
    some: &mut Vec<(u32, u32)>,
    seen: Seen<'_, R>,
    leaves: (&Nodes<R>, bool),
    candidates: &mut Candidates<N>,
) {
    dispatch!(level, simd => sift_on(simd, some, seen, leaves, candidates));
}

#[inline(always)]
fn sift_on<R: Rough, N: Carried, S: Simd>(
    simd: S,
    some: &mut Vec<(u32, u32)>,
    (tree, sight, view): Seen<'_, R>,
    (leaves, skin): (&Nodes<R>, bool),
    candidates: &mut Candidates<N>,
) {
    let (offsets, skins): (&[Leaf], &[Skin]) = (&tree.leaves, &tree.skins);
    some.resize(leaves.len() + 1, (0, 0));
    let point: Triple<S, R> = [Sixteen::zero(simd); 3];
    // First which leaves have some: a branch at each leaf would be mispredicted at every other.
    let mut count = 0;
    for at in 0..leaves.len() {
        let leaf = leaves.get(at);
        let offset = &offsets[leaf.index as usize].offset;
        let hits = if sight.fits {
            let p = seen::<R, S>(&load::<R, S>(simd, offset), &view.rows, leaf.middle);
            within::<R, S>(simd, &sight.reach, leaf.slabs, &p, &point).0
        } else {
            f32x16::from_slice(simd, &offset[0]).simd_le(f32::INFINITY).to_bitmask() as u32
        };
        some[count] = (leaf.index, hits);
        count += usize::from(hits != 0);
    }
    candidates.room(count, skin);
    let way = N::way(view);
    for (leaf, hits) in &some[..count] {
        let index = *leaf as usize;
        let base = view.leaf_from_tip(tree.centre(index));
        let offset = load::<f32, S>(simd, &offsets[index].offset);
        candidates.take(simd, (view, &way), (*leaf, base), &offset, *hits);
        if skin {
            candidates.take_skin(simd, &skins[index], *hits);
        }
        candidates.took(hits.count_ones() as usize);
    }
}
