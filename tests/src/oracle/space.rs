//! Vectors of space in 256 bits.

use super::big::Big;

/// A point or vector in space.
pub type Triple = [Big; 3];

/// Returns a vector of doubles, each exactly.
pub fn exactly(v: impl Into<[f64; 3]>) -> Triple {
    v.into().map(Big::exactly)
}

/// Returns the sum of two vectors.
pub fn add(a: &Triple, b: &Triple) -> Triple {
    [0, 1, 2].map(|k| &a[k] + &b[k])
}

/// Returns the difference of two vectors.
pub fn sub(a: &Triple, b: &Triple) -> Triple {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

/// Returns a multiple of a vector.
pub fn times(a: &Triple, factor: &Big) -> Triple {
    a.each_ref().map(|component| component * factor)
}

/// Returns the scalar product.
pub fn dot(a: &Triple, b: &Triple) -> Big {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

/// Returns the vector product.
pub fn cross(a: &Triple, b: &Triple) -> Triple {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| &(&a[i] * &b[j]) - &(&a[j] * &b[i]))
}

/// Returns the length.
pub fn norm(a: &Triple) -> Big {
    dot(a, a).sqrt()
}

/// Returns the distance between a vector and one of doubles.
pub fn distance(a: &Triple, b: impl Into<[f64; 3]>) -> f64 {
    norm(&sub(a, &exactly(b))).to_f64()
}
