//! Inverse kinematics against forward kinematics.

use super::{FOUR_AXIS, Random, cases, chain, texts};
use crate::machine::{Chain, InverseError, Joints, Letter, Machine, Setup};
use nalgebra::{Point3, Vector3};

/// Returns joints within the limits of the rotary axes; every fourth at the singular direction or near it.
fn joints(random: &mut Random, machine: &Machine, singular: bool) -> Joints {
    let mut joints = random.joints(machine, 200.0);
    for axis in machine.axes().iter().filter(|axis| axis.letter.is_rotary()) {
        let [low, high] = axis.limits.unwrap_or([-1000.0, 1000.0]);
        let index = axis.letter.index();
        joints[index] = match (singular, axis.letter) {
            (true, Letter::A | Letter::B) => random.pick(&[0.0, 1e-3, 1e-7, 5e-8, 1e-11, -1e-14]),
            _ => 0.5 * (low + high) + 0.5 * (high - low) * random.unit(),
        };
    }
    joints
}

fn turn(a: &Joints, b: &Joints) -> f64 {
    (3..6).map(|k| (a[k] - b[k]).abs()).sum()
}

/// Returns the errors of the tip, in units of its rounding bound, and of the axis, in radians.
fn errors(chain: &Chain, joints: &Joints, tip: &Point3<f64>, axis: &Vector3<f64>) -> [f64; 2] {
    let pose = chain.pose(joints).expect("a pose");
    let bound = chain.rounding(joints).tip;
    [(pose.tip() - tip).norm() / bound, (pose.axis() - axis).norm()]
}

/// At random joints, singular ones among them: each solution gives the pose back, one of them the joints
/// themselves, and the first is no farther from any given joints than these, with whole turns within the
/// limits.
#[test]
fn solutions_give_the_pose_back() {
    let mut random = Random::new(9);
    let machines: Vec<_> = texts()
        .into_iter()
        .map(|text| {
            // Without limits of linear axes, which random setups exceed.
            let mut machine = Machine::parse(text, "test").expect("a machine");
            for axis in machine.axes.iter_mut().filter(|axis| !axis.letter.is_rotary()) {
                axis.limits = None;
            }
            machine
        })
        .collect();
    let (mut greatest, mut pairs) = ([0.0f64; 3], 0);
    let count = cases("JOINTS", 10_000);
    for case in 0..count {
        let machine = &machines[case % machines.len()];
        let setup = random.setup(machine);
        let chain = machine.chain(&setup).expect("a setup");
        let truth = joints(&mut random, machine, case % 4 == 0);
        let pose = chain.pose(&truth).expect("a pose");
        let (tip, axis) = (pose.tip(), pose.axis());
        let far = joints(&mut random, machine, case % 5 == 0);
        for near in [truth, far] {
            let solutions = chain.solutions(&tip, &axis, &near).expect("solutions");
            assert_eq!(chain.inverse(&tip, &axis, &near).expect("a solution"), solutions[0]);
            pairs += usize::from(solutions.len() == 2);
            assert!(
                solutions
                    .windows(2)
                    .all(|pair| { turn(&pair[0].joints, &near) <= turn(&pair[1].joints, &near) })
            );
            for solution in &solutions {
                let [tip_error, axis_error] = errors(&chain, &solution.joints, &tip, &axis);
                // Twice the bound: of the pose that is given, and of the one at the solution.
                assert!(tip_error <= 2.0, "{tip_error} {truth:?} {solution:?}");
                assert!((axis_error - solution.axis_error).abs() < 1e-15);
                let is_singular = axis_error > 1e-14;
                assert!(
                    axis_error < 2e-9 && (!is_singular || case % 4 == 0),
                    "{truth:?} {axis_error:e}"
                );
                greatest[0] = greatest[0].max(tip_error);
                greatest[1 + usize::from(is_singular)] =
                    greatest[1 + usize::from(is_singular)].max(axis_error);
                for axis in machine.axes() {
                    let [low, high] = axis.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                    assert!((low..=high).contains(&solution.joints[axis.letter.index()]));
                }
            }
            let known = Letter::ALL.map(|letter| {
                let (value, near) = (truth[letter.index()], near[letter.index()]);
                match machine.axis(letter).filter(|_| letter.is_rotary()) {
                    Some(axis) => nearest(value, near, axis.limits),
                    None => value,
                }
            });
            // Rounding of the pose moves joints by 1e-8 rad where both solutions meet, and by more where the
            // tool axis nears the first rotary axis.
            let excess = turn(&solutions[0].joints, &near) - turn(&known, &near);
            let is_regular = case % 4 != 0;
            assert!(
                excess < if is_regular { 1e-5 } else { 1e-3 },
                "{excess:e} {truth:?} {near:?} {solutions:?}"
            );
        }
    }
    assert!(pairs > count / 2, "{pairs}");
    println!(
        "{count} poses: greatest error of the tip {:.3} of the bound, of the axis {:.2e} rad, near a singular direction \
         {:.2e} rad",
        greatest[0], greatest[1], greatest[2]
    );
}

