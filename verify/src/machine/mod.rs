//! Machine tools: axes, forward and inverse kinematics, and the motions that a control makes of linear joint
//! motions.
//!
//! # The file
//! A [`Machine`] is a TOML file of a `name` and an `[[axis]]` per axis. The axes of one side are in order,
//! from the machine's base to the workpiece or from the base to the spindle. Lengths are in millimetres,
//! angles in degrees.
//!
//! | key | meaning |
//! |---|---|
//! | `letter` | `X`, `Y`, `Z` (all three required), `A`, `B`, `C` (at most two) |
//! | `kind` | `linear` for X, Y, Z and `rotary` for A, B, C |
//! | `carries` | `table` or `tool`: the side on which the axis is |
//! | `direction` | rotary only: a vector along the axis, about which a positive command turns the tool counter-clockwise relative to the workpiece |
//! | `point` | rotary only: a point of the axis in machine coordinates, with all axes at 0 |
//! | `limits` | optional: least and greatest joint value |
//! | `home` | optional: joint value of the reference position, for G28 |
//! | `rapid` | optional, for all axes or none: speed in rapid traverse, in mm or degrees per minute |
//!
//! The file can state `tool_change`: `"stays"` if M6 leaves the axes where they are, or the joint values at which it leaves
//! axes, such as `{ Z = 0 }`; axes that are not named stay. Without it, the control's rules decide.
//!
//! The file can state `m92 = [x, y, z]`: the machine coordinates of the point from which M92 of Heidenhain counts, in mm.
//!
//! A `[[body]]` states a body of the machine, for a check of its motions against others. Lengths are in mm, in machine coordinates
//! with all axes at 0.
//!
//! | key | meaning |
//! |---|---|
//! | `name` | its name in findings |
//! | `moves_with` | the axis that moves it, `base`, or `spindle` for the head that holds the tool |
//! | `mesh` | its shape: a mesh in a file beside the machine's, in mm |
//! | `box` | or its lowest and its highest corner |
//! | `cylinder` | or its `radius` and `height` |
//! | `tool` | or a solid of revolution: a `.tool` file beside the machine's, or a built-in tool |
//! | `position` | the place of the mesh's origin, of the middle of the cylinder's lower end, or of the tool's tip; the origin if absent |
//! | `axis` | the direction of the cylinder, or from the tool's tip to its spindle; `[0, 0, 1]` if absent |
//! | `margin` | distance to keep; 0 if absent |
//! | `against` | what it is checked against: names of bodies, `tool`, `part`, `fixtures` |
//!
//! A pair is checked if one of both names the other. One has to be a `tool` and the other one not: the depth of meshes in solids of
//! revolution is proved. The tools of the program are solids, part and fixtures are meshes.
//!
//! Linear axes move along the machine coordinate of their letter, and no rotary axis carries one. Directions
//! are those of ISO 841, also for axes of the table: a positive command turns such a table clockwise. A
//! control that turns it counter-clockwise, as LinuxCNC's `xyzac-trt-kins` does by default, needs the
//! opposite direction, such as `[-1, 0, 0]`. A machine of the library turns by ISO 841 unless
//! [`Rule::RotaryDirection`](crate::gcode::Rule::RotaryDirection) says otherwise.
//!
//! # Kinematics
//! With all axes at 0, the gauge point of the spindle is at the origin of machine coordinates and the spindle
//! points along −z: the tool axis, from the tip to the spindle, is +z. The tip is at (0, 0, −h) for a tool
//! length h.
//!
//! Let J(q) be the motion of an axis at the joint value q: a translation by q, or a rotation by q about its
//! line. ISO 841 states directions as motions of the tool relative to the workpiece. An axis that carries the
//! tool therefore moves its link by J(q), and one that carries the table by J(−q). Let t₁ … tₙ be the axes of
//! the table, from the base outwards, and s₁ … sₘ those of the tool. Link k of the table side is the body
//! that t₁ … tₖ move: 0 is the base, n carries the workpiece. In machine coordinates, link k is at J_t₁(−q) …
//! J_tₖ(−q), and the tip's frame at J_s₁(q) … J_sₘ(q) T(0, 0, −h). The pose of the tip's frame relative to
//! link k is hence one product:
//!
//! > P_k = J_tₖ(q) … J_t₁(q) · J_s₁(q) … J_sₘ(q) · T(0, 0, −h)
//!
//! The frame of every link coincides with machine coordinates when all axes are at 0.
//!
//! **Workpiece.** Let o be a work offset, and G(r) = J_tₙ(r) … J_t₁(r) the rotary axes of the table alone.
//! The frame of the workpiece is F = G(o_r) T(o_xyz) in link n: when the rotary axes are at the offset's
//! values, its axes are parallel to those of machine coordinates, and its origin is where the tip of a tool
//! of length 0 is at the joint values o. The pose relative to the workpiece is F⁻¹ Pₙ. An offset of a rotary
//! axis of the tool shifts the values of this axis only.
//!
//! **Without TCP** (tool centre point control), program coordinates p give the joint values p + o + (0, 0,
//! h), as [`Setup::joints`]. **With TCP**, they are the coordinates of the tip in the frame of the workpiece,
//! which turns with the table, and the linear joints follow ([`Chain::linear_joints`]).
//!
//! # Motions
//! Between two blocks a control interpolates rotary joints linearly in time, together with the linear joints
//! or, with TCP, with the tip. [`JointMotion`] is this motion, with a proved bound on its deviation from a
//! [`Motion`](touchoff::Motion), the limits of axes, and singular passes.

