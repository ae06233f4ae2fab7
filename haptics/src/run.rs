//! Running a session at a fixed rate, in a thread of its own, and the real-time scheduling of that thread: priority, core
//! and memory locking.

use crate::{Device, DeviceFaults, Session, SessionState};
use hdrhistogram::Histogram;
use std::fmt;
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
            // Cycles that were missed by so much are not made up for: the schedule begins anew.
            if late > STALL_THRESHOLD || due.saturating_sub(started) > period {
                report.stalls += 1;
                due = started;
            }
            let state = self.cycle(device);
            // The cycle in which the device ends has no pose of its own, and does not count.
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
            // The time of the cycle alone, without the wait for it.
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

/// Real-time properties requested for a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Realtime {
    /// First-in-first-out real-time priority, from 1 to 99, ahead of all threads without one; `None` for no change.
    pub priority: Option<u8>,
    /// The only core to run on, counted from 0; `None` for any.
    pub core: Option<usize>,
    /// `true` to lock all memory of the process.
    pub locked: bool,
}

/// A request that the system refused. The loop runs without it.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RealtimeError {
    /// The priority was refused.
    #[error("no real-time priority ({0}): start as root, or allow it with `ulimit -r`")]
    Priority(String),
    /// The core was refused.
    #[error("not kept on core {core}: this process may run on {}", CoreList(.cores))]
    Core {
        /// The requested core.
        core: usize,
        /// The cores available to this process, in ascending order.
        cores: Vec<usize>,
    },
    /// Memory locking was refused.
    #[error("memory is not locked ({0}): start as root, or allow it with `ulimit -l`")]
    Memory(String),
}

touchoff::debug_as_sentence!(RealtimeError);

impl Realtime {
    /// Applies the requests to the calling thread. Returns those that were refused; the others take effect.
    pub fn apply(&self) -> Vec<RealtimeError> {
        let mut errors = Vec::new();
        if let Some(core) = self.core
            && let Err(error) = pin_to_core(core)
        {
            errors.push(error);
        }
        if self.locked
            && let Err(error) = lock_memory()
        {
            errors.push(RealtimeError::Memory(error));
        }
        if let Some(priority) = self.priority
            && let Err(error) = set_priority(priority)
        {
            errors.push(RealtimeError::Priority(error));
        }
        errors
    }
}

/// Checks that this process may run on a core, counted from 0.
///
/// # Errors
/// Returns [`RealtimeError::Core`] with the available cores if it may not.
pub fn check_core(core: usize) -> Result<(), RealtimeError> {
    let ids = core_affinity::get_core_ids().unwrap_or_default();
    let cores: Vec<usize> = ids.into_iter().map(|id| id.id).collect();
    if cores.contains(&core) { Ok(()) } else { Err(RealtimeError::Core { core, cores }) }
}

/// Binds the calling thread to a core.
fn pin_to_core(core: usize) -> Result<(), RealtimeError> {
    // Check first: the system's core set has a fixed size, beyond which no core may be requested.
    check_core(core)?;
    if core_affinity::set_for_current(core_affinity::CoreId { id: core }) {
        return Ok(());
    }
    let ids = core_affinity::get_core_ids().unwrap_or_default();
    Err(RealtimeError::Core { core, cores: ids.into_iter().map(|id| id.id).collect() })
}

/// A list of cores, displayed as ranges: `core 0 to 7, 12`.
struct CoreList<'a>(&'a [usize]);

impl fmt::Display for CoreList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("cores that the system does not name");
        }
        let runs = self.0.chunk_by(|one, next| one + 1 == *next);
        for (k, run) in runs.enumerate() {
            f.write_str(if k == 0 { "core " } else { ", " })?;
            match run {
                [first, .., last] => write!(f, "{first} to {last}")?,
                _ => write!(f, "{}", run[0])?,
            }
        }
        Ok(())
    }
}

#[cfg(unix)]
fn lock_memory() -> Result<(), String> {
    use rustix::mm::{MlockAllFlags, mlockall};
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| error.to_string())
}

#[cfg(not(unix))]
fn lock_memory() -> Result<(), String> {
    Err("this system has no such call".to_owned())
}

#[cfg(unix)]
fn set_priority(priority: u8) -> Result<(), String> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let value = ThreadPriorityValue::try_from(priority).map_err(|error| error.to_string())?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority_value = ThreadPriority::Crossplatform(value);
    set_thread_priority_and_policy(thread_native_id(), priority_value, policy)
        .map_err(|e| e.to_string())
}

#[cfg(not(unix))]
fn set_priority(_: u8) -> Result<(), String> {
    use thread_priority::ThreadPriority;
    thread_priority::set_current_thread_priority(ThreadPriority::Max).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cores_that_there_are_not_are_refused_with_those_that_there_are() {
        for core in [1024, 4096, usize::MAX] {
            let realtime = Realtime { core: Some(core), ..Realtime::default() };
            let [RealtimeError::Core { core: refused, cores }] = &realtime.apply()[..] else {
                panic!("{core} was granted")
            };
            assert_eq!(*refused, core);
            for core in cores {
                assert_eq!(check_core(*core), Ok(()));
            }
        }
        let error = |cores| RealtimeError::Core { core: 9, cores }.to_string();
        assert!(error(vec![0, 1, 2, 5, 7, 8]).ends_with("may run on core 0 to 2, 5, 7 to 8"));
        assert!(error(vec![]).ends_with("cores that the system does not name"));
    }
}
