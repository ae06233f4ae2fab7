//! Clearance of a tool, checked against known geometry and against the points of a fine raster.

use crate::prelude::*;
use crate::to_tool;
use std::sync::Arc;

/// Number of divisions of the triangles' sides.
const DIVISIONS: u32 = 20;

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

#[test]
fn clearance_in_material_is_the_distance_to_the_surface() {
    let mut certifier = certifier(&block([-90.0; 3], [90.0; 3]), "D2Ball");
    let found = certifier.clearance(&pose([0.0, 0.0, -85.0], UP), 1e-9).distance;
    assert_contains(found, 5.0, 2e-9, "in a block");
}

fn tube() -> Mesh {
    shapes::tube(3.0, 5.0, 13.0, 24, 3, Unit::Millimetre).expect("a tube")
}

/// Returns a random pose with its tip in a cube.
fn random_pose(half: f64, rng: &mut Rng) -> Pose {
    let axis = Vector3::from_fn(|_, _| rng.between(-1.0, 1.0)).normalize();
    pose([0; 3].map(|_| rng.between(-half, half)), axis.into())
}

/// Returns the distance of a raster of a part's points, which is at least that of the part, and a bound on the excess.
fn raster_distance(mesh: &Mesh, oracle: &Nearest, pose: &Pose) -> [f64; 2] {
    let (mut min_distance, mut spacing) = (f64::INFINITY, 0f64);
    for [a, b, c] in triangles(mesh) {
        let (u, v) = ((b - a) / f64::from(DIVISIONS), (c - a) / f64::from(DIVISIONS));
        spacing = spacing.max(u.norm()).max(v.norm()).max((v - u).norm());
        for i in 0..=DIVISIONS {
            for j in 0..=DIVISIONS - i {
                let p = to_tool(pose, 1.0, a + u * f64::from(i) + v * f64::from(j));
                min_distance = min_distance.min(oracle.signed_distance(p));
            }
        }
    }
    [min_distance, spacing]
}

#[test]
fn raster_points_are_within_the_certified_clearance() {
    let sphere = shapes::sphere(8.0, 2, Unit::Millimetre).expect("a sphere");
    let mut rng = Rng::new(7);
    for mesh in [&sphere, &tube()] {
        for name in ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"] {
            let oracle = Nearest::of(name);
            let mut certifier = certifier(mesh, name);
            let mut count = 0;
            while count < 8 {
                let pose = random_pose(25.0, &mut rng);
                let [nearest, spacing] = raster_distance(mesh, &oracle, &pose);
                let Interval { low, high } = certifier.clearance(&pose, 1e-6).distance;
                let text = format!("{name} at {pose:?}: {nearest} by points, {low} to {high}");
                if nearest <= 0.0 {
                    assert_eq!(low, 0.0, "{text}");
                    continue;
                }
                count += 1;
                assert!(low <= nearest + 1e-9, "{text}");
                // Every point of the mesh is within one raster side of a raster point.
                assert!(nearest - spacing <= high, "{text}");
                assert!(high - low < 2e-6, "{text}");
            }
        }
    }
}

/// The oracle locates the tool's point: on the surface, as far from the witness as is said, and with the normal along which
/// the distance grows.
#[test]
fn the_nearest_points_are_on_both_surfaces() {
    let mut rng = Rng::new(11);
    let (mut apart, mut contacts) = (0, 0);
    for name in ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"] {
        let oracle = Nearest::of(name);
        let mut certifier = certifier(&tube(), name);
        for _ in 0..200 {
            let pose = random_pose(12.0, &mut rng);
            let nearest = certifier.clearance(&pose, 1e-9);
            let (on_tool, witness) = (nearest.on_tool.expect("a point"), nearest.witness);
            let text = format!("{name} at {pose:?}: {nearest:?}");
            // Both are known to the rounding error of the certifier, far below this.
            let off = oracle.signed_distance(to_tool(&pose, 1.0, on_tool.point));
            assert!(off.abs() < 1e-9, "{text}");
            assert!((on_tool.normal.norm() - 1.0).abs() < 1e-12, "{text}");
            let between = witness.expect("a point").point - on_tool.point;
            let signed = certifier.signed_distance(&pose, 1e-9);
            if nearest.distance.low > 0.0 {
                apart += 1;
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
    let buried = inside.signed_distance(&pose([0.0, 0.0, -85.0], UP), 1e-9);
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
