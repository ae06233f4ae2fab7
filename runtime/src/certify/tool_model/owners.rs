//! The features to which a query is restricted. A feature *owns* the points to which it is the nearest. For a
//! tool known by its depth field the features are its regions.

use crate::certify::tool_model::feature::{Feature, MeridianPoint, minus, norm};
use crate::certify::tool_model::section::{Section, SectionSlab};
use crate::tool::{Region, ToolInfo, bit};
use std::collections::BinaryHeap;

/// A set of features, by their indices in the section's list.
#[derive(Clone, Debug, Default)]
pub(crate) struct Owners {
    /// A flag per feature; `None` for all features.
    owned_features: Option<Vec<bool>>,
    /// The owning regions of a tool without a profile, one bit each as in [`crate::tool::EvaluationEnclosure`].
    regions: u64,
    /// Heights of local maxima of depth among the points that the features own.
    pub(crate) peaks: Vec<f64>,
}

/// A rectangle of the half plane.
#[derive(Clone, Copy)]
struct Rectangle {
    low: MeridianPoint,
    high: MeridianPoint,
}

impl Rectangle {
    /// Returns the bounding rectangle of a slab.
    fn of(slab: &SectionSlab) -> Rectangle {
        Rectangle { low: [slab.hole, slab.low], high: [slab.radius, slab.high] }
    }

    fn corners(&self) -> [MeridianPoint; 4] {
        let Rectangle { low, high } = *self;
        [low, [high[0], low[1]], high, [low[0], high[1]]]
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
}

impl Owners {
    /// Returns the features of some surfaces.
    pub(crate) fn of(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let owned_features: Vec<bool> =
            section.features.iter().map(|f| surfaces(f.surface)).collect();
        let owned_features = owned_features.contains(&false).then_some(owned_features);
        let mut owners = Owners { owned_features, ..Owners::default() };
        if !owners.all() {
            match owners.find_peaks(section, true) {
                // Just below and just above: at a seam each side owns only points on its side.
                Some(peaks) => {
                    let beside = 0.25 * section.error;
                    let owner_kinds = |peak: f64| [peak - beside, peak + beside];
                    owners.peaks = peaks.into_iter().flat_map(owner_kinds).collect();
                }
                // No realistic profile is like this. The depth of the whole tool is an upper bound.
                None => owners.owned_features = None,
            }
        }
        owners
    }

    /// Returns the features of some surfaces for distance queries. If a feature lies within a triangle's range of
    /// distances and heights, the triangle meets it at the height of one of its ends, so the peaks are the heights of
    /// ends.
    pub(crate) fn near(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let is_owned = |feature: &&Feature| surfaces(feature.surface);
        let ends = section.features.iter().filter(is_owned).flat_map(|feature| feature.ends);
        let peaks = ends.map(|end| end[1]).collect();
        let owned_features = section.features.iter().map(|f| surfaces(f.surface)).collect();
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
            peaks: Vec::new(),
        }
    }

    /// Returns whether some of these regions, a bit each, are owners.
    pub(crate) fn own_some(&self, regions: u64) -> bool {
        self.all() || self.regions & regions != 0
    }

    /// Returns whether all features are owners.
    #[inline]
    pub(crate) fn all(&self) -> bool {
        self.owned_features.is_none()
    }

    /// Returns whether a feature is an owner.
    #[inline]
    pub(crate) fn is_owned(&self, feature: usize) -> bool {
        self.owned_features.as_ref().is_none_or(|owned_features| owned_features[feature])
    }

    /// Returns, per slab, the heights between which the owners can own a point deeper than `deeper`.
    pub(crate) fn zones(&self, section: &Section, deeper: f64) -> Vec<Option<[f64; 2]>> {
        let whole = |slab: &SectionSlab| Some([slab.low, slab.high]);
        let zone = |slab| if self.all() { whole(slab) } else { self.zone(section, slab, deeper) };
        section.slabs.iter().map(zone).collect()
    }

