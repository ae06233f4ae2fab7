//! Reasons for which a job leaves something open.

use crate::Gap;
use crate::check::CheckGap;
use crate::codes::faults;
use crate::gcode::{BlockLine, WorkOffset};

faults! {
    #[family("V06", "What a job leaves open")]
    /// A reason for a gap of a job.
    #[derive(Clone, PartialEq, thiserror::Error)]
    pub(crate) enum JobGap {
        /// A gap of a motion that depends on what the job checks it against.
        #[code_of(0)]
        #[error("{0}")]
        Motion(CheckGap),
        /// Bodies of the machine that are not checked, as the page of `touchoff live` has none of their files.
        #[code = V0601]
        #[error(
            "the bodies that the machine's file states are not checked here: check them by a job file, or name a machine without bodies"
        )]
        MachineBodies,
        /// Rapid traverse of several axes through the stock, whose path is not stated.
        #[code = V0602]
        #[error(
            "the path of several axes in rapid traverse is checked against the stock on the straight line only: state `rapid` of the \
             control, or the `rapid` rates of the machine's axes"
        )]
        StockRapid,
        /// A work offset under which the tool stays far from the part.
        ///
        /// Something else stands there, which nothing was checked against.
        #[code = V0603]
        #[error(
            "under {offset} the tool never comes within its diameter of the part: check {offset} in `work_offsets`, state what stands \
             there as `[[other_part]]`, or give a job per part"
        )]
        FarOffset { offset: WorkOffset },
        /// A tool that is thinner than the points of the stock are apart.
        #[code = V0604]
        #[error(
            "{name} is thin for a stock whose points are {spacing} apart, and may pass through material {found} unseen: state a smaller \
             `spacing`, or a smaller `tolerance` of the stock"
        )]
        ThinTool { name: String, spacing: String, found: String },
        /// A set-up whose stock comes from one that is not clean.
        #[code = V0605]
        #[error(
            "the set-up before, whose stock this is, is not clean: verify {file} by itself"
        )]
        EarlierSetup { file: String },
        /// The motion to the first position after a tool change of a program of positions.
        ///
        /// A verdict is possible.
        #[code = V0606]
        #[error(
            "{count} motion{} to the first position after a tool change not checked, first to line {line}: only the machine knows where \
             they start",
            if *count == 1 { "" } else { "s" }
        )]
        ToolChange { count: usize, line: usize },
        /// The way to the first position at a height at which something stands.
        ///
        /// The program states Z before X, Y or rotary axes, so that the tool comes from wherever it stands, at that height. A body of the
        /// machine that does not move with the part can be anywhere.
        #[code = V0607]
        #[error(
            "the way to the first position in X, Y or rotary axes is not checked, and at Z it is lower than {name}: state them before this \
             Z, or a Z above it"
        )]
        LowWay { name: String },
        /// A comment of the program that describes another tool than the job has.
        ///
        /// Post-processors write the tools for which a program was made. A verdict about another tool says nothing about them.
        #[code = V0608]
        #[error(
            "the comment {comment} describes another T{number} than the job has, which is {mounted}{}: give the tool of the program, or \
             correct the comment", more_comments(*others)
        )]
        OtherTool { comment: String, number: u32, mounted: String, others: usize },
        /// The way to a reference position from a height at which something stands.
        ///
        /// G28, G30 or G53 moves Z with other axes to where only the machine knows, and so in a direction that is not known. Z alone goes
        /// straight up, which is checked.
        #[code = V0609]
        #[error(
            "the way to the reference position in X and Y is not checked, and begins lower than {name}: move Z there first, or state the \
             origin of G54 in `work_offsets`, and `home` of the axes"
        )]
        LowWayHome { name: String },
        /// A motion of an empty spindle (T0) at a height at which something stands.
        ///
        /// The job has no tool 0, and the shape of the spindle's nose is not known. Its gauge point has to stay above part, stock, fixtures
        /// and bodies of the machine, wherever X and Y are. Under tool centre point control, and where a head tilts the spindle, it is taken
        /// to be below all.
        #[code = V0610]
        #[error(
            "the gauge point of the empty spindle (T0) is not known to stay above {name}: move Z above it before, with a spindle that is not \
             tilted, or state `[tool.0]` with the shape of the spindle's nose and `length = 0`"
        )]
        LowSpindle { name: String },
        /// An earlier set-up whose own file accepts what is left open.
        ///
        /// A verdict is possible.
        #[code = V0611]
        #[error("the set-up before, whose stock this is, leaves something open, which {file} accepts by `anyway`")]
        AcceptedSetup { file: String },
        /// A motion aside at the top of Z's travel, whose place is not known, over something that is higher than the tool's tip by its length
        /// or, if that is not stated, as it is drawn.
        #[code = V0612]
        #[error(
            "at the top of Z, {} reaches lower than {name}: state its `length` and `home` of the axes, with which its motions there are \
             checked",
            tool.map_or("the tool".to_owned(), |tool| format!("T{tool}"))
        )]
        LowTop { name: String, tool: Option<u32> },
        /// A note in the library of a tool: programs of its system have another origin, or it has a holder that is not drawn.
        #[code = V0613]
        #[error("{tool}: {doubt}")]
        LibraryTool { tool: String, doubt: String },
    }
}

impl JobGap {
    /// Returns the gap that allows no verdict.
    pub(super) fn open(&self, place: impl Into<BlockLine>) -> Gap {
        Gap::open(place, self.code(), self.to_string())
    }
}

/// Tells how many other comments describe another tool.
fn more_comments(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => " (and 1 more comment)".to_owned(),
        count => format!(" (and {count} more comments)"),
    }
}
