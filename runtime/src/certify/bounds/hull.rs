//! Upper bounds of the depth of a tool in boxes and triangles, in SIMD lanes.

use crate::bvh::{LaneVector, PoseTransform};
use crate::certify::bounds::clip::Clip;
use crate::certify::bounds::descent::{Bounds, BoxBounds, BoxRings, Children, rings};
use crate::certify::bounds::lanes::{
    Real, choose, distances, extents_from, max3, min3, radial_extents,
};
use crate::certify::bounds::nearest::{NearestPoint, direction_from_axis};
use crate::certify::bounds::ring::{
    AxisDistances, Ring, RingDistances, from_ring, under_both, under_both_of_ring,
};
use crate::certify::bounds::support::Support;
use crate::certify::part::NodeRing;
use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::chains::Chain;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::profile::ProfileModel;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::tool_model::section::Section;
use crate::interval::Interval;
use crate::tool::ToolInfo;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};
use touchoff_plane::Segment;

#[cfg(test)]
mod tests;

/// The slabs of a tool, for upper bounds of depth.
#[derive(Clone)]
pub(crate) struct Hull<R> {
    /// The rounding error bound of a point.
    pub(crate) margin: R,
    pub(crate) slabs: Vec<HullSlab<R>>,
    /// The planes that touch the tool from outside, where they are tighter.
    support: Option<Support<R>>,
}

/// A slab between two heights: the depth of a point in it is at most each of these bounds.
#[derive(Clone)]
pub(crate) struct HullSlab<R> {
    pub(crate) low: R,
    pub(crate) high: R,
    /// The distance of a point on the tool's side of each plane, `c - n_d d - n_z z`, stored as `[n_d, n_z, c]`. The
    /// first plane is upright.
    pub(crate) planes: Vec<[R; 3]>,
    /// Planes that bound the depth of some points only.
    pub(crate) guarded: Vec<GuardedPlane<R>>,
    /// The radius of the hole about the axis, if there is one. A point is at most as deep as its distance beyond the
    /// hole.
    pub(crate) hole: Option<R>,
    /// A ball about a point of the axis, as `[z, radius]`: the bound is the distance inside it.
    pub(crate) ball: Option<[R; 2]>,
    /// Circles on the tool's surface: the bound is the distance from them.
    pub(crate) rings: Vec<Ring<R>>,
}

/// A plane, and the points whose depth is at most their distance under it: those on the far side of all `guards`, each a
/// plane as in [`HullSlab::planes`] with a normal of length 1.
#[derive(Clone)]
pub(crate) struct GuardedPlane<R> {
    pub(crate) plane: [R; 3],
    pub(crate) guards: Vec<[R; 3]>,
}

impl<R: Real> Hull<R> {
    /// Creates a hull for points inside the tool. The slabs lie between the heights of their zones, and reach farther
    /// by the error bound of heights.
    pub(crate) fn new(
        ProfileModel { section, chains, .. }: &ProfileModel,
        zones: &[Option<Rectangle>],
        error: f64,
    ) -> Hull<R> {
        let slabs = chains.iter().filter_map(|chain| {
            let zones = zones[chain.slabs.clone()].iter().flatten();
            let heights = zones.map(|zone| [zone.low[1], zone.high[1]]);
            let [low, high] = heights.reduce(|one, other| [one[0], other[1]])?;
            Some(HullSlab::new(section, chain, [low - error, high + error]))
        });
        Hull { slabs: slabs.collect(), margin: R::of(error), support: Support::new(section) }
    }

    /// Creates a hull for a tool whose depth has the Lipschitz constant `steep`: depth is at most `steep` times the
    /// distance to the boundary of the envelope.
    pub(crate) fn about(info: &ToolInfo, steep: f64, error: f64) -> Hull<R> {
        let Interval { low: bottom, high: top } = info.reach();
        let slabs = info.envelope.iter().map(|slab| {
            let planes = [[1.0, 0.0, slab.radius], [0.0, -1.0, -bottom], [0.0, 1.0, top]];
            let steep_planes = planes.map(|plane| plane.map(|part| R::of(steep * part)));
            HullSlab::under([slab.low - error, slab.high + error], steep_planes.to_vec())
        });
        Hull { slabs: slabs.collect(), margin: R::of(error), support: None }
    }

