//! Results of a sweep: comparisons with known ones, and their independence of the order of batches.

use crate::{
    BALL, HOLDER, MILL, NECK, cutting_distance, is_inside, parts, polyline_distance, sample_points,
};
use nalgebra::{Point3, Vector3};
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::sync::LazyLock;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Tool, TriangleId, Unit};
use touchoff_postures::sweep::{Batch, PostureSweep, SweepError, SweepStats};
use touchoff_postures::{Directions, MapRow, Rules, Validator, ValidatorError};

static LOLLIPOP: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Lollipop "most of a ball on a thin neck" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 9) center (0, 5) as ball cutting;
            line to (3, 40), (0, 40) as neck;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static STICK: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Stick "nothing of it cuts" {
        units mm;
        profile { start (0, 0); line to (3, 0), (3, 20), (0, 20) as stick; }
    }"#
    .parse()
    .expect("a tool")
});

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
    let (mut rows, mut stats) = (vec![None; triangles], SweepStats::default());
    for batches in orders {
        let _: ControlFlow<()> = sweep.run(batches, |batch: Batch| {
            stats += batch.stats;
            for (id, row) in batch.rows {
                assert!(rows[id.index()].replace(row).is_none(), "{id} comes twice");
            }
            ControlFlow::Continue(())
        });
    }
    (rows, stats)
}

/// Returns all rows of a part.
pub(crate) fn sweep_all(
    mesh: &Mesh,
    tools: &[&dyn Tool],
    directions: &Directions,
    rules: Rules,
) -> (Vec<MapRow>, SweepStats) {
    let bvh = TriangleBvh::new(mesh);
    let sweep =
        PostureSweep::new(mesh, &bvh, tools.to_vec(), directions, rules, keep(3)).expect("a sweep");
    let batches: Vec<usize> = (0..sweep.batches()).collect();
    let (rows, stats) = run(&sweep, mesh.triangles().len(), &[&batches]);
    (rows.into_iter().map(|row| row.expect("every triangle")).collect(), stats)
}

fn count(set: &[u64]) -> u32 {
    set.iter().map(|word| word.count_ones()).sum()
}

fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

/// Returns two meshes as one, with the second one's triangles reversed if `reverse` is set.
fn joined(first: &Mesh, second: &Mesh, reverse: bool) -> Mesh {
    let offset = first.vertices().len() as u32;
    let vertices = first.vertices().iter().chain(second.vertices()).copied();
    let moved = second.triangles().iter().map(|[a, b, c]| {
        let [a, b, c] = [a + offset, b + offset, c + offset];
        if reverse { [a, c, b] } else { [a, b, c] }
    });
    let triangles = first.triangles().iter().copied().chain(moved);
    Mesh::new(vertices, triangles, first.unit()).expect("a mesh")
}

#[test]
fn batches_do_not_depend_on_their_order() {
    let mesh = shapes::sphere(8.0, 3, Unit::Millimetre).expect("a sphere");
    let bvh = TriangleBvh::new(&mesh);
    let directions = Directions::spread(25);
    let tools: Vec<&dyn Tool> = vec![&*MILL, &*BALL];
    let sweep =
        PostureSweep::new(&mesh, &bvh, tools, &directions, rules(), keep(2)).expect("a sweep");
    assert_eq!(sweep.batches(), 5);
    let triangles = mesh.triangles().len();
    let (rows, stats) = run(&sweep, triangles, &[&[0, 1, 2, 3, 4]]);
    assert!(rows.iter().all(Option::is_some));
    assert_eq!(stats.postures(), 2 * 50 * triangles as u64);
    assert_eq!(stats.triangles, 2 * triangles as u64);
    let orders: [&[&[usize]]; 3] =
        [&[&[4, 3, 2, 1, 0]], &[&[2], &[0], &[4], &[1], &[3]], &[&[1, 3], &[], &[0, 2, 4]]];
    for order in orders {
        assert!(run(&sweep, triangles, order) == (rows.clone(), stats), "{order:?}");
    }
    // The sweep stops at a `Break`, and the batches until then are the same.
    let mut first = Vec::new();
    let stopped = sweep.run(&[0, 1, 2, 3, 4], |batch| {
        first.extend(batch.rows);
        ControlFlow::Break(7)
    });
    assert_eq!((stopped, first.len()), (ControlFlow::Break(7), 256));
    assert!(first.iter().all(|(id, row)| rows[id.index()].as_ref() == Some(row)));
}

