//! Interference by evaluating the oracle at every point, one after the other.
//!
//! No tree, no filter, no lanes: a loop in f64 with compensated sums. All results are in the world frame and in the
//! part's unit.

use crate::prelude::*;
use touchoff_tests::oracle::sum::Sum;

/// One tool, one pose, one cloud.
pub(super) struct Query<'a> {
    pub(super) oracle: &'a dyn Oracle,
    pub(super) pose: Pose,
    /// The part's unit in the tool's: 1/25.4 for a part in millimetres and a tool in inches.
    pub(super) scale: f64,
    pub(super) law: Law,
    /// The compliance centre, in the world.
    pub(super) centre: Point3<f64>,
    pub(super) points: &'a [Point3<f64>],
    pub(super) normals: &'a [Vector3<f64>],
    /// Areas, or ones for the thesis's plain sum.
    pub(super) weights: &'a [f64],
}

/// The result of a query.
pub(super) struct Answer {
    /// Indices of the points in the tool or on its surface, in order.
    pub(super) contacts: Vec<usize>,
    /// The largest depth; 0 without contact.
    pub(super) depth: f64,
    /// `Σ F`, on the tool.
    pub(super) force: Vector3<f64>,
    /// `Σ (p - centre) × F`, on the tool.
    pub(super) torque: Vector3<f64>,
    /// `Σ w m`.
    pub(super) integral: f64,
    /// `½ Σ w m²`.
    pub(super) energy: f64,
    /// The smallest niceness; `None` without contact.
    pub(super) niceness: Option<f64>,
}

impl Query<'_> {
    /// Returns the point in the tool's frame and unit: `scale Rᵀ (p - tip)`, subtracting first.
    pub(super) fn to_tool_frame(&self, p: Point3<f64>) -> [f64; 3] {
        (self.scale * (self.pose.rotation().transpose() * (p - self.pose.tip()))).into()
    }

    /// Rotates a vector from the tool's frame to the world.
    pub(super) fn to_world_frame(&self, v: [f64; 3]) -> Vector3<f64> {
        self.pose.rotation() * Vector3::from(v)
    }

    /// Evaluates the oracle at every point and adds up the results. The force of a point is
    /// - by the thesis's law `w m (n - u)` (Ho 1999, eq. 5.1, without the factor ½);
    /// - by the gradient law `w m ∇m`, the gradient of `½ Σ w m²` over the point in the world;
    /// - by the facing law that of the thesis, or none if the point's normal faces away (`u·n > 0`). The point still counts as
    ///   contact.
    pub(super) fn answer(&self) -> Answer {
        let mut contacts = Vec::new();
        let (mut depth, mut niceness) = (0.0, None::<f64>);
        let (mut force, mut torque) = ([Sum::default(); 3], [Sum::default(); 3]);
        let (mut integral, mut energy) = (Sum::default(), Sum::default());
        for (i, p) in self.points.iter().enumerate() {
            let q = self.to_tool_frame(*p);
            let Some(s) = self.oracle.evaluate(q) else { continue };
            contacts.push(i);
            depth = f64::max(depth, s.depth / self.scale);
            niceness = Some(niceness.map_or(s.niceness, |least| least.min(s.niceness)));

            // The gradient of a magnitude in the tool's unit, taken over the part's, is `scale` times as steep.
            let (m, steep) = if self.oracle.magnitude_is_depth() {
                (s.magnitude / self.scale, 1.0)
            } else {
                (s.magnitude, self.scale)
            };
            let w = self.weights[i];
            integral.add(w * m);
            energy.add(0.5 * w * m * m);

            let (n, u) = (self.normals[i], self.to_world_frame(s.direction));
            let push = match self.law {
                Law::Facing if u.dot(&n) > 0.0 => continue,
                Law::Thesis | Law::Facing => n - u,
                Law::Gradient => {
                    steep * self.to_world_frame(self.oracle.gradient(q).expect("it is inside"))
                }
            };
            let f = w * m * push;
            let t = (p - self.centre).cross(&f);
            for k in 0..3 {
                force[k].add(f[k]);
                torque[k].add(t[k]);
            }
        }
        let vector = |sums: [Sum; 3]| Vector3::from(sums.map(|sum| sum.value()));
        Answer {
            contacts,
            depth,
            force: vector(force),
            torque: vector(torque),
            integral: integral.value(),
            energy: energy.value(),
            niceness,
        }
    }
}
