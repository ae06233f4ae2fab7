//! Item 13: denormal coordinates, depths and weights.

use super::ledger::{Kind, Ledger};
use super::scene::{PointSet, ProbeCheck};
use super::truth::Subject;
use super::validator::Validator;
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff_tests::oracle::rng::Rng;

/// Error of a stored weight, in units of `f32` rounding relative to the largest weight.
const WEIGHT_ERROR: Kind = Kind::with_limit("stored weight", "2^-24 of the largest", 1.0);

const TINY_NUMBERS: [f64; 8] = [5e-324, -5e-324, 1e-323, 1e-310, -1e-310, 2.2e-308, 1e-300, 1e-160];

/// Validates denormal coordinates, weights and poses.
pub(super) fn denormal(subject: &Subject, count: usize, rng: &mut Rng, ledger: &mut Ledger) {
    let validator = Validator::new(subject.tool, &*subject.truth);
    let mut tiny = || TINY_NUMBERS[rng.bits() as usize % TINY_NUMBERS.len()];
    let mut points: Vec<[f64; 3]> = (0..count).map(|_| [tiny(), tiny(), tiny()]).collect();
    // Include points near every corner, and on the lowest face.
    let mut corners: Vec<[f64; 3]> = subject.oracle.corner_points();
    let quarter_radius = subject.oracle.extent()[0] / 4.0;
    corners.push([quarter_radius, 0.0, 0.0]);
    for [x, y, z] in corners {
        points.extend([[x, tiny(), z], [tiny(), y, z], [x, y, tiny()], [x, tiny(), tiny()]]);
    }
    validator.validate(&points, ledger);

    for weight in [1.0, 1e-300, 1e-310, 5e-324] {
        let mut point_set = PointSet::near_tool(subject, 40, 2f64.powi(-20), rng);
        for (k, p) in points.iter().take(20).enumerate() {
            point_set.points[k] = Point3::from(*p);
        }
        for (k, weight_of_point) in point_set.weights.iter_mut().enumerate() {
            *weight_of_point = if k % 3 == 0 { weight } else { weight * rng.between(0.0, 1.0) };
        }
        point_set.weights[1] = 5e-324;
        check_poses(subject, &point_set, ledger);
    }
    let few: Vec<_> = points.iter().take(40).map(|p| Point3::from(*p)).collect();
    let point_set = PointSet {
        normals: vec![Vector3::x(); few.len()],
        weights: vec![1.0; few.len()],
        points: few,
        unit: subject.tool.info().unit,
    };
    check_poses(subject, &point_set, ledger);
}

fn check_poses(subject: &Subject, point_set: &PointSet, ledger: &mut Ledger) {
    let part = point_set.part();
    let (tool, truth) = (subject.tool, &*subject.truth);
    let check = ProbeCheck { tool, truth, point_set, part: &part };
    for tip in [0.0, -0.0, 5e-324, -1e-310] {
        for quaternion in [[0.0, 0.0, 0.0, 1.0], [5e-324, 1e-310, 0.0, 1.0], [0.5, 0.5, 0.5, 0.5]] {
            let tip = Point3::new(tip, -tip, tip);
            let pose = Pose::from_quaternion(tip, quaternion).expect("a unit quaternion");
            check.check(&pose, ledger);
        }
    }
    let largest = point_set.weights.iter().copied().fold(0.0, f64::max);
    let tree = part.tree();
    for k in 0..tree.len() {
        let (stored, given) = (tree.weight(k), point_set.weights[tree.triangle(k).index()]);
        let error = (stored - given).abs();
        // If the largest weight is itself denormal, a fraction of it is rounded to a denormal number.
        let bound = largest * 2f64.powi(-24) + 5e-324;
        ledger.record(WEIGHT_ERROR, error / bound, || {
            format!("{given:e} of {largest:e} is {stored:e}")
        });
    }
}
