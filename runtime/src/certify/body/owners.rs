//! Which of a tool's features are asked about: those that own a place are the nearest to it. Of a tool that
//! is known by its field the features are its regions.

use crate::certify::body::feature::{Feature, Place, minus, norm};
use crate::certify::body::section::{Section, Slab};
use crate::tool::{Card, Region, bit};
use std::collections::BinaryHeap;

/// Features, by their places in the section's list.
#[derive(Clone, Debug, Default)]
pub(crate) struct Owners {
    /// `None` for all of them.
    some: Option<Vec<bool>>,
    /// Those that are regions of a tool by its field, a bit each as [`crate::tool::Enclosed`] has them.
    regions: u64,
    /// Heights at which they own places that are deeper than all others about them that they own.
    pub(crate) peaks: Vec<f64>,
}

/// Places of the half plane.
#[derive(Clone, Copy)]
struct Rectangle {
    low: Place,
    high: Place,
}

impl Rectangle {
    /// All between a slab's heights that may be inside.
    fn of(slab: &Slab) -> Rectangle {
        Rectangle { low: [slab.hole, slab.low], high: [slab.radius, slab.high] }
    }

    fn corners(&self) -> [Place; 4] {
        let Rectangle { low, high } = *self;
        [low, [high[0], low[1]], high, [low[0], high[1]]]
    }

    fn wide(&self) -> Place {
        minus(self.high, self.low)
    }

    /// Its middle, and how far it reaches from there.
    fn ball(&self) -> (Place, f64) {
        let [across, up] = self.wide();
        ([0, 1].map(|k| f64::midpoint(self.low[k], self.high[k])), 0.5 * across.hypot(up))
    }

    /// Both halves of its longer side.
    fn halves(&self) -> [Rectangle; 2] {
        let ([across, up], (middle, _)) = (self.wide(), self.ball());
        let longer = usize::from(up > across);
        let (mut first, mut second) = (*self, *self);
        first.high[longer] = middle[longer];
        second.low[longer] = middle[longer];
        [first, second]
    }
}

impl Owners {
    /// The features of some surfaces.
    pub(crate) fn of(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let some: Vec<bool> = section.features.iter().map(|f| surfaces(f.surface)).collect();
        let some = some.contains(&false).then_some(some);
        let mut owners = Owners { some, ..Owners::default() };
        if !owners.all() {
            match owners.find_peaks(section, true) {
                // Just below and just above: of a seam either side owns only what is on its side.
                Some(peaks) => {
                    let beside = 0.25 * section.error;
                    let both = |peak: f64| [peak - beside, peak + beside];
                    owners.peaks = peaks.into_iter().flat_map(both).collect();
                }
                // No profile that is meant is like this; the whole tool is no less deep.
                None => owners.some = None,
            }
        }
        owners
    }

    /// The same, to be asked how near they are: where all of one is within a triangle's distances and heights,
    /// it is at its ends that the triangle comes to it.
    pub(crate) fn near(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let own = |feature: &&Feature| surfaces(feature.surface);
        let ends = section.features.iter().filter(own).flat_map(|feature| feature.ends);
        let peaks = ends.map(|end| end[1]).collect();
        let some = section.features.iter().map(|f| surfaces(f.surface)).collect();
        Owners { some: Some(some), peaks, ..Owners::default() }
    }

    /// Regions of a tool that is known by its field.
    pub(crate) fn of_regions(card: &Card, own: impl Fn(usize, &Region) -> bool) -> Owners {
        let some: Vec<bool> =
            card.regions.iter().enumerate().map(|(index, region)| own(index, region)).collect();
        let bits = (0..some.len()).filter(|index| some[*index]).map(bit);
        let regions = bits.fold(0, |all, bit| all | bit);
        Owners { some: some.contains(&false).then_some(some), regions, peaks: Vec::new() }
    }

    /// Whether some of a tool's regions are among them.
    pub(crate) fn own_some(&self, regions: u64) -> bool {
        self.all() || self.regions & regions != 0
    }

    /// Whether these are all features.
    #[inline]
    pub(crate) fn all(&self) -> bool {
        self.some.is_none()
    }

    /// Whether a feature is one of them.
    #[inline]
    pub(crate) fn own(&self, feature: usize) -> bool {
        self.some.as_ref().is_none_or(|some| some[feature])
    }

    /// Of each slab, between which heights these can own a place that is deeper than that.
    pub(crate) fn zones(&self, section: &Section, deeper: f64) -> Vec<Option<[f64; 2]>> {
        let whole = |slab: &Slab| Some([slab.low, slab.high]);
        let zone = |slab| if self.all() { whole(slab) } else { self.zone(section, slab, deeper) };
        section.slabs.iter().map(zone).collect()
    }

