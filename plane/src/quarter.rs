//! Monotone segments: lines, and arcs of at most a quarter of their circle between a horizontal and a vertical tangent.

use crate::bounds::{Triangle, below_tangents, max3};
use crate::segment::{ANGLE_ROUNDING, Circle, Segment};
use crate::vector::{Point, cross, minus, norm};

/// The distance from the axis, in the tool's size, up to which an arc's centre is that of a ball about the axis.
const MAX_BALL_OFFSET: f64 = 1e-9;

impl Segment {
    /// Returns the line itself, or the line that touches a convex arc at its middle; `None` for a concave arc.
    pub fn tangent_line(&self) -> Option<Segment> {
        match self.circle {
            None => Some(*self),
            Some(Circle { centre, radius, convex: true }) => {
                let out = [self.along[1], -self.along[0]];
                let touch = [0, 1].map(|k| centre[k] + radius * out[k]);
                Some(Segment::line_through(touch, self.along, self.surface))
            }
            Some(_) => None,
        }
    }

    /// Returns the segment in monotone pieces: an arc is cut where its tangent is horizontal or vertical.
    pub fn quarters(&self) -> Vec<Segment> {
        let Some(circle) = self.circle else { return vec![*self] };
        let Circle { centre, radius, .. } = circle;
        let turn = self.turn().abs();
        let mut cuts: Vec<(f64, Point)> =
            [[radius, 0.0], [0.0, radius], [-radius, 0.0], [0.0, -radius]]
                .into_iter()
                .map(|[d, z]| [centre[0] + d, centre[1] + z])
                .map(|cut| (circle.turn_between(self.ends[0], cut), cut))
                // Cuts at the ends do not count. An arc that exceeds a quarter by so little reaches beyond its end by
                // `radius (1 - cos 1e-9)`, 5e-19 of the radius, which is less than the rounding error of its centre and
                // radius.
                .filter(|(at, _)| *at >= ANGLE_ROUNDING && *at < turn - ANGLE_ROUNDING)
                .collect();
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut from = self.ends[0];
        cuts.into_iter()
            .map(|(_, cut)| cut)
            .chain([self.ends[1]])
            .map(|to| {
                let ends = [std::mem::replace(&mut from, to), to];
                Segment::new(ends, Some(circle), self.surface)
            })
            .collect()
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

    /// Returns the distance from the axis at a height between its ends.
    pub fn radius_at(&self, z: f64) -> f64 {
        let [[d0, z0], [d1, z1]] = self.ends;
        if z == z0 || z == z1 {
            return if z == z0 { d0 } else { d1 };
        }
        let radius = match self.circle {
            None => d0 + (d1 - d0) * ((z - z0) / (z1 - z0)),
            Some(Circle { centre, radius, convex }) => {
                let side = if convex { self.side_sign() } else { -self.side_sign() };
                let up = z - centre[1];
                centre[0] + side * ((radius - up) * (radius + up)).max(0.0).sqrt()
            }
        };
        // A monotone piece stays between its ends, whatever the rounding.
        radius.clamp(d0.min(d1), d0.max(d1))
    }

    /// Returns a ball about a point of the axis that contains the circle of a convex arc whose centre is near the
    /// axis, as height and radius. `size` is the tool's size. The ball contains the circle whatever the distance of
    /// its centre from the axis. Returns `None` beyond [`MAX_BALL_OFFSET`], where it is not tight enough to be useful,
    /// and for balls so large that `f32` loses all precision.
    pub fn ball(&self, size: f64) -> Option<[f64; 2]> {
        let Circle { centre: [d, z], radius, convex } = self.circle?;
        let small = radius.max(z.abs()) <= 4.0 * size;
        (convex && small && d.abs() <= MAX_BALL_OFFSET * size).then_some([z, radius + d.abs()])
    }

    /// Returns the signed distance of a point on the tool's side of the segment, for points between its heights: at
    /// least 0 just inside. A convex arc is continued horizontally into the tool, a concave one out of it.
    #[inline]
    pub fn continued_distance(&self, p: Point) -> f64 {
        let Some(Circle { centre, radius, convex }) = self.circle else {
            return cross(self.along, minus(p, self.ends[0]));
        };
        let [d, z] = minus(p, centre);
        let d = self.side_sign() * d;
        if convex {
            radius - norm([d.max(0.0), z])
        } else if d <= 0.0 {
            norm([d, z]) - radius
        } else {
            z.abs() - radius - d
        }
    }

    /// Returns the gradient of [`Segment::continued_distance`].
    pub fn continued_gradient(&self, p: Point) -> Point {
        let Some(Circle { centre, convex, .. }) = self.circle else {
            return [-self.along[1], self.along[0]];
        };
        let sense = self.side_sign();
        let [d, z] = minus(p, centre);
        let d = sense * d;
        let vector = if convex { [-d.max(0.0), -z] } else { [d, z] };
        let length = norm(vector);
        let [d, z] = if (!convex && d > 0.0) || length == 0.0 {
            [-1.0, 0.0]
        } else {
            vector.map(|part| part / length)
        };
        [sense * d, z]
    }

    /// Returns the gradient of [`Segment::distance`].
    pub fn distance_gradient(&self, p: Point) -> Point {
        let vector = minus(p, self.foot(p));
        let length = norm(vector);
        if length > 0.0 { vector.map(|part| part / length) } else { self.continued_gradient(p) }
    }

    /// Returns an upper bound of [`Segment::continued_distance`] over a triangle.
    #[inline]
    pub fn max_continued_distance(&self, triangle: &Triangle) -> f64 {
        match &self.circle {
            // Tangents that touch on the tool's side bound nothing: the tool continues there.
            Some(circle) if circle.convex => {
                let sense = self.side_sign();
                below_tangents(circle, triangle, |[d, z]| [sense * (sense * d).max(0.0), z])
            }
            // Linear, or convex where it is at least 0.
            _ => max3(triangle.map(|p| self.continued_distance(p))),
        }
    }

    /// Returns whether [`Segment::continued_distance`] is the signed distance from the segment at all points of a triangle: their
    /// feet are in the range `from` to `to` along the line, or on the arc.
    #[inline]
    pub fn projects_onto(&self, triangle: &Triangle, [from, to]: [f64; 2]) -> bool {
        match &self.circle {
            None => triangle.iter().all(|p| (from..=to).contains(&self.position(*p))),
            Some(circle) => self.all_in_sector(circle, triangle),
        }
    }

    /// Returns 1 if the tool is toward the axis, -1 if it is away from it.
    fn side_sign(&self) -> f64 {
        if self.ends[1][1] < self.ends[0][1] { -1.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The end of the arc is an ulp before its beginning, as rounding may leave it.
    #[test]
    fn an_arc_as_short_as_rounding_is_no_full_circle() {
        let (from, to) = ([5.0, 0.3], [5.0, 0.3f64.next_down()]);
        for convex in [true, false] {
            let (from, to) = if convex { (from, to) } else { (to, from) };
            let circle = Some(Circle { centre: [3.0, 0.1], radius: 2.0_f64.hypot(0.2), convex });
            assert_eq!(Segment::new([from, to], circle, 0).quarters().len(), 1);
        }
    }
}
