//! The deepest point of triangles in a tool, by brute force.
//!
//! A signed distance is 1-Lipschitz, so a triangle whose centre is shallower than the best sample by more than the
//! triangle's radius is skipped. The others are sampled at their corners, at random points and at the feet of random
//! points of the tool. From the best samples a search climbs by decreasing random steps.

use crate::prelude::*;
use std::cell::Cell;
use touchoff_tests::oracle::triangle::{Point, nearest, point};
use touchoff_tests::oracle::vector::{add, distance, dot, sub, unit};

/// Maximum number of triangles that are sampled at a pose, and number of samples of each kind over all of them and at least
/// per triangle. Fewer triangles nearby get more samples each, up to a maximum.
const EFFORT: [usize; 3] = [1000, 600, 8];
const MAX_SAMPLES_PER_TRIANGLE: usize = 150;
/// Number of samples from which the search climbs, maximum number of them per triangle, and number of steps.
const CLIMBS: usize = 6;
const MAX_CLIMBS_PER_TRIANGLE: usize = 3;
pub(crate) const STEPS_PER_CLIMB: usize = 500;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) triangle: usize,
    /// In the tool's frame and unit.
    pub(crate) point: Point,
    /// The depth, or another value to be maximised, in the part's unit.
    pub(crate) value: f64,
}

/// A ball in the part's frame and unit.
#[derive(Clone, Copy)]
pub(crate) struct Ball {
    pub(crate) centre: Point3<f64>,
    pub(crate) radius: f64,
}

pub(crate) struct BruteForce<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) oracle: &'a dyn Oracle,
    /// The tool by its profile, if its depth is the distance to that.
    pub(crate) profile: Option<&'a Nearest>,
    /// The tool's unit of length, in the part's unit.
    pub(crate) length: f64,
    /// The sum of the tool's size, the part's size and the part's distance from the origin, in the part's unit.
    pub(crate) size: f64,
    /// Bounding ball of each triangle, about its centroid.
    pub(crate) bounding_balls: Vec<Ball>,
    /// Bounding balls of groups of consecutive triangles.
    group_balls: Vec<Ball>,
    pub(crate) evaluations: Cell<u64>,
}

const TRIANGLES_PER_GROUP: usize = 32;

/// A pose: its tip, and the tool's axes in the world frame.
pub(crate) struct ToolFrame {
    tip: Point3<f64>,
    axes: [[f64; 3]; 3],
}

fn bounding_ball(balls: &[Ball]) -> Ball {
    let centres = balls.iter().map(|ball| ball.centre.coords);
    let centre = Point3::from(centres.sum::<Vector3<f64>>() / balls.len() as f64);
    let radii = balls.iter().map(|ball| (ball.centre - centre).norm() + ball.radius);
    Ball { centre, radius: radii.fold(0.0, f64::max) * (1.0 + 1e-12) }
}

