//! A program of any kind: CL data, or G-code on a machine.

use super::file::has_ending;
use super::{BodyFrame, JobError, JobGap, RevolvedBody};
use crate::check::MoveRequest;
use crate::gcode::{ControlRules, ControlSetup, SubprogramFile, SubprogramLine};
use crate::machine::{Machine, Mover, Reference, Relation, Side};
use crate::program::{ProgramFile, read_text};
use crate::{ClData, Gap, MachineProgram, Move, ProgramError, ToolSelection, ToolUse};
use std::collections::HashMap;
use std::iter;
use std::path::{Path, PathBuf};
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::{FileKind, Pose, Unit, read_text_file};

/// The machine of G-code for which none is named.
pub const DEFAULT_MACHINE: &str = "3-axis";

/// A program that was read, and of G-code each reading.
#[derive(Debug)]
pub enum Program {
    /// Positions of the tip with the axis: CL data per tool change, at least one.
    Locations(Vec<ClData>),
    /// G-code on a machine, as each control reads it: at least one reading.
    Machine(Vec<MachineProgram>),
}

/// The moves of one block or of the way to one cutter location.
pub(super) struct BlockMoves {
    /// Number of the tool in the spindle.
    pub(super) tool: Option<u32>,
    /// The moves, one after the other, for each request.
    pub(super) frames: Vec<Vec<Move>>,
}

impl Program {
    /// Makes a program of poses, one after the other in feed, in the frame of the part and in `unit`. Findings count them as
    /// lines from 1. Poses and isometries are both taken:
    ///
    /// ```
    /// # use nalgebra::{Isometry3, Translation3};
    /// # use touchoff_verify::Program;
    /// # use touchoff::Unit;
    /// let down = [10.0, 5.0, 0.0].map(|z| Isometry3::translation(0.0, 0.0, z));
    /// let program = Program::from_poses("plunge", Unit::Millimetre, down)?;
    /// assert_eq!(program.tools()[0].number, None);
    /// # Ok::<(), touchoff_verify::job::JobError>(())
    /// ```
    ///
    /// # Errors
    /// If there are fewer than two poses, if an isometry is no pose, or if the motion between two of them is ambiguous.
    pub fn from_poses<P>(
        name: &str,
        unit: Unit,
        poses: impl IntoIterator<Item = P>,
    ) -> Result<Program, JobError>
    where
        P: TryInto<Pose>,
        P::Error: Into<JobError>,
    {
        let poses = poses.into_iter().map(|pose| pose.try_into().map(|pose| (pose, false)));
        let poses: Vec<(Pose, bool)> = poses.collect::<Result<_, _>>().map_err(Into::into)?;
        let program = ClData::new(name, Some(unit), poses)?;
        program.check_motions()?;
        Ok(Program::Locations(vec![program]))
    }

    /// Reads a program from its file. G-code without a machine runs on three axes.
    ///
    /// # Errors
    /// If the program or the machine cannot be read, a motion is not possible on the machine, or a machine or rules of a control
    /// are given for positions.
    pub fn read(
        file: &Path,
        machine: Option<&Path>,
        setup: &ControlSetup,
    ) -> Result<Program, JobError> {
        Program::of_content(ProgramFile::read(file)?, file, machine, setup)
    }

    /// Makes the program of a file that was read, as [`Program::read`] does.
    ///
    /// # Errors
    /// As for [`Program::read`].
    pub(super) fn of_content(
        content: ProgramFile,
        file: &Path,
        machine: Option<&Path>,
        setup: &ControlSetup,
    ) -> Result<Program, JobError> {
        let is_plain = machine.is_none() && setup.rules == ControlRules::default();
        match content {
            ProgramFile::Gcode(text) => {
                let machine = read_machine(machine.unwrap_or(Path::new(DEFAULT_MACHINE)))?;
                Program::gcode(&file.display().to_string(), text, machine, setup)
            }
            ProgramFile::Locations(programs) if is_plain => Ok(Program::Locations(programs)),
            ProgramFile::Locations(_) => Err(JobError::MachineForPositions),
        }
    }

    /// Reads a program from the content of a file: CL data, or G-code, for which the machine and the setup count. `name` is the
    /// program's name in messages.
    ///
    /// # Errors
    /// If a line is refused, or a motion is not possible on the machine.
    pub fn parse(
        content: impl AsRef<[u8]>,
        name: &str,
        machine: Machine,
        setup: &ControlSetup,
    ) -> Result<Program, JobError> {
        match ProgramFile::parse(content, name)? {
            ProgramFile::Locations(programs) => Ok(Program::Locations(programs)),
            ProgramFile::Gcode(text) => Program::gcode(name, text, machine, setup),
        }
    }

