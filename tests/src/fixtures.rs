//! The thesis's tube as points, poses along it, cuboids, and a ball for a tool.

use nalgebra::Point3;
use touchoff::mesh::shapes;
use touchoff::scenes::{ScenePath, tube};
use touchoff::tool::Interpreted;
use touchoff::{Cloud, Mesh, Part, Pose, Sampling, Unit};

/// Returns a cuboid with edges along the coordinate axes, in mm.
///
/// # Panics
/// If it has no volume.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

/// Radius of [`ball`], mm.
pub const BALL: f64 = 3.0;

/// Returns a tool that is a ball, all of which cuts. Its centre is on the axis.
///
/// # Panics
/// If the compiler rejects it.
pub fn ball() -> Interpreted {
    "tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } niceness cutting: 1; }"
        .parse()
        .expect("a tool")
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
