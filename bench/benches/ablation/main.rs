//! What the runtime skips, and what a query would cost if it did not.
//!
//! ```sh
//! cargo bench -p touchoff-bench --features peers --bench ablation > docs/measured/ablation.md
//! ```
//!
//! A line compares a question with one in which a single thing is not skipped, made by public API
//! alone: another question, a tool with one thing changed, other poses. Both must give the same
//! answers. `--json` prints one object a row.

mod asked;
mod chapter;
mod cores;
mod line;
mod outputs;
mod reach;
mod regions;
mod table;
mod turns;
mod without;
mod world;

#[path = "../scaling/passes.rs"]
#[expect(dead_code, reason = "passes of one method; here several take turns")]
mod passes;
#[path = "../scaling/row.rs"]
#[expect(dead_code, reason = "what passes make")]
mod row;

use crate::chapter::CHAPTERS;
use crate::line::{Row, Setting};
use clap::Parser;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;
use touchoff::scenes::{POSES, Path, tube};
use touchoff::{Cloud, Part, Pose};
use touchoff_bench::race::{clock, contender};

/// Seed of the clouds.
const SEED: u64 = 1;

/// Times the runtime with each of its skips and without it.
#[derive(Parser)]
struct Options {
    /// Points of the cloud.
    #[arg(long, value_delimiter = ',', default_value = "20000,1000000")]
    points: Vec<NonZeroUsize>,
    /// Poses that a path is cut into.
    #[arg(long, default_value_t = NonZeroUsize::new(POSES).expect("some poses"))]
    poses: NonZeroUsize,
    /// How long a line may take; poses sit out if need be.
    #[arg(long, default_value_t = 0.6)]
    seconds: f64,
    /// One object a row.
    #[arg(long)]
    json: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() {
    let options = Options::parse();
    let parts: Vec<Part> = options.points.iter().map(|points| part(points.get())).collect();
    if let Some(first) = parts.first() {
        cores::start(first, &poses(Path::Outside, options.poses.get()));
    }
    // Asked before the thread is pinned, since it is told of how many cores it may use.
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let pinned = clock::pin();
    let mut rows: Vec<Vec<Row>> = CHAPTERS.iter().map(|_| Vec::new()).collect();
    for part in &parts {
        for path in Path::ALL {
            let poses = poses(path, options.poses.get());
            let setting = Setting { part, path, poses, seconds: options.seconds, cores };
            for (chapter, rows) in CHAPTERS.iter().zip(&mut rows) {
                rows.extend((chapter.measure)(&setting));
            }
        }
    }
    rows.iter_mut().for_each(|rows| table::in_order(rows));
    if options.json {
        table::json(&rows);
    } else {
        table::markdown(&rows, cores, pinned);
    }
}

fn part(points: usize) -> Part {
    Part::from_cloud(&Cloud::random(&tube(), points, SEED).expect("the tube has a surface"))
}

fn poses(path: Path, count: usize) -> Vec<Pose> {
    (0..count).map(|k| path.pose(k, count)).collect()
}
