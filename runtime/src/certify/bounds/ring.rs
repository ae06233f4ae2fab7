//! Bounds by the distance from a circle about the axis, in SIMD lanes, and by the lesser of two functions.

use crate::bvh::LaneVector;
use crate::certify::bounds::lanes::{
    Crossing, Real, between, choose, crossing, is_between, ordered,
};
use fearless_simd::{Select, Simd, SimdFloat, SimdMask};

/// A circle about the axis.
#[derive(Clone, Copy)]
pub(crate) struct Ring<R> {
    pub(crate) radius: R,
    pub(crate) height: R,
    /// True if the part of the circle's plane outside it counts as the ring, too.
    pub(crate) annulus: bool,
}

/// Lower and upper bounds of the distances of three corners from the axis.
pub(crate) struct AxisDistances<'a, V> {
    pub(crate) least: &'a [V; 3],
    pub(crate) greatest: &'a [V; 3],
}

/// A ring, and upper bounds on its distances from the corners of triangles.
pub(crate) struct RingDistances<R, V> {
    pub(crate) ring: Ring<R>,
    pub(crate) distance: [V; 3],
}

/// Returns upper bounds, up to rounding, on the distances of corners from a ring. The bound is convex over a triangle, so
/// its linear interpolation between corners bounds it.
#[inline(always)]
pub(crate) fn from_ring<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    [a, b, c]: &[LaneVector<V>; 3],
    from_axis: &AxisDistances<'_, V>,
    ring: Ring<R>,
) -> [V; 3] {
    let AxisDistances { least: out, greatest: far } = *from_axis;
    [
        to_ring(simd, [out[0], far[0], a[2]], ring),
        to_ring(simd, [out[1], far[1], b[2]], ring),
        to_ring(simd, [out[2], far[2], c[2]], ring),
    ]
}

/// Returns the bound of [`from_ring`] for one point: its least and greatest distance from the axis, and its height.
#[inline(always)]
pub(crate) fn to_ring<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    [out, far, z]: [V; 3],
    ring: Ring<R>,
) -> V {
    let (d, height) = (V::splat(simd, ring.radius), V::splat(simd, ring.height));
    let inward = (d - out).max(V::splat(simd, R::of(0.0)));
    let radial = if ring.annulus { inward } else { inward.max(far - d) };
    let along = z - height;
    (radial * radial + along * along).sqrt()
}

/// Returns the maximum of the lesser of two functions that are linear on each triangle, and the point where it occurs.
#[inline(always)]
pub(crate) fn under_both<S: Simd, V: SimdFloat<S>>(
    zero: V,
    corners: &[LaneVector<V>; 3],
    first: &[V; 3],
    second: &[V; 3],
) -> (V, LaneVector<V>) {
    // The lesser of two linear functions is concave: along an edge it is greatest at a corner, or where both are
    // equal. Inside it is no greater, since the line on which both are equal ends on edges.
    let (mut max, mut point) = lesser_at_corners(corners, first, second);
    for k in 0..3 {
        let next = (k + 1) % 3;
        let (from, to) = (first[k] - second[k], first[next] - second[next]);
        let Crossing { at, exists } = crossing(zero, from, to, zero);
        let here = exists.select(first[k] + at * (first[next] - first[k]), max);
        let more = here.simd_gt(max);
        max = more.select(here, max);
        point = choose(more, &between(&corners[k], &corners[next], at), &point);
    }
    (max, point)
}

/// Returns the maximum at the corners of the lesser of two functions, and the corner.
#[inline(always)]
fn lesser_at_corners<S: Simd, V: SimdFloat<S>>(
    corners: &[LaneVector<V>; 3],
    first: &[V; 3],
    second: &[V; 3],
) -> (V, LaneVector<V>) {
    let mut max = first[0].min(second[0]);
    let mut point = corners[0];
    for k in 1..3 {
        let here = first[k].min(second[k]);
        let more = here.simd_gt(max);
        max = more.select(here, max);
        point = choose(more, &corners[k], &point);
    }
    (max, point)
}

/// Returns an upper bound, up to rounding, on the lesser of a linear function and the distance from a ring at every point
/// of each triangle, and the point where it may occur. `out` are lower bounds of the corners' distances from the axis,
/// linear on the triangle.
///
/// The lesser is greatest on an edge: along a line on which the linear function is constant, the distance is convex. On
/// an edge on which the distance grows beyond the function, the excess is convex, so a chord of it ends before the two
/// are equal. Chords from there to the end of the edge come nearer.
#[inline(always)]
pub(crate) fn under_both_of_ring<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    corners: &[LaneVector<V>; 3],
    out: &[V; 3],
    linear: &[V; 3],
    RingDistances { ring, distance }: &RingDistances<R, V>,
) -> (V, LaneVector<V>) {
    let (zero, one) = (V::splat(simd, R::of(0.0)), V::splat(simd, R::of(1.0)));
    let (mut max, mut point) = lesser_at_corners(corners, linear, distance);
    for k in 0..3 {
        let next = (k + 1) % 3;
        let (first, last) = (distance[k] - linear[k], distance[next] - linear[next]);
        let crosses = is_between(first, zero, last);
        if !crosses.any_true() {
            continue;
        }
        // From the corner at which the ring is nearer than the function tells.
        let swap = first.simd_gt(zero);
        let (start, end) =
            (choose(swap, &corners[next], &corners[k]), choose(swap, &corners[k], &corners[next]));
        let out = ordered(swap, out[k], out[next]);
        let linear = ordered(swap, linear[k], linear[next]);
        let (mut excess, end_excess) = ordered(swap, first, last);
        let mut at = zero;
        let mut nearer = max;
        for _ in 0..CHORDS {
            at = at + (one - at) * (excess / (excess - end_excess));
            let [x, y, z] = between(&start, &end, at);
            let far = (x * x + y * y).sqrt();
            let here = to_ring(simd, [out.0 + at * (out.1 - out.0), far, z], *ring);
            excess = here - (linear.0 + at * (linear.1 - linear.0));
            nearer = nearer.max(here);
            // Rounding may have found the end of the chord beyond the place of equality; then it is near enough.
            excess = excess.min(zero);
        }
        at = at + (one - at) * (excess / (excess - end_excess));
        let here = nearer.max(linear.0 + at * (linear.1 - linear.0));
        let more = crosses & here.simd_gt(max);
        max = more.select(here, max);
        point = choose(more, &between(&start, &end, at), &point);
    }
    (max, point)
}

/// The number of chords by which the place of equality is enclosed.
const CHORDS: usize = 2;
