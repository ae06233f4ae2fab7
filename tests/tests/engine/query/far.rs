//! Parts far from the world's origin, tiny and huge: the tree keeps its points relative to the centres of its leaves.

use super::anywhere::all_tools;
use super::compare::{check_tools, tools};
use super::parts;
use crate::prelude::*;

/// Rounds coordinates to multiples of 2^-10, so that sums with 2^40 are exact.
fn on_a_grid(p: Point3<f64>) -> Point3<f64> {
    p.map(|c| (c * 1024.0).round() / 1024.0)
}

fn moved(part: &Part, by: Vector3<f64>) -> Part {
    let tree = part.tree();
    let indices = 0..tree.len();
    parts::of(
        indices.clone().map(|i| on_a_grid(tree.point(i)) + by).collect(),
        indices.clone().map(|i| tree.normal(i).into()).collect(),
        indices.map(|i| tree.weight(i)).collect(),
    )
}

/// Part and pose that are moved together, by an amount that loses no bit, give the same results to the last bit.
#[test]
fn exact_translations_do_not_change_the_result() {
    let part = parts::tube(2_000);
    let original = moved(&part, Vector3::zeros());
    for power in [10, 20, 30, 40] {
        let by = 2f64.powi(power) * Vector3::new(1.0, -1.0, 0.5);
        let translated = moved(&part, by);
        for (tool, oracle) in tools() {
            let mut rng = Rng::new(21);
            let mut compared = 0;
            for k in 0..30 {
                let pose = parts::about(&original, &*oracle, k, &mut rng);
                let tip = on_a_grid(pose.tip());
                // Larger tips would lose bits in the sum with `by`.
                if tip.coords.amax() > 1024.0 {
                    continue;
                }
                compared += 1;
                let axis = pose.axis();
                let at = |tip| Pose::from_axis(tip, axis).expect("a pose");
                let a = Probe::new(&original, tool).wrench(&at(tip));
                let mut b = Probe::new(&translated, tool).wrench(&at(tip + by));
                if let Some(deepest) = &mut b.deepest {
                    let point = a.deepest.expect("as deep").point;
                    assert!((deepest.point - by - point).amax() <= 2f64.powi(power - 51));
                    deepest.point = point;
                }
                assert_eq!(a, b, "{} 2^{power}", oracle.name());
            }
            assert!(compared > 15, "{}: {compared} poses compared", oracle.name());
        }
    }
}

/// After a translation that rounds the points, results agree with brute force on the rounded points.
#[test]
fn other_translations_change_results_by_rounding_only() {
    for distance in [1e3, 1e6, 1e9, 1e12] {
        let by = distance * Vector3::new(1.0, -0.7, 0.3);
        let part = parts::carried(&parts::tube_mesh(), 2_000, |p| p + by);
        all_tools(&format!("translated by {distance:e}"), &part, 48);
    }
}

/// Parts of sizes from 1e-30 to 1e30, all of them with contacts somewhere.
#[test]
fn tiny_and_huge_parts() {
    for size in [1e-30, 1e-9, 1e-4, 1e-2, 1e2, 1e4, 1e6, 1e9, 1e15, 1e30] {
        all_tools(&format!("soup of {size:e}"), &parts::soup(size, 2_000, 23), 24);
    }
}

/// Half the points within the tool's reach, half strewn over a part up to 1e12 times larger: one tree spans both.
#[test]
fn a_small_tool_on_a_large_part() {
    for size in [1e3, 1e5, 1e8, 1e12] {
        for offset in [0.0, 0.6 * size] {
            let mut rng = Rng::new(25);
            let original = Point3::new(offset, -offset, 0.5 * offset);
            let near_points =
                (0..1_000).map(|_| original + parts::vector(&mut rng, 8.0)).collect::<Vec<_>>();
            let far_points = (0..1_000).map(|_| Point3::from(parts::vector(&mut rng, size)));
            let points: Vec<_> = near_points.into_iter().chain(far_points).collect();
            let normals = (0..2_000).map(|_| parts::direction(&mut rng)).collect();
            let part = parts::of(points, normals, vec![0.3; 2_000]);
            check_tools(&format!("{size:e} at {offset:e}"), &part, 27, |case, rng| {
                for k in 0..24 {
                    let [_, height] = case.oracle.extent();
                    let own = Vector3::new(0.0, 0.0, rng.between(0.0, height));
                    let at = original + parts::vector(rng, 4.0);
                    case.check(&parts::bringing(own, at, rng), k);
                }
                assert!(case.statistics.touching > 12, "{size:e} {}", case.oracle.name());
            });
        }
    }
}

/// Coordinates from the smallest positive double up to 1e-150.
#[test]
fn parts_near_the_smallest_doubles() {
    for size in [5e-324, 1e-310, 1e-300, 1e-150] {
        let points = [0.0, 1.0, 2.0, -3.0, 5.0].map(|k| Point3::new(k * size, -k * size, size));
        let part = parts::of(points.to_vec(), vec![Vector3::x(); 5], vec![1.0; 5]);
        check_tools(&format!("{size:e}"), &part, 26, |case, rng| {
            for k in 0..12 {
                let own = Vector3::new(0.3, 0.2, 0.7);
                // All five points are inside the tool.
                assert_eq!(case.check(&parts::bringing(own, Point3::origin(), rng), k), 5);
            }
        });
    }
}
