//! The part: triangles with ids that hold, in a stated unit.
//!
//! A [`Mesh`] is read from an STL file or generated ([`shapes`]); it is correct as data (every
//! index in range, every coordinate finite, some area) but not necessarily a solid. What it is,
//! [`Mesh::survey`] says. Coordinates are the world's, in the mesh's [`Unit`].

pub mod shapes;
mod stl;
mod survey;

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Point3, Vector3};

use crate::Unit;

pub use stl::StlError;
pub use survey::Survey;

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
        match std::fs::read(path) {
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
        bounds(corners.map(|&vertex| &self.vertices[vertex as usize]))
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
    let [low, high] = bounds(corners.iter().flatten());
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
fn bounds<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> [Point3<f64>; 2] {
    let nothing = [f64::INFINITY, f64::NEG_INFINITY].map(|c| Point3::new(c, c, c));
    points.into_iter().fold(nothing, |[low, high], p| [low.inf(p), high.sup(p)])
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
mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};

    const UNIT: Unit = Unit::Millimetre;
    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1.5e-3 0 0\n\
                         vertex 0 2 0\nendloop\nendfacet\n";

    fn binary(header: &str, triangles: &[[f32; 12]]) -> Vec<u8> {
        let mut bytes = format!("{header:80}").into_bytes();
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend(triangle.iter().flat_map(|number| number.to_le_bytes()));
            bytes.extend([0, 0]);
        }
        bytes
    }

    fn one() -> [f32; 12] {
        [0.0, 0.0, 1.0, -0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    }

    fn refusal(bytes: &[u8]) -> String {
        Mesh::from_stl(bytes, "part.stl", UNIT).expect_err("it should be refused").to_string()
    }

    #[test]
    fn refuses_what_is_no_mesh() {
        let [a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
        let of =
            |vertices: &[_], triangles: &[_]| Mesh::new(vertices.into(), triangles.into(), UNIT);
        assert_eq!(of(&[a, b, c], &[]), Err(MeshError::NoTriangle));
        assert_eq!(of(&[a, b, c], &[[0, 1, 1]]), Err(MeshError::NoArea { triangles: 1 }));
        let index = MeshError::Index { triangle: 1, index: 3, vertices: 3 };
        assert_eq!(of(&[a, b, c], &[[0, 1, 2], [0, 3, 1]]), Err(index));
        for odd in [f64::NAN, f64::INFINITY, -1e61] {
            let error = of(&[a, b, Point3::new(0.0, odd, 0.0)], &[[0, 1, 2]]);
            assert!(matches!(error, Err(MeshError::Coordinate { vertex: 2, .. })), "{error:?}");
        }
    }

    #[test]
    fn areas_hold_at_any_scale_and_offset() {
        for (scale, offset) in [
            (1.0, 0.0),
            (1e-9, 0.0),
            (1e9, 0.0),
            (1e-60, 0.0),
            (1e60, 0.0),
            (1.0, 1e9),
            (1e-3, 1e6),
        ] {
            let corner =
                |x: f64, y: f64| Point3::new(offset + scale * x, offset + scale * y, offset);
            let (a, b, c) = (corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0));
            let sliver = corner(0.5, 0.0);
            let mesh =
                Mesh::new(vec![a, b, c, sliver], vec![[0, 1, 3], [0, 1, 2]], UNIT).expect("a mesh");
            assert_eq!((mesh.normal(0), mesh.area(0)), (None, 0.0), "scale {scale}");
            let expected = 0.5 * (b.x - a.x) * (c.y - a.y);
            assert!((mesh.area(1) / expected - 1.0).abs() < 1e-15, "scale {scale}");
            assert_eq!(mesh.normal(1), Some(Vector3::z()), "scale {scale}");
        }
    }

    #[test]
    fn reads_ascii_in_every_dress() {
        let plain = format!("solid a part\n{FACET}endsolid a part\n");
        let expected = Mesh::from_stl(plain.as_bytes(), "", UNIT).expect("plain");
        assert_eq!(expected.triangle(0)[1], Point3::new(1.5e-3, 0.0, 0.0));
        for text in [
            format!("solid\n{FACET}endsolid"),
            plain.to_uppercase(),
            plain.replace('\n', "\r\n"),
            plain.replace('\n', "\r"),
            format!("\u{feff}\n\t{plain}"),
            plain.replace("normal 0 0 1", "normal nan -nan(ind) 1.#QNAN"),
            plain.replace("1.5e-3", "+.0015").replace('2', "2."),
        ] {
            assert_eq!(Mesh::from_stl(text.as_bytes(), "", UNIT).expect(&text), expected);
        }
        let mut latin = plain.clone().into_bytes();
        latin[6] = 0xE9;
        assert_eq!(Mesh::from_stl(&latin, "", UNIT).expect("Latin-1 in the name"), expected);
        let two = Mesh::from_stl(plain.repeat(2).as_bytes(), "", UNIT).expect("two solids");
        assert_eq!((two.triangles().len(), two.vertices().len()), (2, 3));
    }

    #[test]
    fn says_what_is_wrong_with_ascii_and_where() {
        let file = |facet: &str| format!("solid x\n{facet}endsolid x\n");
        for (change, into, line, says) in [
            ("facet n", "face n", 2, "`endsolid`, found `face`"),
            ("normal", "norm", 2, "`normal`, found `norm`"),
            ("0 0 1", "0 0 ?", 2, "a number of the facet's"),
            ("outer", "inner", 3, "expected `outer loop`"),
            (" loop", "", 4, "expected `loop` after"),
            ("0 2 0", "0 2", 7, "expected a coordinate"),
            ("0 2 0", "0 2,5 0", 6, "found `2,5`"),
            ("endloop", "vertex", 7, "`endloop` after three"),
            ("vertex 0 2 0\n", "", 6, "a facet has three"),
            ("endfacet", "end", 8, "expected `endfacet`"),
            ("0 2 0", "0 inf 0", 6, "`inf` is not a finite"),
            ("0 2 0", "0 1e999 0", 6, "`1e999` is not"),
        ] {
            let message = refusal(file(&FACET.replace(change, into)).as_bytes());
            let place = format!("part.stl, line {line}: ");
            assert!(message.starts_with(&place), "{into}: {message}");
            assert!(message.contains(says), "{into}: {message}");
        }
        let more = refusal((file(FACET) + "more").as_bytes());
        assert!(more.contains("line 10: expected `solid`, or the end of"));
        let cut = refusal(format!("solid x\n{FACET}").as_bytes());
        assert!(cut.contains("ends on line 9, where `facet` or `endsolid` should"));
        assert!(refusal(b"solid").contains("cut off"));
        assert!(refusal(file("").as_bytes()).contains("no triangle"));
        let flat = refusal(file(&FACET.replace('2', "0")).as_bytes());
        assert!(flat.contains("none of the mesh's 1 triangles"));
    }

    #[test]
    fn says_what_is_wrong_with_binary_and_where() {
        let whole = binary("solid by a CAD system", &[one(), one()]);
        let mesh = Mesh::from_stl(&whole, "", UNIT).expect("binary, whatever its header");
        assert_eq!((mesh.triangles().len(), mesh.vertices().len()), (2, 3));

        assert!(refusal(&[]).contains("part.stl is empty"));
        assert!(refusal(b"ply\nformat").contains("is no STL file: it has 10 bytes"));
        let cut = refusal(&whole[..150]);
        assert!(cut.contains("2 triangles = 184 bytes, but the file has 150"), "{cut}");
        let longer = refusal(&[&whole[..], b"!"].concat());
        assert!(longer.contains("has 185 bytes") && longer.contains("= 184 bytes"), "{longer}");
        let mut odd = one();
        odd[7] = f32::NAN;
        let odd = refusal(&binary("", &[one(), odd]));
        assert!(odd.contains("triangle 1 (from 0), byte 162: the coordinate NaN"), "{odd}");
        assert!(refusal(&binary("", &[])).contains("no triangle"));
        assert!(refusal(&binary("", &[[1.0; 12]])).contains("none of the mesh's 1 triangles"));
        let missing = Mesh::read_stl("no/such/part.stl", UNIT).expect_err("no such file");
        assert!(missing.to_string().contains("cannot read no/such/part.stl"), "{missing}");
    }

    #[test]
    fn welds_what_only_noise_tells_apart() {
        let mut noisy = one();
        noisy[3..6].copy_from_slice(&[1e-17, 0.0, -3e-16]);
        let [mut far, mut fine] = [one(); 2];
        (far[6], fine[3]) = (1.0 + f32::EPSILON, 1e-9);
        let read = |triangles: &[_]| Mesh::from_stl(&binary("", triangles), "", UNIT);
        let mesh = read(&[one(), noisy, far, fine]).expect("a mesh");
        assert_eq!(mesh.triangles()[1], [0, 1, 2], "-0, 0 and 1e-17 are one");
        assert_eq!(mesh.triangles()[2..], [[0, 3, 2], [4, 1, 2]]);
    }

    #[test]
    fn survives_any_bytes() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
        let text = format!("solid\n{}endsolid\n", FACET.repeat(2)).into_bytes();
        let words: [&[u8]; 6] = [b"endfacet", b"solid", b"\r\n", b"1e400", b"vertex", b"\0"];
        for seed in [binary("", &[one(), one()]), binary("solid", &[one()]), text, vec![0; 90]] {
            for _ in 0..5000 {
                let mut bytes = seed.clone();
                for _ in 0..1 + below(4) {
                    let at = below(bytes.len());
                    match below(4) {
                        0 => bytes[at] = below(256) as u8,
                        1 => bytes[at] ^= 1 << below(8),
                        2 => bytes.truncate(at.max(1)),
                        _ => drop(bytes.splice(at..at, words[below(6)].iter().copied())),
                    }
                }
                if let Ok(mesh) = Mesh::from_stl(&bytes, "", UNIT) {
                    let survey = mesh.survey();
                    assert!(survey.area > 0.0 && survey.area.is_finite(), "{survey:?}");
                    assert!(!survey.to_string().is_empty());
                }
            }
        }
    }

    #[test]
    fn reads_the_real_parts() {
        let parts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/parts");
        if !parts.is_dir() {
            eprintln!("skipped: {} is absent", parts.display());
            return;
        }
        // The areas are from an independent reading of the files.
        for (file, unit, triangles, area) in [
            ("thesis_tube.stl", Unit::Millimetre, 9_216, 759.6236125024762),
            ("impeller.stl", Unit::Millimetre, 52_872, 12_995.440601326354),
            ("featuretype_inch.stl", Unit::Inch, 3_476, 53.82738611818216),
            ("octagonal_pocket_metre.stl", Unit::Metre, 3_262, 0.07482245333956647),
            ("kiri_pocket_test.stl", Unit::Millimetre, 28, 28_480.0),
        ] {
            let mesh = Mesh::read_stl(parts.join(file), unit).expect(file);
            let survey = mesh.survey();
            eprintln!("{file}: {survey}");
            assert_eq!(survey.triangles, triangles, "{file}");
            assert!(survey.solid(), "{file}: {survey}");
            assert!((survey.area / area - 1.0).abs() < 1e-12, "{file}: {}", survey.area);
        }
    }
}
