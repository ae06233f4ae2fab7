//! Files that are no map, or a map of something else, are refused with an explanation.

use super::*;
use redb::TableDefinition;
use touchoff::TriangleId;

#[test]
fn what_belongs_to_something_else_is_refused() {
    let place = Place::new();
    drop(place.open());
    let says = |asked: &MapIdentity| {
        let error = PostureMap::open(place.path(), asked).expect_err("it should be refused");
        assert!(matches!(error, MapError::Differs { .. }), "{error:?}");
        let text = error.to_string();
        assert!(text.contains("give another path for a new map, or remove the file"), "{text}");
        text
    };
    let own = identity();
    let mut asked = own.clone();
    asked.part.digest ^= 1;
    assert!(says(&asked).contains("of another part, 12 triangles in mm with the digest "));
    let mut asked = own.clone();
    asked.tools.swap(0, 1);
    assert!(
        says(&asked).contains("the tools `Ball`, `Flat`, in this order, and now they are `Flat`")
    );
    let mut asked = own.clone();
    asked.tools[1].digest ^= 1;
    assert!(says(&asked).contains("another version of `Flat`"));
    let mut asked = own.clone();
    asked.rules.tolerance = 0.02;
    let text = says(&asked);
    assert!(text.contains("(tolerance 0.01, niceness above 0.25, `shank` -0.5, 3 kept"), "{text}");
    assert!(text.contains("than now (tolerance 0.02,"), "{text}");
    assert!(says(&own.clone().with_keep(NonZeroU16::MIN)).contains("1 kept of each triangle"));
    let mut asked = own.clone();
    asked.directions[9][2] = 1e-300;
    assert!(says(&asked).contains("it has 70, now there are 70, and number 9 from 0"));
    asked = own.clone().with_directions(own.directions[..60].to_vec());
    assert!(says(&asked).contains("it has 70, now there are 60, and number 60 from 0"));
    assert_eq!(place.open().identity(), &own);
}

#[test]
fn what_is_no_map_is_refused() {
    let place = Place::new();
    let error = PostureMap::read(place.path()).expect_err("nothing there");
    assert!(matches!(error, MapError::Unreadable { .. }), "{error:?}");
    for bytes in [&b""[..], b"redb", b"solid block\n", &[0; 5000]] {
        fs::write(place.path(), bytes).expect("written");
        assert!(matches!(place.error(), MapError::Foreign { .. }));
    }
    fs::remove_file(place.path()).expect("removed");
    let other = Database::create(place.path()).expect("a store");
    let write = other.begin_write().expect("begun");
    let table: TableDefinition<'_, u64, u64> = TableDefinition::new("facts");
    write.open_table(table).expect("a table");
    write.commit().expect("written");
    drop(other);
    assert!(matches!(place.error(), MapError::Foreign { .. }));
    fs::remove_file(place.path()).expect("removed");
    drop(Database::create(place.path()).expect("a store"));
    assert!(matches!(place.error(), MapError::Foreign { .. }));
    let error = PostureMap::read(place.0.path()).expect_err("a folder");
    assert!(matches!(error, MapError::Unreadable { .. }), "{error:?}");
    let nowhere = place.0.path().join("nowhere").join("a.postures");
    let error = PostureMap::open(nowhere, &identity()).expect_err("no folder");
    assert!(matches!(error, MapError::Unwritable { .. }), "{error:?}");
}

#[test]
fn a_newer_map_is_refused() {
    let place = Place::new();
    drop(place.open());
    let store = Database::create(place.path()).expect("a store");
    let write = store.begin_write().expect("begun");
    let mut facts = write.open_table(FACTS).expect("a table");
    facts.insert(VERSION, 2u32.to_le_bytes().as_slice()).expect("written");
    drop(facts);
    write.commit().expect("written");
    drop(store);
    let text = place.error().to_string();
    assert!(text.contains("of version 2, and versions up to 1 are read here"), "{text}");
}

#[test]
fn a_map_is_open_once() {
    let place = Place::new();
    let map = place.open();
    assert!(matches!(place.error(), MapError::Locked { .. }));
    drop(map);
    place.open();
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_written_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    drop(place.open());
    fs::set_permissions(place.path(), fs::Permissions::from_mode(0o000)).expect("set");
    // Some users, such as root, may read any file.
    if File::open(place.path()).is_err() {
        assert!(matches!(place.error(), MapError::Unreadable { .. }));
    }
}

#[test]
fn a_row_that_does_not_fit_is_refused_with_its_batch() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(4));
    let map = place.open();
    let good = any_record(&mut random);
    let access = |directions: Vec<u64>, tool| MapRow {
        best: Vec::new(),
        access: vec![Accessibility { tool, directions, stickout: None }],
    };
    let bad = [
        (12, good),
        (0, PostureRecord { tool: 2, ..good }),
        (0, PostureRecord { niceness: f64::NAN, ..good }),
        (0, PostureRecord { depth: f64::INFINITY, ..good }),
        (0, PostureRecord { clearance: -1.0, ..good }),
        (0, PostureRecord { axis: [0.0; 3], ..good }),
        (0, PostureRecord { tip: [f64::NAN; 3], ..good }),
    ];
    for (triangle, record) in bad {
        let error =
            map.merge(&[(TriangleId(1), good), (TriangleId(triangle), record)]).expect_err("unfit");
        assert!(matches!(error, MapError::Unfit { .. }), "{error:?}");
        let row = MapRow { best: vec![record], access: Vec::new() };
        assert!(map.record(&[(TriangleId(triangle), row)]).is_err());
    }
    for row in [access(vec![0], 0), access(vec![0, 1 << 6], 0), access(vec![0, 0], 2)] {
        assert!(
            map.record(&[(TriangleId(1), access(vec![1, 0], 0)), (TriangleId(0), row)]).is_err()
        );
    }
    assert_eq!(rows(&map), []);
}

#[test]
fn no_flipped_bit_is_taken_for_a_posture() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(5));
    let given: Vec<(TriangleId, MapRow)> =
        (0..12).map(|k| (TriangleId(k), any_row(&mut random))).collect();
    let map = place.open();
    map.record(&given).expect("recorded");
    let whole = rows(&map);
    drop(map);
    let bytes = fs::read(place.path()).expect("read");
    let look = |bytes: &[u8]| -> Result<Vec<(TriangleId, MapRow)>, MapError> {
        fs::write(place.path(), bytes).expect("written");
        PostureMap::open(place.path(), &identity())?.rows()?.collect()
    };
    // The file is mostly zeros: change bytes that are not 0, and some of the rest.
    let used: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at] != 0).collect();
    let step = used.len().div_ceil(100);
    let places = used.into_iter().step_by(step).chain((0..bytes.len()).step_by(bytes.len() / 25));
    let mut refused = 0;
    for at in places {
        let mut other = bytes.clone();
        other[at] ^= 1 << (at % 8);
        match look(&other) {
            Ok(rows) => assert_eq!(rows, whole, "byte {at}"),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 10, "{refused}");
    for part in [1, 2, 5, 9, 15] {
        let cut = bytes.len() * part / 16;
        assert!(look(&bytes[..cut]).is_err(), "{cut} bytes");
    }
    assert_eq!(look(&bytes).expect("whole again"), whole);
}
