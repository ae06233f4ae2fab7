//! Clearance of a tool, checked against known geometry and against samples.

use crate::depth_oracle::PROFILES;
use crate::prelude::*;
use crate::to_tool;
use std::sync::Arc;

#[test]
fn clearance_of_a_ball_above_a_plate_is_its_height() {
    let mut certifier = certifier(&plate(), "D2Ball");
    for gap in [1e-9, 1e-6, 1e-3, 0.5, 20.0, 1e4] {
        let found = certifier.clearance(&pose([0.3, 0.1, gap], UP), 1e-9).distance;
        assert_contains(found, gap, 2e-9 + 1e-11 * gap, "above a plate");
    }
    let touching = certifier.clearance(&pose([0.3, 0.1, -0.5], UP), 1e-9);
    assert_eq!(touching.distance, Interval::new(0.0, 0.0));
    assert!(touching.witness.is_some());
}

fn tube() -> Mesh {
    shapes::tube(3.0, 5.0, 13.0, 24, 3, Unit::Millimetre).expect("a tube")
}

/// Returns a random pose with its tip in a cube.
fn random_pose(half: f64, rng: &mut Rng) -> Pose {
    pose([0; 3].map(|_| rng.between(-half, half)), rng.direction())
}

/// The oracle locates the tool's point: on the surface, as far from the witness as is said, and with the normal along which
/// the distance grows. No sample of the part is nearer than that.
#[test]
fn the_nearest_points_are_on_both_surfaces() {
    let sphere = shapes::sphere(8.0, 2, Unit::Millimetre).expect("a sphere");
    let mut rng = Rng::new(11);
    let (mut apart, mut contacts) = (0, 0);
    for (mesh, name) in [sphere, tube()].iter().flat_map(|mesh| PROFILES.map(|name| (mesh, name))) {
        let oracle = Nearest::of(name);
        let brute = BruteForce::new(mesh, &oracle, 1.0);
        let mut certifier = certifier(mesh, name);
        for k in 0..100 {
            let pose = random_pose([12.0, 25.0][k % 2], &mut rng);
            let nearest = certifier.clearance(&pose, 1e-9);
            let on_tool = nearest.on_tool.expect("a point");
            let witness = nearest.witness.expect("a point");
            let text = format!("{name} at {pose:?}: {nearest:?}");
            // Both are known to the rounding error of the certifier, far below this.
            let off = oracle.signed_distance(to_tool(&pose, 1.0, on_tool.point));
            assert!(off.abs() < 1e-9 && brute.witness(&pose, &witness).1 < 1e-9, "{text}");
            assert!((on_tool.normal.norm() - 1.0).abs() < 1e-12, "{text}");
            let between = witness.point - on_tool.point;
            let signed = certifier.signed_distance(&pose, 1e-9);
            assert!(nearest.distance.width() < 1e-8, "{text}");
            if nearest.distance.low > 0.0 {
                apart += 1;
                let sampled = -brute.deepest(&brute.tool_frame(&pose), &mut rng);
                assert!(nearest.distance.low <= sampled + 1e-9, "{text}: {sampled} by samples");
                assert!((between.norm() - nearest.distance.low).abs() < 1e-8, "{text}");
                assert!((between / between.norm() - on_tool.normal).norm() < 1e-6, "{text}");
                // The search before decides which triangle comes first, and so the bits.
                assert!((signed.low - nearest.distance.low).abs() < 1e-8, "{text}");
            } else {
                contacts += 1;
                let depth = certifier.deepest(&pose, 1e-9).depth;
                assert!(signed.low <= -depth.low && -depth.high <= signed.high, "{text}: {signed}");
                assert!(signed.width() < 1e-8, "{text}: {signed}");
                // The witness of a contact is inside: the normal leads from it to the surface.
                assert!(between.dot(&on_tool.normal) <= 1e-12, "{text}");
            }
        }
    }
    println!("{apart} apart, {contacts} contacts");
    assert!(apart > 100 && contacts > 300, "{apart} {contacts}");
}

#[test]
fn a_signed_distance_is_below_zero_in_the_material() {
    let mut inside = certifier(&block([-90.0; 3], [90.0; 3]), "D2Ball");
    let deep = pose([0.0, 0.0, -85.0], UP);
    assert_contains(inside.clearance(&deep, 1e-9).distance, 5.0, 2e-9, "in a block");
    let buried = inside.signed_distance(&deep, 1e-9);
    assert_eq!(buried.low, f64::NEG_INFINITY);
    assert!((-5.0..-5.0 + 1e-8).contains(&buried.high), "{buried}");
    // An open sheet has no inside.
    let sheet = shapes::plane(20.0, 4, Unit::Millimetre).expect("a sheet");
    let above = certifier(&sheet, "D2Ball").signed_distance(&pose([0.0, 0.0, 2.0], UP), 1e-9);
    assert_contains(above, 2.0, 2e-8, "above a sheet");
}

/// Certifiers that share their part and tool, clones and threads answer with the bits of the first.
#[test]
fn shared_and_cloned_certifiers_have_the_same_bits() {
    let bvh = Arc::new(TriangleBvh::new(&tube()));
    let mut rng = Rng::new(5);
    let poses: Vec<Pose> = (0..300).map(|_| random_pose(12.0, &mut rng)).collect();
    struct Held(Certifier<'static>);
    let interpreted: Arc<dyn Tool> = Arc::new(drawn("0 0; pin 1 0, 1 9, 0 9", ""));
    let mut held =
        Held(Certifier::shared(Arc::clone(&bvh), Arc::clone(&interpreted)).expect("a profile"));
    let mut borrowed = Certifier::new(&bvh, &*interpreted).expect("a profile");
    let mut cloned = borrowed.clone();
    // Stretches of 64 begin without caches, as on all cores.
    let mut alone = Vec::new();
    for stretch in poses.chunks(64) {
        borrowed.clear_caches();
        cloned.clear_caches();
        held.0.clear_caches();
        for pose in stretch {
            let answers = [
                borrowed.signed_distance(pose, 1e-7),
                cloned.signed_distance(pose, 1e-7),
                held.0.signed_distance(pose, 1e-7),
            ];
            assert!(answers[1] == answers[0] && answers[2] == answers[0], "{answers:?}");
            alone.push(answers[0]);
        }
    }
    let many = held.0.par_map(&poses, |certifier, pose| certifier.signed_distance(pose, 1e-7));
    assert_eq!(many, alone);
    // A thread of its own.
    let answers = std::thread::spawn(move || held.0.signed_distance(&poses[0], 1e-7)).join();
    assert_eq!(answers.expect("no panic").low, alone[0].low);
}
