//! Levels of detail within a budget, and parts that change between queries.

use crate::prelude::*;
use std::collections::BTreeSet;
use touchoff::scenes::{ScenePath, tube};
use touchoff::{Cloud, LodProbe, Mesh, Sampling, Wrench};
use touchoff_tests::fixtures::cuboid;
use touchoff_tests::oracle::Nearest;
use touchoff_tools::{Ball, Fig73, Fig73Exact};

const POSES: usize = 2_000;

fn detailed(points: usize) -> Part {
    Part::with_lods(&tube(), Sampling::new(points)).expect("the tube has a surface")
}

/// Returns the probe of a ball end mill with a budget of 90 nodes.
fn graded(part: &Part) -> LodProbe<'_, Ball> {
    LodProbe::new(part, &Ball, 90, Law::Gradient).expect("a budget that does")
}

/// Returns the pose of an upright tool over the tube's wall.
fn over_the_wall(z: f64) -> Pose {
    Pose::from_axis(Point3::new(4.0, 0.0, z), Vector3::z()).expect("a pose")
}

fn evaluation(part: &Part, budget: usize, path: ScenePath) -> Vec<touchoff::LodWrench> {
    let mut graded =
        LodProbe::new(part, &Fig73, budget, Law::Gradient).expect("a budget that does");
    (0..POSES).map(|k| graded.wrench(&path.pose(k, POSES))).collect()
}

#[test]
fn queries_keep_their_node_budget() {
    let part = detailed(100_000);
    let mut levels = BTreeSet::new();
    for path in [ScenePath::Outside, ScenePath::Inside, ScenePath::Hold] {
        for budget in [60, 200, 1_000, 1_000_000] {
            let all = evaluation(&part, budget, path);
            assert!(all.iter().all(|evaluation| evaluation.nodes <= budget), "{budget}");
            levels.extend(all.iter().map(|evaluation| evaluation.level));
            // The same queries, the same answers.
            assert_eq!(all, evaluation(&part, budget, path));
        }
    }
    assert!(levels.len() >= 4, "{levels:?}");
    // With a sufficient budget the finest level answers, as a probe does.
    let mut probe = Probe::new(&part, &Fig73).with_law(Law::Gradient);
    // Each level evaluates as a part of its own would: coarser, with a bound that states by how much.
    let coarse = evaluation(&part, 60, ScenePath::Outside);
    let fine = evaluation(&part, 1_000_000, ScenePath::Outside);
    let mut looser = 0;
    for (k, (coarse, fine)) in coarse.iter().zip(&fine).enumerate() {
        let finer = probe.sampling_error_bound();
        assert_eq!((fine.level, fine.sampling_error_bound), (0, finer));
        assert_eq!(fine.wrench, probe.wrench(&ScenePath::Outside.pose(k, POSES)));
        let bound = coarse.sampling_error_bound.expect("a bound");
        assert!(fine.wrench.depth() <= coarse.wrench.depth() + bound);
        looser += usize::from(bound > 2.0 * finer.expect("a bound"));
    }
    assert!(looser > POSES / 2);
}

