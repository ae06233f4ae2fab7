//! Geometry of triangles relative to the tool's axis, in SIMD lanes of `f32` or `f64`: nearest points, cuts between two
//! heights, and bounds that are linear on a triangle.
//!
//! Lower bounds on distance need no exact nearest point. For any direction `n` with |n| ≤ 1, every point `p` of a
//! triangle is at a distance of at least the least `n · corner`. A rounded `n` makes the bound less tight, not wrong.
//!
//! Where the squared distance is subnormal, its root is too inaccurate to divide by. A point that near counts as on the
//! axis and has the direction 0.

use crate::bvh::LaneVector;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

/// A scalar type that SIMD vectors have as elements.
pub(crate) trait Real: Copy + PartialOrd {
    /// The length to which directions are scaled, so that rounding makes none longer than 1. With unit roundoff u, the
    /// sum of squares errs by at most 3u, so its root by 1.5u and u for rounding it. The division and the
    /// multiplication add u each: less than 5u in total. This is 1 - 8u.
    const SHRINK: Self;
    /// The smallest positive normal number, which replaces a divisor of 0.
    const MIN_POSITIVE_VALUE: Self;
    /// The largest distance that counts as 0. Squares of larger ones are 64 times the smallest normal number, so the
    /// absolute error of subnormal terms, half a unit of the last place each, is less than u/20 of their sum.
    const NEGLIGIBLE_DISTANCE: Self;

    fn of(value: f64) -> Self;

    /// Returns the length of a vector in the plane.
    fn norm(x: Self, y: Self) -> Self;
}

impl Real for f32 {
    const SHRINK: f32 = 1.0 - 4.0 * f32::EPSILON;
    const MIN_POSITIVE_VALUE: f32 = f32::MIN_POSITIVE;
    /// 2⁻⁶⁰
    const NEGLIGIBLE_DISTANCE: f32 = f32::from_bits((127 - 60) << 23);

    fn of(value: f64) -> f32 {
        value as f32
    }

    fn norm(x: f32, y: f32) -> f32 {
        (x * x + y * y).sqrt()
    }
}

impl Real for f64 {
    const SHRINK: f64 = 1.0 - 4.0 * f64::EPSILON;
    const MIN_POSITIVE_VALUE: f64 = f64::MIN_POSITIVE;
    /// 2⁻⁵⁰⁸
    const NEGLIGIBLE_DISTANCE: f64 = f64::from_bits((1023 - 508) << 52);

    fn of(value: f64) -> f64 {
        value
    }

    fn norm(x: f64, y: f64) -> f64 {
        (x * x + y * y).sqrt()
    }
}

/// The point of each triangle that is nearest to the axis or to a point on the axis.
pub(crate) struct NearestPoint<V> {
    pub(crate) point: LaneVector<V>,
    /// A direction away from the axis or the point, no longer than 1. It is 0 where the distance is negligible.
    pub(crate) direction: LaneVector<V>,
}

#[inline(always)]
pub(crate) fn min3<S: Simd, V: SimdFloat<S>>(a: V, b: V, c: V) -> V {
    a.min(b).min(c)
}

#[inline(always)]
pub(crate) fn max3<S: Simd, V: SimdFloat<S>>(a: V, b: V, c: V) -> V {
    a.max(b).max(c)
}

/// Selects `a` where the mask is set, and `b` elsewhere.
#[inline(always)]
pub(crate) fn choose<S: Simd, V: SimdBase<S>>(
    mask: V::Mask,
    a: &LaneVector<V>,
    b: &LaneVector<V>,
) -> LaneVector<V> {
    [mask.select(a[0], b[0]), mask.select(a[1], b[1]), mask.select(a[2], b[2])]
}

