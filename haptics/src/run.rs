//! Running a session at a fixed rate, in a thread of its own.

use super::{Device, DeviceFaults, Session, SessionState};
use hdrhistogram::Histogram;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use touchoff::tool::BatchEvaluator;

/// A clock with a wait function.
pub trait Clock {
    /// Returns the time since a fixed moment. The value may be wrong.
    fn now(&mut self) -> Duration;
    /// Waits until the given time or later.
    fn wait_until(&mut self, time: Duration);
}

/// The system's monotonic clock. It sleeps until shortly before the time to wait for, then spins.
#[derive(Clone, Copy, Debug)]
pub struct MonotonicClock {
    start: Instant,
    /// The time to spin before each deadline.
    spin_time: Duration,
}

impl MonotonicClock {
    /// Creates a clock that spins for `awake` before each deadline. Choose the time that the system
    /// takes to wake a thread.
    pub fn new(awake: Duration) -> MonotonicClock {
        MonotonicClock { start: Instant::now(), spin_time: awake }
    }
}

impl Clock for MonotonicClock {
    fn now(&mut self) -> Duration {
        self.start.elapsed()
    }

    fn wait_until(&mut self, time: Duration) {
        if let Some(remaining) = time.checked_sub(self.start.elapsed() + self.spin_time) {
            std::thread::sleep(remaining);
        }
        while self.start.elapsed() < time {
            std::hint::spin_loop();
        }
    }
}

/// A clock without real time: cycles follow each other as fast as possible.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedClock(Duration);

impl Clock for SimulatedClock {
    fn now(&mut self) -> Duration {
        self.0
    }

    fn wait_until(&mut self, time: Duration) {
        self.0 = time;
    }
}

/// A histogram of durations in ns, with three significant digits.
pub type LatencyHistogram = Histogram<u64>;

/// The result of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoopReport {
    /// The number of completed cycles.
    pub cycles: u64,
    /// The number of cycles that missed their deadline: they ended after the next one was due.
    pub missed: u64,
    /// The number of cycles skipped to catch up.
    pub skipped: u64,
    /// The number of time jumps: a cycle began more than a second late, or the clock went back by more
    /// than a period (a clock that was set, or a starved thread). The schedule restarts there.
    pub stalls: u64,
    /// Durations of cycles: one entry per cycle. The last bin, a minute, also counts all above.
    pub durations: LatencyHistogram,
    /// Delays of cycle starts: one entry per cycle, including stalls. The last bin, a minute, also
    /// counts all above. A cycle before which the clock went back counts as on time.
    pub start_delays: LatencyHistogram,
    /// Faults of the device.
    pub faults: DeviceFaults,
    /// The largest force, N, and the largest torque, N·mm.
    pub peak_wrench: [f64; 2],
    /// The last state.
    pub last: Option<SessionState>,
    /// The number of states dropped because the stream was full.
    pub dropped_states: u64,
}

impl LoopReport {
    fn new() -> LoopReport {
        // From 1 ns to a minute, with a relative resolution of a thousandth.
        let times = Histogram::new_with_bounds(1, 60_000_000_000, 3).expect("bounds in order");
        LoopReport {
            cycles: 0,
            missed: 0,
            skipped: 0,
            stalls: 0,
            durations: times.clone(),
            start_delays: times,
            faults: DeviceFaults::default(),
            peak_wrench: [0.0; 2],
            last: None,
            dropped_states: 0,
        }
    }

    fn record_state(&mut self, state: &SessionState) {
        let sizes = [state.wrench_on_hand.force.norm(), state.wrench_on_hand.torque.norm()];
        self.peak_wrench = [0, 1].map(|k: usize| self.peak_wrench[k].max(sizes[k]));
        self.last = Some(*state);
    }
}

/// The loop's end of the state channel: publishes the latest state and a stream of all states.
#[derive(Debug)]
pub struct StatePublisher {
    latest: triple_buffer::Input<Option<SessionState>>,
    record: rtrb::Producer<SessionState>,
}

/// The latest state, for one reader. Reading is wait-free for both sides.
#[derive(Debug)]
pub struct LatestState(triple_buffer::Output<Option<SessionState>>);

impl LatestState {
    /// Returns the latest state, or `None` before the first one.
    pub fn read(&mut self) -> Option<&SessionState> {
        self.0.read().as_ref()
    }
}

/// All states in order, as long as the reader takes them before the buffer is full.
#[derive(Debug)]
pub struct StateStream(rtrb::Consumer<SessionState>);

impl Iterator for StateStream {
    type Item = SessionState;

    /// Returns the next state, or `None` if there is none yet.
    fn next(&mut self) -> Option<SessionState> {
        self.0.pop().ok()
    }
}

impl StateStream {
    /// Returns whether the loop has ended: no states follow those still in the stream.
    pub fn is_closed(&self) -> bool {
        self.0.is_abandoned()
    }
}

/// Creates both ends of a state channel, with a buffer for `capacity` states in the stream.
pub fn state_channel(capacity: usize) -> (StatePublisher, LatestState, StateStream) {
    let (latest, output) = triple_buffer::triple_buffer(&None);
    let (record, consumer) = rtrb::RingBuffer::new(capacity);
    (StatePublisher { latest, record }, LatestState(output), StateStream(consumer))
}

/// Delay of a cycle that counts as a stall.
const STALL_THRESHOLD: Duration = Duration::from_secs(1);

impl<T: BatchEvaluator + ?Sized> Session<'_, T> {
    /// Runs cycles at their scheduled times, independent of the duration of earlier cycles. The run ends after
    /// `cycles` cycles, when the device has ended, or when `stop` is set. Cycles whose time has passed are skipped and
    /// count toward `cycles`.
    pub fn run(
        &mut self,
        device: &mut impl Device,
        clock: &mut impl Clock,
        cycles: u64,
        publisher: &mut StatePublisher,
        stop: &AtomicBool,
    ) -> LoopReport {
        let mut report = LoopReport::new();
        let period = self.period();
        let mut due = clock.now();
        while report.cycles + report.skipped < cycles && !stop.load(Ordering::Relaxed) {
            clock.wait_until(due);
            let started = clock.now();
            let late = started.saturating_sub(due);
            if late > STALL_THRESHOLD || due.saturating_sub(started) > period {
                report.stalls += 1;
                due = started;
            }
            let state = self.cycle(device);
            if self.faults().ended {
                break;
            }
            report.cycles += 1;
            if let Some(state) = state {
                report.record_state(&state);
                publisher.latest.write(Some(state));
                report.dropped_states += u64::from(publisher.record.push(state).is_err());
            }
            report.start_delays.saturating_record(nanoseconds(late));
            let ended = clock.now();
            report.durations.saturating_record(nanoseconds(ended.saturating_sub(started)));
            due += period;
            // The number of whole periods that have passed.
            let cycles_behind = ended.saturating_sub(due).as_nanos() / period.as_nanos().max(1);
            let cycles_behind =
                u32::try_from(cycles_behind.min(u128::from(cycles))).unwrap_or(u32::MAX);
            report.missed += u64::from(ended > due);
            report.skipped += u64::from(cycles_behind);
            due += period * cycles_behind;
        }
        report.faults = self.faults();
        report
    }
}

fn nanoseconds(time: Duration) -> u64 {
    time.as_nanos().try_into().unwrap_or(u64::MAX)
}
