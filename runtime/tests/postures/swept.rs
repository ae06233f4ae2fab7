//! Results of a sweep: comparisons with known ones, and their independence of the order of batches.

use crate::{Ball, HOLDER, Mill, NECK, away, from_cutting, inside, parts, places};
use nalgebra::{Point3, Vector3};
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::postures::sweep::{Batch, PostureSweep, SweepError, SweepStats};
use touchoff::postures::{Directions, MapRow, Rules, Validator, ValidatorError};
use touchoff::{Mesh, Tool, TriangleId, Unit};

touchoff::tool! {
    tool Lollipop "most of a ball on a thin neck" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 9) center (0, 5) as ball cutting;
            line to (3, 40), (0, 40) as neck;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Stick "nothing of it cuts" {
        units mm;
        profile { start (0, 0); line to (3, 0), (3, 20), (0, 20) as stick; }
    }
}

fn rules() -> Rules {
    Rules { tolerance: 0.01, niceness: 0.5, allowed: Vec::new() }
}

fn keep(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).expect("not 0")
}

/// Runs batches in some orders, and returns the rows by triangle and the counters.
fn run(
    sweep: &PostureSweep<'_>,
    triangles: usize,
    orders: &[&[usize]],
) -> (Vec<Option<MapRow>>, SweepStats) {
    let (mut rows, mut tally) = (vec![None; triangles], SweepStats::default());
    for batches in orders {
        let _: ControlFlow<()> = sweep.run(batches, |batch: Batch| {
            tally += batch.stats;
            for (id, row) in batch.rows {
                assert!(rows[id as usize].replace(row).is_none(), "{id} comes twice");
            }
            ControlFlow::Continue(())
        });
    }
    (rows, tally)
}

/// Returns all rows of a part.
fn swept(
    mesh: &Mesh,
    tools: &[&dyn Tool],
    directions: &Directions,
    rules: Rules,
) -> (Vec<MapRow>, SweepStats) {
    let bvh = TriangleBvh::new(mesh);
    let sweep =
        PostureSweep::new(mesh, &bvh, tools.to_vec(), directions, rules, keep(3)).expect("a sweep");
    let all: Vec<usize> = (0..sweep.batches()).collect();
    let (rows, tally) = run(&sweep, mesh.triangles().len(), &[&all]);
    (rows.into_iter().map(|row| row.expect("every triangle")).collect(), tally)
}

fn count(set: &[u64]) -> u32 {
    set.iter().map(|word| word.count_ones()).sum()
}

fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

/// Returns two meshes as one, with the second one's triangles reversed if `turned`.
fn both(one: &Mesh, other: &Mesh, turned: bool) -> Mesh {
    let first = one.vertices().len() as u32;
    let vertices = one.vertices().iter().chain(other.vertices()).copied().collect();
    let more = other.triangles().iter().map(|[a, b, c]| {
        let [a, b, c] = [a + first, b + first, c + first];
        if turned { [a, c, b] } else { [a, b, c] }
    });
    let triangles = one.triangles().iter().copied().chain(more).collect();
    Mesh::new(vertices, triangles, one.unit()).expect("a mesh")
}

#[test]
fn batches_are_the_same_whichever_way_they_are_asked_for() {
    let mesh = shapes::sphere(8.0, 3, Unit::Millimetre).expect("a sphere");
    let bvh = TriangleBvh::new(&mesh);
    let directions = Directions::spread(25);
    let tools: Vec<&dyn Tool> = vec![&Mill, &Ball];
    let sweep =
        PostureSweep::new(&mesh, &bvh, tools, &directions, rules(), keep(2)).expect("a sweep");
    assert_eq!(sweep.batches(), 5);
    let triangles = mesh.triangles().len();
    let (rows, tally) = run(&sweep, triangles, &[&[0, 1, 2, 3, 4]]);
    assert!(rows.iter().all(Option::is_some));
    assert_eq!(tally.postures(), 2 * 50 * triangles as u64);
    assert_eq!(tally.triangles, 2 * triangles as u64);
    let orders: [&[&[usize]]; 3] =
        [&[&[4, 3, 2, 1, 0]], &[&[2], &[0], &[4], &[1], &[3]], &[&[1, 3], &[], &[0, 2, 4]]];
    for order in orders {
        assert!(run(&sweep, triangles, order) == (rows.clone(), tally), "{order:?}");
    }
    // The sweep stops when told, and the batches so far are the same.
    let mut first = Vec::new();
    let stopped = sweep.run(&[0, 1, 2, 3, 4], |batch| {
        first.extend(batch.rows);
        ControlFlow::Break(7)
    });
    assert_eq!((stopped, first.len()), (ControlFlow::Break(7), 256));
    assert!(first.iter().all(|(id, row)| rows[*id as usize].as_ref() == Some(row)));
}

