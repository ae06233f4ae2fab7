//! Tool poses: the position of the tip and the orientation of the tool.

use crate::mesh::LARGEST_COORDINATE;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// Largest deviation of a given axis's norm from 1: published programs round their axes to four digits,
/// and anything further off is a mistake in the data.
pub const AXIS_TOLERANCE: f64 = 1e-3;

/// Largest coordinate of a composed pose's tip: a thousand times the largest coordinate that may be
/// given. Composing two given poses never reaches it.
pub const MAX_TIP_COORDINATE: f64 = 1e3 * LARGEST_COORDINATE;

/// A tool's pose in the world: the map from the tool frame (tip at the origin, +z from the tip to the spindle) to the
/// part's frame, both in the part's unit of length. For a solid without an axis, the "tip" is the origin of its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    rotation: Matrix3<f64>,
    tip: Point3<f64>,
    /// True if the spin about the axis was given.
    has_spin: bool,
}

/// Reasons why a pose is invalid.
#[derive(Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A coordinate is NaN, infinite, or beyond the largest one allowed.
    #[error("the pose has a coordinate that is not a number within {LARGEST_COORDINATE:e}")]
    NotFinite,
    /// A matrix is no rotation, even after a correction of small errors.
    #[error(
        "the matrix is not a rotation: give one whose columns are perpendicular unit vectors, right-handed"
    )]
    NotRotation,
    /// The norm of the axis or the quaternion is not 1 within the tolerance.
    #[error(
        "the {what} has norm {norm}: give a unit {} (within {AXIS_TOLERANCE} of 1)",
        unit_kind(.what)
    )]
    NotUnit {
        /// `axis` or `quaternion`.
        what: &'static str,
        /// The norm found.
        norm: f64,
    },
}

crate::debug_as_sentence!(PoseError);

/// Returns the kind of unit value that a pose takes as its axis or quaternion.
fn unit_kind(what: &str) -> &'static str {
    if what == "quaternion" { "quaternion" } else { "vector" }
}

impl Pose {
    /// Builds a pose from the tip and the unit vector from the tip to the spindle, as in a 5-axis program's
    /// `x,y,z,i,j,k`. The spin about the axis does not affect axisymmetric tools. It is chosen by the branch-free frame
    /// of Duff et al., *Building an orthonormal basis, revisited* (JCGT 2017), which is accurate for every axis.
    ///
    /// An axis whose norm is within [`AXIS_TOLERANCE`] of 1 is normalised. The pose has no
    /// [spin](Pose::has_spin), so it does not place a solid without an axis.
    ///
    /// # Errors
    /// [`PoseError::NotUnit`] if the axis's norm is outside the tolerance, [`PoseError::NotFinite`] if a
    /// component is not finite or a coordinate of the tip is beyond [`LARGEST_COORDINATE`].
    pub fn from_axis(tip: Point3<f64>, axis: Vector3<f64>) -> Result<Pose, PoseError> {
        let axis = unit("axis", [axis.x, axis.y, axis.z, 0.0])?;
        let [x, y, z, _] = axis;
        // Without a branch, and without the cancellation at z = -1 that a fixed sign has.
        let sign = 1f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        let first = Vector3::new(1.0 + sign * x * x * a, sign * b, -sign * x);
        let second = Vector3::new(b, sign + y * y * a, -y);
        let rotation = Matrix3::from_columns(&[first, second, Vector3::new(x, y, z)]);
        Pose::finite(orthonormal(rotation), tip, false)
    }

    /// Builds a pose from the tip and a quaternion `(x, y, z, w)` that rotates the tool frame to the
    /// world frame. The tolerance of its norm and the errors are those of [`Pose::from_axis`].
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

    fn finite(rotation: Matrix3<f64>, tip: Point3<f64>, has_spin: bool) -> Result<Pose, PoseError> {
        if tip.iter().all(|c| c.abs() <= LARGEST_COORDINATE) {
            Ok(Pose { rotation, tip, has_spin })
        } else {
            Err(PoseError::NotFinite)
        }
    }

