//! A single triangle: the lines in it on which depth can be greatest, and its subdivision.
//!
//! Depth is a function of d and z alone. Where it is greatest inside a triangle, its gradient, which lies in the
//! plane through the axis there, is normal to the triangle. The point therefore lies in the plane through the
//! axis that contains the triangle's normal. That also holds on a ridge, where gradients of two features combine
//! to the normal. The maximum is therefore on an edge or on the *meridian*, the line in which the triangle meets
//! that plane. A level triangle meets it everywhere: its depth depends on d alone, and any line through the axis
//! has all values that the edges do not have.

pub(crate) mod line_search;

use crate::certify::rounding;
use crate::certify::space::{Point, cross, dot, minus, norm};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::profile::ProfileModel;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::triangle::line_search::{DepthSearch, SearchLine};

/// A triangle in the tool's frame and unit.
pub(crate) struct LocalTriangle {
    pub(crate) corners: [Point; 3],
    normal: Point,
    /// The base point of its meridian, and the direction along it.
    base: Point,
    direction: Point,
    /// The largest distance between the computed meridian and the true one.
    pub(crate) skew: f64,
}

impl LocalTriangle {
    pub(crate) fn new(corners: [Point; 3]) -> LocalTriangle {
        let [a, b, c] = corners;
        let edges = [minus(b, a), minus(c, b), minus(a, c)];
        let lengths = edges.map(norm);
        let longest = lengths[0].max(lengths[1]).max(lengths[2]);
        // The product of the two shorter edges has the least rounding error.
        let across = if lengths[0] == longest {
            cross(edges[1], edges[2])
        } else if lengths[1] == longest {
            cross(edges[2], edges[0])
        } else {
            cross(edges[0], edges[1])
        };
        let area = norm(across);
        let shortest = lengths[0].min(lengths[1]).min(lengths[2]);
        let far = corners.map(norm).into_iter().fold(0.0, f64::max);
        let height = if longest > 0.0 { area / longest } else { 0.0 };
        let edges =
            LocalTriangle { corners, normal: [0.0; 3], base: a, direction: [0.0; 3], skew: height };
        let skew = rounding::skew(height, shortest, far);
        // A height below the skew makes the normal meaningless, and then every point is as near to an edge.
        if skew.is_nan() || skew >= height || !area.is_finite() {
            return edges;
        }
        let normal = across.map(|part| part / area);
        // The foot of the origin on the triangle's plane. The axis passes through the origin, so the foot is in the
        // meridian's plane.
        let base = normal.map(|part| part * dot(normal, a));
        let level = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
        // A level triangle meets every plane through the axis; any of them will do.
        let [x, y] = if level > 0.0 { [normal[0] / level, normal[1] / level] } else { [1.0, 0.0] };
        let direction = [normal[2] * x, normal[2] * y, -level];
        LocalTriangle { corners, normal, base, direction, skew }
    }

    /// Returns the meridian within the triangle.
    fn meridian(&self) -> Option<SearchLine> {
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            let inward = cross(self.normal, minus(b, a));
            // inward · (base + t direction - a) >= 0
            let (speed, min_value) =
                (dot(inward, self.direction), dot(inward, minus(a, self.base)));
            if speed > 0.0 {
                from = from.max(min_value / speed);
            } else if speed < 0.0 {
                to = to.min(min_value / speed);
            } else if min_value > 0.0 {
                return None;
            }
        }
        (from < to && from.is_finite() && to.is_finite())
            .then(|| SearchLine::new(self.base, self.direction, [from, to]))
    }

    /// Returns the segment of the triangle at a height, unless that is only an edge.
    pub(crate) fn level(&self, z: f64) -> Option<SearchLine> {
        let mut ends = [None, None];
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            if (a[2] <= z) != (b[2] <= z) {
                let part = (z - a[2]) / (b[2] - a[2]);
                let at = [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis]));
                // Two edges cross the height, or none: each corner is on one side of it.
                ends[usize::from(ends[0].is_some())] = Some([at[0], at[1], z]);
            }
        }
        let [from, to] = [ends[0]?, ends[1]?];
        Some(SearchLine::new(from, minus(to, from), [0.0, 1.0]))
    }

    /// Returns its meridian and its edges.
    pub(crate) fn search_lines(&self) -> impl Iterator<Item = SearchLine> + use<> {
        self.meridian().into_iter().chain(self.edges())
    }

    fn edges(&self) -> [SearchLine; 3] {
        let [a, b, c] = self.corners;
        let edge = |from: Point, to: Point| SearchLine::new(from, minus(to, from), [0.0, 1.0]);
        [edge(a, b), edge(b, c), edge(c, a)]
    }
}

/// Returns the point of a triangle nearest to `p`, up to rounding. It is a convex combination of the corners
/// whatever the rounding errors.
///
/// The regions of the plane nearest to a corner, an edge or the inside are told apart as in Ericson, *Real-Time
/// Collision Detection*, 2005, section 5.1.5.
pub(crate) fn nearest(p: Point, &[a, b, c]: &[Point; 3]) -> Point {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let [[a1, a2], [b1, b2], [c1, c2]] = [a, b, c].map(|corner| {
        let direction = minus(p, corner);
        [dot(ab, direction), dot(ac, direction)]
    });
    if a1 <= 0.0 && a2 <= 0.0 {
        return a;
    }
    if b1 >= 0.0 && b2 <= b1 {
        return b;
    }
    if c2 >= 0.0 && c1 <= c2 {
        return c;
    }
    let [to_a, to_b, to_c] = [b1 * c2 - c1 * b2, c1 * a2 - a1 * c2, a1 * b2 - b1 * a2];
    if to_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        return between(a, b, a1 / (a1 - b1));
    }
    if to_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        return between(a, c, a2 / (a2 - c2));
    }
    if to_a <= 0.0 && b2 >= b1 && c1 >= c2 {
        return between(b, c, (b2 - b1) / ((b2 - b1) + (c1 - c2)));
    }
    // First along the edge, then toward the third corner by its barycentric coordinate.
    let whole = to_a + to_b + to_c;
    between(between(a, b, to_b / (to_a + to_b)), c, to_c / whole)
}

