//! Timing of competing methods: interleaved, on the same poses, and never twice at the same pose.
//!
//! The path is divided into blocks of `BLOCK` poses. Every block is given to each method in turn, with a different
//! method first each time. Before its turn, a method answers one untimed query at the pose before the block. In real
//! use it would not share its caches with other methods. Even blocks are timed as a whole, for the mean. Odd blocks are
//! timed query by query, for the percentiles; reading the clock adds about 20 ns there. A method that would exceed its
//! time budget skips blocks at even intervals.

use super::contender::{Answer, Contender};
use cpu_time::ThreadTime;
use std::time::{Duration, Instant};
use touchoff::Pose;

/// Number of poses per turn.
const BLOCK: usize = 25;
/// Number of poses by which a method's time is estimated.
const TRIAL: usize = 5;

/// The timings of one method.
#[derive(Default)]
pub struct Times {
    /// Even blocks: number of queries, wall time and CPU time.
    together: usize,
    wall: Duration,
    cpu: Duration,
    /// Odd blocks: the time of each query, ns.
    single: Vec<u64>,
    colliding: usize,
}

impl Times {
    /// Returns the number of poses queried.
    pub fn poses(&self) -> usize {
        self.together + self.single.len()
    }

    /// Returns the mean wall time per query, ns.
    pub fn average(&self) -> f64 {
        self.wall.as_secs_f64() * 1e9 / self.together.max(1) as f64
    }

    /// Returns the mean CPU time per query, ns.
    pub fn cpu(&self) -> f64 {
        self.cpu.as_secs_f64() * 1e9 / self.together.max(1) as f64
    }

    /// Returns the time in ns that a fraction `part` of all queries does not exceed. Returns `None` if fewer than one
    /// query lies beyond it.
    pub fn percentile(&self, part: f64) -> Option<u64> {
        let beyond = (1.0 - part) * self.single.len() as f64;
        let at = (self.single.len() as f64 * part) as usize;
        (beyond > 1.0 - 1e-9).then(|| self.single[at.min(self.single.len() - 1)])
    }

    /// Returns the time of the longest query, ns.
    pub fn longest(&self) -> Option<u64> {
        self.single.last().copied()
    }

    /// Returns the mean number of points inside.
    pub fn colliding(&self) -> f64 {
        self.colliding as f64 / self.poses().max(1) as f64
    }

    fn count(&mut self, answer: &Answer) {
        self.colliding += answer.colliding;
    }
}

/// Pins the thread to the last core. Returns whether that succeeded.
pub fn pin() -> bool {
    let cores = core_affinity::get_core_ids().unwrap_or_default();
    cores.last().is_some_and(|core| core_affinity::set_for_current(*core))
}

/// Times methods on a path, each for about `seconds` at most.
pub fn race(methods: &mut [Box<dyn Contender + '_>], poses: &[Pose], seconds: f64) -> Vec<Times> {
    let strides: Vec<usize> =
        methods.iter_mut().map(|m| stride(&mut **m, poses, seconds)).collect();
    let mut times: Vec<Times> = methods.iter().map(|_| Times::default()).collect();
    for (block, some) in poses.chunks(BLOCK).enumerate() {
        let before = &poses[(block * BLOCK).saturating_sub(1)];
        for turn in 0..methods.len() {
            let which = (turn + block / 2) % methods.len();
            if (block / 2).is_multiple_of(strides[which]) {
                methods[which].query(before);
                round(&mut *methods[which], some, block % 2 == 0, &mut times[which]);
            }
        }
    }
    times.iter_mut().for_each(|times| times.single.sort_unstable());
    times
}

fn round(method: &mut dyn Contender, poses: &[Pose], together: bool, times: &mut Times) {
    if !together {
        for pose in poses {
            let start = Instant::now();
            let answer = method.query(pose);
            let taken = start.elapsed();
            times.single.push(u64::try_from(taken.as_nanos()).unwrap_or(u64::MAX));
            times.count(&answer);
        }
        return;
    }
    let mut counts = Times::default();
    let (cpu, wall) = (ThreadTime::now(), Instant::now());
    for pose in poses {
        counts.count(&method.query(pose));
    }
    times.wall += wall.elapsed();
    times.cpu += cpu.elapsed();
    times.together += poses.len();
    times.colliding += counts.colliding;
}

/// Returns `n` such that a method takes part in one of every `n` pairs of blocks.
fn stride(method: &mut dyn Contender, poses: &[Pose], seconds: f64) -> usize {
    let trial = || poses.iter().step_by((poses.len() / TRIAL).max(1));
    let start = Instant::now();
    trial().for_each(|pose| {
        method.query(pose);
    });
    let one = start.elapsed().as_secs_f64() / trial().count().max(1) as f64;
    (one * poses.len() as f64 / seconds).ceil().max(1.0) as usize
}
