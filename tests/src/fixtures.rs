//! Inputs for the benches of single calls: many points near a tool, and poses along the tube.

use crate::oracle::rng::Rng;
use touchoff::scenes::{ScenePath, tube};
use touchoff::tool::{PointBatch, Tool};
use touchoff::{Cloud, Interval, Part, Pose, Sampling};

/// Tools that the benches evaluate: one of straight lines and a ball, the thesis's by hand and by profile, and one
/// of many profile segments.
pub const TOOLS: [&str; 4] = ["D2Ball", "Fig73", "Fig73Exact", "BullNoseHsk63"];

/// Returns a tool of the library.
///
/// # Panics
/// If there is none of that name.
pub fn tool(name: &str) -> &'static dyn Tool {
    touchoff_tools::find(name).expect("a tool of the library")
}

/// Returns points within 5 % of the tool's radius of its outline, inside or not, such as the tree leaves of a
/// cloud. If there are more than some 16,000, a processor cannot learn which branches they take.
pub fn points_near_surface(tool: &dyn Tool, count: usize) -> PointBatch {
    let info = tool.info();
    let (Interval { low, high }, radius) = (info.reach(), info.radius());
    let mut rng = Rng::new(1);
    let mut points = PointBatch::default();
    while points.len() < count {
        let z = rng.between(low, high);
        let slabs = info.envelope.iter().filter(|slab| (slab.low..=slab.high).contains(&z));
        let outline = slabs.fold(0.0, |max_radius, slab| slab.radius.max(max_radius));
        let d = outline + rng.between(-0.05, 0.05) * radius;
        let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
        points.push([d * cos, d * sin, z]);
    }
    points
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
