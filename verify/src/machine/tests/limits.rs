//! Limits of axes against dense samples of the second implementation.

use super::{Random, chain, library};
use crate::machine::{JointMotion, Letter, LimitViolation, LinearPath, Machine, Plane, Setup};

/// Number of samples of a motion.
const SAMPLES: usize = 400;

/// On random motions, the axes found are those that samples find, at their worst samples; none is missed.
/// Prints how many of the motions leave a limit.
#[test]
fn limits_that_samples_exceed_are_found() {
    let mut random = Random::new(7);
    let machines: Vec<_> =
        library().into_iter().filter(|machine| machine.axes().len() > 3).collect();
    let (mut found, mut inner, mut close) = (0, 0, 0);
    for case in 0..4000 {
        let machine = &machines[case % machines.len()];
        let mut sampled = random.motion(machine);
        // Near the middle of the machines' travels, so that many motions pass a limit by little.
        sampled.setup.work_offset[..3].copy_from_slice(&[0.0, 0.0, -250.0]);
        for value in sampled.rotary.as_flattened_mut() {
            *value %= 150.0;
        }
        let motion = sampled.motion();
        let violations = motion.check_limits();
        for axis in machine.axes() {
            let Some([low, high]) = axis.limits else { continue };
            for (limit, sign) in [(low, -1.0), (high, 1.0)] {
                let index = axis.letter.index();
                let value = |t: f64| match index {
                    0..3 => sampled.linear(t)[index],
                    _ => {
                        let [start, end] = sampled.rotary.map(|values| values[index - 3]);
                        start + t * (end - start)
                    }
                };
                let excess = |value: f64| sign * (value - limit);
                let (worst, at) = (0..=SAMPLES)
                    .map(|k| (excess(value(k as f64 / SAMPLES as f64)), k))
                    .max_by(|a, b| a.0.total_cmp(&b.0))
                    .expect("a sample");
                let is_this = |v: &&LimitViolation| v.letter == axis.letter && v.limit == limit;
                match violations.iter().find(is_this) {
                    Some(violation) => {
                        assert!(
                            violation.is_reached && excess(violation.value) > 0.0,
                            "{violation:?}"
                        );
                        assert!((value(violation.fraction) - violation.value).abs() < 1e-9);
                        assert!(excess(violation.value) >= worst - 1.1e-4, "{violation:?} {worst}");
                        found += 1;
                        inner += usize::from(at != 0 && at != SAMPLES);
                    }
                    None => assert!(worst < 1.1e-4, "{sampled:?} {axis:?} {worst}"),
                }
                close += usize::from(worst > -1.0 && worst < 1.0);
            }
        }
        let expected = violations.len();
        let mut limits: Vec<_> = violations.iter().map(|v| (v.letter, v.limit.to_bits())).collect();
        limits.dedup();
        assert_eq!(limits.len(), expected, "{violations:?}");
    }
    println!(
        "{found} limits are exceeded, {inner} of them between the ends; {close} limits are within 1 mm or 1°"
    );
    assert!(found > 500 && inner > 20 && close > 20);
}

/// Ends at the limits are within them, although sums of starts and differences round beyond.
#[test]
fn motions_to_the_limits_are_within_them() {
    let mut random = Random::new(11);
    let chain = chain("A-C trunnion", 0.0, 0.0);
    for _ in 0..1000 {
        let [x, z, a] = [350.0, 250.0, 75.0].map(|size| size * random.unit());
        let (start, end) = ([x, 0.0, z - 250.0], [350.0, -300.0, -500.0]);
        let rotary = [[a - 45.0, 0.0, 0.0], [random.pick(&[-120.0, 30.0]), 0.0, 0.0]];
        for (start, end, rotary) in [(start, end, rotary), (end, start, [rotary[1], rotary[0]])] {
            let path = LinearPath::Line { start, end };
            let motion = JointMotion::new(&chain, rotary, &path).expect("a motion");
            assert_eq!(motion.check_limits(), [], "{rotary:?} {path:?}");
            for (t, position, rotary) in [(0.0, start, rotary[0]), (1.0, end, rotary[1])] {
                let joints = motion.joints(t);
                assert_eq!((&joints[..3], &joints[3..]), (&position[..], &rotary[..]));
            }
        }
    }
}

