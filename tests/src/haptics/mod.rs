//! The haptic loop with a simulated hand: walls, a sheet, and the energy balance.

pub mod energy;
pub mod sheet;
pub mod wall;

use crate::fixtures::cuboid;
use nalgebra::{Point3, Vector3};
use touchoff::{Part, Pose, Sampling};

/// Returns a block whose top is z = 0, as `points` points.
pub fn block(points: usize) -> Part {
    let mesh = cuboid([-20., -20., -10.], [20., 20., 0.]);
    Part::from_mesh(&mesh, Sampling::new(points)).expect("points of a block")
}

/// Returns the pose of an upright tool with its tip at height `z` above the origin.
pub fn upright(z: f64) -> Pose {
    Pose::from_axis(Point3::new(0.0, 0.0, z), Vector3::z()).expect("a pose")
}

pub use crate::library::tool;
