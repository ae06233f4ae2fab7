//! The points that some features own, and the heights at which depth can be greatest there.
//!
//! Where depth is greatest inside a triangle, some convex combination of the gradients toward the nearest
//! features is normal to the triangle, or 0. In the first case the point is on the meridian. In the second it is
//! *critical*: the centre of an arc, midway between two points of the profile on a common normal, or equally far
//! from three features. Without overhangs depth does not grow away from the axis, so an equally deep point lies
//! nearer to the axis, on the meridian or on an edge. With overhangs a critical point is a circle about the axis,
//! which a triangle crosses anywhere.
//!
//! Between parallel lines, or arcs about one centre, the critical points form a line of the half plane along
//! which depth is constant. A triangle crosses its surface of revolution in curves. Closed curves meet the
//! meridian (`docs/certified.md`). The others end on an edge, or at the height of an end of that line. At such an
//! end a foot is an end of a feature, or a third feature is as near.

use crate::certify::space::Point;
use crate::certify::tool_model::feature::{Feature, MeridianPoint, minus, norm};
use crate::certify::tool_model::section::{Owners, Section, SectionSlab};
use crate::certify::triangle::SubTriangle;
use crate::certify::triangle::line_search::DepthSearch;
use crate::tool::{Circle, Region, ToolInfo, bit};
use std::collections::BinaryHeap;

/// A rectangle of the half plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub(crate) low: MeridianPoint,
    pub(crate) high: MeridianPoint,
}

impl Rectangle {
    /// Returns the bounding rectangle of a slab.
    pub(crate) fn of(slab: &SectionSlab) -> Rectangle {
        Rectangle { low: [slab.hole, slab.low], high: [slab.radius, slab.high] }
    }

    pub(crate) fn corners(&self) -> [MeridianPoint; 4] {
        let Rectangle { low, high } = *self;
        [low, [high[0], low[1]], high, [low[0], high[1]]]
    }

    /// Returns whether it has points in common with another.
    pub(crate) fn meets(&self, other: &Rectangle) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Returns whether another lies within it.
    fn contains(&self, other: &Rectangle) -> bool {
        (0..2).all(|k| self.low[k] <= other.low[k] && other.high[k] <= self.high[k])
    }

    fn size(&self) -> MeridianPoint {
        minus(self.high, self.low)
    }

    /// Returns its centre, and the distance from there to its corners.
    fn ball(&self) -> (MeridianPoint, f64) {
        let [across, up] = self.size();
        ([0, 1].map(|k| f64::midpoint(self.low[k], self.high[k])), 0.5 * across.hypot(up))
    }

    /// Returns both halves of its longer side.
    fn halves(&self) -> [Rectangle; 2] {
        let ([across, up], (middle, _)) = (self.size(), self.ball());
        let longer = usize::from(up > across);
        let (mut first, mut second) = (*self, *self);
        first.high[longer] = middle[longer];
        second.low[longer] = middle[longer];
        [first, second]
    }

    /// Returns it without strips of some height along the bottom and the top of a slab, and the strips that it has.
    fn without_seams(&self, slab: &SectionSlab, height: f64) -> (Rectangle, Vec<Rectangle>) {
        let (mut inner, mut strips) = (*self, Vec::new());
        if self.low[1] == slab.low {
            inner.low[1] += height;
            strips.push(Rectangle { high: [self.high[0], inner.low[1]], ..*self });
        }
        if self.high[1] == slab.high {
            inner.high[1] -= height;
            strips.push(Rectangle { low: [self.low[0], inner.high[1]], ..*self });
        }
        (inner, strips)
    }
}

impl Owners {
    /// Returns the features of some surfaces.
    pub(crate) fn of(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let owned_features: Vec<bool> =
            section.features.iter().map(|f| surfaces(f.surface)).collect();
        let owned_features = owned_features.contains(&false).then_some(owned_features);
        let mut owners = Owners { owned_features, ..Owners::default() };
        if !owners.all() {
            let Peaks { heights, unresolved } = owners.find_peaks(section, true);
            // Just below and just above: at a seam each side owns only points on its side.
            let beside = 0.25 * section.error;
            owners.peaks = heights.iter().flat_map(|peak| [peak - beside, peak + beside]).collect();
            owners.unresolved = unresolved;
        }
        owners
    }