    /// Creates a pose with a known spin from a rotation and a tip that were computed. The caller answers for a matrix that is a
    /// rotation except for rounding, and for coordinates up to [`MAX_TIP_COORDINATE`].
    pub fn from_computed(rotation: Matrix3<f64>, tip: Point3<f64>) -> Pose {
        Pose::turned(rotation, tip, true)
    }

    /// Creates a pose from a matrix that is a rotation except for rounding; `has_spin` states whether its
    /// spin is known.
    pub(crate) fn turned(rotation: Matrix3<f64>, tip: Point3<f64>, has_spin: bool) -> Pose {
        Pose { rotation: orthonormal(rotation), tip, has_spin }
    }

    /// Returns whether the spin about the axis was given, rather than chosen by [`Pose::from_axis`]. Results for a tool
    /// of revolution do not depend on it. Results for a solid without an axis do, so it needs a pose with spin.
    pub fn has_spin(&self) -> bool {
        self.has_spin
    }

    /// Returns the tip's position, in the world frame.
    pub fn tip(&self) -> Point3<f64> {
        self.tip
    }

    /// Returns the unit vector from the tip to the spindle, in the world frame.
    pub fn axis(&self) -> Vector3<f64> {
        self.rotation.column(2).into()
    }

    /// Returns the rotation from the tool frame to the world frame. Its columns are the tool's x, y and z.
    pub fn rotation(&self) -> &Matrix3<f64> {
        &self.rotation
    }

    /// Returns the pose after a motion of the world: `motion ∘ self`. Hence `step.then(&pose)` is the
    /// pose after a step in the tool's own frame.
    ///
    /// The rotation remains a rotation after any number of compositions: `RᵀR` differs from the identity
    /// by at most 3 ε in every entry, as in every pose. The remaining rounding rotates it like a random
    /// walk. A motion that returns to its start is rounded in the same way each time, by some 3e-17 rad.
    ///
    /// # Panics
    /// Panics if the tip leaves [`MAX_TIP_COORDINATE`]: a certifier's answer for such a pose would be meaningless.
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
        Pose { rotation, tip: check_range(tip), has_spin: self.has_spin && motion.has_spin }
    }

    /// Returns the pose translated by a displacement in the world frame.
    ///
    /// # Errors
    /// [`PoseError::NotFinite`] if a coordinate of the new tip is not finite or beyond the largest one allowed.
    pub fn translated(&self, displacement: Vector3<f64>) -> Result<Pose, PoseError> {
        Pose::finite(self.rotation, self.tip + displacement, self.has_spin)
    }

    /// Returns the pose rotated by `rotation` in the world frame, with its tip at `tip`. Errors of the matrix up to some
    /// 1e-6 are corrected.
    ///
    /// # Errors
    /// [`PoseError::NotFinite`] if the tip is out of bounds, [`PoseError::NotRotation`] if the matrix is still no rotation
    /// then.
    pub fn rotated_to(&self, rotation: Matrix3<f64>, tip: Point3<f64>) -> Result<Pose, PoseError> {
        let rotation = orthonormal(rotation * self.rotation);
        match orthonormality_error(&rotation) {
            // A reflection is orthonormal, too.
            error if error <= ORTHONORMALITY_TOLERANCE && rotation.determinant() > 0.0 => {
                Pose::finite(rotation, tip, self.has_spin)
            }
            // NaN compares as false with everything.
            _ => Err(PoseError::NotRotation),
        }
    }

    /// Returns the pose relative to `frame`, as `frame⁻¹ ∘ self`, with the difference of the tips
    /// taken first. The rotation remains a rotation as in [`Pose::then`].
    ///
    /// # Panics
    /// Panics if the tip leaves [`MAX_TIP_COORDINATE`].
    pub fn relative_to(&self, frame: &Pose) -> Pose {
        // Exactly, so that a part at the origin sees the bits of the given pose.
        if *frame == Pose::default() {
            return *self;
        }
        let inverse = frame.rotation.transpose();
        // The difference first: both tips may be far from the origin.
        let tip = Point3::from(inverse * (self.tip - frame.tip));
        Pose {
            rotation: orthonormal(inverse * self.rotation),
            tip: check_range(tip),
            has_spin: self.has_spin,
        }
    }

    /// Returns the pose as nalgebra's isometry.
    pub fn to_isometry(&self) -> Isometry3<f64> {
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(self.rotation);
        Isometry3::from_parts(self.tip.into(), nalgebra::UnitQuaternion::from(rotation))
    }
}

