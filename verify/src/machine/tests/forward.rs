//! Forward kinematics against the 256-bit chain.

use super::exact::{Affine, FileMachine, big};
use super::{Random, cases, texts};
use crate::machine::{Chain, JointError, Letter, Machine};
use nalgebra::Matrix3;
use touchoff::Pose;

/// Returns the errors of a pose: of the tip, and of the rotation in the Frobenius norm, which is at least
/// that of the operator.
pub(super) fn errors(pose: &Pose, exact: &Affine) -> [f64; 2] {
    let norm = |squares: [f64; 2]| squares.map(f64::sqrt);
    let mut squares = [0.0; 2];
    for row in 0..3 {
        for column in 0..4 {
            let (at, value) = match column {
                3 => (0, pose.tip()[row]),
                _ => (1, pose.rotation()[(row, column)]),
            };
            squares[at] += (&exact.0[row][column] - big(value)).to_f64().value().powi(2);
        }
    }
    norm(squares)
}

/// Compares poses relative to the workpiece and to all links with the exact ones, at random joints, at
/// singular and at nearly singular ones. Prints the greatest part of the bound that an error takes.
#[test]
fn poses_are_within_their_rounding_bounds() {
    let mut random = Random::new(1);
    let mut greatest = [0.0f64; 2];
    let machines: Vec<_> = texts()
        .into_iter()
        .map(|text| (Machine::parse(text, "test").expect("a machine"), FileMachine::parse(text)))
        .collect();
    let count = cases("JOINTS", 10_000);
    for case in 0..count {
        let (machine, file) = &machines[case % machines.len()];
        let setup = random.setup(machine);
        let joints = random.joints(machine, 500.0);
        let chain = machine.chain(&setup).expect("a setup");
        let mut check = |chain: &Chain, exact: &Affine| {
            let pose = chain.pose(&joints).expect("a pose");
            let rotation = pose.rotation();
            let error = (rotation.transpose() * rotation - Matrix3::identity()).norm();
            assert!(error <= 4.5 * f64::EPSILON);
            let bound = chain.rounding(&joints);
            for (at, (error, bound)) in
                errors(&pose, exact).into_iter().zip([bound.tip, bound.rotation]).enumerate()
            {
                assert!(
                    error <= bound,
                    "{}: {joints:?} {setup:?}: {error:e} > {bound:e}",
                    machine.name()
                );
                greatest[at] = greatest[at].max(error / bound);
            }
        };
        let length = setup.tool_length;
        let motions = file.motions(&joints);
        let last = file.pose(&motions, length, file.links());
        check(&chain, &file.workpiece(&setup.work_offset).inverse().then(&last));
        let link = random.below(file.links() + 1);
        check(&chain.relative_to(link).expect("a link"), &file.pose(&motions, length, link));
    }
    println!(
        "{count} joints: greatest error of the tip {:.3} of its bound, of the rotation {:.3}",
        greatest[0], greatest[1]
    );
}

/// Joint values for program coordinates without TCP put the tip at them, and linear joints with TCP do so at
/// any rotary values.
#[test]
fn program_coordinates_are_those_of_the_tip() {
    let mut random = Random::new(2);
    for text in texts() {
        let machine = Machine::parse(text, "test").expect("a machine");
        for _ in 0..200 {
            let mut setup = random.setup(&machine);
            setup.work_offset[3..].fill(0.0);
            let program = [0, 1, 2].map(|_| 100.0 * random.unit());
            let [x, y, z] = program;
            let chain = machine.chain(&setup).expect("a setup");
            let joints = setup.joints(&[x, y, z, 0.0, 0.0, 0.0]);
            let pose = chain.pose(&joints).expect("a pose");
            assert!((pose.tip() - nalgebra::Point3::from(program)).norm() < 2e-12);
            assert!((pose.rotation() - nalgebra::Matrix3::identity()).norm() < 1e-15);
            let [.., a, b, c] = random.joints(&machine, 1.0);
            let joints = chain.linear_joints(&program.into(), [a, b, c]).expect("joints");
            let bound = 2.0 * chain.rounding(&joints).tip;
            let pose = chain.pose(&joints).expect("a pose");
            assert!((pose.tip() - nalgebra::Point3::from(program)).norm() <= bound);
        }
    }
}

#[test]
fn values_that_are_no_joints_are_refused() {
    let machine = Machine::named("A-C trunnion").expect("a machine");
    let chain = machine.chain(&Default::default()).expect("a setup");
    let refusal = |joints| chain.pose(&joints).expect_err("no joints");
    let what = |error: JointError| match error {
        JointError::Range { what, .. } => what,
        other => panic!("{other}"),
    };
    for bad in [f64::NAN, f64::INFINITY, -2e6] {
        for index in 0..6 {
            let mut joints = [0.0; 6];
            joints[index] = bad;
            assert_eq!(what(refusal(joints)), "XYZABC"[index..=index]);
            let mut setup = super::Setup { work_offset: joints, tool_length: 0.0 };
            assert!(machine.chain(&setup).is_err());
            setup = super::Setup { work_offset: [0.0; 6], tool_length: bad };
            assert_eq!(what(machine.chain(&setup).expect_err("no length")), "the tool length");
        }
    }
    let missing = JointError::NoAxis { letter: Letter::B, value: 1.5 };
    assert_eq!(refusal([0.0, 0.0, 0.0, 0.0, 1.5, 0.0]), missing);
    let missing = JointError::NoLink { link: 4, last: 3 };
    assert_eq!(chain.relative_to(4).expect_err("no link"), missing);
    let tip = nalgebra::Point3::origin();
    let base = chain.relative_to(0).expect("the base");
    assert!(
        base.linear_joints(&tip, [0.0; 3]).is_err() && chain.linear_joints(&tip, [0.0; 3]).is_ok()
    );
}
