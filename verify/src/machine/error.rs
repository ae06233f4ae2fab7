//! Errors of machines, of joint values and of the inverse kinematics.

use super::{BodyFault, Letter, MAX_NAME};
use crate::codes::faults;

faults! {
    #[family("K02", "Machines: names and files")]
    /// A reason for which a machine cannot be used. The message names the file, the line, the reason and the
    /// remedy.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum MachineError {
        /// No machine of this name comes with the library.
        #[code = K0201]
        #[error("`{name}` is no machine of the library: name one of {known}, or give a file")]
        UnknownName {
            /// The name.
            name: String,
            /// The known names.
            known: String,
        },
        /// A line of the file is refused.
        #[code_of(fault)]
        #[error("{file}:{line}: {fault}")]
        Line {
            /// The file.
            file: String,
            /// The line, 1-based.
            line: usize,
            /// The fault in it.
            fault: MachineFault,
        },
        /// A linear axis is missing.
        #[code = K0202]
        #[error("{file}: there is no axis {letter}: give an [[axis]] for each of X, Y and Z")]
        MissingAxis {
            /// The file.
            file: String,
            /// The missing axis.
            letter: Letter,
        },
    }
}

faults! {
    #[family("K01", "Machines: lines of their files")]
    /// A fault in a line of a machine's file.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum MachineFault {
        /// The text is not TOML, or a key is unknown, missing or of the wrong type.
        #[code = K0101]
        #[error("{message}: correct the line (docs of the module `machine` list the keys)")]
        Syntax {
            /// The parser's message.
            message: String,
        },
        /// The name is empty, is long, or has a control character.
        #[code = K0102]
        #[error(
            "the name is empty, is long, or has a control character: give the machine a name of one line, of up to {MAX_NAME} characters"
        )]
        Name,
        /// The position of a tool change is none.
        #[code = K0103]
        #[error(
            "`tool_change` is \"stays\", or finite joint values of axes of the machine, such as {{ Z = 0 }}"
        )]
        ToolChange,
        /// A body of the machine is wrong.
        #[code_of(fault)]
        #[error("body `{name}`: {fault}")]
        Body {
            /// Its name.
            name: String,
            /// The reason.
            fault: BodyFault,
        },
        /// An axis is given twice.
        #[code = K0104]
        #[error("axis {letter} is given again, first in line {first}: remove one of them")]
        Repeated {
            /// The axis.
            letter: Letter,
            /// The line of the first, 1-based.
            first: usize,
        },
        /// A linear axis with a rotary axis's letter, or the other way round.
        #[code = K0105]
        #[error(
            "{letter} is the letter of a {expected} axis: X, Y, Z are linear, A, B, C rotary (ISO 841)"
        )]
        Kind {
            /// The letter.
            letter: Letter,
            /// The kind that belongs to the letter.
            expected: &'static str,
        },
        /// A linear axis in another direction than that of its letter.
        #[code = K0106]
        #[error(
            "axis {letter} has another direction than machine coordinate {letter}: remove `direction`"
        )]
        LinearDirection {
            /// The axis.
            letter: Letter,
        },
        /// A linear axis with a point.
        #[code = K0107]
        #[error("axis {letter} is linear and has no point: remove `point`")]
        LinearPoint {
            /// The axis.
            letter: Letter,
        },
        /// A rotary axis without one of its keys.
        #[code = K0108]
        #[error("rotary axis {letter} has no `{key}`: add `{key} = {example}`")]
        MissingKey {
            /// The axis.
            letter: Letter,
            /// The missing key.
            key: &'static str,
            /// An example of its value.
            example: &'static str,
        },
        /// A zero direction.
        #[code = K0109]
        #[error("the direction of axis {letter} is zero: give a vector such as [1, 0, 0]")]
        ZeroDirection {
            /// The axis.
            letter: Letter,
        },
        /// A number that is not finite or too large.
        #[code = K0110]
        #[error("`{key}` of axis {letter} is {value}: give a number within ±{limit:e}")]
        Range {
            /// The axis.
            letter: Letter,
            /// The key.
            key: &'static str,
            /// The value.
            value: f64,
            /// The largest magnitude allowed.
            limit: f64,
        },
        /// A rapid traverse rate that is no speed.
        #[code = K0111]
        #[error(
            "the rapid traverse rate of axis {letter} is {value}: give mm or degrees per minute, above 0"
        )]
        Rapid {
            /// The axis.
            letter: Letter,
            /// The given value.
            value: f64,
        },
        /// A lower limit that is not below the upper one.
        #[code = K0112]
        #[error("the limits of axis {letter} are {low} and {high}: give the lower one first")]
        Limits {
            /// The axis.
            letter: Letter,
            /// The first limit.
            low: f64,
            /// The second limit.
            high: f64,
        },
        /// A home position outside the limits.
        #[code = K0113]
        #[error("axis {letter} has its home at {home}, outside its limits: correct one of them")]
        Home {
            /// The axis.
            letter: Letter,
            /// The position.
            home: f64,
        },
        /// A linear axis that a rotary axis of its side carries.
        #[code = K0114]
        #[error(
            "axis {letter} is carried by rotary axis {rotary}, which is not supported: list it before {rotary}"
        )]
        CarriedLinear {
            /// The linear axis.
            letter: Letter,
            /// The rotary axis before it.
            rotary: Letter,
        },
        /// More than two rotary axes.
        #[code = K0115]
        #[error("{letter} is a third rotary axis: two determine the tool axis, so give at most two")]
        ThirdRotary {
            /// The axis.
            letter: Letter,
        },
        /// Two rotary axes with the same direction.
        #[code = K0116]
        #[error(
            "axes {first} and {letter} are parallel, so they are one axis to the tool: correct a direction"
        )]
        Parallel {
            /// The first axis.
            first: Letter,
            /// The second axis.
            letter: Letter,
        },
        /// The point of M92 is none.
        #[code = K0117]
        #[error("`m92` is three lengths within 1,000,000 mm, such as [0, 0, -100]: correct them")]
        BuilderPoint,
    }
}

