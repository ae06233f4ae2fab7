//! G-code programs on a machine: the motions of the tool relative to the part, or to a body of the machine.
//!
//! ```text
//! text ──interpreter──▶ steps, program coordinates ──work offset, tool length──▶ joints ──chain──▶ moves
//! ```
//!
//! The frame of the part is that of one work offset, when the rotary axes stand at its values. A motion whose start or
//! end only the machine knows is not checked, and listed.

use super::moves::{JointPath, Move, MovePath};
use crate::gcode::{ControlSetup, GcodeError, Interpreter, ProgramNote, Step};
use crate::machine::{
    JointError, JointMotion, Letter, LimitViolation, Machine, Setup, SingularPass,
};
use crate::motion::Motion;
use crate::unit::Unit;
use nalgebra::Vector3;
use resolve::{Resolved, Resolver};
use std::collections::BTreeMap;

mod fault;
mod path;
mod rapid;
mod resolve;

pub use fault::{MachineProgramError, StepFault};

/// A G-code program on a machine.
#[derive(Clone, Debug)]
pub struct MachineProgram {
    file: String,
    text: String,
    machine: Machine,
    setup: ControlSetup,
    summary: MachineSummary,
}

/// Summary of a program on its machine.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MachineSummary {
    /// The tools in the order of their first motion that is checked.
    pub tools: Vec<ToolUse>,
    /// Motions that are not checked, since only the machine knows where they start or end, or what positions mean.
    pub unknown: Option<UnknownMotions>,
    /// Feed motions with the length offset of another tool: the line of the first, the register and the tool.
    pub other_lengths: Vec<(usize, u32, u32)>,
    /// Axes that leave their limits, each with its line: the worst per axis and limit. Empty if the origin of the part on
    /// the machine is not given.
    pub limits: Vec<(usize, LimitViolation)>,
    /// Singular passes, each with its line.
    pub singular: Vec<(usize, SingularPass)>,
    /// Notes of the interpreter.
    pub notes: Vec<ProgramNote>,
}

/// Motions that are not checked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct UnknownMotions {
    /// Their number.
    pub count: usize,
    /// The line of the first.
    pub line: usize,
    /// The line of the first in feed, if there is one.
    pub feed_line: Option<usize>,
}

/// A tool's use in a program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolUse {
    /// The tool's number; `None` before the first tool change.
    pub number: Option<u32>,
    /// Line of its first motion.
    pub line: usize,
    /// Number of motions.
    pub motions: usize,
}

/// A selection of the motions of a program by their tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolSelection {
    /// All motions.
    All,
    /// Those with one tool in the spindle; `None`: those before the first tool change.
    Number(Option<u32>),
}

impl ToolSelection {
    /// Returns whether the selection has the motions of a tool.
    pub fn contains(self, tool: Option<u32>) -> bool {
        match self {
            ToolSelection::All => true,
            ToolSelection::Number(number) => number == tool,
        }
    }
}

impl MachineProgram {
    /// Interprets a program on a machine. `name` is the program's name in errors.
    ///
    /// `setup` states work offsets and tool lengths. The frame of the part is that of G54. If its origin on the machine is
    /// not given, the machine's home and limits have no part, and the table may turn under tool centre point control
    /// only. If the length of a tool is not given, the tip is where the program says.
    ///
    /// # Errors
    /// If a line stops the interpreter, or if a motion is not possible on the machine.
    pub fn new(
        name: &str,
        text: String,
        machine: Machine,
        mut setup: ControlSetup,
    ) -> Result<MachineProgram, MachineProgramError> {
        let is_placed = setup.work_offsets[0].is_some();
        // The position of the machine before the program is unknown; axes that it lacks are at 0.
        setup.start = Letter::ALL.map(|letter| machine.axis(letter).is_none().then_some(0.0));
        if is_placed && machine.axes().iter().all(|axis| axis.home.is_some()) {
            setup.home = Some(machine.home().map(Option::unwrap_or_default));
        }
        let file = name.to_owned();
        let mut program =
            MachineProgram { file, text, machine, setup, summary: MachineSummary::default() };
        program.summary = program.run(is_placed)?;
        Ok(program)
    }

    /// Returns the summary of the program on its machine.
    pub fn summary(&self) -> &MachineSummary {
        &self.summary
    }

