//! A second implementation of joint motions in doubles, by nalgebra's isometries and quaternions, and random
//! motions.

use super::Random;
use crate::machine::{Axis, JointMotion, LinearPath, Link, Machine, Plane, Setup, Side};
use nalgebra::{
    Isometry3, Point3, Rotation2, Translation3, Unit, UnitQuaternion, Vector2, Vector3,
};

/// A joint motion, as its constructor takes it.
#[derive(Clone, Debug)]
pub(super) struct Sampled {
    pub(super) machine: Machine,
    pub(super) setup: Setup,
    pub(super) rotary: [[f64; 3]; 2],
    pub(super) path: LinearPath,
    pub(super) tcp: bool,
    /// Distance below the tip of a point that rests, which is the path.
    pub(super) pivot: Option<f64>,
}

/// Returns the motion of an axis's link relative to the one before it, for the tool's side.
fn link_motion(axis: &Axis, joint: f64) -> Isometry3<f64> {
    if !axis.letter.is_rotary() {
        return Translation3::from(axis.direction * joint).into();
    }
    let turn = UnitQuaternion::from_axis_angle(
        &Unit::new_normalize(axis.direction),
        (joint % 360.0).to_radians(),
    );
    Isometry3::rotation_wrt_point(turn, axis.point)
}

impl Sampled {
    /// Returns the motion that is tested.
    pub(super) fn motion(&self) -> JointMotion {
        let chain = self.machine.chain(&self.setup).expect("a setup");
        if let Some(distance) = self.pivot {
            let point = Point3::from(self.position(0.0));
            return JointMotion::about(&chain, distance, self.rotary, &point).expect("a motion");
        }
        match self.tcp {
            true => JointMotion::with_tcp(&chain, self.rotary, &self.path),
            false => JointMotion::new(&chain, self.rotary, &self.path),
        }
        .expect("a motion")
    }

    pub(super) fn position(&self, t: f64) -> Vector3<f64> {
        match self.path {
            LinearPath::Line { start, end } => Vector3::from(start).lerp(&end.into(), t),
            LinearPath::Arc { start, end, plane, centre, sweep } => {
                let [first, second] = match plane {
                    Plane::Xy => [0, 1],
                    Plane::Zx => [2, 0],
                    Plane::Yz => [1, 2],
                };
                let arm = |position: [f64; 3]| {
                    Vector2::new(position[first], position[second]) - Vector2::from(centre)
                };
                let mut position = Vector3::from(start).lerp(&end.into(), t);
                let in_plane = Rotation2::new(sweep * t) * arm(start) * (1.0 - t)
                    + Rotation2::new(sweep * (t - 1.0)) * arm(end) * t;
                position[first] = centre[0] + in_plane.x;
                position[second] = centre[1] + in_plane.y;
                position
            }
        }
    }

    /// Returns the joint values of an axis with the linear ones that are given.
    fn value(&self, axis: &Axis, t: f64, linear: &Vector3<f64>) -> f64 {
        let index = axis.letter.index();
        match index {
            0..3 => linear[index],
            _ => {
                let [start, end] = self.rotary.map(|values| values[index - 3]);
                start + (end - start) * t
            }
        }
    }

    fn side(&self, side: Side, t: f64, linear: &Vector3<f64>, count: usize) -> Isometry3<f64> {
        let sign = if side == Side::Table { -1.0 } else { 1.0 };
        let axes = self.machine.axes().iter().filter(|axis| axis.side == side).take(count);
        axes.fold(Isometry3::identity(), |pose, axis| {
            pose * link_motion(axis, sign * self.value(axis, t, linear))
        })
    }

    /// Returns where a link is in machine coordinates.
    pub(super) fn place(&self, t: f64, link: Link) -> Isometry3<f64> {
        let Link::Axis(letter) = link else { return Isometry3::identity() };
        let side = self.machine.axis(letter).expect("an axis of the machine").side;
        let axes = self.machine.axes().iter().filter(|axis| axis.side == side);
        let count = 1 + axes.take_while(|axis| axis.letter != letter).count();
        self.side(side, t, &self.linear(t), count)
    }

    /// Returns where the frame of the workpiece is in machine coordinates.
    pub(super) fn part(&self, t: f64) -> Isometry3<f64> {
        let linear = self.linear(t);
        let is_slide = |axis: &&Axis| axis.side == Side::Table && !axis.letter.is_rotary();
        let slides = self.machine.axes().iter().filter(is_slide);
        let slide: Vector3<f64> =
            slides.map(|axis| axis.direction * linear[axis.letter.index()]).sum();
        Translation3::from(-slide) * self.workpiece(t)
    }

