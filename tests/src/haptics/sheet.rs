//! A sheet thinner than the tool, and a hand that presses on it.

use super::wall::LIMITS;
use super::{tool, upright};
use crate::fixtures::cuboid;
use touchoff::{Law, Part, Probe, Sampling};
use touchoff_haptics::{Rendering, Session, SessionSettings, SimulatedHand};

/// Returns a sheet 0.5 mm thick, from z = -0.5 to 0.
pub fn sheet_part() -> Part {
    let mesh = cuboid([-15., -15., -0.5], [15., 15., 0.]);
    Part::from_mesh(&mesh, Sampling::new(40_000)).expect("points of a sheet")
}

/// Presses a ball of 2 mm, with a contact of 100 N/mm³, onto the sheet. The hand wants it ever deeper, by 10 mm per
/// second for two seconds. Returns, per cycle, the depth that the hand wants in mm, the tip's height in mm, and the
/// upward force in N.
pub fn press_on_sheet(part: &Part, law: Law, rendering: Option<Rendering>) -> Vec<[f64; 3]> {
    let settings = SessionSettings { stiffness: 100.0, rendering, ..SessionSettings::new(1000.0) };
    let probe = Probe::new(part, tool("D2Ball")).with_law(law);
    let mut session = Session::new(probe, &settings, LIMITS).expect("settings");
    let hand_height = |time: f64| -10.0 * time;
    let mut hand = SimulatedHand::new(LIMITS, 1000.0, |time| upright(0.2 + hand_height(time)))
        .expect("a hand");
    (0..2_000)
        .filter_map(|cycle| {
            let state = session.cycle(&mut hand)?;
            let hand_height = hand_height(f64::from(cycle) / 1000.0);
            Some([-hand_height, state.tool.tip().z, state.wrench_on_hand.force.z])
        })
        .collect()
}
