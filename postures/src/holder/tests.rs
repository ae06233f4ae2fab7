//! Stick-outs: closed forms, and a comparison with sample points of triangles.

use super::*;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::LazyLock;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::tool::Surface;
use touchoff::{Mesh, Tool, TriangleId, Unit};

static DISC: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Disc "a ball in a holder with a flat face" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 12) as flute cutting;
            line to (3, 30) as shank;
            line to (10, 30), (10, 50), (0, 50) as nut;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static NUT: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Nut "a ball in a holder that widens" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 12) as flute cutting;
            line to (3, 30) as shank;
            line to (5, 30), (9, 38) as nut;
            arc to (12, 41) center (9, 41) as nut;
            line to (12, 50), (8, 54), (8, 60), (20, 61), (20, 80), (0, 80) as nut;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static LIP: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Lip "a holder with a round lip: lower than where its arc begins and ends" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 30) as shank;
            line to (6, 30), (8, 32) as nut;
            arc to (14, 32) center (11, 34) as nut;
            line to (14, 50), (0, 50) as nut;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

/// Returns the info of a tool whose holder is named as a mounted component.
fn mounted(tool: &dyn Tool) -> ToolInfo {
    let mut info = tool.info().clone();
    let surfaces = info.surfaces.iter().map(|surface| {
        let mount = if surface.name == "nut" { "nut" } else { "cutter" };
        Surface { name: format!("{mount}.{}", surface.name).into(), ..surface.clone() }
    });
    info.surfaces = surfaces.collect();
    info
}

/// Returns sample points of a holder's outline as `[d, z]`, in the tool's unit.
fn outline(info: &ToolInfo) -> Vec<[f64; 2]> {
    const PLACES: u32 = 64;
    let own =
        info.outline.iter().filter(|piece| info.surfaces[piece.surface.0].name.starts_with("nut"));
    let places = own.flat_map(|piece| {
        (0..=PLACES).map(|k| {
            let part = f64::from(k) / f64::from(PLACES);
            let Some(arc) = piece.circle else {
                return [0, 1].map(|k| piece.from[k] + (piece.to[k] - piece.from[k]) * part);
            };
            let angle = |at: [f64; 2]| (at[1] - arc.centre[1]).atan2(at[0] - arc.centre[0]);
            let (from, to) = (angle(piece.from), angle(piece.to));
            let turn = if arc.convex { 1.0 } else { -1.0 };
            let sweep = (turn * (to - from)).rem_euclid(2.0 * std::f64::consts::PI);
            let (sine, cosine) = (from + turn * sweep * part).sin_cos();
            [arc.centre[0] + arc.radius * cosine, arc.centre[1] + arc.radius * sine]
        })
    });
    places.collect()
}

/// Returns the stick-out that a point requires at a distance `d` from the axis and a height `z` above the tip:
/// its height less the height of the outline above the nose. Each point of the outline is taken to continue
/// upward.
fn needed(outline: &[[f64; 2]], [d, z]: [f64; 2]) -> f64 {
    let nose = outline.iter().map(|place| place[1]).fold(f64::INFINITY, f64::min);
    let above = outline.iter().filter(|place| d <= place[0]);
    above.map(|place| z - (place[1] - nose)).fold(f64::NEG_INFINITY, f64::max)
}

fn least(info: &ToolInfo, mesh: &Mesh, tip: [f64; 3], axis: Vector3<f64>) -> f64 {
    let length = info.unit.factor_to(mesh.unit());
    let holder = Holder::new(info, length).expect("a holder");
    needed_by(&holder, &TriangleBvh::new(mesh), &Point3::from(tip), &axis.normalize())
}

/// Returns the stick-out for one posture.
fn needed_by(holder: &Holder, bvh: &TriangleBvh, tip: &Point3<f64>, axis: &Vector3<f64>) -> f64 {
    // The tool is long enough.
    let holder = Holder { stickout: f64::INFINITY, ..holder.clone() };
    LeastStickout::new(holder, bvh).of([(*tip, *axis)]).expect("one posture")
}

fn cuboid(low: [f64; 3], high: [f64; 3], unit: Unit) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), unit).expect("a cuboid")
}

#[test]
fn a_flat_holder_stays_above_the_highest_that_it_covers() {
    let info = mounted(&*DISC);
    // The tip is at the foot of a step 20 high, at a distance of `away`.
    for (away, wanted) in [(5.0, 20.0), (9.5, 20.0), (10.5, 12.0), (40.0, 12.0)] {
        let step = cuboid([away, -50.0, -5.0], [away + 50.0, 50.0, 20.0], Unit::Millimetre);
        let found = least(&info, &step, [0.0; 3], Vector3::z());
        assert!((found - wanted).abs() < 1e-12, "{away}: {found}");
    }
    // Points below the highest cutting point require no more stick-out.
    let low = cuboid([5.0, -50.0, -5.0], [50.0, 50.0, 8.0], Unit::Millimetre);
    assert!((least(&info, &low, [0.0; 3], Vector3::z()) - 12.0).abs() < 1e-9);
}

#[test]
fn a_wall_that_leans_asks_for_more_the_nearer_it_comes() {
    let info = mounted(&*DISC);
    let step = cuboid([6.0, -50.0, -5.0], [56.0, 50.0, 20.0], Unit::Millimetre);
    let mut last = 0.0;
    for degrees in [-40.0, -20.0, 0.0, 20.0, 40.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        let found = least(&info, &step, [0.0; 3], Vector3::new(sine, 0.0, cosine));
        assert!(found >= last - 1e-12, "{degrees}: {found} after {last}");
        last = found;
    }
}

