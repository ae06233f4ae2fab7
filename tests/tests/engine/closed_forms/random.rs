//! Random clouds: errors fall as the inverse square root of the number of points.

use super::{
    Figures, Scene, UNIT, ball_in_a_plane, ball_on_a_ball, cap_height, figures, measure,
    side_in_a_bore, side_in_a_plane,
};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Part, Pose, Sampling};
use touchoff_tests::oracle::closed_forms::quadrature;
use touchoff_tests::oracle::rng::Rng;

/// Compares the errors of the four figures on random clouds of a mesh with their standard deviations, over seeds
/// and four numbers of points, each four times the last. `squares` are the integrals of the squares of the four
/// integrands.
fn scatters(what: &str, mesh: &Mesh, squares: Figures, scenes: impl Fn(u64) -> Scene) {
    const SEEDS: u64 = 24;
    let area = mesh.diagnostics().area;
    let counts = [1_000usize, 4_000, 16_000, 64_000];
    let mut logs = Vec::new();
    let (mut sum, mut square) = ([0.0; 4], [0.0; 4]);
    for count in counts {
        let mut errors = [0.0; 4];
        for seed in 0..SEEDS {
            let scene = scenes(seed);
            // A longer cloud begins with the shorter one of its seed: other seeds for every count.
            let cloud =
                Cloud::sample(mesh, Sampling::monte_carlo(count).with_seed(count as u64 + seed))
                    .expect("a cloud");
            let part = Part::from_cloud(&cloud);
            let (got, _) = measure(&scene, &part);
            for (k, want) in figures(&scene.want).into_iter().enumerate() {
                let deviation = ((area * squares[k] - want * want) / count as f64).sqrt();
                let z = (got[k] - want) / deviation;
                sum[k] += z;
                square[k] += z * z;
                errors[k] += (got[k] - want).powi(2);
            }
        }
        logs.push(errors.map(|e: f64| (e / SEEDS as f64).sqrt().ln()));
    }
    let all = (counts.len() as u64 * SEEDS) as f64;
    for k in 0..4 {
        // Least squares over log₄ of the count: -1.5, -0.5, 0.5, 1.5.
        let fit: f64 = logs.iter().zip([-1.5, -0.5, 0.5, 1.5]).map(|(l, x)| l[k] * x).sum();
        let slope = fit / 5.0 / 4f64.ln();
        let (mean, spread) = (sum[k] / all, (square[k] / all).sqrt());
        println!("{what} {k}: slope {slope:.3} mean z {mean:.3} rms z {spread:.3}");
        // About three standard deviations of each, over 96 clouds.
        assert!((slope + 0.5).abs() < 0.16, "{what} {k}: slope {slope}");
        assert!(mean.abs() < 0.35, "{what} {k}: mean {mean}");
        assert!((0.75..1.25).contains(&spread), "{what} {k}: spread {spread}");
    }
}

/// Computes `∫ f² dA` over a contact for the integrands of the four figures. `at` gives the depth and the
/// components of `u` and `n` along the axis; `area` is the area per unit of the parameter.
fn squares(area: f64, [from, to]: [f64; 2], at: impl Fn(f64) -> (f64, f64, f64)) -> Figures {
    let integrate = |f: &dyn Fn(f64, f64, f64) -> f64| {
        area * quadrature(from, to, |s| {
            let (m, u, n) = at(s);
            f(m, u, n)
        })
    };
    [
        integrate(&|m, _, _| m * m),
        integrate(&|m, u, n| (m * (n - u)).powi(2)),
        integrate(&|m, u, _| (m * u).powi(2)),
        integrate(&|m, _, _| m.powi(4) / 4.0),
    ]
}