    /// Returns the features of some surfaces for distance queries. If a feature lies within a triangle's range of
    /// distances and heights, the triangle meets it at the height of one of its ends, so the peaks are the heights of
    /// ends.
    pub(crate) fn near(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let owned_features: Vec<bool> =
            section.features.iter().map(|f| surfaces(f.surface)).collect();
        let owned = section.features.iter().zip(&owned_features).filter(|(_, owned)| **owned);
        let peaks = owned.flat_map(|(feature, _)| feature.ends.map(|end| end[1])).collect();
        Owners { owned_features: Some(owned_features), peaks, ..Owners::default() }
    }

    /// Returns regions of a tool without a profile.
    pub(crate) fn of_regions(info: &ToolInfo, is_owned: impl Fn(usize, &Region) -> bool) -> Owners {
        let owned_features: Vec<bool> = info
            .regions
            .iter()
            .enumerate()
            .map(|(index, region)| is_owned(index, region))
            .collect();
        let bits = (0..owned_features.len()).filter(|index| owned_features[*index]).map(bit);
        let regions = bits.fold(0, |all, bit| all | bit);
        Owners {
            owned_features: owned_features.contains(&false).then_some(owned_features),
            regions,
            ..Owners::default()
        }
    }

    /// Returns, per slab, a rectangle that holds all points deeper than `deeper` that the owners can own.
    pub(crate) fn zones(&self, section: &Section, deeper: f64) -> Vec<Option<Rectangle>> {
        let slabs = section.slabs.iter();
        if self.all() {
            return slabs.map(|slab| Some(Rectangle::of(slab))).collect();
        }
        slabs.map(|slab| self.zone(section, slab, deeper)).collect()
    }

    /// Computes the zone of a slab. Rectangles of it are halved until an owner is the nearest feature in all of one
    /// or in none of it, or until the rectangle is too small to matter.
    fn zone(&self, section: &Section, slab: &SectionSlab, deeper: f64) -> Option<Rectangle> {
        let min_size = section.size / f64::from(ZONE_DIVISIONS);
        let strip = 0.25 * section.error.min(slab.high - slab.low);
        let mut zone: Option<Rectangle> = None;
        let mut stack = vec![Rectangle::of(slab)];
        while let Some(rectangle) = stack.pop() {
            if zone.is_some_and(|zone| zone.contains(&rectangle)) {
                continue;
            }
            let is_owned = match self.own_rectangle(section, &rectangle, deeper) {
                Some(false) => continue,
                owned => owned.is_some(),
            };
            // The height of a seam at which features of equal direction meet is the border between their points, and only
            // a strip along it is not certain to belong to one of them.
            let (inner, strips) = rectangle.without_seams(slab, strip);
            if !strips.is_empty() && self.own_rectangle(section, &inner, deeper) == Some(false) {
                for strip in strips {
                    if self.own_rectangle(section, &strip, deeper) != Some(false) {
                        zone = widened(zone, strip);
                    }
                }
            } else if is_owned || rectangle.ball().1 <= min_size {
                zone = widened(zone, rectangle);
            } else {
                stack.extend(rectangle.halves());
            }
        }
        zone
    }

    /// Returns whether the owners own all points of a rectangle and these are deeper than `deeper`, or own none of them
    /// that is; `None` if that is not certain.
    fn own_rectangle(&self, section: &Section, rectangle: &Rectangle, deeper: f64) -> Option<bool> {
        let (middle, reach) = rectangle.ball();
        let (mut owner, mut other) = (f64::INFINITY, f64::INFINITY);
        let corners = rectangle.corners();
        for (index, feature) in section.features.iter().enumerate() {
            if section.hidden_by_neighbours(index, &corners) {
                continue;
            }
            let nearest = if self.is_owned(index) { &mut owner } else { &mut other };
            *nearest = nearest.min(feature.distance(middle));
        }
        // A distance has the Lipschitz constant 1, and two of them are compared.
        let uncertainty = 2.0 * reach + section.error;
        if owner > other + uncertainty || owner.min(other) + reach <= deeper {
            return Some(false);
        }
        if section.own_nothing(self, &corners, 2.0 * section.error, |_| false) {
            return Some(false);
        }
        (owner + uncertainty < other && owner - reach > deeper).then_some(true)
    }

