//! Certified depths compared with closed forms.

use super::{plate, pose, soup, tool};
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;
use touchoff::certify::{Certifier, PoseVerdict, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Pose, Unit, scenes};

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Asserts that the interval contains a depth and is not too wide.
fn holds(mesh: &Mesh, name: &str, pose: &Pose, depth: f64) {
    let bvh = TriangleBvh::new(mesh);
    let mut certifier = Certifier::new(&bvh, tool(name)).expect("a profile");
    let [least, most] = mesh.bounds();
    let size = 100.0 + least.coords.amax().max(most.coords.amax());
    let rounding = 1e3 * f64::EPSILON * size;
    for tolerance in [0.0, 1e-9, 1e-6, 1e-3, 1.0] {
        let Interval { low, high } = certifier.deepest(pose, tolerance).depth;
        let text = format!("{name}: {depth:e} in {low:e} to {high:e}, tolerance {tolerance:e}");
        assert!(low - rounding <= depth && depth <= high + rounding, "{text}");
        assert!(high - low <= tolerance + rounding, "{text}");
    }
}

#[test]
fn a_ball_in_a_plane_is_as_deep_as_it_was_pressed() {
    for depth in [1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.999] {
        for [x, y] in [[0.0, 0.0], [0.3, 0.1], [-7.0, 11.0]] {
            holds(&plate(), "D2Ball", &pose([x, y, -depth], UP), depth);
        }
        // Tilted by 30 degrees, the ball touches elsewhere with the same depth.
        let (axis, tilt) = (Vector3::new(0.5, 0.0, 0.75f64.sqrt()), 1.0 - depth);
        let tip = Point3::new(0.3, 0.1, tilt) - axis;
        holds(&plate(), "D2Ball", &Pose::from_axis(tip, axis).expect("an axis"), depth);
    }
}

#[test]
fn a_flat_end_that_is_flush_is_not_deep() {
    let bvh = TriangleBvh::new(&plate());
    for name in ["Flat", "BullNose", "TSlot", "Dovetail"] {
        let flush = pose([0.0, 0.0, 0.0], UP);
        holds(&plate(), name, &flush, 0.0);
        let mut certifier = Certifier::new(&bvh, tool(name)).expect("a profile");
        let clear = certifier.check_pose(&flush);
        assert!(matches!(clear, PoseVerdict::Undecided(high) if high < 1e-10), "{name}: {clear:?}");
    }
}

#[test]
fn a_side_that_is_tangent_is_not_deep() {
    // BullNose is a cylinder of 6 mm radius from z = 2 to 14.
    for depth in [0.0, 1e-9, 1e-3, 0.5] {
        let beside = pose([26.0 - depth, 0.0, -12.0], UP);
        holds(&plate(), "BullNose", &beside, depth);
    }
}

#[test]
fn a_ball_in_the_bore_is_as_deep_as_the_facets_say() {
    let tube = scenes::tube();
    let turn = (PI / 1024.0).cos();
    // A point 2.5 mm from the axis is half a millimetre from the bore's wall, up to the flatness of the facets.
    holds(&tube, "D2Ball", &pose([2.5, 0.0, 5.0], UP), 1.0 - 0.5 * turn);
    holds(&tube, "D2Ball", &pose([0.0, 0.0, 5.0], UP), 0.0);
}

#[test]
fn far_from_the_origin_it_is_known_less_well_and_no_worse() {
    let far = |p: &Point3<f64>| p + Vector3::new(1e6, -1e6, 1e6);
    let near = plate();
    let vertices = near.vertices().iter().map(far).collect();
    let moved = Mesh::new(vertices, near.triangles().to_vec(), Unit::Millimetre).expect("a mesh");
    for depth in [0.0, 1.0 / 1024.0, 0.5] {
        holds(&moved, "D2Ball", &pose([1e6, -1e6, 1e6 - depth], UP), depth);
    }
}

