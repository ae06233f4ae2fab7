//! 5-axis programs: where the tip goes and which way the tool stands, read from a table of
//! `x,y,z,i,j,k` or from APT-CL, and written as either.
//!
//! The format is decided by the content, never by the file's ending. The first line that is
//! neither blank nor a comment (`#`, `$$`) says which it is:
//! - it begins with a number, or with the name `x`, or is a row of five or more commas or
//!   semicolons without `/`: a table of poses,
//!   `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`;
//! - it begins with another letter: APT-CL;
//! - anything else is refused.
//!
//! Coordinates are in the unit of the part. A table says nothing of its unit; APT may, and then
//! [`Program::check_unit`] holds it to the part's.

mod apt;
mod csv;
mod cutter;
mod error;
mod words;
mod write;

pub use error::{Fault, ProgramError};
pub use write::{Cutter, Heading, WriteError, apt_word};

use std::path::Path;

use crate::input;
use crate::pose::Pose;
use crate::tool::{Card, Shape};
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};

/// A 5-axis program: the positions it names, in its order.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The unit of length that the file itself states: APT's `UNITS`.
    pub unit: Option<Unit>,
    /// The positions, at least one.
    pub stops: Vec<Stop>,
    /// Words that were passed over, each with its 1-based line: they can neither move the tool nor change
    /// what positions mean.
    pub ignored: Vec<(usize, String)>,
    file: String,
    /// Of a program that was read.
    unit_line: Option<usize>,
    /// What APT says of the cutter, as arguments of `CUTTER` in the program's unit, each with its line.
    cutters: Vec<(usize, Vec<f64>)>,
}

/// One position of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The line it begins on, 1-based; of a program that was not read, its place in that.
    pub line: usize,
    /// The tool there, in the program's coordinates.
    pub pose: Pose,
    /// Whether the tool comes here in rapid traverse.
    pub rapid: bool,
}

impl Program {
    /// A program of these poses, each with whether the tool comes there in rapid traverse; `name` is what
    /// errors call it. Poses are in the unit that is stated, or in the part's.
    ///
    /// # Errors
    /// If there is no pose.
    pub fn new(
        name: &str,
        unit: Option<Unit>,
        poses: impl IntoIterator<Item = (Pose, bool)>,
    ) -> Result<Program, ProgramError> {
        let stop = |(line, (pose, rapid))| Stop { line, pose, rapid };
        let stops: Vec<Stop> = (1..).zip(poses).map(stop).collect();
        let file = name.to_owned();
        if stops.is_empty() {
            return Err(ProgramError::NoPosition { file });
        }
        Ok(Program { unit, stops, ignored: Vec::new(), file, unit_line: None, cutters: Vec::new() })
    }

    /// Reads a program from a file.
    pub fn read(path: impl AsRef<Path>) -> Result<Program, ProgramError> {
        let file = path.as_ref().display().to_string();
        match input::read(path) {
            Ok(bytes) => Program::parse(bytes, &file),
            Err(source) => Err(ProgramError::Read { file, source }),
        }
    }

    /// Reads a program from the content of a file; `name` is what errors call it.
    pub fn parse(content: impl AsRef<[u8]>, name: &str) -> Result<Program, ProgramError> {
        let file = name.to_owned();
        match assemble(content.as_ref()) {
            Err((line, fault)) => Err(ProgramError::Line { file, line, fault }),
            Ok(tape) if tape.stops.is_empty() => Err(ProgramError::NoPosition { file }),
            Ok(tape) => Ok(Program {
                unit: tape.unit.map(|(unit, _)| unit),
                unit_line: tape.unit.map(|(_, line)| line),
                stops: tape.stops,
                ignored: tape.ignored,
                cutters: tape.cutters,
                file,
            }),
        }
    }

    /// Holds the program to the part it is run on: a unit that the file states must be the
    /// part's. A file that states none is taken to be in the part's.
    pub fn check_unit(&self, part: Unit) -> Result<(), ProgramError> {
        match self.unit {
            Some(said) if said != part => Err(ProgramError::Unit {
                file: self.file.clone(),
                line: self.unit_line,
                said,
                part,
            }),
            _ => Ok(()),
        }
    }

    /// Holds the program to what it moves: a solid without an axis needs full poses, which only a
    /// table of quaternions gives.
    pub fn check_poses(&self, card: &Card) -> Result<(), ProgramError> {
        match (card.shape, self.stops.iter().find(|stop| !stop.pose.is_full())) {
            (Shape::Solid { .. }, Some(stop)) => Err(ProgramError::NoSpin {
                file: self.file.clone(),
                line: stop.line,
                solid: card.name.to_string(),
            }),
            _ => Ok(()),
        }
    }

