//! 5-axis programs: where the tip goes and which way the tool stands, read from a table of
//! `x,y,z,i,j,k` or from APT-CL.
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

use std::fs;
use std::io;
use std::path::Path;

use crate::{Pose, PoseError, Unit};
use nalgebra::{Point3, Vector3};

/// A 5-axis program: the positions it names, in its order.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The unit of length that the file itself states: APT's `UNITS`.
    pub unit: Option<Unit>,
    /// The positions, at least one.
    pub stops: Vec<Stop>,
    /// Words that were not understood and do not place the tool as far as is known, each with its
    /// 1-based line.
    pub ignored: Vec<(usize, String)>,
    file: String,
    unit_line: usize,
}

/// One position of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The line it begins on, 1-based.
    pub line: usize,
    /// The tool there, in the program's coordinates.
    pub pose: Pose,
    /// Whether the tool comes here in rapid traverse.
    pub rapid: bool,
}

impl Program {
    /// Reads a program from a file.
    pub fn read(path: impl AsRef<Path>) -> Result<Program, ProgramError> {
        let file = path.as_ref().display().to_string();
        match fs::read(path) {
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
                unit_line: tape.unit.map_or(0, |(_, line)| line),
                stops: tape.stops,
                ignored: tape.ignored,
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
}

/// Why a program could not be taken. The message names the file, the line, the reason and the
/// remedy.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The file could not be read at all.
    #[error("{file}: cannot be read ({source}): check the path and its permissions")]
    Read {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// The file names no position.
    #[error(
        "{file}: holds no position: give rows of x,y,z,i,j,k or an APT-CL program of GOTO points \
         (G-code is not read)"
    )]
    NoPosition {
        /// The file.
        file: String,
    },
    /// A line cannot be taken.
    #[error("{file}:{line}: {fault}")]
    Line {
        /// The file.
        file: String,
        /// The line, 1-based.
        line: usize,
        /// What is wrong with it.
        fault: Fault,
    },
    /// The program states another unit than the part's.
    #[error(
        "{file}:{line}: UNITS says {said}, but the part is in {part}: load the part in {said}, or \
         post the program in {part}"
    )]
    Unit {
        /// The file.
        file: String,
        /// The line of `UNITS`, 1-based.
        line: usize,
        /// The program's unit.
        said: Unit,
        /// The part's unit.
        part: Unit,
    },
}

