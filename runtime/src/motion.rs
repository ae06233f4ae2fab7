//! How a tool goes from one pose to another.

use crate::pose::Pose;
use nalgebra::{Matrix3, Point3, Unit, Vector3};

/// A tool's way from one pose to another, as a 5-axis program means it: the tip goes straight, the
/// axis turns about the normal of both axes (spherical interpolation), both evenly. What spin the tool has
/// is not felt, and is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    tip: Point3<f64>,
    way: Vector3<f64>,
    /// The rotation at the start; its second column is what the axis turns about, at all times the tool's
    /// second axis.
    start: Matrix3<f64>,
    angle: f64,
}

/// Two poses between which there is no one way.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The axes are opposite, so that the axis may turn any way.
    #[error("the axis turns to its opposite, so that which way is not said: give a pose between")]
    Opposite,
}

/// Axes that are nearer to being opposite turn in a way that rounding decides.
const OPPOSITE: f64 = 1e-9;

impl Motion {
    /// The motion from one pose to another.
    ///
    /// # Errors
    /// If the axes are opposite.
    pub fn new(from: &Pose, to: &Pose) -> Result<Motion, MotionError> {
        let (first, last) = (from.axis(), to.axis());
        let (sine, cosine) = (first.cross(&last), first.dot(&last));
        let size = sine.norm();
        if size < OPPOSITE && cosine < 0.0 {
            return Err(MotionError::Opposite);
        }
        let way = to.tip() - from.tip();
        // What does not turn is seen from where it goes.
        let across = if size > f64::MIN_POSITIVE.sqrt() { sine } else { first.cross(&way) };
        // A product across the axis has no part along it. One that has is rounding: made perpendicular, what
        // is left of it would be rounding again, and the three columns no rotation.
        let second = across - first * first.dot(&across);
        let start = match Unit::try_new(second, 0.5 * across.norm()) {
            Some(second) => Matrix3::from_columns(&[second.cross(&first), *second, first]),
            None => *from.rotation(),
        };
        Ok(Motion { tip: from.tip(), way, start, angle: size.atan2(cosine) })
    }

    /// The pose at a part of the way, from 0 to 1; outside of that it is that of the nearer end.
    ///
    /// # Panics
    /// If the part is NaN, where there is no pose.
    pub fn pose(&self, part: f64) -> Pose {
        assert!(!part.is_nan(), "NaN is no part of a motion: give a number from 0 to 1");
        let part = part.clamp(0.0, 1.0);
        let (sine, cosine) = (part * self.angle).sin_cos();
        let [x, y, z] = [0, 1, 2].map(|axis| Vector3::from(self.start.column(axis)));
        let columns = [cosine * x - sine * z, y, cosine * z + sine * x];
        Pose::turned(Matrix3::from_columns(&columns), self.tip + part * self.way)
    }

    /// Where the tip begins, in the world.
    pub fn start(&self) -> Point3<f64> {
        self.tip
    }

    /// How the tip goes, in the world.
    pub fn way(&self) -> Vector3<f64> {
        self.way
    }

    /// By how much the axis turns, in radians.
    pub fn angle(&self) -> f64 {
        self.angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::off;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Neighbouring axes and plunges along the axis: the cross product that the frame is built on is rounding
    /// and nothing else, and may point along the axis itself.
    #[test]
    fn every_pose_of_a_motion_has_a_rotation() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut uniform = || (random.next_u64() >> 11) as f64 / 2f64.powi(52) - 1.0;
        let mut worst = 0.0f64;
        let mut judge = |from: &Pose, to: &Pose| {
            let motion = Motion::new(from, to).expect("axes that are not opposite");
            for part in [0.0, 0.5, 1.0] {
                worst = worst.max(off(motion.pose(part).rotation()));
            }
        };
        for k in 0..1_000_000 {
            let grid = |v: f64| if k % 2 == 0 { (8.0 * v).round() } else { v };
            let axis = Vector3::new(grid(uniform()), grid(uniform()), grid(uniform()));
            let Some(axis) = Unit::try_new(axis, 1e-3).map(Unit::into_inner) else { continue };
            let tip = Point3::new(uniform(), uniform(), uniform());
            let from = Pose::from_axis(tip, axis).expect("an axis");
            let nudged = axis.map(|part| part * (1.0 + f64::EPSILON * (3.0 * uniform()).round()));
            judge(&from, &Pose::from_axis(tip, nudged).expect("an axis"));
            judge(&from, &Pose::from_axis(tip + from.axis() * uniform(), axis).expect("an axis"));
        }
        // What a certifier counts on. Built on rounding along the axis it was twenty.
        assert!(worst <= 5.0 * f64::EPSILON, "{worst:e}");
    }

    #[test]
    fn a_part_outside_is_that_of_the_nearer_end() {
        let [from, to] = [0.0, 1.0]
            .map(|x| Pose::from_axis(Point3::new(x, 0.0, 0.0), Vector3::z()).expect("a pose"));
        let motion = Motion::new(&from, &to).expect("a motion");
        for (part, end) in [(-1.0, 0.0), (f64::NEG_INFINITY, 0.0), (1.5, 1.0), (1e300, 1.0)] {
            assert_eq!(motion.pose(part).tip().x, end, "{part}");
        }
    }

    #[test]
    #[should_panic(expected = "NaN is no part of a motion")]
    fn a_part_that_is_not_a_number_is_refused() {
        let pose = Pose::default();
        Motion::new(&pose, &pose).expect("a motion").pose(f64::NAN);
    }
}
