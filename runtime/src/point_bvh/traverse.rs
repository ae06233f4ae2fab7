//! The traversal: finds the leaves that a tool may reach, with margins for rounding.

use super::PointBvh;
use crate::bvh::{
    Boxes, LANE_INDICES, LaneVector, PoseTransform, QuerySetup, ReachBounds, SLABS, WIDTH, extent,
    load, transform,
};
use crate::tool::reserve;
use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, f32x16, mask32x16, u32x16};
use std::ops::Range;

/// The state of a traversal, with memory kept between queries. Levels alternate between two lists: the nodes of one
/// level and those of the next.
#[derive(Default)]
pub(crate) struct Traversal {
    nodes: [Nodes; 2],
    /// Index of the list that has the leaves; the other one has the nodes above them.
    leaves: usize,
}

/// Nodes or leaves that the tool may reach. The lists have room for one more block.
#[derive(Default)]
pub(crate) struct Nodes {
    count: usize,
    index: Vec<u32>,
    /// A mask of the slabs that may reach the node. No other slab reaches its contents.
    slabs: Vec<u32>,
    /// The centre of the node's box, in the tool's frame and unit.
    middle: [Vec<f32>; 3],
}

/// An entry of [`Nodes`].
#[derive(Clone, Copy)]
pub(crate) struct ReachableNode {
    pub(super) index: u32,
    pub(super) slabs: u32,
    pub(super) middle: [f32; 3],
}

impl Nodes {
    /// Returns the number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    #[inline(always)]
    pub(super) fn get(&self, position: usize) -> ReachableNode {
        let middle = [self.middle[0][position], self.middle[1][position], self.middle[2][position]];
        ReachableNode { index: self.index[position], slabs: self.slabs[position], middle }
    }

    /// Selects the first `count` nodes, without slabs and centres.
    fn set_all(&mut self, count: usize) {
        self.make_room(count);
        self.count = count;
        for (slot, index) in self.index[..count].iter_mut().zip(0..) {
            *slot = index;
        }
    }

    /// Makes room for `count` nodes and one more block.
    fn make_room(&mut self, count: usize) {
        let required = count + WIDTH;
        if self.index.len() < required {
            self.index.resize(required, 0);
            self.slabs.resize(required, 0);
            self.middle.iter_mut().for_each(|list| list.resize(required, 0.0));
        }
    }

    /// Reserves memory for `count` nodes and one more block, without touching it.
    fn reserve(&mut self, count: usize) {
        let required = count + WIDTH;
        reserve(&mut self.index, required);
        reserve(&mut self.slabs, required);
        self.middle.iter_mut().for_each(|list| reserve(list, required));
    }
}

impl Traversal {
    /// Reserves memory for all nodes and leaves of a tree. The children of level `k` go to list `(k + 1) mod 2`, where
    /// [`descend`] writes them.
    pub(crate) fn reserve(&mut self, tree: &PointBvh) {
        self.nodes[0].reserve(1);
        for (level, boxes) in tree.levels.iter().enumerate() {
            self.nodes[(level + 1) % 2].reserve(boxes.len() * WIDTH);
        }
    }

    /// Finds the leaves that the tool may reach, visiting at most `max_nodes` nodes and leaves. Returns the number visited;
    /// `None` if that limit does not suffice.
    pub(crate) fn leaves(
        &mut self,
        level: Level,
        input: TraversalInput<'_>,
        max_nodes: usize,
    ) -> Option<usize> {
        self.down(level, input, input.tree.levels.len(), max_nodes)
    }

    /// Finds the nodes above the leaves that the tool may reach. Returns the number of these nodes.
    pub(crate) fn nodes(&mut self, level: Level, input: TraversalInput<'_>) -> usize {
        self.down(level, input, input.tree.levels.len() - 1, usize::MAX);
        self.nodes[1 - self.leaves].count
    }

    /// Descends `levels` levels. Returns the number of nodes visited; `None` if it exceeds `max_nodes`.
    fn down(
        &mut self,
        level: Level,
        input: TraversalInput<'_>,
        levels: usize,
        max_nodes: usize,
    ) -> Option<usize> {
        let TraversalInput { tree, setup, .. } = input;
        // Levels alternate between the lists, the root in list 0.
        self.leaves = tree.levels.len() % 2;
        if setup.fits {
            return descend(level, &mut self.nodes, input, levels, max_nodes);
        }
        // Where `f32` cannot hold the coordinates, nothing can be ruled out.
        let count = tree.levels.get(levels).map_or(tree.leaves.len(), |boxes| boxes.len());
        (count <= max_nodes).then(|| {
            self.nodes[levels % 2].set_all(count);
            count
        })
    }

    /// Finds the leaves under one of the nodes found.
    pub(crate) fn under(&mut self, level: Level, input: TraversalInput<'_>, node: usize) {
        let tree = input.tree;
        let [even, odd] = &mut self.nodes;
        let (nodes, leaves) = if self.leaves == 0 { (odd, even) } else { (even, odd) };
        if input.setup.fits {
            let boxes = &tree.levels[tree.levels.len() - 1];
            children(level, input, boxes, nodes, node..node + 1, leaves);
        } else {
            leaves.set_all(tree.leaves.len());
        }
    }

    /// Selects a single leaf.
    pub(crate) fn only(&mut self, leaf: u32, input: TraversalInput<'_>) {
        let TraversalInput { tree, setup, view } = input;
        let leaves = &mut self.nodes[self.leaves];
        leaves.make_room(1);
        leaves.count = 1;
        leaves.index[0] = leaf;
        leaves.slabs[0] = setup.reach.all;
        let centre = tree.centre(leaf as usize);
        let middle = view.transform(centre.map(|part| part as f32));
        for (list, part) in leaves.middle.iter_mut().zip(middle) {
            list[0] = part;
        }
    }

