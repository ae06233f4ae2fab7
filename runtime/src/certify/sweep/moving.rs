//! Bounds of moving boxes and triangles against a hull, 16 at a time in `f32`.

use crate::bvh::{Boxes, LaneVector, PoseTransform};
use crate::certify::bounds::descent::{BoxBounds, DescentInput, Displacement, Node, above, rings};
use crate::certify::bounds::hull::Hull;
use crate::tool::on_vectors;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, f32x16};

/// A hull and the motion of boxes past it.
pub(super) struct Moving<'a> {
    pub(super) hull: &'a Hull<f32>,
    pub(super) shift: Displacement,
    pub(super) required_clearance: f32,
    /// The transforms at the beginning and at the end of the interval.
    pub(super) ends: &'a [PoseTransform; 2],
}

impl BoxBounds for Moving<'_> {
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        boxes: &Boxes,
        view: &PoseTransform,
        threshold: f32,
    ) -> f32x16<S> {
        self.hull.of_rings(simd, &rings(simd, boxes, view, Some(&self.shift)), threshold)
    }
}

/// Returns a bit mask of the triangles of a leaf whose bound may exceed `threshold`.
pub(super) fn of_leaf(
    level: Level,
    input: DescentInput<'_, Moving<'_>>,
    node: Node,
    threshold: f32,
) -> u32 {
    on_vectors!(level, simd => of_leaf_on(simd, input, node, threshold));
    u32::MAX
}

#[inline(always)]
fn of_leaf_on<S: Simd>(
    simd: S,
    (bvh, moving, view): DescentInput<'_, Moving<'_>>,
    node: Node,
    threshold: f32,
) -> u32 {
    let [a, b, c] = node.corners(simd, bvh, &moving.ends[0]);
    let [d, e, f] = node.corners(simd, bvh, &moving.ends[1]);
    let middle = node.corners(simd, bvh, view);
    let [u, v, w] = moving.shift.axis;
    let square = |&[x, y, z]: &LaneVector<f32x16<S>>| {
        let [a, b, c] = [y * w - z * v, z * u - x * w, x * v - y * u];
        c * c + b * b + a * a
    };
    let [p, q, r] = middle.each_ref().map(square);
    let far = p.max(q).max(r).sqrt();
    let grow = moving.shift.deviation_bound(simd, far) + moving.required_clearance;
    let ends = [a, b, c, d, e, f];
    above(moving.hull.swept(simd, (&ends, &middle), grow, threshold), threshold)
}
