//! Features: the monotone pieces of a profile, as geometry of the half plane.

pub(crate) use crate::tool::distance::{MeridianPoint, cross, dot, minus};
use crate::tool::{Circle, ProfileSegment};
use std::f64::consts::TAU;

/// The distance from the axis, in the tool's size, up to which an arc's centre is that of a ball about the axis.
const MAX_BALL_OFFSET: f64 = 1e-9;

/// The angle up to which an arc's ends, or an end and a quarter of the circle, are one: rounding may have exchanged their angles.
const ANGLE_ROUNDING: f64 = 1e-9;

/// Three points. In a triangle that encloses a curve between two ends, the third is the apex.
pub(crate) type Triangle = [MeridianPoint; 3];

/// A profile segment, or a piece of an arc of at most a quarter of its circle, so that it is monotone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feature {
    pub(crate) ends: [MeridianPoint; 2],
    /// The unit vector from end to end; 0 if the ends coincide.
    pub(crate) along: MeridianPoint,
    pub(crate) length: f64,
    pub(crate) circle: Option<Circle>,
    pub(crate) surface: usize,
}

pub(crate) fn norm(a: MeridianPoint) -> f64 {
    dot(a, a).sqrt()
}

fn min3([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

fn max3([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}

impl Feature {
    fn new(ends: [MeridianPoint; 2], circle: Option<Circle>, surface: usize) -> Feature {
        let vector = minus(ends[1], ends[0]);
        let length = norm(vector);
        let along = if length > 0.0 { vector.map(|part| part / length) } else { [0.0; 2] };
        Feature { ends, along, length, circle, surface }
    }

    /// Returns the position of a point's foot along the line from the first end.
    #[inline]
    pub(crate) fn position(&self, p: MeridianPoint) -> f64 {
        dot(self.along, minus(p, self.ends[0]))
    }

    /// Returns the point of the line at a position.
    #[inline]
    pub(crate) fn line_point(&self, at: f64) -> MeridianPoint {
        [0, 1].map(|k| self.ends[0][k] + at * self.along[k])
    }

    /// Returns the position at which the line reaches a height.
    pub(crate) fn position_at_height(&self, z: f64) -> f64 {
        (z - self.ends[0][1]) / self.along[1]
    }

    /// Returns the distance of the line from the axis at a height, also beyond its ends.
    pub(crate) fn line_radius_at(&self, z: f64) -> f64 {
        let slope = self.along[0] / self.along[1];
        self.ends[0][0] + slope * (z - self.ends[0][1])
    }

    /// Returns the direction of travel at its beginning (0) or end (1).
    pub(crate) fn tangent_at(&self, end: usize) -> MeridianPoint {
        let Some(Circle { centre, radius, convex }) = self.circle else { return self.along };
        let [d, z] = minus(self.ends[end], centre).map(|part| part / radius);
        if convex { [-z, d] } else { [z, -d] }
    }

    /// Returns the line itself, or the line that touches a convex arc at its middle; `None` for a concave arc.
    pub(crate) fn tangent(&self) -> Option<Feature> {
        match self.circle {
            None => Some(*self),
            Some(Circle { centre, radius, convex: true }) => {
                let out = [self.along[1], -self.along[0]];
                let touch = [0, 1].map(|k| centre[k] + radius * out[k]);
                Some(Feature { ends: [touch; 2], length: 0.0, circle: None, ..*self })
            }
            Some(_) => None,
        }
    }

    /// Returns a ball about a point of the axis that contains the circle of a convex arc whose centre is near the
    /// axis, as height and radius. `size` is the tool's size. The ball contains the circle whatever the distance of
    /// its centre from the axis. Returns `None` beyond [`MAX_BALL_OFFSET`], where it is not tight enough to be useful,
    /// and for balls so large that `f32` loses all precision.
    pub(crate) fn ball(&self, size: f64) -> Option<[f64; 2]> {
        let Circle { centre: [d, z], radius, convex } = self.circle?;
        let small = radius.max(z.abs()) <= 4.0 * size;
        (convex && small && d.abs() <= MAX_BALL_OFFSET * size).then_some([z, radius + d.abs()])
    }

    /// Returns 1 if the tool is toward the axis, -1 if it is away from it.
    fn side_sign(&self) -> f64 {
        if self.ends[1][1] < self.ends[0][1] { -1.0 } else { 1.0 }
    }

    /// Returns the distance from the axis at a height between its ends.
    pub(crate) fn radius_at(&self, z: f64) -> f64 {
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

    /// Returns the signed distance of a point on the tool's side of the feature, for points between its heights: at
    /// least 0 just inside. A convex arc is continued horizontally into the tool, a concave one out of it.
    #[inline]
    pub(crate) fn signed_distance(&self, p: MeridianPoint) -> f64 {
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

    /// Returns the gradient of [`Feature::signed_distance`].
    pub(crate) fn signed_gradient(&self, p: MeridianPoint) -> MeridianPoint {
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

    /// Returns an upper bound of [`Feature::signed_distance`] over a triangle.
    #[inline]
    pub(crate) fn max_signed_distance_bound(&self, triangle: &Triangle) -> f64 {
        match &self.circle {
            // Tangents that touch on the tool's side bound nothing: the tool continues there.
            Some(circle) if circle.convex => {
                let sense = self.side_sign();
                below_tangents(circle, triangle, |[d, z]| [sense * (sense * d).max(0.0), z])
            }
            // Linear, or convex where it is at least 0.
            _ => max3(triangle.map(|p| self.signed_distance(p))),
        }
    }

    /// Returns whether the foot of a point on an arc's circle lies on the arc.
    #[inline]
    fn sector(&self, circle: &Circle, p: MeridianPoint) -> bool {
        let [from, to] = self.ends.map(|end| minus(end, circle.centre));
        let out = minus(p, circle.centre);
        let (first, last) = (cross(from, out), cross(out, to));
        if circle.convex { first >= 0.0 && last >= 0.0 } else { first <= 0.0 && last <= 0.0 }
    }

    /// Returns the ends that may be the nearest points of the feature to points of a polygon. Returns `None` if the
    /// nearest point may be elsewhere.
    pub(crate) fn at_ends(&self, corners: &[MeridianPoint]) -> Option<[bool; 2]> {
        let [first, last] = self.ends;
        // Beyond an end of a line or, as seen from the centre, of an arc, the nearest point is an end. A neighbour that comes nearer
        // from there is told by the same product.
        let [backward, forward] = [self.tangent_at(0).map(|d| -d), self.tangent_at(1)];
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

    fn all_in_sector(&self, circle: &Circle, triangle: &Triangle) -> bool {
        triangle.iter().all(|p| self.sector(circle, *p))
    }

    /// Returns whether [`Feature::signed_distance`] is the signed distance from the feature at all points of a triangle: their
    /// feet are in the range `from` to `to` along the line, or on the arc.
    #[inline]
    pub(crate) fn projects_onto(&self, triangle: &Triangle, [from, to]: [f64; 2]) -> bool {
        match &self.circle {
            None => triangle.iter().all(|p| (from..=to).contains(&self.position(*p))),
            Some(circle) => self.all_in_sector(circle, triangle),
        }
    }

    /// Returns the nearest point of the feature.
    #[inline]
    pub(crate) fn foot(&self, p: MeridianPoint) -> MeridianPoint {
        match &self.circle {
            None => {
                let at = self.position(p);
                if at <= 0.0 {
                    self.ends[0]
                } else if at >= self.length {
                    self.ends[1]
                } else {
                    self.line_point(at)
                }
            }
            Some(circle) if self.sector(circle, p) => {
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

    /// Returns the distance of a point from the feature.
    #[inline]
    pub(crate) fn distance(&self, p: MeridianPoint) -> f64 {
        match &self.circle {
            None => {
                let off = minus(p, self.ends[0]);
                let at = dot(self.along, off);
                if at <= 0.0 {
                    norm(off)
                } else if at >= self.length {
                    norm(minus(p, self.ends[1]))
                } else {
                    cross(self.along, off).abs()
                }
            }
            Some(circle) if self.sector(circle, p) => {
                (norm(minus(p, circle.centre)) - circle.radius).abs()
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| minus(p, end));
                dot(from, from).min(dot(to, to)).sqrt()
            }
        }
    }

    /// Returns the gradient of [`Feature::distance`].
    pub(crate) fn distance_gradient(&self, p: MeridianPoint) -> MeridianPoint {
        let vector = minus(p, self.foot(p));
        let length = norm(vector);
        if length > 0.0 { vector.map(|part| part / length) } else { self.signed_gradient(p) }
    }

    /// Returns an upper bound of the distances of a triangle's points.
    #[inline]
    pub(crate) fn max_distance_bound(&self, triangle: &Triangle) -> f64 {
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
    #[inline]
    pub(crate) fn min_distance_bound(&self, triangle: &Triangle) -> f64 {
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

    /// Returns whether another feature, which begins where this one ends, turns by little there.
    pub(crate) fn continues_in(&self, other: &Feature) -> bool {
        let [one, other] = [self.tangent_at(1), other.tangent_at(0)];
        dot(one, other) > 0.0 && cross(one, other).abs() < MAX_TURN_IN_LINE
    }

    /// Returns whether this feature is farther than another from every point of a polygon, by more than a margin.
    pub(crate) fn is_farther<const N: usize>(
        &self,
        other: &Feature,
        corners: &[MeridianPoint; N],
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
    pub(crate) fn affine_lower_bounds<const N: usize>(
        &self,
        corners: &[MeridianPoint; N],
    ) -> [f64; N] {
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
    pub(crate) fn convex_upper_bounds<const N: usize>(
        &self,
        corners: &[MeridianPoint; N],
    ) -> [f64; N] {
        let Some(circle @ Circle { centre: middle, radius, .. }) = &self.circle else {
            return corners.map(|p| self.distance(p));
        };
        let centre = mean(corners);
        if corners.iter().all(|corner| self.sector(circle, *corner)) {
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
        let [from, to] = self.ends.map(|end| norm(minus(centre, end)));
        let nearer = self.ends[usize::from(to < from)];
        corners.map(|p| norm(minus(p, nearer)))
    }

    /// Returns whether the distances of two features differ by at most `margin` at every point of a polygon.
    pub(crate) fn is_as_far_as<const N: usize>(
        &self,
        other: &Feature,
        corners: &[MeridianPoint; N],
        margin: f64,
    ) -> bool {
        let is_within = |one: &Feature, other: &Feature| {
            let mut bounds = one
                .convex_upper_bounds(corners)
                .into_iter()
                .zip(other.affine_lower_bounds(corners));
            bounds.all(|(upper, lower)| upper - lower <= margin)
        };
        is_within(self, other) && is_within(other, self)
    }

    /// Returns the signed distance of a triangle beyond the line that touches the feature on the side of `viewpoint`,
    /// normal to the direction of `viewpoint` from its foot; 0 if `viewpoint` is on the feature.
    #[inline]
    fn separation(&self, triangle: &Triangle, viewpoint: MeridianPoint) -> f64 {
        let vector = minus(viewpoint, self.foot(viewpoint));
        let length = norm(vector);
        if length == 0.0 {
            return 0.0;
        }
        let [from, to] = self.ends.map(|end| dot(vector, end));
        let max_dot = match &self.circle {
            Some(circle) if self.sector(circle, [0, 1].map(|k| circle.centre[k] + vector[k])) => {
                dot(vector, circle.centre) + circle.radius * length
            }
            _ => from.max(to),
        };
        (min3(triangle.map(|p| dot(vector, p))) - max_dot) / length
    }
}

/// Returns whether lower bounds of one feature's distance at the corners of a polygon are greater than upper bounds of another's
/// by more than a margin: affine less convex is concave, and least at a corner.
pub(crate) fn is_above_everywhere<const N: usize>(
    lower: [f64; N],
    upper: [f64; N],
    margin: f64,
) -> bool {
    lower.into_iter().zip(upper).all(|(lower, upper)| lower - upper > margin)
}

/// The angle, in radians, up to which features meet nearly in line.
const MAX_TURN_IN_LINE: f64 = 1.0 / 16.0;

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

/// Returns the features of a profile segment: an arc is cut where its tangent is horizontal or vertical.
pub(crate) fn quarters(piece: &ProfileSegment) -> Vec<Feature> {
    let Some(circle) = piece.circle else {
        return vec![Feature::new([piece.from, piece.to], None, piece.surface.0)];
    };
    let Circle { centre, radius, .. } = circle;
    let turn = turn_between(&circle, piece.from, piece.to);
    let turn = if turn < TAU - ANGLE_ROUNDING { turn } else { 0.0 };
    let mut cuts: Vec<(f64, MeridianPoint)> =
        [[radius, 0.0], [0.0, radius], [-radius, 0.0], [0.0, -radius]]
            .into_iter()
            .map(|[d, z]| [centre[0] + d, centre[1] + z])
            .map(|cut| (turn_between(&circle, piece.from, cut), cut))
            // Cuts at the ends do not count. An arc that exceeds a quarter by so little reaches beyond its end by
            // `radius (1 - cos 1e-9)`, 5e-19 of the radius, which is less than the rounding error of its centre and
            // radius.
            .filter(|(at, _)| *at >= ANGLE_ROUNDING && *at < turn - ANGLE_ROUNDING)
            .collect();
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut from = piece.from;
    cuts.into_iter()
        .map(|(_, cut)| cut)
        .chain([piece.to])
        .map(|to| {
            Feature::new([std::mem::replace(&mut from, to), to], Some(circle), piece.surface.0)
        })
        .collect()
}

/// Returns the angle from one point of an arc's circle to another in the arc's sense, from 0 to a full turn.
fn turn_between(circle: &Circle, from: MeridianPoint, to: MeridianPoint) -> f64 {
    let [from, to] = [from, to].map(|p| (p[1] - circle.centre[1]).atan2(p[0] - circle.centre[0]));
    let sense = if circle.convex { 1.0 } else { -1.0 };
    (sense * (to - from)).rem_euclid(TAU)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::SurfaceId;

    /// The end of the arc is an ulp before its beginning, as rounding may leave it.
    #[test]
    fn an_arc_as_short_as_rounding_is_no_full_circle() {
        let (from, to) = ([5.0, 0.3], [5.0, 0.3f64.next_down()]);
        for convex in [true, false] {
            let (from, to) = if convex { (from, to) } else { (to, from) };
            let circle = Some(Circle { centre: [3.0, 0.1], radius: 2.0_f64.hypot(0.2), convex });
            assert_eq!(
                quarters(&ProfileSegment { from, to, circle, surface: SurfaceId(0) }).len(),
                1
            );
        }
    }

    /// The square about (1, 2) is at least 1.515 from the arc and at most 1.05 from the line, that about (7, 3) at least 3.95
    /// and at most 0.55.
    #[test]
    fn an_arc_is_farther_than_a_line_beside_it() {
        let circle = Some(Circle { centre: [0.0, 3.0], radius: 3.0, convex: true });
        let [from, to] = [[0.0, 0.0], [3.0, 3.0]];
        let arc = quarters(&ProfileSegment { from, to, circle, surface: SurfaceId(0) })[0];
        for (centre, beside, margin) in [([1.0, 2.0], 2.0, 0.4), ([7.0, 3.0], 6.5, 3.0)] {
            let line = Feature::new([[beside, 0.0], [beside, 6.0]], None, 0);
            let corners = [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]
                .map(|off| [0, 1].map(|k| centre[k] + off[k]));
            assert!(arc.is_farther(&line, &corners, margin), "{centre:?}");
        }
    }

    /// Rounding moves the foot of the middle along the line. A line through both would be tilted, over so wide and thin a triangle by
    /// more than the error of a distance.
    #[test]
    fn a_line_that_is_nearer_at_a_corner_is_not_farther() {
        let bottom = Feature::new([[0.0, 0.0], [50.0, 0.0]], None, 0);
        let top = Feature::new([[50.0, 0.01], [0.0, 0.01]], None, 0);
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
        let arc = quarters(&ProfileSegment { from, to, circle, surface: SurfaceId(0) })[0];
        assert!(arc.max_distance_bound(&[[2.0, 2.0], [3.0, 2.0], [2.0, 2.0]]) >= 2.0);
    }
}
