//! Contacts against their closed forms (`oracle::closed_forms`), with clouds of the midpoints of regular cells: weights
//! are exact, and errors fall as the cells' area.

use crate::prelude::*;
use nalgebra::Rotation3;
use std::f64::consts::TAU;
use touchoff_tests::fixtures::part_of;
use touchoff_tests::library::tool;
use touchoff_tests::oracle::closed_forms::{
    Contact, ball_in_cavity, ball_in_plane, ball_on_ball, cylinder_in_bore, cylinder_in_plane,
};

/// A contact to be measured: a pose, the expected result, the axis of the forces, and the point about which there
/// is no torque.
struct Scene {
    tool: &'static dyn Tool,
    pose: Pose,
    want: Figures,
    axis: Vector3<f64>,
    balance: Point3<f64>,
}

/// Integral, thesis force, gradient force and energy; all forces along the axis.
type Figures = [f64; 4];

fn figures(contact: &Contact) -> Figures {
    [contact.integral, contact.force, contact.gradient_force, contact.energy]
}

/// Returns the measured figures, and the largest force across the axis and torque about the balance point.
fn measure(scene: &Scene, part: &Part) -> (Figures, f64) {
    // The balance point in the tool's frame; torque about another centre is checked too.
    let balance = scene.pose.rotation().transpose() * (scene.balance - scene.pose.tip());
    let evaluation = |law, centre: Vector3<f64>| {
        Probe::new(part, scene.tool).with_law(law).with_centre(centre.into()).wrench(&scene.pose)
    };
    let (thesis, gradient) = (evaluation(Law::Thesis, balance), evaluation(Law::Gradient, balance));
    assert_eq!((thesis.integral, thesis.energy), (gradient.integral, gradient.energy));
    // Nothing faces away in these contacts, so `facing` gives the thesis's force.
    assert_eq!(thesis.force, evaluation(Law::Facing, balance).force);
    let aside = Vector3::new(0.3, -0.8, 0.5);
    let about = evaluation(Law::Thesis, balance - aside).torque
        - (scene.pose.rotation() * aside).cross(&thesis.force);
    assert!((about - thesis.torque).norm() < 1e-12 * (1.0 + thesis.force.norm()));
    let across = [thesis.force, gradient.force]
        .map(|force| (force - force.dot(&scene.axis) * scene.axis).norm())
        .into_iter()
        .chain([thesis.torque.norm(), gradient.torque.norm()])
        .fold(0.0, f64::max);
    let along = |force: Vector3<f64>| force.dot(&scene.axis);
    ([thesis.integral, along(thesis.force), along(gradient.force), thesis.energy], across)
}

/// CF1: a ball (radius 1, its centre 1 above the tip) `h` deep in the plane z = 0 at `x, y`, tilted by `tilt`
/// (rad).
fn ball_in_a_plane(name: &str, h: f64, tilt: f64, [x, y]: [f64; 2]) -> Scene {
    let axis = Vector3::new(0.6 * tilt.sin(), 0.8 * tilt.sin(), tilt.cos());
    let balance = Point3::new(x, y, 1.0 - h);
    Scene {
        tool: tool(name),
        pose: Pose::from_axis(balance - axis, axis).expect("a pose"),
        want: figures(&ball_in_plane(1.0, h)),
        axis: Vector3::z(),
        balance,
    }
}

/// CF2: the side of a cylinder in a strip of the plane z = 0 that is `2 long` along the tool. The tool's axis lies
/// at an angle of `turn` (rad) from x, and its `z` is over the middle.
fn side_in_a_plane(name: &str, radius: f64, h: f64, z: f64, long: f64, turn: f64) -> Scene {
    let along = Vector3::new(turn.cos(), turn.sin(), 0.0);
    let balance = Point3::new(0.0, 0.0, radius - h);
    Scene {
        tool: tool(name),
        pose: Pose::from_axis(balance - z * along, along).expect("a pose"),
        want: figures(&cylinder_in_plane(radius, h)).map(|figure| 2.0 * long * figure),
        axis: Vector3::z(),
        balance,
    }
}

/// CF3 and CF4: a unit ball on a ball, or in a cavity, about the origin; `along` points from the origin to the unit
/// ball.
fn ball_on_a_ball(sigma: f64, part: f64, h: f64, along: Vector3<f64>) -> Scene {
    let (want, dist) = if sigma > 0.0 {
        (ball_on_ball(1.0, part, h), 1.0 + part - h)
    } else {
        (ball_in_cavity(1.0, part, h), part - 1.0 + h)
    };
    let balance = Point3::from(dist * along);
    // The spindle points away from the part, or toward its middle.
    let pose = Pose::from_axis(balance - sigma * along, sigma * along).expect("a pose");
    Scene { tool: tool("UnitSphere"), pose, want: figures(&want), axis: along, balance }
}

