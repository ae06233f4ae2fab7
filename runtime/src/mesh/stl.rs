//! Reading STL, binary and ASCII. The reader is our own because `stl_io` names no line or triangle in its
//! errors and takes a binary file whose header begins with `solid` for text.

use std::io;

use nalgebra::{Point3, Vector3};

use super::stray::{Stray, stray};
use super::words::{Place, Words, number, shown};
use super::{LARGEST_COORDINATE, MeshError, area_and_normal, coordinate_holds};

/// Bytes of a binary file before its first triangle: 80 of header, 4 of count.
pub(super) const HEADER: usize = 84;
/// Bytes of a triangle in a binary file: 12 numbers, 2 bytes of attributes.
pub(super) const RECORD: usize = 50;

/// Why an STL file could not be read. Lines count from 1, triangles and bytes from 0.
#[derive(Debug, thiserror::Error)]
pub enum StlError {
    /// The file system would not give it.
    #[error("cannot read {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// Not a single byte.
    #[error("{file} is empty: export or copy it again")]
    Empty {
        /// The file.
        file: String,
    },
    /// It does not begin with `solid` and is too short to be binary.
    #[error(
        "{file} is no STL file: it has {bytes} bytes, does not begin with `solid` as ASCII STL \
         does, and a binary one has at least {HEADER}: convert the part to STL"
    )]
    NotStl {
        /// The file.
        file: String,
        /// Its length.
        bytes: usize,
    },
    /// A binary file ends before its last triangle.
    #[error(
        "{file} is cut off, or not STL: as binary STL its header promises {triangles} triangles \
         = {expected} bytes, but the file has {found}: export or copy it again"
    )]
    Truncated {
        /// The file.
        file: String,
        /// How many triangles the header promises.
        triangles: u32,
        /// How many bytes they make.
        expected: u64,
        /// How many bytes there are.
        found: u64,
    },
    /// A binary file goes on after its last triangle.
    #[error(
        "{file} has {found} bytes, but as binary STL its header promises {triangles} triangles = \
         {expected} bytes, and what follows is unknown: export it again, one solid to a file"
    )]
    Trailing {
        /// The file.
        file: String,
        /// How many triangles the header promises.
        triangles: u32,
        /// How many bytes they make.
        expected: u64,
        /// How many bytes there are.
        found: u64,
    },
    /// An ASCII file says something else than it must.
    #[error(
        "{file}, line {line}: expected {expected}, found `{found}`: mend the line, or export \
             the part again"
    )]
    Expected {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// What should stand there.
        expected: &'static str,
        /// The word that does.
        found: String,
    },
    /// An ASCII file ends before its last `endsolid`.
    #[error(
        "{file} ends on line {line}, where {expected} should follow: it was cut off; export \
             or copy it again"
    )]
    Unended {
        /// The file.
        file: String,
        /// The last line.
        line: usize,
        /// What should have followed.
        expected: &'static str,
    },
    /// A vertex of an ASCII file is nowhere.
    #[error(
        "{file}, line {line}: the coordinate `{coordinate}` is not a finite number within \
         {LARGEST_COORDINATE:e}: repair the mesh where it was made"
    )]
    LineCoordinate {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// The coordinate as written.
        coordinate: String,
    },
    /// A vertex of a binary file is nowhere.
    #[error(
        "{file}, triangle {triangle} (from 0), byte {byte}: the coordinate {coordinate} is not a \
         finite number: repair the mesh where it was made"
    )]
    TriangleCoordinate {
        /// The file.
        file: String,
        /// The triangle.
        triangle: usize,
        /// Where in the file the coordinate stands.
        byte: usize,
        /// The coordinate.
        coordinate: f32,
    },
    /// A vertex is far outside the rest of the part.
    #[error(
        "{file}, triangle {triangle} (from 0), {place}: {stray}: mend the coordinate, or export or copy the part again"
    )]
    Stray {
        /// The file.
        file: String,
        /// The triangle.
        triangle: usize,
        /// Where in the file the vertex stands.
        place: Place,
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

/// What a file holds: the corners of each facet, in the file's order.
#[derive(Default)]
pub(super) struct Facets {
    pub(super) corners: Vec<[Point3<f64>; 3]>,
    pub(super) opposed_normals: usize,
}

impl Facets {
    fn push(&mut self, stated: Vector3<f64>, corners: [Point3<f64>; 3]) {
        // More than 120 degrees from the winding's: a careless or stale normal is none of our
        // business, one that points the other way is a sign that the winding may be wrong.
        let norm = stated.norm();
        if let Some((_, normal)) = area_and_normal(&corners)
            && normal.dot(&stated) < -0.5 * norm
        {
            self.opposed_normals += 1;
        }
        self.corners.push(corners);
    }
}

/// Reads a whole file, or says why not; there is no partial result.
///
/// A file is binary when its length is what its count says, whatever its header begins with.
/// Failing that it is text when it begins with `solid` and its first bytes hold no NUL, which a
/// binary file's count nearly always does.
///
/// A vertex far outside all others is refused.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Facets, StlError> {
    let (facets, is_text) = facets(bytes, name)?;
    let Some((corner, axis, stray)) = stray(facets.corners.as_flattened()) else {
        return Ok(facets);
    };
    let triangle = corner / 3;
    let place = if is_text {
        line_of(bytes, corner)
    } else {
        Place::Byte(HEADER + RECORD * triangle + 4 * (3 + 3 * (corner % 3) + axis))
    };
    Err(StlError::Stray { file: name.to_owned(), triangle, place, stray })
}

