//! Maps opened for reading: they show one moment, whoever writes to the file, and leave the file unchanged.

use super::*;
use crate::Directions;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};
use touchoff::TriangleId;

fn some_rows(random: &mut Pcg64Mcg, triangles: std::ops::Range<u32>) -> Vec<(TriangleId, MapRow)> {
    triangles.map(|k| (TriangleId(k), any_row(random))).collect()
}

#[test]
fn a_look_changes_nothing() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(7));
    place.open().record(&some_rows(&mut random, 0..9)).expect("recorded");
    let long_ago = SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000);
    let file = File::options().write(true).open(place.path()).expect("a file");
    file.set_modified(long_ago).expect("a time");
    let mut permissions = file.metadata().expect("a file").permissions();
    drop(file);
    permissions.set_readonly(true);
    fs::set_permissions(place.path(), permissions).expect("set");
    let bytes = fs::read(place.path()).expect("read");
    let map = PostureMap::read(place.path()).expect("a map");
    assert_eq!((map.identity(), rows(&map).len()), (&identity(), 9));
    drop(map);
    assert!(fs::read(place.path()).expect("read") == bytes, "the bytes are others");
    let modified = fs::metadata(place.path()).and_then(|file| file.modified()).expect("a time");
    assert_eq!(modified, long_ago);
    assert_eq!(fs::read_dir(place.0.path()).expect("a folder").count(), 1);
}

#[test]
fn a_copy_is_not_recorded_into() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(8));
    drop(place.open());
    let copy = PostureMap::read(place.path()).expect("a map");
    let error = copy.record(&some_rows(&mut random, 0..1)).expect_err("read only");
    assert!(matches!(error, MapError::ReadOnly { .. }), "{error:?}");
    let error = copy.merge(&[(TriangleId(0), any_record(&mut random))]).expect_err("read only");
    assert!(error.to_string().contains("`PostureMap::resume`"), "{error}");
    let map = PostureMap::resume(place.path()).expect("a map");
    map.record(&some_rows(&mut random, 0..1)).expect("recorded");
}

#[test]
fn a_map_is_read_while_another_records_into_it() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(9));
    let map = place.open();
    map.record(&some_rows(&mut random, 0..4)).expect("recorded");
    let early = PostureMap::read(place.path()).expect("a map");
    let known = rows(&map);
    map.record(&some_rows(&mut random, 4..9)).expect("recorded");
    assert_eq!(rows(&early), known, "a copy stays as it is");
    assert_eq!(rows(&PostureMap::read(place.path()).expect("a map")), rows(&map));

    let nice = |niceness, random: &mut Pcg64Mcg| PostureRecord { niceness, ..any_record(random) };
    map.merge(&[(TriangleId(3), nice(9.0, &mut random))]).expect("recorded");
    let (over, path) = (AtomicBool::new(false), place.path());
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut nicest = f64::NEG_INFINITY;
            let mut reads = 0;
            loop {
                // A map that is read after the last record has all records.
                let last = over.load(Ordering::Acquire) && reads >= 2;
                let map = PostureMap::read(&path).expect("a map");
                let now = rows(&map)[3].1.best[0].niceness;
                assert!(now >= nicest, "what was there is gone: {now} after {nicest}");
                (nicest, reads) = (now, reads + 1);
                if last {
                    return nicest;
                }
            }
        });
        for step in 0..60 {
            let record = nice(10.0 + f64::from(step), &mut random);
            map.merge(&[(TriangleId(3), record)]).expect("recorded");
        }
        over.store(true, Ordering::Release);
        assert_eq!(reader.join().expect("it reads"), 69.0);
    });
}

/// A sparse file takes no space on the disk, but its copy takes memory.
#[test]
fn a_map_that_is_longer_than_it_says_is_not_copied() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(10));
    place.open().record(&some_rows(&mut random, 0..12)).expect("recorded");
    let file = fs::OpenOptions::new().write(true).open(place.path()).expect("a map");
    let length = file.metadata().expect("a map").len();
    for (longer, reason) in
        [(length + 1, format!("not {length}")), ((4 << 30) + 1, "that are read".to_owned())]
    {
        file.set_len(longer).expect("a sparse file");
        for error in [PostureMap::read(place.path()), PostureMap::resume(place.path())] {
            let error = error.expect_err("it is too long").to_string();
            assert!(
                error.contains(&format!("it has {longer} bytes")) && error.contains(&reason),
                "{error}"
            );
        }
    }
    file.set_len(length).expect("a file");
    assert_eq!(rows(&PostureMap::read(place.path()).expect("whole")).len(), 12);
}

