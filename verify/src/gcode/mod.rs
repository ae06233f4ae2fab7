//! G-code: an interpreter of ISO 6983 programs in the dialects of Fanuc and Haas, LinuxCNC, Sinumerik and
//! Heidenhain (DIN/ISO), of native programs of Sinumerik 840D, and of conversational programs of Heidenhain (Klartext).
//!
//! An [`Interpreter`] executes a program as a control does, and returns its motions one by one. Each [`Step`]
//! is a line or an arc between two positions in program coordinates, with the [state of the
//! control](ControlState) that says what they mean. Lengths are in millimetres whatever the unit of the
//! program (a value in inches is multiplied by 25.4, rounded once), angles of A, B and C in degrees.
//!
//! ```
//! use touchoff_verify::gcode::{ControlSetup, Interpreter, StepPath};
//!
//! let program = "G21 G90 G54\nT3 M6\nG0 G43 H3 Z5.\nX10. Y0.\nG1 Z-1. F200.\nG2 I-10.\nM30\n";
//! let steps = Interpreter::new(program, &ControlSetup::default())?.collect::<Result<Vec<_>, _>>()?;
//! let circle = steps.last().expect("four motions");
//! assert_eq!(circle.end[..3], [Some(10.0), Some(0.0), Some(-1.0)]);
//! assert!(matches!(circle.path, StepPath::Arc { centre: [0.0, 0.0], sweep, .. } if sweep < -6.28));
//! # Ok::<(), touchoff_verify::gcode::GcodeError>(())
//! ```
//!
//! **What is read.**
//! - G0 G1 G2 G3 in the planes G17 G18 G19: helices, I J K by G90.1 and G91.1, R, full circles, turns P.
//! - G20 G21 (Sinumerik's G70 G71), G90 G91, G93 G94 G95, G4; G61 G64 and their like leave a [`ProgramNote`].
//! - G28 G30 with their intermediate position, G53.
//! - G54 to G59.3, `G54.1 P`, `G154 P`, G110 to G129, G52, G92 to G92.3, G10 L2 and L20.
//! - G43 H (without H: the register of the tool in the spindle), G49, T, M6.
//! - Cutter radius compensation G40 G41 G42 with D, and LinuxCNC's G41.1 G42.1, from a [table of radii](ControlSetup::radius_offsets).
//! - Canned cycles G73 G74 G81 to G86 G89 with G98 G99 in three planes, with R, Z, Q, P and repeats L or K.
//! - Polar coordinates G16, mirror images G51.1, corners `,R` and `,C` between lines.
//! - `M98 P L` with O-numbers, M97, M198 and M99, also of [other files](ControlSetup::subprograms); macros of Fanuc and Haas (G65, G66, `IF`, `WHILE`, `GOTO`) and O-words of LinuxCNC.
//! - Tool centre point control: G43.4, G43.5, G234, `TRAORI`, M428; ended by G49, `TRAFOOF`, M429.
//! - Tilted planes G68.2 with G53.1, rotation G68, both ended by G69.
//! - Variables and expressions; comments, `/`, `%`, N.
//! - Native programs of Sinumerik: expressions, loops and jumps, subprograms of the file, frames, CYCLE800, drilling cycles, tool vectors
//!   under `TRAORI`. `docs/controls.md` lists their words.
//! - Klartext, if the text begins with `BEGIN PGM NAME MM`: `docs/controls.md` lists its words.
//!
//! **What stops it.** Everything else. A word that is not understood could move the tool, so it is an error
//! with its line, its name and a remedy, and so is a word that no other word of its block uses;
//! [`Interpreter::survey`] finds all that are not read. Nothing is passed over in silence: words without an
//! effect on the path, such as `M8`, are listed in [`Interpreter::notes`].
//!
//! **What is unknown.** A coordinate is `None` if only the machine knows it: before it is programmed first,
//! after G28 without a [home](ControlSetup::home), after a tool change that [moves](Choice::Moves) the axes,
//! after a change between work offsets that are not given,
//! after a tool length that is not given comes into force (Z), and after tool centre point control is
//! switched on or off while A, B and C are not all known to be 0 (X Y Z). It becomes known when it is
//! programmed in G90.
//!
//! **What differs between controls.** Where a program leaves a choice to the control, a [`Rule`] decides. The
//! [setup](ControlSetup::rules) states them, and [`Interpreter::asked`] lists those that the program depends on.
//! Without a statement the first choice of a rule is made.
//!
//! **Assumptions.** A tool change (M6) loads the tool of its own block or, without T there, the last T. Start
//! values are G17 G90 G91.1 G94 G98 G54, and no motion mode. Subprograms that M98 calls share the variables of
//! their caller; macros and O-words have their own.