/// Returns the tip after checking that it is within [`MAX_TIP_COORDINATE`].
fn check_range(tip: Point3<f64>) -> Point3<f64> {
    assert!(
        tip.iter().all(|coordinate| coordinate.abs() <= MAX_TIP_COORDINATE),
        "the composed pose has its tip at {tip}, out of {MAX_TIP_COORDINATE:e}: compose fewer or smaller motions"
    );
    tip
}

/// Largest entry of `RᵀR - I` in a valid rotation. A certifier's bounds hold for rotations with rounding
/// errors; a matrix farther off was not made by this module.
const ORTHONORMALITY_TOLERANCE: f64 = 1e-9;

/// Returns the largest magnitude in `RᵀR - I`, or NaN if any entry is NaN.
pub(crate) fn orthonormality_error(rotation: &Matrix3<f64>) -> f64 {
    let error = rotation.transpose() * rotation - Matrix3::identity();
    error.iter().fold(
        0.0,
        |max_error, entry| if entry.abs() <= max_error { max_error } else { entry.abs() },
    )
}

/// Corrects the rounding of a matrix `R` that is nearly a rotation. The result `Q` has `QᵀQ` within 6u
/// of the identity in every entry, with `u = ε/2`, and differs from `R` by half of `|I − RᵀR|`.
///
/// This is a Newton step toward the nearest rotation, `R + R E/2` with `E = I − RᵀR`. Let `E` have entries below 1e-9.
/// An exact step leaves its square. Entries of `RᵀR` are sums of three products, whose magnitudes add up to at most 1,
/// and err by 3u (Cauchy and Schwarz); the difference from the identity is exact (Sterbenz). The computed `E` therefore
/// errs by 3u, and `QᵀQ` by as much. Rounding `R E/2` is of second order. Rounding the last sum changes an entry of `Q`
/// by u of its magnitude, and `QᵀQ` by 2u. The total is 5u, and second-order terms add less than another u.
pub(crate) fn orthonormal(product: Matrix3<f64>) -> Matrix3<f64> {
    let error = Matrix3::identity() - product.transpose() * product;
    product + product * error * 0.5
}

/// Returns the pose at the origin without rotation.
impl Default for Pose {
    fn default() -> Pose {
        Pose { rotation: Matrix3::identity(), tip: Point3::origin(), has_spin: true }
    }
}

impl TryFrom<Isometry3<f64>> for Pose {
    type Error = PoseError;

    fn try_from(isometry: Isometry3<f64>) -> Result<Pose, PoseError> {
        let q = isometry.rotation.coords;
        Pose::from_quaternion(isometry.translation.vector.into(), [q.x, q.y, q.z, q.w])
    }
}

