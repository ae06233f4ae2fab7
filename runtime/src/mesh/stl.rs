//! Reading and writing STL, binary and ASCII. The crate has its own reader because `stl_io` names no line or
//! triangle in its errors and takes a binary file whose header begins with `solid` for text.

use std::io::{self, Write};

use nalgebra::{Point3, Vector3};

use super::location::{SourceLocation, Tokens, number, printable};
use super::outlier::{Outlier, OutlyingVertex, find_outlier};
use super::{LARGEST_COORDINATE, Mesh, MeshError, area_and_normal, is_valid_coordinate};
use crate::cancellation;

/// Bytes of a binary file before its first triangle: 80 of header, 4 of count.
const HEADER: usize = 84;
/// Bytes per triangle in a binary file: 12 numbers of 4 bytes, 2 bytes of attributes.
const RECORD: usize = 50;

/// Reasons why an STL file could not be read. Lines count from 1, triangles and bytes from 0.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum StlError {
    /// The file system refused to read the file.
    #[error("cannot read {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file name.
        file: String,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The file is empty.
    #[error("{file} is empty: export or copy it again")]
    Empty {
        /// The file name.
        file: String,
    },
    /// The file does not begin with `solid` and is too short to be binary.
    #[error(
        "{file} is no STL file: it has {bytes} bytes, does not begin with `solid` as ASCII STL \
         does, and a binary one has at least {HEADER}: convert the part to STL"
    )]
    NotStl {
        /// The file name.
        file: String,
        /// The file length in bytes.
        bytes: usize,
    },
    /// A binary file ends before its last triangle.
    #[error(
        "{file} is cut off, or not STL: as binary STL its header promises {triangles} triangles \
         = {expected} bytes, but the file has {found}: export or copy it again"
    )]
    Truncated {
        /// The file name.
        file: String,
        /// The number of triangles declared in the header.
        triangles: u32,
        /// The file length that this number requires, in bytes.
        expected: u64,
        /// The number of bytes found.
        found: u64,
    },
    /// A binary file continues after its last triangle.
    #[error(
        "{file} has {found} bytes, but as binary STL its header promises {triangles} triangles = \
         {expected} bytes, and what follows is unknown: export it again, one solid to a file"
    )]
    Trailing {
        /// The file name.
        file: String,
        /// The number of triangles declared in the header.
        triangles: u32,
        /// The file length that this number requires, in bytes.
        expected: u64,
        /// The number of bytes found.
        found: u64,
    },
    /// An ASCII file does not match the grammar.
    #[error(
        "{file}, line {line}: expected {expected}, found `{found}`: mend the line, or export \
             the part again"
    )]
    Expected {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The expected content.
        expected: &'static str,
        /// The word found instead.
        found: String,
    },
    /// An ASCII file ends before its last `endsolid`.
    #[error(
        "{file} ends on line {line}, where {expected} should follow: it was cut off; export \
             or copy it again"
    )]
    UnexpectedEnd {
        /// The file name.
        file: String,
        /// The last line number, from 1.
        line: usize,
        /// The content expected next.
        expected: &'static str,
    },
    /// A coordinate of a vertex in an ASCII file is not finite or too large.
    #[error(
        "{file}, line {line}: the coordinate `{coordinate}` is not a finite number within \
         {LARGEST_COORDINATE:e}: repair the mesh where it was made"
    )]
    LineCoordinate {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The coordinate as written.
        coordinate: String,
    },
    /// A coordinate of a vertex in a binary file is not finite.
    #[error(
        "{file}, triangle {triangle} (from 0), byte {byte}: the coordinate {coordinate} is not a \
         finite number: repair the mesh where it was made"
    )]
    TriangleCoordinate {
        /// The file name.
        file: String,
        /// The triangle's index, from 0.
        triangle: usize,
        /// The byte offset of the coordinate in the file.
        byte: usize,
        /// The coordinate.
        coordinate: f32,
    },
    /// A vertex is far outside the rest of the part.
    #[error(
        "{file}, triangle {triangle} (from 0), {location}: {outlier}: mend the coordinate, or export or copy the part again"
    )]
    Outlier {
        /// The file name.
        file: String,
        /// The triangle's index, from 0.
        triangle: usize,
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

crate::debug_as_sentence!(StlError);

impl Mesh {
    /// Writes the mesh as binary STL, in its own unit, which is named in the header text. Coordinates
    /// are rounded to `f32`, as the format requires.
    ///
    /// # Errors
    /// Returns the errors of `out`, and `InvalidInput` for a coordinate beyond the range of `f32`.
    pub fn write_stl(&self, out: &mut impl Write) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(HEADER + RECORD * self.triangles.len());
        bytes.extend(format!("binary STL in {} by touchoff", self.unit).bytes());
        bytes.resize(80, b' ');
        // `Mesh::new` guarantees that the ids fit 32 bits, and hence their count.
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for corners in self.corners() {
            let normal = area_and_normal(&corners).map_or(Vector3::zeros(), |(_, n)| n);
            for vector in [normal, corners[0].coords, corners[1].coords, corners[2].coords] {
                for &number in vector.iter() {
                    let rounded = number as f32;
                    if !rounded.is_finite() {
                        let text = format!("{number:e} is beyond binary STL: write ASCII instead");
                        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
                    }
                    bytes.extend(rounded.to_le_bytes());
                }
            }
            // No attributes.
            bytes.extend([0, 0]);
        }
        out.write_all(&bytes)
    }

    /// Writes the mesh as ASCII STL, in its own unit, with all digits: reading it again yields bitwise
    /// the same corners.
    ///
    /// # Errors
    /// Returns the errors of `out`.
    pub fn write_stl_ascii(&self, out: &mut impl Write) -> io::Result<()> {
        let mut out = io::BufWriter::new(out);
        writeln!(out, "solid touchoff, in {}", self.unit)?;
        for corners in self.corners() {
            let normal = area_and_normal(&corners).map_or(Vector3::zeros(), |(_, n)| n);
            writeln!(out, "  facet normal {:e} {:e} {:e}", normal.x, normal.y, normal.z)?;
            writeln!(out, "    outer loop")?;
            for p in corners {
                writeln!(out, "      vertex {:e} {:e} {:e}", p.x, p.y, p.z)?;
            }
            writeln!(out, "    endloop\n  endfacet")?;
        }
        writeln!(out, "endsolid touchoff")?;
        out.flush()
    }
}