    /// Interprets G-code on a machine. `name` is the program's name in messages.
    ///
    /// # Errors
    /// As for [`MachineProgram::readings`].
    fn gcode(
        name: &str,
        text: String,
        machine: Machine,
        setup: &ControlSetup,
    ) -> Result<Program, JobError> {
        Ok(Program::Machine(MachineProgram::readings(name, text, machine, setup)?))
    }

    /// Returns the program's name in messages.
    pub fn name(&self) -> &str {
        match self {
            Program::Locations(programs) => programs[0].name(),
            Program::Machine(readings) => readings[0].name(),
        }
    }

    /// Returns the name of a file: that of the program, or by its [number](crate::gcode::SubprogramLine::file) of a file of subprograms.
    pub fn file_name(&self, number: usize) -> &str {
        self.readings().first().map_or(self.name(), |program| program.file_name(number))
    }

    /// Names a line in a file of subprograms, for the end of a sentence; empty without one.
    pub(super) fn name_within(&self, place: Option<SubprogramLine>) -> String {
        self.readings().first().map_or(String::new(), |program| program.name_within(place))
    }

    /// Returns the readings of G-code; none for positions, which have one meaning.
    pub fn readings(&self) -> &[MachineProgram] {
        match self {
            Program::Locations(_) => &[],
            Program::Machine(readings) => readings,
        }
    }

    /// Returns the machine of G-code.
    pub fn machine(&self) -> Option<&Machine> {
        Some(self.readings().first()?.machine())
    }

    /// Returns the number of readings: 1 for positions.
    pub fn reading_count(&self) -> usize {
        self.readings().len().max(1)
    }

    /// Names the readings for which something holds; `None` if it holds for all.
    pub fn under(&self, holds: &[usize]) -> Option<String> {
        let readings = self.readings();
        let holds: Vec<_> =
            holds.iter().filter_map(|index| Some(readings.get(*index)?.assumed())).collect();
        MachineProgram::under(readings, &holds)
    }

    /// Checks that G-code is read to its end in every reading. A job checks it up to the line that is not read, and gives no verdict.
    ///
    /// # Errors
    /// If a line stops the interpreter.
    pub fn check_complete(&self) -> Result<(), JobError> {
        for reading in self.readings() {
            reading.check_complete()?;
        }
        Ok(())
    }

    /// Returns what the program leaves open, whatever it is checked against.
    pub fn gaps(&self) -> Vec<Gap> {
        match self {
            Program::Locations(programs) => tool_changes(programs).into_iter().collect(),
            Program::Machine(readings) => MachineProgram::gaps(readings),
        }
    }

    /// Returns whether the program can turn the tool axis.
    pub fn turns_axis(&self) -> bool {
        match self.machine() {
            Some(machine) => machine.axes().iter().any(|axis| axis.letter.is_rotary()),
            None => true,
        }
    }

    /// Returns the tools that the program uses, each with the number of its motions in the first reading that has any. A tool of which
    /// no motion can be checked has none.
    pub fn tools(&self) -> Vec<ToolUse> {
        let mut tools: Vec<ToolUse> = Vec::new();
        // Where the tool of a number is in the list.
        let mut places: HashMap<Option<u32>, usize> = HashMap::new();
        let mut place_of = |used: ToolUse, tools: &mut Vec<ToolUse>| {
            *places.entry(used.number).or_insert_with(|| {
                tools.push(used);
                tools.len() - 1
            })
        };
        let summaries = || self.readings().iter().map(MachineProgram::summary);
        for used in summaries().flat_map(|summary| &summary.tools) {
            place_of(*used, &mut tools);
        }
        for (number, block) in summaries().flat_map(|summary| &summary.unchecked_tools) {
            // An empty spindle has no tool that could be missing.
            if *number != 0 {
                let used = ToolUse { number: Some(*number), line: block.line, motions: 0 };
                place_of(used, &mut tools);
            }
        }
        for program in self.locations(ToolSelection::All) {
            let (line, motions) = (program.locations[0].line, program.locations.len());
            let used = ToolUse { number: program.tool, line, motions: 0 };
            let place = place_of(used, &mut tools);
            tools[place].motions += motions;
        }
        tools
    }

