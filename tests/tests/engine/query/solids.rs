//! Solids without an axis at full poses, with contacts that are known in closed form.

use super::parts;
use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::{Law, Part, Pose, Probe, Sampling, Unit};
use touchoff_tests::library;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tools::{Block, LBracket};

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

fn anywhere(rng: &mut Rng) -> Pose {
    let tip = Point3::from(parts::vector(rng, 100.0));
    Pose::from_quaternion(tip, rng.quaternion()).expect("a pose")
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
            Pose::from_quaternion(Point3::origin(), [0.0, 0.0, 0.0, 1.0]).expect("a pose")
        } else {
            anywhere(&mut rng)
        };
        let part = plane(&block_pose);
        for h in [0.5, 1.5, 4.0] {
            let pose = shifted(&block_pose, Vector3::new(0.0, 0.0, -h));
            let mut probe = Probe::new(&part, &Block).with_law(Law::Gradient);
            let evaluation = probe.wrench(&pose);
            assert!(probe.detect(&pose));
            assert!((evaluation.depth() - h).abs() < 1e-5, "{} at {h}", evaluation.depth());
            let integral = h * w * l - h * h * (w + l) + 4.0 * h.powi(3) / 3.0;
            assert!(
                (evaluation.integral / integral - 1.0).abs() < 1e-3,
                "{} {integral}",
                evaluation.integral
            );
            let up = h * (w - 2.0 * h) * (l - 2.0 * h);
            let force_in_tool = pose.rotation().transpose() * evaluation.force;
            assert!((force_in_tool.z / up - 1.0).abs() < 0.03, "{force_in_tool} {up}");
            // Everything cancels but the points of the hips themselves, which may fall to either side.
            assert!(
                force_in_tool.xy().norm() < 0.01 * up && evaluation.torque.norm() < 0.1 * up,
                "{force_in_tool} {up}"
            );
        }
        let clear = shifted(&block_pose, Vector3::new(0.0, 0.0, 1e-3));
        assert!(!Probe::new(&part, &Block).detect(&clear));
    }
}

/// A pin in the bracket's hole, turned with it: clear while it is thinner than the hole, and as deep in its wall
/// all round as it is thicker.
#[test]
fn a_pin_in_the_hole_of_a_bracket() {
    let mut rng = Rng::new(92);
    for _ in 0..6 {
        let pose = anywhere(&mut rng);
        for (radius, depth) in [(3.2, None), (3.4, Some(0.1)), (4.0, Some(0.7))] {
            let points: Vec<_> = (0..20_000)
                .map(|_| {
                    let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
                    let z = rng.between(1.0, 5.0);
                    let own = Vector3::new(10.0 + radius * cos, radius * sin, z);
                    pose.tip() + pose.rotation() * own
                })
                .collect();
            let count = points.len();
            let part = parts::of(points, vec![Vector3::z(); count], vec![1.0; count]);
            let mut probe = Probe::new(&part, &LBracket);
            let contacts = probe.contacts(&pose);
            assert_eq!(contacts.len(), if depth.is_some() { count } else { 0 });
            for contact in contacts {
                assert!((contact.depth - depth.unwrap_or_default()).abs() < 1e-5, "{contact:?}");
                let out =
                    contact.point - pose.tip() - pose.rotation() * Vector3::new(10.0, 0.0, 0.0);
                let along = pose.axis().dot(&out) * pose.axis();
                assert!((contact.direction + (out - along) / radius).norm() < 1e-5);
            }
        }
    }
}

/// Surfaces of the bracket in contact with a rail, by name, and the greatest depth.
#[test]
fn a_bracket_around_a_rail() {
    let rail = shapes::cuboid(
        Point3::new(-3.5, -40.0, 6.5),
        Point3::new(3.5, 40.0, 30.0),
        Unit::Millimetre,
    );
    let part =
        Part::from_mesh(&rail.expect("a box"), Sampling::new(40_000).with_seed(3)).expect("a part");
    let mut probe = Probe::new(&part, &LBracket);
    let at = |x: f64, z: f64| Pose::from_quaternion(Point3::new(x, 0.0, z), [0.0, 0.0, 0.0, 1.0]);
    // Standing clear, then against the inner face, then lifted into the upper one.
    assert!(!probe.detect(&at(0.0, 0.0).expect("a pose")));
    let mut surfaces = |x: f64, z: f64| {
        let contacts = probe.contacts(&at(x, z).expect("a pose")).to_vec();
        let name = |id| &*library::tool("LBracket").info().surface(id).name;
        let deepest = contacts.iter().map(|c| c.depth).fold(0.0, f64::max);
        let mut names: Vec<String> = contacts.iter().map(|c| name(c.surface).to_owned()).collect();
        names.sort();
        names.dedup();
        (names, deepest)
    };
    let (names, deepest) = surfaces(1.5, 0.0);
    assert!(
        names.contains(&"inner".to_owned()) && (deepest - 1.0).abs() < 1e-3,
        "{names:?} {deepest}"
    );
    let (names, deepest) = surfaces(0.0, 1.0);
    assert!(
        names.contains(&"inner".to_owned()) && (deepest - 0.5).abs() < 1e-3,
        "{names:?} {deepest}"
    );
}

/// Spin matters without an axis: a pose from an axis does not place a solid, and reports that it has no spin.
#[test]
fn the_spin_matters() {
    let pose = Pose::from_quaternion(Point3::origin(), [0.0, 0.0, 0.0, 1.0]).expect("a pose");
    let point = Point3::new(18.0, 0.0, 5.0);
    let part = parts::identical(point, 1);
    let mut probe = Probe::new(&part, &Block);
    assert!(pose.has_spin() && probe.detect(&pose));
    let half = 0.5f64.sqrt();
    let turned = Pose::from_quaternion(Point3::origin(), [0.0, 0.0, half, half]).expect("a pose");
    assert!(turned.has_spin() && !probe.detect(&turned));
    let axial = Pose::from_axis(Point3::origin(), Vector3::z()).expect("a pose");
    assert!(!axial.has_spin());
}
