//! Random sampling of points on a mesh.

use super::Cloud;
use super::duplicates::Copies;
use crate::id::TriangleId;
use crate::mesh::{CompensatedSum, Mesh, area_and_normal};
use crate::parallel;
use nalgebra::{Point3, Vector3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::ops::Range;

/// Points per parallel task.
const TOGETHER: usize = 1 << 12;

/// The triangles that have an area, with cumulative areas for sampling.
pub(super) struct AreaSampler {
    ids: Vec<u32>,
    normals: Vec<Vector3<f64>>,
    /// The area of all triangles up to and including each.
    areas_up_to: Vec<f64>,
    pub(super) copies: Copies,
    /// The total area with coincident triangles counted once: the area that points spread over.
    pub(super) spread: f64,
}

impl AreaSampler {
    pub(super) fn of(mesh: &Mesh) -> AreaSampler {
        let mut facets = AreaSampler {
            ids: Vec::new(),
            normals: Vec::new(),
            areas_up_to: Vec::new(),
            copies: Copies::of(mesh),
            spread: 0.0,
        };
        let (mut sum, mut distinct) = (CompensatedSum::default(), CompensatedSum::default());
        let mut highest = 0f64;
        for (id, corners) in (0..).zip(mesh.corners()) {
            if let Some((area, normal)) = area_and_normal(&corners) {
                sum.add(area);
                // The search needs an ascending list; a compensated sum may step back by an ulp.
                highest = highest.max(sum.value());
                facets.ids.push(id);
                facets.normals.push(normal);
                facets.areas_up_to.push(highest);
                if facets.copies.count(id) > 0 {
                    distinct.add(area);
                    facets.spread = facets.spread.max(distinct.value());
                }
            }
        }
        facets
    }

    /// Returns the total area, which is positive for a mesh.
    pub(super) fn area(&self) -> f64 {
        self.areas_up_to.last().copied().unwrap_or_default()
    }

    /// Samples independently and uniformly; see [`SamplingMethod::MonteCarlo`](super::SamplingMethod::MonteCarlo).
    pub(super) fn random(&self, mesh: &Mesh, count: usize, seed: u64) -> Cloud {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut cloud = Cloud::with_capacity(count, mesh.unit());
        let area = self.area();
        for _ in 0..count {
            let target = fraction(&mut random) * area;
            let facet = self.at(target);
            let point = self.point(mesh, facet, &mut random);
            cloud.push(point, self.normals[facet], self.ids[facet], area / count as f64);
        }
        cloud
    }

    /// Draws one point from each of `count` equal shares of the area (stratified sampling). The weights
    /// are 0: the points are candidates for decimation.
    pub(super) fn even(&self, mesh: &Mesh, count: usize, seed: u64) -> Cloud {
        let share = self.area() / count as f64;
        let draw = |range: Range<usize>| {
            let mut random = Pcg64::new(seed.into(), range.start as u128);
            let mut drawn = Cloud::with_capacity(range.len(), mesh.unit());
            for index in range {
                let facet = self.at((index as f64 + fraction(&mut random)) * share);
                let point = self.point(mesh, facet, &mut random);
                drawn.push(point, self.normals[facet], self.ids[facet], 0.0);
            }
            drawn
        };
        let mut cloud = Cloud::with_capacity(count, mesh.unit());
        for drawn in parallel::ranges(count, TOGETHER, draw) {
            cloud.points.extend(drawn.points);
            cloud.normals.extend(drawn.normals);
            cloud.triangles.extend(drawn.triangles);
            cloud.weights.extend(drawn.weights);
        }
        cloud
    }

    /// Returns the index of the triangle at which the cumulative area exceeds `target`.
    fn at(&self, target: f64) -> usize {
        self.areas_up_to.partition_point(|&up_to| up_to <= target).min(self.ids.len() - 1)
    }

    /// Draws a point of a triangle, uniformly by area.
    fn point(&self, mesh: &Mesh, facet: usize, random: &mut Pcg64) -> Point3<f64> {
        let [a, b, c] = mesh.triangle(TriangleId(self.ids[facet]));
        let (u, v) = (fraction(random), fraction(random));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a + u * (b - a) + v * (c - a)
    }
}

/// Returns a uniform number in [0, 1), a multiple of 2^-53. Its product with any area stays below that
/// area, rounded or not.
pub(super) fn fraction(random: &mut Pcg64) -> f64 {
    (random.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
