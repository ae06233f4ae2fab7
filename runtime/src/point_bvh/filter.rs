//! The filter: the points of leaves that may be inside a tool.

use super::traverse::{Nodes, TraversalInput, within};
use super::{Candidates, Leaf, LeafAttributes};
use crate::bvh::{LaneVector, load, transform};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};

/// Replaces the candidates by the points of some leaves that the tool's envelope reaches; with `attributes`, their
/// normals and weights too.
pub(crate) fn filter(
    level: Level,
    input: TraversalInput<'_>,
    leaves: &Nodes,
    attributes: bool,
    candidates: &mut Candidates,
) {
    candidates.clear();
    dispatch!(level, simd => filter_on(simd, input, leaves, attributes, candidates));
}

#[inline(always)]
fn filter_on<S: Simd>(
    simd: S,
    TraversalInput { tree, setup, view }: TraversalInput<'_>,
    leaves: &Nodes,
    attributes: bool,
    candidates: &mut Candidates,
) {
    let (offsets, attribute_blocks): (&[Leaf], &[LeafAttributes]) =
        (&tree.leaves, &tree.attributes);
    let mut hit_leaves = std::mem::take(&mut candidates.leaves);
    hit_leaves.resize(leaves.len() + 1, (0, 0));
    let point: LaneVector<f32x16<S>> = [f32x16::splat(simd, 0.0); 3];
    // The first pass finds the leaves with such points. A branch at each leaf would be mispredicted at every other one.
    let mut count = 0;
    for position in 0..leaves.len() {
        let leaf = leaves.get(position);
        let offset = &offsets[leaf.index as usize].offset;
        let hits = if setup.fits {
            let p = transform(&load(simd, offset), &view.rows, leaf.middle);
            within(simd, &setup.reach, leaf.slabs, &p, &point).0
        } else {
            f32x16::from_slice(simd, &offset[0]).simd_le(f32::INFINITY).to_bitmask() as u32
        };
        hit_leaves[count] = (leaf.index, hits);
        count += usize::from(hits != 0);
    }
    candidates.make_room(count, attributes);
    for (leaf, hits) in &hit_leaves[..count] {
        let index = *leaf as usize;
        let base = view.leaf_from_tip(tree.centre(index));
        let offset = load(simd, &offsets[index].offset);
        candidates.take(simd, view, (*leaf, base), &offset, *hits);
        if attributes {
            candidates.take_attributes(simd, &attribute_blocks[index], *hits);
        }
        candidates.advance(hits.count_ones() as usize);
    }
    candidates.leaves = hit_leaves;
}
