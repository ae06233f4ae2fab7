//! Rendering: the wrench on the hand, from contact, coupling and passivity control.
//!
//! **Virtual coupling** is a spring and damper between the device and the tool. The tool is massless: it always stands
//! where spring and contact balance (Wan and McNeely, *Quasi-static approximation for 6 degrees-of-freedom haptic
//! rendering*, 2003; Barbič and James, *Six-DoF haptic rendering of contact between geometrically complex reduced
//! deformable models*, 2008). Away from the part it follows the hand and no force is applied. In contact the hand is
//! coupled to two springs in series: it never meets a stiffness above the coupling's, however stiff the contact. If the
//! contact force is a gradient, so is the hand's: that of the minimum of the contact and spring energy.
//!
//! **Passivity**: the hand must not get back more energy than it put in. The device applies a constant wrench from one
//! cycle to the next, so its work on the hand between two poses is known exactly: wrench times displacement
//! (Stramigioli et al., *Sampled data systems passivity and discrete port-Hamiltonian systems*, 2005). Contact and
//! coupling store part of the energy that the hand put in. If they store more than was put in, the excess was
//! generated, and the hand could receive it. The controller dissipates the excess with a damper of the required
//! strength (Hannaford and Ryu, *Time-domain passivity control of haptic interfaces*, 2002; with energy tracking, Ryu,
//! Preusche, Hannaford and Hirzinger, 2005).

use crate::frame::{halves, join};
use crate::setting::{SettingError, above_zero, not_negative};
use crate::{DeviceLimits, DeviceWrench};
use nalgebra::{Matrix6, SymmetricEigen, Vector3, Vector6};

/// Methods of computing the device's wrench from contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rendering {
    /// The contact wrench at the device's pose.
    Direct {
        /// `true` to scale the wrench down wherever contact is stiffer than the device can render, by
        /// the largest eigenvalue of the contact's stiffness.
        scaled: bool,
        /// Time constant of a damper in contact, s: the damping coefficient is this time times the
        /// stiffness that the device can render.
        damping: f64,
    },
    /// Virtual coupling: the tool yields at the other end of a spring.
    Coupled(Coupling),
}

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

    pub(super) fn check(&self) -> Result<(), SettingError> {
        above_zero("stiffness of the coupling in N/mm", self.stiffness)?;
        above_zero("rotational stiffness of the coupling in N·mm/rad", self.turning_stiffness)?;
        not_negative("damping of the coupling in s", self.damping)
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

/// Returns the secant stiffness and the energy of a one-dimensional spring whose force is limited to `limit`.
fn capped_spring(stiffness: f64, limit: f64, displacement: f64) -> (f64, f64) {
    if stiffness * displacement <= limit {
        (stiffness, 0.5 * stiffness * displacement * displacement)
    } else {
        // Beyond the limit the force is constant, and the energy grows linearly: the integral of the force.
        (limit / displacement, limit * (displacement - 0.5 * limit / stiffness))
    }
}

/// Limits force and torque to the device's maxima; directions are kept.
pub(super) fn saturate(wrench: &DeviceWrench, limits: &DeviceLimits) -> DeviceWrench {
    DeviceWrench {
        force: capped(wrench.force, limits.force),
        torque: capped(wrench.torque, limits.torque),
    }
}

/// Returns a vector, shortened to a limit if it is longer.
fn capped(vector: Vector3<f64>, limit: f64) -> Vector3<f64> {
    let size = vector.norm();
    vector * if size > limit { limit / size } else { 1.0 }
}

/// Returns the positive semidefinite part of a contact's symmetrised stiffness, and its largest eigenvalue relative to
/// the stiffness that the device can render. At 1, the stiffest direction or rotation is at the device's limit.
pub(super) fn limit_stiffness(matrix: &Matrix6<f64>, limits: &DeviceLimits) -> (Matrix6<f64>, f64) {
    // In units of the device's limits, a stiffness in N/mm and one in N·mm/rad have eigenvalues in common.
    let scale =
        diagonal(limits.stiffness, limits.turning_stiffness).map(|limit| 1.0 / limit.sqrt());
    let scaled = Matrix6::from_fn(|row, column| {
        0.5 * (matrix[(row, column)] + matrix[(column, row)]) * scale[row] * scale[column]
    });
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
    // Negative eigenvalues are cut off, the others stay.
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

/// Energy balance since the session began or restarted, in N·mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct EnergyBalance {
    /// The energy that the hand put in, less what it got back.
    pub input: f64,
    /// The energy stored in contact and coupling.
    pub stored: f64,
    /// The largest excess of stored over supplied energy: the generated energy.
    pub generated: f64,
    /// The energy that the controller dissipated.
    pub dissipated: f64,
}

/// The energy balance and the controller's damper.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Passivity {
    pub(super) energy: EnergyBalance,
    /// The controller's share of the last wrench that the device took.
    damping: Vector6<f64>,
    /// The excess of stored over supplied energy, N·mm.
    excess: f64,
}

impl Passivity {
    /// Accounts for a displacement of the hand under the last wrench.
    pub(super) fn add_work(&mut self, wrench: &DeviceWrench, displacement: &Vector6<f64>) {
        // The wrench acts on the hand: work on the hand is energy that it gets.
        self.energy.input -= to_vector(wrench).dot(displacement);
        self.energy.dissipated -= self.damping.dot(displacement);
    }

    /// Accounts for stored energy that does not come from the hand but counts as supplied.
    pub(super) fn supply(&mut self, energy: f64) {
        self.energy.input += energy;
    }

    /// Updates the stored energy and the excess.
    pub(super) fn set_stored(&mut self, stored: f64) {
        self.energy.stored = stored;
        self.excess = stored - self.energy.input;
        self.energy.generated = self.energy.generated.max(self.excess);
    }

    /// Notes the wrench that the device took, and what it would be without the damper.
    pub(super) fn set_damping(&mut self, applied: &DeviceWrench, undamped: &DeviceWrench) {
        self.damping = to_vector(applied) - to_vector(undamped);
    }

    /// Returns a damper wrench against the displacement of the last cycle. It dissipates the excess if
    /// the next displacement is equally long. It is never stronger than [`MAX_DAMPING_FRACTION`] times the force of the
    /// stiffest springs that the device can render over that displacement.
    pub(super) fn damping_wrench(
        &self,
        displacement: &Vector6<f64>,
        max_stiffness: &Vector6<f64>,
    ) -> DeviceWrench {
        let damper = max_stiffness.component_mul(displacement);
        let power = damper.dot(displacement);
        if self.excess > 0.0 && power > 0.0 {
            // The same displacement again, against this force, takes out `excess`.
            to_wrench(&(damper * -(self.excess / power).min(MAX_DAMPING_FRACTION)))
        } else {
            DeviceWrench::default()
        }
    }
}

/// Largest damper force, relative to the force of the stiffest renderable spring over the same
/// displacement. At 0.5, the damper is half as stiff over a cycle as the device can bear.
const MAX_DAMPING_FRACTION: f64 = 0.5;