#[inline(always)]
pub(crate) fn minus<S: Simd, V: SimdBase<S>>(
    a: &LaneVector<V>,
    b: &LaneVector<V>,
) -> LaneVector<V> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn dot<S: Simd, V: SimdBase<S>>(a: &LaneVector<V>, b: &LaneVector<V>) -> V {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<S: Simd, V: SimdBase<S>>(
    a: &LaneVector<V>,
    b: &LaneVector<V>,
) -> LaneVector<V> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the z component of the cross product.
#[inline(always)]
fn cross_z<S: Simd, V: SimdBase<S>>(a: &LaneVector<V>, b: &LaneVector<V>) -> V {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the points of segments nearest to the origin, and their squared distances. `from_axis`: distances from the
/// axis instead of from the origin.
#[inline(always)]
fn on_edge<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    a: &LaneVector<V>,
    b: &LaneVector<V>,
    from_axis: bool,
) -> (LaneVector<V>, V) {
    let direction = minus(b, a);
    let length =
        dot_from_axis(&direction, &direction, from_axis).max(V::splat(simd, R::MIN_POSITIVE_VALUE));
    let at = (-dot_from_axis(a, &direction, from_axis) / length).max(V::splat(simd, R::of(0.0)));
    let at = at.min(V::splat(simd, R::of(1.0)));
    let p = between(a, b, at);
    (p, dot_from_axis(&p, &p, from_axis))
}

#[inline(always)]
fn dot_from_axis<S: Simd, V: SimdBase<S>>(
    a: &LaneVector<V>,
    b: &LaneVector<V>,
    from_axis: bool,
) -> V {
    let radial = a[0] * b[0] + a[1] * b[1];
    if from_axis { radial } else { radial + a[2] * b[2] }
}

/// Returns the nearest of the points of [`on_edge`] on the three edges of each triangle.
#[inline(always)]
fn on_edges<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    [a, b, c]: [&LaneVector<V>; 3],
    from_axis: bool,
) -> (LaneVector<V>, V) {
    let (p, square) = on_edge(simd, a, b, from_axis);
    let (q, other) = on_edge(simd, b, c, from_axis);
    let nearer = other.simd_lt(square);
    let (p, square) = (choose(nearer, &q, &p), nearer.select(other, square));
    let (q, other) = on_edge(simd, c, a, from_axis);
    let nearer = other.simd_lt(square);
    (choose(nearer, &q, &p), nearer.select(other, square))
}

impl<V: Copy> NearestPoint<V> {
    /// Computes the points of triangles nearest to the axis.
    #[inline(always)]
    pub(crate) fn to_axis<S: Simd, R: Real>(
        simd: S,
        [a, b, c]: &[LaneVector<V>; 3],
    ) -> NearestPoint<V>
    where
        V: SimdFloat<S, Element = R>,
    {
        let (zero, negligible) =
            (V::splat(simd, R::of(0.0)), V::splat(simd, R::NEGLIGIBLE_DISTANCE));
        let (point, square) = on_edges(simd, [a, b, c], true);
        // The axis passes through triangles that have it on the same side of all edges.
        let (u, v, w) = (cross_z(b, c), cross_z(c, a), cross_z(a, b));
        let through = (u.simd_gt(zero) & v.simd_gt(zero) & w.simd_gt(zero))
            | (u.simd_lt(zero) & v.simd_lt(zero) & w.simd_lt(zero));
        // The areas opposite the corners are the barycentric coordinates of the point on the axis.
        let z = (u * a[2] + v * b[2] + w * c[2]) / (u + v + w);
        let distance = square.sqrt();
        let scale = (through | distance.simd_le(negligible))
            .select(zero, V::splat(simd, R::SHRINK) / distance);
        let direction = [point[0] * scale, point[1] * scale, zero];
        NearestPoint { point: choose(through, &[zero, zero, z], &point), direction }
    }

