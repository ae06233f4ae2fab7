//! The part as points: where the tool can be touched, which way is out there, and for how much
//! of the surface each point stands.

mod blue;
mod cells;
mod draw;
mod guess;
mod near;
mod thin;

use crate::Unit;
use crate::mesh::{LARGEST_COORDINATE, Mesh, Points, area_and_normal, coordinate_holds};
use crate::words::words;
use cells::{Cells, Sites, Surface};
use draw::Facets;
use nalgebra::{Point3, Vector3};

/// How far the norm of a given normal may be from 1 before it is refused rather than normalised.
pub const NORMAL_TOLERANCE: f64 = 1e-3;

/// A weighted point cloud on a part's surface.
///
/// All four lists have the same, non-zero length. Points are in the world's frame and in
/// [`Cloud::unit`]; normals are unit vectors out of the material; triangles are the ids of the
/// mesh's triangles that the points lie on; weights are areas, in the unit's square, so that
/// `Σ weight · f(point)` approximates the integral of f over the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    triangles: Vec<u32>,
    weights: Vec<f64>,
    unit: Unit,
    cover: Option<Cover>,
}

/// How points are spread over a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// Evenly: [`Cloud::blue`].
    #[default]
    Blue,
    /// Each for itself: [`Cloud::random`], weighed by the area of their cells.
    Random,
}

words!(Sampling, "blue, random", Blue "blue", Random "random");

/// The most points that [`Cloud::covering`] takes: they want some 8 GiB while they are spread.
pub const MOST_COVERING: usize = 20_000_000;

/// How far a surface gets from the points of a cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// The covering radius, or a bound on it: from any place of the surface to the nearest point.
    pub radius: f64,
    /// Whether it is proved, of a mesh, or estimated, from the points alone.
    pub proved: bool,
}

/// Lists that make no cloud, or a wish for one that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CloudError {
    /// There is nothing to touch.
    #[error("the cloud has no point: ask for one at least")]
    Empty,
    /// More points than 32-bit indices can tell apart.
    #[error("{count} points are more than 32-bit indices can tell apart: ask for fewer")]
    TooMany {
        /// How many were asked for.
        count: usize,
    },
    /// A covering radius that is no length.
    #[error("{radius} is no covering radius: give a finite length above 0")]
    Radius {
        /// What was asked for.
        radius: f64,
    },
    /// A covering radius that wants too many points.
    #[error(
        "a covering radius of {radius} wants about {needed:.1e} points, more than {MOST_COVERING}, \
         which would have one of about {instead:.3}: ask for that, or ask the triangles \
         (`certify`), between which nothing lies"
    )]
    TooFine {
        /// What was asked for.
        radius: f64,
        /// About how many points it wants.
        needed: f64,
        /// About what so many points as there can be have.
        instead: f64,
    },
    /// The lists do not belong together.
    #[error(
        "{points} points, {normals} normals, {triangles} triangle ids and {weights} weights: give \
         one of each for every point"
    )]
    Lengths {
        /// How many points there are.
        points: usize,
        /// How many normals there are.
        normals: usize,
        /// How many triangle ids there are.
        triangles: usize,
        /// How many weights there are.
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
    /// A normal is not a direction.
    #[error(
        "the normal of point {point} has norm {norm}: give a unit vector (within \
         {NORMAL_TOLERANCE} of 1)"
    )]
    Normal {
        /// The point's index.
        point: usize,
        /// The normal's norm; NaN when a component is.
        norm: f64,
    },
    /// A weight is not an area.
    #[error("the weight of point {point} is {weight}: give a finite area, 0 or more")]
    Weight {
        /// The point's index.
        point: usize,
        /// The weight.
        weight: f64,
    },
}

impl Cloud {
    /// `count` points drawn independently and uniformly by area, each with the weight
    /// `area / count`. A sum over the cloud differs from the integral by a standard deviation of
    /// order `count^-1/2`, whatever the integrand's smoothness: four times the points, half the
    /// error. [`Cloud::weighed`] gives them weights that do better.
    ///
    /// The same mesh, count and seed give the same cloud on every machine, and the first points
    /// of a longer cloud are those of a shorter one. Each point takes three draws of PCG64 (its
    /// triangle and two barycentric coordinates, folded back into the triangle).
    ///
    /// # Errors
    /// A count of 0, or beyond 32 bits.
    pub fn random(mesh: &Mesh, count: usize, seed: u64) -> Result<Cloud, CloudError> {
        let facets = Facets::of(mesh);
        check_count(count)?;
        Ok(facets.random(mesh, count, seed))
    }

