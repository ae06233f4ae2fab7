//! Benchmark scenes: poses of the tool of Ho (1999), fig. 7.3, around a tube.
//!
//! The tube stands on z = 0 about the z axis, with inner radius [`INNER`], outer radius [`OUTER`] and
//! height [`HEIGHT`], in mm. With `c` the centre of the tool's ball (radius [`BALL`]) and `a` the unit
//! vector from the spindle to the tip, the pose has tip `c + a` and axis `−a`. Angles are in radians, `u
//! = k/n`, and `n̂ = (cos φ, sin φ, 0)`. The ball penetrates by `δ(u) = δ₀ (1 + 0.9 sin 130u)`. One δ₀
//! serves every number of points, so that collisions grow in proportion to it.

use crate::mesh::Mesh;
use crate::mesh::shapes;
use crate::pose::Pose;
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;

/// Radius of the bore, mm.
pub const INNER: f64 = 3.0;
/// Radius of the outer wall, mm.
pub const OUTER: f64 = 5.0;
/// Height of the tube, mm: with the radii, the area of the part in Ho (1999), 759.8 mm².
pub const HEIGHT: f64 = 13.116;
/// Radius of the tool's ball, and distance from its centre to the tip, mm.
pub const BALL: f64 = 1.0;
/// Number of poses of a path in the published measurements.
pub const POSES: usize = 10_000;

/// Returns the tube as a mesh. It deviates from the true cylinders by at most 2.4e-5 mm, a
/// five-hundredth of the paths' depths.
pub fn tube() -> Mesh {
    shapes::tube(INNER, OUTER, HEIGHT, 1024, 1, Unit::Millimetre).expect("a tube by construction")
}

/// A path of the tool along the tube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScenePath {
    /// The ball winds up the outer wall, then the side of the cutter runs along the top edge.
    Outside,
    /// The cutter runs about the bore.
    Inside,
    /// The taper, spindle and housing are driven into the rim.
    Hold,
}

impl ScenePath {
    /// All paths.
    pub const ALL: [ScenePath; 3] = [ScenePath::Outside, ScenePath::Inside, ScenePath::Hold];

    /// Returns the path's keyword: `outside`, `inside` or `hold`.
    pub const fn name(self) -> &'static str {
        match self {
            ScenePath::Outside => "outside",
            ScenePath::Inside => "inside",
            ScenePath::Hold => "hold",
        }
    }

    /// Returns pose `k` of the `n` poses of the path, in mm; `k < n`.
    pub fn pose(self, k: usize, n: usize) -> Pose {
        let u = fraction(k, n);
        match self {
            ScenePath::Outside if u < 0.6 => wall_pose(u),
            ScenePath::Outside => edge_pose(u),
            ScenePath::Inside => bore_pose(u),
            ScenePath::Hold => rim_pose(u),
        }
    }
}

/// Returns pose `k` of `n` with the ball at distance `gap` (mm) from the outer wall, so that nothing
/// touches: `φ = 10πu`, `c = (6 + gap) n̂ + (0, 0, 1.5 + 10u)`, `a = −n̂ cos 0.4 + (−sin φ, cos φ, 0)
/// sin 0.4`.
///
/// # Panics
/// Panics if `gap` is NaN or infinite.
pub fn pose_at_gap(gap: f64, k: usize, n: usize) -> Pose {
    let u = fraction(k, n);
    let phi = 10.0 * PI * u;
    let a = -0.4f64.cos() * radial(phi) + 0.4f64.sin() * tangential(phi);
    pose_at(cylindrical(OUTER + BALL + gap, phi, 1.5 + 10.0 * u), a)
}

