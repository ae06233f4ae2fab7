//! Reading OBJ. The crate has its own reader because `tobj` names no line in its errors, panics on an
//! index such as `1/-9`, and gives every group its own vertices.

use nalgebra::Point3;

use super::faces::Faces;
use super::location::{SourceLocation, Tokens, number, printable};
use super::outlier::Outlier;
use super::{LARGEST_COORDINATE, Mesh, MeshError, is_valid_coordinate};
use crate::cancellation;
use crate::unit::Unit;

/// Reasons why an OBJ file could not be read. Lines count from 1.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum ObjError {
    /// A line does not match the grammar.
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
        expected: &'static str,
        /// The content found instead.
        found: String,
    },
    /// A line may describe surface geometry in an unsupported form.
    #[error(
        "{file}, line {line}: `{word}` is not read and may be a part of the surface: export the part as faces, \
         `f` lines"
    )]
    Unread {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The first word of the line.
        word: String,
    },
    /// A coordinate of a vertex is not finite or too large.
    #[error(
        "{file}, line {line}: the coordinate `{coordinate}` is not a finite number within \
         {LARGEST_COORDINATE:e}: repair the mesh where it was made"
    )]
    Coordinate {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The coordinate as written.
        coordinate: String,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "{file}, line {line}: the face names vertex {index}, but {vertices} come before it: \
         vertices count from 1, or back from -1; export the part again"
    )]
    Index {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The vertex index in the face.
        index: i64,
        /// The number of vertices before the face.
        vertices: usize,
    },
    /// No triangles between the corners of a polygon fill it.
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
    /// The file has no faces.
    #[error(
        "{file} has no faces, lines such as `f 1 2 3`: it is no OBJ file, or it holds points or \
         curves only: export the part as a mesh"
    )]
    NoFaces {
        /// The file name.
        file: String,
    },
    /// A vertex is far outside the rest of the part.
    #[error("{file}, {location}: {outlier}: mend the coordinate, or export or copy the part again")]
    Outlier {
        /// The file name.
        file: String,
        /// The location of the vertex in the file.
        location: SourceLocation,
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

crate::debug_as_sentence!(ObjError);

/// Keywords whose lines hold no surface: attributes of vertices, points and lines, names, materials, and
/// the shading of faces.
const SKIPPED: [&[u8]; 13] = [
    b"vn", b"vt", b"vp", b"p", b"l", b"o", b"g", b"s", b"mg", b"mtllib", b"usemtl", b"usemap",
    b"maplib",
];

impl Mesh {
    /// Reads the faces of an OBJ file as a mesh, whose numbers are in `unit` (OBJ states none). Errors
    /// name the file as `name`. No input makes this function panic.
    ///
    /// The reader uses the lines `v` and `f`, skips names, materials and attributes, and refuses any
    /// other line, such as a free-form surface. Indices may count from 1, or back from -1, with or
    /// without `/vt/vn`. Objects, groups and materials all become one mesh. Polygons and equal corners
    /// are treated as in [`Mesh::from_ply`]. The format does not declare the number of its elements, so
    /// a file that was cut off between faces shows as a leak in the [diagnostics](Mesh::diagnostics).
    ///
    /// # Errors
    /// See [`ObjError`].
    pub fn from_obj(bytes: &[u8], name: &str, unit: Unit) -> Result<Mesh, ObjError> {
        let file = name.to_owned();
        let mut lines = Lines { tokens: Tokens::new(bytes), name };
        let mut vertices = Vec::new();
        let mut faces = Faces::default();
        let mut corners = Vec::new();
        while lines.next() {
            cancellation::check();
            match lines.word() {
                Some(b"v") => vertices.push(lines.vertex()?),
                Some(b"f") => {
                    let location = SourceLocation::Line(lines.tokens.line);
                    lines.face(vertices.len(), &mut corners)?;
                    faces.push(location, &corners);
                }
                Some(word) if !SKIPPED.contains(&word) => {
                    let (line, word) = (lines.tokens.line, printable(word));
                    return Err(ObjError::Unread { file, line, word });
                }
                _ => {}
            }
            lines.tokens.skip_line();
        }
        if faces.is_empty() {
            return Err(ObjError::NoFaces { file });
        }
        if let Some(location) = faces.fill(&vertices) {
            return Err(ObjError::Folded { file, location });
        }
        if let Some((vertex, outlier)) = faces.outlier(&vertices) {
            // No lines are kept for vertices, so the file is read once more.
            return Err(ObjError::Outlier { file, location: line_of(bytes, vertex), outlier });
        }
        let mesh = faces.weld(&vertices, unit);
        mesh.map_err(|source| ObjError::Mesh { file, source })
    }
}

/// Returns the line of a vertex in a valid file.
fn line_of(bytes: &[u8], vertex: usize) -> SourceLocation {
    let mut lines = Lines { tokens: Tokens::new(bytes), name: "" };
    let mut remaining = vertex + 1;
    while lines.next() {
        remaining -= usize::from(lines.word() == Some(b"v"));
        if remaining == 0 {
            break;
        }
        // A line may continue after a `\`, so read all of its words before skipping the rest.
        while lines.word().is_some() {}
        lines.tokens.skip_line();
    }
    SourceLocation::Line(lines.tokens.line)
}

/// The lines of a file. A line may continue after a `\` and end in a comment.
struct Lines<'a, 'n> {
    tokens: Tokens<'a>,
    name: &'n str,
}

impl<'a> Lines<'a, '_> {
    /// Advances to the next line and returns whether there is one.
    fn next(&mut self) -> bool {
        self.tokens.skip_space();
        !self.tokens.rest.is_empty()
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            let word = self.tokens.next_on_line()?;
            if word.starts_with(b"#") {
                self.tokens.skip_line();
                return None;
            }
            let Some(head) = word.strip_suffix(b"\\") else {
                return Some(word);
            };
            self.tokens.skip_space();
            if !head.is_empty() {
                return Some(head);
            }
        }
    }

    fn expected(&self, expected: &'static str, found: Option<&[u8]>) -> ObjError {
        let found =
            found.map_or("the end of the line".to_owned(), |w| format!("`{}`", printable(w)));
        ObjError::Expected { file: self.name.to_owned(), line: self.tokens.line, expected, found }
    }

    /// Reads the coordinates after `v`. A weight or a colour may follow them; it does not affect the position.
    fn vertex(&mut self) -> Result<Point3<f64>, ObjError> {
        let expected = "a coordinate, such as 1.5 or 2e-3";
        let mut vertex = Point3::origin();
        for coordinate in vertex.iter_mut() {
            let word = self.word().ok_or_else(|| self.expected(expected, None))?;
            *coordinate = number(word).ok_or_else(|| self.expected(expected, Some(word)))?;
            if !is_valid_coordinate(*coordinate) {
                let (file, line) = (self.name.to_owned(), self.tokens.line);
                return Err(ObjError::Coordinate { file, line, coordinate: printable(word) });
            }
        }
        Ok(vertex)
    }

    /// Reads the corners after `f` and checks them against the `vertices` read before.
    fn face(&mut self, vertices: usize, corners: &mut Vec<u32>) -> Result<(), ObjError> {
        let expected = "a corner such as 7, 7/1 or 7//2: a face has three or more";
        corners.clear();
        while let Some(word) = self.word() {
            // Texture and normal follow the vertex after slashes.
            let vertex = word.split(|&byte| byte == b'/').next().unwrap_or_default();
            let index = str::from_utf8(vertex).ok().and_then(|text| text.parse::<i64>().ok());
            let index = index.ok_or_else(|| self.expected(expected, Some(word)))?;
            // An index below 0 counts back from the vertex read last.
            let corner = match index {
                0 => None,
                1.. => usize::try_from(index - 1).ok(),
                ..0 => usize::try_from(index.unsigned_abs())
                    .ok()
                    .and_then(|back| vertices.checked_sub(back)),
            };
            let valid = corner.filter(|&corner| corner < vertices);
            corners.push(valid.and_then(|corner| u32::try_from(corner).ok()).ok_or_else(|| {
                let (file, line) = (self.name.to_owned(), self.tokens.line);
                ObjError::Index { file, line, index, vertices }
            })?);
        }
        if corners.len() < 3 {
            return Err(self.expected(expected, None));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::TriangleId;
    use crate::mesh::shapes;
    use crate::mesh::tests::damaged;
    use rand_core::SeedableRng;

    const UNIT: Unit = Unit::Millimetre;
    const TRIANGLE: &str = "v 0 0 0\nv .5 0 0 1.0\nv 0 2. 1e-1 0.1 0.2 0.3\nf 1 2 3\n";

    fn cuboid() -> Mesh {
        let high = Point3::new(1.0, 2.5, 4.0);
        shapes::cuboid(Point3::origin(), high, UNIT).expect("a cuboid")
    }

    fn cuboid_file() -> String {
        let mut text = "# a cuboid\nmtllib a.mtl\no cuboid\n".to_owned();
        let mesh = cuboid();
        mesh.vertices().iter().for_each(|v| text += &format!("v {} {} {}\n", v.x, v.y, v.z));
        text += "vn 0 0 1\nvt 0 0\n";
        for (id, &[a, b, c]) in mesh.triangles().iter().enumerate() {
            // Vertex k is also the one k - 8 from the end.
            text += &match id % 4 {
                0 => format!("g side{id}\nf {} {} {}\n", a + 1, b + 1, c + 1),
                1 => format!("f {}/1 {}/1 {}/1\n", a + 1, b + 1, c + 1),
                2 => format!("f {}//1 {}//1 {}//1 # turned\n", a + 1, b + 1, c + 1),
                _ => format!("usemtl m\nf -{}/1/1 -{}/1/1 \\\n-{}/1/1\n", 8 - a, 8 - b, 8 - c),
            };
        }
        text
    }

    fn refusal(bytes: impl AsRef<[u8]>) -> String {
        let refused = Mesh::from_obj(bytes.as_ref(), "part.obj", UNIT);
        refused.expect_err("it should be refused").to_string()
    }

    /// A line that may describe surface geometry is refused, not skipped.
    #[test]
    fn rejects_unsupported_surfaces() {
        let faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        for word in ["fo 1 2 3", "F 1 2 3", "surf 0 1 0 1 1 2 3", "call other.obj", "curv 0 1 1 2"]
        {
            let text = format!("{faces}{word}\n");
            let result = Mesh::from_obj(text.as_bytes(), "a.obj", Unit::Millimetre);
            let message = result.expect_err(word).to_string();
            assert!(message.starts_with("a.obj, line 5: `"), "{message}");
        }
        let text = format!("mtllib a\no b\ng c\ns 1\nusemtl d\n{faces}l 1 2\np 1\n");
        assert!(Mesh::from_obj(text.as_bytes(), "a.obj", Unit::Millimetre).is_ok());
    }

    #[test]
    fn reads_a_solid() {
        let text = cuboid_file();
        for text in [text.clone(), text.replace('\n', "\r\n"), text.replace('\n', "\r")] {
            let mesh = Mesh::from_obj(text.as_bytes(), "", UNIT).expect("a cuboid");
            assert!(
                mesh.diagnostics().is_solid() && mesh.vertices().len() == 8,
                "{}",
                mesh.diagnostics()
            );
            assert!(mesh.corners().eq(cuboid().corners()));
        }
        let latin = [b"# caf\xE9\n", TRIANGLE.as_bytes()].concat();
        let mesh = Mesh::from_obj(&latin, "", UNIT).expect("Latin-1 in a comment");
        assert_eq!(mesh.triangle(TriangleId(0))[2], Point3::new(0.0, 2.0, 0.1));
    }

    #[test]
    fn polygons_are_filled_or_refused() {
        let with = |face: &str| {
            format!("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 .5 0\nv 0 2 0\nf {face}\nf 1 2 5\n")
        };
        let mesh = Mesh::from_obj(with("4 5 1 2 3").as_bytes(), "", UNIT).expect("a fan");
        assert_eq!(
            (mesh.triangles().len(), mesh.area(TriangleId(0)) + mesh.area(TriangleId(1))),
            (4, 1.5)
        );
        // Its first corner does not see all of it.
        let mesh = Mesh::from_obj(with("2 3 4 5 1").as_bytes(), "", UNIT).expect("ears");
        assert_eq!((0..3).map(|id| mesh.area(TriangleId(id))).sum::<f64>(), 2.5);
        let folded = refusal(with("1 2 5 3"));
        assert!(folded.contains("part.obj, line 6: the polygon crosses itself"), "{folded}");
    }

    #[test]
    fn errors_name_the_defect_and_the_line() {
        for (original, replacement, expected) in [
            (
                "v .5 0 0 1.0",
                "v .5 0",
                "line 2: expected a coordinate, such as 1.5 or 2e-3, found the",
            ),
            ("v .5", "v 0,5", "line 2: expected a coordinate, such as 1.5 or 2e-3, found `0,5`"),
            ("v .5", "v 1e61", "line 2: the coordinate `1e61` is not a finite"),
            ("v .5", "v -nan(ind)", "line 2: the coordinate `-nan(ind)` is not a finite"),
            (
                "f 1 2 3",
                "f 1 2",
                "line 4: expected a corner such as 7, 7/1 or 7//2: a face has three",
            ),
            ("f 1 2 3", "f", "line 4: expected a corner"),
            ("f 1 2 3", "f 1 2 /3", "line 4: expected a corner such as 7, 7/1 or 7//2: a face has"),
            ("f 1 2 3", "f 1 2 x", "found `x`"),
            ("f 1 2 3", "f 1 2 4", "line 4: the face names vertex 4, but 3 come before it"),
            ("f 1 2 3", "f 1 2 0", "line 4: the face names vertex 0, but 3"),
            ("f 1 2 3", "f 1 2 -4", "line 4: the face names vertex -4, but 3"),
            ("f 1 2 3", "f 1 2 -9223372036854775808", "names vertex -9223372036854775808, but"),
            ("f 1 2 3", "f 1 2 99999999999999999999", "found `99999999999999999999`"),
            ("f 1 2 3", "f 1 2 2", "part.obj: none of the mesh's 1 triangles"),
            ("f 1 2 3", "l 1 2 3", "part.obj has no faces"),
        ] {
            assert!(TRIANGLE.contains(original), "{original}");
            let message = refusal(TRIANGLE.replace(original, replacement));
            assert!(message.contains(expected), "{replacement}: {message}");
        }
        assert!(refusal("").contains("has no faces"));
    }

    #[test]
    fn truncated_files_are_refused_or_leak() {
        let text = cuboid_file();
        let whole = text.trim_end().trim_end_matches("/1").len();
        for length in 0..whole {
            if let Ok(mesh) = Mesh::from_obj(&text.as_bytes()[..length], "", UNIT) {
                assert!(!mesh.diagnostics().is_closed(), "{length}");
            }
        }
    }

    #[test]
    fn damaged_files_do_not_panic() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let words: [&[u8]; 6] = [b"-", b"\\\n", b"/", b"1e400", b"\nf 1 2 3 4\n", b"99999999999"];
        let seed = cuboid_file().into_bytes();
        for _ in 0..5000 {
            let bytes = damaged(&seed, &words, &mut random);
            if let Ok(mesh) = Mesh::from_obj(&bytes, "", UNIT) {
                let diagnostics = mesh.diagnostics();
                assert!(diagnostics.area > 0.0 && diagnostics.area.is_finite(), "{diagnostics:?}");
            }
        }
    }
}
