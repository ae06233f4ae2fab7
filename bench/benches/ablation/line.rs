//! A line: what it costs with a skip and without it, once both gave the same answers.

use crate::contender::{Answer, Contender};
use crate::passes::{BLOCK, PASSES};
use crate::turns::{Along, Clock, turns};
use nalgebra::Vector3;
use serde::Serialize;
use touchoff::scenes::Path;
use touchoff::{Part, Pose};

/// A row of a table; times are of what its chapter says, ns.
#[derive(Serialize)]
pub(crate) struct Row {
    pub(crate) skip: String,
    pub(crate) scene: &'static str,
    pub(crate) points: usize,
    pub(crate) ns_with: f64,
    pub(crate) ns_without: f64,
    pub(crate) ratio: f64,
}

/// A part, a path along it, and how long a line may take.
pub(crate) struct Setting<'a> {
    pub(crate) part: &'a Part,
    pub(crate) path: Path,
    pub(crate) poses: Vec<Pose>,
    pub(crate) seconds: f64,
    /// How many the machine has.
    pub(crate) cores: usize,
}

/// How many poses tell what a query takes.
const TRIAL: usize = 20;
/// By how much sums of another order may differ, relatively.
const TOLERANCE: f64 = 1e-9;

impl Setting<'_> {
    pub(crate) fn row(&self, skip: &str, [ns_with, ns_without]: [f64; 2]) -> Row {
        Row {
            skip: skip.to_owned(),
            scene: self.path.name(),
            points: self.part.tree().len(),
            ns_with,
            ns_without,
            ratio: ns_without / ns_with,
        }
    }

    /// As many of the poses as there is time for, given what all variants together take at one, ns.
    ///
    /// Evenly along the path, pose by pose: of the slowest queries there would be but a block.
    pub(crate) fn some(&self, ns: f64) -> Vec<Pose> {
        let all = ns * 1e-9 * (self.poses.len() * PASSES) as f64;
        let every = (all / self.seconds).ceil().max(1.0) as usize;
        self.poses.iter().step_by(every).copied().collect()
    }

    /// Two ways to the same answer.
    pub(crate) fn compare(
        &self,
        skip: &str,
        with: &mut dyn Contender,
        without: &mut dyn Contender,
    ) -> Row {
        let poses = self.some(trial(with, &self.poses) + trial(without, &self.poses));
        for pose in &poses {
            agree(skip, pose, &with.query(pose), &without.query(pose));
        }
        let mut with = Along { method: with, poses: &poses };
        let mut without = Along { method: without, poses: &poses };
        let blocks = poses.len().div_ceil(BLOCK);
        let sums = turns([&mut with, &mut without], blocks, Clock::Quieter);
        self.row(skip, sums.map(|sum| sum / poses.len() as f64))
    }
}

/// What a query takes, roughly, ns.
pub(crate) fn trial(method: &mut dyn Contender, poses: &[Pose]) -> f64 {
    let some = || poses.iter().step_by((poses.len() / TRIAL).max(1));
    let all = || some().map(|pose| method.query(pose).colliding).sum::<usize>();
    Clock::Quieter.time(all) / some().count() as f64
}

/// Stops the program unless two answers are the same: as many points, as deep, the same wrench but for
/// the order of its sums.
pub(crate) fn agree(skip: &str, pose: &Pose, with: &Answer, without: &Answer) {
    let vectors = |answer: &Answer| answer.wrench.unwrap_or([Vector3::zeros(); 2]);
    let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() <= TOLERANCE * a.norm();
    let [[force, torque], [other, turn]] = [vectors(with), vectors(without)];
    assert!(
        with.colliding == without.colliding
            && with.depth == without.depth
            && near(force, other)
            && near(torque, turn),
        "{skip} at {pose:?}: with the skip {with:?}, without it {without:?}"
    );
}
