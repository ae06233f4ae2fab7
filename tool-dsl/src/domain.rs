//! Where a file's expressions live: the half plane of a `tool`, or the whole space of a `solid`.
//!
//! Points, boxes and vectors have three parts in both. A tool's half plane is that of y = 0 and
//! x ≥ 0, where x is the distance `d` from the axis; only what is emitted turns its vectors to
//! where a point lies in space.

use crate::diagnostic::figure;
use crate::expr::interval::{Cell, Interval};
use crate::expr::{Coord, Graph, Id};

/// What a file describes, and so what its expressions are functions of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// A `tool`, a solid of revolution: functions of `d` and `z`.
    HalfPlane,
    /// A `solid`, a shape without an axis: functions of `x`, `y` and `z`.
    Space,
}

/// The coordinates of a tool, each with the axis of the half plane that it is measured along.
const OF_HALF_PLANE: &[(Coord, usize, &str)] = &[(Coord::D, 0, "d"), (Coord::Z, 2, "z")];
/// Those of a solid.
const OF_SPACE: &[(Coord, usize, &str)] =
    &[(Coord::X, 0, "x"), (Coord::Y, 1, "y"), (Coord::Z, 2, "z")];

impl Domain {
    /// The word that begins such a file.
    pub fn word(self) -> &'static str {
        match self {
            Domain::HalfPlane => "tool",
            Domain::Space => "solid",
        }
    }

    /// The coordinates, each with its axis (0, 1, 2 for x, y, z) and its name.
    pub fn coordinates(self) -> &'static [(Coord, usize, &'static str)] {
        match self {
            Domain::HalfPlane => OF_HALF_PLANE,
            Domain::Space => OF_SPACE,
        }
    }

    /// A vector from a part for each coordinate; the half plane's has no y.
    pub(crate) fn vector(self, graph: &mut Graph, parts: &[Id]) -> [Id; 3] {
        let mut vector = [graph.int(0); 3];
        for ((_, axis, _), part) in self.coordinates().iter().zip(parts) {
            vector[*axis] = *part;
        }
        vector
    }

    /// All that is no farther than a size from the origin along each coordinate.
    pub fn whole(self, size: f64) -> Cell {
        let all = Interval::new(-size, size);
        match self {
            Domain::HalfPlane => Cell::half_plane(Interval::new(0.0, size), all),
            Domain::Space => Cell { sides: [all; 3] },
        }
    }

    /// The ways in which a solid can reach far, each an axis and whether to its high end.
    pub(crate) fn ways(self) -> &'static [(usize, bool)] {
        match self {
            Domain::HalfPlane => &[(0, true), (2, true), (2, false)],
            Domain::Space => &[(0, true), (0, false), (1, true), (1, false), (2, true), (2, false)],
        }
    }

    /// A point for people: `(d, z)` or `(x, y, z)`.
    pub(crate) fn shown(self, point: [f64; 3]) -> String {
        let parts: Vec<String> =
            self.coordinates().iter().map(|(_, axis, _)| figure(point[*axis])).collect();
        format!("({})", parts.join(", "))
    }

    /// The names of the coordinates as a tuple.
    pub(crate) fn tuple(self) -> String {
        let names: Vec<&str> = self.coordinates().iter().map(|(.., name)| *name).collect();
        format!("({})", names.join(", "))
    }

    /// What a coordinate is, in words.
    pub(crate) fn meaning(self, word: &str) -> Option<&'static str> {
        match (self, word) {
            (Domain::HalfPlane, "d") => Some("the distance from the axis"),
            (Domain::HalfPlane, "z") => Some("the place along the axis"),
            (Domain::Space, "x" | "y" | "z") => Some("a coordinate"),
            _ => None,
        }
    }
}
