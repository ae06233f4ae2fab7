//! The thesis's tube as points, poses along it, and cuboids.

use nalgebra::Point3;
use touchoff::mesh::shapes;
use touchoff::scenes::{ScenePath, tube};
use touchoff::{Cloud, Mesh, Part, Pose, Sampling, Unit};

/// Returns a cuboid with edges along the coordinate axes, in mm.
///
/// # Panics
/// If it has no volume.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

/// Returns the tube as `points` points.
///
/// # Panics
/// If `points` is 0.
pub fn part(points: usize) -> Part {
    let mesh = tube();
    let cloud =
        Cloud::sample(&mesh, Sampling::monte_carlo(points)).expect("the tube has a surface");
    Part::new(&cloud, mesh.diagnostics())
}

/// Returns `count` poses along a path.
pub fn poses(path: ScenePath, count: usize) -> Vec<Pose> {
    (0..count).map(|k| path.pose(k, count)).collect()
}
