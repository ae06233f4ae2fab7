//! The inside of an outline, as features to which points can be nearest, and the radius to which a ball that touches one
//! feature grows before it touches another.

use crate::geometry::outline::{
    Point, Segment, bounding_box, cross, dot, minus, mirrored_direction, norm, turn,
};
use std::f64::consts::PI;

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

/// A point of a feature, and the unit normal there, which points into the section.
#[derive(Clone, Copy, Debug)]
pub(super) struct FootPoint {
    pub(super) foot: Point,
    pub(super) normal: Point,
}

impl FootPoint {
    /// Returns the point at distance `r` along the normal.
    pub(super) fn at(&self, r: f64) -> Point {
        let ([d, z], [normal_d, normal_z]) = (self.foot, self.normal);
        [d + r * normal_d, z + r * normal_z]
    }
}

/// The obstacle that stops a growing ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Obstacle {
    /// Another feature.
    Feature(usize),
    /// The axis, beyond which the mirror image begins.
    Axis,
    /// The centre of its own arc.
    Centre,
    /// Nothing.
    Far,
}

/// The end of a ball's growth: its radius there, and the obstacle that stops it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    pub(super) radius: f64,
    pub(super) obstacle: Obstacle,
}

/// Tolerance, in sizes, for a contact to count as on a segment near its end.
const COINCIDENCE_FRACTION: f64 = 1e-13;
/// Distance from a smooth joint, relative to the segments' chords, within which rounding decides between its segments.
const JOINT_FRACTION: f64 = 1e-5;

/// An outline with the features of its inside.
pub(crate) struct Section<'o> {
    pub(super) outline: &'o [Segment],
    pub(super) features: Vec<Feature>,
    /// The fan of normals of each corner: the angle of the first normal, and the sweep to the last.
    fans: Vec<[f64; 2]>,
    /// The diagonal of the outline's bounding box.
    pub(super) size: f64,
    /// The largest coordinate or radius of the outline, by which depths are rounded.
    pub(super) largest: f64,
    /// A box of each feature, by centre and half the sides, with a margin above the tolerances of contact.
    boxes: Vec<[Point; 2]>,
}

/// The margin of a feature's box, relative to the section's size.
const BOX_MARGIN_FRACTION: f64 = 10.0 * COINCIDENCE_FRACTION;

