//! Sixteen points or boxes at a time, turned to the tool's frame.

use super::{Rough, Sixteen, WIDTH};
use fearless_simd::Simd;

/// Sixteen points or boxes, coordinate by coordinate.
pub(crate) type Triple<S, R = f32> = [<R as Rough>::Sixteen<S>; 3];

// Vector code stands in functions that are always inlined: a closure, as `array::map`
// takes one, would be compiled without the vector instructions of its surroundings.

#[inline(always)]
pub(crate) fn load<R: Rough, S: Simd>(simd: S, lists: &[[f32; WIDTH]; 3]) -> Triple<S, R> {
    [Sixteen::load(simd, &lists[0]), Sixteen::load(simd, &lists[1]), Sixteen::load(simd, &lists[2])]
}

#[inline(always)]
fn dot<R: Rough, S: Simd>(v: &Triple<S, R>, row: [R; 3]) -> R::Sixteen<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

/// Places turned to the tool's frame, from one whose place there is known.
#[inline(always)]
pub(crate) fn seen<R: Rough, S: Simd>(
    v: &Triple<S, R>,
    rows: &[[R; 3]; 3],
    from: [R; 3],
) -> Triple<S, R> {
    [
        dot::<R, S>(v, rows[0]) + from[0],
        dot::<R, S>(v, rows[1]) + from[1],
        dot::<R, S>(v, rows[2]) + from[2],
    ]
}

/// Returns the reach of boxes with these half extents along a row.
#[inline(always)]
pub(crate) fn extent<R: Rough, S: Simd>(half: &Triple<S, R>, row: [R; 3]) -> R::Sixteen<S> {
    dot::<R, S>(half, [row[0].size(), row[1].size(), row[2].size()])
}

/// The lanes' numbers.
pub(crate) const LANE: [u32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