#[test]
fn the_best_are_acceptable_bit_for_bit_and_of_more_the_same_are_first() {
    let directions = Directions::spread(40);
    for mesh in parts() {
        let bvh = TriangleBvh::new(&mesh);
        let mut judge = Validator::new(&bvh, &Mill, &rules()).expect("a judge");
        let sweep = |count| {
            PostureSweep::new(&mesh, &bvh, vec![&Mill], &directions, rules(), keep(count))
                .expect("a sweep")
        };
        let rows = |sweep: &PostureSweep<'_>| {
            let all: Vec<usize> = (0..sweep.batches()).collect();
            run(sweep, mesh.triangles().len(), &[&all]).0
        };
        let (one, four) = (rows(&sweep(1)), rows(&sweep(4)));
        let mut looked = 0;
        for (one, four) in one.iter().flatten().zip(four.iter().flatten()) {
            let reached = count(&four.access[0].directions) as usize;
            assert_eq!(four.best.len(), reached.min(4));
            assert_eq!(one.best.len(), reached.min(1));
            assert!(four.best.is_sorted_by(|a, b| a.niceness as f32 >= b.niceness as f32));
            for record in one.best.iter().chain(&four.best) {
                let pose = record.pose().expect("a pose");
                assert!(directions.list().contains(&record.axis), "not bit for bit");
                assert!(judge.accepts(&pose), "{record:?}");
                assert!(record.niceness > 0.5 && record.depth <= 0.0101, "{record:?}");
                looked += 1;
                if looked % 40 == 0 {
                    let (places, _) = places(&mesh, &pose);
                    for place in places.into_iter().filter(|place| inside(*place)) {
                        let still = away(&NECK, place).min(away(&HOLDER, place));
                        let cuts = from_cutting(place);
                        assert!(cuts <= still && cuts <= 0.01 + 1e-9, "{record:?} {place:?}");
                    }
                }
            }
        }
        assert!(looked > 20, "{looked}");
    }
}

#[test]
fn what_is_enclosed_is_not_reached() {
    let outer = block([-30.0; 3], [30.0; 3]);
    let directions = Directions::spread(60);
    // A cavity for which the tool is too long.
    let hollow = both(&outer, &block([-10.0; 3], [10.0; 3]), true);
    let (rows, tally) = swept(&hollow, &[&Mill], &directions, rules());
    assert!(rows[..12].iter().all(|row| count(&row.access[0].directions) > 0));
    assert!(
        rows[12..].iter().all(|row| count(&row.access[0].directions) == 0 && row.best.is_empty())
    );
    assert!(tally.obstructed + tally.cached_obstruction > 0);
    // A ball without a shank fits into the cavity, where there is no material.
    let (rows, _) = swept(&hollow, &[&Ball], &directions, rules());
    assert!(rows[12..].iter().all(|row| count(&row.access[0].directions) > 0));
    // A body inside the material of another: no triangle is near the ball, and yet it is inside.
    let core = both(&outer, &block([-10.0; 3], [10.0; 3]), false);
    let (rows, _) = swept(&core, &[&Ball], &directions, rules());
    assert!(rows[..12].iter().all(|row| count(&row.access[0].directions) > 0));
    assert!(rows[12..].iter().all(|row| count(&row.access[0].directions) == 0));
}

#[test]
fn a_ball_alone_stands_at_a_plate_in_every_direction_that_its_arc_has() {
    // A ball with 180 degrees of arc may have any axis, and one on a stem of its own width half of all axes.
    let plate = shapes::plane(0.01, 1, Unit::Millimetre).expect("a plate");
    let directions = Directions::spread(500);
    for (tool, wanted) in [(&Ball as &dyn Tool, 4.0), (&Mill, 2.0), (&Lollipop, 2.0 * 1.8)] {
        let (rows, _) = swept(&plate, &[tool], &directions, rules());
        for row in rows {
            let angle = directions.solid_angle(&row.access[0].directions) / std::f64::consts::PI;
            // A lollipop's normals end where their sine is 0.8; a cap's area is proportional to its height.
            assert!((angle - wanted).abs() < 0.02, "{}: {angle}", tool.info().name);
        }
    }
}

