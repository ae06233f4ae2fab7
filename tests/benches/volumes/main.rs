//! Which bounding volume, leaf, branching and split make a tree over the points fast: the questions
//! that Ho (1999) leaves open in section 7.5.1, answered by experiment.
//!
//! ```sh
//! cargo bench -p touchoff-tests --features peers --bench volumes -- --json
//! ```
//!
//! `--points` chooses clouds, `--study` among tables, `--poses` how finely a path is cut. Without
//! `--json` it prints `docs/measured/volumes.md`. Timing, scenes and the tool's formula are those of
//! the bench `peers`.

#[path = "../peers/this.rs"]
mod this;

mod aabb;
mod config;
mod dop;
mod leaves;
mod measure;
mod obb;
mod sphere;
mod split;
mod study;
mod table;
mod tree;
mod volume;
mod wide;

use crate::config::{BASE, Config};
use crate::contender::{Contender, Workpiece};
use crate::measure::{Measured, Scene};
use crate::study::Cross;
use clap::Parser;
use fearless_simd::Level;
use std::num::NonZeroUsize;
use touchoff::scenes::{POSES, Path, tube};
use touchoff::{Cloud, Part};
use touchoff_tests::peers::{brute, formula, points, thesis};
use touchoff_tests::race::{clock, contender};

/// Times trees that differ in one thing, or in two.
#[derive(Parser)]
struct Options {
    /// Points of the clouds.
    #[arg(long, value_delimiter = ',', default_value = "20000,1000000")]
    points: Vec<NonZeroUsize>,
    /// Only these tables: beside, volume, leaf, branching, axis, point, volume-branching,
    /// leaf-branching, volume-leaf, axis-leaf, point-leaf.
    #[arg(long, value_delimiter = ',')]
    study: Vec<String>,
    /// Poses that a path is cut into, fewer of a large cloud.
    #[arg(long, default_value_t = NonZeroUsize::new(POSES).expect("some poses"))]
    poses: NonZeroUsize,
    /// One object a row.
    #[arg(long)]
    json: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    fn wants(&self, name: &str) -> bool {
        self.study.is_empty() || self.study.iter().any(|wanted| wanted == name)
    }
}

/// Seed of the clouds.
const SEED: u64 = 1;
/// Of larger clouds only one thing is varied at a time, on a tenth of the poses.
const LARGE: usize = 100_000;

fn main() {
    let options = Options::parse();
    let pinned = clock::pin();
    if !options.json {
        // Its name without what it holds.
        let level = format!("{:?}", Level::new());
        table::head(pinned, level.split('(').next().unwrap_or(&level));
    }
    for &points in &options.points {
        let mesh = tube();
        let cloud = Cloud::random(&mesh, points.get(), SEED).expect("the tube has a surface");
        let piece = Workpiece { part: Part::from_cloud(&cloud), mesh, cloud };
        let large = points.get() > LARGE;
        let poses = if large { options.poses.get().div_ceil(10) } else { options.poses.get() };
        let scenes = Path::ALL.map(|path| Scene::new(path, poses, &piece));
        let bench = Bench { options: &options, piece, scenes };
        bench.beside();
        bench.studies();
        if !large {
            bench.crosses();
        }
    }
}

/// A cloud, and the scenes about it.
struct Bench<'a> {
    options: &'a Options,
    piece: Workpiece,
    scenes: [Scene; 3],
}

impl Bench<'_> {
    fn heading(&self, title: &str) {
        if !self.options.json {
            println!("## {title}, {} points\n", self.piece.cloud.len());
        }
    }

    /// The base in a race with other methods, to see what trees are about here.
    fn beside(&self) {
        if self.options.json || !self.options.wants("beside") {
            return;
        }
        self.heading("The base beside other methods");
        println!("As in [peers](peers.md), which has more of them.\n");
        let mut rows = [("base", vec![]), ("`touchoff`", vec![]), ("`thesis`", vec![])];
        let mut base = BASE.build(&self.piece);
        let mut racing: Vec<Box<dyn Contender + '_>> = vec![
            Box::new(measure::Lent { tree: &mut *base, searching: false }),
            Box::new(this::This::new(&self.piece)),
            Box::new(thesis::Thesis::new(&self.piece)),
        ];
        for scene in &self.scenes {
            for (row, time) in rows.iter_mut().zip(measure::times(&mut racing, scene)) {
                row.1.push(time);
            }
        }
        table::beside(&self.scenes, &rows);
    }

    fn studies(&self) {
        for study in study::studies().iter().filter(|study| self.options.wants(study.name)) {
            self.heading(study.title);
            let configs: Vec<Config> = study.rows.iter().map(|(_, config)| *config).collect();
            let all = self.race(study.name, &configs, true);
            if !self.options.json {
                table::study(study, &self.scenes, &all);
            }
        }
    }

    fn crosses(&self) {
        for cross in study::crosses().iter().filter(|cross| self.options.wants(cross.name)) {
            self.heading(cross.title);
            let ratios = self.ratios(cross);
            if !self.options.json {
                println!(
                    "Time of the search by that of the base in the same race (a row is one), the geometric mean over scenes.\n"
                );
                table::cross(cross, &ratios);
            }
        }
    }

    /// Every row a race with the base, so that few trees share the caches.
    fn ratios(&self, cross: &Cross) -> Vec<Vec<f64>> {
        let row = |configs: &Vec<Config>| {
            let mut racing = configs.clone();
            racing.extend((!racing.contains(&BASE)).then_some(BASE));
            let all = self.race(cross.name, &racing, false);
            let base = all.iter().find(|one| one.config == BASE).expect("the base is raced");
            all.iter().take(configs.len()).map(|one| ratio(one, base)).collect()
        };
        cross.rows.iter().map(|(_, configs)| row(configs)).collect()
    }

    fn race(&self, name: &str, configs: &[Config], whole: bool) -> Vec<Measured> {
        let all = measure::trees(configs, &self.piece, &self.scenes, whole);
        if self.options.json {
            table::json(name, self.piece.cloud.len(), &self.scenes, &all);
        }
        all
    }
}

/// How many times as long one searches as another, the geometric mean over scenes.
fn ratio(one: &Measured, other: &Measured) -> f64 {
    let pairs = one.scenes.iter().zip(&other.scenes);
    let logs: f64 = pairs.map(|(one, other)| (one.search / other.search).ln()).sum();
    (logs / one.scenes.len() as f64).exp()
}
