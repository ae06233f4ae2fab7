//! APT-CL: the cutter location files that CAM systems write before a machine is chosen.
//!
//! These statements are read: `GOTO/x,y,z[,i,j,k]` and `FROM/` (the tip, and the unit vector from the tip to
//! the spindle; without one, the last given stays, `0,0,1` at first), `RAPID` (for the next `GOTO`),
//! `MULTAX/OFF` (the axis is `0,0,1` again), `UNITS`, one `LOADTL`, `CUTTER`, and `FINI` or NX's `END-OF-PATH`.
//! One of the last two has to end the program, so that a truncated file is never taken for a whole one. `$$`
//! opens a comment, a trailing `$` continues the statement, `;` separates two statements, and case does not
//! matter.
//!
//! Words that can neither move the tool nor change the meaning of positions are listed in
//! [`Program::ignored`](super::Program::ignored). Every other word is refused (`words` has the lists).

use super::words::{is_prose, refuse_motions, skip_statement};
use super::{CutterLocation, Located, ProgramFault, Tape, axis_pose, lines, number, shown};
use crate::unit::Unit;
use std::collections::BTreeMap;
use std::mem;

/// Reads an APT-CL program.
pub(super) fn read(text: &str) -> Result<Tape, Located> {
    let (statements, unfinished_line) = statements(text);
    let mut reader = Reader::default();
    let mut end = 0;
    for (index, (line, statement)) in statements.iter().enumerate() {
        let is_last = unfinished_line.is_none() && index + 1 == statements.len();
        reader.statement(*line, statement, is_last).map_err(|fault| (*line, fault))?;
        end = *line;
    }
    let whole = (reader.finished || reader.path_ended) && unfinished_line.is_none();
    if whole || reader.tape.locations.is_empty() && unfinished_line.is_none() {
        Ok(reader.tape)
    } else {
        Err((unfinished_line.unwrap_or(end), ProgramFault::Unfinished))
    }
}

/// Returns the statements, each with the line on which it begins, and the line of a last statement whose
/// continuation is missing.
fn statements(text: &str) -> (Vec<(usize, String)>, Option<usize>) {
    let mut statements = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (line, raw) in lines(text) {
        if open.is_none() && is_prose(raw) {
            statements.push((line, raw.to_owned()));
            continue;
        }
        let code = raw.split_once("$$").map_or(raw, |(code, _)| code.trim_end());
        if code.is_empty() {
            continue;
        }
        let (start, mut whole) = open.take().unwrap_or((line, String::new()));
        if let Some(part) = code.strip_suffix('$') {
            whole.push_str(part);
            whole.push(' ');
            open = Some((start, whole));
        } else {
            whole.push_str(code);
            let parts = whole.split(';').map(str::trim).filter(|part| !part.is_empty());
            statements.extend(parts.map(|part| (start, part.to_owned())));
        }
    }
    (statements, open.map(|(start, _)| start))
}

/// State of the reader after some statements.
#[derive(Default)]
struct Reader {
    tape: Tape,
    axis: Option<[f64; 3]>,
    rapid: bool,
    /// Set once there was a `GOTO`.
    has_moved: bool,
    /// Statements about the tool, by word: the line and the arguments.
    tools: BTreeMap<String, (usize, Vec<String>)>,
    path_ended: bool,
    finished: bool,
}

impl Reader {
    /// Reads one statement. A position that is the last of the file (`is_last`) and cannot be read was
    /// truncated.
    fn statement(&mut self, line: usize, text: &str, is_last: bool) -> Result<(), ProgramFault> {
        let (head, rest) = text.split_once('/').unwrap_or((text, ""));
        let word = head.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let rest = rest.trim();
        let ended = self.finished || self.path_ended && word != "FINI";
        if ended && !is_prose(text) {
            return Err(ProgramFault::AfterEnd {
                end: if self.finished { "FINI" } else { "END-OF-PATH" },
            });
        }
        let as_unfinished = |fault| if is_last { ProgramFault::Unfinished } else { fault };
        match word.as_str() {
            "GOTO" => {
                let rapid = mem::take(&mut self.rapid);
                self.has_moved = true;
                self.position(line, "GOTO", rest, rapid).map_err(as_unfinished)?;
            }
            "FROM" => self.position(line, "FROM", rest, true).map_err(as_unfinished)?,
            "RAPID" if rest.is_empty() => self.rapid = true,
            "MULTAX" => self.multax(rest)?,
            "UNITS" => self.units(line, rest)?,
            "LOADTL" | "TOOLNO" | "CUTTER" | "TLDATA" | "TOOL PATH" => {
                refuse_motions(&word, rest)?;
                self.tool(line, &word, rest)?;
            }
            // NX ends the path of an operation with `END-OF-PATH`; `FINI` may follow.
            "FINI" | "END-OF-PATH" if !rest.is_empty() => {
                return Err(ProgramFault::Swallowed { word });
            }
            "FINI" => self.finished = true,
            "END-OF-PATH" => self.path_ended = true,
            other => self.other(line, text, other, rest)?,
        }
        Ok(())
    }

