//! Exports reproduce the map to the bit.

use super::*;
use crate::{Piece, colormap};
use serde_json::Value;
use touchoff::TriangleId;
use touchoff::mesh::Geometry;

fn known() -> (Place, PostureMap) {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(7));
    let map = place.open();
    let mut given: Vec<(TriangleId, MapRow)> =
        (0..10).map(|k| (TriangleId(k), any_row(&mut random))).collect();
    given[2].1.access.clear();
    given[3].1.best[..].iter_mut().for_each(|record| record.depth = 5e-324);
    map.record(&given).expect("recorded");
    (place, map)
}

fn same(one: f64, text: &str) {
    let other: f64 = text.parse().expect("a number");
    assert_eq!(one.to_bits(), other.to_bits(), "{one} {text}");
}

#[test]
fn csv_reads_back() {
    let (_place, map) = known();
    let mut bytes = Vec::new();
    map.write_csv(&mut bytes).expect("written");
    let text = String::from_utf8(bytes).expect("text");
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let lines: Vec<Vec<&str>> = lines.collect();
    assert!(lines.iter().all(|line| line.len() == header.len()));
    for (triangle, row) in rows(&map) {
        let own = lines.iter().filter(|line| line[0] == triangle.to_string());
        let own: Vec<_> = own.collect();
        type Lines<'a> = Vec<&'a Vec<&'a str>>;
        let (nice, bare): (Lines<'_>, Lines<'_>) =
            own.into_iter().partition(|line| !line[8].is_empty());
        assert_eq!(nice.len(), row.best.len());
        for (line, record) in nice.iter().zip(&row.best) {
            assert_eq!(line[1], ["Ball", "Flat"][usize::from(record.tool)]);
            let ([x, y, z], [i, j, k]) = (record.tip, record.axis);
            let rest = [record.niceness, record.depth, record.clearance];
            let numbers = [x, y, z, i, j, k].into_iter().chain(rest);
            numbers.zip(&line[2..]).for_each(|(number, text)| same(number, text));
        }
        for access in &row.access {
            let name = ["Ball", "Flat"][usize::from(access.tool)];
            let mut all = nice.iter().chain(&bare).filter(|line| line[1] == name).peekable();
            assert!(all.peek().is_some());
            for line in all {
                let count: u32 = access.directions.iter().map(|word| word.count_ones()).sum();
                assert_eq!(line[11], count.to_string());
                match access.stickout {
                    Some(stickout) => same(stickout, line[12]),
                    None => assert_eq!(line[12], ""),
                }
                let is_reached = access.directions.iter().any(|word| *word != 0);
                assert_eq!(line[13], if is_reached { "1.0" } else { "0.0" });
            }
        }
    }
}

#[test]
fn json_reads_back() {
    let (_place, map) = known();
    let mut bytes = Vec::new();
    map.write_json(&mut bytes).expect("written");
    let json: Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(json["map"]["triangles"], 12);
    assert_eq!(json["map"]["tools"][1]["name"], "Flat");
    assert_eq!(json["map"]["rules"]["tolerance"], 0.01);
    let known = rows(&map);
    let text = String::from_utf8(bytes).expect("text");
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(known.len()));
    let lines = text.lines().filter(|line| line.starts_with("{\"triangle\""));
    for ((triangle, row), line) in known.iter().zip(lines) {
        let value: Value = serde_json::from_str(line.trim_end_matches(',')).expect("a row");
        assert_eq!(value["triangle"], triangle.0);
        assert_eq!(value["access"].as_array().map(Vec::len), Some(row.access.len()));
        for (record, value) in row.best.iter().zip(value["best"].as_array().expect("a list")) {
            // Compare the text as written, independently of a reader's rounding.
            let tip = record.tip.map(|number| serde_json::to_string(&number).expect("a number"));
            tip.iter().zip(record.tip).for_each(|(text, number)| same(number, text));
            assert!(line.contains(&tip.join(",")));
            assert_eq!(value["clearance"].is_null(), record.clearance.is_infinite());
        }
    }
}

