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
const REACHES: [f64; 2] = [2.0, 0.7];
/// Cosine of the angle between normals (45°) below which a neighbour lies beyond an edge.
const FLAT: f64 = 0.7;
/// Number of corners of the initial cell.
const CORNERS: usize = 16;
/// Positions per parallel task.
const TOGETHER: usize = 1 << 10;

/// Maximum number of distinct normals examined at a position; if there are more, a subsample represents
/// all.
const MOST_SIDES: usize = 1 << 10;
/// Maximum weight of a position with many points in the estimate of the spacing.
const MOST_SHARED: usize = 16;

/// Estimates the areas of the cells of points with unit normals, and the covering radius; it is `None`
/// if it cannot be estimated. Each distinct position is searched once, however many points it has.
pub(super) fn estimate(
    points: &[Point3<f64>],
    normals: &[Vector3<f64>],
) -> (Vec<f64>, Option<f64>) {
    let all = DistinctPoints::of(points, normals);
    let places = &all.places;
    let near = NeighbourBvh::new(places);
    let weight = |place: u32| all.count(place).min(MOST_SHARED);
    let lists = parallel::ranges(places.len(), TOGETHER, |range| {
        let (mut found, mut cell, mut cut) = (vec![], vec![], vec![]);
        let (mut areas, mut radius) = (Vec::with_capacity(range.len()), Some(0f64));
        for site in range {
            let (at, site) = (places[site], site as u32);
            let around = (weight(site) * (1 + NEIGHBOURS)).min(points.len());
            let spacing =
                (PI * near.weighing(at.into(), around, weight) / NEIGHBOURS as f64).sqrt();
            near.within(at.into(), 2.0 * REACHES[0] * spacing, &mut found);
            for side in all.sides(site) {
                let normal = &side.normal;
                let facing = |other: &Side| other.normal.dot(normal);
                // Coincident points that face the same side share one cell.
                let sides = all.sides(site);
                let step = sides.len().div_ceil(MOST_SIDES);
                let same = sides.iter().step_by(step).filter(|other| facing(other) > SAME_SIDE);
                let shared = same.map(|other| step * other.points.len()).sum::<usize>().max(1);
                for reach in REACHES {
                    cell.clear();
                    cell.extend(polygon(normal, reach * spacing));
                    for &(squared, other) in &found {
                        let mut sides = all.sides(other).iter();
                        if squared > 0.0 && sides.any(|other| facing(other) > SAME_SIDE) {
                            let toward = places[other as usize] - at;
                            clip(&mut cell, &mut cut, toward, squared / 2.0, other);
                        }
                    }
                    if cell.iter().all(|(_, other)| *other != EDGE) {
                        break;
                    }
                }
                areas.push(area(&cell, normal) / shared as f64);
                // Near an edge the plane continues where the surface does not.
                let beside = |squared: f64| squared < (REACHES[0] * spacing).powi(2);
                let edge =
                    found.iter().take_while(|(squared, _)| beside(*squared)).any(|(_, other)| {
                        let mut sides = all.sides(*other).iter();
                        sides.any(|other| (SAME_SIDE..FLAT).contains(&facing(other)))
                    });
                let corners = cell.iter().map(|(corner, _)| corner.norm()).fold(0.0, f64::max);
                let here = if edge { corners.min(REACHES[1] * spacing) } else { corners };
                radius = radius.filter(|_| spacing > 0.0).map(|radius| radius.max(here));
            }
        }
        (areas, radius)
    });
    let radius = lists.iter().map(|(_, radius)| *radius).reduce(|a, b| Some(a?.max(b?)));
    let mut areas = vec![0.0; points.len()];
    for (area, side) in lists.into_iter().flat_map(|(areas, _)| areas).zip(&all.sides) {
        all.points[side.points.clone()].iter().for_each(|point| areas[*point as usize] = area);
    }
    (areas, radius.flatten())
}

/// The distinct positions of points, in the order of the first point of each.
struct DistinctPoints {
    places: Vec<Point3<f64>>,
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
            let (at, normal) = (points[index as usize], normals[index as usize]);
            [at.x, at.y, at.z, normal.x, normal.y, normal.z].map(bits)
        };
        let mut keyed: Vec<([u64; 6], u32)> =
            (0..points.len() as u32).map(|index| (key(index), index)).collect();
        parallel::sort(&mut keyed);
        let mut groups: Vec<&[([u64; 6], u32)]> =
            keyed.chunk_by(|a, b| a.0[..3] == b.0[..3]).collect();
        groups.sort_unstable_by_key(|group| group.iter().map(|(_, index)| *index).min());
        let mut all =
            DistinctPoints { places: vec![], ends: vec![], sides: vec![], points: vec![] };
        for group in groups {
            all.places.push(points[group[0].1 as usize]);
            for side in group.chunk_by(|a, b| a.0 == b.0) {
                let start = all.points.len();
                all.points.extend(side.iter().map(|(_, index)| *index));
                let normal = normals[side[0].1 as usize];
                all.sides.push(Side { normal, points: start..all.points.len() });
            }
            all.ends.push(all.sides.len());
        }
        all
    }

    /// Returns the sides of a position.
    fn sides(&self, place: u32) -> &[Side] {
        let place = place as usize;
        let start = if place == 0 { 0 } else { self.ends[place - 1] };
        &self.sides[start..self.ends[place]]
    }

    /// Returns the number of points at a position.
    fn count(&self, place: u32) -> usize {
        let sides = self.sides(place);
        sides[sides.len() - 1].points.end - sides[0].points.start
    }
}

/// Returns the corners of a regular polygon around a circle of the given radius, perpendicular to a
/// normal.
fn polygon(normal: &Vector3<f64>, radius: f64) -> impl Iterator<Item = Corner> {
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let other = normal.cross(&across);
    let out = radius / (PI / CORNERS as f64).cos();
    (0..CORNERS).map(move |corner| {
        let (sin, cos) = (TAU * corner as f64 / CORNERS as f64).sin_cos();
        (out * (cos * across + sin * other), EDGE)
    })
}
