//! The depth of each surface of a tool by sampling, and its excess over the surface's allowance.

use super::brute::{BruteForce, Point, distance, nearest};
use touchoff::Pose;
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;

/// Maximum number of triangles sampled per pose, and number of samples per triangle.
const MAX_TRIANGLES: usize = 300;
const SAMPLES_PER_TRIANGLE: usize = 8;
/// Number of samples from which the search climbs, and number of steps.
const CLIMBS: usize = 3;
const STEPS_PER_CLIMB: usize = 250;

/// A sample of a triangle, in the tool's frame and unit.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The index of the triangle.
    pub triangle: usize,
    /// The point.
    pub point: Point,
    /// The depth, or its excess over the allowance, in the part's unit.
    pub value: f64,
}

/// A tool's surfaces with their allowances, and a part.
pub struct SurfaceAllowances<'a> {
    /// The part's triangles and the tool.
    pub brute: &'a BruteForce<'a>,
    /// The surfaces' names, in the tool's order.
    pub surface_names: Vec<String>,
    /// The allowances of the surfaces, in the part's unit. A negative one is a distance to keep.
    pub allowances: Vec<f64>,
}

impl SurfaceAllowances<'_> {
    /// Returns the distance of a point from a surface, in the part's unit.
    pub fn distance_to_surface(&self, surface: usize, p: Point) -> f64 {
        self.brute.oracle.distance_to_surface(&self.surface_names[surface], p) * self.brute.length
    }

    /// Returns the depth of a point, in the part's unit, if the point is inside and the surface is the nearest by more
    /// than rounding. Returns negative infinity otherwise. At 2e-9 from a tangent joint, two distances differ by only
    /// 1e-18.
    pub fn depth(&self, surface: usize, p: Point) -> f64 {
        let depth = self.brute.depth(p) * self.brute.length;
        let own_distance =
            self.distance_to_surface(surface, p) + 8.0 * f64::EPSILON * self.brute.size;
        let other_surfaces = (0..self.surface_names.len()).filter(|other| *other != surface);
        let is_nearest = other_surfaces
            .into_iter()
            .all(|other| own_distance <= self.distance_to_surface(other, p));
        if depth >= 0.0 && is_nearest { depth } else { f64::NEG_INFINITY }
    }

    /// Returns the largest excess of a point's depth over an allowance, or of a distance to keep over the point's
    /// distance.
    pub fn max_excess(&self, p: Point) -> f64 {
        let excess = |surface: usize| {
            let allowed = self.allowances[surface];
            let excess_depth = self.depth(surface, p) - allowed.max(0.0);
            if allowed < 0.0 {
                excess_depth.max(-self.distance_to_surface(surface, p) - allowed)
            } else {
                excess_depth
            }
        };
        let excesses = (0..self.surface_names.len()).map(excess).filter(|over| !over.is_nan());
        excesses.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns samples of the triangles near a pose, with the value NaN.
    pub fn samples(&self, pose: &Pose, rng: &mut Rng) -> Vec<Sample> {
        let (brute, frame) = (self.brute, self.brute.tool_frame(pose));
        let [radius, height] = brute.oracle.extent();
        let max_margin =
            self.allowances.iter().fold(0.0, |max_margin: f64, allowed| max_margin.max(-allowed));
        let near = |id: &usize| {
            let (middle, reach) = brute.bounding_balls[*id];
            let (p, reach) =
                (brute.to_tool_frame(&frame, middle), (reach + max_margin) / brute.length);
            p[2] + reach >= 0.0 && p[2] - reach <= height && p[0].hypot(p[1]) <= radius + reach
        };
        let mut near: Vec<usize> = (0..brute.bounding_balls.len()).filter(near).collect();
        while near.len() > MAX_TRIANGLES {
            near.swap_remove(rng.bits() as usize % near.len());
        }
        let count = SAMPLES_PER_TRIANGLE * (MAX_TRIANGLES / near.len().max(1)).clamp(1, 8);
        let mut samples = Vec::new();
        for triangle in near {
            let corners = brute.triangle(&frame, triangle);
            let mut add = |point| samples.push(Sample { triangle, point, value: f64::NAN });
            corners.into_iter().for_each(&mut add);
            for _ in 0..count {
                let max_height = if rng.bits().is_multiple_of(2) { height } else { 2.0 * radius };
                let mut offset = || rng.between(-1.0, 1.0) * radius;
                let tool_point = [offset(), offset(), rng.between(0.0, max_height)];
                add(nearest(tool_point, &corners));
            }
        }
        samples
    }

    /// Returns the largest value over the samples and a search from the best of them.
    pub fn max_sample(
        &self,
        pose: &Pose,
        samples: &[Sample],
        value: impl Fn(Point) -> f64,
        rng: &mut Rng,
    ) -> Option<Sample> {
        let evaluated =
            samples.iter().map(|sample| Sample { value: value(sample.point), ..*sample });
        let mut evaluated: Vec<Sample> =
            evaluated.filter(|sample| sample.value > f64::NEG_INFINITY).collect();
        evaluated.sort_by(|a, b| b.value.total_cmp(&a.value));
        evaluated.truncate(CLIMBS);
        let climbed = evaluated.into_iter().map(|from| self.climb(pose, from, &value, rng));
        climbed.max_by(|a, b| a.value.total_cmp(&b.value))
    }

    fn climb(
        &self,
        pose: &Pose,
        start: Sample,
        value: impl Fn(Point) -> f64,
        rng: &mut Rng,
    ) -> Sample {
        let triangle = self.brute.triangle(&self.brute.tool_frame(pose), start.triangle);
        let [a, b, c] = triangle;
        let longest_edge = distance(a, b).max(distance(b, c)).max(distance(c, a));
        let (mut step, mut best, mut failed) =
            (longest_edge.min(self.brute.oracle.extent()[0]), start, 0);
        for _ in 0..STEPS_PER_CLIMB {
            let direction = rng.direction();
            let next = [0, 1, 2].map(|axis| best.point[axis] + step * direction[axis]);
            let point = nearest(next, &triangle);
            let new_value = value(point);
            if new_value > best.value {
                (best, failed) = (Sample { point, value: new_value, ..best }, 0);
                step *= 1.5;
            } else {
                failed += 1;
                if failed % 4 == 0 {
                    step *= 0.6;
                }
            }
        }
        best
    }
}
