//! Clouds of a mesh by how their points are spread, and what each counts for.

use touchoff::{Cloud, Mesh};

/// A pattern of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pattern {
    /// Independently of each other: [`Cloud::random`].
    Random,
    /// Evenly: [`Cloud::blue`].
    Blue,
}

impl Pattern {
    /// Both, in the order of tables.
    pub(super) const ALL: [Pattern; 2] = [Pattern::Random, Pattern::Blue];

    /// Returns the word for it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Pattern::Random => "random",
            Pattern::Blue => "blue",
        }
    }
}

/// Returns the same points with equal weights.
pub(super) fn equal(cloud: &Cloud, mesh: &Mesh) -> Cloud {
    let weights = vec![mesh.survey().area / cloud.len() as f64; cloud.len()];
    let (points, normals) = (cloud.points().to_vec(), cloud.normals().to_vec());
    let triangles = cloud.triangles().to_vec();
    Cloud::new(points, normals, triangles, weights, cloud.unit()).expect("the lists of a cloud")
}
