//! The points of triangles nearest to the tool's axis, and directions to them, in SIMD lanes.
//!
//! Lower bounds on distance need no exact nearest point. For any direction `n` with |n| ≤ 1, every point `p` of a
//! triangle is at a distance of at least the least `n · corner`. A rounded `n` makes the bound less tight, not wrong.
//!
//! Where the squared distance is subnormal, its root is too inaccurate to divide by. A point that near counts as on the
//! axis and has the direction 0.

use crate::bvh::LaneVector;
use crate::certify::bounds::lanes::{Real, between, choose, cross_z, dot, minus};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

/// The point of each triangle that is nearest to the axis or to a point on the axis.
pub(crate) struct NearestPoint<V> {
    pub(crate) point: LaneVector<V>,
    /// A direction away from the axis or the point, no longer than 1. It is 0 where the distance is negligible.
    pub(crate) direction: LaneVector<V>,
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

/// Returns the points of segments nearest to the origin, and their squared distances. `from_axis`: distances from the
/// axis instead of from the origin.
#[inline(always)]
pub(super) fn on_edge<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
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