mod body;
mod chain;
mod deviation;
mod error;
mod file;
mod inverse;
mod limits;
mod motion;
#[cfg(test)]
mod tests;

pub use body::{BodyFault, BodyShape, MachineBody, Opponent};
pub use chain::{Chain, RoundingBound};
pub(crate) use chain::{Mover, Reference, Relation, sin_cos_degrees};
pub use error::{InverseError, JointError, MachineError, MachineFault};
pub use inverse::{InverseSolution, REACH_TOLERANCE};
pub use limits::{LimitViolation, SINGULAR_ANGLE, SINGULAR_TURN, SingularPass};
pub use motion::{JointMotion, LinearPath, Plane};

use nalgebra::{Point3, Vector2, Vector3};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// Values of the axes X, Y, Z in millimetres and A, B, C in degrees. An axis that the machine lacks is at 0.
pub type Joints = [f64; 6];

/// Largest magnitude of a length: joint values, points of axes, work offsets, tool lengths. In millimetres.
pub const MAX_LENGTH: f64 = 1e6;

/// Largest magnitude of a rotary joint value, in degrees.
pub const MAX_DEGREES: f64 = 1e6;

/// The machines that come with the library: names and files.
const LIBRARY: [(&str, &str); 15] = [
    ("3-axis", include_str!("machines/3-axis.toml")),
    ("4-axis", include_str!("machines/4-axis.toml")),
    ("A-C trunnion", include_str!("machines/a-c-trunnion.toml")),
    ("B-C table-table", include_str!("machines/b-c-table.toml")),
    ("A-B table-table", include_str!("machines/a-b-table.toml")),
    ("B-C nutating table", include_str!("machines/b-c-nutating-table.toml")),
    ("A head + C table", include_str!("machines/a-head-c-table.toml")),
    ("B head + C table", include_str!("machines/b-head-c-table.toml")),
    ("B nutating head + C table", include_str!("machines/b-nutating-head-c-table.toml")),
    ("A-C fork head", include_str!("machines/a-c-fork-head.toml")),
    ("B-C fork head", include_str!("machines/b-c-fork-head.toml")),
    ("A-B head", include_str!("machines/a-b-head.toml")),
    ("B-C nutating head", include_str!("machines/b-c-nutating-head.toml")),
    ("A-C trunnion with bodies", include_str!("machines/a-c-trunnion-bodies.toml")),
    ("A-C fork head with bodies", include_str!("machines/a-c-fork-head-bodies.toml")),
];

/// The letter of an axis (ISO 841).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
#[allow(missing_docs)]
pub enum Letter {
    X,
    Y,
    Z,
    A,
    B,
    C,
}

