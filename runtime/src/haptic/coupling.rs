//! A spring between the device and the tool.
//!
//! The tool is light: at every moment it stands where the spring and the contact balance (Wan and McNeely,
//! *Quasi-static approximation for 6 degrees-of-freedom haptic rendering*, 2003; Barbič and James, *Six-DoF
//! haptic rendering of contact between geometrically complex reduced deformable models*, 2008). So clear of
//! the part it is where the hand wants it and nothing is felt, and in contact the hand feels two springs in a
//! row: nothing stiffer than the coupling, however stiff the contact. Where the contact's force is a
//! gradient, so is the hand's: that of the least energy that contact and spring can have together.

use super::frame::{halves, join};
use super::{Limits, Push};
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// A spring and a damper between a device and its tool, against moving and against turning. The spring pulls
/// with no more than the device can push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// N/mm
    pub stiffness: f64,
    /// N·mm/rad
    pub turning: f64,
    /// How long the damper remembers, s: its damping is that times the stiffness.
    pub damping: f64,
}

impl Coupling {
    /// As stiff as the device can render.
    pub fn of(limits: &Limits) -> Coupling {
        Coupling { stiffness: limits.stiffness, turning: limits.turning, damping: 1e-3 }
    }

    pub(super) fn springs(&self) -> Vector6<f64> {
        diagonal(self.stiffness, self.turning)
    }
}

/// The stiffest that a device can render.
pub(super) fn springs(limits: &Limits) -> Vector6<f64> {
    diagonal(limits.stiffness, limits.turning)
}

fn diagonal(way: f64, turn: f64) -> Vector6<f64> {
    Vector6::new(way, way, way, turn, turn, turn)
}

/// What a spring that pulls with so much at most does when it is stretched: how stiff it is from its
/// rest on, and the energy in it, N·mm.
pub(super) fn spring(
    coupling: &Coupling,
    limits: &Limits,
    stretch: &Vector6<f64>,
) -> (Vector6<f64>, f64) {
    let [way, turn] = halves(stretch).map(|part| part.norm());
    let (force, by_way) = capped(coupling.stiffness, limits.force, way);
    let (torque, by_turn) = capped(coupling.turning, limits.torque, turn);
    (diagonal(force, torque), by_way + by_turn)
}

/// Stiffness and energy of one that is stretched so far.
fn capped(stiffness: f64, most: f64, stretch: f64) -> (f64, f64) {
    if stiffness * stretch <= most {
        (stiffness, 0.5 * stiffness * stretch * stretch)
    } else {
        (most / stretch, most * (stretch - 0.5 * most / stiffness))
    }
}

/// No more than the device can do: force and torque each as they point.
pub(super) fn saturated(push: &Push, limits: &Limits) -> Push {
    let least = |size: f64, most: f64| if size > most { most / size } else { 1.0 };
    Push {
        force: push.force * least(push.force.norm(), limits.force),
        torque: push.torque * least(push.torque.norm(), limits.torque),
    }
}

/// The symmetric part of a contact's stiffness without what pushes on as it gives way, and the most that it is
/// of what the device can render, as an eigenvalue: at 1 the stiffest of all ways and turns is as stiff as the
/// device can bear.
pub(super) fn rendered(matrix: &Matrix6<f64>, limits: &Limits) -> (Matrix6<f64>, f64) {
    let unit = diagonal(limits.stiffness, limits.turning).map(|most| 1.0 / most.sqrt());
    let scaled = Matrix6::from_fn(|row, column| {
        0.5 * (matrix[(row, column)] + matrix[(column, row)]) * unit[row] * unit[column]
    });
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
    let kept = eigenvectors * Matrix6::from_diagonal(&eigenvalues.map(|value| value.max(0.0)));
    let kept = kept * eigenvectors.transpose();
    let matrix = Matrix6::from_fn(|row, column| kept[(row, column)] / (unit[row] * unit[column]));
    (matrix, eigenvalues.max())
}

pub(super) fn as_push(both: &Vector6<f64>) -> Push {
    let [force, torque] = halves(both);
    Push { force, torque }
}

pub(super) fn as_vector(push: &Push) -> Vector6<f64> {
    join(&push.force, &push.torque)
}
