//! Upper bounds of the depth of a tool in moving boxes and triangles, in SIMD lanes. A moving triangle stays in the
//! convex hull of both positions, grown by the deviation of its paths from straight.

use crate::bvh::{LaneVector, PoseTransform};
use crate::certify::bounds::batch::{Batch, Lanes, load};
use crate::certify::bounds::clip::Clip;
use crate::certify::bounds::descent::{
    BoundedTree, BoxBounds, Children, Displacement, Node, above, rings,
};
use crate::certify::bounds::hull::{Hull, HullSlab};
use crate::certify::bounds::lanes::{Real, choose, is_between, max3, min3, radial_extents};
use crate::certify::bounds::nearest::{NearestPoint, direction_from_axis};
use crate::certify::bounds::ring::to_ring;
use crate::certify::sweep::interval::MotionInterval;
use crate::certify::triangle::TrianglePiece;
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};

/// The corners of triangles at both ends of their motion.
type Ends<V> = [LaneVector<V>; 6];

/// Triangles in motion: at both ends, and in the middle.
struct MovingTriangles<V> {
    pub(crate) ends: Ends<V>,
    pub(crate) middle: [LaneVector<V>; 3],
}

/// The heights of a slab, grown by the deviation of paths from straight.
#[derive(Clone, Copy)]
struct GrownHeights<V> {
    low: V,
    high: V,
}

impl<R: Real> Hull<R> {
    /// Returns at least the depth of every point no farther than `grow` from the convex hulls of triangles at both
    /// ends of their motion. A bound of at most `threshold` need not be tight.
    #[inline(always)]
    fn swept<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        moving: &MovingTriangles<V>,
        grow: V,
        threshold: R,
    ) -> V {
        let MovingTriangles { ends, middle } = moving;
        let [a, b, c, d, e, f] = ends;
        let low = a[2].min(b[2]).min(c[2]).min(d[2].min(e[2]).min(f[2]));
        let high = max3(a[2], b[2], c[2]).max(max3(d[2], e[2], f[2]));
        let zero = V::splat(simd, R::of(0.0));
        let half_displacement = half_displacement_of(simd, ends);
        let near =
            slide(simd, &NearestPoint::to_axis(simd, middle).point, &half_displacement, None);
        // Any direction gives a bound; that of the point nearest to the axis on its way gives a tight one.
        let out = outward(ends, &direction_from_axis(simd, &[near[0], near[1], zero], zero));
        let threshold = V::splat(simd, threshold);
        let mut bound = V::splat(simd, R::of(f64::NEG_INFINITY));
        for slab in &self.slabs {
            let grown = GrownHeights {
                low: V::splat(simd, slab.low) - grow,
                high: V::splat(simd, slab.high) + grow,
            };
            let here = low.simd_le(grown.high) & high.simd_ge(grown.low);
            let mut depth = slab.under_planes_of(simd, &out, &heights(ends), grow);
            let open = here & depth.simd_gt(threshold);
            if open.any_true() {
                depth = depth.min(slab.swept(simd, moving, &half_displacement, &near, grown, grow));
            }
            bound = here.select(bound.max(depth), bound);
        }
        bound
    }
}

