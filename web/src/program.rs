//! Programs: read from a file, and the motions of one tool.

use crate::error::EngineError;
use serde::Serialize;
use touchoff::Unit;
use touchoff::tool::ToolInfo;
use touchoff_verify::gcode::{ControlSetup, Spindle};
use touchoff_verify::machine::Machine;
use touchoff_verify::program::ProgramFile;
use touchoff_verify::{ClData, MachineProgram, Move, ToolSelection};

/// Greatest number of motions that the page holds in memory.
pub(crate) const MAX_MOTIONS: usize = 200_000;

/// A program that was read.
#[derive(Debug)]
pub(crate) enum OpenProgram {
    /// Positions, a program per tool change.
    Locations(Vec<ClData>),
    /// G-code on a machine, in the readings of all controls that are known.
    Machine(Vec<MachineProgram>),
}

/// The facts about a program that the page shows.
#[derive(Debug, Serialize)]
pub(crate) struct ProgramFacts {
    /// Name of the machine, for G-code.
    machine: Option<String>,
    /// The tools that the program uses, in order.
    tools: Vec<ToolFacts>,
    /// Sentences about what allows no verdict, each with its line.
    open: Vec<String>,
    /// Sentences about what is wrong whatever the part is.
    faults: Vec<String>,
    /// Sentences about what is not checked.
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct ToolFacts {
    number: Option<u32>,
    motions: usize,
}

/// Reads a program. `machine` is the name of a machine that comes with the library, or the text of a machine's file; it counts
/// for G-code only.
///
/// # Errors
/// Fails if a line is refused, if the machine is unknown, or for too many motions.
pub(crate) fn read(bytes: &[u8], name: &str, machine: &str) -> Result<OpenProgram, EngineError> {
    let program = match ProgramFile::parse(bytes, name)? {
        ProgramFile::Locations(programs) => OpenProgram::Locations(programs),
        ProgramFile::Gcode(text) => {
            // A name has one line.
            let machine = match machine.contains('\n') {
                true => Machine::parse(machine, "the machine's file")?,
                false => Machine::named(machine)?,
            };
            let setup = ControlSetup::default();
            OpenProgram::Machine(MachineProgram::readings(name, text, machine, &setup)?)
        }
    };
    let motions = program.tools().iter().map(|tool| tool.motions).sum();
    if motions > MAX_MOTIONS {
        return Err(EngineError::LongProgram { name: name.to_owned(), motions });
    }
    Ok(program)
}

impl OpenProgram {
    fn tools(&self) -> Vec<ToolFacts> {
        match self {
            OpenProgram::Locations(programs) => {
                let mut tools: Vec<ToolFacts> = Vec::new();
                for program in programs {
                    let motions = program.locations.len();
                    match tools.iter_mut().find(|tool| tool.number == program.tool) {
                        Some(tool) => tool.motions += motions,
                        None => tools.push(ToolFacts { number: program.tool, motions }),
                    }
                }
                tools
            }
            OpenProgram::Machine(readings) => {
                let tools = readings[0].summary().tools.iter();
                tools.map(|tool| ToolFacts { number: tool.number, motions: tool.motions }).collect()
            }
        }
    }

    /// Returns the facts that the page shows.
    pub(crate) fn facts(&self) -> ProgramFacts {
        let (mut faults, mut notes, mut open) = (Vec::new(), Vec::new(), Vec::new());
        let machine = match self {
            OpenProgram::Locations(programs) => {
                let ignored: usize = programs.iter().map(|program| program.ignored.len()).sum();
                if ignored > 0 {
                    notes.push(format!(
                        "{ignored} words that cannot move the tool were passed over"
                    ));
                }
                None
            }
            OpenProgram::Machine(readings) => {
                let summary = readings[0].summary();
                faults.extend(summary.other_lengths.iter().map(|(line, register, tool)| {
                    format!("line {line}: T{tool} feeds with the length offset H{register}, which has another length")
                }));
                let starts = summary.states_spindle();
                for (line, _, spindle) in &summary.spindle {
                    faults.extend(match spindle {
                        Spindle::NotStated if starts => {
                            Some(format!("line {line}: feeds with the spindle off"))
                        }
                        Spindle::Stopped => {
                            Some(format!("line {line}: feeds with the spindle off"))
                        }
                        Spindle::WithoutSpeed => {
                            Some(format!("line {line}: feeds without a speed S of the spindle"))
                        }
                        Spindle::CounterClockwise => Some(format!(
                            "line {line}: feeds with the spindle turning counter-clockwise"
                        )),
                        _ => None,
                    });
                }
                faults.extend(summary.limits.iter().map(|(line, found)| {
                    format!("line {line}: {} leaves its limit of {}", found.letter, found.limit)
                }));
                notes.extend(summary.singular.iter().map(|(line, pass)| {
                    format!(
                        "line {line}: {} turns by {:.0}° while the tool axis hardly moves: a singular pass",
                        pass.letter, pass.turn
                    )
                }));
                if readings.len() > 1 {
                    open.push(format!(
                        "controls read this program in {} ways; the page shows that of {}",
                        readings.len(),
                        readings[0].assumed()
                    ));
                }
                for gap in MachineProgram::gaps(readings) {
                    let list = if gap.is_open { &mut open } else { &mut notes };
                    list.push(format!("line {}: {}", gap.line, gap.reason));
                }
                Some(readings[0].machine().name().to_owned())
            }
        };
        ProgramFacts { machine, tools: self.tools(), open, faults, notes }
    }

    /// Returns the motions of the tool with a number in the program, in the frame and unit of the part.
    ///
    /// # Errors
    /// Fails if unit, poses or cutter of the program do not fit.
    pub(crate) fn moves(
        &self,
        number: Option<u32>,
        (info, unit): (&ToolInfo, Unit),
    ) -> Result<Vec<Move>, EngineError> {
        match self {
            OpenProgram::Locations(programs) => {
                let mut moves = Vec::new();
                for program in programs.iter().filter(|program| program.tool == number) {
                    program.check_unit(unit)?;
                    program.check_poses(info)?;
                    program.check_cutter(info, unit)?;
                    moves.extend(Move::all(program, info.symmetry));
                }
                Ok(moves)
            }
            OpenProgram::Machine(readings) => {
                Ok(readings[0].moves(ToolSelection::Number(number), None, unit)?.collect())
            }
        }
    }
}
