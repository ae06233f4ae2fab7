//! Convex polygons that cover the cells of a partition.
//!
//! A feature's cell lies within the normals at its ends, on the interior side of its line or circle, and where no other
//! feature is nearer. Polygons that begin with the first two are cut wherever another feature is provably at least as
//! near, and halved where that is not yet decided. They cover the cell whatever the heuristics of the halving: a point
//! is left out only if another feature is at least as near to it within [`Section::tolerance`]. Neighbours may overlap
//! along borders that are not straight, where the polygons know the side of the border instead.
//!
//! **Nearer, proved.** On a convex polygon the distance from a line, and from a convex circle, is at least a function
//! that is linear or concave: itself. That from a point or a concave circle is at least its tangent plane at the
//! middle. The distance from another segment is at most a convex function: that from its line, a concave circle or an
//! end, and the tangent plane of that from a convex circle. The difference of the two is concave, so that its least
//! value is at a vertex.

use super::section::{Feature, Section};
use crate::geometry::outline::{Point, Segment, dot, minus, norm};
use crate::geometry::polygon::{
    Polygon, area, centre_and_half, centroid, clipped, divided, halved, hull, range,
};
use std::collections::VecDeque;
use touchoff_plane::Circle;

/// The least part of a polygon's breadth that a cut along a normal leaves on either side: thinner pieces prove little more.
const MIN_CUT: f64 = 0.02;
/// The breadth, in the tool's size, below which a polygon is not cut so.
const MIN_CUT_FRACTION: f64 = 1e-3;

/// The number of polygons of a feature that are halved.
const MAX_HALVINGS: usize = 300;
/// The part of a distance by which another feature may be nearer at a vertex of a polygon that is not halved.
const LOOSE_FRACTION: f64 = 0.08;
/// The least area that is halved, relative to the square of the section's size.
const MIN_AREA: f64 = 1e-20;

/// The error of a distance, in sizes, that need not be less.
const LITTLE_LOSS_FRACTION: f64 = 1e-12;
/// The number of times that a polygon is halved for a closer bound of a loss.
const MAX_LOSS_HALVINGS: usize = 12;
/// The same where the bound is more than is allowed. Near a vertex where few points are owned, all but one of the halves have none.
const MAX_SEARCH_HALVINGS: usize = 64;
/// The number of polygons that are searched so. Along a curve there would be too many.
const MAX_SEARCHED: usize = 1000;
/// The part of a circle's radius that a polygon inside the circle may exceed it by.
const LOOSE_RADIUS: f64 = 1.005;
/// The difference of distances, in tolerances, above which a later feature is nearer than an earlier one.
pub(super) const TIE_TOLERANCES: f64 = 16.0;
/// The number of vertices up to which a polygon is fitted to a circle.
const MAX_VERTICES: usize = 16;

/// The number of times that all other features may trim a polygon.
const MAX_TRIMMING_ROUNDS: usize = 4;