/// Poses relative to the base do not depend on the table's axes, but these axes have their limits all the same.
#[test]
fn limits_hold_relative_to_any_link() {
    let base = chain("A-C trunnion", 0.0, 0.0).relative_to(0).expect("the base");
    let path = LinearPath::Line { start: [0.0; 3], end: [0.0, 0.0, -1.0] };
    let rotary = [[0.0; 3], [45.0, 0.0, 0.0]];
    let violations = JointMotion::new(&base, rotary, &path).expect("a motion").check_limits();
    let [LimitViolation { letter: Letter::A, value: 45.0, limit: 30.0, fraction: 1.0, .. }] =
        violations[..]
    else {
        panic!("one violation, of A: {violations:?}");
    };
}

/// The middle of an arc is beyond a limit by less than the samples of a coarse search would show.
#[test]
fn an_arc_that_leaves_a_limit_between_its_ends_is_found() {
    let chain = chain("3-axis", 0.0, 0.0);
    let arc = |radius: f64| {
        let [start, end] = [-1.0, 1.0].map(|side: f64| [390.0, side * radius, -10.0]);
        let (plane, centre) = (Plane::Xy, [390.0, 0.0]);
        let path = LinearPath::Arc { start, end, plane, centre, sweep: std::f64::consts::PI };
        JointMotion::new(&chain, [[0.0; 3]; 2], &path).expect("a motion").check_limits()
    };
    assert!(arc(10.0).is_empty() && arc(9.99).is_empty());
    let [violation] = arc(10.001)[..] else { panic!("one violation") };
    assert_eq!((violation.letter, violation.limit), (Letter::X, 400.0));
    assert!((violation.value - 400.001).abs() < 1e-4 && (violation.fraction - 0.5).abs() < 0.01);
}

/// A search that is too long ends, and reports what it could not rule out.
#[test]
fn a_search_that_does_not_finish_is_reported() {
    let chain = chain("A-C trunnion", -450.0, 100.0);
    // X and Y run along ±349.99999 for 2,777 turns: X is below its limit, by less than the search's
    // tolerance.
    let position = [349.99999, 0.0, 0.0];
    let path = LinearPath::Line { start: position, end: position };
    let motion =
        JointMotion::with_tcp(&chain, [[0.0; 3], [0.0, 0.0, 1e6]], &path).expect("a motion");
    let found: Vec<_> = motion
        .check_limits()
        .iter()
        .map(|violation| {
            let excess = violation.value.abs() - violation.limit.abs();
            let is_bound = !violation.is_reached && excess > 0.0;
            assert!(violation.is_reached && excess > 49.0 || is_bound, "{violation:?}");
            (violation.letter, violation.limit, violation.is_reached)
        })
        .collect();
    let expected = [
        (Letter::X, -350.0, false),
        (Letter::X, 350.0, false),
        (Letter::Y, -300.0, true),
        (Letter::Y, 300.0, true),
    ];
    assert_eq!(found, expected);
}

#[test]
fn only_the_limits_of_linear_axes_go() {
    for name in Machine::names() {
        let machine = Machine::named(name).expect("a machine");
        let chain = machine.chain(&Setup::default()).expect("a chain");
        let mut free = chain.without_linear_limits();
        assert_eq!(free.limits[..3], [[f64::NEG_INFINITY, f64::INFINITY]; 3]);
        assert_eq!(free.limits[3..], chain.limits[3..]);
        free.limits = chain.limits;
        assert_eq!(free, chain);
    }
}
