//! Clearance of a tool, checked against known geometry and against the points of a fine raster.

use crate::{block, plate, pose, tool};
use nalgebra::{Point3, Vector3};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Pose, TriangleId, Unit};
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};

/// Number of divisions of the triangles' sides.
const DIVISIONS: u32 = 20;

#[test]
fn clearance_of_a_ball_above_a_plate_is_its_height() {
    let bvh = TriangleBvh::new(&plate());
    let mut certifier = Certifier::new(&bvh, tool("D2Ball")).expect("a profile");
    for gap in [1e-9, 1e-6, 1e-3, 0.5, 20.0, 1e4] {
        let Interval { low, high } =
            certifier.clearance(&pose([0.3, 0.1, gap], [0.0, 0.0, 1.0]), 1e-9).distance;
        assert!(low <= gap && gap <= high, "{gap}: {low} to {high}");
        assert!(high - low < 2e-9 + 1e-11 * gap, "{gap}: {low} to {high}");
    }
    let touching = certifier.clearance(&pose([0.3, 0.1, -0.5], [0.0, 0.0, 1.0]), 1e-9);
    assert_eq!(touching.distance, Interval::new(0.0, 0.0));
    assert!(touching.witness.is_some());
}

#[test]
fn clearance_in_material_is_the_distance_to_the_surface() {
    let bvh = TriangleBvh::new(&block([-90.0; 3], [90.0; 3]));
    let mut certifier = Certifier::new(&bvh, tool("D2Ball")).expect("a profile");
    let Interval { low, high } =
        certifier.clearance(&pose([0.0, 0.0, -85.0], [0.0, 0.0, 1.0]), 1e-9).distance;
    assert!(low <= 5.0 && 5.0 <= high && high - low < 2e-9, "{low} to {high}");
}

/// Returns the distance of a raster of a part's points, which is at least that of the part, and a bound on the excess.
fn raster_distance(mesh: &Mesh, oracle: &Nearest, pose: &Pose) -> [f64; 2] {
    let to_tool = pose.rotation().transpose();
    let (mut min_distance, mut spacing) = (f64::INFINITY, 0f64);
    for id in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let (u, v) = ((b - a) / f64::from(DIVISIONS), (c - a) / f64::from(DIVISIONS));
        spacing = spacing.max(u.norm()).max(v.norm()).max((v - u).norm());
        for i in 0..=DIVISIONS {
            for j in 0..=DIVISIONS - i {
                let p = to_tool * (a + u * f64::from(i) + v * f64::from(j) - pose.tip());
                min_distance = min_distance.min(oracle.signed_distance([p.x, p.y, p.z]));
            }
        }
    }
    [min_distance, spacing]
}

#[test]
fn raster_points_are_within_the_certified_clearance() {
    let sphere = shapes::sphere(8.0, 2, Unit::Millimetre).expect("a sphere");
    let tube = shapes::tube(3.0, 5.0, 13.0, 24, 3, Unit::Millimetre).expect("a tube");
    let mut rng = Rng::new(7);
    for mesh in [&sphere, &tube] {
        let bvh = TriangleBvh::new(mesh);
        for name in ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"] {
            let oracle = Nearest::of(name);
            let mut certifier = Certifier::new(&bvh, tool(name)).expect("a profile");
            let mut count = 0;
            while count < 8 {
                let axis = Vector3::from_fn(|_, _| rng.between(-1.0, 1.0)).normalize();
                let tip = Point3::from(Vector3::from_fn(|_, _| rng.between(-25.0, 25.0)));
                let Ok(pose) = Pose::from_axis(tip, axis) else { continue };
                let [nearest, spacing] = raster_distance(mesh, &oracle, &pose);
                let Interval { low, high } = certifier.clearance(&pose, 1e-6).distance;
                let text = format!("{name} at {tip}, {axis}: {nearest} by points, {low} to {high}");
                if nearest <= 0.0 {
                    assert_eq!(low, 0.0, "{text}");
                    continue;
                }
                count += 1;
                assert!(low <= nearest + 1e-9, "{text}");
                // Every point of the mesh is within one raster side of a raster point.
                assert!(nearest - spacing <= high, "{text}");
                assert!(high - low < 2e-6, "{text}");
            }
        }
    }
}