    /// Returns an upper bound on the depth of the points that the owners own, at most 1 % above the depth of one of
    /// them unless the budget is spent first.
    ///
    /// Rectangles are halved, the one that may be deepest first: depth has the Lipschitz constant 1.
    pub(crate) fn greatest_depth(&self, section: &Section) -> f64 {
        let mut max_depth = 0.0;
        let mut rectangles: Vec<Rectangle> = Vec::new();
        // Non-negative floating point numbers are in the order of their bits.
        let mut queue: BinaryHeap<(u64, usize)> = BinaryHeap::new();
        let mut halves: Vec<Rectangle> = section.slabs.iter().map(Rectangle::of).collect();
        let mut bound = f64::INFINITY;
        for _ in 0..MAX_RECTANGLES {
            for rectangle in halves.drain(..) {
                let (middle, reach) = rectangle.ball();
                let depth = section.signed(middle);
                let away =
                    section.owned(self).map(|owner| section.features[owner].distance(middle));
                let owner = away.fold(f64::INFINITY, f64::min);
                if depth >= 0.0 && owner <= depth + section.error {
                    max_depth = depth.max(max_depth);
                }
                if owner <= depth.abs() + 2.0 * reach + section.error && depth + reach >= 0.0 {
                    queue.push(((depth + reach).to_bits(), rectangles.len()));
                    rectangles.push(rectangle);
                }
            }
            let Some((bits, index)) = queue.pop() else { return max_depth };
            bound = f64::from_bits(bits);
            if bound <= 1.01 * max_depth + section.error {
                break;
            }
            halves.extend(rectangles[index].halves());
        }
        // The rectangle divided last had the largest bound, which holds for its halves too.
        bound + section.error
    }

    /// Returns the heights of points at which the depth of owned points can have a local maximum: points equally far
    /// from three features, of which there are few. Elsewhere depth grows in some direction in which the owners own
    /// points, or does not grow away from the axis. With `others`, only those are returned near which other features own
    /// points too.
    ///
    /// The heights are found by halving rectangles, each with the features that may be the nearest there. Two features that
    /// meet nearly in line are equally far to within a fraction of the error bound all over some rectangles. There they count
    /// as one, and the end of their border is [computed](Section::border_ends) by itself.
    fn find_peaks(&self, section: &Section, others: bool) -> Peaks {
        let min_size = section.error / 32.0;
        // All points of an arc are equally far from its centre.
        let centres = section.features.iter().filter_map(|feature| feature.circle);
        let mut peaks: Vec<f64> = centres.map(|circle| circle.centre[1]).collect();
        peaks.extend(section.border_ends());
        let all: Vec<usize> = (0..section.features.len()).collect();
        let whole = section.slabs.iter().map(Rectangle::of);
        let mut cells: Vec<PeakCell> =
            whole.map(|rectangle| PeakCell { rectangle, nearest: all.clone() }).collect();
        let mut examined = 0;
        while !cells.is_empty() {
            examined += cells.len();
            if examined > MAX_CELLS {
                break;
            }
            for PeakCell { rectangle, nearest } in std::mem::take(&mut cells) {
                let Some(nearest) = self.peak_features(section, &rectangle, &nearest, others)
                else {
                    continue;
                };
                let (middle, reach) = rectangle.ball();
                if reach > min_size {
                    let halves = rectangle.halves();
                    cells.extend(
                        halves.map(|half| PeakCell { rectangle: half, nearest: nearest.clone() }),
                    );
                } else if peaks.iter().all(|peak| (peak - middle[1]).abs() > 2.0 * min_size) {
                    // Neighbouring rectangles at one point count once.
                    peaks.push(middle[1]);
                }
            }
        }
        Peaks { heights: peaks, unresolved: cells.into_iter().map(|cell| cell.rectangle).collect() }
    }

