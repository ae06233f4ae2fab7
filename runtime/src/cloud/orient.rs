//! Normals of points that have none: each is perpendicular to the plane that fits its neighbours best (H. Hoppe et al., *Surface
//! reconstruction from unorganized points*, 1992, section 3.2), and points the same way as those of its neighbours. Which way that is
//! cannot be known.

use crate::cloud::neighbours::NeighbourBvh;
use crate::mesh::position_bits;
use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// Number of neighbours that a plane is fitted to, the point itself included.
const NEIGHBOURS: usize = 12;

/// Returns a unit normal for each of one or more points; coincident points have the same.
pub(super) fn estimate(points: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    // All coincident points are equally near to one another, and say nothing about a plane.
    let (mut positions, mut known) = (Vec::new(), HashMap::new());
    let position_of: Vec<usize> = points
        .iter()
        .map(|point| {
            *known.entry(position_bits((*point).into())).or_insert_with(|| {
                positions.push(*point);
                positions.len() - 1
            })
        })
        .collect();
    let normals = estimate_distinct(&positions);
    position_of.into_iter().map(|position| normals[position]).collect()
}

/// Returns a unit normal for each of one or more distinct positions.
fn estimate_distinct(points: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    let tree = NeighbourBvh::new(points);
    let mut found = Vec::new();
    let mut neighbours: Vec<Vec<u32>> = Vec::with_capacity(points.len());
    let mut normals: Vec<Vector3<f64>> = Vec::with_capacity(points.len());
    for point in points {
        tree.nearest_within((*point).into(), f64::INFINITY, NEIGHBOURS, &mut found);
        let count = found.len() as f64;
        let sum = found.iter().map(|near| points[near.index as usize].coords);
        let middle = sum.sum::<Vector3<f64>>() / count;
        let mut spread = Matrix3::zeros();
        for near in &found {
            let offset = points[near.index as usize].coords - middle;
            spread += offset * offset.transpose();
        }
        let planes = SymmetricEigen::new(spread);
        let flattest = planes.eigenvalues.imin();
        let normal = planes.eigenvectors.column(flattest).into_owned();
        normals.push(normal.try_normalize(0.0).unwrap_or(Vector3::z()));
        neighbours.push(found.iter().map(|near| near.index).collect());
    }
    orient(&mut normals, &neighbours);
    normals
}

/// Turns normals that point against those of their neighbours, from each point to the neighbour whose plane differs least.
fn orient(normals: &mut [Vector3<f64>], neighbours: &[Vec<u32>]) {
    // Neighbours need not be mutual.
    let mut linked: Vec<Vec<u32>> = neighbours.to_vec();
    for (point, near) in (0..).zip(neighbours) {
        near.iter().for_each(|near| linked[*near as usize].push(point));
    }
    let mut is_visited = vec![false; normals.len()];
    for seed in 0..normals.len() {
        let mut open = BinaryHeap::from([(Reverse(0u64), seed as u32, seed as u32)]);
        while let Some((_, point, from)) = open.pop() {
            if std::mem::replace(&mut is_visited[point as usize], true) {
                continue;
            }
            let before = normals[from as usize];
            let normal = &mut normals[point as usize];
            if normal.dot(&before) < 0.0 {
                *normal = -*normal;
            }
            let normal = normals[point as usize];
            for near in linked[point as usize].iter().filter(|near| !is_visited[**near as usize]) {
                let bend = 1.0 - normals[*near as usize].dot(&normal).abs();
                // The bits of numbers from 0 are in their order.
                open.push((Reverse(bend.max(0.0).to_bits()), *near, point));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a sphere, in turns about its axis, whose normals are known but for their common sign.
    #[test]
    fn normals_of_a_sphere_point_all_out_or_all_in() {
        let count = 2000;
        let points = (0..count).map(|k| {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
            let (sine, cosine) = (2.399_963 * f64::from(k)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            Point3::new(radius * cosine, radius * sine, z)
        });
        let points: Vec<Point3<f64>> = points.collect();
        let normals = estimate(&points);
        let sign = normals[0].dot(&points[0].coords).signum();
        for (point, normal) in points.iter().zip(&normals) {
            assert!((normal - sign * point.coords).norm() < 0.1, "{point} {normal}");
        }
        // Points that coincide change nothing: a plane is fitted to distinct ones.
        let copies: Vec<Point3<f64>> = points.iter().flat_map(|point| vec![*point; 20]).collect();
        let of_copies = estimate(&copies);
        for (copies, normal) in of_copies.chunks(20).zip(&normals) {
            assert!(copies.iter().all(|copy| copy == normal), "{copies:?} {normal}");
        }
    }
}
