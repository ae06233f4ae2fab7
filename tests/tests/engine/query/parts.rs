//! Parts for the queries, and random poses. The triangle ids of their clouds are the points' own indices in the cloud, so that a
//! contact can be told from its neighbours.

use crate::prelude::*;
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Sampling};
pub(crate) use touchoff_tests::fixtures::part_of as of;

pub(crate) const UNIT: Unit = Unit::Millimetre;

/// Returns a part of random points of a mesh, mapped by `at`.
pub(crate) fn carried(mesh: &Mesh, count: usize, at: impl Fn(Point3<f64>) -> Point3<f64>) -> Part {
    let cloud = Cloud::sample(mesh, Sampling::monte_carlo(count)).expect("a cloud");
    let points = cloud.points().iter().copied().map(at).collect();
    of(points, cloud.normals().to_vec(), cloud.weights().to_vec())
}

pub(crate) fn tube_mesh() -> Mesh {
    shapes::tube(3.0, 5.0, touchoff::scenes::HEIGHT, 256, 4, UNIT).expect("a tube")
}

pub(crate) fn tube(count: usize) -> Part {
    carried(&tube_mesh(), count, |p| p)
}

pub(crate) fn sphere(radius: f64, count: usize) -> Part {
    carried(&shapes::sphere(radius, 4, UNIT).expect("a ball"), count, |p| p)
}

pub(crate) fn cuboid(half: f64, count: usize) -> Part {
    let corner = Vector3::new(half, 0.7 * half, 0.5 * half);
    let mesh = shapes::cuboid((-corner).into(), corner.into(), UNIT).expect("a box");
    carried(&mesh, count, |p| p)
}

/// Returns points anywhere in a cube, with random normals and weights.
pub(crate) fn soup(half: f64, count: usize, seed: u64) -> Part {
    let mut rng = Rng::new(seed);
    let points = (0..count).map(|_| Point3::from(vector(&mut rng, half))).collect();
    let normals = (0..count).map(|_| direction(&mut rng)).collect();
    let weights = (0..count).map(|_| rng.between(0.0, 2.0)).collect();
    of(points, normals, weights)
}

/// Returns a part of the same point `count` times.
pub(crate) fn identical(at: Point3<f64>, count: usize) -> Part {
    let mut rng = Rng::new(9);
    let normals = (0..count).map(|_| direction(&mut rng)).collect();
    of(vec![at; count], normals, vec![0.5; count])
}

pub(crate) fn vector(rng: &mut Rng, half: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.between(-half, half))
}

pub(crate) fn direction(rng: &mut Rng) -> Vector3<f64> {
    Vector3::from(rng.direction())
}

/// Returns a pose of random orientation that brings the tool's own point `in_tool` to `at`.
pub(crate) fn bringing(in_tool: Vector3<f64>, at: Point3<f64>, rng: &mut Rng) -> Pose {
    let turned = Pose::from_quaternion(Point3::origin(), rng.quaternion()).expect("a pose");
    let quaternion = turned.to_isometry().rotation.coords.into();
    Pose::from_quaternion(at - turned.rotation() * in_tool, quaternion).expect("a pose")
}

/// Returns a pose about a part: one in eight far off, the others with some point of the part in the tool or hardly
/// outside.
pub(crate) fn about(part: &Part, oracle: &dyn Oracle, k: usize, rng: &mut Rng) -> Pose {
    let tree = part.tree();
    let point = tree.point(rng.index(tree.len()));
    let [width, height] = oracle.extent();
    if k % 8 == 7 {
        let distance = rng.between(1.0, 4.0) * 10f64.powi(rng.bits() as i32 & 3);
        return bringing(vector(rng, height), point + distance * height * direction(rng), rng);
    }
    if !oracle.is_revolved() {
        // A solid may fill little of the box about it, so the point is near a face or a splitting surface.
        let curves = oracle.curve_points();
        let curve = &curves[rng.index(curves.len())];
        let own = Vector3::from(curve[rng.index(curve.len())]);
        return bringing(own + vector(rng, 0.02 * height), point, rng);
    }
    let axis = direction(rng);
    let d = 1.05 * width * rng.between(0.0, 1.0);
    let z = rng.between(-0.05, 1.05) * height;
    let d = d / axis.x.hypot(axis.y).max(1e-9);
    bringing(Vector3::new(d * axis.x, d * axis.y, z), point, rng)
}
