//! A part's triangles, and whether a point is inside them.

mod facets;
mod flat;
mod winding;

pub(crate) use facets::Corners;
pub use facets::Facets;
pub(crate) use flat::Ring;
