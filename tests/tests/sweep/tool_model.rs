//! Postures of a tool at a triangle, derived from the tool's restatement alone.

use nalgebra::{Point3, Vector3};
use touchoff_tests::oracle::profile::Feature;
use touchoff_tests::oracle::vector::{Point, add, cross, dot, left, opposite, sub, unit};
use touchoff_tests::oracle::{Nearest, Oracle};

pub(super) struct ToolModel {
    /// The oracle for its profile and its depths.
    pub(super) oracle: Nearest,
    /// The tool's unit of length, in the part's unit.
    pub(super) length: f64,
    /// Up to two heights on the axis, in the tool's unit: the deepest point owned by a cutting surface, if deeper than
    /// the tolerance, and the deepest point owned by another surface.
    pub(super) core_heights: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Posture {
    /// The tip, in the part's unit.
    pub(super) tip: Point3<f64>,
    /// The axis, from the tip to the spindle.
    pub(super) axis: Vector3<f64>,
    pub(super) niceness: f64,
}

/// A sine, or a share of the tool's size, that counts as rounding.
const ROUNDING: f64 = 1e-9;

impl ToolModel {
    /// Derives a tool from its restatement. `length` is the tool's unit of length in the part's unit. `tolerance` is
    /// the allowed depth of cutting surfaces, in the part's unit.
    pub(super) fn new(name: &str, length: f64, tolerance: f64) -> ToolModel {
        let mut model = ToolModel { oracle: Nearest::of(name), length, core_heights: Vec::new() };
        model.core_heights = model.deepest(tolerance);
        model
    }

    /// Returns all postures in which a cutting surface touches the plane through a point, on a convex arc or at a
    /// corner of the outline. The outline's normal there is opposite to the plane's, or the opposite lies between the
    /// normals of the pieces that meet at the corner. Deviations up to `factor` times rounding are accepted.
    pub(super) fn postures(
        &self,
        contact_point: Point3<f64>,
        normal: Vector3<f64>,
        axis: Vector3<f64>,
        factor: f64,
    ) -> Vec<Posture> {
        let axial = -normal.dot(&axis);
        let radial_vector = -normal - axial * axis;
        let radial_length = radial_vector.norm();
        let direction = [radial_length, axial];
        let size = self.oracle.extent()[0].max(self.oracle.extent()[1]);
        let (small_step, rounding) = (ROUNDING * size, factor * ROUNDING);
        let profile = self.oracle.profile();
        let cutting = profile.owners().iter().zip(self.oracle.surfaces());
        let cutting: Vec<usize> = cutting
            .filter_map(|(owner, (_, cuts))| match owner {
                Feature::Segment(k) if cuts => Some(*k),
                _ => None,
            })
            .collect();
        // The contact point, and a point slightly inside the segments that touch there.
        let mut contacts: Vec<(Point<f64>, [Point<f64>; 2])> = Vec::new();
        for &k in &cutting {
            let segment = &profile.segments()[k];
            if let Some(circle) = &segment.circle
                && circle.convex
            {
                let arms = [segment.from, segment.to].map(|end| unit(&sub(&end, &circle.centre)));
                if cross(&arms[0], &direction) >= -rounding
                    && cross(&direction, &arms[1]) >= -rounding
                {
                    let at_radius = |radius: f64| add(&circle.centre, &direction, &radius);
                    let inner = at_radius(circle.radius - small_step);
                    contacts.push((at_radius(circle.radius), [inner; 2]));
                }
            }
            // The corner before the segment.
            if k > 0 && !cutting.contains(&(k - 1)) {
                continue;
            }
            let [before, after] = profile.tangents(k);
            let is_extreme =
                dot(before, &direction) >= -rounding && dot(after, &direction) <= rounding;
            if profile.turn(k) > ROUNDING && is_extreme {
                let slightly_inside = |along: Point<f64>, tangent: &Point<f64>| {
                    let step = add(&along, &left(tangent), &0.02);
                    add(&segment.from, &step, &small_step)
                };
                let inner_points =
                    [slightly_inside(opposite(before), before), slightly_inside(*after, after)];
                contacts.push((segment.from, inner_points));
            }
        }
        let posture = |([d, z], inner_points): (Point<f64>, [Point<f64>; 2])| {
            // If the tool's axis is parallel to the normal, the contact is a ring without a distinguished point.
            if radial_length < ROUNDING && d > ROUNDING * size {
                return None;
            }
            let radial =
                if radial_length > 0.0 { radial_vector / radial_length } else { Vector3::zeros() };
            let niceness_at = |[d, z]: Point<f64>| {
                self.oracle.evaluate([d, 0.0, z]).map(|evaluation| evaluation.niceness)
            };
            // At a corner both pieces touch, and the lower niceness counts.
            let niceness = inner_points.into_iter().filter_map(niceness_at).reduce(f64::min)?;
            let tip = contact_point - self.length * (d * radial + z * axis);
            Some(Posture { tip, axis, niceness })
        };
        contacts.into_iter().filter_map(posture).collect()
    }

