//! Errors in programs.

use crate::codes::faults;
use std::io;

use touchoff::{Escaped, PoseError, Unit};

faults! {
    #[family("P06", "Tables and APT: files")]
    /// A reason for which a program is refused. The message names the file, the line, the reason and the remedy.
    #[derive(thiserror::Error)]
    #[non_exhaustive]
    pub enum ProgramError {
        /// The file could not be read at all.
        #[code = P0601]
        #[error("{file}: cannot be read ({source}): check the path and its permissions")]
        Read {
            /// The file.
            file: String,
            /// The system's error.
            source: io::Error,
        },
        /// The file has no position.
        #[code = P0602]
        #[error(
            "{file}: holds no position: give rows of x,y,z,i,j,k or an APT-CL program of GOTO points; \
             `verify` reads G-code, too"
        )]
        NoPosition {
            /// The file.
            file: String,
        },
        /// The file has one position, and so no motion.
        #[code = P0603]
        #[error("{file}:{line}: holds one position, and so no motion: give the whole program")]
        OnePosition {
            /// The file.
            file: String,
            /// The line of the position, 1-based.
            line: usize,
        },
        /// The program is for another cutter.
        #[code = P0604]
        #[error(
            "{file}:{line}: CUTTER/{stated} is not `{tool}`, which is CUTTER/{expected} in {unit}: give the tool \
             that the program was made for, or remove the statement to try another"
        )]
        Cutter {
            /// The file.
            file: String,
            /// The line of `CUTTER`, 1-based.
            line: usize,
            /// The arguments in the program.
            stated: String,
            /// The tool's name.
            tool: String,
            /// The arguments that describe the tool, in the program's unit.
            expected: String,
            /// The program's unit.
            unit: Unit,
        },
        /// A line is refused.
        #[code_of(fault)]
        #[error("{}:{line}: {fault}{}", Escaped(file), shown_others(file, others))]
        Line {
            /// The file.
            file: String,
            /// The line, 1-based.
            line: usize,
            /// The fault in it.
            fault: ProgramFault,
            /// Further faults, each with its first line.
            others: Vec<(usize, ProgramFault)>,
        },
        /// The program states another unit than the part's.
        #[code = P0605]
        #[error(
            "{file}{}: UNITS says {stated}, but the part is in {part}: load the part in {stated}, or \
             post the program in {part}", .line.map(|line| format!(":{line}")).unwrap_or_default()
        )]
        Unit {
            /// The file.
            file: String,
            /// The line of `UNITS`, 1-based, in a program that was read.
            line: Option<usize>,
            /// The program's unit.
            stated: Unit,
            /// The part's unit.
            part: Unit,
        },
        /// The tool is a solid without an axis, and a pose has no spin.
        #[code = P0606]
        #[error(
            "{file}:{line}: an axis does not place `{solid}`, a solid without one: give a quaternion, \
             x,y,z,qx,qy,qz,qw"
        )]
        NoSpin {
            /// The file.
            file: String,
            /// The line of the first such pose, 1-based.
            line: usize,
            /// The solid's name.
            solid: String,
        },
        /// A file without a unit has an arc, and the part is not in millimetres.
        #[code = P0607]
        #[error(
            "{file}:{line}: an arc in a file without UNITS is divided into chords as in mm, but the part is in {part}: \
             state UNITS/MM or UNITS/INCHES before the first position, or post the arcs as GOTO points"
        )]
        UnscaledArc {
            /// The file.
            file: String,
            /// The line of the first arc, 1-based.
            line: usize,
            /// The part's unit.
            part: Unit,
        },
    }
}