    /// Creates a hull of the regions that some features bound, for points no farther from these features than the
    /// hull is grown.
    pub(crate) fn holding(profile: &ProfileModel, owners: &Owners, error: f64) -> Hull<R> {
        let section = &profile.section;
        let zones: Vec<_> = section
            .slabs
            .iter()
            .map(|slab| owners.is_owned(slab.side).then_some(slab.rectangle()))
            .collect();
        // Points outside are no nearer to a plane that touches the tool than to the tool.
        let mut hull = Hull { support: None, ..Hull::new(profile, &zones, error) };
        // A level feature is the side of no slab.
        let sides: Vec<usize> = section.slabs.iter().map(|slab| slab.side).collect();
        for (index, feature) in section.outline.features.iter().enumerate() {
            if owners.is_owned(index) && !sides.contains(&index) {
                let [[d0, z0], [d1, z1]] = feature.segment.ends;
                let heights = [z0.min(z1) - error, z0.max(z1) + error];
                hull.slabs
                    .push(HullSlab::under(heights, vec![plane([1.0, 0.0], [d0.max(d1), 0.0])]));
            }
        }
        hull
    }

    /// Returns an upper bound of the depth of each triangle, up to rounding, and the point where depth may be
    /// greatest. Absent triangles have NaN coordinates. A bound of at most `threshold` need not be tight. Given such
    /// points of an earlier call in `refine_at`, the bounds are taken in their directions.
    #[inline(always)]
    pub(crate) fn triangles<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[LaneVector<V>; 3],
        threshold: R,
        refine_at: Option<&LaneVector<V>>,
    ) -> (V, LaneVector<V>) {
        let [a, b, c] = corners;
        let (low, high) = (min3(a[2], b[2], c[2]), max3(a[2], b[2], c[2]));
        let threshold = V::splat(simd, threshold);
        let under = match &self.support {
            Some(support) => support.parallel_to(simd, corners),
            None => V::splat(simd, R::of(f64::INFINITY)),
        };
        // Near a contact this alone rules out most triangles.
        if !under.simd_gt(threshold).any_true() {
            return (under, *a);
        }
        let near = NearestPoint::to_axis(simd, corners);
        // In that direction no corner reaches farther out than its distance from the axis.
        let out = radial_extents(corners, &near.direction);
        let mut bound = V::splat(simd, R::of(f64::NEG_INFINITY));
        let mut point = near.point;
        for slab in &self.slabs {
            let (from, to) = (V::splat(simd, slab.low), V::splat(simd, slab.high));
            let in_slab = low.simd_le(to) & high.simd_ge(from);
            // The upright plane rules out most slabs.
            let [p, q, r] = under_plane(simd, corners, &out, slab.planes[0]);
            let outside = max3(p, q, r);
            if !(in_slab & !outside.simd_le(threshold)).any_true() {
                bound = in_slab.select(bound.max(outside), bound);
                continue;
            }
            let depth = slab.under_planes(simd, corners, &out, &None);
            let open = in_slab & depth.simd_gt(threshold);
            let (depth, deepest) = if open.any_true() {
                slab.triangles(simd, corners, &near, open, refine_at)
            } else {
                (depth, near.point)
            };
            let better = in_slab & depth.simd_gt(bound);
            bound = better.select(depth, bound);
            point = choose(better, &deepest, &point);
        }
        (bound.min(under), point)
    }
}

/// Returns the plane with a normal through a point, as in [`HullSlab::planes`].
fn plane<R: Real>(n: MeridianPoint, [d, z]: MeridianPoint) -> [R; 3] {
    [n[0], n[1], n[0] * d + n[1] * z].map(R::of)
}

/// Returns the plane of which a feature's line is the meridian.
fn under<R: Real>(line: &Segment) -> [R; 3] {
    plane([line.along[1], -line.along[0]], line.ends[0])
}

impl<R: Real> GuardedPlane<R> {
    /// Creates the plane of a line of the profile, for points whose feet are in a range along the line, where it is on the
    /// surface or outside the tool.
    fn new(line: &Segment, [from, to]: [f64; 2]) -> GuardedPlane<R> {
        let [u, v] = line.along;
        let ends = [([u, v], from), ([-u, -v], to)];
        let finite = ends.into_iter().filter(|(_, at)| at.is_finite());
        GuardedPlane {
            plane: under(line),
            guards: finite.map(|(normal, at)| plane(normal, line.line_point(at))).collect(),
        }
    }
}

