//! The same bits at every SIMD level, from a fresh probe and a used one.

use super::compare::{LAWS_AND_WEIGHTS, tools};
use super::parts;
use crate::prelude::*;
use touchoff_tests::evaluations::levels;

/// Formats all results of a probe at a pose. No two different numbers have the same text, the sign of zeros
/// included.
fn formatted_results(probe: &mut Probe<'_>, pose: &Pose) -> String {
    let wrench = format!("{:?}", probe.wrench(pose));
    let detected = probe.detect(pose);
    // Detecting stops early, and the next query must not find anything of that.
    assert_eq!(wrench, format!("{:?}", probe.wrench(pose)), "{pose:?}");
    format!("{wrench} {detected} {:?}", probe.contacts(pose))
}

/// Returns parts small and large, with full leaves and others.
fn parts() -> Vec<Part> {
    vec![parts::soup(6.0, 37, 1), parts::tube(3_000), parts::cuboid(9.0, 4_097)]
}

fn random_poses(part: &Part, oracle: &dyn Oracle, count: usize, seed: u64) -> Vec<Pose> {
    let mut rng = Rng::new(seed);
    (0..count).map(|k| parts::about(part, oracle, k, &mut rng)).collect()
}

#[test]
fn every_simd_level_gives_the_same_bits() {
    let levels = levels();
    println!("{levels:?}");
    for part in parts() {
        for (tool, oracle) in tools() {
            for (k, pose) in random_poses(&part, &*oracle, 60, 2).iter().enumerate() {
                let (law, weights) = LAWS_AND_WEIGHTS[k % 6];
                let at = |level: Level| {
                    let probe = Probe::new(&part, tool).with_law(law).with_weights(weights);
                    formatted_results(&mut probe.with_level(level), pose)
                };
                let best = at(Level::new());
                for (name, level) in &levels {
                    assert_eq!(best, at(*level), "{} {name}", oracle.name());
                }
            }
        }
    }
}

#[test]
fn fresh_and_reused_probes_give_the_same_bits() {
    for part in parts() {
        for (tool, oracle) in tools() {
            let mut used = Probe::new(&part, tool);
            for (k, pose) in random_poses(&part, &*oracle, 1_000, 3).iter().enumerate() {
                match k % 3 {
                    0 => drop(used.wrench(pose)),
                    1 => drop(used.contacts(pose).len()),
                    _ => drop(used.detect(pose)),
                }
            }
            for pose in &random_poses(&part, &*oracle, 40, 4) {
                let fresh = formatted_results(&mut Probe::new(&part, tool), pose);
                assert_eq!(fresh, formatted_results(&mut used, pose), "{}", oracle.name());
            }
        }
    }
}
