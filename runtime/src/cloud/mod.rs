//! Weighted point clouds on a part's surface: positions, outward normals, and the area that each point represents.

mod blue_noise;
mod estimate;
mod neighbours;
mod orient;
mod pieces;
mod sampling;
mod voronoi;

pub use sampling::{Sampling, SamplingMethod};

use crate::id::TriangleId;
use crate::mesh::{LARGEST_COORDINATE, Mesh, OrientedPoints, area_and_normal, is_valid_coordinate};
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use pieces::Surface;
use sampling::AreaSampler;
use voronoi::{Cells, VoronoiSites};

/// Cosine of the angle between normals (107°) below which two points lie on opposite sides of something thin.
const SAME_SIDE: f64 = -0.3;

/// Largest deviation of a given normal's norm from 1: files round normals to a few decimals. A normal within this
/// tolerance is normalised, any other is refused. The value is a choice of what counts as a mistake.
pub const NORMAL_TOLERANCE: f64 = 1e-3;

/// A weighted point cloud on a part's surface.
///
/// All four lists have the same, non-zero length. Points are in the world frame and in [`Cloud::unit`]. Normals are
/// unit vectors out of the material. Triangles are the ids of the mesh's triangles that the points lie on. Weights are
/// areas, in the square of the unit, so that `Σ weight · f(point)` approximates the integral of f over the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    triangles: Vec<TriangleId>,
    weights: Vec<f64>,
    unit: Unit,
    covering_radius: Option<CoveringRadius>,
}

/// Maximum number of points for blue-noise sampling. That many points need some 12 GiB of memory during sampling.
pub const MAX_BLUE_NOISE_POINTS: usize = 20_000_000;

/// The covering radius of a cloud: the largest distance from a surface point to the nearest point of the cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CoveringRadius {
    /// The covering radius or an upper bound on it, in the cloud's unit.
    pub radius: f64,
    /// `true` if the radius is proved for a mesh, `false` if it is estimated from the points alone.
    pub proved: bool,
}

/// Reasons why lists do not form a cloud, or why a requested cloud cannot be built.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// The cloud would have no points.
    #[error("the cloud has no point: ask for one at least")]
    Empty,
    /// There are more points than 32-bit indices can number.
    #[error("{count} points are more than 32-bit indices can tell apart: ask for fewer")]
    TooMany {
        /// The requested number of points.
        count: usize,
    },
    /// There are more points than [`MAX_BLUE_NOISE_POINTS`].
    #[error(
        "{count} points are more than {MAX_BLUE_NOISE_POINTS}, the most that are spread evenly: take random ones"
    )]
    TooManyBlueNoise {
        /// The requested number of points.
        count: usize,
    },
    /// The covering radius is not a positive finite length.
    #[error("{radius} is no covering radius: give a finite length above 0")]
    Radius {
        /// The requested covering radius.
        radius: f64,
    },
    /// The covering radius needs too many points.
    #[error(
        "a covering radius of {radius} needs about {needed:.1e} points, more than {limit}, \
         which give one of about {attainable:.2e}: ask for that, or query the triangles \
         (`certify`), between which nothing lies"
    )]
    TooFine {
        /// The requested covering radius.
        radius: f64,
        /// The approximate number of points it needs.
        needed: f64,
        /// The maximum number of points.
        limit: usize,
        /// The approximate covering radius of that maximum number of points.
        attainable: f64,
    },
    /// The lists have different lengths.
    #[error(
        "{points} points, {normals} normals, {triangles} triangle ids and {weights} weights: give \
         one of each for every point"
    )]
    Lengths {
        /// The number of points.
        points: usize,
        /// The number of normals.
        normals: usize,
        /// The number of triangle ids.
        triangles: usize,
        /// The number of weights.
        weights: usize,
    },
    /// A coordinate is NaN, infinite or too large.
    #[error(
        "point {point} has the coordinate {coordinate}: coordinates must be finite and within \
         {LARGEST_COORDINATE:e}"
    )]
    Coordinate {
        /// The point's index.
        point: usize,
        /// The coordinate.
        coordinate: f64,
    },
    /// A normal is not a unit vector.
    #[error(
        "the normal of point {point} has norm {norm}: give a unit vector (within \
         {NORMAL_TOLERANCE} of 1)"
    )]
    Normal {
        /// The point's index.
        point: usize,
        /// The normal's norm; NaN if a component is NaN.
        norm: f64,
    },
    /// Points without normals, so that their outer side is unknown.
    #[error(
        "the points have no normals, so their outer side is unknown: export them with `nx`, `ny` and `nz`, or export the mesh, with \
         its faces"
    )]
    NoNormals,
    /// A weight is not a valid area.
    #[error("the weight of point {point} is {weight}: give a finite area, 0 or more")]
    Weight {
        /// The point's index.
        point: usize,
        /// The weight.
        weight: f64,
    },
}

