//! Contacts of tools, and their niceness: closed forms, and a check that no point beside the contact is cut.

use super::*;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::LazyLock;
use touchoff::tool::Interpreted;

static BALL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Ball "a ball on a straight shank" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 9) as flute cutting;
            line to (3, 20), (0, 20) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static BULL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Bull "a bull nose" {
        units mm;
        profile {
            start (0, 0);
            line to (4, 0) as face cutting;
            arc to (6, 2) center (4, 2) as corner cutting;
            line to (6, 20) as flute cutting;
            line to (6, 30), (0, 30) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static FLAT: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Flat "a flat end, sharp, in inches" {
        units inch;
        profile {
            start (0, 0);
            line to (0.25, 0) as face cutting;
            line to (0.25, 1) as flute cutting;
            line to (0.25, 2), (0, 2) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static POINT: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Point "a cone of 90 degrees" {
        units mm;
        profile {
            start (0, 0);
            line to (3, 3) as cone cutting;
            line to (3, 20), (0, 20) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

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

static STEPS: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Steps "two steps, both sharp, and what is cut away" {
        units mm;
        profile {
            start (0, 0);
            line to (2, 0) as face cutting;
            line to (2, 4), (5, 4), (5, 8) as step cutting;
            arc to (8, 11) center (8, 8) concave as cove cutting;
            line to (8, 20), (0, 20) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

fn draws() -> impl FnMut(f64, f64) -> f64 {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    move |low, high| low + (high - low) * (random.next_u64() as f64 / u64::MAX as f64)
}

fn unit(draw: &mut impl FnMut(f64, f64) -> f64) -> Vector3<f64> {
    loop {
        let way = Vector3::from_fn(|_, _| draw(-1.0, 1.0));
        if (0.1..1.0).contains(&way.norm()) {
            return way.normalize();
        }
    }
}

/// Returns per point in the world whether it is inside a tool.
fn inside(
    tool: &dyn Tool,
    tip: Point3<f64>,
    axis: Vector3<f64>,
    places: &[Point3<f64>],
) -> Vec<bool> {
    let mut points = PointBatch::default();
    let length = tool.info().unit.factor_to(Unit::Millimetre);
    for place in places {
        let way = (place - tip) / length;
        let z = way.dot(&axis);
        points.push([(way - axis * z).norm(), 0.0, z]);
    }
    let mut evaluations = Evaluations::default();
    tool.evaluate(Level::new(), Outputs::INSIDE, &points, length, &mut evaluations);
    let mut all = vec![false; places.len()];
    evaluations.inside_indices().for_each(|place| all[place] = true);
    all
}

/// Returns the contacts between a tool and the plane through a point, in mm.
fn contacts(
    tool: &dyn Tool,
    place: Point3<f64>,
    normal: Vector3<f64>,
    axis: Vector3<f64>,
) -> Vec<Contact> {
    let info = tool.info();
    ContactSites::new(info, info.unit.factor_to(Unit::Millimetre))
        .contacts(place, normal, axis)
        .collect()
}

/// Returns an axis at an angle in degrees to the normal +z.
fn leaning(degrees: f64) -> Vector3<f64> {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    Vector3::new(sine, 0.0, cosine)
}

#[test]
fn below_the_place_is_the_tool_and_above_beside_it_the_face() {
    let mut draw = draws();
    let tools: [&dyn Tool; 6] = [&*BALL, &*BULL, &*FLAT, &*POINT, &*LOLLIPOP, &*STEPS];
    for tool in tools {
        let size = tool.info().size() * tool.info().unit.factor_to(Unit::Millimetre);
        let mut stood = 0;
        for _ in 0..3_000 {
            let place = Point3::from(unit(&mut draw) * 40.0);
            let (normal, axis) = (unit(&mut draw), unit(&mut draw));
            for contact in contacts(tool, place, normal, axis) {
                stood += 1;
                let mut places = vec![place + normal * (1e-6 * size)];
                for _ in 0..16 {
                    let way = unit(&mut draw);
                    let along = way - normal * way.dot(&normal);
                    places.push(place + along * (1e-5 * size) - normal * (1e-9 * size));
                }
                let inside = inside(tool, contact.tip, axis, &places);
                let text = format!("{} {normal:?} {axis:?}", tool.info().name);
                assert!(inside[0], "not at its place: {text}");
                assert!(!inside[1..].contains(&true), "beyond the face: {text}");
                let tool_unit = size / tool.info().size();
                let mut evaluations = Evaluations::default();
                let mut points = PointBatch::default();
                for [d, z] in contact.within {
                    points.push([d / tool_unit, 0.0, z / tool_unit]);
                }
                tool.evaluate(Level::new(), Outputs::INSIDE, &points, 1.0, &mut evaluations);
                assert_eq!(evaluations.inside_indices().count(), 2, "a place is outside: {text}");
            }
        }
        assert!(stood > 300, "{}: {stood}", tool.info().name);
    }
}

#[test]
fn a_ball_stands_as_high_as_its_middle_whichever_way_it_leans() {
    let place = Point3::new(1.0, 2.0, 3.0);
    for degrees in [0.0, 1e-9, 10.0, 45.0, 89.9] {
        let axis = leaning(degrees);
        let all = contacts(&*BALL, place, Vector3::z(), axis);
        assert_eq!(all.len(), 1, "{degrees}");
        let middle = all[0].tip + axis * 3.0;
        assert!((middle - (place + Vector3::z() * 3.0)).norm() < 1e-12, "{degrees}");
    }
    // Beyond a right angle the flute is in the way.
    assert!(contacts(&*BALL, place, Vector3::z(), leaning(90.1)).is_empty());
    assert!(contacts(&*BALL, place, Vector3::z(), -Vector3::z()).is_empty());
}

#[test]
fn a_bull_nose_that_leans_stands_on_its_corners_arc() {
    for degrees in [1.0, 30.0, 89.0] {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        let axis = leaning(degrees);
        let all = contacts(&*BULL, Point3::origin(), Vector3::z(), axis);
        assert_eq!(all.len(), 1, "{degrees}");
        // The arc's centre is 4 from the axis, on its lowest side, and 2 along it.
        let corner = all[0].tip + Vector3::new(cosine, 0.0, -sine) * 4.0 + axis * 2.0;
        assert!((corner - Point3::new(0.0, 0.0, 2.0)).norm() < 1e-12, "{degrees}: {corner}");
    }
    // An upright tool stands on its flat face, which has no single point of contact.
    assert!(contacts(&*BULL, Point3::origin(), Vector3::z(), Vector3::z()).is_empty());
}

#[test]
fn a_flat_end_stands_on_its_corner_in_the_parts_unit() {
    for degrees in [0.001, 30.0, 89.0] {
        let axis = leaning(degrees);
        let all = contacts(&*FLAT, Point3::origin(), Vector3::z(), axis);
        assert_eq!(all.len(), 1, "{degrees}");
        let off = Point3::origin() - all[0].tip;
        assert!(off.dot(&axis).abs() < 1e-9 && (off.norm() - 6.35).abs() < 1e-9, "{off}");
    }
    assert!(contacts(&*FLAT, Point3::origin(), Vector3::z(), leaning(90.1)).is_empty());
}

#[test]
fn a_cones_tip_touches_as_far_as_its_side_lets_it() {
    for (degrees, count) in [(0.0, 1), (44.0, 1), (46.0, 0)] {
        let all = contacts(&*POINT, Point3::origin(), Vector3::z(), leaning(degrees));
        assert_eq!(all.len(), count, "{degrees}");
        assert!(all.iter().all(|contact| contact.tip.coords.norm() < 1e-12));
    }
    // At this angle the cone's upper corner would touch, but the shank above it does not cut.
    assert!(contacts(&*POINT, Point3::origin(), Vector3::z(), leaning(60.0)).is_empty());
}

#[test]
fn a_lollipop_touches_what_it_is_under() {
    // The neck begins where the normal points 53 degrees upward.
    let under =
        |degrees: f64| contacts(&*LOLLIPOP, Point3::origin(), -Vector3::z(), leaning(degrees));
    assert!(under(0.0).is_empty() && under(36.0).is_empty());
    for degrees in [38.0, 90.0, 140.0, 180.0] {
        let all = under(degrees);
        assert_eq!(all.len(), 1, "{degrees}");
        let middle = all[0].tip + leaning(degrees) * 5.0;
        assert!((middle - Point3::new(0.0, 0.0, -5.0)).norm() < 1e-12, "{degrees}");
    }
}

#[test]
fn each_step_touches_and_a_cove_never_does() {
    let axis = leaning(45.0);
    let mut all = contacts(&*STEPS, Point3::origin(), Vector3::z(), axis);
    all.sort_by(|a, b| b.tip.z.total_cmp(&a.tip.z));
    // Where the upper step touches, the lower one passes through the face. Contacts do not exclude that.
    let corners = all.iter().map(|contact| {
        let off = Point3::origin() - contact.tip;
        [(off - axis * off.dot(&axis)).norm(), off.dot(&axis)]
    });
    for (found, wanted) in corners.zip([[2.0, 0.0], [5.0, 4.0]]) {
        assert!((found[0] - wanted[0]).abs() < 1e-12 && (found[1] - wanted[1]).abs() < 1e-12);
    }
    assert_eq!(all.len(), 2);
}

static SHARP: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Sharp "two surfaces that meet in a sharp corner" {
        units mm;
        profile {
            start (0, 0);
            line to (6, 0) as face cutting;
            line to (6, 20) as flute cutting;
            line to (6, 60), (0, 60) as shank;
        }
        niceness flute: 1;
        niceness face: 0.25 + z;
    }"#
    .parse()
    .expect("a tool")
});

#[test]
fn a_corner_is_as_nice_as_the_less_nice_of_what_meets_there() {
    let mut placement = ToolPlacement::new(&*SHARP, Unit::Metre);
    let target = SurfacePoint { point: Point3::new(0.1, 0.0, 0.2), normal: Vector3::z() };
    let axes = (1..90).map(|degrees| {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        Vector3::new(sine, 0.0, cosine)
    });
    let mut postures = Vec::new();
    placement.list(target, axes, &mut postures);
    assert_eq!(postures.len(), 89);
    for posture in &postures {
        assert!((posture.niceness - 0.25).abs() < 1e-6, "{posture:?}");
    }
}
