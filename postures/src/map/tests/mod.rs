mod exported;
mod full;
mod pieces;
mod read;
mod refused;

use super::open::write_facts;
use super::*;
use crate::Rules;
use nalgebra::Point3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use redb::Builder;
use std::fs::{self, File};
use std::io;
use std::num::NonZeroU16;
use std::sync::LazyLock;
use tempfile::TempDir;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, TriangleId, Unit};

pub(crate) static BALL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Ball "a ball on a straight shank" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 20), (0, 20) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

pub(crate) static FLAT: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Flat "flat" {
        units mm;
        profile { start (0, 0); line to (4, 0), (4, 20), (0, 20) as side cutting; }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

/// Returns a mesh of twelve triangles.
fn block() -> Mesh {
    shapes::cuboid(Point3::origin(), Point3::new(9.0, 8.0, 7.0), Unit::Millimetre).expect("a mesh")
}

fn rules() -> Rules {
    Rules { tolerance: 0.01, niceness: 0.25, allowed: vec![("shank".into(), -0.5)] }
}

/// Returns an identity with two tools, 70 directions and three postures per triangle.
fn identity() -> MapIdentity {
    let directions = (0..70).map(|k| (f64::from(k) / 10.0).sin_cos()).map(|(x, y)| [x, y, 0.0]);
    MapIdentity::new(&block(), &[&*BALL, &*FLAT], rules())
        .expect("rules")
        .with_directions(directions.collect())
        .with_keep(NonZeroU16::new(3).expect("not 0"))
}

struct Place(TempDir);

impl Place {
    fn new() -> Place {
        Place(tempfile::tempdir().expect("a folder"))
    }

    fn path(&self) -> std::path::PathBuf {
        self.0.path().join("a.postures")
    }

    fn open(&self) -> PostureMap {
        PostureMap::open(self.path(), &identity()).expect("a map")
    }

    fn error(&self) -> MapError {
        PostureMap::open(self.path(), &identity()).expect_err("it should be refused")
    }
}

fn part(random: &mut Pcg64Mcg) -> f64 {
    random.next_u64() as f64 / u64::MAX as f64
}

fn any_record(random: &mut Pcg64Mcg) -> PostureRecord {
    let tip = [0; 3].map(|_| 20.0 * part(random) - 10.0);
    let (x, z) = (6.0 * part(random)).sin_cos();
    PostureRecord {
        tool: (random.next_u32() % 2) as u16,
        tip,
        axis: [x, 0.0, z],
        // Few values, so that some are equal.
        niceness: f64::from(random.next_u32() % 4) / 3.0,
        depth: part(random) / 1e3,
        clearance: if random.next_u32().is_multiple_of(4) { f64::INFINITY } else { part(random) },
    }
}

fn any_row(random: &mut Pcg64Mcg) -> MapRow {
    let access = |tool: u16, random: &mut Pcg64Mcg| Accessibility {
        tool,
        directions: vec![random.next_u64(), random.next_u64() & 0b11_1111],
        stickout: (tool == 0).then(|| 30.0 * part(random)),
    };
    let best = (0..random.next_u32() % 3).map(|_| any_record(random)).collect();
    MapRow { best, access: vec![access(0, random), access(1, random)] }
}

fn rows(map: &PostureMap) -> Vec<(TriangleId, MapRow)> {
    map.rows().expect("rows").collect::<Result<_, _>>().expect("rows that are whole")
}

#[test]
fn what_is_recorded_is_there_when_it_is_opened_again() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(1));
    let given: Vec<(TriangleId, MapRow)> =
        (0..9).map(|k| (TriangleId(k), any_row(&mut random))).collect();
    let first = {
        let map = place.open();
        map.record(&given[..5]).expect("recorded");
        map.record(&given[5..]).expect("recorded");
        rows(&map)
    };
    for ((triangle, row), (of, given)) in first.iter().zip(&given) {
        assert_eq!((triangle, &row.access), (of, &given.access));
        assert_eq!(row.best.len(), given.best.len());
        assert!(given.best.iter().all(|record| row.best.contains(record)));
    }
    let map = place.open();
    assert_eq!(rows(&map), first);
    assert_eq!(map.identity(), &identity());
    assert_eq!(map.row(TriangleId(3)).expect("read"), Some(first[3].1.clone()));
    assert_eq!(map.row(TriangleId(9)).expect("read"), None);
    let covered = first.iter().filter(|(_, row)| !row.best.is_empty()).count() as u32;
    assert_eq!(
        map.coverage().expect("read"),
        Coverage { covered, swept: 9, triangles: 12, ..Coverage::default() }
    );
    let swept = map.swept().expect("read");
    assert!(swept.into_iter().eq((0..9).map(TriangleId)));
}