    /// Returns the machine.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Returns the motions with one tool relative to a link of the table (`None` for the part), in a unit of length. Links
    /// are numbered as by [`Chain::relative_to`](crate::machine::Chain::relative_to). The frame of a link is that of the
    /// part while all axes, X, Y and Z included, are at 0.
    ///
    /// A motion of which only the end is known is given as a rest at that end.
    ///
    /// # Errors
    /// [`JointError::NoLink`] if the machine has no such link.
    pub fn moves(
        &self,
        tool: ToolSelection,
        link: Option<usize>,
        unit: Unit,
    ) -> Result<impl Iterator<Item = Move> + '_, JointError> {
        if let Some(link) = link {
            self.machine.chain(&Setup::default())?.relative_to(link)?;
        }
        let [x, y, z, ..] = self.setup.work_offsets[0].unwrap_or_default();
        let frame = MoveFrame { link, origin: Vector3::new(x, y, z), unit };
        let steps = Interpreter::new(&self.text, &self.setup).into_iter().flatten();
        let mut resolver = Resolver::new(&self.machine, &self.setup);
        let mut from = None;
        // The first run has read and resolved every step.
        let steps = steps.map(|step| step.expect("a step that was read before"));
        Ok(steps.flat_map(move |step| {
            let resolved = resolver.resolve(&step).expect("a step that was resolved before");
            if !tool.contains(step.state.tool) {
                from = None;
                return Vec::new();
            }
            let moves = moves_of(&step, resolved, frame, from);
            if !moves.is_empty() {
                from = Some(step.line);
            }
            moves
        }))
    }

    fn error(&self, error: GcodeError) -> MachineProgramError {
        let GcodeError { line, fault } = error;
        MachineProgramError::Gcode { file: self.file.clone(), line, fault }
    }

    /// Runs the program once. `is_placed` is set if the origin of the part is known.
    fn run(&self, is_placed: bool) -> Result<MachineSummary, MachineProgramError> {
        let mut summary = MachineSummary::default();
        let mut uses: BTreeMap<Option<u32>, usize> = BTreeMap::new();
        let mut is_last_singular = false;
        let mut interpreter =
            Interpreter::new(&self.text, &self.setup).map_err(|error| self.error(error))?;
        let mut resolver = Resolver::new(&self.machine, &self.setup);
        for step in interpreter.by_ref() {
            let step = step.map_err(|error| self.error(error))?;
            let resolved = resolver.resolve(&step).map_err(|fault| MachineProgramError::Step {
                file: self.file.clone(),
                line: step.line,
                fault,
            })?;
            let motions = match resolved {
                Resolved::Unknown | Resolved::Arrival(_) => {
                    let unknown = UnknownMotions { count: 0, line: step.line, feed_line: None };
                    let unknown = summary.unknown.get_or_insert(unknown);
                    unknown.count += 1;
                    if !step.rapid {
                        unknown.feed_line.get_or_insert(step.line);
                    }
                    continue;
                }
                Resolved::Motions(motions) => motions,
            };
            let number = step.state.tool;
            let index = *uses.entry(number).or_insert_with(|| {
                summary.tools.push(ToolUse { number, line: step.line, motions: 0 });
                summary.tools.len() - 1
            });
            summary.tools[index].motions += 1;
            let other = resolver.other_length(&step.state).filter(|_| !step.rapid);
            if let Some((register, tool)) = other
                && !summary.other_lengths.iter().any(|known| (known.1, known.2) == (register, tool))
            {
                summary.other_lengths.push((step.line, register, tool));
            }
            for (motion, _) in &motions {
                // Without a work offset, linear joints are known up to a displacement only.
                let violations = if is_placed { motion.check_limits() } else { Vec::new() };
                for violation in violations {
                    add_violation(&mut summary.limits, step.line, violation);
                }
                let pass = motion.singular_pass();
                if let (false, Some(pass)) = (is_last_singular, pass) {
                    summary.singular.push((step.line, pass));
                }
                is_last_singular = pass.is_some();
            }
        }
        summary.notes = interpreter.notes();
        Ok(summary)
    }
}

/// Adds a violation, or keeps the worse one of the same axis and limit.
fn add_violation(found: &mut Vec<(usize, LimitViolation)>, line: usize, violation: LimitViolation) {
    let same = |(_, known): &&mut (usize, LimitViolation)| {
        known.letter == violation.letter && known.limit == violation.limit
    };
    let excess = |violation: &LimitViolation| (violation.value - violation.limit).abs();
    match found.iter_mut().find(same) {
        None => found.push((line, violation)),
        Some(known) if excess(&violation) > excess(&known.1) => *known = (line, violation),
        Some(_) => (),
    }
}

/// The frame of moves.
#[derive(Clone, Copy)]
struct MoveFrame {
    /// The link of the table; `None` for the part.
    link: Option<usize>,
    /// Origin of the part in machine coordinates, in mm.
    origin: Vector3<f64>,
    unit: Unit,
}

/// Returns the moves of a step.
fn moves_of(step: &Step, resolved: Resolved, frame: MoveFrame, from: Option<usize>) -> Vec<Move> {
    let path = |motion: JointMotion, error: f64| match frame.link {
        Some(link) => {
            let related = motion.relative_to(link).expect("a link of the machine");
            JointPath::new(related, frame.unit, error).relative_to(frame.origin)
        }
        None => JointPath::new(motion, frame.unit, error),
    };
    let as_move = |from: Option<usize>, path: MovePath| Move {
        line: step.line,
        from,
        rapid: step.rapid,
        tool: step.state.tool,
        path,
    };
    let rest = |motion: JointMotion, at: f64| {
        let pose = path(motion, 0.0).pose(at);
        Motion::with_spin(&pose, &pose).ok().map(MovePath::Straight)
    };
    match resolved {
        Resolved::Unknown => Vec::new(),
        Resolved::Arrival(motion) => {
            rest(*motion, 1.0).map(|path| as_move(None, path)).into_iter().collect()
        }
        Resolved::Motions(motions) => {
            let start = motions.first().filter(|_| from.is_none());
            let start = start.and_then(|(motion, _)| rest(*motion, 0.0));
            let start = start.map(|path| as_move(None, path));
            let motions = motions.into_iter().map(|(motion, error)| {
                let path = MovePath::Joints(Box::new(path(motion, error)));
                as_move(Some(from.unwrap_or(step.line)), path)
            });
            start.into_iter().chain(motions).collect()
        }
    }
}
