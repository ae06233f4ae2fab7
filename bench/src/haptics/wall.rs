//! The stiffest walls onto which a hand presses a flat end, by theory and as measured.

use touchoff_haptics::{Coupling, DeviceLimits, HandImpedance, Rendering};
use touchoff_tests::haptics::block;
use touchoff_tests::haptics::wall::{DIRECT, LIMITS, Wall, largest, theoretical_limit};

/// Results at one rate.
pub struct Row {
    /// Cycle rate, Hz.
    pub rate: f64,
    /// The limit by theory, N/mm.
    pub theory: f64,
    /// The measured limits, N/mm: direct; with encoders of 0.01 mm; scaled; coupled.
    pub measured: [f64; 4],
    /// The largest stiffness of a coupling at which the tip comes to rest, N/mm.
    pub coupling: f64,
}

/// Resolution of the encoders, mm.
pub const ENCODER_STEP: f64 = 0.01;

/// Returns the largest stiffness of a wall at which the tip comes to rest, N/mm: it swings by no more than a
/// micrometre, or two steps of the encoders.
fn max_stable_stiffness(wall: &Wall<'_>) -> f64 {
    let rest = (2.0 * wall.step).max(1e-3);
    largest(|stiffness| wall.oscillation(stiffness) <= rest)
}

/// Measures the limits at a rate.
pub fn row(rate: f64) -> Row {
    let part = block(5_000);
    let theory = theoretical_limit(&HandImpedance::default(), rate);
    let limits = DeviceLimits { force: 1e6, torque: 1e9, ..LIMITS };
    let scaled = Rendering::Direct { scaled: true, damping: 0.0 };
    let coupled = Rendering::Coupled(Coupling::of(&limits));
    let renderings = [(DIRECT, 0.0), (DIRECT, ENCODER_STEP), (scaled, 0.0), (coupled, 0.0)];
    let measured = renderings.map(|(rendering, step)| {
        max_stable_stiffness(&Wall { part: &part, rate, rendering, step })
    });
    let coupling = largest(|stiffness| {
        let rendering = Rendering::Coupled(Coupling { stiffness, ..Coupling::of(&limits) });
        Wall { part: &part, rate, rendering, step: 0.0 }.oscillation(1e4) <= 1e-3
    });
    Row { rate, theory, measured, coupling }
}
