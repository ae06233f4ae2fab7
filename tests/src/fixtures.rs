//! The thesis's tube as points, and poses along it.

use touchoff::scenes::{ScenePath, tube};
use touchoff::{Cloud, Part, Pose, Sampling};

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