/// A budget of as many nodes as a query visits suffices for it; one node less pays for a coarser level only.
#[test]
fn a_budget_is_spent_to_the_last_node() {
    let part = detailed(20_000);
    let needed = LodProbe::new(&part, &Fig73, 0, Law::Thesis).expect_err("no nodes").needed;
    let query = |budget: usize, pose: &Pose| {
        let mut probe = LodProbe::new(&part, &Fig73, budget, Law::Thesis).expect("enough nodes");
        probe.wrench(pose)
    };
    let mut compared = 0;
    for k in 0..200 {
        let pose = ScenePath::Hold.pose(k, 200);
        let whole = query(1_000_000, &pose);
        if whole.nodes <= needed {
            continue;
        }
        compared += 1;
        assert_eq!(query(whole.nodes, &pose), whole);
        let less = query(whole.nodes - 1, &pose);
        assert!(less.level > whole.level && less.nodes < whole.nodes, "{less:?}");
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn rejects_a_budget_that_is_too_small() {
    let part = detailed(2_000);
    let refused = LodProbe::new(&part, &Fig73, 5, Law::Thesis).expect_err("5 nodes are too few");
    assert!(refused.needed > 5 && refused.to_string().contains("a budget of 5 nodes is too small"));
    assert!(LodProbe::new(&part, &Fig73, refused.needed, Law::Thesis).is_ok());
}

#[test]
fn force_is_continuous_where_the_level_changes() {
    // Into the rim, slowly: the deeper, the more nodes.
    let part = detailed(200_000);
    let mut slow = graded(&part);
    let mut before: Option<touchoff::LodWrench> = None;
    let (mut changes, mut jumps) = (0, 0);
    for k in 0..20_000 {
        let pose = over_the_wall(13.4 - 1.0 * f64::from(k) / 20_000.0);
        let evaluation = slow.wrench(&pose);
        if let Some(before) = before {
            let step = (evaluation.wrench.force - before.wrench.force).norm();
            // The step that the level's own force would have made.
            if evaluation.level != before.level {
                changes += 1;
                assert_eq!(evaluation.wrench.force, before.wrench.force);
                let alone = graded(&part).wrench(&pose).wrench;
                jumps += usize::from((alone.force - before.wrench.force).norm() > 1e-4);
            }
            let scale = evaluation.wrench.force.norm().max(0.01);
            assert!(step < 0.02 * scale + 1e-3, "{k}: {step} of {scale}");
        }
        before = Some(evaluation);
    }
    assert!(changes >= 2 && jumps >= 1, "{changes} {jumps}");
}

#[test]
fn a_tool_oscillating_around_its_budget_keeps_its_forces() {
    let part = detailed(200_000);
    // Deep in the wall the budget is too small for the level that a light touch is evaluated at.
    let pose = over_the_wall;
    let mut fresh = graded(&part);
    let [shallow, deep] = [13.1, 12.2].map(|z| fresh.wrench(&pose(z)).level);
    assert!(shallow < deep, "{shallow} {deep}");
    let mut oscillating = graded(&part);
    let mut alone = Probe::new(&part, &Ball).with_law(Law::Gradient);
    let (mut last, mut changes, mut near_count) = (None, 0, 0);
    for k in 0..2_000 {
        let z = if k % 2 == 0 { 13.1 } else { 12.2 };
        let evaluation = oscillating.wrench(&pose(z));
        changes += usize::from(last.is_some_and(|level| level != evaluation.level));
        last = Some(evaluation.level);
        let true_force = alone.wrench(&pose(z)).force;
        let difference = (evaluation.wrench.force - true_force).norm();
        near_count += usize::from(difference < 0.25 * true_force.norm() + 0.1);
    }
    assert!(changes <= 2 * 2_000 / 32 + 2, "{changes}");
    assert!(near_count > 1_000, "{near_count}");
    // Out of the part no force of it is left.
    let away = oscillating.wrench(&pose(20.0)).wrench;
    assert_eq!((away.force, away.torque), (Vector3::zeros(), Vector3::zeros()));
    assert_eq!(oscillating.wrench(&pose(12.2)), graded(&part).wrench(&pose(12.2)));
}

/// Returns points all over a mesh that are outside the tool at all poses.
fn left<'a>(
    mesh: &'a Mesh,
    poses: &'a [Pose],
    rng: &'a mut Rng,
) -> impl Iterator<Item = Point3<f64>> + 'a {
    let seed = (1e9 * rng.between(0.0, 1.0)) as u64;
    let cloud = Cloud::sample(mesh, Sampling::monte_carlo(60_000).with_seed(seed));
    let ball = Nearest::of("Ball");
    cloud.expect("a cloud").points().to_vec().into_iter().filter(move |point| {
        poses.iter().all(|pose| {
            let from = pose.rotation().transpose() * (point - pose.tip());
            ball.signed_distance(from.into()) >= 0.0
        })
    })
}

fn sums(part: &Part, tool: &dyn touchoff::Tool, pose: &Pose) -> Wrench {
    Probe::new(part, tool).wrench(pose)
}