impl Letter {
    /// All letters, in the order of [`Joints`].
    pub const ALL: [Letter; 6] = [Letter::X, Letter::Y, Letter::Z, Letter::A, Letter::B, Letter::C];

    /// Returns the letter's index in [`Joints`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Returns whether the letter is that of a rotary axis.
    pub const fn is_rotary(self) -> bool {
        matches!(self, Letter::A | Letter::B | Letter::C)
    }
}

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// A link of a machine: something that its axes move as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Link {
    /// The base, which stands still.
    Base,
    /// The link that an axis moves: those before it on its side move it, too.
    Axis(Letter),
}

/// The letter of the axis, or `base`.
impl fmt::Display for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Link::Base => f.write_str("base"),
            Link::Axis(letter) => letter.fmt(f),
        }
    }
}

/// The side of a machine on which an axis is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Between the base and the workpiece.
    Table,
    /// Between the base and the spindle.
    Tool,
}

/// An axis of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// The letter, which states the kind: X, Y, Z are linear, A, B, C rotary.
    pub letter: Letter,
    /// The side that the axis carries.
    pub side: Side,
    /// Direction of the tool's motion relative to the workpiece for a positive command: a unit vector in
    /// machine coordinates.
    pub direction: Vector3<f64>,
    /// A point of a rotary axis, in mm, in machine coordinates with all axes at 0; the origin for a linear
    /// axis.
    pub point: Point3<f64>,
    /// Least and greatest joint value, in mm or degrees.
    pub limits: Option<[f64; 2]>,
    /// Joint value of the reference position, in mm or degrees.
    pub home: Option<f64>,
    /// Speed in rapid traverse, in mm or degrees per minute.
    pub rapid: Option<f64>,
}

impl Axis {
    /// Returns whether it is rotary and tilts what it carries: it does not turn about Z.
    pub(crate) fn tilts(&self) -> bool {
        self.letter.is_rotary() && self.direction.xy() != Vector2::zeros()
    }
}

/// A machine tool with the axes X, Y, Z and up to two rotary axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    name: String,
    axes: Vec<Axis>,
    tool_change: Option<[Option<f64>; 6]>,
    builder_point: Option<[f64; 6]>,
    bodies: Vec<MachineBody>,
    /// Set for a machine of the library, whose rotary axes turn by convention.
    is_of_library: bool,
}

/// The length of the longest name of a machine, a body, a fixture or a part, in characters: each finding has it.
pub(crate) const MAX_NAME: usize = 100;

/// Returns whether a name is one line that findings can have.
pub(crate) fn is_name(name: &str) -> bool {
    !name.trim().is_empty()
        && name.chars().nth(MAX_NAME).is_none()
        && !name.contains(char::is_control)
}

impl Machine {
    /// Parses a machine from TOML. `file` is its path, for errors and for the files of its bodies.
    ///
    /// # Errors
    /// If the text is not TOML, if a key is unknown or missing, or if the axes are no machine that is
    /// supported.
    ///
    /// ```
    /// use touchoff_verify::machine::Machine;
    ///
    /// let file = r#"
    ///     name = "4-axis"
    ///     axis = [
    ///         { letter = "X", kind = "linear", carries = "table" },
    ///         { letter = "A", kind = "rotary", carries = "table", direction = [1, 0, 0], point = [0, 0, -300] },
    ///         { letter = "Y", kind = "linear", carries = "tool" },
    ///         { letter = "Z", kind = "linear", carries = "tool", limits = [-400, 0] },
    ///     ]"#;
    /// let machine = Machine::parse(file, "4-axis.toml")?;
    /// assert_eq!(machine.axes().len(), 4);
    /// let error = Machine::parse("name = \"lathe\"\nspindles = 2", "lathe.toml").expect_err("an unknown key");
    /// assert!(error.to_string().starts_with("lathe.toml:2: unknown field `spindles`"));
    /// # Ok::<(), touchoff_verify::machine::MachineError>(())
    /// ```
    pub fn parse(text: &str, file: impl AsRef<Path>) -> Result<Machine, MachineError> {
        file::parse(text, file.as_ref())
    }

