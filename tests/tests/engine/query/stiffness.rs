//! The derivative of the wrench against its finite differences.

use super::compare::tools;
use super::parts;
use crate::prelude::*;
use nalgebra::{Matrix6, Rotation3, Vector6};
use touchoff::Wrench;
use touchoff_tests::haptics::{block, tool, upright};

/// Step of the finite differences: a length in the part's unit, and an angle in rad.
const STEP: f64 = 1e-6;

/// Returns a pose moved by the first three components and turned by the last three about a point of the tool.
fn moved(pose: &Pose, centre: Point3<f64>, step: &Vector6<f64>) -> Pose {
    let about = pose.tip() + pose.rotation() * centre.coords;
    let turn = Rotation3::from_scaled_axis(Vector3::new(step[3], step[4], step[5]));
    let displacement = Vector3::new(step[0], step[1], step[2]);
    let tip = about + displacement + turn * (pose.tip() - about);
    let rotation = turn * Rotation3::from_matrix_unchecked(*pose.rotation());
    let q = UnitQuaternion::from_rotation_matrix(&rotation).coords;
    Pose::from_quaternion(tip, [q.x, q.y, q.z, q.w]).expect("a pose")
}

fn both(wrench: &Wrench) -> Vector6<f64> {
    let Wrench { force: f, torque: t, .. } = wrench;
    Vector6::new(f.x, f.y, f.z, t.x, t.y, t.z)
}

/// Returns minus the wrench's central differences.
fn differences(probe: &mut Probe<'_>, pose: &Pose, centre: Point3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    for axis in 0..6 {
        let mut step = Vector6::zeros();
        step[axis] = STEP;
        let [ahead, behind] =
            [step, -step].map(|step| both(&probe.wrench(&moved(pose, centre, &step))));
        matrix.set_column(axis, &((behind - ahead) / (2.0 * STEP)));
    }
    matrix
}

/// Returns the differences between the two matrices at poses about a part, relative to the matrix's own size,
/// sorted.
fn relative_errors(part: &Part, tool: &dyn Tool, oracle: &dyn Oracle, law: Law) -> Vec<f64> {
    let mut rng = Rng::new(31);
    let centre = Point3::new(0.3, -0.2, 1.5);
    let mut probe = Probe::new(part, tool).with_law(law).with_centre(centre);
    let mut relative_errors = Vec::new();
    for k in 0..60 {
        let pose = parts::about(part, oracle, k, &mut rng);
        let found = probe.stiffness(&pose);
        assert_eq!(found.wrench, probe.wrench(&pose));
        if found.wrench.colliding > 0 {
            let expected = differences(&mut probe, &pose, centre);
            relative_errors.push((found.matrix - expected).norm() / expected.norm());
        } else {
            assert_eq!(found.matrix, Matrix6::zeros());
        }
    }
    relative_errors.sort_by(f64::total_cmp);
    relative_errors
}

/// Where a point changes its region within a step, differences are of no use; therefore the worst tenth is not
/// compared.
#[test]
fn stiffness_agrees_with_finite_differences() {
    let part = parts::soup(6.0, 1_500, 5);
    for (tool, oracle) in tools() {
        for law in [Law::Gradient, Law::Thesis, Law::Facing] {
            let relative_errors = relative_errors(&part, tool, &*oracle, law);
            assert!(relative_errors.len() >= 20, "{}: {}", oracle.name(), relative_errors.len());
            let ninth_decile = relative_errors[relative_errors.len() * 9 / 10];
            let name = oracle.name();
            assert!(ninth_decile < 1e-6, "{name}, {law}: {ninth_decile:e} of {relative_errors:?}");
        }
    }
}

/// A flat end in a plane: a spring by the area.
#[test]
fn a_flat_face_is_a_spring() {
    let plane = block(200_000);
    let mut probe = Probe::new(&plane, tool("Flat")).with_law(Law::Gradient);
    let found = probe.stiffness(&upright(-1e-3));
    let area = found.wrench.force.z / 1e-3;
    assert!((found.matrix[(2, 2)] / area - 1.0).abs() < 1e-3, "{} {area}", found.matrix);
}