/// Returns the height of the cap of the part that lies in the tool.
fn cap_height(sigma: f64, part: f64, h: f64) -> f64 {
    let dist = if sigma > 0.0 { 1.0 + part - h } else { part - 1.0 + h };
    part - (part * part + dist * dist - 1.0) / (2.0 * dist)
}

/// CF5: a cylinder in a bore about z, on a strip `2 long` along it about the tool's `z`.
fn side_in_a_bore(name: &str, radius: f64, bore: f64, h: f64, z: f64, long: f64, at: f64) -> Scene {
    let out = Vector3::new(at.cos(), at.sin(), 0.0);
    let offset = bore - radius + h;
    let balance = Point3::from(offset * out);
    Scene {
        tool: tool(name),
        pose: Pose::from_axis(balance - z * Vector3::z(), Vector3::z()).expect("a pose"),
        want: figures(&cylinder_in_bore(radius, bore, offset)).map(|figure| 2.0 * long * figure),
        axis: out,
        balance,
    }
}

/// Returns the largest error of a measurement, relative to the figures. Forces across the axis and torques are
/// relative to the thesis's force.
fn error(scene: &Scene, part: &Part) -> f64 {
    let (got, across) = measure(scene, part);
    let along = got.iter().zip(scene.want).map(|(got, want)| (got / want - 1.0).abs());
    along.fold((across / scene.want[1]).abs(), f64::max)
}

