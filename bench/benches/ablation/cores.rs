//! Many poses on all cores, and one after the other.

use crate::asked::{felt, wrench};
use crate::line::{Row, Setting, agree, trial};
use crate::turns::{Clock, Variant, turns};
use tools_library::Fig73;
use touchoff::{Part, Pose, Probe};

/// `Probe::map` hands a thread so many poses at a time; each gets some of them in a block.
const TOGETHER: usize = 256;
const HANDED: usize = 4;
/// How much longer than another line this one may take: a block has to keep all cores busy.
const LONGER: f64 = 10.0;

struct Many<'a> {
    probe: Probe<'a, Fig73>,
    blocks: Vec<&'a [Pose]>,
    parallel: bool,
}

impl Variant for Many<'_> {
    fn ready(&mut self, block: usize) {
        self.probe.wrench(&self.blocks[block][0]);
    }

    fn run(&mut self, block: usize) -> usize {
        let poses = self.blocks[block];
        if self.parallel {
            let felt = self.probe.map(poses, |probe, pose| probe.wrench(pose));
            felt.iter().map(|felt| felt.colliding).sum()
        } else {
            poses.iter().map(|pose| self.probe.wrench(pose).colliding).sum()
        }
    }
}

/// Starts the threads that will share the work. They inherit the cores of the thread that starts
/// them, so this comes before that one is pinned to a single core.
pub(crate) fn start(part: &Part, poses: &[Pose]) {
    Probe::new(part, &Fig73).map(poses, |probe, pose| probe.detect(pose));
}

/// Poses shared out to all cores.
pub(crate) fn map(setting: &Setting) -> Vec<Row> {
    let probe = Probe::new(setting.part, &Fig73);
    let ns = 2.0 * trial(&mut wrench(probe.another()), &setting.poses);
    let poses = setting.some(ns / LONGER);
    let shared = probe.map(&poses, |probe, pose| felt(&probe.wrench(pose)));
    let mut one = probe.another();
    for (pose, shared) in poses.iter().zip(&shared) {
        agree("map", pose, shared, &felt(&one.wrench(pose)));
    }
    let blocks: Vec<&[Pose]> = poses.chunks(TOGETHER * HANDED * setting.cores).collect();
    let [mut shared, mut one] = [true, false].map(|parallel| Many {
        probe: probe.another(),
        blocks: blocks.clone(),
        parallel,
    });
    let sums = turns([&mut shared, &mut one], blocks.len(), Clock::Wall);
    vec![setting.row("wrench", sums.map(|sum| sum / poses.len() as f64))]
}
