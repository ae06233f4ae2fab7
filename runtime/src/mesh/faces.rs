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
/// `None` if there is no ear: the polygon crosses itself, seen along its area vector. Takes a time of the square of the number of
/// corners, for a corner that is no ear rarely becomes one before a corner beside it is cut off.
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
    // The corners that are left, as a ring.
    let count = corners.len();
    let mut next: Vec<usize> = (1..count).chain([0]).collect();
    let mut previous: Vec<usize> = [count - 1].into_iter().chain(0..count - 1).collect();
    let is_ear = |next: &[usize], [a, b, c]: [usize; 3]| {
        let is_inside = |p: usize| {
            [a, b, c].iter().all(|corner| flat[*corner] != flat[p])
                && [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|turn| side(turn) >= 0.0)
        };
        let mut others = std::iter::successors(Some(next[c]), |p| Some(next[*p]));
        side([a, b, c]) > 0.0 && !others.by_ref().take_while(|p| *p != a).any(is_inside)
    };
    let mut is_none = vec![false; count];
    let mut ears = Vec::with_capacity(count - 2);
    // The corner to look at, and the number of those since the last ear, none of which is one.
    let (mut corner, mut passed, mut is_second_round) = (0, 0, false);
    while ears.len() < count - 3 {
        let ear = [previous[corner], corner, next[corner]];
        let [a, _, c] = ear;
        if !is_none[corner] {
            cancellation::check();
            if is_ear(&next, ear) {
                ears.push(ear.map(|corner| corners[corner]));
                (next[a], previous[c]) = (c, a);
                (is_none[a], is_none[c]) = (false, false);
                (corner, passed, is_second_round) = (c, 0, false);
                continue;
            }
            is_none[corner] = true;
        }
        (corner, passed) = (c, passed + 1);
        if passed == count - ears.len() {
            if is_second_round {
                return None;
            }
            // A corner that touched the triangle of another may be cut off.
            is_none.fill(false);
            (passed, is_second_round) = (0, true);
        }
    }
    ears.push([previous[corner], corner, next[corner]].map(|corner| corners[corner]));
    Some(ears)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A band that winds about a point: a search that begins at its first corner for each ear takes minutes.
    #[test]
    fn a_spiral_of_many_corners_is_cut() {
        let turn = |k: u32, width: f64| {
            let angle = f64::from(k) * 0.1;
            let radius = 1.0 + 0.1 * angle + width;
            Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let half = 1000;
        let outer = (0..half).map(|k| turn(k, 0.2));
        let vertices: Vec<_> = outer.chain((0..half).rev().map(|k| turn(k, 0.0))).collect();
        let corners: Vec<u32> = (0..2 * half).collect();
        let ears = ears(&corners, &vertices).expect("ears");
        assert!(ears.len() == corners.len() - 2 && is_filled(&ears, &vertices));
    }
}
