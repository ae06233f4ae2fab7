//! Tests of reading and refusing PLY.

use super::*;
use crate::id::TriangleId;
use crate::mesh::shapes;
use crate::mesh::tests::damaged;
use rand_core::SeedableRng;

const UNIT: Unit = Unit::Millimetre;
const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];
const XYZ: &str = "property float x\nproperty double y\nproperty float32 z\n";
const CLOUD: &str = "property float x\nproperty float y\nproperty float z\nproperty float nx\n\
                     property float ny\nproperty float nz\nproperty int face\n\
                     property double area\n";

/// A writer of PLY files in any encoding.
struct Writer {
    encoding: &'static str,
    bytes: Vec<u8>,
}

impl Writer {
    fn new(encoding: &'static str, header: &str) -> Writer {
        let head = format!("ply\nformat {encoding} 1.0\ncomment made up\n{header}end_header\n");
        Writer { encoding, bytes: head.into_bytes() }
    }

    fn put<const N: usize>(&mut self, value: &impl ToString, little: [u8; N], big: [u8; N]) {
        match self.encoding {
            "ascii" => self.bytes.extend(format!("{} ", value.to_string()).bytes()),
            "binary_big_endian" => self.bytes.extend(big),
            _ => self.bytes.extend(little),
        }
    }

    fn u8(&mut self, value: u8) {
        self.put(&value, [value], [value]);
    }

    fn i32(&mut self, value: i32) {
        self.put(&value, value.to_le_bytes(), value.to_be_bytes());
    }

    fn f32(&mut self, value: f32) {
        self.put(&value, value.to_le_bytes(), value.to_be_bytes());
    }

    fn f64(&mut self, value: f64) {
        self.put(&value, value.to_le_bytes(), value.to_be_bytes());
    }

    fn end_line(&mut self) {
        if self.encoding == "ascii" {
            self.bytes.push(b'\n');
        }
    }
}

fn cuboid() -> Mesh {
    let high = Point3::new(1.0, 2.5, 4.0);
    shapes::cuboid(Point3::origin(), high, UNIT).expect("a cuboid")
}

/// Returns the cuboid among elements and properties that are not requested.
fn mesh_file(encoding: &'static str) -> Vec<u8> {
    let header = format!(
        "element camera 2\nproperty list uchar short view\nelement vertex 8\n{XYZ}property uchar \
         red\nelement edge 0\nproperty int a\nelement face 12\nproperty int8 flag\nproperty list \
         uchar int vertex_indices\nproperty list uint8 double texcoord\n"
    );
    let mut file = Writer::new(encoding, &header);
    for _ in 0..2 {
        file.u8(1);
        file.put(&7, 7i16.to_le_bytes(), 7i16.to_be_bytes());
        file.end_line();
    }
    let mesh = cuboid();
    for vertex in mesh.vertices() {
        file.f32(vertex.x as f32);
        file.f64(vertex.y);
        file.f32(vertex.z as f32);
        file.u8(255);
        file.end_line();
    }
    for triangle in mesh.triangles() {
        file.u8(9);
        file.u8(3);
        triangle.iter().for_each(|&vertex| file.i32(vertex.cast_signed()));
        file.u8(1);
        file.f64(0.5);
        file.end_line();
    }
    file.bytes
}

fn cloud_file(encoding: &'static str, points: &[([f32; 6], i32, f64)]) -> Vec<u8> {
    let header = format!("element vertex {}\n{CLOUD}element face 0\n", points.len());
    let mut file = Writer::new(encoding, &header);
    for (numbers, face, area) in points {
        numbers.iter().for_each(|&number| file.f32(number));
        file.i32(*face);
        file.f64(*area);
        file.end_line();
    }
    file.bytes
}

/// Returns a triangle in ASCII with `original` replaced by `replacement` in its header or body.
fn ascii(original: &str, replacement: &str) -> String {
    let file = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\n{XYZ}element face 1\nproperty list uchar int \
         vertex_index\nend_header\n0 0 0\n.5 0 0\n0 2. 1e-1\n3 0 1 2\n"
    );
    assert!(file.contains(original));
    file.replacen(original, replacement, 1)
}

