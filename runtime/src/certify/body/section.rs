//! A tool's section as its profile bounds it: exact distances in the half plane, and slabs between
//! heights that say which pieces can matter there.
//!
//! Places are `[d, z]` in the tool's frame and unit. A slab holds what lies, between two heights, on
//! the axis' side of one piece, its *side*: as far as the axis, or to another piece, its *inner* side,
//! where the profile overhangs. No piece ends between a slab's heights.

use crate::certify::body::circles;
use crate::certify::body::feature::{Feature, Place, Triangle, cross, dot, minus, norm, quarters};
use crate::certify::body::owners::Owners;
use crate::tool::Card;

/// What lies between two heights.
#[derive(Clone, Debug)]
pub(crate) struct Slab {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The feature that bounds it away from the axis.
    pub(crate) side: usize,
    /// The feature that bounds it toward the axis, if it does not reach that.
    inner: Option<usize>,
    /// The least radius.
    pub(crate) hole: f64,
    /// The radii of its side at both heights.
    radii: [f64; 2],
    /// The features that can be the nearest to a place in it.
    near: Vec<usize>,
    /// The largest radius.
    pub(crate) radius: f64,
    /// From where to where along the line of its side a foot is on the surface or outside the tool,
    /// so that depth is no more than the distance from that line.
    pub(crate) feet: [f64; 2],
}

/// The profile of a tool.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    pub(crate) features: Vec<Feature>,
    pub(crate) slabs: Vec<Slab>,
    /// Whether some heights have several of them, or one that does not reach the axis.
    overhangs: bool,
    /// The heights of circles about the axis on which it can be deepest in a triangle.
    pub(crate) circles: Vec<f64>,
    /// How far it reaches from the tip.
    pub(crate) size: f64,
    /// How far heights are known: slabs are taken to reach that much farther.
    pub(crate) error: f64,
}

/// How deep a place is, and how that changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depth {
    /// The depth; outside, something less than 0.
    pub(crate) value: f64,
    pub(crate) gradient: Place,
    pub(crate) feature: usize,
}

impl Section {
    /// The section of a tool with a profile; `None` without one, or where it overhangs in more ways than
    /// can be told.
    pub(crate) fn new(card: &Card, error: f64) -> Option<Section> {
        let features: Vec<Feature> = card.outline.iter().flat_map(quarters).collect();
        let size = features.iter().flat_map(|f| f.ends).map(norm).fold(0.0, f64::max);
        // Less than `error`, by which slabs are taken to reach farther: 64 ε of what is no smaller than `size`.
        let slabs = slabs(&features, 4.0 * f64::EPSILON * size);
        if slabs.is_empty() {
            return None;
        }
        let overhangs = slabs.iter().any(|slab| slab.inner.is_some());
        let circles = Vec::new();
        let mut section = Section { features, slabs, overhangs, circles, size, error };
        for slab in 0..section.slabs.len() {
            let side = section.features[section.slabs[slab].side];
            section.slabs[slab].feet = section.feet(&side, slab);
        }
        if overhangs {
            section.circles = circles::heights(&section)?;
        }
        Some(section)
    }

    /// From where to where on a line its feet are outside the tool, given that they are between the heights
    /// of a slab.
    fn feet(&self, line: &Feature, slab: usize) -> [f64; 2] {
        let at = |z: f64| (z - line.ends[0][1]) / line.along[1];
        let Slab { low, high, .. } = self.slabs[slab];
        let inside = |other: &&Slab| !self.outside(line, other);
        let below = self.slabs[..slab].iter().rev().find(inside);
        let above = self.slabs[slab + 1..].iter().find(inside);
        let beside = |other: Option<&Slab>| other.is_some_and(|o| o.low < high && low < o.high);
        if beside(below) || beside(above) {
            // The tool goes on beyond a gap: only feet on the side itself are known to be on the surface.
            return [0.0, line.length];
        }
        [
            below.map_or(f64::NEG_INFINITY, |other| at(other.high).min(0.0)),
            above.map_or(f64::INFINITY, |other| at(other.low).max(line.length)),
        ]
    }