/// Returns a point of the segment between two others; one of its ends if rounding leaves no fraction between 0 and 1.
fn between(from: Point, to: Point, part: f64) -> Point {
    let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
    [0, 1, 2].map(|k| from[k] + part * (to[k] - from[k]))
}

/// A triangle, or a piece of one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SubTriangle {
    /// The corners; the longest side is from the first to the second.
    corners: [Point; 3],
}

fn middle(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| f64::midpoint(a[axis], b[axis]))
}

fn square(a: Point) -> f64 {
    dot(a, a)
}

/// A piece of one of a part's triangles.
#[derive(Clone, Copy, Default)]
pub(crate) struct TrianglePiece {
    pub(crate) index: u32,
    pub(crate) piece: SubTriangle,
}

impl SubTriangle {
    pub(crate) fn new([a, b, c]: [Point; 3]) -> SubTriangle {
        let [ab, bc, ca] = [minus(b, a), minus(c, b), minus(a, c)].map(square);
        let corners = if ab >= bc && ab >= ca {
            [a, b, c]
        } else if bc >= ca {
            [b, c, a]
        } else {
            [c, a, b]
        };
        SubTriangle { corners }
    }

    pub(crate) fn corners(&self) -> &[Point; 3] {
        &self.corners
    }

    /// Returns the length of its longest side.
    pub(crate) fn longest(&self) -> f64 {
        square(minus(self.corners[1], self.corners[0])).sqrt()
    }

    /// Returns the centre and radius of a ball that contains it.
    pub(crate) fn ball(&self) -> (Point, f64) {
        let [a, b, c] = self.corners;
        // About the middle of the longest side for an obtuse triangle, about the centroid for one that is nearly regular.
        let mean = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let [half, mean] = [middle(a, b), mean].map(|centre| {
            let far = [a, b, c].map(|corner| square(minus(corner, centre)));
            (centre, far[0].max(far[1]).max(far[2]).sqrt())
        });
        if half.1 < mean.1 { half } else { mean }
    }

    /// Returns a rectangle of the half plane with all points within `displacement` of the triangle.
    pub(crate) fn rectangle(&self, displacement: f64) -> Rectangle {
        let (mut far, mut low, mut high) = (0.0f64, f64::INFINITY, f64::NEG_INFINITY);
        for [x, y, z] in self.corners {
            far = far.max((x * x + y * y).sqrt());
            (low, high) = (low.min(z), high.max(z));
        }
        Rectangle {
            low: [(self.distance_from_axis() - displacement).max(0.0), low - displacement],
            high: [far + displacement, high + displacement],
        }
    }

    /// Leaves its depth open in a search if a rectangle of unresolved peaks is within a distance of it.
    pub(crate) fn leave_unresolved(
        &self,
        ProfileModel { section, circles, .. }: &ProfileModel,
        owners: &Owners,
        distance: f64,
        search: &mut DepthSearch,
    ) {
        // Hardly any profile has some.
        if circles.unresolved.is_empty() && owners.unresolved.is_empty() {
            return;
        }
        let rectangle = self.rectangle(distance);
        let unresolved = circles.unresolved.iter().chain(&owners.unresolved);
        for near in unresolved.filter(|unresolved| unresolved.meets(&rectangle)) {
            let (middle, reach) = near.ball();
            let bound = section.signed(middle) + reach + section.outline.error;
            if bound > search.threshold() {
                search.leave(bound);
            }
        }
    }

    /// Returns the distance of its nearest point from the axis.
    fn distance_from_axis(&self) -> f64 {
        // Seen along the axis: that of the origin from a triangle, which is 0 if the origin is on the same side of all edges.
        let mut near = f64::INFINITY;
        let mut sides = [false; 2];
        for k in 0..3 {
            let ([x, y, _], [to_x, to_y, _]) = (self.corners[k], self.corners[(k + 1) % 3]);
            let (across, up) = (to_x - x, to_y - y);
            let side = x * up - y * across;
            sides[0] |= side <= 0.0;
            sides[1] |= side >= 0.0;
            let along = -(x * across + y * up) / (across * across + up * up);
            // An edge parallel to the axis is one point.
            let part = if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) };
            near = near.min((x + part * across).hypot(y + part * up));
        }
        if sides == [true, true] { near } else { 0.0 }
    }

    /// Returns both halves, cut at the middle of its longest side; none if that is too short to be halved.
    pub(crate) fn halves(&self) -> impl Iterator<Item = SubTriangle> + use<> {
        let [a, b, c] = self.corners;
        let half = middle(a, b);
        let halves = [SubTriangle::new([a, half, c]), SubTriangle::new([half, b, c])];
        halves.into_iter().filter(move |_| half != a && half != b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_on_the_side_that_faces() {
        let triangle = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
        for (from, expected) in [
            ([1.0, 1.0, 5.0], [1.0, 1.0, 0.0]),
            ([-1.0, 2.0, 7.0], [0.0, 2.0, 0.0]),
            ([-1.0, 5.0, 2.0], [0.0, 3.0, 0.0]),
            // On 3x + 4y = 12: (4, 3) - 12/25 (3, 4).
            ([4.0, 3.0, 1.0], [2.56, 1.08, 0.0]),
        ] {
            let found = nearest(from, &triangle);
            assert!(norm(minus(found, expected)) < 1e-12, "{from:?}: {found:?}");
        }
    }
}
