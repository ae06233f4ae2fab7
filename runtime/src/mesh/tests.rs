//! Tests of reading, writing, welding and refusing meshes.

use super::*;
use crate::id::TriangleId;
use rand_core::{Rng, SeedableRng};
use std::path::PathBuf;

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

fn triangle_record() -> [f32; 12] {
    [0.0, 0.0, 1.0, -0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
}

fn refusal(bytes: &[u8]) -> String {
    Mesh::from_stl(bytes, "part.stl", UNIT).expect_err("it should be refused").to_string()
}

#[test]
fn rejects_invalid_meshes() {
    let [a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let mesh = |vertices: &[Point3<f64>], triangles: &[_]| {
        Mesh::new(vertices.to_vec(), triangles.to_vec(), UNIT)
    };
    assert_eq!(mesh(&[a, b, c], &[]), Err(MeshError::NoTriangle));
    assert_eq!(mesh(&[], &[]), Err(MeshError::NoTriangle));
    let line = [0.0, 1.0, 2.0, 3.0].map(|x| Point3::new(x, 0.0, 0.0));
    assert_eq!(mesh(&line, &[[0, 1, 2], [1, 2, 3]]), Err(MeshError::NoArea { triangles: 2 }));
    assert_eq!(mesh(&[a, b, c], &[[0, 1, 1]]), Err(MeshError::NoArea { triangles: 1 }));
    let index = MeshError::Index { triangle: 1, index: 3, vertices: 3 };
    assert_eq!(mesh(&[a, b, c], &[[0, 1, 2], [0, 3, 1]]), Err(index));
    for coordinate in [f64::NAN, f64::INFINITY, -1e61] {
        let error = mesh(&[a, b, Point3::new(0.0, coordinate, 0.0)], &[[0, 1, 2]]);
        assert!(matches!(error, Err(MeshError::Coordinate { vertex: 2, .. })), "{error:?}");
    }
}

#[test]
fn areas_are_accurate_at_any_scale_and_offset() {
    for (scale, offset) in
        [(1.0, 0.0), (1e-9, 0.0), (1e9, 0.0), (1e-60, 0.0), (1e60, 0.0), (1.0, 1e9), (1e-3, 1e6)]
    {
        let corner = |x: f64, y: f64| Point3::new(offset + scale * x, offset + scale * y, offset);
        let (a, b, c) = (corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0));
        let sliver = corner(0.5, 0.0);
        let mesh =
            Mesh::new(vec![a, b, c, sliver], vec![[0, 1, 3], [0, 1, 2]], UNIT).expect("a mesh");
        assert_eq!(
            (mesh.normal(TriangleId(0)), mesh.area(TriangleId(0))),
            (None, 0.0),
            "scale {scale}"
        );
        let expected = 0.5 * (b.x - a.x) * (c.y - a.y);
        assert!((mesh.area(TriangleId(1)) / expected - 1.0).abs() < 1e-15, "scale {scale}");
        assert_eq!(mesh.normal(TriangleId(1)), Some(Vector3::z()), "scale {scale}");
    }
}

#[test]
fn reads_ascii_variants() {
    let plain = format!("solid a part\n{FACET}endsolid a part\n");
    let expected = Mesh::from_stl(plain.as_bytes(), "", UNIT).expect("plain");
    assert_eq!(expected.triangle(TriangleId(0))[1], Point3::new(1.5e-3, 0.0, 0.0));
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
fn ascii_errors_name_the_defect_and_the_line() {
    let file = |facet: &str| format!("solid x\n{facet}endsolid x\n");
    for (original, replacement, line, expected) in [
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
        let message = refusal(file(&FACET.replace(original, replacement)).as_bytes());
        let prefix = format!("part.stl, line {line}: ");
        assert!(message.starts_with(&prefix), "{replacement}: {message}");
        assert!(message.contains(expected), "{replacement}: {message}");
    }
    let surplus = refusal((file(FACET) + "more").as_bytes());
    assert!(surplus.contains("line 10: expected `solid`, or the end of"));
    let cut = refusal(format!("solid x\n{FACET}").as_bytes());
    assert!(cut.contains("ends on line 9, where `facet` or `endsolid` should"));
    assert!(refusal(b"solid").contains("cut off"));
    assert!(refusal(file("").as_bytes()).contains("no triangle"));
    let flat = refusal(file(&FACET.replace('2', "0")).as_bytes());
    assert!(flat.contains("none of the mesh's 1 triangles"));
}

#[test]
fn binary_errors_name_the_defect_and_the_byte() {
    let whole = binary("solid by a CAD system", &[triangle_record(), triangle_record()]);
    let mesh = Mesh::from_stl(&whole, "", UNIT).expect("binary, whatever its header");
    assert_eq!((mesh.triangles().len(), mesh.vertices().len()), (2, 3));

    assert!(refusal(&[]).contains("part.stl is empty"));
    assert!(refusal(b"ply\nformat").contains("is no STL file: it has 10 bytes"));
    let cut = refusal(&whole[..150]);
    assert!(cut.contains("2 triangles = 184 bytes, but the file has 150"), "{cut}");
    let longer = refusal(&[&whole[..], b"!"].concat());
    assert!(longer.contains("has 185 bytes") && longer.contains("= 184 bytes"), "{longer}");
    let mut invalid = triangle_record();
    invalid[7] = f32::NAN;
    let invalid = refusal(&binary("", &[triangle_record(), invalid]));
    assert!(invalid.contains("triangle 1 (from 0), byte 162: the coordinate NaN"), "{invalid}");
    assert!(refusal(&binary("", &[])).contains("no triangle"));
    assert!(refusal(&binary("", &[[1.0; 12]])).contains("none of the mesh's 1 triangles"));
    let missing = Mesh::read_stl("no/such/part.stl", UNIT).expect_err("no such file");
    assert!(missing.to_string().contains("cannot read no/such/part.stl"), "{missing}");
}

/// Nine different coordinates, each of which is read to its place and refused in its place if it is not finite.
#[test]
fn every_coordinate_of_a_binary_triangle_is_read_and_checked() {
    let mut record = triangle_record();
    for (k, number) in record.iter_mut().enumerate().skip(3) {
        *number = (k * k) as f32 + 0.5;
    }
    let file = binary("", &[triangle_record(), record]);
    let mesh = Mesh::from_stl(&file, "", UNIT).expect("a mesh");
    let read = mesh.triangle(TriangleId(1)).map(|corner| <[f64; 3]>::from(corner.coords));
    let written = record[3..].iter().map(|number| f64::from(*number));
    assert!(read.as_flattened().iter().copied().eq(written), "{read:?}");
    for k in 3..12 {
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut damaged = record;
            damaged[k] = wrong;
            let said = refusal(&binary("", &[triangle_record(), damaged]));
            let byte = 84 + 50 + 4 * k;
            let expected = format!("triangle 1 (from 0), byte {byte}: the coordinate {wrong}");
            assert!(said.contains(&expected), "{said}");
        }
    }
}

#[test]
fn every_coordinate_of_an_ascii_triangle_is_read_and_checked() {
    let words: Vec<String> = (1..10).map(|k| format!("{}.5", k * k)).collect();
    let text = |words: &[String]| {
        let rows: Vec<String> =
            words.chunks(3).map(|row| format!("vertex {}", row.join(" "))).collect();
        let rows = rows.join("\n");
        format!("solid x\nfacet normal 0 0 1\nouter loop\n{rows}\nendloop\nendfacet\nendsolid\n")
    };
    let mesh = Mesh::from_stl(text(&words).as_bytes(), "", UNIT).expect("a mesh");
    let read = mesh.triangle(TriangleId(0)).map(|corner| <[f64; 3]>::from(corner.coords));
    assert!(read.as_flattened().iter().map(ToString::to_string).eq(words.iter().cloned()));
    for k in 0..9 {
        for wrong in ["inf", "-1e999", "1e61"] {
            let mut damaged = words.clone();
            damaged[k] = wrong.to_owned();
            let said = refusal(text(&damaged).as_bytes());
            let expected = format!("line {}: the coordinate `{wrong}` is not", 4 + k / 3);
            assert!(said.contains(&expected), "{said}");
        }
    }
}

#[test]
fn welds_vertices_that_differ_by_noise() {
    let mut noisy = triangle_record();
    noisy[3..6].copy_from_slice(&[1e-17, 0.0, -3e-16]);
    let [mut distinct, mut small] = [triangle_record(); 2];
    (distinct[6], small[3]) = (1.0 + f32::EPSILON, 1e-9);
    let read = |triangles: &[_]| Mesh::from_stl(&binary("", triangles), "", UNIT);
    let mesh = read(&[triangle_record(), noisy, distinct, small]).expect("a mesh");
    assert_eq!(mesh.triangles()[1], [0, 1, 2], "-0, 0 and 1e-17 are one");
    assert_eq!(mesh.triangles()[2..], [[0, 3, 2], [4, 1, 2]]);
}

/// Returns a file with up to four random defects: a changed byte, a truncation or an inserted word.
pub(super) fn damaged(file: &[u8], words: &[&[u8]], random: &mut rand_pcg::Pcg64) -> Vec<u8> {
    let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
    let mut bytes = file.to_vec();
    for _ in 0..1 + below(4) {
        let position = below(bytes.len());
        match below(4) {
            0 => bytes[position] = below(256) as u8,
            1 => bytes[position] ^= 1 << below(8),
            2 => bytes.truncate(position.max(1)),
            _ => drop(bytes.splice(position..position, words[below(words.len())].iter().copied())),
        }
    }
    bytes
}

#[test]
fn damaged_files_do_not_panic() {
    let mut random = rand_pcg::Pcg64::seed_from_u64(1);
    let text = format!("solid\n{}endsolid\n", FACET.repeat(2)).into_bytes();
    let words: [&[u8]; 6] = [b"endfacet", b"solid", b"\r\n", b"1e400", b"vertex", b"\0"];
    for seed in [
        binary("", &[triangle_record(), triangle_record()]),
        binary("solid", &[triangle_record()]),
        text,
        vec![0; 90],
    ] {
        for _ in 0..5000 {
            let bytes = damaged(&seed, &words, &mut random);
            if let Ok(mesh) = Mesh::from_stl(&bytes, "", UNIT) {
                let diagnostics = mesh.diagnostics();
                assert!(diagnostics.area > 0.0 && diagnostics.area.is_finite(), "{diagnostics:?}");
                assert!(!diagnostics.to_string().is_empty());
            }
        }
    }
}

/// Returns the folder of shared parts, if it exists: a checkout alone has none.
fn shared_parts() -> Option<PathBuf> {
    let parts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/parts");
    if parts.is_dir() {
        return Some(parts);
    }
    eprintln!("{} is absent: only the parts made here are read", parts.display());
    None
}

/// Returns the area of a tube with flat sides, by its radii and its height.
fn area_of_tube([inner, outer]: [f64; 2], height: f64, sides: u32) -> f64 {
    let (angle, sides) = (std::f64::consts::PI / f64::from(sides), f64::from(sides));
    let walls = 2.0 * angle.sin() * (inner + outer) * height;
    let rings = (2.0 * angle).sin() * (outer * outer - inner * inner);
    sides * (walls + rings)
}

/// Checks parts of each kind and unit, made here and read from files, then the shared ones.
#[test]
fn reads_parts_from_stl_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, mesh: &Mesh, ascii: bool| {
        let mut bytes = Vec::new();
        let written = match ascii {
            true => mesh.write_stl_ascii(&mut bytes),
            false => mesh.write_stl(&mut bytes),
        };
        written.and_then(|()| std::fs::write(folder.path().join(name), bytes)).expect("a file");
    };
    let tube = shapes::tube(3.0, 5.0, 13.116, 96, 23, UNIT).expect("a tube");
    let cuboid = |[x, y, z]: [f64; 3], unit| {
        shapes::cuboid(Point3::new(-x, 0.0, 0.0), Point3::new(x, y, z), unit).expect("a cuboid")
    };
    write("tube.stl", &tube, false);
    write("tube_ascii.stl", &tube, true);
    write("inch.stl", &cuboid([1.5, 2.0, 0.25], Unit::Inch), false);
    write("metre.stl", &cuboid([0.1, 0.07, 0.3], Unit::Metre), true);
    let tube_area = area_of_tube([3.0, 5.0], 13.116, 96);
    // Areas by formula; a binary file rounds coordinates to `f32`.
    let mut parts: Vec<(PathBuf, Unit, usize, f64, f64)> = [
        ("tube.stl", Unit::Millimetre, 9_216, tube_area, 1e-6),
        ("tube_ascii.stl", Unit::Millimetre, 9_216, tube_area, 1e-12),
        ("inch.stl", Unit::Inch, 12, 14.5, 1e-12),
        ("metre.stl", Unit::Metre, 12, 2.0 * (0.2 * 0.07 + 0.2 * 0.3 + 0.07 * 0.3), 1e-12),
    ]
    .map(|(file, unit, triangles, area, tolerance)| {
        (folder.path().join(file), unit, triangles, area, tolerance)
    })
    .to_vec();
    if let Some(shared_parts) = shared_parts() {
        // The areas are from an independent reading of the files.
        let files = [
            ("thesis_tube.stl", Unit::Millimetre, 9_216, 759.6236125024762),
            ("impeller.stl", Unit::Millimetre, 52_872, 12_995.440601326354),
            ("featuretype_inch.stl", Unit::Inch, 3_476, 53.82738611818216),
            ("octagonal_pocket_metre.stl", Unit::Metre, 3_262, 0.07482245333956647),
            ("kiri_pocket_test.stl", Unit::Millimetre, 28, 28_480.0),
        ];
        parts.extend(
            files.map(|(file, unit, count, area)| {
                (shared_parts.join(file), unit, count, area, 1e-12)
            }),
        );
    }
    for (path, unit, triangles, area, tolerance) in parts {
        let file = path.display();
        let mesh = Mesh::read_stl(&path, unit).unwrap_or_else(|error| panic!("{file}: {error}"));
        let diagnostics = mesh.diagnostics();
        assert_eq!((diagnostics.triangles, mesh.unit()), (triangles, unit), "{file}");
        assert!(diagnostics.is_solid(), "{file}: {diagnostics}");
        assert!(
            (diagnostics.area / area - 1.0).abs() < tolerance,
            "{file}: {} of {area}",
            diagnostics.area
        );
    }
}

