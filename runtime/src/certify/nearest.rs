//! Distance of a point from the triangles of a part, by branch and bound.

use super::TriangleBvh;
use crate::bvh::WIDTH;
use crate::mesh::area_and_normal;
use nalgebra::{Point3, Vector3};

/// A search for nearest triangles. It is fast for points near the one before: the triangle found last gives a bound.
#[derive(Debug)]
pub struct NearestTriangle<'a> {
    bvh: &'a TriangleBvh,
    /// The triangle found last, as an index in the tree's order.
    last: usize,
    /// Nodes that may hold a nearer triangle: their levels and indices, and lower bounds on the squared distance.
    stack: Vec<(f64, usize, usize)>,
}

impl NearestTriangle<'_> {
    /// Creates a search.
    pub fn new(bvh: &TriangleBvh) -> NearestTriangle<'_> {
        NearestTriangle { bvh, last: 0, stack: Vec::new() }
    }

    /// Returns the distance of a point from the nearest triangle, in the part's frame and unit. It is the
    /// distance from a point of a triangle, rounded by some units in the last place of the coordinates.
    pub fn distance(&mut self, point: Point3<f64>) -> f64 {
        self.squared_distance_below(point, f64::INFINITY).sqrt()
    }

    /// Returns whether no triangle is within a distance of a point, with the rounding of [`NearestTriangle::distance`].
    pub(crate) fn are_beyond(&mut self, point: Point3<f64>, distance: f64) -> bool {
        let limit = distance * distance;
        self.squared_distance_below(point, limit) >= limit
    }

    /// Returns the squared distance of a point from the nearest triangle, or `limit` if that is not below it.
    fn squared_distance_below(&mut self, point: Point3<f64>, limit: f64) -> f64 {
        let frame = &self.bvh.frame;
        let p = frame.inside(point.into());
        let bvh = self.bvh;
        let last = squared_distance(point, bvh.corners[self.last].map(Point3::from));
        let mut nearest = limit.min(last);
        self.stack.clear();
        self.stack.push((0.0, 0, 0));
        while let Some((low, level, index)) = self.stack.pop() {
            if low >= nearest {
                continue;
            }
            let Some(boxes) = self.bvh.levels.get(level) else {
                let first = index * WIDTH;
                for triangle in first..first + self.bvh.children(level, index) {
                    let corners = bvh.corners[triangle].map(Point3::from);
                    if squared_distance_of_box(point, &corners) < nearest {
                        let distance = squared_distance(point, corners);
                        if distance < nearest {
                            (nearest, self.last) = (distance, triangle);
                        }
                    }
                }
                continue;
            };
            let (boxes, first) = (&boxes[index], self.stack.len());
            for lane in 0..self.bvh.children(level, index) {
                let mut low = 0.0;
                for axis in 0..3 {
                    let [centre, half] =
                        [boxes.centre, boxes.half].map(|list| f64::from(list[axis][lane]));
                    // Boxes and the point were converted with a rounding of their coordinates each: a triangle that they
                    // rule out wrongly is nearer by no more than that.
                    let beyond = ((p[axis] - centre).abs() - half).max(0.0);
                    low += beyond * beyond;
                }
                let low = low * frame.scale * frame.scale;
                if low < nearest {
                    self.stack.push((low, level + 1, index * WIDTH + lane));
                }
            }
            // The nearest box comes off the stack first.
            self.stack[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        nearest
    }
}

/// Returns the squared distance of a point from the bounding box of a triangle.
fn squared_distance_of_box(point: Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> f64 {
    let beyond = (a.inf(b).inf(c) - point).sup(&(point - a.sup(b).sup(c)));
    beyond.map(|beyond| beyond.max(0.0)).norm_squared()
}

/// Returns the squared distance of a point from a triangle. For a triangle without area, it is the distance
/// from its edges.
///
/// The nearest point is the foot on the triangle's plane if that is on the inner side of all edges, and
/// otherwise on an edge (Ericson, *Real-time collision detection*, 2005, section 5.1.5).
fn squared_distance(point: Point3<f64>, corners: [Point3<f64>; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let edges = [(a, b), (b, c), (c, a)];
    if let Some((_, normal)) = area_and_normal(&corners)
        && edges.iter().all(|(from, to)| from.cross(to).dot(&normal) > 0.0)
    {
        let height = normal.dot(&a);
        return height * height;
    }
    edges
        .iter()
        .map(|(from, to)| squared_distance_of_segment(*from, *to))
        .fold(f64::INFINITY, f64::min)
}

/// Returns the squared distance of the origin from a segment.
fn squared_distance_of_segment(from: Vector3<f64>, to: Vector3<f64>) -> f64 {
    let along = to - from;
    let length = along.norm_squared();
    // A segment without length has any of its points as the nearest one.
    let fraction = if length > 0.0 { (-from.dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (from + fraction * along).norm_squared()
}
