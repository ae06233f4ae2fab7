//! Clearance of a tool, checked against known geometry and against the points of a fine raster.

use super::{plate, pose, tool};
use nalgebra::{Point3, Vector3};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Pose, TriangleId, Unit};
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};

/// Number of divisions of the triangles' sides.
const RASTER: u32 = 20;

#[test]
fn a_ball_above_a_plate_is_as_far_as_it_was_lifted() {
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
fn a_tool_in_material_is_as_far_as_its_surface() {
    let [low, high] = [Point3::new(-90.0, -90.0, -90.0), Point3::new(90.0, 90.0, 90.0)];
    let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid");
    let bvh = TriangleBvh::new(&block);
    let mut certifier = Certifier::new(&bvh, tool("D2Ball")).expect("a profile");
    let Interval { low, high } =
        certifier.clearance(&pose([0.0, 0.0, -85.0], [0.0, 0.0, 1.0]), 1e-9).distance;
    assert!(low <= 5.0 && 5.0 <= high && high - low < 2e-9, "{low} to {high}");
}

/// Returns the distance of a raster of a part's points, which is at least that of the part, and a bound on the excess.
fn raster(mesh: &Mesh, oracle: &Nearest, pose: &Pose) -> [f64; 2] {
    let back = pose.rotation().transpose();
    let (mut least, mut apart) = (f64::INFINITY, 0f64);
    for id in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let (u, v) = ((b - a) / f64::from(RASTER), (c - a) / f64::from(RASTER));
        apart = apart.max(u.norm()).max(v.norm()).max((v - u).norm());
        for i in 0..=RASTER {
            for j in 0..=RASTER - i {
                let p = back * (a + u * f64::from(i) + v * f64::from(j) - pose.tip());
                least = least.min(oracle.signed_distance([p.x, p.y, p.z]));
            }
        }
    }
    [least, apart]
}

#[test]
fn no_point_of_a_part_is_nearer_than_is_said() {
    let sphere = shapes::sphere(8.0, 2, Unit::Millimetre).expect("a sphere");
    let tube = shapes::tube(3.0, 5.0, 13.0, 24, 3, Unit::Millimetre).expect("a tube");
    let mut draw = Rng::new(7);
    for mesh in [&sphere, &tube] {
        let bvh = TriangleBvh::new(mesh);
        for name in ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"] {
            let oracle = Nearest::of(name);
            let mut certifier = Certifier::new(&bvh, tool(name)).expect("a profile");
            let mut seen = 0;
            while seen < 8 {
                let axis = Vector3::from_fn(|_, _| draw.between(-1.0, 1.0)).normalize();
                let tip = Point3::from(Vector3::from_fn(|_, _| draw.between(-25.0, 25.0)));
                let Ok(pose) = Pose::from_axis(tip, axis) else { continue };
                let [nearest, apart] = raster(mesh, &oracle, &pose);
                let Interval { low, high } = certifier.clearance(&pose, 1e-6).distance;
                let text = format!("{name} at {tip}, {axis}: {nearest} by points, {low} to {high}");
                if nearest <= 0.0 {
                    assert_eq!(low, 0.0, "{text}");
                    continue;
                }
                seen += 1;
                assert!(low <= nearest + 1e-9, "{text}");
                // Every point of the mesh is within one raster side of a raster point.
                assert!(nearest - apart <= high, "{text}");
                assert!(high - low < 2e-6, "{text}");
            }
        }
    }
}
