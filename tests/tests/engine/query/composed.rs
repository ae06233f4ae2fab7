//! Poses that are composed many times stay rotations, and stay where they should be.

use crate::prelude::*;
use nalgebra::{Matrix3, Unit};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::space::exactly;
use touchoff_tests::oracle::vector::dot;

/// Largest entry of `RᵀR - I` of a composed rotation, in ε.
const MAX_ORTHOGONALITY_ERROR: f64 = 4.0;

/// Axes and angles (rad), small and large, about any axis and about those of the frame.
const TURNS: [([f64; 3], f64); 7] = [
    ([1.0, 2.0, 3.0], 1e-3),
    ([3.0, -1.0, 2.0], 1.0),
    ([-0.2, 0.7, 0.1], 1e-9),
    ([0.0, 0.0, 1.0], TAU / 360.0),
    ([1.0, 1.0, 1.0], FRAC_PI_3),
    ([0.0, 1.0, 0.0], FRAC_PI_2),
    ([0.6, -0.5, 2.0], TAU / 7.0),
];

/// Returns the largest entry of `RᵀR - I`, in ε.
fn orthogonality_error(rotation: &Matrix3<f64>) -> f64 {
    let columns = [0, 1, 2].map(|k| exactly(rotation.column(k).into_owned()));
    let mut largest = 0f64;
    for i in 0..3 {
        for j in i..3 {
            let entry = Big::exactly(if i == j { 1.0 } else { 0.0 });
            let off = &dot(&columns[i], &columns[j]) - &entry;
            largest = largest.max(off.abs().to_f64());
        }
    }
    largest / f64::EPSILON
}

/// Returns the rotation by `times` an angle about an axis.
fn turn((axis, angle): ([f64; 3], f64), times: f64) -> UnitQuaternion<f64> {
    let axis = Unit::new_normalize(Vector3::from(axis));
    UnitQuaternion::from_axis_angle(&axis, (times * angle) % TAU)
}

/// Returns a motion: the rotation about a point that is not the origin.
fn motion(by: ([f64; 3], f64)) -> Pose {
    let turn = turn(by, 1.0);
    let fixed = Point3::new(10.0, -20.0, 5.0);
    let tip = fixed - turn * fixed.coords;
    Pose::from_quaternion(tip, turn.coords.into()).expect("a unit quaternion")
}

#[test]
fn rotations_stay_rotations() {
    const COMPOSITIONS: u32 = 30_000;
    for by in TURNS {
        let step = motion(by);
        let mut pose = Pose::default();
        for _ in 0..COMPOSITIONS {
            pose = pose.then(&step);
            assert!(orthogonality_error(pose.rotation()) <= MAX_ORTHOGONALITY_ERROR, "{by:?}");
        }
        // Each composition, and the step itself, is off by some ε.
        let exact = turn(by, f64::from(COMPOSITIONS)).to_rotation_matrix();
        let difference = (pose.rotation() - exact.matrix()).norm();
        let bound = 2.0 * f64::EPSILON * f64::from(COMPOSITIONS);
        assert!(difference <= bound, "{by:?}: {difference:e}");
    }
}

/// Any chain of poses, each composed with the last or taken relative to it.
#[test]
fn any_chain_of_poses_ends_in_a_rotation() {
    let mut rng = Rng::new(12);
    let mut any = || {
        let [x, y, z] = rng.direction();
        let [a, b, c] = rng.direction();
        let tip = Point3::new(a, b, c);
        let axis = Pose::from_axis(tip, Vector3::new(x, y, z)).expect("a unit vector");
        let w = rng.between(-1.0, 1.0);
        let size = (1.0 + w * w).sqrt();
        let full = Pose::from_quaternion(tip, [x, y, z, w].map(|part| part / size));
        [axis, full.expect("a unit quaternion")]
    };
    let mut pose = Pose::default();
    for _ in 0..20_000 {
        for other in any() {
            let error = orthogonality_error(other.rotation());
            assert!(error <= 2.0 * MAX_ORTHOGONALITY_ERROR, "{other:?}");
            pose = pose.then(&other).relative_to(&any()[1]);
            assert!(orthogonality_error(pose.rotation()) <= MAX_ORTHOGONALITY_ERROR, "{pose:?}");
            // A pose composed with another and taken relative to it is the same again.
            let back = pose.then(&other).relative_to(&other);
            assert!((back.rotation() - pose.rotation()).norm() < 3e-15, "{other:?}");
            assert!((back.tip() - pose.tip()).norm() < 1e-14 * (1.0 + pose.tip().coords.norm()));
        }
    }
}

/// One motion after another is the product, point by point.
#[test]
fn composed_motions_agree_with_successive_ones() {
    let mut rng = Rng::new(5);
    for by in TURNS {
        let first = motion(by);
        let second = motion((rng.direction(), 0.7));
        let both = first.then(&second);
        let through = |pose: &Pose, p: Point3<f64>| pose.tip() + pose.rotation() * p.coords;
        let p = Point3::from(rng.direction());
        let difference = through(&both, p) - through(&second, through(&first, p));
        assert!(difference.norm() < 1e-12, "{difference}");
        assert!(both.has_spin());
        let spun = Pose::from_axis(p, Vector3::z()).expect("a unit vector");
        assert!(!spun.then(&second).has_spin());
    }
}