#[test]
fn the_same_postures_stay_in_whatever_order_they_come() {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    let mut records: Vec<(TriangleId, PostureRecord)> =
        (0..200).map(|_| (TriangleId(random.next_u32() % 12), any_record(&mut random))).collect();
    let mut found = Vec::new();
    for size in [200, 7, 1] {
        let place = Place::new();
        let map = place.open();
        records.chunks(size).for_each(|some| map.merge(some).expect("recorded"));
        // Merging the same records once more changes nothing.
        map.merge(&records).expect("recorded");
        found.push(rows(&map));
        let shift = 1 + random.next_u32() as usize % 100;
        records.rotate_left(shift);
        records.reverse();
    }
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
    for (triangle, row) in &found[0] {
        let of = records.iter().filter(|(of, _)| of == triangle).map(|(_, record)| record);
        let mut all: Vec<&PostureRecord> = of.collect();
        all.sort_by(|one, other| other.niceness.total_cmp(&one.niceness));
        let nicest: Vec<f64> = all.iter().take(3).map(|record| record.niceness).collect();
        let kept: Vec<f64> = row.best.iter().map(|record| record.niceness).collect();
        assert_eq!(kept, nicest);
    }
}

#[test]
fn of_equally_nice_postures_the_clearer_and_then_the_less_deep_stays() {
    let place = Place::new();
    let once = identity().with_keep(NonZeroU16::MIN);
    let map = PostureMap::open(place.path(), &once).expect("a map");
    let record = |niceness, clearance, depth, tool| PostureRecord {
        tool,
        tip: [0.0; 3],
        axis: [0.0, 0.0, 1.0],
        niceness,
        depth,
        clearance,
    };
    let order = [
        record(0.5, 9.0, 0.0, 0),
        record(0.6, 1.0, 0.02, 1),
        record(0.6, 2.0, 0.02, 1),
        record(0.6, 2.0, 0.01, 1),
        record(0.6, 2.0, 0.01, 0),
    ];
    for record in order {
        map.merge(&[(TriangleId(0), record)]).expect("recorded");
        assert_eq!(map.row(TriangleId(0)).expect("read").expect("a row").best, [record]);
    }
    order.iter().for_each(|record| map.merge(&[(TriangleId(0), *record)]).expect("recorded"));
    assert_eq!(map.row(TriangleId(0)).expect("read").expect("a row").best, [order[4]]);
}

#[test]
fn a_sweep_and_a_hand_do_not_take_from_each_other() {
    let (place, mut random) = (Place::new(), Pcg64Mcg::seed_from_u64(3));
    let map = place.open();
    let nice = PostureRecord { niceness: 2.0, ..any_record(&mut random) };
    map.merge(&[(TriangleId(4), nice)]).expect("recorded");
    assert!(!map.swept().expect("read").contains(&TriangleId(4)));
    let row = any_row(&mut random);
    map.record(&[(TriangleId(4), row.clone())]).expect("recorded");
    let found = map.row(TriangleId(4)).expect("read").expect("a row");
    assert_eq!(found.best[0], nice);
    assert_eq!(found.access, row.access);
    let again = MapRow { best: Vec::new(), ..any_row(&mut random) };
    map.record(&[(TriangleId(4), again.clone())]).expect("recorded");
    let known = map.row(TriangleId(4)).expect("read").expect("a row");
    assert_eq!(known, MapRow { access: again.access, ..found });
}

#[test]
fn a_part_is_another_when_a_bit_of_a_corner_is() {
    let mesh = block();
    let own = PartFingerprint::of(&mesh);
    let (vertices, triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    let of = |vertices: &[Point3<f64>], triangles: &[[u32; 3]], unit| {
        PartFingerprint::of(
            &Mesh::new(vertices.to_vec(), triangles.to_vec(), unit).expect("a mesh"),
        )
    };
    assert_eq!(of(&vertices, &triangles, Unit::Millimetre), own);
    // A duplicated vertex leaves the corners the same.
    let mut twice = vertices.clone();
    twice.push(vertices[triangles[0][0] as usize]);
    let mut other = triangles.clone();
    other[0][0] = vertices.len() as u32;
    assert_eq!(of(&twice, &other, Unit::Millimetre), own);
    let mut moved = vertices.clone();
    moved[1].y = moved[1].y.next_up();
    assert_ne!(of(&moved, &triangles, Unit::Millimetre).digest, own.digest);
    let mut swapped = triangles.clone();
    swapped.swap(0, 1);
    assert_ne!(of(&vertices, &swapped, Unit::Millimetre).digest, own.digest);
    assert_ne!(of(&vertices, &triangles, Unit::Inch).digest, own.digest);
}
