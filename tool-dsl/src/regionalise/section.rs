//! The inside of an outline, as features to which points can be nearest.

use super::cover::HalfPlane;
use crate::geometry::outline::{
    Point, Segment, bounding_box, cross, dot, minus, mirrored_direction, norm, turn,
};

/// A feature to which a point can be nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// A segment, by its index in the outline.
    Piece(usize),
    /// The reflex corner at the end of a segment; for `None`, the one before the first segment.
    Corner(Option<usize>),
}

impl Feature {
    /// Returns the index of a segment.
    pub(super) fn piece(self) -> Option<usize> {
        match self {
            Feature::Piece(piece) => Some(piece),
            Feature::Corner(_) => None,
        }
    }
}

/// Tolerance, in sizes, for a contact to count as on a segment near its end.
pub(super) const COINCIDENCE_FRACTION: f64 = 1e-13;

/// An outline with the features of its inside.
#[derive(Clone, Debug)]
pub(crate) struct Section<'o> {
    pub(super) outline: &'o [Segment],
    pub(super) features: Vec<Feature>,
    /// The fan of normals of each corner: the angle of the first normal, and the sweep to the last.
    pub(super) fans: Vec<[f64; 2]>,
    /// The diagonal of the outline's bounding box.
    pub(super) size: f64,
    /// The largest coordinate or radius of the outline, by which depths are rounded.
    pub(super) largest: f64,
    /// A box of each feature, by centre and half the sides, with a margin above the tolerances of contact.
    pub(super) boxes: Vec<[Point; 2]>,
    /// The sides of the normals at each feature's ends toward the feature.
    sides: Vec<Vec<HalfPlane>>,
}

/// The margin of a feature's box, relative to the section's size.
const BOX_MARGIN_FRACTION: f64 = 10.0 * COINCIDENCE_FRACTION;

impl<'o> Section<'o> {
    pub(super) fn new(outline: &'o [Segment]) -> Section<'o> {
        let [low, high] = bounding_box(outline);
        let size = norm(minus(high, low));
        let radii = outline.iter().filter_map(|segment| Some(segment.geometry.circle?.radius));
        let largest =
            [low, high].as_flattened().iter().map(|x| x.abs()).chain(radii).fold(0.0, f64::max);
        let (features, fans, boxes, sides) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut section = Section { outline, features, fans, size, largest, boxes, sides };
        section.find_features();
        let features = section.features.iter();
        section.boxes = features.clone().map(|feature| section.feature_box(*feature)).collect();
        section.sides = features.map(|feature| section.sides_of(*feature)).collect();
        section
    }

    /// Returns the features, in the order of the outline.
    pub(crate) fn features(&self) -> &[Feature] {
        &self.features
    }

    /// Returns the features that are segments, each with the segment's index.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (usize, usize)> {
        let pieces = self.features.iter().enumerate();
        pieces.filter_map(|(feature, kind)| Some((feature, kind.piece()?)))
    }

    /// Returns the box of a feature by its centre and half its sides.
    fn feature_box(&self, feature: Feature) -> [Point; 2] {
        let [low, high] = match feature {
            Feature::Piece(piece) => bounding_box(&self.outline[piece..=piece]),
            Feature::Corner(previous) => [self.corner_at(previous); 2],
        };
        let centre = [0, 1].map(|k| low[k] / 2.0 + high[k] / 2.0);
        let half = [0, 1].map(|k| (high[k] - low[k]) / 2.0 + BOX_MARGIN_FRACTION * self.size);
        [centre, half]
    }

    /// Returns the sides of the normals at a feature's ends toward the feature.
    pub(super) fn sector_sides(&self, feature: usize) -> &[HalfPlane] {
        &self.sides[feature]
    }

    /// Returns whether the box of a feature reaches into a square about a point, given half the square's side.
    pub(super) fn is_box_within(&self, feature: usize, p: Point, distance: f64) -> bool {
        let [centre, half] = self.boxes[feature];
        (p[0] - centre[0]).abs() - half[0] <= distance
            && (p[1] - centre[1]).abs() - half[1] <= distance
    }

    /// Returns an upper bound of a point's distance from the outline: beyond the far corner of the nearest box.
    pub(super) fn reach(&self, p: Point) -> f64 {
        let to_corners = self.boxes.iter().map(|[centre, half]| {
            (p[0] - centre[0]).abs() + half[0] + (p[1] - centre[1]).abs() + half[1]
        });
        to_corners.fold(f64::INFINITY, f64::min) + self.tolerance()
    }

