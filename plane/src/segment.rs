//! Lines and arcs.

use crate::vector::{Point, angle_between, cross, dot, minus, norm, turned, unit};
use std::f64::consts::TAU;

/// The angle up to which an arc's ends, or an end and a quarter of the circle, are one: rounding may have exchanged their angles.
pub const ANGLE_ROUNDING: f64 = 1e-9;

/// The circle of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The centre, as `[d, z]`.
    pub centre: Point,
    /// The radius.
    pub radius: f64,
    /// True if the tool lies inside the circle; the arc then runs counter-clockwise.
    pub convex: bool,
}

impl Circle {
    /// Returns the circle of an arc that bulges out of the tool.
    pub const fn convex(centre: Point, radius: f64) -> Circle {
        Circle { centre, radius, convex: true }
    }

    /// Returns the circle of an arc that bulges into the tool.
    pub const fn concave(centre: Point, radius: f64) -> Circle {
        Circle { centre, radius, convex: false }
    }

    /// Returns the angle from one point to another in the sense of the arc, from 0 to a full turn.
    pub fn turn_between(&self, from: Point, to: Point) -> f64 {
        let angle = angle_between(minus(from, self.centre), minus(to, self.centre));
        let turn = if self.convex { angle } else { -angle };
        if turn < 0.0 { turn + TAU } else { turn }
    }
}

/// A line or an arc of a profile, with the tool on its left. Distances, nearest points and sectors are those of arcs of at most half a turn, of
/// which [`Segment::halves`] makes any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The start and the end.
    pub ends: [Point; 2],
    /// The unit vector from end to end; if the ends coincide that of [`Segment::line_through`], or 0.
    pub along: Point,
    /// The distance between the ends.
    pub chord: f64,
    /// The circle of an arc; `None` for a line.
    pub circle: Option<Circle>,
    /// The index of the surface that it belongs to.
    pub surface: usize,
}

/// A point of a segment.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The point.
    pub point: Point,
    /// The unit direction of travel there.
    pub along: Point,
}

impl Place {
    /// Returns the unit normal out of the tool.
    pub fn outward(&self) -> Point {
        [self.along[1], -self.along[0]]
    }
}

impl Segment {
    /// Returns a segment of a surface. Both ends of an arc are on its circle, but for rounding.
    pub fn new(ends: [Point; 2], circle: Option<Circle>, surface: usize) -> Segment {
        let vector = minus(ends[1], ends[0]);
        let chord = norm(vector);
        let along = if chord > 0.0 { vector.map(|part| part / chord) } else { [0.0; 2] };
        Segment { ends, along, chord, circle, surface }
    }

    /// Returns the segment, or an arc of more than half a turn as two arcs.
    pub fn halves(self) -> impl Iterator<Item = Segment> {
        let is_wide = self.circle.is_some_and(|Circle { centre, convex, .. }| {
            let [from, to] = self.ends.map(|end| minus(end, centre));
            let sine = if convex { cross(from, to) } else { cross(to, from) };
            sine < -ANGLE_ROUNDING * dot(from, to).abs()
        });
        let [from, to] = self.ends;
        let half = |ends: [Point; 2]| Segment::new(ends, self.circle, self.surface);
        let halves = match is_wide.then(|| self.place(0.5).point) {
            Some(middle) => [half([from, middle]), half([middle, to])],
            None => [self; 2],
        };
        halves.into_iter().take(1 + usize::from(is_wide))
    }

    /// Returns a line of length 0 through a point, with a unit vector along it.
    pub fn line_through(point: Point, along: Point, surface: usize) -> Segment {
        Segment { ends: [point; 2], along, chord: 0.0, circle: None, surface }
    }

    /// Returns the angle that an arc turns by, above 0 if it runs counter-clockwise; 0 for a line, and for an arc whose ends coincide.
    pub fn turn(&self) -> f64 {
        let Some(circle) = self.circle else { return 0.0 };
        let turn = circle.turn_between(self.ends[0], self.ends[1]);
        // Rounding may have exchanged ends that coincide.
        let turn = if turn < TAU - ANGLE_ROUNDING { turn } else { 0.0 };
        if circle.convex { turn } else { -turn }
    }