impl Section<'_> {
    /// Returns the difference of distances below which features count as equally near.
    pub(crate) fn tolerance(&self) -> f64 {
        4.0 * f64::EPSILON * self.largest
    }

    /// Returns a difference of distances, or 0 if rounding decides its sign: a cut along a side would only multiply vertices.
    fn without_rounding(&self, difference: f64) -> f64 {
        if difference.abs() <= self.tolerance() { 0.0 } else { difference }
    }

    /// Returns polygons that cover the cell of a feature within a polygon.
    pub(super) fn cover(&self, feature: usize, bounds: &Polygon) -> Vec<Polygon> {
        let mut covered = Vec::new();
        let start = self
            .sector_sides(feature)
            .iter()
            .try_fold(bounds.clone(), |polygon, side| clipped(&polygon, &|p| side.at(p)));
        let Some(start) = start.and_then(|polygon| self.on_own_side(feature, polygon)) else {
            return covered;
        };
        // Broad before deep, so that a limit leaves small polygons everywhere.
        let mut pending = VecDeque::from([start]);
        let mut halvings = 0;
        while let Some(polygon) = pending.pop_front() {
            let Some(polygon) = self.trimmed(feature, polygon) else { continue };
            match self.halves(feature, &polygon).filter(|_| halvings < MAX_HALVINGS) {
                Some(halves) => {
                    halvings += 1;
                    pending.extend(halves.into_iter().flatten());
                }
                None => covered.push(polygon),
            }
        }
        covered
    }

    pub(super) fn sides_of(&self, feature: Feature) -> Vec<HalfPlane> {
        match feature {
            Feature::Piece(piece) => {
                let [mut start, end] = self.normal_sides(piece);
                // One normal divides two segments without an angle, however their normals are rounded.
                if self.is_smooth_start(piece) {
                    start = self.normal_sides(piece - 1)[1].opposite();
                }
                vec![start, end]
            }
            Feature::Corner(previous) => {
                let from = self.corner_at(previous);
                let ends = self.adjacent_segments(previous).into_iter().flatten();
                ends.map(|(piece, end)| {
                    let along = self.outline[piece].geometry.tangent(end);
                    let toward = if end == 1 { along } else { [-along[0], -along[1]] };
                    HalfPlane { from, toward }
                })
                .collect()
            }
        }
    }

    /// Returns the sides of the normals at a segment's ends toward it.
    fn normal_sides(&self, piece: usize) -> [HalfPlane; 2] {
        let segment = &self.outline[piece];
        // The normals of an arc meet in its centre.
        let [from, to] = segment
            .geometry
            .circle
            .map_or(segment.geometry.ends, |Circle { centre, .. }| [centre; 2]);
        let start = HalfPlane { from, toward: segment.geometry.tangent(0) };
        [start, HalfPlane { from: to, toward: segment.geometry.tangent(1) }.opposite()]
    }

    /// Cuts off what is provably beyond a feature's own line or circle.
    fn on_own_side(&self, feature: usize, polygon: Polygon) -> Option<Polygon> {
        let Feature::Piece(piece) = self.features[feature] else { return Some(polygon) };
        let segment = &self.outline[piece];
        match segment.geometry.circle {
            None => clipped(&polygon, &|p| segment.geometry.signed_distance(p)),
            Some(Circle { centre, radius, convex: true }) => {
                // A tangent for each corner that is far outside.
                let mut polygon = polygon;
                while polygon.len() < MAX_VERTICES {
                    let reach = |p: &Point| norm(minus(*p, centre));
                    let farthest =
                        polygon.iter().copied().max_by(|p, q| reach(p).total_cmp(&reach(q)));
                    let Some(p) = farthest.filter(|p| reach(p) > LOOSE_RADIUS * radius) else {
                        break;
                    };
                    let out = minus(p, centre).map(|part| part / reach(&p));
                    polygon = clipped(&polygon, &|p| radius - dot(out, minus(p, centre)))?;
                }
                Some(polygon)
            }
            // The chord between the directions of the outermost vertices.
            Some(Circle { centre, radius, convex: false }) => {
                let middle = minus(centroid(&polygon), centre);
                let middle = middle.map(|part| part / norm(middle));
                let cosine = polygon.iter().map(|p| {
                    let offset = minus(*p, centre);
                    dot(offset, middle) / norm(offset)
                });
                let cosine = cosine.fold(1.0, f64::min);
                if cosine <= 0.0 {
                    return Some(polygon);
                }
                clipped(&polygon, &|p| dot(middle, minus(p, centre)) - radius * cosine)
            }
        }
    }

    /// Returns a lower bound of the distance from a feature that is concave, exact at a point, and whether it is linear.
    fn low(&self, feature: usize, at: Point) -> (Estimate<'_>, bool) {
        match self.features[feature] {
            Feature::Corner(previous) => {
                (Estimate::tangent(self.corner_at(previous), 0.0, 1.0, at), true)
            }
            Feature::Piece(piece) => match self.outline[piece].geometry.circle {
                None => (Estimate::Signed(&self.outline[piece]), true),
                Some(Circle { convex: true, .. }) => {
                    (Estimate::Signed(&self.outline[piece]), false)
                }
                Some(Circle { centre, radius, convex: false }) => {
                    (Estimate::tangent(centre, radius, 1.0, at), true)
                }
            },
        }
    }

    /// Returns an upper bound of the distance from a feature, within its normals and on its own side, that is convex and exact
    /// at a point, and whether it is linear.
    fn high(&self, feature: usize, at: Point) -> (Estimate<'_>, bool) {
        match self.features[feature] {
            Feature::Corner(previous) => (Estimate::Point(self.corner_at(previous)), false),
            Feature::Piece(piece) => match self.outline[piece].geometry.circle {
                None => (Estimate::Signed(&self.outline[piece]), true),
                Some(Circle { centre, radius, convex: true }) => {
                    (Estimate::tangent(centre, radius, -1.0, at), true)
                }
                Some(Circle { convex: false, .. }) => {
                    (Estimate::Signed(&self.outline[piece]), false)
                }
            },
        }
    }

    pub(super) fn all_within(&self, sides: &[HalfPlane], points: &[Point]) -> bool {
        let slack = -self.tolerance();
        sides.iter().all(|side| points.iter().all(|p| side.at(*p) >= slack))
    }

    /// Returns whether points are on the interior side of a feature's line or circle.
    fn all_in_front(&self, feature: usize, points: &[Point]) -> bool {
        let slack = -self.tolerance();
        match self.features[feature] {
            Feature::Corner(_) => true,
            Feature::Piece(piece) => {
                points.iter().all(|p| self.outline[piece].geometry.signed_distance(*p) >= slack)
            }
        }
    }

    /// Returns whether a feature's points in a polygon, as far as they are behind another feature and within its normals, are
    /// provably at least as near to it; trivially if there are none.
    pub(super) fn is_behind_nearer(&self, feature: usize, other: usize, polygon: &Polygon) -> bool {
        let Feature::Piece(piece) = self.features[other] else { return true };
        if self.all_in_front(other, polygon) {
            return true;
        }
        let slack = self.tolerance();
        let segment = &self.outline[piece];
        anchors(polygon).any(|at| {
            let (low, _) = self.low(feature, at);
            let (high, _) = self.high(feature, at);
            let behind = |p: &Point| match segment.geometry.circle {
                None => -segment.geometry.signed_distance(*p),
                Some(Circle { centre, radius, convex: true }) => norm(minus(*p, centre)) - radius,
                Some(Circle { centre, radius, convex: false }) => {
                    Estimate::tangent(centre, radius, -1.0, at).at(*p)
                }
            };
            // Points behind the other are behind the feature as well if `behind + f · high ≤ 0` for a factor `f ≥ 0`. The sum is
            // convex, so that corners suffice. Two normals at a small angle meet in a corner that is well known only
            // across them: it may be behind both.
            let in_front = polygon.iter().filter(|p| high.at(**p) > slack);
            let factor = in_front.map(|p| -behind(p) / high.at(*p)).fold(f64::MAX, f64::min);
            polygon.iter().all(|p| low.at(*p) - behind(p) >= -slack)
                || (factor >= 0.0
                    && polygon.iter().all(|p| behind(p) + factor * high.at(*p) <= slack))
        })
    }

    /// Cuts off what is provably at least as near to another feature. What one cuts off may bring the rest within the normals
    /// of one before it, so that straight segments, whose cuts are exact, are asked again, in turns from both ends.
    fn trimmed(&self, feature: usize, polygon: Polygon) -> Option<Polygon> {
        let mut polygon = self.on_own_side(feature, polygon)?;
        let others = (0..self.features.len()).filter(|other| *other != feature);
        let mut others: Vec<usize> = others.collect();
        for _ in 0..MAX_TRIMMING_ROUNDS {
            let before = polygon.clone();
            let mut square = self.square_of_nearer(feature, &polygon);
            for &other in &others {
                let (middle, half) = square;
                if self.is_box_within(other, middle, half) {
                    polygon = self.trimmed_by(feature, other, polygon)?;
                    square = self.square_of_nearer(feature, &polygon);
                }
            }
            if polygon == before || !self.is_straight(feature) {
                break;
            }
            others.retain(|other| self.is_straight(*other));
            others.reverse();
        }
        Some(polygon)
    }

    /// Returns the centre and half the side of a square that has all points as near to a polygon's as a feature is.
    fn square_of_nearer(&self, feature: usize, polygon: &Polygon) -> (Point, f64) {
        let (low, _) = self.low(feature, centroid(polygon));
        let farthest = polygon.iter().map(|p| low.at(*p)).fold(0.0, f64::max);
        let (middle, half) = centre_and_half(polygon);
        (middle, farthest + half)
    }

    fn is_straight(&self, feature: usize) -> bool {
        self.line_direction(feature).is_some()
    }

    /// Returns the least difference of distances by which another feature counts as at least as near. Of two features that are
    /// equally near, the first keeps the point, so that not both leave it out.
    fn slack(&self, feature: usize, other: usize) -> f64 {
        let tolerance = self.tolerance();
        if other < feature { -tolerance } else { TIE_TOLERANCES * tolerance }
    }

    fn trimmed_by(&self, feature: usize, other: usize, mut polygon: Polygon) -> Option<Polygon> {
        let slack = self.slack(feature, other);
        let sides = self.sector_sides(other);
        if let Feature::Piece(piece) = self.features[other] {
            let segment = &self.outline[piece];
            let (low, _) = self.low(feature, centroid(&polygon));
            // One end of the segment is nearer everywhere.
            let is_nearer =
                |end: &Point| polygon.iter().all(|p| low.at(*p) - norm(minus(*p, *end)) >= slack);
            // The feature's own points are no nearer than it.
            let own_points = self.end_points(feature);
            if segment.geometry.ends.iter().any(|end| !own_points.contains(end) && is_nearer(end)) {
                return None;
            }
            // Two points have a straight border.
            if let Feature::Corner(previous) = self.features[feature] {
                let corner = self.corner_at(previous);
                for end in segment.geometry.ends.into_iter().filter(|end| *end != corner) {
                    let from = [0, 1].map(|k| f64::midpoint(corner[k], end[k]));
                    let toward = minus(corner, end);
                    let side = HalfPlane { from, toward: toward.map(|part| part / norm(toward)) };
                    polygon = clipped(&polygon, &|p| self.without_rounding(side.at(p)))?;
                }
            }
            // Behind a line, the line itself is nearer.
            if segment.geometry.circle.is_none() {
                let values: Vec<f64> =
                    polygon.iter().map(|p| segment.geometry.signed_distance(*p)).collect();
                if values.iter().any(|value| *value < -self.tolerance())
                    && let [Some(back), front] = divided(&polygon, &values)
                    && self.all_within(sides, &back)
                    && back
                        .iter()
                        .all(|p| low.at(*p) + segment.geometry.signed_distance(*p) >= slack)
                {
                    polygon = front?;
                }
            }
        }
        let is_corner = matches!(self.features[other], Feature::Corner(_));
        for at in anchors(&polygon.clone()) {
            let (low, is_linear) = self.low(feature, at);
            let (high, other_is_linear) = self.high(other, at);
            let above = |p: &Point| low.at(*p) - high.at(*p) - slack.max(0.0);
            let [least, most] = range(polygon.iter().map(|p| self.without_rounding(above(p))));
            // Both are exact at the first point, so that this one is far from the border.
            if most <= 0.0 {
                break;
            }
            if least >= 0.0
                && (is_corner || self.all_within(sides, &polygon))
                && self.is_behind_nearer(feature, other, &polygon)
            {
                return None;
            }
            if is_linear && other_is_linear {
                let is_nearer = |p: Point| self.without_rounding(above(&p));
                polygon = self.without(feature, other, polygon, &is_nearer)?;
            }
            // The distances from straight segments are exact everywhere.
            if self.is_straight(feature) && self.is_straight(other) {
                break;
            }
        }
        Some(polygon)
    }

    /// Cuts off where another feature is nearer, as a linear function tells, as far as it is within the other's normals and in
    /// front of it, and as the rest can be convex.
    fn without(
        &self,
        feature: usize,
        other: usize,
        polygon: Polygon,
        is_nearer: &impl Fn(Point) -> f64,
    ) -> Option<Polygon> {
        let sides = self.sector_sides(other);
        let within = |side: &HalfPlane, p: Point| side.at(p) + self.tolerance();
        let is_cut_off =
            |p: Point| is_nearer(p) > 0.0 && sides.iter().all(|side| within(side, p) > 0.0);
        // The vertices that stay span the rest.
        if !polygon.iter().any(|p| is_cut_off(*p)) {
            return Some(polygon);
        }
        let cut = sides.iter().fold(clipped(&polygon, is_nearer), |cut, side| {
            cut.and_then(|cut| clipped(&cut, &|p| within(side, p)))
        });
        if !cut.is_some_and(|cut| self.is_behind_nearer(feature, other, &cut)) {
            return Some(polygon);
        }
        let beyond = sides.iter().map(|side| clipped(&polygon, &|p| -within(side, p)));
        let rest = [clipped(&polygon, &|p| -is_nearer(p))].into_iter().chain(beyond).flatten();
        let rest: Vec<Polygon> = rest.collect();
        // Estimates would be fitted to a border that is curved, with twice as many vertices each time.
        if rest.len() > 1 && !(self.is_straight(feature) && self.is_straight(other)) {
            return Some(polygon);
        }
        let rest = rest.into_iter().reduce(|one, other| hull([one, other].concat()));
        rest.filter(|rest| rest.len() > 2)
    }

    /// Returns the distance of a feature from a point.
    pub(crate) fn distance_of(&self, feature: usize, p: Point) -> f64 {
        match self.features[feature] {
            Feature::Piece(piece) => self.outline[piece].geometry.distance(p),
            Feature::Corner(previous) => norm(minus(p, self.corner_at(previous))),
        }
    }

    /// Returns the nearest feature to a point and its distance; `None` if the nearest point is an end that is no feature.
    pub(super) fn nearest(&self, p: Point) -> (Option<usize>, f64) {
        let mut nearest = (None, f64::INFINITY);
        let reach = self.reach(p);
        for (index, feature) in self.features.iter().enumerate() {
            if !self.is_box_within(index, p, nearest.1.min(reach)) {
                continue;
            }
            let distance = self.distance_of(index, p);
            let own = feature.piece().is_none_or(|piece| {
                self.outline[piece].geometry.sector(p).iter().all(|side| *side >= 0.0)
            });
            if distance < nearest.1 || (distance == nearest.1 && nearest.0.is_none()) {
                nearest = (own.then_some(index), distance);
            }
        }
        nearest
    }

    /// Returns the part of a polygon beyond which a feature owns no point, since another one is nearer there: of those that are the
    /// nearest at vertices, the ones whose distance, as that of the feature, is bounded by a linear function; or an end of a segment, which
    /// is nearer to all of a polygon if it is at the vertices.
    pub(crate) fn possibly_owned(&self, feature: usize, polygon: &Polygon) -> Option<Polygon> {
        let middle = centroid(polygon);
        // The points that a feature owns are as far as its line or circle.
        let (own, true) = self.low(feature, middle) else { return Some(polygon.clone()) };
        // Beyond a corner of the outline, between the normals there, nothing else is near.
        let ends = self.outline.iter().flat_map(|segment| segment.geometry.ends);
        let from = |end: &Point| norm(minus(*end, middle));
        let end = ends.min_by(|one, other| from(one).total_cmp(&from(other)));
        let is_nearer = |end: Point| {
            polygon.iter().all(|p| norm(minus(*p, end)) + self.tolerance() < own.at(*p))
        };
        if end.is_some_and(is_nearer) {
            return None;
        }
        let nearest = |p: &Point| self.nearest(*p).0.filter(|nearest| *nearest != feature);
        let mut rivals: Vec<usize> = polygon.iter().filter_map(nearest).collect();
        rivals.sort_unstable();
        rivals.dedup();
        let mut owned = polygon.clone();
        for rival in rivals {
            let (distance, is_linear) = self.high(rival, middle);
            if is_linear
                && self.all_within(self.sector_sides(rival), &owned)
                && self.all_in_front(rival, &owned)
            {
                let excess = |p: Point| distance.at(p) - own.at(p) + self.tolerance();
                owned = clipped(&owned, &excess)?;
            }
        }
        Some(owned)
    }

    /// Returns two halves of a polygon that is too large for its cell.
    fn halves(&self, feature: usize, polygon: &Polygon) -> Option<[Option<Polygon>; 2]> {
        if area(polygon) < MIN_AREA * self.size * self.size {
            return None;
        }
        let mut loosest: Option<(f64, Option<usize>)> = None;
        for p in polygon {
            let own = self.depth_at(feature, *p).abs();
            let (nearest, distance) = self.nearest(*p);
            if nearest == Some(feature) {
                continue;
            }
            // Beyond the outline, a point has no owner however far it is from the other feature.
            let is_beyond = self.depth_at(feature, *p) > 0.0 && !self.is_inside(*p);
            let excess = own - if is_beyond { -distance } else { distance };
            let loose = excess / own;
            if excess > LITTLE_LOSS_FRACTION * self.size
                && loose > LOOSE_FRACTION
                && loosest.is_none_or(|(most, _)| loose > most)
            {
                loosest = Some((loose, nearest));
            }
        }
        let (_, nearest) = loosest?;
        // Between the normals of the nearest feature more can be proved than beyond them.
        let sides = nearest.map(|nearest| self.sector_sides(nearest)).unwrap_or_default();
        for side in sides {
            let values: Vec<f64> = polygon.iter().map(|p| side.at(*p)).collect();
            let [low, high] = range(values.iter().copied());
            if low < -MIN_CUT * high.abs().max(MIN_CUT_FRACTION * self.size)
                && high > -MIN_CUT * low
            {
                return Some(divided(polygon, &values));
            }
        }
        Some(halved(polygon))
    }

    /// Returns an upper bound of the error of depth, or of the distance outside, if the points of a polygon that a feature owns
    /// are given to another; `None` is the outside. `may_own` tells of a part of the polygon whether it may have such points.
    /// Beyond `allowed` the bound need not be close.
    pub(crate) fn greatest_loss(
        &self,
        [own, other]: [Option<usize>; 2],
        polygon: &Polygon,
        allowed: f64,
        may_own: impl Fn(&Polygon) -> bool,
    ) -> f64 {
        let mut greatest = 0.0f64;
        let (mut pending, mut searched) = (vec![(polygon.clone(), 0)], 0);
        while let Some((mut polygon, halvings)) = pending.pop() {
            let mut bound = self.bound_of_loss(own, other, &polygon);
            // Only what is too much is worth the question whether there is any point.
            if bound > greatest.max(allowed) {
                let owned = match own {
                    _ if !may_own(&polygon) => None,
                    Some(own) => self.possibly_owned(own, &polygon),
                    None => Some(polygon),
                };
                let Some(owned) = owned else { continue };
                polygon = owned;
                bound = self.bound_of_loss(own, other, &polygon);
            }
            if bound <= greatest {
                continue;
            }
            let least = self.loss_at_vertices([own, other], &polygon);
            let is_close = bound <= 2.0 * least + LITTLE_LOSS_FRACTION * self.size;
            let is_known = bound <= allowed || greatest > allowed;
            let is_searched = bound > allowed && searched < MAX_SEARCHED;
            searched += usize::from(is_searched && halvings >= MAX_LOSS_HALVINGS);
            let most = if is_searched { MAX_SEARCH_HALVINGS } else { MAX_LOSS_HALVINGS };
            if (is_close && is_known) || halvings >= most {
                greatest = bound;
            } else {
                let halves = halved(&polygon).into_iter().flatten();
                pending.extend(halves.map(|half| (half, halvings + 1)));
            }
        }
        greatest
    }

    /// Returns the greatest error at the vertices of a polygon of depth, or of the distance outside, if they are given to another
    /// feature than their own; `None` is the outside.
    pub(crate) fn loss_at_vertices(
        &self,
        [own, other]: [Option<usize>; 2],
        polygon: &Polygon,
    ) -> f64 {
        if own == other {
            return 0.0;
        }
        let depth = |feature: Option<usize>, p: &Point| {
            feature.map_or(0.0, |feature| self.depth_at(feature, *p).max(0.0))
        };
        let losses = polygon.iter().map(|p| {
            let distance = if own.is_none() { self.nearest(*p).1 } else { 0.0 };
            distance.max((depth(own, p) - depth(other, p)).abs())
        });
        losses.fold(0.0, f64::max)
    }

    fn bound_of_loss(&self, own: Option<usize>, other: Option<usize>, polygon: &Polygon) -> f64 {
        if own == other {
            return 0.0;
        }
        let middle = centroid(polygon);
        let high = |feature: usize, p: &Point| self.high(feature, middle).0.at(*p);
        let low = |feature: usize, p: &Point| self.low(feature, middle).0.at(*p);
        let greatest =
            |value: &dyn Fn(&Point) -> f64| polygon.iter().map(value).fold(0.0, f64::max);
        // `high` and `high - low` are convex, so that their greatest value is at a vertex.
        match (own, other) {
            (Some(a), Some(b)) => {
                greatest(&|p| (high(a, p) - low(b, p)).max(high(b, p) - low(a, p)))
            }
            (Some(feature), None) => greatest(&|p| high(feature, p)),
            (None, Some(feature)) => greatest(&|p| high(feature, p)).max(self.farthest(polygon)),
            (None, None) => 0.0,
        }
    }

    /// Returns the point of a corner, or the ends of a segment.
    pub(super) fn end_points(&self, feature: usize) -> Vec<Point> {
        match self.features[feature] {
            Feature::Corner(previous) => vec![self.corner_at(previous)],
            Feature::Piece(piece) => self.outline[piece].geometry.ends.to_vec(),
        }
    }

    /// Returns an upper bound of the distance of a polygon's points from the outline.
    fn farthest(&self, polygon: &Polygon) -> f64 {
        let middle = centroid(polygon);
        let greatest =
            |distance: &dyn Fn(&Point) -> f64| polygon.iter().map(distance).fold(0.0, f64::max);
        let features = (0..self.features.len()).map(|feature| {
            let ends = self.end_points(feature);
            let to_ends = ends.iter().map(|end| greatest(&|p| norm(minus(*p, *end))));
            let to_end = to_ends.fold(f64::INFINITY, f64::min);
            if !self.all_within(self.sector_sides(feature), polygon) {
                return to_end;
            }
            let [high, low] = [self.high(feature, middle).0, self.low(feature, middle).0];
            to_end.min(greatest(&|p| high.at(*p).max(-low.at(*p))))
        });
        features.fold(f64::INFINITY, f64::min)
    }
}

