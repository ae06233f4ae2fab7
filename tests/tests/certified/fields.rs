//! Tools known only by their depth field and its Lipschitz bound.

use crate::allowances::sampled::SurfaceAllowances;
use crate::pair::{IN_CONTACT, TOUCHING, WIDER};
use crate::prelude::*;
use touchoff::certify::AllowanceError;
use touchoff_tests::oracle;

/// The library's tools without a profile.
const TOOLS: [&str; 5] = ["Fig73", "Cylinder", "UnitSphere", "Block", "LBracket"];

/// Tools in any orientation at spheres half as large as they are, of which they may touch the surface. No sample is deeper
/// than the certified depth, nor one of a surface deeper than that of the surface.
#[test]
fn samples_of_fields_are_within_the_certified_depths() {
    let mut rng = Rng::new(5);
    for name in TOOLS {
        let (tool, oracle) = (tool(name), oracle::of(name));
        let length = tool.info().unit.factor_to(Unit::Millimetre);
        let size = length * tool.info().radius().max(tool.info().reach().high);
        let mesh = shapes::sphere(0.5 * size, 3, Unit::Millimetre).expect("a sphere");
        let bvh = TriangleBvh::new(&mesh);
        let brute = BruteForce::of_field(&mesh, &*oracle, length);
        let mut field =
            SurfaceAllowances { rounding: 1e-9, ..SurfaceAllowances::new(tool, &bvh, brute) };
        let mut certifier = field.certifier();
        let (coarse, mut decided, mut tally) = (2e-2 * size, 0, Tally::default());
        for _ in 0..24 {
            let tip = Vector3::from(rng.direction()) * 0.5 * size * rng.between(0.7, 1.3);
            let pose = Pose::from_quaternion(tip.into(), rng.quaternion()).expect("a quaternion");
            field.check_depths(&mut certifier, &pose, 1e-6, &mut tally, &mut rng);
            field.check_pose(&pose, &mut tally, &mut rng);
            let sampled = field.brute.deepest(&field.brute.tool_frame(&pose), &mut rng);
            let depth = certifier.deepest(&pose, coarse).depth;
            let clearance = certifier.clearance(&pose, coarse).distance;
            let text = format!("{name} {pose:?}: {sampled} in {depth}, {clearance} away");
            assert!(sampled <= depth.high + 1e-9, "{text}");
            assert!(clearance.low <= clearance.high, "{text}");
            assert!(sampled <= 0.0 || clearance.low == 0.0, "{text}");
            decided += usize::from(depth.width() <= 1.01 * coarse);
        }
        assert!(decided > 16 && tally.count(TOUCHING) > 6, "{name}: {decided} of 24, {tally}");
        assert!(tally.count(IN_CONTACT) > 10 && tally.count(WIDER) == 0, "{name}: {tally}");
    }
}

#[test]
fn motions_of_a_field_tool_are_decided() {
    let mut certifier = certifier(&plate(), "Fig73");
    let at = |x: f64, z: f64| pose([x, 0.0, z], UP);
    let motion = |from: [f64; 2], to: [f64; 2]| motion(&at(from[0], from[1]), &at(to[0], to[1]));
    let pass = certifier.check_motion(&motion([-8.0, 0.2], [8.0, 0.3]), 1e-3);
    assert_eq!(pass, MotionVerdict::Clear);
    let (at, _) = touching(certifier.check_motion(&motion([-8.0, 1.0], [8.0, -1.0]), 1e-3));
    assert!(at >= 0.5, "{at}");
    let error = certifier.with_allowance("nose", -0.1).err();
    assert!(matches!(error, Some(AllowanceError::NoMargin { .. })), "{error:?}");
}

