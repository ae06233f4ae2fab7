//! Times two versions of the library in one process; run by `scripts/race.sh`.

use std::hint::black_box;
use std::time::Instant;

const POSES: usize = 2_000;
const BLOCK: usize = 25;
const PASSES: usize = 7;
/// Tolerance of certified depths, mm.
const TOLERANCE: f64 = 1e-6;
const QUERIES: [&str; 4] = ["wrench", "detect", "certified depth", "motion"];
const SCENES: [&str; 4] = ["outside", "inside", "hold", "apart"];

/// Defines the module of one version: its part, and the time per block of poses.
macro_rules! version {
    ($name:ident, $touchoff:ident, $tools:ident) => {
        mod $name {
            use super::*;
            use $touchoff::certify::{Certifier, TriangleBvh};
            use $touchoff::scenes::{ScenePath, pose_at_gap, tube};
            use $touchoff::{Cloud, Motion, Part, Pose, Probe, Sampling};

            pub fn part(count: usize) -> &'static Part {
                let cloud = Cloud::sample(&tube(), Sampling::monte_carlo(count)).expect("points of a tube");
                Box::leak(Box::new(Part::from_cloud(&cloud)))
            }

            pub fn poses(scene: usize) -> Vec<Pose> {
                let pose = |k| match ScenePath::ALL.get(scene) {
                    Some(path) => path.pose(k, POSES),
                    None => pose_at_gap(0.5, k, POSES),
                };
                (0..POSES).map(pose).collect()
            }

            pub fn certifier() -> Certifier<'static> {
                let bvh: &'static TriangleBvh = Box::leak(Box::new(TriangleBvh::new(&tube())));
                Certifier::new(bvh, &$tools::Fig73Exact).expect("a tool with a profile")
            }

            pub struct Racer {
                probe: Probe<'static, $tools::Fig73Exact>,
                certifier: Certifier<'static>,
                poses: Vec<Pose>,
                motions: Vec<Motion>,
            }

            impl Racer {
                pub fn new(part: &'static Part, scene: usize) -> Racer {
                    let poses = poses(scene);
                    // Successive poses of a path are close, so their axes are not antiparallel.
                    let motion = |pair: &[Pose]| Motion::new(&pair[0], &pair[1]).expect("a motion");
                    let motions: Vec<Motion> = poses.windows(2).map(motion).collect();
                    Racer {
                        probe: Probe::new(part, &$tools::Fig73Exact),
                        certifier: certifier(),
                        motions,
                        poses,
                    }
                }

                /// Returns the mean time per pose, ns.
                pub fn time(&mut self, query: usize, block: usize) -> f64 {
                    let Racer { probe, certifier, poses, motions } = self;
                    let poses = &poses[block * BLOCK..(block + 1) * BLOCK];
                    let start = Instant::now();
                    for (k, pose) in poses.iter().enumerate() {
                        let pose = black_box(pose);
                        match query {
                            0 => _ = black_box(probe.wrench(pose)),
                            1 => _ = black_box(probe.detect(pose)),
                            2 => _ = black_box(certifier.deepest(pose, TOLERANCE)),
                            _ => {
                                let motion = &motions[(block * BLOCK + k).min(motions.len() - 1)];
                                _ = black_box(certifier.check_motion(black_box(motion), TOLERANCE));
                            }
                        }
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
    println!("| points | scene | query | other, ns | this, ns | this by other |\n|--:|---|---|--:|--:|--:|");
    for count in [20_000, 1_000_000] {
        let parts = (then::part(count), now::part(count));
        for (scene, name) in SCENES.into_iter().enumerate() {
            let mut racers = (then::Racer::new(parts.0, scene), now::Racer::new(parts.1, scene));
            // Certified queries use the triangles, so they do not depend on the number of points.
            let queries = if count == 20_000 { &QUERIES[..] } else { &QUERIES[..2] };
            for (query, query_name) in queries.iter().enumerate() {
                let mut best = vec![[f64::MAX; 2]; POSES / BLOCK];
                for pass in 0..PASSES {
                    for (block, best) in best.iter_mut().enumerate() {
                        for turn in 0..2 {
                            let who = (block + pass + turn) % 2;
                            let time = match who {
                                0 => racers.0.time(query, block),
                                _ => racers.1.time(query, block),
                            };
                            best[who] = best[who].min(time);
                        }
                    }
                }
                let mean = |who: usize| best.iter().map(|b| b[who]).sum::<f64>() / best.len() as f64;
                let (other, this) = (mean(0), mean(1));
                println!("| {count} | {name} | {query_name} | {other:.0} | {this:.0} | {:.3} |", this / other);
            }
        }
    }
}
