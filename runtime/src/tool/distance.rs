//! The distance from a point outside a tool to the tool.

use super::{Circle, EnvelopeSlab, ProfileSegment, Symmetry, ToolInfo};
use crate::interval::Interval;

/// A point of the half plane, `[d, z]`.
pub(crate) type MeridianPoint = [f64; 2];

impl ToolInfo {
    /// Returns the distance from a point outside the tool to the tool, in the tool's frame and the file's unit.
    ///
    /// With a profile it is the least distance of the profile's segments in the half plane through the point. Without one it is
    /// a lower bound: the distance from the envelope or, for a solid without an axis, from its box. Both are rounded outward,
    /// to 1e-4 mm for a tool of some centimetres. Rounding is a few units in the last place of the largest coordinate. At a
    /// point inside the result is a distance from the surface, or 0, and says nothing.
    pub fn distance_from_outside(&self, [x, y, z]: [f64; 3]) -> f64 {
        let p = [x.hypot(y), z];
        if !self.outline.is_empty() {
            let distances = self.outline.iter().map(|segment| segment.distance(p));
            return distances.fold(f64::INFINITY, f64::min);
        }
        match &self.symmetry {
            Symmetry::Revolved => {
                let distances = self.envelope.iter().map(|slab| slab.distance(p));
                distances.fold(f64::INFINITY, f64::min)
            }
            Symmetry::Solid { extent: [along_x, along_y] } => {
                let across = along_x.distance(x).hypot(along_y.distance(y));
                across.hypot(self.reach().distance(z))
            }
        }
    }
}

impl Interval {
    /// Returns the distance of a number from the interval.
    fn distance(self, at: f64) -> f64 {
        (self.low - at).max(at - self.high).max(0.0)
    }
}

impl EnvelopeSlab {
    /// Returns the distance of a point of the half plane from the slab.
    fn distance(&self, [d, z]: MeridianPoint) -> f64 {
        (d - self.radius).max(0.0).hypot(Interval::new(self.low, self.high).distance(z))
    }
}

impl ProfileSegment {
    /// Returns the distance of a point of the half plane from the segment.
    fn distance(&self, p: MeridianPoint) -> f64 {
        let [from, to] = [self.from, self.to].map(|end| minus(p, end));
        let nearest_end = norm(from).min(norm(to));
        match &self.circle {
            Some(circle) if self.is_beside_arc(circle, p) => {
                (norm(minus(p, circle.centre)) - circle.radius).abs()
            }
            Some(_) => nearest_end,
            None => {
                let along = minus(self.to, self.from);
                let is_beside = dot(along, from) > 0.0 && dot(along, to) < 0.0;
                if is_beside { (cross(along, from) / norm(along)).abs() } else { nearest_end }
            }
        }
    }

    /// Returns whether the nearest point of an arc's circle is on the arc.
    fn is_beside_arc(&self, circle: &Circle, p: MeridianPoint) -> bool {
        // A concave arc runs clockwise, so its ends are taken in reverse.
        let [first, last] = if circle.convex { [self.from, self.to] } else { [self.to, self.from] };
        let [first, last, out] = [first, last, p].map(|point| minus(point, circle.centre));
        let (after, before) = (cross(first, out) >= 0.0, cross(out, last) >= 0.0);
        // Beyond half a turn the arc is all but the sector from its last end to its first.
        if cross(first, last) >= 0.0 { after && before } else { after || before }
    }
}

pub(crate) fn minus(a: MeridianPoint, b: MeridianPoint) -> MeridianPoint {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn dot(a: MeridianPoint, b: MeridianPoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: MeridianPoint, b: MeridianPoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the length of a vector, of any size: neither its square nor a tiny one's is out of range.
fn norm([d, z]: MeridianPoint) -> f64 {
    d.hypot(z)
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
                let arc = ProfileSegment::arc(ends, circle, 0);
                for radius in [0.5, 3.0] {
                    for beside in [0.0, 0.5, 1.0] {
                        let p = at(10.0 + beside * turn, radius);
                        assert!((arc.distance(p) - (radius - 2.0f64).abs()).abs() < 1e-14);
                    }
                    for (beyond, end) in [(-20.0, 0.0), (turn + 20.0, turn)] {
                        let p = at(10.0 + beyond, radius);
                        let expected = norm(minus(p, at(10.0 + end, 2.0)));
                        assert!((arc.distance(p) - expected).abs() < 1e-14, "{turn} {beyond}");
                    }
                }
            }
        }
    }
}
