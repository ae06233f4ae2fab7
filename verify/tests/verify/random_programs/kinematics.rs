//! Machines as chains of axes, and where they put the tool: products of motions, written from ISO 841.

use super::Axes;
use crate::oracle::Random;
use nalgebra::{
    Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3,
};
use std::fmt::Write;

/// Letters of the axes, in the order of [`Axes`].
pub(crate) const LETTERS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// An axis of a machine.
#[derive(Clone, Debug)]
struct Axis {
    index: usize,
    is_of_table: bool,
    direction: Vector3<f64>,
    /// A point of a rotary axis.
    point: [f64; 3],
}

/// A machine with up to two rotary axes: C, and A or B, which tilts.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    /// The axes, those of each side from the base outwards.
    axes: Vec<Axis>,
    /// The index of the axis that tilts the tool relative to the part, if it is along a coordinate axis.
    pub(crate) tilting: Option<usize>,
    pub(crate) is_endless: bool,
    /// Rates of the axes in rapid traverse, if the file states them.
    pub(crate) rates: Option<Axes>,
    /// The joints at which a tool change leaves the axes; `None` for those that stay.
    pub(crate) change: [Option<f64>; 6],
}

/// The tip and the direction from the tip to the spindle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolPose {
    pub(crate) tip: Vector3<f64>,
    pub(crate) axis: Vector3<f64>,
}

impl Machine {
    pub(crate) fn draw(random: &mut Random) -> Machine {
        let mut point = |low| [random.between(-9.0, 9.0), random.between(-9.0, 9.0), low];
        let (table, tool) = ([point(-480.0), point(-500.0)], [point(190.0), point(160.0)]);
        let kind = random.choice(7);
        let tilting = if random.chance(0.5) { 3 } else { 4 };
        let is_nutating = random.chance(0.15);
        let axis = |index: usize, is_of_table, point| {
            let mut direction = Vector3::zeros();
            direction[index % 3] = 1.0;
            if is_nutating && index == tilting {
                direction = Vector3::new(0.0, 1.0, 1.0).normalize();
            }
            Axis { index, is_of_table, direction, point }
        };
        let mut axes: Vec<Axis> = (0..3).map(|k| axis(k, random.chance(0.4), [0.0; 3])).collect();
        match kind {
            0 => {}
            1 | 2 => axes.extend([axis(tilting, true, table[0]), axis(5, true, table[1])]),
            3 | 4 => axes.extend([axis(5, true, table[1]), axis(tilting, false, tool[1])]),
            _ => axes.extend([axis(5, false, tool[0]), axis(tilting, false, tool[1])]),
        }
        let is_aligned = kind > 0 && !is_nutating;
        let rates =
            (random.chance(0.92)).then(|| [0; 6].map(|_| random.between(5000.0, 30_000.0).round()));
        let change = match random.choice(3) {
            0 => [None; 6],
            1 => [None, None, Some(0.0), None, None, None],
            _ => {
                let c = (kind > 0 && random.chance(0.3)).then_some(30.0);
                [Some(-50.0), Some(20.0), Some(-100.0), None, None, c]
            }
        };
        let is_endless = random.chance(0.5);
        Machine { axes, tilting: is_aligned.then_some(tilting), is_endless, rates, change }
    }

    /// Returns the machine's file.
    pub(crate) fn file(&self) -> String {
        let mut change = String::new();
        for (letter, value) in LETTERS.iter().zip(self.change) {
            if let Some(value) = value {
                let _ = write!(
                    change,
                    "{}{letter} = {value:.1}",
                    ["", ", "][usize::from(!change.is_empty())]
                );
            }
        }
        let change =
            if change.is_empty() { "\"stays\"".to_owned() } else { format!("{{ {change} }}") };
        let mut text = format!("name = \"random\"\ntool_change = {change}\n");
        for Axis { index, is_of_table, direction, point } in &self.axes {
            let side = if *is_of_table { "table" } else { "tool" };
            let kind = if *index < 3 { "linear" } else { "rotary" };
            let _ = write!(
                text,
                "[[axis]]\nletter = \"{}\"\nkind = \"{kind}\"\ncarries = \"{side}\"\nhome = 0\n",
                LETTERS[*index]
            );
            if *index > 2 {
                let direction = <[f64; 3]>::from(*direction);
                let _ = writeln!(text, "direction = {direction:?}\npoint = {point:?}");
            }
            if let Some([low, high]) = self.limits(*index) {
                let _ = writeln!(text, "limits = [{low:.1}, {high:.1}]");
            }
            if let Some(rates) = self.rates {
                let _ = writeln!(text, "rapid = {:.0}", rates[*index]);
            }
        }
        text
    }

    pub(crate) fn has(&self, index: usize) -> bool {
        self.axes.iter().any(|axis| axis.index == index)
    }

    pub(crate) fn is_of_table(&self, index: usize) -> bool {
        self.axes.iter().any(|axis| axis.index == index && axis.is_of_table)
    }

