//! The haptic loop with a simulated hand: walls, a sheet, and what becomes of energy.

pub mod energy;
pub mod sheet;
pub mod wall;

use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::{Part, Pose, Unit};

/// A block whose top is z = 0.
pub fn block(points: usize) -> Part {
    let (low, high) = (Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.));
    let mesh = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
    Part::from_mesh(&mesh, points, 1).expect("points of a block")
}

/// The tool upright, its tip at a height over the origin.
pub fn upright(z: f64) -> Pose {
    Pose::from_axis(Point3::new(0.0, 0.0, z), Vector3::z()).expect("a pose")
}

/// A tool of the library.
pub fn tool(name: &str) -> &'static dyn touchoff::Tool {
    tools_library::find(name).expect("a tool of the library")
}
