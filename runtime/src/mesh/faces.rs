//! The faces of a file: their triangles, and whether the fan of a polygon's triangles fills it.

use crate::mesh::location::SourceLocation;
use crate::mesh::outlier::{Outlier, OutlyingVertex, find_outlier};
use crate::mesh::{Mesh, MeshError, weld};
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Largest fraction of a polygon's area that triangles of its fan may have with the opposite
/// orientation. It only covers the rounding at corners that are nearly in line.
const MAX_FOLDED_AREA_FRACTION: f64 = 1e-3;

/// The triangles of a file's faces, in the file's order. A polygon becomes a fan about its first corner.
#[derive(Default)]
pub(super) struct Faces {
    triangles: Vec<[u32; 3]>,
    /// The location and the range of triangles of each face with more than three corners.
    polygons: Vec<(SourceLocation, Range<usize>)>,
}

impl Faces {
    /// Adds a face of three or more corners.
    pub(super) fn push(&mut self, location: SourceLocation, corners: &[u32]) {
        let start = self.triangles.len();
        if let [first, rest @ ..] = corners {
            self.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        }
        if corners.len() > 3 {
            self.polygons.push((location, start..self.triangles.len()));
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Finds the first vertex that a face uses and that is far outside the others. Returns its index in the file.
    pub(super) fn outlier(&self, vertices: &[Point3<f64>]) -> Option<(usize, Outlier)> {
        let mut is_used = vec![false; vertices.len()];
        self.triangles.as_flattened().iter().for_each(|vertex| is_used[*vertex as usize] = true);
        let used: Vec<usize> = (0..vertices.len()).filter(|vertex| is_used[*vertex]).collect();
        let positions: Vec<Point3<f64>> = used.iter().map(|vertex| vertices[*vertex]).collect();
        let OutlyingVertex { index, outlier, .. } = find_outlier(&positions)?;
        Some((used[index], outlier))
    }

    /// Returns the location of the first polygon that its fan does not fill, because some of its
    /// triangles face the other way. Every index must be in range.
    pub(super) fn folded(&self, vertices: &[Point3<f64>]) -> Option<SourceLocation> {
        let folded = self.polygons.iter().find(|(_, range)| {
            let fan = self.triangles[range.clone()].iter().map(|triangle| {
                let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
                (b - a).cross(&(c - a))
            });
            // Twice the area vector of the polygon, whatever the corner of the fan. The triangles of a fan that fills the
            // polygon all point its way.
            let sum: Vector3<f64> = fan.clone().sum();
            let opposed = fan.filter(|area_vector| area_vector.dot(&sum) <= 0.0);
            opposed.map(|area_vector| area_vector.norm()).sum::<f64>()
                > MAX_FOLDED_AREA_FRACTION * sum.norm()
        });
        folded.map(|(location, _)| *location)
    }

    /// Builds the mesh. Corners with equal coordinates become one vertex, whatever their indices. Every
    /// index must be in range.
    pub(super) fn weld(&self, vertices: &[Point3<f64>], unit: Unit) -> Result<Mesh, MeshError> {
        let triangles = self.triangles.iter();
        let corners: Vec<[Point3<f64>; 3]> =
            triangles.map(|triangle| triangle.map(|vertex| vertices[vertex as usize])).collect();
        weld(&corners, unit)
    }
}