impl<'o> Section<'o> {
    pub(super) fn new(outline: &'o [Segment]) -> Section<'o> {
        let [low, high] = bounding_box(outline);
        let size = norm(minus(high, low));
        let radii = outline.iter().filter_map(|segment| Some(segment.round()?.1));
        let largest =
            [low, high].as_flattened().iter().map(|x| x.abs()).chain(radii).fold(0.0, f64::max);
        let (features, fans, boxes) = (Vec::new(), Vec::new(), Vec::new());
        let mut section = Section { outline, features, fans, size, largest, boxes };
        section.find_features();
        section.boxes =
            section.features.iter().map(|feature| section.feature_box(*feature)).collect();
        section
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

    /// Returns whether the box of a feature reaches into a square about a point, given half the square's side.
    pub(super) fn is_box_within(&self, feature: usize, p: Point, distance: f64) -> bool {
        let [centre, half] = self.boxes[feature];
        (p[0] - centre[0]).abs() - half[0] <= distance
            && (p[1] - centre[1]).abs() - half[1] <= distance
    }

    /// Collects the segments of the outline and the reflex corners between them. At the axis the outline meets its own
    /// mirror image, and only half of a corner's fan lies on this side.
    fn find_features(&mut self) {
        let (Some(first), Some(last)) = (self.outline.first(), self.outline.last()) else { return };
        let start = first.tangent(false);
        self.add_corner(None, mirrored_direction(start), start);
        for (index, segment) in self.outline.iter().enumerate() {
            self.features.push(Feature::Piece(index));
            self.fans.push([0.0; 2]);
            let end = segment.tangent(true);
            let next = self.outline.get(index + 1);
            let next =
                next.map_or(mirrored_direction(last.tangent(true)), |next| next.tangent(false));
            self.add_corner(Some(index), end, next);
        }
    }

    fn add_corner(&mut self, previous: Option<usize>, incoming: Point, outgoing: Point) {
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
            Some(piece) => self.outline[piece].ends()[1],
            None => self.outline[0].ends()[0],
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

    /// Returns the segments at a joint of two features without an angle between them, each with the end that is there (0 for
    /// its start, 1 for its end): tangent segments, or a corner and one of its segments. Empty if there is no such joint.
    pub(super) fn smooth_joint(&self, a: usize, b: usize) -> Vec<(usize, usize)> {
        match (self.features[a], self.features[b]) {
            (Feature::Piece(a), Feature::Piece(b)) => {
                let (low, high) = (a.min(b), a.max(b));
                let [before, after] = [low, high].map(|piece| &self.outline[piece]);
                let is_smooth =
                    high == low + 1 && turn(before.tangent(true), after.tangent(false)) == 0.0;
                if is_smooth { vec![(low, 1), (high, 0)] } else { Vec::new() }
            }
            (Feature::Piece(piece), Feature::Corner(previous))
            | (Feature::Corner(previous), Feature::Piece(piece)) => {
                let adjacent = self.adjacent_segments(previous).into_iter().flatten();
                adjacent.filter(|(segment, _)| *segment == piece).collect()
            }
            (Feature::Corner(_), Feature::Corner(_)) => Vec::new(),
        }
    }

    /// Returns the point and normal of a feature at a parameter from 0 to 1, which is linear along a line and in the
    /// angle of an arc or fan.
    pub(super) fn foot_point(&self, feature: usize, t: f64) -> FootPoint {
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let [from, to] = segment.ends();
                match segment.round() {
                    None => {
                        let along = segment.tangent(false);
                        let foot =
                            [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
                        FootPoint { foot, normal: [-along[1], along[0]] }
                    }
                    Some((centre, radius, convex)) => {
                        let [start, sweep] = segment.angles();
                        let (sin, cos) = (start + t * sweep).sin_cos();
                        let foot = [centre[0] + radius * cos, centre[1] + radius * sin];
                        let inward = if convex { -1.0 } else { 1.0 };
                        FootPoint { foot, normal: [inward * cos, inward * sin] }
                    }
                }
            }
            Feature::Corner(previous) => {
                let [from, sweep] = self.fans[feature];
                let (sin, cos) = (from + t * sweep).sin_cos();
                FootPoint { foot: self.corner_at(previous), normal: [cos, sin] }
            }
        }
    }

    /// Returns the parameter of the normal on which a point lies; outside [0, 1] if the feature has no such normal.
    pub(super) fn parameter(&self, feature: usize, p: Point) -> f64 {
        let wrapped_parameter = |from: f64, sweep: f64, offset: Point| {
            let angle = offset[1].atan2(offset[0]) - from;
            // Into the turn about the middle of the sweep, so that points beyond either end stay on their side.
            let wrapped = angle - 2.0 * PI * ((angle - sweep / 2.0) / (2.0 * PI)).round();
            wrapped / sweep
        };
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let [from, to] = segment.ends();
                match segment.round() {
                    None => {
                        let offset = minus(to, from);
                        dot(minus(p, from), offset) / dot(offset, offset)
                    }
                    Some((centre, ..)) => {
                        let [start, sweep] = segment.angles();
                        wrapped_parameter(start, sweep, minus(p, centre))
                    }
                }
            }
            Feature::Corner(previous) => {
                let [from, sweep] = self.fans[feature];
                wrapped_parameter(from, sweep, minus(p, self.corner_at(previous)))
            }
        }
    }

