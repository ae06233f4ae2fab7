//! State of a control that changes seldom, and the coordinates that it defines.
//!
//! **Coordinates.** A block states a position p in *program coordinates*. In the *workpiece's* frame, which
//! has its origin and its axes in the work offset, the position is
//!
//! w = R p + o + s,
//!
//! with the rotation R and the origin o of a [rotated or tilted plane](Rotation) and the
//! [shift](ControlState::shift) s. If [positions turn with the
//! workpiece](ControlState::turns_with_workpiece), w is the tip in a frame that turns, and the kinematics of
//! the machine give its axes. Otherwise these stand at
//!
//! m = Q w + w₀ + h ẑ,
//!
//! with the origin w₀ and the rotation Q about z of the [work offset](ControlState::origin), and the tool
//! length h. Rotary axes are shifted in the same way, and not rotated. Q turns the workpiece with its frame,
//! so it has no part in w.
//!
//! An unknown coordinate is `None`. A result is unknown if it depends on an unknown coordinate. A known one
//! is within 2⁻⁴⁶ of exact, times the sum of the absolute values of the coordinates, origins and shifts that
//! it depends on: the entries of a product of three rotations are within 2⁻⁴⁸, and a sum has at most eight
//! terms.

use super::Choice;
use crate::machine::sin_cos_degrees;
use nalgebra::{Matrix3, Vector3};
use std::fmt;

/// A position: X Y Z in millimetres, A B C in degrees. `None`: only the machine knows the coordinate.
pub type Position = [Option<f64>; 6];

/// State of a control that changes seldom. Motions share it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ControlState {
    /// Number of the tool in the spindle; `None`: not stated by the program.
    pub tool: Option<u32>,
    /// The tool length offset.
    pub length: LengthOffset,
    /// The work offset.
    pub work_offset: WorkOffset,
    /// Origin of the work offset, in machine coordinates.
    pub origin: Position,
    /// Rotation of the work offset about z (`G10 L2 R`), in degrees.
    pub origin_rotation: f64,
    /// Sum of G52 and G92. A coordinate is `None` if G92 was given at a position that only the machine knows.
    pub shift: Position,
    /// Tool centre point control.
    pub tcp: Tcp,
    /// The number of words before that have switched it on.
    pub tcp_starts: usize,
    /// The rotation of the program's coordinates.
    pub rotation: Rotation,
    /// The number of tilted planes that have begun before.
    pub plane_starts: usize,
    /// The tool axis between two positions of the rotary axes, where the program states it: [`Choice::ByAxes`] (ORIMKS with ORIAXES) or
    /// [`Choice::GreatCircle`] (ORIWKS with ORIVECT).
    pub orientation: Option<Choice>,
    /// Set by M126 of Heidenhain: rotary axes turn the shorter way to an absolute position.
    pub shorter_way: bool,
}

/// Tool length offset (G43).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LengthOffset {
    /// None: the program states positions of the spindle's gauge point.
    Off,
    /// A length, which is a register of the control.
    On {
        /// Number after H, or of the tool.
        register: u32,
        /// The length in millimetres, if it is known.
        length: Option<f64>,
    },
}

/// Work offset (G54).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WorkOffset {
    /// None: coordinates are those of the machine (G500 of Sinumerik).
    Off,
    /// G54 to G59.3, numbered from 1 to 9.
    Standard(u8),
    /// Fanuc's `G54.1 P1` to `P300`, which are `G154 P1` to `P300` of Haas.
    Additional(u16),
}

impl WorkOffset {
    /// The first of the G words of Haas that are further work offsets: G110 to G129 are G154 P1 to P20.
    pub(crate) const FIRST_OF_HAAS: u32 = 110;
    /// The first of those of Sinumerik: G505 and G506 are G58 and G59 of ISO mode, and G507 to G599 go on.
    pub(crate) const FIRST_OF_SINUMERIK: u32 = 507;
}