    /// Computes the points of triangles nearest to a point on the axis.
    #[inline(always)]
    pub(crate) fn to_axis_point<S: Simd, R: Real>(
        simd: S,
        [a, b, c]: &[LaneVector<V>; 3],
        z: R,
    ) -> NearestPoint<V>
    where
        V: SimdFloat<S, Element = R>,
    {
        let zero = V::splat(simd, R::of(0.0));
        let centre = V::splat(simd, z);
        let a = [a[0], a[1], a[2] - centre];
        let b = [b[0], b[1], b[2] - centre];
        let c = [c[0], c[1], c[2] - centre];
        // Relative to the point on the axis, the nearest points are those nearest to the origin.
        let (edge, _) = on_edges(simd, [&a, &b, &c], false);
        // The foot on the plane, in barycentric coordinates times a positive number.
        let (ab, ac) = (minus(&b, &a), minus(&c, &a));
        let (bb, bc, cc) = (dot(&ab, &ab), dot(&ab, &ac), dot(&ac, &ac));
        let (to_b, to_c) = (-dot(&a, &ab), -dot(&a, &ac));
        let whole = bb * cc - bc * bc;
        let (v, w) = (cc * to_b - bc * to_c, bb * to_c - bc * to_b);
        let within = v.simd_gt(zero) & w.simd_gt(zero) & (v + w).simd_lt(whole);
        let (v, w) = (v / whole, w / whole);
        let foot = [
            a[0] + v * ab[0] + w * ac[0],
            a[1] + v * ab[1] + w * ac[1],
            a[2] + v * ab[2] + w * ac[2],
        ];
        let point = choose(within, &foot, &edge);
        NearestPoint {
            point: [point[0], point[1], point[2] + centre],
            direction: direction_from_axis(simd, &point, zero),
        }
    }
}

/// The part of each triangle between two heights, as a polygon: the corners within the heights, which are included,
/// and the points where sides cross a height. Polygons below and above the same height have the same crossing points, so
/// no gap is left.
pub(crate) struct Clip<V, M> {
    kept: [M; 3],
    /// Per side: the cuts at the lower and at the upper height.
    cuts: [[Crossing<V, M>; 2]; 3],
}

/// The place between two points at which a linear function takes a value.
#[derive(Clone, Copy)]
struct Crossing<V, M> {
    /// The parameter, from 0 to 1.
    at: V,
    /// A mask of the lanes in which there is a crossing.
    exists: M,
}

impl<V: Copy, M: Copy> Clip<V, M> {
    #[inline(always)]
    pub(crate) fn new<S: Simd, R: Real>(
        simd: S,
        [a, b, c]: &[LaneVector<V>; 3],
        [low, high]: [R; 2],
    ) -> Clip<V, M>
    where
        V: SimdFloat<S, Element = R> + SimdBase<S, Mask = M>,
        M: SimdMask<S>,
    {
        let zero = V::splat(simd, R::of(0.0));
        let (low, high) = (V::splat(simd, low), V::splat(simd, high));
        let kept = [
            a[2].simd_ge(low) & a[2].simd_le(high),
            b[2].simd_ge(low) & b[2].simd_le(high),
            c[2].simd_ge(low) & c[2].simd_le(high),
        ];
        let cuts = [
            [crossing(zero, a[2], b[2], low), crossing(zero, a[2], b[2], high)],
            [crossing(zero, b[2], c[2], low), crossing(zero, b[2], c[2], high)],
            [crossing(zero, c[2], a[2], low), crossing(zero, c[2], a[2], high)],
        ];
        Clip { kept, cuts }
    }

    /// Returns the maximum of a function that is linear on each triangle.
    #[inline(always)]
    pub(crate) fn max_linear<S: Simd, R: Real>(&self, simd: S, values: [V; 3]) -> V
    where
        V: SimdFloat<S, Element = R> + SimdBase<S, Mask = M>,
        M: SimdMask<S> + Select<V>,
    {
        let none = V::splat(simd, R::of(f64::NEG_INFINITY));
        let mut max = none;
        for k in 0..3 {
            let (from, to) = (values[k], values[(k + 1) % 3]);
            max = max.max(self.kept[k].select(from, none));
            for Crossing { at, exists } in self.cuts[k] {
                max = max.max(exists.select(from + at * (to - from), none));
            }
        }
        max
    }

