//! A tool among several bodies whose depths and distances are known: one answer for all, whatever their order.

use crate::prelude::*;
use touchoff::certify::CertifiedScene;
use touchoff_tests::fixtures::ball;

/// Returns a plate whose upper face is at a height.
fn plate_at(height: f64) -> TriangleBvh {
    TriangleBvh::new(&block([-20.0, -15.0, height - 10.0], [20.0, 15.0, height]))
}

/// Asks for the answer of two bodies, `first` and `second`, in both orders of their names.
fn assert_for_both_orders(bodies: [&TriangleBvh; 2], check: impl Fn(&mut CertifiedScene<'_>)) {
    let tool = ball();
    for order in [[0, 1], [1, 0]] {
        let mut scene = CertifiedScene::new(Unit::Millimetre);
        for k in order {
            let certifier = Certifier::new(bodies[k], &tool).expect("a profile");
            let name = ["first", "second"][k];
            scene.add_body(name, certifier, Pose::default()).expect("millimetres");
        }
        check(&mut scene);
    }
}

#[test]
fn the_deepest_body_decides_depth_and_the_nearest_one_distance() {
    for [first, second] in
        [[0.2, 0.5], [0.5, 0.2], [-0.3, -0.7], [-0.7, -0.3], [0.2, -0.7], [-0.7, 0.2]]
    {
        let deepest = if first > second { "first" } else { "second" };
        let depth = f64::max(first, second);
        assert_for_both_orders([&plate_at(first), &plate_at(second)], |scene| {
            let tip = pose([0.3, 0.1, 0.0], UP);
            let found = scene.signed_distance(&tip, 1e-9).expect("bodies");
            assert_eq!(found.body, deepest, "{first} {second}");
            assert_contains(found.answer, -depth, 1e-8, first);
            let found = scene.deepest(&tip, 1e-9).expect("bodies");
            assert_contains(found.answer.depth, depth.max(0.0), 1e-8, first);
            if depth > 0.0 {
                assert_eq!(found.body, deepest, "{first} {second}");
            }
            let found = scene.clearance(&tip, 1e-9).expect("bodies");
            assert_contains(found.answer.distance, (-depth).max(0.0), 1e-8, first);
            if depth < 0.0 {
                assert_eq!(found.body, deepest, "{first} {second}");
            }
        });
    }
}

#[test]
fn the_gravest_verdict_is_that_of_all_bodies() {
    let around = TriangleBvh::new(&block([-50.0; 3], [50.0; 3]));
    let (touched, far) = (plate_at(0.5), plate_at(-1.0));
    let tip = pose([0.3, 0.1, 0.0], UP);
    let path = Motion::new(&tip, &pose([0.4, 0.1, 0.0], UP)).expect("no rotation");
    for (bodies, body) in
        [([&touched, &around], "first"), ([&far, &around], "second"), ([&far, &touched], "second")]
    {
        assert_for_both_orders(bodies, |scene| {
            let is_touching = bodies.iter().any(|bvh| std::ptr::eq(*bvh, &touched));
            let found = scene.check_pose(&tip).expect("bodies");
            assert_eq!(found.body, body);
            assert_eq!(matches!(found.answer, PoseVerdict::Touching(_)), is_touching);
            assert_eq!(matches!(found.answer, PoseVerdict::Inside(_)), !is_touching);
            let found = scene.check_motion(&path, 1e-6).expect("bodies");
            assert_eq!(found.body, body);
            assert_eq!(matches!(found.answer, MotionVerdict::Touching(..)), is_touching);
            assert_eq!(matches!(found.answer, MotionVerdict::Inside(_)), !is_touching);
        });
    }
}
