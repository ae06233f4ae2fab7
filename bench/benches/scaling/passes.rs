//! Passes: the same poses again and again, in blocks, so that for each block there is a pass in which
//! nothing else had the core.
//!
//! Of a block the fastest pass counts, and all blocks are summed: the machine undisturbed, as the
//! prototype was timed. A block of slow queries outlasts a slice of another program's time, so that
//! no pass may be free of them; its CPU time is. Beside it stands the pass in the middle, by the
//! clock on the wall, with all that disturbed it.

use crate::contender::Contender;
use crate::row::Passed;
use cpu_time::ThreadTime;
use std::time::Instant;
use touchoff::Pose;

/// Poses of a block.
pub(crate) const BLOCK: usize = 25;
/// How often each pose is asked.
pub(crate) const PASSES: usize = 5;

/// Neighbouring poses: how many, how many points collide at all of them together, and how long each
/// pass took, ns: wall time, and the fastest of wall and CPU times.
#[derive(Clone)]
pub(crate) struct Block {
    poses: usize,
    colliding: usize,
    wall: [f64; PASSES],
    best: f64,
}

impl Block {
    /// How many points collide at one pose, on average.
    pub(crate) fn colliding(&self) -> f64 {
        self.colliding as f64 / self.poses as f64
    }
}

impl Passed {
    /// Of some blocks, at least one.
    pub(crate) fn of(blocks: &[Block]) -> Passed {
        let poses: usize = blocks.iter().map(|block| block.poses).sum();
        let a_query = |sum: f64| sum / poses.max(1) as f64;
        let pass = |pass: usize| blocks.iter().map(|block| block.wall[pass]).sum::<f64>();
        let mut sums: [f64; PASSES] = std::array::from_fn(pass);
        sums.sort_by(f64::total_cmp);
        Passed {
            passed: poses,
            colliding_avg: a_query(blocks.iter().map(|block| block.colliding as f64).sum()),
            ns_best: a_query(blocks.iter().map(|block| block.best).sum()),
            ns_median: a_query(sums[PASSES / 2]),
        }
    }
}

/// Asks a method at all poses, [`PASSES`] times.
pub(crate) fn passes(method: &mut dyn Contender, poses: &[Pose]) -> Vec<Block> {
    let mut blocks: Vec<Block> = poses
        .chunks(BLOCK)
        .map(|some| Block {
            poses: some.len(),
            colliding: 0,
            wall: [0.0; PASSES],
            best: f64::INFINITY,
        })
        .collect();
    for pass in 0..PASSES {
        for (some, block) in poses.chunks(BLOCK).zip(&mut blocks) {
            // The CPU's clock takes long to read: it runs around the other.
            let (cpu, wall) = (ThreadTime::now(), Instant::now());
            block.colliding = some.iter().map(|pose| method.query(pose).colliding).sum();
            let [wall, cpu] = [wall.elapsed(), cpu.elapsed()].map(|time| time.as_secs_f64() * 1e9);
            block.wall[pass] = wall;
            block.best = block.best.min(wall).min(cpu);
        }
    }
    blocks
}

/// Whole blocks of the poses, evenly along the path, so many that passes take no longer than
/// `seconds` if a query takes `ns`.
pub(crate) fn thinned(poses: &[Pose], ns: f64, seconds: f64) -> Vec<Pose> {
    let all = ns * 1e-9 * (poses.len() * PASSES) as f64;
    let every = (all / seconds).ceil().max(1.0) as usize;
    poses.chunks(BLOCK).step_by(every).flatten().copied().collect()
}