    /// Returns the largest radius and the height, in the part's unit.
    pub(super) fn extent(&self) -> [f64; 2] {
        self.oracle.extent().map(|value| value * self.length)
    }

    /// Returns the depth of a point of the tool's frame, which is negative outside, and its distances from the cutting
    /// surfaces and from the others. The point is in the tool's unit, the results in the part's.
    pub(super) fn depth_and_distances(&self, point: [f64; 3]) -> [f64; 3] {
        let [cutting_distance, non_cutting_distance] =
            [true, false].map(|cuts| self.oracle.distance_to_cutting(cuts, point));
        let depth = -self.oracle.signed_distance(point);
        [depth, cutting_distance, non_cutting_distance].map(|value| value * self.length)
    }

    fn deepest(&self, tolerance: f64) -> Vec<f64> {
        const SAMPLES: u32 = 256;
        let height = self.oracle.extent()[1];
        let heights = (1..SAMPLES).map(|k| height * f64::from(k) / f64::from(SAMPLES));
        let samples: Vec<(f64, [f64; 3])> =
            heights.map(|z| (z, self.depth_and_distances([0.0, 0.0, z]))).collect();
        let deepest = |owns: fn(&[f64; 3]) -> bool, min_depth: f64| {
            let owned = samples.iter().filter(|(_, sample)| sample[0] > min_depth && owns(sample));
            owned.max_by(|a, b| a.1[0].total_cmp(&b.1[0])).map(|(z, _)| *z)
        };
        let deepest_heights = [
            deepest(|sample| sample[1] <= sample[2], tolerance),
            deepest(|sample| sample[2] < sample[1], 0.0),
        ];
        deepest_heights.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_tests::oracle::rng::Rng;

    /// The contact point is on the tool's surface, a point slightly above the plane is inside the tool, and no point
    /// slightly below the plane is.
    #[test]
    fn a_posture_touches_its_plane_in_one_point_without_cutting() {
        let mut rng = Rng::new(5);
        for name in ["D2Ball", "BullNose", "TaperedBall", "Flat", "Drill", "HalfInchBallCat40"] {
            let length = if name.starts_with("Half") { 25.4 } else { 1.0 };
            let model = ToolModel::new(name, length, 0.01);
            let mut count = 0;
            for _ in 0..2_000 {
                let (normal, axis) =
                    (Vector3::from(rng.direction()), Vector3::from(rng.direction()));
                for posture in model.postures(Point3::origin(), normal, axis, 1.0) {
                    count += 1;
                    let depth = |point: Vector3<f64>| {
                        let offset = (point - posture.tip.coords) / length;
                        let z = offset.dot(&axis);
                        -model.oracle.signed_distance([(offset - z * axis).norm(), 0.0, z])
                    };
                    assert!(depth(Vector3::zeros()).abs() < 1e-12, "{name} {posture:?}");
                    assert!(depth(1e-6 * normal) > 0.0, "{name} {posture:?}");
                    for _ in 0..20 {
                        let random_vector = Vector3::from(rng.direction());
                        let on_plane = 1e-3 * (random_vector - normal.dot(&random_vector) * normal);
                        assert!(depth(on_plane - 1e-9 * normal) <= 0.0, "{name} {posture:?}");
                    }
                }
            }
            assert!(count > 100, "{name}: {count}");
        }
    }
}
