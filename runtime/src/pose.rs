//! Where a tool is: its tip, and which way it stands.

use crate::mesh::LARGEST_COORDINATE;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// How far the norm of a given axis may be from 1: published programs round their axes to four
/// digits, and anything further off is a mistake in the data.
pub const AXIS_TOLERANCE: f64 = 1e-3;

/// The largest coordinate of a composed pose's tip: a thousand times the largest that may be given, which two poses that
/// were given never reach.
pub const FARTHEST_TIP: f64 = 1e3 * LARGEST_COORDINATE;

/// A tool's pose in the world: the map from the tool's frame (tip at the origin, +z from the tip
/// to the spindle) to the part's, both in the part's unit of length. Of a solid without an axis
/// what is called its tip is the origin of its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    rotation: Matrix3<f64>,
    tip: Point3<f64>,
    /// Whether the spin about the axis was given.
    full: bool,
}

/// A pose that cannot be one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A coordinate is NaN, infinite, or beyond what a part's may be.
    #[error("the pose has a coordinate that is not a number within {LARGEST_COORDINATE:e}")]
    NotFinite,
    /// The axis, or the quaternion, has no direction to take.
    #[error("the {what} has norm {norm}: give a unit vector (within {AXIS_TOLERANCE} of 1)")]
    NotUnit {
        /// `axis` or `quaternion`.
        what: &'static str,
        /// The norm that was found.
        norm: f64,
    },
}

impl Pose {
    /// A pose from the tip and the unit vector from the tip to the spindle, as in a 5-axis
    /// program's `x,y,z,i,j,k`. The spin about the axis, which no axisymmetric tool feels, is
    /// chosen by the branch-free frame of Duff et al., *Building an orthonormal basis, revisited*
    /// (JCGT 2017), accurate for every axis.
    ///
    /// An axis whose norm is within [`AXIS_TOLERANCE`] of 1 is normalised, another refused. Such a
    /// pose is not [full](Pose::is_full): it does not place a solid without an axis.
    pub fn from_axis(tip: Point3<f64>, axis: Vector3<f64>) -> Result<Pose, PoseError> {
        let axis = unit("axis", [axis.x, axis.y, axis.z, 0.0])?;
        let [x, y, z, _] = axis;
        let sign = 1f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        let first = Vector3::new(1.0 + sign * x * x * a, sign * b, -sign * x);
        let second = Vector3::new(b, sign + y * y * a, -y);
        let rotation = Matrix3::from_columns(&[first, second, Vector3::new(x, y, z)]);
        Pose::finite(orthonormal(rotation), tip, false)
    }

