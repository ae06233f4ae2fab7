//! The way down a tree of triangles, the deepest first.

use super::facets::{Corners, Facets};
use super::flat::Ring;
use super::nearest::Space;
use crate::tool::{LANES, on_vectors};
use crate::tree::{Boxes, View, WIDTH, load, seen};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};

/// A node of the tree, a leaf or a triangle, and how deep the tool can be in it.
#[derive(Clone, Copy)]
pub(super) struct Node {
    /// That of its children; leaves are those whose children are triangles.
    level: u32,
    index: u32,
    pub(super) bound: f32,
}

impl Node {
    /// What it is within, as `f64` knows it.
    pub(super) fn ring(&self, facets: &Facets, view: &View) -> Option<Ring> {
        facets.ring(self.level as usize, self.index as usize, view)
    }

    pub(super) fn is_triangle(&self, facets: &Facets) -> bool {
        self.level as usize > facets.levels.len()
    }
}

/// What is yet to be looked at, the deepest of the last opened on top.
#[derive(Default)]
pub(super) struct Descent {
    stack: Vec<Node>,
    some: Vec<u32>,
    /// Whether anything was.
    looked: bool,
}

/// Something that depth, or a negative distance, is no more than.
pub(super) trait Bounds {
    /// In 16 boxes; what is not there has NaN.
    fn of_boxes<S: Simd>(&self, simd: S, boxes: &Boxes, view: &View) -> f32x16<S>;

    /// In 16 triangles in the tool's frame. What is no more than wanted need not be close.
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Space<f32x16<S>>; 3],
        wanted: f32,
    ) -> f32x16<S>;
}

/// A part as a tool sees it.
type Seen<'a, B> = (&'a Facets, &'a B, &'a View);

impl Descent {
    pub(super) fn clear(&mut self) {
        self.stack.clear();
        self.looked = false;
    }

    /// Begins at the root.
    pub(super) fn begin(&mut self) {
        self.stack.push(Node { level: 0, index: 0, bound: f32::INFINITY });
        self.looked = true;
    }

    /// Whether it began.
    pub(super) fn looked(&self) -> bool {
        self.looked
    }

    pub(super) fn pop(&mut self) -> Option<Node> {
        self.stack.pop()
    }

    /// A triangle, and those that lie on the stack behind it: up to eight that may be deeper than that.
    pub(super) fn triangles(&mut self, facets: &Facets, first: Node, wanted: f32) -> &[u32] {
        self.some.clear();
        self.some.push(first.index);
        while self.some.len() < LANES
            && let Some(next) = self.stack.pop_if(|node| node.is_triangle(facets))
        {
            if next.bound > wanted {
                self.some.push(next.index);
            }
        }
        &self.some
    }

    /// Puts the children of a node on the stack that may be deeper than that.
    pub(super) fn open<B: Bounds>(
        &mut self,
        level: Level,
        seen: Seen<'_, B>,
        node: Node,
        wanted: f32,
    ) {
        let facets = seen.0;
        let mut bounds = [node.bound; WIDTH];
        let hits = if (node.level as usize) < facets.levels.len() {
            dispatch!(level, simd => of_boxes(simd, seen, node, wanted, &mut bounds))
        } else {
            of_leaf(level, seen, node, wanted, &mut bounds)
        };
        self.take(facets, node, hits, &bounds);
    }

    /// Puts all children of a node on the stack, where `f32` cannot hold what is known of them.
    pub(super) fn open_all(&mut self, facets: &Facets, node: Node) {
        self.take(facets, node, u32::MAX, &[node.bound; WIDTH]);
    }

    fn take(&mut self, facets: &Facets, node: Node, hits: u32, bounds: &[f32; WIDTH]) {
        let children = facets.children(node.level as usize, node.index as usize);
        let mut hits = hits & (u32::MAX >> (32 - children));
        let first = self.stack.len();
        while hits != 0 {
            let lane = hits.trailing_zeros();
            hits &= hits - 1;
            let bound = bounds[lane as usize];
            let index = node.index * WIDTH as u32 + lane;
            let child = Node { level: node.level + 1, index, bound };
            let mut at = self.stack.len();
            self.stack.push(child);
            while at > first && self.stack[at - 1].bound > bound {
                self.stack[at] = self.stack[at - 1];
                at -= 1;
            }
            self.stack[at] = child;
        }
    }
}

/// Which are more than wanted; what `f32` cannot hold may be.
#[inline(always)]
fn above<S: Simd>(bound: f32x16<S>, wanted: f32) -> u32 {
    !bound.simd_le(wanted).to_bitmask() as u32
}

#[inline(always)]
fn of_boxes<S: Simd, B: Bounds>(
    simd: S,
    (facets, bounded, view): Seen<'_, B>,
    node: Node,
    wanted: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    let boxes = &facets.levels[node.level as usize][node.index as usize];
    let bound = bounded.of_boxes(simd, boxes, view);
    bound.store_slice(bounds);
    above(bound, wanted)
}

/// Without vectors, the triangles of a leaf are as deep as it is.
fn of_leaf<B: Bounds>(
    level: Level,
    seen: Seen<'_, B>,
    node: Node,
    wanted: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    on_vectors!(level, simd => of_leaf_on(simd, seen, node, wanted, bounds));
    u32::MAX
}

#[inline(always)]
fn of_leaf_on<S: Simd, B: Bounds>(
    simd: S,
    (facets, bounded, view): Seen<'_, B>,
    node: Node,
    wanted: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    let index = node.index as usize;
    let boxes = &facets.levels[node.level as usize - 1][index / WIDTH];
    let centre = [0, 1, 2].map(|axis| boxes.centre[axis][index % WIDTH]);
    let middle = view.seen(centre);
    let Corners(corners) = &facets.leaves[index];
    let corners = [
        seen(&load(simd, &corners[0]), &view.rows, middle),
        seen(&load(simd, &corners[1]), &view.rows, middle),
        seen(&load(simd, &corners[2]), &view.rows, middle),
    ];
    let bound = bounded.of_triangles(simd, &corners, wanted);
    bound.store_slice(bounds);
    above(bound, wanted)
}
