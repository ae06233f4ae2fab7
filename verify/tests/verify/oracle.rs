//! A brute-force oracle: sample points of triangles, sample times of motions, and the distance to each segment
//! of one profile in closed form. It shares no code with the library.

use nalgebra::{Point3, Vector3};
use touchoff::{Mesh, TriangleId};

/// The surfaces of the tool, in its order.
pub(crate) const SURFACES: [&str; 4] = ["ball", "flute", "shank", "nut"];

touchoff::tool! {
    tool Mounted "6 mm ball, flute to 10, 25 out of a nut" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 10) as flute cutting;
            line to (3, 25) as shank;
            line to (8, 25), (8, 40), (0, 40) as nut;
        }
        niceness cutting: 1;
    }
}

/// A tip and an axis.
pub(crate) type ToolPose = (Point3<f64>, Vector3<f64>);

/// Returns the distance of a point in the half plane to each surface.
fn distances([d, z]: [f64; 2]) -> [f64; 4] {
    let segment = |[a, b]: [f64; 2], [c, e]: [f64; 2]| {
        let (x, y) = (c - a, e - b);
        let t = (((d - a) * x + (z - b) * y) / (x * x + y * y)).clamp(0.0, 1.0);
        (d - a - t * x).hypot(z - b - t * y)
    };
    // The quarter of the circle below and beside (0, 3).
    let ball = if z <= 3.0 { (3.0 - d.hypot(z - 3.0)).abs() } else { (d - 3.0).hypot(z - 3.0) };
    let nut = [([3.0, 25.0], [8.0, 25.0]), ([8.0, 25.0], [8.0, 40.0]), ([8.0, 40.0], [0.0, 40.0])];
    [
        ball,
        segment([3.0, 3.0], [3.0, 10.0]),
        segment([3.0, 10.0], [3.0, 25.0]),
        nut.iter().map(|(from, to)| segment(*from, *to)).fold(f64::INFINITY, f64::min),
    ]
}

fn is_inside([d, z]: [f64; 2]) -> bool {
    match z {
        0.0..3.0 => d.hypot(z - 3.0) <= 3.0,
        3.0..25.0 => d <= 3.0,
        25.0..=40.0 => d <= 8.0,
        _ => false,
    }
}

/// Returns the coordinates `[d, z]` of a point in the half plane of a tool.
fn half_plane_coordinates(point: &Point3<f64>, (tip, axis): &ToolPose) -> [f64; 2] {
    let offset = point - tip;
    let z = offset.dot(axis);
    [(offset - axis * z).norm(), z]
}

/// Results of brute force per surface: the depth where it is the nearest, and the distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Worst {
    pub(crate) depth: [f64; 4],
    pub(crate) distance: [f64; 4],
}

impl Worst {
    pub(crate) fn none() -> Worst {
        Worst { depth: [0.0; 4], distance: [f64::INFINITY; 4] }
    }

    /// Adds a point of the part, for a tip and an axis of the tool.
    pub(crate) fn add(&mut self, point: &Point3<f64>, pose: &ToolPose) {
        let coordinates = half_plane_coordinates(point, pose);
        // No margin under test reaches farther.
        if coordinates[0] > 15.0 || !(-7.0..47.0).contains(&coordinates[1]) {
            return;
        }
        let distances = distances(coordinates);
        for (min_distance, distance) in self.distance.iter_mut().zip(distances) {
            *min_distance = min_distance.min(distance);
        }
        if is_inside(coordinates) {
            let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
            for (max_depth, distance) in self.depth.iter_mut().zip(distances) {
                // On a seam both surfaces are equally near.
                if distance - nearest <= 1e-9 {
                    *max_depth = max_depth.max(nearest);
                }
            }
        }
    }
}

/// Returns tip and axis at a time of a motion from 0 to 1: the tip moves straight, the axis turns evenly.
pub(crate) fn interpolate((from, to): (&ToolPose, &ToolPose), fraction: f64) -> ToolPose {
    let tip = from.0 + (to.0 - from.0) * fraction;
    let angle = from.1.cross(&to.1).norm().atan2(from.1.dot(&to.1));
    if angle < 1e-9 {
        return (tip, from.1);
    }
    let axis = from.1 * ((1.0 - fraction) * angle).sin() + to.1 * (fraction * angle).sin();
    (tip, axis.normalize())
}

/// Returns sample points of all triangles, at most `step` apart along their edges.
pub(crate) fn sample_points(mesh: &Mesh, step: f64) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for id in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let n = (longest / step).ceil() as u32;
        for i in 0..=n {
            for j in 0..=n - i {
                let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(n));
                points.push(a + (b - a) * u + (c - a) * v);
            }
        }
    }
    points
}

/// A reproducible generator of random numbers.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Returns a number that is uniformly distributed between two bounds.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Returns one of the first `count` numbers.
    pub(crate) fn choice(&mut self, count: usize) -> usize {
        self.between(0.0, count as f64) as usize
    }

    /// Returns true in a share of all calls.
    pub(crate) fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    pub(crate) fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from([0; 3].map(|_| self.between(-size, size)))
    }
}