    /// Returns those features of a list that may be the nearest to a point of a rectangle, if there may be a point equally
    /// far from three. With `others`, some of these have to be owners and some not.
    fn peak_features(
        &self,
        section: &Section,
        rectangle: &Rectangle,
        nearest: &[usize],
        others: bool,
    ) -> Option<Vec<usize>> {
        let (middle, reach) = rectangle.ball();
        let corners = rectangle.corners();
        let margin = section.error / 64.0;
        let feature = |index: usize| &section.features[index];
        let mut distances: Vec<(f64, usize)> =
            nearest.iter().map(|index| (feature(*index).distance(middle), *index)).collect();
        distances.sort_by(|one, other| one.0.total_cmp(&other.0));
        // Within the reach, a distance changes by at most the reach, and so does the least of all.
        let max_distance = distances[0].0 + 2.0 * reach + margin;
        distances.retain(|(distance, _)| *distance <= max_distance);
        let mut nearest: Vec<usize> = Vec::new();
        for (_, index) in distances {
            let is_farther = nearest.iter().take(MAX_COMPARED).any(|nearer: &usize| {
                feature(index).is_farther(feature(*nearer), &corners, margin)
            });
            if !is_farther && !section.hidden_by_neighbours(index, &corners) {
                nearest.push(index);
            }
        }
        let mut owner_kinds = [false; 2];
        let mut sites: Vec<usize> = Vec::new();
        for index in &nearest {
            owner_kinds[usize::from(self.is_owned(*index))] = true;
            let foot = feature(*index).foot(middle);
            let is_known = sites.iter().any(|site| {
                // Both sides of a reflex corner are equally far from a point nearest to that corner. Elsewhere one of
                // two adjacent features is nearer on either side of a line. Shared ends are identical to the bit.
                let same_foot = norm(minus(feature(*site).foot(middle), foot)) <= section.error;
                let same_kind = self.is_owned(*index) == self.is_owned(*site);
                let both_end =
                    || [*index, *site].map(|f| feature(f).at_ends(&corners).is_some()) == [true; 2];
                let is_in_line = || {
                    let (first, second) = (index.min(site), index.max(site));
                    reach >= MIN_MERGED * section.error
                        && first + 1 == *second
                        && feature(*first).continues_in(feature(*second))
                        && feature(*first).is_as_far_as(
                            feature(*second),
                            &corners,
                            0.25 * section.error,
                        )
                };
                (same_foot && (same_kind || both_end())) || is_in_line()
            });
            if !is_known {
                sites.push(*index);
            }
        }
        (sites.len() > 2 && (owner_kinds == [true, true] || !others)).then_some(nearest)
    }
}

/// A rectangle that is searched for peaks, and the features that may be the nearest to points of it.
struct PeakCell {
    rectangle: Rectangle,
    nearest: Vec<usize>,
}

/// The heights at which depth can have a local maximum, and rectangles in which there may be more of them.
struct Peaks {
    heights: Vec<f64>,
    unresolved: Vec<Rectangle>,
}

/// Returns the rectangle about a zone and another rectangle.
fn widened(zone: Option<Rectangle>, other: Rectangle) -> Option<Rectangle> {
    let Rectangle { low, high } = zone.unwrap_or(other);
    Some(Rectangle {
        low: [0, 1].map(|k| low[k].min(other.low[k])),
        high: [0, 1].map(|k| high[k].max(other.high[k])),
    })
}

/// The resolution of zones: the tool's size divided by this.
const ZONE_DIVISIONS: u32 = 1 << 11;

/// The maximum number of rectangles examined for the deepest point. The bound proved until then is the answer.
const MAX_RECTANGLES: u32 = 1 << 17;

/// The maximum number of rectangles examined for peaks. What is left of them is a part of the answer.
const MAX_CELLS: usize = 1 << 17;

/// The number of the nearest features to which others are compared.
const MAX_COMPARED: usize = 8;

/// The least size of a rectangle, in error bounds of a point, in which two features may count as one.
const MIN_MERGED: f64 = 8.0;

impl Section {
    /// Computes the heights of circles about the axis on which depth can be greatest, where the profile overhangs.
    pub(super) fn with_circles(mut self) -> Section {
        if self.overhangs {
            let Peaks { mut heights, unresolved } = Owners::default().find_peaks(&self, false);
            heights.extend(
                normal_pairs(&self.features)
                    .into_iter()
                    .map(|[a, b]| ([0, 1].map(|k| f64::midpoint(a[k], b[k])), norm(minus(a, b))))
                    .filter(|(middle, distance)| self.is_critical(*middle, 0.5 * distance))
                    .map(|(middle, _)| middle[1]),
            );
            heights.sort_by(f64::total_cmp);
            heights.dedup_by(|upper, lower| *upper - *lower <= 0.25 * self.error);
            (self.circles, self.unresolved) = (heights, unresolved);
        }
        self
    }