#[test]
fn a_map_without_its_end_is_called_truncated() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(10));
    place.open().record(&some_rows(&mut random, 0..12)).expect("recorded");
    let bytes = fs::read(place.path()).expect("read");
    for length in [20, 200, 319, 320, 4096, bytes.len() / 2, bytes.len() - 4096, bytes.len() - 1] {
        fs::write(place.path(), &bytes[..length]).expect("written");
        for error in [PostureMap::read(place.path()), PostureMap::resume(place.path())] {
            let error = error.expect_err("its end is missing");
            assert!(matches!(error, MapError::Truncated { .. }), "{length}: {error:?}");
            assert!(error.to_string().contains(&format!("truncated: it has {length} of ")));
        }
    }
    // The same for a file whose writer was killed, although its header has less information.
    fs::write(place.path(), &bytes).expect("written");
    let live = place.open();
    let killed = fs::read(place.path()).expect("read");
    drop(live);
    for length in [320, 5000, killed.len() / 2 + 1, killed.len() - 1] {
        fs::write(place.path(), &killed[..length]).expect("written");
        let error = PostureMap::read(place.path()).expect_err("its end is missing");
        assert!(matches!(error, MapError::Truncated { .. }), "{length}: {error:?}");
    }
    fs::write(place.path(), &killed).expect("written");
    assert_eq!(rows(&PostureMap::read(place.path()).expect("whole")).len(), 12);
}

/// Creates a map's file with the given identity and bytes of rows, as an attacker could.
fn crafted(place: &Place, identity: &MapIdentity, rows: &[(u32, Vec<u8>)]) {
    let _ = fs::remove_file(place.path());
    let store = Database::create(place.path()).expect("a store");
    write_facts(&store, identity).expect("written");
    let write = store.begin_write().expect("begun");
    let mut table = write.open_table(ROWS).expect("a table");
    for (triangle, bytes) in rows {
        table.insert(triangle, bytes.as_slice()).expect("written");
    }
    drop(table);
    write.commit().expect("written");
}

#[test]
fn no_file_asks_for_more_memory_than_it_has_bytes() {
    let place = Place::new();
    // The tables between 50,000 directions would take 5 GB.
    let many = identity().with_directions(vec![[0.0, 0.0, 1.0]; 50_000]);
    crafted(&place, &many, &[]);
    let error = PostureMap::read(place.path()).expect_err("too many");
    assert!(matches!(error, MapError::Oversized { .. }), "{error:?}");
    let most = 2 * Directions::MAX_HEMISPHERE;
    assert!(error.to_string().contains(&format!("50000 directions, and there may be {most}")));
    fs::remove_file(place.path()).expect("removed");
    let error = PostureMap::open(place.path(), &many).expect_err("too many");
    assert!(matches!(error, MapError::Oversized { .. }) && !place.path().exists(), "{error:?}");
    let mut tools = identity();
    tools.tools = vec![tools.tools[0].clone(); 70_000];
    crafted(&place, &tools, &[]);
    let error = PostureMap::read(place.path()).expect_err("too many");
    assert!(error.to_string().contains("70000 tools"), "{error}");

    // More triangles than any mesh has: the data take as much memory as the file has bytes.
    let mut vast = identity();
    vast.part.triangles = u32::MAX;
    let row = any_row(&mut Pcg64Mcg::seed_from_u64(11));
    crafted(&place, &vast, &[(u32::MAX - 1, encode(&row))]);
    let map = PostureMap::read(place.path()).expect("a map");
    assert_eq!(map.swept().expect("read").len(), 1);

    let access = |tool| Accessibility { tool, directions: vec![0, 0], stickout: None };
    let row = MapRow { best: Vec::new(), access: vec![access(1), access(0), access(1)] };
    let record = any_record(&mut Pcg64Mcg::seed_from_u64(12));
    let more = MapRow { best: vec![record; 4], access: Vec::new() };
    for row in [row, more] {
        crafted(&place, &identity(), &[(3, encode(&row))]);
        let map = PostureMap::read(place.path()).expect("a map");
        assert!(matches!(map.row(TriangleId(3)), Err(MapError::Damaged { .. })));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_no_regular_file_is_not_waited_for() {
    for path in ["/dev/zero", "/dev/null", "/dev"] {
        for error in [PostureMap::read(path), PostureMap::open(path, &identity())] {
            let error = error.expect_err("no file");
            assert!(error.to_string().contains("it is no regular file"), "{error}");
        }
    }
}

#[test]
fn names_in_a_map_are_escaped_where_it_is_refused() {
    let place = Place::new();
    let mut evil = identity();
    evil.tools[0].name = "Ball\u{1b}[2J\nerror".to_owned();
    evil.rules.allowed[0].0 = "sh\u{7}ank".to_owned();
    crafted(&place, &evil, &[]);
    let text = place.error().to_string();
    assert!(text.contains(r"`Ball\u001b[2J\u000aerror`"), "{text}");
    assert!(evil.rules.to_string().contains(r"sh\u0007ank"), "{}", evil.rules);
}
