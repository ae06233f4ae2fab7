//! Where triangles lie in a plane: how deep a node can be by that plane, in `f64`.
//!
//! A flat end on a plate is as deep in all of its triangles, and `f32` cannot tell one from another. What
//! a node's triangles have along a normal can.

use super::Facets;
use crate::bvh::{PoseTransform, WIDTH};
use crate::certify::space::{Point, dot};

/// Between which heights along a normal the corners of a node's triangles lie, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    normal: Point,
    ends: [f64; 2],
}

/// What a node has in the tool's frame: no place of it is nearer to the axis or beyond these heights.
pub(crate) struct Ring {
    pub(crate) near: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Plane {
    /// Of triangles, given by their corners in the tree's frame: along the mean of their normals.
    pub(crate) fn of(triangles: &[[Point; 3]]) -> Plane {
        let mut sum = [0.0; 3];
        for [a, b, c] in triangles {
            let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
            sum[0] += u[1] * v[2] - u[2] * v[1];
            sum[1] += u[2] * v[0] - u[0] * v[2];
            sum[2] += u[0] * v[1] - u[1] * v[0];
        }
        let length = dot(sum, sum).sqrt();
        // Any direction will do.
        let normal = if length > 0.0 { sum.map(|part| part / length) } else { [0.0, 0.0, 1.0] };
        let heights = triangles.iter().flatten().map(|corner| dot(normal, *corner));
        let ends = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
            [low.min(height), high.max(height)]
        });
        Plane { normal, ends }
    }
}

impl Facets {
    /// The ring about the tool's axis that a node is within, by its box and its plane; the whole part has
    /// no box.
    pub(crate) fn ring(&self, level: usize, index: usize, view: &PoseTransform) -> Option<Ring> {
        let boxes = &self.levels[level.checked_sub(1)?][index / WIDTH];
        let lane = index % WIDTH;
        let centre = [0, 1, 2].map(|axis| f64::from(boxes.centre[axis][lane]));
        let half = [0, 1, 2].map(|axis| f64::from(boxes.half[axis][lane]));
        let Plane { normal, ends } = self.planes[level][index];
        let (rows, origin) = view.exactly();
        // How far the node reaches along a direction of the tool's frame, given as the part's: as much of
        // it as is normal to the plane is known closely.
        let along = |way: Point, from: f64| {
            let part = dot(way, normal);
            let rest = [0, 1, 2].map(|k| way[k] - part * normal[k]);
            let wide = dot(rest.map(f64::abs), half);
            let middle = from + dot(rest, centre);
            let [a, b] = ends.map(|end| part * end);
            let flat = [middle + a.min(b) - wide, middle + a.max(b) + wide];
            let boxed = [-1.0, 1.0]
                .map(|side| from + dot(way, centre) + side * dot(way.map(f64::abs), half));
            [flat[0].max(boxed[0]), flat[1].min(boxed[1])]
        };
        let [low, high] = along(rows[2], origin[2]);
        let apart = |[low, high]: [f64; 2]| low.max(-high).max(0.0);
        let [x, y] = [0, 1].map(|axis| apart(along(rows[axis], origin[axis])));
        // Toward the axis along the plane's normal.
        let [u, v] = [dot(rows[0], normal), dot(rows[1], normal)];
        let level = (u * u + v * v).sqrt();
        let inward = if level > 0.0 {
            let way = [0, 1, 2].map(|k| (u * rows[0][k] + v * rows[1][k]) / level);
            apart(along(way, (u * origin[0] + v * origin[1]) / level))
        } else {
            0.0
        };
        Some(Ring { near: (x * x + y * y).sqrt().max(inward), low, high })
    }
}
