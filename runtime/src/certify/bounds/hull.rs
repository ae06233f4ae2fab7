//! Upper bounds of the depth of a tool in boxes and triangles, in SIMD lanes.

use crate::bvh::{LaneVector, PoseTransform};
use crate::certify::bounds::descent::{Bounds, BoxBounds, BoxRings, Children, rings};
use crate::certify::bounds::nearest::{
    AxisDistances, Clip, NearestPoint, Real, Ring, RingDistances, choose, direction_from_axis,
    distances, extents_from, from_ring, max3, min3, radial_extents, under_both, under_both_of_ring,
};
use crate::certify::bounds::support::Support;
use crate::certify::part::NodeRing;
use crate::certify::tool_model::chains::Chain;
use crate::certify::tool_model::feature::{Feature, MeridianPoint};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::tool_model::section::Section;
use crate::interval::Interval;
use crate::tool::ToolInfo;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};

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
    pub(crate) fn new(section: &Section, zones: &[Option<Rectangle>], error: f64) -> Hull<R> {
        let slabs = section.chains.iter().filter_map(|chain| {
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
        let slabs = info.envelope.iter().map(|slab| HullSlab {
            low: R::of(slab.low - error),
            high: R::of(slab.high + error),
            planes: [[1.0, 0.0, slab.radius], [0.0, -1.0, -bottom], [0.0, 1.0, top]]
                .map(|plane| plane.map(|part| R::of(steep * part)))
                .to_vec(),
            guarded: Vec::new(),
            hole: None,
            ball: None,
            rings: Vec::new(),
        });
        Hull { slabs: slabs.collect(), margin: R::of(error), support: None }
    }

    /// Creates a hull of the regions that some features bound, for points no farther from these features than the
    /// hull is grown.
    pub(crate) fn holding(section: &Section, owners: &Owners, error: f64) -> Hull<R> {
        let zones: Vec<_> = section
            .slabs
            .iter()
            .map(|slab| owners.is_owned(slab.side).then_some(slab.rectangle()))
            .collect();
        // Points outside are no nearer to a plane that touches the tool than to the tool.
        let mut hull = Hull { support: None, ..Hull::new(section, &zones, error) };
        // A level feature is the side of no slab.
        let sides: Vec<usize> = section.slabs.iter().map(|slab| slab.side).collect();
        for (index, feature) in section.features.iter().enumerate() {
            if owners.is_owned(index) && !sides.contains(&index) {
                let [[d0, z0], [d1, z1]] = feature.ends;
                hull.slabs.push(HullSlab {
                    low: R::of(z0.min(z1) - error),
                    high: R::of(z0.max(z1) + error),
                    planes: vec![[1.0, 0.0, d0.max(d1)].map(R::of)],
                    guarded: Vec::new(),
                    hole: None,
                    ball: None,
                    rings: Vec::new(),
                });
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
fn under<R: Real>(line: &Feature) -> [R; 3] {
    plane([line.along[1], -line.along[0]], line.ends[0])
}

impl<R: Real> GuardedPlane<R> {
    /// Creates the plane of a line of the profile, for points whose feet are in a range along the line, where it is on the
    /// surface or outside the tool.
    fn new(line: &Feature, [from, to]: [f64; 2]) -> GuardedPlane<R> {
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
    /// Creates the bounds of a chain of slabs, for points between two heights.
    fn new(section: &Section, chain: &Chain, heights: [f64; 2]) -> HullSlab<R> {
        let slabs = &section.slabs[chain.slabs.clone()];
        let radius = slabs.iter().map(|slab| slab.radius).fold(0.0, f64::max);
        let (chain_low, chain_high) = (slabs[0].low, slabs[slabs.len() - 1].high);
        let [low, high] = heights.map(R::of);
        let mut bounds = HullSlab {
            low,
            high,
            // The radial distance to the surface.
            planes: vec![plane([1.0, 0.0], [radius, 0.0])],
            guarded: Vec::new(),
            hole: (slabs[0].hole > 0.0).then(|| R::of(slabs[0].hole)),
            ball: section.tip_ball_about(chain).map(|ball| ball.map(R::of)),
            rings: Vec::new(),
        };
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
        let side = &section.features[slab.side];
        let [[d0, z0], [d1, z1]] = side.ends;
        let slope = (d1 - d0) / (z1 - z0);
        let convex = side.circle.is_some_and(|circle| circle.convex);
        let line = side.tangent();
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
            self.planes.push(plane([1.0, -slope], side.ends[0]));
        }
        for line in section.lines_beside(slab) {
            let feet = section.outside_feet(line);
            self.guarded.push(GuardedPlane::new(&section.features[line], feet));
        }
        // For an arc that does not reach the axis, the feet next to it are not on the surface.
        if d0.min(d1) == 0.0
            && let Some(ball) = side.ball(section.size)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::QuerySetup;
    use crate::certify::bounds::descent::{BoundedTree, Node, of_children};
    use crate::certify::part::TriangleBvh;
    use crate::certify::space::Point;
    use crate::certify::tool_model::chains::TipBall;
    use crate::mesh::Mesh;
    use crate::pose::Pose;
    use crate::tool::Interpreted;
    use crate::tool::Tool;
    use crate::unit::Unit;
    use fearless_simd::{Level, dispatch, f64x8};
    use nalgebra::{Point3, Vector3};
    use std::f64::consts::FRAC_PI_2;
    use std::sync::LazyLock;

    const ERROR: f64 = 1e-12;

    static NECKED: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Necked "reflex corners between lines, and a convex corner above one" {
            units mm;
            profile {
                start (0, 0);
                arc to (1, 1) center (0, 1) as nose cutting;
                line to (1, 5) as flute cutting;
                line to (3, 7), (3, 9) as neck;
                line to (5, 9), (5, 20), (0, 20) as housing;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    static WAISTED: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Waisted "a waist between cones" {
            units mm;
            profile {
                start (0, 0);
                line to (4, 0) as face cutting;
                line to (5, 6) as side cutting;
                line to (2, 9), (2, 15) as neck;
                line to (6, 18), (0, 20) as head;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    static ROUNDED: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Rounded "convex and concave arcs beside lines" {
            units mm;
            profile {
                start (0, 0);
                line to (2, 0) as face cutting;
                arc to (4, 2) center (2, 2) as edge cutting;
                line to (3, 8) as side cutting;
                arc to (5, 10) center (5, 8) concave as fillet;
                line to (7, 14), (7, 16), (0, 16) as shank;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    static HOLLOW: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Hollow "a cone from below, so that the profile runs downward first" {
            units mm;
            profile {
                start (0, 4);
                line to (4, 0) as cup cutting;
                line to (6, 0), (6, 12), (0, 12) as body;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    /// A ball and a rounded shoulder of 3 mm radius, as polylines of 48 chords.
    static CHORDED: LazyLock<Interpreted> = LazyLock::new(|| {
        let chords = |[d, z]: [f64; 2]| {
            let points = (1..48).map(|k| {
                let (sine, cosine) = (f64::from(k) / 48.0 * FRAC_PI_2).sin_cos();
                format!("({:.5}, {:.5})", d + 3.0 * sine, z - 3.0 * cosine)
            });
            points.collect::<Vec<String>>().join(", ")
        };
        let [ball, shoulder] = [[0.0, 3.0], [3.5, 9.0]].map(chords);
        let text = format!(
            r#"tool Chorded "chords" {{
                units mm;
                profile {{
                    start (0, 0);
                    line to {ball}, (3, 3) as ball cutting;
                    line to (3, 6) as flute cutting;
                    line to (3.5, 6), {shoulder}, (6.5, 9), (6.5, 16), (0, 16) as shank;
                }}
                niceness cutting: 1;
            }}"#
        );
        text.parse().expect("a tool")
    });

    /// Returns the tools of these tests.
    fn tools() -> [&'static ToolInfo; 5] {
        [NECKED.info(), WAISTED.info(), ROUNDED.info(), HOLLOW.info(), CHORDED.info()]
    }

    #[test]
    fn chords_of_a_ball_are_bounded_by_it_and_those_of_a_shoulder_together() {
        let section = Section::new(CHORDED.info(), ERROR).expect("a profile");
        let TipBall { slabs, ball: [centre, radius] } = section.tip_ball.expect("a ball");
        assert!(slabs == 48 && (centre - 3.0).abs() < 1e-5 && (radius - 3.0).abs() < 1e-5);
        let chains = section.chains.iter().map(|chain| chain.slabs.clone());
        assert!(chains.clone().flatten().eq(0..section.slabs.len()));
        // Below the flattest of them the tool continues.
        let shoulder = chains.filter(|slabs| slabs.start > 48 && slabs.len() > 1);
        assert!(shoulder.flatten().count() > 0);
    }

    /// A sequence of numbers from 0 to 1 that looks random.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn between(&mut self, low: f64, high: f64) -> f64 {
            low + (high - low) * self.next()
        }

        /// Returns a triangle of some size near the tool.
        fn triangle(&mut self, section: &Section) -> [Point; 3] {
            let [low, high] = section.reach();
            let size = 8.0 * self.next().powi(3);
            let middle = [
                self.between(-5.0, 5.0),
                self.between(-5.0, 5.0),
                self.between(low - 1.0, high + 1.0),
            ];
            [(); 3].map(|()| middle.map(|at| at + size * self.between(-1.0, 1.0)))
        }
    }

    /// Returns the greatest depth of some points of a triangle, by the distances from all segments.
    fn sampled(section: &Section, [a, b, c]: &[Point; 3]) -> f64 {
        const STEPS: u32 = 24;
        let mut deepest = f64::NEG_INFINITY;
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let (u, v) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
                let [x, y, z] = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
                let p = [x.hypot(y), z];
                if section.contains(p) {
                    deepest = deepest.max(section.unsigned_distance(p));
                }
            }
        }
        deepest
    }

    #[test]
    fn no_sampled_point_of_a_triangle_is_deeper_than_its_bounds() {
        let mut numbers = Numbers(1);
        let (mut inside, mut refined) = (0, 0);
        for info in tools() {
            let section = Section::new(info, ERROR).expect("a profile");
            let zones: Vec<_> = section.slabs.iter().map(|slab| Some(slab.rectangle())).collect();
            let hull = Hull::<f64>::new(&section, &zones, ERROR);
            for _ in 0..3000 {
                let triangle = numbers.triangle(&section);
                let deepest = sampled(&section, &triangle);
                let [first, second] =
                    dispatch!(Level::new(), simd => both_bounds(simd, &hull, &triangle));
                assert!(deepest <= first + 1e-9, "{}: {triangle:?} {deepest} {first}", info.name);
                assert!(deepest <= second + 1e-9, "{}: {triangle:?} {deepest} {second}", info.name);
                inside += usize::from(deepest > 0.0);
                refined += usize::from(second < first);
            }
        }
        assert!(inside > 3000 && refined > 1000, "{inside} {refined}");
    }

    /// Returns the bound of a triangle, and that at its likely deepest point.
    fn both_bounds<S: Simd>(simd: S, hull: &Hull<f64>, triangle: &[Point; 3]) -> [f64; 2] {
        let corners = triangle.map(|p| p.map(|at| f64x8::splat(simd, at)));
        let (first, point) = hull.triangles(simd, &corners, 0.0, None);
        let (second, _) = hull.triangles(simd, &corners, 0.0, Some(&point));
        [first[0], second[0]]
    }

    #[test]
    fn a_triangle_that_touches_an_arc_is_not_deep() {
        let section = Section::new(ROUNDED.info(), ERROR).expect("a profile");
        let zones: Vec<_> = section.slabs.iter().map(|slab| Some(slab.rectangle())).collect();
        let hull = Hull::<f64>::new(&section, &zones, ERROR);
        for (degrees, turn) in [(1, 0.0), (20, 1.0), (45, 2.0), (70, 3.0), (60, -2.0)] {
            // Outward from the centre of the edge: down at 0 degrees. Beyond 70 the shank, which is wider, reaches farther.
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let azimuth = Vector3::new(f64::cos(turn), f64::sin(turn), 0.0);
            let out = azimuth * sine - Vector3::z() * cosine;
            let touch = azimuth * 2.0 + Vector3::z() * 2.0 + out * 2.0;
            let [u, v] = [azimuth.cross(&Vector3::z()), azimuth * cosine + Vector3::z() * sine];
            for deep in [0.0, 0.125] {
                let corners = [[-2.0, -1.0], [2.0, -2.0], [0.5, 3.0]]
                    .map(|[x, y]| (touch - out * deep + u * x + v * y).into());
                let [bound, _] =
                    dispatch!(Level::new(), simd => both_bounds(simd, &hull, &corners));
                assert!((bound - deep).abs() < 1e-12, "{degrees}: {bound}, not {deep}");
            }
        }
    }

    #[test]
    fn no_sampled_point_of_a_node_is_deeper_than_its_bound() {
        let mut numbers = Numbers(2);
        let mut inside = 0;
        for info in tools() {
            let section = Section::new(info, ERROR).expect("a profile");
            let zones: Vec<_> = section.slabs.iter().map(|slab| Some(slab.rectangle())).collect();
            for _ in 0..60 {
                // A strip of triangles that is almost plane, in places flat.
                let [at, across, up] = [(); 3].map(|()| {
                    Vector3::new(
                        numbers.between(-3.0, 3.0),
                        numbers.between(-3.0, 3.0),
                        numbers.between(-3.0, 3.0),
                    )
                });
                let at = Point3::new(0.0, 0.0, numbers.between(0.0, 16.0)) + at;
                let bend = numbers.between(-0.02, 0.02);
                let vertices = (0..20 * 20).map(|k| {
                    let [u, v] = [k / 20, k % 20].map(|k| f64::from(k) / 10.0 - 1.0);
                    at + across * u + up * v + across.cross(&up) * (bend * u * u)
                });
                let triangles = (0..19 * 19).flat_map(|k: u32| {
                    let corner = k / 19 * 20 + k % 19;
                    [[corner, corner + 1, corner + 20], [corner + 1, corner + 21, corner + 20]]
                });
                let mesh = Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
                let bvh = TriangleBvh::new(&mesh);
                let setup = QuerySetup::new(&bvh.frame, info, 1.0);
                let margin = setup.margin;
                let hull = Hull::<f32>::new(&section, &zones, margin);
                let mut view = PoseTransform::default();
                let pose = Pose::from_axis(Point3::origin(), Vector3::z()).expect("a unit vector");
                if !setup.set_pose(&bvh.frame, &pose, &mut view) {
                    continue;
                }
                let tree = BoundedTree { bvh: &bvh, bounds: &hull, view: &view };
                let root = Node { level: 0, index: 0, bound: f32::INFINITY };
                let mut bounds = [0.0f32; 16];
                of_children(Level::new(), &tree, root, f32::NEG_INFINITY, &mut bounds);
                let below = 16usize.pow(bvh.levels.len() as u32);
                for (child, triangles) in bvh.corners.chunks(below).enumerate() {
                    let axes = pose.rotation().transpose();
                    let deepest = triangles.iter().map(|corners| {
                        let corners = corners.map(|p| (axes * Vector3::from(p)).into());
                        sampled(&section, &corners)
                    });
                    let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
                    let bound = f64::from(bounds[child]) + 4.0 * margin;
                    assert!(deepest <= bound, "{}: {deepest} {bound}", info.name);
                    inside += usize::from(deepest > 0.0);
                }
            }
        }
        assert!(inside > 200, "{inside}");
    }

    /// A triangle that is beside the housing where it is as high, and below it where it is nearer to the axis.
    #[test]
    fn a_triangle_that_passes_below_a_step_is_not_deep() {
        let section = Section::new(NECKED.info(), ERROR).expect("a profile");
        let zones: Vec<_> = section.slabs.iter().map(|slab| Some(slab.rectangle())).collect();
        let hull = Hull::<f64>::new(&section, &zones, ERROR);
        let corners = [[3.5, 0.0, 8.9], [8.5, 0.0, 9.2], [8.5, 1.0, 9.2]];
        let [bound, _] = dispatch!(Level::new(), simd => both_bounds(simd, &hull, &corners));
        assert!(bound < 0.0, "{bound}");
    }
}