/// The line of a corner of a sound text.
fn line_of(bytes: &[u8], corner: usize) -> Place {
    let mut words = Words::new(bytes);
    let mut left = corner + 1;
    while left > 0
        && let Some(word) = words.next()
    {
        if word.eq_ignore_ascii_case(b"solid") || word.eq_ignore_ascii_case(b"endsolid") {
            words.skip_line();
        }
        left -= usize::from(word.eq_ignore_ascii_case(b"vertex"));
    }
    Place::Line(words.line)
}

/// The facets of a file, and whether it is text.
fn facets(bytes: &[u8], name: &str) -> Result<(Facets, bool), StlError> {
    let file = || name.to_owned();
    if bytes.is_empty() {
        return Err(StlError::Empty { file: file() });
    }
    let binary = bytes.split_first_chunk::<HEADER>().map(|(header, body)| {
        let count = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
        (count, body)
    });
    let is_text = !bytes.iter().take(HEADER).any(|&byte| byte == 0)
        && Words::new(bytes).next().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    match binary {
        Some((triangles, body)) => {
            let expected = RECORD as u64 * u64::from(triangles);
            let found = body.len() as u64;
            if expected == found {
                return Ok((read_binary(body, name)?, false));
            }
            if is_text {
                return Ok((read_ascii(bytes, name)?, true));
            }
            let (expected, found) = (expected + HEADER as u64, found + HEADER as u64);
            Err(if found < expected {
                StlError::Truncated { file: file(), triangles, expected, found }
            } else {
                StlError::Trailing { file: file(), triangles, expected, found }
            })
        }
        None if is_text => Ok((read_ascii(bytes, name)?, true)),
        None => Err(StlError::NotStl { file: file(), bytes: bytes.len() }),
    }
}

fn read_binary(body: &[u8], name: &str) -> Result<Facets, StlError> {
    let mut facets = Facets::default();
    let (records, _) = body.as_chunks::<RECORD>();
    for (triangle, record) in records.iter().enumerate() {
        let (words, _attributes) = record.as_chunks::<4>();
        let mut numbers = [0f32; 12];
        for (number, word) in numbers.iter_mut().zip(words) {
            *number = f32::from_le_bytes(*word);
        }
        if let Some(k) = (3..12).find(|&k| !numbers[k].is_finite()) {
            return Err(StlError::TriangleCoordinate {
                file: name.to_owned(),
                triangle,
                byte: HEADER + RECORD * triangle + 4 * k,
                coordinate: numbers[k],
            });
        }
        let point = |k: usize| Vector3::new(numbers[k], numbers[k + 1], numbers[k + 2]).cast();
        facets.push(point(0), [3, 6, 9].map(|k| point(k).into()));
    }
    Ok(facets)
}