#[test]
fn a_plane_that_leans_is_highest_at_the_rim() {
    let info = mounted(&*DISC);
    // The top is 35 above the tip, so that it is above the cutter, too, wherever the rim meets it.
    let block = cuboid([-90.0, -90.0, -90.0], [90.0, 90.0, 35.0], Unit::Millimetre);
    for degrees in [0.0, 1e-9, 15.0, 40.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        let found = least(&info, &block, [0.0; 3], Vector3::new(0.6 * sine, -0.8 * sine, cosine));
        let wanted = (35.0 + 10.0 * sine) / cosine;
        assert!((found - wanted).abs() < 1e-9, "{degrees}: {found}, not {wanted}");
    }
}

/// Returns sample points of a mesh, at most `apart` from each other along the sides of each triangle.
fn raster(mesh: &Mesh, apart: f64) -> Vec<Point3<f64>> {
    let mut all = Vec::new();
    for id in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let size = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let count = (size / apart).ceil();
        for i in 0..=count as u32 {
            for j in 0..=count as u32 - i {
                all.push(a + (b - a) * (f64::from(i) / count) + (c - a) * (f64::from(j) / count));
            }
        }
    }
    all
}

#[test]
fn no_place_of_a_part_needs_more_and_one_beside_it_as_much() {
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let mut draw =
        |low: f64, high: f64| low + (high - low) * (random.next_u64() as f64 / u64::MAX as f64);
    let meshes = [
        cuboid([-30.0, -20.0, -25.0], [30.0, 20.0, 0.0], Unit::Millimetre),
        shapes::sphere(18.0, 3, Unit::Millimetre).expect("a sphere"),
        shapes::tube(12.0, 25.0, 40.0, 24, 3, Unit::Millimetre).expect("a tube"),
    ];
    let tools: [&dyn Tool; 3] = [&*DISC, &*NUT, &*LIP];
    let mut more = 0;
    for tool in tools {
        let info = mounted(tool);
        let name = &info.name;
        let outline = outline(&info);
        let holder = Holder::new(&info, 1.0).expect("a holder");
        for mesh in &meshes {
            let bvh = TriangleBvh::new(mesh);
            let places = raster(mesh, 1.0);
            for _ in 0..30 {
                let tip = Point3::from(Vector3::from_fn(|_, _| draw(-30.0, 30.0)));
                let axis = Vector3::from_fn(|_, _| draw(-1.0, 1.0)).normalize();
                let found = needed_by(&holder, &bvh, &tip, &axis);
                let [mut true_least, mut near] = [holder.cutting; 2];
                for place in &places {
                    let way = place - tip;
                    let z = way.dot(&axis);
                    let d = (way - axis * z).norm();
                    true_least = true_least.max(needed(&outline, [d, z]));
                    // A sample point is at most 1 away.
                    near = near.max(needed(&outline, [(d - 1.0).max(0.0), z + 1.0]));
                }
                let at = format!("{name} at {tip:?} {axis:?}");
                assert!(found >= true_least - 1e-9, "{found}, needed {true_least}: {at}");
                assert!(name != "Disc" || found <= near, "{found}, at most {near}: {at}");
                more += u32::from(true_least > 12.5);
            }
        }
    }
    assert!(more > 50, "{more}");
}

#[test]
fn the_unit_of_the_part_is_that_of_the_answer() {
    let info = mounted(&*NUT);
    let axis = Vector3::new(0.2, 0.1, 1.0);
    let of = |unit: Unit| {
        let scale = Unit::Millimetre.factor_to(unit);
        let step = cuboid(
            [6.0, -50.0, -5.0].map(|part| part * scale),
            [56.0, 50.0, 20.0].map(|part| part * scale),
            unit,
        );
        least(&info, &step, [0.0; 3], axis) / scale
    };
    let wanted = of(Unit::Millimetre);
    for unit in [Unit::Inch, Unit::Metre] {
        assert!((of(unit) - wanted).abs() < 1e-9, "{unit}: {}, not {wanted}", of(unit));
    }
}

#[test]
fn the_least_of_all_postures_counts_in_any_order() {
    let info = mounted(&*NUT);
    let holder = Holder::new(&info, 1.0).expect("a holder");
    let bvh = TriangleBvh::new(&cuboid([5.0, -50.0, -5.0], [55.0, 50.0, 20.0], Unit::Millimetre));
    let mut postures: Vec<_> = (0..40)
        .map(|k| {
            let (sine, cosine) = (0.02 * f64::from(k - 5)).sin_cos();
            (
                Point3::new(0.2 * f64::from(k % 7), f64::from(k), 0.0),
                Vector3::new(sine, 0.0, cosine),
            )
        })
        .collect();
    let each = postures.iter().map(|(tip, axis)| needed_by(&holder, &bvh, tip, axis));
    let wanted = each.fold(f64::INFINITY, f64::min);
    assert!(wanted > 12.0 && wanted < 30.0, "{wanted}");
    let mut stickout = LeastStickout::new(holder.clone(), &bvh);
    assert_eq!(stickout.of([]), None);
    for _ in 0..postures.len() {
        postures.rotate_left(1);
        assert_eq!(stickout.of(postures.iter().copied()), Some(wanted));
        assert_eq!(
            LeastStickout::new(holder.clone(), &bvh).of(postures.iter().copied()),
            Some(wanted)
        );
    }
    // At a wall that is higher than the tool is long, the tool as it is counts, which was validated.
    let wall = TriangleBvh::new(&cuboid([5.0, -50.0, -5.0], [55.0, 50.0, 90.0], Unit::Millimetre));
    let upright = [(Point3::origin(), Vector3::z())];
    assert_eq!(LeastStickout::new(holder, &wall).of(upright), Some(30.0));
    assert!(Holder::new(NUT.info(), 1.0).is_none());
}
