//! Random poses at which a tool is likely to touch a part, random motions on which it is likely to come near, and a part with
//! many ridges.

use crate::approach::ReferenceMotion;
use crate::pose_at;
use crate::prelude::*;
use nalgebra::Rotation3;

/// Returns a wavy sheet `2 half` mm wide, with `divisions` squares per side and ridges between its triangles.
pub(crate) fn bumpy(half: f64, divisions: u32) -> Mesh {
    let flat = shapes::plane(half, divisions, Unit::Millimetre).expect("a sheet");
    let mut rng = Rng::new(7);
    let raise = |p: &Point3<f64>| {
        let wave = 1.5 * (0.4 * p.x).sin() * (0.3 * p.y).cos();
        Point3::new(p.x, p.y, wave + rng.between(-0.3, 0.3))
    };
    moved(&flat, raise)
}

/// Returns a random point of a profile and the outward direction there, both as `[d, z]`.
fn random_surface_point(oracle: &Nearest, rng: &mut Rng) -> ([f64; 2], [f64; 2]) {
    let segments = oracle.profile().segments();
    let segment = &segments[rng.index(segments.len())];
    let point = segment.at(rng.between(0.0, 1.0));
    (point, segment.outward(&point))
}

/// Returns a random depth from 1e-9 to about 6 mm, or sometimes minus that, for a gap.
fn random_press_depth(rng: &mut Rng) -> f64 {
    let depth = rng.power(-9.0, 0.8);
    if rng.once_in(8) { -depth } else { depth }
}

impl BruteForce<'_> {
    /// Returns a random pose. Most poses press a point of the tool's surface slightly into a triangle, either facing it or
    /// in any orientation. Some are along the coordinate axes and at round numbers, and some anywhere around the part.
    pub(crate) fn random_pose(&self, rng: &mut Rng) -> Pose {
        match rng.bits() % 20 {
            0..=7 => self.touching_pose(true, rng),
            8..=14 => self.touching_pose(false, rng),
            15..=17 => self.aligned_pose(rng),
            _ => self.pose_anywhere(rng),
        }
    }

    /// Returns the normal of a triangle, or any direction if it has no area.
    fn normal(&self, id: usize, rng: &mut Rng) -> Vector3<f64> {
        let normal = self.mesh.normal(TriangleId(id as u32));
        normal.unwrap_or_else(|| random_direction(rng))
    }

    fn touching_pose(&self, is_facing: bool, rng: &mut Rng) -> Pose {
        let (mesh, length) = (self.mesh, self.length);
        let id = (rng.bits() as usize % mesh.triangles().len()) as u32;
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let [v, w] = rng.weights();
        let target = a + v * (b - a) + w * (c - a);
        let profile = self.profile.expect("a profile");
        let ([d, z], [radial_part, axial_part]) = random_surface_point(profile, rng);
        let inward = -self.normal(id as usize, rng);
        let (axis, radial) = if is_facing {
            let orthogonal = Vector3::from(rng.across(inward.into()));
            let axis = axial_part * inward + radial_part * orthogonal;
            (axis, radial_part * inward - axial_part * orthogonal)
        } else {
            let axis = random_direction(rng);
            let radial = Vector3::from(rng.across(axis.into()));
            (axis, radial)
        };
        let outward = radial_part * radial + axial_part * axis;
        pose_at(target - length * (d * radial + z * axis) + random_press_depth(rng) * outward, axis)
    }

    /// Returns a pose along a coordinate axis: flush with a corner of the part's box, tangent to its sides, or on a grid.
    fn aligned_pose(&self, rng: &mut Rng) -> Pose {
        let length = self.length;
        let mut axis = Vector3::zeros();
        let axis_index = rng.index(3);
        axis[axis_index] = if rng.once_in(2) { 1.0 } else { -1.0 };
        let [low, high] = self.mesh.bounds();
        let [d, _, z] = rng.pick(&self.oracle.corner_points());
        let mut tip = Point3::origin();
        for k in 0..3 {
            let side = if rng.once_in(2) { low[k] } else { high[k] };
            let grid = (rng.between(low[k], high[k]) * 2.0).round() / 2.0;
            tip[k] = match rng.bits() % 4 {
                0 if k == axis_index => side - z * length * axis[k],
                0 => side - d * length,
                1 if k != axis_index => side + d * length,
                1 => side,
                2 => grid,
                _ => rng.between(low[k], high[k]),
            };
        }
        pose_at(tip, axis)
    }

    /// Returns a pose anywhere in a box twice the part's size, so that the tool may be entirely inside or far away.
    fn pose_anywhere(&self, rng: &mut Rng) -> Pose {
        let [low, high] = self.mesh.bounds();
        let centre = nalgebra::center(&low, &high);
        let tip = [0, 1, 2].map(|k| centre[k] + (high[k] - low[k]) * rng.between(-1.0, 1.0));
        pose_at(Point3::from(tip), random_direction(rng))
    }
}

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
    let about = nalgebra::Unit::new_normalize(random_direction(rng));
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
                let normal = self.normal(id, rng);
                let slide = normal.cross(&random_direction(rng)).normalize()
                    * part_size
                    * rng.power(-3.0, 0.0);
                let tilts = rng.once_in(2);
                pose_at(tip + slide, if tilts { axis + 0.1 * random_direction(rng) } else { axis })
            }
            MotionKind::SwingAboutTip => pose_at(tip, random_rotation(rng) * axis),
            MotionKind::SwingAboutPoint => {
                let still = ReferenceMotion { from, to: from };
                let about = Point3::from(self.deepest_at(&still, 0.0, rng).point);
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
            let normal = self.normal(deepest.triangle, rng);
            let shift = normal * (deepest.depth + gap);
            let shifted = |pose: &Pose| pose_at(pose.tip() + shift, pose.axis());
            motion = ReferenceMotion { from: shifted(&motion.from), to: shifted(&motion.to) };
        }
        motion
    }
}
