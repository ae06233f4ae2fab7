//! The covering radius, and the time that it takes to make a cloud.

use super::{Pattern, radius};
use cpu_time::ProcessTime;
use nalgebra::Point3;
use std::path::Path;
use std::time::{Duration, Instant};
use touchoff::mesh::{Shape, ShapeError, shapes};
use touchoff::{Mesh, Unit, scenes};

/// Real parts, where there is a folder of them.
const FILES: [&str; 2] = ["impeller.stl", "nist_mbe_pmi_1_18k.ply"];

/// So often more is a cloud made, of fewer points than these.
const MORE: usize = 4;
const LONG: usize = 100_000;

/// A part and its name.
pub type Named = (String, Mesh);

/// What a part gave with so many points.
#[derive(Clone, Debug)]
pub struct Row {
    /// The part.
    pub part: String,
    /// Triangles of the part.
    pub triangles: usize,
    /// Points of each cloud.
    pub points: usize,
    /// The covering radius by the root of a point's share of the area, by pattern.
    pub radius: [f64; 2],
    /// To make the blue cloud on all cores.
    pub all: Duration,
    /// To make it on one.
    pub one: Duration,
    /// Of that the time that the core was at it.
    pub work: Duration,
}

/// Parts by construction, and those of a folder that are there.
///
/// # Errors
/// A file that cannot be read.
pub fn parts(folder: &Path) -> Result<Vec<Named>, ShapeError> {
    const UNIT: Unit = Unit::Millimetre;
    let high = Point3::new(10.0, 20.0, 40.0);
    let mut parts = vec![
        ("tube".to_owned(), scenes::tube()),
        ("cuboid".to_owned(), shapes::cuboid(Point3::origin(), high, UNIT).expect("a box")),
        ("sphere".to_owned(), shapes::sphere(10.0, 5, UNIT).expect("a ball")),
    ];
    for name in FILES {
        let path = folder.join(name);
        if !path.exists() {
            eprintln!("{name} is skipped: it is not in the folder");
        } else if let Shape::Mesh(mesh) = Shape::read(path, UNIT)? {
            parts.push((name.to_owned(), mesh));
        }
    }
    Ok(parts)
}

/// Makes clouds of a part.
///
/// # Panics
/// If a cloud is another on one core than on all.
pub fn row((name, mesh): &Named, points: usize, seed: u64) -> Row {
    let make = || {
        let make = || {
            let (start, work) = (Instant::now(), ProcessTime::now());
            let cloud = Pattern::Blue.cloud(mesh, points, seed);
            (cloud, [start.elapsed(), work.elapsed()])
        };
        let (cloud, mut best) = make();
        for _ in 0..(LONG / points).min(MORE) {
            let (_, times) = make();
            best = [0, 1].map(|clock: usize| best[clock].min(times[clock]));
        }
        (cloud, best)
    };
    let (blue, [all, _]) = make();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let (again, [one, work]) = pool.install(make);
    assert!(blue == again, "{name}: {points} points are others on one core than on all");
    let random = Pattern::Random.cloud(mesh, points, seed);
    let density = points as f64 / mesh.survey().area;
    Row {
        part: name.clone(),
        triangles: mesh.triangles().len(),
        points,
        radius: [&random, &blue].map(|cloud| radius(cloud) * density.sqrt()),
        all,
        one,
        work,
    }
}
