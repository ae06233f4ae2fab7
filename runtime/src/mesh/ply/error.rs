//! Errors of the PLY reader.

use crate::mesh::{MeshError, Outlier, SourceLocation};

/// Reasons why a PLY file could not be read. Lines count from 1, elements and bytes from 0.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum PlyError {
    /// The first line is not `ply`.
    #[error("{file} is no PLY file: its first line is not `ply`: convert the part to PLY")]
    NotPly {
        /// The file name.
        file: String,
    },
    /// A line of the header, or of an ASCII file, does not match the grammar.
    #[error(
        "{file}, line {line}: expected {expected}, found {found}: mend the line, or export the \
         part again"
    )]
    Expected {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The expected content.
        expected: String,
        /// The content found instead.
        found: String,
    },
    /// A part of the surface is written in an unsupported form.
    #[error(
        "{file} has a surface in `{unread}` too, which is not read: export the part as faces alone"
    )]
    Unread {
        /// The file name.
        file: String,
        /// The name of the element or list.
        unread: String,
    },
    /// The header gives the same name to two elements or properties.
    #[error("{file}, line {line}: there is a second `{name}`: give each its own name")]
    Duplicate {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The name of the element or property.
        name: String,
    },
    /// The file is shorter than its header declares.
    #[error(
        "{file} is cut off, or its header is wrong: {count} of `{element}` take {min_bytes} bytes at \
         least, but only {found} follow: export or copy it again"
    )]
    Promised {
        /// The file name.
        file: String,
        /// The element's name.
        element: String,
        /// The number of elements declared in the header.
        count: usize,
        /// The minimum number of bytes that the elements take.
        min_bytes: u128,
        /// The number of bytes found.
        found: usize,
    },
    /// The file ends within an element.
    #[error(
        "{file} ends at {location}, within `{element}` {index} (from 0) of {count}: it was cut off; \
         export or copy it again"
    )]
    Ended {
        /// The file name.
        file: String,
        /// The location at which it ends.
        location: SourceLocation,
        /// The element's name.
        element: String,
        /// The index of the element, from 0.
        index: usize,
        /// The number of elements declared in the header.
        count: usize,
    },
    /// The file continues after its last element.
    #[error(
        "{file} goes on at {location}, after all that its header promises, and what follows is \
         unknown: export it again, one part to a file"
    )]
    Trailing {
        /// The file name.
        file: String,
        /// The location at which it continues.
        location: SourceLocation,
    },
    /// A number is not valid for its property.
    #[error(
        "{file}, {location}: `{property}` of `{element}` {index} (from 0) is {value:?}, but must be \
         {rule}: repair the part where it was made"
    )]
    Value {
        /// The file name.
        file: String,
        /// The location of the element in the file.
        location: SourceLocation,
        /// The element's name.
        element: String,
        /// The index of the element, from 0.
        index: usize,
        /// The property's name.
        property: String,
        /// The number found.
        value: f64,
        /// The condition on the number.
        rule: &'static str,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "{file}, {location}: face {face} (from 0) names vertex {vertex}, but there are {vertices}, \
         counted from 0: export the part again"
    )]
    Index {
        /// The file name.
        file: String,
        /// The location of the face in the file.
        location: SourceLocation,
        /// The face's index, from 0.
        face: usize,
        /// The vertex index in the face.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A face has fewer than three corners.
    #[error(
        "{file}, {location}: face {face} (from 0) has {corners} corners: a face has three at least; \
         repair the mesh where it was made"
    )]
    Corners {
        /// The file name.
        file: String,
        /// The location of the face in the file.
        location: SourceLocation,
        /// The face's index, from 0.
        face: usize,
        /// The number of corners.
        corners: usize,
    },
    /// The fan of triangles from the first corner of a polygon does not fill it.
    #[error(
        "{file}, {location}: the polygon crosses itself or is too bent to be cut into triangles: export \
         the part in triangles"
    )]
    Folded {
        /// The file name.
        file: String,
        /// The location of the face in the file.
        location: SourceLocation,
    },
    /// The normal of a point cannot be normalised.
    #[error(
        "{file}, {location}: the normal of point {point} (from 0) is no direction: its norm is \
         {norm:?}; remove the point, or compute the normals anew"
    )]
    Normal {
        /// The file name.
        file: String,
        /// The location of the point in the file.
        location: SourceLocation,
        /// The point's index, from 0.
        point: usize,
        /// The normal's norm; NaN if a component is NaN.
        norm: f64,
    },
    /// There are no vertices, or they lack coordinates.
    #[error(
        "{file} has no points: it needs an element `vertex` with the numbers `x`, `y` and `z`: \
         export the part again"
    )]
    NoPoints {
        /// The file name.
        file: String,
    },
    /// The file has no faces.
    #[error(
        "{file} has no faces: it needs an element `face` with the list `vertex_indices`: export \
         the part as a mesh, or read it as points"
    )]
    NoFaces {
        /// The file name.
        file: String,
    },
    /// A vertex is far outside the rest of the part.
    #[error(
        "{file}, {location}: vertex {vertex} (from 0): {outlier}: mend the coordinate, or export or copy the part again"
    )]
    Outlier {
        /// The file name.
        file: String,
        /// The location of the vertex in the file.
        location: SourceLocation,
        /// The vertex index, from 0.
        vertex: usize,
        /// The outlying coordinate and its statistics.
        outlier: Outlier,
    },
    /// The file is well formed, but its content is not a mesh.
    #[error("{file}: {source}")]
    Mesh {
        /// The file name.
        file: String,
        /// The defect of the mesh.
        source: MeshError,
    },
}

crate::debug_as_sentence!(PlyError);