    /// `count` points spread evenly, no two close together and no place far from all, each with
    /// the area of its cell for a weight, and how far the surface gets from them ([`Cloud::cover`]).
    ///
    /// Of five times as many random points the most crowded are taken away, until 98 in 100 of those
    /// wanted are left; the others are put, one by one, where the surface is farthest from all: so
    /// edges and corners of the part get points where that helps. The same mesh, count and seed
    /// give the same cloud, however many cores there are.
    ///
    /// # Errors
    /// A count of 0, or beyond 32 bits with the points that are taken away.
    pub fn blue(mesh: &Mesh, count: usize, seed: u64) -> Result<Cloud, CloudError> {
        check_count(count.saturating_mul(blue::CANDIDATES))?;
        let cloud = blue::blue(mesh, &Facets::of(mesh), count, seed);
        Ok(cloud.weighed(mesh))
    }

    /// `count` points spread as is said, weighed, their cover known.
    ///
    /// # Errors
    /// A count of 0, or beyond 32 bits.
    pub fn sample(
        mesh: &Mesh,
        sampling: Sampling,
        count: usize,
        seed: u64,
    ) -> Result<Cloud, CloudError> {
        match sampling {
            Sampling::Blue => Cloud::blue(mesh, count, seed),
            Sampling::Random => Ok(Cloud::random(mesh, count, seed)?.weighed(mesh)),
        }
    }