/// A bound of a distance on a convex polygon.
enum Estimate<'o> {
    /// The signed distance from a segment's line or circle.
    Signed(&'o Segment),
    /// The distance from a point.
    Point(Point),
    /// `sign (out · (p - centre) - radius)`: the tangent plane of a distance from a circle.
    Tangent { centre: Point, radius: f64, out: Point, sign: f64 },
}

impl Estimate<'_> {
    /// Returns the tangent plane at a point of a distance from a circle.
    fn tangent(centre: Point, radius: f64, sign: f64, at: Point) -> Estimate<'static> {
        let offset = minus(at, centre);
        let length = norm(offset).max(f64::MIN_POSITIVE);
        Estimate::Tangent { centre, radius, out: offset.map(|part| part / length), sign }
    }

    fn at(&self, p: Point) -> f64 {
        match self {
            Estimate::Signed(segment) => segment.geometry.signed_distance(p),
            Estimate::Point(point) => norm(minus(p, *point)),
            Estimate::Tangent { centre, radius, out, sign } => {
                sign * (dot(*out, minus(p, *centre)) - radius)
            }
        }
    }
}

/// Returns the points of a polygon at which bounds are made exact.
fn anchors(polygon: &Polygon) -> impl Iterator<Item = Point> {
    [centroid(polygon)].into_iter().chain(polygon.iter().copied())
}