/// What can be wrong with a line of a program.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A byte that is no part of a UTF-8 text, or is NUL.
    #[error("byte {byte} of the file is not UTF-8 text: save it as UTF-8 (not UTF-16 or Latin-1)")]
    NotText {
        /// Its offset in the file, from 0.
        byte: usize,
    },
    /// The first line belongs to neither format.
    #[error(
        "{start} begins neither a row of x,y,z,i,j,k nor an APT statement: give one or the other"
    )]
    Unrecognised {
        /// How the line starts.
        start: String,
    },
    /// A row with another number of columns.
    #[error("found {found} columns, expected {expected}: {remedy}")]
    Columns {
        /// How many the row has.
        found: usize,
        /// How many it should have, and which.
        expected: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A first row of names that are not the columns'.
    #[error("{names} are not the columns: write x,y,z,i,j,k or x,y,z,qx,qy,qz,qw, or no names")]
    Names {
        /// The row.
        names: String,
    },
    /// A word where a number should be.
    #[error("{cell} is not a number: {remedy}")]
    NotNumber {
        /// The word.
        cell: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// NaN, an infinity, or a number too large to hold.
    #[error("{cell} is not a finite number: correct it or remove the position")]
    NotFinite {
        /// The number, as written.
        cell: String,
    },
    /// A zero axis or quaternion.
    #[error("{what} is zero and points nowhere: {remedy}")]
    NoDirection {
        /// Which columns.
        what: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A pose that cannot be one, above all an axis that is no unit vector.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// `GOTO` or `FROM` with another number of numbers.
    #[error("{word} has {found} numbers: write {word}/x,y,z or {word}/x,y,z,i,j,k")]
    Count {
        /// The word.
        word: &'static str,
        /// How many numbers follow it.
        found: usize,
    },
    /// A word that moves the tool in a way that is not interpreted.
    #[error("{word} moves the tool in a way that is not read: post the program as GOTO points")]
    Moves {
        /// The word.
        word: String,
    },
    /// A word that moves what positions are measured in.
    #[error("{word} moves the coordinates: post the program as GOTO points in the part's own")]
    Frame {
        /// The word.
        word: String,
    },
    /// A position that is not written as one.
    #[error("{statement} is not understood: write GOTO/x,y,z,i,j,k, with nothing before it")]
    Malformed {
        /// How the statement starts.
        statement: String,
    },
    /// `MULTAX` with another argument.
    #[error("MULTAX/{argument} is not understood: write MULTAX/ON or MULTAX/OFF")]
    Multax {
        /// The argument.
        argument: String,
    },
    /// A unit that is not supported.
    #[error("UNITS/{unit} is not supported: post the program in MM or INCHES")]
    UnknownUnit {
        /// What was written.
        unit: String,
    },
    /// A second, other unit.
    #[error("UNITS changes from {from} to {to}: post the whole program in one unit")]
    UnitChanges {
        /// The unit stated before.
        from: Unit,
        /// The unit stated here.
        to: Unit,
    },
    /// A unit stated after the first position.
    #[error("UNITS comes after the first position: state it before")]
    UnitLate,
    /// The end of the file before the end of the program.
    #[error("the program stops here without FINI: post it again, or add FINI if this is the end")]
    Unfinished,
    /// A statement after the end.
    #[error("a statement follows FINI: give one program per file")]
    AfterEnd,
}

/// A fault and its 1-based line.
type Located = (usize, Fault);

/// What is read of a file, whatever its format.
#[derive(Default)]
struct Tape {
    stops: Vec<Stop>,
    unit: Option<(Unit, usize)>,
    ignored: Vec<(usize, String)>,
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
            None => return Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
            Some(byte) => byte,
        },
        Err(error) => error.valid_up_to(),
    };
    let line = lines(&String::from_utf8_lossy(&bytes[..bad])).count();
    Err((line, Fault::NotText { byte: bad }))
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
        || separated && !apt::is_prose(line)
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
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// The message of a content that is refused.
    pub(super) fn refusal(content: impl AsRef<[u8]>) -> String {
        Program::parse(content, "part.cl").expect_err("it is refused").to_string()
    }

    /// A file of the shared data, or nothing, said plainly, where it is absent.
    pub(super) fn shared(name: &str) -> Option<PathBuf> {
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/paths");
        let path = root.join(name);
        if path.is_file() {
            return Some(path);
        }
        eprintln!("skipped: {} is absent", path.display());
        None
    }

    #[test]
    fn refuses_what_is_neither_format() {
        let no_position = "part.cl: holds no position: give rows of x,y,z,i,j,k or an APT-CL \
                           program of GOTO points (G-code is not read)";
        for empty in ["", "\u{feff}", "# only\n\n$$ comments\r\n", "G0 X1 Y2\nM30\n", "FINI\n"] {
            assert_eq!(refusal(empty), no_position, "{empty:?}");
        }
        assert_eq!(
            refusal("\n%\nO1000\n"),
            "part.cl:2: `%` begins neither a row of x,y,z,i,j,k nor an APT statement: give one or \
             the other"
        );
        let not_text = "is not UTF-8 text: save it as UTF-8 (not UTF-16 or Latin-1)";
        for (content, place) in [
            (&b"1,2,3,0,0,1\r\n# caf\xe9\n"[..], "part.cl:2: byte 18 of the file"),
            (&b"\xff\xfe1\0"[..], "part.cl:1: byte 0 of the file"),
            (&b"1\0,\0"[..], "part.cl:1: byte 1 of the file"),
        ] {
            assert_eq!(refusal(content), format!("{place} {not_text}"));
        }
    }

    #[test]
    fn names_a_file_that_is_absent() {
        let error = Program::read("no/such.cl").expect_err("it is absent").to_string();
        assert!(error.starts_with("no/such.cl: cannot be read ("), "{error}");
        assert!(error.ends_with("): check the path and its permissions"), "{error}");
    }

    #[test]
    fn quotes_briefly_and_in_one_line() {
        assert_eq!(shown("\u{1b}[2J"), "`\\u{1b}[2J`");
        assert_eq!(shown(&"é".repeat(99)), format!("`{}…`", "é".repeat(40)));
    }

    /// Any bytes are a program or an error, never a panic.
    #[test]
    fn survives_mutations() {
        let mut seeds = vec![
            b"\xef\xbb\xbfx,y,z,qx,qy,qz,qw\r\n1,2,3,0,0,0,1 # a\r\n4,5,6,1,0,0,0\n".to_vec(),
            b"UNITS/MM\nMULTAX/ON\nRAPID;GOTO/1,2,3,$\n0,0,1\nCYCLE/OFF\nGOTO/4,5,6\nFINI\n"
                .to_vec(),
        ];
        for name in ["impeller_flank.apt", "ijms2021_fan_xyzijk.csv"] {
            seeds.extend(shared(name).and_then(|path| fs::read(path).ok()));
        }
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut random = move |below: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            usize::try_from(state >> 33).unwrap_or(0) % below.max(1)
        };
        let spice = b"\0\r\n,;/$#.-+eE09 \xff\xc3xG\"";
        for seed in &seeds {
            for _ in 0..3000 {
                let start = random(seed.len() / 2);
                let length = random(600.min(seed.len() - start)) + 1;
                let mut bytes = seed[start..start + length].to_vec();
                for _ in 0..random(6) {
                    let at = random(bytes.len());
                    match random(3) {
                        0 => bytes[at] = spice[random(spice.len())],
                        1 => bytes.insert(at, spice[random(spice.len())]),
                        _ => bytes.truncate(at + 1),
                    }
                }
                match Program::parse(&bytes, "mutant") {
                    Ok(program) => assert!(!program.stops.is_empty()),
                    Err(error) => assert!(error.to_string().starts_with("mutant:")),
                }
            }
        }
    }
}