#[test]
fn ply_reads_back() {
    let (place, map) = known();
    let (mesh, path) = (block(), place.0.path().join("a.ply"));
    let mut bytes = Vec::new();
    map.write_ply(&mut bytes, &mesh, colormap).expect("written");
    fs::write(&path, &bytes).expect("written");
    let Geometry::Mesh(read) = Geometry::read(&path, Unit::Millimetre).expect("a PLY") else {
        panic!("no mesh")
    };
    assert_eq!(PartFingerprint::of(&read), PartFingerprint::of(&mesh));
    // A face has a count, three corners, three bytes of colour, a double and its triangle.
    let faces = &bytes[bytes.len() - 12 * 28..];
    for (triangle, face) in (0u32..).zip(faces.chunks(28)) {
        let niceness = f64::from_le_bytes(face[16..24].try_into().expect("8 bytes"));
        assert_eq!(face[24..], triangle.to_le_bytes());
        let row = map.row(TriangleId(triangle)).expect("read").unwrap_or_default();
        match row.best.first() {
            Some(best) => {
                assert_eq!(niceness.to_bits(), best.niceness.to_bits());
                assert_eq!(face[13..16], colormap(niceness));
            }
            None => assert!(niceness.is_nan() && face[13..16] == [0x80; 3]),
        }
    }
    let other = shapes::sphere(3.0, 1, Unit::Millimetre).expect("a sphere");
    let error = map.write_ply(&mut Vec::new(), &other, colormap).expect_err("another part");
    assert!(matches!(error, MapError::Differs { .. }), "{error:?}");
}

/// Triangle 4 in three pieces, of which the tools reach some.
#[test]
fn pieces_are_exported() {
    let (place, map) = known();
    let whole = Piece::whole(TriangleId(4));
    let [one, other] = whole.halves().expect("halves");
    let [third, fourth] = other.halves().expect("halves");
    let row = |ball: u64, flat: u64, stickout, niceness| {
        let access = |tool, set| Accessibility {
            tool,
            directions: vec![set, 0],
            stickout: if tool == 0 && set != 0 { stickout } else { None },
        };
        let mut best = any_record(&mut Pcg64Mcg::seed_from_u64(1));
        best.niceness = niceness;
        let best = if ball | flat == 0 { Vec::new() } else { vec![best] };
        MapRow { best, access: vec![access(0, ball), access(1, flat)] }
    };
    let rows = [
        (one, row(0b1100, 0, Some(7.0), 0.5)),
        (third, row(0b1010, 0b1, Some(6.0), 0.75)),
        (fourth, row(0, 0, None, 0.0)),
    ];
    map.record_pieces(&rows).expect("recorded");
    let export = |write: &dyn Fn(&mut Vec<u8>) -> Result<(), MapError>| {
        let mut bytes = Vec::new();
        write(&mut bytes).expect("written");
        bytes
    };
    let csv = String::from_utf8(export(&|out| map.write_csv(out))).expect("text");
    let ends = |line: &str| line.split(',').skip(11).collect::<Vec<_>>().join(",");
    let of = |name: &str| {
        let mut lines = csv.lines().filter(|line| line.starts_with(&format!("4,{name},")));
        lines.next().map(ends).expect("a line")
    };
    assert_eq!([of("Ball"), of("Flat")], ["3,6.0,0.75", "1,,0.25"]);
    let json: Value = serde_json::from_slice(&export(&|out| map.write_json(out))).expect("JSON");
    let row = &json["rows"][4];
    assert_eq!((&row["pieces"], &row["best"][0]["niceness"]), (&3.into(), &0.75.into()));
    assert_eq!(row["access"][0]["area_reached"], 0.75);

    let (mesh, path) = (block(), place.0.path().join("a.ply"));
    let bytes = export(&|out| map.write_ply(out, &mesh, colormap));
    fs::write(&path, &bytes).expect("written");
    let Geometry::Mesh(read) = Geometry::read(&path, Unit::Millimetre).expect("a PLY") else {
        panic!("no mesh")
    };
    assert_eq!((read.triangles().len(), read.vertices().len()), (14, 10));
    let area: f64 = (4..7).map(|id| read.area(TriangleId(id))).sum();
    assert!((area - mesh.area(TriangleId(4))).abs() < 1e-9, "{area}");
    let faces: Vec<&[u8]> = bytes[bytes.len() - 14 * 28..].chunks(28).collect();
    let triangles: Vec<u8> = faces.iter().map(|face| face[24]).collect();
    assert_eq!(triangles, [0, 1, 2, 3, 4, 4, 4, 5, 6, 7, 8, 9, 10, 11]);
    let niceness = faces[4..7]
        .iter()
        .map(|face| f64::from_le_bytes(face[16..24].try_into().expect("8 bytes")));
    let niceness: Vec<f64> = niceness.collect();
    assert!(niceness[..2] == [0.5, 0.75] && niceness[2].is_nan(), "{niceness:?}");
}

#[test]
fn an_export_that_cannot_be_written_says_so() {
    struct Full;
    impl io::Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let (_place, map) = known();
    let said = [
        map.write_csv(&mut Full),
        map.write_json(&mut Full),
        map.write_ply(&mut Full, &block(), colormap),
    ];
    for said in said {
        assert!(matches!(said, Err(MapError::Export { .. })), "{said:?}");
    }
}