mod blank;
mod block;
mod comment;
mod control;
mod cursor;
mod error;
mod files;
mod interpreter;
mod iso;
mod klartext;
mod note;
mod rules;
mod sinumerik;
mod state;
mod survey;
mod words;

pub use blank::{Blank, BlankDoubt};
pub(crate) use comment::stated_tools;
pub use comment::{StatedEnd, StatedTool};
pub use control::Spindle;
pub(crate) use control::band_radii;
pub use error::{ArcFault, CompensationFault, GcodeError, GcodeFault};
pub(crate) use files::line_of;
pub use files::{BlockLine, SubprogramFile, SubprogramLine};
pub use interpreter::Interpreter;
pub use iso::ExpressionFault;
pub use note::{NoteKind, ProgramNote};
pub use rules::{Choice, ControlError, ControlFault, ControlRules, GENERIC, Rule};
pub(crate) use sinumerik::is_word as is_word_of_sinumerik;
pub(crate) use state::about;
pub use state::{ControlState, Frame, LengthOffset, Position, Rotation, Tcp, WorkOffset};
pub use survey::Survey;

pub use crate::machine::Plane;

use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest absolute value of a number in a program, in its unit.
pub const LARGEST_NUMBER: f64 = 1e9;
/// Largest nesting of calls of subprograms: LinuxCNC's (`INTERP_SUB_ROUTINE_LEVELS` counts the main program too).
pub const MAX_CALLS: usize = 9;
/// The largest number of assignments in a block: LinuxCNC writes those beyond it over the values of the first ones
/// (`MAX_NAMED_PARAMETERS` of its interpreter).
const MAX_ASSIGNMENTS: usize = 50;
/// Largest number of blocks and steps in subprograms, with all repeats, unless [`ControlSetup::max_repeated`] has another: some
/// seconds of work.
pub const MAX_REPEATED: usize = 2_000_000;

/// Returns how much a block that is executed again takes of [`MAX_REPEATED`]: one for each 64 bytes, since the work grows with its text.
fn work(block: &str) -> usize {
    const BYTES: usize = 64;
    1 + block.len() / BYTES
}
/// Number of steps of a block that are not counted: those of a cycle can be many more than its text.
const FREE_STEPS: usize = 100;
/// Largest number of motions of one block with a canned cycle.
pub const MAX_CYCLE_STEPS: usize = 100_000;

/// Returns the name of a variable that a job can state, in one spelling: `#500` or `#<_depth>`, `R1` of Sinumerik, `Q1`, `QL1` or `QR1`
/// of Klartext.
pub(crate) fn variable_name(text: &str) -> Option<String> {
    iso::variable_name(text)
        .or_else(|| sinumerik::variable_name(text))
        .or_else(|| klartext::variable_name(text))
}

