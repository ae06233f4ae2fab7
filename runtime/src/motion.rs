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
        let start = match Unit::try_new(across - first * first.dot(&across), 0.0) {
            Some(second) => Matrix3::from_columns(&[second.cross(&first), *second, first]),
            None => *from.rotation(),
        };
        Ok(Motion { tip: from.tip(), way, start, angle: size.atan2(cosine) })
    }

    /// The pose at a part of the way, from 0 to 1.
    pub fn pose(&self, part: f64) -> Pose {
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
