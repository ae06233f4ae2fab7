//! Item 10: minimal input, and weights near overflow. Invalid input is refused by the tests of clouds, meshes and poses.

use crate::prelude::*;
use touchoff::Probe;
use touchoff_tests::fixtures::part_of;

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

#[test]
fn sums_of_weights_near_overflow_stay_finite() {
    let points = vec![Point3::new(0.0, 0.0, 0.5); 20];
    let part = part_of(points, vec![Vector3::z(); 20], vec![1e300; 20]);
    let tool = touchoff_tools::find("D2Ball").expect("a tool of the library");
    let wrench = Probe::new(&part, tool).wrench(&Pose::default());
    assert!(wrench.colliding == 20, "{wrench:?}");
    assert!(wrench.force.iter().chain(&wrench.torque).all(|c| c.is_finite()), "{wrench:?}");
}
