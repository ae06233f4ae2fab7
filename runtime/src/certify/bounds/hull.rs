//! How deep a tool is at most in boxes and triangles, side by side.

use crate::bvh::{Boxes, PoseTransform};
use crate::certify::body::feature::{Feature, Place};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::{self, Section};
use crate::certify::bounds::descent::{Bounds, BoxBounds, Rings, rings};
use crate::certify::bounds::nearest::{
    Clip, Near, Real, Space, across, beyond, choose, direction, distances, from_ring, least, most,
    under_both,
};
use crate::certify::part::Ring;
use crate::tool::Card;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};

/// A tool's slabs, for bounds.
pub(crate) struct Hull<R> {
    pub(crate) slabs: Vec<Slab<R>>,
}

/// Between two heights depth is no more than each of these says.
pub(crate) struct Slab<R> {
    pub(crate) low: R,
    pub(crate) high: R,
    /// How far a place is on the tool's side of a plane, `c - n_d d - n_z z`, as `[n_d, n_z, c]`. The first
    /// is upright.
    pub(crate) planes: Vec<[R; 3]>,
    /// The radius of the hole about the axis, if there is one: a place is no deeper than it is beyond that.
    pub(crate) hole: Option<R>,
    /// How far it is inside a ball about a place of the axis, as `[z, radius]`.
    pub(crate) ball: Option<[R; 2]>,
    /// How far it is from a circle about the axis, as `[d, z]`; and whether the level ring beyond the
    /// circle is the tool's surface too.
    pub(crate) rings: Vec<([R; 2], bool)>,
}

impl<R: Real> Hull<R> {
    /// For places inside: none is deeper. Slabs are those between the heights of their zones, and reach
    /// farther by how far heights are known.
    pub(crate) fn new(section: &Section, zones: &[Option<[f64; 2]>], error: f64) -> Hull<R> {
        let slabs =
            section.slabs.iter().enumerate().zip(zones).filter_map(|((index, slab), zone)| {
                let [from, to] = (*zone)?;
                let side = &section.features[slab.side];
                let [[d0, z0], [d1, z1]] = side.ends;
                let plane = |n: Place, [d, z]: Place| [n[0], n[1], n[0] * d + n[1] * z].map(R::of);
                let touching =
                    |line: &Feature| plane([line.along[1], -line.along[0]], line.ends[0]);
                // How far it is to the surface on the level.
                let mut planes = vec![plane([1.0, 0.0], [slab.radius, 0.0])];
                let slope = (d1 - d0) / (z1 - z0);
                let convex = side.circle.is_some_and(|circle| circle.convex);
                let line = side.tangent();
                if line.as_ref().is_some_and(|line| section.covers(line, index)) {
                    planes.extend(line.as_ref().map(touching));
                } else if slope != 0.0 && slope.abs() <= 2.0 && !convex {
                    planes.push(plane([1.0, -slope], side.ends[0]));
                }
                let [low, high] = section.reach();
                if slab.low - low <= slab.radius {
                    planes.push(plane([0.0, -1.0], [0.0, low]));
                }
                if high - slab.high <= slab.radius {
                    planes.push(plane([0.0, 1.0], [0.0, high]));
                }
                // Of an arc that does not come to the axis, feet beside it are not on the surface.
                let to_axis = d0.min(d1) == 0.0;
                let ball = side.ball(section.size).filter(|_| to_axis).map(|ball| ball.map(R::of));
                let rings = section.reflex(slab).map(|(place, level)| (place.map(R::of), level));
                let [low, high] = [from - error, to + error].map(R::of);
                let hole = (slab.hole > 0.0).then(|| R::of(slab.hole));
                Some(Slab { low, high, planes, hole, ball, rings: rings.collect() })
            });
        Hull { slabs: slabs.collect() }
    }

    /// Of a tool whose depth changes so fast at most: it is no more than that times the way out of what
    /// holds the tool.
    pub(crate) fn about(card: &Card, steep: f64, error: f64) -> Hull<R> {
        let [bottom, top] = card.reach();
        let plane = |nd: f64, nz: f64, c: f64| [nd, nz, c].map(|part| R::of(steep * part));
        let slabs = card.envelope.iter().map(|slab| Slab {
            low: R::of(slab.low - error),
            high: R::of(slab.high + error),
            planes: vec![
                plane(1.0, 0.0, slab.radius),
                plane(0.0, -1.0, -bottom),
                plane(0.0, 1.0, top),
            ],
            hole: None,
            ball: None,
            rings: Vec::new(),
        });
        Hull { slabs: slabs.collect() }
    }

