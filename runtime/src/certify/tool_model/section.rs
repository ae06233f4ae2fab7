//! The meridian section of a tool, bounded by its profile: exact distances in the half plane, and slabs between
//! heights that list the features that matter there.
//!
//! Points are `[d, z]` in the tool's frame and unit. A slab is the region between two heights and inward of one
//! feature, its *side*. It extends to the axis, or to another feature, its *inner* side, where the profile
//! overhangs. No feature ends between a slab's heights.

use crate::certify::rounding;
use crate::certify::tool_model::cells::CellTree;
use crate::certify::tool_model::chains::{Chain, TipBall};
use crate::certify::tool_model::feature::{
    Feature, MeridianPoint, Triangle, cross, dot, mean, minus, norm, quarters,
};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::tool::ToolInfo;
use std::cell::LazyCell;

/// The sine of a reflex corner's turn up to which it is left out. A corner only lowers bounds, so that no result is wrong. No point
/// is nearer to such a corner than to the lines that meet there by more than 5e-19 of its distance.
const MIN_REFLEX_TURN: f64 = 1e-9;

/// A region between two heights.
#[derive(Clone, Debug)]
pub(crate) struct SectionSlab {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The feature that bounds it away from the axis.
    pub(crate) side: usize,
    /// The feature that bounds it toward the axis; `None` if the slab reaches the axis.
    inner: Option<usize>,
    /// The least radius.
    pub(crate) hole: f64,
    /// The radii of its side at both heights.
    radii: [f64; 2],
    /// The largest radius.
    pub(crate) radius: f64,
    /// The range along the line of its side in which a foot is on the surface or outside the tool, so that depth is
    /// at most the distance from that line.
    feet: [f64; 2],
}

impl SectionSlab {
    /// Returns its bounding rectangle.
    pub(crate) fn rectangle(&self) -> Rectangle {
        Rectangle { low: [self.hole, self.low], high: [self.radius, self.high] }
    }
}

