//! Boxes and triangles on their way past a hull, 16 at a time in `f32`.

use crate::bvh::{Boxes, PoseTransform};
use crate::certify::bounds::descent::{BoxBounds, Node, Seen, Shift, above, rings};
use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::nearest::Space;
use crate::tool::on_vectors;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, f32x16};

/// A hull past which boxes move.
pub(super) struct Moving<'a> {
    pub(super) hull: &'a Hull<f32>,
    pub(super) shift: Shift,
    pub(super) keep: f32,
    /// The part at the beginning and at the end.
    pub(super) ends: &'a [PoseTransform; 2],
}

impl BoxBounds for Moving<'_> {
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        boxes: &Boxes,
        view: &PoseTransform,
        wanted: f32,
    ) -> f32x16<S> {
        self.hull.of_rings(simd, &rings(simd, boxes, view, Some(&self.shift)), wanted)
    }
}

/// Which triangles of a leaf may be more than wanted.
pub(super) fn of_leaf(level: Level, seen: Seen<'_, Moving<'_>>, node: Node, wanted: f32) -> u32 {
    on_vectors!(level, simd => of_leaf_on(simd, seen, node, wanted));
    u32::MAX
}

#[inline(always)]
fn of_leaf_on<S: Simd>(
    simd: S,
    (facets, moving, view): Seen<'_, Moving<'_>>,
    node: Node,
    wanted: f32,
) -> u32 {
    let [a, b, c] = node.corners(simd, facets, &moving.ends[0]);
    let [d, e, f] = node.corners(simd, facets, &moving.ends[1]);
    let middle = node.corners(simd, facets, view);
    let [u, v, w] = moving.shift.axis;
    let square = |&[x, y, z]: &Space<f32x16<S>>| {
        let [a, b, c] = [y * w - z * v, z * u - x * w, x * v - y * u];
        c * c + b * b + a * a
    };
    let [p, q, r] = middle.each_ref().map(square);
    let far = p.max(q).max(r).sqrt();
    let grow = moving.shift.curve(simd, far) + moving.keep;
    let ends = [a, b, c, d, e, f];
    above(moving.hull.swept(simd, (&ends, &middle), grow, wanted), wanted)
}
