//! Parts far from the world's origin, tiny and huge: the tree keeps its points relative to the centres of its leaves.

use super::anywhere::all_tools;
use super::compare::check_tools;
use super::parts;
use crate::prelude::*;

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
