//! Which points of the leaves may be inside a tool.

use super::walk::{Nodes, load, seen, within};
use super::{Candidates, Sight, Tree, View, WIDTH};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};

/// Leaves with points that may be inside, and a bit for each of these.
#[derive(Default)]
pub(crate) struct Sieve(Vec<(u32, u32)>);

impl Sieve {
    /// Takes the points of some leaves that the tool's envelope reaches. `skin` says whether what the
    /// part has there, normals and weights, is wanted.
    pub(crate) fn sift(
        &mut self,
        level: Level,
        seen: (&Tree, &Sight, &View),
        (leaves, skin): (&Nodes, bool),
        candidates: &mut Candidates,
    ) {
        self.0.resize(leaves.len() + 1, (0, 0));
        dispatch!(level, simd => sift(simd, &mut self.0, seen, (leaves, skin), candidates));
    }
}

#[inline(always)]
fn sift<S: Simd>(
    simd: S,
    some: &mut [(u32, u32)],
    (tree, sight, view): (&Tree, &Sight, &View),
    (leaves, skin): (&Nodes, bool),
    candidates: &mut Candidates,
) {
    let point = [f32x16::splat(simd, 0.0); 3];
    // First which leaves have some: a branch at each leaf would be mispredicted at every other.
    let mut count = 0;
    for at in 0..leaves.len() {
        let leaf = leaves.get(at);
        let offset = load(simd, &tree.leaves[leaf.index as usize].offset);
        let hits = if sight.fits {
            let p = seen(&offset, &view.rows, leaf.middle);
            within(simd, &sight.reach, leaf.slabs, &p, &point).0
        } else {
            offset[0].simd_le(f32::INFINITY).to_bitmask() as u32
        };
        some[count] = (leaf.index, hits);
        count += usize::from(hits != 0);
    }
    candidates.room(count, skin);
    let boxes = &tree.levels[tree.levels.len() - 1];
    for (leaf, hits) in &some[..count] {
        let index = *leaf as usize;
        let (last, lane) = (&boxes[index / WIDTH].centre, index % WIDTH);
        let centre = [f64::from(last[0][lane]), f64::from(last[1][lane]), f64::from(last[2][lane])];
        let base = view.leaf_from_tip(centre);
        let offset = load(simd, &tree.leaves[index].offset);
        candidates.take(simd, view, (*leaf, base), &offset, *hits);
        if skin {
            candidates.take_skin(simd, &tree.skins[index], *hits);
        }
        candidates.took(hits.count_ones() as usize);
    }
}
