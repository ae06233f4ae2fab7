//! Vectors of any number type: of the half plane, `[d, z]`, and of space.

use super::real::Real;
use std::array::from_fn;

/// A point or vector of the half plane.
pub type Point<T> = [T; 2];

/// Returns the difference of two vectors.
pub fn sub<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    from_fn(|k| a[k].minus(&b[k]))
}

/// Returns `a + times b`.
pub fn add<T: Real, const N: usize>(a: &[T; N], b: &[T; N], times: &T) -> [T; N] {
    from_fn(|k| a[k].plus(&times.times(&b[k])))
}

/// Returns the scalar product.
pub fn dot<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    (1..N).fold(a[0].times(&b[0]), |sum, k| sum.plus(&a[k].times(&b[k])))
}

/// Returns the length; in the half plane also where the squares leave the range.
pub fn norm<T: Real, const N: usize>(a: &[T; N]) -> T {
    if N == 2 { a[0].hypot(&a[1]) } else { dot(a, a).root() }
}

/// Returns the distance between two points.
pub fn distance<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    norm(&sub(a, b))
}

/// Returns a vector as a unit vector; +z if it vanishes.
pub fn unit<T: Real, const N: usize>(a: &[T; N]) -> [T; N] {
    let length = norm(a);
    if length > T::zero() {
        from_fn(|k| a[k].over(&length))
    } else {
        from_fn(|k| T::exactly(if k + 1 == N { 1.0 } else { 0.0 }))
    }
}

/// Returns the third component of the vector product: positive if `b` is on the left of `a`.
pub fn cross<T: Real>(a: &Point<T>, b: &Point<T>) -> T {
    a[0].times(&b[1]).minus(&a[1].times(&b[0]))
}

/// Returns the vector product in space.
pub fn vector_product<T: Real>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i].times(&b[j]).minus(&a[j].times(&b[i])))
}

/// Returns the vector a quarter turn to the left.
pub fn left<T: Real>([d, z]: &Point<T>) -> Point<T> {
    [z.negated(), d.clone()]
}

/// Returns the vector a quarter turn to the right: out of the material on the left of a tangent.
pub fn right<T: Real>([d, z]: &Point<T>) -> Point<T> {
    [z.clone(), d.negated()]
}

/// Returns the vector with the other sign.
pub fn opposite<T: Real>([d, z]: &Point<T>) -> Point<T> {
    [d.negated(), z.negated()]
}

/// Returns a vector turned counter-clockwise by an angle (rad).
pub fn turned([d, z]: &Point<f64>, angle: f64) -> Point<f64> {
    let (sin, cos) = angle.sin_cos();
    [d * cos - z * sin, d * sin + z * cos]
}