/// A half plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfPlane {
    from: Point,
    toward: Point,
}

impl HalfPlane {
    fn opposite(self) -> HalfPlane {
        HalfPlane { toward: self.toward.map(|part| -part), ..self }
    }

    /// Returns the distance of a point from the border, positive inside.
    pub(super) fn at(&self, p: Point) -> f64 {
        dot(self.toward, minus(p, self.from))
    }
}

#[cfg(test)]
mod tests {
    use crate::compile;
    use crate::geometry::outline::{cross, minus};
    use crate::geometry::polygon::area;
    use crate::library;
    use crate::source::Source;

    /// Chords of a ball, with coordinates as CAD writes them, meet in many points near the centre. Their cells are polygons, whose
    /// areas add up to that of the section.
    #[test]
    fn polygons_of_straight_segments_are_their_cells() {
        let point = |k: u32| {
            let (sine, cosine) = (f64::from(k) / 48.0 * std::f64::consts::FRAC_PI_2).sin_cos();
            [3.0 * sine, 3.0 - 3.0 * cosine].map(|part| (part * 1e6).round() / 1e6)
        };
        let corners: Vec<_> = (0..=48).map(point).chain([[3.0, 30.0], [0.0, 30.0]]).collect();
        let lines: Vec<String> = corners[1..].iter().map(|[d, z]| format!("({d}, {z})")).collect();
        let text = format!(
            "tool Chords {{ units mm; profile {{ start (0, 0); line to {} as ball; }} }}",
            lines.join(", ")
        );
        let tool = compile(&Source::new("chords.tool", text)).into_tool().expect("a tool");
        let profile = tool.model.profile.as_ref().expect("a profile");
        let covers = (0..profile.inner.section().features.len()).map(|k| profile.inner.cover_of(k));
        let covers: Vec<_> = covers.collect();
        assert!(covers.iter().all(|cover| cover.len() == 1));
        let sum: f64 = covers.iter().map(|cover| area(&cover[0])).sum();
        let excess = sum - area(&corners);
        assert!(excess.abs() < 1e-8, "{excess}");
    }

