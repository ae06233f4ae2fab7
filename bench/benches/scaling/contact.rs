//! What a wrench costs by how many points collide.

use crate::Options;
use crate::passes::{Block, passes, thinned};
use crate::query::Wrench;
use crate::row::{Contact, Line, Passed, Row};
use std::collections::BTreeMap;
use std::time::Instant;
use touchoff::scenes::{Path, apart};
use touchoff::{Part, Pose};
use touchoff_bench::plot::fit;

/// How deep the ball is pushed into the wall, mm: as deep as its radius, which is half the wall.
const DEPTHS: [f64; 10] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
/// In so many parts a decade of colliding points is cut.
const PARTS: f64 = 3.0;

/// The ball pushed into the wall, then the paths, and a line through each of them.
pub(crate) fn contact(part: &Part, options: &Options, rows: &mut Vec<Row>) {
    let scenes = std::iter::once(wall(part, options));
    for found in scenes.chain(Path::ALL.map(|path| along(part, path, options))) {
        let line = line(&found);
        rows.extend(found.into_iter().map(Row::Contact));
        rows.extend(line.map(Row::Fit));
    }
}

fn wall(part: &Part, options: &Options) -> Vec<Contact> {
    let count = options.poses.get();
    DEPTHS
        .into_iter()
        .map(|depth| {
            let poses: Vec<Pose> = (0..count).map(|k| apart(-depth, k, count)).collect();
            let blocks = timed(part, &poses, options.seconds);
            contact_of(part, "wall", Some(depth), &blocks)
        })
        .collect()
}

/// Blocks of a path, those together at which about as many points collide.
fn along(part: &Part, path: Path, options: &Options) -> Vec<Contact> {
    let count = options.poses.get();
    let poses: Vec<Pose> = (0..count).map(|k| path.pose(k, count)).collect();
    let mut alike: BTreeMap<i32, Vec<Block>> = BTreeMap::new();
    for block in timed(part, &poses, options.seconds) {
        // What finds nothing is the table of what is apart.
        if block.colliding() >= 1.0 {
            let bin = (PARTS * block.colliding().log10()).floor() as i32;
            alike.entry(bin).or_default().push(block);
        }
    }
    alike.values().map(|blocks| contact_of(part, path.name(), None, blocks)).collect()
}

/// Passes over as many of the poses as there is time for.
fn timed(part: &Part, poses: &[Pose], seconds: f64) -> Vec<Block> {
    let mut wrench = Wrench::new(part);
    let trial: Vec<Pose> = poses.iter().step_by((poses.len() / 20).max(1)).copied().collect();
    let start = Instant::now();
    passes(&mut wrench, &trial);
    let ns = start.elapsed().as_secs_f64() * 1e9 / (trial.len() * crate::passes::PASSES) as f64;
    passes(&mut wrench, &thinned(poses, ns, seconds))
}

fn contact_of(part: &Part, scene: &'static str, depth: Option<f64>, blocks: &[Block]) -> Contact {
    Contact { points: part.tree().len(), scene, depth, passed: Passed::of(blocks) }
}

fn line(found: &[Contact]) -> Option<Line> {
    let places: Vec<[f64; 2]> =
        found.iter().map(|row| [row.passed.colliding_avg, row.passed.ns_best]).collect();
    let first = found.first()?;
    let line = fit(&places)?;
    let (ns_at_zero, ns_a_point) = (line.at_zero, line.slope);
    Some(Line { points: first.points, scene: first.scene, ns_at_zero, ns_a_point })
}