impl<R: Real> HullSlab<R> {
    /// Returns the least, over all planes, of the greatest distance under the plane at corners with these radial
    /// positions and heights.
    #[inline(always)]
    fn under_planes_of<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        out: &[V; 6],
        heights: &[V; 6],
        grow: V,
    ) -> V {
        let mut depth = V::splat(simd, R::of(f64::INFINITY));
        for &[nd, nz, c] in &self.planes {
            let steep = V::splat(simd, R::norm(nd, nz));
            let (nd, nz) = (V::splat(simd, nd), V::splat(simd, nz));
            let mut min_extent = out[0] * nd + heights[0] * nz;
            for k in 1..6 {
                min_extent = min_extent.min(out[k] * nd + heights[k] * nz);
            }
            depth = depth.min(V::splat(simd, c) + grow * steep - min_extent);
        }
        depth
    }

    /// Returns a tighter bound for the portion of the hulls between the slab's heights.
    #[inline(always)]
    fn swept<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        moving: &MovingTriangles<V>,
        half_displacement: &LaneVector<V>,
        near: &LaneVector<V>,
        grown: GrownHeights<V>,
        grow: V,
    ) -> V {
        let MovingTriangles { ends, middle } = moving;
        let GrownHeights { low: from, high: to } = grown;
        let zero = V::splat(simd, R::of(0.0));
        let clip = Clip::new(simd, middle, [self.low, self.high]);
        let point = within(simd, &clip, middle, grown, near);
        let direction = direction_from_axis(simd, &[point[0], point[1], zero], zero);
        let out = outward(ends, &direction);
        let heights = heights(ends);
        // Projected along the direction, the hull is plane. Its portion between the heights has its vertices at
        // corners between the heights and where it is cut.
        let [at_low, at_high] =
            [min_at(simd, &out, &heights, from), min_at(simd, &out, &heights, to)];
        let far = V::splat(simd, R::of(SENTINEL));
        let (cut_low, cut_high) = (at_low.simd_lt(far), at_high.simd_lt(far));
        let mut depth = far;
        for &[nd, nz, c] in &self.planes {
            let steep = V::splat(simd, R::norm(nd, nz));
            let (nd, nz) = (V::splat(simd, nd), V::splat(simd, nz));
            let mut min_extent = cut_low.select(at_low * nd + from * nz, far);
            min_extent = cut_high.select(min_extent.min(at_high * nd + to * nz), min_extent);
            for k in 0..6 {
                let inside = heights[k].simd_ge(from) & heights[k].simd_le(to);
                min_extent =
                    inside.select(min_extent.min(out[k] * nd + heights[k] * nz), min_extent);
            }
            depth = depth.min(V::splat(simd, c) + grow * steep - min_extent);
        }
        if let Some([z, radius]) = self.ball {
            let centre = V::splat(simd, z);
            let near = slide(
                simd,
                &NearestPoint::to_axis_point(simd, middle, z).point,
                half_displacement,
                Some(centre),
            );
            let foot = within(simd, &clip, middle, grown, &near);
            let direction = direction_from_axis(simd, &foot, centre);
            let mut beyond = [zero; 6];
            for k in 0..6 {
                let [x, y, height] = &ends[k];
                beyond[k] =
                    *x * direction[0] + *y * direction[1] + (*height - centre) * direction[2];
            }
            let mut min_extent =
                min_at(simd, &beyond, &heights, from).min(min_at(simd, &beyond, &heights, to));
            for k in 0..6 {
                let inside = heights[k].simd_ge(from) & heights[k].simd_le(to);
                min_extent = inside.select(min_extent.min(beyond[k]), min_extent);
            }
            depth = depth.min(V::splat(simd, radius) + grow - min_extent);
        }
        if let Some(hole) = self.hole {
            let mut farthest = zero;
            for [x, y, _] in ends {
                farthest = farthest.max((*x * *x + *y * *y).sqrt());
            }
            depth = depth.min(farthest + grow - V::splat(simd, hole));
        }
        for ring in &self.rings {
            let mut farthest = zero;
            for k in 0..6 {
                let [x, y, height] = &ends[k];
                let far = (*x * *x + *y * *y).sqrt();
                farthest = farthest.max(to_ring(simd, [out[k], far, *height], *ring));
            }
            depth = depth.min(farthest + grow);
        }
        depth
    }
}

/// Returns the displacement of triangles from the middle to the end of their motion.
#[inline(always)]
fn half_displacement_of<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    [a, b, c, d, e, f]: &Ends<V>,
) -> LaneVector<V> {
    let sixth = V::splat(simd, R::of(1.0 / 6.0));
    [
        (d[0] + e[0] + f[0] - a[0] - b[0] - c[0]) * sixth,
        (d[1] + e[1] + f[1] - a[1] - b[1] - c[1]) * sixth,
        (d[2] + e[2] + f[2] - a[2] - b[2] - c[2]) * sixth,
    ]
}

