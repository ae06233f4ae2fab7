//! Contact between a cutting tool and a workpiece at any pose, for 5-axis machining: haptics, certified
//! interference, postures and program verification.
//!
//! A tool is written in a small language and compiled by [`include_tool!`], [`tool!`] or
//! [`tool_library!`] into straight-line code. A [`Part`] is a mesh sampled as a weighted point cloud, in
//! a bounding volume hierarchy. A [`Probe`] evaluates a tool at the points of a part: [`Probe::detect`],
//! [`Probe::deepest`], [`Probe::posture`], [`Probe::wrench`], [`Probe::contacts`]. [`certify`] proves
//! bounds for all points of the triangles, [`verify`] checks programs, and the features `haptic` and
//! `postures` add the haptic loop and posture maps.
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

// Generated code refers to this crate as `::touchoff`, also inside the crate itself.
extern crate self as touchoff;

mod atomic_file;
mod bvh;
pub mod certify;
pub mod cloud;
mod escape;
#[cfg(feature = "haptic")]
pub mod haptic;
mod input;
mod keywords;
pub mod mesh;
mod motion;
mod parallel;
mod part;
mod point_bvh;
mod pose;
#[cfg(feature = "postures")]
pub mod postures;
mod probe;
pub mod program;
mod scene;
pub mod scenes;
mod storage;
pub mod tool;
mod unit;
pub mod verify;

pub use atomic_file::AtomicFile;
pub use cloud::{Cloud, CloudError, CoveringRadius, SamplingMethod};
pub use escape::{Escaped, EscapedLines};
pub use fearless_simd::Level;
pub use keywords::ParseEnumError;
pub use mesh::{Mesh, MeshDiagnostics, MeshError, StlError};
pub use motion::{Motion, MotionError};
pub use part::{Part, PartError};
pub use point_bvh::PointBvh;
pub use pose::{AXIS_TOLERANCE, FARTHEST_TIP, Pose, PoseError};
pub use probe::{
    BudgetError, Contact, DeepestPoint, Law, LodProbe, LodWrench, Posture, Probe, Stiffness,
    Summary, Weights, Wrench, WrenchRounding, summary,
};
pub use program::{CutterLocation, Program, ProgramError};
pub use scene::{PartId, Scene, SceneError, ToolId};
pub use storage::SavedError;
pub use tool::Tool;
pub use tool_macros::{include_tool, tool, tool_library};
pub use unit::{ParseUnitError, Unit};
