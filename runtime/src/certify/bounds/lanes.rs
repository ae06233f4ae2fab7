//! Vectors in SIMD lanes of `f32` or `f64`, one triangle a lane.

use crate::bvh::LaneVector;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

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
pub(super) fn cross_z<S: Simd, V: SimdBase<S>>(a: &LaneVector<V>, b: &LaneVector<V>) -> V {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the point between two others at a parameter from 0 to 1.
#[inline(always)]
pub(super) fn between<S: Simd, V: SimdBase<S>>(
    from: &LaneVector<V>,
    to: &LaneVector<V>,
    at: V,
) -> LaneVector<V> {
    let direction = minus(to, from);
    [from[0] + at * direction[0], from[1] + at * direction[1], from[2] + at * direction[2]]
}

/// Returns two values, exchanged where the mask is set.
#[inline(always)]
pub(super) fn ordered<S: Simd, V: SimdBase<S>>(swap: V::Mask, first: V, last: V) -> (V, V) {
    (swap.select(last, first), swap.select(first, last))
}

/// The place between two points at which a linear function takes a value.
#[derive(Clone, Copy)]
pub(super) struct Crossing<V, M> {
    /// The parameter, from 0 to 1.
    pub(super) at: V,
    /// A mask of the lanes in which there is a crossing.
    pub(super) exists: M,
}

/// Returns the lanes in which a level is strictly between two values, in either order.
#[inline(always)]
pub(crate) fn is_between<S: Simd, V: SimdFloat<S>>(from: V, level: V, to: V) -> V::Mask {
    (from.simd_lt(level) & to.simd_gt(level)) | (from.simd_gt(level) & to.simd_lt(level))
}

/// Returns where a linear function, `from` at parameter 0 and `to` at 1, takes the value `level` strictly between.
#[inline(always)]
pub(super) fn crossing<S: Simd, V: SimdFloat<S>>(
    zero: V,
    from: V,
    to: V,
    level: V,
) -> Crossing<V, V::Mask> {
    let exists = is_between(from, level, to);
    Crossing { at: exists.select((level - from) / (to - from), zero), exists }
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