/// The maximum number of linear bounds of a slab for a triangle.
const MAX_BOUNDS: usize = 8;

/// The cut of triangles by a slab, if there is any.
type Part<V, M> = Option<Clip<V, M>>;

impl<R: Real> HullSlab<R> {
    /// Creates the bounds by planes of points between two heights.
    fn under(heights: [f64; 2], planes: Vec<[R; 3]>) -> HullSlab<R> {
        let [low, high] = heights.map(R::of);
        HullSlab {
            low,
            high,
            planes,
            guarded: Vec::new(),
            hole: None,
            ball: None,
            rings: Vec::new(),
        }
    }

    /// Creates the bounds of a chain of slabs, for points between two heights.
    fn new(section: &Section, chain: &Chain, heights: [f64; 2]) -> HullSlab<R> {
        let slabs = &section.slabs[chain.slabs.clone()];
        let radius = slabs.iter().map(|slab| slab.radius).fold(0.0, f64::max);
        let (chain_low, chain_high) = (slabs[0].low, slabs[slabs.len() - 1].high);
        // The first plane is the radial distance to the surface.
        let mut bounds = HullSlab::under(heights, vec![plane([1.0, 0.0], [radius, 0.0])]);
        bounds.hole = (slabs[0].hole > 0.0).then(|| R::of(slabs[0].hole));
        bounds.ball = chain.ball.map(|ball| ball.map(R::of));
        match &chain.line {
            Some(line) => bounds.planes.push(under(line)),
            None => bounds.add_side(section, chain.slabs.start),
        }
        // The tool's lower and upper end bound depth too, where they are as near as the side can be.
        let [bottom, top] = section.reach();
        if chain_low - bottom <= radius {
            bounds.planes.push(plane([0.0, -1.0], [0.0, bottom]));
        }
        if top - chain_high <= radius {
            bounds.planes.push(plane([0.0, 1.0], [0.0, top]));
        }
        // No point is deeper than the radius.
        let corners = section.reflex_corners([chain_low - radius, chain_high + radius]);
        bounds.rings.extend(corners.map(|corner| Ring {
            radius: R::of(corner.point[0]),
            height: R::of(corner.point[1]),
            annulus: corner.ends_level,
        }));
        bounds
    }

    /// Adds the bounds by the side of a single slab and by the lines beside it.
    fn add_side(&mut self, section: &Section, index: usize) {
        let slab = &section.slabs[index];
        let side = &section.outline.features[slab.side];
        let [[d0, z0], [d1, z1]] = side.segment.ends;
        let slope = (d1 - d0) / (z1 - z0);
        let convex = side.segment.circle.is_some_and(|circle| circle.convex);
        let line = side.tangent_line();
        let is_bound = line.as_ref().is_some_and(|line| section.tangent_bounds_slab(line, index));
        if let Some(line) = &line {
            if is_bound {
                self.planes.push(under(line));
            } else {
                self.guarded.push(GuardedPlane::new(line, section.feet(line, index)));
            }
        }
        if !is_bound && slope != 0.0 && slope.abs() <= 2.0 && !convex {
            // Radially under the chord of the side, beyond which neither a line nor a concave arc reaches.
            // Steeper planes have larger errors than `margin` in `search` allows for.
            self.planes.push(plane([1.0, -slope], side.segment.ends[0]));
        }
        for line in section.lines_beside(slab) {
            let feet = section.outside_feet(line);
            self.guarded.push(GuardedPlane::new(&section.outline.features[line].segment, feet));
        }
        // For an arc that does not reach the axis, the feet next to it are not on the surface.
        if d0.min(d1) == 0.0
            && let Some(ball) = side.ball(section.outline.size)
        {
            self.ball = Some(ball.map(R::of));
        }
    }

