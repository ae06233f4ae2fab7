//! What is not known of points without a mesh: the area of each one's cell, and how far the surface gets
//! from them. Estimates: each cell is taken for flat, in the plane across the point's normal.

use super::cells::{Cells, Corner, EDGE, area, clip};
use super::near::Near;
use crate::cores;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

/// By so many neighbours it is judged how close points are.
const NEIGHBOURS: usize = 8;
/// How far a cell reaches at most, and where that shows that the surface ends there, in spacings.
const REACHES: [f64; 2] = [2.0, 0.7];
/// Neighbours whose normals are at more than 107° are on the far side of a thin sheet.
const SAME_SIDE: f64 = -0.3;
/// The corners of a cell before it is cut.
const CORNERS: usize = 16;
/// Points that one core takes at a time.
const TOGETHER: usize = 1 << 10;

/// Estimates the cells of points with unit normals.
pub(super) fn guess(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> Cells {
    let near = Near::new(points);
    let lists = cores::ranges(points.len(), TOGETHER, |range| {
        let (mut found, mut cell, mut cut) = (vec![], vec![], vec![]);
        let (mut areas, mut radius) = (Vec::with_capacity(range.len()), 0f64);
        for site in range {
            let (at, normal) = (points[site], &normals[site]);
            let around = NEIGHBOURS.min(points.len() - 1);
            let spacing = (PI * near.nearest_of(at.into(), around + 1) / NEIGHBOURS as f64).sqrt();
            near.within(at.into(), 2.0 * REACHES[0] * spacing, &mut found);
            for reach in REACHES {
                cell.clear();
                cell.extend(polygon(normal, reach * spacing));
                for &(squared, other) in &found {
                    let facing = normals[other as usize].dot(normal);
                    if squared > 0.0 && facing > SAME_SIDE {
                        let toward = points[other as usize] - at;
                        clip(&mut cell, &mut cut, toward, squared / 2.0, other);
                    }
                }
                if cell.iter().all(|(_, other)| *other != EDGE) {
                    break;
                }
            }
            areas.push(area(&cell, normal));
            radius = cell.iter().map(|(corner, _)| corner.norm()).fold(radius, f64::max);
        }
        (areas, radius)
    });
    let radius = lists.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
    Cells { areas: lists.into_iter().flat_map(|(areas, _)| areas).collect(), radius }
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
