//! Estimates for points without a mesh: the area of each point's cell, and the covering radius. Each
//! cell is assumed flat, in the plane through the point perpendicular to its normal.

use super::SAME_SIDE;
use super::pieces::{Corner, EDGE, area, clip};
use crate::cloud::neighbours::{Neighbour, NeighbourBvh};
use crate::mesh::position_bits;
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Number of neighbours that define the local spacing.
const NEIGHBOURS: usize = 8;
/// Radii of the initial cell, in spacings: the normal one, and the one used where the cell shows that the surface ends.
const CELL_RADII: [f64; 2] = [2.0, 0.7];
/// Cosine of the angle between normals (45°) below which a neighbour lies beyond an edge.
const EDGE_COSINE: f64 = 0.7;
/// Number of corners of the initial cell.
const POLYGON_CORNERS: usize = 16;
/// Positions per parallel task.
const POINTS_PER_TASK: usize = 1 << 10;

/// Maximum number of distinct normals examined at a position; if there are more, a subsample represents all.
const MAX_SIDES: usize = 1 << 10;
/// Maximum weight of a position with many points in the estimate of the spacing.
const MAX_SHARED: usize = 16;

/// Estimates the areas of the cells of points with unit normals, and the covering radius; it is `None`
/// if it cannot be estimated. Each distinct position is searched once, however many points it has.
pub(super) fn estimate(
    points: &[Point3<f64>],
    normals: &[Vector3<f64>],
) -> (Vec<f64>, Option<f64>) {
    let distinct = DistinctPoints::of(points, normals);
    let positions = &distinct.positions;
    let tree = NeighbourBvh::new(positions);
    let parts = parallel::ranges(positions.len(), POINTS_PER_TASK, |range| {
        let (mut neighbours, mut cell) = (vec![], SideCell::default());
        let mut part = PartEstimate { areas: Vec::with_capacity(range.len()), radius: Some(0.0) };
        for index in range {
            let (position, site) = (positions[index], index as u32);
            let neighbour_count =
                (distinct.capped_count(site) * (1 + NEIGHBOURS)).min(points.len());
            let squared = tree.distance_to_weight(position.into(), neighbour_count, |index| {
                distinct.capped_count(index)
            });
            // The area per point of a disc that holds so many neighbours.
            let spacing = (PI * squared / NEIGHBOURS as f64).sqrt();
            let max_distance = 2.0 * CELL_RADII[0] * spacing;
            tree.within(position.into(), max_distance, &mut neighbours);
            for side in distinct.sides(site) {
                cell.cut(&distinct, site, side, &neighbours, spacing);
                // Coincident points that face the same way share one cell.
                let sharing = distinct.count_facing(site, side).max(1);
                part.areas.push(area(&cell.corners, &side.normal) / sharing as f64);
                // Near an edge the plane continues where the surface does not.
                let radius = match distinct.is_near_edge(side, &neighbours, spacing) {
                    true => cell.radius().min(CELL_RADII[1] * spacing),
                    false => cell.radius(),
                };
                // A spacing of 0, between coincident points only, says nothing about the rest of the surface.
                part.radius = part.radius.filter(|_| spacing > 0.0).map(|max| max.max(radius));
            }
        }
        part
    });
    let radius = parts.iter().try_fold(0.0, |max: f64, part| Some(max.max(part.radius?)));
    let mut areas = vec![0.0; points.len()];
    for (area, side) in parts.into_iter().flat_map(|part| part.areas).zip(&distinct.sides) {
        distinct.points[side.points.clone()].iter().for_each(|point| areas[*point as usize] = area);
    }
    (areas, radius)
}

/// The estimates of some positions.
struct PartEstimate {
    /// The area of the cell of each side.
    areas: Vec<f64>,
    /// The largest radius of a cell, if it can be estimated.
    radius: Option<f64>,
}

/// The distinct positions of points, in the order of the first point of each.
struct DistinctPoints {
    positions: Vec<Point3<f64>>,
    /// The end of each position's sides in `sides`.
    ends: Vec<usize>,
    sides: Vec<Side>,
    points: Vec<u32>,
}

/// A point in the order by which coincident ones are found.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct KeyedPoint {
    /// The bits of its position, and of its normal.
    position: [u64; 3],
    normal: [u64; 3],
    index: u32,
}

/// The points at a position that have the same normal.
struct Side {
    normal: Vector3<f64>,
    /// The range of their indices in [`DistinctPoints::points`].
    points: Range<usize>,
}

impl Side {
    /// Returns whether another side faces the same way.
    fn faces_same_way(&self, other: &Side) -> bool {
        other.normal.dot(&self.normal) > SAME_SIDE
    }
}

/// The cell of a side, relative to its position, with memory kept between cells.
#[derive(Default)]
struct SideCell {
    corners: Vec<Corner>,
    /// Memory of [`clip`].
    clipped: Vec<Corner>,
}

