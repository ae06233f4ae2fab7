//! Motions of a tool from one pose to another.

use crate::pose::{Pose, orthonormal};
use nalgebra::{Matrix3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};

/// A motion of a tool from one pose to another at constant speed, with the tip on a straight line.
///
/// [`Motion::new`] rotates the axis about the common normal of both axes (spherical interpolation), as
/// 5-axis programs prescribe. The spin about the axis is chosen arbitrarily, since a tool of revolution
/// does not depend on it. [`Motion::with_spin`] rotates the whole frame about one fixed axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    tip: Point3<f64>,
    displacement: Vector3<f64>,
    /// The initial rotation of the rotating frame, whose second column is the axis of rotation.
    start: Matrix3<f64>,
    /// The rotation from the tool frame to the rotating frame, if they differ; the spin is then known.
    frame: Option<Matrix3<f64>>,
    angle: f64,
}

/// Reasons why a motion between two poses is ambiguous.
#[derive(Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// The axes are antiparallel.
    #[error("start and end axes are opposite, so the way between is ambiguous: add a pose between")]
    Opposite,
    /// The rotations differ by half a turn.
    #[error(
        "start and end differ by half a turn, so the way between is ambiguous: add a pose between"
    )]
    HalfTurn,
    /// A pose was built from its axis alone.
    #[error(
        "a pose from an axis has no spin, which a solid without an axis needs: give a quaternion"
    )]
    NoSpin,
}

crate::debug_as_sentence!(MotionError);

/// Tolerance, approximately in radians, within which a rotation counts as half a turn and is ambiguous:
/// rounding would decide its direction.
const HALF_TURN_TOLERANCE: f64 = 1e-9;

impl Motion {
    /// Creates the motion that rotates the axis along the shorter great circle.
    ///
    /// # Errors
    /// [`MotionError::Opposite`] if the axes are antiparallel.
    pub fn new(from: &Pose, to: &Pose) -> Result<Motion, MotionError> {
        let (first, last) = (from.axis(), to.axis());
        let (sine, cosine) = (first.cross(&last), first.dot(&last));
        let sine_norm = sine.norm();
        if sine_norm < HALF_TURN_TOLERANCE && cosine < 0.0 {
            return Err(MotionError::Opposite);
        }
        let displacement = to.tip() - from.tip();
        // Without a rotation of the axis, the displacement defines the frame.
        let normal =
            if sine_norm > f64::MIN_POSITIVE.sqrt() { sine } else { first.cross(&displacement) };
        // An exact cross product is perpendicular to the axis. A computed one that is not consists of
        // rounding, and so does its perpendicular remainder: the three columns would not form a rotation.
        let second = normal - first * first.dot(&normal);
        let start = match Unit::try_new(second, 0.5 * normal.norm()) {
            Some(second) => Matrix3::from_columns(&[second.cross(&first), *second, first]),
            None => *from.rotation(),
        };
        let start = orthonormal(start);
        Ok(Motion {
            tip: from.tip(),
            displacement,
            start,
            frame: None,
            // Accurate at all angles, unlike an arc cosine.
            angle: sine_norm.atan2(cosine),
        })
    }

    /// Creates the motion that rotates the tool frame about one axis by less than half a turn, as the spherical
    /// interpolation of quaternions does. A solid without an axis needs it. The axis of a tool of revolution then moves
    /// along a circle that depends on the spins of both poses, which [`Motion::new`] ignores.
    ///
    /// # Errors
    /// [`MotionError::NoSpin`] if a pose has no [spin](Pose::has_spin), [`MotionError::HalfTurn`] if the
    /// rotations differ by half a turn.
    ///
    /// ```
    /// # use nalgebra::{Point3, Vector3};
    /// # use touchoff::{Motion, Pose};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let half = std::f64::consts::FRAC_1_SQRT_2;
    /// let turned = Pose::from_quaternion(Point3::new(2.0, 0.0, 0.0), [0.0, 0.0, half, half])?;
    /// let motion = Motion::with_spin(&Pose::default(), &turned)?;
    /// let middle = motion.pose(0.5);
    /// assert!((middle.rotation().column(0) - Vector3::new(half, half, 0.0)).norm() < 1e-15);
    /// assert!(middle.has_spin() && (middle.tip().x - 1.0).abs() < 1e-15);
    /// # Ok(()) }
    /// ```
    pub fn with_spin(from: &Pose, to: &Pose) -> Result<Motion, MotionError> {
        if !from.has_spin() || !to.has_spin() {
            return Err(MotionError::NoSpin);
        }
        // The rotation in the tool frame. Shepperd's conversion of a rotation matrix to a quaternion is
        // accurate for all angles (1978).
        let rotation =
            Rotation3::from_matrix_unchecked(from.rotation().transpose() * to.rotation());
        let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
        let (sine, cosine) = (rotation.imag(), rotation.w);
        if cosine.abs() < HALF_TURN_TOLERANCE {
            return Err(MotionError::HalfTurn);
        }
        // The square of a shorter vector underflows, and its rotation is zero.
        let axis = Unit::try_new(sine * cosine.signum(), f64::MIN_POSITIVE.sqrt());
        let angle = if axis.is_some() { 2.0 * sine.norm().atan2(cosine.abs()) } else { 0.0 };
        let axis = axis.unwrap_or(Vector3::y_axis());
        // Two directions perpendicular to the axis, from any frame that contains it.
        let basis = Pose::from_axis(Point3::origin(), *axis).map_err(|_| MotionError::HalfTurn)?;
        let [first, second] = [0, 1].map(|k| Vector3::from(basis.rotation().column(k)));
        let columns = Matrix3::from_columns(&[second, *axis, first]);
        Ok(Motion {
            tip: from.tip(),
            displacement: to.tip() - from.tip(),
            start: orthonormal(from.rotation() * columns),
            frame: Some(columns.transpose()),
            angle,
        })
    }