    /// Returns the length along the segment.
    pub fn length(&self) -> f64 {
        self.circle.map_or(self.chord, |circle| circle.radius * self.turn().abs())
    }

    /// Returns the place at a fraction of the length, from 0 to 1.
    pub fn place(&self, fraction: f64) -> Place {
        let Some(Circle { centre, .. }) = self.circle else {
            let at = fraction * self.chord;
            return Place { point: self.line_point(at), along: self.along };
        };
        let angle = fraction * self.turn();
        let [d, z] = turned(minus(self.ends[0], centre), angle);
        Place { point: [centre[0] + d, centre[1] + z], along: turned(self.tangent(0), angle) }
    }

    /// Returns places at equal steps from the start to the end, one more than `steps`. The first and the last point are the ends.
    pub fn places(&self, steps: usize) -> impl Iterator<Item = Place> {
        (0..=steps).map(move |k| {
            let place = self.place(k as f64 / steps as f64);
            match k {
                0 => Place { point: self.ends[0], ..place },
                _ if k == steps => Place { point: self.ends[1], ..place },
                _ => place,
            }
        })
    }

    /// Returns the position of a point's foot along the line, from the start.
    #[inline]
    pub fn position(&self, p: Point) -> f64 {
        dot(self.along, minus(p, self.ends[0]))
    }

    /// Returns the point of the line at a position.
    #[inline]
    pub fn line_point(&self, at: f64) -> Point {
        [0, 1].map(|k| self.ends[0][k] + at * self.along[k])
    }

    /// Returns the position at which the line reaches a height.
    pub fn position_at_height(&self, z: f64) -> f64 {
        (z - self.ends[0][1]) / self.along[1]
    }

    /// Returns the distance of the line from the axis at a height, also beyond its ends.
    pub fn line_radius_at(&self, z: f64) -> f64 {
        let slope = self.along[0] / self.along[1];
        self.ends[0][0] + slope * (z - self.ends[0][1])
    }

    /// Returns the unit direction of travel at its start (0) or end (1).
    pub fn tangent(&self, end: usize) -> Point {
        let Some(Circle { centre, convex, .. }) = self.circle else { return self.along };
        let [d, z] = unit(minus(self.ends[end], centre));
        if convex { [-z, d] } else { [z, -d] }
    }

    /// Returns the unit normal into the tool at the foot of a point on the whole line or circle; NaN in the centre.
    pub fn inward(&self, p: Point) -> Point {
        match self.circle {
            None => [-self.along[1], self.along[0]],
            Some(Circle { centre, convex: true, .. }) => unit(minus(centre, p)),
            Some(Circle { centre, convex: false, .. }) => unit(minus(p, centre)),
        }
    }

    /// Returns the signed distance of a point from the whole line or circle, above 0 on the tool's side; of a line whose ends coincide always 0.
    #[inline]
    pub fn signed_distance(&self, p: Point) -> f64 {
        match self.circle {
            None => cross(self.along, minus(p, self.ends[0])),
            Some(Circle { centre, radius, convex: true }) => radius - norm(minus(p, centre)),
            Some(Circle { centre, radius, convex: false }) => norm(minus(p, centre)) - radius,
        }
    }

    /// Returns the distances of a point past the normal at the start and ahead of the normal at the end of a line, or of an arc of
    /// at most half a turn. Both are at least 0 where the nearest point of the segment is not one of its ends.
    pub fn sector(&self, p: Point) -> [f64; 2] {
        let [from, to] = self.ends;
        match self.circle {
            None => [dot(self.along, minus(p, from)), dot(self.along, minus(to, p))],
            Some(Circle { centre, radius, convex }) => {
                let [from, to, out] = [from, to, p].map(|point| minus(point, centre));
                let sides = [cross(from, out) / radius, cross(out, to) / radius];
                if convex { sides } else { sides.map(|side| -side) }
            }
        }
    }

