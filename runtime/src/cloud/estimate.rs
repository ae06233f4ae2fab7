//! Estimates for points without a mesh: the area of each point's cell, and the covering radius. Each
//! cell is assumed flat, in the plane through the point perpendicular to its normal.

use super::SAME_SIDE;
use super::point_grid::NeighbourBvh;
use super::voronoi::{Corner, EDGE, area, clip};
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Number of neighbours that define the local spacing.
const NEIGHBOURS: usize = 8;
/// Radii of the initial cell, in spacings: the normal one, and the one used where the cell shows that
/// the surface ends.
const CELL_RADII: [f64; 2] = [2.0, 0.7];
/// Cosine of the angle between normals (45°) below which a neighbour lies beyond an edge.
const EDGE_COSINE: f64 = 0.7;
/// Number of corners of the initial cell.
const POLYGON_CORNERS: usize = 16;
/// Positions per parallel task.
const POINTS_PER_TASK: usize = 1 << 10;

/// Maximum number of distinct normals examined at a position; if there are more, a subsample represents
/// all.
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
    let weight = |index: u32| distinct.count(index).min(MAX_SHARED);
    let lists = parallel::ranges(positions.len(), POINTS_PER_TASK, |range| {
        let (mut found, mut cell, mut cut) = (vec![], vec![], vec![]);
        let (mut areas, mut radius) = (Vec::with_capacity(range.len()), Some(0f64));
        for site in range {
            let (position, site) = (positions[site], site as u32);
            let neighbour_count = (weight(site) * (1 + NEIGHBOURS)).min(points.len());
            let spacing = (PI * tree.distance_to_weight(position.into(), neighbour_count, weight)
                / NEIGHBOURS as f64)
                .sqrt();
            tree.within(position.into(), 2.0 * CELL_RADII[0] * spacing, &mut found);
            for side in distinct.sides(site) {
                let normal = &side.normal;
                let facing = |other: &Side| other.normal.dot(normal);
                // Coincident points that face the same side share one cell.
                let sides = distinct.sides(site);
                let step = sides.len().div_ceil(MAX_SIDES);
                let facing_sides =
                    sides.iter().step_by(step).filter(|other| facing(other) > SAME_SIDE);
                let shared =
                    facing_sides.map(|other| step * other.points.len()).sum::<usize>().max(1);
                for reach in CELL_RADII {
                    cell.clear();
                    cell.extend(polygon(normal, reach * spacing));
                    for &(squared, other) in &found {
                        let mut sides = distinct.sides(other).iter();
                        if squared > 0.0 && sides.any(|other| facing(other) > SAME_SIDE) {
                            let toward = positions[other as usize] - position;
                            clip(&mut cell, &mut cut, toward, squared / 2.0, other);
                        }
                    }
                    if cell.iter().all(|(_, other)| *other != EDGE) {
                        break;
                    }
                }
                areas.push(area(&cell, normal) / shared as f64);
                // Near an edge the plane continues where the surface does not.
                let is_nearby = |squared: f64| squared < (CELL_RADII[0] * spacing).powi(2);
                let edge = found.iter().take_while(|(squared, _)| is_nearby(*squared)).any(
                    |(_, other)| {
                        let mut sides = distinct.sides(*other).iter();
                        sides.any(|other| (SAME_SIDE..EDGE_COSINE).contains(&facing(other)))
                    },
                );
                let corners = cell.iter().map(|(corner, _)| corner.norm()).fold(0.0, f64::max);
                let cell_radius = if edge { corners.min(CELL_RADII[1] * spacing) } else { corners };
                radius = radius.filter(|_| spacing > 0.0).map(|radius| radius.max(cell_radius));
            }
        }
        (areas, radius)
    });
    let radius = lists.iter().map(|(_, radius)| *radius).reduce(|a, b| Some(a?.max(b?)));
    let mut areas = vec![0.0; points.len()];
    for (area, side) in lists.into_iter().flat_map(|(areas, _)| areas).zip(&distinct.sides) {
        distinct.points[side.points.clone()].iter().for_each(|point| areas[*point as usize] = area);
    }
    (areas, radius.flatten())
}

/// The distinct positions of points, in the order of the first point of each.
struct DistinctPoints {
    positions: Vec<Point3<f64>>,
    /// The end of each position's sides in `sides`.
    ends: Vec<usize>,
    sides: Vec<Side>,
    points: Vec<u32>,
}

/// The points at a position that have the same normal.
struct Side {
    normal: Vector3<f64>,
    /// The range of their indices in [`DistinctPoints::points`].
    points: Range<usize>,
}

impl DistinctPoints {
    fn of(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> DistinctPoints {
        // Zero has two bit patterns.
        let bits = |part: f64| (part + 0.0).to_bits();
        let key = |index: u32| {
            let (position, normal) = (points[index as usize], normals[index as usize]);
            [position.x, position.y, position.z, normal.x, normal.y, normal.z].map(bits)
        };
        let mut keyed: Vec<([u64; 6], u32)> =
            (0..points.len() as u32).map(|index| (key(index), index)).collect();
        parallel::sort(&mut keyed);
        let mut groups: Vec<&[([u64; 6], u32)]> =
            keyed.chunk_by(|a, b| a.0[..3] == b.0[..3]).collect();
        groups.sort_unstable_by_key(|group| group.iter().map(|(_, index)| *index).min());
        let mut distinct =
            DistinctPoints { positions: vec![], ends: vec![], sides: vec![], points: vec![] };
        for group in groups {
            distinct.positions.push(points[group[0].1 as usize]);
            for side in group.chunk_by(|a, b| a.0 == b.0) {
                let start = distinct.points.len();
                distinct.points.extend(side.iter().map(|(_, index)| *index));
                let normal = normals[side[0].1 as usize];
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

    /// Returns the number of points at a position.
    fn count(&self, index: u32) -> usize {
        let sides = self.sides(index);
        sides[sides.len() - 1].points.end - sides[0].points.start
    }
}

/// Returns the corners of a regular polygon around a circle of the given radius, perpendicular to a
/// normal.
fn polygon(normal: &Vector3<f64>, radius: f64) -> impl Iterator<Item = Corner> {
    let tangent = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let other = normal.cross(&tangent);
    let out = radius / (PI / POLYGON_CORNERS as f64).cos();
    (0..POLYGON_CORNERS).map(move |corner| {
        let (sin, cos) = (TAU * corner as f64 / POLYGON_CORNERS as f64).sin_cos();
        (out * (cos * tangent + sin * other), EDGE)
    })
}
