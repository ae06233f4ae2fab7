//! 5-axis programs: tips and tool axes, read from a table of `x,y,z,i,j,k` or from APT-CL, and written as
//! either.
//!
//! The format follows from the content, never the file's ending. The first line that is neither blank nor a
//! comment (`#`, `$$`) determines it:
//! - it begins with a number, or with the name `x`, or is a row of five or more commas or semicolons without
//!   `/`: a table of poses, `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`;
//! - it begins with another letter: APT-CL;
//! - anything else is refused.
//!
//! Coordinates are in the part's unit. A table does not state its unit. APT may, and [`ClData::check_unit`]
//! compares it with the part's.

mod apt;
mod csv;
mod cutter;
mod error;
mod write;

pub use cutter::Cutter;
use cutter::StatedCutter;
pub(crate) use cutter::cutting_radii;
pub use error::{ProgramError, ProgramFault};
pub use write::{AptHeader, Decimals, WriteError, apt_unit};

use std::borrow::Cow;
use std::path::Path;

use nalgebra::{Point3, Vector3};
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::{FileKind, Pose, Unit, read_regular_file};

/// CL data, a program of one tool: its cutter locations, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct ClData {
    /// Unit of length that the file states with APT's `UNITS`.
    pub unit: Option<Unit>,
    /// The cutter locations, at least one.
    pub locations: Vec<CutterLocation>,
    /// Words that were passed over, each with its 1-based line. They can neither move the tool nor change the
    /// meaning of positions.
    pub ignored: Vec<(usize, String)>,
    /// The tool's number, if APT's `LOADTL` states it.
    pub tool: Option<u32>,
    file: String,
    /// Line of `UNITS` in a program that was read.
    unit_line: Option<usize>,
    /// Line of the first arc whose chords were computed as in mm, in a file without `UNITS`.
    unscaled_arc: Option<usize>,
    /// Cutters that APT states, in the program's unit.
    cutters: Vec<StatedCutter>,
}

/// A program of either kind, as a file holds it.
#[derive(Clone, Debug, PartialEq)]
pub enum ProgramFile {
    /// Positions of the tip with the axis, from a table or APT-CL: a program per tool change, at least one.
    Locations(Vec<ClData>),
    /// The text of a G-code program.
    Gcode(String),
}

impl ProgramFile {
    /// Reads a file of positions or of G-code.
    ///
    /// # Errors
    /// If the file cannot be read, or as for [`ProgramFile::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<ProgramFile, ProgramError> {
        let file = path.as_ref().display().to_string();
        match read_regular_file(path, FileKind::Program) {
            Ok(bytes) => ProgramFile::parse(bytes, &file),
            Err(source) => Err(ProgramError::Read { file, source }),
        }
    }

    /// Reads positions or G-code from the content of a file. `name` is the file's name in errors.
    ///
    /// The first line that is neither blank nor a comment decides: G-code begins with `%`, a comment in parentheses, a
    /// letter with a number, a call of Sinumerik as `MSG("A")`, or the head of a Heidenhain program.
    ///
    /// # Errors
    /// If the content is not text, or as for [`ClData::parse_tools`].
    pub fn parse(content: impl AsRef<[u8]>, name: &str) -> Result<ProgramFile, ProgramError> {
        match decode(content.as_ref()) {
            Ok(text) if is_gcode(&text) => Ok(ProgramFile::Gcode(text.into_owned())),
            _ => ClData::parse_tools(content, name).map(ProgramFile::Locations),
        }
    }
}

/// Reads a program as text: UTF-8, or else Windows-1252.
///
/// # Errors
/// If it cannot be read, or is no text.
pub fn read_text(path: &Path) -> Result<String, ProgramError> {
    let file = path.display().to_string();
    match read_regular_file(path, FileKind::Program) {
        Ok(bytes) => match decode(&bytes) {
            Ok(text) => Ok(text.into_owned()),
            Err((line, fault)) => Err(ProgramError::Line { file, line, fault, others: Vec::new() }),
        },
        Err(source) => Err(ProgramError::Read { file, source }),
    }
}

/// A cutter location: one position of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutterLocation {
    /// The line on which it begins, 1-based; in a program that was not read, its number from 1.
    pub line: usize,
    /// Pose of the tool, in the program's coordinates.
    pub pose: Pose,
    /// Set if the tool arrives in rapid traverse.
    pub rapid: bool,
}