/// Returns the value with the whole turns that bring it nearest to another within limits, by trying them.
fn nearest(value: f64, near: f64, limits: Option<[f64; 2]>) -> f64 {
    let [low, high] = limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    (-12..=12)
        .map(|turns| value + 360.0 * f64::from(turns))
        .filter(|value| (low..=high).contains(value))
        .min_by(|a, b| (a - near).abs().total_cmp(&(b - near).abs()))
        .expect("the value itself")
}

/// A joint whose axis is parallel to the tool axis keeps its value.
#[test]
fn a_singular_direction_keeps_the_angle() {
    // All machines with an axis C, which is that of the spindle where A and B are at 0.
    for (name, index) in Machine::names().filter(|name| name.contains('C')).map(|name| (name, 5)) {
        let chain = chain(name, -450.0, 100.0);
        let mut near = [0.0; 6];
        near[index] = 123.456;
        let solution = chain.inverse(&Point3::origin(), &Vector3::z(), &near).expect("a solution");
        assert_eq!(solution.joints[3..], near[3..], "{name}");
    }
}

#[test]
fn directions_that_are_not_reached_are_refused() {
    let tip = Point3::new(0.0, 0.0, -400.0);
    let solve = |machine: &Machine, axis: [f64; 3]| {
        let chain =
            machine.chain(&Setup { tool_length: 100.0, ..Setup::default() }).expect("a setup");
        chain.inverse(&tip, &axis.into(), &[0.0; 6]).map(|solution| solution.joints)
    };
    let missed = |machine: &Machine, axis| match solve(machine, axis).expect_err("no solution") {
        InverseError::Unreachable { degrees } => degrees,
        other => panic!("{other}"),
    };
    let three = Machine::named("3-axis").expect("a machine");
    let four = Machine::parse(FOUR_AXIS, "4-axis").expect("a machine");
    let five = Machine::named("A-C trunnion").expect("a machine");
    for machine in [&three, &four, &five] {
        for bad in [[0.0; 3], [f64::NAN, 0.0, 1.0], [0.0, f64::INFINITY, 1.0]] {
            assert_eq!(solve(machine, bad), Err(InverseError::NoDirection));
        }
        // Any length of the vector does, and the rounding of four digits.
        assert!(
            solve(machine, [0.0, 0.0, 1e-300]).is_ok() && solve(machine, [5e-5, 0.0, 1.0]).is_ok()
        );
    }
    assert!((missed(&three, [0.1, 0.0, 1.0]) - 0.1f64.atan().to_degrees()).abs() < 1e-9);
    assert_eq!(solve(&four, [0.0, -1.0, 0.0]).expect("a solution")[3], 90.0);
    assert!((missed(&four, [0.01, 0.0, 1.0]) - 0.01f64.atan().to_degrees()).abs() < 1e-9);
    // A can neither be 150° nor −150°.
    let refusal = solve(&five, [0.0, 0.5, -3f64.sqrt() / 2.0]).expect_err("no solution");
    let is_outside = |value: f64| (value - 150.0).abs() < 1e-9;
    assert!(
        matches!(refusal, InverseError::Limit { letter: Letter::A, value, low: -120.0, high: 30.0 } if is_outside(value)),
        "{refusal}"
    );
    let outside = five.chain(&Setup::default()).expect("a setup");
    let refusal = outside.inverse(&Point3::new(500.0, 0.0, 0.0), &Vector3::z(), &[0.0; 6]);
    assert_eq!(
        refusal,
        Err(InverseError::Limit { letter: Letter::X, value: 500.0, low: -350.0, high: 350.0 })
    );
}
