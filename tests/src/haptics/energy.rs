//! The energy balance of a hand that taps a plane.

use super::wall::LIMITS;
use super::{tool, upright};
use touchoff::{Law, Part, Probe};
use touchoff_haptics::{EnergyBalance, Rendering, ScriptedDevice, Session, SessionSettings};

/// Moves a ball up and down on a plane eight times per second for five seconds, whatever force it renders; the contact's
/// stiffness is in N/mm³. Returns the energy balance after each cycle.
pub fn tapping_energy(
    part: &Part,
    stiffness: f64,
    rendering: Option<Rendering>,
    passive: bool,
) -> Vec<EnergyBalance> {
    let settings =
        SessionSettings { stiffness, rendering, passive, ..SessionSettings::new(1000.0) };
    let probe = Probe::new(part, tool("D2Ball")).with_law(Law::Gradient);
    let mut session = Session::new(probe, &settings, LIMITS).expect("settings");
    let mut device = ScriptedDevice::new(LIMITS, |cycle| Ok(upright(height(cycle))));
    (0..5_000).filter_map(|_| Some(session.cycle(&mut device)?.energy)).collect()
}

/// Returns the height of the tip above the plane in a cycle, mm.
pub fn height(cycle: u64) -> f64 {
    -0.2 + 0.2 * (cycle as f64 * 0.05).cos()
}
