//! Sixteen points or boxes at a time, transformed to the tool's frame.

use super::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x16};

/// The coordinates of sixteen points or boxes: x, y and z.
pub(crate) type Triple<S> = [f32x16<S>; 3];

// Vector code stands in functions that are always inlined. A closure, as `array::map` takes one, would be
// compiled without the vector instructions of the surrounding function.

/// Loads three lists of sixteen coordinates.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lists: &[[f32; WIDTH]; 3]) -> Triple<S> {
    [
        f32x16::from_slice(simd, &lists[0]),
        f32x16::from_slice(simd, &lists[1]),
        f32x16::from_slice(simd, &lists[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(v: &Triple<S>, row: [f32; 3]) -> f32x16<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

/// Transforms sixteen vectors to the tool's frame. `rows` is the rotation with its scale, `from` the transformed
/// point that the vectors start at.
#[inline(always)]
pub(crate) fn transform<S: Simd>(v: &Triple<S>, rows: &[[f32; 3]; 3], from: [f32; 3]) -> Triple<S> {
    [dot(v, rows[0]) + from[0], dot(v, rows[1]) + from[1], dot(v, rows[2]) + from[2]]
}

/// Returns the half extent along a direction of boxes with these half extents.
#[inline(always)]
pub(crate) fn extent<S: Simd>(half: &Triple<S>, row: [f32; 3]) -> f32x16<S> {
    dot(half, [row[0].abs(), row[1].abs(), row[2].abs()])
}

/// The lane indices.
pub(crate) const LANE_INDICES: [u32; WIDTH] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