    /// Refuses a program that has no motion.
    ///
    /// # Errors
    /// If it holds one position.
    pub fn check_motions(&self) -> Result<(), ProgramError> {
        match self.stops[..] {
            [Stop { line, .. }] => Err(ProgramError::OnePosition { file: self.file.clone(), line }),
            _ => Ok(()),
        }
    }
}

/// A fault and its 1-based line.
type Located = (usize, Fault);

/// What is read of a file, whatever its format.
#[derive(Default)]
struct Tape {
    stops: Vec<Stop>,
    unit: Option<(Unit, usize)>,
    ignored: Vec<(usize, String)>,
    cutters: Vec<(usize, Vec<f64>)>,
}

/// Bytes to text to positions.
fn assemble(bytes: &[u8]) -> Result<Tape, Located> {
    let text = decode(bytes)?;
    let Some((line, first)) = lines(text).find(|(_, line)| !is_comment(line)) else {
        return Ok(Tape::default());
    };
    if begins_table(first) {
        let stops = csv::read(text)?;
        Ok(Tape { stops, ..Tape::default() })
    } else if first.starts_with(|c: char| c.is_ascii_alphabetic()) {
        apt::read(text)
    } else {
        Err((line, Fault::Unrecognised { start: shown(first) }))
    }
}

/// The text without its byte-order mark. NUL counts as no text: that is how UTF-16 without a mark
/// shows.
fn decode(bytes: &[u8]) -> Result<&str, Located> {
    let bad = match std::str::from_utf8(bytes) {
        Ok(text) => match text.find('\0') {
            None => return plain(text.strip_prefix('\u{feff}').unwrap_or(text)),
            Some(byte) => byte,
        },
        Err(error) => error.valid_up_to(),
    };
    let line = lines(&String::from_utf8_lossy(&bytes[..bad])).count();
    Err((line, Fault::NotText { byte: bad }))
}

/// The text, if no character in it hides a line from a reader or shows one that is none.
fn plain(text: &str) -> Result<&str, Located> {
    let hidden = |c: char| {
        c.is_control() && !matches!(c, '\t' | '\r' | '\n') || matches!(c, '\u{2028}' | '\u{2029}')
    };
    match text.find(hidden) {
        None => Ok(text),
        Some(byte) => {
            let line = lines(&text[..byte]).count();
            let shown =
                text[byte..].chars().take(1).flat_map(char::escape_unicode).collect::<String>();
            Err((line, Fault::Control { shown: format!("`{shown}`") }))
        }
    }
}

/// The lines, trimmed and numbered from 1, whether they end in LF, CRLF or a lone CR.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines =
        text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    (1..).zip(lines.map(str::trim))
}

fn is_comment(line: &str) -> bool {
    line.is_empty() || line.starts_with('#') || line.starts_with("$$")
}

/// Whether a first line is a row of a table, well formed or not.
fn begins_table(line: &str) -> bool {
    let separators = [',', ';', '\t', ' '];
    let first = line.split(separators).next().unwrap_or(line);
    let separated = line.matches([',', ';']).count() >= 5 && !line.contains('/');
    line.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        || first.parse::<f64>().is_ok()
        || first.trim_matches('"').eq_ignore_ascii_case("x")
        || separated && !words::is_prose(line)
}

const PLAIN_NUMBER: &str = "write a plain number with a decimal point";

/// A finite number.
fn number(cell: &str) -> Result<f64, Fault> {
    match cell.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Fault::NotFinite { cell: shown(cell.trim()) }),
        Err(_) => Err(Fault::NotNumber { cell: shown(cell.trim()), remedy: PLAIN_NUMBER }),
    }
}

/// A pose from `x,y,z,i,j,k`.
fn axis_pose(tip: [f64; 3], axis: [f64; 3]) -> Result<Pose, Fault> {
    if axis == [0.0; 3] {
        let remedy = "give the unit vector from the tip to the spindle";
        return Err(Fault::NoDirection { what: "the axis i,j,k", remedy });
    }
    Ok(Pose::from_axis(Point3::from(tip), Vector3::from(axis))?)
}

/// What a message quotes of the file: short, in one line, nothing that a terminal would obey.
fn shown(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.is_empty() {
        return "an empty cell".to_owned();
    }
    let mut quoted = String::from("`");
    quoted.extend(text.chars().take(LONGEST).flat_map(char::escape_debug));
    if text.chars().nth(LONGEST).is_some() {
        quoted.push('…');
    }
    quoted.push('`');
    quoted
}

#[cfg(test)]
mod tests;