/// A cylinder beside a wall: its side may cut, its ends may not.
#[test]
fn allowances_apply_to_each_surface_of_a_field() {
    let wall = block([1.5, -30.0, 1.0], [40.0, 30.0, 5.0]);
    let at = |y: f64, z: f64| pose([0.0, y, z], UP);
    // The wall is 0.5 mm deep in the side, and its edges are 1 mm from the ends.
    let certifier = || certifier(&wall, "Cylinder");
    let mut side = certifier().with_allowance("side", f64::INFINITY).expect("a surface");
    assert_eq!(side.check_pose(&at(0.0, 0.0)), PoseVerdict::Clear);
    let slide = motion(&at(-1.0, 0.0), &at(1.0, 0.0));
    assert_eq!(side.check_motion(&slide, 1e-6), MotionVerdict::Clear);
    let (_, depth, max_depth, _) =
        deeper(certifier().motion_depth(SurfaceId(0), &slide, 0.4, 1e-6));
    assert!(depth.low <= 0.5 && 0.5 <= depth.high + 1e-9 && max_depth < 0.52, "{depth}");
    let bottom = certifier().motion_depth(SurfaceId(1), &slide, 0.0, 1e-6);
    assert_eq!(bottom, Ok(MotionDepth::Within));
    // Raised by 0.8 mm, the wall's lower edge is nearer to the bottom.
    let PoseVerdict::Touching(witness) = side.check_pose(&at(0.0, 0.8)) else {
        panic!("it touches")
    };
    assert_eq!(witness.surface, SurfaceId(1));
    let rise = motion(&at(0.0, 0.0), &at(0.0, 0.8));
    assert!(touching(side.check_motion(&rise, 1e-6)).0 > 0.6);
}

#[test]
fn rejects_a_tool_whose_depth_has_no_bound_of_its_slope() {
    let text = "tool Steep { units mm; tip z = -2; curve ball = 4 - d^2 - z^2;
        region ball as body cutting where 0 <= ball { depth: sqrt(ball); } niceness cutting: 1; }";
    let tool: Interpreted = text.parse().expect("a tool");
    let bvh = TriangleBvh::new(&plate());
    let error = Certifier::new(&bvh, &tool).expect_err("a refusal").to_string();
    assert!(error.contains("Steep") && error.contains("profile"), "{error}");
}

/// A cube of 2 mm in the notch of the bracket. Its distance from the bracket's boxes is known by hand.
#[test]
fn a_part_in_a_notch_is_at_its_distance() {
    for (low, high, distance) in [
        ([8.0, -1.0, 14.0], [10.0, 1.0, 16.0], 8.0),
        ([2.0, -1.0, 7.0], [4.0, 1.0, 9.0], 1.0),
        ([14.0, -1.0, 18.0], [16.0, 1.0, 20.0], 12.0),
    ] {
        let mut certifier = certifier(&block(low, high), "LBracket");
        let pose = Pose::from_quaternion(Point3::origin(), [0.0, 0.0, 0.0, 1.0]);
        let pose = pose.expect("a quaternion");
        let clearance = certifier.clearance(&pose, 1e-3).distance;
        assert!(clearance.contains(distance) && clearance.low > 0.4 * distance, "{clearance}");
        let signed = certifier.signed_distance(&pose, 1e-3);
        assert!(signed.contains(distance) && signed.low > 0.0, "{signed}");
        assert_eq!(certifier.check_pose(&pose), PoseVerdict::Clear, "{low:?}");
        assert!(certifier.deepest(&pose, 1e-3).depth.high < 1e-9, "{low:?}");
    }
}

/// The edge of a block beside a ball that is written as a region.
#[test]
fn the_distance_of_an_edge_from_a_region_is_not_below_its_interval() {
    let text = "tool Sphere { units mm; tip z = -5; curve sphere = hypot(d, z) - 5;
        region sphere as ball cutting where sphere <= 0 { depth: -sphere; direction: away from (0, 0); }
        niceness cutting: 1; }";
    let tool: Interpreted = text.parse().expect("a tool");
    let mut certifier = certifier_of(&block([0.0, -20.0, -20.0], [40.0, 20.0, 0.0]), &tool);
    let mut rng = Rng::new(1);
    for gap in [1e-3, 0.05, 0.2, 1.0] {
        for _ in 0..8 {
            let angle = rng.between(1.65, 3.1);
            let centre = Vector3::new(angle.cos(), 0.0, angle.sin()) * (5.0 + gap);
            let axis = Vector3::from(rng.direction());
            let pose = pose((centre - 5.0 * axis).into(), axis.into());
            let Interval { low, high } = certifier.clearance(&pose, 1e-4).distance;
            let is_right = low <= gap + 1e-9 && gap <= high && low > 0.1 * gap;
            assert!(is_right, "{gap}: {low} to {high}");
            assert_eq!(certifier.check_pose(&pose), PoseVerdict::Clear, "{gap}");
        }
    }
}

