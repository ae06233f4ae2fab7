//! A triangle in the tool's frame, and the lines in it to be searched.
//!
//! Depth is a function of d and z alone. Where it is greatest inside a triangle, its gradient, which lies in the
//! plane through the axis there, is normal to the triangle. The point therefore lies in the plane through the
//! axis that contains the triangle's normal. That also holds on a ridge, where gradients of two features combine
//! to the normal. The maximum is therefore on an edge or on the *meridian*, the line in which the triangle meets
//! that plane. A level triangle meets it everywhere: its depth depends on d alone, and any line through the axis
//! has all values that the edges do not have.

use crate::certify::rounding;
use crate::certify::space::{Point, cross, dot, minus, norm};
use crate::certify::triangle::line_search::SearchLine;

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
        let edges = LocalTriangle {
            corners,
            normal: [0.0; 3],
            base: a,
            direction: [0.0; 3],
            skew: rounding::height(height, shortest),
        };
        let skew = rounding::skew(height, shortest, far);
        // A height below the skew makes the normal meaningless, and then every point is as near to an edge.
        if skew.is_nan() || skew >= edges.skew || !area.is_finite() {
            return edges;
        }
        let normal = across.map(|part| part / area);
        let base = normal.map(|part| part * dot(normal, a));
        let level = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
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
            // inward · (base + t way - a) >= 0
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
        [[a, b], [b, c], [c, a]]
            .map(|[from, to]| SearchLine::new(from, minus(to, from), [0.0, 1.0]))
    }
}

/// Returns the point of a triangle nearest to `p`, up to rounding. It is a convex combination of the corners
/// whatever the rounding errors.
///
/// The regions of the plane nearest to a corner, an edge or the inside are told apart as in Ericson, *Real-Time
/// Collision Detection*, 2005, section 5.1.5.
pub(crate) fn nearest(p: Point, &[a, b, c]: &[Point; 3]) -> Point {
    let along = |from: Point, to: Point, part: f64| {
        let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
        [0, 1, 2].map(|k| from[k] + part * (to[k] - from[k]))
    };
    let (ab, ac) = (minus(b, a), minus(c, a));
    let of = |corner: Point| {
        let direction = minus(p, corner);
        [dot(ab, direction), dot(ac, direction)]
    };
    let ([a1, a2], [b1, b2], [c1, c2]) = (of(a), of(b), of(c));
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
        return along(a, b, a1 / (a1 - b1));
    }
    if to_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        return along(a, c, a2 / (a2 - c2));
    }
    if to_a <= 0.0 && b2 >= b1 && c1 >= c2 {
        return along(b, c, (b2 - b1) / ((b2 - b1) + (c1 - c2)));
    }
    // First along the edge, then toward the third corner by its barycentric coordinate.
    let whole = to_a + to_b + to_c;
    along(along(a, b, to_b / (to_a + to_b)), c, to_c / whole)
}
