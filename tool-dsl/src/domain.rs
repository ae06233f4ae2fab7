//! The domain of a file's expressions: the half plane of a `tool`, or the whole space of a `solid`.
//!
//! Points, boxes and vectors have three components in both. A tool's half plane is y = 0, x ≥ 0, where x is
//! the distance `d` from the axis. Only the emitted outputs turn its vectors to the azimuth of a point in
//! space.

use crate::diagnostic::format_number;
use crate::expr::interval::{Cell, Interval};
use crate::expr::{Coord, Graph, Id};

/// The kind of a file, which decides the coordinates of its expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// A `tool`, a solid of revolution: functions of `d` and `z`.
    HalfPlane,
    /// A `solid`, a shape without an axis: functions of `x`, `y` and `z`.
    Space,
}

/// The coordinates of a tool, each with its axis in the half plane.
const HALF_PLANE_COORDINATES: &[(Coord, usize, &str)] = &[(Coord::D, 0, "d"), (Coord::Z, 2, "z")];
/// The coordinates of a solid, each with its axis.
const SPACE_COORDINATES: &[(Coord, usize, &str)] =
    &[(Coord::X, 0, "x"), (Coord::Y, 1, "y"), (Coord::Z, 2, "z")];

impl Domain {
    /// Returns the keyword that begins such a file.
    pub fn keyword(self) -> &'static str {
        match self {
            Domain::HalfPlane => "tool",
            Domain::Space => "solid",
        }
    }

    /// Returns the coordinates, each with its axis (0, 1, 2 for x, y, z) and its name.
    pub fn coordinates(self) -> &'static [(Coord, usize, &'static str)] {
        match self {
            Domain::HalfPlane => HALF_PLANE_COORDINATES,
            Domain::Space => SPACE_COORDINATES,
        }
    }

    /// Returns the vector with the given component per coordinate; in the half plane, y is 0.
    pub(crate) fn vector(self, graph: &mut Graph, parts: &[Id]) -> [Id; 3] {
        let mut vector = [graph.int(0); 3];
        for ((_, axis, _), part) in self.coordinates().iter().zip(parts) {
            vector[*axis] = *part;
        }
        vector
    }

    /// Returns the cell of all points at most `size` from the origin along each coordinate.
    pub fn bounding_cell(self, size: f64) -> Cell {
        let full_range = Interval::new(-size, size);
        match self {
            Domain::HalfPlane => Cell::half_plane(Interval::new(0.0, size), full_range),
            Domain::Space => Cell { sides: [full_range; 3] },
        }
    }

    /// Returns the directions in which a solid can extend, each as an axis and whether toward its high end.
    pub(crate) fn axis_directions(self) -> &'static [(usize, bool)] {
        match self {
            Domain::HalfPlane => &[(0, true), (2, true), (2, false)],
            Domain::Space => &[(0, true), (0, false), (1, true), (1, false), (2, true), (2, false)],
        }
    }

    /// Formats a point for people: `(d, z)` or `(x, y, z)`.
    pub(crate) fn format_point(self, point: [f64; 3]) -> String {
        let parts: Vec<String> =
            self.coordinates().iter().map(|(_, axis, _)| format_number(point[*axis])).collect();
        format!("({})", parts.join(", "))
    }

    /// Returns the names of the coordinates as a tuple.
    pub(crate) fn tuple(self) -> String {
        let names: Vec<&str> = self.coordinates().iter().map(|(.., name)| *name).collect();
        format!("({})", names.join(", "))
    }

    /// Describes a coordinate in words.
    pub(crate) fn meaning(self, word: &str) -> Option<&'static str> {
        match (self, word) {
            (Domain::HalfPlane, "d") => Some("the distance from the axis"),
            (Domain::HalfPlane, "z") => Some("the place along the axis"),
            (Domain::Space, "x" | "y" | "z") => Some("a coordinate"),
            _ => None,
        }
    }
}
