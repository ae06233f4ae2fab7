//! Errors of programs on a machine.

use crate::codes::faults;
use crate::gcode::{BlockLine, GcodeFault, WorkOffset};
use crate::machine::{InverseError, JointError};

faults! {
    #[family("K09", "Readings of programs")]
    /// A program that cannot be checked on its machine.
    #[derive(thiserror::Error)]
    #[non_exhaustive]
    pub enum MachineProgramError {
        /// A control reads the program in this way, and is stopped by it.
        #[code_of(error)]
        #[error(
            "{error} (under {rules}; a control that is named, or whose rules are stated, reads it in one way)"
        )]
        Under {
            /// The error.
            error: Box<MachineProgramError>,
            /// The rules that are assumed.
            rules: String,
        },
        /// Controls read the program in too many ways.
        #[code = K0901]
        #[error(
            "{file}: controls read this program in more than {} ways, by the rules {rules}: name the control, or state its rules",
            super::MAX_READINGS
        )]
        Readings {
            /// The program.
            file: String,
            /// The keys of the rules, each with the line that depends on it.
            rules: String,
        },
        /// The variables of the program can have too many values.
        #[code = K0902]
        #[error(
            "{file}: the values of `[variables]` have more than {} combinations: state fewer, and check the program once for each group",
            super::MAX_VALUES
        )]
        Values {
            /// The program.
            file: String,
        },
        /// A block is not read, or its motion is not possible on the machine.
        #[code_of(fault)]
        #[error("{file}:{line}: {fault}")]
        Block {
            /// The program.
            file: String,
            /// The line, 1-based.
            line: usize,
            /// The fault in it.
            fault: BlockFault,
        },
    }
}

/// A block that ends what is checked of a program.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("line {}: {fault}", .block.line)]
pub struct BlockError {
    /// The block.
    pub block: BlockLine,
    /// Its fault.
    pub fault: BlockFault,
}

touchoff::debug_as_sentence!(BlockError);

/// A fault in a block of a program.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlockFault {
    /// It is not read.
    #[error(transparent)]
    Gcode(#[from] GcodeFault),
    /// Its motion is not possible on the machine.
    #[error(transparent)]
    Step(#[from] StepFault),
}

touchoff::debug_as_sentence!(BlockFault);

impl BlockFault {
    /// Returns the stable [code](crate::codes) of the fault.
    pub fn code(&self) -> &'static str {
        match self {
            BlockFault::Gcode(fault) => fault.code(),
            BlockFault::Step(fault) => fault.code(),
        }
    }

    /// Returns whether it is the same as another one, whatever the file and the line, and the position of an axis that the machine lacks.
    pub(super) fn is_same(&self, other: &BlockFault) -> bool {
        match (self, other) {
            (
                BlockFault::Step(StepFault::Joint(JointError::NoAxis { letter, .. })),
                BlockFault::Step(StepFault::Joint(JointError::NoAxis { letter: other, .. })),
            ) => letter == other,
            (BlockFault::Gcode(fault), BlockFault::Gcode(other)) => {
                fault.innermost() == other.innermost()
            }
            _ => self == other,
        }
    }
}

/// A fault that stands in the way of checking a program, beside the one that ends what is checked.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Obstacle {
    /// The first block that has it.
    pub block: BlockLine,
    /// The number of blocks that have it.
    pub count: usize,
    /// The fault.
    pub fault: BlockFault,
}

