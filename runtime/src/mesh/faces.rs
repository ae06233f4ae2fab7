//! The faces of a file: their triangles, and those of polygons.

use crate::cancellation;
use crate::mesh::location::SourceLocation;
use crate::mesh::outlier::{Outlier, OutlyingVertex, find_outlier};
use crate::mesh::{Mesh, MeshError, weld};
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Largest fraction of a polygon's area that triangles of its fan may have with the opposite
/// orientation. It only covers the rounding at corners that are nearly in line.
const MAX_FOLDED_AREA_FRACTION: f64 = 1e-3;

/// The triangles of a file's faces, in the file's order. A polygon becomes a fan about its first corner, or is cut at its ears.
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

    /// Cuts polygons at their ears that their fan does not fill. Returns the location of the first polygon that neither fills.
    /// Every index must be in range.
    pub(super) fn fill(&mut self, vertices: &[Point3<f64>]) -> Option<SourceLocation> {
        for (location, range) in &self.polygons {
            let triangles = &mut self.triangles[range.clone()];
            if is_filled(triangles, vertices) {
                continue;
            }
            let first = triangles[0][0];
            let corners: Vec<u32> = [first, triangles[0][1]]
                .into_iter()
                .chain(triangles.iter().map(|t| t[2]))
                .collect();
            match ears(&corners, vertices).filter(|ears| is_filled(ears, vertices)) {
                Some(ears) => triangles.copy_from_slice(&ears),
                None => return Some(*location),
            }
        }
        None
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

/// Returns whether triangles fill the polygon around them: none faces the other way. Then their areas add up to the polygon's, and
/// none covers another.
fn is_filled(triangles: &[[u32; 3]], vertices: &[Point3<f64>]) -> bool {
    let areas = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
        (b - a).cross(&(c - a))
    });
    // Twice the area vector of the polygon, however it is cut.
    let sum: Vector3<f64> = areas.clone().sum();
    let opposed = areas.filter(|area_vector| area_vector.dot(&sum) <= 0.0);
    opposed.map(|area_vector| area_vector.norm()).sum::<f64>()
        <= MAX_FOLDED_AREA_FRACTION * sum.norm()
}

/// Cuts a polygon into triangles, each an ear of what is left: its corner is convex, and no other corner lies in it (Meisters 1975).
/// `None` if there is no ear: the polygon crosses itself, seen along its area vector.
fn ears(corners: &[u32], vertices: &[Point3<f64>]) -> Option<Vec<[u32; 3]>> {
    let first = vertices[corners[0] as usize];
    let arms: Vec<Vector3<f64>> =
        corners.iter().map(|corner| vertices[*corner as usize] - first).collect();
    let normal: Vector3<f64> = arms.windows(2).map(|pair| pair[0].cross(&pair[1])).sum();
    let (drop, up) = (normal.iamax(), normal[normal.iamax()].signum());
    let flat: Vec<[f64; 2]> =
        arms.iter().map(|arm| [up * arm[(drop + 1) % 3], arm[(drop + 2) % 3]]).collect();
    let side = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [flat[a], flat[b], flat[c]];
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut ears = Vec::with_capacity(corners.len() - 2);
    while left.len() > 3 {
        cancellation::check();
        let count = left.len();
        let ear = (0..count).find(|k| {
            let [a, b, c] = [left[(k + count - 1) % count], left[*k], left[(k + 1) % count]];
            let is_inside = |p: usize| {
                [a, b, c].iter().all(|corner| flat[*corner] != flat[p])
                    && [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|turn| side(turn) >= 0.0)
            };
            side([a, b, c]) > 0.0 && !left.iter().any(|p| is_inside(*p))
        })?;
        let [a, c] = [left[(ear + count - 1) % count], left[(ear + 1) % count]];
        ears.push([a, left.remove(ear), c].map(|corner| corners[corner]));
    }
    ears.push([left[0], left[1], left[2]].map(|corner| corners[corner]));
    Some(ears)
}