crate::debug_as_sentence!(CloudError);

impl Cloud {
    /// Samples points of a mesh. Points that are not drawn by [`SamplingMethod::MonteCarlo`] have the areas of their
    /// cells as weights and a proved [covering radius](Cloud::covering_radius).
    ///
    /// # Errors
    /// Fails for a count of 0 or beyond 32 bits, and for more than [`MAX_BLUE_NOISE_POINTS`] with
    /// [`SamplingMethod::BlueNoise`].
    pub fn sample(mesh: &Mesh, sampling: Sampling) -> Result<Cloud, CloudError> {
        let Sampling { count, method, seed } = sampling;
        check_count(count)?;
        let sampler = AreaSampler::of(mesh);
        match method {
            SamplingMethod::BlueNoise if count > MAX_BLUE_NOISE_POINTS => {
                Err(CloudError::TooManyBlueNoise { count })
            }
            SamplingMethod::BlueNoise => {
                let surface = Surface::new(mesh, &sampler, count);
                let cloud = blue_noise::sample_blue_noise(mesh, &sampler, &surface, count, seed);
                Ok(cloud.weighted_on(&surface))
            }
            SamplingMethod::Uniform => {
                Ok(sampler.random(mesh, count, seed).with_voronoi_weights(mesh))
            }
            SamplingMethod::MonteCarlo => Ok(sampler.random(mesh, count, seed)),
        }
    }

