//! Whether a point is inside a part: how often its surface goes around the point, by what a ray crosses.

use super::Facets;
use crate::tree::WIDTH;
use nalgebra::{Point3, Vector3};

/// Ways that no edge of a part is likely to lie along.
const WAYS: [[f64; 3]; 6] = [
    [0.5377, 0.6421, 0.5465],
    [-0.7013, 0.4547, -0.5492],
    [0.2915, -0.8349, 0.4669],
    [-0.4129, -0.3607, 0.8363],
    [0.8713, -0.2287, -0.4341],
    [-0.1741, 0.5613, -0.8091],
];

impl Facets {
    /// Whether a point of the world, in the part's unit, is inside the part: `None` if the part has no
    /// inside, or the point is so near to its surface that rounding would decide.
    pub(crate) fn contains(&self, point: Point3<f64>) -> Option<bool> {
        if !self.solid {
            return None;
        }
        let p = self.frame.inside([point.x, point.y, point.z]);
        let size = f64::from(self.frame.size);
        if p.iter().any(|part| part.abs() > size) {
            return Some(false);
        }
        WAYS.iter().find_map(|way| self.turns(point, Vector3::from(*way))).map(|turns| turns > 0)
    }

    /// How often the surface goes around a point, by what a ray crosses; `None` if it comes too near to
    /// an edge.
    fn turns(&self, point: Point3<f64>, way: Vector3<f64>) -> Option<i32> {
        let p = self.frame.inside([point.x, point.y, point.z]);
        let mut turns = 0;
        let mut stack = vec![(0, 0)];
        while let Some((level, index)) = stack.pop() {
            for lane in 0..self.children(level, index) {
                let child = index * WIDTH + lane;
                if let Some(level_boxes) = self.levels.get(level) {
                    let boxes = &level_boxes[index];
                    let near = |axis: usize| {
                        let from = f64::from(boxes.centre[axis][lane]) - p[axis];
                        let half = f64::from(boxes.half[axis][lane]) * (1.0 + 1e-6) + 1e-12;
                        let [a, b] = [(from - half) / way[axis], (from + half) / way[axis]];
                        [a.min(b), a.max(b)]
                    };
                    let ([a, b], [c, d], [e, f]) = (near(0), near(1), near(2));
                    if a.max(c).max(e).max(0.0) <= b.min(d).min(f) {
                        stack.push((level + 1, child));
                    }
                } else {
                    turns += self.crossing(child, point, &way)?;
                }
            }
        }
        Some(turns)
    }

    /// 1 if a ray leaves through a triangle's outer side, -1 if it enters, 0 if it misses; `None` where
    /// rounding would decide.
    fn crossing(&self, triangle: usize, point: Point3<f64>, way: &Vector3<f64>) -> Option<i32> {
        let [a, b, c] = self.corners[triangle].map(|corner| Point3::from(corner) - point);
        let largest = a.amax().max(b.amax()).max(c.amax());
        let nearly = 64.0 * f64::EPSILON * largest * largest;
        let sides = [a.cross(&b), b.cross(&c), c.cross(&a)].map(|normal| normal.dot(way));
        if sides.iter().any(|side| *side > nearly) && sides.iter().any(|side| *side < -nearly) {
            return Some(0);
        }
        if sides.iter().any(|side| side.abs() <= nearly) {
            return None;
        }
        // The ray's line crosses; it does so ahead if the plane is ahead.
        let normal = (b - a).cross(&(c - a));
        let (along, ahead) = (normal.dot(way), normal.dot(&a));
        if ahead.abs() <= nearly * largest {
            return None;
        }
        let forward = ahead * along > 0.0;
        Some(if forward { if along > 0.0 { 1 } else { -1 } } else { 0 })
    }
}
