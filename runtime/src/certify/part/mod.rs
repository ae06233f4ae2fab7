//! A part's triangles, and whether a point is inside them.

mod facets;
mod flat;
mod flats;
mod winding;

pub use facets::Facets;
pub(crate) use facets::{Corners, flat};
pub(crate) use flat::Ring;
pub(crate) use flats::Face;
pub(crate) use winding::Location;
