//! Planes of nodes: tighter bounds, in `f64`, of nodes whose triangles lie nearly in a plane.
//!
//! A flat tool end on a plate is equally deep in all triangles of the plate, and `f32` cannot tell them apart.
//! The extent of a node's triangles along a normal can.

use super::TriangleBvh;
use crate::bvh::{PoseTransform, WIDTH};
use crate::certify::space::{Point, dot};

/// A direction, and the extent of the corners of a node's triangles along it, in the tree's frame and unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    normal: Point,
    ends: [f64; 2],
}

/// A ring about the tool's axis that contains a node: the least distance from the axis, and the range of heights,
/// in the tool's unit.
pub(crate) struct NodeRing {
    pub(crate) near: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Plane {
    /// Computes the plane of triangles along the mean of their normals, from corners in the tree's frame.
    pub(crate) fn of(triangles: &[[Point; 3]]) -> Plane {
        let mut sum = [0.0; 3];
        for [a, b, c] in triangles {
            let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
            sum[0] += u[1] * v[2] - u[2] * v[1];
            sum[1] += u[2] * v[0] - u[0] * v[2];
            sum[2] += u[0] * v[1] - u[1] * v[0];
        }
        let length = dot(sum, sum).sqrt();
        // Any direction is correct.
        let normal = if length > 0.0 { sum.map(|part| part / length) } else { [0.0, 0.0, 1.0] };
        let heights = triangles.iter().flatten().map(|corner| dot(normal, *corner));
        let ends = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
            [low.min(height), high.max(height)]
        });
        Plane { normal, ends }
    }
}

/// The box and the plane of a node, in the tree's frame and unit.
struct NodeBounds {
    centre: Point,
    half: Point,
    plane: Plane,
}

impl NodeBounds {
    /// Returns the extent of the node along a direction of the tree's frame, for a position of `origin` at the frame's
    /// origin. Its component normal to the plane is bounded tightly, the rest by the box; the box alone may be tighter.
    #[inline]
    fn extent(&self, direction: Point, origin: f64) -> [f64; 2] {
        let NodeBounds { centre, half, plane: Plane { normal, ends } } = *self;
        let part = dot(direction, normal);
        let rest = [0, 1, 2].map(|k| direction[k] - part * normal[k]);
        let wide = dot(rest.map(f64::abs), half);
        let middle = origin + dot(rest, centre);
        let [a, b] = ends.map(|end| part * end);
        let flat = [middle + a.min(b) - wide, middle + a.max(b) + wide];
        let boxed = [-1.0, 1.0].map(|side| {
            origin + dot(direction, centre) + side * dot(direction.map(f64::abs), half)
        });
        [flat[0].max(boxed[0]), flat[1].min(boxed[1])]
    }
}

/// Returns the least magnitude in a range.
#[inline]
fn least_magnitude([low, high]: [f64; 2]) -> f64 {
    low.max(-high).max(0.0)
}

impl TriangleBvh {
    /// Returns the ring about the tool's axis that contains a node, from its box and its plane. Returns `None` for
    /// the root, which has no box.
    pub(crate) fn ring(
        &self,
        level: usize,
        index: usize,
        view: &PoseTransform,
    ) -> Option<NodeRing> {
        let boxes = &self.levels[level.checked_sub(1)?][index / WIDTH];
        let lane = index % WIDTH;
        let centre = [0, 1, 2].map(|axis| f64::from(boxes.centre[axis][lane]));
        let half = [0, 1, 2].map(|axis| f64::from(boxes.half[axis][lane]));
        let node = NodeBounds { centre, half, plane: self.planes[level][index] };
        let (rows, origin) = view.exactly();
        let [low, high] = node.extent(rows[2], origin[2]);
        let [x, y] = [0, 1].map(|axis| least_magnitude(node.extent(rows[axis], origin[axis])));
        // The distance toward the axis along the plane's normal.
        let [u, v] = [0, 1].map(|axis| dot(rows[axis], node.plane.normal));
        let length = (u * u + v * v).sqrt();
        let inward = if length > 0.0 {
            let direction = [0, 1, 2].map(|k| (u * rows[0][k] + v * rows[1][k]) / length);
            least_magnitude(node.extent(direction, (u * origin[0] + v * origin[1]) / length))
        } else {
            0.0
        };
        Some(NodeRing { near: (x * x + y * y).sqrt().max(inward), low, high })
    }
}
