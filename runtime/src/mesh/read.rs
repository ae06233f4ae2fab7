//! Reading a part from a file of any supported format.

use std::io;
use std::path::Path;

use super::{Mesh, ObjError, OrientedPoints, PlyError, PointsError, StlError, ply};
use crate::input::{self, FileKind};
use crate::unit::Unit;

/// The content of a part file.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A surface mesh.
    Mesh(Mesh),
    /// Points of the surface.
    Points(OrientedPoints),
}

/// Reasons why a file could not be read.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// The file system refused to read the file.
    #[error("cannot read {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file name.
        file: String,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The format is not recognised.
    #[error(
        "{file} is of no known format: read are meshes in STL, PLY and OBJ (`.stl`, `.ply`, \
         `.obj`) and points in PLY, PCD and tables of x y z (`.pcd`, `.xyz`, `.txt`, `.asc`, `.pts`, `.csv`): convert the part to one of these"
    )]
    Unknown {
        /// The file name.
        file: String,
    },
    /// The file is not a valid STL file.
    #[error(transparent)]
    Stl(#[from] StlError),
    /// The file is not a valid PLY file.
    #[error(transparent)]
    Ply(#[from] PlyError),
    /// The file is not a valid OBJ file.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// The file is not a valid cloud of points in PCD or XYZ.
    #[error(transparent)]
    Points(#[from] PointsError),
}

crate::debug_as_sentence!(GeometryError);

/// The extensions of tables of points.
const TABLES: [&str; 5] = ["xyz", "txt", "asc", "pts", "csv"];

impl Geometry {
    /// Reads a file whose lengths are in `unit`. A file that begins with `ply` is read as PLY; otherwise the file
    /// extension decides between STL, PLY, OBJ, PCD and XYZ. PLY with faces is a mesh, PLY without faces is points.
    ///
    /// # Errors
    /// Every defect of the file is reported with the file name and the location.
    pub fn read(path: impl AsRef<Path>, unit: Unit) -> Result<Geometry, GeometryError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        match input::read_regular_file(path, FileKind::Geometry) {
            Ok(bytes) => Geometry::from_bytes(&bytes, &file, unit),
            Err(source) => Err(GeometryError::Unreadable { file, source }),
        }
    }

    /// Reads a file already in memory, like [`Geometry::read`]; `name` is its file name. No input makes
    /// this function panic.
    ///
    /// # Errors
    /// See [`Geometry::read`].
    pub fn from_bytes(bytes: &[u8], name: &str, unit: Unit) -> Result<Geometry, GeometryError> {
        let extension = Path::new(name).extension().unwrap_or_default();
        let has_extension = |known: &str| extension.eq_ignore_ascii_case(known);
        // PLY alone has a beginning that nothing else has. STL may be anything, and OBJ any text.
        Ok(if ply::begins(bytes) || has_extension("ply") {
            match ply::has_faces(bytes, name)? {
                true => Geometry::Mesh(Mesh::from_ply(bytes, name, unit)?),
                false => Geometry::Points(OrientedPoints::from_ply(bytes, name)?),
            }
        } else if has_extension("stl") {
            Geometry::Mesh(Mesh::from_stl(bytes, name, unit)?)
        } else if has_extension("obj") {
            Geometry::Mesh(Mesh::from_obj(bytes, name, unit)?)
        } else if has_extension("pcd") {
            Geometry::Points(OrientedPoints::from_pcd(bytes, name)?)
        } else if TABLES.iter().any(|table| has_extension(table)) {
            Geometry::Points(OrientedPoints::from_xyz(bytes, name)?)
        } else {
            return Err(GeometryError::Unknown { file: name.to_owned() });
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Unit = Unit::Millimetre;

    fn refusal(bytes: &[u8], name: &str) -> String {
        Geometry::from_bytes(bytes, name, UNIT).expect_err("it should be refused").to_string()
    }

    #[test]
    fn detects_the_format_by_content_and_extension() {
        let triangle = Geometry::from_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "a.OBJ", UNIT);
        let Ok(Geometry::Mesh(mesh)) = triangle else { panic!("{triangle:?}") };
        let mut stl = Vec::new();
        mesh.write_stl(&mut stl).expect("written");
        assert_eq!(Geometry::from_bytes(&stl, "a.stl", UNIT).expect("STL"), Geometry::Mesh(mesh));

        let xyz = "property float x\nproperty float y\nproperty float z\n";
        let normal = "property float nx\nproperty float ny\nproperty float nz\n";
        let header = format!("ply\nformat ascii 1.0\nelement vertex 3\n{xyz}");
        let list = "element face 1\nproperty list uchar int vertex_index\n";
        let mesh = format!("{header}{list}end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        let points = format!("{header}{normal}end_header\n{}", "0 0 0 0 0 1\n".repeat(3));
        let read = Geometry::from_bytes(mesh.as_bytes(), "whatever.stl", UNIT);
        assert!(matches!(read, Ok(Geometry::Mesh(_))), "{read:?}");
        let read = Geometry::from_bytes(points.as_bytes(), "part", UNIT);
        assert!(
            matches!(&read, Ok(Geometry::Points(points)) if points.points.len() == 3),
            "{read:?}"
        );
    }

    #[test]
    fn errors_name_the_supported_formats() {
        let unknown = refusal(b"ISO-10303-21;", "part.step");
        assert!(unknown.contains("part.step is of no known format: read are meshes in STL, PLY"));
        assert!(refusal(b"solid", "part.ply").contains("is no PLY file"));
        assert!(refusal(b"", "part.stl").contains("is empty"));
        assert!(refusal(b"", "part.obj").contains("has no faces"));
        let missing = Geometry::read("no/such/part.ply", UNIT).expect_err("no such file");
        assert!(missing.to_string().contains("cannot read no/such/part.ply"), "{missing}");
    }
}