    /// Returns the number of motions, those of all readings together.
    pub fn motions(&self) -> usize {
        let summaries = self.readings().iter().map(MachineProgram::summary);
        let tools = summaries.flat_map(|summary| &summary.tools);
        let locations = self.locations(ToolSelection::All).map(|program| program.locations.len());
        tools.map(|tool| tool.motions).chain(locations).sum()
    }

    /// Checks that the program is meant for a tool and the part's unit. Returns the line of a `CUTTER` that does not describe a tool
    /// of this kind, and is therefore not compared with it.
    ///
    /// # Errors
    /// If its unit, poses or cutter do not fit.
    pub fn check_tool(
        &self,
        motions: ToolSelection,
        info: &ToolInfo,
        unit: Unit,
    ) -> Result<Option<usize>, ProgramError> {
        let mut not_compared = None;
        for program in self.locations(motions) {
            program.check_unit(unit)?;
            program.check_poses(info)?;
            not_compared = not_compared.or(program.check_cutter(info, unit)?);
        }
        Ok(not_compared)
    }

    /// Returns the CL data of a tool; none of G-code.
    fn locations(&self, motions: ToolSelection) -> impl Iterator<Item = &ClData> {
        let programs = match self {
            Program::Locations(programs) => &programs[..],
            Program::Machine(_) => &[],
        };
        programs.iter().filter(move |program| motions.contains(program.tool))
    }

    /// Returns the moves of a tool in a reading, in the frame of a link of the table (`None` for the part) and in a unit.
    ///
    /// # Errors
    /// If the machine has no such link.
    ///
    /// # Panics
    /// If there is no such reading.
    pub fn moves<'a>(
        &'a self,
        reading: usize,
        motions: ToolSelection,
        symmetry: Symmetry,
        link: Option<usize>,
        unit: Unit,
    ) -> Result<Box<dyn Iterator<Item = Move> + 'a>, JobError> {
        Ok(match self {
            Program::Locations(_) => {
                let programs = self.locations(motions);
                Box::new(programs.flat_map(move |program| Move::all(program, symmetry)))
            }
            Program::Machine(readings) => Box::new(readings[reading].moves(motions, link, unit)?),
        })
    }

    /// Returns the moves of a reading in the order of the program, for each request, of which positions have that of the tool at the
    /// part alone. `symmetry` is that of the tool with a
    /// number in positions, of which a tool that is not known makes none. `restarts` is set if each tool begins with a rest at its
    /// first position.
    pub(super) fn blocks<'a>(
        &'a self,
        reading: usize,
        requests: &[MoveRequest],
        unit: Unit,
        restarts: bool,
        symmetry: impl Fn(Option<u32>) -> Option<Symmetry> + 'a,
    ) -> Result<Box<dyn Iterator<Item = BlockMoves> + 'a>, JobError> {
        Ok(match self {
            // Positions are in the frame of the part, with which all bodies of their job move.
            Program::Locations(programs) => Box::new(programs.iter().flat_map(move |program| {
                let tool = program.tool;
                let moves =
                    symmetry(tool).into_iter().flat_map(|symmetry| Move::all(program, symmetry));
                moves.map(move |step| BlockMoves { tool, frames: vec![vec![step]] })
            })),
            Program::Machine(readings) => {
                let blocks = readings[reading]
                    .blocks(requests, unit, restarts, move |number| symmetry(number).is_some())?;
                Box::new(blocks.map(|(tool, frames)| BlockMoves { tool, frames }))
            }
        })
    }

    /// Returns the request for the moves of the tools, or of a body of the machine, at a body with a frame, in a reading.
    ///
    /// # Errors
    /// If the program is not for a machine, or that lacks a link.
    pub(super) fn request(
        &self,
        reading: usize,
        revolved: Option<&RevolvedBody<'_>>,
        frame: BodyFrame,
    ) -> Result<MoveRequest, JobError> {
        match (revolved, frame) {
            (None, BodyFrame::Part) => return Ok(MoveRequest::AtPart),
            (None, BodyFrame::Table(link)) => return Ok(MoveRequest::AtTable(link)),
            _ => {}
        }
        let Some(machine) = self.readings().get(reading).map(MachineProgram::machine) else {
            return Err(JobError::BodiesForPositions);
        };
        let mover = match revolved {
            None => Mover::Tool,
            Some(body) => Mover::Body { link: body.link, mount: body.mount },
        };
        let reference = match frame {
            BodyFrame::Part => Reference::Workpiece,
            BodyFrame::Table(_) | BodyFrame::Machine(_) => Reference::Link(frame.link(machine)),
        };
        Ok(MoveRequest::Bodies {
            relation: Box::new(Relation::new(machine, mover, reference)?),
            is_in_part: matches!(frame, BodyFrame::Table(_)),
        })
    }

    /// Checks that the bodies of the machine have a place in all readings: that the origin of the part and the lengths of all tools
    /// are known.
    ///
    /// # Errors
    /// If one of them is not stated.
    pub(super) fn check_places(&self) -> Result<(), JobError> {
        for program in self.readings() {
            if program.part_origin().is_none() {
                return Err(JobError::NoPlace);
            }
            let mut tools = program.summary().tools.iter();
            if let Some(tool) = tools.find(|tool| program.tool_length(tool.number).is_none()) {
                let line = tool.line;
                return Err(match tool.number {
                    Some(number) => JobError::NoLength { number, line },
                    None => JobError::NoToolForLength { line },
                });
            }
        }
        Ok(())
    }

    /// Returns the link of the table that moves with an axis, or `base`; `None` for the one that carries the part.
    ///
    /// # Errors
    /// If the program is not for a machine, its table has no such axis, or the part is turned in its frame.
    pub fn link(&self, axis: &str) -> Result<Option<usize>, JobError> {
        let Some(program) = self.readings().first() else {
            return Err(JobError::MovesWithoutMachine);
        };
        // Links are numbered from the base on.
        let axes = program.machine().axes().iter().filter(|axis| axis.side == Side::Table);
        let links: Vec<String> =
            iter::once("base".to_owned()).chain(axes.map(|axis| axis.letter.to_string())).collect();
        match links.iter().position(|link| link == axis) {
            // The last link carries the part.
            Some(link) if link + 1 == links.len() => Ok(None),
            // The frame of another link is that of the machine, in which the part has to have a place.
            Some(link) => match program.part_origin() {
                Some(origin) if origin[3..] == [0.0; 3] => Ok(Some(link)),
                _ => Err(JobError::MovesWithoutOrigin),
            },
            None => Err(JobError::MovesWithNothing),
        }
    }
}