    /// Whether a line stays outside the tool between a slab's heights.
    fn outside(&self, line: &Feature, slab: &Slab) -> bool {
        let slope = line.along[0] / line.along[1];
        let radius = |z: f64| line.ends[0][0] + slope * (z - line.ends[0][1]);
        let (low, high) = (radius(slab.low), radius(slab.high));
        match self.features[slab.side].circle {
            None => low >= slab.radii[0] && high >= slab.radii[1],
            Some(_) => low.min(high) >= slab.radius,
        }
    }

    /// Whether no place of a slab is deeper than its distance from a line that touches the slab's side:
    /// the feet of all are on the surface or outside.
    pub(crate) fn covers(&self, line: &Feature, slab: usize) -> bool {
        let Slab { low, high, hole, radii, .. } = self.slabs[slab];
        let [from, to] = self.feet(line, slab);
        let corners = [[hole, low], [hole, high], [radii[0], low], [radii[1], high]];
        corners.into_iter().all(|p| {
            let at = dot(line.along, minus(p, line.ends[0]));
            from <= at && at <= to
        })
    }

    /// The lowest and the highest place's height.
    pub(crate) fn reach(&self) -> [f64; 2] {
        [self.slabs[0].low, self.slabs[self.slabs.len() - 1].high]
    }

    /// The reflex corners that can be the nearest to places of a slab, and whether a level piece goes out
    /// from each, on which the tool does not go on. A corner only lowers bounds, so that which are left out for being
    /// flatter than 1e-9 makes no answer wrong; no place is nearer to such a corner than to the lines that meet there by more
    /// than 5e-19 of its distance.
    pub(crate) fn reflex(&self, slab: &Slab) -> impl Iterator<Item = (Place, bool)> {
        let pairs = self.features.windows(2).filter(|pair| {
            let [before, after] = [pair[0].heading(1), pair[1].heading(0)];
            cross(before, after) < -1e-9
        });
        let near = |z: f64| slab.low - slab.radius <= z && z <= slab.high + slab.radius;
        // Where the profile overhangs, the tool may be on either side of a level piece.
        let level = |f: &Feature| !self.overhangs && f.circle.is_none() && f.along[1] == 0.0;
        pairs
            .map(move |pair| (pair[1].ends[0], level(&pair[0]) || level(&pair[1])))
            .filter(move |(place, _)| near(place[1]))
    }

    /// The slabs from the first that reaches a height.
    pub(crate) fn from(&self, z: f64) -> &[Slab] {
        &self.slabs[self.slabs.partition_point(|slab| slab.high + self.error < z)..]
    }

    /// Whether a place is inside or on the surface.
    pub(crate) fn contains(&self, p: Place) -> bool {
        let inside =
            |slab: &Slab| (slab.low..=slab.high).contains(&p[1]) && self.over(slab, p).0 >= 0.0;
        self.slabs.iter().any(inside)
    }

    /// How far a place is on the tool's side of a slab's sides, and of which it is less so.
    #[inline]
    fn over(&self, slab: &Slab, p: Place) -> (f64, usize) {
        let of = |side: usize| (self.features[side].over(p), side);
        let outer = of(slab.side);
        slab.inner.map(of).filter(|inner| inner.0 < outer.0).unwrap_or(outer)
    }

    /// How deep a place is; below 0 or nothing outside.
    pub(crate) fn depth_at(&self, owners: &Owners, p: Place) -> Option<Depth> {
        // Several slabs are at a height where the profile overhangs, or where they meet.
        let here = self.from(p[1]).iter().take_while(|slab| slab.low - self.error <= p[1]);
        let depths = here.map(|slab| self.depth((owners, 0.0), slab, p));
        depths.reduce(|one, other| if other.value > one.value { other } else { one })
    }

    /// The distance of a place from the profile.
    pub(crate) fn away(&self, p: Place) -> f64 {
        self.nearest(0..self.features.len(), p).0
    }

