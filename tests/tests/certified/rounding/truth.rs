//! Search for the deepest point of triangles in a tool, in doubles, with the depth evaluated in 256 bits.
//!
//! A candidate point is a convex combination of a triangle's corners, so it lies on the triangle exactly. Its depth in
//! 256 bits is a lower bound of the greatest depth, however the point was found.

use super::cutters::Cutter;
use crate::prelude::*;
use touchoff_tests::oracle::Meridian;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::space::{Frame, Triple, exactly, to_f64};
pub(crate) use touchoff_tests::oracle::triangle::Point;
use touchoff_tests::oracle::triangle::{mean, nearest_weights};
use touchoff_tests::oracle::vector::dot;

/// Number of starting points of the search, steps per start, and additional steps for the best of them.
const CLIMBS: usize = 3;
const STEPS_PER_CLIMB: usize = 60;
const FINAL_STEPS: usize = 120;

pub(crate) struct Scene<'a> {
    pub(crate) cutter: &'a Cutter,
    /// The corners of each triangle, in the tool's frame and in doubles.
    pub(crate) triangles: Vec<[Point; 3]>,
    /// The same corners in 256 bits.
    exact: Vec<[Triple; 3]>,
}

/// A point on a triangle, by its unnormalised barycentric weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrianglePoint {
    pub(crate) triangle: usize,
    /// Weights that are not negative and not all 0.
    pub(crate) weights: Point,
}

/// The deepest point that a climb reached.
pub(crate) struct Climbed {
    pub(crate) depth: f64,
    pub(crate) point: TrianglePoint,
    /// The last step size.
    pub(crate) step: f64,
}

impl<'a> Scene<'a> {
    /// Transforms triangles from the world to the tool's frame. The pose maps that frame to the world: `p = R q + tip`.
    pub(crate) fn new(cutter: &'a Cutter, pose: &Pose, triangles: &[[Point; 3]]) -> Scene<'a> {
        let frame = Frame::new(pose.rotation(), pose.tip());
        let to_tool = |corner: Point| frame.to_tool(&exactly(corner));
        let exact: Vec<_> = triangles.iter().map(|corners| corners.map(to_tool)).collect();
        let double = |corners: &[Triple; 3]| corners.each_ref().map(to_f64);
        Scene { cutter, triangles: exact.iter().map(double).collect(), exact }
    }

    /// Returns the point in the tool's frame, in doubles.
    pub(crate) fn point(&self, point: &TrianglePoint) -> Point {
        mean(&self.triangles[point.triangle], point.weights)
    }

    /// Returns the depth of a point, computed in doubles.
    pub(crate) fn depth(&self, point: &TrianglePoint) -> f64 {
        let [x, y, z] = self.point(point);
        self.cutter.profile.depth(&[x.hypot(y), z])
    }

    /// Returns the depth of a point, computed in 256 bits.
    pub(crate) fn exact_depth(&self, triangle_point: &TrianglePoint) -> Big {
        let corners = &self.exact[triangle_point.triangle];
        let weights = exactly(triangle_point.weights);
        let sum = &(&weights[0] + &weights[1]) + &weights[2];
        let point = [0, 1, 2].map(|axis| {
            let column = [0, 1, 2].map(|k| corners[k][axis].clone());
            &dot(&weights, &column) / &sum
        });
        self.cutter.reference.depth(&Meridian::of(point))
    }

    /// Returns the point of a triangle that is approximately nearest to `p`, which is in the tool's frame.
    pub(crate) fn nearest(&self, triangle: usize, p: Point) -> TrianglePoint {
        TrianglePoint { triangle, weights: nearest_weights(p, &self.triangles[triangle]) }
    }

    pub(crate) fn deepest(&self, rng: &mut Rng) -> TrianglePoint {
        let mut starts = Vec::new();
        for triangle in 0..self.triangles.len() {
            self.starts(triangle, rng, &mut starts);
        }
        let mut starts: Vec<_> =
            starts.into_iter().map(|point| (self.depth(&point), point)).collect();
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        starts.truncate(CLIMBS);
        let climbed = starts.iter().map(|(_, point)| self.climb(point, 0.3, STEPS_PER_CLIMB, rng));
        let best =
            climbed.max_by(|a, b| a.depth.total_cmp(&b.depth)).expect("a triangle has starts");
        self.climb(&best.point, best.step, FINAL_STEPS, rng).point
    }

    /// Appends starting points: corners, points on edges and inside, and feet of points of the tool.
    fn starts(&self, triangle: usize, rng: &mut Rng, starts: &mut Vec<TrianglePoint>) {
        let mut add = |weights: Point| starts.push(TrianglePoint { triangle, weights });
        for k in 0..3 {
            let mut corner = [0.0; 3];
            corner[k] = 1.0;
            add(corner);
            for _ in 0..3 {
                let fraction = rng.between(0.0, 1.0);
                let mut edge = [0.0; 3];
                edge[k] = fraction;
                edge[(k + 1) % 3] = 1.0 - fraction;
                add(edge);
            }
        }
        for _ in 0..6 {
            add([0; 3].map(|_| rng.between(0.0, 1.0)));
        }
        let corners = &self.triangles[triangle];
        let height = self.cutter.extent[1];
        for _ in 0..4 {
            add(nearest_weights([0.0, 0.0, rng.between(0.0, height)], corners));
        }
        for segment in self.cutter.profile.segments() {
            let ([d, z], [cos, sin]) = (segment.centre().unwrap_or(&segment.to), rng.azimuth());
            add(nearest_weights([d * cos, d * sin, *z], corners));
        }
    }

    /// Climbs from a point by random steps. The step grows after an improvement and shrinks otherwise.
    pub(crate) fn climb(
        &self,
        start: &TrianglePoint,
        step: f64,
        steps: usize,
        rng: &mut Rng,
    ) -> Climbed {
        let (mut best, mut current, mut step) = (self.depth(start), *start, step);
        let mut last_change = [0.0; 3];
        for k in 0..steps {
            if step < 1e-17 {
                break;
            }
            // Few directions lead up along a ridge, so the last successful direction is tried again.
            let change = if k % 3 == 0 && last_change != [0.0; 3] {
                last_change
            } else {
                let [u, v] = [rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)];
                [u, v, -u - v]
            };
            let moved = [0, 1, 2].map(|k| (current.weights[k] + step * change[k]).max(0.0));
            let sum = moved[0] + moved[1] + moved[2];
            let next = TrianglePoint { weights: moved.map(|weight| weight / sum), ..current };
            let depth = self.depth(&next);
            if depth > best {
                (best, current, last_change) = (depth, next, change);
                step = (step * 1.8).min(0.5);
            } else {
                step *= 0.7;
            }
        }
        Climbed { depth: best, point: current, step }
    }
}
