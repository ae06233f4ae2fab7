//! A surface in pieces that are handy to divide among points.
//!
//! **How many there are.** A triangle whose box is `l` by `w` is met by about `(l/s + 1)(w/s + 1)` cells of points
//! at a spacing `s`, and is cut until that is [`MET`] at most. Each cut halves the longer side, so a piece that was
//! cut has more than `MET / 2`, and the cuts add at most two thirds to the sum over all pieces: a sum `E` over the
//! triangles makes at most `E / 16` pieces beside one for each triangle. Of parts with an ordinary shape `E` is a few
//! times the number of points and triangles. Where it is more than [`MOST_MET`] times that and [`ANY_MET`], triangles are long
//! against the spacing, and are cut by a coarser grain instead, at which `E` is [`COARSE_MET`] times the number of
//! points and triangles. So there are never more than `5 triangles + 4 points + 2^20` pieces. What is computed of
//! them holds for pieces of any size.

use super::diagram::{Corner, EDGE, area, clip};
use super::draw::Facets;
use crate::mesh::{Mesh, area_and_normal};
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Triangles are cut until about as many points have a cell in each.
pub(super) const MET: f64 = 64.0;
/// Cells that triangles meet, for each point and each triangle, before they are cut by a coarser grain.
const MOST_MET: f64 = 64.0;
/// As many in any case.
const ANY_MET: f64 = (1 << 24) as f64;
/// Cells that they meet at the coarser grain, for each point and each triangle.
const COARSE_MET: f64 = 16.0;

/// Triangles in handy pieces. Those without an area are in it too: they are edges, and a tool may be
/// as deep there.
pub(super) struct Surface {
    pub(super) pieces: Vec<Piece>,
    corners: Vec<Point3<f64>>,
    /// The root of a point's share of the area.
    pub(super) spacing: f64,
    /// The spacing that triangles are cut for.
    grain: f64,
    /// The largest coordinate.
    pub(super) size: f64,
}

/// A convex part of a triangle.
pub(super) struct Piece {
    pub(super) triangle: u32,
    /// Coincident pieces that it stands for, itself included.
    pub(super) copies: u32,
    corners: Range<usize>,
    /// The triangle's; zero if it has no area.
    pub(super) normal: Vector3<f64>,
    pub(super) area: f64,
}

/// What the pieces of a triangle have of it.
struct Of {
    triangle: u32,
    copies: u32,
    /// A corner, which others are given from.
    from: Point3<f64>,
    normal: Vector3<f64>,
    /// Along the longest side, and across it.
    axes: [Vector3<f64>; 2],
}

impl Surface {
    /// Of a mesh that is to have so many points.
    pub(super) fn new(mesh: &Mesh, facets: &Facets, count: usize) -> Surface {
        let spacing = (facets.spread / count as f64).sqrt();
        let [low, high] = mesh.bounds();
        let size = low.coords.amax().max(high.coords.amax());
        let grain = grain(mesh, facets, spacing, count);
        let mut surface = Surface { pieces: vec![], corners: vec![], spacing, grain, size };
        for (triangle, corners) in (0..).zip(mesh.corners()) {
            let copies = facets.copies.count(triangle);
            if copies > 0 {
                let (area, normal) = area_and_normal(&corners).unwrap_or_default();
                let from = corners[0];
                let whole = corners.map(|corner| (corner - from, EDGE)).to_vec();
                let of = Of { triangle, copies, from, normal, axes: axes(&corners, &normal) };
                surface.add(&of, whole, area);
            }
        }
        surface
    }

    /// Adds a part of a triangle, cut across where it is longer until few points have a cell in each.
    fn add(&mut self, of: &Of, part: Vec<Corner>, area: f64) {
        let Of { triangle, copies, from, normal, axes } = *of;
        let ends = ends(&part, &axes);
        if met(&ends, self.grain) <= MET {
            let start = self.corners.len();
            self.corners.extend(part.iter().map(|(corner, _)| from + corner));
            let corners = start..self.corners.len();
            self.pieces.push(Piece { triangle, copies, corners, normal, area });
            return;
        }
        let [long, wide] = ends.map(|[low, high]| high - low);
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
            self.add(of, part, share * area);
        }
    }

    /// Returns whether triangles are too long to be cut for the points' spacing.
    pub(super) fn coarse(&self) -> bool {
        self.grain > self.spacing
    }

    /// The corners of a piece.
    pub(super) fn corners(&self, piece: &Piece) -> &[Point3<f64>] {
        &self.corners[piece.corners.clone()]
    }
}

/// Returns the direction of the longest side of a triangle and that across it in its plane.
fn axes([a, b, c]: &[Point3<f64>; 3], normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let edges = [b - a, c - b, a - c].into_iter();
    let longest =
        edges.max_by(|x, y| x.norm_squared().total_cmp(&y.norm_squared())).unwrap_or_default();
    let along = longest.try_normalize(0.0).unwrap_or_default();
    [along, normal.cross(&along)]
}

/// Returns between which coordinates some corners lie along two axes.
fn ends(part: &[Corner], axes: &[Vector3<f64>; 2]) -> [[f64; 2]; 2] {
    axes.map(|axis| {
        let along = || part.iter().map(|(v, _)| v.dot(&axis));
        [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
    })
}

/// Returns about how many cells of points at a spacing a box meets.
fn met(ends: &[[f64; 2]; 2], spacing: f64) -> f64 {
    let [long, wide] = ends.map(|[low, high]| high - low);
    (long / spacing + 1.0) * (wide / spacing + 1.0)
}

/// Returns the spacing that a mesh is cut for: that of its points, or the next power of two of it at which there
/// are not too many pieces.
fn grain(mesh: &Mesh, facets: &Facets, spacing: f64, count: usize) -> f64 {
    let triangles = (0..).zip(mesh.corners()).filter(|(id, _)| facets.copies.count(*id) > 0);
    let boxes: Vec<[[f64; 2]; 2]> = triangles
        .map(|(_, corners)| {
            let normal = area_and_normal(&corners).unwrap_or_default().1;
            let whole = corners.map(|corner| (corner - corners[0], EDGE));
            ends(&whole, &axes(&corners, &normal))
        })
        .collect();
    let all = |grain: f64| boxes.iter().map(|ends| met(ends, grain)).sum::<f64>();
    let size = (count + boxes.len()) as f64;
    let mut grain = spacing;
    if all(grain) > MOST_MET * size + ANY_MET {
        while all(grain) > COARSE_MET * size {
            grain *= 2.0;
        }
    }
    grain
}
