//! Shards that merge to the rows of a whole sweep, in any order; files that are damaged, foreign, missing or there twice.

use super::*;
use crate::map::tests::{BALL, FLAT};
use crate::sweep::PostureSweep;
use crate::{Directions, Rules};
use std::fs;
use std::num::{NonZeroU16, NonZeroUsize};
use std::ops::ControlFlow;
use std::path::PathBuf;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Tool, Unit};

/// A sphere of 1,280 triangles, which are five batches, and the settings of its sweep.
struct Study {
    mesh: Mesh,
    bvh: TriangleBvh,
    directions: Directions,
    rules: Rules,
    keep: NonZeroU16,
}

fn tools() -> [&'static dyn Tool; 2] {
    [&*BALL, &*FLAT]
}

impl Study {
    fn new() -> Study {
        let mesh = shapes::sphere(20.0, 3, Unit::Millimetre).expect("a sphere");
        Study {
            bvh: TriangleBvh::new(&mesh),
            mesh,
            // A number of directions that fills no byte.
            directions: Directions::spread(13),
            rules: Rules { tolerance: 0.05, niceness: 0.0, allowed: Vec::new() },
            keep: NonZeroU16::new(3).expect("3"),
        }
    }

    fn sweep(&self) -> PostureSweep<'_> {
        let (mesh, bvh, directions) = (&self.mesh, &self.bvh, &self.directions);
        PostureSweep::new(mesh, bvh, tools().to_vec(), directions, self.rules.clone(), self.keep)
            .expect("a sweep")
    }

    fn identity(&self) -> MapIdentity {
        MapIdentity::new(&self.mesh, &tools(), self.rules.clone())
            .expect("rules")
            .with_directions(self.directions.list().to_vec())
            .with_keep(self.keep)
    }

    fn rows(&self, batches: std::ops::Range<usize>) -> Vec<(TriangleId, MapRow)> {
        let batches: Vec<usize> = batches.collect();
        let mut rows = Vec::new();
        let _: ControlFlow<()> = self.sweep().run(&batches, |batch| {
            rows.extend(batch.rows);
            ControlFlow::Continue(())
        });
        rows
    }

    /// Writes all shards of a number of them into a folder.
    fn write(&self, folder: &Path, count: u32) -> Vec<PathBuf> {
        let shards = (1..=count).map(|number| {
            let shard = Shard::new(number, count).expect("a shard");
            let path = folder.join(format!("{number}-of-{count}.parquet"));
            let rows = self.rows(shard.range(self.sweep().batches()));
            let bytes = shard_bytes(&self.mesh, &self.identity(), shard, rows);
            write_shard(&path, &bytes).expect("a shard");
            path
        });
        shards.collect()
    }
}

/// Merges files, and returns the bytes of the map and of the table.
fn merged(folder: &Path, files: &[PathBuf]) -> Result<[Vec<u8>; 2], ShardError> {
    let mut merge = Merge::new();
    for file in files {
        merge.add(file)?;
    }
    let merged = merge.finish()?;
    let [map, table] = ["merged.postures", "merged.parquet"].map(|name| folder.join(name));
    let _ = fs::remove_file(&map);
    merged.write_map(&map)?;
    merged.write_table(&table)?;
    Ok([map, table].map(|file| fs::read(file).expect("a file")))
}

#[test]
fn shards_of_any_number_and_order_merge_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, study) = (folder.path(), Study::new());
    let whole = merged(folder, &study.write(folder, 1)).expect("a map");
    // Some of nine shards have none of the five batches.
    for count in [2, 3, 9] {
        let mut files = study.write(folder, count);
        let again = study.write(folder, count);
        for (one, other) in files.iter().zip(&again) {
            assert_eq!(fs::read(one).expect("a file"), fs::read(other).expect("a file"));
        }
        files.rotate_left(1);
        files.reverse();
        assert!(merged(folder, &files).expect("a map") == whole, "{count} shards");
    }
    // The number of threads does not count.
    let shard: Shard = "2/3".parse().expect("a shard");
    let with_threads = |threads: usize| {
        let sweep = study.sweep().with_threads(NonZeroUsize::new(threads).expect("a number"));
        let batches: Vec<usize> = shard.range(sweep.batches()).collect();
        let mut rows = Vec::new();
        let _: ControlFlow<()> = sweep.run(&batches, |batch| {
            rows.extend(batch.rows);
            ControlFlow::Continue(())
        });
        shard_bytes(&study.mesh, &study.identity(), shard, rows)
    };
    assert!(with_threads(1) == with_threads(5));
    // The rows are those of a sweep into a map, which has them in the order of time.
    let map = PostureMap::open(folder.join("swept.postures"), &study.identity()).expect("a map");
    let mut rows = study.rows(0..study.sweep().batches());
    rows.reverse();
    map.record(&rows).expect("rows");
    let opened = PostureMap::read(folder.join("merged.postures")).expect("a map");
    assert_eq!(opened.identity(), map.identity());
    let all =
        |map: &PostureMap| map.rows().expect("rows").collect::<Result<Vec<_>, _>>().expect("rows");
    assert_eq!(all(&opened), all(&map));
    assert!(all(&map).iter().any(|(_, row)| row.best.len() == 3));
    let mut table = Vec::new();
    map.write_parquet(&mut table, &study.mesh).expect("a table");
    assert!(table == whole[1], "the table of the map");
    // A map is not written over another one.
    let mut merge = Merge::new();
    merge.add(&study.write(folder, 1)[0]).expect("a shard");
    let again = merge.finish().expect("all").write_map(folder.join("merged.postures"));
    assert!(matches!(again, Err(ShardError::Map(MapError::Exists { .. }))), "{again:?}");
}

