//! What is not known of points without a mesh: the area of each one's cell, and how far the surface gets
//! from them. Estimates: each cell is taken for flat, in the plane across the point's normal.

use super::SAME_SIDE;
use super::diagram::{Corner, EDGE, area, clip};
use super::near::Near;
use crate::cores;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// By so many neighbours it is judged how close points are.
const NEIGHBOURS: usize = 8;
/// How far a cell reaches at most, and where that shows that the surface ends there, in spacings.
const REACHES: [f64; 2] = [2.0, 0.7];
/// Neighbours whose normals are at more than 45° are beyond an edge.
const FLAT: f64 = 0.7;
/// The corners of a cell before it is cut.
const CORNERS: usize = 16;
/// Points that one core takes at a time.
const TOGETHER: usize = 1 << 10;

/// Of more normals at a place than this some are looked at for all.
const MOST_SIDES: usize = 1 << 10;
/// Points of a place weigh no more than so many when it is judged how close others are.
const MOST_SHARED: usize = 16;

/// Estimates the areas of the cells of points with unit normals, and how far the surface gets from them;
/// `None` where nothing tells. Each place is looked for once, however many points it has.
pub(super) fn guess(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> (Vec<f64>, Option<f64>) {
    let all = Places::of(points, normals);
    let places = &all.places;
    let near = Near::new(places);
    let weight = |place: u32| all.count(place).min(MOST_SHARED);
    let lists = cores::ranges(places.len(), TOGETHER, |range| {
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
                // What is there more than once shares its cell.
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
                // Beside an edge the plane goes on where the surface does not.
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

/// The places that points are at, in the order of the first point of each.
struct Places {
    places: Vec<Point3<f64>>,
    /// Where the sides of each end.
    ends: Vec<usize>,
    sides: Vec<Side>,
    points: Vec<u32>,
}

/// The points of a place that have the same normal.
struct Side {
    normal: Vector3<f64>,
    /// Which they are, in [`Places::points`].
    points: Range<usize>,
}

impl Places {
    fn of(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> Places {
        // Zero has two bit patterns.
        let bits = |part: f64| (part + 0.0).to_bits();
        let key = |index: u32| {
            let (at, normal) = (points[index as usize], normals[index as usize]);
            [at.x, at.y, at.z, normal.x, normal.y, normal.z].map(bits)
        };
        let mut keyed: Vec<([u64; 6], u32)> =
            (0..points.len() as u32).map(|index| (key(index), index)).collect();
        cores::sort(&mut keyed);
        let mut groups: Vec<&[([u64; 6], u32)]> =
            keyed.chunk_by(|a, b| a.0[..3] == b.0[..3]).collect();
        groups.sort_unstable_by_key(|group| group.iter().map(|(_, index)| *index).min());
        let mut all = Places { places: vec![], ends: vec![], sides: vec![], points: vec![] };
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

    /// The sides of a place.
    fn sides(&self, place: u32) -> &[Side] {
        let place = place as usize;
        let start = if place == 0 { 0 } else { self.ends[place - 1] };
        &self.sides[start..self.ends[place]]
    }

    /// Returns how many points a place has.
    fn count(&self, place: u32) -> usize {
        let sides = self.sides(place);
        sides[sides.len() - 1].points.end - sides[0].points.start
    }
}

/// A polygon about a circle across a normal.
fn polygon(normal: &Vector3<f64>, radius: f64) -> impl Iterator<Item = Corner> {
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let other = normal.cross(&across);
    let out = radius / (PI / CORNERS as f64).cos();
    (0..CORNERS).map(move |corner| {
        let (sin, cos) = (TAU * corner as f64 / CORNERS as f64).sin_cos();
        (out * (cos * across + sin * other), EDGE)
    })
}