#[test]
fn an_undercut_is_reached_by_a_lollipop_and_by_no_ball_end() {
    let up = Directions::from(vec![[0.0, 0.0, 1.0]]);
    let tilted = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let corners = [[0.0, -0.2], [0.0, 0.2], [0.4, 0.0]];
        let place = |[along, y]: [f64; 2]| Point3::new(-along * sine, y, along * cosine);
        let mesh =
            Mesh::new(corners.map(place).to_vec(), vec![[0, 1, 2]], Unit::Millimetre).expect("one");
        let normal = mesh.normal(TriangleId(0)).expect("an area");
        assert!(
            (normal - Vector3::new(-cosine, 0.0, -sine)).norm() < 1e-12
                || (normal - Vector3::new(cosine, 0.0, sine)).norm() < 1e-12,
            "{normal}"
        );
        let under = normal.z < 0.0;
        if under { mesh } else { both_turned(&mesh) }
    };
    for (degrees, lollipop) in [(10.0, true), (50.0, true), (56.0, false), (80.0, false)] {
        let mesh = tilted(degrees);
        for (tool, wanted) in [(&Lollipop as &dyn Tool, lollipop), (&Mill, false)] {
            let (rows, tally) = swept(&mesh, &[tool], &up, rules());
            let found = count(&rows[0].access[0].directions) == 1;
            assert_eq!(found, wanted, "{} at {degrees}: {tally:?}", tool.info().name);
        }
    }
}

fn both_turned(mesh: &Mesh) -> Mesh {
    let turned = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    Mesh::new(mesh.vertices().to_vec(), turned, mesh.unit()).expect("a mesh")
}

#[test]
fn what_has_no_area_is_reached_from_nowhere() {
    let block = block([0.0; 3], [9.0; 3]);
    let mut triangles = block.triangles().to_vec();
    triangles.extend([[0, 0, 1], [2, 2, 2]]);
    let mesh = Mesh::new(block.vertices().to_vec(), triangles, Unit::Millimetre).expect("a mesh");
    let directions = Directions::spread(20);
    let (rows, tally) = swept(&mesh, &[&Mill], &directions, rules());
    assert_eq!(tally.postures(), 40 * 14);
    for row in &rows[12..] {
        assert!(row.best.is_empty() && count(&row.access[0].directions) == 0);
    }
    assert!(rows[..12].iter().all(|row| count(&row.access[0].directions) > 0));
}

#[test]
fn niceness_has_to_be_more_than_is_asked() {
    let directions = Directions::spread(30);
    let mesh = block([0.0; 3], [9.0; 3]);
    for (niceness, some) in [(0.999, true), (1.0, false), (-1.0, true)] {
        let (rows, tally) = swept(&mesh, &[&Mill], &directions, Rules { niceness, ..rules() });
        assert_eq!(rows.iter().any(|row| !row.best.is_empty()), some, "{niceness}");
        assert_eq!(tally.below_niceness > 0, !some, "{niceness}");
        assert_eq!(tally.searched() + tally.cached_obstruction > 0, some, "{niceness}");
    }
}

#[test]
fn the_more_is_allowed_the_more_is_reached() {
    let directions = Directions::spread(60);
    // A block on a plate, so that the holder comes near the plate.
    let mesh = both(
        &block([-40.0, -40.0, -5.0], [40.0, 40.0, 0.0]),
        &block([-4.0, -4.0, 0.5], [4.0, 4.0, 12.0]),
        false,
    );
    let sets = [-1.0, 0.0, 2.0, f64::INFINITY].map(|allowed| {
        let allowed = vec![("holder".to_owned(), allowed)];
        let (rows, _) = swept(&mesh, &[&Mill], &directions, Rules { allowed, ..rules() });
        rows.into_iter().flat_map(|row| row.access[0].directions.clone()).collect::<Vec<u64>>()
    });
    for pair in sets.windows(2) {
        assert!(pair[0].iter().zip(&pair[1]).all(|(less, more)| less & !more == 0));
        assert!(count(&pair[0]) < count(&pair[1]), "{} {}", count(&pair[0]), count(&pair[1]));
    }
}

