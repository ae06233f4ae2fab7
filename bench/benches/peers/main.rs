//! The yardstick: this project beside other ways to answer the same question, in one process, on the
//! same poses.
//!
//! ```sh
//! cargo bench -p touchoff-bench --features peers --bench peers -- --json
//! ```
//!
//! `--scene`, `--points` and `--method` choose among rows, `--poses` how finely a path is cut,
//! `--seconds` how long a method may take for a row. Without `--json` it prints
//! `docs/measured/peers.md`. The tool is that of fig. 7.3, the law the thesis's with area weights,
//! torque about the tip.

mod exact;
mod table;
mod this;
mod triangles;

use crate::contender::{Contender, Workpiece};
use crate::exact::{Errors, Exact};
use crate::table::Row;
use clap::{Parser, ValueEnum};
use std::num::NonZeroUsize;
use touchoff::scenes::{POSES, Path, apart, tube};
use touchoff::{Cloud, Part, Pose};
use touchoff_bench::peers::{brute, fidget, parry_bvh, parry_contact, shell, thesis};
use touchoff_bench::race::{clock, contender};

/// Times this project and its peers on the scenes of the figures.
#[derive(Parser)]
struct Options {
    /// Only these scenes.
    #[arg(long, value_delimiter = ',')]
    scene: Vec<Scene>,
    /// Points of the cloud.
    #[arg(long, value_delimiter = ',', default_value = "1000,5000,20000,100000,1000000")]
    points: Vec<NonZeroUsize>,
    /// Triangles of the meshes; 0 for none.
    #[arg(long, value_delimiter = ',', default_value = "2000,20000,200000")]
    triangles: Vec<usize>,
    /// Only these methods.
    #[arg(long, value_delimiter = ',')]
    method: Vec<Method>,
    /// Poses that a path is cut into.
    #[arg(long, default_value_t = NonZeroUsize::new(POSES).expect("some poses"))]
    poses: NonZeroUsize,
    /// How long a method may take for a row; slower ones sit out poses.
    #[arg(long, default_value_t = 2.0)]
    seconds: f64,
    /// One object a row.
    #[arg(long)]
    json: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Where the tool goes.
#[derive(Clone, Copy, ValueEnum)]
enum Scene {
    Outside,
    Inside,
    Hold,
    Apart,
}

impl Scene {
    fn name(self) -> &'static str {
        match self {
            Scene::Outside => Path::Outside.name(),
            Scene::Inside => Path::Inside.name(),
            Scene::Hold => Path::Hold.name(),
            Scene::Apart => "apart",
        }
    }

    fn pose(self, k: usize, n: usize) -> Pose {
        match self {
            Scene::Outside => Path::Outside.pose(k, n),
            Scene::Inside => Path::Inside.pose(k, n),
            Scene::Hold => Path::Hold.pose(k, n),
            Scene::Apart => apart(GAP, k, n),
        }
    }
}

/// How far apart the ball is from the wall in the scene of that name, mm.
const GAP: f64 = 0.5;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    Touchoff,
    BruteF64,
    BruteF32,
    Thesis,
    ParryBvh,
    ParryContact,
    Fidget,
    Grid,
    GridDz,
}

impl Method {
    fn build<'a>(self, piece: &'a Workpiece) -> Box<dyn Contender + 'a> {
        match self {
            Method::Touchoff => Box::new(this::This::new(piece)),
            Method::BruteF64 => Box::new(brute::Scalar::new(piece)),
            Method::BruteF32 => Box::new(brute::Lanes::new(piece)),
            Method::Thesis => Box::new(thesis::Thesis::new(piece)),
            Method::ParryBvh => Box::new(parry_bvh::ParryBvh::new(piece)),
            Method::ParryContact => Box::new(parry_contact::ParryContact::new(piece)),
            Method::Fidget => Box::new(fidget::Fidget::new(piece)),
            Method::Grid => Box::new(shell::Shell::in_space(piece)),
            Method::GridDz => Box::new(shell::Shell::in_the_half_plane(piece)),
        }
    }
}

/// Seed of the clouds.
const SEED: u64 = 1;

fn main() {
    let options = Options::parse();
    let chosen = |given: &[Method]| {
        let all = Method::value_variants().iter().copied();
        all.filter(|method| given.is_empty() || given.contains(method)).collect::<Vec<_>>()
    };
    let methods = chosen(&options.method);
    let scenes = if options.scene.is_empty() { Scene::value_variants() } else { &options.scene };
    let pinned = clock::pin();
    if !options.json {
        table::head(pinned);
    }
    let mut rows = Vec::new();
    for &points in &options.points {
        let mesh = tube();
        let cloud = Cloud::random(&mesh, points.get(), SEED).expect("the tube has a surface");
        let piece = Workpiece { part: Part::from_cloud(&cloud), mesh, cloud };
        let mut methods: Vec<_> = methods.iter().map(|method| method.build(&piece)).collect();
        let exact = Exact::new(&piece);
        for &scene in scenes {
            let found = measure(scene, &options, &piece, &exact, &mut methods);
            if options.json {
                found.iter().for_each(table::json);
            }
            rows.extend(found);
        }
    }
    if !options.json {
        table::markdown(&rows);
    }
    let meshes: Vec<usize> = options.triangles.iter().copied().filter(|size| *size > 0).collect();
    triangles::measure(&meshes, options.seconds, options.json);
}

/// A scene, a cloud, all methods.
fn measure(
    scene: Scene,
    options: &Options,
    piece: &Workpiece,
    exact: &Exact,
    methods: &mut [Box<dyn Contender + '_>],
) -> Vec<Row> {
    let count = options.poses.get();
    let poses: Vec<Pose> = (0..count).map(|k| scene.pose(k, count)).collect();
    let times = clock::race(methods, &poses, options.seconds);
    let mut errors: Vec<Errors> = methods.iter().map(|_| Errors::default()).collect();
    for pose in poses.iter().step_by((poses.len() / checks(piece.cloud.len())).max(1)) {
        let truth = exact.at(pose, piece);
        for (method, errors) in methods.iter_mut().zip(&mut errors) {
            errors.add(&method.query(pose), &truth, method.feels_triangles());
        }
    }
    let names = methods.iter().map(|method| method.name());
    names
        .zip(times.iter().zip(&errors))
        .map(|(name, (times, errors))| {
            Row::new(scene.name(), piece.cloud.len(), name, times, errors)
        })
        .collect()
}

/// At how many poses the truth is worked out, which takes long of many points.
fn checks(points: usize) -> usize {
    (20_000_000 / points.max(1)).clamp(40, 200)
}
