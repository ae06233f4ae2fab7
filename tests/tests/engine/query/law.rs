//! Properties of the laws: signs by hand, and the gradient law as the slope of the energy.

use super::compare::tools;
use super::parts;
use crate::prelude::*;
use nalgebra::{Isometry3, Translation3};
use touchoff_tests::haptics::upright;

fn energy(probe: &mut Probe<'_>, at: Isometry3<f64>) -> f64 {
    probe.wrench(&Pose::try_from(at).expect("a pose")).energy
}

/// Returns the slope of the energy as the pose is moved by a step along each coordinate.
fn slope(probe: &mut Probe<'_>, moved: impl Fn(Vector3<f64>) -> Isometry3<f64>) -> Vector3<f64> {
    const STEP: f64 = 1e-6;
    Vector3::from_fn(|axis, _| {
        let step = STEP * Vector3::ith(axis, 1.0);
        (energy(probe, moved(step)) - energy(probe, moved(-step))) / (2.0 * STEP)
    })
}

/// Force is the negative slope of the energy over the tip's position, torque that over rotations about the
/// compliance centre. Points that enter within the step, or change their region, leave an error of its order.
#[test]
fn the_gradient_law_is_the_slope_of_the_energy() {
    let part = parts::tube(3_000);
    let centre = Point3::new(0.5, -1.0, 2.0);
    for (tool, oracle) in tools() {
        let mut rng = Rng::new(12);
        let mut probe = Probe::new(&part, tool).with_law(Law::Gradient).with_centre(centre);
        let (mut touching, mut worst) = (0, [0f64; 2]);
        for k in 0..60 {
            let pose = parts::about(&part, &*oracle, k, &mut rng);
            let evaluation = probe.wrench(&pose);
            let at = pose.to_isometry();
            let about = (at * centre).coords;
            let to_tip = slope(&mut probe, |step| Translation3::from(step) * at);
            let turned = slope(&mut probe, |step| {
                let turn = UnitQuaternion::new(step);
                Translation3::from(about) * turn * Translation3::from(-about) * at
            });
            let size: f64 = probe
                .contacts(&pose)
                .iter()
                .map(|c| c.weight * c.magnitude * c.gradient.norm())
                .sum();
            let size = size + 1e-9;
            worst[0] = worst[0].max((evaluation.force + to_tip).norm() / size);
            worst[1] = worst[1].max((evaluation.torque + turned).norm() / (20.0 * size));
            touching += usize::from(evaluation.colliding > 0);
        }
        println!("{} {touching} {worst:?}", oracle.name());
        assert!(touching > 30 && worst.iter().all(|w| *w < 1e-4), "{} {worst:?}", oracle.name());
    }
}

/// One point, worked out on paper. The ball (radius 1) enters the plate by 0.25 below its middle: `m = 0.25`, `u
/// = -z`, `n = +z`.
#[test]
fn one_contact_agrees_with_a_hand_calculation() {
    let weight = 2.0;
    let part = parts::of(vec![Point3::new(10.0, 20.0, 30.0)], vec![Vector3::z()], vec![weight]);
    let tool = library::tool("UnitSphere");
    let pose = Pose::from_axis(Point3::new(10.0, 20.0, 29.75), Vector3::z()).expect("a pose");
    for (law, expected_force) in [(Law::Thesis, 2.0), (Law::Gradient, 1.0), (Law::Facing, 2.0)] {
        // Torque about a centre beside the tool, 3 below x: r = (3, 0, 0.25), F = (0, 0, f), r × F = (0, -3 f, 0).
        let mut probe =
            Probe::new(&part, tool).with_law(law).with_centre(Point3::new(-3.0, 0.0, 0.0));
        let wrench = probe.wrench(&pose);
        let force = weight * 0.25 * expected_force;
        assert_eq!(wrench.force, Vector3::new(0.0, 0.0, force));
        assert_eq!(wrench.torque, Vector3::new(0.0, -3.0 * force, 0.0));
        assert_eq!((wrench.depth(), wrench.integral, wrench.energy), (0.25, 0.5, 0.0625));
        // Some tens of units of roundoff of forces up to 1 on arms up to 5.
        let rounding = wrench.rounding;
        assert!(rounding.torque < 1e-13 && rounding.force < 1e-13, "{rounding:?}");
        let deepest = wrench.deepest.expect("a contact").point;
        assert_eq!(deepest, Point3::new(10.0, 20.0, 30.0));
    }
}

/// Two faces of a thin sheet in one ball: under `facing` the far one exerts no force, and still counts.
#[test]
fn the_facing_law_ignores_the_far_side_of_a_sheet() {
    let points = vec![Point3::new(0.0, 0.0, 0.0), Point3::new(0.0, 0.0, -0.0625)];
    let part = parts::of(points, vec![Vector3::z(), -Vector3::z()], vec![1.0; 2]);
    let tool = library::tool("UnitSphere");
    let evaluation = |law| Probe::new(&part, tool).with_law(law).wrench(&upright(-0.25));
    let (thesis, facing) = (evaluation(Law::Thesis), evaluation(Law::Facing));
    assert_eq!((thesis.colliding, facing.colliding), (2, 2));
    assert_eq!(facing.force, Vector3::new(0.0, 0.0, 0.5));
    // The far side's normal and direction both point down and cancel.
    assert!((thesis.force - facing.force).norm() < 1e-15);
    assert!((thesis.integral - 0.4375).abs() < 1e-15 && thesis.integral == facing.integral);
    assert!((evaluation(Law::Gradient).force.z - 0.4375).abs() < 1e-15);
}
