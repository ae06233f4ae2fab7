//! Item 10: invalid or minimal input. It is refused with an error, or gives sensible results.

use crate::prelude::*;
use std::error::Error;
use std::fmt::Debug;
use touchoff::{Cloud, CloudError, Mesh, PoseError, Probe, Sampling, Unit};
use touchoff_tests::fixtures::part_of;

const MM: Unit = Unit::Millimetre;
const GRID: f64 = 1.0 / (1 << 30) as f64;

#[test]
fn clouds_of_one_place_and_clouds_inside_keep_the_contract() {
    check_tools(10, |subject, rng, checks| {
        let single = PointSet::near_tool(subject, 1, GRID, rng);
        let same = |count: usize| PointSet {
            points: vec![single.points[0]; count],
            normals: vec![single.normals[0]; count],
            weights: vec![0.5; count],
            unit: single.unit,
        };
        let interior = points_inside(subject, rng);
        for points in [&single, &same(2), &same(16), &same(17), &same(300), &interior] {
            for k in 0..extent(1, 8) {
                let pose =
                    if k == 0 { Pose::default() } else { random_pose(Point3::origin(), rng) };
                Scene::new(subject, points.transformed(&pose, GRID), pose).check(checks);
            }
        }
        let count = interior.points.len();
        let contacts = Scene::new(subject, interior, Pose::default()).query().contacts.len();
        let place = || format!("{contacts} of {count}");
        checks.never("point inside without a contact", contacts != count, place);
    });
}

/// Returns points that are all inside, by at least a thousandth of the tool's radius.
fn points_inside(subject: &Subject, rng: &mut Rng) -> PointSet {
    let mut points = PointSet::near_tool(subject, 40, GRID, rng);
    let [radius, height] = subject.oracle.extent();
    let mut attempts = 0;
    for p in &mut points.points {
        *p = loop {
            let [x, y] = [0; 2].map(|_| rng.between(-radius, radius));
            let candidate = [x, y, rng.between(0.0, height)];
            attempts += 1;
            assert!(attempts < 1_000_000, "a tool has an inside");
            if subject.oracle.signed_distance(candidate) < -1e-3 * radius {
                break Point3::from(candidate);
            }
        };
    }
    points
}

/// Input of other kinds is refused by the tests of clouds, meshes and poses.
#[test]
fn input_beyond_all_limits_is_refused() {
    for y in [f64::NAN, f64::NEG_INFINITY, 1e61] {
        refused(cloud(|set| set.points[1].y = y));
    }
    refused(cloud(|set| set.normals[2] *= 1e-320));
    refused(mesh(&[], &[]));
    // Only triangles without area.
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
    refused(mesh(&flat, &[[0, 1, 2], [1, 2, 3]]));
    refused(Pose::from_quaternion(Point3::origin(), [1e-160, 0.0, 0.0, 1e-160]));
    let far = Point3::new(0.0, 0.0, -1.7e308);
    assert_eq!(Pose::from_axis(far, Vector3::z()), Err(PoseError::NotFinite));
}

#[test]
fn extreme_input_is_accepted() {
    accepted(cloud(|set| set.points[1].y = 1e60));
    accepted(cloud(|set| set.weights = vec![0.0; 3]));
    accepted(cloud(|set| set.weights = vec![1e308; 3]));
    accepted(mesh(&TETRAHEDRON, &FACES));
    // A triangle without area, and a sliver.
    accepted(mesh(&TETRAHEDRON, &[&FACES[..], &[[0, 1, 1]]].concat()));
    let mut sliver = TETRAHEDRON;
    sliver[2][1] = 1e-300;
    accepted(mesh(&sliver, &FACES));

    // Sums of weights near overflow stay finite.
    let points = vec![Point3::new(0.0, 0.0, 0.5); 20];
    let part = part_of(points, vec![Vector3::z(); 20], vec![1e300; 20]);
    let tool = touchoff_tools::find("D2Ball").expect("a tool of the library");
    let wrench = Probe::new(&part, tool).wrench(&Pose::default());
    assert!(wrench.colliding == 20, "{wrench:?}");
    assert!(wrench.force.iter().chain(&wrench.torque).all(|c| c.is_finite()), "{wrench:?}");
}

#[track_caller]
fn refused<T, E>(outcome: Result<T, E>) {
    assert!(outcome.err().is_some(), "this input was accepted");
}

#[track_caller]
fn accepted<T, E: Debug>(outcome: Result<T, E>) {
    outcome.expect("this input is sensible");
}

/// Makes a cloud of three points after `change` has made one thing wrong.
fn cloud(change: impl Fn(&mut PointSet)) -> Result<Cloud, CloudError> {
    let mut set = PointSet {
        points: vec![Point3::origin(); 3],
        normals: vec![Vector3::z(); 3],
        weights: vec![1.0; 3],
        unit: MM,
    };
    change(&mut set);
    set.cloud(0..3)
}

const TETRAHEDRON: [[f64; 3]; 4] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

/// Makes a mesh and samples points on it, whose numbers must be sensible.
fn mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<(), Box<dyn Error>> {
    let vertices = vertices.iter().copied().map(Point3::from);
    let mesh = Mesh::new(vertices, triangles.to_vec(), MM)?;
    for sampling in [Sampling::monte_carlo(50), Sampling::new(50)] {
        let cloud = Cloud::sample(&mesh, sampling)?;
        assert!(cloud.points().iter().all(|p| p.iter().all(|c| c.is_finite())), "{cloud:?}");
        assert!(cloud.normals().iter().all(|n| (n.norm() - 1.0).abs() < 1e-12), "{cloud:?}");
        assert!(cloud.weights().iter().all(|w| w.is_finite() && *w >= 0.0), "{cloud:?}");
    }
    Ok(())
}