/// Returns a pose of the first 60 % of outside. With `v = u/0.6`: `φ = 10πv`, `z = 1.5 + 10v`, tilt `τ =
/// 0.5 + 0.45 sin 23v`, `ψ = 17v`, `t = (−sin φ cos ψ, cos φ cos ψ, sin ψ)`; `c = (6 − δ) n̂ + (0, 0,
/// z)`, `a = −n̂ cos τ + t sin τ`.
fn wall_pose(u: f64) -> Pose {
    let v = u / 0.6;
    let phi = 10.0 * PI * v;
    let tilt = 0.5 + 0.45 * (23.0 * v).sin();
    let (sin, cos) = (17.0 * v).sin_cos();
    let t = cos * tangential(phi) + sin * Vector3::z();
    let a = -tilt.cos() * radial(phi) + tilt.sin() * t;
    pose_at(cylindrical(OUTER + BALL - outside_depth(u), phi, 1.5 + 10.0 * v), a)
}

/// Returns a pose of the last 40 % of outside. With `v = (u − 0.6)/0.4`: `φ = 6πv`, `c = ((6 − 0.3δ) n̂,
/// H − 2 − 1.5 sin 19v)`, `a ∝ (0.03 sin(31v) cos φ − 0.02 sin φ, 0.03 sin(31v) sin φ + 0.02 cos φ,
/// −1)`.
fn edge_pose(u: f64) -> Pose {
    let v = (u - 0.6) / 0.4;
    let phi = 6.0 * PI * v;
    let lean = 0.03 * (31.0 * v).sin() * radial(phi) + 0.02 * tangential(phi);
    let z = HEIGHT - 2.0 - 1.5 * (19.0 * v).sin();
    pose_at(cylindrical(OUTER + BALL - 0.3 * outside_depth(u), phi, z), lean - Vector3::z())
}

/// Returns a pose of inside: `φ = 16πu`, `c = ((2 + δ) n̂, H − 2.3 − 1.4 sin 19u)`, `a ∝ (0.002 sin(31u) n̂, −1)`.
fn bore_pose(u: f64) -> Pose {
    let phi = 16.0 * PI * u;
    let lean = 0.002 * (31.0 * u).sin() * radial(phi);
    let z = HEIGHT - 2.3 - 1.4 * (19.0 * u).sin();
    pose_at(cylindrical(INNER - BALL + depth(0.0124, u), phi, z), lean - Vector3::z())
}

/// Returns a pose of hold: `φ = 50πu`, tilt `τ = 12° · sin(35.4πu)`, `c = ((1.2 + 0.9 sin 15.8πu) n̂, H
/// − 6.5 − 2.5 cos 6.6πu)`, `a = (sin τ n̂, −cos τ)`.
fn rim_pose(u: f64) -> Pose {
    let phi = 50.0 * PI * u;
    let tilt = 12f64.to_radians() * (35.4 * PI * u).sin();
    let radius = 1.2 + 0.9 * (15.8 * PI * u).sin();
    let z = HEIGHT - 6.5 - 2.5 * (6.6 * PI * u).cos();
    pose_at(cylindrical(radius, phi, z), tilt.sin() * radial(phi) - tilt.cos() * Vector3::z())
}

fn outside_depth(u: f64) -> f64 {
    depth(0.0536, u)
}

/// Returns the penetration `δ(u)` for its `δ₀`, mm.
fn depth(mean: f64, u: f64) -> f64 {
    mean * (1.0 + 0.9 * (130.0 * u).sin())
}

/// Returns `k/n`, finite for every `n`.
fn fraction(k: usize, n: usize) -> f64 {
    k as f64 / n.max(1) as f64
}

/// Returns `n̂`, the direction away from the tube's axis.
fn radial(phi: f64) -> Vector3<f64> {
    Vector3::new(phi.cos(), phi.sin(), 0.0)
}

/// Returns the direction around the tube's axis.
fn tangential(phi: f64) -> Vector3<f64> {
    Vector3::new(-phi.sin(), phi.cos(), 0.0)
}

/// Returns a point from cylindrical coordinates.
fn cylindrical(radius: f64, phi: f64, z: f64) -> Point3<f64> {
    Point3::from(radius * radial(phi) + z * Vector3::z())
}