    /// Returns a machine of the library: one of [`Machine::names`].
    ///
    /// # Errors
    /// [`MachineError::UnknownName`] for another name.
    pub fn named(name: &str) -> Result<Machine, MachineError> {
        match LIBRARY.iter().find(|(known, _)| *known == name) {
            Some((name, text)) => {
                Ok(Machine { is_of_library: true, ..Machine::parse(text, name)? })
            }
            None => Err(MachineError::UnknownName {
                name: name.to_owned(),
                known: LIBRARY.map(|(name, _)| format!("`{name}`")).join(", "),
            }),
        }
    }

    /// Returns the file of a machine of the library, as text.
    pub fn file(name: &str) -> Option<&'static str> {
        LIBRARY.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
    }

    /// Returns the names of the machines that come with the library.
    pub fn names() -> impl Iterator<Item = &'static str> {
        LIBRARY.iter().map(|(name, _)| *name)
    }

    /// Returns the machine's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the axes, in the order of the file.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Returns the axis of a letter.
    pub fn axis(&self, letter: Letter) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.letter == letter)
    }

    /// Returns the bodies that the file states, in its order.
    pub fn bodies(&self) -> &[MachineBody] {
        &self.bodies
    }

    /// Returns whether a rotary axis carries a side.
    pub(super) fn has_rotary(&self, side: Side) -> bool {
        self.axes.iter().any(|axis| axis.letter.is_rotary() && axis.side == side)
    }

    /// Returns whether its file states how its rotary axes turn. A machine of the library turns by ISO 841, which a control may not
    /// share ([`Rule::RotaryDirection`](crate::gcode::Rule::RotaryDirection)).
    pub(crate) fn states_directions(&self) -> bool {
        !self.is_of_library || !self.axes.iter().any(|axis| axis.letter.is_rotary())
    }

    /// Returns the machine with opposite directions of some rotary axes.
    pub(crate) fn reversed(&self, is_reversed: impl Fn(Letter) -> bool) -> Machine {
        let mut machine = self.clone();
        let rotary = machine.axes.iter_mut().filter(|axis| axis.letter.is_rotary());
        for axis in rotary.filter(|axis| is_reversed(axis.letter)) {
            axis.direction = -axis.direction;
        }
        machine
    }

    /// Returns the joint values of the reference position, in mm and degrees, as far as the file states them.
    pub fn home(&self) -> [Option<f64>; 6] {
        Letter::ALL.map(|letter| self.axis(letter).and_then(|axis| axis.home))
    }

    /// Returns the joint values, in mm and degrees, at which a tool change leaves the axes: `None` for an axis that stays.
    /// `None` for all if the file does not state it.
    pub fn tool_change(&self) -> Option<[Option<f64>; 6]> {
        self.tool_change
    }

    /// Returns the machine coordinates of the point from which M92 of Heidenhain counts, in mm, if the file states it.
    pub fn builder_point(&self) -> Option<[f64; 6]> {
        self.builder_point
    }

    /// Returns the chain from the workpiece to the tool's tip.
    ///
    /// # Errors
    /// If the work offset or the tool length is out of range, or if the offset states a rotary axis that the
    /// machine lacks.
    pub fn chain(&self, setup: &Setup) -> Result<Chain, JointError> {
        Chain::new(self, setup)
    }
}

/// The position of the workpiece on a machine, and the length of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Setup {
    /// Work offset, such as that of G54, in machine coordinates: mm and degrees.
    pub work_offset: Joints,
    /// Distance from the tip to the gauge point of the spindle along the tool axis, in mm.
    pub tool_length: f64,
}

impl Setup {
    /// Returns what a control without TCP adds to program coordinates, in mm and degrees: o + (0, 0, h). A
    /// path of program coordinates becomes one of joints by [`LinearPath::translated`].
    pub fn shift(&self) -> Joints {
        let mut shift = self.work_offset;
        shift[2] += self.tool_length;
        shift
    }

    /// Returns the joint values, in mm and degrees, at which a control without TCP puts program coordinates:
    /// p + o + (0, 0, h). Both sums are rounded once.
    pub fn joints(&self, program: &Joints) -> Joints {
        let shift = self.shift();
        std::array::from_fn(|index| program[index] + shift[index])
    }
}
