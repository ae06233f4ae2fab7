//! Contact between a cutting tool and a workpiece at any pose, for 5-axis machining: depth, force and certified
//! interference.
//!
//! A tool is written in a small language and compiled into straight-line code by [`include_tool!`], [`tool!`] or
//! [`tool_library!`]. A workpiece is a triangle mesh: sampled as a weighted point cloud for fast queries, or searched
//! as triangles for proved ones. Depths have an error bound wherever one is proved of the tool, forces a bound on their
//! rounding error.
//!
//! # A tour
//!
//! A *wrench* is a force and a torque; *niceness* rates how good a contact is for machining; a *posture* is a tool's pose
//! at a triangle of the part. The glossary is `docs/glossary.md`.
//!
//! **Load.** [`Mesh::read_stl`] and [`mesh::Geometry`] read files; the caller states the unit. [`Part::from_mesh`]
//! samples a mesh; [`Part::save`] and [`Part::open`] keep the result.
//!
//! **Write a tool**, or take one from the package `touchoff-tools`.
//!
//! **Query.** A [`Probe`] evaluates a tool at the points of a part.
//!
//! ```
//! use touchoff::{Part, Pose, Probe, Sampling, Unit, mesh::shapes};
//! use nalgebra::{Point3, Vector3};
//!
//! touchoff::tool! {
//!     tool Ball "6 mm ball" {
//!         units mm;
//!         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
//!         niceness cutting: 1 - depth/3;
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
//! let part = Part::from_mesh(&block, Sampling::new(20_000))?;
//! let mut probe = Probe::new(&part, &Ball);
//! let pose = Pose::from_axis(Point3::new(0.0, 0.0, -0.5), Vector3::z())?;
//! let wrench = probe.wrench(&pose);
//! assert!(wrench.colliding > 0 && wrench.force.z > 0.0);
//! // `depth_bound` also covers the surface between the points.
//! assert!(probe.depth_bound(&pose).is_some_and(|bound| bound >= 0.5));
//! # Ok(()) }
//! ```
//!
//! **Certify.** A [`Certifier`](certify::Certifier) bounds depth, clearance and motions over all points of the
//! triangles.
//!
//! ```
//! # use nalgebra::{Point3, Vector3};
//! # use touchoff::{Pose, Unit, mesh::shapes};
//! use touchoff::certify::{Certifier, TriangleBvh};
//! # touchoff::tool! {
//! #     tool Ball "6 mm ball" {
//! #         units mm;
//! #         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
//! #         niceness cutting: 1 - depth/3;
//! #     }
//! # }
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
//! # let pose = Pose::from_axis(Point3::new(0.0, 0.0, -0.5), Vector3::z())?;
//! let bvh = TriangleBvh::new(&block);
//! let depth = Certifier::new(&bvh, &Ball)?.deepest(&pose, 1e-9).depth;
//! // The tip is 0.5 mm below the top face. The interval is as wide as the tolerance and the rounding error bound.
//! assert!(depth.contains(0.5) && depth.width() < 2e-9);
//! # Ok(()) }
//! ```
//!
//! **Verify.** The package `touchoff-verify` checks programs: tables of locations, APT and G-code, on machines, with
//! fixtures and stock.
//!
//! **Sweep.** The package `touchoff-postures` tries tools at every triangle from every direction, keeps the result, and
//! plans paths over it.
//!
//! **Run the loop.** The package `touchoff-haptics` drives a haptic device at 1 kHz.
//!
//! A shorter program: `examples/first_contact.rs`.
//!
//! # Main types
//!
//! | type | purpose |
//! |---|---|
//! | [`Tool`] | a tool that can be evaluated; `tool!` implements it |
//! | [`Mesh`], [`Cloud`], [`Part`] | triangles, points sampled on them, and the points prepared for queries |
//! | [`Pose`], [`Motion`] | the tool's tip and axis or full rotation, and a move between two of them |
//! | [`Probe`] | contact, depth and force at the points of a part |
//! | [`TriangleBvh`](certify::TriangleBvh), [`Certifier`](certify::Certifier) | triangles prepared for queries, and proved depth, clearance and motions |
//! | [`Law`], [`Weights`], [`Level`] | options of a probe: force law, weights of points, SIMD level |
//!
//! Lengths are in the unit of the part or of the tool's file, as each function states; frames are right-handed, and a
//! tool's axis points from the tip to the spindle. Vectors and points are those of `nalgebra`, which a program needs as a
//! dependency too.
//!
//! # Features
//!
//! No feature is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `parallel` | many poses on all cores: `Probe::par_map` |
//! | `interpreter` | `.tool` files loaded at run time: `tool::Interpreted` |

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

// The code blocks of this page are tests, too.
#[cfg(doctest)]
#[doc = include_str!("../../docs/certified.md")]
struct CertifiedPage;

// Generated code refers to this crate as `::touchoff`, also inside the crate itself.
extern crate self as touchoff;

mod atomic_file;
mod bvh;
pub mod cancellation;
pub mod certify;
pub mod cloud;
mod debug;
mod escape;
mod handle;
mod id;
mod input;
mod interval;
mod keywords;
pub mod mesh;
mod motion;
mod parallel;
mod part;
mod point_bvh;
mod pose;
mod probe;
mod scene;
pub mod scenes;
mod shard;
mod storage;
pub mod tool;
mod unit;

pub use atomic_file::AtomicFile;
pub use cloud::{Cloud, CloudError, CoveringRadius, Sampling, SamplingMethod};
pub use escape::{Escaped, EscapedLines};
pub use fearless_simd::Level;
pub use id::{SurfaceId, TriangleId};
pub use input::{FileKind, is_within, open_regular_file, read_regular_file, read_text_file};
pub use interval::Interval;
pub use keywords::ParseEnumError;
pub use mesh::{Mesh, MeshDiagnostics, MeshError, StlError};
pub use motion::{Motion, MotionError};
pub use part::{Part, PartError};
pub use point_bvh::PointBvh;
pub use pose::{AXIS_TOLERANCE, MAX_TIP_COORDINATE, Pose, PoseError};
pub use probe::{
    BudgetError, Contact, DeepestPoint, InsidePoint, InsideQuery, Law, LodProbe, LodWrench,
    Posture, Probe, Stiffness, Summary, ToolEnvelope, Weights, Wrench, WrenchRounding, summary,
};
pub use scene::{PartId, Scene, SceneError, ToolId};
pub use shard::{NoShard, Shard, ShardSet, ShardSetError};
pub use storage::SavedError;
pub use tool::Tool;
pub use touchoff_macros::{include_tool, tool, tool_library};
pub use unit::{ParseUnitError, Unit};
