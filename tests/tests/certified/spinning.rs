//! Motions of solids without an axis of symmetry, whose spin is known and enters the proof.

use crate::prelude::*;
use nalgebra::{Quaternion, UnitQuaternion};
use touchoff_tests::oracle;

fn pose_from_rotation(tip: [f64; 3], turn: UnitQuaternion<f64>) -> Pose {
    Pose::from_quaternion(Point3::from(tip), turn.coords.into()).expect("a quaternion")
}

fn pose_about_z(tip: [f64; 3], degrees: f64) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), degrees.to_radians());
    pose_from_rotation(tip, turn)
}

fn motion(from: &Pose, to: &Pose) -> Motion {
    Motion::with_spin(from, to).expect("less than half a turn")
}

/// The block is 40 by 30 mm. Its sides are 20 and 15 mm from its axis, its corners 25 mm. It rotates beside a wall at a
/// distance between these.
#[test]
fn a_corner_of_a_block_reaches_a_wall_when_it_points_there() {
    let rotation_at =
        |x: f64| motion(&pose_about_z([x, 0.0, 0.0], 0.0), &pose_about_z([x, 0.0, 0.0], 90.0));
    let mut certifier = certifier(&block([0.0, -60.0, -20.0], [30.0, 60.0, 40.0]), "Block");
    assert_eq!(certifier.check_motion(&rotation_at(-25.003), 1e-6), MotionVerdict::Clear);
    for reach in [24.9, 24.0, 21.0] {
        let (at, witness) = touching(certifier.check_motion(&rotation_at(-reach), 1e-6));
        // The corner at (20, -15) points at the wall after 36.87 degrees. It is in the wall while 25 mm times the
        // cosine of the deviation exceeds the wall's distance.
        let (corner, half) = (0.75f64.atan(), (reach / 25.0).acos());
        let angle = at * std::f64::consts::FRAC_PI_2;
        assert!((angle - corner).abs() <= half + 1e-9, "{reach}: {at}");
        assert!(witness.point.x.abs() < 1e-9, "{witness:?}");
    }
    // During the motion the deepest point is on the wall beside the corner. At both ends the block is outside.
    let mut bounds = [0.0f64; 2];
    for surface in (0..6).map(SurfaceId) {
        match certifier.motion_depth(surface, &rotation_at(-24.5), 0.0, 1e-6).expect("a surface") {
            MotionDepth::Deeper { depth, max_depth, .. } => {
                bounds = [bounds[0].max(depth.low), bounds[1].max(max_depth)];
            }
            other => assert_eq!(other, MotionDepth::Within),
        }
    }
    // With `a` the angle between the wall's normal and a side's, the wall's point equally far from both sides has depth
    // `h / (cos a + sin a)` if the corner extends `h` beyond the wall. It is largest when the corner points slightly
    // past the wall's normal.
    let deviations = (-1000..=1000).map(|step| 1e-5 * f64::from(step));
    let depths = deviations.map(|deviation| {
        let (sine, cosine) = (0.75f64.atan() + deviation).sin_cos();
        (25.0 * deviation.cos() - 24.5) / (cosine + sine)
    });
    let depth = depths.fold(0.0, f64::max);
    assert!(
        bounds[0] <= depth + 1e-6 && depth <= bounds[1] + 1e-6 && bounds[1] < 1.6 * depth,
        "{bounds:?}"
    );
}

#[test]
fn a_solid_without_spin_is_undecided() {
    let mut certifier = certifier(&crate::plate(), "Block");
    let rest_pose = pose([0.0, 0.0, 50.0], [0.0, 0.0, 1.0]);
    let motion = crate::motion(&rest_pose, &rest_pose);
    assert_eq!(certifier.check_motion(&motion, 1e-3), MotionVerdict::Undecided(0.0));
    let depth = certifier.motion_depth(SurfaceId(0), &motion, 0.0, 1e-3);
    assert_eq!(depth, Ok(MotionDepth::Undecided(0.0)));
}