#[test]
fn best_postures_are_acceptable_and_sorted() {
    let directions = Directions::spread(40);
    for mesh in parts() {
        let bvh = TriangleBvh::new(&mesh);
        let mut validator = Validator::new(&bvh, &*MILL, &rules()).expect("a validator");
        let sweep = |count| {
            PostureSweep::new(&mesh, &bvh, vec![&*MILL], &directions, rules(), keep(count))
                .expect("a sweep")
        };
        let rows = |sweep: &PostureSweep<'_>| {
            let batches: Vec<usize> = (0..sweep.batches()).collect();
            run(sweep, mesh.triangles().len(), &[&batches]).0
        };
        let (one, four) = (rows(&sweep(1)), rows(&sweep(4)));
        let mut checked = 0;
        for (one, four) in one.iter().flatten().zip(four.iter().flatten()) {
            let accessible = count(&four.access[0].directions) as usize;
            assert_eq!(four.best.len(), accessible.min(4));
            assert_eq!(one.best.len(), accessible.min(1));
            assert!(four.best.is_sorted_by(|a, b| a.niceness as f32 >= b.niceness as f32));
            for record in one.best.iter().chain(&four.best) {
                let pose = record.pose().expect("a pose");
                assert!(directions.list().contains(&record.axis), "not bit for bit");
                assert!(validator.accepts(&pose), "{record:?}");
                assert!(record.niceness > 0.5 && record.depth <= 0.0101, "{record:?}");
                checked += 1;
                if checked % 40 == 0 {
                    let (points, _) = sample_points(&mesh, &pose);
                    for point in points.into_iter().filter(|point| is_inside(*point)) {
                        let non_cutting =
                            polyline_distance(&NECK, point).min(polyline_distance(&HOLDER, point));
                        let cutting = cutting_distance(point);
                        assert!(
                            cutting <= non_cutting && cutting <= 0.01 + 1e-9,
                            "{record:?} {point:?}"
                        );
                    }
                }
            }
        }
        assert!(checked > 20, "{checked}");
    }
}

#[test]
fn enclosed_surfaces_are_not_reached() {
    let outer = block([-30.0; 3], [30.0; 3]);
    let directions = Directions::spread(60);
    // A cavity for which the tool is too long.
    let hollow = joined(&outer, &block([-10.0; 3], [10.0; 3]), true);
    let (rows, stats) = sweep_all(&hollow, &[&*MILL], &directions, rules());
    assert!(rows[..12].iter().all(|row| count(&row.access[0].directions) > 0));
    assert!(
        rows[12..].iter().all(|row| count(&row.access[0].directions) == 0 && row.best.is_empty())
    );
    assert!(stats.obstructed + stats.cached_obstruction > 0);
    // A ball without a shank fits into the cavity, where there is no material.
    let (rows, _) = sweep_all(&hollow, &[&*BALL], &directions, rules());
    assert!(rows[12..].iter().all(|row| count(&row.access[0].directions) > 0));
    // A body inside the material of another: no triangle is near the ball, and yet it is inside.
    let core = joined(&outer, &block([-10.0; 3], [10.0; 3]), false);
    let (rows, _) = sweep_all(&core, &[&*BALL], &directions, rules());
    assert!(rows[..12].iter().all(|row| count(&row.access[0].directions) > 0));
    assert!(rows[12..].iter().all(|row| count(&row.access[0].directions) == 0));
}

#[test]
fn a_plate_is_reached_from_all_directions_of_the_arc() {
    // A ball with 180 degrees of arc may have any axis, and one on a stem of its own width half of all axes.
    let plate = shapes::plane(0.01, 1, Unit::Millimetre).expect("a plate");
    let directions = Directions::spread(500);
    for (tool, expected) in [(&*BALL as &dyn Tool, 4.0), (&*MILL, 2.0), (&*LOLLIPOP, 2.0 * 1.8)] {
        let (rows, _) = sweep_all(&plate, &[tool], &directions, rules());
        for row in rows {
            let angle = directions.solid_angle(&row.access[0].directions) / std::f64::consts::PI;
            // A lollipop's normals end where their sine is 0.8; a cap's area is proportional to its height.
            assert!((angle - expected).abs() < 0.02, "{}: {angle}", tool.info().name);
        }
    }
}

