//! Quarters: a profile's lines, and pieces of its arcs that are monotone. Upper and lower bounds of distances over polygons: at the corners, for a
//! function that is convex (an upper bound) or concave (a lower one).

use crate::certify::space::MeridianPoint;
use touchoff_plane::{ANGLE_ROUNDING, Circle, Segment, cross, dot, minus, norm};

/// The distance from the axis, in the tool's size, up to which an arc's centre is that of a ball about the axis.
const MAX_BALL_OFFSET: f64 = 1e-9;

/// The radius of a ball, and the height of its centre, in the tool's size, beyond which `f32` loses its surface.
pub(crate) const MAX_BALL: f64 = 4.0;

/// The angle, in radians, up to which quarters meet nearly in line.
const MAX_TURN_IN_LINE: f64 = 1.0 / 16.0;

/// Three points. In a triangle that encloses a curve between two ends, the third is the apex.
pub(crate) type Triangle = [MeridianPoint; 3];

/// A line of a profile, or a piece of an arc, of at most a quarter of its circle, between a horizontal and a vertical tangent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quarter {
    pub(crate) segment: Segment,
}

fn min3([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

fn max3([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}

impl Quarter {
    /// Returns the quarters of a segment: an arc is cut where its tangent is horizontal or vertical.
    pub(crate) fn of(segment: Segment) -> Vec<Quarter> {
        let Some(circle) = segment.circle else { return vec![Quarter { segment }] };
        let Circle { centre, radius, .. } = circle;
        let turn = segment.turn().abs();
        let mut cuts: Vec<(f64, MeridianPoint)> =
            [[radius, 0.0], [0.0, radius], [-radius, 0.0], [0.0, -radius]]
                .into_iter()
                .map(|[d, z]| [centre[0] + d, centre[1] + z])
                .map(|cut| (circle.turn_between(segment.ends[0], cut), cut))
                // Cuts at the ends do not count. An arc that exceeds a quarter by so little reaches beyond its end by
                // `radius (1 - cos 1e-9)`, 5e-19 of the radius, which is less than the rounding error of its centre and
                // radius.
                .filter(|(at, _)| *at >= ANGLE_ROUNDING && *at < turn - ANGLE_ROUNDING)
                .collect();
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut from = segment.ends[0];
        cuts.into_iter()
            .map(|(_, cut)| cut)
            .chain([segment.ends[1]])
            .map(|to| {
                let ends = [std::mem::replace(&mut from, to), to];
                Quarter { segment: Segment::new(ends, Some(circle), segment.surface) }
            })
            .collect()
    }

    /// Returns the line itself, or the line that touches a convex arc at its middle; `None` for a concave arc.
    pub(crate) fn tangent_line(&self) -> Option<Segment> {
        match self.segment.circle {
            None => Some(self.segment),
            Some(Circle { centre, radius, convex: true }) => {
                let out = [self.segment.along[1], -self.segment.along[0]];
                let touch = [0, 1].map(|k| centre[k] + radius * out[k]);
                Some(Segment::line_through(touch, self.segment.along, self.segment.surface))
            }
            Some(_) => None,
        }
    }

    /// Returns the distance from the axis at a height between its ends.
    pub(crate) fn radius_at(&self, z: f64) -> f64 {
        let [[d0, z0], [d1, z1]] = self.segment.ends;
        if z == z0 || z == z1 {
            return if z == z0 { d0 } else { d1 };
        }
        let radius = match self.segment.circle {
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

    /// Returns a ball about a point of the axis that contains the circle of a convex arc whose centre is near the axis, as height and radius.
    /// `size` is the tool's size. The ball contains the circle whatever the distance of its centre from the axis. Returns `None` where it would be
    /// too large for `f32`, or not tight enough to be useful.
    pub(crate) fn ball(&self, size: f64) -> Option<[f64; 2]> {
        let Circle { centre: [d, z], radius, convex } = self.segment.circle?;
        let small = radius.max(z.abs()) <= MAX_BALL * size;
        (convex && small && d.abs() <= MAX_BALL_OFFSET * size).then_some([z, radius + d.abs()])
    }

    /// Returns the signed distance of a point on the tool's side of the segment, for points between its heights: at
    /// least 0 just inside. A convex arc is continued horizontally into the tool, a concave one out of it.
    #[inline]
    pub(crate) fn continued_distance(&self, p: MeridianPoint) -> f64 {
        let Some(Circle { centre, radius, convex }) = self.segment.circle else {
            return cross(self.segment.along, minus(p, self.segment.ends[0]));
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

    /// Returns the gradient of [`Quarter::continued_distance`]; on the continuation of a concave arc, of its part across the axis alone.
    pub(crate) fn continued_gradient(&self, p: MeridianPoint) -> MeridianPoint {
        let Some(Circle { centre, convex, .. }) = self.segment.circle else {
            return [-self.segment.along[1], self.segment.along[0]];
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
    pub(crate) fn distance_gradient(&self, p: MeridianPoint) -> MeridianPoint {
        let vector = minus(p, self.segment.foot(p));
        let length = norm(vector);
        if length > 0.0 { vector.map(|part| part / length) } else { self.continued_gradient(p) }
    }

    /// Returns an upper bound of [`Quarter::continued_distance`] over a triangle.
    #[inline]
    pub(crate) fn max_continued_distance(&self, triangle: &Triangle) -> f64 {
        match &self.segment.circle {
            // Tangents that touch on the tool's side bound nothing: the tool continues there.
            Some(circle) if circle.convex => {
                let sense = self.side_sign();
                below_tangents(circle, triangle, |[d, z]| [sense * (sense * d).max(0.0), z])
            }
            // Linear, or convex where it is at least 0.
            _ => max3(triangle.map(|p| self.continued_distance(p))),
        }
    }

    /// Returns whether [`Quarter::continued_distance`] is the signed distance from the segment at all points of a triangle: their
    /// feet are in the range `from` to `to` along the line, or on the arc.
    #[inline]
    pub(crate) fn projects_onto(&self, triangle: &Triangle, [from, to]: [f64; 2]) -> bool {
        match &self.segment.circle {
            None => triangle.iter().all(|p| (from..=to).contains(&self.segment.position(*p))),
            Some(circle) => self.all_in_sector(circle, triangle),
        }
    }

    /// Returns whether another segment, which begins where this one ends, turns by little there.
    pub(crate) fn continues_in(&self, other: &Quarter) -> bool {
        let [one, other] = [self.segment.tangent(1), other.segment.tangent(0)];
        dot(one, other) > 0.0 && cross(one, other).abs() < MAX_TURN_IN_LINE
    }

    /// Returns the ends that may be the nearest points of the segment to points of a polygon. Returns `None` if the
    /// nearest point may be elsewhere.
    pub(crate) fn nearest_ends(&self, corners: &[MeridianPoint]) -> Option<[bool; 2]> {
        let [first, last] = self.segment.ends;
        // Beyond an end of a line or, as seen from the centre, of an arc, the nearest point is an end. A neighbour that comes nearer
        // from there is told by the same product.
        let [backward, forward] = [self.segment.tangent(0).map(|d| -d), self.segment.tangent(1)];
        let is_beyond = corners.iter().all(|p| dot(backward, minus(*p, first)) > 0.0)
            || corners.iter().all(|p| dot(forward, minus(*p, last)) > 0.0);
        if !is_beyond {
            return None;
        }
        // The bisector of the ends tells which of them is the nearer one.
        let middle = [0, 1].map(|k| f64::midpoint(first[k], last[k]));
        let positions = corners.iter().map(|p| dot(self.segment.along, minus(*p, middle)));
        if positions.clone().all(|at| -at > 0.0) {
            Some([true, false])
        } else if positions.clone().all(|at| at > 0.0) {
            Some([false, true])
        } else {
            Some([true, true])
        }
    }

    /// Returns an upper bound of the distances of a triangle's points.
    #[inline]
    pub(crate) fn max_distance(&self, triangle: &Triangle) -> f64 {
        match &self.segment.circle {
            // The distance from a convex set is convex.
            None => max3(triangle.map(|p| self.segment.distance(p))),
            Some(circle) if self.all_in_sector(circle, triangle) => {
                let out = max3(triangle.map(|p| norm(minus(p, circle.centre)) - circle.radius));
                out.max(below_tangents(circle, triangle, |n| n))
            }
            Some(_) => {
                let [from, to] =
                    self.segment.ends.map(|end| max3(triangle.map(|p| norm(minus(p, end)))));
                from.min(to)
            }
        }
    }

    /// Returns a lower bound of the distances of a triangle's points.
    #[inline]
    pub(crate) fn min_distance(&self, triangle: &Triangle) -> f64 {
        let [first, second, middle] = *triangle;
        // A distance has the Lipschitz constant 1.
        let reach = norm(minus(first, middle)).max(norm(minus(second, middle)));
        let coarse = self.segment.distance(middle) - reach;
        if let Some(Circle { centre, radius, convex: false }) = self.segment.circle {
            // Measured from inside the circle; from beyond it only an end is near.
            return coarse.max(min3(triangle.map(|p| radius - norm(minus(p, centre)))));
        }
        let nearer = if self.segment.distance(first) < self.segment.distance(second) {
            first
        } else {
            second
        };
        coarse.max(self.separation(triangle, middle)).max(self.separation(triangle, nearer))
    }

    /// Returns whether this segment is farther than another from every point of a polygon, by more than a margin.
    pub(crate) fn is_farther<const N: usize>(
        &self,
        other: &Quarter,
        corners: &[MeridianPoint; N],
        margin: f64,
    ) -> bool {
        is_above_everywhere(self.lower_bounds(corners), other.upper_bounds(corners), margin)
    }

    /// Returns numbers for the corners of a polygon of which any convex combination is at most the distance of the same combination of the
    /// corners. They are the distances for a line whose strip holds the polygon on one side.
    pub(crate) fn lower_bounds<const N: usize>(&self, corners: &[MeridianPoint; N]) -> [f64; N] {
        let centre = mean(corners);
        match &self.segment.circle {
            // The distance from a convex set is at least that from a line which separates the two, whatever its direction.
            None => {
                let away = minus(centre, self.segment.foot(centre));
                let length = norm(away);
                if length == 0.0 {
                    return [0.0; N];
                }
                let [from, to] = self.segment.ends.map(|end| dot(away, end));
                corners.map(|p| (dot(away, p) - from.max(to)) / length)
            }
            // An arc is no nearer than its circle: of the two lower bounds inside and outside of it one is concave, and the
            // other is at least its tangent.
            Some(Circle { centre: middle, radius, .. }) => {
                let out = minus(centre, *middle);
                let length = norm(out);
                if length < *radius {
                    corners.map(|p| radius - norm(minus(p, *middle)))
                } else {
                    corners.map(|p| dot(out, minus(p, *middle)) / length - radius)
                }
            }
        }
    }

    /// Returns numbers for the corners of a polygon of which any convex combination is at least the distance of the same combination of the
    /// corners. They are the distances for a line.
    pub(crate) fn upper_bounds<const N: usize>(&self, corners: &[MeridianPoint; N]) -> [f64; N] {
        let Some(circle @ Circle { centre: middle, radius, .. }) = &self.segment.circle else {
            return corners.map(|p| self.segment.distance(p));
        };
        let centre = mean(corners);
        if corners.iter().all(|corner| self.segment.is_beside_arc(circle, *corner)) {
            let out = minus(centre, *middle);
            let length = norm(out);
            let along = |p: MeridianPoint| {
                if length > 0.0 { dot(out, minus(p, *middle)) / length } else { 0.0 }
            };
            if corners.iter().all(|corner| norm(minus(*corner, *middle)) <= *radius) {
                return corners.map(|p| radius - along(p));
            }
            if corners.iter().all(|corner| along(*corner) >= *radius) {
                return corners.map(|p| norm(minus(p, *middle)) - radius);
            }
        }
        let [from, to] = self.segment.ends.map(|end| norm(minus(centre, end)));
        let nearer = self.segment.ends[usize::from(to < from)];
        corners.map(|p| norm(minus(p, nearer)))
    }

    /// Returns whether the distances of two segments differ by at most `margin` at every point of a polygon.
    pub(crate) fn is_as_far_as<const N: usize>(
        &self,
        other: &Quarter,
        corners: &[MeridianPoint; N],
        margin: f64,
    ) -> bool {
        let is_within = |one: &Quarter, other: &Quarter| {
            let mut bounds = one.upper_bounds(corners).into_iter().zip(other.lower_bounds(corners));
            bounds.all(|(upper, lower)| upper - lower <= margin)
        };
        is_within(self, other) && is_within(other, self)
    }

    /// Returns the signed distance of a triangle beyond the line that touches the segment on the side of `viewpoint`,
    /// normal to the direction of `viewpoint` from its foot; 0 if `viewpoint` is on the segment.
    #[inline]
    fn separation(&self, triangle: &Triangle, viewpoint: MeridianPoint) -> f64 {
        let vector = minus(viewpoint, self.segment.foot(viewpoint));
        let length = norm(vector);
        if length == 0.0 {
            return 0.0;
        }
        let [from, to] = self.segment.ends.map(|end| dot(vector, end));
        let max_dot = match &self.segment.circle {
            Some(circle)
                if self
                    .segment
                    .is_beside_arc(circle, [0, 1].map(|k| circle.centre[k] + vector[k])) =>
            {
                dot(vector, circle.centre) + circle.radius * length
            }
            _ => from.max(to),
        };
        (min3(triangle.map(|p| dot(vector, p))) - max_dot) / length
    }

    fn all_in_sector(&self, circle: &Circle, triangle: &Triangle) -> bool {
        triangle.iter().all(|p| self.segment.is_beside_arc(circle, *p))
    }

    /// Returns 1 if the tool is toward the axis, -1 if it is away from it.
    fn side_sign(&self) -> f64 {
        if self.segment.ends[1][1] < self.segment.ends[0][1] { -1.0 } else { 1.0 }
    }
}

/// Returns whether lower bounds of one segment's distance at the corners of a polygon are greater than upper bounds of another's
/// by more than a margin: affine less convex is concave, and least at a corner.
pub(crate) fn is_above_everywhere<const N: usize>(
    lower: [f64; N],
    upper: [f64; N],
    margin: f64,
) -> bool {
    lower.into_iter().zip(upper).all(|(lower, upper)| lower - upper > margin)
}

/// Returns the mean of the corners of a polygon.
pub(crate) fn mean(corners: &[MeridianPoint]) -> MeridianPoint {
    [0, 1].map(|k| corners.iter().map(|corner| corner[k]).sum::<f64>() / corners.len() as f64)
}

/// Returns an upper bound of the depth of a triangle's points inside a circle. No point is deeper than under any
/// tangent. The tangents taken are at the feet of the end that is farther inside and of the apex, in the
/// directions that `touching` derives from theirs.
#[inline]
fn below_tangents(
    circle: &Circle,
    triangle: &Triangle,
    touching: impl Fn(MeridianPoint) -> MeridianPoint,
) -> f64 {
    let out = triangle.map(|p| minus(p, circle.centre));
    let deeper = usize::from(dot(out[1], out[1]) < dot(out[0], out[0]));
    let [end, apex] = [out[deeper], out[2]].map(|foot| {
        let n = touching(foot);
        let length = norm(n);
        if length > 0.0 {
            circle.radius - min3(out.map(|v| dot(n, v))) / length
        } else {
            // The centre itself has no direction; nothing is deeper than the radius.
            circle.radius
        }
    });
    end.min(apex)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The square about (1, 2) is at least 1.515 from the arc and at most 1.05 from the line, that about (7, 3) at least 3.95
    /// and at most 0.55.
    #[test]
    fn an_arc_is_farther_than_a_line_beside_it() {
        let circle = Some(Circle { centre: [0.0, 3.0], radius: 3.0, convex: true });
        let [from, to] = [[0.0, 0.0], [3.0, 3.0]];
        let arc = Quarter { segment: Segment::new([from, to], circle, 0) };
        for (centre, beside, margin) in [([1.0, 2.0], 2.0, 0.4), ([7.0, 3.0], 6.5, 3.0)] {
            let line = Quarter { segment: Segment::new([[beside, 0.0], [beside, 6.0]], None, 0) };
            let corners = [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]
                .map(|off| [0, 1].map(|k| centre[k] + off[k]));
            assert!(arc.is_farther(&line, &corners, margin), "{centre:?}");
        }
    }

    /// Rounding moves the foot of the middle along the line. A line through both would be tilted, over so wide and thin a triangle by
    /// more than the error of a distance.
    #[test]
    fn a_line_that_is_nearer_at_a_corner_is_not_farther() {
        let bottom = Quarter { segment: Segment::new([[0.0, 0.0], [50.0, 0.0]], None, 0) };
        let top = Quarter { segment: Segment::new([[50.0, 0.01], [0.0, 0.01]], None, 0) };
        let corners = [
            [1.229_026_647_031_889, 0.004_999_999_982_607_259],
            [34.446_196_190_199_394, 0.005_000_000_003_054_599],
            [17.837_611_418_615_64, 0.004_999_999_992_830_929],
        ];
        assert!(top.segment.distance(corners[1]) < bottom.segment.distance(corners[1]) - 6e-12);
        assert!(!top.is_farther(&bottom, &corners, 4.26e-12));
    }

    /// Both the nearer end of an edge and the apex are the arc's centre, whose depth is the radius.
    #[test]
    fn the_centre_of_an_arc_is_as_deep_as_its_radius() {
        let circle = Some(Circle { centre: [2.0, 2.0], radius: 2.0, convex: true });
        let [from, to] = [[2.0, 0.0], [4.0, 2.0]];
        let arc = Quarter { segment: Segment::new([from, to], circle, 0) };
        assert!(arc.max_distance(&[[2.0, 2.0], [3.0, 2.0], [2.0, 2.0]]) >= 2.0);
    }

    /// The end of the arc is an ulp before its beginning, as rounding may leave it.
    #[test]
    fn an_arc_as_short_as_rounding_is_no_full_circle() {
        let (from, to) = ([5.0, 0.3], [5.0, 0.3f64.next_down()]);
        for convex in [true, false] {
            let (from, to) = if convex { (from, to) } else { (to, from) };
            let circle = Some(Circle { centre: [3.0, 0.1], radius: 2.0_f64.hypot(0.2), convex });
            assert_eq!(Quarter::of(Segment::new([from, to], circle, 0)).len(), 1);
        }
    }
}