/// Normalises a vector whose norm is within the tolerance.
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

    const NON_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    /// Checks that every constructor refuses matrices that are not rotations and invalid positions. All
    /// accepted poses are rotations to within rounding, however large the error within the tolerance.
    #[test]
    fn constructors_reject_invalid_poses() {
        let origin = Point3::origin();
        for bad in NON_FINITE {
            for index in 0..4 {
                let mut quaternion = [0.0, 0.6, 0.0, 0.8];
                quaternion[index] = bad;
                assert_eq!(Pose::from_quaternion(origin, quaternion), Err(PoseError::NotFinite));
                let unchecked = UnitQuaternion::new_unchecked(Quaternion::from(quaternion));
                let isometry = Isometry3::from_parts(Translation3::identity(), unchecked);
                assert_eq!(Pose::try_from(isometry), Err(PoseError::NotFinite));
                let [x, y, z] = [0, 1, 2].map(|k| if k == index % 3 { bad } else { 0.0 });
                let (tip, axis) = (Point3::new(x, y, z), Vector3::new(x, y, z));
                assert_eq!(Pose::from_axis(origin, axis), Err(PoseError::NotFinite));
                assert_eq!(Pose::from_axis(tip, Vector3::z()), Err(PoseError::NotFinite));
                assert_eq!(Pose::default().translated(axis), Err(PoseError::NotFinite));
            }
        }
        let far = Point3::new(0.0, 0.0, -1.7e308);
        assert_eq!(Pose::from_axis(far, Vector3::z()), Err(PoseError::NotFinite));
        for norm in [0.0, 1e-160, 0.5, 1.0 - 1.1e-3, 1.0 + 1.1e-3, 1e200] {
            let axis = Pose::from_axis(origin, Vector3::new(0.0, 0.6, 0.8) * norm);
            assert!(matches!(axis, Err(PoseError::NotUnit { what: "axis", .. })), "{axis:?}");
            let quaternion = Pose::from_quaternion(origin, [0.0, 0.6, 0.0, 0.8].map(|c| c * norm));
            assert!(matches!(quaternion, Err(PoseError::NotUnit { .. })), "{quaternion:?}");
        }
        for norm in [1.0 - 0.9e-3, 1.0, 1.0 + 0.9e-3] {
            for sign in [1.0, -1.0] {
                let axis = Pose::from_axis(origin, Vector3::new(0.36, 0.48, sign * 0.8) * norm);
                let components = [0.1, 0.7, -0.1, sign * 0.7].map(|c| c * norm);
                let quaternion = Pose::from_quaternion(origin, components);
                for pose in [axis, quaternion] {
                    assert!(
                        orthonormality_error(pose.expect("within tolerance").rotation())
                            <= 4.0 * f64::EPSILON
                    );
                }
            }
        }
    }

    #[test]
    #[should_panic(expected = "compose fewer or smaller motions")]
    fn rejects_a_composed_tip_out_of_range() {
        let tip = Point3::new(LARGEST_COORDINATE, 0.0, 0.0);
        let mut pose = Pose::from_axis(tip, Vector3::z()).expect("a pose");
        for _ in 0..2000 {
            pose = pose.then(&pose);
        }
    }

    #[test]
    fn poses_with_extreme_coordinates_compose() {
        let [a, b] = [-LARGEST_COORDINATE, LARGEST_COORDINATE]
            .map(|c| Pose::from_axis(Point3::new(c, c, c), Vector3::x()).expect("a pose"));
        assert!(a.relative_to(&b).then(&b).tip().iter().all(|coordinate| coordinate.is_finite()));
    }

    /// Checks that a NaN matrix, or one that has drifted away from a rotation, gives no pose.
    #[test]
    fn rejects_matrices_that_are_not_rotations() {
        let (pose, origin) = (Pose::default(), Point3::origin());
        let scaled = |factor: f64| Matrix3::identity() * factor;
        assert!(pose.rotated_to(scaled(1.0), origin).is_ok());
        // The Newton step corrects errors below the square root of the tolerance.
        assert!(pose.rotated_to(scaled(1.0 + 1e-6), origin).is_ok());
        for matrix in [scaled(f64::NAN), scaled(1.01), scaled(0.0), scaled(f64::INFINITY)] {
            assert_eq!(pose.rotated_to(matrix, origin), Err(PoseError::NotRotation));
        }
        let nan_tip = Point3::new(0.0, f64::NAN, 0.0);
        assert_eq!(pose.rotated_to(scaled(1.0), nan_tip), Err(PoseError::NotFinite));
    }
}