    /// Returns the frame of the workpiece in machine coordinates, with the linear joints at 0.
    fn workpiece(&self, t: f64) -> Isometry3<f64> {
        let rotary = |joints: [f64; 6]| {
            let axes = self.machine.axes().iter();
            axes.filter(|axis| axis.side == Side::Table && axis.letter.is_rotary())
                .fold(Isometry3::identity(), |pose, axis| {
                    pose * link_motion(axis, -joints[axis.letter.index()])
                })
        };
        let [x, y, z, ..] = self.setup.work_offset;
        let mut now = [0.0; 6];
        for axis in self.machine.axes() {
            now[axis.letter.index()] = self.value(axis, t, &Vector3::zeros());
        }
        rotary(now) * rotary(self.setup.work_offset).inverse() * Translation3::new(x, y, z)
    }

    /// Returns the linear joints.
    pub(super) fn linear(&self, t: f64) -> Vector3<f64> {
        let position = self.position(t);
        if !self.tcp {
            return position;
        }
        let tip = self.workpiece(t) * Point3::from(position);
        let head = self.side(Side::Tool, t, &Vector3::zeros(), usize::MAX)
            * Point3::new(0.0, 0.0, -self.setup.tool_length - self.pivot.unwrap_or_default());
        tip - head
    }

    /// Returns the pose of the tip's frame relative to the workpiece, or to a link.
    pub(super) fn pose(&self, t: f64, link: Option<usize>) -> Isometry3<f64> {
        let linear = self.linear(t);
        let tip = self.side(Side::Tool, t, &linear, usize::MAX)
            * Translation3::new(0.0, 0.0, -self.setup.tool_length);
        match link {
            Some(link) => self.side(Side::Table, t, &linear, link).inverse() * tip,
            None => {
                let is_slide = |axis: &&Axis| axis.side == Side::Table && !axis.letter.is_rotary();
                let slides = self.machine.axes().iter().filter(is_slide);
                let slide: Vector3<f64> =
                    slides.map(|axis| axis.direction * linear[axis.letter.index()]).sum();
                // The slides move the workpiece backwards, and with it the rotary axes.
                self.workpiece(t).inverse() * Translation3::from(slide) * tip
            }
        }
    }
}

impl Random {
    /// Returns a joint motion of a machine. Turns are from 1e-3° to some 100°, paths from 1e-2 to 200 mm,
    /// lines and arcs of up to two turns; half of the motions are with TCP, and a sixth about a point that rests.
    pub(super) fn motion(&mut self, machine: &Machine) -> Sampled {
        let setup = self.setup(machine);
        let scale = self.pick(&[1e-3, 1.0, 30.0, 100.0]);
        let mut rotary = [[0.0; 3]; 2];
        for axis in machine.axes().iter().filter(|axis| axis.letter.is_rotary()) {
            let index = axis.letter.index() - 3;
            rotary[0][index] = self.angle() % 1000.0;
            let change = if self.below(6) == 0 { 0.0 } else { scale * self.unit() };
            rotary[1][index] = rotary[0][index] + change;
        }
        let start = [0, 1, 2].map(|_| 200.0 * self.unit());
        let size = self.pick(&[0.0, 1e-2, 10.0, 200.0]);
        let line_end = start.map(|value| value + size * self.unit());
        let mut path = match self.below(3) {
            0 | 1 => LinearPath::Line { start, end: line_end },
            _ => self.arc(start, size),
        };
        let mut tcp = self.below(2) == 0;
        let distance = self.pick(&[0.0, 1.0, 50.0, 300.0]);
        let pivot = (self.below(6) == 0).then_some(distance);
        if pivot.is_some() {
            (path, tcp) = (LinearPath::Line { start, end: start }, true);
        }
        Sampled { machine: machine.clone(), setup, rotary, path, tcp, pivot }
    }

    /// Returns a helix about a centre at about the given distance. Every third is a spiral.
    fn arc(&mut self, start: [f64; 3], size: f64) -> LinearPath {
        let plane = self.pick(&[Plane::Xy, Plane::Zx, Plane::Yz]);
        let [first, second, normal] = match plane {
            Plane::Xy => [0, 1, 2],
            Plane::Zx => [2, 0, 1],
            Plane::Yz => [1, 2, 0],
        };
        let arm = Vector2::new(size * self.unit(), size * self.unit());
        let sweep = 2.0 * std::f64::consts::TAU * self.unit();
        let spiral = 1.0 + 0.1 * self.unit();
        let growth = self.pick(&[1.0, 1.0, spiral]);
        let centre = [start[first] - arm.x, start[second] - arm.y];
        let last = Rotation2::new(sweep) * arm * growth;
        let mut end = start;
        end[first] = centre[0] + last.x;
        end[second] = centre[1] + last.y;
        end[normal] += 10.0 * self.unit();
        LinearPath::Arc { start, end, plane, centre, sweep }
    }
}
