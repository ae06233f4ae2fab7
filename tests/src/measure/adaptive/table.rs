//! The integrator beside clouds, at equal error.

use super::cell::{Face, faces, split, touched};
use super::integrate::{Adaptive, Answer, Settings};
use super::scenes::{Scene, Stage};
use nalgebra::Vector3;
use std::hint::black_box;
use std::time::Instant;
use touchoff::{Cloud, CloudError, Part, Pose, Probe};

/// The errors that are wished.
const WISHED: [f64; 3] = [1.0, 1e-2, 1e-4];
/// How many clouds there are of each size.
const SEEDS: u64 = 2;
/// No triangle is longer when the reference begins, mm.
const FINEST: f64 = 0.1;

/// Blue-noise clouds of so many points. The error is the root mean square over poses and seeds, all else means.
#[derive(Clone, Copy)]
pub(super) struct Blue {
    pub(super) points: f64,
    pub(super) contact: f64,
    /// µs a pose.
    pub(super) time: f64,
    pub(super) error: f64,
}

/// One wish in one scene. The error is the root mean square over poses, all else means of them.
pub(super) struct Row {
    pub(super) name: &'static str,
    pub(super) wished: f64,
    pub(super) evaluations: f64,
    pub(super) rounds: f64,
    /// µs a pose.
    pub(super) time: f64,
    /// No less than the reference may be wrong.
    pub(super) error: f64,
    /// The cloud as wrong, and whether it is between clouds that were measured.
    pub(super) blue: Blue,
    pub(super) between: bool,
}

impl Row {
    /// How many times as long as the cloud the integrator takes.
    pub(super) fn times(&self) -> f64 {
        self.time / self.blue.time
    }
}

/// What came of a scene.
pub(super) struct Outcome {
    pub(super) name: &'static str,
    /// How wrong the reference is by its own estimate.
    pub(super) estimate: f64,
    pub(super) blues: Vec<Blue>,
    /// By which power of their points their error falls.
    pub(super) order: f64,
    /// A row a wish, but for those of which nothing came.
    pub(super) rows: Vec<Row>,
}

/// Root mean square.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|value| value * value)).sqrt()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    sum / f64::from(count)
}

/// µs a pose, each so many together as fast as they were in the best of many passes.
fn fastest(poses: usize, together: usize, mut ask: impl FnMut(usize)) -> f64 {
    let mut best = vec![f64::INFINITY; poses.div_ceil(together)];
    let (start, mut passes) = (Instant::now(), 0);
    while passes < 5 || start.elapsed().as_secs_f64() < 0.1 {
        for (group, best) in best.iter_mut().enumerate() {
            let one = Instant::now();
            (group * together..poses.min((group + 1) * together)).for_each(&mut ask);
            *best = best.min(one.elapsed().as_secs_f64() * 1e6);
        }
        passes += 1;
    }
    best.iter().sum::<f64>() / poses as f64
}

/// How wrong forces are.
fn error(found: impl Iterator<Item = Vector3<f64>>, right: &[Answer]) -> f64 {
    rms(found.zip(right).map(|(found, right)| (found - right.force).norm() / right.force.norm()))
}

/// Measures all that happens beside a part.
pub(super) fn measure(stage: &Stage) -> Result<Vec<Outcome>, CloudError> {
    let parts = |count| {
        let part = |seed| Ok(Part::from_cloud(&Cloud::blue(&stage.mesh, count, seed)?));
        (1..=SEEDS).map(part).collect()
    };
    let parts: Result<Vec<Vec<Part>>, _> = stage.clouds.into_iter().map(parts).collect();
    let (parts, faces) = (parts?, split(&faces(&stage.mesh), stage.longest));
    Ok(stage.scenes.iter().map(|scene| outcome(scene, &faces, &parts)).collect())
}

