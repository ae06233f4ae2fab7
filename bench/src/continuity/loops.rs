//! Closed loops of a tool in contact with an edge.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Part, Pose, Probe, Tool, Unit};

/// Half the width of the block that is touched, mm, in x and y; its upper edge at x = 10 is what is felt.
const HALF: f64 = 10.0;
/// How deep the tool is at the middle of a loop, mm.
const DEEP: f64 = 0.4;
/// The radius of a loop, mm.
const RADIUS: f64 = 0.3;
/// How far the tool turns either way, in radians.
const TURN: f64 = 0.02;

/// The block, its upper face at z = 0.
///
/// # Panics
/// Never: its corners are two.
pub fn block() -> Mesh {
    let [low, high] = [Point3::new(-HALF, -HALF, -HALF), Point3::new(HALF, HALF, 0.0)];
    shapes::cuboid(low, high, Unit::Millimetre).expect("a block by construction")
}

/// How a loop goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Whether the tool's side is at the edge, and not its end.
    pub side: bool,
    /// Whether it turns as well.
    pub turns: bool,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 4] = [
        Kind { side: false, turns: false },
        Kind { side: false, turns: true },
        Kind { side: true, turns: false },
        Kind { side: true, turns: true },
    ];

    /// The words for it.
    pub fn name(self) -> &'static str {
        match self {
            Kind { side: false, turns: false } => "end",
            Kind { side: false, turns: true } => "end, turning",
            Kind { side: true, turns: false } => "side",
            Kind { side: true, turns: true } => "side, turning",
        }
    }
}

/// A closed loop: the tip goes round a circle across the edge, the tool turns about two axes across its own.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    middle: Point3<f64>,
    upright: UnitQuaternion<f64>,
    turn: f64,
}

/// A pose of a loop, and how it changes with the loop's parameter.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// The pose.
    pub pose: Pose,
    /// The tip's velocity.
    pub velocity: Vector3<f64>,
    /// The tool's.
    pub spin: Vector3<f64>,
}

impl Loop {
    /// A loop whose middle is so deep in the block's edge; `None` if the tool cannot be brought there.
    pub fn new(part: &Part, tool: &dyn Tool, kind: Kind) -> Option<Loop> {
        let out = Vector3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
        let axis = if kind.side {
            Vector3::new(-0.7, 0.35, 0.8).normalize()
        } else {
            Vector3::new(0.5, 0.2, 1.0).normalize()
        };
        let spun = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
        let upright = UnitQuaternion::rotation_between(&Vector3::z(), &axis)? * spun;
        let card = tool.card();
        let length = card.unit.to(Unit::Millimetre);
        let [low, high] = card.reach().map(|z| z * length);
        let edge = Point3::new(HALF, 0.0, 0.0);
        // Of the side some place above the end.
        let along = if kind.side { low + 0.3 * (high - low) } else { low };
        let foot = edge - along * axis;
        let mut looped = Loop { middle: foot, upright, turn: 0.0 };
        let mut probe = Probe::new(part, tool);
        let mut depth = |far: f64| {
            looped.middle = foot + far * out;
            let pose = looped.at(FRAC_PI_2).pose;
            // The pose there, its circle taken away.
            let tip = looped.middle;
            let pose = Pose::try_from(nalgebra::Isometry3::from_parts(
                tip.into(),
                pose.isometry().rotation,
            ));
            pose.ok().and_then(|pose| probe.deepest(&pose)).map_or(0.0, |deepest| deepest.depth)
        };
        let reach = 2.0 * (card.radius() * length + high - low);
        let (mut near, mut far) = (0.0, reach);
        // The first place from outside that is as deep.
        let steps = 4_000;
        for k in 0..=steps {
            let here = reach * (1.0 - 1.5 * f64::from(k) / f64::from(steps));
            if depth(here) >= DEEP {
                near = here;
                break;
            }
            far = here;
        }
        if depth(near) < DEEP {
            return None;
        }
        for _ in 0..40 {
            let half = (near + far) / 2.0;
            if depth(half) >= DEEP { near = half } else { far = half }
        }
        looped.middle = foot + near * out;
        looped.turn = if kind.turns { TURN } else { 0.0 };
        Some(looped)
    }

    /// The pose at a parameter from 0 to 2π.
    ///
    /// # Panics
    /// Never: a product of unit quaternions is one.
    pub fn at(&self, t: f64) -> Moving {
        let (sine, cosine) = t.sin_cos();
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let tip = self.middle + RADIUS * (cosine * x + sine * z);
        let first = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.turn * sine);
        let second = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.turn * cosine);
        let turn = first * second * self.upright;
        let q = turn.coords;
        let pose = Pose::from_quaternion(tip, [q.x, q.y, q.z, q.w]).expect("a unit quaternion");
        Moving {
            pose,
            velocity: RADIUS * (cosine * z - sine * x),
            spin: self.turn * (cosine * x - sine * (first * y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_those_of_the_pose() {
        let looped = Loop {
            middle: Point3::new(1.0, 2.0, 3.0),
            upright: UnitQuaternion::from_euler_angles(0.3, 0.8, -0.4),
            turn: 0.4,
        };
        const SMALL: f64 = 1e-6;
        for k in 0..20 {
            let t = f64::from(k) / 3.0;
            let here = looped.at(t);
            let [before, after] = [looped.at(t - SMALL).pose, looped.at(t + SMALL).pose];
            let velocity = (after.tip() - before.tip()) / (2.0 * SMALL);
            assert!((velocity - here.velocity).norm() < 1e-9);
            let turned = (after.rotation() - before.rotation()) / (2.0 * SMALL);
            let expected = here.spin.cross_matrix() * here.pose.rotation();
            assert!((turned - expected).norm() < 1e-8, "{t}");
        }
    }
}
