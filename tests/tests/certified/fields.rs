//! Tools known only by their depth field and its Lipschitz bound.

use crate::{UP, block, motion, plate, pose, to_tool, tool};
use nalgebra::{Point3, Vector3};
use touchoff::certify::{
    AllowanceError, Certifier, MotionDepth, MotionVerdict, PoseVerdict, TriangleBvh,
};
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Interval, Mesh, Pose, SurfaceId, TriangleId, Unit};
use touchoff_dsl::source::Source;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{self, Oracle};

/// Returns every library tool without a profile, and its oracle.
fn tools_without_profile() -> [(&'static str, Box<dyn Oracle>); 5] {
    ["Fig73", "Cylinder", "UnitSphere", "Block", "LBracket"].map(|name| (name, oracle::of(name)))
}

/// Returns a random pose near a sphere of this radius, in any orientation.
fn random_pose_near(radius: f64, rng: &mut Rng) -> Pose {
    let quaternion = rng.quaternion();
    let tip = Vector3::from(rng.direction()) * radius * rng.between(0.7, 1.3);
    Pose::from_quaternion(Point3::from(tip), quaternion).expect("a quaternion")
}

/// Returns random points of each triangle.
fn random_points(mesh: &Mesh, rng: &mut Rng) -> Vec<Point3<f64>> {
    let ids = (0..mesh.triangles().len() as u32).flat_map(|id| [id; 8]);
    let random_point = |id: u32| {
        let ([a, b, c], [v, w]) = (mesh.triangle(TriangleId(id)), rng.weights());
        a + v * (b - a) + w * (c - a)
    };
    ids.map(random_point).collect()
}

/// Returns the greatest depth over random points of each triangle.
fn max_sampled_depth(
    mesh: &Mesh,
    oracle: &dyn Oracle,
    pose: &Pose,
    length: f64,
    rng: &mut Rng,
) -> f64 {
    let evaluations = random_points(mesh, rng)
        .into_iter()
        .filter_map(|p| oracle.evaluate(to_tool(pose, length, p)));
    evaluations.map(|evaluation| evaluation.depth * length).fold(0.0, f64::max)
}

#[test]
fn sampled_depths_of_fields_are_within_the_interval() {
    const TOLERANCE: f64 = 2e-2;
    let mut rng = Rng::new(5);
    for (name, oracle) in tools_without_profile() {
        let tool = tool(name);
        let length = tool.info().unit.factor_to(Unit::Millimetre);
        let size = length * tool.info().radius().max(tool.info().reach().high);
        let mesh = shapes::sphere(0.5 * size, 3, Unit::Millimetre).expect("a sphere");
        let bvh = TriangleBvh::new(&mesh);
        let mut certifier = Certifier::new(&bvh, tool).expect("a tool that is proved");
        let (mut touching, mut decided) = (0, 0);
        for _ in 0..12 {
            let pose = random_pose_near(0.5 * size, &mut rng);
            let penetration = certifier.deepest(&pose, TOLERANCE * size);
            let Interval { low, high } = penetration.depth;
            let sampled = max_sampled_depth(&mesh, &*oracle, &pose, length, &mut rng);
            assert!(
                sampled <= high + 1e-9,
                "{name} {pose:?}: {sampled} in {:?}",
                penetration.depth
            );
            if let Some(witness) = penetration.witness {
                touching += 1;
                let depth =
                    oracle.evaluate(to_tool(&pose, length, witness.point)).expect("inside").depth;
                assert!(low <= depth * length + 1e-9, "{name} {pose:?}: {depth} in {low}..{high}");
            }
            decided += usize::from(high - low <= 1.01 * TOLERANCE * size);
            let verdict = certifier.check_pose(&pose);
            match verdict {
                PoseVerdict::Touching(_) => assert!(high > 0.0, "{name} {pose:?}"),
                PoseVerdict::Undecided(max_depth) => {
                    assert!(sampled <= max_depth + 1e-9, "{name} {pose:?}");
                }
                _ => assert!(sampled == 0.0, "{name} {pose:?}: {verdict:?} at {sampled}"),
            }
            let Interval { low: min_clearance, high: max_clearance } =
                certifier.clearance(&pose, TOLERANCE * size).distance;
            assert!(
                min_clearance <= max_clearance && (sampled == 0.0 || min_clearance == 0.0),
                "{name} {pose:?}: {min_clearance}..{max_clearance}"
            );
        }
        assert!(touching > 3 && decided > 8, "{name}: {touching} and {decided} of 12");
    }
}

#[test]
fn motions_of_a_field_tool_are_decided() {
    let bvh = TriangleBvh::new(&plate());
    let mut certifier = Certifier::new(&bvh, tool("Fig73")).expect("proved");
    let at = |x: f64, z: f64| pose([x, 0.0, z], UP);
    let motion = |from: [f64; 2], to: [f64; 2]| motion(&at(from[0], from[1]), &at(to[0], to[1]));
    assert_eq!(
        certifier.check_motion(&motion([-8.0, 0.2], [8.0, 0.3]), 1e-3),
        MotionVerdict::Clear
    );
    let dive = certifier.check_motion(&motion([-8.0, 1.0], [8.0, -1.0]), 1e-3);
    assert!(matches!(dive, MotionVerdict::Touching(at, _) if at >= 0.5), "{dive:?}");
    let error = certifier.with_allowance("nose", -0.1).err();
    assert!(matches!(error, Some(AllowanceError::NoMargin { .. })), "{error:?}");
}

/// A surface owns the points of its regions. No sample of a surface is deeper than its certified depth, and a witness
/// is at least as deep as the lower bound.
#[test]
fn samples_of_a_field_are_within_the_certified_depth_of_their_surface() {
    const TOLERANCE: f64 = 1e-6;
    let mut rng = Rng::new(11);
    for (name, oracle) in tools_without_profile() {
        let tool = tool(name);
        let info = tool.info();
        let length = info.unit.factor_to(Unit::Millimetre);
        let size = length * info.radius().max(info.reach().high);
        let mesh = shapes::sphere(0.5 * size, 3, Unit::Millimetre).expect("a sphere");
        let bvh = TriangleBvh::new(&mesh);
        let mut certifier = Certifier::new(&bvh, tool).expect("a tool that is proved");
        let (mut touching, mut wide) = (0, 0);
        for _ in 0..12 {
            let pose = random_pose_near(0.5 * size, &mut rng);
            let tool_depth = certifier.deepest(&pose, TOLERANCE).depth;
            let mut max_depths = [0.0f64; 2];
            for surface in 0..info.surfaces.len() {
                let penetration =
                    certifier.deepest_on(SurfaceId(surface), &pose, TOLERANCE).expect("a surface");
                let text = format!("{name} {surface} at {pose:?}: {penetration:?}");
                let Interval { low, high } = penetration.depth;
                max_depths = [max_depths[0].max(low), max_depths[1].max(high)];
                wide += usize::from(high - low > 1.01 * TOLERANCE);
                let depth_and_owner = |p: Point3<f64>| {
                    let evaluation = oracle.evaluate(to_tool(&pose, length, p))?;
                    Some((evaluation.depth * length, info.regions[evaluation.owner].surface))
                };
                for point in random_points(&mesh, &mut rng) {
                    if let Some((depth, owner)) = depth_and_owner(point)
                        && owner == SurfaceId(surface)
                    {
                        assert!(depth <= high + 1e-9, "{text}: {depth} at {point}");
                    }
                }
                if let Some(witness) = penetration.witness {
                    touching += 1;
                    assert_eq!(witness.surface, SurfaceId(surface), "{text}");
                    let (depth, _) = depth_and_owner(witness.point).expect("inside");
                    assert!(low <= depth + 1e-9, "{text}: {depth}");
                }
            }
            let consistent =
                max_depths[0] <= tool_depth.high + 1e-9 && tool_depth.low <= max_depths[1] + 1e-9;
            assert!(
                consistent,
                "{name} at {pose:?}: {max_depths:?} of each, {tool_depth:?} of all"
            );
        }
        assert!(touching > 5 && wide == 0, "{name}: {touching} touch, {wide} are wide");
    }
}

/// A cylinder beside a wall: its side may cut, its ends may not.
#[test]
fn allowances_apply_to_each_surface_of_a_field() {
    let wall = TriangleBvh::new(&block([1.5, -30.0, 1.0], [40.0, 30.0, 5.0]));
    let at = |y: f64, z: f64| pose([0.0, y, z], UP);
    // The wall is 0.5 mm deep in the side, and its edges are 1 mm from the ends.
    let certifier = || Certifier::new(&wall, tool("Cylinder")).expect("proved");
    let mut side = certifier().with_allowance("side", f64::INFINITY).expect("a surface");
    assert_eq!(side.check_pose(&at(0.0, 0.0)), PoseVerdict::Clear);
    let slide = motion(&at(-1.0, 0.0), &at(1.0, 0.0));
    assert_eq!(side.check_motion(&slide, 1e-6), MotionVerdict::Clear);
    let motion_depth =
        certifier().motion_depth(SurfaceId(0), &slide, 0.4, 1e-6).expect("a surface");
    let MotionDepth::Deeper { depth: Interval { low, high }, max_depth, .. } = motion_depth else {
        panic!("{motion_depth:?}")
    };
    assert!(low <= 0.5 && 0.5 <= high + 1e-9 && max_depth < 0.52, "{motion_depth:?}");
    assert_eq!(
        certifier().motion_depth(SurfaceId(1), &slide, 0.0, 1e-6).expect("a surface"),
        MotionDepth::Within
    );
    // Raised by 0.8 mm, the wall's lower edge is nearer to the bottom.
    let PoseVerdict::Touching(witness) = side.check_pose(&at(0.0, 0.8)) else {
        panic!("it touches")
    };
    assert_eq!(witness.surface, SurfaceId(1));
    let rise = motion(&at(0.0, 0.0), &at(0.0, 0.8));
    assert!(matches!(side.check_motion(&rise, 1e-6), MotionVerdict::Touching(at, _) if at > 0.6));
}

#[test]
fn every_tool_of_the_library_is_certified() {
    let bvh = TriangleBvh::new(&plate());
    for tool in touchoff_tools::TOOLS {
        assert!(Certifier::new(&bvh, *tool).is_ok(), "{}", tool.info().name);
    }
}

#[test]
fn rejects_a_tool_whose_depth_jumps() {
    let text = "tool Jump { units mm;
        region low as body cutting where d <= 2, 0 <= z, z <= 1 { depth: min(z, 2 - d); }
        region high as body cutting where d <= 2, 1 <= z, z <= 3 { depth: min(3 - z, 2 - d); }
        niceness cutting: 1; }";
    let tool = Interpreted::parse(&Source::new("jump.tool", text)).expect("a tool");
    let bvh = TriangleBvh::new(&plate());
    let error = Certifier::new(&bvh, &tool).expect_err("a refusal").to_string();
    assert!(error.contains("Jump") && error.contains("profile"), "{error}");
}