    /// Returns the pose at a fraction of the motion, from 0 to 1. Fractions outside are clamped to the nearer end.
    ///
    /// # Panics
    /// Panics if the fraction is NaN.
    pub fn pose(&self, fraction: f64) -> Pose {
        assert!(!fraction.is_nan(), "NaN is no part of a motion: give a number from 0 to 1");
        let fraction = fraction.clamp(0.0, 1.0);
        let (sine, cosine) = (fraction * self.angle).sin_cos();
        let [x, y, z] = [0, 1, 2].map(|axis| Vector3::from(self.start.column(axis)));
        let columns = Matrix3::from_columns(&[cosine * x - sine * z, y, cosine * z + sine * x]);
        let tip = self.tip + fraction * self.displacement;
        match &self.frame {
            None => Pose::turned(columns, tip, false),
            Some(frame) => Pose::turned(columns * frame, tip, true),
        }
    }

    /// Returns whether the spin about the tool axis is known, so that the motion applies to a solid without an axis.
    pub fn has_spin(&self) -> bool {
        self.frame.is_some()
    }

    /// Returns the motion relative to `frame`, to some units in the last place of the coordinates.
    #[must_use]
    pub fn relative_to(&self, frame: &Pose) -> Motion {
        if *frame == Pose::default() {
            return *self;
        }
        let inverse = frame.rotation().transpose();
        Motion {
            tip: Point3::from(inverse * (self.tip - frame.tip())),
            displacement: inverse * self.displacement,
            start: orthonormal(inverse * self.start),
            ..*self
        }
    }

    /// Returns the axis of rotation in the tool frame, a unit vector that is constant over the motion.
    /// For [`Motion::new`] it is y, by the choice of the spin.
    pub(crate) fn rotation_axis(&self) -> Vector3<f64> {
        self.frame.map_or(Vector3::y(), |frame| frame.row(1).transpose())
    }

    /// Returns the initial position of the tip, in the world frame.
    pub fn start(&self) -> Point3<f64> {
        self.tip
    }

    /// Returns the displacement of the tip over the motion, in the world frame.
    pub fn displacement(&self) -> Vector3<f64> {
        self.displacement
    }

    /// Returns the angle by which the axis rotates, or the frame if the spin is known, in radians.
    pub fn angle(&self) -> f64 {
        self.angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::orthonormality_error;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Tests neighbouring axes and plunges along the axis. There the cross product that defines the
    /// frame consists of rounding only, and may point along the axis itself.
    #[test]
    fn every_pose_of_a_motion_is_a_rotation() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut uniform = || (random.next_u64() >> 11) as f64 / 2f64.powi(52) - 1.0;
        let mut max_error = 0.0f64;
        let mut check = |from: &Pose, to: &Pose| {
            let motion = Motion::new(from, to).expect("axes that are not opposite");
            for fraction in [0.0, 0.5, 1.0] {
                max_error = max_error.max(orthonormality_error(motion.pose(fraction).rotation()));
            }
        };
        for k in 0..1_000_000 {
            let grid = |v: f64| if k % 2 == 0 { (8.0 * v).round() } else { v };
            let axis = Vector3::new(grid(uniform()), grid(uniform()), grid(uniform()));
            let Some(axis) = Unit::try_new(axis, 1e-3).map(Unit::into_inner) else { continue };
            let tip = Point3::new(uniform(), uniform(), uniform());
            let from = Pose::from_axis(tip, axis).expect("an axis");
            let nudged =
                axis.map(|component| component * (1.0 + f64::EPSILON * (3.0 * uniform()).round()));
            check(&from, &Pose::from_axis(tip, nudged).expect("an axis"));
            check(&from, &Pose::from_axis(tip + from.axis() * uniform(), axis).expect("an axis"));
        }
        // 6u from the rotation and 3u from the check itself. A frame built on rounding along the axis
        // gave forty.
        assert!(max_error <= 4.5 * f64::EPSILON, "{max_error:e}");
    }

