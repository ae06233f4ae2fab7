//! What is not known of points without a mesh: the area of each one's cell, and how far the surface gets
//! from them. Estimates: each cell is taken for flat, in the plane across the point's normal.

use super::SAME_SIDE;
use super::diagram::{Corner, EDGE, area, clip};
use super::near::Near;
use crate::cores;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

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

/// Estimates the areas of the cells of points with unit normals, and how far the surface gets from them;
/// `None` where nothing tells.
pub(super) fn guess(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> (Vec<f64>, Option<f64>) {
    let near = Near::new(points);
    let lists = cores::ranges(points.len(), TOGETHER, |range| {
        let (mut found, mut cell, mut cut) = (vec![], vec![], vec![]);
        let (mut areas, mut radius) = (Vec::with_capacity(range.len()), Some(0f64));
        for site in range {
            let (at, normal) = (points[site], &normals[site]);
            let facing = |other: u32| normals[other as usize].dot(normal);
            near.within(at.into(), 0.0, &mut found);
            // What is there more than once shares its cell.
            let shared = found.iter().filter(|(_, other)| facing(*other) > SAME_SIDE).count();
            let around = (found.len() * (1 + NEIGHBOURS)).min(points.len());
            let spacing = (PI * near.nearest_of(at.into(), around) / NEIGHBOURS as f64).sqrt();
            near.within(at.into(), 2.0 * REACHES[0] * spacing, &mut found);
            for reach in REACHES {
                cell.clear();
                cell.extend(polygon(normal, reach * spacing));
                for &(squared, other) in &found {
                    if squared > 0.0 && facing(other) > SAME_SIDE {
                        let toward = points[other as usize] - at;
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
            let edge = found.iter().any(|&(squared, other)| {
                beside(squared) && (SAME_SIDE..FLAT).contains(&facing(other))
            });
            let corners = cell.iter().map(|(corner, _)| corner.norm()).fold(0.0, f64::max);
            let here = if edge { corners.min(REACHES[1] * spacing) } else { corners };
            radius = radius.filter(|_| spacing > 0.0).map(|radius| radius.max(here));
        }
        (areas, radius)
    });
    let radius = lists.iter().map(|(_, radius)| *radius).reduce(|a, b| Some(a?.max(b?)));
    (lists.into_iter().flat_map(|(areas, _)| areas).collect(), radius.flatten())
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