    /// Returns the directions of the outline before and after the end of a segment; for `None`, before and after the first one.
    /// At the axis the outline meets its own mirror image.
    pub(super) fn directions_at(&self, previous: Option<usize>) -> [Point; 2] {
        let before = previous.map(|piece| self.outline[piece].geometry.tangent(1));
        let after = self.outline.get(previous.map_or(0, |piece| piece + 1));
        let after = after.map(|segment| segment.geometry.tangent(0));
        let at_axis = before.or(after).map_or([0.0; 2], mirrored_direction);
        [before.unwrap_or(at_axis), after.unwrap_or(at_axis)]
    }

    /// Collects the segments of the outline and the reflex corners between them. At the axis only half of a corner's fan lies on
    /// this side.
    fn find_features(&mut self) {
        self.add_corner(None);
        for index in 0..self.outline.len() {
            self.features.push(Feature::Piece(index));
            self.fans.push([0.0; 2]);
            self.add_corner(Some(index));
        }
    }

    fn add_corner(&mut self, previous: Option<usize>) {
        let [incoming, outgoing] = self.directions_at(previous);
        // At a convex corner, or none, a segment is always nearer than the corner.
        if turn(incoming, outgoing) >= 0.0 {
            return;
        }
        let normal = [-incoming[1], incoming[0]];
        let mut from = normal[1].atan2(normal[0]);
        let mut sweep = cross(incoming, outgoing).atan2(dot(incoming, outgoing));
        // On the axis the other half of the fan belongs to the mirror image.
        if previous.is_none() {
            (from, sweep) = (from + sweep / 2.0, sweep / 2.0);
        } else if previous == Some(self.outline.len() - 1) {
            sweep /= 2.0;
        }
        self.features.push(Feature::Corner(previous));
        self.fans.push([from, sweep]);
    }

    /// Returns the position of a corner.
    pub(super) fn corner_at(&self, previous: Option<usize>) -> Point {
        match previous {
            Some(piece) => self.outline[piece].geometry.ends[1],
            None => self.outline[0].geometry.ends[0],
        }
    }

    /// Returns the segments that end in a corner, each with the end that does: 0 for its start, 1 for its end.
    pub(super) fn adjacent_segments(&self, previous: Option<usize>) -> [Option<(usize, usize)>; 2] {
        match previous {
            None => [None, Some((0, 0))],
            Some(piece) => {
                let next = (piece + 1 < self.outline.len()).then_some((piece + 1, 0));
                [Some((piece, 1)), next]
            }
        }
    }

    /// Returns whether a segment goes on from the one before it without an angle.
    pub(super) fn is_smooth_start(&self, piece: usize) -> bool {
        let (Some(before), Some(after)) = (piece.checked_sub(1), self.outline.get(piece)) else {
            return false;
        };
        turn(self.outline[before].geometry.tangent(1), after.geometry.tangent(0)) == 0.0
    }

    /// Returns the segment at a joint of two features without an angle between them, with the end that is there (0 for
    /// its start, 1 for its end): of tangent segments the first, of a corner and a segment that. `None` without such a joint.
    pub(super) fn smooth_joint(&self, a: usize, b: usize) -> Option<(usize, usize)> {
        match (self.features[a], self.features[b]) {
            (Feature::Piece(a), Feature::Piece(b)) => {
                let (low, high) = (a.min(b), a.max(b));
                (high == low + 1 && self.is_smooth_start(high)).then_some((low, 1))
            }
            (Feature::Piece(piece), Feature::Corner(previous))
            | (Feature::Corner(previous), Feature::Piece(piece)) => {
                let mut adjacent = self.adjacent_segments(previous).into_iter().flatten();
                adjacent.find(|(segment, _)| *segment == piece)
            }
            (Feature::Corner(_), Feature::Corner(_)) => None,
        }
    }

    /// Returns the direction of a feature that is a straight segment.
    pub(super) fn line_direction(&self, feature: usize) -> Option<Point> {
        let segment = &self.outline[self.features[feature].piece()?];
        segment.circle.is_none().then(|| segment.geometry.tangent(0))
    }

    /// Returns a point's signed distance from a feature's whole line or circle, or its distance from a corner.
    pub(crate) fn depth_at(&self, feature: usize, p: Point) -> f64 {
        match self.features[feature] {
            Feature::Piece(piece) => self.outline[piece].geometry.signed_distance(p),
            Feature::Corner(previous) => norm(minus(p, self.corner_at(previous))),
        }
    }
}
