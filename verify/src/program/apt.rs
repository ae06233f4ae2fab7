//! APT-CL: the cutter location files that CAM systems write before a machine is chosen.
//!
//! These statements are read: `GOTO/x,y,z[,i,j,k]` and, as the first position of a tool, `FROM/` (the tip, and
//! the unit vector from the tip to the spindle; without one, `0,0,1`, or the last given in NX's files), `RAPID`
//! (for the next `GOTO`), `MULTAX`, `UNITS` (`UNIT`), `LOADTL` (`LOAD/TOOL`), `CUTTER`, [arcs and cycles](cycle) by `CIRCLE`,
//! `MOVARC`, `TLON,GOFWD` and `CYCLE`, and `FINI` or NX's `END-OF-PATH`. Positions are those of the tool's tip: `CUTCOM` beside them lets the control correct a
//! worn tool, and is passed over.
//! One of the last two, or CATIA's `END`, has to end the program, so that a truncated file is never taken for a whole one. `$$`
//! opens a comment, a trailing `$` continues the statement, `;` separates two statements, and case does not
//! matter. Two comments state the frame of the positions, which may be repeated and not changed: CATIA's machining axis and
//! Creo's coordinate system. Creo states its cutter, and whether positions are those of the contour, in comments, too, and several
//! positions on an arc after one `CIRCLE`.
//!
//! Statements about the tool hold for the positions that follow them: `LOADTL` between two positions changes the tool,
//! and the cutters stated before or after it, up to the next position, are those of the new one. In NX's files,
//! `TOOL PATH` after `END-OF-PATH` begins another operation.
//!
//! Words that can neither move the tool nor change the meaning of positions are listed in
//! [`ClData::ignored`](super::ClData::ignored), with any arguments or with those given; so is a rate that is not understood. Every
//! other word is refused: an unknown one could be a motion.

mod cycle;

use super::cutter::{Stated, StatedCutter};
use super::{
    CutterLocation, Faults, Located, ProgramFault, Tape, Tapes, axis_pose, lines, number, shown,
};
use crate::gcode::is_word_of_sinumerik;
use cycle::{Arc, Cycle, Normals, Stop};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashSet};
use std::mem;
use touchoff::{Pose, Unit, cancellation};

/// Largest number of chords of all arcs of a program.
pub(super) const MAX_ALL_CHORDS: usize = 2_000_000;

/// The axis of a tool along +Z.
const UPRIGHT: [f64; 3] = [0.0, 0.0, 1.0];

/// The comment with which CATIA writes the machining axis.
const CATIA_AXIS: &str = "$$*CATIA0";

/// The beginning of Creo's comments.
const CREO_COMMENT: &str = "$$->";

/// The words of Creo's comments that are read: the coordinate system, whether positions are those of the tool's centre or of the contour,
/// and the cutter.
const CREO_SYSTEM: &str = "$$-> CSYS";
const CREO_CONTOUR: &str = "$$-> CUTCOM_GEOMETRY_TYPE";
const CREO_CUTTER: &str = "$$-> CUTTER";

/// Returns the word of a comment of Creo that is read, and its arguments.
fn creo_comment(line: &str) -> Option<CreoComment<'_>> {
    let (name, arguments) = line.strip_prefix(CREO_COMMENT)?.split_once('/')?;
    let known = [CREO_SYSTEM, CREO_CONTOUR, CREO_CUTTER];
    let is_named =
        |word: &&str| word[CREO_COMMENT.len()..].trim().eq_ignore_ascii_case(name.trim());
    let word = known.into_iter().find(is_named)?;
    Some(CreoComment { word, arguments: arguments.trim().trim_end_matches('$').trim_end() })
}

/// A comment of Creo that is read.
struct CreoComment<'a> {
    word: &'static str,
    arguments: &'a str,
}

