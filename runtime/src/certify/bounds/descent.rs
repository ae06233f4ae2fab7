//! The way down a tree of triangles, the deepest first.

use crate::bvh::{Boxes, PoseTransform, WIDTH, extent, load, seen};
use crate::certify::bounds::nearest::Space;
use crate::certify::part::Ring;
use crate::certify::part::{Corners, Facets};
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, SimdMask, dispatch, f32x16};

/// A node of the tree, a leaf or a triangle, and how deep the tool can be in it.
#[derive(Clone, Copy)]
pub(crate) struct Node {
    /// That of its children; leaves are those whose children are triangles.
    pub(crate) level: u32,
    pub(crate) index: u32,
    pub(crate) bound: f32,
}

impl Node {
    /// What it is within, as `f64` knows it.
    pub(crate) fn ring(&self, facets: &Facets, view: &PoseTransform) -> Option<Ring> {
        facets.ring(self.level as usize, self.index as usize, view)
    }

    /// The flat faces that all its triangles are of, if these are few.
    pub(crate) fn faces<'a>(&self, facets: &'a Facets) -> Option<&'a [u32]> {
        facets.flats.of_node(self.level as usize, self.index as usize)
    }

    /// Half the diagonal of its box, in the tree's unit.
    pub(crate) fn size(&self, facets: &Facets) -> f64 {
        let Some(level) = self.level.checked_sub(1) else { return f64::INFINITY };
        let (node, lane) = (self.index as usize / WIDTH, self.index as usize % WIDTH);
        let half = &facets.levels[level as usize][node].half;
        half.iter().map(|list| f64::from(list[lane]).powi(2)).sum::<f64>().sqrt()
    }

    /// Those of its children that a bit says.
    pub(crate) fn children(self, facets: &Facets, hits: u32) -> impl Iterator<Item = Node> + use<> {
        let children = facets.children(self.level as usize, self.index as usize);
        let there = (0..children as u32).filter(move |lane| hits >> lane & 1 == 1);
        let first = self.index * WIDTH as u32;
        there.map(move |lane| Node { level: self.level + 1, index: first + lane, ..self })
    }

    /// The corners of a leaf's triangles in the tool's frame.
    #[inline(always)]
    pub(crate) fn corners<S: Simd>(
        &self,
        simd: S,
        facets: &Facets,
        view: &PoseTransform,
    ) -> [Space<f32x16<S>>; 3] {
        let index = self.index as usize;
        let boxes = &facets.levels[self.level as usize - 1][index / WIDTH];
        let lane = index % WIDTH;
        let centre = [boxes.centre[0][lane], boxes.centre[1][lane], boxes.centre[2][lane]];
        let middle = view.seen(centre);
        let Corners([a, b, c]) = &facets.leaves[index];
        [
            seen(&load(simd, a), &view.rows, middle),
            seen(&load(simd, b), &view.rows, middle),
            seen(&load(simd, c), &view.rows, middle),
        ]
    }

    /// Whether its children are triangles.
    pub(crate) fn is_leaf(&self, facets: &Facets) -> bool {
        self.level as usize == facets.levels.len()
    }

    pub(crate) fn is_triangle(&self, facets: &Facets) -> bool {
        self.level as usize > facets.levels.len()
    }
}

/// What is yet to be looked at, the deepest of the last opened on top.
#[derive(Default)]
pub(crate) struct Descent {
    stack: Vec<Node>,
    some: Vec<u32>,
    /// Whether anything was.
    looked: bool,
}

/// Something that depth, or a negative distance, is no more than in boxes.
pub(crate) trait BoxBounds {
    /// In 16 boxes; what is not there has NaN. What is no more than wanted need not be close.
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        boxes: &Boxes,
        view: &PoseTransform,
        wanted: f32,
    ) -> f32x16<S>;
}

/// The same in boxes and triangles.
pub(crate) trait Bounds: BoxBounds {
    /// In 16 triangles in the tool's frame. What is no more than wanted need not be close.
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Space<f32x16<S>>; 3],
        wanted: f32,
    ) -> f32x16<S>;
}

/// What boxes are within, as the axis has it: no place is nearer or farther, or beyond these heights.
pub(crate) struct Rings<V> {
    pub(crate) near: V,
    pub(crate) far: V,
    pub(crate) low: V,
    pub(crate) high: V,
}

/// How far places go, in the tool's frame: straight, and by a turn about an axis through the tip.
#[derive(Clone, Copy, Default)]
pub(crate) struct Shift {
    /// The axis of the turn.
    pub(crate) axis: [f32; 3],
    pub(crate) straight: [f32; 3],
    pub(crate) length: f32,
    pub(crate) turn: f32,
    /// No place that matters is farther from the axis of the turn.
    pub(crate) reach: f32,
}