#[test]
fn a_part_in_inches_is_answered_in_inches() {
    let [low, high] = [Point3::new(-2.0, -2.0, -1.0), Point3::new(2.0, 2.0, 0.0)];
    let mesh = shapes::cuboid(low, high, Unit::Inch).expect("a cuboid");
    for depth in [1e-9, 1e-4, 0.01, 0.039] {
        holds(&mesh, "D2Ball", &pose([0.1, 0.2, -depth], UP), depth);
    }
    // A tool in inches and a part in mm: a ball of a quarter inch radius.
    holds(&plate(), "HalfInchBallCat40", &pose([0.1, 0.2, -0.7], UP), 0.7);
}

#[test]
fn clear_tells_inside_from_outside() {
    let [low, high] = [Point3::new(-200.0, -200.0, -200.0), Point3::new(200.0, 200.0, 200.0)];
    let block = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid"));
    let mut in_block = Certifier::new(&block, tool("D2Ball")).expect("a profile");
    let plane = TriangleBvh::new(&shapes::plane(10.0, 4, Unit::Millimetre).expect("a sheet"));
    let mut on_plane = Certifier::new(&plane, tool("D2Ball")).expect("a profile");
    let mut draw = touchoff_tests::oracle::draw::Rng::new(3);
    for _ in 0..200 {
        let axis = draw.direction();
        let middle = [0; 3].map(|_| draw.between(-100.0, 100.0));
        assert!(matches!(in_block.check_pose(&pose(middle, axis)), PoseVerdict::Inside(_)));
        let far = [0, 1, 2].map(|k| middle[k] + 800.0 * axis[k]);
        assert_eq!(in_block.check_pose(&pose(far, axis)), PoseVerdict::Clear);
        let high = [middle[0], middle[1], 50.0 + middle[2].abs()];
        assert_eq!(on_plane.check_pose(&pose(high, axis)), PoseVerdict::SurfaceOnly);
        let touching = pose([draw.between(-9.0, 9.0), 0.5, -1e-6], UP);
        let PoseVerdict::Touching(witness) = on_plane.check_pose(&touching) else {
            panic!("it touches: {touching:?}");
        };
        assert!(witness.point.z.abs() < 1e-12, "{witness:?}");
        assert!((witness.point - touching.tip()).norm() < 2e-3, "{witness:?}");
    }
    // A tip exactly on the surface is neither inside nor outside.
    let on = in_block.check_pose(&pose([0.0, 0.0, 200.0], [0.0, 0.0, -1.0]));
    assert!(matches!(on, PoseVerdict::Undecided(high) if high < 1e-10), "{on:?}");
}

#[test]
fn what_is_inside_an_inverted_part_or_a_hole_is_not_said_to_be_in_material() {
    let [low, high] = [Point3::new(-200.0, -200.0, -200.0), Point3::new(200.0, 200.0, 200.0)];
    let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid");
    let turned = block.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let inverted = Mesh::new(block.vertices().to_vec(), turned, Unit::Millimetre).expect("a mesh");
    let bvh = TriangleBvh::new(&inverted);
    let mut certifier = Certifier::new(&bvh, tool("D2Ball")).expect("a profile");
    assert_eq!(certifier.check_pose(&pose([1.0, 2.0, 3.0], UP)), PoseVerdict::SurfaceOnly);
    let bore = TriangleBvh::new(&scenes::tube());
    let mut certifier = Certifier::new(&bore, tool("D2Ball")).expect("a profile");
    assert_eq!(certifier.check_pose(&pose([0.1, 0.2, 1.0], UP)), PoseVerdict::Clear);
}

#[test]
fn above_the_centre_of_a_ball_on_a_neck_the_corner_is_nearest() {
    // The ball has radius 5 mm about (0, 5); the neck begins at (3, 9). The first triangle is 3.2 mm deep. The ball
    // alone would bound the second by 3 mm and so prune it.
    let at = |z: f64| [[1e-3, 0.0, z], [-1e-3, 1e-3, z], [-1e-3, -1e-3, z]];
    let mesh = soup(&[at(3.2), at(7.0)]);
    let depth = 13f64.sqrt();
    let bvh = TriangleBvh::new(&mesh);
    let mut certifier = Certifier::new(&bvh, tool("Lollipop")).expect("a profile");
    let found = certifier.deepest(&pose([0.0; 3], UP), 1e-9);
    assert!(found.depth.high >= depth - 1e-12, "{depth} in {found:?}");
}