#[test]
fn only_a_lollipop_reaches_an_undercut() {
    let up = Directions::from(vec![[0.0, 0.0, 1.0]]);
    let tilted = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let corners = [[0.0, -0.2], [0.0, 0.2], [0.4, 0.0]];
        let point_at =
            |[distance, y]: [f64; 2]| Point3::new(-distance * sine, y, distance * cosine);
        let mesh = Mesh::new(corners.map(point_at).to_vec(), vec![[0, 1, 2]], Unit::Millimetre)
            .expect("one");
        let normal = mesh.normal(TriangleId(0)).expect("an area");
        assert!(
            (normal - Vector3::new(-cosine, 0.0, -sine)).norm() < 1e-12
                || (normal - Vector3::new(cosine, 0.0, sine)).norm() < 1e-12,
            "{normal}"
        );
        let is_undercut = normal.z < 0.0;
        if is_undercut { mesh } else { reversed(&mesh) }
    };
    for (degrees, lollipop) in [(10.0, true), (50.0, true), (56.0, false), (80.0, false)] {
        let mesh = tilted(degrees);
        for (tool, expected) in [(&*LOLLIPOP as &dyn Tool, lollipop), (&*MILL, false)] {
            let (rows, stats) = sweep_all(&mesh, &[tool], &up, rules());
            let is_reached = count(&rows[0].access[0].directions) == 1;
            assert_eq!(is_reached, expected, "{} at {degrees}: {stats:?}", tool.info().name);
        }
    }
}

fn reversed(mesh: &Mesh) -> Mesh {
    let turned = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]);
    Mesh::new(mesh.vertices().to_vec(), turned, mesh.unit()).expect("a mesh")
}

#[test]
fn degenerate_triangles_are_not_reached() {
    let block = block([0.0; 3], [9.0; 3]);
    let mut triangles = block.triangles().to_vec();
    triangles.extend([[0, 0, 1], [2, 2, 2]]);
    let mesh = Mesh::new(block.vertices().to_vec(), triangles, Unit::Millimetre).expect("a mesh");
    let directions = Directions::spread(20);
    let (rows, stats) = sweep_all(&mesh, &[&*MILL], &directions, rules());
    assert_eq!(stats.postures(), 40 * 14);
    for row in &rows[12..] {
        assert!(row.best.is_empty() && count(&row.access[0].directions) == 0);
    }
    assert!(rows[..12].iter().all(|row| count(&row.access[0].directions) > 0));
}

#[test]
fn niceness_has_to_exceed_the_rule() {
    let directions = Directions::spread(30);
    let mesh = block([0.0; 3], [9.0; 3]);
    for (niceness, is_reached) in [(0.999, true), (1.0, false), (-1.0, true)] {
        let (rows, stats) = sweep_all(&mesh, &[&*MILL], &directions, Rules { niceness, ..rules() });
        assert_eq!(rows.iter().any(|row| !row.best.is_empty()), is_reached, "{niceness}");
        assert_eq!(stats.below_niceness > 0, !is_reached, "{niceness}");
        assert_eq!(stats.searched() + stats.cached_obstruction > 0, is_reached, "{niceness}");
    }
}

#[test]
fn larger_allowances_reach_more() {
    let directions = Directions::spread(60);
    // A block on a plate, so that the holder comes near the plate.
    let mesh = joined(
        &block([-40.0, -40.0, -5.0], [40.0, 40.0, 0.0]),
        &block([-4.0, -4.0, 0.5], [4.0, 4.0, 12.0]),
        false,
    );
    let sets = [-1.0, 0.0, 2.0, f64::INFINITY].map(|allowed| {
        let allowed = vec![("holder".to_owned(), allowed)];
        let (rows, _) = sweep_all(&mesh, &[&*MILL], &directions, Rules { allowed, ..rules() });
        rows.into_iter().flat_map(|row| row.access[0].directions.clone()).collect::<Vec<u64>>()
    });
    for pair in sets.windows(2) {
        assert!(pair[0].iter().zip(&pair[1]).all(|(smaller, larger)| smaller & !larger == 0));
        assert!(count(&pair[0]) < count(&pair[1]), "{} {}", count(&pair[0]), count(&pair[1]));
    }
}

