//! The points that some features own, and how deep they are.

use crate::certify::rounding;
use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::cells::Cell;
use crate::certify::tool_model::outline::Outline;
use crate::certify::tool_model::peaks::Peaks;
use crate::certify::tool_model::quarter::{Quarter, mean};
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::tool_model::section::Section;
use crate::certify::tool_model::slab::SectionSlab;
use crate::tool::{Region, ToolInfo, bit};
use std::cell::LazyCell;
use std::collections::BinaryHeap;

/// The features to which a query is restricted, by their indices in the section's list. A feature *owns* the points to
/// which it is the nearest. For a tool known by its depth field the features are its regions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Owners {
    /// A flag per feature; `None` for all features.
    owned_features: Option<Vec<bool>>,
    /// The owning regions of a tool without a profile, one bit each as in [`crate::tool::EvaluationEnclosure`].
    regions: u64,
    /// Heights of local maxima of depth among the points that the features own.
    pub(crate) peaks: Vec<f64>,
    /// Rectangles in which there may be more of them.
    pub(crate) unresolved: Vec<Rectangle>,
}

impl Owners {
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
}

impl Owners {
    /// Returns the features of some surfaces.
    pub(crate) fn of(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let owned_features: Vec<bool> =
            section.outline.features.iter().map(|f| surfaces(f.segment.surface)).collect();
        let owned_features = owned_features.contains(&false).then_some(owned_features);
        let mut owners = Owners { owned_features, ..Owners::default() };
        if !owners.all() {
            let Peaks { heights, unresolved } = owners.find_peaks(section, true);
            // Just below and just above: at a seam each side owns only points on its side.
            let beside = rounding::FRACTION * section.outline.error;
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
            section.outline.features.iter().map(|f| surfaces(f.segment.surface)).collect();
        let owned =
            section.outline.features.iter().zip(&owned_features).filter(|(_, owned)| **owned);
        let peaks = owned.flat_map(|(feature, _)| feature.segment.ends.map(|end| end[1])).collect();
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
            return slabs.map(|slab| Some(slab.rectangle())).collect();
        }
        slabs.map(|slab| self.zone(section, slab, deeper)).collect()
    }

    /// Computes the zone of a slab. Cells of it are halved until all candidates are owners or none is, or until the cell is too
    /// small to matter.
    fn zone(&self, section: &Section, slab: &SectionSlab, deeper: f64) -> Option<Rectangle> {
        let min_size = section.outline.size / f64::from(ZONE_DIVISIONS);
        let strip = rounding::FRACTION * section.outline.error.min(slab.high - slab.low);
        let mut zone: Option<Rectangle> = None;
        let widen = |zone: &mut Option<Rectangle>, rectangle: Rectangle| {
            *zone = Some(zone.map_or(rectangle, |zone| zone.widened(&rectangle)));
        };
        let margin = section.outline.owner_margin();
        let mut stack = section.cells_of(slab);
        while let Some(cell) = stack.pop() {
            let rectangle = cell.rectangle;
            if zone.is_some_and(|zone| zone.contains(&rectangle)) {
                continue;
            }
            let ownership = self.ownership(section, &cell, deeper);
            if ownership == Ownership::None {
                continue;
            }
            // The height of a seam at which features of equal direction meet is the border between their points, and only
            // a strip along it is not certain to belong to one of them.
            let (inner, strips) = rectangle.without_seams([slab.low, slab.high], strip);
            let part =
                |rectangle: Rectangle| section.outline.cell(rectangle, &cell.candidates, margin);
            let is_owned = |cell: &Cell| self.ownership(section, cell, deeper) != Ownership::None;
            if !strips.is_empty() && !is_owned(&part(inner)) {
                for strip in strips {
                    if is_owned(&part(strip)) {
                        widen(&mut zone, strip);
                    }
                }
            } else if ownership == Ownership::All || rectangle.ball().1 <= min_size {
                widen(&mut zone, rectangle);
            } else {
                stack.extend(section.outline.halves(&cell, margin));
            }
        }
        zone
    }

    /// Returns which of a cell's points deeper than `deeper` the owners own.
    fn ownership(&self, section: &Section, cell: &Cell, deeper: f64) -> Ownership {
        let (middle, reach) = cell.rectangle.ball();
        let candidates = cell.candidates.iter().copied();
        // Depth has the Lipschitz constant 1.
        let (depth, _) = section.outline.nearest(candidates.clone(), middle);
        let mut owned = candidates.map(|candidate| self.is_owned(candidate));
        if depth + reach <= deeper || !owned.clone().any(|is_owned| is_owned) {
            Ownership::None
        } else if depth - reach > deeper && owned.all(|is_owned| is_owned) {
            Ownership::All
        } else {
            Ownership::Some
        }
    }

