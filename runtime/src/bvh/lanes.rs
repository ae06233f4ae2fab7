//! Transforms of 16 points or boxes at a time to the tool's frame, in SIMD lanes of `f32`.

use super::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x16};

/// Vectors in SIMD lanes, coordinate by coordinate: points, box centres or half extents.
pub(crate) type LaneVector<V> = [V; 3];

/// The index of each lane; added to `16 n` it is the index of a child of node `n`, or of an item of leaf `n`.
pub(crate) const LANE_INDICES: [u32; WIDTH] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

const _: () = assert!(WIDTH == 16, "lanes are f32x16");

// Every function is `#[inline(always)]`, and none takes a closure, as `array::map` would: a closure is compiled as a
// function of its own, without the vector instructions that its caller enables.

/// Loads sixteen vectors from the lists of their x, y and z coordinates.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lists: &[[f32; WIDTH]; 3]) -> LaneVector<f32x16<S>> {
    [
        f32x16::from_slice(simd, &lists[0]),
        f32x16::from_slice(simd, &lists[1]),
        f32x16::from_slice(simd, &lists[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(v: &LaneVector<f32x16<S>>, row: [f32; 3]) -> f32x16<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

/// Transforms sixteen vectors to the tool's frame and unit: `rows · v + origin`. `rows` is the rotation times the ratio
/// of the units; `origin` is the transformed point that the vectors are relative to. Coordinates are rounded to
/// nearest: the caller adds a margin, such as [`super::QuerySetup::margin`]. Lanes with a NaN stay NaN.
#[inline(always)]
pub(crate) fn transform<S: Simd>(
    v: &LaneVector<f32x16<S>>,
    rows: &[[f32; 3]; 3],
    origin: [f32; 3],
) -> LaneVector<f32x16<S>> {
    [dot(v, rows[0]) + origin[0], dot(v, rows[1]) + origin[1], dot(v, rows[2]) + origin[2]]
}

/// Returns the half extents of sixteen boxes along one axis of the tool, in the tool's unit. `half` are their half
/// extents in the tree's frame and unit, `row` is that axis's row of the transform. The sum is not rounded outward.
#[inline(always)]
pub(crate) fn extent<S: Simd>(half: &LaneVector<f32x16<S>>, row: [f32; 3]) -> f32x16<S> {
    dot(half, [row[0].abs(), row[1].abs(), row[2].abs()])
}
