//! The normals of a profile's features, which drawings follow to the borders of the cells.

use super::section::{COINCIDENCE_FRACTION, Feature, Section};
use crate::geometry::outline::{Point, dot, minus, norm};
use crate::model::Model;
use std::f64::consts::PI;
use touchoff_plane::Circle;

/// Distance from a smooth joint, relative to the segments' chords, within which rounding decides between its segments.
const JOINT_FRACTION: f64 = 1e-5;

/// What ends a normal in the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalEnd {
    /// The cell of another feature.
    Feature(usize),
    /// The axis.
    Axis,
    /// The centre of the feature's own arc.
    Centre,
}

/// The normal at a point of a feature, up to the end of its cell.
#[derive(Clone, Copy, Debug)]
pub struct Normal {
    /// The point of the feature.
    pub foot: Point,
    /// The last point of the cell.
    pub end: Point,
    /// What is there.
    pub at_end: NormalEnd,
}

/// A point of a feature, and the unit normal there, which points into the section.
#[derive(Clone, Copy, Debug)]
struct FootPoint {
    foot: Point,
    normal: Point,
}

impl FootPoint {
    /// Returns the point at distance `r` along the normal.
    fn at(&self, r: f64) -> Point {
        let ([d, z], [normal_d, normal_z]) = (self.foot, self.normal);
        [d + r * normal_d, z + r * normal_z]
    }
}

/// The features of a profile, in the order of the tool's regions.
#[allow(missing_debug_implementations)]
pub struct Features<'m>(Section<'m>);

