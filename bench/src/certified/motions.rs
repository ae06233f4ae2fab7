//! Random motions on which a tool is likely to come near a part.

use super::approach::ReferenceMotion;
use super::brute::BruteForce;
use super::poses;
use nalgebra::{Point3, Rotation3, Unit, Vector3};
use touchoff::{Pose, TriangleId};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;

/// The kinds of motions.
pub const MOTION_KINDS: [&str; 8] = [
    "slide",
    "swing about the tip",
    "swing about a place",
    "plunge",
    "straight",
    "still",
    "rapid",
    "any",
];

/// Number of times that a motion is shifted toward a near miss, and number of sampled times per shift.
const SHIFTS: usize = 3;
const TIME_SAMPLES_PER_SHIFT: u32 = 10;

fn pose_at(tip: Point3<f64>, axis: Vector3<f64>) -> Pose {
    Pose::from_axis(tip, axis.normalize()).expect("an axis")
}

fn random_direction(rng: &mut Rng) -> Vector3<f64> {
    Vector3::from(rng.direction())
}

/// Returns a random number between two powers of ten.
fn random_power(rng: &mut Rng, low_exponent: f64, high_exponent: f64) -> f64 {
    10f64.powf(rng.between(low_exponent, high_exponent))
}

/// Returns a rotation about a random axis by 0.001 to 150 degrees.
fn random_rotation(rng: &mut Rng) -> Rotation3<f64> {
    let about = Unit::new_normalize(random_direction(rng));
    Rotation3::from_axis_angle(&about, random_power(rng, -3.0, 150f64.log10()).to_radians())
}

/// Returns a random motion of a kind. Most are shifted away from the part until they pass it by 1e-7 to 0.5 mm, or
/// overlap it by that much.
pub fn random_motion(brute: &BruteForce<'_>, kind: &str, rng: &mut Rng) -> ReferenceMotion {
    loop {
        let motion = draw_motion(brute, kind, rng);
        // For nearly antiparallel axes, rounding decides the rotation.
        if motion.angle().to_degrees() > 170.0 {
            continue;
        }
        let stays = rng.bits().is_multiple_of(6);
        return if stays { motion } else { shift_to_near_miss(brute, motion, rng) };
    }
}

fn draw_motion(brute: &BruteForce<'_>, kind: &str, rng: &mut Rng) -> ReferenceMotion {
    let from = poses::pose(brute.mesh, brute.oracle, brute.length, rng);
    let (tip, axis) = (from.tip(), from.axis());
    let [low, high] = brute.mesh.bounds();
    let part_size = (high - low).norm();
    let to = match kind {
        "slide" => {
            let id = brute.deepest_at(&ReferenceMotion { from, to: from }, 0.0, rng).triangle;
            let normal =
                brute.mesh.normal(TriangleId(id as u32)).unwrap_or_else(|| random_direction(rng));
            let slide = normal.cross(&random_direction(rng)).normalize()
                * part_size
                * random_power(rng, -3.0, 0.0);
            let tilts = rng.bits().is_multiple_of(2);
            pose_at(tip + slide, if tilts { axis + 0.1 * random_direction(rng) } else { axis })
        }
        "swing about the tip" => pose_at(tip, random_rotation(rng) * axis),
        "swing about a place" => {
            let about =
                Point3::from(brute.deepest_at(&ReferenceMotion { from, to: from }, 0.0, rng).point);
            let rotation = random_rotation(rng);
            pose_at(about + rotation * (tip - about), rotation * axis)
        }
        "plunge" => {
            let distance = part_size * random_power(rng, -4.0, 0.3);
            pose_at(
                tip + axis * if rng.bits().is_multiple_of(2) { distance } else { -distance },
                axis,
            )
        }
        "straight" => {
            pose_at(tip + random_direction(rng) * part_size * random_power(rng, -4.0, 0.5), axis)
        }
        "still" => from,
        "rapid" => {
            let far_pose = pose_at(
                tip + random_direction(rng) * part_size * random_power(rng, 0.5, 3.0),
                random_rotation(rng) * axis,
            );
            // Half of them also come from far away.
            if rng.bits().is_multiple_of(2) {
                let back = tip - (far_pose.tip() - tip);
                return ReferenceMotion { from: pose_at(back, axis), to: far_pose };
            }
            far_pose
        }
        _ => poses::pose(brute.mesh, brute.oracle, brute.length, rng),
    };
    if rng.bits().is_multiple_of(2) {
        ReferenceMotion { from, to }
    } else {
        ReferenceMotion { from: to, to: from }
    }
}

fn shift_to_near_miss(
    brute: &BruteForce<'_>,
    mut motion: ReferenceMotion,
    rng: &mut Rng,
) -> ReferenceMotion {
    let [radius, _] = brute.oracle.extent();
    let gap = random_power(rng, -7.0, -0.3) * (radius * brute.length / 5.0);
    let gap = if rng.bits().is_multiple_of(10) { -gap } else { gap };
    for _ in 0..SHIFTS {
        let deepest = brute.deepest_in_motion(&motion, TIME_SAMPLES_PER_SHIFT, false, rng);
        let normal = brute
            .mesh
            .normal(TriangleId(deepest.triangle as u32))
            .unwrap_or_else(|| random_direction(rng));
        let shift = normal * (deepest.depth + gap);
        let shifted = |pose: &Pose| pose_at(pose.tip() + shift, pose.axis());
        motion = ReferenceMotion { from: shifted(&motion.from), to: shifted(&motion.to) };
    }
    motion
}