/// The section of a tool with a profile.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    pub(crate) features: Vec<Feature>,
    /// The features that can be the nearest to a point.
    pub(super) cells: CellTree,
    pub(crate) slabs: Vec<SectionSlab>,
    /// The slabs in chains, for bounds that need not be tight.
    pub(crate) chains: Vec<Chain>,
    /// The ball that bounds the depth of chords at the tip.
    pub(crate) tip_ball: Option<TipBall>,
    /// True if some heights have several slabs, or one that does not reach the axis.
    pub(super) overhangs: bool,
    /// The heights of circles about the axis on which depth can be greatest in a triangle: none before
    /// [`Section::with_circles`].
    pub(crate) circles: Vec<f64>,
    /// Rectangles in which there may be more of them.
    pub(crate) unresolved: Vec<Rectangle>,
    /// The largest distance of a point of the profile from the tip.
    pub(crate) size: f64,
    /// The error bound of heights: slabs are taken to reach farther by this.
    pub(crate) error: f64,
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
    /// Creates the section of a tool. Returns `None` if the tool has no profile.
    pub(crate) fn new(info: &ToolInfo, error: f64) -> Option<Section> {
        let features: Vec<Feature> = info.outline.iter().flat_map(quarters).collect();
        let size = features.iter().flat_map(|f| f.ends).map(norm).fold(0.0, f64::max);
        // Less than `error`, by which slabs are taken to reach farther: that is 64 ε of a length no smaller than
        // `size`.
        let slabs = slabs(&features, 4.0 * f64::EPSILON * size);
        if slabs.is_empty() {
            return None;
        }
        let overhangs = slabs.iter().any(|slab| slab.inner.is_some());
        let mut section = Section {
            features,
            cells: CellTree::default(),
            slabs,
            chains: Vec::new(),
            tip_ball: None,
            overhangs,
            circles: Vec::new(),
            unresolved: Vec::new(),
            size,
            error,
        };
        section.cells = CellTree::new(&section);
        for slab in 0..section.slabs.len() {
            let side = *section.side(&section.slabs[slab]);
            section.slabs[slab].feet = section.feet(&side, slab);
        }
        section.tip_ball = section.find_tip_ball();
        section.chains = section.chains();
        Some(section)
    }

    /// Returns the range along a line in which its feet are outside the tool, provided that they are between the
    /// heights of a slab.
    pub(crate) fn feet(&self, line: &Feature, slab: usize) -> [f64; 2] {
        let SectionSlab { low, high, .. } = self.slabs[slab];
        let mut below = self.slabs[..slab].iter().rev();
        let below = below.find(|other| !self.outside(line, other));
        let above = self.slabs[slab + 1..].iter().find(|other| !self.outside(line, other));
        if [below, above].into_iter().flatten().any(|other| other.low < high && low < other.high) {
            // The tool continues beyond a gap: only feet on the side itself are known to be on the surface.
            return [0.0, line.length];
        }
        [
            below.map_or(f64::NEG_INFINITY, |other| line.position_at_height(other.high).min(0.0)),
            above
                .map_or(f64::INFINITY, |other| line.position_at_height(other.low).max(line.length)),
        ]
    }

    /// Returns the feature that is the outer side of a slab.
    pub(crate) fn side(&self, slab: &SectionSlab) -> &Feature {
        &self.features[slab.side]
    }

    /// Returns the range along a line of the profile, other than a level one, in which its feet are on the surface or outside
    /// the tool.
    pub(crate) fn outside_feet(&self, index: usize) -> [f64; 2] {
        let line = &self.features[index];
        match self.slabs.iter().position(|slab| slab.side == index) {
            Some(slab) => self.feet(line, slab),
            None => [0.0, line.length],
        }
    }

    /// Returns whether a line stays outside the tool between a slab's heights.
    fn outside(&self, line: &Feature, slab: &SectionSlab) -> bool {
        let [low, high] = [slab.low, slab.high].map(|z| line.line_radius_at(z));
        match self.side(slab).circle {
            None => low >= slab.radii[0] && high >= slab.radii[1],
            // An arc may bulge between its ends, so the line has to clear the slab's largest radius.
            Some(_) => low.min(high) >= slab.radius,
        }
    }

    /// Returns whether no point of a slab is deeper than its distance from a line that touches the slab's side: all
    /// feet are on the surface or outside.
    pub(crate) fn tangent_bounds_slab(&self, line: &Feature, slab: usize) -> bool {
        let SectionSlab { low, high, hole, radii, .. } = self.slabs[slab];
        let [from, to] = self.feet(line, slab);
        let corners = [[hole, low], [hole, high], [radii[0], low], [radii[1], high]];
        // Positions along the line are linear, so the corners of the slab are the extremes.
        corners.into_iter().all(|p| (from..=to).contains(&line.position(p)))
    }

    /// Returns the lines of the profile that run upward, other than the slab's side, and have all of the slab on the tool's
    /// side and feet of some of its points.
    pub(crate) fn lines_beside(&self, slab: &SectionSlab) -> impl Iterator<Item = usize> {
        let [low, high] = [slab.low, slab.high];
        // An arc may bulge beyond the line between its ends.
        let is_line = self.side(slab).circle.is_none();
        let radii = if is_line { slab.radii } else { [slab.radius; 2] };
        let corners = [[slab.hole, low], [slab.hole, high], [radii[0], low], [radii[1], high]];
        let cells = self.cells_of(slab);
        let mut others: Vec<usize> = cells.into_iter().flat_map(|cell| cell.candidates).collect();
        // Neighbours bound depth near their common end, though they may be the nearest to no point of the slab.
        others.extend([slab.side.saturating_sub(1), (slab.side + 1).min(self.features.len() - 1)]);
        // Those next to the side along the profile are likely to bound depth best.
        others.sort_by_key(|other| (other.abs_diff(slab.side), *other));
        others.dedup();
        others.into_iter().skip_while(|other| *other == slab.side).filter(move |other| {
            let line = &self.features[*other];
            let positions = corners.map(|corner| line.position(corner));
            line.circle.is_none()
                && line.along[1] > 0.0
                && corners.iter().all(|corner| line.signed_distance(*corner) >= 0.0)
                && positions.iter().any(|at| *at > 0.0)
                && positions.iter().any(|at| *at < line.length)
        })
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
        self.features.windows(2).filter_map(move |pair| {
            let turn = cross(pair[0].tangent_at(1), pair[1].tangent_at(0));
            let point = pair[1].ends[0];
            (turn < -MIN_REFLEX_TURN && low <= point[1] && point[1] <= high).then(|| ReflexCorner {
                point,
                // Where the profile overhangs, the tool may be on either side of a level feature.
                ends_level: !self.overhangs
                    && pair.iter().any(|f| f.circle.is_none() && f.along[1] == 0.0),
            })
        })
    }

    /// Returns the slabs from the first that reaches a height.
    pub(crate) fn slabs_from(&self, z: f64) -> &[SectionSlab] {
        &self.slabs[self.slabs.partition_point(|slab| slab.high + self.error < z)..]
    }

    /// Returns whether a point is inside or on the surface.
    pub(crate) fn contains(&self, p: MeridianPoint) -> bool {
        let mut slabs = self.slabs_from(p[1]).iter().take_while(|slab| slab.low <= p[1]);
        slabs.any(|slab| slab.high >= p[1] && self.inner_distance(slab, p).0 >= 0.0)
    }

    /// Returns the distance of a point on the tool's side of a slab's sides, and the side for which it is less.
    #[inline]
    fn inner_distance(&self, slab: &SectionSlab, p: MeridianPoint) -> (f64, usize) {
        let outer = (self.side(slab).signed_distance(p), slab.side);
        let Some(side) = slab.inner else { return outer };
        let inner = (self.features[side].signed_distance(p), side);
        if inner.0 < outer.0 { inner } else { outer }
    }

    /// Returns the depth of a point; for a point outside, a value below 0 or nothing.
    pub(crate) fn depth_at(&self, owners: &Owners, p: MeridianPoint) -> Option<Depth> {
        // Several slabs are at a height where the profile overhangs, or where slabs meet.
        let slabs = self.slabs_from(p[1]).iter().take_while(|slab| slab.low - self.error <= p[1]);
        let depths = slabs.map(|slab| self.depth(owners, 0.0, slab, p));
        depths.reduce(|one, other| if other.value > one.value { other } else { one })
    }

    /// Returns the outward unit normal at the foot of a point on a feature: for a point outside, the direction from its foot.
    pub(crate) fn normal(&self, feature: usize, p: MeridianPoint) -> MeridianPoint {
        let feature = &self.features[feature];
        let away = minus(p, feature.foot(p));
        let length = norm(away);
        // Rounding decides on which side of the surface a point so near to it is.
        if length <= self.contact_tolerance() {
            return feature.signed_gradient(p).map(|part| -part);
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
        match self.cells.candidates(p) {
            Some(candidates) => self.nearest(candidates.iter().copied(), p),
            None => self.nearest(0..self.features.len(), p),
        }
    }

    /// Returns the signed depth of a point: outside, the negative of its distance.
    pub(crate) fn signed(&self, p: MeridianPoint) -> f64 {
        let value = self.unsigned_distance(p);
        if self.contains(p) { value } else { -value }
    }

    /// Returns whether owners own no point of a rectangle within `displacement` of a point with this depth.
    pub(crate) fn far_from(
        &self,
        owners: &Owners,
        rectangle: &[MeridianPoint; 4],
        p: MeridianPoint,
        depth: f64,
        displacement: f64,
    ) -> bool {
        !owners.all()
            && self.own_nothing(owners, rectangle, self.owner_margin(), |owner| {
                self.features[owner].distance(p) > depth + 2.0 * displacement
            })
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
            let other =
                -over <= self.contact_tolerance() && self.is_apart(owners, |f| f.distance(p));
            let value = if other { f64::NEG_INFINITY } else { over };
            return Depth {
                value,
                gradient: self.features[side].signed_gradient(p),
                feature: side,
            };
        }
        // The side of the slab is the first, so that it owns points of the slab that another feature is as near to.
        let side_distance = (self.side(slab).distance(p), slab.side);
        let (mut value, mut feature) = self.nearest_of_all(p);
        if side_distance.0 <= value {
            (value, feature) = side_distance;
        }
        let gradient = self.features[feature].distance_gradient(p);
        if !owners.is_owned(feature) {
            let owned = self.owned(owners).filter(|owner| !self.hidden_by_neighbours(*owner, &[p]));
            let (other, owner) = self.nearest(owned, p);
            if other > value + self.error + 2.0 * slack {
                return Depth { value: f64::NEG_INFINITY, gradient, feature };
            }
            feature = owner;
        }
        Depth { value, gradient, feature }
    }

    /// Returns the distance outside up to which a point counts as touching.
    fn contact_tolerance(&self) -> f64 {
        rounding::APART * self.error
    }

    /// Returns whether all owners are farther away than that.
    fn is_apart(&self, owners: &Owners, distance: impl Fn(&Feature) -> f64) -> bool {
        !owners.all()
            && self
                .owned(owners)
                .all(|owner| distance(&self.features[owner]) > self.contact_tolerance())
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
        let out = side.max_signed_distance_bound(triangle);
        let over = slab
            .inner
            .map_or(out, |inner| out.min(self.features[inner].max_signed_distance_bound(triangle)));
        if over < 0.0 {
            // A point so little outside touches; whether an owner does is worth knowing only above the threshold.
            let other =
                over > threshold && self.is_apart(owners, |f| f.min_distance_bound(triangle));
            return if other { f64::NEG_INFINITY } else { over };
        }
        // The signed distance from the side is a bound only where feet are on the surface or outside the tool.
        let mut bound = if side.projects_onto(triangle, slab.feet) { out } else { f64::INFINITY };
        // Any feature bounds depth; those near the middle of the triangle bound it best.
        for candidate in self.cells.candidates_near(mean(triangle)) {
            if bound <= threshold {
                return bound;
            }
            bound = bound.min(self.features[*candidate].max_distance_bound(triangle));
        }
        if bound > threshold && !owners.all() {
            // Depth is the distance of the nearest feature. An owner that is farther by more than the errors of both
            // distances owns no point here.
            let margin = self.owner_margin() + 2.0 * slack;
            if self.own_nothing(owners, triangle, margin, |owner| {
                self.features[owner].min_distance_bound(triangle) > bound + margin
            }) {
                return f64::NEG_INFINITY;
            }
        }
        bound
    }

    /// Returns the distance of a point from the owners, as a negative depth.
    #[inline]
    pub(crate) fn distance(&self, owners: &Owners, p: MeridianPoint) -> Depth {
        let (value, feature) =
            if owners.all() { self.nearest_of_all(p) } else { self.nearest(self.owned(owners), p) };
        let gradient = self.features[feature].distance_gradient(p).map(|part| -part);
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
        for owner in self.owned(owners) {
            let feature = &self.features[owner];
            // A distance has the Lipschitz constant 1.
            let coarse = reach - feature.distance(middle);
            let near = coarse > best.max(bound);
            bound = bound.max(if near {
                -feature.min_distance_bound(triangle).max(0.0)
            } else {
                coarse
            });
        }
        bound
    }

    /// Returns whether neighbouring features are nearer than `feature` to all points of a polygon. That is so if the
    /// nearest point of `feature` is an end that it shares with a neighbour, and the neighbour comes nearer from there.
    pub(crate) fn hidden_by_neighbours(&self, feature: usize, corners: &[MeridianPoint]) -> bool {
        let Some(ends) = self.features[feature].at_ends(corners) else { return false };
        [0, 1].into_iter().all(|end| !ends[end] || self.neighbour_is_nearer(feature, end, corners))
    }

    /// Returns whether owners own no point of a polygon: each is known to be far away, or its neighbours are nearer to all
    /// points, or a feature that is no owner is, by more than a margin.
    #[inline]
    pub(super) fn own_nothing<const N: usize>(
        &self,
        owners: &Owners,
        corners: &[MeridianPoint; N],
        margin: f64,
        is_far: impl Fn(usize) -> bool,
    ) -> bool {
        // Computed once: it is the same for all owners, and few polygons need it.
        let nearest_other = LazyCell::new(|| {
            let others = (0..self.features.len()).filter(|feature| !owners.is_owned(*feature));
            &self.features[self.nearest(others, mean(corners)).1]
        });
        self.owned(owners).all(|owner| {
            is_far(owner)
                || self.hidden_by_neighbours(owner, corners)
                || self.features[owner].is_farther(&nearest_other, corners, margin)
        })
    }

    /// Returns whether the neighbour that shares an end of a feature comes nearer to all points of a polygon from there.
    fn neighbour_is_nearer(&self, feature: usize, end: usize, corners: &[MeridianPoint]) -> bool {
        let neighbour = if end == 0 { feature.checked_sub(1) } else { Some(feature + 1) };
        let Some(other) = neighbour.and_then(|index| self.features.get(index)) else {
            return false;
        };
        // The direction in which the neighbour leaves the shared end.
        let tangent = other.tangent_at(1 - end);
        let outward = if end == 0 { tangent.map(|part| -part) } else { tangent };
        let from = self.features[feature].ends[end];
        corners.iter().all(|p| dot(outward, minus(*p, from)) > 0.0)
    }

    pub(crate) fn owned<'a>(&self, owners: &'a Owners) -> impl Iterator<Item = usize> + use<'a> {
        (0..self.features.len()).filter(|feature| owners.is_owned(*feature))
    }

    pub(super) fn nearest(
        &self,
        features: impl Iterator<Item = usize>,
        p: MeridianPoint,
    ) -> (f64, usize) {
        features.fold((f64::INFINITY, 0), |nearest, feature| {
            let distance = self.features[feature].distance(p);
            if distance < nearest.0 { (distance, feature) } else { nearest }
        })
    }
}