impl<'a> BruteForce<'a> {
    /// Prepares the triangles of a mesh. `length` is the tool's unit of length in the mesh's unit.
    pub(crate) fn new(mesh: &'a Mesh, oracle: &'a Nearest, length: f64) -> BruteForce<'a> {
        BruteForce { profile: Some(oracle), ..BruteForce::of_field(mesh, oracle, length) }
    }

    /// The same for a tool that is known by its depth alone.
    pub(crate) fn of_field(mesh: &'a Mesh, oracle: &'a dyn Oracle, length: f64) -> BruteForce<'a> {
        let [low, high] = mesh.bounds();
        let [radius, height] = oracle.extent();
        let max_coordinate = low.coords.amax().max(high.coords.amax());
        let balls = triangles(mesh).map(|corners| {
            let [a, b, c] = corners.map(|corner| corner.coords);
            let centre = Point3::from((a + b + c) / 3.0);
            let radii = corners.map(|corner| (corner - centre).norm());
            Ball { centre, radius: radii[0].max(radii[1]).max(radii[2]) }
        });
        let balls: Vec<_> = balls.collect();
        BruteForce {
            length,
            group_balls: balls.chunks(TRIANGLES_PER_GROUP).map(bounding_ball).collect(),
            size: (high - low).norm() + max_coordinate + (radius + height) * length,
            bounding_balls: balls,
            evaluations: Cell::new(0),
            profile: None,
            mesh,
            oracle,
        }
    }

    pub(crate) fn tool_frame(&self, pose: &Pose) -> ToolFrame {
        let rotation = pose.rotation();
        ToolFrame {
            tip: pose.tip(),
            axes: [0, 1, 2].map(|k| [rotation[(0, k)], rotation[(1, k)], rotation[(2, k)]]),
        }
    }

    pub(crate) fn to_tool_frame(&self, frame: &ToolFrame, point: Point3<f64>) -> Point {
        let offset = point - frame.tip;
        frame.axes.map(|axis| dot(&axis, &offset.into()) / self.length)
    }

    /// Returns a point of the world in the tool's frame and unit.
    pub(crate) fn point_in_tool_frame(&self, pose: &Pose, point: Point3<f64>) -> Point {
        self.to_tool_frame(&self.tool_frame(pose), point)
    }

    /// Returns the depth of a witness and its distance from its triangle, in the part's unit.
    pub(crate) fn witness(&self, pose: &Pose, witness: &Witness) -> (f64, f64) {
        let frame = self.tool_frame(pose);
        let point = self.to_tool_frame(&frame, witness.point);
        let triangle = self.triangle(&frame, witness.triangle.index());
        let off = distance(&point, &nearest(point, &triangle));
        (self.depth(point), off * self.length)
    }

    /// Returns a triangle in the tool's frame and unit.
    pub(crate) fn triangle(&self, frame: &ToolFrame, id: usize) -> [Point; 3] {
        self.mesh.triangle(TriangleId(id as u32)).map(|corner| self.to_tool_frame(frame, corner))
    }

    /// Returns the depth of a point of the tool's frame, in the part's unit; it is negative outside.
    pub(crate) fn depth(&self, p: Point) -> f64 {
        self.evaluations.set(self.evaluations.get() + 1);
        let field = if self.profile.is_some() { None } else { self.oracle.evaluate(p) };
        let depth = field.map_or_else(|| -self.oracle.signed_distance(p), |inside| inside.depth);
        depth * self.length
    }

    /// Returns the greatest depth found, in the part's unit; it is minus the least distance found if no sample is inside.
    pub(crate) fn deepest(&self, frame: &ToolFrame, rng: &mut Rng) -> f64 {
        let starts = self.deepest_samples(frame, EFFORT, rng).into_iter().take(CLIMBS);
        let depth = |p| self.depth(p);
        let climb = |start| self.climb(frame, start, STEPS_PER_CLIMB, depth, rng).value;
        starts.map(climb).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns samples of the triangles that may be deepest, the deepest first. The effort is the maximum number of these
    /// triangles, and the number of samples of each kind over all of them and at least per triangle.
    pub(crate) fn deepest_samples(
        &self,
        frame: &ToolFrame,
        [max_triangles, total, least]: [usize; 3],
        rng: &mut Rng,
    ) -> Vec<Sample> {
        let [radius, height] = self.oracle.extent();
        // No point of a ball beside the tool's bounding cylinder is nearer than that.
        let depth_bound = |ball: &Ball| {
            let [x, y, z] = self.to_tool_frame(frame, ball.centre);
            let gap = (x.hypot(y) - radius).max(0.0).hypot((z - height).max(-z).max(0.0));
            if gap > 0.0 { ball.radius - gap * self.length } else { f64::INFINITY }
        };
        let bounds = self.group_balls.iter().map(depth_bound).enumerate();
        let mut groups: Vec<(usize, f64)> = bounds.collect();
        groups.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (mut best, mut samples, mut candidates) = (f64::NEG_INFINITY, Vec::new(), Vec::new());
        for (group, bound) in groups {
            if bound < best {
                break;
            }
            let members = self.bounding_balls.iter().enumerate().skip(TRIANGLES_PER_GROUP * group);
            for (triangle, ball) in members.take(TRIANGLES_PER_GROUP) {
                if depth_bound(ball) < best {
                    continue;
                }
                let point = self.to_tool_frame(frame, ball.centre);
                let value = self.depth(point);
                candidates.push((value + ball.radius * (1.0 + 1e-9), triangle));
                if value > best {
                    best = value;
                    samples = vec![Sample { triangle, point, value }];
                }
            }
        }
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        let count = (total / candidates.len()).clamp(least, MAX_SAMPLES_PER_TRIANGLE);
        for (bound, triangle) in candidates.into_iter().take(max_triangles) {
            if bound <= best {
                break;
            }
            let sampled = self.sample(frame, triangle, count, |p| self.depth(p), rng);
            best = best.max(sampled[0].value);
            samples.extend(sampled.into_iter().take(MAX_CLIMBS_PER_TRIANGLE));
        }
        samples.sort_by(|a, b| b.value.total_cmp(&a.value));
        samples
    }

    /// Returns whether a ball of the tool's frame overlaps the tool's bounding cylinder.
    pub(crate) fn is_near(&self, centre: Point, reach: f64) -> bool {
        let [radius, height] = self.oracle.extent();
        let [x, y, z] = centre;
        z + reach >= 0.0 && z - reach <= height && x.hypot(y) <= radius + reach
    }

    /// Returns samples of a triangle: its corners, and `count` points of each kind. The one with the largest value comes
    /// first.
    pub(crate) fn sample(
        &self,
        frame: &ToolFrame,
        triangle: usize,
        count: usize,
        value: impl Fn(Point) -> f64,
        rng: &mut Rng,
    ) -> Vec<Sample> {
        let [radius, height] = self.oracle.extent();
        let corners = self.triangle(frame, triangle);
        let mut points = corners.to_vec();
        for _ in 0..count {
            points.push(point(&corners, rng.weights()));
            // Half of the points are near the tip.
            let max_height = if rng.once_in(2) { height } else { height.min(2.0 * radius) };
            let mut offset = || rng.between(-1.0, 1.0) * radius;
            points.push(nearest([offset(), offset(), rng.between(0.0, max_height)], &corners));
        }
        let sample = |point| Sample { triangle, point, value: value(point) };
        let mut samples: Vec<Sample> = points.into_iter().map(sample).collect();
        samples.sort_by(|a, b| b.value.total_cmp(&a.value));
        samples
    }

    /// Climbs from a sample on its triangle by random steps, which grow after an improvement and shrink otherwise. Returns
    /// the sample with the largest value reached.
    pub(crate) fn climb(
        &self,
        frame: &ToolFrame,
        start: Sample,
        steps: usize,
        value: impl Fn(Point) -> f64,
        rng: &mut Rng,
    ) -> Sample {
        let triangle = self.triangle(frame, start.triangle);
        let [a, b, c] = &triangle;
        let mut current = nearest(start.point, &triangle);
        let mut best = value(current);
        let mut last_direction = [0.0; 3];
        let mut step =
            distance(a, b).max(distance(b, c)).max(distance(c, a)).min(self.oracle.extent()[0]);
        let mut failed = 0;
        for k in 0..steps {
            if step < 1e-11 {
                break;
            }
            // Few directions lead up along a ridge, so the last successful direction is tried again.
            let direction = if k % 4 == 0 && last_direction != [0.0; 3] {
                last_direction
            } else {
                rng.direction()
            };
            let next = nearest(add(&current, &direction, &step), &triangle);
            let new_value = value(next);
            if new_value > best {
                last_direction = unit(&sub(&next, &current));
                (best, current, failed) = (new_value, next, 0);
                step *= 1.5;
            } else {
                failed += 1;
                if failed % 4 == 0 {
                    step *= 0.6;
                }
            }
        }
        Sample { value: best, point: current, ..start }
    }
}
