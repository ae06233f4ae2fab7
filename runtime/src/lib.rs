//! Full-body haptics for 5-axis machining: what a cutting tool feels of a workpiece, at any pose.
//!
//! A tool is written in a small language and compiled by [`include_tool!`], [`tool!`] or
//! [`tool_library!`] into straight-line code. A [`Part`] is a mesh made into a weighted point
//! cloud in a tree. A [`Probe`] brings them together: [`Probe::detect`], [`Probe::deepest`],
//! [`Probe::posture`], [`Probe::wrench`], [`Probe::contacts`].
//!
//! ```
//! use touchoff::{Part, Pose, Probe, Unit, mesh::shapes};
//! use nalgebra::{Point3, Vector3};
//!
//! touchoff::tool! {
//!     tool Ball "a ball of 3 mm radius" {
//!         units mm;
//!         region ball as ball cutting where hypot(d, z - 3) <= 3 {
//!             depth: 3 - hypot(d, z - 3);
//!         }
//!         niceness cutting: 1 - depth/3;
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
//! let part = Part::from_mesh(&block, 20_000, 1)?;
//! let mut probe = Probe::new(&part, &Ball);
//! let pose = Pose::from_axis(Point3::new(0.0, 0.0, -0.5), Vector3::z())?;
//! let felt = probe.wrench(&pose);
//! assert!(felt.colliding > 0 && felt.force.z > 0.0);
//! # Ok(()) }
//! ```

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

// Generated code names this crate `::touchoff`, here as elsewhere.
extern crate self as touchoff;

mod atomic_file;
mod bvh;
pub mod certify;
pub mod cloud;
mod cores;
mod escape;
#[cfg(feature = "haptic")]
pub mod haptic;
mod input;
pub mod mesh;
mod motion;
mod part;
mod pose;
#[cfg(feature = "postures")]
pub mod postures;
mod probe;
pub mod program;
mod saved;
mod scene;
pub mod scenes;
pub mod tool;
mod tree;
mod unit;
pub mod verify;
mod words;

pub use atomic_file::AtomicFile;
pub use cloud::{Cloud, CloudError, Cover, Sampling};
pub use escape::{Escaped, EscapedLines};
pub use fearless_simd::Level;
pub use mesh::{Mesh, MeshError, StlError, Survey};
pub use motion::{Motion, MotionError};
pub use part::{Part, PartError};
pub use pose::{AXIS_TOLERANCE, FARTHEST_TIP, Pose, PoseError};
pub use probe::{
    BudgetError, Contact, Deepest, Graded, GradedWrench, Law, Posture, Probe, Rounding, Stiffness,
    Summary, Weights, Wrench, summary,
};
pub use program::{Program, ProgramError, Stop};
pub use saved::SavedError;
pub use scene::{PartId, Scene, SceneError, ToolId};
pub use tool::Tool;
pub use tool_macros::{include_tool, tool, tool_library};
pub use tree::Tree;
pub use unit::{Unit, UnknownUnit};
pub use words::UnknownWord;