/// Returns the slabs between the heights at which features end, in upward order. Features whose ends differ in
/// height by at most `level` have none.
fn slabs(features: &[Feature], level: f64) -> Vec<SectionSlab> {
    let mut heights: Vec<f64> = features.iter().flat_map(|f| f.ends).map(|end| end[1]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|upper, lower| *upper - *lower <= level);
    let mut slabs = Vec::new();
    for pair in heights.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let middle = f64::midpoint(low, high);
        let passing = features.iter().enumerate().filter(|(_, feature)| {
            let [from, to] = feature.ends.map(|end| end[1]);
            (to - from).abs() > level && from.min(to) < middle && middle < from.max(to)
        });
        let mut sides: Vec<usize> = passing.map(|(index, _)| index).collect();
        sides.sort_by(|one, other| {
            features[*one].radius_at(middle).total_cmp(&features[*other].radius_at(middle))
        });
        // The tool is on the left of its profile: a feature that runs up ends it, one that runs down begins it.
        let mut inner = None;
        for side in sides {
            let [from, to] = features[side].ends.map(|end| end[1]);
            if from < to {
                slabs.push(SectionSlab::new(features, [low, high], side, inner.take()));
            } else {
                inner = Some(side);
            }
        }
    }
    slabs
}

impl SectionSlab {
    fn new(
        features: &[Feature],
        [low, high]: [f64; 2],
        side: usize,
        inner: Option<usize>,
    ) -> SectionSlab {
        let radii = [low, high].map(|z| features[side].radius_at(z));
        // A quarter of a circle is farthest out at its ends.
        let radius = radii[0].max(radii[1]);
        let hole = inner.map_or(0.0, |inner| {
            features[inner].radius_at(low).min(features[inner].radius_at(high))
        });
        SectionSlab { low, high, side, inner, hole, radii, radius, feet: [0.0; 2] }
    }
}
