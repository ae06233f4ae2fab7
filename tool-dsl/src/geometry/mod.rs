//! Geometry of the half plane that several passes share: the segments of a profile, convex polygons, and curves as functions
//! of a point.

pub(crate) mod function;
pub(crate) mod outline;
pub(crate) mod polygon;
