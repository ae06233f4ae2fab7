//! Virtual coupling: a spring and damper between the device and the tool.
//!
//! The tool is massless: it always stands where spring and contact balance (Wan and McNeely,
//! *Quasi-static approximation for 6 degrees-of-freedom haptic rendering*, 2003; Barbič and James,
//! *Six-DoF haptic rendering of contact between geometrically complex reduced deformable models*, 2008).
//! Away from the part it follows the hand and no force is applied. In contact the hand is coupled to two
//! springs in series: it never meets a stiffness above the coupling's, however stiff the contact. If the
//! contact force is a gradient, so is the hand's: that of the minimum of the contact and spring energy.

use super::frame::{halves, join};
use super::{DeviceLimits, DeviceWrench};
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// A spring and a damper between a device and its tool, in translation and rotation. The spring's force
/// and torque are limited to the device's maxima.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Translational stiffness, N/mm.
    pub stiffness: f64,
    /// Rotational stiffness, N·mm/rad.
    pub turning_stiffness: f64,
    /// Time constant of the damper, s: the damping coefficient is this time times the stiffness.
    pub damping: f64,
}

impl Coupling {
    /// Returns a coupling as stiff as the device can render.
    pub fn of(limits: &DeviceLimits) -> Coupling {
        Coupling {
            stiffness: limits.stiffness,
            turning_stiffness: limits.turning_stiffness,
            damping: 1e-3,
        }
    }

    pub(super) fn springs(&self) -> Vector6<f64> {
        diagonal(self.stiffness, self.turning_stiffness)
    }
}

/// Returns the largest stiffnesses that a device can render, N/mm and N·mm/rad.
pub(super) fn springs(limits: &DeviceLimits) -> Vector6<f64> {
    diagonal(limits.stiffness, limits.turning_stiffness)
}

fn diagonal(linear: f64, angular: f64) -> Vector6<f64> {
    Vector6::new(linear, linear, linear, angular, angular, angular)
}

/// Returns the secant stiffness (force divided by stretch) of a spring with limited force at a given
/// stretch, and its energy, N·mm.
pub(super) fn spring(
    coupling: &Coupling,
    limits: &DeviceLimits,
    displacement: &Vector6<f64>,
) -> (Vector6<f64>, f64) {
    let [linear, angular] = halves(displacement).map(|part| part.norm());
    let (force, linear_energy) = capped_spring(coupling.stiffness, limits.force, linear);
    let (torque, angular_energy) =
        capped_spring(coupling.turning_stiffness, limits.torque, angular);
    (diagonal(force, torque), linear_energy + angular_energy)
}

/// Returns the secant stiffness and the energy of a one-dimensional spring whose force is limited to
/// `limit`.
fn capped_spring(stiffness: f64, limit: f64, displacement: f64) -> (f64, f64) {
    if stiffness * displacement <= limit {
        (stiffness, 0.5 * stiffness * displacement * displacement)
    } else {
        (limit / displacement, limit * (displacement - 0.5 * limit / stiffness))
    }
}

/// Limits force and torque to the device's maxima; directions are kept.
pub(super) fn saturate(wrench: &DeviceWrench, limits: &DeviceLimits) -> DeviceWrench {
    let factor = |size: f64, limit: f64| if size > limit { limit / size } else { 1.0 };
    DeviceWrench {
        force: wrench.force * factor(wrench.force.norm(), limits.force),
        torque: wrench.torque * factor(wrench.torque.norm(), limits.torque),
    }
}

/// Returns the positive semidefinite part of a contact's symmetrised stiffness, and its largest
/// eigenvalue relative to the stiffness that the device can render. At 1, the stiffest direction or
/// rotation is at the device's limit.
pub(super) fn limit_stiffness(matrix: &Matrix6<f64>, limits: &DeviceLimits) -> (Matrix6<f64>, f64) {
    let scale =
        diagonal(limits.stiffness, limits.turning_stiffness).map(|limit| 1.0 / limit.sqrt());
    let scaled = Matrix6::from_fn(|row, column| {
        0.5 * (matrix[(row, column)] + matrix[(column, row)]) * scale[row] * scale[column]
    });
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
    let projected = eigenvectors * Matrix6::from_diagonal(&eigenvalues.map(|value| value.max(0.0)));
    let projected = projected * eigenvectors.transpose();
    let matrix =
        Matrix6::from_fn(|row, column| projected[(row, column)] / (scale[row] * scale[column]));
    (matrix, eigenvalues.max())
}

pub(super) fn to_wrench(both: &Vector6<f64>) -> DeviceWrench {
    let [force, torque] = halves(both);
    DeviceWrench { force, torque }
}

pub(super) fn to_vector(wrench: &DeviceWrench) -> Vector6<f64> {
    join(&wrench.force, &wrench.torque)
}