faults! {
    #[family("K06", "Machines: joint values")]
    /// A reason for which joint values are refused.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum JointError {
        /// A value that is not finite or too large.
        #[code = K0601]
        #[error("{what} is {value}: give a number within ±{limit:e}")]
        Range {
            /// The value's name.
            what: String,
            /// The value.
            value: f64,
            /// The largest magnitude allowed.
            limit: f64,
        },
        /// A value of an axis that the machine lacks.
        #[code = K0602]
        #[error(
            "{letter} is {value}, but the machine has no axis {letter}: name the machine for which the program was posted"
        )]
        NoAxis {
            /// The axis.
            letter: Letter,
            /// The value, in degrees.
            value: f64,
        },
        /// A link that the machine lacks.
        #[code = K0603]
        #[error("there is no link {link}: the table side has links 0 (the base) to {last}")]
        NoLink {
            /// The link.
            link: usize,
            /// The last link.
            last: usize,
        },
        /// A body moves with an axis that the machine lacks.
        #[code = K0604]
        #[error(
            "a body moves with {letter}, an axis that the machine lacks: name one of its axes, or its base"
        )]
        NoCarrier {
            /// The axis.
            letter: Letter,
        },
        /// A position of the tip relative to a body that not all linear axes move.
        #[code = K0605]
        #[error(
            "not all linear axes move the tool relative to link {link}: give the tip relative to the workpiece"
        )]
        Frame {
            /// The link.
            link: usize,
        },
    }
}

faults! {
    #[family("K07", "Machines: positions of the axes for a tool axis")]
    /// A reason for which no joint values place the tool.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum InverseError {
        /// A coordinate of the tip, the tool length or a nearby joint value is out of range.
        #[code_of(0)]
        #[error(transparent)]
        Joint(#[from] JointError),
        /// The tool axis is zero or not finite.
        #[code = K0701]
        #[error("the tool axis is zero or not finite: give the vector from the tip to the spindle")]
        NoDirection,
        /// The rotary axes do not reach the direction.
        #[code = K0702]
        #[error(
            "the rotary axes miss the tool axis by {degrees:.4}°: choose another direction or machine"
        )]
        Unreachable {
            /// Angle between the direction and the nearest that is reached, in degrees.
            degrees: f64,
        },
        /// The solution is outside the limits of an axis.
        #[code = K0703]
        #[error(
            "axis {letter} would be at {value:.4}, outside its limits {low} to {high}: move or reclamp the part"
        )]
        Limit {
            /// The axis.
            letter: Letter,
            /// The value nearest to the limits, in millimetres or degrees.
            value: f64,
            /// The lower limit.
            low: f64,
            /// The upper limit.
            high: f64,
        },
    }
}
