//! Random sampling of points on a mesh: the number, the method and the seed of the points, and how they are drawn.
//! Coincident triangles (the same three vertices in the same cyclic order) count once where points are spread evenly.

use crate::cancellation;
use crate::cloud::Cloud;
use crate::id::TriangleId;
use crate::keywords::keyword_enum;
use crate::mesh::{CompensatedSum, Mesh, area_and_normal};
use crate::parallel;
use nalgebra::Vector3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Methods of distributing points over a mesh and of weighing them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SamplingMethod {
    /// Evenly: no two points are close together, and no part of the surface is far from all. Each point has the area
    /// of its cell as weight.
    ///
    /// The most crowded of four times as many random points are removed until 96 % of the count are left. The
    /// remaining points are inserted one by one where the surface is farthest from all others, so edges and corners
    /// of the part get points where they help. The cloud is the same for any number of cores.
    #[default]
    BlueNoise,
    /// Independently and uniformly by area. Each point has the area of its cell as weight.
    Uniform,
    /// Independently and uniformly by area, each point with the weight `area / count`, and without a covering radius.
    ///
    /// A sum over the cloud differs from the integral by a standard deviation of order `count^-1/2`, whatever the
    /// integrand's smoothness: four times the points halve the error. The first points of a longer cloud are those of
    /// a shorter one. Each point takes three draws of PCG64: its triangle and two barycentric coordinates, folded
    /// back into the triangle.
    MonteCarlo,
}

keyword_enum!(
    SamplingMethod, "blue, random, monte-carlo",
    BlueNoise "blue", Uniform "random", MonteCarlo "monte-carlo"
);

/// The number of points to sample on a mesh, the method, and the seed. Equal samplings of equal meshes give equal
/// clouds on every machine.
///
/// ```
/// use touchoff::cloud::Sampling;
///
/// let even = Sampling::new(20_000);
/// let random = Sampling::monte_carlo(20_000).with_seed(7);
/// assert_ne!(even, random);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sampling {
    /// The number of points, from 1 to 2³² - 1, or to [`MAX_BLUE_NOISE_POINTS`](super::MAX_BLUE_NOISE_POINTS).
    pub count: usize,
    /// The method.
    pub method: SamplingMethod,
    /// The seed of the random numbers.
    pub seed: u64,
}

impl Sampling {
    /// Returns a sampling of evenly spread points, with seed 1.
    pub const fn new(count: usize) -> Sampling {
        Sampling { count, method: SamplingMethod::BlueNoise, seed: 1 }
    }

    /// Returns a sampling of independent points with equal weights, with seed 1.
    pub const fn monte_carlo(count: usize) -> Sampling {
        Sampling { count, method: SamplingMethod::MonteCarlo, seed: 1 }
    }

    /// Sets the method.
    #[must_use]
    pub const fn with_method(mut self, method: SamplingMethod) -> Sampling {
        self.method = method;
        self
    }

    /// Sets the seed.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Sampling {
        self.seed = seed;
        self
    }
}

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
        // Small areas must not be lost beside the sum of a million others.
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
    fn area(&self) -> f64 {
        self.areas_up_to.last().copied().unwrap_or_default()
    }

    /// Samples independently and uniformly; see [`SamplingMethod::MonteCarlo`](super::SamplingMethod::MonteCarlo).
    pub(super) fn random(&self, mesh: &Mesh, count: usize, seed: u64) -> Cloud {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut cloud = Cloud::with_capacity(count, mesh.unit());
        let area = self.area();
        for _ in 0..count {
            cancellation::check();
            let target = fraction(&mut random) * area;
            self.push_sample(mesh, target, area / count as f64, &mut random, &mut cloud);
        }
        cloud
    }

    /// Draws one point from each of `count` equal shares of the area (stratified sampling). The weights
    /// are 0: the points are candidates for decimation.
    pub(super) fn stratified(&self, mesh: &Mesh, count: usize, seed: u64) -> Cloud {
        let share = self.area() / count as f64;
        let parts = parallel::ranges(count, POINTS_PER_TASK, |range| {
            // A stream of its own for each range: the cloud is the same for any number of cores.
            let mut random = Pcg64::new(seed.into(), range.start as u128);
            let mut samples = Cloud::with_capacity(range.len(), mesh.unit());
            for index in range {
                let target = (index as f64 + fraction(&mut random)) * share;
                self.push_sample(mesh, target, 0.0, &mut random, &mut samples);
            }
            samples
        });
        let mut cloud = Cloud::with_capacity(count, mesh.unit());
        for samples in parts {
            cloud.points.extend(samples.points);
            cloud.normals.extend(samples.normals);
            cloud.triangles.extend(samples.triangles);
            cloud.weights.extend(samples.weights);
        }
        cloud
    }

    /// Appends a point drawn uniformly from the triangle at which the cumulative area exceeds `target`.
    fn push_sample(
        &self,
        mesh: &Mesh,
        target: f64,
        weight: f64,
        random: &mut Pcg64,
        cloud: &mut Cloud,
    ) {
        let index = self.areas_up_to.partition_point(|&up_to| up_to <= target);
        let index = index.min(self.ids.len() - 1);
        let triangle = TriangleId(self.ids[index]);
        let [a, b, c] = mesh.triangle(triangle);
        let (u, v) = (fraction(random), fraction(random));
        // The other half of the parallelogram, turned over, covers the triangle evenly, too.
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        cloud.push(a + u * (b - a) + v * (c - a), self.normals[index], triangle, weight);
    }
}

/// Returns a uniform number in [0, 1), a multiple of 2^-53. Its product with any area stays below that
/// area, rounded or not.
pub(super) fn fraction(random: &mut Pcg64) -> f64 {
    (random.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// The number of coincident triangles that each triangle of a mesh represents; `None` if all triangles are distinct.
pub(super) struct Copies(Option<Vec<u32>>);

impl Copies {
    fn of(mesh: &Mesh) -> Copies {
        let mut keyed: Vec<([u32; 3], u32)> = mesh
            .triangles()
            .iter()
            .zip(0..)
            .map(|(&[a, b, c], id)| {
                // The rotation that begins with the least vertex is the same for all copies; the mirrored order is
                // another side.
                let rotations = [[a, b, c], [b, c, a], [c, a, b]];
                (rotations.into_iter().min().unwrap_or_default(), id)
            })
            .collect();
        parallel::sort(&mut keyed);
        if keyed.windows(2).all(|pair| pair[0].0 != pair[1].0) {
            return Copies(None);
        }
        let mut counts = vec![0; keyed.len()];
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            counts[same[0].1 as usize] = same.len() as u32;
        }
        Copies(Some(counts))
    }

    /// Returns the number of copies of a triangle, including itself, or 0 if one with a lower id represents it.
    pub(super) fn count(&self, triangle: u32) -> u32 {
        self.0.as_ref().map_or(1, |counts| counts[triangle as usize])
    }
}
