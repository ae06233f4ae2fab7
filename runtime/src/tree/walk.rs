//! Which leaves a tool may reach: the descent in `f32`, with margins.

use super::view::{Reach, SLABS};
use super::{Boxes, Shelf, Sight, Tree, View, WIDTH};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};
use std::ops::Range;

/// The descent, with its memory kept between queries: nodes of a level and of the next, in turns.
#[derive(Default)]
pub(crate) struct Walker {
    nodes: [Nodes; 2],
    /// Which of the two has the nodes above the leaves.
    above: usize,
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
}

impl Walker {
    /// Finds the nodes above the leaves that the tool may reach; how many there are.
    #[inline(always)]
    pub(super) fn find<S: Simd>(
        &mut self,
        simd: S,
        (tree, sight, view): (&Tree, &Sight, &View),
    ) -> usize {
        let above = tree.levels.len() - 1;
        self.above = above % 2;
        if sight.fits {
            descend(simd, &mut self.nodes, &tree.levels[..above], sight, view, usize::MAX);
        } else {
            self.nodes[self.above].all(tree.levels[above].len());
        }
        self.nodes[self.above].count
    }

    /// Finds the leaves of the whole part, looking at so many nodes and leaves at most; how many it
    /// were.
    #[inline(always)]
    pub(super) fn within<S: Simd>(
        &mut self,
        simd: S,
        (tree, sight, view): (&Tree, &Sight, &View),
        most: usize,
    ) -> Option<usize> {
        self.above = (tree.levels.len() - 1) % 2;
        if !sight.fits {
            let leaves = tree.leaves.len();
            return (leaves <= most).then(|| {
                self.nodes[1 - self.above].all(leaves);
                leaves
            });
        }
        descend(simd, &mut self.nodes, &tree.levels, sight, view, most)
    }

    /// The leaves that were found last.
    pub(super) fn found(&self) -> &Nodes {
        &self.nodes[1 - self.above]
    }

    /// One leaf alone.
    pub(super) fn only(
        &mut self,
        leaf: u32,
        (tree, sight, view): (&Tree, &Sight, &View),
    ) -> &Nodes {
        let [nodes, _] = &mut self.nodes;
        nodes.room(1);
        nodes.count = 1;
        nodes.index[0] = leaf;
        nodes.slabs[0] = sight.reach.all;
        let centre = tree.centre(leaf as usize);
        let middle = view.seen(centre.map(|part| part as f32));
        for (list, part) in nodes.middle.iter_mut().zip(middle) {
            list[0] = part;
        }
        nodes
    }

    /// The leaves under some of those nodes that may have a point inside the tool, in order.
    #[inline(always)]
    pub(super) fn leaves<S: Simd>(
        &mut self,
        simd: S,
        (tree, sight, view): (&Tree, &Sight, &View),
        some: Range<usize>,
    ) -> &Nodes {
        let [even, odd] = &mut self.nodes;
        let (nodes, leaves) = if self.above == 0 { (even, odd) } else { (odd, even) };
        if sight.fits {
            let boxes = &tree.levels[tree.levels.len() - 1];
            below(simd, boxes, sight, view, (nodes, some), leaves);
        } else {
            leaves.all(tree.leaves.len());
        }
        leaves
    }
}

/// Sixteen points or boxes, coordinate by coordinate.
pub(crate) type Triple<S> = [f32x16<S>; 3];

// What runs on vectors is written in functions that are always inlined: a closure, as `array::map`
// takes one, would be compiled without the vector instructions of its surroundings.

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lists: &[[f32; WIDTH]; 3]) -> Triple<S> {
    [
        f32x16::from_slice(simd, &lists[0]),
        f32x16::from_slice(simd, &lists[1]),
        f32x16::from_slice(simd, &lists[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(v: &Triple<S>, row: [f32; 3]) -> f32x16<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

/// Places turned to the tool's frame, from one whose place there is known.
#[inline(always)]
pub(crate) fn seen<S: Simd>(v: &Triple<S>, rows: &[[f32; 3]; 3], from: [f32; 3]) -> Triple<S> {
    [dot(v, rows[0]) + from[0], dot(v, rows[1]) + from[1], dot(v, rows[2]) + from[2]]
}

/// How far boxes with these half extents reach along a row.
#[inline(always)]
pub(crate) fn extent<S: Simd>(half: &Triple<S>, row: [f32; 3]) -> f32x16<S> {
    dot(half, [row[0].abs(), row[1].abs(), row[2].abs()])
}

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
    let zero = f32x16::splat(simd, 0.0);
    let (low, high) = (*z - half[2], *z + half[2]);
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
#[inline(always)]
fn descend<S: Simd>(
    simd: S,
    nodes: &mut [Nodes; 2],
    levels: &[Shelf<Boxes>],
    sight: &Sight,
    view: &View,
    most: usize,
) -> Option<usize> {
    let [even, odd] = nodes;
    even.room(1);
    even.count = 1;
    even.index[0] = 0;
    even.slabs[0] = sight.reach.all;
    let mut spent = 1;
    if spent > most {
        return None;
    }
    for (level, boxes) in levels.iter().enumerate() {
        let (from, to) = if level % 2 == 0 { (&*even, &mut *odd) } else { (&*odd, &mut *even) };
        below(simd, boxes, sight, view, (from, 0..from.count), to);
        spent += to.count;
        if spent > most {
            return None;
        }
    }
    Some(spent)
}

/// The children of some nodes that the tool may reach. What lies behind the last leaf is NaN and
/// fails.
#[inline(always)]
fn below<S: Simd>(
    simd: S,
    boxes: &[Boxes],
    sight: &Sight,
    view: &View,
    (nodes, some): (&Nodes, Range<usize>),
    kept: &mut Nodes,
) {
    kept.room(some.len() * WIDTH);
    let mut count = 0;
    for at in some {
        let node = nodes.index[at];
        let children = &boxes[node as usize];
        let (centre, half) = (load(simd, &children.centre), load(simd, &children.half));
        let middle = seen(&centre, &view.rows, view.origin);
        let wide =
            [extent(&half, view.rows[0]), extent(&half, view.rows[1]), extent(&half, view.rows[2])];
        let (hits, by) = within(simd, &sight.reach, nodes.slabs[at], &middle, &wide);
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

/// The lanes' numbers.
pub(super) const LANE: [u32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
