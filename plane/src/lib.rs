//! The plane geometry of a profile: points of the half plane `[d, z]`, where `d` is the distance from the tool's axis, lines and
//! arcs with the tool on their left, their distances, feet, normals and tangents.
//!
//! The compiler of tools, the certifier, drawings, posture maps, stock, reports and the page all take a profile's geometry from here; coordinates
//! are in whatever unit the profile has.
//!
//! **Rounding.** Let S be the largest absolute value of the coordinates and radii involved, and u = 2⁻⁵³. A distance, signed or not, errs by at most 16 u S, and a
//! foot by as much, from those of the line through the doubles of its ends, or of the circle with its doubles as centre and radius; the test
//! `distances_are_as_accurate_as_stated` compares them with 200 bits. Which end, or which side of a normal, is nearest is decided by rounding where both are as
//! near as that. Squares must not overflow: S is between 1e-150 and 1e150.
//!
//! **Singular points.** A line whose ends coincide has the direction 0, and is a point. In the centre of an arc, which has no direction, the foot is the
//! arc's start, and a normal is NaN. An arc whose ends coincide turns by 0.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

mod segment;
mod vector;

pub use segment::{ANGLE_ROUNDING, Circle, Place, Segment};
pub use vector::{Point, angle_between, cross, dot, minus, norm, turned, unit};