/// Reads an APT-CL program. All statements that are refused are found, each fault once.
pub(super) fn read(text: &str) -> Result<Tapes, Faults> {
    let (mut faults, mut known) = (Faults::new(), HashSet::new());
    let mut refuse = |(line, fault): Located| {
        if known.insert(fault.obstacle()) {
            faults.push((line, fault));
        }
    };
    check_catia_axes(text).unwrap_or_else(&mut refuse);
    let (statements, unfinished_line) = statements(text);
    let is_creo = lines(text).any(|(_, line)| line.starts_with(CREO_COMMENT));
    let mut reader = Reader { is_creo, ..Reader::default() };
    let mut end = 0;
    for (index, (line, statement)) in statements.iter().enumerate() {
        cancellation::check();
        let is_last = unfinished_line.is_none() && index + 1 == statements.len();
        reader.statement(*line, statement, is_last).unwrap_or_else(&mut refuse);
        end = *line;
    }
    reader.change_tool().unwrap_or_else(&mut refuse);
    if reader.arc.is_some() {
        refuse((end, ProgramFault::Arc { what: "ends at no position" }));
    }
    if let Some(line) = reader.normals.ambiguous() {
        let what =
            "fits both directions, and no clockwise arc tells that the file's normals state them";
        refuse((line, ProgramFault::Arc { what }));
    }
    // A file without positions is refused as such, whether it ends or not.
    // In a file of NX it is the beginning of `END-OF-PATH`.
    let is_at_end = reader.is_at_end && !reader.is_nx;
    let whole = (reader.finished || reader.path_ended || is_at_end) && unfinished_line.is_none();
    let is_empty = reader.tapes.is_empty() && reader.tape.locations.is_empty();
    if !(whole || is_empty && unfinished_line.is_none()) {
        refuse((unfinished_line.unwrap_or(end), ProgramFault::Unfinished));
    }
    if !faults.is_empty() {
        faults.sort_by_key(|(line, _)| *line);
        return Err(faults);
    }
    reader.tapes.push(reader.tape);
    Ok(Tapes { tapes: reader.tapes, several: reader.several })
}

/// Refuses a second machining axis of CATIA, which stands among the comments: `$$*CATIA0`, then a name and three rows.
fn check_catia_axes(text: &str) -> Result<(), Located> {
    let mut first: Option<Vec<&str>> = None;
    let mut lines = lines(text).peekable();
    while let Some((line, comment)) = lines.next() {
        if !comment.starts_with(CATIA_AXIS) {
            continue;
        }
        let rest = std::iter::from_fn(|| lines.next_if(|(_, next)| next.starts_with("$$")));
        let rows: Vec<&str> = rest.skip(1).take(3).map(|(_, row)| row).collect();
        if first.get_or_insert_with(|| rows.clone()) != &rows {
            return Err((line, ProgramFault::Frame { word: CATIA_AXIS.to_owned() }));
        }
    }
    Ok(())
}

