//! What it takes to make a part.

use crate::memory::kept;
use crate::row::Built;
use std::time::{Duration, Instant};
use touchoff::scenes::tube;
use touchoff::{Cloud, Part};

/// Seed of the clouds.
const SEED: u64 = 1;
/// How often a part is built, if there is time.
const BUILDS: usize = 5;
/// Points of a leaf, boxes of a node.
const WIDTH: usize = 16;
/// A point's offset, and a box's centre and half extent: three and six `f32`.
const POINT: usize = 12;
const BOX: usize = 24;

/// A part of so many points, made anew as long as there is time.
pub(crate) fn build(points: usize, seconds: f64) -> (Part, Built) {
    let mesh = tube();
    let random = || Cloud::random(&mesh, points, SEED).expect("the tube has a surface");
    let start = Instant::now();
    let (mut times, mut bytes, mut part) = ([Vec::new(), Vec::new()], [0; 2], None);
    while part.is_none() || times[0].len() < BUILDS && start.elapsed().as_secs_f64() < seconds {
        // Two parts at a time would be one more in memory than a program has.
        drop(part.take());
        let (cloud, took) = timed(|| kept(random));
        times[0].push(took);
        let (made, took) = timed(|| kept(|| Part::from_cloud(&cloud.0)));
        times[1].push(took);
        bytes = [cloud.1, made.1];
        part = Some(made.0);
    }
    let built = row(points, times, bytes);
    (part.expect("the loop builds one at least"), built)
}

fn timed<T>(make: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    (make(), start.elapsed())
}

fn row(points: usize, times: [Vec<Duration>; 2], bytes: [usize; 2]) -> Built {
    let builds = times[0].len();
    let [cloud, tree] = times.map(|mut times| {
        times.sort_unstable();
        [times[0], times[builds / 2]].map(|time| time.as_secs_f64() * 1e3)
    });
    let [cloud_bytes, part_bytes, geometry_bytes] =
        [bytes[0], bytes[1], geometry(points)].map(|bytes| bytes as f64 / points as f64);
    Built {
        points,
        builds,
        cloud_ms_best: cloud[0],
        cloud_ms_median: cloud[1],
        tree_ms_best: tree[0],
        tree_ms_median: tree[1],
        cloud_bytes,
        part_bytes,
        geometry_bytes,
    }
}

/// Bytes of what the descent reads, by the layout that `runtime/src/tree` writes down: leaves of
/// points, and levels of nodes of boxes above them.
fn geometry(points: usize) -> usize {
    let mut things = points.div_ceil(WIDTH);
    let mut bytes = things * WIDTH * POINT;
    loop {
        things = things.div_ceil(WIDTH);
        bytes += things * WIDTH * BOX;
        if things <= 1 {
            return bytes;
        }
    }
}
