//! The traversal: leaves that a tool may reach, with margins.

use super::Tree;
use crate::bvh::{
    Boxes, LANE, PoseTransform, QuerySetup, Reach, SLABS, Triple, WIDTH, extent, load, seen,
};
use crate::tool::reserve;
use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, f32x16, mask32x16, u32x16};
use std::ops::Range;

/// A traversal, with its memory kept between queries: nodes of a level and of the next, in turns.
#[derive(Default)]
pub(crate) struct Traversal {
    nodes: [Nodes; 2],
    /// Which of the two has leaves; the other has the nodes above.
    leaves: usize,
}

/// Nodes or leaves that the tool may reach, and a block of room behind them.
#[derive(Default)]
pub(crate) struct Nodes {
    count: usize,
    index: Vec<u32>,
    /// A bit for each slab that may reach it; no other reaches what lies in it.
    slabs: Vec<u32>,
    /// Where the middle of its box is, seen from the tool.
    middle: [Vec<f32>; 3],
}

/// One of [`Nodes`].
#[derive(Clone, Copy)]
pub(crate) struct Near {
    pub(super) index: u32,
    pub(super) slabs: u32,
    pub(super) middle: [f32; 3],
}

impl Nodes {
    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> Near {
        let middle = [self.middle[0][at], self.middle[1][at], self.middle[2][at]];
        Near { index: self.index[at], slabs: self.slabs[at], middle }
    }

    /// All of so many.
    fn all(&mut self, count: usize) {
        self.room(count);
        self.count = count;
        for (place, index) in self.index[..count].iter_mut().zip(0..) {
            *place = index;
        }
    }

    /// Makes room for so many and a block more.
    fn room(&mut self, count: usize) {
        let wanted = count + WIDTH;
        if self.index.len() < wanted {
            self.index.resize(wanted, 0);
            self.slabs.resize(wanted, 0);
            self.middle.iter_mut().for_each(|list| list.resize(wanted, 0.0));
        }
    }

    /// Reserves memory for so many and a block more, without touching it.
    fn reserve(&mut self, count: usize) {
        let wanted = count + WIDTH;
        reserve(&mut self.index, wanted);
        reserve(&mut self.slabs, wanted);
        self.middle.iter_mut().for_each(|list| reserve(list, wanted));
    }
}

impl Traversal {
    /// Reserves memory for all nodes and leaves of a tree: the children of level `k` go to list `k + 1`
    /// modulo 2, as [`descend`] writes them.
    pub(crate) fn reserve(&mut self, tree: &Tree) {
        self.nodes[0].reserve(1);
        for (level, boxes) in tree.levels.iter().enumerate() {
            self.nodes[(level + 1) % 2].reserve(boxes.len() * WIDTH);
        }
    }

    /// Finds the leaves that the tool may reach, looking at so many nodes and leaves at most; how many it
    /// were.
    pub(crate) fn leaves(&mut self, level: Level, seen: Seen<'_>, most: usize) -> Option<usize> {
        self.down(level, seen, seen.0.levels.len(), most)
    }

    /// Finds the nodes above the leaves that the tool may reach; how many there are.
    pub(crate) fn nodes(&mut self, level: Level, seen: Seen<'_>) -> usize {
        self.down(level, seen, seen.0.levels.len() - 1, usize::MAX);
        self.nodes[1 - self.leaves].count
    }

    /// Goes down so many levels.
    fn down(
        &mut self,
        level: Level,
        (tree, setup, view): Seen<'_>,
        levels: usize,
        most: usize,
    ) -> Option<usize> {
        self.leaves = tree.levels.len() % 2;
        if setup.fits {
            return descend(level, &mut self.nodes, &tree.levels[..levels], (setup, view), most);
        }
        let all = tree.levels.get(levels).map_or(tree.leaves.len(), |boxes| boxes.len());
        (all <= most).then(|| {
            self.nodes[levels % 2].all(all);
            all
        })
    }

    /// Finds the leaves under one of the nodes that were found.
    pub(crate) fn under(&mut self, level: Level, (tree, setup, view): Seen<'_>, node: usize) {
        let [even, odd] = &mut self.nodes;
        let (nodes, leaves) = if self.leaves == 0 { (odd, even) } else { (even, odd) };
        if setup.fits {
            let boxes = &tree.levels[tree.levels.len() - 1];
            below(level, boxes, (setup, view), (nodes, node..node + 1), leaves);
        } else {
            leaves.all(tree.leaves.len());
        }
    }

