//! Two versions of one library in one process: `scripts/race.sh`.

use std::hint::black_box;
use std::time::Instant;

const POSES: usize = 10_000;
const BLOCK: usize = 25;
const PASSES: usize = 7;
const SCENES: [&str; 4] = ["outside", "inside", "hold", "apart"];

/// One version: its part, and the time of a block of poses.
macro_rules! version {
    ($name:ident, $touchoff:ident, $tools:ident) => {
        mod $name {
            use super::*;
            use $touchoff::scenes::{Path, apart, tube};
            use $touchoff::{Cloud, Part, Pose, Probe};

            pub fn part(count: usize) -> &'static Part {
                let cloud = Cloud::random(&tube(), count, 1).expect("points of a tube");
                Box::leak(Box::new(Part::from_cloud(&cloud)))
            }

            pub fn poses(scene: usize) -> Vec<Pose> {
                let pose = |k| match Path::ALL.get(scene) {
                    Some(path) => path.pose(k, POSES),
                    None => apart(0.5, k, POSES),
                };
                (0..POSES).map(pose).collect()
            }

            pub struct Racer(Probe<'static, $tools::Fig73Exact>, Vec<Pose>);

            impl Racer {
                pub fn new(part: &'static Part, scene: usize) -> Racer {
                    Racer(Probe::new(part, &$tools::Fig73Exact), poses(scene))
                }

                /// ns a pose.
                pub fn time(&mut self, block: usize) -> f64 {
                    let Racer(probe, poses) = self;
                    let start = Instant::now();
                    for pose in &poses[block * BLOCK..(block + 1) * BLOCK] {
                        black_box(probe.wrench(black_box(pose)));
                    }
                    start.elapsed().as_nanos() as f64 / BLOCK as f64
                }
            }
        }
    };
}

version!(now, this, this_tools);
version!(then, other, other_tools);

fn main() {
    println!("| points | scene | other, ns | this, ns | this by other |\n|--:|---|--:|--:|--:|");
    for count in [20_000, 1_000_000] {
        let parts = (then::part(count), now::part(count));
        for (scene, name) in SCENES.into_iter().enumerate() {
            let mut racers = (then::Racer::new(parts.0, scene), now::Racer::new(parts.1, scene));
            let mut best = vec![[f64::MAX; 2]; POSES / BLOCK];
            for pass in 0..PASSES {
                for (block, best) in best.iter_mut().enumerate() {
                    for turn in 0..2 {
                        let who = (block + pass + turn) % 2;
                        let time = if who == 0 { racers.0.time(block) } else { racers.1.time(block) };
                        best[who] = best[who].min(time);
                    }
                }
            }
            let mean = |who: usize| best.iter().map(|b| b[who]).sum::<f64>() / best.len() as f64;
            let (other, this) = (mean(0), mean(1));
            println!("| {count} | {name} | {other:.0} | {this:.0} | {:.3} |", this / other);
        }
    }
}
