//! Random motions on which a tool is likely to come near a part.

use crate::approach::ReferenceMotion;
use crate::brute::BruteForce;
use crate::pose_at;
use nalgebra::{Point3, Rotation3, Unit, Vector3};
use touchoff::{Pose, TriangleId};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MotionKind {
    /// Along a triangle's plane; half of these also tilt.
    Slide,
    SwingAboutTip,
    SwingAboutPoint,
    /// Along the tool's axis.
    Plunge,
    Straight,
    Still,
    /// To a pose far away; half of these also come from far away.
    Rapid,
    Any,
}

impl MotionKind {
    pub(crate) const ALL: [MotionKind; 8] = [
        MotionKind::Slide,
        MotionKind::SwingAboutTip,
        MotionKind::SwingAboutPoint,
        MotionKind::Plunge,
        MotionKind::Straight,
        MotionKind::Still,
        MotionKind::Rapid,
        MotionKind::Any,
    ];
}

/// Number of times that a motion is shifted toward a near miss, and number of sampled times per shift.
const SHIFTS: usize = 3;
const TIME_SAMPLES_PER_SHIFT: u32 = 10;

fn random_direction(rng: &mut Rng) -> Vector3<f64> {
    Vector3::from(rng.direction())
}

/// Returns a rotation about a random axis by 0.001 to 150 degrees.
fn random_rotation(rng: &mut Rng) -> Rotation3<f64> {
    let about = Unit::new_normalize(random_direction(rng));
    Rotation3::from_axis_angle(&about, rng.power(-3.0, 150f64.log10()).to_radians())
}

impl BruteForce<'_> {
    /// Returns a random motion of a kind. Most are shifted away from the part until they pass it by 1e-7 to 0.5 mm, or
    /// overlap it by that much.
    pub(crate) fn random_motion(&self, kind: MotionKind, rng: &mut Rng) -> ReferenceMotion {
        loop {
            let motion = self.draw_motion(kind, rng);
            // For nearly antiparallel axes, rounding decides the rotation.
            if motion.angle().to_degrees() > 170.0 {
                continue;
            }
            let stays = rng.once_in(6);
            return if stays { motion } else { self.shift_to_near_miss(motion, rng) };
        }
    }

    fn draw_motion(&self, kind: MotionKind, rng: &mut Rng) -> ReferenceMotion {
        let from = self.random_pose(rng);
        let (tip, axis) = (from.tip(), from.axis());
        let [low, high] = self.mesh.bounds();
        let part_size = (high - low).norm();
        let to = match kind {
            MotionKind::Slide => {
                let id = self.deepest_at(&ReferenceMotion { from, to: from }, 0.0, rng).triangle;
                let normal = self
                    .mesh
                    .normal(TriangleId(id as u32))
                    .unwrap_or_else(|| random_direction(rng));
                let slide = normal.cross(&random_direction(rng)).normalize()
                    * part_size
                    * rng.power(-3.0, 0.0);
                let tilts = rng.once_in(2);
                pose_at(tip + slide, if tilts { axis + 0.1 * random_direction(rng) } else { axis })
            }
            MotionKind::SwingAboutTip => pose_at(tip, random_rotation(rng) * axis),
            MotionKind::SwingAboutPoint => {
                let about = Point3::from(
                    self.deepest_at(&ReferenceMotion { from, to: from }, 0.0, rng).point,
                );
                let rotation = random_rotation(rng);
                pose_at(about + rotation * (tip - about), rotation * axis)
            }
            MotionKind::Plunge => {
                let distance = part_size * rng.power(-4.0, 0.3);
                pose_at(tip + axis * if rng.once_in(2) { distance } else { -distance }, axis)
            }
            MotionKind::Straight => {
                pose_at(tip + random_direction(rng) * part_size * rng.power(-4.0, 0.5), axis)
            }
            MotionKind::Still => from,
            MotionKind::Rapid => {
                let far_pose = pose_at(
                    tip + random_direction(rng) * part_size * rng.power(0.5, 3.0),
                    random_rotation(rng) * axis,
                );
                if rng.once_in(2) {
                    let back = tip - (far_pose.tip() - tip);
                    return ReferenceMotion { from: pose_at(back, axis), to: far_pose };
                }
                far_pose
            }
            MotionKind::Any => self.random_pose(rng),
        };
        if rng.once_in(2) {
            ReferenceMotion { from, to }
        } else {
            ReferenceMotion { from: to, to: from }
        }
    }

    fn shift_to_near_miss(&self, mut motion: ReferenceMotion, rng: &mut Rng) -> ReferenceMotion {
        let [radius, _] = self.oracle.extent();
        let gap = rng.power(-7.0, -0.3) * (radius * self.length / 5.0);
        let gap = if rng.once_in(10) { -gap } else { gap };
        for _ in 0..SHIFTS {
            let deepest = self.deepest_in_motion(&motion, TIME_SAMPLES_PER_SHIFT, false, rng);
            let normal = self
                .mesh
                .normal(TriangleId(deepest.triangle as u32))
                .unwrap_or_else(|| random_direction(rng));
            let shift = normal * (deepest.depth + gap);
            let shifted = |pose: &Pose| pose_at(pose.tip() + shift, pose.axis());
            motion = ReferenceMotion { from: shifted(&motion.from), to: shifted(&motion.to) };
        }
        motion
    }
}