impl Shift {
    /// How far the ways are from straight of places that are so far from the axis of the turn.
    #[inline(always)]
    pub(crate) fn curve<S: Simd>(&self, simd: S, far: f32x16<S>) -> f32x16<S> {
        let reach = f32x16::splat(simd, self.reach).min(far + self.length);
        (reach * (0.5 * self.turn) + self.length) * self.turn
    }
}

/// The rings of boxes, if so on all their way.
#[inline(always)]
pub(crate) fn rings<S: Simd>(
    simd: S,
    boxes: &Boxes,
    view: &PoseTransform,
    shift: Option<&Shift>,
) -> Rings<f32x16<S>> {
    let centre = load(simd, &boxes.centre);
    let half = load(simd, &boxes.half);
    let [x, y, z] = seen(&centre, &view.rows, view.origin);
    let zero = f32x16::splat(simd, 0.0);
    let (x, y) = (x.abs(), y.abs());
    let rows = &view.rows;
    let mut wide = [extent(&half, rows[0]), extent(&half, rows[1]), extent(&half, rows[2])];
    if let Some(shift) = shift {
        let reach = f32x16::splat(simd, shift.reach);
        let far = [x + wide[0], y + wide[1], z.abs() + wide[2]];
        // No part of `axis × p` is larger than these.
        let [u, v, w] = shift.axis.map(f32::abs);
        let across = [far[2] * v + far[1] * w, far[2] * u + far[0] * w, far[0] * v + far[1] * u];
        let curve = shift.curve(simd, across[0] + across[1] + across[2]);
        for axis in 0..3 {
            let turned = reach.min(across[axis]) * shift.turn;
            wide[axis] = wide[axis] + turned + shift.straight[axis] + curve;
        }
    }
    let (near_x, near_y) = ((x - wide[0]).max(zero), (y - wide[1]).max(zero));
    let (far_x, far_y) = (x + wide[0], y + wide[1]);
    Rings {
        near: (near_x * near_x + near_y * near_y).sqrt(),
        far: (far_x * far_x + far_y * far_y).sqrt(),
        low: z - wide[2],
        high: z + wide[2],
    }
}

/// A part as a tool sees it.
pub(crate) type Seen<'a, B> = (&'a Facets, &'a B, &'a PoseTransform);

impl Descent {
    pub(crate) fn clear(&mut self) {
        self.stack.clear();
        self.looked = false;
    }

    /// Begins at the root.
    pub(crate) fn begin(&mut self) {
        self.stack.push(Node { level: 0, index: 0, bound: f32::INFINITY });
        self.looked = true;
    }

    /// Whether it began.
    pub(crate) fn looked(&self) -> bool {
        self.looked
    }

    pub(crate) fn pop(&mut self) -> Option<Node> {
        self.stack.pop()
    }

    /// A triangle, and those that lie on the stack behind it: up to eight that may be deeper than that.
    pub(crate) fn triangles(&mut self, facets: &Facets, first: Node, wanted: f32) -> &mut Vec<u32> {
        self.some.clear();
        self.some.push(first.index);
        while self.some.len() < LANES
            && let Some(next) = self.stack.pop_if(|node| node.is_triangle(facets))
        {
            if next.bound > wanted || next.bound.is_nan() {
                self.some.push(next.index);
            }
        }
        &mut self.some
    }

    /// Puts the children of a node on the stack that may be deeper than that.
    pub(crate) fn open<B: Bounds>(
        &mut self,
        level: Level,
        seen: Seen<'_, B>,
        node: Node,
        wanted: f32,
    ) {
        let facets = seen.0;
        let mut bounds = [node.bound; WIDTH];
        let hits = if node.is_leaf(facets) {
            of_leaf(level, seen, node, wanted, &mut bounds)
        } else {
            of_children(level, seen, node, wanted, &mut bounds)
        };
        self.take(facets, node, hits, &bounds);
    }

    /// Puts all children of a node on the stack, where `f32` cannot hold what is known of them.
    pub(crate) fn open_all(&mut self, facets: &Facets, node: Node) {
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
pub(crate) fn above<S: Simd>(bound: f32x16<S>, wanted: f32) -> u32 {
    !bound.simd_le(wanted).to_bitmask() as u32
}

/// Which children of a node, that are boxes, may be more than wanted.
pub(crate) fn of_children<B: BoxBounds>(
    level: Level,
    seen: Seen<'_, B>,
    node: Node,
    wanted: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    dispatch!(level, simd => of_boxes(simd, seen, node, wanted, bounds))
}

#[inline(always)]
fn of_boxes<S: Simd, B: BoxBounds>(
    simd: S,
    (facets, bounded, view): Seen<'_, B>,
    node: Node,
    wanted: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    let boxes = &facets.levels[node.level as usize][node.index as usize];
    let bound = bounded.of_boxes(simd, boxes, view, wanted);
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
    let corners = node.corners(simd, facets, view);
    let bound = bounded.of_triangles(simd, &corners, wanted);
    bound.store_slice(bounds);
    above(bound, wanted)
}
