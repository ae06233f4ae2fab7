//! The largest stiffness of a wall onto which a hand presses a flat end.
//!
//! A mass on a spring that is sampled and held comes to rest as long as the eigenvalues of one cycle are within the
//! unit circle (Gil et al., *Stability boundary for haptic rendering*, 2004). This module has the theory, by a two
//! by two matrix, and the behaviour of the loop.

use super::{tool, upright};
use nalgebra::{Matrix2, Vector2};
use touchoff::{Law, Part, Probe};
use touchoff_haptics::{
    DeviceAxes, DeviceLimits, HandImpedance, Rendering, Session, SessionSettings, SimulatedHand,
};

/// The device that the hand holds.
pub const LIMITS: DeviceLimits = DeviceLimits {
    axes: DeviceAxes::Five,
    force: 20.0,
    torque: 1000.0,
    stiffness: 1.0,
    turning_stiffness: 2000.0,
};

/// Direct rendering without scaling or damping.
pub const DIRECT: Rendering = Rendering::Direct { scaled: false, damping: 0.0 };

/// Computes the exponential of a matrix by its series, after scaling down, and by repeated squaring.
fn exponential(matrix: Matrix2<f64>) -> Matrix2<f64> {
    let small = matrix / 1024.0;
    let mut term = Matrix2::identity();
    let mut sum = term;
    for k in 1..20 {
        term = term * small / f64::from(k);
        sum += term;
    }
    (0..10).fold(sum, |power, _| power * power)
}

/// Returns the largest stiffness of a wall, N/mm, at which a grip comes to rest by theory; `rate` in Hz.
pub fn theoretical_limit(grip: &HandImpedance, rate: f64) -> f64 {
    let per_mass = 1000.0 / grip.mass;
    let dynamics = Matrix2::new(0.0, 1.0, -grip.stiffness * per_mass, -grip.damping * per_mass);
    let transition = exponential(dynamics / rate);
    // The effect of a force of 1 N within a period.
    let inverse = dynamics.try_inverse().expect("a hand with a spring");
    let force = inverse * (transition - Matrix2::identity()) * Vector2::new(0.0, per_mass);
    largest(|stiffness| {
        let closed = transition - force * Vector2::new(stiffness, 0.0).transpose();
        closed.complex_eigenvalues().iter().all(|value| value.norm() < 1.0)
    })
}

/// Returns the largest number for which `is_stable` is true, to one part in a hundred; infinity if it is beyond 10^5.
pub fn largest(is_stable: impl Fn(f64) -> bool) -> f64 {
    const MAX_STIFFNESS: f64 = 1e5;
    let mut high = 0.1;
    while is_stable(high) {
        high *= 2.0;
        if high > MAX_STIFFNESS {
            return f64::INFINITY;
        }
    }
    let mut low = high / 2.0;
    while high > low * 1.01 {
        let middle = (low * high).sqrt();
        if is_stable(middle) { low = middle } else { high = middle }
    }
    low
}

/// A wall and a hand at it.
pub struct Wall<'a> {
    /// The part.
    pub part: &'a Part,
    /// Cycle rate, Hz.
    pub rate: f64,
    /// Rendering of contact.
    pub rendering: Rendering,
    /// Resolution of the device's encoders, mm.
    pub step: f64,
}

impl Wall<'_> {
    /// Returns the swing of the tip in the last tenth of the run, mm, for a wall of this stiffness, N/mm. The swing
    /// is infinite if the device jumps.
    pub fn oscillation(&self, stiffness: f64) -> f64 {
        let mut probe = Probe::new(self.part, tool("Flat")).with_law(Law::Gradient);
        let face = probe.stiffness(&upright(-1e-3)).matrix[(2, 2)];
        let settings = SessionSettings {
            stiffness: stiffness / face,
            rendering: Some(self.rendering),
            passive: false,
            ..SessionSettings::new(self.rate)
        };
        // Presses with a fifth of a newton, and a little more to begin with.
        let hand_pose = |time: f64| upright(if time < 0.2 { -1.05 } else { -1.0 });
        let limits = DeviceLimits { force: 1e6, torque: 1e9, ..LIMITS };
        let hand = SimulatedHand::new(limits, self.rate, hand_pose)
            .and_then(|hand| hand.with_encoders(self.step, 0.0));
        let mut hand = hand.expect("a hand");
        let mut session = Session::new(probe, &settings, limits).expect("settings");
        // Long enough to come to rest, and short enough to wait for.
        let seconds = (2e4 / self.rate).clamp(1.0, 4.0);
        let cycles = (seconds * self.rate) as usize;
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for cycle in 0..cycles {
            session.cycle(&mut hand);
            // A jump is faster than any hand.
            if session.faults().jumps > 0 {
                return f64::INFINITY;
            }
            let Some(pose) = hand.pose_of_handle().filter(|_| cycle >= cycles * 9 / 10) else {
                continue;
            };
            (low, high) = (low.min(pose.tip().z), high.max(pose.tip().z));
        }
        high - low
    }
}
