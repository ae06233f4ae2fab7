//! Division of a surface into pieces of a convenient size for the Voronoi diagram.
//!
//! **Number of pieces.** A triangle whose box is `l` by `w` meets about `(l/s + 1)(w/s + 1)` cells of
//! points at a spacing `s`, and is cut until that is at most [`MAX_POINTS_PER_PIECE`]. Each cut halves the longer side,
//! so a piece that was cut has more than `MET / 2`, and the cuts add at most two thirds to the sum over
//! all pieces. A sum `E` over the triangles therefore makes at most `E / 16` pieces in addition to one
//! per triangle. For parts with an ordinary shape, `E` is a few times the number of points and
//! triangles. If it is more than [`MAX_MEAN_PIECES`] times that and [`FREE_PIECES`], triangles are long compared
//! with the spacing. They are then cut by a coarser grain, at which `E` is [`COARSE_MEAN_PIECES`] times the
//! number of points and triangles. There are therefore never more than `5 triangles + 4 points + 2^20`
//! pieces. Results computed from the pieces hold for pieces of any size.

use super::sampling::AreaSampler;
use crate::cancellation;
use crate::mesh::{Mesh, area_and_normal};
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Triangles are cut until about as many points have a cell in each piece.
const MAX_POINTS_PER_PIECE: f64 = 64.0;
/// Cells that triangles meet, per point and per triangle, before a coarser grain is used.
const MAX_MEAN_PIECES: f64 = 64.0;
/// Number of cells that is always allowed.
const FREE_PIECES: f64 = (1 << 24) as f64;
/// Cells that triangles meet at the coarser grain, per point and per triangle.
const COARSE_MEAN_PIECES: f64 = 16.0;

/// Triangles cut into pieces. Triangles without area are included: they are edges, and a tool may be
/// just as deep there.
pub(super) struct Surface {
    pub(super) pieces: Vec<SurfacePiece>,
    corners: Vec<Point3<f64>>,
    /// The square root of the area per point.
    pub(super) spacing: f64,
    /// The spacing that triangles are cut for.
    grain: f64,
    /// The largest coordinate.
    pub(super) size: f64,
}

/// A convex part of a triangle.
pub(super) struct SurfacePiece {
    pub(super) triangle: u32,
    /// The number of coincident pieces that this piece represents, including itself.
    pub(super) copies: u32,
    corners: Range<usize>,
    /// The triangle's unit normal; zero if the triangle has no area.
    pub(super) normal: Vector3<f64>,
    pub(super) area: f64,
}

/// Properties of a triangle that all of its pieces share.
struct TrianglePieces {
    triangle: u32,
    copies: u32,
    /// The corner that other corners are given relative to.
    origin: Point3<f64>,
    normal: Vector3<f64>,
    /// Directions along the longest side, and across it in the triangle's plane.
    axes: [Vector3<f64>; 2],
}

impl Surface {
    /// Divides a mesh for `count` points.
    pub(super) fn new(mesh: &Mesh, sampler: &AreaSampler, count: usize) -> Surface {
        let spacing = (sampler.distinct_area / count as f64).sqrt();
        let [low, high] = mesh.bounds();
        let size = low.coords.amax().max(high.coords.amax());
        let grain = grain(mesh, sampler, spacing, count);
        let mut surface = Surface { pieces: vec![], corners: vec![], spacing, grain, size };
        for (triangle, corners) in (0..).zip(mesh.corners()) {
            // Coincident triangles are divided once, and their areas are added up.
            let copies = sampler.copies.count(triangle);
            if copies > 0 {
                let (area, normal) = area_and_normal(&corners).unwrap_or_default();
                let origin = corners[0];
                let polygon =
                    corners.map(|corner| Corner { at: corner - origin, neighbour: EDGE }).to_vec();
                let triangle_pieces = TrianglePieces {
                    triangle,
                    copies,
                    origin,
                    normal,
                    axes: axes(&corners, &normal),
                };
                surface.add(&triangle_pieces, polygon, area);
            }
        }
        surface
    }

    /// Adds a part of a triangle. It is cut across its longer extent until few points have a cell in each piece.
    fn add(&mut self, triangle_pieces: &TrianglePieces, part: Vec<Corner>, area: f64) {
        cancellation::check();
        let TrianglePieces { triangle, copies, origin, normal, axes } = *triangle_pieces;
        let ends = ends(&part, &axes);
        if expected_points(&ends, self.grain) <= MAX_POINTS_PER_PIECE {
            let start = self.corners.len();
            self.corners.extend(part.iter().map(|corner| origin + corner.at));
            let corners = start..self.corners.len();
            self.pieces.push(SurfacePiece { triangle, copies, corners, normal, area });
            return;
        }
        let [long, wide] = ends.map(|[low, high]| high - low);
        let axis_index = usize::from(wide > long);
        let ([low, high], axis) = (ends[axis_index], axes[axis_index]);
        let middle = low / 2.0 + high / 2.0;
        let (mut first, mut cut) = (part.clone(), vec![]);
        let mut second = part;
        clip(&mut first, &mut cut, axis, middle, EDGE);
        clip(&mut second, &mut cut, -axis, -middle, EDGE);
        let sizes = [&first, &second].map(|part| self::area(part, &normal));
        let total = sizes[0] + sizes[1];
        for (part, size) in [first, second].into_iter().zip(sizes) {
            // If rounding leaves no area, the part still has a length, so it is divided evenly.
            let share = if total > 0.0 { size / total } else { 0.5 };
            self.add(triangle_pieces, part, share * area);
        }
    }

