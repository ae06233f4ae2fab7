//! Both questions along the paths: yes or no, and all that is felt.

use crate::clock::race;
use crate::contender::{Answer, Contender};
use crate::passes::{passes, thinned};
use crate::row::{Query, Timing};
use crate::{MILLION, Options};
use tools_library::Fig73;
use touchoff::scenes::Path;
use touchoff::{Part, Pose, Probe};

/// Force, torque and all else of the contact.
pub(crate) struct Wrench<'a>(Probe<'a, Fig73>);

/// Whether there is contact; it counts as one point.
struct Detect<'a>(Probe<'a, Fig73>);

impl<'a> Wrench<'a> {
    pub(crate) fn new(part: &'a Part) -> Wrench<'a> {
        Wrench(Probe::new(part, &Fig73))
    }
}

impl Contender for Wrench<'_> {
    fn name(&self) -> &'static str {
        "wrench"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let felt = self.0.wrench(pose);
        let wrench = Some([felt.force, felt.torque]);
        Answer { colliding: felt.colliding, depth: felt.depth(), wrench }
    }
}

impl Contender for Detect<'_> {
    fn name(&self) -> &'static str {
        "detect"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        Answer { colliding: usize::from(self.0.detect(pose)), ..Answer::default() }
    }
}

/// Every path, but for the deepest on more than a million points, where hundreds of thousands of them
/// would collide.
pub(crate) fn paths(part: &Part, options: &Options) -> Vec<Query> {
    let points = part.tree().len();
    let count = options.poses.get();
    let paths = Path::ALL.into_iter().filter(|path| points <= MILLION || *path != Path::Hold);
    paths
        .flat_map(|path| {
            let poses: Vec<Pose> = (0..count).map(|k| path.pose(k, count)).collect();
            let timings = both(part, &poses, options.seconds);
            timings.map(|timing| query(points, path.name(), timing))
        })
        .collect()
}

fn query(points: usize, scene: &'static str, timing: Timing) -> Query {
    let colliding = timing.passed.colliding_avg;
    let a_point = timing.passed.ns_best / colliding;
    let tells = timing.asked == "wrench" && colliding > 0.0;
    Query { points, scene, ns_a_point: tells.then_some(a_point), timing }
}

/// What both questions cost at these poses.
pub(crate) fn both(part: &Part, poses: &[Pose], seconds: f64) -> [Timing; 2] {
    let mut methods: [Box<dyn Contender + '_>; 2] =
        [Box::new(Wrench::new(part)), Box::new(Detect(Probe::new(part, &Fig73)))];
    let times = race(&mut methods, poses, seconds);
    [0, 1].map(|which| {
        let some = thinned(poses, times[which].average(), seconds);
        let blocks = passes(&mut *methods[which], &some);
        Timing::new(methods[which].name(), &times[which], &blocks)
    })
}