    /// For places no farther from some features than it is made to grow: what of the tool these bound.
    pub(crate) fn holding(section: &Section, owners: &Owners, error: f64) -> Hull<R> {
        let side = |slab: &section::Slab| owners.own(slab.side).then_some([slab.low, slab.high]);
        let zones: Vec<_> = section.slabs.iter().map(side).collect();
        let mut hull = Hull::new(section, &zones, error);
        // What is level bounds no slab.
        let sides: Vec<usize> = section.slabs.iter().map(|slab| slab.side).collect();
        for (index, feature) in section.features.iter().enumerate() {
            if owners.own(index) && !sides.contains(&index) {
                let [[d0, z0], [d1, z1]] = feature.ends;
                hull.slabs.push(Slab {
                    low: R::of(z0.min(z1) - error),
                    high: R::of(z0.max(z1) + error),
                    planes: vec![[1.0, 0.0, d0.max(d1)].map(R::of)],
                    hole: None,
                    ball: None,
                    rings: Vec::new(),
                });
            }
        }
        hull
    }

    /// No less than the depth of any place of each of some triangles, but for rounding; and where depth
    /// may be greatest. What is not there has NaN. What is no more than wanted need not be close. Given
    /// such places, it looks closer from there.
    #[inline(always)]
    pub(crate) fn triangles<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[Space<V>; 3],
        wanted: R,
        again: Option<&Space<V>>,
    ) -> (V, Space<V>) {
        let [a, b, c] = corners;
        let (low, high) = (least(a[2], b[2], c[2]), most(a[2], b[2], c[2]));
        let near = Near::to_axis(simd, corners);
        // No corner is nearer to the axis than it is out in that direction.
        let out = across(corners, &near.way);
        let wanted = V::splat(simd, wanted);
        let mut bound = V::splat(simd, R::of(f64::NEG_INFINITY));
        let mut place = near.place;
        for slab in &self.slabs {
            let (from, to) = (V::splat(simd, slab.low), V::splat(simd, slab.high));
            let here = low.simd_le(to) & high.simd_ge(from);
            // Most slabs are out of reach, by how far out triangles are.
            let [p, q, r] = under_plane(simd, corners, &out, slab.planes[0]);
            let outside = most(p, q, r);
            if !(here & !outside.simd_le(wanted)).any_true() {
                bound = here.select(bound.max(outside), bound);
                continue;
            }
            let depth = slab.under_planes(simd, corners, &out, &None);
            let open = here & depth.simd_gt(wanted);
            let (depth, deepest) = if open.any_true() {
                slab.triangles(simd, corners, &near, open, again)
            } else {
                (depth, near.place)
            };
            let better = here & depth.simd_gt(bound);
            bound = better.select(depth, bound);
            place = choose(better, &deepest, &place);
        }
        (bound, place)
    }
}

/// The most bounds that a slab has for a triangle.
const BOUNDS: usize = 8;

/// A part of triangles, if a slab cuts them.
type Part<V, M> = Option<Clip<V, M>>;