    /// Samples as many points as it takes for a covering radius of at most `radius`, in the mesh's unit, but no more
    /// than `sampling.count`. With [`SamplingMethod::BlueNoise`] these are about `0.8 · area / radius²` points.
    ///
    /// # Errors
    /// Fails if `radius` is not positive and finite, or needs more than `sampling.count` points or
    /// [`MAX_BLUE_NOISE_POINTS`].
    pub fn with_covering_radius(
        mesh: &Mesh,
        radius: f64,
        sampling: Sampling,
    ) -> Result<Cloud, CloudError> {
        let max_count = sampling.count.min(MAX_BLUE_NOISE_POINTS);
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(CloudError::Radius { radius });
        }
        let area = AreaSampler::of(mesh).distinct_area;
        // Typical covering radius, divided by the square root of the area per point.
        let mut ratio = match sampling.method {
            SamplingMethod::BlueNoise => 0.91,
            SamplingMethod::Uniform | SamplingMethod::MonteCarlo => 2.1,
        };
        loop {
            let required_count = area * (ratio / radius).powi(2);
            if required_count > max_count as f64 {
                // The radius falls with the square root of the area per point.
                let attainable = ratio * (area / max_count as f64).sqrt();
                return Err(CloudError::TooFine {
                    radius,
                    needed: required_count,
                    limit: max_count,
                    attainable,
                });
            }
            let count = (required_count.ceil() as usize).max(1);
            let mut cloud = Cloud::sample(mesh, Sampling { count, ..sampling })?;
            // A Monte Carlo cloud keeps its equal weights, but its radius is needed here.
            if cloud.covering_radius.is_none() {
                cloud.covering_radius = cloud.clone().with_voronoi_weights(mesh).covering_radius;
            }
            match cloud.covering_radius {
                Some(covering_radius) if covering_radius.radius > radius => {
                    let measured = covering_radius.radius * (count as f64 / area).sqrt();
                    // Where few points are far apart, more of them soon do better than that.
                    ratio *= (1.005 * measured / ratio).clamp(1.005, 2.0);
                }
                _ => return Ok(cloud),
            }
        }
    }

    /// Builds a cloud from points of a surface without a mesh, with unit normals out of the material. Without given
    /// areas, these are estimated from the distances between neighbours. The [covering radius](Cloud::covering_radius)
    /// is always estimated that way. Without given triangles, each point has its own.
    ///
    /// # Errors
    /// See [`Cloud::new`], and [`CloudError::NoNormals`] for points without normals.
    pub fn from_points(points: OrientedPoints, unit: Unit) -> Result<Cloud, CloudError> {
        let OrientedPoints { points, normals, triangles, areas, left_out: _ } = points;
        if normals.is_empty() && !points.is_empty() {
            return Err(CloudError::NoNormals);
        }
        let count = points.len();
        let triangles = triangles.unwrap_or_else(|| (0..count as u32).map(TriangleId).collect());
        let estimated = areas.is_none();
        let weights = areas.unwrap_or_else(|| vec![0.0; count]);
        let mut cloud = Cloud::new(points, normals, triangles, weights, unit)?;
        let (areas, radius) = estimate::estimate(&cloud.points, &cloud.normals);
        // Between points without a mesh the surface may do anything.
        cloud.covering_radius = radius.map(|radius| CoveringRadius { radius, proved: false });
        if estimated {
            cloud.weights = areas;
        }
        Ok(cloud)
    }

    /// Builds a cloud from points of a surface without a mesh and without normals. Depths and the tool's directions need none; normals
    /// are fitted to neighbours, for the estimate of areas alone: on which side of the points the material is cannot be known, and laws
    /// of force that depend on it ([`Law`](crate::Law)) have no meaning.
    ///
    /// # Errors
    /// See [`Cloud::new`].
    pub fn from_points_without_normals(
        points: OrientedPoints,
        unit: Unit,
    ) -> Result<Cloud, CloudError> {
        for (index, point) in points.points.iter().enumerate() {
            check_position(index, point)?;
        }
        let normals = match points.points.is_empty() {
            true => Vec::new(),
            false => orient::estimate(&points.points),
        };
        Cloud::from_points(OrientedPoints { normals, ..points }, unit)
    }

    /// Returns the same points, weighted by the areas of their cells on the mesh that they were sampled
    /// from, in the same unit. A point's cell is the part of the surface nearest to it among the points
    /// on the same side of an edge or of a thin sheet. The weights add up to the mesh's area, except for
    /// rounding. The cloud also gets a proved [covering radius](Cloud::covering_radius).
    #[must_use]
    pub fn with_voronoi_weights(self, mesh: &Mesh) -> Cloud {
        let surface = Surface::new(mesh, &AreaSampler::of(mesh), self.len());
        self.weighted_on(&surface)
    }

    fn weighted_on(mut self, surface: &Surface) -> Cloud {
        let Cells { areas, radius } =
            surface.cells(&VoronoiSites::new(surface, &self.points, &self.normals));
        self.weights = areas;
        self.covering_radius = Some(CoveringRadius { radius, proved: true });
        self
    }

    /// Selects `count` of the points, or all if there are fewer, spread as evenly as possible, and
    /// computes new weights ([`Cloud::with_voronoi_weights`]).
    #[must_use]
    pub fn decimated(&self, mesh: &Mesh, count: usize) -> Cloud {
        let sampler = AreaSampler::of(mesh);
        let mut cloud = Cloud::with_capacity(count.min(self.len()), self.unit);
        for index in
            blue_noise::decimate(&self.points, &self.normals, sampler.distinct_area, count.max(1))
        {
            cloud.push_of(self, index as usize);
        }
        let surface = Surface::new(mesh, &sampler, cloud.len());
        cloud.weighted_on(&surface)
    }

    /// Places one point at the centroid of each triangle that has an area, with that area as weight.
    /// Sums over the cloud are exact, except for rounding, for functions that are affine on each
    /// triangle. For smooth functions the error is of second order in the length of the edges. It is of
    /// first order where the integrand begins or ends within triangles, as contact does.
    pub fn centroids(mesh: &Mesh) -> Cloud {
        let mut cloud = Cloud::with_capacity(mesh.triangles().len(), mesh.unit());
        for (id, corners) in (0..).zip(mesh.corners()) {
            if let Some((area, normal)) = area_and_normal(&corners) {
                let [a, b, c] = corners;
                cloud.push(a + ((b - a) + (c - a)) / 3.0, normal, TriangleId(id), area);
            }
        }
        cloud
    }

    /// Builds a cloud from n points in the world frame and in `unit`, n normals out of the material, n
    /// ids of the triangles they lie on, and n areas in the square of `unit`. The ids may be any numbers
    /// that tell the caller which triangle was touched.
    ///
    /// Normals whose norm is within [`NORMAL_TOLERANCE`] of 1 are normalised, others refused.
    ///
    /// # Errors
    /// Fails for no points or too many, lists of different lengths, a number that is not finite, a
    /// normal that is not a unit vector, or a negative weight.
    pub fn new(
        points: Vec<Point3<f64>>,
        mut normals: Vec<Vector3<f64>>,
        triangles: Vec<TriangleId>,
        weights: Vec<f64>,
        unit: Unit,
    ) -> Result<Cloud, CloudError> {
        let count = points.len();
        if [normals.len(), triangles.len(), weights.len()] != [count; 3] {
            return Err(CloudError::Lengths {
                points: count,
                normals: normals.len(),
                triangles: triangles.len(),
                weights: weights.len(),
            });
        }
        check_count(count)?;
        for (point, position) in points.iter().enumerate() {
            check_position(point, position)?;
        }
        for (point, normal) in normals.iter_mut().enumerate() {
            *normal = unit_normal(point, *normal)?;
        }
        for (point, &weight) in weights.iter().enumerate() {
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(CloudError::Weight { point, weight });
            }
        }
        Ok(Cloud { points, normals, triangles, weights, unit, covering_radius: None })
    }

    fn with_capacity(count: usize, unit: Unit) -> Cloud {
        Cloud {
            points: Vec::with_capacity(count),
            normals: Vec::with_capacity(count),
            triangles: Vec::with_capacity(count),
            weights: Vec::with_capacity(count),
            unit,
            covering_radius: None,
        }
    }

    fn push(
        &mut self,
        point: Point3<f64>,
        normal: Vector3<f64>,
        triangle: TriangleId,
        weight: f64,
    ) {
        self.points.push(point);
        self.normals.push(normal);
        self.triangles.push(triangle);
        self.weights.push(weight);
    }

    /// Appends a point of another cloud, without weight.
    fn push_of(&mut self, other: &Cloud, index: usize) {
        self.push(other.points[index], other.normals[index], other.triangles[index], 0.0);
    }

    /// Returns the points, in the world frame and in [`Cloud::unit`].
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Returns the unit normal at each point, out of the material.
    pub fn normals(&self) -> &[Vector3<f64>] {
        &self.normals
    }

    /// Returns the id of the mesh's triangle that each point lies on.
    pub fn triangles(&self) -> &[TriangleId] {
        &self.triangles
    }

    /// Returns the area that each point represents, in the square of [`Cloud::unit`].
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Returns the covering radius, or `None` if it is unknown.
    pub fn covering_radius(&self) -> Option<CoveringRadius> {
        self.covering_radius
    }

    /// Returns the unit of length.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the number of points, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a cloud is never empty")]
    pub fn len(&self) -> usize {
        self.points.len()
    }
}

/// Fails unless `count` is at least 1 and fits 32-bit indices.
fn check_count(count: usize) -> Result<(), CloudError> {
    match count {
        0 => Err(CloudError::Empty),
        _ if u32::try_from(count).is_err() => Err(CloudError::TooMany { count }),
        _ => Ok(()),
    }
}

/// Fails unless all coordinates of a point are valid.
pub(crate) fn check_position(point: usize, position: &Point3<f64>) -> Result<(), CloudError> {
    match position.iter().find(|&&c| !is_valid_coordinate(c)) {
        Some(&coordinate) => Err(CloudError::Coordinate { point, coordinate }),
        None => Ok(()),
    }
}

/// Normalises a normal whose norm is within [`NORMAL_TOLERANCE`] of 1; fails otherwise.
pub(crate) fn unit_normal(point: usize, normal: Vector3<f64>) -> Result<Vector3<f64>, CloudError> {
    let norm = normal.norm();
    // NaN fails this comparison and is refused.
    if (norm - 1.0).abs() <= NORMAL_TOLERANCE {
        Ok(normal / norm)
    } else {
        Err(CloudError::Normal { point, norm })
    }
}

#[cfg(test)]
mod tests;
