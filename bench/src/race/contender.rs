//! The interface and the arithmetic that all competing methods share.

use nalgebra::{Matrix3, Vector3};
use touchoff::Pose;

/// A method that answers queries at successive poses.
pub trait Contender {
    /// Returns the method's name in the table.
    fn name(&self) -> &'static str;

    /// Evaluates the contact of tool and part at a pose.
    fn query(&mut self, pose: &Pose) -> Answer;
}

/// The answer of a method. Force and torque about the tip act on the tool, in the world frame. The force is by the law
/// `Σ w m (n − u)`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Answer {
    /// Number of points inside. Methods without points give 1 if there is contact, else 0.
    pub colliding: usize,
    /// The greatest depth; 0 without contact.
    pub depth: f64,
    /// Force and torque, if the method computes them.
    pub wrench: Option<[Vector3<f64>; 2]>,
}

/// A pose, stored as three rows that turn vectors from the world frame into the tool's frame.
pub struct PoseTransform {
    /// The tip, in the world frame.
    pub tip: [f64; 3],
    rows: [[f64; 3]; 3],
}

impl PoseTransform {
    /// Converts a pose.
    pub fn of(pose: &Pose) -> PoseTransform {
        let column = |axis: usize| pose.rotation().column(axis).into_owned().into();
        PoseTransform { tip: pose.tip().coords.into(), rows: [column(0), column(1), column(2)] }
    }

    /// Returns the vector from the tip to a point, in the world frame.
    #[inline]
    pub fn offset_from_tip(&self, p: [f64; 3]) -> [f64; 3] {
        [p[0] - self.tip[0], p[1] - self.tip[1], p[2] - self.tip[2]]
    }

    /// Returns a vector of the world frame in the tool's frame.
    #[inline]
    pub fn to_tool_frame(&self, v: [f64; 3]) -> [f64; 3] {
        [dot(self.rows[0], v), dot(self.rows[1], v), dot(self.rows[2], v)]
    }

    /// Returns the half extents along the tool's axes of a box with these half extents along the world's axes.
    #[inline]
    pub fn box_half_extents(&self, half: [f64; 3]) -> [f64; 3] {
        let extent = |row: [f64; 3]| dot([row[0].abs(), row[1].abs(), row[2].abs()], half);
        [extent(self.rows[0]), extent(self.rows[1]), extent(self.rows[2])]
    }

    /// Returns the rows in single precision.
    pub fn rows_f32(&self) -> [[f32; 3]; 3] {
        self.rows.map(|row| row.map(|c| c as f32))
    }

    /// Returns a vector of the tool's frame in the world frame.
    pub fn to_world_frame(&self, v: Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = self.rows.map(Vector3::from);
        Matrix3::from_columns(&[x, y, z]) * v
    }
}

/// The sums over a contact. The tool's directions and the part's normals are summed separately, each in its own frame,
/// so that no vector is rotated per point.
#[derive(Default)]
pub struct Sums {
    colliding: usize,
    depth: f64,
    /// Force and torque from the tool's directions, in the tool's frame, and from the normals, in the world frame.
    tool: [Vector3<f64>; 2],
    part: [Vector3<f64>; 2],
}

impl Sums {
    /// Adds a point inside. `offset` and `p` are its vectors from the tip in the world frame and in the tool's frame.
    /// The pairs are its weight and normal in the world frame, and its magnitude and direction in the tool's frame.
    #[inline]
    pub fn add(
        &mut self,
        [offset, p]: [[f64; 3]; 2],
        (weight, normal): (f64, [f64; 3]),
        (magnitude, direction): (f64, [f64; 3]),
    ) {
        self.colliding += 1;
        self.depth = self.depth.max(magnitude);
        let force_scale = weight * magnitude;
        let (normal_force, direction_force) =
            (force_scale * Vector3::from(normal), force_scale * Vector3::from(direction));
        self.part[0] += normal_force;
        self.part[1] += Vector3::from(offset).cross(&normal_force);
        self.tool[0] -= direction_force;
        self.tool[1] -= Vector3::from(p).cross(&direction_force);
    }

    /// Returns the answer, with both sums in the world frame.
    pub fn answer(&self, transform: &PoseTransform) -> Answer {
        let sum = |index: usize| transform.to_world_frame(self.tool[index]) + self.part[index];
        Answer { colliding: self.colliding, depth: self.depth, wrench: Some([sum(0), sum(1)]) }
    }
}

/// Returns the scalar product.
#[inline]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