    /// A pose from the tip and a quaternion `(x, y, z, w)` that turns the tool's frame into the
    /// world's. Its norm is held to the same tolerance as an axis.
    pub fn from_quaternion(tip: Point3<f64>, quaternion: [f64; 4]) -> Result<Pose, PoseError> {
        let [x, y, z, w] = unit("quaternion", quaternion)?;
        let rotation = Matrix3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
        );
        Pose::finite(orthonormal(rotation), tip, true)
    }

    fn finite(rotation: Matrix3<f64>, tip: Point3<f64>, full: bool) -> Result<Pose, PoseError> {
        if tip.iter().all(|c| c.abs() <= LARGEST_COORDINATE) {
            Ok(Pose { rotation, tip, full })
        } else {
            Err(PoseError::NotFinite)
        }
    }

    /// Creates a pose from a matrix that is a rotation but for rounding; `full` if its spin is known.
    pub(crate) fn turned(rotation: Matrix3<f64>, tip: Point3<f64>, full: bool) -> Pose {
        Pose { rotation: orthonormal(rotation), tip, full }
    }

    /// Whether the spin about the axis was given, rather than chosen by [`Pose::from_axis`]. A
    /// tool's answers do not depend on it; those of a solid without an axis do, so that only a
    /// full pose means something for it.
    pub fn is_full(&self) -> bool {
        self.full
    }

    /// Where the tip is, in the world.
    pub fn tip(&self) -> Point3<f64> {
        self.tip
    }

    /// The unit vector from the tip to the spindle, in the world.
    pub fn axis(&self) -> Vector3<f64> {
        self.rotation.column(2).into()
    }

    /// The rotation from the tool's frame to the world's; its columns are the tool's x, y and z.
    pub fn rotation(&self) -> &Matrix3<f64> {
        &self.rotation
    }

    /// The same pose after a motion of the world: `motion ∘ self`. So `step.then(&pose)` is the pose
    /// after a step in the tool's own frame.
    ///
    /// However many motions follow each other, the rotation stays one: `RᵀR` differs from the identity
    /// by at most 3 ε in every entry, as in every pose. What is left of rounding turns it like a random walk; but a motion
    /// that comes back to where it began is rounded the same time and again, some 3e-17 rad each.
    ///
    /// # Panics
    /// If the tip gets out of [`FARTHEST_TIP`]: a certifier's answer about such a pose would mean nothing.
    ///
    /// ```
    /// # use nalgebra::{Point3, Vector3};
    /// # use touchoff::Pose;
    /// # fn main() -> Result<(), touchoff::PoseError> {
    /// let half = std::f64::consts::FRAC_1_SQRT_2;
    /// let quarter = Pose::from_quaternion(Point3::origin(), [0.0, 0.0, half, half])?;
    /// let pose = Pose::from_axis(Point3::new(1.0, 0.0, 0.0), Vector3::x())?.then(&quarter);
    /// assert!((pose.tip() - Point3::new(0.0, 1.0, 0.0)).norm() < 1e-15);
    /// assert!((pose.axis() - Vector3::y()).norm() < 1e-15);
    /// # Ok(()) }
    /// ```
    #[must_use]
    pub fn then(&self, motion: &Pose) -> Pose {
        let tip = motion.tip + motion.rotation * self.tip.coords;
        let rotation = orthonormal(motion.rotation * self.rotation);
        Pose { rotation, tip: near(tip), full: self.full && motion.full }
    }

    /// The same pose shifted in the world.
    ///
    /// # Errors
    /// If that is no place for a part.
    pub fn shifted(&self, way: Vector3<f64>) -> Result<Pose, PoseError> {
        Pose::finite(self.rotation, self.tip + way, self.full)
    }

    /// Turned by a rotation, its tip carried to there.
    ///
    /// # Errors
    /// If the tip is not within the bounds of a pose, or the turn is no rotation.
    #[cfg(feature = "haptic")]
    pub(crate) fn carried(&self, turn: Matrix3<f64>, tip: Point3<f64>) -> Result<Pose, PoseError> {
        let rotation = orthonormal(turn * self.rotation);
        match off(&rotation) {
            off if off <= ORTHONORMAL => Pose::finite(rotation, tip, self.full),
            _ => Err(PoseError::NotFinite),
        }
    }

    /// The same pose seen from where something else stands: `place⁻¹ ∘ self`, the difference of the
    /// tips first. Its rotation stays one as that of [`Pose::then`] does.
    ///
    /// # Panics
    /// If the tip gets out of [`FARTHEST_TIP`].
    pub fn seen_from(&self, place: &Pose) -> Pose {
        if *place == Pose::default() {
            return *self;
        }
        let back = place.rotation.transpose();
        let tip = Point3::from(back * (self.tip - place.tip));
        Pose { rotation: orthonormal(back * self.rotation), tip: near(tip), full: self.full }
    }

    /// The same pose as nalgebra's isometry.
    pub fn isometry(&self) -> Isometry3<f64> {
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(self.rotation);
        Isometry3::from_parts(self.tip.into(), nalgebra::UnitQuaternion::from(rotation))
    }
}

/// A tip that is not farther than [`FARTHEST_TIP`].
fn near(tip: Point3<f64>) -> Point3<f64> {
    assert!(
        tip.iter().all(|part| part.abs() <= FARTHEST_TIP),
        "the composed pose has its tip at {tip}, out of {FARTHEST_TIP:e}: compose fewer or smaller motions"
    );
    tip
}

/// The largest entry of `RᵀR - I` in a rotation. A certifier's bounds hold for rotations that are off
/// by rounding; a matrix that is farther off was not made by this module.
#[cfg(feature = "haptic")]
const ORTHONORMAL: f64 = 1e-9;

/// Returns the largest entry of `RᵀR - I`, NaN if any is NaN.
#[cfg(any(test, feature = "haptic"))]
pub(crate) fn off(rotation: &Matrix3<f64>) -> f64 {
    let off = rotation.transpose() * rotation - Matrix3::identity();
    off.iter().fold(0.0, |most, part| if part.abs() <= most { most } else { part.abs() })
}

/// Returns a rotation `Q` beside a matrix `R` that is one but for rounding: `QᵀQ` differs from the identity by at most 6u in
/// every entry, `u = ε/2`, and `Q` from `R` by half of `|I − RᵀR|`.
///
/// This is a step of Newton's method toward the nearest rotation, `R + R E/2` with `E = I − RᵀR`. Let `E` have entries below
/// 1e-9. An exact step leaves its square. Entries of `RᵀR` are sums of three products, whose sizes add up to 1 at most,
/// and err by 3u (Cauchy and Schwarz); the difference from the identity is exact (Sterbenz). So the computed `E` errs by 3u,
/// and `QᵀQ` by as much. Rounding `R E/2` is of second order. Rounding the last sum changes an entry of `Q` by u of its
/// size, and `QᵀQ` by 2u. That is 5u, and second order takes less than another.
pub(crate) fn orthonormal(product: Matrix3<f64>) -> Matrix3<f64> {
    let off = Matrix3::identity() - product.transpose() * product;
    product + product * off * 0.5
}

/// At the origin, unturned.
impl Default for Pose {
    fn default() -> Pose {
        Pose { rotation: Matrix3::identity(), tip: Point3::origin(), full: true }
    }
}

impl TryFrom<Isometry3<f64>> for Pose {
    type Error = PoseError;