impl ClData {
    /// Creates a program from poses, each with a flag that is set if the tool arrives in rapid traverse. `name`
    /// is the program's name in errors. Poses are in the unit that is stated, or in the part's.
    ///
    /// # Errors
    /// If there is no pose.
    pub fn new(
        name: &str,
        unit: Option<Unit>,
        poses: impl IntoIterator<Item = (Pose, bool)>,
    ) -> Result<ClData, ProgramError> {
        let numbered = (1..).zip(poses);
        let locations: Vec<CutterLocation> =
            numbered.map(|(line, (pose, rapid))| CutterLocation { line, pose, rapid }).collect();
        let file = name.to_owned();
        if locations.is_empty() {
            return Err(ProgramError::NoPosition { file });
        }
        Ok(ClData {
            unit,
            locations,
            ignored: Vec::new(),
            tool: None,
            file,
            unit_line: None,
            unscaled_arc: None,
            cutters: Vec::new(),
        })
    }

    /// Reads a program of one tool from a file.
    ///
    /// # Errors
    /// If the file cannot be read, or as for [`ClData::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<ClData, ProgramError> {
        let file = path.as_ref().display().to_string();
        match read_regular_file(path, FileKind::Program) {
            Ok(bytes) => ClData::parse(bytes, &file),
            Err(source) => Err(ProgramError::Read { file, source }),
        }
    }

    /// Reads a program of one tool from the content of a file. `name` is the file's name in errors.
    ///
    /// # Errors
    /// If a line is refused, the tool changes, or there is no position.
    pub fn parse(content: impl AsRef<[u8]>, name: &str) -> Result<ClData, ProgramError> {
        let tapes = assemble(content.as_ref());
        let tapes = tapes.and_then(|Tapes { tapes, several }| match several {
            None => Ok(tapes),
            Some(fault) => Err(vec![fault]),
        });
        ClData::from_tapes(tapes, name).map(|mut programs| programs.swap_remove(0))
    }

    /// Reads the programs of several tools from the content of a file: one per tool change of APT, at least one. Each has
    /// the positions between two changes. `name` is the file's name in errors.
    ///
    /// # Errors
    /// If a line is refused, or if there is no position.
    pub fn parse_tools(content: impl AsRef<[u8]>, name: &str) -> Result<Vec<ClData>, ProgramError> {
        ClData::from_tapes(assemble(content.as_ref()).map(|read| read.tapes), name)
    }

    fn from_tapes(
        tapes: Result<Vec<Tape>, Faults>,
        name: &str,
    ) -> Result<Vec<ClData>, ProgramError> {
        let file = name.to_owned();
        let mut tapes = match tapes {
            Err(mut faults) => {
                let (line, fault) = faults.remove(0);
                return Err(ProgramError::Line { file, line, fault, others: faults });
            }
            Ok(tapes) => tapes,
        };
        // A tool that is loaded and never moved makes no program.
        tapes.retain(|tape| !tape.locations.is_empty());
        if tapes.is_empty() {
            return Err(ProgramError::NoPosition { file });
        }
        let programs = tapes.into_iter().map(|tape| ClData {
            unit: tape.unit.map(|(unit, _)| unit),
            unit_line: tape.unit.map(|(_, line)| line),
            unscaled_arc: tape.unscaled_arc,
            locations: tape.locations,
            ignored: tape.ignored,
            tool: tape.tool,
            cutters: tape.cutters,
            file: file.clone(),
        });
        Ok(programs.collect())
    }

    /// Returns the program's name in messages.
    pub fn name(&self) -> &str {
        &self.file
    }

    /// Checks that a unit that the file states is the part's. A file that states none is taken to be in the
    /// part's unit. Arcs of such a file are divided into chords as in millimetres.
    ///
    /// # Errors
    /// If the units differ, or if a file without a unit has an arc and the part is not in millimetres.
    pub fn check_unit(&self, part: Unit) -> Result<(), ProgramError> {
        let file = || self.file.clone();
        match (self.unit, self.unscaled_arc) {
            (Some(stated), _) if stated != part => {
                Err(ProgramError::Unit { file: file(), line: self.unit_line, stated, part })
            }
            (None, Some(line)) if part != Unit::Millimetre => {
                Err(ProgramError::UnscaledArc { file: file(), line, part })
            }
            _ => Ok(()),
        }
    }

    /// Checks that the poses suffice for a tool: a solid without an axis needs poses with a spin, which only a
    /// table of quaternions gives.
    ///
    /// # Errors
    /// If the tool is such a solid, and a pose has no spin.
    pub fn check_poses(&self, info: &ToolInfo) -> Result<(), ProgramError> {
        match (info.symmetry, self.locations.iter().find(|location| !location.pose.has_spin())) {
            (Symmetry::Solid { .. }, Some(location)) => Err(ProgramError::NoSpin {
                file: self.file.clone(),
                line: location.line,
                solid: info.name.to_string(),
            }),
            _ => Ok(()),
        }
    }

    /// Refuses a program that has no motion.
    ///
    /// # Errors
    /// If it has one position.
    pub fn check_motions(&self) -> Result<(), ProgramError> {
        match self.locations[..] {
            [CutterLocation { line, .. }] => {
                Err(ProgramError::OnePosition { file: self.file.clone(), line })
            }
            _ => Ok(()),
        }
    }
}

