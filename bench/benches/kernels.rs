//! What single calls take: an evaluator of tools by lanes and one by one, and the whole query.
//!
//! ```sh
//! cargo bench -p touchoff-bench --features kernels --bench kernels
//! ```
//!
//! Points are 65,536 and poses 10,000, in order, so that no branch is learnt.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use tools_library::Fig73;
use touchoff::scenes::{POSES, Path};
use touchoff::tool::{Ask, Felt};
use touchoff::{Level, Probe};
use touchoff_tests::fixtures::{TOOLS, near, part, poses, tool};

const POINTS: usize = 1 << 16;

fn evaluate(criterion: &mut Criterion) {
    for (ask, word) in [(Ask::INSIDE, "inside"), (Ask::DIRECTION, "direction")] {
        let mut group = criterion.benchmark_group(word);
        group.throughput(Throughput::Elements(POINTS as u64));
        for name in TOOLS {
            let (tool, mut felt) = (tool(name), Felt::default());
            let points = near(tool, POINTS);
            for (level, how) in [(Level::new(), "lanes"), (Level::baseline(), "scalar")] {
                group.bench_function(BenchmarkId::new(how, name), |bencher| {
                    bencher.iter(|| {
                        tool.evaluate(level, ask, black_box(&points), 1.0, &mut felt);
                        black_box(&felt);
                    });
                });
            }
        }
        group.finish();
    }
}

fn wrench(criterion: &mut Criterion) {
    let part = part(20_000);
    let mut group = criterion.benchmark_group("wrench");
    for path in [Path::Outside, Path::Inside] {
        let poses = poses(path, POSES);
        let mut probe = Probe::new(&part, &Fig73);
        let mut next = poses.iter().cycle();
        group.bench_function(path.name(), |bencher| {
            bencher.iter(|| next.next().map(|pose| black_box(probe.wrench(black_box(pose)))));
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate, wrench);
criterion_main!(benches);