/// Returns the point nearest to the axis, or to the point of it at `centre`, on the path of a point moved by up
/// to `half_displacement` either way.
#[inline(always)]
fn slide<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    point: &LaneVector<V>,
    half_displacement: &LaneVector<V>,
    centre: Option<V>,
) -> LaneVector<V> {
    let (mut toward, mut square) = (
        point[0] * half_displacement[0] + point[1] * half_displacement[1],
        half_displacement[0] * half_displacement[0] + half_displacement[1] * half_displacement[1],
    );
    if let Some(centre) = centre {
        toward += (point[2] - centre) * half_displacement[2];
        square += half_displacement[2] * half_displacement[2];
    }
    let one = V::splat(simd, R::of(1.0));
    // Without displacement it is 0 / tiny = 0.
    let at = -toward / square.max(V::splat(simd, R::MIN_POSITIVE_VALUE));
    let at = at.max(-one).min(one);
    [
        point[0] + at * half_displacement[0],
        point[1] + at * half_displacement[1],
        point[2] + at * half_displacement[2],
    ]
}

/// Returns a point, or, if it is beyond two heights, the point at that end which is nearest to the axis.
#[inline(always)]
fn within<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    clip: &Clip<V, V::Mask>,
    middle: &[LaneVector<V>; 3],
    grown: GrownHeights<V>,
    point: &LaneVector<V>,
) -> LaneVector<V> {
    let above = point[2].simd_gt(grown.high);
    let end = clip.at_end(simd, middle, above);
    choose(above | point[2].simd_lt(grown.low), &end, point)
}

#[inline(always)]
fn heights<S: Simd, V: SimdBase<S>>([a, b, c, d, e, f]: &Ends<V>) -> [V; 6] {
    [a[2], b[2], c[2], d[2], e[2], f[2]]
}

/// Returns how far out corners are in a direction across the axis.
#[inline(always)]
fn outward<S: Simd, V: SimdBase<S>>(ends: &Ends<V>, direction: &LaneVector<V>) -> [V; 6] {
    let [a, b, c, d, e, f] = *ends;
    let [first, last] =
        [radial_extents(&[a, b, c], direction), radial_extents(&[d, e, f], direction)];
    [first[0], first[1], first[2], last[0], last[1], last[2]]
}

/// A number larger than the distance of any point examined.
const SENTINEL: f64 = 1e30;

/// Returns the minimum of a linear function on a hull at one height, or `SENTINEL` if the hull does not reach it.
#[inline(always)]
fn min_at<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    values: &[V; 6],
    heights: &[V; 6],
    at: V,
) -> V {
    let mut min_extent = V::splat(simd, R::of(SENTINEL));
    let zero = V::splat(simd, R::of(0.0));
    let [a, b, c, d, e, f] = *heights;
    let lowest = min3(a, b, c).min(min3(d, e, f));
    let highest = max3(a, b, c).max(max3(d, e, f));
    if !(lowest.simd_lt(at) & highest.simd_gt(at)).any_true() {
        return min_extent;
    }
    for i in 0..6 {
        for j in i + 1..6 {
            let (low, high) = (heights[i] - at, heights[j] - at);
            let across = is_between(low, zero, high);
            // All pairs of corners are taken, not only the edges of the hull: a chord inside it changes no minimum.
            let value = values[i] - low * ((values[j] - values[i]) / (high - low));
            min_extent = across.select(min_extent.min(value), min_extent);
        }
    }
    min_extent
}

/// A hull and the motion of boxes past it.
pub(crate) struct Moving<'a> {
    pub(crate) hull: &'a Hull<f32>,
    pub(crate) shift: Displacement,
    /// The transforms at the beginning and at the end of the interval.
    pub(crate) ends: &'a [PoseTransform; 2],
}

impl BoxBounds for Moving<'_> {
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        children: Children<'_>,
        view: &PoseTransform,
        threshold: f32,
    ) -> f32x16<S> {
        let rings = rings(simd, children, view, self.hull.margin, Some(&self.shift));
        self.hull.of_rings(simd, &rings, threshold)
    }
}

/// Returns a bit mask of the triangles of a leaf whose bound may exceed `threshold`.
pub(crate) fn of_leaf(
    level: Level,
    tree: &BoundedTree<'_, Moving<'_>>,
    node: Node,
    threshold: f32,
) -> u32 {
    on_vectors!(level, simd => of_leaf_on(simd, tree, node, threshold));
    u32::MAX
}