impl fmt::Display for WorkOffset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WorkOffset::Off => f.write_str("G500"),
            WorkOffset::Standard(number @ 1..=6) => write!(f, "G{}", 53 + number),
            WorkOffset::Standard(number) => write!(f, "G59.{}", number.saturating_sub(6)),
            WorkOffset::Additional(number) => write!(f, "G54.1 P{number}"),
        }
    }
}

/// Tool centre point control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tcp {
    /// Off: the linear axes do not follow the rotary axes.
    Off,
    /// On, with rotary axes in the program (G43.4, G234, M428).
    Rotary,
    /// On, by `TRAORI` of Sinumerik, with rotary axes in the program.
    Transformation,
    /// On, with tool vectors in the program (G43.5).
    Vector,
}

/// Rotation of the program's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation {
    /// None.
    Off,
    /// Rotation about the normal of the selected plane (G68).
    Plane {
        /// The map to unrotated coordinates.
        frame: Frame,
    },
    /// Tilted plane (G68.2).
    Tilted {
        /// The map to untilted coordinates.
        frame: Frame,
        /// Set by G53.1: the rotary axes hold the tool along z of the tilted plane, and positions turn with
        /// the workpiece as under tool centre point control.
        aligned: bool,
    },
}

/// The map p ↦ R p + o.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The rotation R.
    pub rotation: Matrix3<f64>,
    /// The origin o, in millimetres.
    pub origin: Vector3<f64>,
}

impl Rotation {
    /// Returns the map from the program's coordinates to unrotated ones, if it is not the identity by
    /// definition.
    pub fn frame(&self) -> Option<&Frame> {
        match self {
            Rotation::Off => None,
            Rotation::Plane { frame } | Rotation::Tilted { frame, .. } => Some(frame),
        }
    }
}

impl LengthOffset {
    /// Returns the length in millimetres: 0 if the offset is off, `None` if it is not known.
    pub fn length(&self) -> Option<f64> {
        match *self {
            LengthOffset::Off => Some(0.0),
            LengthOffset::On { length, .. } => length,
        }
    }
}

/// The rotary axes of a machine, with the angles of its table at which the part is set up.
#[derive(Clone, Copy, Debug)]
pub(super) struct RotaryAxes {
    /// Set for the axes that carry the tool.
    pub(super) carries_tool: [bool; 6],
    /// Set for the rotary axes that tilt what they carry: those that do not turn about Z.
    pub(super) tilts: [bool; 6],
    /// Origin of G54, which is the frame of the part, in machine coordinates.
    pub(super) part: Position,
}

impl RotaryAxes {
    /// Returns whether the tool may be tilted: an axis that carries it is not where it turns nothing.
    pub(super) fn tilts_tool(&self, turns_nothing: [bool; 3]) -> bool {
        (0..3).any(|k| !turns_nothing[k] && self.tilts[k + 3] && self.carries_tool[k + 3])
    }

    /// Returns whether tool or part may be tilted.
    pub(super) fn tilts(&self, turns_nothing: [bool; 3]) -> bool {
        (0..3).any(|k| !turns_nothing[k] && self.tilts[k + 3])
    }
}

impl ControlState {
    /// Converts a position from program coordinates to the workpiece's frame.
    pub fn to_workpiece(&self, position: Position) -> Position {
        let mut result = position;
        if let Some(Frame { rotation, origin }) = self.rotation.frame() {
            let linear = rotated(rotation, linear(position));
            for k in 0..3 {
                result[k] = linear[k].map(|value| value + origin[k]);
            }
        }
        add(result, self.shift, 1.0)
    }

    /// Converts a position from the workpiece's frame to program coordinates.
    pub fn from_workpiece(&self, position: Position) -> Position {
        let mut result = add(position, self.shift, -1.0);
        if let Some(Frame { rotation, origin }) = self.rotation.frame() {
            let from_origin = [0, 1, 2].map(|k| result[k].map(|value| value - origin[k]));
            result[..3].copy_from_slice(&rotated(&rotation.transpose(), from_origin));
        }
        result
    }

