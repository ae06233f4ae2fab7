//! Which leaves a tool may reach: the descent, with margins.

use super::Tree;
use crate::bvh::{
    Boxes, LANE, Reach, Rough, SLABS, Sight, Sixteen, Triple, View, WIDTH, extent, load, seen,
};
use crate::tool::reserve;
use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, mask32x16, u32x16};
use std::ops::Range;

/// The descent, with its memory kept between queries: nodes of a level and of the next, in turns.
#[derive(Default)]
pub(crate) struct Walker<R = f32> {
    nodes: [Nodes<R>; 2],
    /// Which of the two has leaves; the other has the nodes above.
    leaves: usize,
}

/// Nodes or leaves that the tool may reach, and a block of room behind them.
#[derive(Default)]
pub(crate) struct Nodes<R = f32> {
    count: usize,
    index: Vec<u32>,
    /// A bit for each slab that may reach it; no other reaches what lies in it.
    slabs: Vec<u32>,
    /// Where the middle of its box is, seen from the tool.
    middle: [Vec<R>; 3],
}

/// One of [`Nodes`].
#[derive(Clone, Copy)]
pub(crate) struct Near<R> {
    pub(super) index: u32,
    pub(super) slabs: u32,
    pub(super) middle: [R; 3],
}

impl<R: Rough> Nodes<R> {
    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> Near<R> {
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
            self.middle.iter_mut().for_each(|list| list.resize(wanted, R::default()));
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

impl<R: Rough> Walker<R> {
    /// Reserves memory for all nodes and leaves of a tree: the children of level `k` go to list `k + 1`
    /// modulo 2, as [`descend`] writes them.
    pub(super) fn reserve(&mut self, tree: &Tree) {
        self.nodes[0].reserve(1);
        for (level, boxes) in tree.levels.iter().enumerate() {
            self.nodes[(level + 1) % 2].reserve(boxes.len() * WIDTH);
        }
    }

    /// Finds the leaves that the tool may reach, looking at so many nodes and leaves at most; how many it
    /// were.
    pub(super) fn leaves(&mut self, level: Level, seen: Seen<'_, R>, most: usize) -> Option<usize> {
        self.down(level, seen, seen.0.levels.len(), most)
    }

    /// Finds the nodes above the leaves that the tool may reach; how many there are.
    pub(super) fn nodes(&mut self, level: Level, seen: Seen<'_, R>) -> usize {
        self.down(level, seen, seen.0.levels.len() - 1, usize::MAX);
        self.nodes[1 - self.leaves].count
    }

    /// Goes down so many levels.
    fn down(
        &mut self,
        level: Level,
        (tree, sight, view): Seen<'_, R>,
        levels: usize,
        most: usize,
    ) -> Option<usize> {
        self.leaves = tree.levels.len() % 2;
        if sight.fits {
            return descend(level, &mut self.nodes, &tree.levels[..levels], (sight, view), most);
        }
        let all = tree.levels.get(levels).map_or(tree.leaves.len(), |boxes| boxes.len());
        (all <= most).then(|| {
            self.nodes[levels % 2].all(all);
            all
        })
    }

    /// Finds the leaves under one of the nodes that were found.
    pub(super) fn under(&mut self, level: Level, (tree, sight, view): Seen<'_, R>, node: usize) {
        let [even, odd] = &mut self.nodes;
        let (nodes, leaves) = if self.leaves == 0 { (odd, even) } else { (even, odd) };
        if sight.fits {
            let boxes = &tree.levels[tree.levels.len() - 1];
            below(level, boxes, (sight, view), (nodes, node..node + 1), leaves);
        } else {
            leaves.all(tree.leaves.len());
        }
    }

    /// One leaf alone.
    pub(super) fn only(&mut self, leaf: u32, (tree, sight, view): Seen<'_, R>) {
        let leaves = &mut self.nodes[self.leaves];
        leaves.room(1);
        leaves.count = 1;
        leaves.index[0] = leaf;
        leaves.slabs[0] = sight.reach.all;
        let centre = tree.centre(leaf as usize);
        let middle = view.seen(centre.map(R::of));
        for (list, part) in leaves.middle.iter_mut().zip(middle) {
            list[0] = part;
        }
    }

    /// The leaves that were found last.
    pub(super) fn found(&self) -> &Nodes<R> {
        &self.nodes[self.leaves]
    }
}

/// A part as a tool sees it.
pub(super) type Seen<'a, R> = (&'a Tree, &'a Sight<R>, &'a View<R>);

/// Which lanes a tool may reach, of boxes about a centre, with half extents along the tool's axes; and
/// for each lane by which of the `slabs`.
#[inline(always)]
pub(super) fn within<R: Rough, S: Simd>(
    simd: S,
    reach: &Reach<R>,
    slabs: u32,
    [x, y, z]: &Triple<S, R>,
    half: &Triple<S, R>,
) -> (u32, u32x16<S>) {
    let (low, high) = (*z - half[2], *z + half[2]);
    let (dx, dy) = ((x.abs() - half[0]).positive(), (y.abs() - half[1]).positive());
    let squared = dx * dx + dy * dy;
    let mut by = u32x16::splat(simd, 0);
    let mut left = slabs;
    while left != 0 {
        let slab = left.trailing_zeros();
        left &= left - 1;
        let [slab_low, slab_high, radius] = reach.slabs[slab as usize % SLABS];
        let here = low.at_most(slab_high) & high.at_least(slab_low) & squared.at_most(radius);
        by = here.select(by | (1 << slab), by);
    }
    let mut hit = by.simd_gt(0);
    if let Some(across) = &reach.across {
        for (axis, [from, to]) in across.iter().enumerate() {
            let centre = if axis == 0 { *x } else { *y };
            hit &= (centre - half[axis]).at_most(*to);
            hit &= (centre + half[axis]).at_least(*from);
        }
    }
    (hit.to_bitmask() as u32, by)
}

/// Down some levels from the root, looking at so many nodes and what they lead to at most; how many it
/// were.
fn descend<R: Rough>(
    level: Level,
    nodes: &mut [Nodes<R>; 2],
    levels: &[Vec<Boxes>],
    seen: (&Sight<R>, &View<R>),
    most: usize,
) -> Option<usize> {
    dispatch!(level, simd => descend_on(simd, nodes, levels, seen, most))
}

#[inline(always)]
fn descend_on<R: Rough, S: Simd>(
    simd: S,
    nodes: &mut [Nodes<R>; 2],
    levels: &[Vec<Boxes>],
    (sight, view): (&Sight<R>, &View<R>),
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
        below_on(simd, boxes, (sight, view), (from, 0..from.count), to);
        spent += to.count;
        if spent > most {
            return None;
        }
    }
    Some(spent)
}

