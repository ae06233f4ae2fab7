//! Geometry of the half plane that several passes share: the segments of a profile, their intersections,
//! polygons that curves cut, and curves as functions of a point.

pub(crate) mod cut;
pub(crate) mod outline;
