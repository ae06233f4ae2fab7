//! Why a PLY file is refused.

use crate::mesh::{MeshError, Place, Stray};

/// Why a PLY file could not be read. Lines count from 1, elements and bytes from 0.
#[derive(Debug, thiserror::Error)]
pub enum PlyError {
    /// It does not begin as every PLY file does.
    #[error("{file} is no PLY file: its first line is not `ply`: convert the part to PLY")]
    NotPly {
        /// The file.
        file: String,
    },
    /// A line of the header, or of an ASCII file, says something else than it must.
    #[error(
        "{file}, line {line}: expected {expected}, found {found}: mend the line, or export the \
         part again"
    )]
    Expected {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// What should stand there.
        expected: String,
        /// What does.
        found: String,
    },
    /// A part of the surface is written in a form that is not read.
    #[error(
        "{file} has a surface in `{unread}` too, which is not read: export the part as faces alone"
    )]
    Unread {
        /// The file.
        file: String,
        /// The element or list.
        unread: String,
    },
    /// The header gives one name to two things.
    #[error("{file}, line {line}: there is a second `{name}`: give each its own name")]
    Twice {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// The name of the element or property.
        name: String,
    },
    /// The file is shorter than its header promises.
    #[error(
        "{file} is cut off, or its header is wrong: {count} of `{element}` take {least} bytes at \
         least, but only {found} follow: export or copy it again"
    )]
    Promised {
        /// The file.
        file: String,
        /// The element's name.
        element: String,
        /// How many the header promises.
        count: usize,
        /// How many bytes they take at least.
        least: u128,
        /// How many bytes there are.
        found: usize,
    },
    /// The file ends within an element.
    #[error(
        "{file} ends at {place}, within `{element}` {index} (from 0) of {count}: it was cut off; \
         export or copy it again"
    )]
    Ended {
        /// The file.
        file: String,
        /// Where it ends.
        place: Place,
        /// The element's name.
        element: String,
        /// Which of them.
        index: usize,
        /// How many the header promises.
        count: usize,
    },
    /// The file goes on after its last element.
    #[error(
        "{file} goes on at {place}, after all that its header promises, and what follows is \
         unknown: export it again, one part to a file"
    )]
    Trailing {
        /// The file.
        file: String,
        /// Where it goes on.
        place: Place,
    },
    /// A number is not what its property must be.
    #[error(
        "{file}, {place}: `{property}` of `{element}` {index} (from 0) is {value:?}, but must be \
         {rule}: repair the part where it was made"
    )]
    Value {
        /// The file.
        file: String,
        /// Where the element begins.
        place: Place,
        /// The element's name.
        element: String,
        /// Which of them.
        index: usize,
        /// The property's name.
        property: String,
        /// The number.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// A face names a vertex that is not there.
    #[error(
        "{file}, {place}: face {face} (from 0) names vertex {vertex}, but there are {vertices}, \
         counted from 0: export the part again"
    )]
    Index {
        /// The file.
        file: String,
        /// Where the face begins.
        place: Place,
        /// The face.
        face: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A face is less than a triangle.
    #[error(
        "{file}, {place}: face {face} (from 0) has {corners} corners: a face has three at least; \
         repair the mesh where it was made"
    )]
    Corners {
        /// The file.
        file: String,
        /// Where the face begins.
        place: Place,
        /// The face.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// A polygon is not filled by triangles from its first corner.
    #[error(
        "{file}, {place}: the polygon is too hollow or too bent to be cut into triangles from its \
         first corner: export the part in triangles"
    )]
    Folded {
        /// The file.
        file: String,
        /// Where the face begins.
        place: Place,
    },
    /// A point without a direction out of the material.
    #[error(
        "{file}, {place}: the normal of point {point} (from 0) is no direction: its norm is \
         {norm:?}; remove the point, or compute the normals anew"
    )]
    Normal {
        /// The file.
        file: String,
        /// Where the point stands.
        place: Place,
        /// The point.
        point: usize,
        /// The normal's norm; NaN when a component is.
        norm: f64,
    },
    /// There is no vertex that could be placed.
    #[error(
        "{file} has no points: it needs an element `vertex` with the numbers `x`, `y` and `z`: \
         export the part again"
    )]
    NoPoints {
        /// The file.
        file: String,
    },
    /// There is no surface.
    #[error(
        "{file} has no faces: it needs an element `face` with the list `vertex_indices`: export \
         the part as a mesh, or read it as points"
    )]
    NoFaces {
        /// The file.
        file: String,
    },
    /// Nobody knows which way is out.
    #[error(
        "{file} holds points without normals, and which way is out cannot be known: export them \
         with `nx`, `ny` and `nz`, or export the mesh, with its faces"
    )]
    NoNormals {
        /// The file.
        file: String,
    },
    /// A vertex is far outside the rest of the part.
    #[error(
        "{file}, {place}: vertex {vertex} (from 0): {stray}: mend the coordinate, or export or copy the part again"
    )]
    Stray {
        /// The file.
        file: String,
        /// Where the vertex stands.
        place: Place,
        /// The vertex.
        vertex: usize,
        /// What is wrong with it.
        stray: Stray,
    },
    /// The file is in order, but what it holds is no mesh.
    #[error("{file}: {source}")]
    Mesh {
        /// The file.
        file: String,
        /// What is wrong with the mesh.
        source: MeshError,
    },
}
