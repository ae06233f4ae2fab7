//! Points and vectors in space with 256 bits, and the frame of a tool at a pose.
//!
//! The doubles of parts and poses are exact numbers.

use super::big::Big;
use super::vector::{dot, norm, sub, vector_product};
use nalgebra::{Matrix3, Point3};

/// A point or vector in space.
pub type Triple = [Big; 3];

/// Returns a vector of doubles exactly.
pub fn exactly(v: impl Into<[f64; 3]>) -> Triple {
    v.into().map(Big::exactly)
}

/// Returns the nearest doubles.
pub fn to_f64([x, y, z]: &Triple) -> [f64; 3] {
    [x.to_f64(), y.to_f64(), z.to_f64()]
}

/// Returns the distance between a vector and one of doubles.
pub fn distance(a: &Triple, b: impl Into<[f64; 3]>) -> f64 {
    norm(&sub(a, &exactly(b))).to_f64()
}

/// A tool's frame in the world: the map `p = R q + tip`, whose inverse needs no `R` that is exactly a rotation.
pub struct Frame {
    tip: Triple,
    /// The rows of the inverse of `R`.
    rows: [Triple; 3],
}

impl Frame {
    /// Creates the frame of a pose, given by its rotation and its tip.
    pub fn new(rotation: &Matrix3<f64>, tip: Point3<f64>) -> Frame {
        let [x, y, z] = [0, 1, 2].map(|k| exactly(rotation.column(k).into_owned()));
        let rows = [vector_product(&y, &z), vector_product(&z, &x), vector_product(&x, &y)];
        let determinant = dot(&rows[0], &x);
        Frame {
            tip: exactly(tip),
            rows: rows.map(|row| row.map(|component| &component / &determinant)),
        }
    }

    /// Returns a point of the world in the frame.
    pub fn to_tool(&self, point: &Triple) -> Triple {
        let from_tip = sub(point, &self.tip);
        self.rows.each_ref().map(|row| dot(row, &from_tip))
    }
}
