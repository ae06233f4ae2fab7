//! Accepted postures are acceptable at every sample point.

use crate::{
    BALL, HOLDER, MILL, NECK, PLAIN, cutting_distance, is_inside, polyline_distance,
    random_numbers, random_pose,
};
use crate::{parts, sample_points};
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff_postures::{Rules, RulesError, Validator, ValidatorError};

fn rules(tolerance: f64) -> Rules {
    Rules { tolerance, niceness: 0.5, allowed: Vec::new() }
}

#[test]
fn accepted_postures_obey_the_rules_at_sample_points() {
    let mut random = random_numbers(2);
    let (mut accepted, mut rejected, mut deep_points) = (0, 0, 0);
    for mesh in parts() {
        let bvh = TriangleBvh::new(&mesh);
        for tolerance in [1e-3, 0.05, 1.0] {
            let mut validator =
                Validator::new(&bvh, &*MILL, &rules(tolerance)).expect("a validator");
            let mut certifier = Certifier::new(&bvh, &*MILL).expect("a profile");
            for _ in 0..60 {
                // About to touch, or slightly deeper.
                let start = random_pose(&mut random, 20.0);
                let depth = certifier.deepest(&start, 1e-6).depth.high;
                let gap = certifier.clearance(&start, 1e-6).distance.low;
                let displacement = start.axis() * (depth - gap - random(0.0, tolerance.max(0.2)));
                let Ok(pose) = start.translated(displacement) else { continue };
                let Some(record) = validator.record(3, &pose, 0.75) else {
                    rejected += 1;
                    continue;
                };
                assert_eq!(record.pose().expect("a pose").tip(), pose.tip());
                assert_eq!((record.tool, record.niceness), (3, 0.75));
                let text = format!("{tolerance}: {record:?}");
                let (points, spacing) = sample_points(&mesh, &record.pose().expect("a pose"));
                let mut nearest = f64::INFINITY;
                for point in points {
                    let non_cutting =
                        polyline_distance(&NECK, point).min(polyline_distance(&HOLDER, point));
                    nearest = nearest.min(non_cutting);
                    if is_inside(point) {
                        let cutting = cutting_distance(point);
                        assert!(
                            cutting.min(non_cutting) <= record.depth + 1e-9,
                            "{text}, {point:?}"
                        );
                        assert!(non_cutting >= cutting - 1e-9, "{text}, {point:?}");
                        assert!(cutting <= tolerance + 1e-9, "{text}, {point:?}");
                        deep_points += u32::from(cutting > 1e-6);
                    }
                }
                assert!(record.clearance <= nearest + 1e-9, "{text}: {nearest}");
                let clearance_tolerance = 0.02 * tolerance + 1e-6;
                assert!(
                    nearest - spacing <= record.clearance + clearance_tolerance,
                    "{text}: {nearest}"
                );
                accepted += 1;
            }
        }
    }
    assert!(
        accepted > 100 && rejected > 30 && deep_points > 100,
        "{accepted} accepted, {rejected} not, {deep_points} points deep"
    );
}

#[test]
fn does_not_record_postures_that_break_the_rules() {
    let mesh = &parts()[0];
    let bvh = TriangleBvh::new(mesh);
    let upright =
        |x: f64, z: f64| Pose::from_axis(Point3::new(x, -5.0, z), Vector3::z()).expect("a pose");
    let mut validator = Validator::new(&bvh, &*MILL, &rules(0.01)).expect("a validator");
    let good = upright(-6.0, -0.005);
    assert!(validator.record(0, &good, 0.501).is_some());
    assert!(validator.record(0, &good, 0.5).is_none());
    assert!(validator.record(0, &good, f64::NAN).is_none());
    assert!(validator.record(0, &upright(-6.0, -0.011), 1.0).is_none());
    // The flute and the neck's shoulder are in the part's side; the holder is 0.5 mm above the part, or in it.
    assert!(!validator.accepts(&upright(3.0 - 0.009, -19.5)));
    let neck = ("neck".to_owned(), 0.01);
    let mut allowed = Rules { allowed: vec![neck.clone()], ..rules(0.01) };
    let mut validator = Validator::new(&bvh, &*MILL, &allowed).expect("a validator");
    assert!(validator.accepts(&upright(3.0 - 0.009, -19.5)));
    assert!(!validator.accepts(&upright(3.0 - 0.009, -20.5)));
    allowed.allowed = vec![("holder".into(), 0.6), ("flute".into(), 0.0)];
    let mut validator = Validator::new(&bvh, &*MILL, &allowed).expect("a validator");
    assert!(validator.accepts(&upright(3.0 + 1e-6, -20.5)));
    assert!(!validator.accepts(&upright(3.0 - 0.009, -19.5)));
    allowed.allowed = vec![("holder".into(), -1.0), neck];
    let mut validator = Validator::new(&bvh, &*MILL, &allowed).expect("a validator");
    assert!(!validator.accepts(&upright(3.0 - 0.009, -19.5)));
    assert!(validator.accepts(&upright(3.0 - 0.009, -18.9)));
    // Inside the part no posture is acceptable.
    let mut validator = Validator::new(&bvh, &*BALL, &rules(0.01)).expect("a validator");
    assert!(!validator.accepts(&upright(-6.0, -7.0)));
}

#[test]
fn rejects_invalid_rules() {
    let bvh = TriangleBvh::new(&parts()[0]);
    let error_of = |rules: &Rules| match Validator::new(&bvh, &*MILL, rules) {
        Err(ValidatorError::Rules(error)) => error.to_string(),
        _ => panic!("{rules:?}"),
    };
    for tolerance in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        assert!(error_of(&rules(tolerance)).contains("is not a length above 0"));
    }
    let invalid = Rules { niceness: f64::NAN, ..rules(0.01) };
    assert_eq!(error_of(&invalid), RulesError::Niceness(f64::NAN).to_string());
    let mut named = rules(0.01);
    named.allowed = vec![("neck".into(), f64::NAN)];
    assert!(error_of(&named).contains("an allowance of NaN for `neck` is not a length"));
    named.allowed = vec![("nack".into(), 0.1)];
    let message = named.check(&[&*MILL, &*BALL]).expect_err("no such surface").to_string();
    let surfaces = "`ball`, `flute`, `holder`, `neck`";
    assert_eq!(
        message,
        format!("no tool has the surface `nack` that is allowed for: they have {surfaces}")
    );
    // Another tool may have this surface.
    assert!(Validator::new(&bvh, &*MILL, &named).is_ok());
    // Only margins are refused for a tool without a profile.
    assert!(Validator::new(&bvh, &*PLAIN, &rules(0.01)).is_ok());
}
