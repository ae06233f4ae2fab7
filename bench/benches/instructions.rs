//! How many instructions the same calls take, which no other program on the machine can change.
//!
//! ```sh
//! cargo install gungraun-runner --version 0.20.0
//! cargo bench -p touchoff-bench --features instructions --bench instructions
//! ```
//!
//! Needs valgrind, whose processor has AVX2 and no AVX-512: its counts are those of a machine
//! without. A call is 4,096 points or 200 poses.

#![expect(missing_docs, reason = "gungraun's macros make undocumented items")]

use gungraun::{library_benchmark, library_benchmark_group, main};
use std::hint::black_box;
use tools_library::Fig73;
use touchoff::scenes::Path;
use touchoff::tool::{Ask, Felt, Points, Tool};
use touchoff::{Level, Part, Pose, Probe};
use touchoff_tests::fixtures::{near, part, poses, tool};

fn points(name: &str) -> (&'static dyn Tool, Points) {
    let tool = tool(name);
    (tool, near(tool, 4_096))
}

fn scene(path: Path) -> (Part, Vec<Pose>) {
    (part(20_000), poses(path, 200))
}

#[library_benchmark]
#[benches::of(args = ["D2Ball", "Fig73", "Fig73Exact", "BullNoseHsk63"], setup = points)]
fn lanes((tool, points): (&'static dyn Tool, Points)) -> Felt {
    evaluate(tool, &points, Level::new())
}

#[library_benchmark]
#[benches::of(args = ["D2Ball", "Fig73", "Fig73Exact", "BullNoseHsk63"], setup = points)]
fn scalar((tool, points): (&'static dyn Tool, Points)) -> Felt {
    evaluate(tool, &points, Level::baseline())
}

fn evaluate(tool: &dyn Tool, points: &Points, level: Level) -> Felt {
    let mut felt = Felt::default();
    tool.evaluate(level, Ask::DIRECTION, black_box(points), 1.0, &mut felt);
    felt
}

#[library_benchmark]
#[benches::along(args = [Path::Outside, Path::Inside], setup = scene)]
fn wrench((part, poses): (Part, Vec<Pose>)) -> f64 {
    let mut probe = Probe::new(&part, &Fig73);
    poses.iter().map(|pose| black_box(probe.wrench(black_box(pose))).depth()).sum()
}

library_benchmark_group!(name = kernels, benchmarks = [lanes, scalar, wrench]);
main!(library_benchmark_groups = kernels);
