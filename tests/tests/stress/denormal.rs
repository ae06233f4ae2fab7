//! Item 13: coordinates, depths, weights and poses of 5e-324 to 1e-300. The contract; and a stored weight differs from
//! the given one by at most 2^-24 of the largest.

use crate::prelude::*;

const TINY: [f64; 8] = [5e-324, -5e-324, 1e-323, 1e-310, -1e-310, 2.2e-308, 1e-300, 1e-160];

#[test]
fn denormal_numbers_keep_the_contract() {
    check_tools(13, |subject, rng, checks| {
        let mut tiny = || TINY[rng.bits() as usize % TINY.len()];
        let mut points: Vec<[f64; 3]> =
            (0..extent(12, 200)).map(|_| [tiny(), tiny(), tiny()]).collect();
        // Near every corner, and on the lowest face.
        let mut corners: Vec<[f64; 3]> = subject.oracle.corner_points();
        corners.push([subject.oracle.extent()[0] / 4.0, 0.0, 0.0]);
        for [x, y, z] in corners {
            points.extend([[x, tiny(), z], [tiny(), y, z], [x, y, tiny()], [x, tiny(), tiny()]]);
        }
        Validator::new(subject.tool, &*subject.truth).validate(&points, checks);

        let points: Vec<Point3<f64>> = points.into_iter().take(40).map(Point3::from).collect();
        for weight in [1.0, 1e-300, 1e-310, 5e-324] {
            let mut set = PointSet::near_tool(subject, 40, 2f64.powi(-20), rng);
            let count = points.len().min(20);
            set.points[..count].copy_from_slice(&points[..count]);
            for (k, weight_of_point) in set.weights.iter_mut().enumerate() {
                *weight_of_point = if k % 3 == 0 { weight } else { weight * rng.between(0.0, 1.0) };
            }
            set.weights[1] = 5e-324;
            check_poses(subject, &set, checks);
        }
        let set = PointSet {
            normals: vec![Vector3::x(); points.len()],
            weights: vec![1.0; points.len()],
            points,
            unit: subject.tool.info().unit,
        };
        check_poses(subject, &set, checks);
    });
}

fn check_poses(subject: &Subject, points: &PointSet, checks: &mut Checks) {
    for z in [0.0, -0.0, 5e-324, -1e-310] {
        for quaternion in [[0.0, 0.0, 0.0, 1.0], [5e-324, 1e-310, 0.0, 1.0], [0.5, 0.5, 0.5, 0.5]] {
            let pose = pose(Point3::new(z, -z, z), quaternion);
            Scene::new(subject, points.clone(), pose).check(checks);
        }
    }
    let largest = points.weights.iter().copied().fold(0.0, f64::max);
    // If the largest weight is itself denormal, a fraction of it is rounded to a denormal number.
    let bound = largest * 2f64.powi(-24) + 5e-324;
    let part = points.part();
    let tree = part.tree();
    for k in 0..tree.len() {
        let (stored, given) = (tree.weight(k), points.weights[tree.triangle(k).index()]);
        let place = || format!("{given:e} of {largest:e} is {stored:e}");
        let name = "stored weight [2^-24 of the largest]";
        checks.within(name, (stored - given).abs() / bound, 1.0, place);
    }
}
