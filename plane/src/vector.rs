//! Vectors of the half plane.

/// A point or a vector, `[d, z]`.
pub type Point = [f64; 2];

/// Returns `a - b`.
#[inline]
pub fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns the scalar product.
#[inline]
pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Returns the area of the parallelogram of `a` and `b`, above 0 if `b` is to the left of `a`.
#[inline]
pub fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the length.
#[inline]
pub fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the vector of length 1 in the same direction; NaN for 0.
#[inline]
pub fn unit(a: Point) -> Point {
    let length = norm(a);
    [a[0] / length, a[1] / length]
}

/// Returns the signed angle from `a` to `b`, above 0 to the left, from -π to π.
pub fn angle_between(a: Point, b: Point) -> f64 {
    cross(a, b).atan2(dot(a, b))
}

/// Returns the vector that is turned by an angle, to the left if it is above 0.
pub fn turned(a: Point, angle: f64) -> Point {
    let (sine, cosine) = angle.sin_cos();
    [a[0] * cosine - a[1] * sine, a[0] * sine + a[1] * cosine]
}