fn refusal(bytes: impl AsRef<[u8]>) -> String {
    let refused = Mesh::from_ply(bytes.as_ref(), "part.ply", UNIT);
    refused.expect_err("it should be refused").to_string()
}

fn cloud_refusal(bytes: impl AsRef<[u8]>) -> String {
    let refused = OrientedPoints::from_ply(bytes.as_ref(), "part.ply");
    refused.expect_err("it should be refused").to_string()
}

#[test]
fn reads_meshes_in_every_encoding() {
    let expected = cuboid();
    for encoding in ENCODINGS {
        let bytes = mesh_file(encoding);
        assert!(has_faces(&bytes, "").expect("a header"));
        let mesh = Mesh::from_ply(&bytes, "", UNIT).expect(encoding);
        assert!(mesh.diagnostics().is_solid(), "{encoding}: {}", mesh.diagnostics());
        assert!(mesh.corners().eq(expected.corners()), "{encoding}");
        let crlf = String::from_utf8_lossy(&bytes).replace('\n', "\r\n").into_bytes();
        if encoding == "ascii" {
            assert_eq!(Mesh::from_ply(&crlf, "", UNIT).expect("CR LF"), mesh);
        }
    }
}

#[test]
fn reads_points_in_every_encoding() {
    let points =
        [([1.0, 2.0, 3.0, 0.0, 0.0, 2.0], 7, 0.25), ([0.0, 0.0, 10.0, 3.0, 0.0, 4.0], 0, 0.0)];
    for encoding in ENCODINGS {
        let bytes = cloud_file(encoding, &points);
        assert!(!has_faces(&bytes, "").expect("a header"));
        let read = OrientedPoints::from_ply(&bytes, "").expect(encoding);
        let expected = OrientedPoints {
            points: vec![Point3::new(1.0, 2.0, 3.0), Point3::new(0.0, 0.0, 10.0)],
            normals: vec![Vector3::z(), Vector3::new(0.6, 0.0, 0.8)],
            triangles: Some(vec![TriangleId(7), TriangleId(0)]),
            areas: Some(vec![0.25, 0.0]),
            left_out: 0,
        };
        assert_eq!(read, expected, "{encoding}");
        let text = String::from_utf8_lossy(&bytes).replace(" face\n", " f\n").replace("area", "a");
        if encoding == "ascii" {
            let bare =
                OrientedPoints::from_ply(text.as_bytes(), "").expect("without ids and areas");
            assert_eq!(bare, OrientedPoints { triangles: None, areas: None, ..expected });
        }
    }
}

#[test]
fn reads_ascii_variants() {
    let expected = Mesh::from_ply(ascii("ply", "ply").as_bytes(), "", UNIT).expect("plain");
    assert_eq!(expected.triangle(TriangleId(0))[2], Point3::new(0.0, 2.0, 0.1));
    for text in [
        ascii("ply\n", "ply \nobj_info  \ncomment a b\n"),
        ascii("ply", "ply").replace('\n', "\r"),
        ascii("3 0 1 2\n", "3 0 1 2"),
        ascii("0 0 0", "\n  0\t0 -0.0 "),
        ascii("element vertex", "element nothing 1000000000000000000\nelement vertex"),
    ] {
        let mesh = Mesh::from_ply(text.as_bytes(), "", UNIT).expect(&text);
        assert!(mesh.corners().eq(expected.corners()), "{text}");
    }
    let mut latin = ascii("ply\n", "ply\ncomment caf?\n").into_bytes();
    latin[15] = 0xE9;
    assert_eq!(Mesh::from_ply(&latin, "", UNIT).expect("Latin-1 in a comment"), expected);
}

