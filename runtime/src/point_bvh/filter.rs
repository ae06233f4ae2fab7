//! The filter: the points of leaves that may be inside a tool, as candidates in the tool's frame.

use crate::bvh::{LANE_INDICES, LaneVector, PoseTransform, WIDTH, load, transform};
use crate::point_bvh::traverse::{Nodes, TraversalInput, within};
use crate::point_bvh::{Leaf, LeafAttributes};
use crate::tool::{LANES, PointBatch, reserve};
use fearless_simd::{
    Level, Simd, SimdBase, SimdMask, SimdWiden, dispatch, f32x16, f64x8, mask32x16, mask64x8,
    u32x16,
};

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
    hit_leaves.resize(leaves.len() + 1, HitLeaf::default());
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
            // Every slot that has a point: NaN marks the others.
            f32x16::from_slice(simd, &offset[0]).simd_le(f32::INFINITY).to_bitmask() as u32
        };
        hit_leaves[count] = HitLeaf { index: leaf.index, hits };
        // An entry without hits is overwritten by the next one.
        count += usize::from(hits != 0);
    }
    candidates.make_room(count, attributes);
    for leaf in &hit_leaves[..count] {
        let index = leaf.index as usize;
        let base = view.leaf_from_tip(tree.centre(index));
        let offset = load(simd, &offsets[index].offset);
        candidates.take(simd, view, *leaf, base, &offset);
        if attributes {
            candidates.take_attributes(simd, &attribute_blocks[index], leaf.hits);
        }
        candidates.advance(leaf.hits.count_ones() as usize);
    }
    candidates.leaves = hit_leaves;
}

/// A leaf with points that may be inside.
#[derive(Clone, Copy, Default)]
struct HitLeaf {
    index: u32,
    /// A mask of these points.
    hits: u32,
}

/// Points that may be inside: their tree indices, and their coordinates in the tool's frame and unit.
#[derive(Default)]
pub(crate) struct Candidates {
    leaves: Vec<HitLeaf>,
    indices: Vec<u32>,
    pub(crate) points: PointBatch,
    /// Normals and weights of the candidates, if requested. Normals are in the part's frame.
    pub(crate) normals: [Vec<f32>; 3],
    pub(crate) weights: Vec<f32>,
}

impl Candidates {
    fn clear(&mut self) {
        self.points.clear();
    }

    /// Returns the tree indices of the candidates.
    pub(crate) fn indices(&self) -> &[u32] {
        &self.indices[..self.points.len()]
    }

    /// Reserves memory for all points of a part with `leaves` leaves, without touching it.
    pub(crate) fn reserve(&mut self, leaves: usize, attributes: bool) {
        let count = (leaves + 1) * WIDTH;
        reserve(&mut self.leaves, leaves + 1);
        self.points.reserve(count);
        reserve(&mut self.indices, count);
        if attributes {
            reserve(&mut self.weights, count);
            self.normals.iter_mut().for_each(|list| reserve(list, count));
        }
    }

    /// Makes room for the points of `leaves` leaves.
    fn make_room(&mut self, leaves: usize, attributes: bool) {
        let additional = (leaves + 1) * WIDTH;
        self.points.make_room(additional);
        let required = self.points.len() + additional;
        if self.indices.len() < required {
            self.indices.resize(required, 0);
        }
        if attributes && self.weights.len() < required {
            self.weights.resize(required, 0.0);
            self.normals.iter_mut().for_each(|list| list.resize(required, 0.0));
        }
    }

    /// Appends the points of a leaf whose bits are set; there has to be room for all of them.
    ///
    /// The points are transformed to the tool's frame in `f64`: `Rᵀ (p − t)`, the difference first. `base` is the
    /// leaf's centre relative to the tip.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        simd: S,
        view: &PoseTransform,
        HitLeaf { index: leaf, hits }: HitLeaf,
        base: [f64; 3],
        offset: &LaneVector<f32x16<S>>,
    ) {
        let lanes = u32x16::from_slice(simd, &LANE_INDICES) + leaf * WIDTH as u32;
        let mask = mask32x16::from_bitmask(simd, u64::from(hits));
        let start = self.points.len();
        lanes.compress(mask).store_slice(&mut self.indices[start..start + WIDTH]);
        // 16 lanes of `f32` are two vectors of `f64`, whose points are appended one after the other.
        let (x, y, z) = (offset[0].widen(), offset[1].widen(), offset[2].widen());
        let halves = [[x.0, y.0, z.0], [x.1, y.1, z.1]];
        let mut count = 0;
        for (half, bits) in halves.into_iter().zip([hits & 0xff, hits >> 8]) {
            let p = [
                half[0] * view.scale + base[0],
                half[1] * view.scale + base[1],
                half[2] * view.scale + base[2],
            ];
            let mask = mask64x8::from_bitmask(simd, u64::from(bits));
            let outputs = self.points.next(count, LANES);
            for (row, output) in view.exact_rows.iter().zip(outputs) {
                let transformed: f64x8<S> = p[0] * row[0] + p[1] * row[1] + p[2] * row[2];
                transformed.compress(mask).store_slice(output);
            }
            count += bits.count_ones() as usize;
        }
    }

    /// Appends the normals and weights of the same points.
    #[inline(always)]
    fn take_attributes<S: Simd>(&mut self, simd: S, attributes: &LeafAttributes, hits: u32) {
        let mask = mask32x16::from_bitmask(simd, u64::from(hits));
        let output = self.points.len()..self.points.len() + WIDTH;
        for (list, of) in self.normals.iter_mut().zip(&attributes.normal) {
            f32x16::from_slice(simd, of).compress(mask).store_slice(&mut list[output.clone()]);
        }
        f32x16::from_slice(simd, &attributes.weight)
            .compress(mask)
            .store_slice(&mut self.weights[output]);
    }

    /// Records that `count` points were appended.
    #[inline(always)]
    fn advance(&mut self, count: usize) {
        self.points.advance(count);
    }
}
