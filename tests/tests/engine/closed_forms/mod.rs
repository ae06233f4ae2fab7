//! Contacts against their closed forms (`oracle::closed_forms`), with real clouds.
//!
//! There are two kinds of cloud. Midpoints of regular cells have exact weights, and their error falls as the cells'
//! area. Random points have an error that falls as the inverse square root of their number; it is compared with its
//! own standard deviation, computed from the integrand.

mod random;
mod regular;

use nalgebra::{Point3, Vector3};
use touchoff::{Law, Part, Pose, Probe, Tool, Unit};
use touchoff_tests::library::tool;
use touchoff_tests::oracle::closed_forms::{
    Contact, ball_in_cavity, ball_in_plane, ball_on_ball, cylinder_in_bore, cylinder_in_plane,
};

const UNIT: Unit = Unit::Millimetre;

/// A contact to be measured: a pose, the expected result, the axis of the forces, and the point about which there
/// is no torque.
struct Scene {
    tool: &'static dyn Tool,
    pose: Pose,
    want: Contact,
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
        want: ball_in_plane(1.0, h),
        axis: Vector3::z(),
        balance,
    }
}

/// CF2: the side of a cylinder in a strip of the plane z = 0 that is `2 long` along the tool. The tool's axis lies
/// at an angle of `turn` (rad) from x, and its `z` is over the middle.
fn side_in_a_plane(name: &str, radius: f64, h: f64, z: f64, long: f64, turn: f64) -> Scene {
    let along = Vector3::new(turn.cos(), turn.sin(), 0.0);
    let c = cylinder_in_plane(radius, h);
    let balance = Point3::new(0.0, 0.0, radius - h);
    Scene {
        tool: tool(name),
        pose: Pose::from_axis(balance - z * along, along).expect("a pose"),
        want: times(&c, 2.0 * long),
        axis: Vector3::z(),
        balance,
    }
}

fn times(c: &Contact, by: f64) -> Contact {
    Contact {
        integral: by * c.integral,
        force: by * c.force,
        gradient_force: by * c.gradient_force,
        energy: by * c.energy,
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
    Scene { tool: tool("UnitSphere"), pose, want, axis: along, balance }
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
        want: times(&cylinder_in_bore(radius, bore, offset), 2.0 * long),
        axis: out,
        balance,
    }
}
