//! Singular passes against dense samples of the second implementation.

use super::sampled::Sampled;
use super::{Random, chain, texts};
use crate::machine::{
    Axis, JointMotion, Letter, LinearPath, Machine, SINGULAR_ANGLE, SINGULAR_TURN, Side,
    SingularPass,
};
use nalgebra::Vector3;

/// Number of samples of a motion.
const SAMPLES: usize = 2000;

/// Returns the rotary axis on the side of the workpiece: the last of the table, or the first of the tool.
fn first_rotary(machine: &Machine) -> Option<Axis> {
    let rotary = || machine.axes().iter().filter(|axis| axis.letter.is_rotary());
    let table = rotary().rfind(|axis| axis.side == Side::Table);
    table.or_else(|| rotary().next()).copied().filter(|_| rotary().count() == 2)
}

/// Returns the largest turn of the first rotary axis in one run of samples near its direction, in degrees.
fn sampled_turn(sampled: &Sampled, axis: &Axis) -> f64 {
    // In the last link, the direction of the first axis is constant: a table's own, or that of a head on a
    // fixed table.
    let link = sampled.machine.axes().iter().filter(|axis| axis.side == Side::Table).count();
    let near = |k: usize| {
        let pose = sampled.pose(k as f64 / SAMPLES as f64, Some(link));
        (pose.rotation * Vector3::z()).dot(&axis.direction.normalize()).abs()
            >= SINGULAR_ANGLE.to_radians().cos()
    };
    let (mut longest, mut run) = (0usize, 0usize);
    for k in 0..=SAMPLES {
        run = if near(k) { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    let index = axis.letter.index() - 3;
    let change = (sampled.rotary[1][index] - sampled.rotary[0][index]).abs();
    change * longest.saturating_sub(1) as f64 / SAMPLES as f64
}

#[test]
fn singular_passes_are_those_of_samples() {
    let mut random = Random::new(8);
    let machines: Vec<_> =
        texts().into_iter().map(|text| Machine::parse(text, "test").expect("a machine")).collect();
    let (mut found, mut missing) = (0, 0);
    for case in 0..4000 {
        let machine = &machines[case % machines.len()];
        let mut sampled = random.motion(machine);
        sampled.tcp = false;
        for axis in machine.axes().iter().filter(|axis| axis.letter.is_rotary()) {
            let index = axis.letter.index() - 3;
            let is_first = first_rotary(machine).is_some_and(|first| first.letter == axis.letter);
            let scale = if is_first { 2000.0 } else { random.pick(&[0.0, 4.0, 60.0, 800.0]) };
            let start = if is_first {
                0.0
            } else {
                random.pick(&[0.0, 180.0, -360.0]) + 6.0 * random.unit()
            };
            sampled.rotary[0][index] = start;
            sampled.rotary[1][index] = start + scale * random.unit();
        }
        let pass = sampled.motion().singular_pass();
        let Some(axis) = first_rotary(machine) else {
            assert_eq!(pass, None, "{}", machine.name());
            continue;
        };
        let turn = sampled_turn(&sampled, &axis);
        let index = axis.letter.index() - 3;
        let step =
            2.0 * (sampled.rotary[1][index] - sampled.rotary[0][index]).abs() / SAMPLES as f64;
        match pass {
            Some(pass) => {
                assert_eq!(pass.letter, axis.letter);
                assert!((pass.turn - turn).abs() <= step + 1e-6, "{sampled:?} {pass:?} {turn}");
                assert!(pass.turn >= SINGULAR_TURN && pass.angle <= SINGULAR_ANGLE, "{pass:?}");
                found += 1;
            }
            None => {
                assert!(turn < SINGULAR_TURN + 1e-6, "{sampled:?} {turn}");
                missing += 1;
            }
        }
    }
    println!("{found} motions with a singular pass, {missing} without");
    assert!(found > 500 && missing > 500);
}

#[test]
fn a_pass_by_the_pole_is_reported_with_its_turn() {
    let chain = chain("A-C trunnion", 0.0, 0.0);
    let path = LinearPath::Line { start: [0.0; 3], end: [1.0; 3] };
    let pass = |from, to| {
        JointMotion::with_tcp(&chain, [from, to], &path).expect("a motion").singular_pass()
    };
    assert_eq!(
        pass([-2.0, 0.0, 10.0], [-2.0, 0.0, 190.0]),
        Some(SingularPass { letter: Letter::C, fractions: [0.0, 1.0], turn: 180.0, angle: 2.0 })
    );
    assert_eq!(pass([-20.0, 0.0, 10.0], [-20.0, 0.0, 190.0]), None);
    // A turns from −10° to 10° and is within 5° of the pole for half of the time.
    let SingularPass { fractions, turn, .. } =
        pass([-10.0, 0.0, 0.0], [10.0, 0.0, -200.0]).expect("a pass");
    assert!((turn - 100.0).abs() < 1e-9 && (fractions[0] - 0.25).abs() < 1e-9);
}
