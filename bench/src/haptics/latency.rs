//! How late cycles begin and how long they take, in real time, beside a loop that does nothing.

use std::sync::atomic::AtomicBool;
use std::time::Duration;
use touchoff::haptic::{
    Hand, Monotonic, Realtime, Report, Scripted, Session, Settings, Tremor, run, watched,
};
use touchoff::{Law, Part, Probe};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool, upright};

/// How long a thread is awake before each cycle.
pub const AWAKE: Duration = Duration::from_micros(60);

/// Both loops at once, each on a core of its own: a hand that presses, and a tool far away.
pub fn both(rate: f64, seconds: f64) -> [Report; 2] {
    let part = block(100_000);
    let timing = (rate, (rate * seconds) as u64);
    std::thread::scope(|scope| {
        let pressed = scope.spawn(|| looped(&part, timing, true));
        let empty = scope.spawn(|| looped(&part, timing, false));
        [pressed, empty].map(|looped| looped.join().expect("a loop panics at nothing"))
    })
}

fn looped(part: &Part, (rate, cycles): (f64, u64), pressed: bool) -> Report {
    let core = Some(usize::from(pressed));
    for refused in (Realtime { priority: Some(80), core, locked: true }).ask() {
        eprintln!("{refused}");
    }
    let probe = Probe::new(part, tool("Ball")).law(Law::Gradient);
    let mut session = Session::new(probe, &Settings::new(rate), LIMITS).expect("settings");
    let clock = &mut Monotonic::new(AWAKE);
    let (mut watch, _latest, _samples) = watched(1);
    let never = AtomicBool::new(false);
    if pressed {
        let wish = |time: f64| upright(-2.0 + 2.2 * (0.5 * time).sin());
        let tremor = Tremor { size: 0.02, frequency: 10.0, seed: 1 };
        let hand = Hand::new(LIMITS, rate, wish).and_then(|hand| hand.trembling(&tremor));
        let mut hand = hand.expect("a hand");
        run((&mut session, &mut hand), (clock, cycles), &mut watch, &never)
    } else {
        let mut far = Scripted::new(LIMITS, |_| Ok(upright(1e6)));
        run((&mut session, &mut far), (clock, cycles), &mut watch, &never)
    }
}
