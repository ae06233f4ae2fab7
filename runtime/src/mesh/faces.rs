//! Triangulation of polygonal faces.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::location::SourceLocation;
use super::{Mesh, MeshError, weld};
use crate::unit::Unit;

/// Largest fraction of a polygon's area that triangles of its fan may have with the opposite
/// orientation. It covers the rounding at corners that are nearly in line, and no more.
const FOLD: f64 = 1e-3;

/// The triangles of a file's faces, in the file's order. A polygon becomes a fan about its first corner.
#[derive(Default)]
pub(super) struct Faces {
    triangles: Vec<[u32; 3]>,
    /// The location and the range of triangles of each face with more than three corners.
    polygons: Vec<(SourceLocation, Range<usize>)>,
}

impl Faces {
    /// Adds a face of three or more corners.
    pub(super) fn push(&mut self, place: SourceLocation, corners: &[u32]) {
        let start = self.triangles.len();
        if let [first, others @ ..] = corners {
            self.triangles.extend(others.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        }
        if corners.len() > 3 {
            self.polygons.push((place, start..self.triangles.len()));
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Returns the ascending indices of the vertices that faces use, and their positions.
    pub(super) fn used(&self, vertices: &[Point3<f64>]) -> (Vec<usize>, Vec<Point3<f64>>) {
        let mut is_used = vec![false; vertices.len()];
        self.triangles.as_flattened().iter().for_each(|vertex| is_used[*vertex as usize] = true);
        let used: Vec<usize> = (0..vertices.len()).filter(|vertex| is_used[*vertex]).collect();
        let places = used.iter().map(|vertex| vertices[*vertex]).collect();
        (used, places)
    }

    /// Returns the location of the first polygon that its fan does not fill, because some of its
    /// triangles face the other way. Every index must be in range.
    pub(super) fn folded(&self, vertices: &[Point3<f64>]) -> Option<SourceLocation> {
        let folds = |triangles: &[[u32; 3]]| {
            let area = |triangle: &[u32; 3]| {
                let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
                (b - a).cross(&(c - a))
            };
            let sum: Vector3<f64> = triangles.iter().map(area).sum();
            let against = triangles.iter().map(area).filter(|area| area.dot(&sum) <= 0.0);
            against.map(|area| area.norm()).sum::<f64>() > FOLD * sum.norm()
        };
        let mut polygons = self.polygons.iter();
        let folded = polygons.find(|(_, range)| folds(&self.triangles[range.clone()]));
        folded.map(|(place, _)| *place)
    }

    /// Builds the mesh. Corners with equal coordinates become one vertex, whatever their indices. Every
    /// index must be in range.
    pub(super) fn weld(&self, vertices: &[Point3<f64>], unit: Unit) -> Result<Mesh, MeshError> {
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| vertices[vertex as usize]);
        weld(&self.triangles.iter().map(corners).collect::<Vec<_>>(), unit)
    }
}
