//! Postures of a tool at a triangle, derived from the tool's restatement alone.

use nalgebra::{Point3, Vector3};
use touchoff_tests::oracle::restated;
use touchoff_tests::oracle::{Nearest, Oracle};

type P2 = [f64; 2];

/// A line or an arc of the outline, with lengths in the tool's unit.
struct Segment {
    from: P2,
    to: P2,
    centre: Option<P2>,
    is_cutting: bool,
}

/// A tool whose postures are derived.
pub(super) struct ToolModel {
    segments: Vec<Segment>,
    /// The oracle for its depths.
    pub(super) oracle: Nearest,
    /// The names of its surfaces, and whether each cuts.
    pub(super) surfaces: Vec<(&'static str, bool)>,
    /// The tool's unit of length, in the part's unit.
    pub(super) length: f64,
    /// Up to two heights on the axis, in the tool's unit: the deepest point owned by a cutting surface, if deeper than
    /// the tolerance, and the deepest point owned by another surface.
    pub(super) core_heights: Vec<f64>,
}

/// A posture of a tool.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posture {
    /// The tip, in the part's unit.
    pub(super) tip: Point3<f64>,
    /// The axis, from the tip to the spindle.
    pub(super) axis: Vector3<f64>,
    /// The quality of the contact.
    pub(super) niceness: f64,
}

/// A sine, or a share of the tool's size, that counts as rounding.
const ROUNDING: f64 = 1e-9;

fn subtract(a: P2, b: P2) -> P2 {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: P2, b: P2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: P2, b: P2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn unit(a: P2) -> P2 {
    let size = a[0].hypot(a[1]);
    a.map(|component| component / size)
}

impl Segment {
    /// Returns the tangent of the outline at a point of the piece. The material is on the left.
    fn tangent(&self, point: P2) -> P2 {
        let Some(centre) = self.centre else { return unit(subtract(self.to, self.from)) };
        let [d, z] = unit(subtract(point, centre));
        if self.is_convex() { [-z, d] } else { [z, -d] }
    }

    /// Returns whether the piece is an arc whose material is around its centre.
    fn is_convex(&self) -> bool {
        let is_left_turn =
            |centre| cross(subtract(self.from, centre), subtract(self.to, centre)) > 0.0;
        self.centre.is_some_and(is_left_turn)
    }
}

impl ToolModel {
    /// Derives a tool from its restatement. `length` is the tool's unit of length in the part's unit. `tolerance` is
    /// the allowed depth of cutting surfaces, in the part's unit.
    ///
    /// # Errors
    /// If the tool has no restatement.
    pub(super) fn new(name: &str, length: f64, tolerance: f64) -> Result<ToolModel, String> {
        let tool = restated::of(name).ok_or_else(|| format!("`{name}` is not restated"))?;
        let point = |[d, z]: &restated::Point| [d.to_f64(), z.to_f64()];
        let mut from = point(&tool.start);
        let mut segments = Vec::new();
        let mut surfaces: Vec<(&'static str, bool)> = Vec::new();
        for segment in &tool.segments {
            let (to, centre) = (point(&segment.to), segment.centre.as_ref().map(point));
            let is_cutting = tool.cutting.contains(&segment.surface);
            segments.push(Segment { from, to, centre, is_cutting });
            if surfaces.iter().all(|(name, _)| *name != segment.surface) {
                surfaces.push((segment.surface, is_cutting));
            }
            from = to;
        }
        let oracle = Nearest::new(&tool);
        let mut model = ToolModel { segments, oracle, surfaces, length, core_heights: Vec::new() };
        model.core_heights = model.deepest(tolerance);
        Ok(model)
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
        let direction: P2 = [radial_length, axial];
        let size = self.oracle.extent()[0].max(self.oracle.extent()[1]);
        // The contact point, and a point slightly inside the piece that touches there.
        let small_step = ROUNDING * size;
        let slightly_inside = |corner: P2, backward: P2, segment: P2| {
            [
                corner[0] + small_step * (backward[0] - 0.02 * segment[1]),
                corner[1] + small_step * (backward[1] + 0.02 * segment[0]),
            ]
        };
        let mut contacts: Vec<(P2, [P2; 2])> = Vec::new();
        for (k, segment) in
            self.segments.iter().enumerate().filter(|(_, segment)| segment.is_cutting)
        {
            if let Some(centre) = segment.centre
                && segment.is_convex()
            {
                let radius = subtract(segment.from, centre);
                let radius = radius[0].hypot(radius[1]);
                let arms = [segment.from, segment.to].map(|end| unit(subtract(end, centre)));
                if cross(arms[0], direction) >= -factor * ROUNDING
                    && cross(direction, arms[1]) >= -factor * ROUNDING
                {
                    let at_radius = |radius: f64| [0, 1].map(|k| centre[k] + radius * direction[k]);
                    contacts.push((at_radius(radius), [at_radius(radius - small_step); 2]));
                }
            }
            // The corner before the piece. On the axis, the outline continues as its mirror image.
            let after = segment.tangent(segment.from);
            let before = match k.checked_sub(1) {
                Some(k) if self.segments[k].is_cutting => self.segments[k].tangent(segment.from),
                Some(_) => continue,
                None => [after[0], -after[1]],
            };
            let is_convex_corner = cross(before, after) > ROUNDING;
            let is_extreme = dot(before, direction) >= -factor * ROUNDING
                && dot(after, direction) <= factor * ROUNDING;
            if is_convex_corner && is_extreme {
                let backward = before.map(|component| -component);
                let inner_points = [
                    slightly_inside(segment.from, backward, before),
                    slightly_inside(segment.from, after, after),
                ];
                contacts.push((segment.from, inner_points));
            }
        }
        let posture = |([d, z], inner_points): (P2, [P2; 2])| {
            // If the tool's axis is parallel to the normal, the contact is a ring without a distinguished point.
            if radial_length < ROUNDING && d > ROUNDING * size {
                return None;
            }
            let radial =
                if radial_length > 0.0 { radial_vector / radial_length } else { Vector3::zeros() };
            let niceness_at = |[d, z]: P2| {
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
        let distance_to = |is_cutting: bool| {
            let surfaces = self.surfaces.iter().filter(|(_, cutting)| *cutting == is_cutting);
            surfaces
                .map(|(name, _)| self.oracle.distance_to_surface(name, point))
                .fold(f64::INFINITY, f64::min)
        };
        let (cutting_distance, non_cutting_distance) = (distance_to(true), distance_to(false));
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
            let model = ToolModel::new(name, length, 0.01).expect("a restated tool");
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
