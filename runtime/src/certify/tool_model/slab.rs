//! Slabs: regions of the half plane between two heights, and inward of one feature, their *side*. A slab extends to the axis, or to
//! another feature, its *inner* side, where the profile overhangs. No feature ends between a slab's heights.

use crate::certify::tool_model::outline::Outline;
use crate::certify::tool_model::quarter::Quarter;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::tool_model::section::Section;
use touchoff_plane::Segment;

/// A region between two heights.
#[derive(Clone, Debug)]
pub(crate) struct SectionSlab {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The feature that bounds it away from the axis.
    pub(crate) side: usize,
    /// The feature that bounds it toward the axis; `None` if the slab reaches the axis.
    pub(super) inner: Option<usize>,
    /// The least radius.
    pub(crate) hole: f64,
    /// The radii of its side at both heights.
    radii: [f64; 2],
    /// The largest radius.
    pub(crate) radius: f64,
    /// The range along the line of its side in which a foot is on the surface or outside the tool, so that depth is
    /// at most the distance from that line.
    pub(super) feet: [f64; 2],
}

impl SectionSlab {
    /// Returns its bounding rectangle.
    pub(crate) fn rectangle(&self) -> Rectangle {
        Rectangle { low: [self.hole, self.low], high: [self.radius, self.high] }
    }
}

impl Outline {
    /// Returns the slabs between the heights at which features end, in upward order. Features whose ends differ in
    /// height by at most some roundings have none.
    pub(super) fn slabs(&self) -> Vec<SectionSlab> {
        let features = &self.features;
        // Less than `error`, by which slabs are taken to reach farther: that is 64 ε of a length no smaller than `size`.
        let level = 4.0 * f64::EPSILON * self.size;
        let mut heights: Vec<f64> =
            features.iter().flat_map(|f| f.segment.ends).map(|end| end[1]).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|upper, lower| *upper - *lower <= level);
        let mut slabs = Vec::new();
        for pair in heights.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            let middle = f64::midpoint(low, high);
            let passing = features.iter().enumerate().filter(|(_, feature)| {
                let [from, to] = feature.segment.ends.map(|end| end[1]);
                (to - from).abs() > level && from.min(to) < middle && middle < from.max(to)
            });
            let mut sides: Vec<usize> = passing.map(|(index, _)| index).collect();
            sides.sort_by(|one, other| {
                features[*one].radius_at(middle).total_cmp(&features[*other].radius_at(middle))
            });
            // The tool is on the left of its profile: a feature that runs up ends it, one that runs down begins it.
            let mut inner = None;
            for side in sides {
                let [from, to] = features[side].segment.ends.map(|end| end[1]);
                if from < to {
                    slabs.push(SectionSlab::new(features, [low, high], side, inner.take()));
                } else {
                    inner = Some(side);
                }
            }
        }
        let feet: Vec<[f64; 2]> = (0..slabs.len())
            .map(|index| self.feet(&features[slabs[index].side].segment, &slabs, index))
            .collect();
        slabs.iter_mut().zip(feet).for_each(|(slab, feet)| slab.feet = feet);
        slabs
    }

    /// Returns the range along a line in which its feet are outside the tool, provided that they are between the
    /// heights of a slab.
    fn feet(&self, line: &Segment, slabs: &[SectionSlab], index: usize) -> [f64; 2] {
        let SectionSlab { low, high, .. } = slabs[index];
        let mut below = slabs[..index].iter().rev();
        let below = below.find(|other| !self.is_outside(line, other));
        let above = slabs[index + 1..].iter().find(|other| !self.is_outside(line, other));
        if [below, above].into_iter().flatten().any(|other| other.low < high && low < other.high) {
            // The tool continues beyond a gap: only feet on the side itself are known to be on the surface.
            return [0.0, line.chord];
        }
        [
            below.map_or(f64::NEG_INFINITY, |other| line.position_at_height(other.high).min(0.0)),
            above.map_or(f64::INFINITY, |other| line.position_at_height(other.low).max(line.chord)),
        ]
    }

    /// Returns whether a line stays outside the tool between a slab's heights.
    fn is_outside(&self, line: &Segment, slab: &SectionSlab) -> bool {
        let [low, high] = [slab.low, slab.high].map(|z| line.line_radius_at(z));
        match self.features[slab.side].segment.circle {
            None => low >= slab.radii[0] && high >= slab.radii[1],
            // An arc may bulge between its ends, so the line has to clear the slab's largest radius.
            Some(_) => low.min(high) >= slab.radius,
        }
    }
}

impl SectionSlab {
    fn new(
        features: &[Quarter],
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
        // Feet on the side itself are on the surface. How far they may be beyond it depends on the other slabs.
        let feet = [0.0, features[side].segment.chord];
        SectionSlab { low, high, side, inner, hole, radii, radius, feet }
    }
}

impl Section {
    /// Returns the range along a line in which its feet are outside the tool, provided that they are between the
    /// heights of a slab.
    pub(crate) fn feet(&self, line: &Segment, slab: usize) -> [f64; 2] {
        self.outline.feet(line, &self.slabs, slab)
    }

    /// Returns the feature that is the outer side of a slab.
    pub(crate) fn side(&self, slab: &SectionSlab) -> &Quarter {
        &self.outline.features[slab.side]
    }

    /// Returns the range along a line of the profile, other than a level one, in which its feet are on the surface or outside
    /// the tool.
    pub(crate) fn outside_feet(&self, index: usize) -> [f64; 2] {
        let line = &self.outline.features[index].segment;
        match self.slabs.iter().position(|slab| slab.side == index) {
            Some(slab) => self.feet(line, slab),
            None => [0.0, line.chord],
        }
    }

    /// Returns whether no point of a slab is deeper than its distance from a line that touches the slab's side: all
    /// feet are on the surface or outside.
    pub(crate) fn tangent_bounds_slab(&self, line: &Segment, slab: usize) -> bool {
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
        let is_line = self.side(slab).segment.circle.is_none();
        let radii = if is_line { slab.radii } else { [slab.radius; 2] };
        let corners = [[slab.hole, low], [slab.hole, high], [radii[0], low], [radii[1], high]];
        let cells = self.cells_of(slab);
        let mut others: Vec<usize> = cells.into_iter().flat_map(|cell| cell.candidates).collect();
        // Neighbours bound depth near their common end, though they may be the nearest to no point of the slab.
        others.extend([
            slab.side.saturating_sub(1),
            (slab.side + 1).min(self.outline.features.len() - 1),
        ]);
        // Those next to the side along the profile are likely to bound depth best.
        others.sort_by_key(|other| (other.abs_diff(slab.side), *other));
        others.dedup();
        others.into_iter().skip_while(|other| *other == slab.side).filter(move |other| {
            let line = &self.outline.features[*other];
            let positions = corners.map(|corner| line.segment.position(corner));
            line.segment.circle.is_none()
                && line.segment.along[1] > 0.0
                && corners.iter().all(|corner| line.continued_distance(*corner) >= 0.0)
                && positions.iter().any(|at| *at > 0.0)
                && positions.iter().any(|at| *at < line.segment.chord)
        })
    }
}
