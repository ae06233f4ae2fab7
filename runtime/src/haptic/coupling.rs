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

fn diagonal(way: f64, turn: f64) -> Vector6<f64> {
    Vector6::new(way, way, way, turn, turn, turn)
}

/// Returns the secant stiffness (force divided by stretch) of a spring with limited force at a given
/// stretch, and its energy, N·mm.
pub(super) fn spring(
    coupling: &Coupling,
    limits: &DeviceLimits,
    stretch: &Vector6<f64>,
) -> (Vector6<f64>, f64) {
    let [way, turn] = halves(stretch).map(|part| part.norm());
    let (force, by_way) = capped(coupling.stiffness, limits.force, way);
    let (torque, by_turn) = capped(coupling.turning_stiffness, limits.torque, turn);
    (diagonal(force, torque), by_way + by_turn)
}

/// Returns the secant stiffness and the energy of a one-dimensional spring whose force is limited to
/// `most`.
fn capped(stiffness: f64, most: f64, stretch: f64) -> (f64, f64) {
    if stiffness * stretch <= most {
        (stiffness, 0.5 * stiffness * stretch * stretch)
    } else {
        (most / stretch, most * (stretch - 0.5 * most / stiffness))
    }
}

/// Limits force and torque to the device's maxima; directions are kept.
pub(super) fn saturated(push: &DeviceWrench, limits: &DeviceLimits) -> DeviceWrench {
    let least = |size: f64, most: f64| if size > most { most / size } else { 1.0 };
    DeviceWrench {
        force: push.force * least(push.force.norm(), limits.force),
        torque: push.torque * least(push.torque.norm(), limits.torque),
    }
}

/// Returns the positive semidefinite part of a contact's symmetrised stiffness, and its largest
/// eigenvalue relative to the stiffness that the device can render. At 1, the stiffest direction or
/// rotation is at the device's limit.
pub(super) fn rendered(matrix: &Matrix6<f64>, limits: &DeviceLimits) -> (Matrix6<f64>, f64) {
    let unit = diagonal(limits.stiffness, limits.turning_stiffness).map(|most| 1.0 / most.sqrt());
    let scaled = Matrix6::from_fn(|row, column| {
        0.5 * (matrix[(row, column)] + matrix[(column, row)]) * unit[row] * unit[column]
    });
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
    let kept = eigenvectors * Matrix6::from_diagonal(&eigenvalues.map(|value| value.max(0.0)));
    let kept = kept * eigenvectors.transpose();
    let matrix = Matrix6::from_fn(|row, column| kept[(row, column)] / (unit[row] * unit[column]));
    (matrix, eigenvalues.max())
}

pub(super) fn as_push(both: &Vector6<f64>) -> DeviceWrench {
    let [force, torque] = halves(both);
    DeviceWrench { force, torque }
}

pub(super) fn as_vector(push: &DeviceWrench) -> Vector6<f64> {
    join(&push.force, &push.torque)
}
