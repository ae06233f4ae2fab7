//! What every method has in common: it is asked at a pose and answers.

use nalgebra::{Matrix3, Vector3};
use touchoff::Pose;

/// A method, ready to be asked at one pose after another.
pub trait Contender {
    /// The word for it, as in the table.
    fn name(&self) -> &'static str;

    /// What the tool feels at a pose.
    fn query(&mut self, pose: &Pose) -> Answer;
}

/// What a method found. Force and torque about the tip are on the tool, in the world's frame, by
/// the law `Σ w m (n − u)`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Answer {
    /// How many points are inside; of methods without points, whether anything is.
    pub colliding: usize,
    /// How deep the deepest is; 0 without contact.
    pub depth: f64,
    /// Force and torque, if the method has any.
    pub wrench: Option<[Vector3<f64>; 2]>,
}

/// A pose as three rows that turn the world's vectors into the tool's frame.
pub struct View {
    /// Where the tip is, in the world.
    pub tip: [f64; 3],
    rows: [[f64; 3]; 3],
}

impl View {
    /// From a pose.
    pub fn of(pose: &Pose) -> View {
        let column = |axis: usize| pose.rotation().column(axis).into_owned().into();
        View { tip: pose.tip().coords.into(), rows: [column(0), column(1), column(2)] }
    }

    /// A point of the world from the tip, still in the world's directions.
    #[inline]
    pub fn arm(&self, p: [f64; 3]) -> [f64; 3] {
        [p[0] - self.tip[0], p[1] - self.tip[1], p[2] - self.tip[2]]
    }

    /// A vector of the world in the tool's frame.
    #[inline]
    pub fn turn(&self, v: [f64; 3]) -> [f64; 3] {
        [dot(self.rows[0], v), dot(self.rows[1], v), dot(self.rows[2], v)]
    }

    /// How far a box with these half extents reaches along the tool's axes.
    #[inline]
    pub fn reach(&self, half: [f64; 3]) -> [f64; 3] {
        let along = |row: [f64; 3]| dot([row[0].abs(), row[1].abs(), row[2].abs()], half);
        [along(self.rows[0]), along(self.rows[1]), along(self.rows[2])]
    }

    /// The rows in single precision.
    pub fn single(&self) -> [[f32; 3]; 3] {
        self.rows.map(|row| row.map(|c| c as f32))
    }

    /// From the tool's frame to the world's.
    pub fn back(&self, v: Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = self.rows.map(Vector3::from);
        Matrix3::from_columns(&[x, y, z]) * v
    }
}

/// The sums of a contact. The tool's directions and the part's normals are summed apart, each in
/// its own frame, so that nothing is turned point by point.
#[derive(Default)]
pub struct Sums {
    colliding: usize,
    depth: f64,
    /// Force and torque in the tool's frame, and in the world's.
    tool: [Vector3<f64>; 2],
    part: [Vector3<f64>; 2],
}

impl Sums {
    /// A point inside: where it is from the tip in the world's directions and in the tool's frame,
    /// its weight and normal, its magnitude and direction.
    #[inline]
    pub fn add(
        &mut self,
        [arm, p]: [[f64; 3]; 2],
        (weight, normal): (f64, [f64; 3]),
        (magnitude, direction): (f64, [f64; 3]),
    ) {
        self.colliding += 1;
        self.depth = self.depth.max(magnitude);
        let push = weight * magnitude;
        let (pushed, pulled) = (push * Vector3::from(normal), push * Vector3::from(direction));
        self.part[0] += pushed;
        self.part[1] += Vector3::from(arm).cross(&pushed);
        self.tool[0] -= pulled;
        self.tool[1] -= Vector3::from(p).cross(&pulled);
    }

    /// What they come to.
    pub fn answer(&self, view: &View) -> Answer {
        let sum = |at: usize| view.back(self.tool[at]) + self.part[at];
        Answer { colliding: self.colliding, depth: self.depth, wrench: Some([sum(0), sum(1)]) }
    }
}

/// The scalar product.
#[inline]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
