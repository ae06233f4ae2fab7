//! The program that is checked: positions, or G-code on a machine.

use super::CheckedPair;
use super::job::Job;
use super::machine::MachineFinding;
use super::tools::{self, ProgramTool};
use crate::failure::Failure;
use crate::program::{self, read_machine};
use std::iter;
use std::path::Path;
use touchoff::gcode::ControlSetup;
use touchoff::machine::Side;
use touchoff::program::ProgramFile;
use touchoff::verify::{MachineProgram, Move, ToolSelection, UnknownMotions};
use touchoff::{Program, Unit};

/// The machine of G-code for which none is named.
pub(crate) const DEFAULT_MACHINE: &str = "3-axis";

/// A program that was read.
pub(crate) enum CheckedProgram {
    /// Positions of the tip with the axis, a program per tool change.
    Locations(Vec<Program>),
    /// G-code.
    Machine(Box<MachineProgram>),
}

impl CheckedProgram {
    /// Reads the program of a job.
    ///
    /// # Errors
    /// As for [`CheckedProgram::open`], or if a single program of positions has a motion that is not known.
    pub(super) fn read(job: &Job) -> Result<CheckedProgram, Failure> {
        let setup = ControlSetup {
            work_offsets: job.work_offsets,
            lengths: tools::lengths(&job.tools),
            block_delete: job.block_delete,
            ..ControlSetup::default()
        };
        let machine = job.machine.as_deref().map(Path::new);
        let program = CheckedProgram::open(&job.program, machine, setup)?;
        if let CheckedProgram::Locations(programs) = &program
            && let [program] = &programs[..]
        {
            program.check_motions()?;
        }
        Ok(program)
    }

    /// Reads a program. G-code without a machine runs on three axes.
    ///
    /// # Errors
    /// If the program or the machine cannot be read, a motion is not possible on the machine, or a machine is given for
    /// positions.
    pub(crate) fn open(
        file: &Path,
        machine: Option<&Path>,
        setup: ControlSetup,
    ) -> Result<CheckedProgram, Failure> {
        let text = match (ProgramFile::read(file)?, machine) {
            (ProgramFile::Gcode(text), _) => text,
            (ProgramFile::Locations(programs), None) => {
                return Ok(CheckedProgram::Locations(programs));
            }
            (ProgramFile::Locations(_), Some(_)) => {
                return Err(Failure::Usage(
                    "a machine is for G-code: this program states positions of the tip",
                ));
            }
        };
        let machine = read_machine(machine.unwrap_or(Path::new(DEFAULT_MACHINE)))?;
        let program = MachineProgram::new(&file.display().to_string(), text, machine, setup)?;
        Ok(CheckedProgram::Machine(Box::new(program)))
    }

    /// Returns the line of the first feed motion that cannot be checked.
    pub(super) fn unknown_feed(&self) -> Option<usize> {
        match self {
            CheckedProgram::Locations(_) => None,
            CheckedProgram::Machine(program) => program.summary().unknown?.feed_line,
        }
    }