    /// Returns whether triangles are too long to be cut for the points' spacing.
    pub(super) fn is_coarse(&self) -> bool {
        self.grain > self.spacing
    }

    /// Returns the corners of a piece.
    pub(super) fn corners(&self, piece: &SurfacePiece) -> &[Point3<f64>] {
        &self.corners[piece.corners.clone()]
    }
}

/// Returns the direction of a triangle's longest side and the direction across it in the triangle's plane.
fn axes([a, b, c]: &[Point3<f64>; 3], normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let edges = [b - a, c - b, a - c].into_iter();
    let longest =
        edges.max_by(|x, y| x.norm_squared().total_cmp(&y.norm_squared())).unwrap_or_default();
    let along = longest.try_normalize(0.0).unwrap_or_default();
    [along, normal.cross(&along)]
}

/// Returns the ranges of the corners' coordinates along two axes.
fn ends(part: &[Corner], axes: &[Vector3<f64>; 2]) -> [[f64; 2]; 2] {
    axes.map(|axis| {
        part.iter()
            .map(|corner| corner.at.dot(&axis))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    })
}

/// Returns the approximate number of cells of points at a spacing that a box meets.
fn expected_points(ends: &[[f64; 2]; 2], spacing: f64) -> f64 {
    let [long, wide] = ends.map(|[low, high]| high - low);
    (long / spacing + 1.0) * (wide / spacing + 1.0)
}

/// Returns the spacing that a mesh is cut for. It is the points' spacing, or that times the smallest
/// power of two for which there are not too many pieces.
fn grain(mesh: &Mesh, sampler: &AreaSampler, spacing: f64, count: usize) -> f64 {
    let triangles = (0..).zip(mesh.corners()).filter(|(id, _)| sampler.copies.count(*id) > 0);
    let boxes: Vec<[[f64; 2]; 2]> = triangles
        .map(|(_, corners)| {
            let normal = area_and_normal(&corners).unwrap_or_default().1;
            let polygon = corners.map(|corner| Corner { at: corner - corners[0], neighbour: EDGE });
            ends(&polygon, &axes(&corners, &normal))
        })
        .collect();
    let size = (count + boxes.len()) as f64;
    let mut grain = spacing;
    // Results hold for pieces of any size: what is at stake is the number of pieces.
    if total_points(&boxes, grain) > MAX_MEAN_PIECES * size + FREE_PIECES {
        while total_points(&boxes, grain) > COARSE_MEAN_PIECES * size {
            grain *= 2.0;
        }
    }
    grain
}

/// Returns the sum of [`expected_points`] over all boxes.
fn total_points(boxes: &[[[f64; 2]; 2]], spacing: f64) -> f64 {
    boxes.iter().map(|ends| expected_points(ends, spacing)).sum()
}

/// A corner of a convex polygon in a surface, relative to some point: the corner of a triangle, or the point of a cell.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) at: Vector3<f64>,
    /// The point of the cloud whose line the next edge lies on, or [`EDGE`].
    pub(super) neighbour: u32,
}

/// Marks an edge of the piece, which belongs to no point.
pub(super) const EDGE: u32 = u32::MAX;

/// Cuts away the part of a polygon beyond `v · to_other = half`. Returns whether there was any. `cut` is memory kept
/// between calls.
pub(super) fn clip(
    cell: &mut Vec<Corner>,
    cut: &mut Vec<Corner>,
    to_other: Vector3<f64>,
    half: f64,
    other: u32,
) -> bool {
    if cell.iter().all(|corner| corner.beyond(&to_other, half) <= 0.0) {
        return false;
    }
    cut.clear();
    for (index, corner) in cell.iter().enumerate() {
        let next = &cell[(index + 1) % cell.len()];
        let [distance, next_distance] = [corner, next].map(|c| c.beyond(&to_other, half));
        if distance <= 0.0 {
            cut.push(*corner);
            if next_distance > 0.0 {
                let at = corner.toward(next, distance / (distance - next_distance));
                cut.push(Corner { at, neighbour: other });
            }
        } else if next_distance <= 0.0 {
            // The polygon is entered again, on the edge that was left out up to here.
            let at = corner.toward(next, distance / (distance - next_distance));
            cut.push(Corner { at, neighbour: corner.neighbour });
        }
    }
    std::mem::swap(cell, cut);
    true
}

impl Corner {
    /// Returns `v · to_other - half`: the distance beyond a line, times the length of `to_other`.
    pub(super) fn beyond(&self, to_other: &Vector3<f64>, half: f64) -> f64 {
        self.at.dot(to_other) - half
    }

    /// Returns the point at a fraction of the way to another corner.
    fn toward(&self, next: &Corner, fraction: f64) -> Vector3<f64> {
        self.at + (next.at - self.at) * fraction
    }
}

/// Returns the area of a polygon.
pub(super) fn area(cell: &[Corner], normal: &Vector3<f64>) -> f64 {
    let Some((first, rest)) = cell.split_first() else { return 0.0 };
    let fan = rest.windows(2).map(|pair| (pair[0].at - first.at).cross(&(pair[1].at - first.at)));
    (fan.map(|cross| cross.dot(normal)).sum::<f64>() / 2.0).max(0.0)
}
