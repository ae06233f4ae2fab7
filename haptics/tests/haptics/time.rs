//! Cycles at their time, with clocks of every kind.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use touchoff::{Law, Part, Pose, Probe};
use touchoff_haptics::{
    Clock, DeviceError, LoopReport, MonotonicClock, PlaybackDevice, ScriptedDevice, Session,
    SessionSettings, SimulatedClock, state_channel,
};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool, upright};

fn session(part: &Part) -> Session<'_> {
    let probe = Probe::new(part, tool("Flat")).with_law(Law::Gradient);
    Session::new(probe, &SessionSettings::new(1000.0), LIMITS).expect("settings")
}

/// Cycles per second.
const SECOND: u64 = 1000;

fn ran(clock: &mut impl Clock) -> LoopReport {
    let part = block(5_000);
    let mut device = ScriptedDevice::new(LIMITS, |_| Ok(upright(-0.2)));
    let (mut watch, _latest, _samples) = state_channel(16);
    let stop = AtomicBool::new(false);
    session(&part).run(&mut device, clock, SECOND, &mut watch, &stop)
}

#[test]
fn a_second_of_cycles_takes_a_second() {
    let mut clock = MonotonicClock::new(Duration::from_micros(100));
    let report = ran(&mut clock);
    // A late last cycle skips some that come after the end.
    assert!(report.cycles <= 1000 && report.cycles + report.skipped >= 1000, "{report:?}");
    assert!(clock.now() >= Duration::from_millis(999));
    assert_eq!(report.stalls, 0);
    assert_eq!(report.durations.len(), report.cycles);
    assert!(report.peak_wrench[0] > 0.1);
}

/// A clock that jumps at one cycle.
struct Wrong {
    time: Duration,
    waited: u64,
    at: u64,
    jump: fn(Duration) -> Duration,
}

impl Clock for Wrong {
    fn now(&mut self) -> Duration {
        self.time
    }
    fn wait_until(&mut self, time: Duration) {
        self.waited += 1;
        self.time = self.time.max(time);
        if self.waited == self.at {
            self.time = (self.jump)(self.time);
        }
    }
}

fn wrong(jump: fn(Duration) -> Duration) -> LoopReport {
    ran(&mut Wrong { time: Duration::from_secs(100), waited: 0, at: 500, jump })
}

#[test]
fn clock_jumps_do_not_stop_the_loop() {
    let ahead = wrong(|time| time + Duration::from_secs(3600));
    assert_eq!((ahead.cycles, ahead.skipped, ahead.stalls), (1000, 0, 1));
    let back = wrong(|time| time - Duration::from_secs(50));
    assert_eq!((back.cycles, back.skipped, back.stalls), (1000, 0, 1));
}

/// Each cycle is one entry, stalls too: a tail that leaves the latest cycles out would look shorter than it is.
#[test]
fn cycles_that_begin_more_than_a_second_late_are_in_the_histogram() {
    for (seconds, counted) in [(1.5, 1.5), (30.0, 30.0), (3600.0, 60.0)] {
        let report = match seconds {
            1.5 => wrong(|time| time + Duration::from_millis(1500)),
            30.0 => wrong(|time| time + Duration::from_secs(30)),
            _ => wrong(|time| time + Duration::from_secs(3600)),
        };
        assert_eq!((report.stalls, report.start_delays.len()), (1, report.cycles), "{seconds} s");
        let latest = report.start_delays.max() as f64 / 1e9;
        // To three digits; the last bin counts all above a minute.
        assert!((latest / counted - 1.0).abs() < 2e-3, "{latest} s of {seconds} s");
        assert_eq!(report.start_delays.count_between(1_000_000_000, u64::MAX), 1, "{seconds} s");
    }
    let back = wrong(|time| time - Duration::from_secs(50));
    assert_eq!(
        (back.stalls, back.start_delays.len(), back.start_delays.max()),
        (1, back.cycles, 0)
    );
}

#[test]
fn a_starved_thread_skips_cycles() {
    let late = wrong(|time| time + Duration::from_micros(7_500));
    assert_eq!((late.cycles, late.missed, late.skipped, late.stalls), (994, 1, 6, 0));
    // To three digits.
    assert!(
        (late.start_delays.max() as f64 / 7.5e6 - 1.0).abs() < 1e-3,
        "{}",
        late.start_delays.max()
    );
}

#[test]
fn the_loop_stops_on_request_or_at_the_end_of_input() {
    let part = block(5_000);
    let (mut watch, _latest, _samples) = state_channel(16);
    let stop = AtomicBool::new(false);
    let stops = |cycle: u64| {
        if cycle == 99 {
            stop.store(true, Ordering::Relaxed);
        }
        Ok(upright(1.0))
    };
    let clock = &mut SimulatedClock::default();
    let mut device = ScriptedDevice::new(LIMITS, stops);
    let report = session(&part).run(&mut device, clock, SECOND, &mut watch, &stop);
    assert_eq!(report.cycles, 100);

    let never = AtomicBool::new(false);
    let path = vec![upright(1.0), upright(-1.0), upright(1.0)];
    let mut played = PlaybackDevice::new(path, 50, LIMITS).expect("no axis turns over");
    let report = session(&part).run(&mut played, clock, SECOND, &mut watch, &never);
    assert_eq!(report.cycles, 51);
}

/// A reader sees states in order, and a record has all of them; one that is not emptied loses some and reports
/// their number.
#[test]
fn other_threads_see_the_state() {
    let part = block(5_000);
    let script = |cycle: u64| -> Result<Pose, DeviceError> { Ok(upright(-1e-4 * cycle as f64)) };
    let (mut watch, mut latest, samples) = state_channel(1000);
    assert!(latest.read().is_none());
    let stop = AtomicBool::new(false);
    let report = std::thread::scope(|scope| {
        let looped = scope.spawn(|| {
            let mut device = ScriptedDevice::new(LIMITS, script);
            let clock = &mut MonotonicClock::new(Duration::ZERO);
            session(&part).run(&mut device, clock, SECOND, &mut watch, &stop)
        });
        let mut read_count = 0;
        while !looped.is_finished() {
            if let Some(state) = latest.read() {
                assert!(state.cycle >= read_count);
                read_count = state.cycle;
            }
        }
        looped.join().expect("the loop panics at nothing")
    });
    assert_eq!(report.dropped_states, 0);
    let cycles: Vec<u64> = samples.map(|state| state.cycle).collect();
    assert_eq!(cycles, (0..report.cycles).collect::<Vec<u64>>());
    assert_eq!(latest.read().map(|state| state.cycle), report.last.map(|state| state.cycle));

    let (mut watch, _latest, _full) = state_channel(10);
    let clock = &mut SimulatedClock::default();
    let mut device = ScriptedDevice::new(LIMITS, script);
    let report = session(&part).run(&mut device, clock, SECOND, &mut watch, &stop);
    assert_eq!(report.dropped_states, 990);
}