#[test]
fn cf1_a_ball_in_a_plane_random() {
    let h: f64 = 0.4;
    let mesh = shapes::plane(1.0, 3, UNIT).expect("a plane");
    // The parameter is the square of the radius, q: dA = π dq.
    let at = |q: f64| {
        let s = (q + (1.0 - h).powi(2)).sqrt();
        (1.0 - s, -(1.0 - h) / s, 1.0)
    };
    let squares = squares(PI, [0.0, h * (2.0 - h)], at);
    scatters("CF1", &mesh, squares, |seed| {
        let name = ["UnitSphere", "Fig73Exact", "D2Ball"][seed as usize % 3];
        ball_in_a_plane(name, h, 0.6, [0.1, -0.15])
    });
}

#[test]
fn cf2_a_side_in_a_plane_random() {
    let (h, radius): (f64, f64) = (0.3, 1.0);
    let mesh = shapes::plane(1.0, 1, UNIT).expect("a plane");
    // The strip is the whole plane's length.
    let at = |y: f64| {
        let s = y.hypot(radius - h);
        (radius - s, -(radius - h) / s, 1.0)
    };
    let half = (h * (2.0 * radius - h)).sqrt();
    let squares = squares(2.0, [-half, half], at);
    scatters("CF2", &mesh, squares, |_| side_in_a_plane("Fig73Exact", radius, h, 3.0, 1.0, 0.0));
}

/// A ball of 327,680 triangles, which are within 4e-5 of the sphere: less than any error measured.
#[test]
fn cf3_a_ball_on_a_ball_random() {
    let (radius, h) = (2.0, 0.5);
    let mesh = shapes::sphere(radius, 7, UNIT).expect("a ball");
    let dist = 1.0 + radius - h;
    // The parameter is the height z on the sphere: dA = 2π R dz; e is +z.
    let at = |z: f64| {
        let s = (radius * radius + dist * dist - 2.0 * dist * z).sqrt();
        (1.0 - s, (z - dist) / s, z / radius)
    };
    let low = radius - cap_height(1.0, radius, h);
    let squares = squares(TAU * radius, [low, radius], at);
    scatters("CF3", &mesh, squares, |seed| {
        let mut rng = Rng::new(seed);
        let along = Vector3::from_fn(|_, _| rng.between(-1.0, 1.0)).normalize();
        ball_on_a_ball(1.0, radius, h, along)
    });
}

/// Returns the wall of a bore about z, `0 <= z <= height`, facing inward: 4,096 flat faces, within 1e-6 of it.
fn wall(bore: f64, height: f64) -> Mesh {
    const SIDES: u32 = 4096;
    let at = |i: u32, z: f64| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(SIDES)).sin_cos();
        Point3::new(bore * cos, bore * sin, z)
    };
    let vertices = (0..SIDES).flat_map(|i| [at(i, 0.0), at(i, height)]);
    let triangles = (0..SIDES).flat_map(|i| {
        let (a, b) = (2 * i, 2 * ((i + 1) % SIDES));
        [[a, a + 1, b], [b, a + 1, b + 1]]
    });
    Mesh::new(vertices, triangles, UNIT).expect("a wall")
}

#[test]
fn cf5_a_side_in_a_bore_random() {
    let (radius, bore, h) = (2.0, 2.5, 0.3);
    let height = 3.0;
    let mesh = wall(bore, height);
    let offset = bore - radius + h;
    let at = |phi: f64| {
        let s = (bore * bore + offset * offset - 2.0 * bore * offset * phi.cos()).sqrt();
        (radius - s, (bore * phi.cos() - offset) / s, -phi.cos())
    };
    let reach = ((bore * bore + offset * offset - radius * radius) / (2.0 * bore * offset)).acos();
    let squares = squares(bore * height, [-reach, reach], at);
    // The cylinder's bottom and top are beyond the wall's ends by 1.5, more than the depth.
    scatters("CF5", &mesh, squares, |seed| {
        let mut scene = side_in_a_bore("Cylinder", radius, bore, h, 3.0, height / 2.0, seed as f64);
        let up = Vector3::new(0.0, 0.0, height / 2.0);
        scene.pose = Pose::from_axis(scene.pose.tip() + up, Vector3::z()).expect("a pose");
        scene.balance += up;
        scene
    });
}