    /// One leaf alone.
    pub(crate) fn only(&mut self, leaf: u32, (tree, setup, view): Seen<'_>) {
        let leaves = &mut self.nodes[self.leaves];
        leaves.room(1);
        leaves.count = 1;
        leaves.index[0] = leaf;
        leaves.slabs[0] = setup.reach.all;
        let centre = tree.centre(leaf as usize);
        let middle = view.seen(centre.map(|part| part as f32));
        for (list, part) in leaves.middle.iter_mut().zip(middle) {
            list[0] = part;
        }
    }

    /// The leaves that were found last.
    pub(crate) fn found(&self) -> &Nodes {
        &self.nodes[self.leaves]
    }
}

/// A part as a tool sees it.
pub(super) type Seen<'a> = (&'a Tree, &'a QuerySetup, &'a PoseTransform);

/// Which lanes a tool may reach, of boxes about a centre, with half extents along the tool's axes; and
/// for each lane by which of the `slabs`.
#[inline(always)]
pub(super) fn within<S: Simd>(
    simd: S,
    reach: &Reach,
    slabs: u32,
    [x, y, z]: &Triple<S>,
    half: &Triple<S>,
) -> (u32, u32x16<S>) {
    let (low, high) = (*z - half[2], *z + half[2]);
    let zero = f32x16::splat(simd, 0.0);
    let (dx, dy) = ((x.abs() - half[0]).max(zero), (y.abs() - half[1]).max(zero));
    let squared = dx * dx + dy * dy;
    let mut by = u32x16::splat(simd, 0);
    let mut left = slabs;
    while left != 0 {
        let slab = left.trailing_zeros();
        left &= left - 1;
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

/// Down some levels from the root, looking at so many nodes and what they lead to at most; how many it
/// were.
fn descend(
    level: Level,
    nodes: &mut [Nodes; 2],
    levels: &[Vec<Boxes>],
    seen: (&QuerySetup, &PoseTransform),
    most: usize,
) -> Option<usize> {
    dispatch!(level, simd => descend_on(simd, nodes, levels, seen, most))
}

#[inline(always)]
fn descend_on<S: Simd>(
    simd: S,
    nodes: &mut [Nodes; 2],
    levels: &[Vec<Boxes>],
    (setup, view): (&QuerySetup, &PoseTransform),
    most: usize,
) -> Option<usize> {
    let [even, odd] = nodes;
    even.room(1);
    even.count = 1;
    even.index[0] = 0;
    even.slabs[0] = setup.reach.all;
    let mut spent = 1;
    if spent > most {
        return None;
    }
    for (level, boxes) in levels.iter().enumerate() {
        let (from, to) = if level % 2 == 0 { (&*even, &mut *odd) } else { (&*odd, &mut *even) };
        below_on(simd, boxes, (setup, view), (from, 0..from.count), to);
        spent += to.count;
        if spent > most {
            return None;
        }
    }
    Some(spent)
}

/// The children of some nodes that the tool may reach. What lies behind the last leaf is NaN and
/// fails.
fn below(
    level: Level,
    boxes: &[Boxes],
    seen: (&QuerySetup, &PoseTransform),
    nodes: (&Nodes, Range<usize>),
    kept: &mut Nodes,
) {
    dispatch!(level, simd => below_on(simd, boxes, seen, nodes, kept));
}

#[inline(always)]
fn below_on<S: Simd>(
    simd: S,
    boxes: &[Boxes],
    (setup, view): (&QuerySetup, &PoseTransform),
    (nodes, some): (&Nodes, Range<usize>),
    kept: &mut Nodes,
) {
    kept.room(some.len() * WIDTH);
    let mut count = 0;
    for at in some {
        let node = nodes.index[at];
        let children = &boxes[node as usize];
        let centre: Triple<S> = load(simd, &children.centre);
        let half: Triple<S> = load(simd, &children.half);
        let middle = seen(&centre, &view.rows, view.origin);
        let wide =
            [extent(&half, view.rows[0]), extent(&half, view.rows[1]), extent(&half, view.rows[2])];
        let (hits, by) = within(simd, &setup.reach, nodes.slabs[at], &middle, &wide);
        let mask = mask32x16::from_bitmask(simd, u64::from(hits));
        let index = u32x16::from_slice(simd, &LANE) + node * WIDTH as u32;
        // Those that are kept side by side, and room for the rest: no branch to mispredict.
        let place = count..count + WIDTH;
        index.compress(mask).store_slice(&mut kept.index[place.clone()]);
        by.compress(mask).store_slice(&mut kept.slabs[place.clone()]);
        for (list, middle) in kept.middle.iter_mut().zip(middle) {
            middle.compress(mask).store_slice(&mut list[place.clone()]);
        }
        count += hits.count_ones() as usize;
    }
    kept.count = count;
}
