//! The greatest depth of a tool during a motion, by sampling many times and points.
//!
//! Each time is sampled as a pose. A triangle whose centre is shallower than the best sample by more than the
//! triangle's radius is skipped; the others are sampled. From the best samples a search climbs in time and position at
//! once.

use crate::brute::Sample;
use crate::prelude::*;
use touchoff_tests::oracle::triangle::{Point, nearest};
use touchoff_tests::oracle::vector::add;

/// Maximum number of triangles that are sampled at a time, and number of samples of each kind over all of them and at least
/// per triangle.
const EFFORT: [usize; 3] = [40, 160, 4];
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
    /// Returns the deepest sample at a time.
    pub(crate) fn deepest_at(
        &self,
        motion: &ReferenceMotion,
        t: f64,
        rng: &mut Rng,
    ) -> MotionSample {
        let pose = motion.pose(t);
        let samples = self.deepest_samples(&self.tool_frame(&pose), EFFORT, rng);
        let Sample { triangle, point, value: depth } = samples[0];
        let offset = pose.rotation() * Vector3::from(point) * self.length;
        MotionSample { t, triangle, point: (pose.tip() + offset).into(), depth }
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
