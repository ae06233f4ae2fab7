//! The heights at which depth can be greatest.
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

use crate::certify::rounding;
use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::cells::Cell;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::quarter::Quarter;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::tool_model::section::Section;
use touchoff_plane::Circle;
use touchoff_plane::{minus, norm};

/// The heights at which depth can have a local maximum, and rectangles in which there may be more of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Peaks {
    pub(crate) heights: Vec<f64>,
    pub(crate) unresolved: Vec<Rectangle>,
}

/// The maximum number of cells examined for peaks. What is left of them is a part of the answer.
const MAX_CELLS: usize = 1 << 17;

impl Owners {
    /// Returns the heights of points at which the depth of owned points can have a local maximum: points equally far
    /// from three features, of which there are few. Elsewhere depth grows in some direction in which the owners own
    /// points, or does not grow away from the axis. With `others`, only those are returned near which other features own
    /// points too.
    ///
    /// The heights are found by halving cells. Two features that
    /// meet nearly in line are equally far to within a fraction of the error bound all over some cells. There they count
    /// as one, and the end of their border is [computed](Section::border_ends) by itself.
    pub(super) fn find_peaks(&self, section: &Section, others: bool) -> Peaks {
        let min_size = rounding::PEAK_CELL * section.outline.error;
        // All points of an arc are equally far from its centre.
        let centres = section.outline.features.iter().filter_map(|feature| feature.segment.circle);
        let mut peaks: Vec<f64> = centres.map(|circle| circle.centre[1]).collect();
        peaks.extend(section.border_ends());
        let mut cells: Vec<Cell> =
            section.slabs.iter().flat_map(|slab| section.cells_of(slab)).collect();
        let mut examined = 0;
        while !cells.is_empty() {
            examined += cells.len();
            if examined > MAX_CELLS {
                break;
            }
            for cell in std::mem::take(&mut cells) {
                if !self.may_have_peak(section, &cell, others) {
                    continue;
                }
                let (middle, reach) = cell.rectangle.ball();
                if reach > min_size {
                    cells.extend(
                        section.outline.halves(&cell, rounding::PEAK_TIE * section.outline.error),
                    );
                } else if peaks.iter().all(|peak| (peak - middle[1]).abs() > 2.0 * min_size) {
                    // Neighbouring cells at one point count once.
                    peaks.push(middle[1]);
                }
            }
        }
        Peaks { heights: peaks, unresolved: cells.into_iter().map(|cell| cell.rectangle).collect() }
    }

    /// Returns whether a cell may hold a point equally far from three features. With `others`, some of these have to be owners
    /// and some not.
    fn may_have_peak(&self, section: &Section, cell: &Cell, others: bool) -> bool {
        let owned = cell.candidates.iter().filter(|index| self.is_owned(**index)).count();
        if others && (owned == 0 || owned == cell.candidates.len()) {
            return false;
        }
        let (middle, reach) = cell.rectangle.ball();
        let corners = cell.rectangle.corners();
        let feature = |index: usize| &section.outline.features[index];
        let mut sites: Vec<usize> = Vec::new();
        for index in &cell.candidates {
            let foot = feature(*index).segment.foot(middle);
            let is_known = sites.iter().any(|site| {
                // Both sides of a reflex corner are equally far from a point nearest to that corner. Elsewhere one of
                // two adjacent features is nearer on either side of a line. Shared ends are identical to the bit.
                let same_foot =
                    norm(minus(feature(*site).segment.foot(middle), foot)) <= section.outline.error;
                let same_kind = self.is_owned(*index) == self.is_owned(*site);
                let both_end = || {
                    [*index, *site].map(|f| feature(f).nearest_ends(&corners).is_some())
                        == [true; 2]
                };
                let is_in_line = || {
                    let (first, second) = (index.min(site), index.max(site));
                    reach >= rounding::MERGED_CELL * section.outline.error
                        && first + 1 == *second
                        && feature(*first).continues_in(feature(*second))
                        && feature(*first).is_as_far_as(
                            feature(*second),
                            &corners,
                            rounding::FRACTION * section.outline.error,
                        )
                };
                (same_foot && (same_kind || both_end())) || is_in_line()
            });
            if !is_known {
                sites.push(*index);
            }
            if sites.len() > 2 {
                return true;
            }
        }
        false
    }
}

