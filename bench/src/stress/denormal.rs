//! Item 13: denormal coordinates, depths and weights.

use super::judge::Judge;
use super::ledger::{Kind, Ledger};
use super::scene::{Asked, Given};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff_tests::oracle::draw::Rng;

/// Error of a stored weight, in units of `f32` rounding relative to the largest weight.
const WEIGHTS: Kind = Kind::of("stored weight", "2^-24 of the largest", 1.0);

const TINY: [f64; 8] = [5e-324, -5e-324, 1e-323, 1e-310, -1e-310, 2.2e-308, 1e-300, 1e-160];

/// Validates denormal coordinates, weights and poses.
pub(super) fn denormal(subject: &Subject, count: usize, draw: &mut Rng, ledger: &mut Ledger) {
    let judge = Judge::new(subject.tool, &*subject.truth);
    let mut tiny = || TINY[draw.bits() as usize % TINY.len()];
    let mut near: Vec<[f64; 3]> = (0..count).map(|_| [tiny(), tiny(), tiny()]).collect();
    // Include points near every corner, and on the lowest face.
    let mut corners: Vec<[f64; 3]> = subject.oracle.corner_points();
    let half = subject.oracle.extent()[0] / 4.0;
    corners.push([half, 0.0, 0.0]);
    for [x, y, z] in corners {
        near.extend([[x, tiny(), z], [tiny(), y, z], [x, y, tiny()], [x, tiny(), tiny()]]);
    }
    judge.points(&near, ledger);

    for weight in [1.0, 1e-300, 1e-310, 5e-324] {
        let mut given = Given::about(subject, 40, 2f64.powi(-20), draw);
        for (k, p) in near.iter().take(20).enumerate() {
            given.points[k] = Point3::from(*p);
        }
        for (k, own) in given.weights.iter_mut().enumerate() {
            *own = if k % 3 == 0 { weight } else { weight * draw.between(0.0, 1.0) };
        }
        given.weights[1] = 5e-324;
        poses(subject, &given, ledger);
    }
    let points: Vec<_> = near.iter().take(40).map(|p| Point3::from(*p)).collect();
    let given = Given {
        normals: vec![Vector3::x(); points.len()],
        weights: vec![1.0; points.len()],
        points,
        unit: subject.tool.info().unit,
    };
    poses(subject, &given, ledger);
}

fn poses(subject: &Subject, given: &Given, ledger: &mut Ledger) {
    let part = given.part();
    let (tool, truth) = (subject.tool, &*subject.truth);
    let asked = Asked { tool, truth, given, part: &part };
    for tip in [0.0, -0.0, 5e-324, -1e-310] {
        for turn in [[0.0, 0.0, 0.0, 1.0], [5e-324, 1e-310, 0.0, 1.0], [0.5, 0.5, 0.5, 0.5]] {
            let tip = Point3::new(tip, -tip, tip);
            let pose = Pose::from_quaternion(tip, turn).expect("a unit quaternion");
            asked.at(&pose, ledger);
        }
    }
    let largest = given.weights.iter().copied().fold(0.0, f64::max);
    let tree = part.tree();
    for k in 0..tree.len() {
        let (stored, own) = (tree.weight(k), given.weights[tree.triangle(k) as usize]);
        let off = (stored - own).abs();
        // If the largest weight is itself denormal, a fraction of it is rounded to a denormal number.
        let bound = largest * 2f64.powi(-24) + 5e-324;
        ledger.see(WEIGHTS, off / bound, || format!("{own:e} of {largest:e} is {stored:e}"));
    }
}
