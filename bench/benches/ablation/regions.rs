//! Regions that no point of a block of eight is in: points as they lie in the tree, and shuffled.

use crate::contender::Answer;
use crate::line::{Row, Setting, agree};
use crate::turns::{Clock, Variant, turns};
use nalgebra::{Matrix3, Vector3};
use std::hint::black_box;
use tools_library::Fig73;
use touchoff::tool::{Ask, Felt, LANES, Points};
use touchoff::{Level, Pose, Probe, Tool};

/// How many points are evaluated together, at least; those of a pose are not parted.
const TOGETHER: usize = 2_000;
/// How many there are in all, about.
const IN_ALL: usize = 400_000;

/// Blocks of points, evaluated as for a wrench.
struct Evaluated {
    blocks: Vec<Points>,
    felt: Felt,
}

impl Evaluated {
    fn new(blocks: &[Vec<[f64; 3]>]) -> Evaluated {
        let points = |block: &Vec<[f64; 3]>| {
            let mut points = Points::default();
            block.iter().for_each(|point| points.push(*point));
            points
        };
        Evaluated { blocks: blocks.iter().map(points).collect(), felt: Felt::default() }
    }

    fn evaluate(&mut self, block: usize) {
        Fig73.evaluate(Level::new(), Ask::DIRECTION, &self.blocks[block], 1.0, &mut self.felt);
    }

    /// What is felt of a block together.
    fn answer(&mut self, block: usize) -> Answer {
        self.evaluate(block);
        let felt = &self.felt;
        let inside = |at: &usize| felt.inside[at / LANES] >> (at % LANES) & 1 != 0;
        let mut answer = Answer::default();
        let mut force = Vector3::zeros();
        for at in (0..self.blocks[block].len()).filter(inside) {
            let direction = felt.direction.each_ref().map(|part| part[at]);
            answer.colliding += 1;
            answer.depth = answer.depth.max(felt.depth[at]);
            force += felt.magnitude[at] * Vector3::from(direction);
        }
        answer.wrench = Some([force, Vector3::zeros()]);
        answer
    }
}

impl Variant for Evaluated {
    fn ready(&mut self, block: usize) {
        self.evaluate(block.saturating_sub(1));
    }

    fn run(&mut self, block: usize) -> usize {
        self.evaluate(block);
        self.felt.inside.iter().map(|block| block.count_ones() as usize).sum()
    }
}

/// The points that collide along the path, in the tree's order and in none.
pub(crate) fn order(setting: &Setting) -> Vec<Row> {
    let mut blocks = collected(setting);
    let mut in_order = Evaluated::new(&blocks);
    shuffle(&mut blocks);
    let mut shuffled = Evaluated::new(&blocks);
    for block in 0..blocks.len() {
        let answers = [in_order.answer(block), shuffled.answer(block)];
        agree("regions", &Pose::default(), &answers[0], &answers[1]);
    }
    let points: usize = blocks.iter().map(Vec::len).sum();
    let sums = turns([&mut in_order, &mut shuffled], blocks.len(), Clock::Quieter);
    black_box(&in_order.felt);
    vec![setting.row("a point evaluated", sums.map(|sum| sum / points as f64))]
}

/// What collides, in the tool's frame, whose unit is the part's.
fn collected(setting: &Setting) -> Vec<Vec<[f64; 3]>> {
    assert_eq!(Fig73.card().unit, setting.part.unit(), "points need no change of unit");
    let mut probe = Probe::new(setting.part, &Fig73);
    let trial = || setting.poses.iter().step_by((setting.poses.len() / 100).max(1));
    let some: usize = trial().map(|pose| probe.contacts(pose).len()).sum();
    let every = (some * setting.poses.len()).div_ceil(trial().count() * IN_ALL).max(1);
    let mut blocks = vec![Vec::new()];
    for pose in setting.poses.iter().step_by(every) {
        let back: Matrix3<f64> = pose.rotation().transpose();
        let contacts = probe.contacts(pose).iter();
        let seen = contacts.map(|contact| back * (contact.point - pose.tip()));
        if blocks.last().is_some_and(|last| last.len() >= TOGETHER) {
            blocks.push(Vec::new());
        }
        blocks.last_mut().expect("the first is there").extend(seen.map(<[f64; 3]>::from));
    }
    blocks
}

/// Every block in an order of its own, the same in every run (Fisher and Yates, SplitMix64).
fn shuffle(blocks: &mut [Vec<[f64; 3]>]) {
    let mut state = 1u64;
    for block in blocks {
        for at in (1..block.len()).rev() {
            block.swap(at, (random(&mut state) % (at as u64 + 1)) as usize);
        }
    }
}

fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
