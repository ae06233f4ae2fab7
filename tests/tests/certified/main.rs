//! Certified answers compared with oracles that share no code with the certifier, and with known geometry.
//!
//! An oracle knows a tool from the dimensions of its drawing ([`touchoff_tests::oracle`]) and a motion from another
//! formula. It samples triangles, so no depth that it finds may exceed an upper bound. Lower bounds are proved by their
//! witnesses, which it evaluates. Four suites also run in full, the first three on real parts too if there are any, and
//! print their counts:
//!
//! ```text
//! POSES=2083 cargo test --release -p touchoff-tests --test certified depths:: -- --nocapture
//! ZOOMED=20 cargo test --release -p touchoff-tests --test certified zoomed:: -- --nocapture
//! MOTIONS=125 cargo test --release -p touchoff-tests --test certified sweeps:: -- --nocapture
//! CASES=1000000 cargo test --release -p touchoff-tests --test certified rounding:: -- --nocapture
//! ```
//!
//! `POSES`, `ZOOMED` and `MOTIONS` are numbers of poses, and of motions proved clear, per tool and part; `CASES` is the
//! number of all cases together.

mod allowances;
mod approach;
mod bodies;
mod borders;
mod brute;
mod clearance;
mod closed_forms;
mod depth_oracle;
mod depths;
mod enclosed;
mod end_in_part;
mod fields;
mod hard_cases;
mod inside_out;
mod kinks;
mod limits;
mod motions;
mod overhang;
mod pair;
mod pieces;
mod prelude;
mod ring_of_ties;
mod rounding;
mod sharp_cases;
mod spinning;
mod supports;
mod sweeps;
mod trajectories;
mod verdicts;
mod work;
mod zoomed;

use nalgebra::{Point3, Vector3};
use touchoff::{Mesh, Motion, Pose, Tool, Unit};
use touchoff_tests::fixtures::cuboid as block;
use touchoff_tests::oracle::Nearest;

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Returns a tool of the library, or one of [`overhang`].
fn tool(name: &str) -> &'static dyn Tool {
    touchoff_tools::find(name).or_else(|| overhang::tool(name)).expect("a tool")
}

/// Returns the oracle of the tool, from the dimensions of its drawing.
fn oracle(name: &str) -> Nearest {
    overhang::oracle(name).unwrap_or_else(|| Nearest::of(name))
}

fn pose(tip: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose::from_axis(Point3::from(tip), Vector3::from(axis)).expect("an axis")
}

fn pose_at(tip: Point3<f64>, axis: Vector3<f64>) -> Pose {
    Pose::from_axis(tip, axis.normalize()).expect("an axis")
}

/// Transforms a point to the frame of a tool, in its unit of `length`.
fn to_tool(pose: &Pose, length: f64, point: Point3<f64>) -> [f64; 3] {
    (pose.rotation().transpose() * (point - pose.tip()) / length).into()
}

fn motion(from: &Pose, to: &Pose) -> Motion {
    Motion::new(from, to).expect("an unambiguous rotation")
}

/// Returns a plate of 40 by 30 mm whose upper face is at z = 0.
fn plate() -> Mesh {
    block([-20.0, -15.0, -10.0], [20.0, 15.0, 0.0])
}

/// Returns a mesh of these triangles, which share no vertices.
fn soup(triangles: &[[[f64; 3]; 3]]) -> Mesh {
    let vertices = triangles.iter().flatten().map(|corner| Point3::from(*corner));
    let ids = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    Mesh::new(vertices, ids, Unit::Millimetre).expect("a mesh")
}