    /// Returns the heights of the ends of borders between features that meet nearly in line: where another feature is as near.
    ///
    /// The border is a ray from the point where they meet, normal to one of them or between both normals. Along it their
    /// distance grows as the parameter does, and that of no other feature grows faster, so that halving finds the end.
    fn border_ends(&self) -> Vec<f64> {
        let mut heights = Vec::new();
        for (index, pair) in self.features.windows(2).enumerate() {
            if !pair[0].continues_in(&pair[1]) {
                continue;
            }
            let [one, other] = [pair[0].tangent_at(1), pair[1].tangent_at(0)];
            let mean = [0, 1].map(|k| one[k] + other[k]);
            for [d, z] in [one, other, mean] {
                let length = d.hypot(z);
                let (normal, from) = ([-z / length, d / length], pair[1].ends[0]);
                let point = |t: f64| [0, 1].map(|k| from[k] + t * normal[k]);
                let is_other_nearer = |t: f64| {
                    let others =
                        (0..self.features.len()).filter(|k| *k != index && *k != index + 1);
                    self.nearest(others, point(t)).0 <= t
                };
                let to_axis = if normal[0] < 0.0 { from[0] / -normal[0] } else { f64::INFINITY };
                let [mut low, mut high] = [0.0, to_axis.min(2.0 * self.size)];
                // Otherwise the border ends at the axis.
                if !is_other_nearer(high) {
                    continue;
                }
                while low < f64::midpoint(low, high) && f64::midpoint(low, high) < high {
                    let middle = f64::midpoint(low, high);
                    if is_other_nearer(middle) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                heights.push(point(high)[1]);
            }
        }
        heights
    }

    /// Leaves open in a search how deep a triangle is within a distance of which a height at which depth can be greatest may not
    /// be known.
    pub(crate) fn leave_unresolved(
        &self,
        owners: &Owners,
        corners: [Point; 3],
        distance: f64,
        search: &mut DepthSearch,
    ) {
        // Hardly any profile has some.
        if self.unresolved.is_empty() && owners.unresolved.is_empty() {
            return;
        }
        let rectangle = SubTriangle::new(corners).rectangle(distance);
        let unresolved = self.unresolved.iter().chain(&owners.unresolved);
        for near in unresolved.filter(|unresolved| unresolved.meets(&rectangle)) {
            let (middle, reach) = near.ball();
            let bound = self.signed(middle) + reach + self.error;
            if bound > search.threshold() {
                search.leave(bound);
            }
        }
    }

    /// Returns whether a point midway between two points of the profile, `half` away from both, is inside and has no
    /// nearer point of the profile.
    fn is_critical(&self, middle: MeridianPoint, half: f64) -> bool {
        let is_nearest = (self.unsigned_distance(middle) - half).abs() <= self.error;
        middle[0] > 0.0 && half > self.error && is_nearest && self.contains(middle)
    }
}

/// Returns pairs of points of features, or of the lines and circles that they lie on, that have a common normal. An end
/// of a feature counts as having every normal.
fn normal_pairs(features: &[Feature]) -> Vec<[MeridianPoint; 2]> {
    let mut pairs = Vec::new();
    let ends: Vec<MeridianPoint> = features.iter().flat_map(|feature| feature.ends).collect();
    for (index, feature) in features.iter().enumerate() {
        for end in &ends {
            pairs.extend(normals(feature, *end).map(|point| [*end, point]));
        }
        for other in &features[..index] {
            match (&feature.circle, &other.circle) {
                // Parallel lines have common normals everywhere; those at their ends suffice.
                (None, None) => {}
                (Some(circle), None) => pairs.extend(common(other, circle)),
                (None, Some(circle)) => pairs.extend(common(feature, circle)),
                // The common normal of two circles passes through both centres.
                (Some(one), Some(_)) => {
                    for point in normals(other, one.centre) {
                        pairs.extend(normals(feature, point).map(|own| [own, point]));
                    }
                }
            }
        }
    }
    for (index, end) in ends.iter().enumerate() {
        pairs.extend(ends[..index].iter().map(|other| [*end, *other]));
    }
    pairs
}

/// Returns the points of a feature's line or circle whose normal passes through a point.
fn normals(feature: &Feature, p: MeridianPoint) -> impl Iterator<Item = MeridianPoint> + use<> {
    let points = match &feature.circle {
        None => [Some(feature.line_point(feature.position(p))), None],
        Some(Circle { centre, radius, .. }) => {
            let offset = minus(p, *centre);
            let distance = norm(offset);
            [1.0, -1.0].map(|side| {
                (distance > 0.0)
                    .then(|| [0, 1].map(|k| centre[k] + side * radius * (offset[k] / distance)))
            })
        }
    };
    points.into_iter().flatten()
}

/// Returns the pairs of points of a line and a circle on their common normal.
fn common(line: &Feature, circle: &Circle) -> [[MeridianPoint; 2]; 2] {
    let Circle { centre, radius, .. } = *circle;
    let foot = line.line_point(line.position(centre));
    let normal = [-line.along[1], line.along[0]];
    [radius, -radius].map(|radius| [foot, [0, 1].map(|k| centre[k] + radius * normal[k])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SurfaceId;
    use crate::tool::Interpreted;
    use crate::tool::Tool;
    use std::sync::LazyLock;

    static HELD: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Held "a ball end mill in a nut" {
            units mm;
            profile {
                start (0, 0);
                arc to (3, 3) center (0, 3) as ball cutting;
                line to (3, 18) as flute cutting;
                line to (3, 30) as shank;
                line to (8.5, 30), (14, 31), (14, 47), (0, 47) as nut;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    static WAISTED: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Waisted "an overhang, and borders that are not level" {
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

    const ERROR: f64 = 1e-12;

    #[test]
    fn every_point_that_a_surface_owns_lies_in_a_zone() {
        for info in [HELD.info(), WAISTED.info()] {
            let section = Section::new(info, ERROR).map(Section::with_circles);
            let section = section.expect("a profile");
            for surface in 0..info.surfaces.len() {
                for deeper in [0.0, 0.5, 2.0] {
                    let owners = Owners::of(&section, |other| other == surface);
                    let zones = owners.zones(&section, deeper);
                    for (k, slab) in
                        (0..200 * zones.len()).map(|k| (k, &section.slabs[k % zones.len()]))
                    {
                        let fraction = |step: f64| (0.5 + step * k as f64).fract();
                        let p = [
                            slab.hole + fraction(0.618_033_988_7) * (slab.radius - slab.hole),
                            slab.low + fraction(0.754_877_666_2) * (slab.high - slab.low),
                        ];
                        // The nearest feature by the distances of all, which the zones are not computed from.
                        let distances = section.features.iter().map(|feature| feature.distance(p));
                        let nearest = distances.clone().fold(f64::INFINITY, f64::min);
                        let mut nearby = section.features.iter().zip(distances);
                        let owns = nearby.any(|(f, d)| d == nearest && f.surface == surface);
                        if !owns || !section.contains(p) || nearest <= deeper {
                            continue;
                        }
                        let in_zone = zones
                            .iter()
                            .flatten()
                            .any(|zone| zone.contains(&Rectangle { low: p, high: p }));
                        assert!(in_zone, "{} surface {surface}, {p:?} at {nearest}", info.name);
                    }
                }
            }
        }
    }

    #[test]
    fn zones_end_at_the_height_where_surfaces_of_equal_direction_meet() {
        let section = Section::new(HELD.info(), ERROR).expect("a profile");
        let ends = |name: &str| {
            let SurfaceId(surface) = HELD.info().surface_named(name).expect("a surface");
            let zones = Owners::of(&section, |other| other == surface).zones(&section, 0.0);
            let bounds = zones.into_iter().flatten().map(|zone| [zone.low[1], zone.high[1]]);
            bounds
                .reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])
                .expect("a zone")
        };
        for (name, [low, high]) in [("ball", [0.0, 3.0]), ("flute", [3.0, 18.0])] {
            let [from, to] = ends(name);
            assert!(
                (from - low).abs() <= ERROR && (to - high).abs() <= ERROR,
                "{name}: {from} {to}"
            );
        }
    }
}