impl<'m> Features<'m> {
    /// Returns the features of a tool whose regions are their cells; `None` if regions are written by hand or smoothed.
    pub fn of(model: &'m Model) -> Option<Features<'m>> {
        let profile = model.profile.as_ref().filter(|profile| profile.over.is_none())?;
        Some(Features(profile.inner.section()))
    }

    /// Returns the index of each feature's segment; `None` for a reflex corner.
    pub fn segments(&self) -> impl Iterator<Item = Option<usize>> {
        self.0.features.iter().map(|feature| feature.piece())
    }

    /// Returns the parameter of a feature's normal through a point; outside [0, 1] if there is none.
    pub fn parameter(&self, feature: usize, p: Point) -> f64 {
        self.0.parameter(feature, p)
    }

    /// Returns the normal at a parameter from 0 to 1, exclusively.
    pub fn normal(&self, feature: usize, parameter: f64) -> Normal {
        let foot_point = self.0.foot_point(feature, parameter);
        let (length, at_end) = self.0.grow_ball(feature, &foot_point);
        // Nothing in the section is farther away than its size.
        let [d, z] = foot_point.at(length.min(self.0.size));
        Normal { foot: foot_point.foot, end: [d.max(0.0), z], at_end }
    }
}

impl Section<'_> {
    /// Returns the point and normal of a feature at a parameter from 0 to 1, which is linear along a line and in the
    /// angle of an arc or fan.
    fn foot_point(&self, feature: usize, t: f64) -> FootPoint {
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let place = segment.geometry.place(t);
                FootPoint { foot: place.point, normal: place.outward().map(|part| -part) }
            }
            Feature::Corner(previous) => {
                let [from, sweep] = self.fans[feature];
                let (sin, cos) = (from + t * sweep).sin_cos();
                FootPoint { foot: self.corner_at(previous), normal: [cos, sin] }
            }
        }
    }

    /// Returns the parameter of the normal on which a point lies; outside [0, 1] if the feature has no such normal.
    fn parameter(&self, feature: usize, p: Point) -> f64 {
        let wrapped_parameter = |from: f64, sweep: f64, offset: Point| {
            let angle = offset[1].atan2(offset[0]) - from;
            // Into the turn about the middle of the sweep, so that points beyond either end stay on their side.
            let wrapped = angle - 2.0 * PI * ((angle - sweep / 2.0) / (2.0 * PI)).round();
            wrapped / sweep
        };
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let [from, to] = segment.geometry.ends;
                match segment.geometry.circle {
                    None => {
                        let offset = minus(to, from);
                        dot(minus(p, from), offset) / dot(offset, offset)
                    }
                    Some(Circle { centre, .. }) => {
                        let [d, z] = minus(from, centre);
                        wrapped_parameter(z.atan2(d), segment.geometry.turn(), minus(p, centre))
                    }
                }
            }
            Feature::Corner(previous) => {
                let [from, sweep] = self.fans[feature];
                wrapped_parameter(from, sweep, minus(p, self.corner_at(previous)))
            }
        }
    }

    /// Returns the radius to which a ball grows that touches a feature at `foot_point`, and what stops it.
    fn grow_ball(&self, feature: usize, foot_point: &FootPoint) -> (f64, NormalEnd) {
        let FootPoint { foot, normal } = *foot_point;
        // The ball meets its mirror image when its centre reaches the axis.
        let to_axis = if normal[0] < 0.0 { -foot[0] / normal[0] } else { f64::INFINITY };
        let circle =
            self.features[feature].piece().and_then(|piece| self.outline[piece].geometry.circle);
        let to_centre = match circle {
            Some(Circle { radius, convex: true, .. }) => radius,
            _ => f64::INFINITY,
        };
        // The arc's own centre counts before another obstacle at the same distance.
        let mut stop = if to_axis < to_centre {
            (to_axis, NormalEnd::Axis)
        } else {
            (to_centre, NormalEnd::Centre)
        };
        for other in 0..self.features.len() {
            // A ball that touches its foot reaches no farther from there than its diameter.
            if other == feature || !self.is_box_within(other, foot, 2.0 * stop.0) {
                continue;
            }
            let radius = self.growth_to_extension(foot_point, other);
            if radius < stop.0 && self.touches(feature, foot_point, other, radius) {
                stop = (radius, NormalEnd::Feature(other));
            }
        }
        stop
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
                match segment.geometry.circle {
                    None => {
                        let along = segment.geometry.tangent(0);
                        // The centre of a ball of radius `r` at `p + r n` is `r` from the line too: `r = signed(p)
                        // + r n·m`, with `|n - m|² = 2 (1 - n·m)`.
                        let normal_difference = minus(n, [-along[1], along[0]]);
                        2.0 * segment.geometry.signed_distance(p)
                            / dot(normal_difference, normal_difference)
                    }
                    Some(Circle { centre, radius, convex }) => {
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
                let [start, end] = segment.geometry.sector(middle);
                match segment.geometry.circle {
                    None => start >= -slack && end >= -slack,
                    Some(Circle { centre, radius, convex }) => {
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
        if self.smooth_joint(feature, other).is_none() {
            return false;
        }
        let [Some(a), Some(b)] = [feature, other].map(|index| self.features[index].piece()) else {
            return true;
        };
        let (low, high) = (&self.outline[a.min(b)], &self.outline[a.max(b)]);
        // Across a tangent joint, only a segment of smaller radius can stop a ball.
        match (self.outline[a].geometry.circle, self.outline[b].geometry.circle) {
            (
                Some(Circle { radius: own, convex: true, .. }),
                Some(Circle { radius, convex: true, .. }),
            ) if radius < own => {
                let joint = norm(minus(foot_point.foot, low.geometry.ends[1]));
                joint < JOINT_FRACTION * low.geometry.chord.min(high.geometry.chord)
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
            let Some(profile) = &tool.model.profile else { continue };
            let mut section = Section::new(&profile.outline);
            for feature in 0..section.features.len() {
                for k in 0..=20 {
                    let foot_point = section.foot_point(feature, f64::from(k) / 20.0);
                    let (length, end) = section.grow_ball(feature, &foot_point);
                    for p in [0.1, 0.5, 1.0].map(|part| foot_point.at(part * length)) {
                        let all =
                            section.outline.iter().map(|segment| segment.geometry.distance(p));
                        let nearest = all.fold(f64::INFINITY, f64::min);
                        assert_eq!(section.nearest(p).1, nearest, "{p:?}");
                    }
                    // With boxes that contain everything, no feature is passed over.
                    let boxes = vec![[[0.0; 2], [f64::INFINITY; 2]]; section.features.len()];
                    let boxes = std::mem::replace(&mut section.boxes, boxes);
                    let expected = section.grow_ball(feature, &foot_point);
                    section.boxes = boxes;
                    assert_eq!((length, end), expected, "{} {feature} {k}", tool.model.name);
                }
            }
        }
    }
}
