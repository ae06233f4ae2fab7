//! Start delays and durations of haptic cycles in real time, compared with a loop that does nothing.

use std::sync::atomic::AtomicBool;
use std::time::Duration;
use touchoff::{Law, Part, Probe};
use touchoff_haptics::{
    LoopReport, MonotonicClock, Realtime, ScriptedDevice, Session, SessionSettings, SimulatedHand,
    Tremor, state_channel,
};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool, upright};

/// Time that a thread spins before each cycle instead of sleeping.
pub const SPIN_TIME: Duration = Duration::from_micros(60);

/// Runs two loops at once, each on a core of its own: a hand that presses on a block, and a tool far away from it.
/// `rate` is in Hz. Returns the reports of the pressing loop and of the empty loop.
pub fn measure(rate: f64, seconds: f64) -> [LoopReport; 2] {
    let part = block(100_000);
    let timing = (rate, (rate * seconds) as u64);
    std::thread::scope(|scope| {
        let pressed = scope.spawn(|| run_loop(&part, timing, true));
        let empty = scope.spawn(|| run_loop(&part, timing, false));
        [pressed, empty].map(|thread| thread.join().expect("a loop panics at nothing"))
    })
}

fn run_loop(part: &Part, (rate, cycles): (f64, u64), pressed: bool) -> LoopReport {
    let core = Some(usize::from(pressed));
    for error in (Realtime { priority: Some(80), core, locked: true }).apply() {
        eprintln!("{error}");
    }
    let probe = Probe::new(part, tool("Ball")).with_law(Law::Gradient);
    let mut session = Session::new(probe, &SessionSettings::new(rate), LIMITS).expect("settings");
    let clock = &mut MonotonicClock::new(SPIN_TIME);
    let (mut publisher, _latest, _samples) = state_channel(1);
    let stop = AtomicBool::new(false);
    if pressed {
        let hand_position = |time: f64| upright(-2.0 + 2.2 * (0.5 * time).sin());
        let tremor = Tremor { size: 0.02, frequency: 10.0, seed: 1 };
        let hand = SimulatedHand::new(LIMITS, rate, hand_position)
            .and_then(|hand| hand.with_tremor(&tremor));
        let mut hand = hand.expect("a hand");
        session.run(&mut hand, clock, cycles, &mut publisher, &stop)
    } else {
        let mut device = ScriptedDevice::new(LIMITS, |_| Ok(upright(1e6)));
        session.run(&mut device, clock, cycles, &mut publisher, &stop)
    }
}