    /// By rectangles of the slab, halved until an owner is the nearest in all of one, or in none, or it is
    /// too small to matter.
    fn zone(&self, section: &Section, slab: &Slab, deeper: f64) -> Option<[f64; 2]> {
        let small = section.size / f64::from(FINE);
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
                if section.behind(index, &corners) {
                    continue;
                }
                let least = if self.own(index) { &mut owner } else { &mut other };
                *least = least.min(feature.away(middle));
            }
            // A distance changes by no more than the way.
            let apart = 2.0 * reach + section.error;
            if owner > other + apart || owner.min(other) + reach <= deeper {
                continue;
            }
            let surely = owner + apart < other && owner - reach > deeper;
            if surely || reach <= small {
                let [from, to] = zone.unwrap_or([low[1], high[1]]);
                zone = Some([from.min(low[1]), to.max(high[1])]);
                continue;
            }
            stack.extend(rectangle.halves());
        }
        zone
    }

    /// Returns how deep the deepest place is that these own, to a hundredth; no less than that if the budget is spent
    /// before.
    ///
    /// By rectangles that are halved, the one that may be deepest first: depth changes by no more than the way.
    pub(crate) fn greatest_depth(&self, section: &Section) -> f64 {
        let mut greatest = 0.0;
        let mut rectangles: Vec<Rectangle> = Vec::new();
        // Numbers that are not negative are in the order of their bits.
        let mut open: BinaryHeap<(u64, usize)> = BinaryHeap::new();
        let mut halves: Vec<Rectangle> = section.slabs.iter().map(Rectangle::of).collect();
        for _ in 0..LOOKS {
            for rectangle in halves.drain(..) {
                let (middle, reach) = rectangle.ball();
                let depth = section.signed(middle);
                let away = section.owned(self).map(|owner| section.features[owner].away(middle));
                let owner = away.fold(f64::INFINITY, f64::min);
                if depth >= 0.0 && owner <= depth + section.error {
                    greatest = depth.max(greatest);
                }
                if owner <= depth.abs() + 2.0 * reach + section.error && depth + reach >= 0.0 {
                    open.push(((depth + reach).to_bits(), rectangles.len()));
                    rectangles.push(rectangle);
                }
            }
            let Some((bound, index)) = open.pop() else { return greatest };
            let bound = f64::from_bits(bound);
            if bound <= 1.01 * greatest + section.error {
                return greatest;
            }
            halves.extend(rectangles[index].halves());
        }
        open.peek().map_or(greatest, |(bound, _)| f64::from_bits(*bound))
    }

    /// Where depth is restricted to what these own, it can be greatest at a place that is as far from three
    /// features; there are a few such places. Elsewhere it grows some way that they own, or away from the
    /// axis nowhere does.
    ///
    /// They are found by rectangles that are halved, to a part of what rounding makes of a place; `None` if
    /// there are too many. If `others`, only those near to which others own places too.
    pub(super) fn find_peaks(&self, section: &Section, others: bool) -> Option<Vec<f64>> {
        let small = section.error / 32.0;
        // At the centre of an arc all of it is as far.
        let centres = section.features.iter().filter_map(|feature| feature.circle);
        let mut peaks: Vec<f64> = centres.map(|circle| circle.centre[1]).collect();
        let mut looks = 0;
        let mut stack: Vec<Rectangle> = section.slabs.iter().map(Rectangle::of).collect();
        while let Some(rectangle) = stack.pop() {
            looks += 1;
            if looks > LOOKS {
                return None;
            }
            let (middle, reach) = rectangle.ball();
            let corners = rectangle.corners();
            if !self.may_peak(section, (middle, reach), &corners, others) {
                continue;
            }
            if reach <= small {
                if peaks.iter().all(|peak| (peak - middle[1]).abs() > 2.0 * small) {
                    peaks.push(middle[1]);
                }
                continue;
            }
            stack.extend(rectangle.halves());
        }
        Some(peaks)
    }

    /// Whether a place no farther than that from another may be as far from three features, and if `others`, some
    /// of them these and some not.
    fn may_peak(
        &self,
        section: &Section,
        (middle, reach): (Place, f64),
        corners: &[Place],
        others: bool,
    ) -> bool {
        let away: Vec<f64> = section.features.iter().map(|f| f.away(middle)).collect();
        let nearest = away.iter().copied().fold(f64::INFINITY, f64::min);
        let near = |index: &usize| away[*index] <= nearest + 2.0 * reach + section.error / 64.0;
        let mut nearby: Vec<(usize, Place)> = Vec::new();
        let mut both = [false; 2];
        for index in (0..away.len()).filter(near) {
            if section.behind(index, corners) {
                continue;
            }
            both[usize::from(self.own(index))] = true;
            let foot = section.features[index].foot(middle);
            // Both sides of a reflex corner are as near to what that is nearest to; elsewhere one of two that
            // meet is nearer on either side of a line.
            let of_corner = |feature: usize| section.features[feature].at_ends(corners).is_some();
            let known = |(other, known): &(usize, Place)| {
                // Ends that are shared are the same to the bit.
                let same = norm(minus(*known, foot)) <= section.error;
                let owner = self.own(index) == self.own(*other);
                same && (owner || (of_corner(index) && of_corner(*other)))
            };
            if !nearby.iter().any(known) {
                nearby.push((index, foot));
            }
        }
        nearby.len() > 2 && (both == [true, true] || !others)
    }
}

/// Zones are found to this part of the tool's size.
const FINE: u32 = 1 << 11;

/// How many rectangles are looked at for peaks, or for the deepest place.
const LOOKS: u32 = 1 << 17;