/// The content of a file: the corners of each facet, in the file's order.
#[derive(Default)]
pub(super) struct StlFacets {
    pub(super) corners: Vec<[Point3<f64>; 3]>,
    pub(super) opposed_normals: usize,
}

impl StlFacets {
    fn push(&mut self, stated_normal: Vector3<f64>, corners: [Point3<f64>; 3]) {
        // The threshold is 120 degrees from the winding's normal. An inaccurate or stale normal
        // is harmless, but one in the opposite direction indicates that the winding may be wrong.
        let norm = stated_normal.norm();
        if let Some((_, normal)) = area_and_normal(&corners)
            && normal.dot(&stated_normal) < -0.5 * norm
        {
            self.opposed_normals += 1;
        }
        self.corners.push(corners);
    }
}

/// Reads a whole file, or returns the reason for its refusal; there is no partial result.
///
/// A file is binary if its length agrees with its count, whatever its header begins with. Otherwise it
/// is text if it begins with `solid` and its first 84 bytes hold no NUL, which the header and count of a
/// binary file nearly always do.
///
/// A vertex far outside all others is refused.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<StlFacets, StlError> {
    let (facets, is_text) = facets(bytes, name)?;
    let outlying = find_outlier(facets.corners.as_flattened());
    let Some(OutlyingVertex { index: corner, axis, outlier }) = outlying else {
        return Ok(facets);
    };
    let triangle = corner / 3;
    let location = if is_text {
        line_of(bytes, corner)
    } else {
        SourceLocation::Byte(HEADER + RECORD * triangle + 4 * (3 + 3 * (corner % 3) + axis))
    };
    Err(StlError::Outlier { file: name.to_owned(), triangle, location, outlier })
}

/// Returns the line of a corner in a valid text file.
fn line_of(bytes: &[u8], corner: usize) -> SourceLocation {
    let mut tokens = Tokens::new(bytes);
    let mut remaining = corner + 1;
    while remaining > 0
        && let Some(word) = tokens.next()
    {
        if word.eq_ignore_ascii_case(b"solid") || word.eq_ignore_ascii_case(b"endsolid") {
            tokens.skip_line();
        }
        remaining -= usize::from(word.eq_ignore_ascii_case(b"vertex"));
    }
    SourceLocation::Line(tokens.line)
}

/// Reads the facets of a file and returns them with `true` if the file is text.
fn facets(bytes: &[u8], name: &str) -> Result<(StlFacets, bool), StlError> {
    let file = name.to_owned();
    if bytes.is_empty() {
        return Err(StlError::Empty { file });
    }
    let binary = bytes.split_first_chunk::<HEADER>().map(|(header, body)| {
        let count = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
        (count, body)
    });
    let is_text = !bytes.iter().take(HEADER).any(|&byte| byte == 0)
        && Tokens::new(bytes).next().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    match binary {
        Some((triangles, body)) => {
            let expected = RECORD as u64 * u64::from(triangles);
            let found = body.len() as u64;
            // Some programs begin binary files with `solid`, so the length decides first.
            if expected == found {
                return Ok((read_binary(body, name)?, false));
            }
            if is_text {
                return Ok((read_ascii(bytes, name)?, true));
            }
            let (expected, found) = (expected + HEADER as u64, found + HEADER as u64);
            Err(if found < expected {
                StlError::Truncated { file, triangles, expected, found }
            } else {
                StlError::Trailing { file, triangles, expected, found }
            })
        }
        None if is_text => Ok((read_ascii(bytes, name)?, true)),
        None => Err(StlError::NotStl { file, bytes: bytes.len() }),
    }
}