    /// Compares with nalgebra's interpolation of quaternions, for short rotations, long ones, and nearly half a turn.
    #[test]
    fn motion_with_spin_matches_quaternion_interpolation() {
        let mut random = Pcg64Mcg::seed_from_u64(2);
        let mut uniform = || (random.next_u64() >> 11) as f64 / 2f64.powi(52) - 1.0;
        let (mut max_error, mut end_error, mut rotation_error) = (0.0f64, 0.0f64, 0.0f64);
        for k in 0..100_000 {
            let mut quaternion = || UnitQuaternion::new(10.0 * Vector3::from_fn(|_, _| uniform()));
            let (first, axis) = (quaternion(), quaternion() * Vector3::z_axis());
            let angle = [[1e-17, 1e-160, 2e-161][k % 3], 1e-9, 1e-3, 1.0, 3.1, 3.13][k % 6];
            let last = first * UnitQuaternion::from_axis_angle(&axis, angle);
            let tip = [0, 1].map(|_| Point3::new(uniform(), uniform(), uniform()));
            let [from, to] = [(first, tip[0]), (last, tip[1])].map(|(turn, tip)| {
                let [x, y, z, w] = turn.coords.into();
                Pose::from_quaternion(tip, [x, y, z, w]).expect("a quaternion")
            });
            let motion = Motion::with_spin(&from, &to).expect("less than half a turn");
            for (fraction, end) in [(0.0, from), (1.0, to)] {
                end_error =
                    end_error.max((motion.pose(fraction).rotation() - end.rotation()).abs().max());
            }
            let fraction = 0.5 + 0.5 * uniform();
            let pose = motion.pose(fraction);
            rotation_error = rotation_error.max(orthonormality_error(pose.rotation()));
            let partial = UnitQuaternion::from_axis_angle(&axis, fraction * angle);
            let expected = (first * partial).to_rotation_matrix();
            max_error = max_error.max((pose.rotation() - expected.matrix()).abs().max());
            let rotation_axis = motion.rotation_axis();
            assert!(
                (pose.rotation() * rotation_axis - from.rotation() * rotation_axis).norm() < 4e-15
            );
        }
        assert!(rotation_error <= 4.5 * f64::EPSILON, "{rotation_error:e}");
        assert!(end_error < 8.0 * f64::EPSILON && max_error < 1e-14, "{end_error:e} {max_error:e}");
    }

    #[test]
    fn rejects_ambiguous_motions_with_spin() {
        let pose = |q| Pose::from_quaternion(Point3::origin(), q).expect("a quaternion");
        let identity = pose([0.0, 0.0, 0.0, 1.0]);
        let axis = Pose::from_axis(Point3::origin(), Vector3::z()).expect("an axis");
        assert_eq!(Motion::with_spin(&identity, &axis), Err(MotionError::NoSpin));
        assert_eq!(Motion::with_spin(&axis, &identity), Err(MotionError::NoSpin));
        for q in [[1.0, 0.0, 0.0, 0.0], [0.0, 0.6, -0.8, 1e-10]] {
            assert_eq!(Motion::with_spin(&identity, &pose(q)), Err(MotionError::HalfTurn));
        }
        assert!(Motion::with_spin(&identity, &pose([0.0, 0.6, 0.8, 1e-8])).is_ok());
        assert!(Motion::with_spin(&identity, &pose([0.0, 0.0, 0.0, -1.0])).is_ok());
    }

    #[test]
    fn fractions_outside_the_motion_are_clamped() {
        let [from, to] = [0.0, 1.0]
            .map(|x| Pose::from_axis(Point3::new(x, 0.0, 0.0), Vector3::z()).expect("a pose"));
        let motion = Motion::new(&from, &to).expect("a motion");
        for (fraction, end) in [(-1.0, 0.0), (f64::NEG_INFINITY, 0.0), (1.5, 1.0), (1e300, 1.0)] {
            assert_eq!(motion.pose(fraction).tip().x, end, "{fraction}");
        }
    }

    #[test]
    #[should_panic(expected = "NaN is no part of a motion")]
    fn rejects_a_nan_fraction() {
        let pose = Pose::default();
        Motion::new(&pose, &pose).expect("a motion").pose(f64::NAN);
    }
}
