//! Passes: the same poses again and again, in blocks, so that for each block there is a pass in which
//! nothing else had the core.
//!
//! Of a block the fastest pass counts, and all blocks are summed: the machine undisturbed, as the
//! prototype was timed. Beside it stands the pass in the middle, with all that disturbed it.

use crate::contender::Contender;
use crate::row::Passed;
use std::time::Instant;
use touchoff::Pose;

/// Poses of a block.
pub(crate) const BLOCK: usize = 25;
/// How often each pose is asked.
pub(crate) const PASSES: usize = 5;

/// Neighbouring poses: how many, how many points collide at all of them together, and how long each
/// pass took, ns.
#[derive(Clone)]
pub(crate) struct Block {
    poses: usize,
    colliding: usize,
    ns: [f64; PASSES],
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
        let best = |block: &Block| block.ns.iter().copied().fold(f64::INFINITY, f64::min);
        let pass = |pass: usize| blocks.iter().map(|block| block.ns[pass]).sum::<f64>();
        let mut sums: [f64; PASSES] = std::array::from_fn(pass);
        sums.sort_by(f64::total_cmp);
        Passed {
            passed: poses,
            colliding_avg: a_query(blocks.iter().map(|block| block.colliding as f64).sum()),
            ns_best: a_query(blocks.iter().map(best).sum()),
            ns_median: a_query(sums[PASSES / 2]),
        }
    }
}

/// Asks a method at all poses, [`PASSES`] times.
pub(crate) fn passes(method: &mut dyn Contender, poses: &[Pose]) -> Vec<Block> {
    let mut blocks: Vec<Block> = poses
        .chunks(BLOCK)
        .map(|some| Block { poses: some.len(), colliding: 0, ns: [0.0; PASSES] })
        .collect();
    for pass in 0..PASSES {
        for (some, block) in poses.chunks(BLOCK).zip(&mut blocks) {
            let start = Instant::now();
            let colliding = some.iter().map(|pose| method.query(pose).colliding).sum();
            block.ns[pass] = start.elapsed().as_secs_f64() * 1e9;
            block.colliding = colliding;
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
