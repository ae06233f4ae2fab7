//! Small cases that need one part of the certifier's reasoning in full: without it, the answer is wrong. Expected numbers are
//! worked out by hand.

use crate::prelude::*;
use touchoff::certify::Trajectory;

/// Returns the depth of a part in a tool that stands upright at the origin.
fn depth(tool: &Interpreted, part: &Mesh) -> Interval {
    certifier_of(part, tool).deepest(&pose([0.0; 3], UP), 1e-9).depth
}

/// A cup's cone from (1, 4) to (4, 0); the outside has a corner half way up. Of the part, (3, 1.8) is deepest: 0.8·2 - 0.6·2.2 from
/// the cone.
#[test]
fn a_cone_beside_a_corner_keeps_its_radius() {
    let tool = drawn("0 4; cup 1 4, 4 0; body 6 0, 6 2, 7 3, 7 12, 0 12", "cup");
    let found = depth(&tool, &soup(&[[[3.0, 0.0, 1.8], [2.99, 0.0, 1.8], [2.99, 0.01, 1.8]]]));
    assert!(found.contains(0.28) && found.width() < 1e-8, "{found}");
}

/// A dish whose arc has its centre below the tip, and a round rim: the part meets the circle of the rim's centres at (8, 6, 5),
/// between its edges, which are less than 4.7 deep.
#[test]
fn a_rim_above_a_dish_is_as_deep_as_its_circle() {
    let tool: Interpreted = "tool Rim { units mm; profile { start (0, 4);
        arc to (6, 2) center (0, -6) concave as dish cutting;
        arc to (15, 5) center (10, 5) as low cutting; arc to (6, 8) center (10, 5) as high;
        line to (2, 8), (2, 30), (0, 30) as shank; } niceness cutting: 1; }"
        .parse()
        .expect("a tool");
    let found = depth(&tool, &soup(&[[[8.0, 5.0, 4.5], [8.0, 7.0, 4.6], [8.0, 6.0, 6.0]]]));
    assert!(found.contains(5.0) && found.width() < 1e-8, "{found}");
}

/// Of an arc of 57.5°, only the part from 3.9° to 24.3° has points below it as deep as is allowed: beyond, the top is nearer. At 14°
/// the point 7.8 mm below the arc is 8 mm and more from everything else.
#[test]
fn a_piece_beside_the_middle_of_an_arc_is_found_inside() {
    let tool = drawn("0 0; face 25.6 0.8; nose 39.2 14.4 about 20 20; top 39.2 18, 0 18", "face");
    let all = [("face", f64::INFINITY), ("nose", 7.5), ("top", f64::INFINITY)];
    let certifier = certifier_of(&block([-60.0; 3], [60.0; 3]), &tool);
    let mut certifier = certifier.with_allowances(all).expect("surfaces");
    let verdict = certifier.check_pose(&pose([0.0; 3], UP));
    assert_eq!(verdict, PoseVerdict::Inside(SurfaceId(1)));
}

/// A flat end and a ball that just touch: rounding would decide on the direction from a point to itself.
#[test]
fn the_normal_at_a_contact_without_depth_is_that_of_the_tool() {
    for drawing in
        ["0 0; face 3 0; flute 3 20; top 0 20", "0 0; ball 3 3 about 0 3; top 3 20, 0 20"]
    {
        let tool = drawn(drawing, "");
        let at = pose([1.0, 2.0, 0.0], UP);
        let found = certifier_of(&plate(), &tool).clearance(&at, 1e-9);
        let normal = found.on_tool.expect("a point").normal;
        assert!((normal + Vector3::z()).norm() < 1e-6, "{drawing}: {normal}");
    }
}

/// A quarter turn about the tip moves a point at 10 mm on an arc of 5 π mm.
#[test]
fn the_speed_of_a_turn_is_that_of_its_farthest_point() {
    let [up, aside] = [UP, [1.0, 0.0, 0.0]].map(|axis| pose([1.0, 2.0, 3.0], axis));
    let speed = motion(&up, &aside).max_speed(10.0);
    assert!((speed - 5.0 * std::f64::consts::PI).abs() < 1e-9, "{speed}");
}