    /// Computes the zone of a slab. Rectangles of it are halved until an owner is the nearest feature in all of one
    /// or in none of it, or until the rectangle is too small to matter.
    fn zone(&self, section: &Section, slab: &SectionSlab, deeper: f64) -> Option<[f64; 2]> {
        let min_size = section.size / f64::from(ZONE_DIVISIONS);
        let mut zone: Option<[f64; 2]> = None;
        let mut stack = vec![Rectangle::of(slab)];
        while let Some(rectangle) = stack.pop() {
            let Rectangle { low, high } = rectangle;
            if zone.is_some_and(|[from, to]| from <= low[1] && high[1] <= to) {
                continue;
            }
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
            // A distance has the Lipschitz constant 1.
            let uncertainty = 2.0 * reach + section.error;
            if owner > other + uncertainty || owner.min(other) + reach <= deeper {
                continue;
            }
            let surely = owner + uncertainty < other && owner - reach > deeper;
            if surely || reach <= min_size {
                let [from, to] = zone.unwrap_or([low[1], high[1]]);
                zone = Some([from.min(low[1]), to.max(high[1])]);
                continue;
            }
            stack.extend(rectangle.halves());
        }
        zone
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
    /// points, or does not grow away from the axis.
    ///
    /// The heights are found by halving rectangles, down to a fraction of the error bound of a point. Returns `None`
    /// if there are too many. With `others`, only those are returned near which other features own points too.
    pub(super) fn find_peaks(&self, section: &Section, others: bool) -> Option<Vec<f64>> {
        let min_size = section.error / 32.0;
        // All points of an arc are equally far from its centre.
        let centres = section.features.iter().filter_map(|feature| feature.circle);
        let mut peaks: Vec<f64> = centres.map(|circle| circle.centre[1]).collect();
        let mut examined = 0;
        let mut stack: Vec<Rectangle> = section.slabs.iter().map(Rectangle::of).collect();
        while let Some(rectangle) = stack.pop() {
            examined += 1;
            if examined > MAX_RECTANGLES {
                return None;
            }
            let (middle, reach) = rectangle.ball();
            let corners = rectangle.corners();
            if !self.may_peak(section, middle, reach, &corners, others) {
                continue;
            }
            if reach <= min_size {
                if peaks.iter().all(|peak| (peak - middle[1]).abs() > 2.0 * min_size) {
                    peaks.push(middle[1]);
                }
                continue;
            }
            stack.extend(rectangle.halves());
        }
        Some(peaks)
    }

    /// Returns whether a point within `reach` of another may be equally far from three features. With `others`, some
    /// of these have to be owners and some not.
    fn may_peak(
        &self,
        section: &Section,
        middle: MeridianPoint,
        reach: f64,
        corners: &[MeridianPoint],
        others: bool,
    ) -> bool {
        let away: Vec<f64> = section.features.iter().map(|f| f.distance(middle)).collect();
        let nearest = away.iter().copied().fold(f64::INFINITY, f64::min);
        let near = |index: &usize| away[*index] <= nearest + 2.0 * reach + section.error / 64.0;
        let mut nearby: Vec<(usize, MeridianPoint)> = Vec::new();
        let mut owner_kinds = [false; 2];
        for index in (0..away.len()).filter(near) {
            if section.hidden_by_neighbours(index, corners) {
                continue;
            }
            owner_kinds[usize::from(self.is_owned(index))] = true;
            let foot = section.features[index].foot(middle);
            // Both sides of a reflex corner are equally far from a point nearest to that corner. Elsewhere one of two
            // adjacent features is nearer on either side of a line.
            let of_corner = |feature: usize| section.features[feature].at_ends(corners).is_some();
            let is_known = |(other, is_known): &(usize, MeridianPoint)| {
                // Shared ends are identical to the bit.
                let same = norm(minus(*is_known, foot)) <= section.error;
                let owner = self.is_owned(index) == self.is_owned(*other);
                same && (owner || (of_corner(index) && of_corner(*other)))
            };
            if !nearby.iter().any(is_known) {
                nearby.push((index, foot));
            }
        }
        nearby.len() > 2 && (owner_kinds == [true, true] || !others)
    }
}

/// The resolution of zones: the tool's size divided by this.
const ZONE_DIVISIONS: u32 = 1 << 11;

/// The maximum number of rectangles examined for peaks, or for the deepest point.
const MAX_RECTANGLES: u32 = 1 << 17;