#[test]
fn binary_body_begins_after_one_line_end() {
    // The first byte after the header could be taken for a part of it.
    for end in ["\n", "\r\n", "\r"] {
        let header = format!("ply\nformat binary_little_endian 1.0\nelement vertex 1\n{CLOUD}");
        let mut bytes = format!("{header}end_header\n").replace('\n', end).into_bytes();
        let x = f32::from_le_bytes([b'\n', b'\r', b'\n', 0x41]);
        bytes.extend([x, 0.0, 0.0, 0.0, 0.0, 1.0].iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend([0; 12]);
        let read = OrientedPoints::from_ply(&bytes, "").expect("a point");
        assert_eq!(read.points, [Point3::new(f64::from(x), 0.0, 0.0)], "{end:?}");
    }
}

#[test]
fn polygons_are_filled_or_refused() {
    let with = |corners: &str, y: f64| {
        format!(
            "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nelement \
             vertex 5\n{XYZ}end_header\n{corners}\n0 0 0\n2 0 0\n2 2 0\n1 {y} 0\n0 2 0\n"
        )
    };
    let mesh = Mesh::from_ply(with("5 0 1 2 3 4", 3.0).as_bytes(), "", UNIT).expect("convex");
    let areas: Vec<f64> = (0..3).map(|id| mesh.area(TriangleId(id))).collect();
    assert_eq!(areas, [2.0, 2.0, 1.0]);
    let hollow = Mesh::from_ply(with("5 3 4 0 1 2", 0.5).as_bytes(), "", UNIT);
    assert_eq!(hollow.expect("seen whole from its first corner").diagnostics().area, 2.5);
    let behind = Mesh::from_ply(with("5 1 2 3 4 0", 0.5).as_bytes(), "", UNIT);
    assert_eq!(behind.expect("cut at its ears").diagnostics().area, 2.5);
    let message = refusal(with("4 0 1 4 2", 0.5));
    assert!(message.starts_with("part.ply, line 10: the polygon crosses itself"), "{message}");
}

/// No corner sees all of a comb, in any of the planes and from either side.
#[test]
fn a_comb_is_cut_at_its_ears() {
    let comb = [(0, 0), (9, 0), (9, 9), (6, 9), (6, 3), (3, 3), (3, 9), (0, 9)];
    for axis in 0..3 {
        for first in 0..8 {
            let corners = |k: usize| {
                let mut point = [1.0, 1.0, 1.0];
                point[(axis + 1) % 3] = f64::from(comb[k].0);
                point[(axis + 2) % 3] = f64::from(comb[k].1);
                format!("{} {} {}\n", point[0], point[1], point[2])
            };
            for turned in [false, true] {
                let order = (0..8).map(|k| (first + if turned { 7 - k } else { k }) % 8);
                let order: String = order.map(|k| format!(" {k}")).collect();
                let rows: String = (0..8).map(corners).collect();
                let file = format!(
                    "ply\nformat ascii 1.0\nelement vertex 8\n{XYZ}element face 1\nproperty list uchar int \
                     vertex_index\nend_header\n{rows}8{order}\n"
                );
                let mesh = Mesh::from_ply(file.as_bytes(), "", UNIT).expect("a comb");
                assert_eq!((mesh.triangles().len(), mesh.diagnostics().area), (6, 63.0));
                let sense = if turned { -1.0 } else { 1.0 };
                let is_turned = |id| mesh.normal(id).is_some_and(|normal| normal[axis] == sense);
                assert!(mesh.ids().all(is_turned), "{axis} {first} {turned}");
            }
        }
    }
}

/// Scanners write points without coordinates where nothing was measured.
#[test]
fn points_without_coordinates_are_left_out() {
    let nan = f32::NAN;
    let normal = [0.0, 0.0, 1.0];
    let points = [[1.0, 2.0, 3.0], [nan; 3], [4.0, 5.0, nan], [6.0, 7.0, 8.0]];
    let points = points.map(|[x, y, z]| ([x, y, z, normal[0], normal[1], normal[2]], 0, 0.5));
    for encoding in ENCODINGS {
        let read = OrientedPoints::from_ply(&cloud_file(encoding, &points), "").expect(encoding);
        assert_eq!(read.points, [Point3::new(1.0, 2.0, 3.0), Point3::new(6.0, 7.0, 8.0)]);
        assert_eq!((read.normals.len(), read.left_out), (2, 2), "{encoding}");
        assert_eq!(read.areas, Some(vec![0.5; 2]));
    }
}

#[test]
fn welds_duplicate_vertices() {
    let mesh = cuboid();
    let mut file = "ply\nformat ascii 1.0\nelement vertex 36\n".to_owned()
        + XYZ
        + "element face 12\nproperty list uchar int vertex_indices\nend_header\n";
    mesh.corners().flatten().for_each(|c| file += &format!("{} {} {}\n", c.x, c.y, c.z));
    (0..12).for_each(|id| file += &format!("3 {} {} {}\n", 3 * id, 3 * id + 1, 3 * id + 2));
    let read = Mesh::from_ply(file.as_bytes(), "", UNIT).expect("a cuboid");
    assert!(read.vertices().len() == 8 && read.diagnostics().is_solid());
}

#[test]
fn header_errors_name_the_defect_and_the_line() {
    assert!(refusal("").contains("part.ply is no PLY file"));
    assert!(refusal("plyformat ascii").contains("is no PLY file"));
    for (original, replacement, line, expected) in [
        ("format ascii", "format utf8", 2, "`binary_big_endian`, found `utf8`"),
        ("1.0", "2.0", 2, "the version 1.0, found `2.0`"),
        (" 1.0", "", 2, "the version 1.0, found the end of the line"),
        ("format ascii 1.0\n", "", 8, "`format` before the end"),
        ("1.0\n", "1.0\nformat binary_little_endian 1.0\n", 3, "a second `format`"),
        ("element vertex 3", "element vertex three", 3, "how many elements there are"),
        ("element vertex 3", "element vertex -3", 3, "how many elements there are"),
        ("element vertex 3", "element vertex 99999999999999999999", 3, "how many elements"),
        ("element vertex 3\n", "element\n", 3, "the element's name"),
        ("element vertex 3\n", "", 3, "`element` before the first `property`"),
        ("property float x", "property half x", 4, "a type, such as `float`, or `list`, found"),
        ("property float x", "property float x y", 4, "the end of the line, found `y`"),
        ("property float x", "properties float x", 4, "a line of the header, or `end_header`"),
        ("double y", "double", 5, "the property's name, found the end of the line"),
        ("double y", "double x", 5, "a second `x`"),
        ("element face", "element vertex", 7, "a second `vertex`"),
        ("list uchar", "list bit", 8, "the type of the list's length, found `bit`"),
        ("uchar int", "uchar bit", 8, "the type of the list's items, found `bit`"),
        ("end_header", "end_header 1", 9, "the end of the line, found `1`"),
    ] {
        let message = refusal(ascii(original, replacement));
        assert!(
            message.starts_with(&format!("part.ply, line {line}: ")),
            "{replacement}: {message}"
        );
        assert!(message.contains(expected), "{replacement}: {message}");
    }
    let cut = refusal("ply\nformat ascii 1.0");
    assert!(cut.contains("line 2: expected a line of the header") && cut.contains("the file"));
}

#[test]
fn errors_name_missing_elements() {
    for (original, replacement, expected) in [
        ("float x", "float u", "has no points"),
        ("element vertex", "element vertices", "has no points"),
        ("vertex_index", "corners", "has no faces"),
        ("list uchar int", "float", "has no faces"),
        ("element face 1", "element face 0", "goes on at line 13"),
        ("element face 1", "element edge 1", "has no faces"),
    ] {
        let message = refusal(ascii(original, replacement));
        assert!(message.contains(expected), "{replacement}: {message}");
    }
    let no_faces = ascii("element face 1", "element face 0").replace("3 0 1 2\n", "");
    assert!(refusal(&no_faces).contains("has no faces"));
    let without = OrientedPoints::from_ply(no_faces.as_bytes(), "a").expect("points");
    assert!(without.normals.is_empty() && !without.points.is_empty());
    assert!(cloud_refusal(cloud_file("ascii", &[])).contains("has no points"));
}

#[test]
fn body_errors_name_the_defect_and_the_location() {
    for (original, replacement, expected) in [
        (".5 0 0", ".5 0 zero", "line 11: expected a number for `z`, found `zero`"),
        (".5 0 0", ".5 0", "line 11: expected a number for `z`, found the end of the line"),
        (".5 0 0", ".5 0 0 0", "line 11: expected the end of the line, found `0`"),
        (".5 0 0", ".5 inf 0", "line 11: `y` of `vertex` 1 (from 0) is inf, but must be finite"),
        (".5 0 0", ".5 0 1.#IND", "line 11: `z` of `vertex` 1 (from 0) is NaN"),
        (".5 0 0", "1e61 0 0", "is 1e61, but must be finite and within 1e60"),
        ("3 0 1 2", "3 0 1 3", "line 13: face 0 (from 0) names vertex 3, but there are 3"),
        ("3 0 1 2", "3 0 1 -1", "`vertex_index` of `face` 0 (from 0) is -1.0"),
        ("3 0 1 2", "3 0 1 1.5", "is 1.5, but must be the number of a vertex"),
        ("3 0 1 2", "2 0 1", "line 13: face 0 (from 0) has 2 corners"),
        ("3 0 1 2", "2.5 0 1 2", "the length of vertex_index` of `face` 0 (from 0) is 2.5"),
        ("3 0 1 2", "4 0 1 2", "ends at line 13, within `face` 0 (from 0) of 1: it was cut off"),
        ("3 0 1 2\n", "3 0 1 2\n5", "goes on at line 14, after all"),
        ("3 0 1 2", "3 0 1 1", "part.ply: none of the mesh's 1 triangles"),
        ("vertex 3", "vertex 1000000000000000000", "1000000000000000000 of `vertex` take 59999"),
    ] {
        let message = refusal(ascii(original, replacement));
        assert!(message.contains(expected), "{replacement}: {message}");
    }
    let (good, inf) = ([1.0, 0.0, 0.0, 0.0, 0.0, 1.0], f32::INFINITY);
    for (normal, face, area, expected) in [
        (
            [0.0, 0.0, 0.0],
            0,
            0.0,
            "the normal of point 1 (from 0) is no direction: its norm is 0.0",
        ),
        ([0.0, f32::NAN, 1.0], 0, 0.0, "its norm is NaN"),
        ([0.0, inf, 1.0], 0, 0.0, "its norm is inf"),
        ([0.0, 0.0, 1.0], -1, 0.0, "`face` of `vertex` 1 (from 0) is -1.0, but must be a whole"),
        ([0.0, 0.0, 1.0], 0, -1.0, "`area` of `vertex` 1 (from 0) is -1.0, but must be a finite"),
        ([0.0, 0.0, 1.0], 0, f64::NAN, "`area` of `vertex` 1 (from 0) is NaN"),
        ([0.0, 0.0, 1.0], 0, 1e308, "but must be a finite area from 0 to 1e60"),
    ] {
        let [x, y, z] = normal;
        let points = [(good, 0, 1.0), ([0.0, 0.0, 0.0, x, y, z], face, area)];
        for encoding in ENCODINGS {
            let bytes = cloud_file(encoding, &points);
            let location = match encoding {
                "ascii" => "line 16: ".to_owned(),
                _ => format!("byte {}: ", bytes.len() - 36),
            };
            let message = cloud_refusal(bytes);
            assert!(message.contains(expected) && message.contains(&location), "{message}");
        }
    }
}

#[test]
fn huge_counts_do_not_allocate() {
    for (count, min_bytes) in [("1000000000000000000", 36), ("18446744073709551615", 664)] {
        for encoding in ENCODINGS {
            let header = format!("element vertex {count}\n{CLOUD}");
            let message = cloud_refusal(Writer::new(encoding, &header).bytes);
            assert!(message.contains(&format!("{count} of `vertex` take ")), "{message}");
            let binary = message.contains(&format!("take {min_bytes}"));
            assert_eq!(binary, encoding != "ascii", "{message}");
        }
    }
    let value = [u32::MAX.to_le_bytes(), i32::MAX.to_le_bytes(), 4e9f32.to_le_bytes(), [0xFF; 4]];
    for (length, value) in ["uint", "int", "float", "int"].iter().zip(value) {
        let list = format!("element face 1\nproperty list {length} double vertex_index\n");
        let header = format!("{list}element vertex 1\n{XYZ}");
        let mut file = Writer::new("binary_little_endian", &header);
        file.bytes.extend([&value[..], &[0x43; 40]].concat());
        let message = refusal(&file.bytes);
        assert!(message.contains("cut off") || message.contains("below 2^32"), "{message}");
    }
}

#[test]
fn rejects_truncated_files() {
    for encoding in ENCODINGS {
        let mesh = mesh_file(encoding);
        let cloud = cloud_file(encoding, &[([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 1, 0.5)]);
        // The expected length of the last word of a text is unknown.
        let last = if encoding == "ascii" { 4 } else { 0 };
        for length in 0..mesh.len() - last {
            assert!(Mesh::from_ply(&mesh[..length], "", UNIT).is_err(), "{encoding} {length}");
        }
        for length in 0..cloud.len() - last {
            assert!(OrientedPoints::from_ply(&cloud[..length], "").is_err(), "{encoding} {length}");
        }
        let longer = refusal([&mesh[..], b"!"].concat());
        assert!(longer.contains("goes on at"), "{longer}");
    }
}

#[test]
fn damaged_files_do_not_panic() {
    let mut random = rand_pcg::Pcg64::seed_from_u64(1);
    let words: [&[u8]; 8] =
        [b"9", b" ", b"\r\n", b"1e400", b"list", b"\0", b"element a 9\n", b"property int q\n"];
    for encoding in ENCODINGS {
        for seed in [mesh_file(encoding), cloud_file(encoding, &[([1.0; 6], 1, 0.5); 3])] {
            for _ in 0..2000 {
                let bytes = damaged(&seed, &words, &mut random);
                if let Ok(mesh) = Mesh::from_ply(&bytes, "", UNIT) {
                    let diagnostics = mesh.diagnostics();
                    assert!(
                        diagnostics.area > 0.0 && diagnostics.area.is_finite(),
                        "{diagnostics:?}"
                    );
                }
                if let Ok(points) = OrientedPoints::from_ply(&bytes, "") {
                    assert!(points.normals.iter().all(|n| (n.norm() - 1.0).abs() < 1e-12));
                    assert!(
                        points.normals.is_empty() || points.points.len() == points.normals.len()
                    );
                }
            }
        }
    }
}

/// Checks that triangle strips and a second list of corners are refused as unread surfaces.
#[test]
fn rejects_unsupported_surfaces() {
    let vertices = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_index\n";
    let body = "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let refusal = |header: String| {
        let result = Mesh::from_ply(header.as_bytes(), "a.ply", Unit::Millimetre);
        result.expect_err("a surface that is not read").to_string()
    };
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let message = refusal(format!("{vertices}{face}{strips}{body}4 0 1 2 -1\n"));
    assert!(message.contains("`tristrips`"), "{message}");
    let lists = format!("{face}property list uchar int vertex_indices\n");
    let message =
        refusal(format!("{vertices}{lists}{}", body.replace("3 0 1 2", "3 0 1 2 3 0 1 2")));
    assert!(message.contains("has a surface in `vertex_ind"), "{message}");
}