    /// Returns the findings about the machine's axes.
    pub(super) fn machine_findings<'a>(&self, file: &'a str) -> Vec<MachineFinding<'a>> {
        match self {
            CheckedProgram::Locations(_) => Vec::new(),
            CheckedProgram::Machine(program) => MachineFinding::all(program, file),
        }
    }

    /// Returns whether the program can turn the tool axis.
    pub(super) fn turns_axis(&self) -> bool {
        match self {
            CheckedProgram::Locations(_) => true,
            CheckedProgram::Machine(program) => {
                program.machine().axes().iter().any(|axis| axis.letter.is_rotary())
            }
        }
    }

    /// Returns the numbers of the tools that the program uses.
    pub(super) fn tools(&self) -> Vec<Option<u32>> {
        match self {
            CheckedProgram::Locations(programs) => {
                let mut numbers = Vec::new();
                for program in programs {
                    if !numbers.contains(&program.tool) {
                        numbers.push(program.tool);
                    }
                }
                numbers
            }
            CheckedProgram::Machine(program) => {
                program.summary().tools.iter().map(|tool| tool.number).collect()
            }
        }
    }

    /// Returns the number of motions.
    pub(super) fn motions(&self) -> usize {
        match self {
            CheckedProgram::Locations(programs) => {
                programs.iter().map(|program| program.locations.len()).sum()
            }
            CheckedProgram::Machine(program) => {
                program.summary().tools.iter().map(|tool| tool.motions).sum()
            }
        }
    }

    /// Checks that the program is meant for a tool and the part's unit.
    ///
    /// # Errors
    /// If its unit, poses or cutter do not fit.
    pub(super) fn check(&self, tool: &ProgramTool, unit: Unit, file: &Path) -> Result<(), Failure> {
        self.programs(tool.selection)
            .try_for_each(|program| program::check(program, tool.tool().info(), unit, file))
    }

    /// Returns the programs of positions of a tool.
    fn programs(&self, selection: ToolSelection) -> impl Iterator<Item = &Program> {
        let programs = match self {
            CheckedProgram::Locations(programs) => &programs[..],
            CheckedProgram::Machine(_) => &[],
        };
        programs.iter().filter(move |program| selection.contains(program.tool))
    }

    /// Returns the motions of a tool relative to a link of the table, or to the part.
    pub(crate) fn moves<'a>(
        &'a self,
        tool: &ProgramTool,
        link: Option<usize>,
        unit: Unit,
    ) -> Result<Box<dyn Iterator<Item = Move> + 'a>, Failure> {
        Ok(match self {
            CheckedProgram::Locations(_) => {
                let symmetry = tool.tool().info().symmetry;
                let programs = self.programs(tool.selection);
                Box::new(programs.flat_map(move |program| Move::all(program, symmetry)))
            }
            CheckedProgram::Machine(program) => {
                Box::new(program.moves(tool.selection, link, unit)?)
            }
        })
    }

    /// Returns all motions in the order of the program, each with its tool.
    pub(super) fn moves_in_order<'a>(
        &'a self,
        tools: &'a [ProgramTool],
        unit: Unit,
    ) -> Result<Box<dyn Iterator<Item = (&'a ProgramTool, Move)> + 'a>, Failure> {
        let tool_of = |number: Option<u32>| {
            let is_its =
                |tool: &&ProgramTool| tool.selection == ToolSelection::All || tool.number == number;
            tools.iter().find(is_its)
        };
        let moves: Box<dyn Iterator<Item = Move>> = match self {
            CheckedProgram::Locations(programs) => {
                Box::new(programs.iter().flat_map(move |program| {
                    let tool = tool_of(program.tool);
                    let symmetry = tool.map(|tool| tool.tool().info().symmetry);
                    symmetry.into_iter().flat_map(|symmetry| Move::all(program, symmetry))
                }))
            }
            CheckedProgram::Machine(program) => {
                Box::new(program.moves(ToolSelection::All, None, unit)?)
            }
        };
        Ok(Box::new(moves.filter_map(move |step| Some((tool_of(step.tool)?, step)))))
    }

    /// Returns the link of the table that moves with an axis, or `base`; `None` for the one that carries the part.
    ///
    /// # Errors
    /// If the program is not for a machine, its table has no such axis, or the part is turned in its frame.
    pub(super) fn link(&self, axis: &str, job: &Job) -> Result<Option<usize>, Failure> {
        let CheckedProgram::Machine(program) = self else {
            return Err(Failure::Usage("`moves_with` is for programs on a machine"));
        };
        let axes = program.machine().axes().iter().filter(|axis| axis.side == Side::Table);
        let links: Vec<String> =
            iter::once("base".to_owned()).chain(axes.map(|axis| axis.letter.to_string())).collect();
        match links.iter().position(|link| link == axis) {
            // The last link carries the part.
            Some(link) if link + 1 == links.len() => Ok(None),
            Some(link) => match job.work_offsets[0] {
                Some(origin) if origin[3..] == [0.0; 3] => Ok(Some(link)),
                _ => Err(Failure::Usage(
                    "`moves_with` another axis than the part's needs the origin of G54 in `work_offsets`, without rotary \
                     offsets",
                )),
            },
            None => {
                Err(Failure::Usage("`moves_with` names an axis of the machine's table, or `base`"))
            }
        }
    }

    /// Prints what is known about the program before any finding.
    pub(super) fn print(&self, pairs: &[CheckedPair<'_>], unit: Unit) {
        for pair in pairs.iter().filter(|pair| pair.is_part) {
            program::print_approach(&pair.report, unit);
        }
        match self {
            CheckedProgram::Locations(programs) => {
                program::print_ignored(programs);
                print_tool_changes(programs);
            }
            CheckedProgram::Machine(program) => print_machine(program),
        }
    }
}

/// Prints the number of motions to the first position after a tool change, which the program does not state.
fn print_tool_changes(programs: &[Program]) {
    let [_, changed @ ..] = programs else { return };
    if let Some(first) = changed.first() {
        message!(
            "{} to the first position after a tool change not checked, first to line {}: only the machine knows where \
             they start",
            match changed.len() {
                1 => "1 motion".to_owned(),
                count => format!("{count} motions"),
            },
            first.locations[0].line
        );
    }
}

/// Prints the machine, the number of motions that were not checked, and notes.
fn print_machine(program: &MachineProgram) {
    let summary = program.summary();
    message!("machine: {}", program.machine().name());
    if let Some(UnknownMotions { count, line, .. }) = summary.unknown {
        message!(
            "{count} motion{} not checked, first at line {line}: only the machine knows where they start or end",
            if count == 1 { "" } else { "s" }
        );
    }
    for note in &summary.notes {
        message!("{note}");
    }
}
