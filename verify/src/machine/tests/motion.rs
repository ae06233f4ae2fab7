//! Poses of joint motions, and the bound on their deviation, against dense samples of the second
//! implementation.

use super::sampled::Sampled;
use super::{Random, cases, chain, library, texts};
use crate::machine::{JointError, JointMotion, Letter, LinearPath, Machine, Setup};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use touchoff::Motion;

/// Number of samples of a motion.
pub(super) const SAMPLES: usize = 24;

pub(super) fn machines() -> Vec<Machine> {
    texts().into_iter().map(|text| Machine::parse(text, "test").expect("a machine")).collect()
}

pub(super) fn rotation(pose: &Isometry3<f64>) -> Matrix3<f64> {
    pose.rotation.to_rotation_matrix().into_inner()
}

#[test]
fn poses_are_those_of_the_second_implementation() {
    let mut random = Random::new(4);
    let machines = machines();
    let mut greatest = 0.0f64;
    for case in 0..20_000 {
        let sampled = random.motion(&machines[case % machines.len()]);
        let motion = sampled.motion();
        let links = motion.chain.link;
        let link = random.below(links + 1);
        let inside = 0.5 + 0.5 * random.unit();
        let t = random.pick(&[0.0, 1.0, inside]);
        let linear = Vector3::from_row_slice(&motion.joints(t)[..3]);
        assert!((linear - sampled.linear(t)).norm() < 1e-10, "{sampled:?} {t}");
        for (motion, link) in
            [(motion, None), (motion.relative_to(link).expect("a link"), Some(link))]
        {
            let (pose, expected) = (motion.pose(t), sampled.pose(t, link));
            let tip = (pose.tip() - Point3::from(expected.translation.vector)).norm();
            let twist = (pose.rotation() - rotation(&expected)).norm();
            assert!(tip < 1e-10 && twist < 1e-12, "{sampled:?} {t} {link:?}: {tip:e} {twist:e}");
            greatest = greatest.max(tip);
        }
    }
    println!("greatest difference of tips {greatest:e} mm");
}

/// Returns the largest displacement of sample points of the tool, within `reach` of the tip, between the true
/// pose and that of the approximating motion.
pub(super) fn displacement(
    truth: &Isometry3<f64>,
    motion: &Motion,
    fraction: f64,
    reach: f64,
    spin: bool,
) -> f64 {
    let pose = motion.pose(fraction);
    let tip = truth.translation.vector - pose.tip().coords;
    let turn = rotation(truth) - pose.rotation();
    let mut points = vec![Vector3::z()];
    if spin {
        points.extend([Vector3::x(), Vector3::y()]);
        // The direction in which the rotations differ most.
        points.extend(turn.svd(false, true).v_t.map(|rows| rows.row(0).transpose()));
    }
    let displaced = |point: &Vector3<f64>| {
        let difference = reach * (turn * point);
        (tip + difference).norm().max((tip - difference).norm())
    };
    points.iter().map(displaced).fold(tip.norm(), f64::max)
}

/// The bound on the deviation holds on 10⁵ random motions of the library's machines and those of the tests,
/// relative to the workpiece and to other bodies, and it is not much wider than needed. Prints the ratios of
/// bound and deviation.
#[test]
fn deviations_are_within_their_bounds() {
    let mut random = Random::new(5);
    let machines = machines();
    let (mut ratios, mut tool_ratios, mut short) =
        (Vec::new(), [Vec::new(), Vec::new()], Vec::new());
    let count = cases("MOTIONS", 40_000);
    for case in 0..count {
        let sampled = random.motion(&machines[case % machines.len()]);
        let mut motion = sampled.motion();
        let link = (case % 3 == 0).then(|| random.below(motion.chain.link + 1));
        if let Some(link) = link {
            motion = motion.relative_to(link).expect("a link");
        }
        let width = random.pick(&[1.0, 0.3, 0.1, 1e-2]);
        let t0 = 0.5 * (1.0 - width) * (1.0 + random.unit());
        let t1 = t0 + width;
        let (reach, spin) = (random.pick(&[0.0, 1.0, 50.0, 300.0]), case % 2 == 0);
        let (bound, approximation) = match spin {
            true => (motion.deviation_with_spin(t0, t1, reach), motion.motion_with_spin(t0, t1)),
            false => (motion.deviation(t0, t1, reach), motion.motion(t0, t1)),
        };
        // An ambiguous motion needs no bound.
        let Ok(approximation) = approximation else { continue };
        let actual = (1..SAMPLES)
            .map(|k| {
                let fraction = k as f64 / SAMPLES as f64;
                let truth = sampled.pose(t0 + fraction * (t1 - t0), link);
                displacement(&truth, &approximation, fraction, reach, spin)
            })
            .fold(0.0, f64::max);
        // The second implementation errs, too, and so do the poses of the approximating motion.
        let slack = 1e-10 + 1e-13 * reach;
        assert!(
            actual <= bound + slack,
            "{sampled:?} {link:?} {t0} {t1} {reach} {spin}: {actual:e} > {bound:e}"
        );
        if actual > 1e-6 {
            ratios.push(bound / actual);
            tool_ratios[usize::from(spin)].push(bound / actual);
            if bound < 0.05 {
                short.push(bound / actual);
            }
        }
    }
    let quantile = |ratios: &mut Vec<f64>, part: f64| {
        ratios.sort_by(f64::total_cmp);
        ratios[((ratios.len() - 1) as f64 * part) as usize]
    };
    let [mut axis, mut spin] = tool_ratios;
    let median = quantile(&mut ratios, 0.5);
    println!(
        "{count} motions: bound / deviation: median {median:.3} (tool of revolution {:.3}, solid {:.3}), least {:.4}, \
         90 % {:.2}; where the bound is below 0.05 mm: median {:.3}, 90 % {:.2}",
        quantile(&mut axis, 0.5),
        quantile(&mut spin, 0.5),
        quantile(&mut ratios, 0.0),
        quantile(&mut ratios, 0.9),
        quantile(&mut short, 0.5),
        quantile(&mut short, 0.9),
    );
    assert!(median < 5.0, "{median}");
}

