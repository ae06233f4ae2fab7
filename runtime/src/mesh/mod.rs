//! The part: triangles with ids that hold, in a stated unit.
//!
//! A [`Mesh`] is read from an STL, PLY or OBJ file or generated ([`shapes`]); [`Shape::read`] takes
//! any of these, and [`Points`] too. A mesh is correct as data (every index in range, every
//! coordinate finite, some area) but not necessarily a solid. What it is, [`Mesh::survey`] says.
//! Coordinates are the world's, in the mesh's [`Unit`].

mod faces;
mod obj;
mod ply;
mod read;
pub mod shapes;
mod stl;
mod stray;
mod survey;
mod topology;
mod words;

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Point3, Vector3};

use crate::input;
use crate::unit::Unit;

pub use obj::ObjError;
pub use ply::{PlyError, Points};
pub use read::{Shape, ShapeError};
pub use stl::StlError;
pub use stray::Stray;
pub use survey::Survey;
pub(crate) use topology::inverted;
pub use words::Place;

/// The largest coordinate a mesh may have, of either sign. Up to here areas and volumes, which
/// are products of coordinates, stay far from overflow; all that a binary STL file can hold
/// (`f32`, 3.4e38) is within it.
pub const LARGEST_COORDINATE: f64 = 1e60;

/// Coordinates below this fraction (2^-40) of the part's size are told apart by nothing but the
/// noise of whoever computed them.
const NOISE: f64 = 1.0 / (1u64 << 40) as f64;

/// How large the sine of a triangle's angle must be for its normal to mean anything: some ten
/// times what rounding leaves in the cross product of two edges.
const SMALLEST_SINE: f64 = 16.0 * f64::EPSILON;

/// A triangle mesh in a stated unit of length.
///
/// A triangle's id is its place in the list, which for a file is the place of its facet in the
/// file. Triangles without area stay in the list so that ids hold; they are never sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    unit: Unit,
    opposed_normals: usize,
}

/// Vertices and triangles that make no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is nothing to touch.
    #[error("the mesh has no triangle: export the part again, with its surfaces meshed")]
    NoTriangle,
    /// There are triangles, but nothing to touch.
    #[error(
        "none of the mesh's {triangles} triangles has an area: export the part again, in finer \
         resolution or a smaller unit"
    )]
    NoArea {
        /// How many triangles there are.
        triangles: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error(
        "triangle {triangle} has the vertex index {index}, but there are {vertices} vertices: \
         indices count from 0"
    )]
    Index {
        /// The triangle's id.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is NaN, infinite or beyond [`LARGEST_COORDINATE`].
    #[error(
        "vertex {vertex} has the coordinate {coordinate}: coordinates must be finite and within \
         {LARGEST_COORDINATE:e}"
    )]
    Coordinate {
        /// The vertex's index.
        vertex: usize,
        /// The coordinate.
        coordinate: f64,
    },
    /// More triangles or vertices than 32-bit ids can tell apart.
    #[error("{count} {what} are more than 32-bit ids can tell apart: split or coarsen the mesh")]
    TooMany {
        /// `triangles` or `vertices`.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A generated shape was asked for with measures it cannot have.
    #[error("no such {shape}: {rule}")]
    Shape {
        /// `tube`, `cuboid`, `plane` or `sphere`.
        shape: &'static str,
        /// What its measures must satisfy.
        rule: &'static str,
    },
}

