//! Notes: what a program leaves to the control, and words that were passed over.

use super::{BlockLine, SubprogramLine};
use crate::codes::faults;
use std::collections::BTreeMap;
use std::fmt;

/// A note about a program. Equal notes are counted.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ProgramNote {
    /// The line of the first, 1-based; in a file of subprograms, that of the program's block which calls it.
    pub line: usize,
    /// The line of the first in the file of subprograms that has it.
    pub within: Option<SubprogramLine>,
    /// The number of them.
    pub count: usize,
    /// The subject.
    pub kind: NoteKind,
}

faults! {
    #[family("V05", "What a program leaves to the control")]
    /// Subject of a note.
    #[derive(Clone, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
    #[non_exhaustive]
    pub enum NoteKind {
        /// A word that can neither move the tool nor change what positions mean.
        #[code = V0501]
        #[error("{word} is passed over")]
        PassedOver {
            /// A G or M word, or the letter of another.
            word: String,
        },
        /// Corners that the control may round, without G61.
        #[code = V0502]
        #[error("the control may round corners without G61, by a tolerance of its own: its path is checked as programmed")]
        RoundedCorners,
        /// A work offset (G58, G59) that native Sinumerik programs read as a shift.
        #[code = V0503]
        #[error("G58 and G59 are work offsets, but shifts on native Sinumerik: state `dialect` of the control")]
        OffsetOrShift,
        /// A tool change, whose motion only the machine knows.
        #[code = V0504]
        #[error("the motion of the tool change is not checked")]
        ToolChange,
        /// A word that the setup ignores.
        #[code = V0505]
        #[error("{word} is ignored as stated: {reason}")]
        Ignored {
            /// The word.
            word: String,
            /// The reason that the setup states.
            reason: String,
        },
        /// M99 in the main program, which repeats it without end.
        #[code = V0506]
        #[error("M99 repeats the program without end, of which one run is checked")]
        Endless,
        /// A bore that is milled on a helix, whose first point is the control's own.
        #[code = V0507]
        #[error("the control chooses where the helix of CYCL DEF 208 begins: it is followed from +X")]
        HelixStart,
        /// A stop, at which an operator can move the tool.
        #[code = V0508]
        #[error("motions by hand during the stop are not checked")]
        Stop,
        /// A block that begins with `/`, and was executed.
        #[code = V0509]
        #[error("an optional block (/) is executed")]
        ExecutedOptionalBlock,
        /// A block that begins with `/`, and was left out.
        #[code = V0510]
        #[error("an optional block (/) is left out")]
        OmittedOptionalBlock,
        /// Text after the end of the program, which is not read.
        #[code = V0511]
        #[error("the text after the end of the program is not read")]
        TextAfterEnd,
        /// Another program in the file, which is not read.
        #[code = V0512]
        #[error("another program begins here, and is not checked: give a file per program")]
        OtherProgram,
        /// A block whose switch is not that of other optional blocks.
        ///
        /// All optional blocks are executed or left out together.
        #[code = V0513]
        #[error("optional blocks have several switches (/1, /2), of which all on and all off are checked")]
        OptionalSwitches,
        /// An arc whose radii at its start and end differ by more than rounding.
        ///
        /// It is read as a spiral.
        #[code = V0514]
        #[error(
            "the radii of an arc differ at its start and its end, and controls take different paths between: correct the arc"
        )]
        TwoRadii,
        /// An arc by its radius, with more digits than the least increment.
        ///
        /// It moves by more than rounding where its numbers are rounded to the least increment.
        #[code = V0515]
        #[error(
            "an arc by its radius has more digits than the least increment, and moves where they are rounded: write them with as many, or \
             the arc with its centre"
        )]
        RoundedRadius,
        /// What the program leaves in force.
        ///
        /// Some controls keep it from the end of one run to the start of the next.
        #[code = V0516]
        #[error(
            "the program ends with {words} in force, with which its next run begins where the control keeps it: end it before, or state \
             its modes at the start"
        )]
        LeftModes {
            /// The words that left them, as a list.
            words: String,
        },
        /// An arc whose radii at its start and its end differ, of which every curve between both is checked.
        ///
        /// Controls take different curves, or stop.
        #[code = V0517]
        #[error(
            "the radii of an arc differ at its start and its end: every curve between both is checked, and {stops} there: correct the arc"
        )]
        Spiral {
            /// The controls that stop.
            stops: String,
        },
        /// A canned cycle that goes no lower than its plane R, or has no depth.
        ///
        /// It positions the tool, and cuts nothing: often Z in a further block of the cycle, which is its depth, was meant as a level.
        #[code = V0518]
        #[error(
            "a cycle cuts nothing, since its depth is not below the plane at which its feed begins: write the depth, or G80 and G0 for a \
             position"
        )]
        EmptyCycle,
        /// A mode that the program does not state before it depends on it.
        ///
        /// It is taken as on a control as delivered; one that keeps modes, or is set otherwise, reads the program in another way.
        #[code = V0519]
        #[error("{word} is not written before a motion that depends on it, and is assumed: write it at the start")]
        AssumedMode {
            /// The word.
            word: &'static str,
        },
        /// A cycle that is defined, and executed nowhere.
        ///
        /// CYCL DEF without M99, M89 or CYCL CALL, MCALL without a position after it, or L0 without a block after it.
        #[code = V0520]
        #[error("a cycle is defined and never called, and cuts nothing: write its call or a position of a hole, or remove it")]
        UncalledCycle,
    }
}

impl fmt::Display for ProgramNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProgramNote { line, within: _, count, kind } = self;
        write!(f, "line {line}: {kind}")?;
        if *count > 1 { write!(f, " ({count} times)") } else { Ok(()) }
    }
}

/// The notes of a program.
#[derive(Clone, Debug, Default)]
pub(super) struct Notes {
    /// First block and number.
    found: BTreeMap<NoteKind, (BlockLine, usize)>,
}

impl Notes {
    /// Adds a note.
    pub(super) fn add(&mut self, block: BlockLine, kind: NoteKind) {
        self.found.entry(kind).or_insert((block, 0)).1 += 1;
    }

    /// Adds a subject whose number says nothing.
    pub(super) fn add_once(&mut self, block: BlockLine, kind: NoteKind) {
        self.found.entry(kind).or_insert((block, 1));
    }

    /// Returns the notes.
    pub(super) fn list(&self) -> Vec<ProgramNote> {
        let notes = self.found.iter().map(|(kind, (block, count))| ProgramNote {
            line: block.line,
            within: block.within,
            count: *count,
            kind: kind.clone(),
        });
        notes.collect()
    }
}