fn outcome(scene: &Scene, faces: &[Face], parts: &[Vec<Part>]) -> Outcome {
    // Poses that are barely in contact would say nothing of either.
    const LEAST: usize = 3;
    let mut finest = Probe::new(&parts[parts.len() - 1][0], scene.tool);
    let mut poses = scene.poses.clone();
    poses.retain(|pose| finest.wrench(pose).colliding >= LEAST);
    let lists: Vec<Vec<Face>> = poses.iter().map(|pose| touched(faces, scene.near, pose)).collect();
    let mut adaptive = Adaptive::new(scene.tool, scene.near);
    let settings = Settings::reference();
    let right: Vec<Answer> = poses
        .iter()
        .zip(&lists)
        .map(|(pose, list)| adaptive.integrate(&split(list, FINEST), pose, &settings))
        .collect();
    let estimate = rms(right.iter().map(|right| right.estimate / right.force.norm()));
    let blues: Vec<Blue> = parts.iter().map(|parts| blue(scene, &poses, parts, &right)).collect();
    let order = order(&blues);

    let mut rows: Vec<Row> = Vec::new();
    for wished in WISHED {
        let settings = Settings::new(wished);
        let mut ask = |k: usize| adaptive.integrate(&lists[k], &poses[k], &settings);
        let found: Vec<Answer> = (0..poses.len()).map(&mut ask).collect();
        let error = error(found.iter().map(|found| found.force), &right).max(estimate);
        if rows.last().is_some_and(|row| error > 0.9 * row.error) {
            continue;
        }
        let (blue, between) = equal(&blues, order, error);
        rows.push(Row {
            name: scene.name,
            wished,
            evaluations: mean(found.iter().map(|found| found.evaluations as f64)),
            rounds: mean(found.iter().map(|found| found.rounds as f64)),
            time: fastest(poses.len(), 1, |k| _ = black_box(ask(k))),
            error,
            blue,
            between,
        });
    }
    Outcome { name: scene.name, estimate, blues, order, rows }
}

/// Clouds of one size at poses.
fn blue(scene: &Scene, poses: &[Pose], parts: &[Part], right: &[Answer]) -> Blue {
    let each = parts.iter().map(|part| {
        let mut probe = Probe::new(part, scene.tool);
        let felt: Vec<_> = poses.iter().map(|pose| probe.wrench(pose)).collect();
        let time = fastest(poses.len(), 10, |k| _ = black_box(probe.wrench(&poses[k])));
        let contact = mean(felt.iter().map(|felt| felt.colliding as f64));
        [contact, time, error(felt.iter().map(|felt| felt.force), right)]
    });
    let each: Vec<[f64; 3]> = each.collect();
    let all = |k: usize| each.iter().map(move |each| each[k]);
    let points = parts[0].tree().len() as f64;
    Blue { points, contact: mean(all(0)), time: mean(all(1)), error: rms(all(2)) }
}

/// By which power of their points the clouds' error falls, by least squares of the logarithms. The smallest hardly touch.
fn order(blues: &[Blue]) -> f64 {
    let blues = &blues[1..];
    let [x, y] = [|blue: &Blue| blue.points.ln(), |blue: &Blue| blue.error.ln()];
    let [a, b] = [mean(blues.iter().map(x)), mean(blues.iter().map(y))];
    let slope = mean(blues.iter().map(|blue| (x(blue) - a) * (y(blue) - b)));
    -slope / mean(blues.iter().map(|blue| (x(blue) - a).powi(2)))
}

/// The cloud with that error: between two that were measured, by the line through their logarithms; else from the nearest by the order.
/// Time is taken to be linear in points, and no less than that of the least cloud.
fn equal(blues: &[Blue], order: f64, error: f64) -> (Blue, bool) {
    let (first, last) = (&blues[0], &blues[blues.len() - 1]);
    let mut pairs = blues.windows(2);
    let pair = pairs.find(|pair| pair[0].error >= error && error >= pair[1].error);
    let points = if let Some([from, to]) = pair {
        let share = (from.error / error).ln() / (from.error / to.error).ln();
        from.points * (to.points / from.points).powf(share)
    } else {
        let near = if error > first.error { first } else { last };
        near.points * (near.error / error).powf(1.0 / order)
    };
    let at = (1..blues.len() - 1).find(|at| blues[*at].points >= points).unwrap_or(blues.len() - 1);
    let (from, to) = (&blues[at - 1], &blues[at]);
    let slope = (to.time - from.time) / (to.points - from.points);
    let contact = points * last.contact / last.points;
    let time = (from.time + slope * (points - from.points)).max(first.time);
    (Blue { points, contact, time, error }, pair.is_some())
}