#[inline(always)]
fn of_leaf_on<S: Simd>(
    simd: S,
    tree: &BoundedTree<'_, Moving<'_>>,
    node: Node,
    threshold: f32,
) -> u32 {
    let BoundedTree { bvh, bounds: moving, view } = *tree;
    let [a, b, c] = node.corners(simd, bvh, &moving.ends[0]);
    let [d, e, f] = node.corners(simd, bvh, &moving.ends[1]);
    let middle = node.corners(simd, bvh, view);
    let [p, q, r] = [
        squared_distance(&middle[0], moving.shift.axis),
        squared_distance(&middle[1], moving.shift.axis),
        squared_distance(&middle[2], moving.shift.axis),
    ];
    let far = p.max(q).max(r).sqrt();
    let grow = moving.shift.deviation_bound(simd, far) + moving.shift.clearance;
    let triangles = MovingTriangles { ends: [a, b, c, d, e, f], middle };
    above(moving.hull.swept(simd, &triangles, grow, threshold), threshold)
}

/// Returns the squared distances of points from an axis through the tip.
#[inline(always)]
fn squared_distance<S: Simd>(&[x, y, z]: &LaneVector<f32x16<S>>, [u, v, w]: [f32; 3]) -> f32x16<S> {
    let [a, b, c] = [y * w - z * v, z * u - x * w, x * v - y * u];
    c * c + b * b + a * a
}

/// Up to eight triangles at both ends of a motion interval and in its middle.
#[derive(Clone, Default)]
pub(crate) struct SweptBatch {
    pub(crate) middle: Batch,
    ends: [[Lanes; 3]; 6],
    /// The deviation of their paths from straight plus the distance that they have to keep.
    grow: Lanes,
    pub(crate) bounds: Lanes,
}

impl SweptBatch {
    /// Loads triangles that have to keep a distance.
    pub(crate) fn begin(
        &mut self,
        interval: &MotionInterval,
        required_clearance: f64,
        parts: &[TrianglePiece],
    ) {
        self.middle.indices.clear();
        self.middle.indices.extend(parts.iter().map(|part| part.index));
        for (lane, part) in parts.iter().enumerate() {
            for (k, corner) in part.piece.corners().iter().enumerate() {
                let [first, middle, last] = interval.transformed(corner);
                for axis in 0..3 {
                    self.ends[k][axis][lane] = first[axis];
                    self.middle.corners[k][axis][lane] = middle[axis];
                    self.ends[3 + k][axis][lane] = last[axis];
                }
            }
            self.grow[lane] = required_clearance
                + interval.deviation_bound(interval.rotation_radius(&self.middle.corners(lane)));
        }
    }

    /// Bounds the depth of each triangle during the interval. A bound of at most `threshold` need not be tight.
    pub(crate) fn bound(&mut self, level: Level, hull: &Hull<f64>, threshold: f64) {
        on_vectors!(level, simd => self.bound_on(simd, hull, threshold));
        // Without vector instructions nothing is known until the edges are searched.
        self.bounds = [f64::INFINITY; LANES];
    }

    #[inline(always)]
    fn bound_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, threshold: f64) {
        let [a, b, c, d, e, f] = &self.ends;
        let ends = [
            load(simd, a),
            load(simd, b),
            load(simd, c),
            load(simd, d),
            load(simd, e),
            load(simd, f),
        ];
        let middle = self.middle.load_corners(simd);
        let grow = f64x8::from_slice(simd, &self.grow);
        hull.swept(simd, &MovingTriangles { ends, middle }, grow, threshold)
            .store_slice(&mut self.bounds);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch, f64x8};

    /// The way from (1, -2, -2) to (1, 6, 8) is nearest to the axis at (1, 0, 0.5).
    #[test]
    fn a_point_slides_to_where_it_is_nearest_to_the_axis() {
        dispatch!(Level::new(), simd => {
            let at = |p: [f64; 3]| p.map(|part| f64x8::splat(simd, part));
            let found = slide(simd, &at([1.0, 2.0, 3.0]), &at([0.0, 4.0, 5.0]), None);
            assert_eq!(found.map(|part| part[0]), [1.0, 0.0, 0.5]);
        });
    }
}
