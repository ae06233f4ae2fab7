//! The integrator beside clouds, at equal error.

use super::{Adaptive, Answer, Face, Scene, Settings, faces, split, touched};
use std::hint::black_box;
use std::time::Instant;
use touchoff::mesh::shapes;
use touchoff::{Cloud, CloudError, MeshError, Part, Pose, Probe, Tool, Unit};

/// What a blue-noise cloud with the areas of Voronoi cells for weights was published to miss of the force of a ball in a plane: so much
/// with so many points in contact, and by which power it falls.
const BLUE: (f64, f64, f64) = (1.2e-3, 152.0, 1.26);
/// What a random cloud misses there with one: the square root of 4/3, for a small depth.
const RANDOM: f64 = 1.155;

/// The errors that are wished.
const WISHED: [f64; 5] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4];

/// One wish in one scene. Errors are root mean squares over poses, all else means of them.
#[derive(Clone, Debug)]
pub struct Row {
    /// The error that was wished, relative to the force.
    pub wished: f64,
    /// At how many points the tool was evaluated.
    pub evaluations: f64,
    /// How often the distance to it was asked for.
    pub distances: f64,
    /// How often those with too much error were halved, and once more.
    pub rounds: f64,
    /// µs a pose.
    pub time: f64,
    /// How wrong force and torque are.
    pub errors: [f64; 2],
    /// Of a random cloud, then of a blue one, as wrong: points in contact, and µs.
    pub clouds: [[f64; 2]; 2],
}

/// What came of a scene.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its name.
    pub name: &'static str,
    /// How many of its poses are in contact.
    pub poses: usize,
    /// How many faces are touched, on average.
    pub touched: f64,
    /// Of the reference: evaluations, and the estimated error.
    pub reference: [f64; 2],
    /// How far it is from a closed form.
    pub closed: Option<f64>,
    /// How far from a large cloud, and how far such a cloud is expected to be.
    pub cloud: [f64; 2],
    /// Of three random clouds: points in contact, µs a pose, error.
    pub random: [[f64; 3]; 3],
    /// A row a wish.
    pub rows: Vec<Row>,
}

/// Root mean square.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|value| value * value)).sqrt()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    sum / f64::from(count)
}

/// µs of the fastest of many passes.
fn fastest(mut pass: impl FnMut()) -> f64 {
    let (start, mut best) = (Instant::now(), f64::INFINITY);
    let mut passes = 0;
    while passes < 5 || start.elapsed().as_secs_f64() < 0.3 {
        let one = Instant::now();
        pass();
        best = best.min(one.elapsed().as_secs_f64() * 1e6);
        passes += 1;
    }
    best
}

/// How wrong forces and torques are.
fn errors(found: &[Answer], right: &[Answer]) -> [f64; 2] {
    let pairs = || found.iter().zip(right);
    [
        rms(pairs().map(|(a, b)| (a.force - b.force).norm() / b.force.norm())),
        rms(pairs()
            .map(|(a, b)| (a.torque - b.torque).norm() / b.torque.norm().max(b.force.norm()))),
    ]
}

/// A random cloud at poses: the points in contact at each, µs a pose, and its answers.
fn cloud(
    scene: &Scene,
    poses: &[Pose],
    points: usize,
) -> Result<(Vec<f64>, f64, Vec<Answer>), CloudError> {
    let part = Part::from_cloud(&Cloud::random(&scene.mesh, points, 1)?);
    let mut probe = Probe::new(&part, scene.tool);
    let felt: Vec<_> = poses.iter().map(|pose| probe.wrench(pose)).collect();
    let time = fastest(|| {
        poses.iter().for_each(|pose| {
            black_box(probe.wrench(pose));
        });
    });
    let answer = |force, torque| Answer { force, torque, ..Answer::default() };
    Ok((
        felt.iter().map(|felt| felt.colliding as f64).collect(),
        time / poses.len() as f64,
        felt.iter().map(|felt| answer(felt.force, felt.torque)).collect(),
    ))
}