/// Returns the statements, each with the line on which it begins, and the line of a last statement whose
/// continuation is missing.
fn statements(text: &str) -> (Vec<(usize, String)>, Option<usize>) {
    let mut statements = Vec::new();
    let mut open: Option<(usize, String)> = None;
    let mut lines = lines(text).peekable();
    while let Some((line, raw)) = lines.next() {
        if let Some(CreoComment { word, arguments }) = creo_comment(raw) {
            // Rows of numbers may follow. They may be comments or not, and end in `$` or not.
            let mut statement = format!("{word} / {arguments}");
            while let Some(row) = lines.peek().and_then(|(_, row)| numbers_of(row)) {
                statement = format!("{statement}, {row}");
                lines.next();
            }
            statements.push((line, statement));
            continue;
        }
        if open.is_none() && is_prose(raw) {
            statements.push((line, raw.to_owned()));
            continue;
        }
        // A comment is no continuation, though it begins with the same sign.
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

/// Returns a row of numbers, without the signs of a comment and of a continuation; `None` for any other line.
fn numbers_of(row: &str) -> Option<&str> {
    let numbers = row.trim_start_matches("$$").trim_start_matches("->").trim_end_matches('$');
    let mut cells = parts(numbers).peekable();
    (cells.peek().is_some() && cells.all(|cell| number(cell).is_ok())).then_some(numbers)
}

/// State of the reader after some statements.
#[derive(Default)]
struct Reader {
    /// The tapes of the tools before the present one.
    tapes: Vec<Tape>,
    tape: Tape,
    axis: Option<[f64; 3]>,
    /// Set where CAM systems take different axes for a position without one.
    is_axis_open: bool,
    /// Set in a file of NX, which has `TOOL PATH`.
    is_nx: bool,
    rapid: bool,
    /// The arc to the next position.
    arc: Option<Arc>,
    /// Set in a file of Creo, which states several positions on an arc.
    is_creo: bool,
    /// The arc that the last statement ended.
    ended_arc: Option<Arc>,
    normals: Normals,
    /// Number of chords of all arcs.
    chords: usize,
    /// The direction in which CATIA's next arc begins.
    direction: Option<Vector3<f64>>,
    /// Set where Creo's positions are those of the contour.
    is_contour: bool,
    /// The arguments of `CUTCOM` in force, by which the control corrects the tool.
    compensation: Option<String>,
    /// The cycle at each position.
    cycle: Option<Cycle>,
    /// Set once there was a `GOTO`.
    has_moved: bool,
    /// Statements about the present tool, by word: the line and the arguments.
    tool: BTreeMap<String, (usize, Vec<String>)>,
    /// Those about the tools before, by their numbers.
    tools: BTreeMap<u32, BTreeMap<String, (usize, Vec<String>)>>,
    /// Statements about the tool since the last position.
    pending: Vec<ToolStatement>,
    /// Creo's coordinate system, as [`Reader::coordinate_system`] writes it.
    system: Option<Vec<String>>,
    /// The first statement that a program of one tool and one operation cannot have.
    several: Option<Located>,
    path_ended: bool,
    /// Set if the last statement is `END`, with which CATIA's programs end.
    is_at_end: bool,
    finished: bool,
}

/// A statement about the tool.
struct ToolStatement {
    line: usize,
    word: String,
    arguments: Vec<String>,
    cutter: Option<StatedCutter>,
}

impl Reader {
    /// Reads one statement. A position that is the last of the file (`is_last`) and cannot be read was
    /// truncated.
    fn statement(&mut self, line: usize, text: &str, is_last: bool) -> Result<(), Located> {
        let (head, rest) = text.split_once('/').unwrap_or((text, ""));
        let word = head.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let rest = rest.trim();
        if matches!(word.as_str(), "GOTO" | "FROM" | "TLON,GOFWD") && !self.finished {
            self.change_tool()?;
        }
        if word != "GOTO" {
            self.ended_arc = None;
        }
        self.is_at_end = word == "END";
        self.word(line, text, &word, rest, is_last).map_err(|fault| (line, fault))
    }

    fn word(
        &mut self,
        line: usize,
        text: &str,
        word: &str,
        rest: &str,
        is_last: bool,
    ) -> Result<(), ProgramFault> {
        if word == CREO_SYSTEM {
            return self.coordinate_system(rest);
        }
        if word == CREO_CONTOUR {
            self.is_contour = rest.eq_ignore_ascii_case("OUTPUT_ON_PROFILE");
            return self.check_contour();
        }
        let ended = self.finished || self.path_ended && !matches!(word, "FINI" | "TOOL PATH");
        if ended && !is_prose(text) {
            return Err(ProgramFault::AfterEnd {
                end: if self.finished { "FINI" } else { "END-OF-PATH" },
            });
        }
        // Other words for the same statements.
        let (word, rest) = match (word, rest.split_once(',')) {
            ("UNIT", _) => ("UNITS", rest),
            ("LOAD", Some((tool, rest))) if tool.trim().eq_ignore_ascii_case("TOOL") => {
                ("LOADTL", rest.trim())
            }
            _ => (word, rest),
        };
        match word {
            "CIRCLE" | "MOVARC" => {
                if self.arc.is_some() {
                    return Err(ProgramFault::Arc { what: "ends at no position" });
                }
                self.arc = Some(match word {
                    "CIRCLE" => Arc::circle(rest, self.is_nx)?,
                    _ => Arc::movarc(rest)?,
                });
            }
            "INDIRV" => {
                let values = rest.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
                let &[i, j, k] = &values[..] else {
                    return Err(ProgramFault::Moves { word: word.to_owned() });
                };
                self.direction = Some(Vector3::new(i, j, k));
            }
            "TLON,GOFWD" => self.catia_arc(line, rest)?,
            "CUTCOM" => {
                self.compensation =
                    Some(rest.to_owned()).filter(|word| !word.eq_ignore_ascii_case("OFF"));
                self.check_contour()?;
                self.other(line, text, word, rest)?;
            }
            "CYCLE" => {
                self.cycle = Cycle::read(rest, self.cycle.as_ref())?;
                if self.cycle.is_none() {
                    self.tape.ignored.push((line, word.to_owned()));
                }
            }
            "GOTO" => {
                let rapid = mem::take(&mut self.rapid);
                self.has_moved = true;
                self.position(line, "GOTO", rest, rapid, is_last)?;
            }
            "FROM" if self.tape.locations.is_empty() => {
                self.position(line, "FROM", rest, true, is_last)?;
            }
            "FROM" => return Err(ProgramFault::LateFrom),
            "RAPID" if rest.is_empty() => self.rapid = true,
            "MULTAX" => self.multax(rest)?,
            "UNITS" => self.units(line, rest)?,
            "LOADTL" | "TOOLNO" | "CUTTER" | "TLDATA" | "TOOL PATH" | CREO_CUTTER => {
                refuse_motions(word, rest)?;
                // Only NX has it, whose positions without an axis keep the last one.
                self.is_nx |= word == "TOOL PATH";
                if mem::take(&mut self.path_ended) {
                    let after = ProgramFault::AfterEnd { end: "END-OF-PATH" };
                    self.several.get_or_insert((line, after));
                }
                let statement = tool_statement(line, word, rest)?;
                if !matches!(word, "CUTTER" | CREO_CUTTER) {
                    self.tape.ignored.push((line, word.to_owned()));
                }
                self.pending.push(statement);
            }
            // NX ends the path of an operation with `END-OF-PATH`; `FINI` may follow.
            "FINI" | "END-OF-PATH" if !rest.is_empty() => {
                return Err(ProgramFault::Swallowed { word: word.to_owned() });
            }
            "FINI" => self.finished = true,
            "END-OF-PATH" => self.path_ended = true,
            other => self.other(line, text, other, rest)?,
        }
        Ok(())
    }

    /// Refuses positions of the contour which the control corrects by the whole radius of the tool.
    fn check_contour(&self) -> Result<(), ProgramFault> {
        match &self.compensation {
            Some(argument) if self.is_contour => {
                let argument = format!("{}, with OUTPUT_ON_PROFILE,", unquoted(argument));
                Err(ProgramFault::Compensation { argument })
            }
            _ => Ok(()),
        }
    }

    /// Reads a position. One that is the last of the file and cannot be read was truncated.
    fn position(
        &mut self,
        line: usize,
        word: &'static str,
        rest: &str,
        rapid: bool,
        is_last: bool,
    ) -> Result<(), ProgramFault> {
        match self.pose(word, rest) {
            Ok(pose) => {
                let before = self.tape.locations.last().map(|location| location.pose);
                let unit = self.tape.unit.map(|(unit, _)| unit);
                let ended_arc = self.ended_arc.take().filter(|_| self.is_creo && !rapid);
                let mut arc = self.arc.take();
                if let (None, Some(ended), Some(before)) = (arc, ended_arc, &before) {
                    arc = ended.continued(before, &pose, unit)?;
                }
                let stops = match (arc, &self.cycle) {
                    (Some(stated), None) => {
                        let (poses, arc) =
                            stated.stops(before.as_ref(), &pose, unit, self.chords)?;
                        if let Some(before) = &before {
                            self.normals.add(line, &stated, &arc, [before, &pose]);
                        }
                        self.keep_unscaled_arc(line);
                        self.chords += poses.len();
                        self.ended_arc = Some(arc);
                        poses.into_iter().map(|pose| Stop { pose, rapid }).collect()
                    }
                    (None, Some(cycle)) => cycle.stops(&pose, before.as_ref())?,
                    (Some(_), Some(_)) => {
                        return Err(ProgramFault::Arc { what: "is within a cycle" });
                    }
                    (None, None) => vec![Stop { pose, rapid }],
                };
                self.add(line, stops);
                Ok(())
            }
            Err(_) if is_last => Err(ProgramFault::Unfinished),
            Err(fault) => Err(fault),
        }
    }

    /// Keeps the line of the first arc that is divided into chords without a stated unit.
    fn keep_unscaled_arc(&mut self, line: usize) {
        if self.tape.unit.is_none() {
            self.tape.unscaled_arc.get_or_insert(line);
        }
    }

    fn add(&mut self, line: usize, stops: Vec<Stop>) {
        for Stop { pose, rapid } in stops {
            self.tape.locations.push(CutterLocation { line, pose, rapid });
        }
    }

    /// Reads an arc of CATIA, which states its own end.
    fn catia_arc(&mut self, line: usize, rest: &str) -> Result<(), ProgramFault> {
        let rapid = mem::take(&mut self.rapid);
        let before = self.tape.locations.last().map(|location| location.pose);
        let (Some(before), Some(direction), None) = (before, self.direction.take(), &self.cycle)
        else {
            return Err(ProgramFault::Arc { what: "begins at no position or in no direction" });
        };
        let (arc, end) = Arc::catia(rest, &before, direction)?;
        let unit = self.tape.unit.map(|(unit, _)| unit);
        let (poses, _) = arc.stops(Some(&before), &end, unit, self.chords)?;
        self.keep_unscaled_arc(line);
        self.chords += poses.len();
        self.add(line, poses.into_iter().map(|pose| Stop { pose, rapid }).collect());
        Ok(())
    }

    fn pose(&mut self, word: &'static str, rest: &str) -> Result<Pose, ProgramFault> {
        if rest.is_empty() {
            return Err(ProgramFault::Count { word, found: 0 });
        }
        let values = rest.split(',').map(number).collect::<Result<Vec<f64>, ProgramFault>>()?;
        let (tip, axis) = match values[..] {
            [_, _, _] if self.is_axis_open => return Err(ProgramFault::OpenAxis),
            [x, y, z] => ([x, y, z], self.axis.unwrap_or(UPRIGHT)),
            [x, y, z, i, j, k] => ([x, y, z], [i, j, k]),
            _ => return Err(ProgramFault::Count { word, found: values.len() }),
        };
        let pose = axis_pose(tip, axis)?;
        // NX leaves an axis out that stays, Creo one that is +Z.
        self.is_axis_open = !self.is_nx && axis != UPRIGHT;
        self.axis = Some(axis);
        Ok(pose)
    }

    fn multax(&mut self, argument: &str) -> Result<(), ProgramFault> {
        match argument.to_ascii_uppercase().as_str() {
            "" | "ON" => {}
            // CATIA locks the last axis then.
            "OFF" => {
                self.is_axis_open |= self.axis.is_some_and(|axis| axis != UPRIGHT);
                self.axis = None;
            }
            _ => {
                return Err(ProgramFault::Multax { argument: unquoted(argument) });
            }
        }
        Ok(())
    }

    /// Reads a coordinate system of Creo, in which the positions after it are given. Another one than the first is refused.
    fn coordinate_system(&mut self, rest: &str) -> Result<(), ProgramFault> {
        // Equal numbers may be written with different digits, and 0 with a sign.
        let cells = parts(rest).map(|cell| match number(cell) {
            Ok(value) => (value + 0.0).to_string(),
            Err(_) => cell.to_owned(),
        });
        let system: Vec<String> = cells.collect();
        match *self.system.get_or_insert_with(|| system.clone()) == system {
            true => Ok(()),
            false => Err(ProgramFault::Frame { word: CREO_SYSTEM.to_owned() }),
        }
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
            None if !self.tape.locations.is_empty() || !self.tapes.is_empty() => {
                Err(ProgramFault::UnitLate)
            }
            None => {
                self.tape.unit = Some((unit, line));
                Ok(())
            }
        }
    }

    /// Applies the statements about the tool since the last position. `LOADTL` among them changes the tool if it has
    /// another number.
    fn change_tool(&mut self) -> Result<(), Located> {
        let pending = mem::take(&mut self.pending);
        let load = pending.iter().find(|statement| statement.word == "LOADTL");
        let number = load.and_then(ToolStatement::number);
        if let (true, Some(load)) = (self.has_moved, load) {
            let known = mem::take(&mut self.tool);
            let fault = pending.iter().find_map(|statement| statement.conflict(&known, true));
            let faults = [self.several.take(), fault];
            self.several = faults.into_iter().flatten().min_by_key(|(line, _)| *line);
            let Some(number) = number else {
                let argument = load.arguments.join(",");
                return Err((
                    load.line,
                    ProgramFault::ToolNumber { argument: unquoted(&argument) },
                ));
            };
            // One number is one tool, also where others come between.
            self.tools.extend(self.tape.tool.map(|number| (number, known)));
            if let Some(known) = self.tools.get(&number) {
                let mut again =
                    pending.iter().filter(|statement| known.contains_key(&statement.word));
                if let Some(fault) = again.find_map(|statement| statement.conflict(known, false)) {
                    return Err(fault);
                }
            }
            // The same tool again goes on from where it is.
            if self.tape.tool != Some(number) {
                let unit = self.tape.unit;
                let next = Tape { unit, tool: Some(number), ..Tape::default() };
                self.tapes.push(mem::replace(&mut self.tape, next));
            }
        } else if load.is_some() {
            self.tape.tool = number;
        }
        let is_late = self.has_moved && load.is_none();
        for statement in pending {
            if let Some(fault) = statement.conflict(&self.tool, is_late) {
                return Err(fault);
            }
            let ToolStatement { line, word, arguments, cutter } = statement;
            self.tape.cutters.extend(cutter);
            self.tool.insert(word, (line, arguments));
        }
        Ok(())
    }

    /// Reads a word that moves nothing, passes over it, or refuses it.
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

/// Reads a statement about the tool.
fn tool_statement(line: usize, word: &str, rest: &str) -> Result<ToolStatement, ProgramFault> {
    let upper = rest.to_ascii_uppercase();
    let mut arguments: Vec<String> = upper.split(',').map(|part| part.trim().into()).collect();
    if word == "TOOL PATH" {
        // The arguments before `TOOL` name the path and not the tool.
        let tool = arguments.iter().position(|part| part == "TOOL");
        arguments.drain(..tool.unwrap_or(0));
    }
    let numbers =
        |parts: &[String]| parts.iter().map(|part| number(part)).collect::<Result<Vec<f64>, _>>();
    let stated = match (word, &arguments[..]) {
        ("CUTTER", arguments) => Some(Stated::Form(numbers(arguments)?)),
        // Creo leaves the corner out, whatever it is.
        (CREO_CUTTER, [diameter]) => Some(Stated::Diameter(number(diameter)?)),
        (CREO_CUTTER, arguments) => Some(Stated::Form(numbers(arguments)?)),
        // NX writes a mill as diameter, corner, height, and the angles of side and end.
        ("TLDATA", [kind, diameter, corner, others @ ..]) if kind == "MILL" => {
            let (diameter, corner) = (number(diameter)?, number(corner)?);
            let angle = |at: usize| others.get(at).map_or(Ok(0.0), |angle| number(angle));
            let (side, end) = (angle(1)?, angle(2)?);
            let centre = 0.5 * diameter - corner;
            Some(Stated::Form(vec![diameter, corner, centre, corner, end, side]))
        }
        ("TLDATA", [kind, _, diameter, ..]) if kind == "DRILL" && arguments[1] == "MILL" => {
            Some(Stated::Diameter(number(diameter)?))
        }
        ("TLDATA", [kind, diameter, ..])
            if ["DRILL", "TCUTTER", "MILL"].contains(&kind.as_str()) =>
        {
            Some(number(diameter).map_or(Stated::Other, Stated::Diameter))
        }
        ("TLDATA", _) => Some(Stated::Other),
        _ => None,
    };
    let cutter = stated.map(|stated| StatedCutter { line, stated });
    Ok(ToolStatement { line, word: word.to_owned(), arguments, cutter })
}

impl ToolStatement {
    /// Returns the number of the tool, if the first argument is one.
    fn number(&self) -> Option<u32> {
        number_of_tool(&self.arguments)
    }

    /// Returns whether a tool with these arguments is loaded again: CATIA does so in each operation, with fewer arguments.
    fn is_same_number(&self, known: &[String]) -> bool {
        let number = self.number();
        self.word == "LOADTL" && number.is_some() && number == number_of_tool(known)
    }

    /// Returns the fault if the statement contradicts the tool that is known, or adds to it too late.
    fn conflict(
        &self,
        known: &BTreeMap<String, (usize, Vec<String>)>,
        is_late: bool,
    ) -> Option<Located> {
        let fault = match known.get(&self.word) {
            Some((first, known)) if *known != self.arguments && !self.is_same_number(known) => {
                ProgramFault::SecondTool { first: *first }
            }
            None if is_late => ProgramFault::LateTool { word: self.word.clone() },
            _ => return None,
        };
        Some((self.line, fault))
    }
}

fn number_of_tool(arguments: &[String]) -> Option<u32> {
    arguments.first()?.parse().ok()
}

/// Returns the text as [`shown`] quotes it, without the quotes; empty for empty text.
fn unquoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { shown(text).trim_matches('`').to_owned() }
}

/// Words whose line is prose to its end: neither `$` nor `;` has a meaning in it.
const PROSE_WORDS: [&str; 3] = ["PARTNO", "PPRINT", "REMARK"];

/// Words that write text to the control verbatim, to the end of the line. The text may contain any motion.
const VERBATIM_WORDS: [&str; 2] = ["INSERT", "LETTER"];

/// Words that can neither move the tool nor change the meaning of positions: names and messages, tolerances
/// that were used in computing the positions, speeds and feeds, coolant, stops and delays, the block numbers and
/// the file of the post-processor, planes that only other words use, displays.
#[rustfmt::skip]
const IGNORED_WORDS: [&str; 36] = [
    "PARTNO", "PPRINT", "REMARK", "TITLES", "MACHIN", "ISN", "SEQNO", "LEADER", "TMARK", "CLPRNT",
    "INTOL", "OUTTOL", "TOLER", "LINTOL", "MCHTOL", "CUT",
    "FEDRAT", "FEDTO", "SPINDL", "COOLNT", "OPSTOP", "STOP", "DELAY", "DWELL", "END", "REWIND",
    "CLEARP", "CLRSRF", "SELCTL", "PAINT", "DISPLY", "PLOT", "NOPLOT", "NOPOST", "VERIFY", "AUTOPS",
];

/// Settings of SolidWorks CAM about tools. Others of its words could turn the table or change the frame.
const CSI_WORDS: [&str; 3] = ["CSI_TOOL", "CSI_SET_FLUTE_LENGTH", "CSI_SET_EXTENSION_LENGTH"];

/// Words that move the tool, or decide whether and how often it moves.
#[rustfmt::skip]
const MOTION_WORDS: [&str; 49] = [
    "GODLTA", "GO", "GOFWD", "GOBACK", "GOLFT", "GORGT", "GOUP", "GODOWN", "GOHOME", "GOCLER",
    "GOABS", "INDIRP", "INDIRV", "LINEAR", "MOVE", "MOVETO", "ARC", "CIRC", "ARCDAT", "DRILL",
    "TLON", "TLLFT", "TLRGT", "CIRCLE", "MOVARC", "HELIX", "NURBS", "SPLINE", "THREAD", "TAP",
    "BORE", "REAM", "CYCLE", "POCKET", "SCURV", "RETRCT", "RETURN", "PROBE", "CALL", "MACRO",
    "TERMAC", "LOOPST", "LOOPND", "JUMPTO", "RUN", "COPY", "DNTCUT", "OPSKIP", "DELETE",
];

/// Words that change the meaning of positions: their frame, the point of the tool that they refer to, absolute
/// or incremental mode, or the tool and the spindle in use.
#[rustfmt::skip]
const FRAME_WORDS: [&str; 21] = [
    "MSYS", "CSYS", "TRACUT", "TRANS", "ORIGIN", "ROTABL", "ROTHED", "ROTATE", "TLAXIS", "TILT",
    "PLANE", "SCALE", "MIRROR", "CUTCOM", "OFSTNO", "FIXOFF", "THICK", "OFFSET", "MODE", "HEAD",
    "TURRET",
];

/// Words of motions that are read. No argument may be one of them, or a motion that begins with `GO`.
const POSITION_WORDS: [&str; 3] = ["GOTO", "FROM", "RAPID"];

/// Returns whether a line is prose to its end.
pub(super) fn is_prose(line: &str) -> bool {
    PROSE_WORDS
        .iter()
        .chain(&VERBATIM_WORDS)
        .any(|prose| line.get(..prose.len()).is_some_and(|word| word.eq_ignore_ascii_case(prose)))
}

/// Decides whether a statement may be passed over, and returns its word. `word` is in capitals, with one space
/// between its parts.
///
/// # Errors
/// If the word moves the tool, changes the meaning of positions, or is not known to do neither; if its
/// arguments contain another statement.
fn skip_statement(word: &str, arguments: &str) -> Result<String, ProgramFault> {
    // Prose need not have a `/`.
    if let Some(prose) = PROSE_WORDS.iter().find(|prose| word.starts_with(**prose)) {
        return Ok((*prose).to_owned());
    }
    if let Some(verbatim) = VERBATIM_WORDS.iter().find(|verbatim| word.starts_with(**verbatim)) {
        let text = format!("{} {}", &word[verbatim.len()..], arguments.to_ascii_uppercase());
        return match moves_nothing(&text) {
            true => Ok((*verbatim).to_owned()),
            false => Err(ProgramFault::Verbatim { word: (*verbatim).to_owned() }),
        };
    }
    // Settings about tools, and names of CATIA's.
    if CSI_WORDS.contains(&word) || word == "TPRINT" {
        refuse_motions(word, &arguments.replace('/', " "))?;
        return Ok(word.to_owned());
    }
    if IGNORED_WORDS.contains(&word) || is_inert_with(word, arguments) {
        refuse_motions(word, arguments)?;
        return match parts(&arguments.to_ascii_uppercase())
            .any(|part| MOTION_WORDS.contains(&part) || FRAME_WORDS.contains(&part))
        {
            true => Err(ProgramFault::Swallowed { word: word.to_owned() }),
            false => Ok(word.to_owned()),
        };
    }
    if is_g_code(word) {
        return Err(ProgramFault::GCode { block: shown(word) });
    }
    // `TLLFT,GOFWD/...` and `L1) GOTO/...` are motions as well.
    let [frame, motion] = [&FRAME_WORDS[..], &MOTION_WORDS].map(|list| {
        word.split([' ', ')', ',', '=']).find(|part| list.contains(part)).map(str::to_owned)
    });
    match (frame, motion) {
        (Some(word), _) if word == "CUTCOM" => {
            Err(ProgramFault::Compensation { argument: unquoted(arguments) })
        }
        (Some(word), _) => Err(ProgramFault::Frame { word }),
        (None, Some(word)) => Err(ProgramFault::Moves { word }),
        (None, None) => Err(ProgramFault::UnknownWord { word: shown(word) }),
    }
}

/// Words of which none stands in prose that is passed over: of Heidenhain with free words behind them, of Sinumerik, Okuma and macros.
#[rustfmt::skip]
const CONTROL_WORDS: [&str; 51] = [
    "ATRANS", "TRANS", "AROT", "ROT", "AMIRROR", "MIRROR", "ASCALE", "SCALE", "SUPA", "POS", "POSA", "SPOS", "MCALL", "EXTCALL",
    "TRAORI", "TRAFOOF", "TRANSMIT", "TRACYL", "CALL", "CYCL", "PLANE", "LBL", "L", "LN", "LP", "CC", "CR", "IF", "WHILE", "GOTO",
    "REPEAT", "GOTOF", "GOTOB", "GOTOC", "GOTOS", "RND", "CHR", "CHF", "APPR", "DEP", "CASE",
    "TCH", "FN", "FUNCTION", "DEF", "PGM", "SEL", "DECLARE", "SQL", "PRESET", "MODIN",
];

/// Returns whether a text for a control, in capitals, is known to move nothing: comments, and prose, which no control executes.
fn moves_nothing(text: &str) -> bool {
    text.split(';').all(|part| match without_comments(part) {
        Some(plain) => plain.trim().is_empty() || is_plain_prose(&plain),
        None => false,
    })
}

/// Returns a text without what stands in parentheses and brackets; `None` if one of them is not closed.
fn without_comments(text: &str) -> Option<String> {
    let mut plain = String::new();
    let mut depth = 0_usize;
    for character in text.chars() {
        match character {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.checked_sub(1)?,
            _ if depth == 0 => plain.push(character),
            _ => {}
        }
    }
    (depth == 0).then_some(plain)
}

/// Returns whether a text is prose: without signs of assignments and variables, codes and words of [`CONTROL_WORDS`], and with two words in
/// a row that no control has, for which any of them refuses the text as a block.
fn is_plain_prose(text: &str) -> bool {
    let is_sign =
        |c: char| !(c.is_alphanumeric() || c.is_whitespace() || ".,:!?'\"&+-*/°".contains(c));
    let is_code = |word: &str| {
        let number = word.strip_prefix("CYCLE");
        let number = number.or_else(|| word.strip_prefix(['G', 'M', 'O', 'T', 'N', 'L', 'P']));
        CONTROL_WORDS.contains(&word)
            || number.is_some_and(|number| number.starts_with(|c: char| c.is_ascii_digit()))
    };
    let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '.');
    if text.contains(is_sign) || words.any(is_code) {
        return false;
    }
    let is_plain = |word: &&str| {
        // A colon ends a label of Sinumerik, behind which a name is a call.
        let word = word.trim_matches(|c: char| !c.is_alphanumeric() && c != ':');
        word.chars().count() > 1
            && word.chars().all(char::is_alphabetic)
            && !is_word_of_sinumerik(word)
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    words.windows(2).any(|pair| pair.iter().all(is_plain))
}

/// Returns whether a word is a letter with a number.
fn is_word_of_block(word: &str) -> bool {
    let number = word.strip_prefix(|c: char| c.is_ascii_alphabetic());
    number.is_some_and(|number| number.parse::<f64>().is_ok())
}

/// Returns the words and numbers among arguments.
fn parts(arguments: &str) -> impl Iterator<Item = &str> {
    arguments.split([' ', ',', '\t', '(', ')', '=']).filter(|part| !part.is_empty())
}

/// Refuses a motion among the arguments of a word. It stands there if the end of a line was lost.
///
/// # Errors
/// If there is a motion.
fn refuse_motions(word: &str, arguments: &str) -> Result<(), ProgramFault> {
    let upper = arguments.to_ascii_uppercase();
    match upper.contains('/')
        || parts(&upper).any(|part| {
            POSITION_WORDS.contains(&part) || part.starts_with("GO") && MOTION_WORDS.contains(&part)
        }) {
        true => Err(ProgramFault::Swallowed { word: word.to_owned() }),
        false => Ok(()),
    }
}

/// Returns whether a statement is a block of G-code: letters, each with a number.
fn is_g_code(statement: &str) -> bool {
    statement.split(' ').all(is_word_of_block)
}

/// Returns whether a word that could have an effect has none with these arguments.
fn is_inert_with(word: &str, arguments: &str) -> bool {
    let is = |word: &str| arguments.eq_ignore_ascii_case(word);
    let numbers = || arguments.split(',').map(number).collect::<Result<Vec<f64>, ProgramFault>>();
    match word {
        "OPSKIP" => is("OFF"),
        // The side of the contour and a register of the control.
        "CUTCOM" => {
            let known = ["ON", "OFF", "LEFT", "RIGHT", "NORMPS", "XYPLAN", "YZPLAN", "ZXPLAN"];
            let upper = arguments.to_ascii_uppercase();
            upper
                .split(',')
                .map(str::trim)
                .all(|word| known.contains(&word) || number(word).is_ok())
        }
        // The tool that is fetched for the next change.
        "SELECT" => {
            arguments.split(',').next().is_some_and(|word| word.trim().eq_ignore_ascii_case("TOOL"))
        }
        "TRNTYP" => {
            let mut words = arguments.split(',').map(str::trim);
            words.next().is_some_and(|word| word.eq_ignore_ascii_case("WORLD"))
                && words.all(|word| number(word).is_ok_and(|value| value == 0.0))
        }
        // The rows of the identity, each with a coordinate of the origin.
        "CSYS" => numbers().is_ok_and(|values| {
            values == [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        }),
        "TRACUT" | "COPY" => is("NOMORE"),
        "MODE" => is("ABSOL") || is("MILL"),
        "ORIGIN" | "TRANS" | "THICK" => {
            numbers().is_ok_and(|values| values.iter().all(|v| *v == 0.0))
        }
        // The part's own coordinates: origin, x axis, y axis.
        "MSYS" => {
            numbers().is_ok_and(|values| values == [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests;
