//! The parts of triangles between two heights, in SIMD lanes.

use crate::bvh::LaneVector;
use crate::certify::bounds::lanes::{Crossing, Real, between, choose, crossing};
use crate::certify::bounds::nearest::on_edge;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

/// The part of each triangle between two heights, as a polygon: the corners within the heights, which are included,
/// and the points where sides cross a height. Polygons below and above the same height have the same crossing points, so
/// no gap is left.
pub(crate) struct Clip<V, M> {
    kept: [M; 3],
    /// Per side: the cuts at the lower and at the upper height.
    cuts: [[Crossing<V, M>; 2]; 3],
}

impl<V: Copy, M: Copy> Clip<V, M> {
    #[inline(always)]
    pub(crate) fn new<S: Simd, R: Real>(
        simd: S,
        [a, b, c]: &[LaneVector<V>; 3],
        [low, high]: [R; 2],
    ) -> Clip<V, M>
    where
        V: SimdFloat<S, Element = R> + SimdBase<S, Mask = M>,
        M: SimdMask<S>,
    {
        let zero = V::splat(simd, R::of(0.0));
        let (low, high) = (V::splat(simd, low), V::splat(simd, high));
        let kept = [
            a[2].simd_ge(low) & a[2].simd_le(high),
            b[2].simd_ge(low) & b[2].simd_le(high),
            c[2].simd_ge(low) & c[2].simd_le(high),
        ];
        let cuts = [
            [crossing(zero, a[2], b[2], low), crossing(zero, a[2], b[2], high)],
            [crossing(zero, b[2], c[2], low), crossing(zero, b[2], c[2], high)],
            [crossing(zero, c[2], a[2], low), crossing(zero, c[2], a[2], high)],
        ];
        Clip { kept, cuts }
    }

    /// Returns the maximum of a function that is linear on each triangle.
    #[inline(always)]
    pub(crate) fn max_linear<S: Simd, R: Real>(&self, simd: S, values: [V; 3]) -> V
    where
        V: SimdFloat<S, Element = R> + SimdBase<S, Mask = M>,
        M: SimdMask<S> + Select<V>,
    {
        let none = V::splat(simd, R::of(f64::NEG_INFINITY));
        let mut max = none;
        for k in 0..3 {
            let (from, to) = (values[k], values[(k + 1) % 3]);
            max = max.max(self.kept[k].select(from, none));
            for Crossing { at, exists } in self.cuts[k] {
                max = max.max(exists.select(from + at * (to - from), none));
            }
        }
        max
    }

    /// Returns the point nearest to the axis on the cut at the lower height, or at the upper height where the mask is
    /// set. If the height passes through a corner, it is some point of the triangle: the bounds taken in its direction
    /// are valid but less tight.
    #[inline(always)]
    pub(crate) fn at_end<S: Simd, R: Real>(
        &self,
        simd: S,
        corners: &[LaneVector<V>; 3],
        upper: M,
    ) -> LaneVector<V>
    where
        V: SimdFloat<S, Element = R> + SimdBase<S, Mask = M>,
        M: SimdMask<S> + Select<V>,
    {
        let [a, b, c] = corners;
        let (first, is_first) = cut_at(a, b, &self.cuts[0], upper);
        let (second, _) = cut_at(b, c, &self.cuts[1], upper);
        let (third, is_third) = cut_at(c, a, &self.cuts[2], upper);
        // Two of the three sides are cut, unless a corner lies at the height itself.
        let from = choose(is_first, &first, &second);
        let to = choose(is_third, &third, &second);
        on_edge(simd, &from, &to, true).0
    }
}

/// Returns the cut of a side at the lower height, or at the upper height where the mask is set, and a mask of its
/// existence.
#[inline(always)]
fn cut_at<S: Simd, V: SimdBase<S>>(
    from: &LaneVector<V>,
    to: &LaneVector<V>,
    [low, high]: &[Crossing<V, V::Mask>; 2],
    upper: V::Mask,
) -> (LaneVector<V>, V::Mask) {
    let point = between(from, to, upper.select(high.at, low.at));
    (point, (upper & high.exists) | (!upper & low.exists))
}
