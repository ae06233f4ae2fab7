//! What becomes of a hand's energy as it taps a plane.

use super::wall::LIMITS;
use super::{block, tool, upright};
use touchoff::haptic::{Energy, Rendering, Scripted, Session, Settings};
use touchoff::{Law, Part, Probe};

/// The plane.
pub fn plane() -> Part {
    block(20_000)
}

/// Stiffness of the contact, N/mm³.
const STIFFNESS: f64 = 2.0;

/// A ball that is moved up and down on a plane eight times a second, whatever it pushes, for five seconds: the
/// account after each cycle.
pub fn tapping(part: &Part, rendering: Option<Rendering>, passive: bool) -> Vec<Energy> {
    tapping_at(part, STIFFNESS, rendering, passive)
}

/// The same with a contact of another stiffness, N/mm³.
pub fn tapping_at(
    part: &Part,
    stiffness: f64,
    rendering: Option<Rendering>,
    passive: bool,
) -> Vec<Energy> {
    let settings = Settings { stiffness, rendering, passive, ..Settings::new(1000.0) };
    let probe = Probe::new(part, tool("D2Ball")).law(Law::Gradient);
    let mut session = Session::new(probe, &settings, LIMITS).expect("settings");
    let mut device = Scripted::new(LIMITS, |cycle| Ok(upright(height(cycle))));
    (0..5_000).filter_map(|_| Some(session.cycle(&mut device)?.energy)).collect()
}

/// The height of the tip over the plane in a cycle, mm.
pub fn height(cycle: u64) -> f64 {
    -0.2 + 0.2 * (cycle as f64 * 0.05).cos()
}