/// Returns the motions to the first position after a tool change, which the program does not state.
fn tool_changes(programs: &[ClData]) -> Option<Gap> {
    let [_, changed @ ..] = programs else { return None };
    let line = changed.first()?.locations[0].line;
    let count = changed.len();
    let gap = JobGap::ToolChange { count, line };
    Some(Gap::said(line, gap.code(), gap.to_string()))
}

/// Reads a control by its name, or from a file in TOML.
///
/// # Errors
/// If there is no such control, or its file is refused.
pub fn read_control(name: &Path) -> Result<ControlRules, JobError> {
    Ok(match toml_text(name)? {
        Some((text, file)) => ControlRules::parse(&text, &file)?,
        None => ControlRules::named(&name.to_string_lossy())?,
    })
}

/// Reads files of subprograms.
///
/// # Errors
/// If one cannot be read, or is no text; if two have one name, by which controls find them.
pub(super) fn read_subprograms(files: &[PathBuf]) -> Result<Vec<SubprogramFile>, JobError> {
    let mut subprograms: Vec<SubprogramFile> = Vec::new();
    for file in files {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let added = SubprogramFile { name, text: read_text(file)?.into() };
        // A call can leave out the ending.
        let stem = added.stem();
        if subprograms.iter().any(|known| known.stem().eq_ignore_ascii_case(stem)) {
            return Err(JobError::SecondSubprogram { name: stem.to_owned() });
        }
        subprograms.push(added);
    }
    Ok(subprograms)
}

/// Reads a machine by its name, or from a file in TOML.
///
/// # Errors
/// If there is no such machine, or its file is refused.
pub fn read_machine(name: &Path) -> Result<Machine, JobError> {
    Ok(match toml_text(name)? {
        Some((text, _)) => Machine::parse(&text, name)?,
        None => Machine::named(&name.to_string_lossy())?,
    })
}

/// Returns the text of a TOML file that is named, and its name for messages; `None` for another name.
///
/// # Errors
/// If the file cannot be read.
fn toml_text(name: &Path) -> Result<Option<(String, String)>, JobError> {
    if !has_ending(name, "toml") {
        return Ok(None);
    }
    let file = name.display().to_string();
    match read_text_file(name, FileKind::Settings) {
        Ok(text) => Ok(Some((text, file))),
        Err(source) => Err(JobError::Unreadable { file, source }),
    }
}