    /// Returns the limits of a rotary axis.
    pub(crate) fn limits(&self, index: usize) -> Option<[f64; 2]> {
        match index {
            3 | 4 => Some([-100.0, 100.0]),
            5 if !self.is_endless => Some([-400.0, 400.0]),
            _ => None,
        }
    }

    /// Returns the place of the link that the axes of a side carry. A positive command moves the tool relative to the part.
    fn link(&self, is_of_table: bool, joints: &Axes) -> Isometry3<f64> {
        let mut link = Isometry3::identity();
        for axis in self.axes.iter().filter(|axis| axis.is_of_table == is_of_table) {
            let value = joints[axis.index] * if is_of_table { -1.0 } else { 1.0 };
            link *= if axis.index < 3 {
                Isometry3::from_parts(
                    Translation3::from(axis.direction * value),
                    UnitQuaternion::identity(),
                )
            } else {
                let direction = Unit::new_unchecked(axis.direction);
                let turn = UnitQuaternion::from_axis_angle(&direction, value.to_radians());
                Isometry3::rotation_wrt_point(turn, Point3::from(axis.point))
            };
        }
        link
    }

    /// Returns the frame on the link of the table in which a part stands: its axes are parallel to those of the machine, and its origin is
    /// at X, Y and Z of `origin`, while the rotary axes stand at those of `origin`.
    pub(crate) fn part_frame(&self, origin: &Axes) -> Isometry3<f64> {
        let turned = [0.0, 0.0, 0.0, origin[3], origin[4], origin[5]];
        self.link(true, &turned).inverse() * Translation3::new(origin[0], origin[1], origin[2])
    }

    /// Returns the pose of a tool by its length relative to a part.
    pub(crate) fn pose(&self, joints: &Axes, length: f64, part: &Isometry3<f64>) -> ToolPose {
        let part = (self.link(true, joints) * part).inverse();
        let tool = self.link(false, joints);
        let tip = part * tool * Point3::new(0.0, 0.0, -length);
        ToolPose { tip: tip.coords, axis: (part * tool) * Vector3::z() }
    }

    /// Returns the joints, with the given rotary ones, at which the tip is at a place of the part.
    pub(crate) fn reach(
        &self,
        rotary: &Axes,
        tip: Vector3<f64>,
        length: f64,
        part: &Isometry3<f64>,
    ) -> Axes {
        let at = |x, y, z| {
            let joints = [x, y, z, rotary[3], rotary[4], rotary[5]];
            self.pose(&joints, length, part).tip
        };
        let start = at(0.0, 0.0, 0.0);
        let columns = [at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(0.0, 0.0, 1.0)];
        let matrix = Matrix3::from_columns(&columns.map(|column| column - start));
        let linear = matrix.try_inverse().expect("three directions") * (tip - start);
        [linear.x, linear.y, linear.z, rotary[3], rotary[4], rotary[5]]
    }

    /// Returns the joints nearest to the present ones, linear ones at rest, at which the tool stands along a direction of the link that
    /// carries the part. The tool is along Rz(c) Rx(a) z or Rz(c) Ry(b) z there, wherever A, B and C are. With `is_lower`, the tilting axis
    /// has the lower of its two values.
    pub(crate) fn align(
        &self,
        joints: &Axes,
        direction: Vector3<f64>,
        is_lower: bool,
    ) -> Option<Axes> {
        let tilting = self.tilting?;
        let tilt = direction.z.clamp(-1.0, 1.0).acos().to_degrees();
        let heading = match tilting {
            3 => direction.x.atan2(-direction.y),
            _ => direction.y.atan2(direction.x),
        };
        let mut best: Option<Axes> = None;
        for (tilt, heading) in [(tilt, heading.to_degrees()), (-tilt, heading.to_degrees() + 180.0)]
        {
            for turns in -3..=3 {
                let mut found = *joints;
                found[tilting] = tilt;
                if tilt.abs() > 1e-6 {
                    found[5] = heading + 360.0 * f64::from(turns);
                }
                let is_allowed = |index: usize| {
                    self.limits(index)
                        .is_none_or(|[low, high]| (low..=high).contains(&found[index]))
                };
                let turn = |found: &Axes| {
                    // The value comes before the way to it.
                    let value = if is_lower { 1e6 * found[tilting] } else { 0.0 };
                    value + (found[tilting] - joints[tilting]).abs() + (found[5] - joints[5]).abs()
                };
                if is_allowed(tilting)
                    && is_allowed(5)
                    && best.as_ref().is_none_or(|best| turn(&found) < turn(best) - 1e-9)
                {
                    best = Some(found);
                }
            }
        }
        best
    }
}

/// Returns the rotation about an axis, 0 to 2, by degrees.
pub(crate) fn about(axis: usize, degrees: f64) -> Rotation3<f64> {
    let mut direction = Vector3::zeros();
    direction[axis] = 1.0;
    Rotation3::from_axis_angle(&Unit::new_unchecked(direction), degrees.to_radians())
}
