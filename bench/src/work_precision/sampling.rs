//! Sampling patterns and weights of clouds.

use touchoff::{Cloud, Mesh};

/// A sampling pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pattern {
    /// Points that are independent of each other: [`SamplingMethod::MonteCarlo`](touchoff::SamplingMethod::MonteCarlo).
    Random,
    /// Evenly spaced points: [`SamplingMethod::BlueNoise`](touchoff::SamplingMethod::BlueNoise).
    Blue,
}

impl Pattern {
    /// Both, in the order of tables.
    pub(super) const ALL: [Pattern; 2] = [Pattern::Random, Pattern::Blue];

    /// Returns the name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Pattern::Random => "random",
            Pattern::Blue => "blue",
        }
    }
}

/// Returns the same points with equal weights.
pub(super) fn equal(cloud: &Cloud, mesh: &Mesh) -> Cloud {
    let weights = vec![mesh.diagnostics().area / cloud.len() as f64; cloud.len()];
    let (points, normals) = (cloud.points().to_vec(), cloud.normals().to_vec());
    let triangles = cloud.triangles().to_vec();
    Cloud::new(points, normals, triangles, weights, cloud.unit()).expect("the lists of a cloud")
}