#[test]
fn the_same_part_in_another_unit_is_reached_the_same() {
    let directions = Directions::spread(40);
    let sets = [Unit::Millimetre, Unit::Inch, Unit::Metre].map(|unit| {
        let scale = Unit::Millimetre.factor_to(unit);
        let scaled = |mesh: Mesh| {
            let vertices = mesh.vertices().iter().map(|place| place * scale).collect();
            Mesh::new(vertices, mesh.triangles().to_vec(), unit).expect("a mesh")
        };
        let mesh = scaled(shapes::tube(4.0, 6.0, 25.0, 24, 3, Unit::Millimetre).expect("a tube"));
        let rules = Rules { tolerance: 0.01 * scale, ..rules() };
        let (rows, _) = swept(&mesh, &[&Mill], &directions, rules);
        rows.into_iter().flat_map(|row| row.access[0].directions.clone()).collect::<Vec<u64>>()
    });
    assert!(count(&sets[0]) > 500);
    for set in &sets[1..] {
        let other: u32 = set.iter().zip(&sets[0]).map(|(a, b)| (a ^ b).count_ones()).sum();
        // Postures within rounding of the tolerance may change.
        assert!(1000 * other <= count(&sets[0]), "{other} of {}", count(&sets[0]));
    }
}

touchoff::tool! {
    solid Round "a ball without an axis" {
        units mm;
        curve ball = hypot(x, y, z) - 1;
        region all as ball cutting where ball <= 0 { depth: -ball; }
        niceness cutting: 1;
    }
}

#[test]
fn what_cannot_be_swept_says_why() {
    let mesh = block([0.0; 3], [9.0; 3]);
    let bvh = TriangleBvh::new(&mesh);
    let directions = Directions::spread(3);
    let refused = |tools: Vec<&'static dyn Tool>, rules: Rules| {
        PostureSweep::new(&mesh, &bvh, tools, &directions, rules, keep(1)).expect_err("refused")
    };
    assert_eq!(refused(vec![&Stick], rules()), SweepError::NoCuttingSurface("Stick".into()));
    let none = Rules { tolerance: 0.0, ..rules() };
    assert!(matches!(refused(vec![&Mill], none), SweepError::Rules(_)));
    assert!(matches!(
        refused(vec![&Round], rules()),
        SweepError::Validator(ValidatorError::Solid { .. })
    ));
}

#[test]
fn directions_are_spread_evenly_and_none_is_lost() {
    for hemisphere in [1, 7, 200, 2_000, 5_000] {
        let directions = Directions::spread(hemisphere);
        let count = directions.list().len();
        assert_eq!(count, 2 * hemisphere.min(Directions::MOST));
        let all = vec![u64::MAX; count.div_ceil(64)];
        let mut set = all.clone();
        if !count.is_multiple_of(64) {
            set[count / 64] = (1 << (count % 64)) - 1;
        }
        assert!((directions.solid_angle(&set) - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(directions.cone(&vec![0; all.len()]), None);
        let (_, half) = directions.cone(&set).expect("all of them");
        assert_eq!(half, std::f64::consts::PI);
        let ways: Vec<Vector3<f64>> =
            directions.list().iter().map(|way| Vector3::from(*way)).collect();
        assert!(ways.iter().all(|way| (way.norm() - 1.0).abs() < 1e-15));
        if (100..1000).contains(&count) {
            let sum: Vector3<f64> = ways.iter().sum();
            assert!(sum.norm() < 0.01 * count as f64);
            // Every cap of a sixteenth of the sphere has its share of directions, within a quarter.
            for middle in &ways {
                let inside = ways.iter().filter(|way| way.dot(middle) > 1.0 - 2.0 / 16.0).count();
                let share = count as f64 / 16.0;
                assert!((inside as f64 - share).abs() < 0.25 * share, "{inside} of {share}");
            }
        }
    }
}

#[test]
fn a_cone_is_about_the_middle_of_its_set() {
    let directions = Directions::spread(1_000);
    let middle = Vector3::new(0.3, -0.5, 0.8).normalize();
    for degrees in [10.0, 30.0, 80.0, 120.0] {
        let mut set = vec![0; directions.list().len().div_ceil(64)];
        for (k, way) in directions.list().iter().enumerate() {
            if Vector3::from(*way).angle(&middle) < f64::to_radians(degrees) {
                set[k / 64] |= 1 << (k % 64);
            }
        }
        let (axis, half) = directions.cone(&set).expect("some");
        // 2,000 directions are some 4.5 degrees apart.
        assert!(Vector3::from(axis).angle(&middle).to_degrees() < 5.0, "{degrees}");
        assert!((half.to_degrees() - degrees).abs() < 6.0, "{degrees}: {}", half.to_degrees());
        let cap = 2.0 * std::f64::consts::PI * (1.0 - f64::to_radians(degrees).cos());
        assert!((directions.solid_angle(&set) - cap).abs() < 0.03, "{degrees}");
    }
}
