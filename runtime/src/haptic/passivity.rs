//! Whether the hand ever gets back more energy than it put in, and what is done about it.
//!
//! The device pushes the same way from one cycle to the next, so what it does to the hand between two poses is
//! known exactly: its push times the way (Stramigioli et al., *Sampled data systems passivity and discrete
//! port-Hamiltonian systems*, 2005). Of what the hand put in, contact and coupling hold some as energy; when they
//! hold more than was put in, some came from nowhere, and the hand would be given it. The controller takes it
//! out again with a damper that is as strong as that needs (Hannaford and Ryu, *Time-domain passivity control
//! of haptic interfaces*, 2002; with energy to follow, Ryu, Preusche, Hannaford and Hirzinger, 2005).

use super::Push;
use super::coupling::{as_push, as_vector};
use nalgebra::Vector6;

/// Energy in N·mm, since the hand began.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// What the hand put in, less what it got back.
    pub put_in: f64,
    /// What contact and coupling hold.
    pub held: f64,
    /// How much more was ever held than had been put in: what came from nowhere.
    pub generated: f64,
    /// What the controller took out.
    pub taken_out: f64,
}

/// Counts the energy.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Passivity {
    pub(super) energy: Energy,
    /// The part of the last push that is the controller's.
    damping: Vector6<f64>,
    /// What is missing.
    missing: f64,
}

impl Passivity {
    /// The hand went so far against the last push.
    pub(super) fn moved(&mut self, push: &Push, way: &Vector6<f64>) {
        self.energy.put_in -= as_vector(push).dot(way);
        self.energy.taken_out -= self.damping.dot(way);
    }

    /// What was not asked of the hand.
    pub(super) fn given(&mut self, energy: f64) {
        self.energy.put_in += energy;
    }

    /// That so much is held now.
    pub(super) fn holds(&mut self, held: f64) {
        self.energy.held = held;
        self.missing = held - self.energy.put_in;
        self.energy.generated = self.energy.generated.max(self.missing);
    }

    /// A damper against the way of the last cycle that takes out what is missing, if the next way is as long,
    /// and never brakes harder than springs as stiff as the device can render would in that time.
    pub(super) fn damped(&mut self, way: &Vector6<f64>, stiffest: &Vector6<f64>) -> Push {
        let brake = stiffest.component_mul(way);
        let work = brake.dot(way);
        self.damping = if self.missing > 0.0 && work > 0.0 {
            brake * -(self.missing / work).min(BRAKE)
        } else {
            Vector6::zeros()
        };
        as_push(&self.damping)
    }
}

/// The strongest damper, in what a spring would push after the same way. A damper of a half is half as stiff
/// over a cycle as what the device can bear.
const BRAKE: f64 = 0.5;
