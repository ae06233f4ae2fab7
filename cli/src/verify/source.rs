//! The program that is checked: positions, or G-code on a machine.

use super::CheckedPair;
use super::job::Job;
use super::machine::MachineFinding;
use super::tools::{self, ProgramTool};
use crate::failure::Failure;
use crate::program::{self, read_control, read_machine};
use std::iter;
use std::path::Path;
use touchoff::Unit;
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::machine::{Machine, Side};
use touchoff_verify::program::ProgramFile;
use touchoff_verify::{ClData, Gap, MachineProgram, Move, ToolSelection};

/// The machine of G-code for which none is named.
pub(crate) const DEFAULT_MACHINE: &str = "3-axis";

/// A program that was read.
pub(crate) enum CheckedProgram {
    /// Positions of the tip with the axis, a program per tool change.
    Locations(Vec<ClData>),
    /// G-code, in each of its readings.
    Machine(Vec<MachineProgram>),
}

impl CheckedProgram {
    /// Reads the program of a job.
    ///
    /// # Errors
    /// As for [`CheckedProgram::open`], or if a single program of positions has a motion that is not known.
    pub(super) fn read(job: &Job) -> Result<CheckedProgram, Failure> {
        let mut rules = match &job.control {
            Some(control) => read_control(Path::new(control))?,
            None => ControlRules::default(),
        };
        if let Some(left_out) = job.block_delete {
            let choice = if left_out { Choice::LeftOut } else { Choice::Executed };
            rules = rules.with(Rule::OptionalBlocks, choice);
        }
        let setup = ControlSetup {
            work_offsets: job.work_offsets,
            lengths: tools::lengths(&job.tools),
            rules,
            ..ControlSetup::default()
        };
        let machine = job.machine.as_deref().map(Path::new);
        let program = CheckedProgram::open(&job.program, machine, &setup)?;
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
        setup: &ControlSetup,
    ) -> Result<CheckedProgram, Failure> {
        let is_plain = machine.is_none() && setup.rules == ControlRules::default();
        let text = match (ProgramFile::read(file)?, is_plain) {
            (ProgramFile::Gcode(text), _) => text,
            (ProgramFile::Locations(programs), true) => {
                return Ok(CheckedProgram::Locations(programs));
            }
            (ProgramFile::Locations(_), false) => {
                return Err(Failure::Usage(
                    "a machine or a control is for G-code: this program states positions of the tip",
                ));
            }
        };
        let machine = read_machine(machine.unwrap_or(Path::new(DEFAULT_MACHINE)))?;
        let name = file.display().to_string();
        Ok(CheckedProgram::Machine(MachineProgram::readings(&name, text, machine, setup)?))
    }

    /// Returns the readings of G-code; none for positions, which have one meaning.
    pub(crate) fn readings(&self) -> &[MachineProgram] {
        match self {
            CheckedProgram::Locations(_) => &[],
            CheckedProgram::Machine(readings) => readings,
        }
    }

    /// Returns the machine of G-code.
    pub(crate) fn machine(&self) -> Option<&Machine> {
        Some(self.readings().first()?.machine())
    }

    /// Returns the number of readings.
    pub(super) fn reading_count(&self) -> usize {
        self.readings().len().max(1)
    }

    /// Names the readings for which something holds; `None` if it holds for all.
    pub(super) fn under(&self, holds: &[usize]) -> Option<String> {
        let readings = self.readings();
        let holds: Vec<_> =
            holds.iter().filter_map(|index| Some(readings.get(*index)?.assumed())).collect();
        MachineProgram::under(readings, &holds)
    }

    /// Returns what the program leaves open.
    pub(super) fn gaps(&self) -> Vec<Gap> {
        match self {
            CheckedProgram::Locations(programs) => tool_changes(programs).into_iter().collect(),
            CheckedProgram::Machine(readings) => MachineProgram::gaps(readings),
        }
    }