    /// Every point inside, found by the parity of crossings, is in a polygon of each feature to which it is nearest by the
    /// distances from the segments.
    #[test]
    fn polygons_cover_what_is_nearest() {
        for tool in library::tools() {
            let Some(profile) = &tool.model.profile else { continue };
            let section = profile.inner.section();
            let covers = (0..section.features.len()).map(|feature| profile.inner.cover_of(feature));
            let covers: Vec<_> = covers.collect();
            let (radius, low, high) = (tool.extent.radius, tool.extent.low, tool.extent.high);
            let mut count = 0;
            for k in 0..4000 {
                // A lattice without rows.
                let fraction = |step: f64| (f64::from(k) * step).fract();
                let p = [
                    radius * fraction(0.754_877_666),
                    low + (high - low) * fraction(0.569_840_291),
                ];
                if !section.is_inside(p) {
                    continue;
                }
                let distances = section.outline.iter().map(|segment| segment.geometry.distance(p));
                let nearest = distances.fold(f64::INFINITY, f64::min);
                for (feature, cover) in covers.iter().enumerate() {
                    let is_within = |side: &super::HalfPlane| side.at(p) >= 0.0;
                    let own = section.depth_at(feature, p);
                    if (own - nearest).abs() > 1e-12
                        || !section.sector_sides(feature).iter().all(is_within)
                    {
                        continue;
                    }
                    let is_in = |polygon: &super::Polygon| {
                        let mut sides = (0..polygon.len()).map(|k| {
                            let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
                            cross(minus(b, a), minus(p, a))
                        });
                        sides.all(|side| side >= -1e-9)
                    };
                    count += 1;
                    let is_tie = covers.iter().enumerate().any(|(other, _)| {
                        other != feature && (section.depth_at(other, p) - nearest).abs() <= 1e-12
                    });
                    assert!(
                        is_tie || cover.iter().any(is_in),
                        "{} {feature} {p:?}",
                        tool.model.name
                    );
                }
            }
            assert!(count > 100, "{}: {count}", tool.model.name);
        }
    }
}