impl SideCell {
    /// Cuts a cell out of the plane of a side, halfway to each neighbour that faces the same way. It begins as the smaller
    /// polygon if the neighbours do not enclose it within the larger one.
    fn cut(
        &mut self,
        distinct: &DistinctPoints,
        site: u32,
        side: &Side,
        neighbours: &[Neighbour],
        spacing: f64,
    ) {
        for radius in CELL_RADII {
            self.corners.clear();
            self.corners.extend(polygon(&side.normal, radius * spacing));
            for &Neighbour { squared, index: neighbour } in neighbours {
                let mut sides = distinct.sides(neighbour).iter();
                if squared > 0.0 && sides.any(|other| side.faces_same_way(other)) {
                    let [from, to] = [site, neighbour].map(|k| distinct.positions[k as usize]);
                    let SideCell { corners, clipped } = self;
                    clip(corners, clipped, to - from, squared / 2.0, neighbour);
                }
            }
            if self.corners.iter().all(|corner| corner.neighbour != EDGE) {
                return;
            }
        }
    }

    /// Returns the largest distance of a corner from the position.
    fn radius(&self) -> f64 {
        self.corners.iter().map(|corner| corner.at.norm()).fold(0.0, f64::max)
    }
}

impl DistinctPoints {
    fn of(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> DistinctPoints {
        let mut keyed: Vec<KeyedPoint> = points
            .iter()
            .zip(normals)
            .zip(0u32..)
            .map(|((position, normal), index)| KeyedPoint {
                position: position_bits((*position).into()),
                normal: position_bits((*normal).into()),
                index,
            })
            .collect();
        parallel::sort(&mut keyed);
        let mut groups: Vec<&[KeyedPoint]> =
            keyed.chunk_by(|a, b| a.position == b.position).collect();
        groups.sort_unstable_by_key(|group| group.iter().map(|point| point.index).min());
        let mut distinct =
            DistinctPoints { positions: vec![], ends: vec![], sides: vec![], points: vec![] };
        for group in groups {
            distinct.positions.push(points[group[0].index as usize]);
            for side in group.chunk_by(|a, b| a.normal == b.normal) {
                let start = distinct.points.len();
                distinct.points.extend(side.iter().map(|point| point.index));
                let normal = normals[side[0].index as usize];
                distinct.sides.push(Side { normal, points: start..distinct.points.len() });
            }
            distinct.ends.push(distinct.sides.len());
        }
        distinct
    }

    /// Returns the sides of a position.
    fn sides(&self, index: u32) -> &[Side] {
        let index = index as usize;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.sides[start..self.ends[index]]
    }

    /// Returns the number of points at a position that face the same way as one of its sides, from a subsample if the
    /// position has many sides.
    fn count_facing(&self, site: u32, side: &Side) -> usize {
        let sides = self.sides(site);
        let step = sides.len().div_ceil(MAX_SIDES);
        let sampled = sides.iter().step_by(step).filter(|other| side.faces_same_way(other));
        sampled.map(|other| step * other.points.len()).sum()
    }

    /// Returns whether a neighbour within the larger radius of a cell lies beyond an edge, but not on the opposite side of
    /// something thin. The neighbours are in the order of their distances.
    fn is_near_edge(&self, side: &Side, neighbours: &[Neighbour], spacing: f64) -> bool {
        let max_squared = (CELL_RADII[0] * spacing).powi(2);
        let near = neighbours.iter().take_while(|neighbour| neighbour.squared < max_squared);
        near.flat_map(|neighbour| self.sides(neighbour.index))
            .any(|other| (SAME_SIDE..EDGE_COSINE).contains(&other.normal.dot(&side.normal)))
    }

    /// Returns the number of points at a position, as it counts in the estimate of the spacing.
    fn capped_count(&self, index: u32) -> usize {
        self.count(index).min(MAX_SHARED)
    }

    /// Returns the number of points at a position.
    fn count(&self, index: u32) -> usize {
        let sides = self.sides(index);
        sides[sides.len() - 1].points.end - sides[0].points.start
    }
}

/// Returns the corners of a regular polygon around a circle of the given radius, perpendicular to a normal.
fn polygon(normal: &Vector3<f64>, radius: f64) -> impl Iterator<Item = Corner> {
    // The axis of the least component is the farthest from being parallel to the normal.
    let tangent = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let other = normal.cross(&tangent);
    let out = radius / (PI / POLYGON_CORNERS as f64).cos();
    (0..POLYGON_CORNERS).map(move |corner| {
        let (sin, cos) = (TAU * corner as f64 / POLYGON_CORNERS as f64).sin_cos();
        Corner { at: out * (cos * tangent + sin * other), neighbour: EDGE }
    })
}
