//! Triangulation of polygonal faces.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::location::SourceLocation;
use super::{Mesh, MeshError, weld};
use crate::unit::Unit;

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

    /// Returns the ascending indices of the vertices that faces use, and their positions.
    pub(super) fn used_vertices(&self, vertices: &[Point3<f64>]) -> (Vec<usize>, Vec<Point3<f64>>) {
        let mut is_used = vec![false; vertices.len()];
        self.triangles.as_flattened().iter().for_each(|vertex| is_used[*vertex as usize] = true);
        let used: Vec<usize> = (0..vertices.len()).filter(|vertex| is_used[*vertex]).collect();
        let positions = used.iter().map(|vertex| vertices[*vertex]).collect();
        (used, positions)
    }

    /// Returns the location of the first polygon that its fan does not fill, because some of its
    /// triangles face the other way. Every index must be in range.
    pub(super) fn folded(&self, vertices: &[Point3<f64>]) -> Option<SourceLocation> {
        let is_folded = |triangles: &[[u32; 3]]| {
            let area_vector = |triangle: &[u32; 3]| {
                let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
                (b - a).cross(&(c - a))
            };
            let sum: Vector3<f64> = triangles.iter().map(area_vector).sum();
            let opposed = triangles
                .iter()
                .map(area_vector)
                .filter(|area_vector| area_vector.dot(&sum) <= 0.0);
            opposed.map(|area_vector| area_vector.norm()).sum::<f64>()
                > MAX_FOLDED_AREA_FRACTION * sum.norm()
        };
        let mut polygons = self.polygons.iter();
        let folded = polygons.find(|(_, range)| is_folded(&self.triangles[range.clone()]));
        folded.map(|(location, _)| *location)
    }

    /// Builds the mesh. Corners with equal coordinates become one vertex, whatever their indices. Every
    /// index must be in range.
    pub(super) fn weld(&self, vertices: &[Point3<f64>], unit: Unit) -> Result<Mesh, MeshError> {
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| vertices[vertex as usize]);
        weld(&self.triangles.iter().map(corners).collect::<Vec<_>>(), unit)
    }
}
