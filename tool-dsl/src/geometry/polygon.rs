//! Convex polygons in the section, cut by linear functions.

use super::outline::{Point, cross, dot, minus, norm};

/// A convex polygon, by its vertices in order.
pub(crate) type Polygon = Vec<Point>;

/// Returns the parts of a polygon where a linear function is negative and positive.
pub(crate) fn divided(polygon: &Polygon, values: &[f64]) -> [Option<Polygon>; 2] {
    let negated: Vec<f64> = values.iter().map(|value| -value).collect();
    [clipped_by_values(polygon, &negated), clipped_by_values(polygon, values)]
}

/// Returns the halves of a polygon across its longest extent.
pub(crate) fn halved(polygon: &Polygon) -> [Option<Polygon>; 2] {
    let (mut from, mut to) = (polygon[0], polygon[0]);
    for p in polygon {
        for q in polygon {
            if norm(minus(*p, *q)) > norm(minus(from, to)) {
                (from, to) = (*p, *q);
            }
        }
    }
    let (along, middle) = (minus(to, from), [0, 1].map(|k| f64::midpoint(from[k], to[k])));
    let values: Vec<f64> = polygon.iter().map(|p| dot(along, minus(*p, middle))).collect();
    divided(polygon, &values)
}

/// Returns the part of a polygon where a linear function is not negative; `None` if that has no area.
pub(crate) fn clipped(polygon: &Polygon, value: &impl Fn(Point) -> f64) -> Option<Polygon> {
    let values: Vec<f64> = polygon.iter().map(|p| value(*p)).collect();
    clipped_by_values(polygon, &values)
}

/// Returns the part of a polygon where the linear function with the given values at its vertices is not negative.
pub(crate) fn clipped_by_values(polygon: &Polygon, values: &[f64]) -> Option<Polygon> {
    let [low, high] = range(values.iter().copied());
    if low >= 0.0 {
        return Some(polygon.clone());
    }
    if high <= 0.0 {
        return None;
    }
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for k in 0..polygon.len() {
        let next = (k + 1) % polygon.len();
        let (p, q, a, b) = (polygon[k], polygon[next], values[k], values[next]);
        if a >= 0.0 {
            part.push(p);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            let t = a / (a - b);
            part.push([0, 1].map(|k| p[k] + t * (q[k] - p[k])));
        }
    }
    part.dedup();
    (part.len() >= 3).then_some(part)
}

/// Returns the least convex polygon about some points.
pub(crate) fn hull(mut points: Vec<Point>) -> Polygon {
    points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Polygon = Vec::new();
        for p in points {
            while let [.., from, to] = chain[..]
                && cross(minus(to, from), minus(p, from)) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.into_iter().rev()));
    hull
}

/// Returns whether a point is in a convex polygon.
pub(crate) fn contains(polygon: &[Point], p: Point) -> bool {
    let sides = (0..polygon.len()).map(|k| {
        let next = polygon[(k + 1) % polygon.len()];
        cross(minus(next, polygon[k]), minus(p, polygon[k]))
    });
    let [low, high] = range(sides);
    low >= 0.0 || high <= 0.0
}

/// Returns the area of a polygon.
pub(crate) fn area(polygon: &Polygon) -> f64 {
    let fan = polygon.windows(2);
    let twice: f64 =
        fan.map(|pair| cross(minus(pair[0], polygon[0]), minus(pair[1], polygon[0]))).sum();
    twice.abs() / 2.0
}

/// Returns the mean of the vertices.
pub(crate) fn centroid(polygon: &Polygon) -> Point {
    [0, 1].map(|k| polygon.iter().map(|p| p[k]).sum::<f64>() / polygon.len() as f64)
}

/// Returns the centre of a polygon's bounding box, and the larger half of its sides.
pub(crate) fn centre_and_half(polygon: &Polygon) -> (Point, f64) {
    let [d, z] = [0, 1].map(|k| range(polygon.iter().map(|p| p[k])));
    let half = (d[1] - d[0]).max(z[1] - z[0]) / 2.0;
    ([f64::midpoint(d[0], d[1]), f64::midpoint(z[0], z[1])], half)
}

/// Returns about the width of a polygon across its longest extent.
pub(crate) fn width(polygon: &Polygon) -> f64 {
    area(polygon) / extent(polygon)
}

/// A side of a convex polygon: a vertex, and the vector between this and the next one that has the polygon on its left.
pub(crate) struct Side {
    from: Point,
    along: Point,
}

impl Side {
    /// Returns the distance of a point from the side's line, times the side's length; positive toward the polygon.
    pub(crate) fn inward(&self, p: Point) -> f64 {
        cross(self.along, minus(p, self.from))
    }
}

/// Returns the sides of a convex polygon that are longer than `tolerance`. Two vertices that coincide but for rounding have no
/// direction.
pub(crate) fn sides(polygon: &Polygon, tolerance: f64) -> impl Iterator<Item = Side> {
    let middle = centroid(polygon);
    (0..polygon.len()).filter_map(move |k| {
        let from = polygon[k];
        let along = minus(polygon[(k + 1) % polygon.len()], from);
        let orientation = cross(along, minus(middle, from)).signum();
        let along = along.map(|part| orientation * part);
        (norm(along) > tolerance).then_some(Side { from, along })
    })
}

/// Returns whether the boxes of two polygons are farther apart than a distance along one of the axes.
pub(crate) fn are_boxes_apart(p: &Polygon, q: &Polygon, distance: f64) -> bool {
    [0, 1].into_iter().any(|axis| {
        let [[low, high], [other_low, other_high]] =
            [p, q].map(|polygon| range(polygon.iter().map(|v| v[axis])));
        high + distance < other_low || other_high + distance < low
    })
}

/// Returns whether two convex polygons have points within a distance of each other.
pub(crate) fn do_touch(p: &Polygon, q: &Polygon, tolerance: f64) -> bool {
    if are_boxes_apart(p, q, tolerance) {
        return false;
    }
    let separates = |a: &Polygon, b: &Polygon| {
        sides(a, tolerance).any(|side| {
            let far = -tolerance * norm(side.along);
            b.iter().all(|v| side.inward(*v) < far)
        })
    };
    !separates(p, q) && !separates(q, p)
}

/// Returns the part of a convex polygon that is within a distance of another's sides' lines, on the outside; `None` if that has no
/// area.
pub(crate) fn near_part(polygon: &Polygon, other: &Polygon, distance: f64) -> Option<Polygon> {
    sides(other, distance).try_fold(polygon.clone(), |part, side| {
        clipped(&part, &|p| side.inward(p) + distance * norm(side.along))
    })
}

/// Returns the greatest distance between vertices of a polygon.
pub(crate) fn extent(polygon: &Polygon) -> f64 {
    let distances = polygon.iter().flat_map(|p| polygon.iter().map(|q| norm(minus(*p, *q))));
    distances.fold(0.0, f64::max)
}

/// Returns the least and the greatest of some values.
pub(crate) fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[low, high], value| [low.min(value), high.max(value)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_the_outermost_points_alone() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        // Points inside, on edges, and twice.
        let more = [[1.0, 1.0], [1.0, 0.0], [2.0, 1.5], [0.0, 2.0]];
        assert_eq!(hull([more, square].concat()), square);
    }
}
