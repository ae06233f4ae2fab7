//! A surface in pieces that are handy to divide among points.

use super::diagram::{Corner, EDGE, area, clip};
use crate::mesh::{Mesh, area_and_normal};
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Triangles are cut until about as many points have a cell in each.
const MET: f64 = 64.0;

/// Triangles in handy pieces. Those without an area are in it too: they are edges, and a tool may be
/// as deep there.
pub(super) struct Surface {
    pub(super) pieces: Vec<Piece>,
    corners: Vec<Point3<f64>>,
    /// The root of a point's share of the area.
    pub(super) spacing: f64,
    /// The largest coordinate.
    pub(super) size: f64,
}

/// A convex part of a triangle.
pub(super) struct Piece {
    pub(super) triangle: u32,
    corners: Range<usize>,
    /// The triangle's; zero if it has no area.
    pub(super) normal: Vector3<f64>,
    pub(super) area: f64,
}

impl Surface {
    /// Of a mesh that is to have so many points.
    pub(super) fn new(mesh: &Mesh, area: f64, count: usize) -> Surface {
        let spacing = (area / count as f64).sqrt();
        let [low, high] = mesh.bounds();
        let size = low.coords.amax().max(high.coords.amax());
        let mut surface = Surface { pieces: vec![], corners: vec![], spacing, size };
        for (triangle, corners) in (0..).zip(mesh.corners()) {
            let (area, normal) = area_and_normal(&corners).unwrap_or_default();
            let [a, b, c] = corners;
            let edges = [b - a, c - b, a - c].into_iter();
            let longest = edges
                .max_by(|x, y| x.norm_squared().total_cmp(&y.norm_squared()))
                .unwrap_or_default();
            let along = longest.try_normalize(0.0).unwrap_or_default();
            let axes = [along, normal.cross(&along)];
            let whole = corners.map(|corner| (corner - a, EDGE)).to_vec();
            surface.add((triangle, a, normal), axes, whole, area);
        }
        surface
    }

    /// Adds a part of a triangle, cut across where it is longer until few points have a cell in each.
    fn add(
        &mut self,
        (triangle, from, normal): (u32, Point3<f64>, Vector3<f64>),
        axes: [Vector3<f64>; 2],
        part: Vec<Corner>,
        area: f64,
    ) {
        let ends = axes.map(|axis| {
            let along = || part.iter().map(|(v, _)| v.dot(&axis));
            [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
        });
        let [long, wide] = ends.map(|[low, high]| high - low);
        if (long / self.spacing + 1.0) * (wide / self.spacing + 1.0) <= MET {
            let start = self.corners.len();
            self.corners.extend(part.iter().map(|(corner, _)| from + corner));
            let corners = start..self.corners.len();
            self.pieces.push(Piece { triangle, corners, normal, area });
            return;
        }
        let across = usize::from(wide > long);
        let ([low, high], axis) = (ends[across], axes[across]);
        let middle = low / 2.0 + high / 2.0;
        let (mut one, mut cut) = (part.clone(), vec![]);
        let mut other = part;
        clip(&mut one, &mut cut, axis, middle, EDGE);
        clip(&mut other, &mut cut, -axis, -middle, EDGE);
        let sizes = [&one, &other].map(|part| self::area(part, &normal));
        let all = sizes[0] + sizes[1];
        for (part, size) in [one, other].into_iter().zip(sizes) {
            // Where rounding leaves no area there is still a way along.
            let share = if all > 0.0 { size / all } else { 0.5 };
            self.add((triangle, from, normal), axes, part, share * area);
        }
    }

    /// The corners of a piece.
    pub(super) fn corners(&self, piece: &Piece) -> &[Point3<f64>] {
        &self.corners[piece.corners.clone()]
    }
}
