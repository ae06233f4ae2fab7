//! Parts, and poses at which a tool is likely to touch a part.

use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::{Mesh, MeshError, Pose, TriangleId, Unit, scenes};
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};

/// Returns the generated parts, in mm, with their names.
///
/// # Errors
/// Never for these dimensions.
pub fn parts() -> Result<Vec<(&'static str, Mesh)>, MeshError> {
    let [low, high] = [Point3::new(-20.0, -15.0, -10.0), Point3::new(20.0, 15.0, 0.0)];
    Ok(vec![
        ("tube", scenes::tube()),
        ("sphere", shapes::sphere(8.0, 4, Unit::Millimetre)?),
        ("cuboid", shapes::cuboid(low, high, Unit::Millimetre)?),
        ("bumpy", bumpy(20.0, 32)?),
    ])
}

/// Returns a wavy sheet `2 half` mm wide, with `divisions` squares per side and ridges between its triangles.
///
/// # Errors
/// Never for a positive width.
pub fn bumpy(half: f64, divisions: u32) -> Result<Mesh, MeshError> {
    let flat = shapes::plane(half, divisions, Unit::Millimetre)?;
    let mut draw = Rng::new(7);
    let raise = |p: &Point3<f64>| {
        let wave = 1.5 * (0.4 * p.x).sin() * (0.3 * p.y).cos();
        Point3::new(p.x, p.y, wave + draw.between(-0.3, 0.3))
    };
    let vertices = flat.vertices().iter().map(raise).collect();
    Mesh::new(vertices, flat.triangles().to_vec(), Unit::Millimetre)
}

fn unit(draw: &mut Rng) -> Vector3<f64> {
    Vector3::from(draw.direction())
}

/// Returns a random unit vector perpendicular to `way`.
fn beside(way: &Vector3<f64>, draw: &mut Rng) -> Vector3<f64> {
    loop {
        let other = unit(draw);
        let across = other - way * way.dot(&other);
        if across.norm() > 0.1 {
            return across.normalize();
        }
    }
}

/// Returns a random pose. Most poses press a point of the tool's surface slightly into a triangle, either facing it or
/// in any orientation. Some are along the coordinate axes and at round numbers, and some anywhere around the part.
///
/// # Panics
/// If the oracle has no surface.
pub fn pose(mesh: &Mesh, oracle: &Nearest, length: f64, draw: &mut Rng) -> Pose {
    match draw.bits() % 20 {
        0..=7 => touching(mesh, oracle, length, true, draw),
        8..=14 => touching(mesh, oracle, length, false, draw),
        15..=17 => aligned(mesh, oracle, length, draw),
        _ => anywhere(mesh, draw),
    }
}

fn made(tip: Point3<f64>, axis: Vector3<f64>) -> Pose {
    Pose::from_axis(tip, axis).expect("an axis")
}

/// Returns a random point of the tool's surface and the outward direction there, both as `[d, z]`.
fn of_surface(oracle: &Nearest, draw: &mut Rng) -> ([f64; 2], [f64; 2]) {
    loop {
        let pieces = oracle.profile().surface();
        let piece = &pieces[draw.bits() as usize % pieces.len()];
        let k = draw.bits() as usize % (piece.len() - 1);
        let (from, to) = (piece[k], piece[k + 1]);
        let way = [to[0] - from[0], to[1] - from[1]];
        let size = way[0].hypot(way[1]);
        if size > 0.0 {
            let part = draw.between(0.0, 1.0);
            let at = [from[0] + part * way[0], from[1] + part * way[1]];
            return (at, [way[1] / size, -way[0] / size]);
        }
    }
}

/// Returns a random depth from 1e-9 to about 6 mm, or sometimes minus that, for a gap.
fn press(draw: &mut Rng) -> f64 {
    let depth = 10f64.powf(draw.between(-9.0, 0.8));
    if draw.bits().is_multiple_of(8) { -depth } else { depth }
}

fn touching(mesh: &Mesh, oracle: &Nearest, length: f64, facing: bool, draw: &mut Rng) -> Pose {
    let id = (draw.bits() as usize % mesh.triangles().len()) as u32;
    let [a, b, c] = mesh.triangle(TriangleId(id));
    let (v, w) = (draw.between(0.0, 1.0), draw.between(0.0, 1.0));
    let (v, w) = if v + w > 1.0 { (1.0 - v, 1.0 - w) } else { (v, w) };
    let place = a + v * (b - a) + w * (c - a);
    let ([d, z], [out, up]) = of_surface(oracle, draw);
    let into = mesh.normal(TriangleId(id)).map_or_else(|| unit(draw), |normal| -normal);
    let (axis, radial) = if facing {
        let across = beside(&into, draw);
        (up * into + out * across, out * into - up * across)
    } else {
        let axis = unit(draw);
        let radial = beside(&axis, draw);
        (axis, radial)
    };
    let way = out * radial + up * axis;
    made(place - length * (d * radial + z * axis) + press(draw) * way, axis)
}

/// Returns a pose along a coordinate axis: flush with a corner of the part's box, tangent to its sides, or on a grid.
fn aligned(mesh: &Mesh, oracle: &Nearest, length: f64, draw: &mut Rng) -> Pose {
    let mut axis = Vector3::zeros();
    let upright = draw.bits() as usize % 3;
    axis[upright] = if draw.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
    let [low, high] = mesh.bounds();
    let corners = oracle.corners();
    let [d, z] = corners[draw.bits() as usize % corners.len()];
    let mut tip = Point3::origin();
    for k in 0..3 {
        let side = if draw.bits().is_multiple_of(2) { low[k] } else { high[k] };
        let grid = (draw.between(low[k], high[k]) * 2.0).round() / 2.0;
        tip[k] = match draw.bits() % 4 {
            0 if k == upright => side - z * length * axis[k],
            0 => side - d * length,
            1 if k != upright => side + d * length,
            1 => side,
            2 => grid,
            _ => draw.between(low[k], high[k]),
        };
    }
    made(tip, axis)
}

/// Returns a pose anywhere in a box twice the part's size, so that the tool may be entirely inside or far away.
fn anywhere(mesh: &Mesh, draw: &mut Rng) -> Pose {
    let [low, high] = mesh.bounds();
    let middle = nalgebra::center(&low, &high);
    let tip = [0, 1, 2].map(|k| middle[k] + (high[k] - low[k]) * draw.between(-1.0, 1.0));
    let axis = unit(draw);
    made(Point3::from(tip), axis)
}
