//! Degenerate parts, tolerances and budgets.

use crate::motions::bumpy;
use crate::pair::{Part, generated_parts};
use crate::prelude::*;
use touchoff_tests::evaluations::levels;

fn depth(mesh: &Mesh, name: &str, pose: &Pose, tolerance: f64) -> Interval {
    certifier(mesh, name).deepest(pose, tolerance).depth
}

#[test]
fn invalid_tolerances_are_treated_as_rounding() {
    for tolerance in [0.0, -0.0, -1.0, f64::NAN, f64::NEG_INFINITY, 5e-324] {
        let found = depth(&plate(), "D2Ball", &pose([0.3, 0.1, -0.5], UP), tolerance);
        assert_contains(found, 0.5, 1e-11, tolerance);
    }
    let found = depth(&plate(), "D2Ball", &pose([0.3, 0.1, -0.5], UP), f64::INFINITY);
    assert!(0.0 < found.low && found.contains(0.5), "{found}");
}

#[test]
fn slivers_and_degenerate_triangles_are_as_deep_as_their_points() {
    // Half a square millimetre far from the tool, so that the mesh has an area.
    let far = [[50.0, 50.0, 0.0], [51.0, 50.0, 0.0], [50.0, 51.0, 0.0]];
    for width in [0.0, 5e-324, 1e-300, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3] {
        let sliver = [[-10.0, 0.0, -0.5], [10.0, 0.0, -0.5], [0.0, width, -0.5]];
        let mesh = soup(&[sliver, far]);
        // The line lies half a millimetre deep in the ball and passes through the tool's axis.
        let found = depth(&mesh, "D2Ball", &pose([0.0, 0.0, -1.0], UP), 1e-9);
        assert_contains(found, 0.5, 1e-6, width);
    }
    let point = [[0.0, 0.0, -0.5]; 3];
    let found = depth(&soup(&[point, far]), "D2Ball", &pose([0.0, 0.0, -1.0], UP), 0.0);
    assert_contains(found, 0.5, 1e-11, point);
}

#[test]
fn duplicate_and_inverted_triangles_do_not_change_depth() {
    let once = plate();
    let mut twice = once.triangles().to_vec();
    twice.extend(once.triangles().iter().map(|[a, b, c]| [*c, *b, *a]));
    twice.extend(once.triangles());
    let twice = Mesh::new(once.vertices().to_vec(), twice, Unit::Millimetre).expect("a mesh");
    let oracle = Nearest::of("Fig73Exact");
    let brute = BruteForce::new(&once, &oracle, 1.0);
    let mut rng = Rng::new(4);
    for _ in 0..200 {
        let pose = brute.random_pose(&mut rng);
        let [a, b] = [&once, &twice].map(|mesh| depth(mesh, "Fig73Exact", &pose, 1e-9));
        assert!(a.low <= b.high && b.low <= a.high, "{a:?} {b:?} {pose:?}");
        assert!((a.low - b.low).abs() <= 2e-9, "{a:?} {b:?} {pose:?}");
    }
}

#[test]
fn an_exhausted_budget_leaves_a_valid_interval() {
    for Part { name, mesh, bvh, .. } in generated_parts() {
        let oracle = Nearest::of("Fig73Exact");
        let brute = BruteForce::new(&mesh, &oracle, 1.0);
        let certifier = || Certifier::new(&bvh, tool("Fig73Exact")).expect("a profile");
        let mut exact = certifier();
        let mut rng = Rng::new(5);
        let mut wide_count = 0;
        for _ in 0..40 {
            let pose = brute.random_pose(&mut rng);
            let truth = exact.deepest(&pose, 0.0).depth;
            let clear = exact.check_pose(&pose);
            for budget in [0, 1, 2, 3, 10, 30, 100, 1000] {
                let mut limited = certifier().with_budget(budget);
                let Interval { low, high } = limited.deepest(&pose, 0.0).depth;
                let text = format!("{name}, {budget}: {truth:?} in {low} to {high} at {pose:?}");
                assert!(low <= truth.high && truth.low <= high, "{text}");
                wide_count += usize::from(high - low > 1e-6);
                let verdict = limited.check_pose(&pose);
                let same = std::mem::discriminant(&verdict) == std::mem::discriminant(&clear);
                let is_undecided = matches!(verdict, PoseVerdict::Undecided(_));
                assert!(same || is_undecided, "{text}: {verdict:?}");
            }
        }
        assert!(wide_count > 0, "no budget was too small for {name}");
    }
}

/// The tree of one triangle has a root, a leaf and the triangle: a budget of three examines all of them.
#[test]
fn a_budget_counts_nodes_and_triangles() {
    let single = soup(&[[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]]);
    let deep = pose([0.0, 0.0, -0.5], UP);
    for (budget, is_decided) in [(0, false), (1, false), (2, false), (3, true), (4, true)] {
        let verdict = certifier(&single, "D2Ball").with_budget(budget).check_pose(&deep);
        let is_touching = matches!(verdict, PoseVerdict::Touching(_));
        assert_eq!(is_touching, is_decided, "{budget}: {verdict:?}");
        assert!(is_touching || matches!(verdict, PoseVerdict::Undecided(_)), "{verdict:?}");
    }
}

