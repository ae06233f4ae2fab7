//! One side of an outline, as features that points of it can be nearest to, and how far a ball that
//! leaves one feature grows before it touches another.

use crate::geometry::outline::{Point, Segment, cross, dot, minus, norm, reach, turn};
use std::f64::consts::PI;

/// What a point can be nearest to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// A piece, by its place in the outline.
    Piece(usize),
    /// The reflex corner behind a piece; before the first for `None`.
    Corner(Option<usize>),
}

/// A point of a feature and the unit normal there, into the section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat {
    pub(super) foot: Point,
    pub(super) normal: Point,
}

impl Seat {
    /// The point so far along the normal.
    pub(super) fn at(&self, r: f64) -> Point {
        [0, 1].map(|k| self.foot[k] + r * self.normal[k])
    }
}

/// What stops a growing ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// Another feature.
    Feature(usize),
    /// The axis, behind which the mirror image begins.
    Axis,
    /// The centre of its own arc.
    Centre,
    /// Nothing within reach, outside the solid.
    Far,
}

/// How far outside points are looked at, in sizes of the outline.
const FAR: f64 = 64.0;
/// Contacts this close to a piece's end, in sizes, are on the piece.
const CLOSE: f64 = 1e-13;
/// This close to a smooth joint, in lengths, rounding decides between its pieces.
const JOINT: f64 = 1e-5;

/// An outline whose left side is asked about, with its features there.
pub(super) struct Section<'o> {
    pub(super) outline: &'o [Segment],
    pub(super) features: Vec<Feature>,
    /// The sweep of each corner's fan: the angle of its first normal, and the turn to its last.
    fans: Vec<[f64; 2]>,
    /// The diagonal of the outline's box.
    pub(super) size: f64,
    /// Whether the left side is the outside, which has no end.
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

    /// The pieces along the outline and the reflex corners between them. At the axis the outline
    /// meets its own mirror image, and only half of a fan is on this side.
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

    /// Where a corner is.
    pub(super) fn corner_at(&self, behind: Option<usize>) -> Point {
        match behind {
            Some(piece) => self.outline[piece].ends()[1],
            None => self.outline[0].ends()[0],
        }
    }

    /// The pieces that end in a corner, and which end it is.
    pub(super) fn beside(&self, behind: Option<usize>) -> [Option<(usize, usize)>; 2] {
        match behind {
            None => [None, Some((0, 0))],
            Some(piece) => {
                let next = (piece + 1 < self.outline.len()).then_some((piece + 1, 0));
                [Some((piece, 1)), next]
            }
        }
    }

    /// The point and normal of a feature at a parameter from 0 to 1: along a line, or by the angle.
    pub(super) fn seat(&self, feature: usize, t: f64) -> Seat {
        match self.features[feature] {
            Feature::Piece(piece) => {
                let segment = &self.outline[piece];
                let [from, to] = segment.ends();
                match segment.round() {
                    None => {
                        let along = segment.tangent(false);
                        let foot = [0, 1].map(|k| from[k] + t * (to[k] - from[k]));
                        Seat { foot, normal: [-along[1], along[0]] }
                    }
                    Some((centre, radius, convex)) => {
                        let [start, sweep] = segment.angles();
                        let (sin, cos) = (start + t * sweep).sin_cos();
                        let foot = [centre[0] + radius * cos, centre[1] + radius * sin];
                        let inward = if convex { -1.0 } else { 1.0 };
                        Seat { foot, normal: [inward * cos, inward * sin] }
                    }
                }
            }
            Feature::Corner(behind) => {
                let [from, sweep] = self.fans[feature];
                let (sin, cos) = (from + t * sweep).sin_cos();
                Seat { foot: self.corner_at(behind), normal: [cos, sin] }
            }
        }
    }

    /// The parameter of the seat that a point is on the normal of, if there is one.
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

    /// A point's signed distance to a feature's whole line or circle, or to a corner.
    pub(super) fn depth_at(&self, feature: usize, p: Point) -> f64 {
        match self.features[feature] {
            Feature::Piece(piece) => self.outline[piece].signed(p),
            Feature::Corner(behind) => norm(minus(p, self.corner_at(behind))),
        }
    }

    /// How far a ball that touches a feature in a seat grows, and what stops it.
    pub(super) fn growth(&self, feature: usize, seat: &Seat) -> (f64, Stop) {
        let (mut most, mut stop) = (f64::INFINITY, Stop::Far);
        for other in [Stop::Far, Stop::Axis, Stop::Centre] {
            let grown = self.grown(feature, seat, other);
            if grown < most || (other == Stop::Centre && grown <= most && grown.is_finite()) {
                (most, stop) = (grown, other);
            }
        }
        for other in 0..self.features.len() {
            if other != feature {
                let grown = self.reach(seat, other);
                if grown < most && self.touches(feature, seat, other, grown) {
                    (most, stop) = (grown, Stop::Feature(other));
                }
            }
        }
        (most, stop)
    }

    /// How far the ball grows until something stops it; infinite if that never does.
    pub(super) fn grown(&self, feature: usize, seat: &Seat, stop: Stop) -> f64 {
        match stop {
            Stop::Far if self.outer => FAR * self.size,
            Stop::Axis if seat.normal[0] < 0.0 => -seat.foot[0] / seat.normal[0],
            Stop::Centre => match self.features[feature] {
                Feature::Piece(piece) => match self.outline[piece].round() {
                    Some((_, radius, true)) => radius,
                    _ => f64::INFINITY,
                },
                Feature::Corner(_) => f64::INFINITY,
            },
            Stop::Far | Stop::Axis => f64::INFINITY,
            Stop::Feature(other) => {
                let grown = self.reach(seat, other);
                let stops = grown.is_finite() && self.touches(feature, seat, other, grown);
                if stops { grown } else { f64::INFINITY }
            }
        }
    }

    /// How far the ball grows until it touches the whole line or circle of another feature.
    fn reach(&self, seat: &Seat, other: usize) -> f64 {
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

    /// Whether the ball that has grown so far touches a feature itself, and not only beyond its ends
    /// or where the two join.
    fn touches(&self, feature: usize, seat: &Seat, other: usize, grown: f64) -> bool {
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

    /// Whether a point is between the normals of a corner's pieces. A corner and its pieces are as
    /// near as one another all about their border, which only the feet tell.
    fn in_fan(&self, behind: Option<usize>, p: Point) -> bool {
        let off = minus(p, self.corner_at(behind));
        self.beside(behind).into_iter().flatten().all(|(piece, end)| {
            let past = dot(off, self.outline[piece].tangent(end == 1));
            let past = if end == 1 { past } else { -past };
            past >= -CLOSE * self.size
        })
    }

    /// Whether two features only touch where they join, as far as a ball in this seat can tell.
    fn shares_end(&self, feature: usize, seat: &Seat, other: usize) -> bool {
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
                // Of two pieces without a turn between them only a rounder one can stop a ball.
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
