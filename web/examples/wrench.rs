//! Times the wrench of tools against 100,000 points at poses that touch, with the instructions of AVX2 and with the best of
//! this machine, for tools as the page has them, interpreted, and compiled ones. `web/tests/wrench` runs it beside the page's engine.

use std::hint::black_box;
use std::time::Instant;
use touchoff::tool::{BatchEvaluator, Interpreted};
use touchoff::{Law, Level, Part, Pose, Probe, Sampling, scenes};
use touchoff_tools::{BallEr16, D2Ball};

const POSES: usize = 2000;

/// Returns poses in which the tool stands on the tube's outer wall, 0.02 to 0.3 mm deep.
fn poses() -> Vec<Pose> {
    let half = 0.5_f64.sqrt();
    let pose = |k: usize| {
        let angle = 2.4 * k as f64;
        let (sine, cosine) = angle.sin_cos();
        let radius = scenes::OUTER - 0.02 - 0.28 * ((0.618 * k as f64) % 1.0);
        let height = 2.0 + 9.0 * ((0.7549 * k as f64) % 1.0);
        let tip = nalgebra::Point3::new(radius * cosine, radius * sine, height);
        // From z to the outward normal.
        Pose::from_quaternion(tip, [-sine * half, cosine * half, 0.0, half]).expect("a pose")
    };
    (0..POSES).map(pose).collect()
}

/// Returns the median time of a wrench in nanoseconds.
fn median<T: BatchEvaluator>(part: &Part, tool: &T, level: Level, poses: &[Pose]) -> u128 {
    let mut probe = Probe::new(part, tool).with_law(Law::Gradient).with_level(level);
    assert!(poses.iter().all(|pose| probe.wrench(pose).colliding > 0), "poses touch");
    let mut times = Vec::with_capacity(poses.len());
    for pose in poses {
        let start = Instant::now();
        black_box(probe.wrench(pose));
        times.push(start.elapsed().as_nanos());
    }
    times.sort_unstable();
    times[times.len() / 2]
}

/// Prints the times of a tool, interpreted and compiled.
fn print<T: BatchEvaluator>(
    file: &str,
    compiled: &T,
    (part, poses): (&Part, &[Pose]),
) -> Result<(), Box<dyn std::error::Error>> {
    let path = format!("{}/../tools-library/tools/{file}.tool", env!("CARGO_MANIFEST_DIR"));
    let interpreted = Interpreted::load(&path)?;
    let best = Level::new();
    for (name, level) in [("AVX2", best.as_avx2().map(Level::Avx2)), ("best", Some(best))] {
        let Some(level) = level else { continue };
        let times =
            [median(part, &interpreted, level, poses), median(part, compiled, level, poses)];
        println!("{file} {name} {} {}", times[0], times[1]);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let part = Part::from_mesh(&scenes::tube(), Sampling::new(100_000))?;
    let poses = poses();
    print("d2_ball", &D2Ball, (&part, &poses))?;
    print("ball_er16", &BallEr16, (&part, &poses))
}
