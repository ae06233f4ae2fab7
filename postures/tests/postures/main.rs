//! Validated and recorded postures: comparisons with sample points of triangles, and a running loop.

mod clearance;
mod crash;
mod path;
mod recorder;
mod refine;
mod stickout;
mod sweep;
mod validator;

use nalgebra::Point3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::LazyLock;
use sweep::sweep_all;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Pose, SurfaceId, Tool, TriangleId, Unit};

static MILL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Mill "a ball on a neck, in a wider holder" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 12) as flute cutting;
            line to (2.5, 12), (2.5, 20) as neck;
            line to (9, 20), (9, 40), (0, 40) as holder;
        }
        niceness cutting: 1 - depth/3;
    }"#
    .parse()
    .expect("a tool")
});

static BALL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Ball "nothing but a ball" {
        units mm;
        profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static PLAIN: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Plain "a ball without a profile" {
        units mm;
        region ball as ball cutting where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

/// Segments of a profile that do not cut, as `[d, z]`: the neck and the holder of a [`Mill`].
const NECK: [[f64; 2]; 3] = [[3.0, 12.0], [2.5, 12.0], [2.5, 20.0]];
const HOLDER: [[f64; 2]; 4] = [[2.5, 20.0], [9.0, 20.0], [9.0, 40.0], [0.0, 40.0]];

/// Returns the distance of a point to a polyline of the profile.
fn polyline_distance(polyline: &[[f64; 2]], [d, z]: [f64; 2]) -> f64 {
    let segment_distance = |ends: &[[f64; 2]]| {
        let [[fd, fz], [td, tz]] = [ends[0], ends[1]];
        let (dd, dz) = (td - fd, tz - fz);
        let t = (((d - fd) * dd + (z - fz) * dz) / (dd * dd + dz * dz)).clamp(0.0, 1.0);
        (d - fd - t * dd).hypot(z - fz - t * dz)
    };
    polyline.windows(2).map(segment_distance).fold(f64::INFINITY, f64::min)
}

/// Returns whether a point is inside a [`Mill`].
fn is_inside([d, z]: [f64; 2]) -> bool {
    let ball = z <= 3.0 && d.hypot(z - 3.0) <= 3.0;
    let stem = |radius: f64, low: f64, high: f64| d <= radius && low <= z && z <= high;
    ball || stem(3.0, 3.0, 12.0) || stem(2.5, 12.0, 20.0) || stem(9.0, 20.0, 40.0)
}

/// Returns the distance of a point to the cutting surfaces of a [`Mill`].
fn cutting_distance([d, z]: [f64; 2]) -> f64 {
    let to_ball = if z <= 3.0 { (d.hypot(z - 3.0) - 3.0).abs() } else { f64::INFINITY };
    to_ball.min(polyline_distance(&[[3.0, 3.0], [3.0, 12.0]], [d, z]))
}

fn parts() -> Vec<Mesh> {
    let low = Point3::new(-12.0, -10.0, -8.0);
    vec![
        shapes::cuboid(low, Point3::origin(), Unit::Millimetre).expect("a cuboid"),
        shapes::sphere(8.0, 2, Unit::Millimetre).expect("a sphere"),
        shapes::tube(4.0, 6.0, 25.0, 24, 3, Unit::Millimetre).expect("a tube"),
    ]
}

fn random_numbers(seed: u64) -> impl FnMut(f64, f64) -> f64 {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    move |low, high| low + (high - low) * (random.next_u64() as f64 / u64::MAX as f64)
}

fn random_pose(random: &mut impl FnMut(f64, f64) -> f64, size: f64) -> Pose {
    loop {
        let axis = nalgebra::Vector3::from_fn(|_, _| random(-1.0, 1.0));
        let tip = Point3::from(nalgebra::Vector3::from_fn(|_, _| random(-size, size)));
        if axis.norm() > 0.1
            && let Ok(pose) = Pose::from_axis(tip, axis.normalize())
        {
            return pose;
        }
    }
}

/// Number of divisions of a triangle's sides.
const DIVISIONS: u32 = 16;

/// Returns sample points of a mesh in the half plane of a tool at a pose, and the largest distance between
/// neighbours.
fn sample_points(mesh: &Mesh, pose: &Pose) -> (Vec<[f64; 2]>, f64) {
    let to_tool = pose.rotation().transpose();
    let (mut points, mut spacing) = (Vec::new(), 0f64);
    for id in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let (u, v) = ((b - a) / f64::from(DIVISIONS), (c - a) / f64::from(DIVISIONS));
        spacing = spacing.max(u.norm()).max(v.norm()).max((v - u).norm());
        for i in 0..=DIVISIONS {
            for j in 0..=DIVISIONS - i {
                let p = to_tool * (a + u * f64::from(i) + v * f64::from(j) - pose.tip());
                points.push([p.x.hypot(p.y), p.z]);
            }
        }
    }
    (points, spacing)
}

fn surface(tool: &dyn Tool, name: &str) -> SurfaceId {
    tool.info().surface_named(name).expect("a surface")
}