faults! {
    #[family("P05", "Tables and APT: lines")]
    /// A fault in a line of a program.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ProgramFault {
        /// A NUL, which no text has.
        #[code = P0501]
        #[error("byte {byte} of the file is NUL: save it as text in UTF-8 or Windows-1252 (not UTF-16)")]
        NotText {
            /// Its offset in the file, from 0.
            byte: usize,
        },
        /// The first line belongs to neither format.
        #[code = P0502]
        #[error(
            "{start} begins neither a row of x,y,z,i,j,k nor an APT statement: give one or the other"
        )]
        Unrecognised {
            /// The beginning of the line.
            start: String,
        },
        /// A row with a wrong number of columns.
        #[code = P0503]
        #[error("found {found} column{}, expected {expected}: {remedy}", plural(*.found))]
        Columns {
            /// Number of columns of the row.
            found: usize,
            /// The expected number of columns, and their names.
            expected: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// A first row of names that are not the columns'.
        #[code = P0504]
        #[error("{names} are not the columns: write x,y,z,i,j,k or x,y,z,qx,qy,qz,qw, or no names")]
        Names {
            /// The row.
            names: String,
        },
        /// A word where a number should be.
        #[code = P0505]
        #[error("{cell} is not a number: {remedy}")]
        NotNumber {
            /// The word.
            cell: String,
            /// The remedy.
            remedy: &'static str,
        },
        /// NaN, an infinity, or a number too large to hold.
        #[code = P0506]
        #[error("{cell} is not a finite number: correct it or remove the position")]
        NotFinite {
            /// The number, as written.
            cell: String,
        },
        /// A zero axis or quaternion.
        #[code = P0507]
        #[error("{what} is zero and points nowhere: {remedy}")]
        NoDirection {
            /// The columns in question.
            what: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// An invalid pose, usually an axis that is not a unit vector.
        #[code = P0508]
        #[error(transparent)]
        Pose(#[from] PoseError),
        /// `GOTO` or `FROM` with a wrong number of arguments.
        #[code = P0509]
        #[error("{word} has {found} numbers: write {word}/x,y,z or {word}/x,y,z,i,j,k")]
        Count {
            /// The word.
            word: &'static str,
            /// Number of numbers after the word.
            found: usize,
        },
        /// A word that moves the tool in a way that is not interpreted.
        #[code = P0510]
        #[error("{word} moves the tool in a way that is not read: post the program as GOTO points")]
        Moves {
            /// The word.
            word: String,
        },
        /// Cutter compensation of the control that is not about its wear.
        #[code = P0511]
        #[error(
            "CUTCOM/{argument} is cutter compensation that is not read: post the program with the path of the tool"
        )]
        Compensation {
            /// The arguments.
            argument: String,
        },
        /// A word that changes the meaning of positions.
        #[code = P0512]
        #[error(
            "{word} changes what positions mean: post the program as GOTO points in the part's coordinates"
        )]
        Frame {
            /// The word.
            word: String,
        },
        /// A block of G-code.
        #[code = P0513]
        #[error(
            "{block} is G-code, which is not read: post the program as APT-CL, or as rows of x,y,z,i,j,k"
        )]
        GCode {
            /// The block.
            block: String,
        },
        /// A word that writes text for the control.
        #[code = P0514]
        #[error("{word} writes to the control what may be a motion: post the program without it")]
        Verbatim {
            /// The word.
            word: String,
        },
        /// A word that is not known to leave the tool and its coordinates alone.
        #[code = P0515]
        #[error(
            "{word} is not understood and could move the tool: post the program as GOTO points, or remove the \
             statement if it moves nothing"
        )]
        UnknownWord {
            /// The word.
            word: String,
        },
        /// A word that is passed over, with another statement in its arguments.
        #[code = P0516]
        #[error("{word} has another statement in its arguments: give each a line of its own")]
        Swallowed {
            /// The word.
            word: String,
        },
        /// A tool that is stated after positions.
        #[code = P0517]
        #[error("{word} comes after positions, which are of another tool: give one program per tool")]
        LateTool {
            /// The word.
            word: String,
        },
        /// A control character, or one that some programs take for the end of a line.
        #[code = P0518]
        #[error("the character {shown} is neither a blank nor the end of a line: remove it")]
        Control {
            /// The escaped character.
            shown: String,
        },
        /// A second tool, or a second cutter.
        #[code = P0519]
        #[error("another tool than that of line {first}: give one program per tool")]
        SecondTool {
            /// The line of the first, 1-based.
            first: usize,
        },
        /// A change to a tool without a number.
        #[code = P0520]
        #[error("LOADTL/{argument} changes the tool, but has no number: write LOADTL/3")]
        ToolNumber {
            /// The arguments.
            argument: String,
        },
        /// A position that is not written as one.
        #[code = P0521]
        #[error("{statement} is not understood: write GOTO/x,y,z,i,j,k, with nothing before it")]
        Malformed {
            /// The beginning of the statement.
            statement: String,
        },
        /// `MULTAX` with an unknown argument.
        #[code = P0522]
        #[error("MULTAX/{argument} is not understood: write MULTAX/ON or MULTAX/OFF")]
        Multax {
            /// The argument.
            argument: String,
        },
        /// A unit that is not supported.
        #[code = P0523]
        #[error("UNITS/{unit} is not supported: post the program in MM or INCHES")]
        UnknownUnit {
            /// The unit as written.
            unit: String,
        },
        /// A second unit that differs from the first.
        #[code = P0524]
        #[error("UNITS changes from {from} to {to}: post the whole program in one unit")]
        UnitChanges {
            /// The unit stated before.
            from: Unit,
            /// The unit stated here.
            to: Unit,
        },
        /// A unit stated after the first position.
        #[code = P0525]
        #[error("UNITS comes after the first position: state it before")]
        UnitLate,
        /// A position without an axis after a tilted one.
        #[code = P0526]
        #[error(
            "GOTO has no axis after a tilted one: NX keeps that one, and Creo takes 0,0,1: write i,j,k"
        )]
        OpenAxis,
        /// `FROM` after a position.
        #[code = P0527]
        #[error(
            "FROM after a position states where the tool is, or moves it there: write GOTO if it moves, or remove it"
        )]
        LateFrom,
        /// The end of the file before the end of the program.
        #[code = P0528]
        #[error("the program stops here without FINI: post it again, or add FINI if this is the end")]
        Unfinished,
        /// The end of the file before its end mark.
        #[code = P0529]
        #[error(
            "the table stops here without its end mark `{}`: write it again, or add the mark if this is the end",
            super::csv::END_MARK
        )]
        NoEndMark,
        /// A statement after the end.
        #[code = P0530]
        #[error("a statement follows {end}: give one program per file")]
        AfterEnd {
            /// The word that ended the program.
            end: &'static str,
        },
        /// A cycle with a word that is not read.
        #[code = P0531]
        #[error("{word} of CYCLE is not read: post the holes as GOTO points, or as DRILL with FEDTO, RAPTO and RTRCTO")]
        Cycle {
            /// The word.
            word: String,
        },
        /// An arc that is none.
        #[code = P0532]
        #[error("the arc of CIRCLE {what}: write CIRCLE/xc,yc,zc,i,j,k before the GOTO that ends it, or post the arc as GOTO points")]
        Arc {
            /// The reason.
            what: &'static str,
        },
        /// An arc with too many chords.
        #[code = P0533]
        #[error(
            "the arc turns by {degrees:.3} degrees, more than the {limit:.3} that can be divided into chords at its radius: check its \
             centre, divide it into several arcs, or post it as GOTO points"
        )]
        LongArc {
            /// The angle, in degrees.
            degrees: f64,
            /// The greatest angle at this radius, in degrees.
            limit: f64,
        },
        /// Too many chords in all arcs of a program.
        #[code = P0534]
        #[error(
            "the arcs up to this one take more than {} chords: divide the program",
            super::apt::MAX_ALL_CHORDS
        )]
        ManyChords,
    }
}

impl ProgramFault {
    /// Returns what tells it from other obstacles: its sentence. Each block of G-code is the same one.
    pub(super) fn obstacle(&self) -> String {
        match self {
            ProgramFault::GCode { .. } => String::new(),
            fault => fault.to_string(),
        }
    }
}

/// Largest number of further faults that a message lists.
const MAX_SHOWN: usize = 100;

/// Lists further faults, each on a line of its own.
fn shown_others(file: &str, others: &[(usize, ProgramFault)]) -> String {
    let (shown, left_out) = others.split_at(others.len().min(MAX_SHOWN));
    let file = Escaped(file);
    let lines = shown.iter();
    let lines = lines.map(|(line, fault)| format!("\n{file}:{line}: {fault} [{}]", fault.code()));
    let mut text: String = lines.collect();
    if let [(first, _), ..] = left_out {
        text += &format!("\n{file}: {} more faults from line {first} on", left_out.len());
    }
    text
}

/// Returns the plural's ending for a number of things.
fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
