//! The meridian section of a tool, bounded by its profile: exact distances and bounds of them in the half plane.
//!
//! Points are `[d, z]` in the tool's frame and unit.

use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::cells::CellTree;
use crate::certify::tool_model::outline::Outline;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::quarter::{Triangle, mean};
use crate::certify::tool_model::slab::SectionSlab;
use crate::tool::ToolInfo;
use touchoff_plane::{cross, minus, norm};

/// The sine of a reflex corner's turn up to which it is left out. A corner only lowers bounds, so that no result is wrong. No point
/// is nearer to such a corner than to the lines that meet there by more than 5e-19 of its distance.
const MIN_REFLEX_TURN: f64 = 1e-9;

/// The section of a tool with a profile.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    pub(crate) outline: Outline,
    /// The features that can be the nearest to a point.
    pub(super) cells: CellTree,
    /// In upward order.
    pub(crate) slabs: Vec<SectionSlab>,
    /// True if some heights have several slabs, or one that does not reach the axis.
    pub(super) overhangs: bool,
}

/// A corner of the profile at which the tool's interior angle is more than half a turn.
pub(crate) struct ReflexCorner {
    pub(crate) point: MeridianPoint,
    /// True if a level feature ends at the corner, beyond which the tool does not continue.
    pub(crate) ends_level: bool,
}

/// The depth of a point, and its gradient.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depth {
    /// The depth; for a point outside, a value less than 0.
    pub(crate) value: f64,
    pub(crate) gradient: MeridianPoint,
    pub(crate) feature: usize,
}

impl Section {
    /// Creates the section of a tool; `error` is the error bound of a point. Returns `None` if the tool has no profile.
    pub(crate) fn new(info: &ToolInfo, error: f64) -> Option<Section> {
        let outline = Outline::new(info, error);
        let slabs = outline.slabs();
        if slabs.is_empty() {
            return None;
        }
        let overhangs = slabs.iter().any(|slab| slab.inner.is_some());
        Some(Section { cells: CellTree::new(&outline), outline, slabs, overhangs })
    }

    /// Returns the lowest and the highest z of the section.
    pub(crate) fn reach(&self) -> [f64; 2] {
        [self.slabs[0].low, self.slabs[self.slabs.len() - 1].high]
    }

    /// Returns the reflex corners between two heights.
    pub(crate) fn reflex_corners(
        &self,
        [low, high]: [f64; 2],
    ) -> impl Iterator<Item = ReflexCorner> {
        self.outline.features.windows(2).filter_map(move |pair| {
            let turn = cross(pair[0].segment.tangent(1), pair[1].segment.tangent(0));
            let point = pair[1].segment.ends[0];
            (turn < -MIN_REFLEX_TURN && low <= point[1] && point[1] <= high).then(|| ReflexCorner {
                point,
                // Where the profile overhangs, the tool may be on either side of a level feature.
                ends_level: !self.overhangs
                    && pair.iter().any(|f| f.segment.circle.is_none() && f.segment.along[1] == 0.0),
            })
        })
    }

    /// Returns the slabs from the first that reaches a height.
    pub(crate) fn slabs_from(&self, z: f64) -> &[SectionSlab] {
        &self.slabs[self.slabs.partition_point(|slab| slab.high + self.outline.error < z)..]
    }

    /// Returns whether a point is inside or on the surface.
    #[inline]
    pub(crate) fn contains(&self, p: MeridianPoint) -> bool {
        let mut slabs = self.slabs_from(p[1]).iter().take_while(|slab| slab.low <= p[1]);
        slabs.any(|slab| slab.high >= p[1] && self.inner_distance(slab, p).0 >= 0.0)
    }

    /// Returns the distance of a point on the tool's side of a slab's sides, and the side for which it is less.
    #[inline]
    fn inner_distance(&self, slab: &SectionSlab, p: MeridianPoint) -> (f64, usize) {
        let outer = (self.side(slab).continued_distance(p), slab.side);
        let Some(side) = slab.inner else { return outer };
        let inner = (self.outline.features[side].continued_distance(p), side);
        if inner.0 < outer.0 { inner } else { outer }
    }

    /// Returns the depth of a point; for a point outside, a value below 0 or nothing.
    pub(crate) fn depth_at(&self, owners: &Owners, p: MeridianPoint) -> Option<Depth> {
        // Several slabs are at a height where the profile overhangs, or where slabs meet.
        let slabs =
            self.slabs_from(p[1]).iter().take_while(|slab| slab.low - self.outline.error <= p[1]);
        let depths = slabs.map(|slab| self.depth(owners, 0.0, slab, p));
        depths.reduce(|one, other| if other.value > one.value { other } else { one })
    }

    /// Returns the outward unit normal at the foot of a point on a feature: for a point outside, the direction from its foot.
    pub(crate) fn normal(&self, feature: usize, p: MeridianPoint) -> MeridianPoint {
        let feature = &self.outline.features[feature];
        let away = minus(p, feature.segment.foot(p));
        let length = norm(away);
        // Rounding decides on which side of the surface a point so near to it is.
        if length <= self.outline.contact_tolerance() {
            return feature.continued_gradient(p).map(|part| -part);
        }
        let sense = if self.contains(p) { -1.0 } else { 1.0 };
        away.map(|part| sense * part / length)
    }

    /// Returns the distance of a point from the profile.
    pub(crate) fn unsigned_distance(&self, p: MeridianPoint) -> f64 {
        self.nearest_of_all(p).0
    }

