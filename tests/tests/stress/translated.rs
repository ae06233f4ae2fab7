//! Item 6: points near the tool, part and pose translated together.
//!
//! By powers of two, where no coordinate loses a bit: the same bits of contacts and wrench. By 1e3 … 1e12 times (1, -0.7,
//! 0.3): depths differ by no more than both clouds' `Probe::rounding_error_bound` and the rounding of the coordinates;
//! and each scene is checked on its own.

use crate::prelude::*;
use crate::scene::{compare_depths, with_tip};

/// Spacing of the coordinates' grid, so that sums with 2^40 are exact.
const GRID: f64 = 1.0 / 1024.0;

#[test]
fn translated_scenes_are_equal() {
    check_tools(6, |subject, rng, checks| {
        let points = PointSet::near_tool(subject, extent(12, 200), GRID, rng);
        for _ in 0..extent(1, 8) {
            let pose = random_pose(Point3::origin(), rng);
            let points = points.transformed(&pose, GRID);
            // All poses are made from one, since a rotation taken from a pose and given again is rounded.
            let translated = |offset: Vector3<f64>| {
                let pose = with_tip(&pose, Point3::from(offset));
                Scene::new(subject, points.map(|p| p + offset), pose)
            };
            let scene = translated(Vector3::zeros());
            for power in [10, 20, 30, 40] {
                let translated = translated(2f64.powi(power) * Vector3::new(1.0, -1.0, 0.5));
                let differ = values(&scene) != values(&translated);
                let place = || format_pose(&translated.pose);
                checks.never("translated without a loss: other bits", differ, place);
            }
            for distance in [1e3, 1e6, 1e9, 1e12] {
                let offset = distance * Vector3::new(1.0, -0.7, 0.3);
                let translated = translated(offset);
                let contacts = [&scene, &translated].map(|scene| scene.check(checks).contacts);
                let lipschitz = subject.tool.info().depth.lipschitz.expect("proved of every tool");
                // Each coordinate of the point and of the tip is rounded to half an ulp at its position.
                let rounding =
                    lipschitz * 3f64.sqrt() * f64::EPSILON * (offset.amax() + subject.scale());
                let bound = scene.error_bound() + translated.error_bound() + rounding;
                let place = || format!("translated to {}", format_pose(&translated.pose));
                compare_depths([&contacts[0], &contacts[1]], bound, place, checks);
            }
        }
    });
}

/// Returns contacts and wrench without their points, as text of all numbers, so that different numbers give different
/// text.
fn values(scene: &Scene<'_>) -> String {
    let mut answers = scene.query();
    for contact in &mut answers.contacts {
        contact.point = Point3::origin();
    }
    if let Some(deepest) = &mut answers.wrench.deepest {
        deepest.point = Point3::origin();
    }
    format!("{:?} {:?}", answers.contacts, answers.wrench)
}
