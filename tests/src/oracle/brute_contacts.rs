//! Brute force and closed forms against each other, on dense clouds.

use super::brute::{Answer, Law, Pose, Query, Sum};
use super::closed_forms::{
    Contact, ball_in_cavity, ball_in_plane, ball_on_ball, cylinder_in_bore, cylinder_in_plane,
};
use super::rng::Rng;
use super::{Fig73, Oracle, UnitSphere, fig_7_3_exact};

/// A weighted cloud.
#[derive(Default)]
struct Cloud {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    weights: Vec<f64>,
}

impl Cloud {
    /// Returns the midpoints of `n × n` cells of the unit square, mapped by `at`, which gives point, normal and
    /// area per unit of the square.
    fn patch(n: u32, at: impl Fn(f64, f64) -> ([f64; 3], [f64; 3], f64)) -> Self {
        let mut cloud = Self::default();
        let mid = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        for i in 0..n {
            for k in 0..n {
                let (p, normal, area) = at(mid(i), mid(k));
                cloud.points.push(p);
                cloud.normals.push(normal);
                cloud.weights.push(area / f64::from(n * n));
            }
        }
        cloud
    }

    /// Returns the square `|x|, |y| <= half` of the plane z = 0, with the material below.
    fn plane(n: u32, half: f64) -> Self {
        Self::patch(n, |s, t| {
            let (x, y) = (half * (2.0 * s - 1.0), half * (2.0 * t - 1.0));
            ([x, y, 0.0], [0.0, 0.0, 1.0], 4.0 * half * half)
        })
    }

    /// Returns the cap of a sphere about the origin within the angle `reach` (rad) of -z; `sigma` = -1 turns its
    /// normals inward. (Archimedes: the area is proportional to z.)
    fn cap(n: u32, radius: f64, reach: f64, sigma: f64) -> Self {
        let depth = radius * (1.0 - reach.cos());
        Self::patch(n, |s, t| {
            let z = -radius + s * depth;
            let r = ((radius - z) * (radius + z)).sqrt();
            let (sin, cos) = (t * std::f64::consts::TAU).sin_cos();
            let p = [r * cos, r * sin, z];
            (p, p.map(|c| sigma * c / radius), std::f64::consts::TAU * radius * depth)
        })
    }

    fn query<'a>(&'a self, oracle: &'a dyn Oracle, pose: Pose) -> Query<'a> {
        Query::new(oracle, pose, &self.points, &self.normals, &self.weights)
    }
}

/// Compares the answers under both laws with `want`, with forces along `axis`.
fn compare(query: Query<'_>, want: Contact, axis: [f64; 3], tolerance: f64) -> Answer {
    let along = |f: [f64; 3]| (0..3).map(|k| f[k] * axis[k]).sum::<f64>();
    let near = |got: f64, want: f64, what: &str| {
        assert!((got - want).abs() <= tolerance * want.abs(), "{what}: {got}, not {want}");
    };
    let thesis = query.answer();
    let gradient = Query { law: Law::Gradient, ..query }.answer();
    near(thesis.integral, want.integral, "integral");
    near(thesis.energy, want.energy, "energy");
    near(along(thesis.force), want.force, "thesis");
    near(along(gradient.force), want.gradient_force, "gradient");
    for (f, a) in thesis.force.iter().zip(axis) {
        let across = f - along(thesis.force) * a;
        assert!(across.abs() < tolerance * want.force.abs(), "{across} across");
    }
    thesis
}

/// CF1: a ball in a plane at several tilts, also with fig. 7.3's own ball.
#[test]
fn a_ball_in_a_plane() {
    let (cloud, up) = (Cloud::plane(1000, 1.0), [0.0, 0.0, 1.0]);
    let (exact, thesis) = (fig_7_3_exact(), Fig73::default());
    for (tool, tilt) in
        [(&UnitSphere as &dyn Oracle, 0.0f64), (&exact, 0.0), (&exact, 0.35), (&thesis, 0.7)]
    {
        let h = 0.1;
        let axis = [tilt.sin() * 0.6, tilt.sin() * 0.8, tilt.cos()];
        // The ball's centre is 1 above the tip along the axis, and stays at height 1 - h.
        let tip = [-axis[0], -axis[1], 1.0 - h - axis[2]];
        let mut query = cloud.query(tool, Pose::from_axis(tip, axis));
        query.centre = [0.3, 0.0, 1.0 - h];
        let a = compare(query, ball_in_plane(1.0, h), up, 1e-5);
        let (depth, at) = a.deepest.expect("a contact");
        assert!((depth - h).abs() < 1e-5 && cloud.points[at][0].abs() < 0.01);
        // Torque about the compliance centre o: (ball's centre - o) × F.
        for (k, want) in [0.0, 0.3 * a.force[2], 0.0].into_iter().enumerate() {
            assert!((a.torque[k] - want).abs() < 1e-6, "{:?}", a.torque);
        }
    }
}

/// CF2 with the shank (region VIII), the part a strip of length 2.
#[test]
fn a_shank_along_a_plane() {
    let tool = fig_7_3_exact();
    let cloud = Cloud::plane(1000, 1.0);
    let h = 0.3;
    // The shank lies along x between z = 1 and z = 5 of the tool.
    let query = cloud.query(&tool, Pose::from_axis([-3.0, 0.0, 1.0 - h], [1.0, 0.0, 0.0]));
    let c = cylinder_in_plane(1.0, h);
    let two = Contact {
        integral: 2.0 * c.integral,
        force: 2.0 * c.force,
        gradient_force: 2.0 * c.gradient_force,
        energy: 2.0 * c.energy,
    };
    let a = compare(query, two, [0.0, 0.0, 1.0], 1e-5);
    assert!(a.niceness.is_some_and(|n| (n - 2.0 * 0.7 * 0.7).abs() < 1e-5));
}

