//! The part as points: where the tool can be touched, which way is out there, and for how much
//! of the surface each point stands.

mod blue;
mod cells;
mod copies;
mod diagram;
mod draw;
mod error;
mod guess;
mod lists;
mod near;
#[cfg(test)]
mod odd;
mod pieces;
mod thin;

pub use error::CloudError;

use crate::mesh::{Mesh, Points, area_and_normal, coordinate_holds};
use crate::unit::Unit;
use crate::words::words;
use cells::Cells;
use diagram::Sites;
use draw::Facets;
use nalgebra::{Point3, Vector3};
use pieces::Surface;

/// Points whose normals are at more than 107°, a cosine below this, are on two sides of something thin.
const SAME_SIDE: f64 = -0.3;

/// How far the norm of a given normal may be from 1 before it is refused rather than normalised: files have normals with a
/// few decimals. A choice of what is taken for a mistake; what is kept has a norm of 1.
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

/// The most points that are spread evenly: they want some 12 GiB while they are.
pub const MOST_BLUE: usize = 20_000_000;

/// How far a surface gets from the points of a cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// The covering radius, or a bound on it: from any place of the surface to the nearest point.
    pub radius: f64,
    /// Whether it is proved, of a mesh, or estimated, from the points alone.
    pub proved: bool,
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
    /// Of four times as many random points the most crowded are taken away, until 96 in 100 of those
    /// wanted are left; the others are put, one by one, where the surface is farthest from all: so
    /// edges and corners of the part get points where that helps. The same mesh, count and seed
    /// give the same cloud, however many cores there are.
    ///
    /// # Errors
    /// A count of 0, or more than [`MOST_BLUE`].
    pub fn blue(mesh: &Mesh, count: usize, seed: u64) -> Result<Cloud, CloudError> {
        check_count(count)?;
        if count > MOST_BLUE {
            return Err(CloudError::TooManyBlue { count });
        }
        let facets = Facets::of(mesh);
        let surface = Surface::new(mesh, &facets, count);
        Ok(blue::blue(mesh, &facets, &surface, count, seed).weighed_on(&surface))
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
    /// of them, but no more than `most`: about `0.8 · area / radius²` of [`Sampling::Blue`].
    ///
    /// # Errors
    /// A radius that is no length, or that wants more than `most` points or [`MOST_BLUE`].
    pub fn covering(
        mesh: &Mesh,
        radius: f64,
        sampling: Sampling,
        most: usize,
        seed: u64,
    ) -> Result<Cloud, CloudError> {
        let most = most.min(MOST_BLUE);
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(CloudError::Radius { radius });
        }
        let area = Facets::of(mesh).spread;
        // The covering radius in roots of a point's share, as it usually is.
        let mut usual = match sampling {
            Sampling::Blue => 0.91,
            Sampling::Random => 2.1,
        };
        loop {
            let needed = area * (usual / radius).powi(2);
            if needed > most as f64 {
                let instead = usual * (area / most as f64).sqrt();
                return Err(CloudError::TooFine { radius, needed, most, instead });
            }
            let count = (needed.ceil() as usize).max(1);
            let cloud = Cloud::sample(mesh, sampling, count, seed)?;
            match cloud.cover {
                Some(cover) if cover.radius > radius => {
                    let here = cover.radius * (count as f64 / area).sqrt();
                    // Where few points are far apart more of them soon do better than that.
                    usual *= (1.005 * here / usual).clamp(1.005, 2.0);
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
        let count = places.len();
        let faces = faces.unwrap_or_else(|| (0..count as u32).collect());
        let estimated = areas.is_none();
        let weights = areas.unwrap_or_else(|| vec![0.0; count]);
        let mut cloud = Cloud::new(places, normals, faces, weights, unit)?;
        let (areas, radius) = guess::guess(&cloud.points, &cloud.normals);
        cloud.cover = radius.map(|radius| Cover { radius, proved: false });
        if estimated {
            cloud.weights = areas;
        }
        Ok(cloud)
    }

    /// The same points, each with the area of its cell on the mesh that they were taken from, in the same unit: the
    /// places that it is nearest to, of those on its side of an edge or of a thin sheet. Their sum
    /// is the mesh's area to rounding. And the cloud's [cover](Cloud::cover).
    #[must_use]
    pub fn weighed(self, mesh: &Mesh) -> Cloud {
        let surface = Surface::new(mesh, &Facets::of(mesh), self.len());
        self.weighed_on(&surface)
    }

    fn weighed_on(mut self, surface: &Surface) -> Cloud {
        let Cells { areas, radius } =
            surface.cells(&Sites::new(surface, &self.points, &self.normals));
        self.weights = areas;
        self.cover = Some(Cover { radius, proved: true });
        self
    }

    /// `count` of the points, or all if there are fewer, spread as evenly as can be, weighed anew
    /// ([`Cloud::weighed`]).
    #[must_use]
    pub fn thinned(&self, mesh: &Mesh, count: usize) -> Cloud {
        let facets = Facets::of(mesh);
        let mut cloud = Cloud::with_capacity(count.min(self.len()), self.unit);
        for index in thin::thin(&self.points, &self.normals, facets.spread, count.max(1)) {
            let index = index as usize;
            cloud.push(self.points[index], self.normals[index], self.triangles[index], 0.0);
        }
        let surface = Surface::new(mesh, &facets, cloud.len());
        cloud.weighed_on(&surface)
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
            check_place(point, place)?;
        }
        for (point, normal) in normals.iter_mut().enumerate() {
            *normal = unit_normal(point, *normal)?;
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

    /// How far the surface gets from the points; `None` where that is not known.
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

/// Whether a point is somewhere.
pub(crate) fn check_place(point: usize, place: &Point3<f64>) -> Result<(), CloudError> {
    match place.iter().find(|&&c| !coordinate_holds(c)) {
        Some(&coordinate) => Err(CloudError::Coordinate { point, coordinate }),
        None => Ok(()),
    }
}

/// A normal of length 1, from one that nearly is.
pub(crate) fn unit_normal(point: usize, normal: Vector3<f64>) -> Result<Vector3<f64>, CloudError> {
    let norm = normal.norm();
    // NaN is near nothing, and so refused.
    if (norm - 1.0).abs() <= NORMAL_TOLERANCE {
        Ok(normal / norm)
    } else {
        Err(CloudError::Normal { point, norm })
    }
}

#[cfg(test)]
mod tests;
