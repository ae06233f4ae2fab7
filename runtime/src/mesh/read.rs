//! Reading a part from a file of any format there is a reader for.

use std::io;
use std::path::Path;

use super::{Mesh, ObjError, PlyError, Points, StlError, ply};
use crate::input;
use crate::unit::Unit;

/// What a file holds of a part.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Its surface.
    Mesh(Mesh),
    /// Points of its surface.
    Points(Points),
}

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ShapeError {
    /// The file system would not give it.
    #[error("cannot read {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// Nothing tells what it is.
    #[error(
        "{file} is of no known format: read are meshes in STL, PLY and OBJ (`.stl`, `.ply`, \
         `.obj`) and points with normals in PLY: convert the part to one of these"
    )]
    Unknown {
        /// The file.
        file: String,
    },
    /// It is no sound STL file.
    #[error(transparent)]
    Stl(#[from] StlError),
    /// It is no sound PLY file.
    #[error(transparent)]
    Ply(#[from] PlyError),
    /// It is no sound OBJ file.
    #[error(transparent)]
    Obj(#[from] ObjError),
}

impl Shape {
    /// Reads a file whose lengths are in `unit`: PLY where it begins with `ply`, otherwise STL,
    /// PLY or OBJ by its name. PLY with faces is a mesh, without any it is points.
    ///
    /// # Errors
    /// All that is wrong with the file, with its name and the place.
    pub fn read(path: impl AsRef<Path>, unit: Unit) -> Result<Shape, ShapeError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        match input::read(path) {
            Ok(bytes) => Shape::from_bytes(&bytes, &file, unit),
            Err(source) => Err(ShapeError::Unreadable { file, source }),
        }
    }

    /// The same as [`Shape::read`] for a file already in memory, whose name is `name`. No bytes
    /// make it panic.
    ///
    /// # Errors
    /// See [`Shape::read`].
    pub fn from_bytes(bytes: &[u8], name: &str, unit: Unit) -> Result<Shape, ShapeError> {
        let extension = Path::new(name).extension().unwrap_or_default();
        let is = |known: &str| extension.eq_ignore_ascii_case(known);
        Ok(if ply::begins(bytes) || is("ply") {
            match ply::has_faces(bytes, name)? {
                true => Shape::Mesh(Mesh::from_ply(bytes, name, unit)?),
                false => Shape::Points(Points::from_ply(bytes, name)?),
            }
        } else if is("stl") {
            Shape::Mesh(Mesh::from_stl(bytes, name, unit)?)
        } else if is("obj") {
            Shape::Mesh(Mesh::from_obj(bytes, name, unit)?)
        } else {
            return Err(ShapeError::Unknown { file: name.to_owned() });
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Unit = Unit::Millimetre;

    fn says(bytes: &[u8], name: &str) -> String {
        Shape::from_bytes(bytes, name, UNIT).expect_err("it should be refused").to_string()
    }

    #[test]
    fn chooses_by_content_and_by_name() {
        let triangle = Shape::from_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "a.OBJ", UNIT);
        let Ok(Shape::Mesh(mesh)) = triangle else { panic!("{triangle:?}") };
        let mut stl = Vec::new();
        mesh.write_stl(&mut stl).expect("written");
        assert_eq!(Shape::from_bytes(&stl, "a.stl", UNIT).expect("STL"), Shape::Mesh(mesh));

        let xyz = "property float x\nproperty float y\nproperty float z\n";
        let normal = "property float nx\nproperty float ny\nproperty float nz\n";
        let header = format!("ply\nformat ascii 1.0\nelement vertex 3\n{xyz}");
        let list = "element face 1\nproperty list uchar int vertex_index\n";
        let mesh = format!("{header}{list}end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        let points = format!("{header}{normal}end_header\n{}", "0 0 0 0 0 1\n".repeat(3));
        let read = Shape::from_bytes(mesh.as_bytes(), "whatever.stl", UNIT);
        assert!(matches!(read, Ok(Shape::Mesh(_))), "{read:?}");
        let read = Shape::from_bytes(points.as_bytes(), "part", UNIT);
        assert!(matches!(&read, Ok(Shape::Points(points)) if points.places.len() == 3), "{read:?}");
    }

    #[test]
    fn says_what_it_reads() {
        let unknown = says(b"ISO-10303-21;", "part.step");
        assert!(unknown.contains("part.step is of no known format: read are meshes in STL, PLY"));
        assert!(says(b"solid", "part.ply").contains("is no PLY file"));
        assert!(says(b"", "part.stl").contains("is empty"));
        assert!(says(b"", "part.obj").contains("has no faces"));
        let missing = Shape::read("no/such/part.ply", UNIT).expect_err("no such file");
        assert!(missing.to_string().contains("cannot read no/such/part.ply"), "{missing}");
    }
}