/// CF3 and CF4: the tool is below, so that it touches the cap around -z.
#[test]
fn a_ball_on_a_ball_and_in_a_cavity() {
    let (h, part) = (0.3, 4.0);
    let down = [0.0, 0.0, -1.0];
    let point = |dist: f64| Pose::from_axis([0.0, 0.0, -dist - 1.0], [0.0, 0.0, 1.0]);
    let outside = Cloud::cap(1000, part, 0.4, 1.0);
    compare(
        outside.query(&UnitSphere, point(1.0 + part - h)),
        ball_on_ball(1.0, part, h),
        down,
        2e-5,
    );
    let cavity = Cloud::cap(1000, part, 0.4, -1.0);
    compare(
        cavity.query(&UnitSphere, point(part - 1.0 + h)),
        ball_in_cavity(1.0, part, h),
        down,
        2e-5,
    );
}

/// CF5 with the shank in a bore along z, on a strip of length 1.
#[test]
fn a_shank_in_a_bore() {
    let (bore, offset) = (3.0, 2.2);
    let cloud = Cloud::patch(1000, |s, t| {
        let (sin, cos) = (0.6 * (2.0 * s - 1.0)).sin_cos();
        ([bore * cos, bore * sin, 2.5 + t], [-cos, -sin, 0.0], 1.2 * bore)
    });
    let tool = fig_7_3_exact();
    let query = cloud.query(&tool, Pose::from_axis([offset, 0.0, 0.0], [0.0, 0.0, 1.0]));
    compare(query, cylinder_in_bore(1.0, bore, offset), [1.0, 0.0, 0.0], 1e-5);
}

/// A part in millimetres and a tool in inches give the same results as one unit for both.
#[test]
fn units_scale() {
    let cloud = Cloud::plane(200, 1.0);
    let pose = Pose::from_axis([0.1, 0.2, -0.1], [0.1, 0.0, 1.0]);
    let one = cloud.query(&UnitSphere, pose).answer();
    let mm = |v: [f64; 3]| v.map(|c| 25.4 * c);
    let points: Vec<_> = cloud.points.iter().map(|p| mm(*p)).collect();
    let large_ball = Pose { tip: mm(pose.tip), ..pose };
    let mut query = Query::new(&UnitSphere, large_ball, &points, &cloud.normals, &cloud.weights);
    query.scale = 1.0 / 25.4;
    let two = query.answer();
    assert_eq!(one.count, two.count);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
    near(two.integral, 25.4 * one.integral);
    near(two.energy, 25.4 * 25.4 * one.energy);
    for k in 0..3 {
        near(two.force[k], 25.4 * one.force[k]);
        near(two.torque[k], 25.4 * 25.4 * one.torque[k]);
    }
}

/// The gradient law is the slope of the energy over the tip's position, for a magnitude that is no distance, in any
/// unit.
#[test]
fn the_gradient_law_is_conservative() {
    let mut rng = Rng::new(8);
    let mut cloud = Cloud::default();
    for _ in 0..3000 {
        cloud.points.push([rng.between(-5.0, 5.0), rng.between(-5.0, 5.0), rng.between(2.0, 18.0)]);
        cloud.normals.push([0.0, 0.0, 1.0]);
        cloud.weights.push(rng.between(0.0, 1.0));
    }
    let tool = Fig73::default();
    for (is_depth, scale) in [(false, 1.0), (false, 0.5), (true, 0.5)] {
        let at = |dx: f64| {
            let mut query = cloud.query(&tool, Pose::from_axis([dx, 0.1, -0.3], [0.2, 0.1, 1.0]));
            query.scale = scale;
            query.magnitude_is_depth = is_depth;
            query.law = Law::Gradient;
            query.answer()
        };
        let h = 1e-7;
        let slope = -(at(h).energy - at(-h).energy) / (2.0 * h);
        let force = at(0.0).force[0];
        assert!((slope - force).abs() < 1e-4 * force.abs().max(1.0), "{slope} {force}");
    }
}

#[test]
fn the_facing_law_ignores_the_far_side() {
    let mut cloud = Cloud::plane(100, 1.0);
    let top = cloud.query(&UnitSphere, Pose::from_axis([0.0, 0.0, -0.2], [0.0, 0.0, 1.0])).answer();
    // A second skin just below, facing down: the far side of a sheet.
    let below: Vec<_> = cloud.points.iter().map(|p| [p[0], p[1], -0.01]).collect();
    cloud.points.extend(below);
    cloud.normals.extend(vec![[0.0, 0.0, -1.0]; 10_000]);
    cloud.weights.extend(cloud.weights.clone());
    let mut query = cloud.query(&UnitSphere, Pose::from_axis([0.0, 0.0, -0.2], [0.0, 0.0, 1.0]));
    query.law = Law::Facing;
    let facing = query.answer();
    assert_eq!(facing.force, top.force);
    assert!(facing.count > top.count);
}

#[test]
fn without_contacts_the_wrench_is_zero() {
    let cloud = Cloud::plane(10, 1.0);
    let a = cloud.query(&UnitSphere, Pose { tip: [0.0, 0.0, 9.0], ..Pose::IDENTITY }).answer();
    assert_eq!((a.count, a.deepest, a.niceness, a.force), (0, None, None, [0.0; 3]));
}

#[test]
fn sums_keep_what_plain_addition_loses() {
    let sum: Sum = [1.0, 1e100, 1.0, -1e100].into_iter().collect();
    assert_eq!(sum.value(), 2.0);
}