fn read_binary(body: &[u8], name: &str) -> Result<StlFacets, StlError> {
    let mut facets = StlFacets::default();
    let (records, _) = body.as_chunks::<RECORD>();
    for (triangle, record) in records.iter().enumerate() {
        cancellation::check();
        // The attributes have no agreed meaning.
        let (fields, _attributes) = record.as_chunks::<4>();
        let mut numbers = [0f32; 12];
        for (number, field) in numbers.iter_mut().zip(fields) {
            *number = f32::from_le_bytes(*field);
        }
        // A normal that is not finite does no harm: it counts only where it opposes the winding's.
        if let Some(k) = (3..12).find(|&k| !numbers[k].is_finite()) {
            return Err(StlError::TriangleCoordinate {
                file: name.to_owned(),
                triangle,
                byte: HEADER + RECORD * triangle + 4 * k,
                coordinate: numbers[k],
            });
        }
        let [normal, corners @ ..] = [0, 3, 6, 9]
            .map(|k| Vector3::new(numbers[k], numbers[k + 1], numbers[k + 2]).cast::<f64>());
        facets.push(normal, corners.map(Point3::from));
    }
    Ok(facets)
}

fn read_ascii(bytes: &[u8], name: &str) -> Result<StlFacets, StlError> {
    let mut facets = StlFacets::default();
    let mut text = Ascii { tokens: Tokens::new(bytes), name };
    loop {
        // The name of a solid, of any number of words, extends to the end of its line.
        text.keyword("`solid`, or the end of the file", b"solid")?;
        text.tokens.skip_line();
        while text.either("`facet` or `endsolid`", b"facet", b"endsolid")? {
            cancellation::check();
            let (stated_normal, corners) = text.facet()?;
            facets.push(stated_normal, corners);
        }
        text.tokens.skip_line();
        if text.tokens.clone().next().is_none() {
            return Ok(facets);
        }
    }
}

/// A parser for ASCII STL, with one function per phrase of the grammar.
struct Ascii<'a> {
    tokens: Tokens<'a>,
    name: &'a str,
}

impl<'a> Ascii<'a> {
    fn word(&mut self, expected: &'static str) -> Result<&'a [u8], StlError> {
        let word = self.tokens.next();
        word.ok_or_else(|| StlError::UnexpectedEnd {
            file: self.name.to_owned(),
            line: self.tokens.line,
            expected,
        })
    }

    fn unexpected(&self, expected: &'static str, found: &[u8]) -> StlError {
        let (file, line) = (self.name.to_owned(), self.tokens.line);
        StlError::Expected { file, line, expected, found: printable(found) }
    }

    fn keyword(&mut self, expected: &'static str, keyword: &[u8]) -> Result<(), StlError> {
        let word = self.word(expected)?;
        if word.eq_ignore_ascii_case(keyword) {
            Ok(())
        } else {
            Err(self.unexpected(expected, word))
        }
    }

    /// Returns whether the next word is keyword `a`; fails if it is neither `a` nor `b`.
    fn either(&mut self, expected: &'static str, a: &[u8], b: &[u8]) -> Result<bool, StlError> {
        let word = self.word(expected)?;
        let is_a = word.eq_ignore_ascii_case(a);
        if is_a || word.eq_ignore_ascii_case(b) {
            Ok(is_a)
        } else {
            Err(self.unexpected(expected, word))
        }
    }

    /// Reads a number and returns it with its word.
    fn number(&mut self, expected: &'static str) -> Result<(f64, &'a [u8]), StlError> {
        let word = self.word(expected)?;
        let number = number(word).ok_or_else(|| self.unexpected(expected, word))?;
        Ok((number, word))
    }

    /// Reads the rest of a facet after its first word.
    fn facet(&mut self) -> Result<(Vector3<f64>, [Point3<f64>; 3]), StlError> {
        self.keyword("`normal`", b"normal")?;
        let mut stated_normal = Vector3::zeros();
        for component in stated_normal.iter_mut() {
            *component = self.number("a number of the facet's normal")?.0;
        }
        self.keyword("`outer loop`", b"outer")?;
        self.keyword("`loop` after `outer`", b"loop")?;
        let mut corners = [Point3::origin(); 3];
        for corner in &mut corners {
            self.keyword("`vertex`: a facet has three", b"vertex")?;
            for coordinate in corner.iter_mut() {
                let (number, word) = self.number("a coordinate, such as 1.5 or 2e-3")?;
                if !is_valid_coordinate(number) {
                    let (file, line) = (self.name.to_owned(), self.tokens.line);
                    let coordinate = printable(word);
                    return Err(StlError::LineCoordinate { file, line, coordinate });
                }
                *coordinate = number;
            }
        }
        self.keyword("`endloop` after three vertices", b"endloop")?;
        self.keyword("`endfacet`", b"endfacet")?;
        Ok((stated_normal, corners))
    }
}
