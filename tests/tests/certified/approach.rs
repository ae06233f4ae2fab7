//! The greatest depth of a tool during a motion, by sampling many times and points.
//!
//! Each time is sampled as a pose. A triangle whose centre is shallower than the best sample by more than the
//! triangle's radius is skipped; the others are sampled. From the best samples a search climbs in time and position at
//! once.

use crate::brute::{Ball, TRIANGLES_PER_GROUP};
use crate::prelude::*;
use touchoff_tests::oracle::triangle::{Point, nearest};
use touchoff_tests::oracle::vector::add;

/// Maximum number of triangles sampled per pose, and number of samples of each kind per triangle.
const MAX_TRIANGLES: usize = 40;
const SAMPLES_PER_TRIANGLE: usize = 4;
/// Number of times that are refined, number of refinements of each, number of searches, and number of steps per
/// search.
const REFINED_TIMES: usize = 5;
const REFINEMENTS_PER_TIME: usize = 6;
const CLIMBS: usize = 6;
const STEPS_PER_CLIMB: usize = 700;

/// A tool's motion, as it is specified.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReferenceMotion {
    pub(crate) from: Pose,
    pub(crate) to: Pose,
}

impl ReferenceMotion {
    /// Returns the pose at parameter `t` in 0 to 1, with the axis by Shoemake's formula.
    pub(crate) fn pose(&self, t: f64) -> Pose {
        let (a, b) = (self.from.axis(), self.to.axis());
        let angle = self.angle();
        let axis = if angle > 0.0 {
            (((1.0 - t) * angle).sin() * a + (t * angle).sin() * b) / angle.sin()
        } else {
            a
        };
        let tip = (1.0 - t) * self.from.tip().coords + t * self.to.tip().coords;
        Pose::from_axis(Point3::from(tip), axis).expect("axes that are not opposite")
    }

    /// Returns the angle between the first and the last axis, rad.
    pub(crate) fn angle(&self) -> f64 {
        let (a, b) = (self.from.axis(), self.to.axis());
        2.0 * (b - a).norm().atan2((b + a).norm())
    }
}

/// A sample of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionSample {
    /// The time, 0 to 1.
    pub(crate) t: f64,
    pub(crate) triangle: usize,
    /// The point, in the part's frame.
    pub(crate) point: Point,
    /// The depth in the part's unit; minus the distance if the point is outside.
    pub(crate) depth: f64,
}