    /// As many points as it takes for no place of the surface to be farther than `radius` from all
    /// of them: about `0.8 · area / radius²` of [`Sampling::Blue`].
    ///
    /// # Errors
    /// A radius that is no length, or that wants more than [`MOST_COVERING`] points.
    pub fn covering(
        mesh: &Mesh,
        radius: f64,
        sampling: Sampling,
        seed: u64,
    ) -> Result<Cloud, CloudError> {
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(CloudError::Radius { radius });
        }
        let area = Facets::of(mesh).area();
        // The covering radius in roots of a point's share, as it usually is.
        let mut usual = match sampling {
            Sampling::Blue => 0.91,
            Sampling::Random => 2.1,
        };
        loop {
            let needed = area * (usual / radius).powi(2);
            if needed > MOST_COVERING as f64 {
                let instead = usual * (area / MOST_COVERING as f64).sqrt();
                return Err(CloudError::TooFine { radius, needed, instead });
            }
            let count = (needed.ceil() as usize).max(1);
            let cloud = Cloud::sample(mesh, sampling, count, seed)?;
            match cloud.cover {
                Some(cover) if cover.radius > radius => {
                    let here = cover.radius * (count as f64 / area).sqrt();
                    usual = (1.005 * usual).max(1.005 * here);
                }
                _ => return Ok(cloud),
            }
        }
    }

    /// Points of a surface that is not known as a mesh, with unit normals out of the material. Where no
    /// areas are given they are estimated from how close neighbours are, and so is the
    /// [cover](Cloud::cover). Where no faces are given each point is its own.
    ///
    /// # Errors
    /// See [`Cloud::new`].
    pub fn from_points(points: Points, unit: Unit) -> Result<Cloud, CloudError> {
        let Points { places, normals, faces, areas } = points;
        let count = places.len() as u32;
        let weights = vec![0.0; places.len()];
        let faces = faces.unwrap_or_else(|| (0..count).collect());
        let mut cloud = Cloud::new(places, normals, faces, weights, unit)?;
        let guess = guess::guess(&cloud.points, &cloud.normals);
        cloud.cover = Some(Cover { radius: guess.radius, proved: false });
        cloud.weights = areas.unwrap_or(guess.areas);
        match cloud.weights.iter().position(|weight| !(weight.is_finite() && *weight >= 0.0)) {
            Some(point) => Err(CloudError::Weight { point, weight: cloud.weights[point] }),
            None => Ok(cloud),
        }
    }

    /// The same points, each with the area of its cell on the mesh that they were taken from: the
    /// places that it is nearest to, of those on its side of an edge or of a thin sheet. Their sum
    /// is the mesh's area to rounding. And the cloud's [cover](Cloud::cover).
    #[must_use]
    pub fn weighed(mut self, mesh: &Mesh) -> Cloud {
        let surface = Surface::new(mesh, Facets::of(mesh).area(), self.len());
        let Cells { areas, radius } =
            surface.cells(&Sites::new(&surface, &self.points, &self.normals));
        self.weights = areas;
        self.cover = Some(Cover { radius, proved: true });
        self
    }

    /// One point for each triangle that has an area: its centroid, with that area as weight.
    /// Sums over it are exact, but for rounding, for functions that are affine on each triangle;
    /// for smooth ones the error is of second order in the length of the edges, and of first
    /// order where the integrand begins or ends within triangles, as contact does.
    pub fn centroids(mesh: &Mesh) -> Cloud {
        let mut cloud = Cloud::with_capacity(mesh.triangles().len(), mesh.unit());
        for (id, corners) in (0..).zip(mesh.corners()) {
            if let Some((area, normal)) = area_and_normal(&corners) {
                let [a, b, c] = corners;
                cloud.push(a + ((b - a) + (c - a)) / 3.0, normal, id, area);
            }
        }
        cloud
    }

    /// A cloud made elsewhere: n points in the world's frame and in `unit`, n normals out of the
    /// material, n ids of the triangles they lie on (any numbers that tell the caller what was
    /// touched), n areas in the square of `unit`.
    ///
    /// Normals whose norm is within [`NORMAL_TOLERANCE`] of 1 are normalised, others refused.
    ///
    /// # Errors
    /// No points or too many, lists of different lengths, a number that is not finite, a normal
    /// that is no unit vector, a negative weight.
    pub fn new(
        points: Vec<Point3<f64>>,
        mut normals: Vec<Vector3<f64>>,
        triangles: Vec<u32>,
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
        for (point, place) in points.iter().enumerate() {
            if let Some(&coordinate) = place.iter().find(|&&c| !coordinate_holds(c)) {
                return Err(CloudError::Coordinate { point, coordinate });
            }
        }
        for (point, normal) in normals.iter_mut().enumerate() {
            let norm = normal.norm();
            // NaN is near nothing, and so refused.
            let near_one = (norm - 1.0).abs() <= NORMAL_TOLERANCE;
            if !near_one {
                return Err(CloudError::Normal { point, norm });
            }
            *normal /= norm;
        }
        for (point, &weight) in weights.iter().enumerate() {
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(CloudError::Weight { point, weight });
            }
        }
        Ok(Cloud { points, normals, triangles, weights, unit, cover: None })
    }

    fn with_capacity(count: usize, unit: Unit) -> Cloud {
        Cloud {
            points: Vec::with_capacity(count),
            normals: Vec::with_capacity(count),
            triangles: Vec::with_capacity(count),
            weights: Vec::with_capacity(count),
            unit,
            cover: None,
        }
    }

    fn push(&mut self, point: Point3<f64>, normal: Vector3<f64>, triangle: u32, weight: f64) {
        self.points.push(point);
        self.normals.push(normal);
        self.triangles.push(triangle);
        self.weights.push(weight);
    }

    /// The points, in the world's frame and in [`Cloud::unit`].
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The unit normal at each point, out of the material.
    pub fn normals(&self) -> &[Vector3<f64>] {
        &self.normals
    }

    /// The id of the mesh's triangle that each point lies on.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// The area for which each point stands, in the square of [`Cloud::unit`].
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// How far the surface gets from the points; `None` where that was not found out.
    pub fn cover(&self) -> Option<Cover> {
        self.cover
    }

    /// The unit of length.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// How many points there are: one at least.
    #[expect(clippy::len_without_is_empty, reason = "a cloud is never empty")]
    pub fn len(&self) -> usize {
        self.points.len()
    }
}

/// Whether 32-bit indices can tell so many points apart.
fn check_count(count: usize) -> Result<(), CloudError> {
    match count {
        0 => Err(CloudError::Empty),
        _ if u32::try_from(count).is_err() => Err(CloudError::TooMany { count }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