    /// Returns an upper bound on the depth of the points that the owners own, at most 1 % above the depth of one of
    /// them unless the budget is spent first.
    ///
    /// Cells are halved, the one that may be deepest first: depth has the Lipschitz constant 1.
    pub(crate) fn greatest_depth(&self, section: &Section) -> f64 {
        let mut max_depth = 0.0;
        let mut cells: Vec<Cell> = Vec::new();
        // Non-negative floating point numbers are in the order of their bits.
        let mut queue: BinaryHeap<(u64, usize)> = BinaryHeap::new();
        let mut halves: Vec<Cell> =
            section.slabs.iter().flat_map(|slab| section.cells_of(slab)).collect();
        let mut bound = f64::INFINITY;
        for _ in 0..MAX_CELLS {
            for cell in halves.drain(..) {
                let (middle, reach) = cell.rectangle.ball();
                let candidates = cell.candidates.iter().copied();
                let (depth, _) = section.outline.nearest(candidates.clone(), middle);
                let owned = candidates.filter(|candidate| self.is_owned(*candidate));
                let (owner, _) = section.outline.nearest(owned, middle);
                let is_inside = section.contains(middle);
                if is_inside && owner <= depth + section.outline.error {
                    max_depth = depth.max(max_depth);
                }
                if owner.is_finite() && (is_inside || depth <= reach) {
                    let signed = if is_inside { depth } else { -depth };
                    queue.push(((signed + reach).to_bits(), cells.len()));
                    cells.push(cell);
                }
            }
            let Some((bits, index)) = queue.pop() else { return max_depth };
            bound = f64::from_bits(bits);
            if bound <= 1.01 * max_depth + section.outline.error {
                break;
            }
            halves.extend(section.outline.halves(&cells[index], section.outline.owner_margin()));
        }
        // The cell divided last had the largest bound, which holds for its halves too.
        bound + section.outline.error
    }

    /// Returns the features that are owners.
    pub(super) fn owned(&self, outline: &Outline) -> impl Iterator<Item = usize> {
        (0..outline.features.len()).filter(|feature| self.is_owned(*feature))
    }

    /// Returns whether they own no point of a rectangle within `displacement` of a point with this depth.
    pub(super) fn are_far_from(
        &self,
        outline: &Outline,
        rectangle: &[MeridianPoint; 4],
        p: MeridianPoint,
        depth: f64,
        displacement: f64,
    ) -> bool {
        !self.all()
            && self.own_nothing(outline, rectangle, outline.owner_margin(), |owner| {
                outline.features[owner].segment.distance(p) > depth + 2.0 * displacement
            })
    }

    /// Returns whether all owners are farther away than the distance up to which a point outside counts as touching.
    pub(super) fn are_apart(&self, outline: &Outline, distance: impl Fn(&Quarter) -> f64) -> bool {
        !self.all()
            && self
                .owned(outline)
                .all(|owner| distance(&outline.features[owner]) > outline.contact_tolerance())
    }

    /// Returns whether they own no point of a polygon: each is known to be far away, or its neighbours are nearer to all
    /// points, or a feature that is no owner is, by more than a margin.
    #[inline]
    pub(super) fn own_nothing<const N: usize>(
        &self,
        outline: &Outline,
        corners: &[MeridianPoint; N],
        margin: f64,
        is_far: impl Fn(usize) -> bool,
    ) -> bool {
        // Computed once: it is the same for all owners, and few polygons need it.
        let nearest_other = LazyCell::new(|| {
            let others = (0..outline.features.len()).filter(|feature| !self.is_owned(*feature));
            &outline.features[outline.nearest(others, mean(corners)).1]
        });
        self.owned(outline).all(|owner| {
            is_far(owner)
                || outline.hidden_by_neighbours(owner, corners)
                || outline.features[owner].is_farther(&nearest_other, corners, margin)
        })
    }
}

/// The part of a cell's points that some features own.
#[derive(Clone, Copy, PartialEq)]
enum Ownership {
    None,
    Some,
    All,
}

/// The resolution of zones: the tool's size divided by this.
const ZONE_DIVISIONS: u32 = 1 << 11;

/// The maximum number of cells halved for the deepest point. The bound proved until then is the answer.
const MAX_CELLS: u32 = 1 << 17;

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
            let section = Section::new(info, ERROR);
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
                        let distances = section
                            .outline
                            .features
                            .iter()
                            .map(|feature| feature.segment.distance(p));
                        let nearest = distances.clone().fold(f64::INFINITY, f64::min);
                        let mut nearby = section.outline.features.iter().zip(distances);
                        let owns =
                            nearby.any(|(f, d)| d == nearest && f.segment.surface == surface);
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
