//! Passivity observer and controller: the hand must not get back more energy than it put in.
//!
//! The device applies a constant wrench from one cycle to the next, so its work on the hand between two
//! poses is known exactly: wrench times displacement (Stramigioli et al., *Sampled data systems
//! passivity and discrete port-Hamiltonian systems*, 2005). Contact and coupling store part of the
//! energy that the hand put in. If they store more than was put in, the excess was generated, and the
//! hand could receive it. The controller dissipates the excess with a damper of the required strength
//! (Hannaford and Ryu, *Time-domain passivity control of haptic interfaces*, 2002; with energy tracking,
//! Ryu, Preusche, Hannaford and Hirzinger, 2005).

use super::DeviceWrench;
use super::coupling::{to_vector, to_wrench};
use nalgebra::Vector6;

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
    /// The controller's share of the last wrench.
    damping: Vector6<f64>,
    /// The excess of stored over supplied energy, N·mm.
    excess: f64,
}

impl Passivity {
    /// Accounts for a displacement of the hand under the last wrench.
    pub(super) fn add_work(&mut self, wrench: &DeviceWrench, displacement: &Vector6<f64>) {
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

    /// Returns a damper wrench against the displacement of the last cycle. It dissipates the excess if
    /// the next displacement is equally long. It is never stronger than [`MAX_DAMPING_FRACTION`] times the force of the
    /// stiffest springs that the device can render over that displacement.
    pub(super) fn damping_wrench(
        &mut self,
        displacement: &Vector6<f64>,
        max_stiffness: &Vector6<f64>,
    ) -> DeviceWrench {
        let damper = max_stiffness.component_mul(displacement);
        let power = damper.dot(displacement);
        self.damping = if self.excess > 0.0 && power > 0.0 {
            damper * -(self.excess / power).min(MAX_DAMPING_FRACTION)
        } else {
            Vector6::zeros()
        };
        to_wrench(&self.damping)
    }
}

/// Largest damper force, relative to the force of the stiffest renderable spring over the same
/// displacement. At 0.5, the damper is half as stiff over a cycle as the device can bear.
const MAX_DAMPING_FRACTION: f64 = 0.5;