    /// Returns the least, over all planes, of the greatest distance under the plane in each triangle.
    #[inline(always)]
    fn under_planes<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[LaneVector<V>; 3],
        out: &[V; 3],
        part: &Part<V, V::Mask>,
    ) -> V {
        let mut depth = V::splat(simd, R::of(f64::INFINITY));
        for plane in &self.planes {
            depth = depth.min(max_over(simd, part, under_plane(simd, corners, out, *plane)));
        }
        for guarded in &self.guarded {
            let holds = guarded.holds(simd, corners, out, part);
            let under = max_over(simd, part, under_plane(simd, corners, out, guarded.plane));
            depth = holds.select(depth.min(under), depth);
        }
        depth
    }

    /// Bounds the pieces of triangles between the slab's heights, for the lanes that are open.
    #[inline(always)]
    fn triangles<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[LaneVector<V>; 3],
        near: &NearestPoint<V>,
        open: V::Mask,
        refine_at: Option<&LaneVector<V>>,
    ) -> (V, LaneVector<V>) {
        let zero = V::splat(simd, R::of(0.0));
        let (from, to) = (V::splat(simd, self.low), V::splat(simd, self.high));
        // If the point nearest to the axis is beyond the slab, the piece in the slab is nearest at that end.
        let (mut deepest, mut direction, mut part) = (near.point, near.direction, None);
        let beyond_it = open & (deepest[2].simd_lt(from) | deepest[2].simd_gt(to));
        let [a, b, c] = corners;
        let (lowest, highest) = (min3(a[2], b[2], c[2]), max3(a[2], b[2], c[2]));
        if (open & (lowest.simd_lt(from) | highest.simd_gt(to))).any_true() {
            let clip = Clip::new(simd, corners, [self.low, self.high]);
            if beyond_it.any_true() {
                let end = clip.at_end(simd, corners, deepest[2].simd_gt(to));
                deepest = choose(beyond_it, &end, &deepest);
                direction = direction_from_axis(simd, &[deepest[0], deepest[1], zero], zero);
            }
            part = Some(clip);
        }
        if let Some(point) = refine_at {
            let within = point[2].simd_ge(from) & point[2].simd_le(to);
            let other = direction_from_axis(simd, &[point[0], point[1], zero], zero);
            direction = choose(within, &other, &direction);
        }
        let out = radial_extents(corners, &direction);
        let mut depth = self.under_planes(simd, corners, &out, &part);
        // Bounds at the corners. Each is convex on a triangle: between the corners at most their interpolation.
        let mut bounds = [[zero; 3]; MAX_BOUNDS];
        let mut count = 0;
        if let Some([z, radius]) = self.ball {
            let (centre, radius) = (V::splat(simd, z), V::splat(simd, radius));
            let ball = NearestPoint::to_axis_point(simd, corners, z);
            let (mut foot, mut direction) = (ball.point, ball.direction);
            let beyond_it = open & (foot[2].simd_lt(from) | foot[2].simd_gt(to));
            if let Some(clip) = &part
                && beyond_it.any_true()
            {
                let end = clip.at_end(simd, corners, foot[2].simd_gt(to));
                foot = choose(beyond_it, &end, &foot);
                direction = direction_from_axis(simd, &foot, centre);
            }
            if let Some(point) = refine_at {
                let within = point[2].simd_ge(from) & point[2].simd_le(to);
                direction = choose(within, &direction_from_axis(simd, point, centre), &direction);
            }
            let beyond = extents_from(simd, corners, &direction, z);
            let inside = [radius - beyond[0], radius - beyond[1], radius - beyond[2]];
            let beneath = max_over(simd, &part, inside);
            let under = beneath.simd_lt(depth);
            depth = under.select(beneath, depth);
            deepest = choose(under, &foot, &deepest);
            bounds[count] = inside;
            count += 1;
        }
        if self.hole.is_some() || !self.rings.is_empty() {
            let far = distances(corners);
            if let Some(hole) = self.hole {
                let hole = V::splat(simd, hole);
                let beyond = [far[0] - hole, far[1] - hole, far[2] - hole];
                depth = depth.min(max_over(simd, &part, beyond));
                if refine_at.is_some() {
                    bounds[count] = beyond;
                    count += 1;
                }
            }
            for ring in &self.rings {
                let from_axis = AxisDistances { least: &out, greatest: &far };
                let distance = from_ring(simd, corners, &from_axis, *ring);
                depth = depth.min(max_over(simd, &part, distance));
            }
        }
        // Pairs of bounds are tighter than each by itself where one grows and the other falls. That pays off only once the
        // directions are those of a likely deepest point.
        if refine_at.is_some() {
            for plane in &self.planes {
                if count < MAX_BOUNDS {
                    bounds[count] = under_plane(simd, corners, &out, *plane);
                    count += 1;
                }
            }
            for guarded in &self.guarded {
                if count < MAX_BOUNDS {
                    let holds = guarded.holds(simd, corners, &out, &part);
                    let under = under_plane(simd, corners, &out, guarded.plane);
                    let other = under_plane(simd, corners, &out, self.planes[0]);
                    bounds[count] = choose(holds, &under, &other);
                    count += 1;
                }
            }
            for first in 0..count {
                for second in first + 1..count {
                    let (both, point) = under_both(zero, corners, &bounds[first], &bounds[second]);
                    let under = both.simd_lt(depth);
                    depth = under.select(both, depth);
                    deepest = choose(under, &point, &deepest);
                }
            }
            let far = distances(corners);
            for ring in &self.rings {
                let from_axis = AxisDistances { least: &out, greatest: &far };
                let distance = from_ring(simd, corners, &from_axis, *ring);
                let ring = RingDistances { ring: *ring, distance };
                for linear in &bounds[..count] {
                    let (both, point) = under_both_of_ring(simd, corners, &out, linear, &ring);
                    let under = both.simd_lt(depth);
                    depth = under.select(both, depth);
                    deepest = choose(under, &point, &deepest);
                }
            }
        }
        (depth, deepest)
    }
}