#[test]
fn accessibility_does_not_depend_on_the_unit() {
    let directions = Directions::spread(40);
    let sets = [Unit::Millimetre, Unit::Inch, Unit::Metre].map(|unit| {
        let scale = Unit::Millimetre.factor_to(unit);
        let scaled = |mesh: Mesh| {
            let vertices = mesh.vertices().iter().map(|vertex| vertex * scale);
            Mesh::new(vertices, mesh.triangles().to_vec(), unit).expect("a mesh")
        };
        let mesh = scaled(shapes::tube(4.0, 6.0, 25.0, 24, 3, Unit::Millimetre).expect("a tube"));
        let rules = Rules { tolerance: 0.01 * scale, ..rules() };
        let (rows, _) = sweep_all(&mesh, &[&*MILL], &directions, rules);
        rows.into_iter().flat_map(|row| row.access[0].directions.clone()).collect::<Vec<u64>>()
    });
    assert!(count(&sets[0]) > 500);
    for set in &sets[1..] {
        let differences: u32 = set.iter().zip(&sets[0]).map(|(a, b)| (a ^ b).count_ones()).sum();
        // Postures within rounding of the tolerance may change.
        assert!(1000 * differences <= count(&sets[0]), "{differences} of {}", count(&sets[0]));
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
fn rejects_unsupported_tools_and_rules() {
    let mesh = block([0.0; 3], [9.0; 3]);
    let bvh = TriangleBvh::new(&mesh);
    let directions = Directions::spread(3);
    let error_of = |tools: Vec<&'static dyn Tool>, rules: Rules| {
        PostureSweep::new(&mesh, &bvh, tools, &directions, rules, keep(1)).expect_err("refused")
    };
    assert_eq!(error_of(vec![&*STICK], rules()), SweepError::NoCuttingSurface("Stick".into()));
    let invalid = Rules { tolerance: 0.0, ..rules() };
    assert!(matches!(error_of(vec![&*MILL], invalid), SweepError::Rules(_)));
    assert!(matches!(
        error_of(vec![&Round], rules()),
        SweepError::Validator(ValidatorError::Solid { .. })
    ));
}

#[test]
fn directions_are_spread_evenly() {
    for hemisphere in [1, 7, 200, 2_000, 5_000] {
        let directions = Directions::spread(hemisphere);
        let count = directions.list().len();
        assert_eq!(count, 2 * hemisphere.min(Directions::MAX_HEMISPHERE));
        let full = vec![u64::MAX; count.div_ceil(64)];
        let mut set = full.clone();
        if !count.is_multiple_of(64) {
            set[count / 64] = (1 << (count % 64)) - 1;
        }
        assert!((directions.solid_angle(&set) - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(directions.cone(&vec![0; full.len()]), None);
        let (_, half_angle) = directions.cone(&set).expect("all of them");
        assert_eq!(half_angle, std::f64::consts::PI);
        let vectors: Vec<Vector3<f64>> =
            directions.list().iter().map(|vector| Vector3::from(*vector)).collect();
        assert!(vectors.iter().all(|vector| (vector.norm() - 1.0).abs() < 1e-15));
        if (100..1000).contains(&count) {
            let sum: Vector3<f64> = vectors.iter().sum();
            assert!(sum.norm() < 0.01 * count as f64);
            // Every cap of a sixteenth of the sphere has its share of directions, within a quarter.
            for centre in &vectors {
                let count_in_cap =
                    vectors.iter().filter(|vector| vector.dot(centre) > 1.0 - 2.0 / 16.0).count();
                let expected = count as f64 / 16.0;
                assert!(
                    (count_in_cap as f64 - expected).abs() < 0.25 * expected,
                    "{count_in_cap} of {expected}"
                );
            }
        }
    }
}

#[test]
fn a_cone_is_centred_on_its_set() {
    let directions = Directions::spread(1_000);
    let centre = Vector3::new(0.3, -0.5, 0.8).normalize();
    for degrees in [10.0, 30.0, 80.0, 120.0] {
        let mut set = vec![0; directions.list().len().div_ceil(64)];
        for (k, direction) in directions.list().iter().enumerate() {
            if Vector3::from(*direction).angle(&centre) < f64::to_radians(degrees) {
                set[k / 64] |= 1 << (k % 64);
            }
        }
        let (axis, half_angle) = directions.cone(&set).expect("some");
        // 2,000 directions are some 4.5 degrees apart.
        assert!(Vector3::from(axis).angle(&centre).to_degrees() < 5.0, "{degrees}");
        assert!(
            (half_angle.to_degrees() - degrees).abs() < 6.0,
            "{degrees}: {}",
            half_angle.to_degrees()
        );
        let cap = 2.0 * std::f64::consts::PI * (1.0 - f64::to_radians(degrees).cos());
        assert!((directions.solid_angle(&set) - cap).abs() < 0.03, "{degrees}");
    }
}
