//! The thesis's tube as points, poses along it, cuboids, parts of given points, and tools of given profiles.

use crate::oracle::restated::Restated;
use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::scenes::{ScenePath, tube};
use touchoff::tool::Interpreted;
use touchoff::{Cloud, Mesh, Part, Pose, Sampling, TriangleId, Unit};

/// Returns the tool that a restatement draws, read at run time; the niceness of what cuts is a formula.
///
/// # Panics
/// If the compiler refuses it.
pub fn interpreted(tool: &Restated, niceness: &str) -> Interpreted {
    let profile = tool.text(|number| number.to_f64().to_string());
    let law = format!("niceness cutting: {niceness};");
    let law = if tool.cutting.is_empty() { "" } else { &law };
    let text = format!("tool {} {{ units mm; {profile} {law} }}", tool.name);
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Returns the tool of a [drawing][Restated::drawn] and the surfaces that cut, with a niceness of 1.
pub fn drawn(drawing: &'static str, cutting: &'static str) -> Interpreted {
    let tool = Restated::drawn("Drawn", drawing, &[]).cuts(cutting);
    interpreted(&tool, "1")
}

/// Returns the part of these points, in mm, with their normals and weights. The triangle of each is its index.
///
/// # Panics
/// If they are no cloud.
pub fn part_of(points: Vec<Point3<f64>>, normals: Vec<Vector3<f64>>, weights: Vec<f64>) -> Part {
    part_in(Unit::Millimetre, points, normals, weights)
}

/// Returns the [part of points][part_of] that are given in a unit.
///
/// # Panics
/// If they are no cloud.
pub fn part_in(
    unit: Unit,
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    weights: Vec<f64>,
) -> Part {
    let ids = (0..points.len() as u32).map(TriangleId).collect();
    Part::from_cloud(&Cloud::new(points, normals, ids, weights, unit).expect("a cloud"))
}

/// Returns the part of these points, in mm, all of weight 1 and with the same normal.
pub fn part_at(points: &[Point3<f64>]) -> Part {
    let count = points.len();
    part_of(points.to_vec(), vec![Vector3::x(); count], vec![1.0; count])
}

/// Returns a cuboid with edges along the coordinate axes, in mm.
///
/// # Panics
/// If it has no volume.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

/// Radius of [`ball`], mm.
pub const BALL: f64 = 3.0;

/// Returns a tool that is a ball, all of which cuts. Its centre is on the axis.
///
/// # Panics
/// If the compiler rejects it.
pub fn ball() -> Interpreted {
    "tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } niceness cutting: 1; }"
        .parse()
        .expect("a tool")
}

/// Returns the tube as `points` points.
///
/// # Panics
/// If `points` is 0.
pub fn part(points: usize) -> Part {
    let mesh = tube();
    let cloud =
        Cloud::sample(&mesh, Sampling::monte_carlo(points)).expect("the tube has a surface");
    Part::new(&cloud, mesh.diagnostics())
}

/// Returns `count` poses along a path.
pub fn poses(path: ScenePath, count: usize) -> Vec<Pose> {
    (0..count).map(|k| path.pose(k, count)).collect()
}