impl Mesh {
    /// A mesh from vertices (n × 3, in `unit`) and triangles (m × 3 indices into them, from 0,
    /// counter-clockwise seen from outside the material).
    ///
    /// # Errors
    /// An index out of range, a coordinate that is not finite or too large, no triangle, no area.
    pub fn new(
        vertices: Vec<Point3<f64>>,
        triangles: Vec<[u32; 3]>,
        unit: Unit,
    ) -> Result<Mesh, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::NoTriangle);
        }
        let what = [("triangles", triangles.len()), ("vertices", vertices.len())];
        if let Some(&(what, count)) = what.iter().find(|(_, n)| u32::try_from(*n).is_err()) {
            return Err(MeshError::TooMany { what, count });
        }
        for (vertex, point) in vertices.iter().enumerate() {
            if let Some(&coordinate) = point.iter().find(|&&c| !coordinate_holds(c)) {
                return Err(MeshError::Coordinate { vertex, coordinate });
            }
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices.len()) {
                let vertices = vertices.len();
                return Err(MeshError::Index { triangle, index, vertices });
            }
        }
        let mesh = Mesh { vertices, triangles, unit, opposed_normals: 0 };
        if mesh.corners().any(|corners| area_and_normal(&corners).is_some()) {
            Ok(mesh)
        } else {
            Err(MeshError::NoArea { triangles: mesh.triangles.len() })
        }
    }

    /// Reads an STL file, binary or ASCII, whose numbers are in `unit` (STL states none).
    ///
    /// Corners with equal coordinates become one vertex, where those below 1e-12 of the part's
    /// size count as 0: exporters leave such noise where a turned face crosses an axis, and a
    /// sound part would seem to leak there. Nothing else is changed.
    ///
    /// # Errors
    /// All that is wrong with the file, with its name and the place; see [`StlError`].
    pub fn read_stl(path: impl AsRef<Path>, unit: Unit) -> Result<Mesh, StlError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        match input::read(path) {
            Ok(bytes) => Mesh::from_stl(&bytes, &file, unit),
            Err(source) => Err(StlError::Unreadable { file, source }),
        }
    }

    /// The same as [`Mesh::read_stl`] for a file already in memory; `name` stands for it in
    /// errors. No bytes make it panic.
    ///
    /// # Errors
    /// See [`StlError`].
    pub fn from_stl(bytes: &[u8], name: &str, unit: Unit) -> Result<Mesh, StlError> {
        let facets = stl::read(bytes, name)?;
        match weld(&facets.corners, unit) {
            Ok(mesh) => Ok(Mesh { opposed_normals: facets.opposed_normals, ..mesh }),
            Err(source) => Err(StlError::Mesh { file: name.to_owned(), source }),
        }
    }

    /// The vertices, in [`Mesh::unit`], in the order of their first use in the file.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// The triangles by id, each three indices into [`Mesh::vertices`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The unit of length of the coordinates.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// As slices do, when there is no triangle `id`.
    pub fn triangle(&self, id: u32) -> [Point3<f64>; 3] {
        self.triangles[id as usize].map(|vertex| self.vertices[vertex as usize])
    }

    /// A triangle's unit normal, by its winding: `(b - a) × (c - a)` normalised. `None` when the
    /// triangle has no area or is so thin that rounding would decide (a sine below 4e-15).
    ///
    /// # Panics
    /// As slices do, when there is no triangle `id`.
    pub fn normal(&self, id: u32) -> Option<Vector3<f64>> {
        area_and_normal(&self.triangle(id)).map(|(_, normal)| normal)
    }

    /// A triangle's area, in the square of the mesh's unit; 0 where [`Mesh::normal`] is `None`.
    ///
    /// # Panics
    /// As slices do, when there is no triangle `id`.
    pub fn area(&self, id: u32) -> f64 {
        area_and_normal(&self.triangle(id)).map_or(0.0, |(area, _)| area)
    }

    /// The smallest box around all triangles: its lowest and highest corner.
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        let corners = self.triangles.iter().flatten();
        bounds(corners.map(|&vertex| self.vertices[vertex as usize]))
    }

    /// What the mesh is: closed or not, which way it is oriented, how large, what is odd about
    /// it. Computed anew on each call, in time linear in the number of triangles.
    pub fn survey(&self) -> Survey {
        Survey::of(self)
    }

    /// The corners of every triangle, by id.
    pub(crate) fn corners(&self) -> impl Iterator<Item = [Point3<f64>; 3]> {
        self.triangles.iter().map(|t| t.map(|vertex| self.vertices[vertex as usize]))
    }
}

/// A mesh from the corners of its facets; the first of equal corners gives the vertex
/// its coordinates.
fn weld(corners: &[[Point3<f64>; 3]], unit: Unit) -> Result<Mesh, MeshError> {
    let [low, high] = bounds(corners.iter().flatten().copied());
    let noise = (high - low).amax() * NOISE;
    let mut known = HashMap::new();
    let mut vertices = Vec::new();
    let mut triangles = Vec::with_capacity(corners.len());
    for facet in corners {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(facet) {
            let count = vertices.len();
            let what = "vertices";
            let next = u32::try_from(count).map_err(|_| MeshError::TooMany { what, count })?;
            // Zero has two bit patterns, and -0 is noise as well.
            let key = [0, 1, 2].map(|axis| match corner[axis] {
                c if c.abs() <= noise => 0,
                c => c.to_bits(),
            });
            *index = *known.entry(key).or_insert(next);
            if *index == next {
                vertices.push(*corner);
            }
        }
        triangles.push(triangle);
    }
    Mesh::new(vertices, triangles, unit)
}

/// The smallest box around some points; without any, an empty one.
pub(crate) fn bounds(points: impl IntoIterator<Item = Point3<f64>>) -> [Point3<f64>; 2] {
    let nothing = [f64::INFINITY, f64::NEG_INFINITY].map(|c| Point3::new(c, c, c));
    points.into_iter().fold(nothing, |[low, high], p| [low.inf(&p), high.sup(&p)])
}

/// Whether a number may be a coordinate; NaN compares false.
pub(crate) fn coordinate_holds(coordinate: f64) -> bool {
    coordinate.abs() <= LARGEST_COORDINATE
}

/// The area and unit normal of a triangle, or `None` when it has none to speak of.
///
/// The edges are subtracted first, so that an offset costs nothing beyond the rounding of the
/// coordinates themselves, and the two shorter ones are multiplied, whose cross product loses
/// the least. Edges from 1e-70 up are told from nothing.
pub(crate) fn area_and_normal([a, b, c]: &[Point3<f64>; 3]) -> Option<(f64, Vector3<f64>)> {
    let edges = [b - a, c - b, a - c];
    let squares = edges.map(|edge| edge.norm_squared());
    let longest = (0..3).fold(0, |k, i| if squares[i] > squares[k] { i } else { k });
    let (first, second) = ((longest + 1) % 3, (longest + 2) % 3);
    let cross = edges[first].cross(&edges[second]);
    let square = cross.norm_squared();
    let least = SMALLEST_SINE * SMALLEST_SINE * squares[first] * squares[second];
    if square <= least || square < f64::MIN_POSITIVE {
        return None;
    }
    let norm = square.sqrt();
    Some((0.5 * norm, cross / norm))
}

/// A sum that carries its rounding error along (Neumaier 1974), so that a million areas add up
/// to the last digits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, term: f64) {
        let sum = self.high + term;
        self.low += if self.high.abs() >= term.abs() {
            (self.high - sum) + term
        } else {
            (term - sum) + self.high
        };
        self.high = sum;
    }

    pub(crate) fn value(self) -> f64 {
        self.high + self.low
    }
}

#[cfg(test)]
mod tests;