/// A fault, with its 1-based line.
type Located = (usize, ProgramFault);

/// The faults of a file, in the order of lines: at least one.
type Faults = Vec<Located>;

/// The data read from a file of either format.
#[derive(Default)]
struct Tapes {
    /// A tape per tool change.
    tapes: Vec<Tape>,
    /// The first statement that a program of one tool cannot have.
    several: Option<Located>,
}

/// The data of one tool.
#[derive(Default)]
struct Tape {
    locations: Vec<CutterLocation>,
    unit: Option<(Unit, usize)>,
    ignored: Vec<(usize, String)>,
    tool: Option<u32>,
    unscaled_arc: Option<usize>,
    cutters: Vec<StatedCutter>,
}

/// Returns whether a text is a program of blocks for a control.
fn is_gcode(text: &str) -> bool {
    // Without blank lines, and without comments of any of the formats.
    let mut code = lines(text).map(|(_, line)| line).filter(|line| {
        !line.is_empty() && !line.starts_with([';', '#']) && !line.starts_with("$$")
    });
    code.next().is_some_and(|line| {
        let line = line.trim_start_matches(|c: char| c == '/' || c.is_whitespace());
        // A number of its block precedes the head of a program in Klartext.
        line.starts_with(['%', '(', '<'])
            || line.contains("BEGIN PGM")
            || begins_word(line)
            || begins_call(line)
    })
}

/// Returns whether a line begins with a letter and a number, as a word of G-code.
fn begins_word(line: &str) -> bool {
    let mut characters = line.chars();
    characters.next().is_some_and(|c| c.is_ascii_alphabetic())
        && characters
            .as_str()
            .trim_start()
            .starts_with(|c: char| c.is_ascii_digit() || "+-.#[<=".contains(c))
}

/// Returns whether a line begins with a name and `(`, or with a declaration of Sinumerik. Statements of APT have `/` after their name.
fn begins_call(line: &str) -> bool {
    let name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let rest = line.trim_start_matches(name);
    let word = &line[..line.len() - rest.len()];
    let is_declared = ["DEF", "PROC"].iter().any(|known| word.eq_ignore_ascii_case(known));
    let is_called = !word.is_empty() && rest.trim_start().starts_with('(');
    is_called && !apt::is_prose(line) || is_declared
}

/// Decodes bytes as text, and reads its positions.
fn assemble(bytes: &[u8]) -> Result<Tapes, Faults> {
    let text = decode(bytes).map_err(|fault| vec![fault])?;
    let text: &str = &text;
    let Some((line, first)) = lines(text).find(|(_, line)| !is_comment(line)) else {
        return Ok(Tapes::default());
    };
    if begins_table(first) {
        let locations = csv::read(text).map_err(|fault| vec![fault])?;
        Ok(Tapes { tapes: vec![Tape { locations, ..Tape::default() }], several: None })
    } else if first.starts_with(|c: char| c.is_ascii_alphabetic()) {
        apt::read(text)
    } else {
        Err(vec![(line, ProgramFault::Unrecognised { start: shown(first) })])
    }
}