    /// Returns the findings about the machine, each with the index of its reading.
    pub(super) fn machine_findings<'a>(
        &self,
        file: &'a str,
        tools: &[ProgramTool],
    ) -> Vec<(usize, MachineFinding<'a>)> {
        let all = |(index, program)| {
            let findings = MachineFinding::all(program, file, tools).into_iter();
            findings.map(move |finding| (index, finding))
        };
        self.readings().iter().enumerate().flat_map(all).collect()
    }

    /// Returns whether the program can turn the tool axis.
    pub(super) fn turns_axis(&self) -> bool {
        match self {
            CheckedProgram::Locations(_) => true,
            CheckedProgram::Machine(_) => self
                .machine()
                .is_some_and(|machine| machine.axes().iter().any(|axis| axis.letter.is_rotary())),
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
            CheckedProgram::Machine(readings) => {
                let mut numbers = Vec::new();
                let summaries = || readings.iter().map(MachineProgram::summary);
                let checked = summaries().flat_map(|summary| &summary.tools);
                let others = summaries().flat_map(|summary| &summary.unchecked_tools);
                // An empty spindle has no tool that could be missing.
                let others = others.map(|(number, _)| *number).filter(|number| *number != 0);
                for number in checked.map(|tool| tool.number).chain(others.map(Some)) {
                    if !numbers.contains(&number) {
                        numbers.push(number);
                    }
                }
                numbers
            }
        }
    }

    /// Returns the number of motions.
    pub(super) fn motions(&self) -> usize {
        match self {
            CheckedProgram::Locations(programs) => {
                programs.iter().map(|program| program.locations.len()).sum()
            }
            CheckedProgram::Machine(readings) => {
                let tools = readings.iter().flat_map(|program| &program.summary().tools);
                tools.map(|tool| tool.motions).sum()
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
    fn programs(&self, selection: ToolSelection) -> impl Iterator<Item = &ClData> {
        let programs = match self {
            CheckedProgram::Locations(programs) => &programs[..],
            CheckedProgram::Machine(_) => &[],
        };
        programs.iter().filter(move |program| selection.contains(program.tool))
    }

    /// Returns the motions of a tool in a reading, relative to a link of the table or to the part.
    pub(crate) fn moves<'a>(
        &'a self,
        reading: usize,
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
            CheckedProgram::Machine(readings) => {
                Box::new(readings[reading].moves(tool.selection, link, unit)?)
            }
        })
    }

    /// Returns all motions of a reading in the order of the program, each with its tool.
    pub(super) fn moves_in_order<'a>(
        &'a self,
        reading: usize,
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
            CheckedProgram::Machine(readings) => {
                Box::new(readings[reading].moves(ToolSelection::All, None, unit)?)
            }
        };
        Ok(Box::new(moves.filter_map(move |step| Some((tool_of(step.tool)?, step)))))
    }

    /// Returns the link of the table that moves with an axis, or `base`; `None` for the one that carries the part.
    ///
    /// # Errors
    /// If the program is not for a machine, its table has no such axis, or the part is turned in its frame.
    pub(super) fn link(&self, axis: &str, job: &Job) -> Result<Option<usize>, Failure> {
        let Some(machine) = self.machine() else {
            return Err(Failure::Usage("`moves_with` is for programs on a machine"));
        };
        let axes = machine.axes().iter().filter(|axis| axis.side == Side::Table);
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
        for pair in pairs.iter().filter(|pair| pair.is_part && pair.reading == 0) {
            program::print_approach(&pair.report, unit);
        }
        match self {
            CheckedProgram::Locations(programs) => program::print_ignored(programs),
            CheckedProgram::Machine(readings) => {
                let stated = self.machine().map_or("", Machine::name);
                match readings.len() {
                    1 => message!("machine: {stated}"),
                    count => message!("machine: {stated}, in {count} readings of the program"),
                }
            }
        }
    }
}

/// Returns the motions to the first position after a tool change, which the program does not state.
fn tool_changes(programs: &[ClData]) -> Option<Gap> {
    let [_, changed @ ..] = programs else { return None };
    let line = changed.first()?.locations[0].line;
    let count = changed.len();
    let plural = if count == 1 { "" } else { "s" };
    let reason = format!(
        "{count} motion{plural} to the first position after a tool change not checked, first to line {line}: only the machine \
         knows where they start"
    );
    Some(Gap::said(line, reason))
}