/// Returns a mesh in ASCII PLY, with its first `triangles` triangles.
fn ply(mesh: &Mesh, triangles: usize) -> String {
    let corners = mesh.vertices().iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z));
    let faces = mesh.triangles()[..triangles].iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n"));
    let (corners, faces): (String, String) = (corners.collect(), faces.collect());
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {triangles}\nproperty list uchar int vertex_indices\nend_header\n{corners}{faces}",
        mesh.vertices().len()
    )
}

/// Checks whole parts and parts with holes, made here and read from files, then the shared ones.
#[test]
fn reads_parts_from_ply_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let tube = shapes::tube(3.0, 5.0, 13.116, 96, 23, UNIT).expect("a tube");
    let total = tube.triangles().len();
    let mut parts = Vec::new();
    for (name, triangles) in
        [("whole.ply", total), ("one_hole.ply", total - 1), ("half.ply", total / 2)]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, ply(&tube, triangles)).expect("a file");
        parts.push((path, triangles, triangles == total));
    }
    if let Some(shared_parts) = shared_parts() {
        let files = [
            ("nist_mbe_pmi_1_18k.ply", 18_166, true),
            ("nist_mbe_pmi_2_46k_leaky.ply", 46_192, false),
            ("nist_mbe_pmi_3_7k.ply", 7_140, true),
            ("noether_wavy_mesh_with_hole.ply", 1_347, false),
        ];
        parts.extend(files.map(|(file, count, closed)| (shared_parts.join(file), count, closed)));
    }
    for (path, triangles, closed) in parts {
        let file = path.display();
        let geometry =
            Geometry::read(&path, UNIT).unwrap_or_else(|error| panic!("{file}: {error}"));
        let Geometry::Mesh(mesh) = geometry else { panic!("{file} has faces") };
        let diagnostics = mesh.diagnostics();
        assert_eq!(
            (diagnostics.triangles, diagnostics.is_closed()),
            (triangles, closed),
            "{file}: {diagnostics}"
        );
    }
}

#[test]
fn written_stl_is_read_back() {
    let mesh = shapes::tube(3.0, 5.0, 13.116, 24, 2, UNIT).expect("a tube");
    let mut text = Vec::new();
    mesh.write_stl_ascii(&mut text).expect("written");
    let read_back = Mesh::from_stl(&text, "", UNIT).expect("read");
    assert!(mesh.corners().eq(read_back.corners()));

    let mut binary = Vec::new();
    mesh.write_stl(&mut binary).expect("written");
    assert!(binary.starts_with(b"binary STL in mm"));
    let read_back = Mesh::from_stl(&binary, "", UNIT).expect("read");
    assert!(
        mesh.corners()
            .flatten()
            .zip(read_back.corners().flatten())
            .all(|(a, b)| { a.iter().zip(b.iter()).all(|(a, b)| f64::from(*a as f32) == *b) })
    );
    assert!(read_back.diagnostics().is_solid() && read_back.diagnostics().opposed_normals == 0);

    let huge = shapes::sphere(1e40, 0, UNIT).expect("a large sphere");
    let error = huge.write_stl(&mut Vec::new()).expect_err("f32 cannot hold it");
    assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput);
}
