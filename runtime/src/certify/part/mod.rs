//! The triangles of a part, and the location of points relative to it.

mod coplanar_faces;
mod planarity;
mod triangle_bvh;
mod winding;

pub(crate) use coplanar_faces::Face;
pub(crate) use planarity::NodeRing;
pub use triangle_bvh::{BoxVisitor, TriangleBvh};
pub(crate) use triangle_bvh::{Corners, flat};
pub use winding::Location;