    /// Returns a point's signed distance from a feature's whole line or circle, or its distance from a corner.
    pub(crate) fn depth_at(&self, feature: usize, p: Point) -> f64 {
        match self.features[feature] {
            Feature::Piece(piece) => self.outline[piece].signed(p),
            Feature::Corner(previous) => norm(minus(p, self.corner_at(previous))),
        }
    }

    /// Bounds the difference by which rounding alone may make one of two features the nearer at a point.
    pub(super) fn rounding(&self, [d, z]: Point) -> f64 {
        16.0 * f64::EPSILON * self.largest.max(d.abs()).max(z.abs())
    }

    /// Returns where the growth of a ball that touches a feature at `foot_point` stops.
    pub(super) fn grow_ball(&self, feature: usize, foot_point: &FootPoint) -> Stop {
        let mut stop = Stop { radius: f64::INFINITY, obstacle: Obstacle::Far };
        for obstacle in [Obstacle::Far, Obstacle::Axis, Obstacle::Centre] {
            let radius = self.growth_to(feature, foot_point, obstacle);
            // The arc's own centre counts before another obstacle at the same distance.
            let is_centre = obstacle == Obstacle::Centre && radius.is_finite();
            if radius < stop.radius || (is_centre && radius <= stop.radius) {
                stop = Stop { radius, obstacle };
            }
        }
        for other in 0..self.features.len() {
            // A ball that touches its foot reaches no farther from there than its diameter.
            if other == feature || !self.is_box_within(other, foot_point.foot, 2.0 * stop.radius) {
                continue;
            }
            let radius = self.growth_to_extension(foot_point, other);
            if radius < stop.radius && self.touches(feature, foot_point, other, radius) {
                stop = Stop { radius, obstacle: Obstacle::Feature(other) };
            }
        }
        stop
    }

    /// Returns the radius at which a given obstacle stops the ball; infinite if it never does.
    pub(super) fn growth_to(
        &self,
        feature: usize,
        foot_point: &FootPoint,
        obstacle: Obstacle,
    ) -> f64 {
        match obstacle {
            // The ball meets its mirror image when its centre reaches the axis.
            Obstacle::Axis if foot_point.normal[0] < 0.0 => {
                -foot_point.foot[0] / foot_point.normal[0]
            }
            Obstacle::Centre => match self.features[feature] {
                Feature::Piece(piece) => match self.outline[piece].round() {
                    Some((_, radius, true)) => radius,
                    _ => f64::INFINITY,
                },
                Feature::Corner(_) => f64::INFINITY,
            },
            Obstacle::Far | Obstacle::Axis => f64::INFINITY,
            Obstacle::Feature(other) => {
                let ball_radius = self.growth_to_extension(foot_point, other);
                let is_stopped = ball_radius.is_finite()
                    && self.touches(feature, foot_point, other, ball_radius);
                if is_stopped { ball_radius } else { f64::INFINITY }
            }
        }
    }

