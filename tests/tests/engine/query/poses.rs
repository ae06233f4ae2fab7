//! Random poses.

use super::parts::{direction, vector};
use nalgebra::{Point3, Vector3};
use touchoff::{Part, Pose};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;

/// Returns a pose of random orientation that brings the tool's own point `in_tool` to `at`.
pub(crate) fn bringing(in_tool: Vector3<f64>, at: Point3<f64>, rng: &mut Rng) -> Pose {
    let turned = Pose::from_quaternion(Point3::origin(), rng.quaternion()).expect("a pose");
    let quaternion = turned.to_isometry().rotation.coords.into();
    Pose::from_quaternion(at - turned.rotation() * in_tool, quaternion).expect("a pose")
}

/// Returns a pose about a part: one in eight far off, the others with some point of the part in the tool or hardly
/// outside.
pub(crate) fn about(part: &Part, oracle: &dyn Oracle, k: usize, rng: &mut Rng) -> Pose {
    let tree = part.tree();
    let point = tree.point(rng.index(tree.len()));
    let [width, height] = oracle.extent();
    if k % 8 == 7 {
        let distance = rng.between(1.0, 4.0) * 10f64.powi(rng.bits() as i32 & 3);
        return bringing(vector(rng, height), point + distance * height * direction(rng), rng);
    }
    if !oracle.is_revolved() {
        // A solid may fill little of the box about it, so the point is near a face or a splitting surface.
        let curves = oracle.curve_points();
        let curve = &curves[rng.index(curves.len())];
        let own = Vector3::from(curve[rng.index(curve.len())]);
        return bringing(own + vector(rng, 0.02 * height), point, rng);
    }
    let axis = direction(rng);
    let d = 1.05 * width * rng.between(0.0, 1.0);
    let z = rng.between(-0.05, 1.05) * height;
    let d = d / axis.x.hypot(axis.y).max(1e-9);
    bringing(Vector3::new(d * axis.x, d * axis.y, z), point, rng)
}
