//! Bounds of distances over polygons: where every point of a polygon is concerned, its corners suffice for a function that is
//! affine, or convex (an upper bound) or concave (a lower one).

use crate::segment::{Circle, Segment};
use crate::vector::{Point, cross, dot, minus, norm};

/// The angle, in radians, up to which segments meet nearly in line.
const MAX_TURN_IN_LINE: f64 = 1.0 / 16.0;

/// Three points. In a triangle that encloses a curve between two ends, the third is the apex.
pub type Triangle = [Point; 3];

pub(crate) fn min3([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

pub(crate) fn max3([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}

impl Segment {
    /// Returns the ends that may be the nearest points of the segment to points of a polygon. Returns `None` if the
    /// nearest point may be elsewhere.
    pub fn at_ends(&self, corners: &[Point]) -> Option<[bool; 2]> {
        let [first, last] = self.ends;
        // Beyond an end of a line or, as seen from the centre, of an arc, the nearest point is an end. A neighbour that comes nearer
        // from there is told by the same product.
        let [backward, forward] = [self.tangent(0).map(|d| -d), self.tangent(1)];
        let is_beyond = corners.iter().all(|p| dot(backward, minus(*p, first)) > 0.0)
            || corners.iter().all(|p| dot(forward, minus(*p, last)) > 0.0);
        if !is_beyond {
            return None;
        }
        // The bisector of the ends tells which of them is the nearer one.
        let middle = [0, 1].map(|k| f64::midpoint(first[k], last[k]));
        let positions = corners.iter().map(|p| dot(self.along, minus(*p, middle)));
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
    pub fn max_distance(&self, triangle: &Triangle) -> f64 {
        match &self.circle {
            // The distance from a convex set is convex.
            None => max3(triangle.map(|p| self.distance(p))),
            Some(circle) if self.all_in_sector(circle, triangle) => {
                let out = max3(triangle.map(|p| norm(minus(p, circle.centre)) - circle.radius));
                out.max(below_tangents(circle, triangle, |n| n))
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| max3(triangle.map(|p| norm(minus(p, end)))));
                from.min(to)
            }
        }
    }

    /// Returns a lower bound of the distances of a triangle's points.
    // Inlined always: a call takes a tenth of a query of distance.
    #[inline(always)]
    pub fn min_distance(&self, triangle: &Triangle) -> f64 {
        let [first, second, middle] = *triangle;
        // A distance has the Lipschitz constant 1.
        let reach = norm(minus(first, middle)).max(norm(minus(second, middle)));
        let coarse = self.distance(middle) - reach;
        if let Some(Circle { centre, radius, convex: false }) = self.circle {
            // Measured from inside the circle; from beyond it only an end is near.
            return coarse.max(min3(triangle.map(|p| radius - norm(minus(p, centre)))));
        }
        let nearer = if self.distance(first) < self.distance(second) { first } else { second };
        coarse.max(self.separation(triangle, middle)).max(self.separation(triangle, nearer))
    }

    /// Returns whether another segment, which begins where this one ends, turns by little there.
    pub fn continues_in(&self, other: &Segment) -> bool {
        let [one, other] = [self.tangent(1), other.tangent(0)];
        dot(one, other) > 0.0 && cross(one, other).abs() < MAX_TURN_IN_LINE
    }

    /// Returns whether this segment is farther than another from every point of a polygon, by more than a margin.
    pub fn is_farther<const N: usize>(
        &self,
        other: &Segment,
        corners: &[Point; N],
        margin: f64,
    ) -> bool {
        is_above_everywhere(
            self.affine_lower_bounds(corners),
            other.convex_upper_bounds(corners),
            margin,
        )
    }

    /// Returns lower bounds of the distance of the corners of a polygon, such that the affine function with these values is one
    /// at every point of the polygon. They are exact for a line on one side of which the polygon lies.
    pub fn affine_lower_bounds<const N: usize>(&self, corners: &[Point; N]) -> [f64; N] {
        let centre = mean(corners);
        match &self.circle {
            // The distance from a convex set is at least that from a line which separates the two, whatever its direction.
            None => {
                let away = minus(centre, self.foot(centre));
                let length = norm(away);
                if length == 0.0 {
                    return [0.0; N];
                }
                let [from, to] = self.ends.map(|end| dot(away, end));
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

    /// Returns upper bounds of the distance of the corners of a polygon, such that a convex function with these values is one at
    /// every point of the polygon. They are exact for a line.
    pub fn convex_upper_bounds<const N: usize>(&self, corners: &[Point; N]) -> [f64; N] {
        let Some(circle @ Circle { centre: middle, radius, .. }) = &self.circle else {
            return corners.map(|p| self.distance(p));
        };
        let centre = mean(corners);
        if corners.iter().all(|corner| self.is_beside_arc(circle, *corner)) {
            let out = minus(centre, *middle);
            let length = norm(out);
            let along = |p: Point| {
                if length > 0.0 { dot(out, minus(p, *middle)) / length } else { 0.0 }
            };
            if corners.iter().all(|corner| norm(minus(*corner, *middle)) <= *radius) {
                return corners.map(|p| radius - along(p));
            }
            if corners.iter().all(|corner| along(*corner) >= *radius) {
                return corners.map(|p| norm(minus(p, *middle)) - radius);
            }
        }
        let [from, to] = self.ends.map(|end| norm(minus(centre, end)));
        let nearer = self.ends[usize::from(to < from)];
        corners.map(|p| norm(minus(p, nearer)))
    }

    /// Returns whether the distances of two segments differ by at most `margin` at every point of a polygon.
    pub fn is_as_far_as<const N: usize>(
        &self,
        other: &Segment,
        corners: &[Point; N],
        margin: f64,
    ) -> bool {
        let is_within = |one: &Segment, other: &Segment| {
            let mut bounds = one
                .convex_upper_bounds(corners)
                .into_iter()
                .zip(other.affine_lower_bounds(corners));
            bounds.all(|(upper, lower)| upper - lower <= margin)
        };
        is_within(self, other) && is_within(other, self)
    }

    /// Returns the signed distance of a triangle beyond the line that touches the segment on the side of `viewpoint`,
    /// normal to the direction of `viewpoint` from its foot; 0 if `viewpoint` is on the segment.
    #[inline(always)]
    fn separation(&self, triangle: &Triangle, viewpoint: Point) -> f64 {
        let vector = minus(viewpoint, self.foot(viewpoint));
        let length = norm(vector);
        if length == 0.0 {
            return 0.0;
        }
        let [from, to] = self.ends.map(|end| dot(vector, end));
        let max_dot = match &self.circle {
            Some(circle)
                if self.is_beside_arc(circle, [0, 1].map(|k| circle.centre[k] + vector[k])) =>
            {
                dot(vector, circle.centre) + circle.radius * length
            }
            _ => from.max(to),
        };
        (min3(triangle.map(|p| dot(vector, p))) - max_dot) / length
    }

    pub(crate) fn all_in_sector(&self, circle: &Circle, triangle: &Triangle) -> bool {
        triangle.iter().all(|p| self.is_beside_arc(circle, *p))
    }
}

/// Returns whether lower bounds of one segment's distance at the corners of a polygon are greater than upper bounds of another's
/// by more than a margin: affine less convex is concave, and least at a corner.
pub fn is_above_everywhere<const N: usize>(lower: [f64; N], upper: [f64; N], margin: f64) -> bool {
    lower.into_iter().zip(upper).all(|(lower, upper)| lower - upper > margin)
}

/// Returns the mean of the corners of a polygon.
pub fn mean(corners: &[Point]) -> Point {
    [0, 1].map(|k| corners.iter().map(|corner| corner[k]).sum::<f64>() / corners.len() as f64)
}

/// Returns an upper bound of the depth of a triangle's points inside a circle. No point is deeper than under any
/// tangent. The tangents taken are at the feet of the end that is farther inside and of the apex, in the
/// directions that `touching` derives from theirs.
#[inline]
pub(crate) fn below_tangents(
    circle: &Circle,
    triangle: &Triangle,
    touching: impl Fn(Point) -> Point,
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
        let arc = Segment::new([from, to], circle, 0);
        for (centre, beside, margin) in [([1.0, 2.0], 2.0, 0.4), ([7.0, 3.0], 6.5, 3.0)] {
            let line = Segment::new([[beside, 0.0], [beside, 6.0]], None, 0);
            let corners = [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]
                .map(|off| [0, 1].map(|k| centre[k] + off[k]));
            assert!(arc.is_farther(&line, &corners, margin), "{centre:?}");
        }
    }

    /// Rounding moves the foot of the middle along the line. A line through both would be tilted, over so wide and thin a triangle by
    /// more than the error of a distance.
    #[test]
    fn a_line_that_is_nearer_at_a_corner_is_not_farther() {
        let bottom = Segment::new([[0.0, 0.0], [50.0, 0.0]], None, 0);
        let top = Segment::new([[50.0, 0.01], [0.0, 0.01]], None, 0);
        let corners = [
            [1.229_026_647_031_889, 0.004_999_999_982_607_259],
            [34.446_196_190_199_394, 0.005_000_000_003_054_599],
            [17.837_611_418_615_64, 0.004_999_999_992_830_929],
        ];
        assert!(top.distance(corners[1]) < bottom.distance(corners[1]) - 6e-12);
        assert!(!top.is_farther(&bottom, &corners, 4.26e-12));
    }

    /// Both the nearer end of an edge and the apex are the arc's centre, whose depth is the radius.
    #[test]
    fn the_centre_of_an_arc_is_as_deep_as_its_radius() {
        let circle = Some(Circle { centre: [2.0, 2.0], radius: 2.0, convex: true });
        let [from, to] = [[2.0, 0.0], [4.0, 2.0]];
        let arc = Segment::new([from, to], circle, 0);
        assert!(arc.max_distance(&[[2.0, 2.0], [3.0, 2.0], [2.0, 2.0]]) >= 2.0);
    }
}