impl<R: Real> GuardedPlane<R> {
    /// Returns the lanes in which all of the triangle, or of its cut, is beyond the guards.
    #[inline(always)]
    fn holds<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[LaneVector<V>; 3],
        out: &[V; 3],
        part: &Part<V, V::Mask>,
    ) -> V::Mask {
        let mut short = V::splat(simd, R::of(f64::NEG_INFINITY));
        for guard in &self.guards {
            // The distance from the axis is at least `out`, and at most that of the corners.
            let radial = if guard[0] < R::of(0.0) { &distances(corners) } else { out };
            short = short.max(max_over(simd, part, under_plane(simd, corners, radial, *guard)));
        }
        short.simd_le(V::splat(simd, R::of(0.0)))
    }
}

/// Returns the distances of corners under a plane. `out` is how far out they are.
#[inline(always)]
fn under_plane<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    [a, b, c]: &[LaneVector<V>; 3],
    out: &[V; 3],
    [nd, nz, offset]: [R; 3],
) -> [V; 3] {
    let (nd, nz) = (V::splat(simd, nd), V::splat(simd, nz));
    let offset = V::splat(simd, offset);
    [
        offset - (out[0] * nd + a[2] * nz),
        offset - (out[1] * nd + b[2] * nz),
        offset - (out[2] * nd + c[2] * nz),
    ]
}

impl Hull<f64> {
    /// Returns an upper bound of the depth of a ring's points.
    pub(crate) fn of_ring(&self, ring: &NodeRing) -> f64 {
        let in_slab =
            self.slabs.iter().filter(|slab| ring.low <= slab.high && slab.low <= ring.high);
        let depths = in_slab.map(|slab| {
            // Only the part of the ring between the slab's heights.
            let (low, high) = (ring.low.max(slab.low), ring.high.min(slab.high));
            let under = |[nd, nz, c]: &[f64; 3]| {
                c - nd * ring.near - nz * if *nz > 0.0 { low } else { high }
            };
            let planes = slab.planes.iter().map(under);
            let holding = slab.guarded.iter().filter(|guarded| {
                guarded.guards.iter().all(|guard| guard[0] >= 0.0 && under(guard) <= 0.0)
            });
            let planes = planes.chain(holding.map(|guarded| under(&guarded.plane)));
            let ball = slab.ball.map(|[z, radius]| {
                let along = z.max(low).min(high) - z;
                radius - (ring.near * ring.near + along * along).sqrt()
            });
            planes.chain(ball).fold(f64::INFINITY, f64::min)
        });
        depths.fold(f64::NEG_INFINITY, f64::max)
    }
}

