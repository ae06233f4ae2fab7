//! Tests of directions at distances whose squares underflow.

use super::nearest::{NearestPoint, Real, direction_from_axis};
use fearless_simd::{Level, Simd, SimdFloat, dispatch, f32x16, f64x8};

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
