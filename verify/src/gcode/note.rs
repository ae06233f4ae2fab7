//! Notes: what a program leaves to the control, and words that were passed over.

use super::{BlockLine, SubprogramLine};
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

/// Subject of a note.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum NoteKind {
    /// A word that can neither move the tool nor change what positions mean.
    PassedOver {
        /// A G or M word, or the letter of another.
        word: String,
    },
    /// A motion without G61: the control may round its corners, by a tolerance of its own.
    RoundedCorners,
    /// A work offset (G58, G59) that native Sinumerik programs read as a shift.
    OffsetOrShift,
    /// A tool change, whose motion only the machine knows.
    ToolChange,
    /// A word that the setup ignores.
    Ignored {
        /// The word.
        word: String,
        /// The reason that the setup states.
        reason: String,
    },
    /// M99 in the main program, which repeats it without end.
    Endless,
    /// A bore that is milled on a helix, whose first point is the control's own.
    HelixStart,
    /// A stop, at which an operator can move the tool.
    Stop,
    /// A block that begins with `/`, and was executed.
    ExecutedOptionalBlock,
    /// A block that begins with `/`, and was left out.
    OmittedOptionalBlock,
    /// Text after the end of the program, which is not read.
    TextAfterEnd,
    /// Another program in the file, which is not read.
    OtherProgram,
    /// A block whose switch is not that of other optional blocks. They are executed or left out together.
    OptionalSwitches,
    /// An arc whose radii at its start and end differ by more than rounding. It is read as a spiral.
    TwoRadii,
    /// An arc by its radius, which moves by more than rounding where its numbers are rounded to the least increment.
    RoundedRadius,
    /// A motion that differs in the next run of the program, if the control keeps modes from the end of the run before.
    LeftModes {
        /// The words that left them, as a list.
        words: String,
    },
}

impl fmt::Display for ProgramNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProgramNote { line, within: _, count, kind } = self;
        write!(f, "line {line}: {kind}")?;
        if *count > 1 { write!(f, " ({count} times)") } else { Ok(()) }
    }
}

impl fmt::Display for NoteKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoteKind::PassedOver { word } => write!(f, "{word} is passed over"),
            NoteKind::Ignored { word, reason } => write!(f, "{word} is ignored as stated: {reason}"),
            NoteKind::Endless => {
                f.write_str("M99 repeats the program without end, of which one run is checked")
            }
            NoteKind::RoundedCorners => f.write_str(
                "the control may round corners without G61, by a tolerance of its own: its path is checked as programmed",
            ),
            NoteKind::OffsetOrShift => f.write_str(
                "G58 and G59 are work offsets, but shifts on native Sinumerik: state `dialect` of the control",
            ),
            NoteKind::ToolChange => f.write_str("the motion of the tool change is not checked"),
            NoteKind::HelixStart => f.write_str(
                "the control chooses where the helix of CYCL DEF 208 begins: it is followed from +X",
            ),
            NoteKind::Stop => f.write_str("motions by hand during the stop are not checked"),
            NoteKind::ExecutedOptionalBlock => f.write_str("an optional block (/) is executed"),
            NoteKind::OmittedOptionalBlock => f.write_str("an optional block (/) is left out"),
            NoteKind::TextAfterEnd => {
                f.write_str("the text after the end of the program is not read")
            }
            NoteKind::OptionalSwitches => f.write_str(
                "optional blocks have several switches (/1, /2), of which all on and all off are checked",
            ),
            NoteKind::TwoRadii => f.write_str(
                "the radii of an arc differ at its start and its end, and controls take different paths between: correct the arc",
            ),
            NoteKind::RoundedRadius => f.write_str(
                "an arc by its radius has more digits than the least increment, and moves where they are rounded: write them with as \
                 many, or the arc with its centre",
            ),
            NoteKind::LeftModes { words } => write!(
                f,
                "the program ends with {words}, which a control can keep, and its next run is another from here on: write \
                 before what this motion needs, end the program as it starts, or state `program_end` of the control"
            ),
            NoteKind::OtherProgram => f.write_str(
                "another program begins here, and is not checked: give a file per program",
            ),
        }
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
