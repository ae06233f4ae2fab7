//! Vectors of the half plane `[d, z]`.

use super::real::Real;

/// A point or vector of the half plane.
pub type Point<T> = [T; 2];

/// Returns the difference of two vectors.
pub fn sub<T: Real>(a: &Point<T>, b: &Point<T>) -> Point<T> {
    [a[0].minus(&b[0]), a[1].minus(&b[1])]
}

/// Returns `a + times b`.
pub fn add<T: Real>(a: &Point<T>, b: &Point<T>, times: &T) -> Point<T> {
    [a[0].plus(&times.times(&b[0])), a[1].plus(&times.times(&b[1]))]
}

/// Returns the scalar product.
pub fn dot<T: Real>(a: &Point<T>, b: &Point<T>) -> T {
    a[0].times(&b[0]).plus(&a[1].times(&b[1]))
}

/// Returns the third component of the vector product: positive if `b` is on the left of `a`.
pub fn cross<T: Real>(a: &Point<T>, b: &Point<T>) -> T {
    a[0].times(&b[1]).minus(&a[1].times(&b[0]))
}

/// Returns the length.
pub fn norm<T: Real>(a: &Point<T>) -> T {
    a[0].hypot(&a[1])
}

/// Returns a vector as a unit vector; +z if it vanishes.
pub fn unit<T: Real>(a: &Point<T>) -> Point<T> {
    let length = norm(a);
    if length > T::zero() {
        [a[0].over(&length), a[1].over(&length)]
    } else {
        [T::zero(), T::exactly(1.0)]
    }
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