/// State of the control before the program.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlSetup {
    /// Position of the spindle's gauge point in the coordinates of G54. Set an axis that the machine lacks to
    /// `Some(0.0)`: a known rotary axis at 0 keeps positions known when tool centre point control is
    /// switched.
    pub start: Position,
    /// Origins of G54 to G59.3 in machine coordinates.
    pub work_offsets: [Option<[f64; 6]>; 9],
    /// Origins of further work offsets, by the number after `G54.1 P`; G110 of Haas is 1, and G507 of Sinumerik.
    pub additional_offsets: BTreeMap<u16, [f64; 6]>,
    /// Tool lengths in millimetres, by H or tool number.
    pub lengths: BTreeMap<u32, f64>,
    /// Set if T0 leaves the spindle empty. Otherwise 0 is the number of a tool.
    pub t0_is_empty: bool,
    /// Radius offsets of cutter compensation in millimetres, by D or tool number: the radius of the tool, or what it differs from the
    /// radius with which the program was made. A negative one exchanges G41 and G42.
    pub radius_offsets: BTreeMap<u32, f64>,
    /// The work offset of each preset of Heidenhain by its number: 1 stands for G54, 9 for G59.3. Without any, a program selects one
    /// preset, which is that of the part.
    pub presets: BTreeMap<u32, u8>,
    /// The numbers of tools, by the names that programs of Sinumerik (`T="NAME"`) and Klartext (`TOOL CALL "NAME"`) give them, in either
    /// case.
    pub tool_names: BTreeMap<String, u32>,
    /// Position of G28 in machine coordinates, as far as it is known.
    pub home: Position,
    /// Position of G30 in machine coordinates.
    pub second_home: Option<[f64; 6]>,
    /// Upper end of the travel of Z in machine coordinates, to which M140 MB MAX of Heidenhain moves.
    pub top: Option<f64>,
    /// Machine coordinates of the point from which M92 of Heidenhain counts.
    pub builder_point: Option<[f64; 6]>,
    /// The choices of the control where controls differ.
    pub rules: ControlRules,
    /// The axes that the machine has.
    pub axes: [bool; 6],
    /// The axes that move the tool, and not the part. An origin of such a rotary axis leaves the tool where the machine has it.
    pub carries_tool: [bool; 6],
    /// The rotary axes that do not turn about Z, and so tilt what they carry.
    pub tilts: [bool; 6],
    /// Values that variables can have before the program, by name: `#500`, `#<_depth>`, `R1`, `Q1`. Lengths are in the unit of the program. An
    /// [`Interpreter`] takes the first of each.
    pub variables: BTreeMap<String, Vec<f64>>,
    /// Files of subprograms that the program can call.
    pub subprograms: Vec<SubprogramFile>,
    /// Position in which M6 leaves the axes, in machine coordinates: `None` for an axis that stays. Without it, as the
    /// [rules](Rule::ToolChange) say.
    pub tool_change: Option<Position>,
    /// Largest number of blocks and steps that are executed again or in subprograms; a program with more is refused. The readings of
    /// a program share it.
    pub max_repeated: usize,
}

impl Default for ControlSetup {
    /// Returns a control that knows no position and states no rule.
    fn default() -> ControlSetup {
        ControlSetup {
            start: [None; 6],
            work_offsets: [None; 9],
            additional_offsets: BTreeMap::new(),
            lengths: BTreeMap::new(),
            t0_is_empty: false,
            radius_offsets: BTreeMap::new(),
            presets: BTreeMap::new(),
            tool_names: BTreeMap::new(),
            home: [None; 6],
            second_home: None,
            top: None,
            builder_point: None,
            rules: ControlRules::default(),
            axes: [true; 6],
            carries_tool: [false; 6],
            tilts: [false, false, false, true, true, false],
            variables: BTreeMap::new(),
            subprograms: Vec::new(),
            tool_change: None,
            max_repeated: MAX_REPEATED,
        }
    }
}

impl ControlSetup {
    /// Returns whether no tool is in the spindle after the call of a number.
    pub(crate) fn is_spindle_empty(&self, tool: Option<u32>) -> bool {
        self.t0_is_empty && tool == Some(0)
    }
}

/// The number of blocks and steps that were executed again or in subprograms, and its limit. The others are limited by the text.
#[derive(Clone, Copy, Debug)]
struct Repeated {
    count: usize,
    limit: usize,
}

impl Repeated {
    fn new(setup: &ControlSetup) -> Repeated {
        Repeated { count: 0, limit: setup.max_repeated }
    }

    /// Counts more of them.
    fn add(&mut self, number: usize) -> Result<(), GcodeFault> {
        self.count = self.count.saturating_add(number);
        if self.count > self.limit {
            Err(GcodeFault::TooLong { limit: self.limit })
        } else {
            Ok(())
        }
    }
}

/// The axes of a step that commands Z and no other.
pub(crate) const Z_ALONE: [bool; 6] = [false, false, true, false, false, false];

/// A motion, in the program coordinates of its [state](Step::state).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// The line of its block, 1-based; in a file of subprograms, that of the program's block which calls it.
    pub line: usize,
    /// The line of its block in the file of subprograms that has it.
    pub within: Option<SubprogramLine>,
    /// Set in rapid traverse.
    pub rapid: bool,
    /// Position at the start: the end of the motion before, in the coordinates that hold now.
    pub start: Position,
    /// Position at the end. A coordinate that is `None` and not [commanded](Step::commanded) stays as it is.
    pub end: Position,
    /// Axes that the block moves to a position of its own. One whose end is `None` goes where only the
    /// machine knows.
    pub commanded: [bool; 6],
    /// The path between.
    pub path: StepPath,
    /// Under G43.5, the unit vector from the tip to the spindle at the end, in the workpiece's frame; `None`
    /// until the program gives one.
    pub tool_vector: Option<[f64; 3]>,
    /// Set if the end is stated, in G90 or in machine coordinates, and not by increments.
    pub absolute: bool,
    /// Set for the way home: of Z to a reference position or, under G53, to 0, and of other axes with it or after it.
    pub is_homeward: bool,
    /// Z of the end in machine coordinates, if the block states it in them and the machine's file gives its place.
    pub machine_height: Option<f64>,
    /// Set for the motion to a reference position (G28, G30).
    pub is_return: bool,
    /// Rotary axes that turn the shorter way to their end (DC of Sinumerik), whatever the [rule](Rule::Rotary).
    pub shortest: [bool; 6],
    /// The position at the end of an alignment with a tilted plane, if the program selects one of two; otherwise it is the nearest.
    pub alignment: Option<Alignment>,
    /// The spindle during the motion.
    pub spindle: Spindle,
    /// State of the control, shared by steps until it changes.
    pub state: Arc<ControlState>,
}