/// Two balls that do not touch.
const TWIN: &str = "tool Twin { units mm; tip z = 0;
    curve a = hypot(d, z - 1) - 1; curve b = hypot(d, z - 11) - 2;
    region low as low cutting where a <= 0 { depth: -a; }
    region high as high where b <= 0 { depth: -b; } niceness cutting: 1; }";

/// Two balls of one tool: each that is inside the part is found.
#[test]
fn every_piece_of_a_tool_of_several_pieces_is_located() {
    let one_region = "tool Twin { units mm; tip z = 0; curve a = 3 - hypot(d, abs(z - 10) - 7);
        region balls as balls cutting where a >= 0 { depth: a; } niceness cutting: 1; }";
    for (text, balls) in
        [(TWIN, [[0.0, 2.0], [9.0, 13.0]]), (one_region, [[0.0, 6.0], [14.0, 20.0]])]
    {
        let tool: Interpreted = text.parse().expect("a tool");
        for (k, [low, high]) in balls.into_iter().enumerate() {
            let part = block([-20.0, -20.0, low - 2.0], [20.0, 20.0, high + 2.0]);
            let mut certifier = certifier_of(&part, &tool);
            let at = pose([0.0; 3], UP);
            assert!(matches!(certifier.check_pose(&at), PoseVerdict::Inside(_)), "{k} of {text}");
            let path = motion(&at, &pose([0.1, 0.0, 0.0], UP));
            let verdict = certifier.check_motion(&path, 1e-3);
            assert!(matches!(verdict, MotionVerdict::Inside(_)), "{k} of {text}: {verdict:?}");
            assert_eq!(certifier.check_pose(&pose([60.0, 0.0, 0.0], UP)), PoseVerdict::Clear);
        }
    }
}

/// A depth of three times the distance, in the middle of a plate: 9 mm at 3 mm from the side.
#[test]
fn the_bound_of_a_motion_is_not_below_a_steep_depth() {
    let text = "tool Steep { units mm; curve side = 3 - d; curve end = 30 - z;
        region side as flute where 0 <= side <= min(z, end) { depth: 3*side; }
        region low as flute where 0 <= z <= min(side, end) { depth: 3*z; }
        region end as flute where 0 <= end <= min(side, z) { depth: 3*end; } }";
    let tool: Interpreted = text.parse().expect("a tool");
    let mut certifier = certifier_of(&block([-0.1, -20.0, -5.0], [0.1, 20.0, 40.0]), &tool);
    let path = motion(&pose([-4.5, 0.0, 0.0], UP), &pose([3.5, 0.0, 0.0], UP));
    let (_, _, max_depth, _) = deeper(certifier.motion_depth(SurfaceId(0), &path, 0.0, 1e-3));
    assert!((9.0..9.5).contains(&max_depth), "{max_depth}");
}

/// One ball is in the block, another on its way into it: with whatever budget, no part of the way is called clear.
#[test]
fn a_piece_inside_is_told_where_another_is_undecided() {
    let tool: Interpreted = TWIN.parse().expect("a tool");
    let mut certifier = certifier_of(&block([-20.0, -20.0, -4.0], [20.0, 20.0, 6.0]), &tool);
    let path = motion(&pose([0.0; 3], UP), &pose([0.0, 0.0, -4.0], UP));
    for budget in 0..400 {
        certifier = certifier.with_budget(budget);
        let verdict = certifier.check_motion(&path, 1e-3);
        let is_told = !matches!(verdict, MotionVerdict::Undecided(at) if at > 0.0);
        assert!(is_told, "{budget}: {verdict:?}");
        let depth = certifier.motion_depth(SurfaceId(0), &path, 0.0, 1e-3).expect("a surface");
        let is_told = !matches!(depth, MotionDepth::Undecided(at) if at > 0.0);
        assert!(is_told, "{budget}: {depth:?}");
    }
}