    fn try_from(isometry: Isometry3<f64>) -> Result<Pose, PoseError> {
        let q = isometry.rotation.coords;
        Pose::from_quaternion(isometry.translation.vector.into(), [q.x, q.y, q.z, q.w])
    }
}

/// Normalises what is within tolerance of a unit vector.
fn unit(what: &'static str, v: [f64; 4]) -> Result<[f64; 4], PoseError> {
    if !v.iter().all(|c| c.is_finite()) {
        return Err(PoseError::NotFinite);
    }
    let norm = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    if (norm - 1.0).abs() > AXIS_TOLERANCE {
        return Err(PoseError::NotUnit { what, norm });
    }
    Ok(v.map(|c| c / norm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Quaternion, Translation3, UnitQuaternion};

    const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    /// Each entrance to a pose refuses what is no rotation or no place, and all it accepts are rotations to
    /// within rounding, however large the error within its tolerance.
    #[test]
    fn every_entrance_refuses_what_is_no_pose() {
        let origin = Point3::origin();
        for bad in BAD {
            for at in 0..4 {
                let mut quaternion = [0.0, 0.6, 0.0, 0.8];
                quaternion[at] = bad;
                assert_eq!(Pose::from_quaternion(origin, quaternion), Err(PoseError::NotFinite));
                let unchecked = UnitQuaternion::new_unchecked(Quaternion::from(quaternion));
                let isometry = Isometry3::from_parts(Translation3::identity(), unchecked);
                assert_eq!(Pose::try_from(isometry), Err(PoseError::NotFinite));
                let [x, y, z] = [0, 1, 2].map(|k| if k == at % 3 { bad } else { 0.0 });
                let (tip, axis) = (Point3::new(x, y, z), Vector3::new(x, y, z));
                assert_eq!(Pose::from_axis(origin, axis), Err(PoseError::NotFinite));
                assert_eq!(Pose::from_axis(tip, Vector3::z()), Err(PoseError::NotFinite));
                assert_eq!(Pose::default().shifted(axis), Err(PoseError::NotFinite));
            }
        }
        for size in [0.0, 0.5, 1.0 - 1.1e-3, 1.0 + 1.1e-3, 1e200] {
            let axis = Pose::from_axis(origin, Vector3::new(0.0, 0.6, 0.8) * size);
            assert!(matches!(axis, Err(PoseError::NotUnit { what: "axis", .. })), "{axis:?}");
            let quaternion = Pose::from_quaternion(origin, [0.0, 0.6, 0.0, 0.8].map(|c| c * size));
            assert!(matches!(quaternion, Err(PoseError::NotUnit { .. })), "{quaternion:?}");
        }
        for size in [1.0 - 0.9e-3, 1.0, 1.0 + 0.9e-3] {
            for sign in [1.0, -1.0] {
                let axis = Pose::from_axis(origin, Vector3::new(0.36, 0.48, sign * 0.8) * size);
                let turned = [0.1, 0.7, -0.1, sign * 0.7].map(|c| c * size);
                let quaternion = Pose::from_quaternion(origin, turned);
                for pose in [axis, quaternion] {
                    assert!(off(pose.expect("within tolerance").rotation()) <= 4.0 * f64::EPSILON);
                }
            }
        }
    }

    #[test]
    #[should_panic(expected = "compose fewer or smaller motions")]
    fn a_composed_pose_does_not_run_away_to_infinity() {
        let far = Point3::new(LARGEST_COORDINATE, 0.0, 0.0);
        let mut pose = Pose::from_axis(far, Vector3::z()).expect("a pose");
        for _ in 0..2000 {
            pose = pose.then(&pose);
        }
    }

    #[test]
    fn poses_as_far_apart_as_they_may_be_given_compose() {
        let [a, b] = [-LARGEST_COORDINATE, LARGEST_COORDINATE]
            .map(|c| Pose::from_axis(Point3::new(c, c, c), Vector3::x()).expect("a pose"));
        assert!(a.seen_from(&b).then(&b).tip().iter().all(|part| part.is_finite()));
    }

    /// A turn that is NaN, or drifted away from a rotation, makes no pose.
    #[cfg(feature = "haptic")]
    #[test]
    fn what_is_carried_by_no_rotation_is_refused() {
        let (pose, origin) = (Pose::default(), Point3::origin());
        let scaled = |by: f64| Matrix3::identity() * by;
        assert!(pose.carried(scaled(1.0), origin).is_ok());
        // Newton's step mends what is off by less than the root of the tolerance.
        assert!(pose.carried(scaled(1.0 + 1e-6), origin).is_ok());
        for turn in [scaled(f64::NAN), scaled(1.01), scaled(0.0), scaled(f64::INFINITY)] {
            assert_eq!(pose.carried(turn, origin), Err(PoseError::NotFinite));
        }
        let nowhere = Point3::new(0.0, f64::NAN, 0.0);
        assert_eq!(pose.carried(scaled(1.0), nowhere), Err(PoseError::NotFinite));
    }
}
