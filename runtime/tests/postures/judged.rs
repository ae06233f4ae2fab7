//! Accepted postures are acceptable at every sample point.

use crate::{Ball, HOLDER, Mill, NECK, Plain, any_pose, away, draws, from_cutting, inside};
use crate::{parts, places};
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::postures::{Rules, RulesError, Validator, ValidatorError};

fn rules(tolerance: f64) -> Rules {
    Rules { tolerance, niceness: 0.5, allowed: Vec::new() }
}

#[test]
fn no_place_of_a_part_is_deeper_than_it_may_be_where_a_posture_is_accepted() {
    let mut draw = draws(2);
    let (mut yes, mut no, mut deep) = (0, 0, 0);
    for mesh in parts() {
        let bvh = TriangleBvh::new(&mesh);
        for tolerance in [1e-3, 0.05, 1.0] {
            let mut judge = Validator::new(&bvh, &Mill, &rules(tolerance)).expect("a judge");
            let mut certifier = Certifier::new(&bvh, &Mill).expect("a profile");
            for _ in 0..60 {
                // About to touch, or slightly deeper.
                let start = any_pose(&mut draw, 20.0);
                let depth = certifier.deepest(&start, 1e-6).depth.high;
                let gap = certifier.clearance(&start, 1e-6).distance.low;
                let way = start.axis() * (depth - gap - draw(0.0, tolerance.max(0.2)));
                let Ok(pose) = start.translated(way) else { continue };
                let Some(record) = judge.record(3, &pose, 0.75) else {
                    no += 1;
                    continue;
                };
                assert_eq!(record.pose().expect("a pose").tip(), pose.tip());
                assert_eq!((record.tool, record.niceness), (3, 0.75));
                let text = format!("{tolerance}: {record:?}");
                let (places, apart) = places(&mesh, &record.pose().expect("a pose"));
                let mut nearest = f64::INFINITY;
                for place in places {
                    let still = away(&NECK, place).min(away(&HOLDER, place));
                    nearest = nearest.min(still);
                    if inside(place) {
                        let cuts = from_cutting(place);
                        assert!(cuts.min(still) <= record.depth + 1e-9, "{text}, {place:?}");
                        assert!(still >= cuts - 1e-9, "{text}, {place:?}");
                        assert!(cuts <= tolerance + 1e-9, "{text}, {place:?}");
                        deep += u32::from(cuts > 1e-6);
                    }
                }
                assert!(record.clearance <= nearest + 1e-9, "{text}: {nearest}");
                let fine = 0.02 * tolerance + 1e-6;
                assert!(nearest - apart <= record.clearance + fine, "{text}: {nearest}");
                yes += 1;
            }
        }
    }
    assert!(yes > 100 && no > 30 && deep > 100, "{yes} accepted, {no} not, {deep} places deep");
}

#[test]
fn what_is_not_nice_or_rubs_is_not_recorded() {
    let mesh = &parts()[0];
    let bvh = TriangleBvh::new(mesh);
    let upright =
        |x: f64, z: f64| Pose::from_axis(Point3::new(x, -5.0, z), Vector3::z()).expect("a pose");
    let mut judge = Validator::new(&bvh, &Mill, &rules(0.01)).expect("a judge");
    let good = upright(-6.0, -0.005);
    assert!(judge.record(0, &good, 0.501).is_some());
    assert!(judge.record(0, &good, 0.5).is_none());
    assert!(judge.record(0, &good, f64::NAN).is_none());
    assert!(judge.record(0, &upright(-6.0, -0.011), 1.0).is_none());
    // The flute and the neck's shoulder are in the part's side; the holder is 0.5 mm above the part, or in it.
    assert!(!judge.accepts(&upright(3.0 - 0.009, -19.5)));
    let neck = ("neck".to_owned(), 0.01);
    let mut allowed = Rules { allowed: vec![neck.clone()], ..rules(0.01) };
    let mut judge = Validator::new(&bvh, &Mill, &allowed).expect("a judge");
    assert!(judge.accepts(&upright(3.0 - 0.009, -19.5)));
    assert!(!judge.accepts(&upright(3.0 - 0.009, -20.5)));
    allowed.allowed = vec![("holder".into(), 0.6), ("flute".into(), 0.0)];
    let mut judge = Validator::new(&bvh, &Mill, &allowed).expect("a judge");
    assert!(judge.accepts(&upright(3.0 + 1e-6, -20.5)));
    assert!(!judge.accepts(&upright(3.0 - 0.009, -19.5)));
    allowed.allowed = vec![("holder".into(), -1.0), neck];
    let mut judge = Validator::new(&bvh, &Mill, &allowed).expect("a judge");
    assert!(!judge.accepts(&upright(3.0 - 0.009, -19.5)));
    assert!(judge.accepts(&upright(3.0 - 0.009, -18.9)));
    // Inside the part no posture is acceptable.
    let mut judge = Validator::new(&bvh, &Ball, &rules(0.01)).expect("a judge");
    assert!(!judge.accepts(&upright(-6.0, -7.0)));
}

#[test]
fn rules_and_tools_that_mean_nothing_are_refused() {
    let bvh = TriangleBvh::new(&parts()[0]);
    let refused = |rules: &Rules| match Validator::new(&bvh, &Mill, rules) {
        Err(ValidatorError::Rules(error)) => error.to_string(),
        _ => panic!("{rules:?}"),
    };
    for tolerance in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&rules(tolerance)).contains("is no length above 0"));
    }
    let unclear = Rules { niceness: f64::NAN, ..rules(0.01) };
    assert_eq!(refused(&unclear), RulesError::Niceness(f64::NAN).to_string());
    let mut named = rules(0.01);
    named.allowed = vec![("neck".into(), f64::NAN)];
    assert!(refused(&named).contains("an allowance of NaN for `neck` is no length"));
    named.allowed = vec![("nack".into(), 0.1)];
    let said = named.check(&[&Mill, &Ball]).expect_err("no such surface").to_string();
    let all = "`ball`, `flute`, `holder`, `neck`";
    assert_eq!(
        said,
        format!("no tool has the surface `nack` that is allowed for: they have {all}")
    );
    // Another tool may have this surface.
    assert!(Validator::new(&bvh, &Mill, &named).is_ok());
    // Only margins are refused for a tool without a profile.
    assert!(Validator::new(&bvh, &Plain, &rules(0.01)).is_ok());
}