    fn position(
        &mut self,
        line: usize,
        word: &'static str,
        rest: &str,
        rapid: bool,
    ) -> Result<(), ProgramFault> {
        if rest.is_empty() {
            return Err(ProgramFault::Count { word, found: 0 });
        }
        let values = rest.split(',').map(number).collect::<Result<Vec<f64>, ProgramFault>>()?;
        let (tip, axis) = match values[..] {
            [x, y, z] => ([x, y, z], self.axis.unwrap_or([0.0, 0.0, 1.0])),
            [x, y, z, i, j, k] => ([x, y, z], [i, j, k]),
            _ => {
                return Err(ProgramFault::Count { word, found: values.len() });
            }
        };
        let pose = axis_pose(tip, axis)?;
        self.axis = Some(axis);
        self.tape.locations.push(CutterLocation { line, pose, rapid });
        Ok(())
    }

    fn multax(&mut self, argument: &str) -> Result<(), ProgramFault> {
        match argument.to_ascii_uppercase().as_str() {
            "" | "ON" => {}
            "OFF" => self.axis = None,
            _ => {
                return Err(ProgramFault::Multax { argument: unquoted(argument) });
            }
        }
        Ok(())
    }

    fn units(&mut self, line: usize, word: &str) -> Result<(), ProgramFault> {
        let unit = match word.to_ascii_uppercase().as_str() {
            "MM" | "MMS" => Unit::Millimetre,
            "IN" | "INCH" | "INCHES" => Unit::Inch,
            _ => return Err(ProgramFault::UnknownUnit { unit: unquoted(word) }),
        };
        match self.tape.unit {
            Some((from, _)) if from != unit => Err(ProgramFault::UnitChanges { from, to: unit }),
            Some(_) => Ok(()),
            None if !self.tape.locations.is_empty() => Err(ProgramFault::UnitLate),
            None => {
                self.tape.unit = Some((unit, line));
                Ok(())
            }
        }
    }

    /// Reads a statement about the tool. A program has one tool, stated before the positions.
    fn tool(&mut self, line: usize, word: &str, rest: &str) -> Result<(), ProgramFault> {
        let upper = rest.to_ascii_uppercase();
        let mut arguments: Vec<String> = upper.split(',').map(|part| part.trim().into()).collect();
        if word == "TOOL PATH" {
            // The arguments before `TOOL` name the path and not the tool.
            let tool = arguments.iter().position(|part| part == "TOOL");
            arguments.drain(..tool.unwrap_or(0));
        }
        match self.tools.get(word) {
            Some((first, known)) if *known != arguments || word == "LOADTL" => {
                return Err(ProgramFault::SecondTool { first: *first });
            }
            None if self.has_moved => return Err(ProgramFault::LateTool { word: word.to_owned() }),
            _ => {}
        }
        match (word, &arguments[..]) {
            ("CUTTER", arguments) => self.cutter(line, arguments)?,
            // NX writes a mill as diameter, corner, height, and the angles of side and end.
            ("TLDATA", [kind, diameter, corner, rest_arguments @ ..]) if kind == "MILL" => {
                let values = [diameter, corner].map(String::as_str).map(number);
                let [diameter, corner] = [values[0].clone()?, values[1].clone()?];
                let angle =
                    |at: usize| rest_arguments.get(at).map_or(Ok(0.0), |angle| number(angle));
                let (side, end) = (angle(1)?, angle(2)?);
                let corner_centre = [0.5 * diameter - corner, corner];
                let arguments =
                    vec![diameter, corner, corner_centre[0], corner_centre[1], end, side];
                self.tape.cutters.push((line, arguments));
            }
            _ => {}
        }
        if word != "CUTTER" {
            self.tape.ignored.push((line, word.to_owned()));
        }
        self.tools.insert(word.to_owned(), (line, arguments));
        Ok(())
    }

    /// Reads the cutter that the positions refer to.
    fn cutter(&mut self, line: usize, arguments: &[String]) -> Result<(), ProgramFault> {
        let values = arguments
            .iter()
            .map(|part| number(part))
            .collect::<Result<Vec<f64>, ProgramFault>>()?;
        self.tape.cutters.push((line, values));
        Ok(())
    }

    /// Passes over or refuses a word that is not read.
    fn other(
        &mut self,
        line: usize,
        text: &str,
        word: &str,
        rest: &str,
    ) -> Result<(), ProgramFault> {
        match skip_statement(word, rest) {
            Ok(word) => {
                self.tape.ignored.push((line, word));
                Ok(())
            }
            Err(ProgramFault::UnknownWord { .. })
                if word.split([' ', ')']).any(|part| ["GOTO", "FROM", "UNITS"].contains(&part)) =>
            {
                Err(ProgramFault::Malformed { statement: shown(text) })
            }
            Err(fault) => Err(fault),
        }
    }
}

/// Returns the text as [`shown`] quotes it, without the quotes; empty for empty text.
fn unquoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { shown(text).trim_matches('`').to_owned() }
}

#[cfg(test)]
mod tests;
