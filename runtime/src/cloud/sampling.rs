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
const POINTS_PER_TASK: usize = 1 << 12;

/// The triangles that have an area, with cumulative areas for sampling.
pub(super) struct AreaSampler {
    ids: Vec<u32>,
    normals: Vec<Vector3<f64>>,
    /// The area of all triangles up to and including each.
    areas_up_to: Vec<f64>,
    pub(super) copies: Copies,
    /// The total area with coincident triangles counted once: the area that points spread over.
    pub(super) distinct_area: f64,
}

impl AreaSampler {
    pub(super) fn of(mesh: &Mesh) -> AreaSampler {
        let mut sampler = AreaSampler {
            ids: Vec::new(),
            normals: Vec::new(),
            areas_up_to: Vec::new(),
            copies: Copies::of(mesh),
            distinct_area: 0.0,
        };
        let (mut sum, mut distinct) = (CompensatedSum::default(), CompensatedSum::default());
        let mut max_so_far = 0f64;
        for (id, corners) in (0..).zip(mesh.corners()) {
            if let Some((area, normal)) = area_and_normal(&corners) {
                sum.add(area);
                // The search needs an ascending list; a compensated sum may step back by an ulp.
                max_so_far = max_so_far.max(sum.value());
                sampler.ids.push(id);
                sampler.normals.push(normal);
                sampler.areas_up_to.push(max_so_far);
                if sampler.copies.count(id) > 0 {
                    distinct.add(area);
                    sampler.distinct_area = sampler.distinct_area.max(distinct.value());
                }
            }
        }
        sampler
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
            let sample_index = self.index_at(target);
            let point = self.point(mesh, sample_index, &mut random);
            cloud.push(
                point,
                self.normals[sample_index],
                TriangleId(self.ids[sample_index]),
                area / count as f64,
            );
        }
        cloud
    }

    /// Draws one point from each of `count` equal shares of the area (stratified sampling). The weights
    /// are 0: the points are candidates for decimation.
    pub(super) fn stratified(&self, mesh: &Mesh, count: usize, seed: u64) -> Cloud {
        let share = self.area() / count as f64;
        let sample_range = |range: Range<usize>| {
            let mut random = Pcg64::new(seed.into(), range.start as u128);
            let mut samples = Cloud::with_capacity(range.len(), mesh.unit());
            for index in range {
                let sample_index = self.index_at((index as f64 + fraction(&mut random)) * share);
                let point = self.point(mesh, sample_index, &mut random);
                samples.push(
                    point,
                    self.normals[sample_index],
                    TriangleId(self.ids[sample_index]),
                    0.0,
                );
            }
            samples
        };
        let mut cloud = Cloud::with_capacity(count, mesh.unit());
        for samples in parallel::ranges(count, POINTS_PER_TASK, sample_range) {
            cloud.points.extend(samples.points);
            cloud.normals.extend(samples.normals);
            cloud.triangles.extend(samples.triangles);
            cloud.weights.extend(samples.weights);
        }
        cloud
    }

    /// Returns the index of the triangle at which the cumulative area exceeds `target`.
    fn index_at(&self, target: f64) -> usize {
        self.areas_up_to.partition_point(|&up_to| up_to <= target).min(self.ids.len() - 1)
    }

    /// Draws a point of a triangle, uniformly by area.
    fn point(&self, mesh: &Mesh, sample_index: usize, random: &mut Pcg64) -> Point3<f64> {
        let [a, b, c] = mesh.triangle(TriangleId(self.ids[sample_index]));
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
