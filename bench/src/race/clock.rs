//! Timing of competing methods: interleaved, on the same poses, and never twice at the same pose.
//!
//! The path is divided into blocks of `POSES_PER_BLOCK` poses. Every block is given to each method in turn, with a
//! different method first each time. Before its turn, a method answers one untimed query at the pose before the block.
//! In real use it would not share its caches with other methods. Even blocks are timed as a whole, for the mean.
//! Odd blocks are timed query by query, for the percentiles; reading the clock adds about 20 ns there. A method that
//! would exceed its time budget skips blocks at even intervals.

use super::contender::{Answer, Contender};
use cpu_time::ThreadTime;
use std::time::{Duration, Instant};
use touchoff::Pose;

/// Number of poses per turn.
const POSES_PER_BLOCK: usize = 25;
/// Number of poses by which a method's time is estimated.
const TRIAL_POSES: usize = 5;

/// The timings of one method.
#[derive(Default)]
pub struct Times {
    /// Even blocks: number of queries, wall time and CPU time.
    in_blocks: usize,
    wall_time: Duration,
    cpu: Duration,
    /// Odd blocks: the time of each query, ns.
    query_times: Vec<u64>,
    colliding: usize,
}

impl Times {
    /// Returns the number of poses queried.
    pub fn poses(&self) -> usize {
        self.in_blocks + self.query_times.len()
    }

    /// Returns the mean wall time per query, ns.
    pub fn average(&self) -> f64 {
        self.wall_time.as_secs_f64() * 1e9 / self.in_blocks.max(1) as f64
    }

    /// Returns the mean CPU time per query, ns.
    pub fn cpu(&self) -> f64 {
        self.cpu.as_secs_f64() * 1e9 / self.in_blocks.max(1) as f64
    }

    /// Returns the time in ns that this fraction of all queries does not exceed. Returns `None` if fewer than one query
    /// lies beyond it.
    pub fn percentile(&self, fraction: f64) -> Option<u64> {
        let queries_beyond = (1.0 - fraction) * self.query_times.len() as f64;
        let index = (self.query_times.len() as f64 * fraction) as usize;
        (queries_beyond > 1.0 - 1e-9)
            .then(|| self.query_times[index.min(self.query_times.len() - 1)])
    }

    /// Returns the time of the longest query, ns.
    pub fn longest(&self) -> Option<u64> {
        self.query_times.last().copied()
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
    for (block, block_poses) in poses.chunks(POSES_PER_BLOCK).enumerate() {
        let previous = &poses[(block * POSES_PER_BLOCK).saturating_sub(1)];
        for turn in 0..methods.len() {
            let index = (turn + block / 2) % methods.len();
            if (block / 2).is_multiple_of(strides[index]) {
                methods[index].query(previous);
                time_block(&mut *methods[index], block_poses, block % 2 == 0, &mut times[index]);
            }
        }
    }
    times.iter_mut().for_each(|times| times.query_times.sort_unstable());
    times
}

fn time_block(method: &mut dyn Contender, poses: &[Pose], as_block: bool, times: &mut Times) {
    if !as_block {
        for pose in poses {
            let start = Instant::now();
            let answer = method.query(pose);
            let taken = start.elapsed();
            times.query_times.push(u64::try_from(taken.as_nanos()).unwrap_or(u64::MAX));
            times.count(&answer);
        }
        return;
    }
    let mut counts = Times::default();
    let (cpu, wall_time) = (ThreadTime::now(), Instant::now());
    for pose in poses {
        counts.count(&method.query(pose));
    }
    times.wall_time += wall_time.elapsed();
    times.cpu += cpu.elapsed();
    times.in_blocks += poses.len();
    times.colliding += counts.colliding;
}

/// Returns `n` such that a method takes part in one of every `n` pairs of blocks.
fn stride(method: &mut dyn Contender, poses: &[Pose], seconds: f64) -> usize {
    let trial = || poses.iter().step_by((poses.len() / TRIAL_POSES).max(1));
    let start = Instant::now();
    trial().for_each(|pose| {
        method.query(pose);
    });
    let seconds_per_query = start.elapsed().as_secs_f64() / trial().count().max(1) as f64;
    (seconds_per_query * poses.len() as f64 / seconds).ceil().max(1.0) as usize
}