/// Returns the text without its byte-order mark. What is not UTF-8 is read as Windows-1252, as posts write it: its letters can stand in
/// comments and names alone, where other code pages give other letters. A NUL is refused, since it reveals UTF-16.
fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, Located> {
    if let Some(byte) = bytes.iter().position(|byte| *byte == 0) {
        let line = lines(&String::from_utf8_lossy(&bytes[..byte])).count();
        return Err((line, ProgramFault::NotText { byte }));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => {
            check_characters(text.strip_prefix('\u{feff}').unwrap_or(text)).map(Cow::Borrowed)
        }
        Err(_) => {
            let text: String = bytes.iter().map(|byte| windows_1252(*byte)).collect();
            check_characters(&text)?;
            Ok(Cow::Owned(text))
        }
    }
}

/// The characters of Windows-1252 from 0x80 to 0x9F. Those that it lacks belong to another code page, and stand in a comment at most.
const WINDOWS_1252: &str = "€\u{fffd}‚ƒ„…†‡ˆ‰Š‹Œ\u{fffd}Ž\u{fffd}\u{fffd}‘’“”•–—˜™š›œ\u{fffd}žŸ";

/// Returns the character of a byte in Windows-1252.
fn windows_1252(byte: u8) -> char {
    match byte {
        0x80..=0x9f => {
            WINDOWS_1252.chars().nth(usize::from(byte - 0x80)).unwrap_or(char::from(byte))
        }
        _ => char::from(byte),
    }
}

/// Returns the text, if no character in it hides a line from a reader or shows a line that is none.
fn check_characters(text: &str) -> Result<&str, Located> {
    let hidden = text.find(|c: char| {
        c.is_control() && !matches!(c, '\t' | '\r' | '\n') || matches!(c, '\u{2028}' | '\u{2029}')
    });
    match hidden {
        None => Ok(text),
        Some(byte) => {
            let line = lines(&text[..byte]).count();
            let shown =
                text[byte..].chars().take(1).flat_map(char::escape_unicode).collect::<String>();
            Err((line, ProgramFault::Control { shown: format!("`{shown}`") }))
        }
    }
}

/// Returns the lines of a program, trimmed and numbered from 1. They may end in LF, CRLF or a lone CR.
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines =
        text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    (1..).zip(lines.map(str::trim))
}

fn is_comment(line: &str) -> bool {
    line.is_empty() || line.starts_with('#') || line.starts_with("$$")
}

/// Returns whether a first line is a row of a table, well formed or not.
fn begins_table(line: &str) -> bool {
    let separators = [',', ';', '\t', ' '];
    let first = line.split(separators).next().unwrap_or(line);
    // A row of names that the table does not have is refused as one, not as a word of APT.
    let separated = line.matches([',', ';']).count() >= 5 && !line.contains('/');
    line.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        || first.parse::<f64>().is_ok()
        || first.trim_matches('"').eq_ignore_ascii_case("x")
        || separated && !apt::is_prose(line)
}

const PLAIN_NUMBER: &str = "write a plain number with a decimal point";

/// Parses a finite number.
fn number(cell: &str) -> Result<f64, ProgramFault> {
    match cell.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        // `inf` and `nan` are numbers to the parser.
        Ok(_) => Err(ProgramFault::NotFinite { cell: shown(cell.trim()) }),
        Err(_) => Err(ProgramFault::NotNumber { cell: shown(cell.trim()), remedy: PLAIN_NUMBER }),
    }
}

/// Creates a pose from `x,y,z,i,j,k`.
fn axis_pose(tip: [f64; 3], axis: [f64; 3]) -> Result<Pose, ProgramFault> {
    if axis == [0.0; 3] {
        let remedy = "give the unit vector from the tip to the spindle";
        return Err(ProgramFault::NoDirection { what: "the axis i,j,k", remedy });
    }
    Ok(Pose::from_axis(Point3::from(tip), Vector3::from(axis))?)
}

/// Quotes text of the file for a message: short, in one line, without characters that a terminal would obey.
fn shown(text: &str) -> String {
    const MAX_CHARACTERS: usize = 40;
    if text.is_empty() {
        return "an empty cell".to_owned();
    }
    let mut quoted = String::from("`");
    quoted.extend(text.chars().take(MAX_CHARACTERS).flat_map(char::escape_debug));
    if text.chars().nth(MAX_CHARACTERS).is_some() {
        quoted.push('…');
    }
    quoted.push('`');
    quoted
}

#[cfg(test)]
mod tests;