    /// Converts a position from program to machine coordinates. Unknown in X Y Z if positions turn with the
    /// workpiece, since the kinematics of the machine then have a part in it.
    pub fn to_machine(&self, position: Position) -> Position {
        let workpiece = self.to_workpiece(position);
        let mut result = workpiece;
        let turn = about(2, self.origin_rotation);
        result[..3].copy_from_slice(&rotated(&turn, linear(workpiece)));
        let mut result = add(result, self.origin, 1.0);
        result[2] = result[2].zip(self.length.length()).map(|(z, length)| z + length);
        if self.turns_with_workpiece() {
            result[..3].fill(None);
        }
        result
    }

    /// Converts a position from machine to program coordinates, with the same exception.
    pub fn from_machine(&self, position: Position) -> Position {
        let mut result = position;
        result[2] = result[2].zip(self.length.length()).map(|(z, length)| z - length);
        let mut result = add(result, self.origin, -1.0);
        // The inverse of the map to the machine, from its end.
        let turn = about(2, -self.origin_rotation);
        let turned = rotated(&turn, linear(result));
        result[..3].copy_from_slice(&turned);
        if self.turns_with_workpiece() {
            result[..3].fill(None);
        }
        self.from_workpiece(result)
    }

    /// Returns whether positions are those of the tip in a workpiece that turns with its table: under tool
    /// centre point control, and in a tilted plane after G53.1.
    pub fn turns_with_workpiece(&self) -> bool {
        self.tcp != Tcp::Off || matches!(self.rotation, Rotation::Tilted { aligned: true, .. })
    }

    /// Returns for each of A, B and C whether it is certain that it turns nothing at a position in program coordinates: an
    /// axis of the table at 0 of G54, with which the part is turned, and an axis that carries the tool at 0 of the machine.
    /// An axis of such an offset that is not known has none.
    pub(super) fn turns_nothing(&self, position: Position, axes: &RotaryAxes) -> [bool; 3] {
        let workpiece = self.to_workpiece(position);
        [3, 4, 5].map(|axis| {
            let origin = match axes.carries_tool[axis] {
                true => self.origin[axis],
                false => self.origin[axis].zip(axes.part[axis]).map(|(own, part)| own - part),
            };
            workpiece[axis].is_some_and(|angle| angle + origin.unwrap_or_default() == 0.0)
        })
    }

    /// Returns the program coordinates, after a change to `new`, of an unmoved machine that stood at
    /// `position`.
    ///
    /// A coordinate becomes unknown if it depends on an unknown work offset or tool length, or on the
    /// kinematics of the machine. These have no part while A, B and C
    /// [turn nothing](ControlState::turns_nothing).
    pub(super) fn carry_over(
        &self,
        new: &ControlState,
        mut position: Position,
        axes: &RotaryAxes,
    ) -> Position {
        let turns = [self, new].map(ControlState::turns_with_workpiece);
        let lengths = self.length.length().zip(new.length.length());
        let lengthened =
            |z: Option<f64>| z.zip(lengths).map(|(z, (before, after))| z + before - after);
        let changes_length = self.length != new.length;
        let is_aligned = matches!(self.rotation, Rotation::Tilted { aligned: true, .. });
        // The tool stands along z of an aligned plane, in whatever direction that is.
        let along_plane = is_aligned && self.rotation == new.rotation;
        if changes_length && along_plane {
            position[2] = lengthened(position[2]);
        }
        let changes_offset = self.work_offset != new.work_offset
            || self.origin != new.origin
            || self.origin_rotation != new.origin_rotation;
        let changes_machine = changes_offset || changes_length && !along_plane;
        if !changes_machine
            && turns[0] == turns[1]
            && self.shift == new.shift
            && self.rotation == new.rotation
        {
            return position;
        }
        let mut workpiece = self.to_workpiece(position);
        let at_zero = self.turns_nothing(position, axes) == [true; 3];
        // The kinematics of the machine have no part in it only while the rotary axes stand at 0.
        if (turns[0] != turns[1] || turns[0] && changes_machine) && !at_zero {
            workpiece[..3].fill(None);
        }
        if changes_length && !along_plane {
            workpiece[2] = lengthened(workpiece[2]);
        }
        if changes_offset {
            workpiece = self.change_offset(new, workpiece);
        }
        new.from_workpiece(workpiece)
    }

