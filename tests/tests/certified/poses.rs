//! Random poses at which a tool is likely to touch a part, and a part with many ridges.

use crate::brute::BruteForce;
use crate::pose_at;
use crate::verdicts::moved;
use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Pose, TriangleId, Unit};
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};

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

/// Returns a random point of the tool's surface and the outward direction there, both as `[d, z]`.
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

    fn touching_pose(&self, is_facing: bool, rng: &mut Rng) -> Pose {
        let (mesh, length) = (self.mesh, self.length);
        let id = (rng.bits() as usize % mesh.triangles().len()) as u32;
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let [v, w] = rng.weights();
        let target = a + v * (b - a) + w * (c - a);
        let ([d, z], [radial_part, axial_part]) = random_surface_point(self.oracle, rng);
        let inward = mesh
            .normal(TriangleId(id))
            .map_or_else(|| Vector3::from(rng.direction()), |normal| -normal);
        let (axis, radial) = if is_facing {
            let orthogonal = Vector3::from(rng.across(inward.into()));
            (
                axial_part * inward + radial_part * orthogonal,
                radial_part * inward - axial_part * orthogonal,
            )
        } else {
            let axis = Vector3::from(rng.direction());
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
        let corners = self.oracle.corners();
        let [d, z] = corners[rng.index(corners.len())];
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
        let axis = Vector3::from(rng.direction());
        pose_at(Point3::from(tip), axis)
    }
}