impl<S: Simd> BoxRings<f32x16<S>> {
    /// Returns the greatest distance under a plane, given as in [`HullSlab::planes`].
    #[inline(always)]
    fn under_plane(&self, simd: S, [nd, nz, c]: [f32; 3]) -> f32x16<S> {
        let d = if nd < 0.0 { self.far } else { self.near };
        let z = if nz > 0.0 { self.low } else { self.high };
        f32x16::splat(simd, c) - d * nd - z * nz
    }
}

impl Hull<f32> {
    /// Returns an upper bound of the depth of each ring's points. A bound of at most `threshold` need not be tight.
    #[inline(always)]
    pub(crate) fn of_rings<S: Simd>(
        &self,
        simd: S,
        rings: &BoxRings<f32x16<S>>,
        threshold: f32,
    ) -> f32x16<S> {
        let BoxRings { near, far, low, high, planes } = *rings;
        let zero = f32x16::splat(simd, 0.0);
        let mut bound = f32x16::splat(simd, f32::NEG_INFINITY);
        for slab in &self.slabs {
            let in_slab = low.simd_le(slab.high) & high.simd_ge(slab.low);
            let low = low.max(f32x16::splat(simd, slab.low));
            let high = high.min(f32x16::splat(simd, slab.high));
            let near = match planes {
                Some(planes) => near.max(planes.distance_of_axis(low, high)),
                None => near,
            };
            // The upright plane rules out most slabs for all rings.
            let [nd, _, radius] = slab.planes[0];
            let mut depth = f32x16::splat(simd, radius) - near * nd;
            if !(in_slab & !depth.simd_le(threshold)).any_true() {
                bound = in_slab.select(bound.max(depth), bound);
                continue;
            }
            let ends = BoxRings { near, far, low, high, planes: None };
            for plane in &slab.planes[1..] {
                depth = depth.min(ends.under_plane(simd, *plane));
            }
            for GuardedPlane { plane, guards } in &slab.guarded {
                let mut short = f32x16::splat(simd, f32::NEG_INFINITY);
                for guard in guards {
                    short = short.max(ends.under_plane(simd, *guard));
                }
                let holds = short.simd_le(zero);
                depth = holds.select(depth.min(ends.under_plane(simd, *plane)), depth);
            }
            if let Some([z, radius]) = slab.ball {
                let centre = f32x16::splat(simd, z);
                let along = centre.max(low).min(high) - centre;
                let mut beyond = (near * near + along * along).sqrt();
                if let Some(planes) = planes {
                    beyond = beyond.max(planes.distance_of_point(z));
                }
                depth = depth.min(f32x16::splat(simd, radius) - beyond);
            }
            if let Some(hole) = slab.hole {
                depth = depth.min(far - hole);
            }
            for &Ring { radius, height, annulus } in &slab.rings {
                let inward = f32x16::splat(simd, radius) - near;
                let outward = if annulus { zero } else { far - radius };
                let across = inward.max(outward).max(zero);
                let along = (low - height).abs().max((high - height).abs());
                depth = depth.min((across * across + along * along).sqrt());
            }
            bound = in_slab.select(bound.max(depth), bound);
        }
        bound
    }
}

impl BoxBounds for Hull<f32> {
    /// Returns an upper bound of the depth of each of 16 boxes, up to rounding. Absent boxes have NaN centres.
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        children: Children<'_>,
        view: &PoseTransform,
        threshold: f32,
    ) -> f32x16<S> {
        self.of_rings(simd, &rings(simd, children, view, self.margin, None), threshold)
    }
}

impl Bounds for Hull<f32> {
    #[inline(always)]
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[LaneVector<f32x16<S>>; 3],
        threshold: f32,
    ) -> f32x16<S> {
        let (mut bound, point) = self.triangles(simd, corners, threshold, None);
        if bound.simd_gt(threshold).to_bitmask().count_ones() > MAX_OPEN_LANES {
            bound = bound.min(self.triangles(simd, corners, threshold, Some(&point)).0);
        }
        bound
    }
}

/// Above this number of open triangles it pays to bound all of them again.
const MAX_OPEN_LANES: u32 = 2;

/// Returns the maximum of a linear function on a triangle, or on its cut by a slab.
#[inline(always)]
fn max_over<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    part: &Part<V, V::Mask>,
    [a, b, c]: [V; 3],
) -> V {
    match part {
        Some(clip) => clip.max_linear(simd, [a, b, c]),
        None => max3(a, b, c),
    }
}