/// The children of some nodes that the tool may reach. What lies behind the last leaf is NaN and
/// fails.
fn below<R: Rough>(
    level: Level,
    boxes: &[Boxes],
    seen: (&Sight<R>, &View<R>),
    nodes: (&Nodes<R>, Range<usize>),
    kept: &mut Nodes<R>,
) {
    dispatch!(level, simd => below_on(simd, boxes, seen, nodes, kept));
}

#[inline(always)]
fn below_on<R: Rough, S: Simd>(
    simd: S,
    boxes: &[Boxes],
    (sight, view): (&Sight<R>, &View<R>),
    (nodes, some): (&Nodes<R>, Range<usize>),
    kept: &mut Nodes<R>,
) {
    kept.room(some.len() * WIDTH);
    let mut count = 0;
    for at in some {
        let node = nodes.index[at];
        let children = &boxes[node as usize];
        let centre: Triple<S, R> = load::<R, S>(simd, &children.centre);
        let half: Triple<S, R> = load::<R, S>(simd, &children.half);
        let middle = seen::<R, S>(&centre, &view.rows, view.origin);
        let wide = [
            extent::<R, S>(&half, view.rows[0]),
            extent::<R, S>(&half, view.rows[1]),
            extent::<R, S>(&half, view.rows[2]),
        ];
        let (hits, by) = within::<R, S>(simd, &sight.reach, nodes.slabs[at], &middle, &wide);
        let mask = mask32x16::from_bitmask(simd, u64::from(hits));
        let index = u32x16::from_slice(simd, &LANE) + node * WIDTH as u32;
        // Those that are kept side by side, and room for the rest: no branch to mispredict.
        let place = count..count + WIDTH;
        index.compress(mask).store_slice(&mut kept.index[place.clone()]);
        by.compress(mask).store_slice(&mut kept.slabs[place.clone()]);
        for (list, middle) in kept.middle.iter_mut().zip(middle) {
            middle.keep(mask, &mut list[place.clone()]);
        }
        count += hits.count_ones() as usize;
    }
    kept.count = count;
}