    /// Returns the distance of a point from the nearest feature, and that feature.
    #[inline]
    fn nearest_of_all(&self, p: MeridianPoint) -> (f64, usize) {
        match self.cells.is_divided() {
            true => self.nearest_candidate(p),
            false => self.outline.nearest(0..self.outline.features.len(), p),
        }
    }

    /// Computes the same among the candidates of a cell. Not inlined: in the loop over the features of a short outline its code takes a tenth
    /// of a distance query.
    #[inline(never)]
    fn nearest_candidate(&self, p: MeridianPoint) -> (f64, usize) {
        match self.cells.candidates(p) {
            Some(candidates) => self.outline.nearest(candidates.iter().copied(), p),
            None => self.outline.nearest(0..self.outline.features.len(), p),
        }
    }

    /// Returns the signed depth of a point: outside, the negative of its distance.
    pub(crate) fn signed(&self, p: MeridianPoint) -> f64 {
        let value = self.unsigned_distance(p);
        if self.contains(p) { value } else { -value }
    }

    /// Returns the depth of a point in a slab; outside, a value less than 0. It is -∞ if other features are the
    /// nearest to all points within `slack` of it.
    #[inline]
    pub(crate) fn depth(
        &self,
        owners: &Owners,
        slack: f64,
        slab: &SectionSlab,
        p: MeridianPoint,
    ) -> Depth {
        let (over, side) = self.inner_distance(slab, p);
        if over < 0.0 {
            let other = -over <= self.outline.contact_tolerance()
                && owners.are_apart(&self.outline, |f| f.segment.distance(p));
            let value = if other { f64::NEG_INFINITY } else { over };
            return Depth {
                value,
                gradient: self.outline.features[side].continued_gradient(p),
                feature: side,
            };
        }
        // The side of the slab is the first, so that it owns points of the slab that another feature is as near to.
        let side_distance = (self.side(slab).segment.distance(p), slab.side);
        let (mut value, mut feature) = self.nearest_of_all(p);
        if side_distance.0 <= value {
            (value, feature) = side_distance;
        }
        let gradient = self.outline.features[feature].distance_gradient(p);
        if !owners.is_owned(feature) {
            let owned = owners
                .owned(&self.outline)
                .filter(|owner| !self.outline.hidden_by_neighbours(*owner, &[p]));
            let (other, owner) = self.outline.nearest(owned, p);
            if other > value + self.outline.error + 2.0 * slack {
                return Depth { value: f64::NEG_INFINITY, gradient, feature };
            }
            feature = owner;
        }
        Depth { value, gradient, feature }
    }

    /// Returns an upper bound of the depth of a slab's points in a triangle; below 0 if none is inside. A bound of at
    /// most `threshold` need not be tight.
    #[inline]
    pub(crate) fn depth_bound(
        &self,
        owners: &Owners,
        slack: f64,
        slab: &SectionSlab,
        triangle: &Triangle,
        threshold: f64,
    ) -> f64 {
        let side = self.side(slab);
        let out = side.max_continued_distance(triangle);
        let over = slab.inner.map_or(out, |inner| {
            out.min(self.outline.features[inner].max_continued_distance(triangle))
        });
        if over < 0.0 {
            // A point so little outside touches; whether an owner does is worth knowing only above the threshold.
            let other =
                over > threshold && owners.are_apart(&self.outline, |f| f.min_distance(triangle));
            return if other { f64::NEG_INFINITY } else { over };
        }
        // The signed distance from the side is a bound only where feet are on the surface or outside the tool.
        let mut bound = if side.projects_onto(triangle, slab.feet) { out } else { f64::INFINITY };
        // Any feature bounds depth; those near the middle of the triangle bound it best.
        for candidate in self.cells.candidates_near(mean(triangle)) {
            if bound <= threshold {
                return bound;
            }
            bound = bound.min(self.outline.features[*candidate].max_distance(triangle));
        }
        if bound > threshold && !owners.all() {
            // Depth is the distance of the nearest feature. An owner that is farther by more than the errors of both
            // distances owns no point here.
            let margin = self.outline.owner_margin() + 2.0 * slack;
            if owners.own_nothing(&self.outline, triangle, margin, |owner| {
                self.outline.features[owner].min_distance(triangle) > bound + margin
            }) {
                return f64::NEG_INFINITY;
            }
        }
        bound
    }

    /// Returns the distance of a point from the owners, as a negative depth.
    #[inline]
    pub(crate) fn distance(&self, owners: &Owners, p: MeridianPoint) -> Depth {
        let (value, feature) = if owners.all() {
            self.nearest_of_all(p)
        } else {
            self.outline.nearest(owners.owned(&self.outline), p)
        };
        let gradient = self.outline.features[feature].distance_gradient(p).map(|part| -part);
        Depth { value: -value, gradient, feature }
    }

    /// Returns an upper bound of the negative distance of a triangle's points from the owners. A bound of at most `best`
    /// need not be tight.
    #[inline]
    pub(crate) fn negative_distance_bound(
        &self,
        owners: &Owners,
        triangle: &Triangle,
        best: f64,
    ) -> f64 {
        let [first, second, middle] = *triangle;
        let reach = norm(minus(first, middle)).max(norm(minus(second, middle)));
        let mut bound = f64::NEG_INFINITY;
        for owner in owners.owned(&self.outline) {
            let feature = &self.outline.features[owner];
            // A distance has the Lipschitz constant 1.
            let coarse = reach - feature.segment.distance(middle);
            let near = coarse > best.max(bound);
            bound = bound.max(if near { -feature.min_distance(triangle).max(0.0) } else { coarse });
        }
        bound
    }
}