impl BruteForce<'_> {
    pub(crate) fn deepest_at(
        &self,
        motion: &ReferenceMotion,
        t: f64,
        rng: &mut Rng,
    ) -> MotionSample {
        let pose = motion.pose(t);
        let frame = self.tool_frame(&pose);
        let [radius, height] = self.oracle.extent();
        let mut best =
            MotionSample { t, triangle: 0, point: [f64::NAN; 3], depth: f64::NEG_INFINITY };
        // Upper bound of the depth in a ball, from its distance to the tool's bounding cylinder.
        let depth_bound = |ball: &Ball| {
            let p = self.to_tool_frame(&frame, ball.centre);
            let radial_gap = (p[0].hypot(p[1]) - radius).max(0.0);
            let axial_gap = (p[2] - height).max(-p[2]).max(0.0);
            ball.radius - (radial_gap * radial_gap + axial_gap * axial_gap).sqrt() * self.length
        };
        let bounds = self.group_balls.iter().map(depth_bound).enumerate();
        let mut groups: Vec<(usize, f64)> = bounds.collect();
        groups.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut candidates = Vec::new();
        for (group, bound) in groups {
            if bound < best.depth {
                break;
            }
            let first = TRIANGLES_PER_GROUP * group;
            let members = self.bounding_balls.iter().enumerate().skip(first);
            for (id, ball) in members.take(TRIANGLES_PER_GROUP) {
                if depth_bound(ball) < best.depth {
                    continue;
                }
                let depth = self.depth(self.to_tool_frame(&frame, ball.centre));
                candidates.push((depth + ball.radius, id));
                if depth > best.depth {
                    best = MotionSample { t, triangle: id, point: ball.centre.into(), depth };
                }
            }
        }
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (bound, id) in candidates.into_iter().take(MAX_TRIANGLES) {
            if bound < best.depth {
                break;
            }
            let sample = self.sample(&frame, id, SAMPLES_PER_TRIANGLE, |p| self.depth(p), rng)[0];
            if sample.value > best.depth {
                let offset = pose.rotation() * Vector3::from(sample.point) * self.length;
                let point = (pose.tip() + offset).into();
                best = MotionSample { t, triangle: id, point, depth: sample.value };
            }
        }
        best
    }

    /// Returns the deepest sample of a whole motion, at `times` random times and at both ends. If `closely`, also
    /// refines around the best of them.
    pub(crate) fn deepest_in_motion(
        &self,
        motion: &ReferenceMotion,
        times: u32,
        closely: bool,
        rng: &mut Rng,
    ) -> MotionSample {
        let step = 1.0 / f64::from(times);
        let random_time = |k| (f64::from(k) + rng.between(0.0, 1.0)) * step;
        let mut sampled_times: Vec<f64> = (0..times).map(random_time).collect();
        sampled_times.extend([0.0, 1.0]);
        let mut samples: Vec<MotionSample> =
            sampled_times.into_iter().map(|t| self.deepest_at(motion, t, rng)).collect();
        let sort_deepest_first =
            |samples: &mut Vec<MotionSample>| samples.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        sort_deepest_first(&mut samples);
        for k in 0..if closely { REFINED_TIMES.min(samples.len()) } else { 0 } {
            for _ in 0..REFINEMENTS_PER_TIME {
                let t = (samples[k].t + rng.between(-step, step)).clamp(0.0, 1.0);
                samples.push(self.deepest_at(motion, t, rng));
            }
        }
        sort_deepest_first(&mut samples);
        let starts = samples.iter().take(if closely { CLIMBS } else { 1 });
        let climbed = starts.map(|from| self.climb_in_time(motion, *from, step, rng));
        let deeper = |a: MotionSample, b: MotionSample| if b.depth > a.depth { b } else { a };
        climbed.fold(samples[0], deeper)
    }

    /// Climbs in time and position from a sample, and returns the deepest sample reached.
    fn climb_in_time(
        &self,
        motion: &ReferenceMotion,
        start: MotionSample,
        step: f64,
        rng: &mut Rng,
    ) -> MotionSample {
        let corners = self.mesh.triangle(TriangleId(start.triangle as u32)).map(Into::into);
        let mut best = start;
        let radius = self.bounding_balls[start.triangle].radius;
        let mut distance = radius.min(self.length * self.oracle.extent()[0]);
        let mut time_step = step;
        let mut failed = 0;
        for k in 0..STEPS_PER_CLIMB {
            if time_step < 1e-17 && distance < 1e-14 {
                break;
            }
            let time_change = if k % 3 == 0 { 0.0 } else { time_step * rng.between(-1.0, 1.0) };
            let t = (best.t + time_change).clamp(0.0, 1.0);
            let offset = if k % 3 == 1 { 0.0 } else { distance };
            let direction = rng.direction();
            let p = nearest(add(&best.point, &direction, &offset), &corners);
            let depth = self.depth(self.point_in_tool_frame(&motion.pose(t), Point3::from(p)));
            if depth > best.depth {
                best = MotionSample { t, point: p, depth, ..best };
                failed = 0;
                (time_step, distance) = ((1.3 * time_step).min(step), 1.3 * distance);
            } else {
                failed += 1;
                if failed % 5 == 0 {
                    (time_step, distance) = (0.6 * time_step, 0.6 * distance);
                }
            }
        }
        best
    }
}