faults! {
    #[family("K08", "Motions that are not possible on a machine")]
    /// A reason for which a motion is not possible on a machine.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum StepFault {
        /// A joint value is out of range, or of an axis that the machine lacks.
        #[code_of(0)]
        #[error(transparent)]
        Joint(#[from] JointError),
        /// No joint values give the tool axis.
        #[code_of(0)]
        #[error(transparent)]
        Inverse(#[from] InverseError),
        /// The length offset is that of another tool, while positions are those of the tip.
        #[code = K0801]
        #[error(
            "the length offset H{register} is {offset} mm, but T{tool} in the spindle is {length} mm long: correct H, or the \
             lengths of the job"
        )]
        Length {
            /// The register.
            register: u32,
            /// Its value, in mm.
            offset: f64,
            /// The tool in the spindle.
            tool: u32,
            /// Its length, in mm.
            length: f64,
        },
        /// The program has turned the rotary axes to other angles than a tilted plane needs.
        #[code = K0802]
        #[error(
            "the tool is {degrees:.3} degrees off z of the tilted plane, to which the program has turned the axes itself: correct the \
             angles, or let PLANE turn them"
        )]
        NotAligned {
            /// The angle, in degrees.
            degrees: f64,
        },
        /// The head turns, and the length of the tool is unknown.
        #[code = K0803]
        #[error("the head turns, and so the length of the tool matters: state it in the job")]
        NoLength,
        /// The table turns without tool centre point control, and the position of the part on it is unknown.
        #[code = K0804]
        #[error(
            "the table turns without tool centre point control, and so the position of the part on it matters: state the \
             origin of G54 in the job's `work_offsets`"
        )]
        NoPartPosition,
        /// The program sets or turns G54, which is the frame of the part.
        #[code = K0805]
        #[error(
            "the program sets G54, which is the frame of the part, to other values than the job: state its origin in the job's \
             `work_offsets`, or remove the block"
        )]
        MovedPart,
        /// An arc in a tilted plane has too many turns.
        #[code = K0806]
        #[error(
            "an arc in a tilted plane turns by {degrees:.0} degrees, more than {limit:.0}: divide it"
        )]
        LongArc {
            /// The angle, in degrees.
            degrees: f64,
            /// The greatest angle at this radius, in degrees.
            limit: f64,
        },
        /// The origin of a work offset is unknown.
        #[code = K0807]
        #[error(
            "the origin of {offset}{} is unknown: state it, and that of G54, in the job's `work_offsets`",
            on_sinumerik(*offset)
        )]
        NoOrigin {
            /// The work offset.
            offset: WorkOffset,
        },
        /// A work offset, or a rotary axis by G52 or G92, is turned against the part while the program states tips, or where a plane is aligned.
        #[code = K0808]
        #[error(
            "{offset} turns the table, or is turned against G54, under tool centre point control or in an aligned plane: controls take the \
             part at different angles then, so state offsets of rotary axes as 0, and turn the part in the CAM system"
        )]
        TurnedOffset {
            /// The work offset.
            offset: WorkOffset,
        },
    }
}

impl StepFault {
    /// Returns whether it is one of what the job states, whatever the positions in the program. `is_uncertain` is set if modes of the control
    /// are not known.
    pub(super) fn is_of_job(&self, is_uncertain: bool) -> bool {
        match self {
            // They depend on tool centre point control.
            StepFault::NoLength | StepFault::NoPartPosition => !is_uncertain,
            StepFault::NoOrigin { .. } | StepFault::TurnedOffset { .. } => true,
            StepFault::Joint(error) => matches!(error, JointError::NoAxis { .. }),
            StepFault::Inverse(_)
            | StepFault::Length { .. }
            | StepFault::NotAligned { .. }
            | StepFault::MovedPart
            | StepFault::LongArc { .. } => false,
        }
    }
}

/// Returns the word of native programs of Sinumerik for a work offset, where it is another one.
fn on_sinumerik(offset: WorkOffset) -> String {
    match offset {
        WorkOffset::Standard(number @ 5..=6) => {
            format!(" (G{} on Sinumerik)", 500 + u32::from(number))
        }
        WorkOffset::Additional(number) => {
            let word = WorkOffset::FIRST_OF_SINUMERIK - 1 + u32::from(number);
            if word <= 599 { format!(" (G{word} on Sinumerik)") } else { String::new() }
        }
        WorkOffset::Off | WorkOffset::Standard(_) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_origin_has_the_word_of_the_program() {
        let sentence = |offset| StepFault::NoOrigin { offset }.to_string();
        let further = sentence(WorkOffset::Standard(5));
        assert!(
            further.starts_with("the origin of G58 (G505 on Sinumerik) is unknown"),
            "{further}"
        );
        let additional = sentence(WorkOffset::Additional(93));
        assert!(
            additional.starts_with("the origin of G54.1 P93 (G599 on Sinumerik) is"),
            "{additional}"
        );
        assert!(sentence(WorkOffset::Additional(94)).starts_with("the origin of G54.1 P94 is"));
        assert!(sentence(WorkOffset::Standard(2)).starts_with("the origin of G55 is unknown"));
    }
}