impl Section {
    /// Returns the heights of circles about the axis on which depth can be greatest in a triangle, where the profile overhangs.
    pub(super) fn circles(&self) -> Peaks {
        if !self.overhangs {
            return Peaks::default();
        }
        let Peaks { mut heights, unresolved } = Owners::default().find_peaks(self, false);
        heights.extend(
            normal_pairs(&self.outline.features)
                .into_iter()
                .map(|[a, b]| ([0, 1].map(|k| f64::midpoint(a[k], b[k])), norm(minus(a, b))))
                .filter(|(middle, distance)| self.is_critical(*middle, 0.5 * distance))
                .map(|(middle, _)| middle[1]),
        );
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|upper, lower| *upper - *lower <= rounding::FRACTION * self.outline.error);
        Peaks { heights, unresolved }
    }

    /// Returns the heights of the ends of borders between features that meet nearly in line: where another feature is as near.
    ///
    /// A border begins where they meet, along the normal of one of them or between both normals. The distance of the pair grows
    /// along it as the distance from that point does, but for the turn between the normals, and no other distance grows faster,
    /// so that halving finds the end.
    fn border_ends(&self) -> Vec<f64> {
        let mut heights = Vec::new();
        for (index, pair) in self.outline.features.windows(2).enumerate() {
            if !pair[0].continues_in(&pair[1]) {
                continue;
            }
            let border = Border::new(self, &pair[0], &pair[1]);
            let others =
                || (0..self.outline.features.len()).filter(|k| *k != index && *k != index + 1);
            for course in [Course::FirstNormal, Course::SecondNormal, Course::Between] {
                let is_other_nearer = |t: f64| {
                    let p = border.point(course, t);
                    self.outline.nearest(others(), p).0
                        <= pair[0].segment.distance(p).min(pair[1].segment.distance(p))
                };
                let (from, away) = (border.from[0], border.max_away(course));
                let to_axis = if away < 0.0 { from / -away } else { f64::INFINITY };
                let end = to_axis.min(2.0 * self.outline.size);
                // Otherwise the border ends at the axis.
                if is_other_nearer(end) {
                    let end = bisect([0.0, end], is_other_nearer);
                    heights.push(border.point(course, end)[1]);
                }
            }
        }
        heights
    }

    /// Returns whether a point midway between two points of the profile, `half` away from both, is inside and has no
    /// nearer point of the profile.
    fn is_critical(&self, middle: MeridianPoint, half: f64) -> bool {
        let is_nearest = (self.unsigned_distance(middle) - half).abs() <= self.outline.error;
        middle[0] > 0.0 && half > self.outline.error && is_nearest && self.contains(middle)
    }
}

/// The border between two features that meet, from the point where they do.
struct Border<'f> {
    features: [&'f Quarter; 2],
    from: MeridianPoint,
    /// The unit normals of both at that point, into the tool.
    normals: [MeridianPoint; 2],
    /// True if between the normals it is a curve that strays from a line by more than rounding.
    is_curved: bool,
}

/// The course of a border: along the normal of one feature, where the tool's angle is more than half a turn, so that the point
/// where they meet is nearest between the normals; or between the normals, where it is less.
#[derive(Clone, Copy, PartialEq)]
enum Course {
    FirstNormal,
    SecondNormal,
    Between,
}