    /// Converts a position from one work offset to another: w' = Q'⁻¹ (Q w + w₀ − w₀').
    fn change_offset(&self, new: &ControlState, workpiece: Position) -> Position {
        let is_same = self.work_offset == new.work_offset;
        // An origin that stays changes nothing, also where it is unknown.
        let mut change = [Some(0.0); 6];
        for (change, (before, after)) in
            change.iter_mut().zip(self.origin.into_iter().zip(new.origin))
        {
            if !(is_same && before == after) {
                *change = before.zip(after).map(|(before, after)| before - after);
            }
        }
        let back = about(2, -new.origin_rotation);
        // Then Q cancels: the position needs no turn, by which an unknown coordinate would spread to others.
        if self.origin_rotation == new.origin_rotation {
            let turned = rotated(&back, linear(change));
            change[..3].copy_from_slice(&turned);
            return add(workpiece, change, 1.0);
        }
        let mut result = workpiece;
        let turned = rotated(&about(2, self.origin_rotation), linear(workpiece));
        result[..3].copy_from_slice(&turned);
        let mut result = add(result, change, 1.0);
        let turned = rotated(&back, linear(result));
        result[..3].copy_from_slice(&turned);
        result
    }
}

/// Returns the rotation by an angle in degrees about an axis: 0 is x, 1 is y, 2 is z. It is exact at multiples of 90.
pub(crate) fn about(axis: usize, degrees: f64) -> Matrix3<f64> {
    let (sine, cosine) = sin_cos_degrees(degrees);
    let [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
    let mut matrix = Matrix3::identity();
    matrix[(first, first)] = cosine;
    matrix[(second, second)] = cosine;
    matrix[(first, second)] = -sine;
    matrix[(second, first)] = sine;
    matrix
}

fn linear(position: Position) -> [Option<f64>; 3] {
    [position[0], position[1], position[2]]
}

/// Multiplies by a matrix. Coordinates with the factor zero have no part in a result.
fn rotated(matrix: &Matrix3<f64>, vector: [Option<f64>; 3]) -> [Option<f64>; 3] {
    [0, 1, 2].map(|row| {
        let terms = (0..3).filter(|column| matrix[(row, *column)] != 0.0);
        terms.map(|column| vector[column].map(|value| matrix[(row, column)] * value)).sum()
    })
}

/// Adds a multiple of one position to another.
fn add(first: Position, second: Position, factor: f64) -> Position {
    let mut sum = first;
    for (value, other) in sum.iter_mut().zip(second) {
        *value = value.zip(other).map(|(value, other)| value + factor * other);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_others_are_rotations() {
        for turns in -9..=9 {
            for (quarter, expected) in
                [(0.0, (0.0, 1.0)), (90.0, (1.0, 0.0)), (180.0, (0.0, -1.0)), (270.0, (-1.0, 0.0))]
            {
                let angle = 360.0 * f64::from(turns) + quarter;
                assert_eq!(sin_cos_degrees(angle), expected, "{angle}");
            }
        }
        let half = sin_cos_degrees(-330.0).0;
        assert!((half - 0.5).abs() <= 1.5 * f64::EPSILON, "{half}");
        let mut worst = 0.0f64;
        for k in 0..100_000 {
            let angle = |step: f64| (f64::from(k) * step) % 720.0 - 360.0;
            let rotation = about(2, angle(0.618)) * about(0, angle(7.31)) * about(2, angle(55.1));
            worst = worst.max((rotation.transpose() * rotation - Matrix3::identity()).abs().max());
        }
        println!("RᵀR is within {worst:.1e} of the identity");
        assert!(worst <= 2f64.powi(-48), "{worst:e}");
    }
}
