//! Variants of a line in turns, block by block, so that noise of the machine hits all of them.
//!
//! As in `scaling`, the fastest of [`PASSES`] passes counts of each block, and all blocks are summed.
//! Between two passes of a block lie all others, so that no pose is asked while caches and branch
//! predictors still know it.

use crate::contender::Contender;
use crate::passes::{BLOCK, PASSES};
use cpu_time::ThreadTime;
use std::hint::black_box;
use std::time::Instant;
use touchoff::Pose;

/// What is timed block by block.
pub(crate) trait Variant {
    /// Before its turn, untimed: in use a variant would not have to share its caches with others.
    fn ready(&mut self, block: usize);

    /// Asks all of a block; how many points collide.
    fn run(&mut self, block: usize) -> usize;
}

/// Which clock counts.
#[derive(Clone, Copy)]
pub(crate) enum Clock {
    /// That on the wall, for what many threads do.
    Wall,
    /// The faster of wall and CPU time, for what this thread does alone.
    Quieter,
}

impl Clock {
    /// How long something takes, ns.
    pub(crate) fn time<T>(self, run: impl FnOnce() -> T) -> f64 {
        // The CPU's clock takes long to read: it runs around the other.
        let (cpu, wall) = (ThreadTime::now(), Instant::now());
        black_box(run());
        let [wall, cpu] = [wall.elapsed(), cpu.elapsed()].map(|time| time.as_secs_f64() * 1e9);
        match self {
            Clock::Wall => wall,
            Clock::Quieter => wall.min(cpu),
        }
    }
}

/// What each variant takes for so many blocks, ns.
pub(crate) fn turns<const N: usize>(
    mut variants: [&mut dyn Variant; N],
    blocks: usize,
    clock: Clock,
) -> [f64; N] {
    let mut best = vec![[f64::INFINITY; N]; blocks];
    for pass in 0..PASSES {
        for (block, best) in best.iter_mut().enumerate() {
            for turn in 0..N {
                let which = (turn + block + pass) % N;
                variants[which].ready(block);
                let took = clock.time(|| variants[which].run(block));
                best[which] = best[which].min(took);
            }
        }
    }
    std::array::from_fn(|which| best.iter().map(|best| best[which]).sum())
}

/// A question put at one pose after another.
pub(crate) struct Along<'a> {
    pub(crate) method: &'a mut dyn Contender,
    pub(crate) poses: &'a [Pose],
}

/// The poses of a block.
pub(crate) fn block_of(poses: &[Pose], block: usize) -> &[Pose] {
    &poses[block * BLOCK..poses.len().min((block + 1) * BLOCK)]
}

impl Variant for Along<'_> {
    fn ready(&mut self, block: usize) {
        black_box(self.method.query(&self.poses[(block * BLOCK).saturating_sub(1)]).colliding);
    }

    fn run(&mut self, block: usize) -> usize {
        let some = block_of(self.poses, block);
        some.iter().map(|pose| self.method.query(pose).colliding).sum()
    }
}
