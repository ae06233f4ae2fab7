//! Which points of the leaves may be inside a tool.

use super::candidates::Carried;
use super::rough::Sixteen;
use super::walk::{Nodes, Seen, Triple, Walker, load, seen, within};
use super::{Candidates, Leaf, Rough, Skin};
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
    /// Finds the candidates of a part. `skin` says whether what it has there, normals and weights, is
    /// wanted.
    pub(crate) fn all(&mut self, level: Level, seen: Seen<'_, R>, skin: bool) {
        self.candidates.clear();
        dispatch!(level, simd => self.all_on(simd, seen, skin));
    }

    // One function for one dispatch.
    #[inline(always)]
    fn all_on<S: Simd>(&mut self, simd: S, seen: Seen<'_, R>, skin: bool) {
        let nodes = self.walker.find(simd, seen);
        let leaves = self.walker.leaves(simd, seen, 0..nodes);
        sift(simd, &mut self.some, seen, (leaves, skin), &mut self.candidates);
    }

    /// Finds the leaves of a part that the tool may reach, looking at so many nodes and leaves at most;
    /// how many it were.
    pub(crate) fn within(&mut self, level: Level, seen: Seen<'_, R>, most: usize) -> Option<usize> {
        dispatch!(level, simd => self.walker.within(simd, seen, most))
    }

    /// Finds the candidates of the leaves that were found last, and what the part has there.
    pub(crate) fn found(&mut self, level: Level, seen: Seen<'_, R>) {
        self.candidates.clear();
        let (leaves, some, candidates) =
            (self.walker.found(), &mut self.some, &mut self.candidates);
        dispatch!(level, simd => sift(simd, some, seen, (leaves, true), candidates));
    }

    /// Finds the nodes above the leaves that the tool may reach; how many there are.
    pub(crate) fn nodes(&mut self, level: Level, seen: Seen<'_, R>) -> usize {
        dispatch!(level, simd => self.walker.find(simd, seen))
    }

    /// Finds the candidates under one of them.
    pub(crate) fn under(&mut self, level: Level, seen: Seen<'_, R>, node: usize) {
        self.candidates.clear();
        dispatch!(level, simd => self.under_on(simd, seen, node));
    }

    #[inline(always)]
    fn under_on<S: Simd>(&mut self, simd: S, seen: Seen<'_, R>, node: usize) {
        let leaves = self.walker.leaves(simd, seen, node..node + 1);
        sift(simd, &mut self.some, seen, (leaves, false), &mut self.candidates);
    }

    /// Finds the candidates of one leaf.
    pub(crate) fn leaf(&mut self, level: Level, seen: Seen<'_, R>, leaf: u32) {
        self.candidates.clear();
        let leaf = self.walker.only(leaf, seen);
        let (some, candidates) = (&mut self.some, &mut self.candidates);
        dispatch!(level, simd => sift(simd, some, seen, (leaf, false), candidates));
    }
}

/// Takes the points of some leaves that the tool's envelope reaches.
#[inline(always)]
fn sift<R: Rough, N: Carried, S: Simd>(
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