    /// How deep a place is; outside, the negative of its distance.
    pub(crate) fn signed(&self, p: Place) -> f64 {
        let value = self.away(p);
        if self.contains(p) { value } else { -value }
    }

    /// Whether owners own no place of a rectangle that is no farther than `goes` from one so deep.
    pub(crate) fn far_from(
        &self,
        owners: &Owners,
        rectangle: &[Place; 4],
        (p, depth, goes): (Place, f64, f64),
    ) -> bool {
        !owners.all()
            && self.owned(owners).all(|owner| {
                self.features[owner].away(p) > depth + 2.0 * goes || self.behind(owner, rectangle)
            })
    }

    /// How deep a place in a slab is; less than 0 outside, and nothing where other features are the nearest to all
    /// places no farther than `slack` from it.
    #[inline]
    pub(crate) fn depth(&self, (owners, slack): (&Owners, f64), slab: &Slab, p: Place) -> Depth {
        let (over, side) = self.over(slab, p);
        if over < 0.0 {
            let other = -over <= self.touch() && self.apart(owners, |f| f.away(p));
            let value = if other { f64::NEG_INFINITY } else { over };
            return Depth { value, gradient: self.features[side].inward(p), feature: side };
        }
        let (value, mut feature) = self.nearest(slab.near.iter().copied(), p);
        let gradient = self.features[feature].outward(p);
        if !owners.own(feature) {
            let owned = self.owned(owners).filter(|owner| !self.behind(*owner, &[p]));
            let (other, owner) = self.nearest(owned, p);
            if other > value + self.error + 2.0 * slack {
                return Depth { value: f64::NEG_INFINITY, gradient, feature };
            }
            feature = owner;
        }
        Depth { value, gradient, feature }
    }

    /// How far outside a place may be and still be taken to touch.
    fn touch(&self) -> f64 {
        4.0 * self.error
    }

    /// Whether all owners are farther away than what touches.
    fn apart(&self, owners: &Owners, away: impl Fn(&Feature) -> f64) -> bool {
        !owners.all() && self.owned(owners).all(|owner| away(&self.features[owner]) > self.touch())
    }

    /// No less than the depth of any place of a slab in a triangle; below 0 if none is inside. What is
    /// not more than `enough` need not be known well.
    #[inline]
    pub(crate) fn at_most(
        &self,
        (owners, slack): (&Owners, f64),
        slab: &Slab,
        triangle: &Triangle,
        enough: f64,
    ) -> f64 {
        let side = &self.features[slab.side];
        let out = side.over_at_most(triangle);
        let over =
            slab.inner.map_or(out, |inner| out.min(self.features[inner].over_at_most(triangle)));
        if over < 0.0 {
            let other = over > enough && self.apart(owners, |f| f.at_least(triangle));
            return if other { f64::NEG_INFINITY } else { over };
        }
        let mut bound = if side.square(triangle, slab.feet) { out } else { f64::INFINITY };
        for near in &slab.near {
            if bound <= enough {
                return bound;
            }
            bound = bound.min(self.features[*near].at_most(triangle));
        }
        if bound > enough && !owners.all() {
            let apart = bound + 2.0 * (self.error + slack);
            let none = |owner: usize| {
                self.behind(owner, triangle) || self.features[owner].at_least(triangle) > apart
            };
            if self.owned(owners).all(none) {
                return f64::NEG_INFINITY;
            }
        }
        bound
    }

    /// The distance of a place from the owners, as a depth: less than 0.
    #[inline]
    pub(crate) fn distance(&self, owners: &Owners, p: Place) -> Depth {
        let (value, feature) = self.nearest(self.owned(owners), p);
        let gradient = self.features[feature].outward(p).map(|part| -part);
        Depth { value: -value, gradient, feature }
    }

    /// No less than the negative distance of any place in a triangle from the owners. What is not more
    /// than `best` need not be known well.
    #[inline]
    pub(crate) fn no_nearer(&self, owners: &Owners, triangle: &Triangle, best: f64) -> f64 {
        let [first, second, middle] = *triangle;
        let reach = norm(minus(first, middle)).max(norm(minus(second, middle)));
        let mut bound = f64::NEG_INFINITY;
        for owner in self.owned(owners) {
            let feature = &self.features[owner];
            // A distance changes by no more than the way.
            let coarse = reach - feature.away(middle);
            let near = coarse > best.max(bound);
            bound = bound.max(if near { -feature.at_least(triangle).max(0.0) } else { coarse });
        }
        bound
    }

