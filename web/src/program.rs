//! Programs: read from a file, and the motions of their tools.

use crate::error::EngineError;
use serde::Serialize;
use touchoff::Unit;
use touchoff::tool::ToolInfo;
use touchoff_verify::gcode::ControlSetup;
use touchoff_verify::machine::Machine;
use touchoff_verify::{Move, Program, ToolSelection, ToolUse};

/// Greatest number of motions that the page holds in memory.
const MAX_MOTIONS: usize = 200_000;

/// The facts about a program that the page shows before it is checked.
#[derive(Debug, Serialize)]
pub(crate) struct ProgramFacts {
    /// Name of the machine, for G-code.
    machine: Option<String>,
    /// The tools of which motions can be checked, in order.
    tools: Vec<ToolFacts>,
    /// Sentences about what allows no verdict, each with its line.
    open: Vec<String>,
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
pub(crate) fn read(bytes: &[u8], name: &str, machine: &str) -> Result<Program, EngineError> {
    // A name has one line.
    let machine = match machine.contains('\n') {
        true => Machine::parse(machine, "the machine's file")?,
        false => Machine::named(machine)?,
    };
    let program = Program::parse(bytes, name, machine, &ControlSetup::default())?;
    let motions = program.tools().iter().map(|tool| tool.motions).sum();
    if motions > MAX_MOTIONS {
        let name = name.to_owned();
        return Err(EngineError::LongProgram { name, motions, limit: MAX_MOTIONS });
    }
    Ok(program)
}

/// Returns the facts that the page shows.
pub(crate) fn facts(program: &Program) -> ProgramFacts {
    let mut notes = Vec::new();
    if let Program::Locations(programs) = program {
        let ignored: usize = programs.iter().map(|program| program.ignored.len()).sum();
        if ignored > 0 {
            notes.push(format!("{ignored} words that cannot move the tool were passed over"));
        }
    }
    let readings = program.readings();
    if readings.len() > 1 {
        notes.push(format!(
            "controls read this program in {} ways; the page shows that of {}, and checks all",
            readings.len(),
            readings[0].assumed()
        ));
    }
    let (open, said): (Vec<_>, Vec<_>) = program.gaps().into_iter().partition(|gap| gap.is_open());
    notes.extend(said.iter().map(ToString::to_string));
    let tools = program.tools().into_iter().filter(|tool| tool.motions > 0);
    ProgramFacts {
        machine: program.machine().map(|machine| machine.name().to_owned()),
        tools: tools.map(|tool| ToolFacts { number: tool.number, motions: tool.motions }).collect(),
        open: open.iter().map(ToString::to_string).collect(),
        notes,
    }
}

/// Returns the motions of all tools in the order of the program, as its first reading has them, in the frame and unit of the part.
/// `tool` returns the tool with a number in the program.
///
/// # Errors
/// Fails if a number has no tool, and if unit, poses or cutter of the program do not fit.
pub(crate) fn moves<'a>(
    program: &Program,
    tool: impl Fn(Option<u32>) -> Option<&'a ToolInfo>,
    unit: Unit,
) -> Result<Vec<Move>, EngineError> {
    for ToolUse { number, .. } in program.tools().into_iter().filter(|used| used.motions > 0) {
        let info = tool(number).ok_or(EngineError::MissingTool(number))?;
        program.check_tool(ToolSelection::Number(number), info, unit)?;
    }
    Ok(match program {
        Program::Locations(programs) => {
            let tools = programs.iter().filter_map(|program| Some((program, tool(program.tool)?)));
            tools.flat_map(|(program, info)| Move::all(program, info.symmetry)).collect()
        }
        Program::Machine(readings) => {
            // A tool of which no motion can be checked may rest somewhere.
            readings[0].moves_in_order(unit).filter(|step| tool(step.tool).is_some()).collect()
        }
    })
}