#[test]
fn what_is_missing_twice_or_of_another_sweep_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, study) = (folder.path(), Study::new());
    let files = study.write(folder, 3);
    let error = |files: &[&PathBuf]| {
        let files: Vec<PathBuf> = files.iter().map(|file| (*file).clone()).collect();
        merged(folder, &files).expect_err("an error").to_string()
    };
    let missing = error(&[&files[2], &files[0]]);
    assert!(missing.contains("1 of 3 shards are left, the first of them 2/3"), "{missing}");
    let twice = error(&[&files[0], &files[1], &files[0]]);
    assert!(twice.ends_with("are both shard 1/3: give one of them"), "{twice}");
    let other_count = study.write(folder, 2);
    let message = error(&[&files[0], &other_count[1]]);
    assert!(message.contains("is shard 2/2, and"), "{message}");
    let text = folder.join("text.parquet");
    fs::write(&text, "triangle,tool\n").expect("a file");
    assert!(error(&[&text]).contains("is no shard of a sweep"));
    assert!(error(&[&folder.join("none.parquet")]).contains("cannot read"));
    assert!(error(&[]).contains("no shard is given that can be read"));
    merged(folder, &files).expect("a map");
    assert!(error(&[&folder.join("merged.parquet")]).contains("is the table of a whole map"));
    // Other rules, another part, other directions.
    let others: [(&str, Study); 3] = [
        (
            "other rules",
            Study { rules: Rules { tolerance: 0.06, ..study.rules.clone() }, ..Study::new() },
        ),
        ("other directions", Study { directions: Directions::spread(12), ..Study::new() }),
        ("another part", {
            let mesh = shapes::sphere(20.5, 3, Unit::Millimetre).expect("a sphere");
            Study { bvh: TriangleBvh::new(&mesh), mesh, ..Study::new() }
        }),
    ];
    for (what, other) in others {
        let path = folder.join("other.parquet");
        let shard = Shard::new(2, 3).expect("a shard");
        let rows = other.rows(shard.range(other.sweep().batches()));
        let bytes = shard_bytes(&other.mesh, &other.identity(), shard, rows);
        write_shard(&path, &bytes).expect("a shard");
        let message = error(&[&files[0], &path]);
        assert!(message.contains(what), "{what}: {message}");
        let done = is_done(&path, &study.identity(), shard);
        assert!(matches!(done, Err(ShardError::Differs { .. })), "{done:?}");
    }
    let shard = |text: &str| text.parse::<Shard>().expect("a shard");
    assert!(is_done(&files[1], &study.identity(), shard("2/3")).expect("a shard"));
    let other = is_done(&files[1], &study.identity(), shard("1/3"));
    assert!(matches!(other, Err(ShardError::OtherShard { .. })), "{other:?}");
    let cut = folder.join("cut.parquet");
    fs::write(&cut, &fs::read(&files[1]).expect("a file")[..500]).expect("a file");
    assert!(!is_done(&cut, &study.identity(), shard("2/3")).expect("a damaged file is replaced"));
    assert!(is_done(&text, &study.identity(), shard("2/3")).is_err());
    assert!(!is_done(folder.join("none.parquet"), &study.identity(), shard("1/3")).expect("none"));
    let mut merge = Merge::new();
    assert_eq!(merge.left().count(), 0);
    assert_eq!(merge.add(&files[1]).expect("a shard"), shard("2/3"));
    assert_eq!(merge.left().map(|shard| shard.to_string()).collect::<Vec<_>>(), ["1/3", "3/3"]);
}

/// A file that is cut off anywhere, or has one other bit, is refused.
#[test]
fn damaged_files_are_refused() {
    let study = Study::new();
    let shard = Shard::new(1, 5).expect("a shard");
    let mut rows = study.rows(shard.range(study.sweep().batches()));
    rows.truncate(12);
    let bytes = shard_bytes(&study.mesh, &study.identity(), shard, rows);
    table::read("whole", bytes.clone()).expect("a table");
    for length in 0..bytes.len() {
        let error = table::read("cut", bytes[..length].to_vec());
        assert!(matches!(error, Err(ShardError::Damaged { .. } | ShardError::Foreign { .. })));
    }
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        let error = table::read("changed", changed);
        assert!(
            matches!(error, Err(ShardError::Damaged { .. } | ShardError::Foreign { .. })),
            "byte {at}: {error:?}"
        );
    }
}