impl Border<'_> {
    fn new<'f>(section: &Section, first: &'f Quarter, second: &'f Quarter) -> Border<'f> {
        let normals = [first.segment.tangent(1), second.segment.tangent(0)].map(|[d, z]| {
            let length = d.hypot(z);
            [-z / length, d / length]
        });
        // Beside an arc that bulges the border ends at its centre at the latest, beside another one anywhere.
        let reach =
            |circle: Circle| if circle.convex { circle.radius } else { 2.0 * section.outline.size };
        let reaches =
            [first, second].into_iter().filter_map(|feature| feature.segment.circle.map(reach));
        let stray = norm(minus(normals[0], normals[1])) * reaches.fold(0.0, f64::max);
        let is_curved = stray > rounding::FRACTION * section.outline.error;
        Border { features: [first, second], from: second.segment.ends[0], normals, is_curved }
    }

    /// Returns whether a course is no line.
    fn is_curve(&self, course: Course) -> bool {
        course == Course::Between && self.is_curved
    }

    /// Returns an upper bound of the components, away from the axis, of the directions to its points.
    fn max_away(&self, course: Course) -> f64 {
        let [first, second] = self.normals.map(|normal| normal[0]);
        if self.is_curve(course) { first.max(second) } else { self.direction(course)[0] }
    }

    /// Returns the direction in which the border begins.
    fn direction(&self, course: Course) -> MeridianPoint {
        match course {
            Course::FirstNormal => self.normals[0],
            Course::SecondNormal => self.normals[1],
            Course::Between => self.mix(0.5),
        }
    }

    /// Returns a direction between both normals, 0 for the first and 1 for the second.
    fn mix(&self, part: f64) -> MeridianPoint {
        let [first, second] = self.normals;
        [0, 1].map(|k| first[k] + part * (second[k] - first[k]))
    }

    /// Returns the point of the border at `t` from its beginning, nearly.
    fn point(&self, course: Course, t: f64) -> MeridianPoint {
        let at = |direction: MeridianPoint| [0, 1].map(|k| self.from[k] + t * direction[k]);
        if !self.is_curve(course) {
            return at(self.direction(course));
        }
        // Beside an arc the border is no line. On the normal of either feature the other one is nearer.
        let is_first_nearer = |part: f64| {
            let p = at(self.mix(part));
            self.features[0].segment.distance(p) <= self.features[1].segment.distance(p)
        };
        at(self.mix(bisect([0.0, 1.0], is_first_nearer)))
    }
}

/// Returns the number from which on a condition holds, which holds at the upper end of a range.
fn bisect([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = f64::midpoint(low, high);
        if !(low < middle && middle < high) {
            return high;
        }
        if holds(middle) { high = middle } else { low = middle }
    }
}

/// Returns pairs of points of features, or of the lines and circles that they lie on, that have a common normal. An end
/// of a feature counts as having every normal.
fn normal_pairs(features: &[Quarter]) -> Vec<[MeridianPoint; 2]> {
    let mut pairs = Vec::new();
    let ends: Vec<MeridianPoint> =
        features.iter().flat_map(|feature| feature.segment.ends).collect();
    for (index, feature) in features.iter().enumerate() {
        for end in &ends {
            pairs.extend(normals(feature, *end).map(|point| [*end, point]));
        }
        for other in &features[..index] {
            match (&feature.segment.circle, &other.segment.circle) {
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
fn normals(feature: &Quarter, p: MeridianPoint) -> impl Iterator<Item = MeridianPoint> + use<> {
    let points = match &feature.segment.circle {
        None => [Some(feature.segment.line_point(feature.segment.position(p))), None],
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
fn common(line: &Quarter, circle: &Circle) -> [[MeridianPoint; 2]; 2] {
    let Circle { centre, radius, .. } = *circle;
    let foot = line.segment.line_point(line.segment.position(centre));
    let normal = [-line.segment.along[1], line.segment.along[0]];
    [radius, -radius].map(|radius| [foot, [0, 1].map(|k| centre[k] + radius * normal[k])])
}