fn read_ascii(bytes: &[u8], name: &str) -> Result<Facets, StlError> {
    let mut facets = Facets::default();
    let mut text = Ascii { words: Words::new(bytes), name };
    loop {
        // The name of a solid, of any words or none, runs to the end of its line.
        text.keyword("`solid`, or the end of the file", b"solid")?;
        text.words.skip_line();
        while text.either("`facet` or `endsolid`", b"facet", b"endsolid")? {
            let (stated, corners) = text.facet()?;
            facets.push(stated, corners);
        }
        text.words.skip_line();
        if text.words.clone().next().is_none() {
            return Ok(facets);
        }
    }
}

/// The grammar of ASCII STL, one function for each of its phrases.
struct Ascii<'a> {
    words: Words<'a>,
    name: &'a str,
}

impl<'a> Ascii<'a> {
    fn word(&mut self, expected: &'static str) -> Result<&'a [u8], StlError> {
        let word = self.words.next();
        word.ok_or_else(|| StlError::Unended {
            file: self.name.to_owned(),
            line: self.words.line,
            expected,
        })
    }

    fn unexpected(&self, expected: &'static str, found: &[u8]) -> StlError {
        let (file, line) = (self.name.to_owned(), self.words.line);
        StlError::Expected { file, line, expected, found: shown(found) }
    }

    fn keyword(&mut self, expected: &'static str, keyword: &[u8]) -> Result<(), StlError> {
        let word = self.word(expected)?;
        if word.eq_ignore_ascii_case(keyword) {
            Ok(())
        } else {
            Err(self.unexpected(expected, word))
        }
    }

    /// Whether the first of two keywords is next; an error when neither is.
    fn either(&mut self, expected: &'static str, a: &[u8], b: &[u8]) -> Result<bool, StlError> {
        let word = self.word(expected)?;
        let is_a = word.eq_ignore_ascii_case(a);
        if is_a || word.eq_ignore_ascii_case(b) {
            Ok(is_a)
        } else {
            Err(self.unexpected(expected, word))
        }
    }

    /// A number, with the word that it is.
    fn number(&mut self, expected: &'static str) -> Result<(f64, &'a [u8]), StlError> {
        let word = self.word(expected)?;
        let number = number(word).ok_or_else(|| self.unexpected(expected, word))?;
        Ok((number, word))
    }

    /// The rest of a facet after its first word.
    fn facet(&mut self) -> Result<(Vector3<f64>, [Point3<f64>; 3]), StlError> {
        self.keyword("`normal`", b"normal")?;
        let mut stated = Vector3::zeros();
        for component in stated.iter_mut() {
            *component = self.number("a number of the facet's normal")?.0;
        }
        self.keyword("`outer loop`", b"outer")?;
        self.keyword("`loop` after `outer`", b"loop")?;
        let mut corners = [Point3::origin(); 3];
        for corner in &mut corners {
            self.keyword("`vertex`: a facet has three", b"vertex")?;
            for coordinate in corner.iter_mut() {
                let (number, word) = self.number("a coordinate, such as 1.5 or 2e-3")?;
                if !coordinate_holds(number) {
                    let (file, line) = (self.name.to_owned(), self.words.line);
                    let coordinate = shown(word);
                    return Err(StlError::LineCoordinate { file, line, coordinate });
                }
                *coordinate = number;
            }
        }
        self.keyword("`endloop` after three vertices", b"endloop")?;
        self.keyword("`endfacet`", b"endfacet")?;
        Ok((stated, corners))
    }
}
