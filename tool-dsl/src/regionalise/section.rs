//! One side of an outline, as features to which points can be nearest, and the radius to which a ball that touches one
//! feature grows before it touches another.

use crate::geometry::outline::{Point, Segment, cross, dot, minus, norm, reach, turn};
use std::f64::consts::PI;

/// A feature to which a point can be nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// A segment, by its index in the outline.
    Piece(usize),
    /// The reflex corner at the end of a segment; for `None`, the one before the first segment.
    Corner(Option<usize>),
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
        [0, 1].map(|k| self.foot[k] + r * self.normal[k])
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
    /// Nothing within the outer limit, outside the solid.
    Far,
}

/// The outer limit of the partition of the outside, in sizes of the outline.
const FAR: f64 = 64.0;
/// Tolerance, in sizes, for a contact to count as on a segment near its end.
const CLOSE: f64 = 1e-13;
/// Distance from a smooth joint, relative to the segments' chords, within which rounding decides between its segments.
const JOINT: f64 = 1e-5;

/// An outline whose left side is partitioned, with the features of that side.
pub(super) struct Section<'o> {
    pub(super) outline: &'o [Segment],
    pub(super) features: Vec<Feature>,
    /// The fan of normals of each corner: the angle of the first normal, and the sweep to the last.
    fans: Vec<[f64; 2]>,
    /// The diagonal of the outline's bounding box.
    pub(super) size: f64,
    /// True if the left side is the outside, which is unbounded.
    outer: bool,
}

impl<'o> Section<'o> {
    pub(super) fn new(outline: &'o [Segment], outer: bool) -> Section<'o> {
        let [low, high] = reach(outline);
        let size = norm(minus(high, low));
        let mut section = Section { outline, features: Vec::new(), fans: Vec::new(), size, outer };
        section.find_features();
        section
    }

    /// Collects the segments of the outline and the reflex corners between them. At the axis the outline meets its own
    /// mirror image, and only half of a corner's fan lies on this side.
    fn find_features(&mut self) {
        let mirrored = |t: Point| [t[0], -t[1]];
        let (Some(first), Some(last)) = (self.outline.first(), self.outline.last()) else { return };
        let start = first.tangent(false);
        self.meet(None, mirrored(start), start);
        for (index, segment) in self.outline.iter().enumerate() {
            self.features.push(Feature::Piece(index));
            self.fans.push([0.0; 2]);
            let end = segment.tangent(true);
            let next = self.outline.get(index + 1);
            let next = next.map_or(mirrored(last.tangent(true)), |next| next.tangent(false));
            self.meet(Some(index), end, next);
        }
    }

    fn meet(&mut self, behind: Option<usize>, incoming: Point, outgoing: Point) {
        if turn(incoming, outgoing) >= 0.0 {
            return;
        }
        let normal = [-incoming[1], incoming[0]];
        let mut from = normal[1].atan2(normal[0]);
        let mut sweep = cross(incoming, outgoing).atan2(dot(incoming, outgoing));
        if behind.is_none() {
            (from, sweep) = (from + sweep / 2.0, sweep / 2.0);
        } else if behind == Some(self.outline.len() - 1) {
            sweep /= 2.0;
        }
        self.features.push(Feature::Corner(behind));
        self.fans.push([from, sweep]);
    }

    /// Returns the position of a corner.
    pub(super) fn corner_at(&self, behind: Option<usize>) -> Point {
        match behind {
            Some(piece) => self.outline[piece].ends()[1],
            None => self.outline[0].ends()[0],
        }
    }

    /// Returns the segments that end in a corner, each with the end that does: 0 for its start, 1 for its end.
    pub(super) fn beside(&self, behind: Option<usize>) -> [Option<(usize, usize)>; 2] {
        match behind {
            None => [None, Some((0, 0))],
            Some(piece) => {
                let next = (piece + 1 < self.outline.len()).then_some((piece + 1, 0));
                [Some((piece, 1)), next]
            }
        }
    }

    /// Returns the point and normal of a feature at a parameter from 0 to 1, which is linear along a line and in the
    /// angle of an arc or fan.
    pub(super) fn seat(&self, feature: usize, t: f64) -> FootPoint {
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let [from, to] = segment.ends();
                match segment.round() {
                    None => {
                        let along = segment.tangent(false);
                        let foot = [0, 1].map(|k| from[k] + t * (to[k] - from[k]));
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
            Feature::Corner(behind) => {
                let [from, sweep] = self.fans[feature];
                let (sin, cos) = (from + t * sweep).sin_cos();
                FootPoint { foot: self.corner_at(behind), normal: [cos, sin] }
            }
        }
    }

    /// Returns the parameter of the normal on which a point lies; outside [0, 1] if the feature has no such normal.
    pub(super) fn parameter(&self, feature: usize, p: Point) -> f64 {
        let turned = |from: f64, sweep: f64, way: Point| {
            let angle = way[1].atan2(way[0]) - from;
            let wrapped = angle - 2.0 * PI * ((angle - sweep / 2.0) / (2.0 * PI)).round();
            wrapped / sweep
        };
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let [from, to] = segment.ends();
                match segment.round() {
                    None => {
                        let way = minus(to, from);
                        dot(minus(p, from), way) / dot(way, way)
                    }
                    Some((centre, ..)) => {
                        let [start, sweep] = segment.angles();
                        turned(start, sweep, minus(p, centre))
                    }
                }
            }
            Feature::Corner(behind) => {
                let [from, sweep] = self.fans[feature];
                turned(from, sweep, minus(p, self.corner_at(behind)))
            }
        }
    }

