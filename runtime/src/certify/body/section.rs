//! A tool's section as its profile bounds it: exact distances in the half plane, and slabs between
//! heights that say which pieces can matter there.
//!
//! Places are `[d, z]` in the tool's frame and unit. The profile is a function of z, so that a slab
//! holds what lies between the axis and one piece, its *side*.

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
    /// The section of a tool with a profile; `None` where that is not a function of z.
    pub(crate) fn new(card: &Card, error: f64) -> Option<Section> {
        let features: Vec<Feature> = card.outline.iter().flat_map(quarters).collect();
        let size = features.iter().flat_map(|f| f.ends).map(norm).fold(0.0, f64::max);
        let level = 4.0 * f64::EPSILON * size;
        let rise = |f: &Feature| f.ends[1][1] - f.ends[0][1];
        if features.is_empty() || features.iter().any(|f| rise(f) < -level) {
            return None;
        }
        let sides = (0..features.len()).filter(|k| rise(&features[*k]) > level);
        let mut slabs: Vec<Slab> = sides.map(|side| Slab::new(&features, side)).collect();
        // What is level is left out; there shall be no gap.
        for k in 1..slabs.len() {
            slabs[k].low = slabs[k].low.min(slabs[k - 1].high);
        }
        let mut section = Section { features, slabs, size, error };
        for slab in 0..section.slabs.len() {
            let side = section.features[section.slabs[slab].side];
            section.slabs[slab].feet = section.feet(&side, slab);
        }
        Some(section)
    }

    /// From where to where on a line its feet are outside the tool, given that they are between the heights
    /// of a slab.
    fn feet(&self, line: &Feature, slab: usize) -> [f64; 2] {
        let at = |z: f64| (z - line.ends[0][1]) / line.along[1];
        let inside = |other: &&Slab| !self.outside(line, other);
        let below = self.slabs[..slab].iter().rev().find(inside);
        let above = self.slabs[slab + 1..].iter().find(inside);
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
        let side = &self.features[slab.side];
        match side.circle {
            None => low >= side.ends[0][0] && high >= side.ends[1][0],
            Some(_) => low.min(high) >= slab.radius,
        }
    }

    /// Whether no place of a slab is deeper than its distance from a line that touches the slab's side:
    /// the feet of all are on the surface or outside.
    pub(crate) fn covers(&self, line: &Feature, slab: usize) -> bool {
        let Slab { low, high, side, .. } = self.slabs[slab];
        let [from, to] = self.feet(line, slab);
        let ends = self.features[side].ends;
        let mut corners = [[0.0, low], [0.0, high], ends[0], ends[1]].into_iter();
        corners.all(|p| {
            let at = dot(line.along, minus(p, line.ends[0]));
            from <= at && at <= to
        })
    }

    /// The lowest and the highest place's height.
    pub(crate) fn reach(&self) -> [f64; 2] {
        [self.slabs[0].low, self.slabs[self.slabs.len() - 1].high]
    }

    /// The reflex corners that can be the nearest to places of a slab, and whether a level piece goes out
    /// from each.
    pub(crate) fn reflex(&self, slab: &Slab) -> impl Iterator<Item = (Place, bool)> {
        let pairs = self.features.windows(2).filter(|pair| {
            let [before, after] = [pair[0].heading(1), pair[1].heading(0)];
            cross(before, after) < -1e-9
        });
        let near = |z: f64| slab.low - slab.radius <= z && z <= slab.high + slab.radius;
        let level = |f: &Feature| f.circle.is_none() && f.along[1] == 0.0;
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
        let inside = |slab: &Slab| {
            (slab.low..=slab.high).contains(&p[1]) && self.features[slab.side].over(p) >= 0.0
        };
        self.slabs.iter().any(inside)
    }

    /// How deep a place is; below 0 or nothing outside.
    pub(crate) fn depth_at(&self, owners: &Owners, p: Place) -> Option<Depth> {
        let slab = self.from(p[1]).first().filter(|slab| slab.low - self.error <= p[1])?;
        let depth = self.depth(owners, slab, p);
        // What is level belongs to the slabs on both its sides.
        let above = self.from(p[1]).get(1).filter(|above| above.low - self.error <= p[1]);
        match above {
            Some(above) if depth.value < 0.0 => Some(self.depth(owners, above, p)),
            _ => Some(depth),
        }
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

    /// How deep a place in a slab is; less than 0 outside, and nothing where other features are the nearest.
    #[inline]
    pub(crate) fn depth(&self, owners: &Owners, slab: &Slab, p: Place) -> Depth {
        let side = &self.features[slab.side];
        let over = side.over(p);
        if over < 0.0 {
            let other = -over <= self.touch() && self.apart(owners, |f| f.away(p));
            let value = if other { f64::NEG_INFINITY } else { over };
            return Depth { value, gradient: side.inward(p), feature: slab.side };
        }
        let (value, mut feature) = self.nearest(slab.near.iter().copied(), p);
        let gradient = self.features[feature].outward(p);
        if !owners.own(feature) {
            let owned = self.owned(owners).filter(|owner| !self.behind(*owner, &[p]));
            let (other, owner) = self.nearest(owned, p);
            if other > value + self.error {
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
        owners: &Owners,
        slab: &Slab,
        triangle: &Triangle,
        enough: f64,
    ) -> f64 {
        let side = &self.features[slab.side];
        let over = side.over_at_most(triangle);
        if over < 0.0 {
            let other = over > enough && self.apart(owners, |f| f.at_least(triangle));
            return if other { f64::NEG_INFINITY } else { over };
        }
        let mut bound = if side.square(triangle, slab.feet) { over } else { f64::INFINITY };
        for near in &slab.near {
            if bound <= enough {
                return bound;
            }
            bound = bound.min(self.features[*near].at_most(triangle));
        }
        if bound > enough && !owners.all() {
            let apart = bound + 2.0 * self.error;
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

impl Slab {
    fn new(features: &[Feature], side: usize) -> Slab {
        let [[d0, low], [d1, high]] = features[side].ends;
        // A quarter of a circle is as far out as its ends, and the way out along d no longer.
        let radius = d0.max(d1);
        let reaches = |f: &Feature| {
            let [z0, z1] = f.ends.map(|end| end[1]);
            z0.min(z1) <= high + radius && z0.max(z1) >= low - radius
        };
        let mut near: Vec<usize> = (0..features.len()).filter(|k| reaches(&features[*k])).collect();
        near.sort_by_key(|k| k.abs_diff(side));
        Slab { low, high, side, near, radius, feet: [0.0; 2] }
    }
}
