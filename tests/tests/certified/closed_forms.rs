//! Certified depths compared with closed forms.

use crate::pose_at;
use crate::prelude::*;
use std::f64::consts::PI;
use touchoff::scenes;

fn assert_interval_contains(mesh: &Mesh, name: &str, pose: &Pose, depth: f64) {
    let mut certifier = certifier(mesh, name);
    let [lower_corner, upper_corner] = mesh.bounds();
    let size = 100.0 + lower_corner.coords.amax().max(upper_corner.coords.amax());
    let rounding = 1e3 * f64::EPSILON * size;
    for tolerance in [0.0, 1e-9, 1e-6, 1e-3, 1.0] {
        let Interval { low, high } = certifier.deepest(pose, tolerance).depth;
        let found = Interval::new(low - rounding, high + rounding);
        assert_contains(found, depth, tolerance + 3.0 * rounding, (name, tolerance));
    }
}

#[test]
fn depth_of_a_ball_in_a_plane() {
    for depth in [1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.999] {
        for [x, y] in [[0.0, 0.0], [0.3, 0.1], [-7.0, 11.0]] {
            assert_interval_contains(&plate(), "D2Ball", &pose([x, y, -depth], UP), depth);
        }
        // Tilted by 30 degrees, the ball touches elsewhere with the same depth.
        let (axis, tilt) = (Vector3::new(0.5, 0.0, 0.75f64.sqrt()), 1.0 - depth);
        let tip = Point3::new(0.3, 0.1, tilt) - axis;
        assert_interval_contains(&plate(), "D2Ball", &pose_at(tip, axis), depth);
    }
}

#[test]
fn a_flush_flat_end_has_no_depth() {
    for name in ["Flat", "BullNose", "TSlot", "Dovetail"] {
        let flush = pose([0.0, 0.0, 0.0], UP);
        assert_interval_contains(&plate(), name, &flush, 0.0);
        let clear = certifier(&plate(), name).check_pose(&flush);
        assert!(matches!(clear, PoseVerdict::Undecided(high) if high < 1e-10), "{name}: {clear:?}");
    }
}

#[test]
fn depth_of_a_side_in_a_plane() {
    // BullNose is a cylinder of 6 mm radius from z = 2 to 14.
    for depth in [0.0, 1e-9, 1e-3, 0.5] {
        let side_pose = pose([26.0 - depth, 0.0, -12.0], UP);
        assert_interval_contains(&plate(), "BullNose", &side_pose, depth);
    }
}

#[test]
fn depth_of_a_ball_in_a_faceted_bore() {
    let tube = scenes::tube();
    let flatness = (PI / 1024.0).cos();
    // A point 2.5 mm from the axis is half a millimetre from the bore's wall, up to the flatness of the facets.
    assert_interval_contains(&tube, "D2Ball", &pose([2.5, 0.0, 5.0], UP), 1.0 - 0.5 * flatness);
    assert_interval_contains(&tube, "D2Ball", &pose([0.0, 0.0, 5.0], UP), 0.0);
}

#[test]
fn depth_is_valid_far_from_the_origin() {
    let moved = moved(&plate(), |p| p + Vector3::new(1e6, -1e6, 1e6));
    for depth in [0.0, 1.0 / 1024.0, 0.5] {
        assert_interval_contains(&moved, "D2Ball", &pose([1e6, -1e6, 1e6 - depth], UP), depth);
    }
}

#[test]
fn depth_is_in_the_unit_of_the_part() {
    let [low, high] = [Point3::new(-2.0, -2.0, -1.0), Point3::new(2.0, 2.0, 0.0)];
    let mesh = shapes::cuboid(low, high, Unit::Inch).expect("a cuboid");
    for depth in [1e-9, 1e-4, 0.01, 0.039] {
        assert_interval_contains(&mesh, "D2Ball", &pose([0.1, 0.2, -depth], UP), depth);
    }
    // A tool in inches and a part in mm: a ball of a quarter inch radius.
    assert_interval_contains(&plate(), "HalfInchBallCat40", &pose([0.1, 0.2, -0.7], UP), 0.7);
}

#[test]
fn pose_verdicts_tell_inside_from_outside() {
    let mut in_block = certifier(&block([-200.0; 3], [200.0; 3]), "D2Ball");
    let plane = shapes::plane(10.0, 4, Unit::Millimetre).expect("a sheet");
    let mut on_plane = certifier(&plane, "D2Ball");
    let mut rng = touchoff_tests::oracle::rng::Rng::new(3);
    for _ in 0..200 {
        let axis = rng.direction();
        let inside_tip = [0; 3].map(|_| rng.between(-100.0, 100.0));
        assert!(matches!(in_block.check_pose(&pose(inside_tip, axis)), PoseVerdict::Inside(_)));
        let outside_tip = [0, 1, 2].map(|k| inside_tip[k] + 800.0 * axis[k]);
        assert_eq!(in_block.check_pose(&pose(outside_tip, axis)), PoseVerdict::Clear);
        let above_plane = [inside_tip[0], inside_tip[1], 50.0 + inside_tip[2].abs()];
        assert_eq!(on_plane.check_pose(&pose(above_plane, axis)), PoseVerdict::SurfaceOnly);
        let touching = pose([rng.between(-9.0, 9.0), 0.5, -1e-6], UP);
        let PoseVerdict::Touching(witness) = on_plane.check_pose(&touching) else {
            panic!("it touches: {touching:?}");
        };
        assert!(witness.point.z.abs() < 1e-12, "{witness:?}");
        assert!((witness.point - touching.tip()).norm() < 2e-3, "{witness:?}");
    }
    // A tip exactly on the surface is neither inside nor outside.
    let verdict = in_block.check_pose(&pose([0.0, 0.0, 200.0], [0.0, 0.0, -1.0]));
    assert!(matches!(verdict, PoseVerdict::Undecided(high) if high < 1e-10), "{verdict:?}");
}

#[test]
fn inverted_parts_and_holes_are_not_material() {
    let solid = block([-200.0; 3], [200.0; 3]);
    let turned = solid.triangles().iter().map(|[a, b, c]| [*a, *c, *b]);
    let inverted = Mesh::new(solid.vertices().to_vec(), turned, Unit::Millimetre).expect("a mesh");
    let verdict = certifier(&inverted, "D2Ball").check_pose(&pose([1.0, 2.0, 3.0], UP));
    assert_eq!(verdict, PoseVerdict::SurfaceOnly);
    let verdict = certifier(&scenes::tube(), "D2Ball").check_pose(&pose([0.1, 0.2, 1.0], UP));
    assert_eq!(verdict, PoseVerdict::Clear);
}

#[test]
fn a_neck_corner_limits_depth_above_the_ball_centre() {
    // The ball has radius 5 mm about (0, 5); the neck begins at (3, 9). The first triangle is 3.2 mm deep. The ball
    // alone would bound the second by 3 mm and so prune it.
    let triangle_at = |z: f64| [[1e-3, 0.0, z], [-1e-3, 1e-3, z], [-1e-3, -1e-3, z]];
    let mesh = soup(&[triangle_at(3.2), triangle_at(7.0)]);
    let depth = 13f64.sqrt();
    let penetration = certifier(&mesh, "Lollipop").deepest(&pose([0.0; 3], UP), 1e-9);
    assert!(penetration.depth.high >= depth - 1e-12, "{depth} in {penetration:?}");
}