    /// Returns a point's signed distance from a feature's whole line or circle, or its distance from a corner.
    pub(super) fn depth_at(&self, feature: usize, p: Point) -> f64 {
        match self.features[feature] {
            Feature::Piece(piece) => self.outline[piece].signed(p),
            Feature::Corner(behind) => norm(minus(p, self.corner_at(behind))),
        }
    }

    /// Returns the radius to which a ball that touches a feature at `seat` grows, and the obstacle that stops it.
    pub(super) fn growth(&self, feature: usize, seat: &FootPoint) -> (f64, Obstacle) {
        let (mut most, mut stop) = (f64::INFINITY, Obstacle::Far);
        for other in [Obstacle::Far, Obstacle::Axis, Obstacle::Centre] {
            let grown = self.grown(feature, seat, other);
            if grown < most || (other == Obstacle::Centre && grown <= most && grown.is_finite()) {
                (most, stop) = (grown, other);
            }
        }
        for other in 0..self.features.len() {
            if other != feature {
                let grown = self.reach(seat, other);
                if grown < most && self.touches(feature, seat, other, grown) {
                    (most, stop) = (grown, Obstacle::Feature(other));
                }
            }
        }
        (most, stop)
    }

    /// Returns the radius at which a given obstacle stops the ball; infinite if it never does.
    pub(super) fn grown(&self, feature: usize, seat: &FootPoint, stop: Obstacle) -> f64 {
        match stop {
            Obstacle::Far if self.outer => FAR * self.size,
            Obstacle::Axis if seat.normal[0] < 0.0 => -seat.foot[0] / seat.normal[0],
            Obstacle::Centre => match self.features[feature] {
                Feature::Piece(piece) => match self.outline[piece].round() {
                    Some((_, radius, true)) => radius,
                    _ => f64::INFINITY,
                },
                Feature::Corner(_) => f64::INFINITY,
            },
            Obstacle::Far | Obstacle::Axis => f64::INFINITY,
            Obstacle::Feature(other) => {
                let grown = self.reach(seat, other);
                let stops = grown.is_finite() && self.touches(feature, seat, other, grown);
                if stops { grown } else { f64::INFINITY }
            }
        }
    }

    /// Returns the radius at which the ball touches the whole line or circle of another feature, or a corner; infinite
    /// if it never does.
    fn reach(&self, seat: &FootPoint, other: usize) -> f64 {
        let (p, n) = (seat.foot, seat.normal);
        let grown = match self.features[other] {
            Feature::Corner(behind) => {
                let way = minus(self.corner_at(behind), p);
                dot(way, way) / (2.0 * dot(n, way))
            }
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                match segment.round() {
                    None => {
                        let along = segment.tangent(false);
                        let apart = minus(n, [-along[1], along[0]]);
                        2.0 * segment.signed(p) / dot(apart, apart)
                    }
                    Some((centre, radius, convex)) => {
                        let a = minus(p, centre);
                        let (off, out) = (radius * radius - dot(a, a), dot(a, n));
                        if convex {
                            off / (2.0 * (radius + out))
                        } else {
                            -off / (2.0 * (radius - out))
                        }
                    }
                }
            }
        };
        if grown >= 0.0 { grown } else { f64::INFINITY }
    }

    /// Returns whether the ball of radius `grown` touches the other feature itself, and not only its extension beyond
    /// its ends or the joint of the two features.
    fn touches(&self, feature: usize, seat: &FootPoint, other: usize, grown: f64) -> bool {
        let middle = seat.at(grown);
        let within = match self.features[other] {
            Feature::Corner(behind) => self.in_fan(behind, middle),
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let slack = CLOSE * self.size;
                let [start, end] = segment.sector(middle);
                match segment.round() {
                    None => start >= -slack && end >= -slack,
                    Some((centre, radius, convex)) => {
                        let slack = CLOSE * norm(minus(middle, centre)).max(slack);
                        (!convex || grown <= radius * (1.0 + CLOSE))
                            && start >= -slack
                            && end >= -slack
                    }
                }
            }
        };
        within && !self.shares_end(feature, seat, other)
    }

    /// Returns whether a point lies between the end normals of the segments at a corner. Near these normals a corner
    /// and its segments are equally near, so only the foot points decide.
    fn in_fan(&self, behind: Option<usize>, p: Point) -> bool {
        let off = minus(p, self.corner_at(behind));
        self.beside(behind).into_iter().flatten().all(|(piece, end)| {
            let past = dot(off, self.outline[piece].tangent(end == 1));
            let past = if end == 1 { past } else { -past };
            past >= -CLOSE * self.size
        })
    }

    /// Returns whether two features touch only where they join, as far as a ball at `seat` can tell.
    fn shares_end(&self, feature: usize, seat: &FootPoint, other: usize) -> bool {
        let joins = |piece: usize, behind: Option<usize>| {
            self.beside(behind).into_iter().flatten().any(|(beside, _)| beside == piece)
        };
        match (self.features[feature], self.features[other]) {
            (Feature::Piece(piece), Feature::Corner(behind))
            | (Feature::Corner(behind), Feature::Piece(piece)) => joins(piece, behind),
            (Feature::Piece(a), Feature::Piece(b)) if a.abs_diff(b) == 1 => {
                let (low, high) = (&self.outline[a.min(b)], &self.outline[a.max(b)]);
                if turn(low.tangent(true), high.tangent(false)) != 0.0 {
                    return false;
                }
                // Across a tangent joint, only a segment of smaller radius can stop a ball.
                match (self.outline[a].round(), self.outline[b].round()) {
                    (Some((_, own, true)), Some((_, radius, true))) if radius < own => {
                        let joint = norm(minus(seat.foot, low.ends()[1]));
                        joint < JOINT * low.chord().min(high.chord())
                    }
                    _ => true,
                }
            }
            _ => false,
        }
    }
}
