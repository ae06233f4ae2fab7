//! The number, the method and the seed of points that are sampled on a mesh.

use crate::keywords::keyword_enum;

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