impl<R: Real> Slab<R> {
    /// The least of the most of what planes say of each triangle.
    #[inline(always)]
    fn under_planes<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[Space<V>; 3],
        out: &[V; 3],
        part: &Part<V, V::Mask>,
    ) -> V {
        let mut depth = V::splat(simd, R::of(f64::INFINITY));
        for plane in &self.planes {
            depth = depth.min(most_of(simd, part, under_plane(simd, corners, out, *plane)));
        }
        depth
    }

    /// The same of the parts of triangles between a slab's heights, for those that are open.
    #[inline(always)]
    fn triangles<S: Simd, V: SimdFloat<S, Element = R>>(
        &self,
        simd: S,
        corners: &[Space<V>; 3],
        near: &Near<V>,
        open: V::Mask,
        again: Option<&Space<V>>,
    ) -> (V, Space<V>) {
        let zero = V::splat(simd, R::of(0.0));
        let (from, to) = (V::splat(simd, self.low), V::splat(simd, self.high));
        // Where a triangle is nearest beyond a slab, the part of it in the slab is so at that end.
        let (mut deepest, mut way, mut part) = (near.place, near.way, None);
        let beyond_it = open & (deepest[2].simd_lt(from) | deepest[2].simd_gt(to));
        if beyond_it.any_true() {
            let clip = Clip::new(simd, corners, [self.low, self.high]);
            let end = clip.at_end(simd, corners, deepest[2].simd_gt(to));
            deepest = choose(beyond_it, &end, &deepest);
            way = direction(simd, &[deepest[0], deepest[1], zero], zero);
            part = Some(clip);
        }
        if let Some(place) = again {
            let within = place[2].simd_ge(from) & place[2].simd_le(to);
            let other = direction(simd, &[place[0], place[1], zero], zero);
            way = choose(within, &other, &way);
        }
        let out = across(corners, &way);
        let mut depth = self.under_planes(simd, corners, &out, &part);
        // Of each bound what it is at the corners; between them it is no more than linear.
        let mut bounds = [[zero; 3]; BOUNDS];
        let mut count = 0;
        if let Some([z, radius]) = self.ball {
            let (centre, radius) = (V::splat(simd, z), V::splat(simd, radius));
            let ball = Near::to_place(simd, corners, z);
            let (mut foot, mut way) = (ball.place, ball.way);
            let beyond_it = open & (foot[2].simd_lt(from) | foot[2].simd_gt(to));
            if beyond_it.any_true() {
                if part.is_none() {
                    part = Some(Clip::new(simd, corners, [self.low, self.high]));
                }
                if let Some(clip) = &part {
                    let end = clip.at_end(simd, corners, foot[2].simd_gt(to));
                    foot = choose(beyond_it, &end, &foot);
                    way = direction(simd, &foot, centre);
                }
            }
            if let Some(place) = again {
                let within = place[2].simd_ge(from) & place[2].simd_le(to);
                way = choose(within, &direction(simd, place, centre), &way);
            }
            let beyond = beyond(simd, corners, &way, z);
            let here = [radius - beyond[0], radius - beyond[1], radius - beyond[2]];
            let beneath = most_of(simd, &part, here);
            let under = beneath.simd_lt(depth);
            depth = under.select(beneath, depth);
            deepest = choose(under, &foot, &deepest);
            bounds[count] = here;
            count += 1;
        }
        if self.hole.is_some() || !self.rings.is_empty() {
            let far = distances(corners);
            if let Some(hole) = self.hole {
                let hole = V::splat(simd, hole);
                let here = [far[0] - hole, far[1] - hole, far[2] - hole];
                depth = depth.min(most_of(simd, &part, here));
                if again.is_some() {
                    bounds[count] = here;
                    count += 1;
                }
            }
            for ring in &self.rings {
                let here = from_ring(simd, corners, (&out, &far), *ring);
                depth = depth.min(most_of(simd, &part, here));
                if again.is_some() && count < BOUNDS {
                    bounds[count] = here;
                    count += 1;
                }
            }
        }
        if again.is_some() {
            for plane in &self.planes {
                if count < BOUNDS {
                    bounds[count] = under_plane(simd, corners, &out, *plane);
                    count += 1;
                }
            }
            for first in 0..count - 1 {
                for second in first + 1..count {
                    let (both, place) = under_both(zero, corners, &bounds[first], &bounds[second]);
                    let under = both.simd_lt(depth);
                    depth = under.select(both, depth);
                    deepest = choose(under, &place, &deepest);
                }
            }
        }
        (depth, deepest)
    }
}

/// How far corners are under a plane, as far out as they are.
#[inline(always)]
fn under_plane<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    [a, b, c]: &[Space<V>; 3],
    out: &[V; 3],
    [nd, nz, most]: [R; 3],
) -> [V; 3] {
    let (nd, nz, most) = (V::splat(simd, nd), V::splat(simd, nz), V::splat(simd, most));
    [
        most - (out[0] * nd + a[2] * nz),
        most - (out[1] * nd + b[2] * nz),
        most - (out[2] * nd + c[2] * nz),
    ]
}