#[test]
fn every_simd_level_gives_a_valid_interval() {
    let levels = levels();
    for Part { name, mesh, bvh, .. } in generated_parts() {
        for tool_name in ["Fig73Exact", "BallEr16"] {
            let oracle = Nearest::of(tool_name);
            let brute = BruteForce::new(&mesh, &oracle, 1.0);
            let certifier = Certifier::new(&bvh, tool(tool_name)).expect("a profile");
            let at_level = |(_, level): &(_, Level)| certifier.clone().with_level(*level);
            let mut certifiers: Vec<_> = levels.iter().map(at_level).collect();
            let mut rng = Rng::new(6);
            for _ in 0..20 {
                let pose = brute.random_pose(&mut rng);
                let penetrations: Vec<_> =
                    certifiers.iter_mut().map(|c| c.deepest(&pose, 1e-6)).collect();
                let depths = || penetrations.iter().map(|penetration| penetration.depth);
                let highest_low = depths().map(|depth| depth.low).fold(0.0, f64::max);
                let is_right = |depth: Interval| depth.width() < 2e-6 && highest_low <= depth.high;
                let text = || format!("{tool_name} in {name}, {pose:?}: {penetrations:?}");
                assert!(depths().all(is_right), "{}", text());
            }
        }
    }
}

#[test]
fn a_face_pressed_slightly_into_a_part_is_not_clear() {
    let mesh = touchoff::mesh::shapes::sphere(8.0, 4, Unit::Millimetre).expect("a sphere");
    let mut certifier = certifier(&mesh, "BullNose");
    let mut missed = Vec::new();
    for id in 0..mesh.triangles().len() as u32 {
        let normal = mesh.normal(TriangleId(id)).expect("it has an area");
        let [a, b, c] = mesh.triangle(TriangleId(id)).map(|corner| corner.coords);
        let centroid = Point3::from((a + b + c) / 3.0);
        let pose = Pose::from_axis(centroid - 1e-8 * normal, normal).expect("an axis");
        let penetration = certifier.deepest(&pose, 1e-9);
        let verdict = certifier.check_pose(&pose);
        if penetration.depth.high < 0.99e-8 || !matches!(verdict, PoseVerdict::Touching(_)) {
            missed.push((pose, penetration, verdict));
        }
    }
    assert!(missed.is_empty(), "{} missed, the first: {:?}", missed.len(), missed[0]);
}

#[test]
fn a_sheet_that_ends_above_a_bull_nose_is_as_deep_as_its_deepest_triangle() {
    let mesh = bumpy(20.0, 32);
    let above = pose([12.5, -19.173505112635194, -0.5], [0.0, 0.0, -1.0]);
    let Interval { high, .. } = depth(&mesh, "BullNose", &above, 1e-6);
    let oracle = Nearest::of("BullNose");
    let mut rng = Rng::new(1);
    let mut deeper = Vec::new();
    for (id, corners) in triangles(&mesh).enumerate() {
        let corners = corners.map(Into::into);
        let single = soup(&[corners]);
        let brute = BruteForce::new(&single, &oracle, 1.0);
        let sampled_depth = brute.deepest(&brute.tool_frame(&above), &mut rng);
        if sampled_depth > high + 1e-9 {
            deeper.push((id, corners, sampled_depth, depth(&single, "BullNose", &above, 1e-6)));
        }
    }
    assert!(deeper.is_empty(), "{high}, but {deeper:?}");
}

#[test]
fn coordinates_beyond_f32_give_valid_intervals() {
    // Rounding is about ten times the tool's size, so the interval is wide; it must still be valid.
    for size in [1e14, 1e20, 1e30] {
        let mesh = soup(&[
            [[-size, -size, 0.0], [size, -size, 0.0], [0.0, size, 0.0]],
            [[0.0, 0.0, 5.0], [size, 1.0, 5.0], [size, 2.0, 5.0]],
        ]);
        let found = depth(&mesh, "D2Ball", &pose([0.0, 0.0, -0.5], UP), 1e-6);
        assert_contains(found, 0.5, f64::INFINITY, size);
        let far = pose([0.0, 0.0, size], UP);
        let found = certifier(&plate(), "D2Ball").clearance(&far, 1e-6).distance;
        assert_contains(found, size, f64::INFINITY, "far away");
    }
}

/// A cone over a ridge along very long motions, whose positions are rounded by about as much as the tolerance: the depth at
/// any time is known, and falls on both sides of the ridge in proportion to the distance.
#[test]
fn depths_along_very_long_motions_contain_the_exact_depth() {
    let cone = drawn("0 0; cone 10 10; shank 10 40, 0 40", "cone");
    let ends = [-5.0, 5.0].map(|y| [[-5.0, y, -9.0], [5.0, y, -9.0], [0.0, y, 0.0]]);
    let triangles =
        [[0, 1, 2], [5, 4, 3], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
    let corners: Vec<_> = ends.concat().into_iter().map(Point3::from).collect();
    let ridge = Mesh::new(corners, triangles, Unit::Millimetre).expect("a mesh");
    let mut certifier = certifier_of(&ridge, &cone);
    let mut rng = Rng::new(61);
    for _ in 0..60 {
        // Integers, so that their sum is exact, and with it the position at any time but for one rounding.
        let [from, to] = [0, 1].map(|_| rng.between(1e6, 2e6).round());
        let below = rng.between(0.2, 0.8);
        let ends = [-from, to].map(|x| pose([x, 0.3, -below], UP));
        let motion = motion(&ends[0], &ends[1]);
        let (at, depth, ..) = deeper(certifier.motion_depth(SurfaceId(0), &motion, 0.0, 1e-9));
        let beside = at.mul_add(from + to, -from).abs();
        let exact = (below - beside) * std::f64::consts::FRAC_1_SQRT_2;
        assert!(depth.low <= exact && exact <= depth.high, "{exact} and {depth:?}");
    }
}
