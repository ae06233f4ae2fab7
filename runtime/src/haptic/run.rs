//! A session in time: so many cycles a second, in a thread of its own.

use super::{Device, Faults, Session, State};
use crate::tool::Senses;
use hdrhistogram::Histogram;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A clock that can be waited for.
pub trait Clock {
    /// The time since some moment; it may be wrong.
    fn now(&mut self) -> Duration;
    /// Waits until that time, or longer.
    fn wait_until(&mut self, time: Duration);
}

/// The system's monotonic clock: sleeps until shortly before, and looks at it again and again from then on.
#[derive(Clone, Copy, Debug)]
pub struct Monotonic {
    start: Instant,
    /// For so long it is awake.
    awake: Duration,
}

impl Monotonic {
    /// Awake for so long before each moment that is waited for; what the system takes to wake a thread.
    pub fn new(awake: Duration) -> Monotonic {
        Monotonic { start: Instant::now(), awake }
    }
}

impl Clock for Monotonic {
    fn now(&mut self) -> Duration {
        self.start.elapsed()
    }

    fn wait_until(&mut self, time: Duration) {
        if let Some(left) = time.checked_sub(self.start.elapsed() + self.awake) {
            std::thread::sleep(left);
        }
        while self.start.elapsed() < time {
            std::hint::spin_loop();
        }
    }
}

/// No time at all: cycles follow each other as fast as they can.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unhurried(Duration);

impl Clock for Unhurried {
    fn now(&mut self) -> Duration {
        self.0
    }

    fn wait_until(&mut self, time: Duration) {
        self.0 = time;
    }
}

/// How often something took how long, in ns, to three digits.
pub type Times = Histogram<u64>;

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Report {
    /// Cycles that were done.
    pub cycles: u64,
    /// Cycles that missed their deadline: they ended after the next one was due.
    pub missed: u64,
    /// Cycles that were left out for that.
    pub left_out: u64,
    /// How often time went on by more than a second at once, or back: a clock that was set, a thread that was
    /// starved. Cycles begin anew there.
    pub stalls: u64,
    /// Durations of cycles: one entry per cycle. The last bin, a minute, also counts all above.
    pub took: Times,
    /// Delays of their beginnings: one entry per cycle, those that count as a stall too. The last bin, a minute, also
    /// counts all above; a cycle before which the clock went back counts as on time.
    pub late: Times,
    /// What was wrong with the device.
    pub faults: Faults,
    /// The largest force, N, and the largest torque, N·mm.
    pub peak: [f64; 2],
    /// The last state.
    pub last: Option<State>,
    /// States for which there was no room in the record.
    pub lost: u64,
}

impl Report {
    fn new() -> Report {
        // From 1 ns to a minute, to a part in a thousand: bounds that are in order.
        let times = Histogram::new_with_bounds(1, 60_000_000_000, 3).expect("bounds in order");
        Report {
            cycles: 0,
            missed: 0,
            left_out: 0,
            stalls: 0,
            took: times.clone(),
            late: times,
            faults: Faults::default(),
            peak: [0.0; 2],
            last: None,
            lost: 0,
        }
    }

    fn note(&mut self, state: &State) {
        let sizes = [state.push.force.norm(), state.push.torque.norm()];
        self.peak = [0, 1].map(|k: usize| self.peak[k].max(sizes[k]));
        self.last = Some(*state);
    }
}

/// The loop's end of what others see: the latest state, and a record of all.
pub struct Watch {
    latest: triple_buffer::Input<Option<State>>,
    record: rtrb::Producer<State>,
}

/// The latest state, for one reader, who never keeps the loop waiting, nor is kept waiting.
pub struct Latest(triple_buffer::Output<Option<State>>);

impl Latest {
    /// The latest state; `None` as long as there is none.
    pub fn read(&mut self) -> Option<&State> {
        self.0.read().as_ref()
    }
}

/// All states in order, as long as they are taken before there is no room left.
pub struct Samples(rtrb::Consumer<State>);

impl Iterator for Samples {
    type Item = State;

    /// The next state; `None` if there is none yet.
    fn next(&mut self) -> Option<State> {
        self.0.pop().ok()
    }
}

impl Samples {
    /// Whether the loop is over: nothing comes after what is left.
    pub fn are_all(&self) -> bool {
        self.0.is_abandoned()
    }
}

/// Both ends, with room for a record of that many states.
pub fn watched(room: usize) -> (Watch, Latest, Samples) {
    let (latest, seen) = triple_buffer::triple_buffer(&None);
    let (record, taken) = rtrb::RingBuffer::new(room);
    (Watch { latest, record }, Latest(seen), Samples(taken))
}

/// A second.
const STALL: Duration = Duration::from_secs(1);

/// Lets cycles happen, each at its time after the start whatever those before it took, until so many are over,
/// the device has nothing left to play, or it is told to stop. What comes too late for its time is left out,
/// and counts as over.
pub fn run<T: Senses + ?Sized>(
    (session, device): (&mut Session<'_, T>, &mut impl Device),
    (clock, cycles): (&mut impl Clock, u64),
    watch: &mut Watch,
    stop: &AtomicBool,
) -> Report {
    let mut report = Report::new();
    let period = session.period();
    let mut due = clock.now();
    while report.cycles + report.left_out < cycles && !stop.load(Ordering::Relaxed) {
        clock.wait_until(due);
        let began = clock.now();
        let late = began.saturating_sub(due);
        if late > STALL || due.saturating_sub(began) > period {
            report.stalls += 1;
            due = began;
        }
        let state = session.cycle(device);
        if session.faults().ended {
            break;
        }
        report.cycles += 1;
        if let Some(state) = state {
            report.note(&state);
            watch.latest.write(Some(state));
            report.lost += u64::from(watch.record.push(state).is_err());
        }
        report.late.saturating_record(nanoseconds(late));
        let ended = clock.now();
        report.took.saturating_record(nanoseconds(ended.saturating_sub(began)));
        due += period;
        // As many periods as have gone by whole.
        let behind = ended.saturating_sub(due).as_nanos() / period.as_nanos().max(1);
        let behind = u32::try_from(behind.min(u128::from(cycles))).unwrap_or(u32::MAX);
        report.missed += u64::from(ended > due);
        report.left_out += u64::from(behind);
        due += period * behind;
    }
    report.faults = session.faults();
    report
}

fn nanoseconds(time: Duration) -> u64 {
    time.as_nanos().try_into().unwrap_or(u64::MAX)
}