    /// Returns the point nearest to the axis on the cut at the lower height, or at the upper height where the mask is
    /// set. If the height passes through a corner, it is some point of the triangle: the bounds taken in its direction
    /// are valid but less tight.
    #[inline(always)]
    pub(crate) fn at_end<S: Simd, R: Real>(
        &self,
        simd: S,
        corners: &[LaneVector<V>; 3],
        upper: M,
    ) -> LaneVector<V>
    where
        V: SimdFloat<S, Element = R> + SimdBase<S, Mask = M>,
        M: SimdMask<S> + Select<V>,
    {
        let [a, b, c] = corners;
        let (first, is_first) = cut_at(a, b, &self.cuts[0], upper);
        let (second, _) = cut_at(b, c, &self.cuts[1], upper);
        let (third, is_third) = cut_at(c, a, &self.cuts[2], upper);
        // Two of the three sides are cut, unless a corner lies at the height itself.
        let from = choose(is_first, &first, &second);
        let to = choose(is_third, &third, &second);
        on_edge(simd, &from, &to, true).0
    }
}

/// Returns the cut of a side at the lower height, or at the upper height where the mask is set, and a mask of its
/// existence.
#[inline(always)]
fn cut_at<S: Simd, V: SimdBase<S>>(
    from: &LaneVector<V>,
    to: &LaneVector<V>,
    [low, high]: &[Crossing<V, V::Mask>; 2],
    upper: V::Mask,
) -> (LaneVector<V>, V::Mask) {
    let point = between(from, to, upper.select(high.at, low.at));
    (point, (upper & high.exists) | (!upper & low.exists))
}

/// Returns the lanes in which a level is strictly between two values, in either order.
#[inline(always)]
pub(crate) fn is_between<S: Simd, V: SimdFloat<S>>(from: V, level: V, to: V) -> V::Mask {
    (from.simd_lt(level) & to.simd_gt(level)) | (from.simd_gt(level) & to.simd_lt(level))
}

/// Returns where a linear function, `from` at parameter 0 and `to` at 1, takes the value `level` strictly between.
#[inline(always)]
fn crossing<S: Simd, V: SimdFloat<S>>(zero: V, from: V, to: V, level: V) -> Crossing<V, V::Mask> {
    let exists = is_between(from, level, to);
    Crossing { at: exists.select((level - from) / (to - from), zero), exists }
}

/// Returns the direction of a point from the point of the axis at height `z`, no longer than 1, and 0 where the distance
/// is negligible.
#[inline(always)]
pub(crate) fn direction_from_axis<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    point: &LaneVector<V>,
    z: V,
) -> LaneVector<V> {
    let (zero, negligible) = (V::splat(simd, R::of(0.0)), V::splat(simd, R::NEGLIGIBLE_DISTANCE));
    let direction = [point[0], point[1], point[2] - z];
    let distance = dot(&direction, &direction).sqrt();
    let scale = distance.simd_gt(negligible).select(V::splat(simd, R::SHRINK) / distance, zero);
    [direction[0] * scale, direction[1] * scale, direction[2] * scale]
}

/// Returns the extents of three corners along a direction perpendicular to the axis.
#[inline(always)]
pub(crate) fn radial_extents<S: Simd, V: SimdBase<S>>(
    [a, b, c]: &[LaneVector<V>; 3],
    direction: &LaneVector<V>,
) -> [V; 3] {
    [
        a[0] * direction[0] + a[1] * direction[1],
        b[0] * direction[0] + b[1] * direction[1],
        c[0] * direction[0] + c[1] * direction[1],
    ]
}

/// Returns the extents of three corners along a direction, relative to the axis point at height `z`.
#[inline(always)]
pub(crate) fn extents_from<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    corners: &[LaneVector<V>; 3],
    direction: &LaneVector<V>,
    z: R,
) -> [V; 3] {
    let [a, b, c] = corners;
    let out = radial_extents(corners, direction);
    let centre = V::splat(simd, z);
    [
        out[0] + (a[2] - centre) * direction[2],
        out[1] + (b[2] - centre) * direction[2],
        out[2] + (c[2] - centre) * direction[2],
    ]
}