impl Hull<f64> {
    /// No less than the depth of any place of a ring.
    pub(crate) fn of_ring(&self, ring: &Ring) -> f64 {
        let here = self.slabs.iter().filter(|slab| ring.low <= slab.high && slab.low <= ring.high);
        let depths = here.map(|slab| {
            let (low, high) = (ring.low.max(slab.low), ring.high.min(slab.high));
            let planes = slab.planes.iter().map(|[nd, nz, most]| {
                most - nd * ring.near - nz * if *nz > 0.0 { low } else { high }
            });
            let ball = slab.ball.map(|[z, radius]| {
                let along = z.max(low).min(high) - z;
                radius - (ring.near * ring.near + along * along).sqrt()
            });
            planes.chain(ball).fold(f64::INFINITY, f64::min)
        });
        depths.fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Hull<f32> {
    /// No less than the depth of any place of rings. What is no more than wanted need not be close.
    #[inline(always)]
    pub(crate) fn of_rings<S: Simd>(
        &self,
        simd: S,
        rings: &Rings<f32x16<S>>,
        wanted: f32,
    ) -> f32x16<S> {
        let Rings { near, far, low, high } = *rings;
        let zero = f32x16::splat(simd, 0.0);
        let mut bound = f32x16::splat(simd, f32::NEG_INFINITY);
        for slab in &self.slabs {
            let here = low.simd_le(slab.high) & high.simd_ge(slab.low);
            let low = low.max(f32x16::splat(simd, slab.low));
            let high = high.min(f32x16::splat(simd, slab.high));
            // Most slabs are out of reach of all rings, by how far out they are.
            let [nd, _, most] = slab.planes[0];
            let mut depth = f32x16::splat(simd, most) - near * nd;
            if !(here & !depth.simd_le(wanted)).any_true() {
                bound = here.select(bound.max(depth), bound);
                continue;
            }
            for &[nd, nz, most] in &slab.planes[1..] {
                let z = if nz > 0.0 { low } else { high };
                depth = depth.min(f32x16::splat(simd, most) - near * nd - z * nz);
            }
            if let Some([z, radius]) = slab.ball {
                let centre = f32x16::splat(simd, z);
                let along = centre.max(low).min(high) - centre;
                let beyond = (near * near + along * along).sqrt();
                depth = depth.min(f32x16::splat(simd, radius) - beyond);
            }
            if let Some(hole) = slab.hole {
                depth = depth.min(far - hole);
            }
            for &([d, z], level) in &slab.rings {
                let inward = f32x16::splat(simd, d) - near;
                let outward = if level { zero } else { far - d };
                let across = inward.max(outward).max(zero);
                let along = (low - z).abs().max((high - z).abs());
                depth = depth.min((across * across + along * along).sqrt());
            }
            bound = here.select(bound.max(depth), bound);
        }
        bound
    }
}

impl BoxBounds for Hull<f32> {
    /// No less than the depth of any place in each of 16 boxes, but for rounding; what is not there has
    /// NaN.
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        boxes: &Boxes,
        view: &PoseTransform,
        wanted: f32,
    ) -> f32x16<S> {
        self.of_rings(simd, &rings(simd, boxes, view, None), wanted)
    }
}

impl Bounds for Hull<f32> {
    #[inline(always)]
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Space<f32x16<S>>; 3],
        wanted: f32,
    ) -> f32x16<S> {
        let (mut bound, place) = self.triangles(simd, corners, wanted, None);
        if bound.simd_gt(wanted).to_bitmask().count_ones() > SEVERAL {
            bound = bound.min(self.triangles(simd, corners, wanted, Some(&place)).0);
        }
        bound
    }
}

/// Of more triangles than these it is worth to look at all more closely.
const SEVERAL: u32 = 2;

/// The most of what is linear between corners, within a slab if that cuts them.
#[inline(always)]
fn most_of<S: Simd, R: Real, V: SimdFloat<S, Element = R>>(
    simd: S,
    part: &Part<V, V::Mask>,
    [a, b, c]: [V; 3],
) -> V {
    match part {
        Some(clip) => clip.most(simd, [a, b, c]),
        None => most(a, b, c),
    }
}