impl Step {
    /// Returns the place of its block.
    pub fn block(&self) -> BlockLine {
        BlockLine { line: self.line, within: self.within }
    }
}

/// One of two positions of the rotary axes that align the tool with a tilted plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// SEQ of Heidenhain: by the sign of the master axis, which is the rotary axis next to the tool, or else the one next to the base.
    Master {
        /// Set for angles from 0.
        is_positive: bool,
    },
    /// The direction of CYCLE800: by the value of the axis that [`Rule::SwivelAxis`] names. If one of them is out of its limits, it is the
    /// other.
    Value {
        /// Set for the higher value.
        is_higher: bool,
    },
}

/// The path of a motion. All axes start and end together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepPath {
    /// X Y Z on a straight line, and A B C in proportion to it.
    Line,
    /// X Y Z on an arc, or a helix about the normal of the plane; the other axes in proportion to the angle.
    ///
    /// If the radii of start and end differ, which is allowed by up to 0.1 % (and 0.03 mm or 0.0028 inch at
    /// least), the radius changes in proportion to the angle.
    Arc {
        /// The plane.
        plane: Plane,
        /// The centre, along the plane's first and second axis, in millimetres.
        centre: [f64; 2],
        /// The angle in radians, positive from the first axis to the second (G3). More than 2π in absolute
        /// value if P gives several turns.
        sweep: f64,
    },
    /// A rotation of A, B and C that aligns the tool with z of a tilted plane (G53.1). The angles are the
    /// machine's. If no axis is [commanded](Step::commanded), the program has turned them before.
    Align,
    /// A rotation of A, B and C, while X, Y and Z follow so that a point of the tool axis rests at the workpiece (PLANE MOVE of
    /// Heidenhain). Axes whose ends are unknown align the tool with z of a tilted plane.
    Pivot {
        /// Distance of the point below the tip, in millimetres.
        distance: f64,
    },
    /// An arc whose start is unknown in its plane.
    Undetermined,
    /// The motion of the [commanded](Step::commanded) axes alone to a position in machine coordinates, while positions [turn with the
    /// workpiece](ControlState::turns_with_workpiece) and rotary axes are turned.
    Machine(Position),
    /// The motion of a tool change to a position in machine coordinates, on a path that only the machine knows.
    /// [Commanded](Step::commanded) axes move.
    ToolChange(Position),
}

/// Reads a whole program: its steps, and the notes about it. [`Interpreter`] returns the steps one by one.
///
/// # Errors
/// If a line stops the interpreter.
pub fn read(text: &str, setup: &ControlSetup) -> Result<(Vec<Step>, Vec<ProgramNote>), GcodeError> {
    let mut interpreter = Interpreter::new(text, setup)?;
    let steps = interpreter.by_ref().collect::<Result<Vec<_>, _>>()?;
    Ok((steps, interpreter.notes()))
}

/// Returns the rules of the control for which a program is written, if its language is that of one control alone.
pub(crate) fn rules_of(text: &str) -> Option<ControlRules> {
    klartext::is_program(text).then(klartext::rules)
}

/// Quotes text of the program for a message: short, without characters that a terminal would obey.
fn shown(text: &str) -> String {
    format!("`{}`", unquoted(text))
}

/// Returns the text as [`shown`] quotes it, without the quotes.
fn unquoted(text: &str) -> String {
    const MAX_CHARACTERS: usize = 40;
    let mut quoted: String =
        text.chars().take(MAX_CHARACTERS).flat_map(char::escape_debug).collect();
    if text.chars().nth(MAX_CHARACTERS).is_some() {
        quoted.push('…');
    }
    quoted
}