/// Returns the distances of corners from the axis.
#[inline(always)]
pub(crate) fn distances<S: Simd, V: SimdFloat<S>>([a, b, c]: &[LaneVector<V>; 3]) -> [V; 3] {
    [
        (a[0] * a[0] + a[1] * a[1]).sqrt(),
        (b[0] * b[0] + b[1] * b[1]).sqrt(),
        (c[0] * c[0] + c[1] * c[1]).sqrt(),
    ]
}

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

/// Returns two values, exchanged where the mask is set.
#[inline(always)]
fn ordered<S: Simd, V: SimdBase<S>>(swap: V::Mask, first: V, last: V) -> (V, V) {
    (swap.select(last, first), swap.select(first, last))
}

/// Returns the point between two others at a parameter from 0 to 1.
#[inline(always)]
fn between<S: Simd, V: SimdBase<S>>(
    from: &LaneVector<V>,
    to: &LaneVector<V>,
    at: V,
) -> LaneVector<V> {
    let direction = minus(to, from);
    [from[0] + at * direction[0], from[1] + at * direction[1], from[2] + at * direction[2]]
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

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch, f32x16, f64x8};

    #[test]
    fn directions_are_no_longer_than_1_at_any_distance() {
        dispatch!(Level::new(), simd => {
            check::<_, f32, f32x16<_>>(simd, -150, |lanes| f64::from(lanes[0]));
            check::<_, f64, f64x8<_>>(simd, -1080, |lanes| lanes[0]);
        });
    }

    /// Compares directions of points and of triangles whose nearest corner is 2^`min_exponent` and more from the axis.
    fn check<S: Simd, R: Real, V>(simd: S, min_exponent: i32, first: impl Fn(V) -> f64)
    where
        V: SimdFloat<S, Element = R>,
    {
        let (mut longest, mut directions) = (0.0f64, 0);
        for exponent in min_exponent..10 {
            for step in 0..40 {
                let (sine, cosine) = (0.37 * f64::from(step)).sin_cos();
                let distance = 2f64.powi(exponent) * (1.0 + f64::from(step) / 40.0);
                let vector = |p: [f64; 3]| p.map(|coordinate| V::splat(simd, R::of(coordinate)));
                let point = [distance * cosine, distance * sine, 0.0];
                // The corner is nearest to the axis and to the origin: the others are farther out.
                let corner = |z: f64| [point[0] + cosine, point[1] + sine, z];
                let triangle = [vector(point), vector(corner(1.0)), vector(corner(-1.0))];
                let zero = R::of(0.0);
                for direction in [
                    direction_from_axis(simd, &triangle[0], V::splat(simd, zero)),
                    NearestPoint::to_axis(simd, &triangle).direction,
                    NearestPoint::to_axis_point(simd, &triangle, zero).direction,
                ] {
                    let length =
                        direction.map(&first).iter().map(|part| part * part).sum::<f64>().sqrt();
                    longest = longest.max(length);
                    directions += usize::from(length > 0.9);
                }
            }
        }
        assert!(longest <= 1.0 && directions > 1000, "{longest} in {directions}");
    }

    #[test]
    fn the_nearest_point_inside_a_triangle_is_its_foot() {
        dispatch!(Level::new(), simd => {
            let at = |p: [f64; 3]| p.map(|part| f64x8::splat(simd, part));
            let triangle = [at([1.0, -2.0, -1.0]), at([1.0, 3.0, -1.0]), at([1.0, 1.0, 2.0])];
            let found = NearestPoint::to_axis_point(simd, &triangle, 0.0).point.map(|part| part[0]);
            let is_near = |(found, expected): (&f64, f64)| (found - expected).abs() < 1e-12;
            assert!(found.iter().zip([1.0, 0.0, 0.0]).all(is_near), "{found:?}");
        });
    }
}
