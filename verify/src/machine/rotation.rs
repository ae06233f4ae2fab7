//! Rotations by angles in degrees.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Bound on the error of [`rotation`] as an operator, in units of 2⁻⁵³, relative to the rotation about the
/// exact unit vector by the exact angle.
///
/// With u = 2⁻⁵³: the angle in radians errs by 3u · π/4. Sine and cosine err by one ulp each, hence by 2u,
/// which changes the matrix by √8 u. Rounding its entries changes it by 8.2u (Frobenius norm). The stored
/// direction errs by 3.5u, which changes the matrix by (|sin θ| + 2 (1 − cos θ)) · 3.5u ≤ (2 + √5) · 3.5u.
/// The sum is below 30u.
pub(super) const ROTATION_ERROR: f64 = 30.0;

/// Returns sine and cosine of an angle in degrees of magnitude up to 2⁴⁰. Each errs by at most 2⁻⁵² plus an
/// ulp of the library's function, and is exact at multiples of 90°.
///
/// The angle is reduced to ±45° in degrees. The reduction is exact: the difference of the angle and the
/// nearest multiple of 90° is a multiple of the angle's ulp and no larger than the angle, or both are within
/// a factor of 2.
pub(crate) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sine, cosine) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters as i64 & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// Returns the rotation about a unit vector by an angle in degrees, counter-clockwise seen from its head
/// (Rodrigues' formula). [`ROTATION_ERROR`] bounds its error.
pub(super) fn rotation(direction: &Vector3<f64>, degrees: f64) -> Matrix3<f64> {
    let (sine, cosine) = sin_cos_degrees(degrees);
    let (d, versine) = (direction, 1.0 - cosine);
    let (xy, yz, zx) = (versine * d.x * d.y, versine * d.y * d.z, versine * d.z * d.x);
    let s = sine * d;
    Matrix3::new(
        versine * d.x * d.x + cosine,
        xy - s.z,
        zx + s.y,
        xy + s.z,
        versine * d.y * d.y + cosine,
        yz - s.x,
        zx - s.y,
        yz + s.x,
        versine * d.z * d.z + cosine,
    )
}

/// Returns the angle in degrees, from −180 to 180, by which the plane through a unit vector `axis` and `from`
/// turns about `axis` to the plane through `axis` and `to`. Neither vector may be parallel to the axis: the
/// angle of a vector that is errs without bound (Murray, Li, Sastry, *A mathematical introduction to robotic
/// manipulation*, 1994, subproblem 1).
pub(super) fn angle_about(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let (from, to) = (from - axis * axis.dot(from), to - axis * axis.dot(to));
    radians_to_degrees(axis.dot(&from.cross(&to)).atan2(from.dot(&to)))
}

/// Returns the angle between two unit vectors in radians, with an error of some 2⁻⁵¹ at any angle.
pub(super) fn angle_between(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// Returns an angle in degrees.
pub(super) fn radians_to_degrees(radians: f64) -> f64 {
    radians * (180.0 / PI)
}
