//! Solids without an axis at full poses, with contacts that are known in closed form.

use super::parts;
use crate::prelude::*;
use touchoff_tools::Block;

/// Returns the plane z = 0 of a pose's own frame, 60 by 60 in squares of a quarter, facing up.
fn plane(pose: &Pose) -> Part {
    let spots = (0..240).flat_map(|i| (0..240).map(move |k| (i, k)));
    let along = |k: i32| f64::from(k) / 4.0 - 29.875;
    let points: Vec<_> = spots
        .map(|(i, k)| pose.tip() + pose.rotation() * Vector3::new(along(i), along(k), 0.0))
        .collect();
    let count = points.len();
    parts::of(points, vec![pose.rotation() * Vector3::z(); count], vec![1.0 / 16.0; count])
}

fn pose(tip: Point3<f64>, quaternion: [f64; 4]) -> Pose {
    Pose::from_quaternion(tip, quaternion).expect("a pose")
}

/// Returns a pose moved by a step in its own frame.
fn shifted(pose: &Pose, step: Vector3<f64>) -> Pose {
    let mut isometry = pose.to_isometry();
    isometry.translation.vector += pose.rotation() * step;
    Pose::try_from(isometry).expect("a pose")
}

/// The block pressed `h` deep into a plane. The depth is `h`, but for a hipped rim of 45°, so that `∫ m dA = h w
/// l - h² (w + l) + 4 h³/3`; only the part that is nearest to the underside pushes up.
#[test]
fn a_block_on_a_plane() {
    let mut rng = Rng::new(91);
    let (w, l) = (40.0, 30.0);
    for k in 0..8 {
        let block_pose = if k == 0 {
            pose(Point3::origin(), [0.0, 0.0, 0.0, 1.0])
        } else {
            pose(parts::vector(&mut rng, 100.0).into(), rng.quaternion())
        };
        let part = plane(&block_pose);
        for h in [0.5, 1.5, 4.0] {
            let pose = shifted(&block_pose, Vector3::new(0.0, 0.0, -h));
            let mut probe = Probe::new(&part, &Block).with_law(Law::Gradient);
            let evaluation = probe.wrench(&pose);
            assert!(probe.detect(&pose));
            assert_near(evaluation.depth(), h, 1e-5, "depth");
            let integral = h * w * l - h * h * (w + l) + 4.0 * h.powi(3) / 3.0;
            assert_near(evaluation.integral / integral, 1.0, 1e-3, h);
            let up = h * (w - 2.0 * h) * (l - 2.0 * h);
            let force_in_tool = pose.rotation().transpose() * evaluation.force;
            assert_near(force_in_tool.z / up, 1.0, 0.03, h);
            // Everything cancels but the points of the hips themselves, which may fall to either side.
            let (across, torque) = (force_in_tool.xy().norm(), evaluation.torque.norm());
            assert!(across < 0.01 * up && torque < 0.1 * up, "{force_in_tool} {torque} {up}");
        }
        let clear = shifted(&block_pose, Vector3::new(0.0, 0.0, 1e-3));
        assert!(!Probe::new(&part, &Block).detect(&clear));
    }
}

/// Spin matters without an axis: a pose from an axis does not place a solid, and reports that it has no spin.
#[test]
fn the_spin_matters() {
    let still = pose(Point3::origin(), [0.0, 0.0, 0.0, 1.0]);
    let part = parts::identical(Point3::new(18.0, 0.0, 5.0), 1);
    let mut probe = Probe::new(&part, &Block);
    assert!(still.has_spin() && probe.detect(&still));
    let half = 0.5f64.sqrt();
    let turned = pose(Point3::origin(), [0.0, 0.0, half, half]);
    assert!(turned.has_spin() && !probe.detect(&turned));
    let axial = Pose::from_axis(Point3::origin(), Vector3::z()).expect("a pose");
    assert!(!axial.has_spin());
}