    /// Returns the radius at which the ball touches the whole line or circle of another feature, or a corner; infinite
    /// if it never does.
    fn growth_to_extension(&self, foot_point: &FootPoint, other: usize) -> f64 {
        let (p, n) = (foot_point.foot, foot_point.normal);
        let ball_radius = match self.features[other] {
            Feature::Corner(previous) => {
                let offset = minus(self.corner_at(previous), p);
                // The centre `p + r n` is as far from the corner as from `p`.
                dot(offset, offset) / (2.0 * dot(n, offset))
            }
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                match segment.round() {
                    None => {
                        let along = segment.tangent(false);
                        // The centre of a ball of radius `r` at `p + r n` is `r` from the line too: `r = signed(p)
                        // + r n·m`, with `|n - m|² = 2 (1 - n·m)`.
                        let normal_difference = minus(n, [-along[1], along[0]]);
                        2.0 * segment.signed(p) / dot(normal_difference, normal_difference)
                    }
                    Some((centre, radius, convex)) => {
                        let a = minus(p, centre);
                        // `|a + r n| = R - r` for a convex circle and `R + r` for a concave one, squared.
                        let (power, radial) = (radius * radius - dot(a, a), dot(a, n));
                        if convex {
                            power / (2.0 * (radius + radial))
                        } else {
                            -power / (2.0 * (radius - radial))
                        }
                    }
                }
            }
        };
        if ball_radius >= 0.0 { ball_radius } else { f64::INFINITY }
    }

    /// Returns whether the ball of radius `ball_radius` touches the other feature itself, and not only its extension beyond
    /// its ends or the joint of the two features.
    fn touches(
        &self,
        feature: usize,
        foot_point: &FootPoint,
        other: usize,
        ball_radius: f64,
    ) -> bool {
        let middle = foot_point.at(ball_radius);
        let is_within_ends = match self.features[other] {
            // Near the end normals a corner and its segments are equally near, so only the foot points decide.
            Feature::Corner(_) => {
                let slack = COINCIDENCE_FRACTION * self.size;
                self.sector_sides(other).iter().all(|side| side.at(middle) >= -slack)
            }
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let slack = COINCIDENCE_FRACTION * self.size;
                let [start, end] = segment.sector(middle);
                match segment.round() {
                    None => start >= -slack && end >= -slack,
                    Some((centre, radius, convex)) => {
                        let slack = COINCIDENCE_FRACTION * norm(minus(middle, centre)).max(slack);
                        (!convex || ball_radius <= radius * (1.0 + COINCIDENCE_FRACTION))
                            && start >= -slack
                            && end >= -slack
                    }
                }
            }
        };
        is_within_ends && !self.shares_end(feature, foot_point, other)
    }

    /// Returns whether two features touch only where they join, as far as a ball at `foot_point` can tell.
    fn shares_end(&self, feature: usize, foot_point: &FootPoint, other: usize) -> bool {
        // At an angle the two face each other, and a ball may touch both.
        if self.smooth_joint(feature, other).is_empty() {
            return false;
        }
        let [Some(a), Some(b)] = [feature, other].map(|index| self.features[index].piece()) else {
            return true;
        };
        let (low, high) = (&self.outline[a.min(b)], &self.outline[a.max(b)]);
        // Across a tangent joint, only a segment of smaller radius can stop a ball.
        match (self.outline[a].round(), self.outline[b].round()) {
            (Some((_, own, true)), Some((_, radius, true))) if radius < own => {
                let joint = norm(minus(foot_point.foot, low.ends()[1]));
                joint < JOINT_FRACTION * low.chord().min(high.chord())
            }
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;

    /// The boxes of features only spare work.
    #[test]
    fn balls_and_distances_are_those_of_all_features() {
        for tool in library::tools() {
            let Some(profile) = &tool.model.section else { continue };
            let mut section = Section::new(&profile.outline);
            for feature in 0..section.features.len() {
                for k in 0..=20 {
                    let foot_point = section.foot_point(feature, f64::from(k) / 20.0);
                    let stop = section.grow_ball(feature, &foot_point);
                    for p in [0.1, 0.5, 1.0].map(|part| foot_point.at(part * stop.radius)) {
                        let all = section.outline.iter().map(|segment| segment.distance_to(p));
                        let nearest = all.fold(f64::INFINITY, f64::min);
                        assert_eq!(section.nearest(p).1, nearest, "{p:?}");
                    }
                    // With boxes that contain everything, no feature is passed over.
                    let boxes = vec![[[0.0; 2], [f64::INFINITY; 2]]; section.features.len()];
                    let boxes = std::mem::replace(&mut section.boxes, boxes);
                    let expected = section.grow_ball(feature, &foot_point);
                    section.boxes = boxes;
                    assert_eq!(
                        (stop.radius, stop.obstacle),
                        (expected.radius, expected.obstacle),
                        "{} {feature} {k}",
                        tool.model.name
                    );
                }
            }
        }
    }
}