/// Returns the pose whose ball is centred at `c` and whose axis runs along `a` from spindle to tip.
fn pose_at(c: Point3<f64>, a: Vector3<f64>) -> Pose {
    let a = a.normalize();
    Pose::from_axis(c + BALL * a, -a).expect("a path's points are finite and its axes unit vectors")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the centre of the ball and its distance from the tube's axis.
    fn ball(pose: &Pose) -> (Point3<f64>, f64) {
        let c = pose.tip() + pose.axis() * BALL;
        (c, c.x.hypot(c.y))
    }

    fn poses(path: ScenePath) -> impl Iterator<Item = (f64, Pose)> {
        (0..POSES).map(move |k| (k as f64 / POSES as f64, path.pose(k, POSES)))
    }

    fn is_close(found: f64, expected: f64) -> bool {
        (found - expected).abs() < 1e-12
    }

    /// Compares with tips and axes computed from the formulas independently of this code.
    #[test]
    fn poses_match_the_formulas() {
        for (found, tip, axis) in [
            (
                ScenePath::Outside.pose(3400, POSES),
                [2.038912176828, -4.795871649479, 7.032875449389],
                [0.929078210311, -0.344838497422, 0.133791217277],
            ),
            (
                ScenePath::Outside.pose(8700, POSES),
                [5.933005861199, 0.959934092413, 9.732910713775],
                [-0.02279593158, -0.02384880051, 0.999455641946],
            ),
            (
                ScenePath::Inside.pose(3400, POSES),
                [-0.377201285261, -1.977358384369, 9.569748856274],
                [-0.000336539485, -0.00176420176, 0.999998387165],
            ),
            (
                ScenePath::Hold.pose(3400, POSES),
                [-0.395425722494, 0.0, 3.815506768873],
                [0.023634385123, 0.0, 0.999720668907],
            ),
            (
                pose_at_gap(0.5, 3400, POSES),
                [-1.353628111417, -5.426223181361, 4.9],
                [-0.65498235202, -0.755644174557, 0.0],
            ),
        ] {
            assert!((found.tip() - Point3::from(tip)).norm() < 1e-11, "{found:?}");
            assert!((found.axis() - Vector3::from(axis)).norm() < 1e-11, "{found:?}");
        }
    }

    #[test]
    fn the_ball_enters_the_outer_wall_by_delta() {
        for (u, pose) in poses(ScenePath::Outside) {
            let delta = 0.0536 * (1.0 + 0.9 * (130.0 * u).sin());
            let expected_depth = if u < 0.6 { delta } else { 0.3 * delta };
            assert!(is_close(ball(&pose).1, OUTER + BALL - expected_depth), "{u}");
        }
    }

    #[test]
    fn the_ball_enters_the_bore_by_delta() {
        for (u, pose) in poses(ScenePath::Inside) {
            let (c, radius) = ball(&pose);
            assert!(is_close(radius, INNER - BALL + 0.0124 * (1.0 + 0.9 * (130.0 * u).sin())));
            assert!((HEIGHT - 3.7 - 1e-9..=HEIGHT - 0.9 + 1e-9).contains(&c.z));
            assert!(pose.axis().z > 0.999_99);
        }
    }

    #[test]
    fn the_holder_tilts_by_twelve_degrees_at_most() {
        let max_tilt =
            poses(ScenePath::Hold).map(|(_, pose)| pose.axis().z.acos()).fold(0.0, f64::max);
        assert!((max_tilt.to_degrees() - 12.0).abs() < 1e-3);
    }

    #[test]
    fn pose_at_gap_keeps_the_gap() {
        for k in 0..POSES {
            assert!(is_close(ball(&pose_at_gap(0.5, k, POSES)).1, 6.5));
        }
    }

    #[test]
    fn zero_poses_do_not_divide_by_zero() {
        for path in ScenePath::ALL {
            assert_eq!(path.pose(0, 0), path.pose(0, 1), "{}", path.name());
        }
    }
}