    /// Returns whether the foot of a point on an arc's circle lies on the arc.
    #[inline]
    pub fn is_beside_arc(&self, circle: &Circle, p: Point) -> bool {
        let [from, to] = self.ends.map(|end| minus(end, circle.centre));
        let out = minus(p, circle.centre);
        let (first, last) = (cross(from, out), cross(out, to));
        if circle.convex { first >= 0.0 && last >= 0.0 } else { first <= 0.0 && last <= 0.0 }
    }

    /// Returns the nearest point of the segment; in the centre of an arc, its start.
    #[inline]
    pub fn foot(&self, p: Point) -> Point {
        match &self.circle {
            None => {
                let at = self.position(p);
                if at <= 0.0 {
                    self.ends[0]
                } else if at >= self.chord {
                    self.ends[1]
                } else {
                    self.line_point(at)
                }
            }
            Some(circle) if self.is_beside_arc(circle, p) => {
                let out = minus(p, circle.centre);
                let length = norm(out);
                if length > 0.0 {
                    [0, 1].map(|k| circle.centre[k] + circle.radius * (out[k] / length))
                } else {
                    self.ends[0]
                }
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| minus(p, end));
                self.ends[usize::from(dot(to, to) < dot(from, from))]
            }
        }
    }

    /// Returns the distance of a point from the segment.
    #[inline]
    pub fn distance(&self, p: Point) -> f64 {
        match &self.circle {
            None => {
                let off = minus(p, self.ends[0]);
                let at = dot(self.along, off);
                if at <= 0.0 {
                    norm(off)
                } else if at >= self.chord {
                    norm(minus(p, self.ends[1]))
                } else {
                    cross(self.along, off).abs()
                }
            }
            Some(circle) if self.is_beside_arc(circle, p) => {
                (norm(minus(p, circle.centre)) - circle.radius).abs()
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| minus(p, end));
                dot(from, from).min(dot(to, to)).sqrt()
            }
        }
    }

    /// Returns the box about the segment by its lowest and highest coordinates.
    pub fn bounding_box(&self) -> [Point; 2] {
        let [from, to] = self.ends;
        let (mut low, mut high) =
            ([0, 1].map(|k| from[k].min(to[k])), [0, 1].map(|k| from[k].max(to[k])));
        for half in self.halves() {
            let Some(circle @ Circle { centre, radius, .. }) = &half.circle else { break };
            for axis in [0, 1] {
                let [mut lowest, mut highest] = [*centre; 2];
                lowest[axis] -= radius;
                highest[axis] += radius;
                if half.is_beside_arc(circle, lowest) {
                    low[axis] = low[axis].min(lowest[axis]);
                }
                if half.is_beside_arc(circle, highest) {
                    high[axis] = high[axis].max(highest[axis]);
                }
            }
        }
        [low, high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on rays from the centre of a circle of radius 2 about (5, 1), beside and beyond arcs of 90°, 180° and 270°.
    #[test]
    fn arcs_are_as_far_as_their_nearest_point() {
        let at = |degrees: f64, radius: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            [5.0 + radius * cosine, 1.0 + radius * sine]
        };
        for turn in [90.0, 180.0, 270.0] {
            for convex in [true, false] {
                let ends = if convex {
                    [at(10.0, 2.0), at(10.0 + turn, 2.0)]
                } else {
                    [at(10.0 + turn, 2.0), at(10.0, 2.0)]
                };
                let circle = Circle { centre: [5.0, 1.0], radius: 2.0, convex };
                let arc = Segment::new(ends, Some(circle), 0);
                let distance = |p: Point| {
                    arc.halves().map(|half| half.distance(p)).fold(f64::INFINITY, f64::min)
                };
                for radius in [0.5, 3.0] {
                    for beside in [0.0, 0.5, 1.0] {
                        let p = at(10.0 + beside * turn, radius);
                        assert!((distance(p) - (radius - 2.0f64).abs()).abs() < 1e-14);
                    }
                    for (beyond, end) in [(-20.0, 0.0), (turn + 20.0, turn)] {
                        let p = at(10.0 + beyond, radius);
                        let expected = norm(minus(p, at(10.0 + end, 2.0)));
                        assert!((distance(p) - expected).abs() < 1e-14, "{turn} {beyond}");
                    }
                }
            }
        }
    }
}
