//! Trees built, checked and timed.

use crate::brute::Scalar;
use crate::clock;
use crate::config::Config;
use crate::contender::{Answer, Contender, Workpiece};
use crate::tree::{Counted, Work};
use cpu_time::ThreadTime;
use touchoff::Pose;
use touchoff::scenes::Path;

/// How often a path is raced over; the median counts.
const ROUNDS: usize = 3;

/// By how much of itself a force may differ for the order in which it was summed.
const ROUNDING: f64 = 1e-9;

/// A path, and what every point asked one by one says at some of its poses.
pub(crate) struct Scene {
    pub(crate) path: Path,
    poses: Vec<Pose>,
    /// Points inside, on average.
    pub(crate) colliding: f64,
    truths: Vec<(Pose, Answer)>,
}

impl Scene {
    pub(crate) fn new(path: Path, count: usize, piece: &Workpiece) -> Scene {
        let poses: Vec<Pose> = (0..count).map(|k| path.pose(k, count)).collect();
        let mut brute = Scalar::new(piece);
        let some = poses.iter().step_by((poses.len() / checks(piece.cloud.len())).max(1));
        let truths: Vec<_> = some.map(|pose| (*pose, brute.query(pose))).collect();
        let colliding: usize = truths.iter().map(|(_, truth)| truth.colliding).sum();
        let colliding = colliding as f64 / truths.len() as f64;
        Scene { path, poses, colliding, truths }
    }
}

/// At how many poses the truth is worked out, which takes long of many points.
fn checks(points: usize) -> usize {
    (20_000_000 / points.max(1)).clamp(200, 1000)
}

/// One tree on all scenes.
pub(crate) struct Measured {
    pub(crate) config: Config,
    /// Of nodes, a point.
    pub(crate) bytes: f64,
    /// Points of a leaf, on average.
    pub(crate) fill: f64,
    /// To build it, ms.
    pub(crate) build: f64,
    pub(crate) scenes: Vec<Found>,
}

/// One tree on one scene.
#[derive(Clone, Copy)]
pub(crate) struct Found {
    /// CPU time of a query, if it was taken, and of its search alone, ns.
    pub(crate) time: Option<f64>,
    pub(crate) search: f64,
    /// What a query does on average.
    pub(crate) tested: f64,
    pub(crate) leaves: f64,
    pub(crate) points: f64,
}

/// Builds trees, checks them, and times them against one another: their search, and if `whole` is
/// wanted the query too.
pub(crate) fn trees(
    configs: &[Config],
    piece: &Workpiece,
    scenes: &[Scene],
    whole: bool,
) -> Vec<Measured> {
    let mut trees = Vec::new();
    let mut all = Vec::new();
    for &config in configs {
        let start = ThreadTime::now();
        let tree = config.build(piece);
        let build = start.elapsed().as_secs_f64() * 1e3;
        let count = piece.cloud.len() as f64;
        let (bytes, fill) = (tree.bytes() as f64 / count, count / tree.leaves() as f64);
        trees.push(tree);
        all.push(Measured { config, bytes, fill, build, scenes: Vec::new() });
    }
    for scene in scenes {
        let work: Vec<[f64; 3]> = trees.iter_mut().map(|tree| check(&mut **tree, scene)).collect();
        let mut race = |searching: bool| {
            let lent = |tree| -> Box<dyn Contender + '_> { Box::new(Lent { tree, searching }) };
            let mut racing: Vec<_> = trees.iter_mut().map(|tree| lent(&mut **tree)).collect();
            times(&mut racing, scene)
        };
        let (whole, search) = (whole.then(|| race(false)), race(true));
        for (at, (measured, [tested, leaves, points])) in all.iter_mut().zip(work).enumerate() {
            let (time, search) = (whole.as_ref().map(|times| times[at]), search[at]);
            measured.scenes.push(Found { time, search, tested, leaves, points });
        }
    }
    all
}

/// CPU time of a query of each, ns.
pub(crate) fn times(racing: &mut [Box<dyn Contender + '_>], scene: &Scene) -> Vec<f64> {
    let rounds: Vec<Vec<clock::Times>> =
        (0..ROUNDS).map(|_| clock::race(racing, &scene.poses, f64::INFINITY)).collect();
    let median = |which: usize| {
        let mut times: Vec<f64> = rounds.iter().map(|round| round[which].cpu()).collect();
        times.sort_unstable_by(f64::total_cmp);
        times[times.len() / 2]
    };
    (0..racing.len()).map(median).collect()
}

/// Tests, leaves and points of a query, on average.
///
/// # Panics
/// If the tree feels anything else than what all points asked one by one come to.
fn check(tree: &mut dyn Counted, scene: &Scene) -> [f64; 3] {
    let mut sum = [0; 3];
    for (pose, truth) in &scene.truths {
        let found = tree.query(pose);
        assert_eq!(found.colliding, truth.colliding, "points at {pose:?}");
        let ([force, torque], [true_force, true_torque]) = (wrench(&found), wrench(truth));
        assert!((force - true_force).norm() <= ROUNDING * (1.0 + true_force.norm()), "{pose:?}");
        assert!((torque - true_torque).norm() <= ROUNDING * (1.0 + true_torque.norm()), "{pose:?}");
        let Work { tested, leaves, points } = tree.work();
        sum = [sum[0] + tested, sum[1] + leaves, sum[2] + points];
    }
    sum.map(|sum| sum as f64 / scene.truths.len() as f64)
}

fn wrench(answer: &Answer) -> [nalgebra::Vector3<f64>; 2] {
    answer.wrench.expect("points have a wrench")
}

/// A tree lent to a race.
pub(crate) struct Lent<'a> {
    pub(crate) tree: &'a mut dyn Counted,
    /// Whether it only searches.
    pub(crate) searching: bool,
}

impl Contender for Lent<'_> {
    fn name(&self) -> &'static str {
        self.tree.name()
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        if self.searching {
            return Answer { colliding: self.tree.search(pose), ..Answer::default() };
        }
        self.tree.query(pose)
    }
}