/// Measures a scene.
///
/// # Errors
/// None: clouds of a sound mesh.
pub fn measure(scene: &Scene) -> Result<Outcome, CloudError> {
    // Poses that are barely in contact would say nothing of either.
    const LEAST: f64 = 20.0;
    let (counts, ..) = cloud(scene, &scene.poses, scene.clouds[2])?;
    let kept = scene.poses.iter().zip(counts).filter(|(_, count)| *count >= LEAST);
    let poses: Vec<Pose> = kept.map(|(pose, _)| *pose).collect();
    let all = split(&faces(&scene.mesh), scene.longest);
    let lists: Vec<Vec<Face>> = poses.iter().map(|pose| touched(&all, scene.near, pose)).collect();
    let mut adaptive = Adaptive::new(scene.tool, scene.near);
    let right: Vec<Answer> = poses
        .iter()
        .zip(&lists)
        .map(|(pose, list)| {
            adaptive.integrate(&split(list, scene.finest), pose, &Settings::reference())
        })
        .collect();
    let mut ask = |settings: &Settings| -> Vec<Answer> {
        let each = poses.iter().zip(&lists);
        each.map(|(pose, list)| adaptive.integrate(list, pose, settings)).collect()
    };
    let size = |answer: &Answer| answer.force.norm();

    let (checked, _, answers) = cloud(scene, &poses, scene.check)?;
    let far = errors(&answers, &right)[0];
    let (mut random, mut shares, mut scatter) = ([[0.0; 3]; 3], Vec::new(), Vec::new());
    for (row, points) in random.iter_mut().zip(scene.clouds) {
        let (counts, time, answers) = cloud(scene, &poses, points)?;
        *row = [mean(counts.iter().copied()), time, errors(&answers, &right)[0]];
        scatter.push(row[2] * row[0].sqrt());
        shares = counts;
    }
    let scatter = rms(scatter.into_iter());
    let clouds = Clouds { random, scatter, shares };

    let mut rows = Vec::new();
    for wished in WISHED {
        let settings = Settings::new(wished);
        let found = ask(&settings);
        let time = fastest(|| drop(black_box(ask(&settings)))) / poses.len() as f64;
        let of = |part: fn(&Answer) -> usize| mean(found.iter().map(|answer| part(answer) as f64));
        let errors = errors(&found, &right);
        rows.push(Row {
            wished,
            evaluations: of(|answer| answer.evaluations),
            distances: of(|answer| answer.distances),
            rounds: of(|answer| answer.rounds),
            time,
            errors,
            clouds: [clouds.random(errors[0]), clouds.blue(errors[0])],
        });
    }
    let reference = [
        mean(right.iter().map(|answer| answer.evaluations as f64)),
        rms(right.iter().map(|answer| answer.estimate[0] / size(answer))),
    ];
    Ok(Outcome {
        name: scene.name,
        poses: poses.len(),
        touched: mean(lists.iter().map(|list| list.len() as f64)),
        reference,
        closed: scene.force.map(|force| rms(right.iter().map(|answer| size(answer) / force - 1.0))),
        cloud: [far, scatter / mean(checked.into_iter()).sqrt()],
        random,
        rows,
    })
}

/// What clouds cost and miss in a scene.
struct Clouds {
    /// Points in contact, µs, error.
    random: [[f64; 3]; 3],
    /// A random cloud's error with one point in contact.
    scatter: f64,
    /// Points in contact, pose by pose, of one of them.
    shares: Vec<f64>,
}

impl Clouds {
    /// µs with so many points in contact: between those that were measured, and on.
    fn time(&self, count: f64) -> f64 {
        let at = usize::from(count > self.random[1][0]);
        let ([from, low, _], [to, high, _]) = (self.random[at], self.random[at + 1]);
        (low + (high - low) * (count - from) / (to - from)).max(self.random[0][1])
    }

    fn random(&self, error: f64) -> [f64; 2] {
        let count = (self.scatter / error).powi(2);
        [count, self.time(count)]
    }

    /// The published error times by how much more a random cloud misses here than there; as many points to the area everywhere, so many
    /// that the root mean square over poses is the error.
    fn blue(&self, error: f64) -> [f64; 2] {
        let (missed, points, power) = BLUE;
        let mean = mean(self.shares.iter().copied());
        // Of one pose with so many points a random cloud misses `harder` times what it misses of the ball.
        let once = rms(self.shares.iter().map(|share| RANDOM / share.sqrt()));
        let harder = self.scatter / mean.sqrt() / once;
        let all = rms(self.shares.iter().map(|share| missed * (points / share).powf(power)));
        let count = mean * (harder * all / error).powf(1.0 / power);
        [count, self.time(count)]
    }
}

/// The ball in a plane divided evenly, nothing halved: sides of the squares in mm, evaluations, µs and the error of the force; and the
/// points of a blue cloud as wrong.
///
/// # Errors
/// None: the shapes are sound.
pub fn unrefined(scene: &Scene, right: f64) -> Result<Vec<[f64; 5]>, MeshError> {
    let mut rows = Vec::new();
    for divisions in [6, 12, 24, 48] {
        let all = faces(&shapes::plane(1.5, divisions, Unit::Millimetre)?);
        let near: &dyn Tool = scene.near;
        let lists: Vec<Vec<Face>> =
            scene.poses.iter().map(|pose| touched(&all, near, pose)).collect();
        let mut adaptive = Adaptive::new(scene.tool, near);
        let settings = Settings::new(f64::INFINITY);
        let mut ask = || -> Vec<Answer> {
            let each = scene.poses.iter().zip(&lists);
            each.map(|(pose, list)| adaptive.integrate(list, pose, &settings)).collect()
        };
        let found = ask();
        let time = fastest(|| drop(black_box(ask()))) / scene.poses.len() as f64;
        let error = rms(found.iter().map(|answer| answer.force.norm() / right - 1.0));
        let count = mean(found.iter().map(|answer| answer.evaluations as f64));
        let (missed, points, power) = BLUE;
        let blue = points * (missed / error).powf(1.0 / power);
        rows.push([3.0 / f64::from(divisions), count, time, error, blue]);
    }
    Ok(rows)
}