    /// Returns the leaves found last.
    pub(crate) fn found(&self) -> &Nodes {
        &self.nodes[self.leaves]
    }
}

/// A tree, the setup of its queries, and the pose.
#[derive(Clone, Copy)]
pub(crate) struct TraversalInput<'a> {
    pub(crate) tree: &'a PointBvh,
    pub(crate) setup: &'a QuerySetup,
    pub(crate) view: &'a PoseTransform,
}

/// Tests boxes, given their centres and half extents along the tool's axes, against the tool's reach. Returns a mask of
/// the lanes that the tool may reach, and for each lane a mask of those among `slabs` that may reach it.
#[inline(always)]
pub(super) fn within<S: Simd>(
    simd: S,
    reach: &ReachBounds,
    slabs: u32,
    [x, y, z]: &LaneVector<f32x16<S>>,
    half: &LaneVector<f32x16<S>>,
) -> (u32, u32x16<S>) {
    let (low, high) = (*z - half[2], *z + half[2]);
    let zero = f32x16::splat(simd, 0.0);
    // The distance from the axis of the nearest point of the box. The boxes are those along the tool's axes, so a
    // rotated box is taken larger than it is.
    let (dx, dy) = ((x.abs() - half[0]).max(zero), (y.abs() - half[1]).max(zero));
    let squared = dx * dx + dy * dy;
    let mut by = u32x16::splat(simd, 0);
    let mut left = slabs;
    while left != 0 {
        let slab = left.trailing_zeros();
        left &= left - 1;
        // The remainder changes no index; it saves the bounds check.
        let [slab_low, slab_high, radius] = reach.slabs[slab as usize % SLABS];
        let here = low.simd_le(slab_high) & high.simd_ge(slab_low) & squared.simd_le(radius);
        by = here.select(by | (1 << slab), by);
    }
    let mut hit = by.simd_gt(0);
    if let Some(across) = &reach.across {
        for (axis, [from, to]) in across.iter().enumerate() {
            let centre = if axis == 0 { *x } else { *y };
            hit &= (centre - half[axis]).simd_le(*to);
            hit &= (centre + half[axis]).simd_ge(*from);
        }
    }
    (hit.to_bitmask() as u32, by)
}

/// Descends `levels` levels from the root, visiting at most `max_nodes` nodes and children. Returns the number visited; `None`
/// if that limit does not suffice.
fn descend(
    level: Level,
    nodes: &mut [Nodes; 2],
    input: TraversalInput<'_>,
    levels: usize,
    max_nodes: usize,
) -> Option<usize> {
    dispatch!(level, simd => descend_on(simd, nodes, input, levels, max_nodes))
}

#[inline(always)]
fn descend_on<S: Simd>(
    simd: S,
    nodes: &mut [Nodes; 2],
    input: TraversalInput<'_>,
    levels: usize,
    max_nodes: usize,
) -> Option<usize> {
    let [even, odd] = nodes;
    even.make_room(1);
    even.count = 1;
    even.index[0] = 0;
    even.slabs[0] = input.setup.reach.all;
    let mut spent = 1;
    if spent > max_nodes {
        return None;
    }
    for (level, boxes) in input.tree.levels[..levels].iter().enumerate() {
        let (from, to) = if level % 2 == 0 { (&*even, &mut *odd) } else { (&*odd, &mut *even) };
        children_on(simd, input, boxes, from, 0..from.count, to);
        // The budget counts what was kept: these are the nodes that the next level opens.
        spent += to.count;
        if spent > max_nodes {
            return None;
        }
    }
    Some(spent)
}

/// Finds the children that the tool may reach of the nodes at some positions of a list. `boxes` has the children of each
/// node of the level; slots behind the last leaf are NaN and fail the test.
fn children(
    level: Level,
    input: TraversalInput<'_>,
    boxes: &[Boxes],
    nodes: &Nodes,
    positions: Range<usize>,
    kept: &mut Nodes,
) {
    dispatch!(level, simd => children_on(simd, input, boxes, nodes, positions, kept));
}

#[inline(always)]
fn children_on<S: Simd>(
    simd: S,
    input: TraversalInput<'_>,
    boxes: &[Boxes],
    nodes: &Nodes,
    positions: Range<usize>,
    kept: &mut Nodes,
) {
    let TraversalInput { setup, view, .. } = input;
    // For all children of all nodes, so that the loop need not test the room.
    kept.make_room(positions.len() * WIDTH);
    let mut count = 0;
    for position in positions {
        let node = nodes.index[position];
        let children = &boxes[node as usize];
        let centre: LaneVector<f32x16<S>> = load(simd, &children.centre);
        let half: LaneVector<f32x16<S>> = load(simd, &children.half);
        let middle = transform(&centre, &view.rows, view.origin);
        let wide =
            [extent(&half, view.rows[0]), extent(&half, view.rows[1]), extent(&half, view.rows[2])];
        let (hits, by) = within(simd, &setup.reach, nodes.slabs[position], &middle, &wide);
        let mask = mask32x16::from_bitmask(simd, u64::from(hits));
        let index = u32x16::from_slice(simd, &LANE_INDICES) + node * WIDTH as u32;
        // The kept entries are stored first in the block, followed by room for the rest: no branch to mispredict.
        let slot = count..count + WIDTH;
        index.compress(mask).store_slice(&mut kept.index[slot.clone()]);
        by.compress(mask).store_slice(&mut kept.slabs[slot.clone()]);
        for (list, middle) in kept.middle.iter_mut().zip(middle) {
            middle.compress(mask).store_slice(&mut list[slot.clone()]);
        }
        count += hits.count_ones() as usize;
    }
    kept.count = count;
}