/// On a tenth of the time, the bound is a hundredth, as long as rounding and the factor of long intervals are
/// small.
#[test]
fn bounds_decrease_with_the_square_of_the_time() {
    let mut random = Random::new(6);
    let machines = library();
    for case in 0..2000 {
        let motion = random.motion(&machines[case % machines.len()]).motion();
        for deviation in [JointMotion::deviation, JointMotion::deviation_with_spin] {
            let [long, short] =
                [1e-2, 1e-3].map(|width| deviation(&motion, 0.5, 0.5 + width, 100.0));
            assert!(short <= 0.0125 * long + 1e-9, "{short:e} {long:e}");
        }
    }
}

/// One rotary axis perpendicular to the tool axis moves it on a great circle, with the tip on a line: the
/// motion between the ends is exact, and so is the bound.
#[test]
fn a_tilt_with_the_tip_on_a_line_does_not_deviate() {
    let chain = chain("A-C fork head", 0.0, 200.0);
    let path = LinearPath::Line { start: [0.0; 3], end: [100.0, 20.0, -3.0] };
    let rotary = [[10.0, 0.0, 35.0], [50.0, 0.0, 35.0]];
    let motion = JointMotion::with_tcp(&chain, rotary, &path).expect("a motion");
    assert!(motion.deviation(0.0, 1.0, 500.0) < 1e-9);
    assert!(motion.deviation_with_spin(0.0, 1.0, 500.0) < 1e-9);
    // The table of a fork head is the base.
    assert!(motion.relative_to(0).expect("the base").deviation(0.0, 1.0, 500.0) < 1e-9);
}

#[test]
fn values_out_of_range_are_refused() {
    let chain = chain("A-C trunnion", 0.0, 0.0);
    let line = LinearPath::Line { start: [0.0; 3], end: [1.0; 3] };
    let refusal =
        |rotary, path: &LinearPath| JointMotion::new(&chain, rotary, path).expect_err("no motion");
    let what = |rotary, path: &LinearPath| match refusal(rotary, path) {
        JointError::Range { what, .. } => what,
        other => panic!("{other}"),
    };
    for bad in [f64::NAN, f64::NEG_INFINITY, 1e300] {
        let rotary = [[0.0; 3], [0.0, 0.0, bad]];
        assert_eq!(what(rotary, &line), "C");
        let path = LinearPath::Line { start: [0.0; 3], end: [0.0, bad, 0.0] };
        assert_eq!(what([[0.0; 3]; 2], &path), "Y");
        for (centre, sweep, name) in [
            ([bad, 0.0], 1.0, "the centre of the arc"),
            ([0.0, 0.0], bad, "the sweep of the arc in radians"),
        ] {
            let plane = crate::machine::Plane::Xy;
            let path = LinearPath::Arc { start: [0.0; 3], end: [0.0; 3], plane, centre, sweep };
            assert_eq!(what([[0.0; 3]; 2], &path), name);
        }
    }
    let refusal = refusal([[0.0; 3], [0.0, 1.0, 0.0]], &line);
    assert!(matches!(refusal, JointError::NoAxis { letter: Letter::B, .. }), "{refusal}");
    let base = chain.relative_to(0).expect("the base");
    assert!(JointMotion::with_tcp(&base, [[0.0; 3]; 2], &line).is_err());
    assert!(JointMotion::new(&base, [[0.0; 3]; 2], &line).is_ok());
}

#[test]
#[should_panic(expected = "NaN is no time of a motion")]
fn rejects_a_nan_time() {
    let machine = Machine::named("3-axis").expect("a machine");
    let sampled = Sampled {
        setup: Setup::default(),
        rotary: [[0.0; 3]; 2],
        path: LinearPath::Line { start: [0.0; 3], end: [1.0; 3] },
        tcp: false,
        pivot: None,
        machine,
    };
    sampled.motion().pose(f64::NAN);
}