/// Returns the midpoints of `n × m` cells of the unit square, mapped by `at`, which gives point, normal and area
/// per unit of the square.
fn patch([n, m]: [u32; 2], at: impl Fn(f64, f64) -> (Point3<f64>, Vector3<f64>, f64)) -> Part {
    let (mut points, mut normals, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..n {
        for k in 0..m {
            let s = (f64::from(i) + 0.5) / f64::from(n);
            let t = (f64::from(k) + 0.5) / f64::from(m);
            let (point, normal, area) = at(s, t);
            points.push(point);
            normals.push(normal);
            weights.push(area / (f64::from(n) * f64::from(m)));
        }
    }
    part_of(points, normals, weights)
}

/// Returns a rectangle of the plane z = 0 about `middle`, with half sides `wide` and `long`, the material below,
/// its cells turned by `turn` (rad).
fn plane(cells: [u32; 2], [wide, long]: [f64; 2], middle: [f64; 2], turn: f64) -> Part {
    let (sin, cos) = turn.sin_cos();
    patch(cells, |s, t| {
        let (x, y) = (wide * (2.0 * s - 1.0), long * (2.0 * t - 1.0));
        let p = Point3::new(middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y, 0.0);
        (p, Vector3::z(), 4.0 * wide * long)
    })
}

/// Asserts that errors at two resolutions, root mean square over a few placements, are at most `bounds` and fall as
/// the cells' area: the slope over the number of cells is -1 within `band`.
fn converges(what: &str, bounds: [f64; 2], band: f64, error: impl Fn(u32, &mut Rng) -> f64) {
    const PLACEMENTS: u32 = 6;
    let cells = [120u32, 480];
    let rms = cells.map(|n| {
        let mut rng = Rng::new(u64::from(n));
        let squares = (0..PLACEMENTS).map(|_| error(n, &mut rng).powi(2));
        (squares.sum::<f64>() / f64::from(PLACEMENTS)).sqrt()
    });
    let slope = (rms[1] / rms[0]).ln() / (16f64).ln();
    println!("{what}: {rms:?} slope {slope}");
    assert!(rms[0] < bounds[0] && rms[1] < bounds[1], "{what}: {rms:?}");
    assert!((slope + 1.0).abs() < band, "{what}: slope {slope}");
}

/// Ball, depth and tilt (rad); the last no more than asin((r - h)/r) where a shank would touch beyond that.
const BALLS: [(&str, f64, f64); 8] = [
    ("UnitSphere", 0.1, 0.0),
    ("UnitSphere", 0.5, 1.2),
    ("UnitSphere", 0.9, 2.5),
    ("Fig73Exact", 0.1, 0.35),
    ("Fig73Exact", 0.3, 0.7),
    ("Fig73", 0.3, 0.7),
    ("D2Ball", 0.05, 1.2),
    ("D2Ball", 0.5, 0.5),
];

#[test]
fn cf1_a_ball_in_a_plane_regular() {
    for (name, h, tilt) in BALLS {
        let reach = 1.05 * (h * (2.0 - h)).sqrt();
        converges(&format!("CF1 {name} {h} {tilt}"), [8e-5, 4e-6], 0.35, |n, rng| {
            let middle = [rng.between(-3.0, 3.0), rng.between(-3.0, 3.0)];
            let jitter = [0, 1].map(|k| middle[k] + 0.01 * reach * rng.between(-1.0, 1.0));
            let part = plane([n / 2; 2], [reach; 2], middle, rng.between(0.0, TAU));
            error(&ball_in_a_plane(name, h, tilt, jitter), &part)
        });
    }
    // A million points.
    let part = plane([1000, 1000], [0.75; 2], [0.003, -0.002], 0.4);
    let found = error(&ball_in_a_plane("D2Ball", 0.3, 0.7, [0.0, 0.0]), &part);
    println!("CF1, a million points: {found:e}");
    assert!(found < 1e-6, "{found:e}");
}

/// Tool, radius, depth, the middle of a stretch of its side, and half its length.
const SIDES: [(&str, f64, f64, f64, f64); 6] = [
    ("Cylinder", 2.0, 0.25, 3.0, 0.9),
    ("Fig73Exact", 1.0, 0.3, 3.0, 1.0),
    ("Fig73", 1.0, 0.1, 3.0, 1.5),
    ("Fig73Exact", 3.0, 0.25, 8.1, 0.6),
    ("D2Ball", 1.0, 0.5, 20.0, 10.0),
    ("HalfSphereCylinder", 1.0, 0.2, 4.5, 1.0),
];

#[test]
fn cf2_a_side_in_a_plane() {
    for (name, radius, h, z, long) in SIDES {
        let half = 1.1 * (h * (2.0 * radius - h)).sqrt();
        converges(&format!("CF2 {name} {radius}"), [2e-4, 6e-6], 0.35, |n, rng| {
            let turn = rng.between(0.0, TAU);
            let slip = 0.02 * half * rng.between(-1.0, 1.0);
            let middle = [-slip * turn.sin(), slip * turn.cos()];
            // Nothing changes along the tool, so a few cells are enough.
            let part = plane([20, n], [long, half], middle, turn);
            error(&side_in_a_plane(name, radius, h, z, long, turn), &part)
        });
    }
}

#[test]
fn cf3_cf4_a_ball_on_a_ball_and_in_a_cavity() {
    for (sigma, radius, h) in [(1.0, 4.0, 0.3), (1.0, 10.0, 0.1), (-1.0, 4.0, 0.3)] {
        converges(&format!("CF3 {sigma} {radius}"), [1e-4, 6e-6], 0.35, |n, rng| {
            let along = Vector3::new(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), 0.7);
            let along = along.normalize();
            let turn = Rotation3::rotation_between(&Vector3::z(), &along).expect("not opposite");
            // The cap around the contact, a little wider, in cells of equal area by Archimedes: slices by height
            // and angle.
            let (sin, cap) = (rng.between(0.0, TAU), 1.1 * cap_height(sigma, radius, h));
            let part = patch([n, n], |s, t| {
                let z = radius - s * cap;
                let r = ((radius - z) * (radius + z)).sqrt();
                let (y, x) = (t * TAU + sin).sin_cos();
                let p = turn * Vector3::new(r * x, r * y, z);
                (p.into(), sigma * p / radius, TAU * radius * cap)
            });
            error(&ball_on_a_ball(sigma, radius, h, along), &part)
        });
    }
}

#[test]
fn cf5_a_side_in_a_bore() {
    for (name, radius, h, z, long) in SIDES {
        for bore in [1.04 * radius, 3.0 * radius] {
            let h = h.min(bore - radius);
            converges(&format!("CF5 {name} {radius} {bore}"), [1.5e-3, 1e-4], 0.35, |n, rng| {
                let (at, slip) = (rng.between(0.0, TAU), rng.between(0.0, 1.0));
                let part = patch([20, 4 * n], |s, t| {
                    let (sin, cos) = (t * TAU + slip).sin_cos();
                    let z = long * (2.0 * s - 1.0);
                    let p = Point3::new(bore * cos, bore * sin, z);
                    (p, Vector3::new(-cos, -sin, 0.0), TAU * bore * 2.0 * long)
                });
                error(&side_in_a_bore(name, radius, bore, h, z, long, at), &part)
            });
        }
    }
}
