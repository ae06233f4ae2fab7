//! The part as points: where the tool can be touched, which way is out there, and for how much
//! of the surface each point stands.

use nalgebra::{Point3, Vector3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::Unit;
use crate::mesh::{LARGEST_COORDINATE, Mesh, Sum, area_and_normal, coordinate_holds};

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
    /// error.
    ///
    /// The same mesh, count and seed give the same cloud on every machine, and the first points
    /// of a longer cloud are those of a shorter one. Each point takes three draws of PCG64 (its
    /// triangle and two barycentric coordinates, folded back into the triangle).
    ///
    /// # Errors
    /// A count of 0, or beyond 32 bits.
    pub fn random(mesh: &Mesh, count: usize, seed: u64) -> Result<Cloud, CloudError> {
        if u32::try_from(count).is_err() {
            return Err(CloudError::TooMany { count });
        }
        let facets = Facets::of(mesh);
        // A mesh has some area, so there is a last facet.
        let (Some(&area), true) = (facets.areas_up_to.last(), count > 0) else {
            return Err(CloudError::Empty);
        };
        let mut random = Pcg64::seed_from_u64(seed);
        let mut cloud = Cloud::with_capacity(count, mesh.unit());
        for _ in 0..count {
            let target = fraction(&mut random) * area;
            let facet = facets.areas_up_to.partition_point(|&up_to| up_to <= target);
            let id = facets.ids[facet];
            let [a, b, c] = mesh.triangle(id);
            let (u, v) = (fraction(&mut random), fraction(&mut random));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = a + u * (b - a) + v * (c - a);
            cloud.push(point, facets.normals[facet], id, area / count as f64);
        }
        Ok(cloud)
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
        if count == 0 {
            return Err(CloudError::Empty);
        }
        if u32::try_from(count).is_err() {
            return Err(CloudError::TooMany { count });
        }
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
        Ok(Cloud { points, normals, triangles, weights, unit })
    }

    fn with_capacity(count: usize, unit: Unit) -> Cloud {
        Cloud {
            points: Vec::with_capacity(count),
            normals: Vec::with_capacity(count),
            triangles: Vec::with_capacity(count),
            weights: Vec::with_capacity(count),
            unit,
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

/// The triangles that have an area, laid out for drawing among them.
struct Facets {
    ids: Vec<u32>,
    normals: Vec<Vector3<f64>>,
    /// The area of all facets up to and including each.
    areas_up_to: Vec<f64>,
}

impl Facets {
    fn of(mesh: &Mesh) -> Facets {
        let mut facets = Facets { ids: Vec::new(), normals: Vec::new(), areas_up_to: Vec::new() };
        let mut sum = Sum::default();
        let mut highest = 0f64;
        for (id, corners) in (0..).zip(mesh.corners()) {
            if let Some((area, normal)) = area_and_normal(&corners) {
                sum.add(area);
                // The search needs an ascending list; a compensated sum may step back by an ulp.
                highest = highest.max(sum.value());
                facets.ids.push(id);
                facets.normals.push(normal);
                facets.areas_up_to.push(highest);
            }
        }
        facets
    }
}

/// A number in [0, 1), a multiple of 2^-53: times any area it stays below that area, rounded or
/// not.
fn fraction(random: &mut Pcg64) -> f64 {
    (random.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    const UNIT: Unit = Unit::Millimetre;

    fn cuboid() -> Mesh {
        let high = Point3::new(1.0, 2.0, 4.0);
        shapes::cuboid(Point3::origin(), high, UNIT).expect("a cuboid")
    }

    /// Pearson's statistic of counts that should be in proportion to `shares`.
    fn chi_square(counts: &[f64], shares: &[f64]) -> f64 {
        let scale = counts.iter().sum::<f64>() / shares.iter().sum::<f64>();
        let terms = counts.iter().zip(shares.iter().map(|share| share * scale));
        terms.map(|(count, expected)| (count - expected).powi(2) / expected).sum()
    }

    #[test]
    fn random_points_lie_on_the_surface_and_share_its_area() {
        let mesh = shapes::tube(3.0, 5.0, 13.116, 96, 23, UNIT).expect("a tube");
        let cloud = Cloud::random(&mesh, 20_000, 7).expect("a cloud");
        assert_eq!((cloud.len(), cloud.unit()), (20_000, UNIT));
        let sum: f64 = cloud.weights().iter().sum();
        assert!((sum / mesh.survey().area - 1.0).abs() < 1e-11, "{sum}");
        for i in 0..cloud.len() {
            let id = cloud.triangles()[i];
            assert_eq!(Some(cloud.normals()[i]), mesh.normal(id));
            let off = (cloud.points()[i] - mesh.triangle(id)[0]).dot(&cloud.normals()[i]);
            assert!(off.abs() < 1e-14, "{off}");
        }
    }

    #[test]
    fn random_points_are_uniform() {
        let mesh = cuboid();
        let cloud = Cloud::random(&mesh, 60_000, 3).expect("a cloud");
        let areas: Vec<f64> = (0..12).map(|id| mesh.area(id)).collect();
        let mut counts = vec![0.0; 12];
        // On the side z = 0, which is 1 by 2, also by cells, whose shares are equal.
        let mut cells = vec![0.0; 32];
        for (point, &id) in cloud.points().iter().zip(cloud.triangles()) {
            counts[id as usize] += 1.0;
            if id / 2 == 4 {
                cells[(point.x * 4.0) as usize + 4 * (point.y * 4.0) as usize] += 1.0;
            }
        }
        // 11 and 31 degrees of freedom: chance goes beyond these once in a thousand seeds.
        let (sides, cells) = (chi_square(&counts, &areas), chi_square(&cells, &[1.0; 32]));
        assert!(sides < 31.3 && cells < 61.1, "{sides} {cells}");
    }

    #[test]
    fn a_seed_is_a_cloud() {
        let mesh = cuboid();
        let [a, b, c] = [(100, 1), (200, 1), (100, 2)]
            .map(|(count, seed)| Cloud::random(&mesh, count, seed).expect("a cloud"));
        assert_eq!(a.points(), &b.points()[..100]);
        assert_ne!(a.points(), c.points());
        // The stream is a promise: clouds in published measurements are named by their seed.
        let first = Point3::new(0.13120038523973798, 2.0, 0.06919470014228546);
        assert_eq!((a.triangles()[0], a.points()[0]), (7, first));
    }

    #[test]
    fn degenerate_triangles_are_never_touched() {
        let vertices = cuboid().vertices().to_vec();
        let triangles = vec![[0, 0, 1], [0, 1, 2], [3, 3, 3], [4, 5, 6], [7, 6, 7]];
        let mesh = Mesh::new(vertices, triangles, UNIT).expect("a mesh");
        let cloud = Cloud::random(&mesh, 1000, 0).expect("a cloud");
        assert!(cloud.triangles().iter().all(|id| [1, 3].contains(id)));
        assert_eq!(Cloud::centroids(&mesh).triangles(), [1, 3]);
        assert_eq!(Cloud::random(&mesh, 0, 0), Err(CloudError::Empty));
        if let Some(count) = (u32::MAX as usize).checked_add(1) {
            assert_eq!(Cloud::random(&mesh, count, 0), Err(CloudError::TooMany { count }));
        }
    }

    #[test]
    fn centroids_are_exact_for_affine_integrands() {
        let mesh = cuboid();
        let cloud = Cloud::centroids(&mesh);
        let affine = |p: &Point3<f64>| 1.0 + 2.0 * p.x - 3.0 * p.y + 4.0 * p.z;
        let sum: f64 = cloud.points().iter().zip(cloud.weights()).map(|(p, w)| w * affine(p)).sum();
        // By symmetry the mean of the surface is the middle of the box.
        assert!((sum - 28.0 * affine(&Point3::new(0.5, 1.0, 2.0))).abs() < 1e-12, "{sum}");
        // The divergence theorem: the weighted normals of a closed surface cancel.
        let normals = cloud.normals().iter().zip(cloud.weights()).map(|(n, w)| n * *w);
        assert!(normals.sum::<Vector3<f64>>().norm() < 1e-13);
    }

    #[test]
    fn clouds_from_elsewhere_are_checked() {
        let at = |x: f64| vec![Point3::origin(), Point3::new(x, 0.0, 0.0)];
        let up = |z: f64| vec![Vector3::z(), Vector3::new(0.0, 0.0, z)];
        let of = |x, z, w| Cloud::new(at(x), up(z), vec![0, 9], vec![1.0, w], UNIT);
        let cloud = of(1.0, 1.0009, 0.0).expect("a cloud");
        assert_eq!((cloud.normals()[1], cloud.triangles()), (Vector3::z(), &[0, 9][..]));
        let coordinate = CloudError::Coordinate { point: 1, coordinate: f64::INFINITY };
        assert_eq!(of(f64::INFINITY, 1.0, 1.0), Err(coordinate));
        for z in [1.01, 0.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(of(1.0, z, 1.0), Err(CloudError::Normal { point: 1, .. })));
        }
        for w in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(of(1.0, 1.0, w), Err(CloudError::Weight { point: 1, .. })));
        }
        let lengths = CloudError::Lengths { points: 2, normals: 2, triangles: 1, weights: 2 };
        let short = Cloud::new(at(1.0), up(1.0), vec![0], vec![1.0; 2], UNIT);
        assert_eq!(short, Err(lengths));
        let none = Cloud::new(vec![], vec![], vec![], vec![], UNIT);
        assert_eq!(none, Err(CloudError::Empty));
    }
}
