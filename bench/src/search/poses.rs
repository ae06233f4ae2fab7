//! Poses as numbers, so that they can be climbed.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use touchoff::Pose;

/// A tip and the vector part of a turn's quaternion, whose fourth part is √(1 - x² - y² - z²).
pub(super) type Numbers = [f64; 6];

/// The pose of some numbers; `None` if they are none.
pub(super) fn pose([x, y, z, i, j, k]: Numbers) -> Option<Pose> {
    let square = i * i + j * j + k * k;
    let w = (1.0 - square).max(0.0).sqrt();
    let size = (square + w * w).sqrt();
    let quaternion = [i, j, k, w].map(|part| part / size);
    Pose::from_quaternion(Point3::new(x, y, z), quaternion).ok()
}

/// The numbers of a pose, to rounding.
pub(super) fn numbers(pose: &Pose) -> Numbers {
    let turn = nalgebra::Rotation3::from_matrix_unchecked(*pose.rotation());
    let turn = UnitQuaternion::from_rotation_matrix(&turn);
    let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
    let v: Vector3<f64> = sign * turn.imag();
    let tip = pose.tip();
    [tip.x, tip.y, tip.z, v.x, v.y, v.z]
}

/// A pose to the last bit.
pub(super) fn told(numbers: Numbers) -> String {
    format!("tip and quaternion {numbers:?}")
}