    /// Whether features beside another are nearer to all places of a triangle, a rectangle or the like: its
    /// nearest point is an end that it shares, and along the feature beside it is yet nearer.
    pub(crate) fn behind(&self, feature: usize, corners: &[Place]) -> bool {
        let Some(ends) = self.features[feature].at_ends(corners) else { return false };
        let nearer = |end: usize| {
            let beside = if end == 0 { feature.checked_sub(1) } else { Some(feature + 1) };
            beside.and_then(|beside| self.features.get(beside)).is_some_and(|other| {
                let heading = other.heading(1 - end);
                let way = if end == 0 { heading.map(|part| -part) } else { heading };
                let from = self.features[feature].ends[end];
                corners.iter().all(|p| dot(way, minus(*p, from)) > 0.0)
            })
        };
        [0, 1].into_iter().all(|end| !ends[end] || nearer(end))
    }

    pub(crate) fn owned<'a>(&self, owners: &'a Owners) -> impl Iterator<Item = usize> + use<'a> {
        (0..self.features.len()).filter(|feature| owners.own(*feature))
    }

    fn nearest(&self, features: impl Iterator<Item = usize>, p: Place) -> (f64, usize) {
        features.fold((f64::INFINITY, 0), |nearest, feature| {
            let away = self.features[feature].away(p);
            if away < nearest.0 { (away, feature) } else { nearest }
        })
    }
}

/// The slabs between the heights at which features end, upward; features that are level to so much have
/// none.
fn slabs(features: &[Feature], level: f64) -> Vec<Slab> {
    let height = |feature: &Feature, end: usize| feature.ends[end][1];
    let mut heights: Vec<f64> = features.iter().flat_map(|f| f.ends).map(|end| end[1]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|upper, lower| *upper - *lower <= level);
    let mut slabs = Vec::new();
    for pair in heights.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let middle = f64::midpoint(low, high);
        let passes = |feature: &Feature| {
            let [from, to] = [0, 1].map(|end| height(feature, end));
            (to - from).abs() > level && from.min(to) < middle && middle < from.max(to)
        };
        let mut sides: Vec<usize> = (0..features.len()).filter(|k| passes(&features[*k])).collect();
        let radius = |side: &usize| features[*side].radius_at(middle);
        sides.sort_by(|one, other| radius(one).total_cmp(&radius(other)));
        let mut inner = None;
        for side in sides {
            if height(&features[side], 0) < height(&features[side], 1) {
                slabs.push(Slab::new(features, [low, high], side, inner.take()));
            } else {
                inner = Some(side);
            }
        }
    }
    slabs
}

impl Slab {
    fn new(features: &[Feature], [low, high]: [f64; 2], side: usize, inner: Option<usize>) -> Slab {
        let radii_of = |side: usize| [low, high].map(|z| features[side].radius_at(z));
        let radii = radii_of(side);
        // A quarter of a circle is as far out as its ends.
        let radius = radii[0].max(radii[1]);
        let hole = inner.map(radii_of).map_or(0.0, |[first, last]| first.min(last));
        // The way out on the level is no longer, nor that to the nearer of two sides than half the way between.
        let deepest = if inner.is_some() { 0.5 * (radius - hole) } else { radius };
        let reaches = |f: &Feature| {
            let [z0, z1] = f.ends.map(|end| end[1]);
            z0.min(z1) <= high + deepest && z0.max(z1) >= low - deepest
        };
        let mut near: Vec<usize> = (0..features.len()).filter(|k| reaches(&features[*k])).collect();
        near.sort_by_key(|k| k.abs_diff(side));
        Slab { low, high, side, inner, hole, radii, near, radius, feet: [0.0; 2] }
    }
}