#[test]
fn removed_material_has_no_contacts_and_the_rest_is_covered() {
    let mesh = tube();
    let mut part = detailed(20_000);
    let cover = part.tree().covering_radius().expect("a cover");
    let mut rng = Rng::new(5);
    let poses: Vec<Pose> = (0..12)
        .map(|_| {
            let angle = rng.between(0.0, std::f64::consts::TAU);
            let out = rng.between(3.5, 7.0);
            let tip = Point3::new(out * angle.cos(), out * angle.sin(), rng.between(9.0, 12.5));
            Pose::from_axis(tip, Vector3::z()).expect("a pose")
        })
        .collect();
    let all = part.tree().len();
    let mut taken = 0;
    for pose in &poses {
        taken += part.cut(&Ball, pose);
        // No point is deeper than the sampling error.
        let unseen = Probe::new(&part, &Ball).sampling_error_bound().expect("a bound");
        assert!(sums(&part, &Ball, pose).depth() <= unseen);
        assert_eq!(part.cut(&Ball, pose), 0);
    }
    assert!(taken > 1_000 && part.tree().len() < all);
    assert_eq!(part.tree().covering_radius(), Some(cover));
    let points: Vec<Point3<f64>> =
        (0..all).map(|index| part.tree().point(index)).filter(|point| !point.x.is_nan()).collect();
    assert_eq!(points.len(), part.tree().len());
    let mut looked = 0;
    for remaining in left(&mesh, &poses, &mut rng).take(4_000) {
        let nearest = points.iter().map(|p| (p - remaining).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest <= cover.radius * (1.0 + 1e-6), "{nearest} of {}", cover.radius);
        looked += 1;
    }
    assert!(looked > 3_000);
    // The results are those of a part that never had those points.
    let tree = part.tree();
    let indices: Vec<usize> = (0..all).filter(|index| !tree.point(*index).x.is_nan()).collect();
    let fresh = Cloud::new(
        points,
        indices.iter().map(|index| tree.normal(*index).into()).collect(),
        indices.iter().map(|index| tree.triangle(*index)).collect(),
        indices.iter().map(|index| tree.weight(*index)).collect(),
        part.unit(),
    );
    let fresh = Part::from_cloud(&fresh.expect("a cloud"));
    for k in 0..POSES {
        let pose = ScenePath::Hold.pose(k, POSES);
        let (changed, fresh) = (sums(&part, &Fig73, &pose), sums(&fresh, &Fig73, &pose));
        assert_eq!(changed.colliding, fresh.colliding);
        assert!((changed.force - fresh.force).norm() <= 1e-5 * (1.0 + fresh.force.norm()));
    }
}

#[test]
fn cutting_a_part_inside_a_tool_removes_all_points() {
    let cube = cuboid([0.0; 3], [0.1; 3]);
    let mut part =
        Part::from_cloud(&Cloud::sample(&cube, Sampling::monte_carlo(500)).expect("a cloud"));
    let pose = Pose::from_axis(Point3::new(0.0, 0.0, -3.0), Vector3::z()).expect("a pose");
    assert_eq!((part.cut(&Ball, &pose), part.tree().is_empty()), (500, true));
    let mut probe = Probe::new(&part, &Ball);
    assert!(!probe.detect(&pose) && probe.deepest(&pose).is_none());
    assert_eq!(probe.wrench(&pose).colliding, 0);
}

#[test]
fn a_deformed_part_has_contacts_at_its_new_points() {
    let bend = |k: f64| {
        move |p: Point3<f64>, n: Vector3<f64>| (Point3::new(p.x + k * p.z * p.z, p.y, p.z), n)
    };
    let mut part = detailed(20_000);
    let before = part.tree().covering_radius().expect("a cover");
    part.displace(bend(0.02)).expect("places");
    let farthest = 0.02 * 13.116f64.powi(2);
    let cover = part.tree().covering_radius().expect("a cover");
    let after = cover.radius - before.radius;
    assert!(before.proved && !cover.proved);
    assert!((after - 2.0 * farthest).abs() < 1e-3 * farthest, "{after}");
    let cloud = Cloud::sample(&tube(), Sampling::new(20_000)).expect("a cloud");
    let bent: Vec<Point3<f64>> =
        cloud.points().iter().map(|p| bend(0.02)(*p, Vector3::z()).0).collect();
    let (normals, triangles) = (cloud.normals().to_vec(), cloud.triangles().to_vec());
    let bent = Cloud::new(bent, normals, triangles, cloud.weights().to_vec(), cloud.unit());
    let bent = Part::from_cloud(&bent.expect("a cloud"));
    let mut touched = 0;
    for k in 0..POSES {
        let pose = ScenePath::Hold.pose(k, POSES);
        let (changed, fresh) = (sums(&part, &Fig73Exact, &pose), sums(&bent, &Fig73Exact, &pose));
        touched += usize::from(fresh.colliding > 0);
        assert!(changed.colliding.abs_diff(fresh.colliding) <= 1, "{k}");
        assert!((changed.force - fresh.force).norm() <= 1e-4 * (1.0 + fresh.force.norm()), "{k}");
        assert!((changed.depth() - fresh.depth()).abs() < 1e-5, "{k}");
    }
    assert!(touched > POSES / 4);
    // A part that does not move does not change, not by a bit.
    let still = part.clone();
    part.displace(|p, n| (p, n)).expect("places");
    assert_eq!(part.tree().covering_radius(), still.tree().covering_radius());
    // Coordinates that are not finite are refused before anything moves.
    for wrong in [f64::NAN, f64::INFINITY] {
        assert!(part.displace(|p, n| (Point3::new(p.x + 1.0, p.y, wrong), n)).is_err());
        assert!(part.displace(|p, n| (p, wrong * n)).is_err());
    }
    for k in 0..POSES {
        let pose = ScenePath::Hold.pose(k, POSES);
        assert_eq!(sums(&part, &Fig73, &pose), sums(&still, &Fig73, &pose));
    }
}