/// Random motions, short and long, past a ball and a plate. The oracle rotates each point by the quaternion formula and
/// has the solid's planes written out.
#[test]
fn samples_of_spinning_motions_are_within_the_bounds() {
    const TOLERANCE: f64 = 1e-3;
    let mut rng = Rng::new(17);
    let parts = [
        shapes::sphere(9.0, 3, Unit::Millimetre).expect("a sphere"),
        block([-30.0, -2.0, -25.0], [30.0, 2.0, 25.0]),
    ];
    let [mut clear, mut touching, mut inside, mut undecided, mut bounded] = [0; 5];
    for mesh in &parts {
        for name in ["Block", "LBracket"] {
            let oracle: &dyn Oracle = &*oracle::of(name);
            let tool = crate::tool(name);
            let mut certifier = certifier_of(mesh, tool);
            for k in 0..case_count("MOTIONS", 12) {
                let start_rotation =
                    UnitQuaternion::new(Vector3::from(rng.direction()) * rng.between(0.0, 3.0));
                let axis = Vector3::from(rng.direction());
                let angle = [0.0, 0.05, 0.6, 2.5][k % 4];
                let end_rotation = start_rotation * UnitQuaternion::new(axis * angle);
                let tip = Vector3::from(rng.direction()) * rng.between(20.0, 42.0);
                let displacement = Vector3::from(rng.direction()) * [30.0, 3.0, 0.3][k % 3];
                let from = pose_from_rotation(tip.into(), start_rotation);
                let to = pose_from_rotation((tip + displacement).into(), end_rotation);
                let motion = motion(&from, &to);
                let depths = |t: f64| {
                    let half = 0.5 * t * angle;
                    let step = Quaternion::from_parts(half.cos(), axis * half.sin());
                    let rotation = start_rotation.quaternion() * step;
                    let tip_at_t = tip + t * displacement;
                    let to_tool = move |p: Point3<f64>| -> [f64; 3] {
                        let q = Quaternion::from_parts(0.0, p.coords - tip_at_t);
                        (rotation.conjugate() * q * rotation).imag().into()
                    };
                    let points = triangles(mesh).flat_map(|[a, b, c]| {
                        let centroid = a + ((b - a) + (c - a)) / 3.0;
                        [a, b, c, nalgebra::center(&a, &b), nalgebra::center(&b, &c), centroid]
                    });
                    let evaluations = points.filter_map(move |p| oracle.evaluate(to_tool(p)));
                    evaluations.map(|evaluation| evaluation.depth).fold(0.0, f64::max)
                };
                let times = (0..=60).map(|step| f64::from(step) / 60.0);
                let sampled = times.map(depths).fold(0.0, f64::max);
                let text = format!("{name} {k} from {from:?} to {to:?}: {sampled}");
                match certifier.check_motion(&motion, TOLERANCE) {
                    MotionVerdict::Clear => {
                        clear += 1;
                        assert!(sampled <= TOLERANCE, "{text}");
                    }
                    MotionVerdict::Touching(at, witness) => {
                        touching += 1;
                        let contact_pose = motion.pose(at);
                        let p = crate::to_tool(&contact_pose, 1.0, witness.point);
                        assert!(oracle.evaluate(p).is_some_and(|s| s.depth > 0.0), "{text}");
                    }
                    MotionVerdict::Inside(_) => {
                        inside += 1;
                        assert_eq!(sampled, 0.0, "{text}");
                    }
                    MotionVerdict::Undecided(_) => undecided += 1,
                    MotionVerdict::SurfaceOnly | MotionVerdict::Near(..) => panic!("{text}"),
                }
                if k % 3 == 0 {
                    let surfaces = (0..tool.info().surfaces.len()).map(SurfaceId);
                    let max_bound = surfaces.map(|surface| {
                        let depth = certifier.motion_depth(surface, &motion, 0.0, TOLERANCE);
                        match depth.expect("a surface") {
                            MotionDepth::Deeper { max_depth, .. } => max_depth,
                            MotionDepth::Within | MotionDepth::Inside => TOLERANCE,
                            MotionDepth::Undecided(_) => f64::INFINITY,
                        }
                    });
                    let max_bound = max_bound.fold(0.0, f64::max);
                    assert!(sampled <= max_bound + 1e-9, "{text}: {max_bound}");
                    bounded += usize::from(max_bound.is_finite());
                }
            }
        }
    }
    let all = clear + touching + undecided + inside;
    assert!(
        8 * clear > all && 8 * touching > all && 16 * undecided < all && 5 * bounded > all,
        "{clear} {touching} {inside} {undecided} {bounded}"
    );
}
