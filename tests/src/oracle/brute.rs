//! Interference by evaluating the oracle at every point, one after the other.
//!
//! No tree, no filter, no lanes: a loop in f64 with compensated sums. All results are in the world frame and in the
//! part's unit. The queries of the engine agree with it and with the [closed forms][super::closed_forms], so these two
//! agree too.

use super::Oracle;
use super::triangle::{cross, dot, norm, sub};

/// The pose of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The tip, in the world.
    pub tip: [f64; 3],
    /// The tool's x, y and z axis in the world: the columns of its rotation matrix.
    pub axes: [[f64; 3]; 3],
}

impl Pose {
    /// Rotates a vector from the tool's frame to the world.
    pub fn to_world_frame(&self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| v[0] * self.axes[0][k] + v[1] * self.axes[1][k] + v[2] * self.axes[2][k])
    }
}

/// The force law of a point (`accuracy.md`, section 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// `w m (n - u)` (Ho 1999, eq. 5.1, without the factor ½).
    Thesis,
    /// `w m ∇m`, the gradient of `½ Σ w m²` with respect to the point in the world.
    Gradient,
    /// The thesis's law without points whose normal faces away (`u·n > 0`). They exert no force, but still count as
    /// contact.
    Facing,
}

/// One tool, one pose, one cloud.
#[derive(Clone, Copy)]
pub struct Query<'a> {
    /// The tool.
    pub oracle: &'a dyn Oracle,
    /// Its pose.
    pub pose: Pose,
    /// The part's unit in the tool's: 1/25.4 for a part in millimetres and a tool in inches.
    pub scale: f64,
    /// True if the magnitude is a length, to be given in the part's unit. [`Query::new`] takes it from the oracle.
    pub magnitude_is_depth: bool,
    /// The force law.
    pub law: Law,
    /// Compliance centre, in the world. [`Query::new`] takes the tip.
    pub centre: [f64; 3],
    /// The part's points.
    pub points: &'a [[f64; 3]],
    /// Their outward normals.
    pub normals: &'a [[f64; 3]],
    /// Their weights: areas, or ones for the thesis's plain sum.
    pub weights: &'a [f64],
}

/// The result of a query.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Indices of the points in the tool or on its surface, in order.
    pub contacts: Vec<usize>,
    /// Their number.
    pub count: usize,
    /// Largest depth and the index of its point; the first of several.
    pub deepest: Option<(f64, usize)>,
    /// `Σ F`, on the tool.
    pub force: [f64; 3],
    /// `Σ (p - centre) × F`, on the tool.
    pub torque: [f64; 3],
    /// `Σ w m`.
    pub integral: f64,
    /// `½ Σ w m²`.
    pub energy: f64,
    /// Smallest niceness; `None` without contact.
    pub niceness: Option<f64>,
    /// `Σ |F|` and `Σ |p - centre| |F|`, to which errors of force and torque are relative.
    pub size: [f64; 2],
}

impl<'a> Query<'a> {
    /// Creates a query with the thesis's law, one unit, and torque about the tip.
    pub fn new(
        oracle: &'a dyn Oracle,
        pose: Pose,
        points: &'a [[f64; 3]],
        normals: &'a [[f64; 3]],
        weights: &'a [f64],
    ) -> Self {
        assert!(points.len() == normals.len() && points.len() == weights.len());
        Self {
            oracle,
            pose,
            scale: 1.0,
            magnitude_is_depth: oracle.magnitude_is_depth(),
            law: Law::Thesis,
            centre: pose.tip,
            points,
            normals,
            weights,
        }
    }

    /// Returns the point in the tool's frame and unit: `scale Rᵀ (p - tip)`, subtracting first.
    pub fn to_tool_frame(&self, p: [f64; 3]) -> [f64; 3] {
        let from_tip = sub(p, self.pose.tip);
        self.pose.axes.map(|axis| self.scale * dot(axis, from_tip))
    }

    /// Evaluates the oracle at every point and adds up the results.
    pub fn answer(&self) -> Answer {
        let mut contacts = Vec::new();
        let mut deepest: Option<(f64, usize)> = None;
        let mut niceness: Option<f64> = None;
        let (mut force, mut torque) = ([Sum::default(); 3], [Sum::default(); 3]);
        let (mut integral, mut energy) = (Sum::default(), Sum::default());
        let mut size = [Sum::default(); 2];
        for (i, &p) in self.points.iter().enumerate() {
            let q = self.to_tool_frame(p);
            let Some(s) = self.oracle.evaluate(q) else {
                continue;
            };
            contacts.push(i);
            let depth = s.depth / self.scale;
            if deepest.is_none_or(|(d, _)| depth > d) {
                deepest = Some((depth, i));
            }
            niceness = Some(niceness.map_or(s.niceness, |n| n.min(s.niceness)));

            // The gradient of a magnitude in the tool's unit, taken over the part's, is `scale` times as steep.
            let (m, steep) = if self.magnitude_is_depth {
                (s.magnitude / self.scale, 1.0)
            } else {
                (s.magnitude, self.scale)
            };
            let w = self.weights[i];
            integral.add(w * m);
            energy.add(0.5 * w * m * m);

            let (n, u) = (self.normals[i], self.pose.to_world_frame(s.direction));
            let push = match self.law {
                Law::Facing if dot(u, n) > 0.0 => continue,
                Law::Thesis | Law::Facing => sub(n, u),
                Law::Gradient => {
                    let gradient = self.oracle.gradient(q).unwrap_or_default();
                    self.pose.to_world_frame(gradient).map(|c| steep * c)
                }
            };
            let f = push.map(|c| w * m * c);
            let arm = sub(p, self.centre);
            let t = cross(arm, f);
            for k in 0..3 {
                force[k].add(f[k]);
                torque[k].add(t[k]);
            }
            size[0].add(norm(f));
            size[1].add(norm(arm) * norm(f));
        }
        Answer {
            count: contacts.len(),
            contacts,
            deepest,
            force: force.map(|s| s.value()),
            torque: torque.map(|s| s.value()),
            integral: integral.value(),
            energy: energy.value(),
            niceness,
            size: size.map(|s| s.value()),
        }
    }
}

/// A compensated sum (Neumaier 1974): its error does not grow with the number of terms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    /// Adds a term.
    pub fn add(&mut self, x: f64) {
        let next = self.sum + x;
        self.lost +=
            if self.sum.abs() >= x.abs() { (self.sum - next) + x } else { (x - next) + self.sum };
        self.sum = next;
    }

    /// Returns the sum so far.
    pub fn value(&self) -> f64 {
        self.sum + self.lost
    }
}

impl FromIterator<f64> for Sum {
    fn from_iter<T: IntoIterator<Item = f64>>(terms: T) -> Self {
        let mut sum = Self::default();
        for x in terms {
            sum.add(x);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::Nearest;
    use super::*;

    #[test]
    fn without_contacts_the_wrench_is_zero() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let pose = Pose { tip: [0.0, 0.0, 9.0], axes };
        let sphere = Nearest::of("UnitSphere");
        let a = Query::new(&sphere, pose, &[[0.0; 3]], &[[0.0, 0.0, 1.0]], &[1.0]).answer();
        assert_eq!((a.count, a.deepest, a.niceness, a.force), (0, None, None, [0.0; 3]));
    }

    #[test]
    fn sums_keep_what_plain_addition_loses() {
        let sum: Sum = [1.0, 1e100, 1.0, -1e100].into_iter().collect();
        assert_eq!(sum.value(), 2.0);
    }
}
