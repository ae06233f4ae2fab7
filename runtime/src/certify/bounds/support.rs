//! The planes that touch the whole tool from outside, which bound depth beside a triangle.

use crate::bvh::LaneVector;
use crate::certify::bounds::lanes::{Real, cross, dot, min3, minus};
use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::section::Section;
use fearless_simd::{Select, Simd, SimdFloat};
use touchoff_plane::Circle;

/// The support function of a tool.
///
/// For a unit vector `m` the tool lies within `m·p ≤ h(m)`, where `h` is its support function. The way from a point inside to
/// its foot on that plane leaves the tool, so no point is deeper than its distance `h(m) - m·p` from the plane, whatever `m`.
/// Perpendicular to a triangle, it is the same for all of its points, and least at the face that the tool touches.
#[derive(Clone)]
pub(crate) struct Support<R> {
    /// Ends of the profile's features.
    corners: Vec<[R; 2]>,
    /// The height of the middle of the tool.
    middle: R,
    arcs: Vec<SupportArc<R>>,
}

/// A convex arc of the profile of at most a quarter turn.
#[derive(Clone, Copy)]
struct SupportArc<R> {
    centre: [R; 2],
    radius: R,
    /// The outward normals at its ends.
    normals: [[R; 2]; 2],
}

impl<R: Real> Support<R> {
    /// Returns `None` for a tool whose other bounds are as tight, which has no convex arc but balls about the axis, and for one
    /// with an arc of so large a circle that the rounding of a normal's length, times its radius, is more than the margin.
    pub(crate) fn new(section: &Section) -> Option<Support<R>> {
        let size = section.outline.size;
        let rounded = section.outline.features.iter().filter_map(|feature| {
            Some((feature, feature.segment.circle.filter(|circle| circle.convex)?))
        });
        let is_large = |circle: &Circle| {
            let [d, z] = circle.centre;
            circle.radius.max(d.abs()).max(z.abs()) > size
        };
        if rounded.clone().all(|(feature, _)| feature.ball(size).is_some())
            || rounded.clone().any(|(_, circle)| is_large(&circle))
        {
            return None;
        }
        let arcs = rounded.map(|(feature, circle)| SupportArc {
            centre: circle.centre.map(R::of),
            radius: R::of(circle.radius),
            normals: [0, 1].map(|end| {
                let [d, z] = feature.segment.tangent(end);
                [z, -d].map(R::of)
            }),
        });
        let mut corners: Vec<MeridianPoint> =
            section.outline.features.iter().flat_map(|feature| feature.segment.ends).collect();
        // Neighbours share an end.
        corners.dedup();
        let [low, high] = section.reach();
        Some(Support {
            corners: corners.into_iter().map(|at| at.map(R::of)).collect(),
            middle: R::of(0.5 * (low + high)),
            arcs: arcs.collect(),
        })
    }

    /// Returns the distances of triangles under the planes that touch the tool and are parallel to them: of the two,
    /// that on the triangle's side of the tool's middle. It is infinite for a triangle so small or large that its normal is
    /// not known.
    ///
    /// The normal's direction may be any; its length errs by 5u, the products and sums by another 3u. With a tool of size `S`, a
    /// part of size `P` and corners within `√2 S + √3 P` that is 12 uS + 14 uP at the corners and 3 · 6 uS at the tool, in
    /// addition to the corners' own error, the margin of 16 uS + 64 uP in `f32`: less than the four margins that the search allows.
    #[inline(always)]
    pub(crate) fn parallel_to<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        [a, b, c]: &[LaneVector<V>; 3],
    ) -> V {
        let splat = |value: R| V::splat(simd, value);
        let zero = splat(R::of(0.0));
        let normal = cross(&minus(b, a), &minus(c, a));
        let square = dot(&normal, &normal);
        let unknown = square.simd_lt(splat(R::of(SMALLEST_SQUARE)))
            | square.simd_gt(splat(R::of(1.0 / SMALLEST_SQUARE)));
        // Away from the middle of the axis.
        let [x, y, z] = *a;
        let middle = splat(self.middle);
        let side = dot(&normal, &[x, y, z - middle]);
        let length = square.sqrt();
        let scale = splat(R::of(1.0)) / side.simd_lt(zero).select(zero - length, length);
        let normal = [normal[0] * scale, normal[1] * scale, normal[2] * scale];
        let [across, along] = [(normal[0] * normal[0] + normal[1] * normal[1]).sqrt(), normal[2]];
        let mut support = splat(R::of(f64::NEG_INFINITY));
        for [d, z] in &self.corners {
            support = support.max(across * splat(*d) + along * splat(*z));
        }
        for arc in &self.arcs {
            let [[d, z], [first_d, first_z], [last_d, last_z]] =
                [arc.centre, arc.normals[0], arc.normals[1]].map(|vector| vector.map(splat));
            let in_range = (along * first_d).simd_ge(across * first_z)
                & (across * last_z).simd_ge(along * last_d);
            let reach = across * d + along * z + splat(arc.radius);
            support = in_range.select(support.max(reach), support);
        }
        let least = min3(dot(&normal, a), dot(&normal, b), dot(&normal, c));
        unknown.select(splat(R::of(f64::INFINITY)), support - least)
    }
}

/// The least square of a normal's length, and the reciprocal of the greatest, of which the length has full precision in
/// `f32`.
const SMALLEST_SQUARE: f64 = 1e-30;
