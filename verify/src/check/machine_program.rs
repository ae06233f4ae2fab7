//! G-code programs on a machine: the motions of the tool relative to the part, or to a body of the machine.
//!
//! ```text
//! text ──interpreter──▶ steps, program coordinates ──work offset, tool length──▶ joints ──chain──▶ moves
//! ```
//!
//! The frame of the part is that of one work offset, when the rotary axes stand at its values. A motion whose start or
//! end only the machine knows is not checked, and listed.

use super::moves::{JointPath, Move, MovePath, RapidBox};
use crate::gcode::{
    self, BlockLine, Choice, ControlRules, ControlSetup, GcodeError, GcodeFault, Interpreter,
    LengthOffset, Rotation, Rule, Step, StepPath, SubprogramFile, Tcp,
};
use crate::machine::{Axis, JointError, JointMotion, Letter, Machine, Relation, Setup, Side};
use nalgebra::Vector3;
use resolve::{AnyRapid, Band, OtherRates, Resolved, Resolver};
use std::collections::{BTreeMap, HashSet};
use std::fmt;
use std::sync::Arc;
use touchoff::{Motion, Unit};

mod fault;
mod path;
mod resolve;
mod summary;

pub use fault::{BlockError, BlockFault, MachineProgramError, Obstacle, StepFault};
pub(crate) use summary::CheckGap;
pub use summary::{
    BlindWay, Gap, GapWeight, Level, MachineSummary, ProgramStop, ToolUse, TopWay, UnknownCause,
    UnknownMotions,
};

/// Largest number of obstacles that are listed. Prose has one in each line.
const MAX_OBSTACLES: usize = 100;
/// Largest number of readings of a program by the rules of controls.
pub const MAX_READINGS: usize = 8;
/// Largest number of combinations of the values that variables can have.
pub const MAX_VALUES: usize = 100;

/// Assumptions of a reading of a program.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Assumption {
    /// Rules of the control that are not stated.
    pub rules: ControlRules,
    /// Variables that can have several values.
    pub variables: BTreeMap<String, f64>,
}

/// The assumption as the keys of files: `rapid = "straight", #500 = 2`.
impl fmt::Display for Assumption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.rules)?;
        let mut is_first = self.rules == ControlRules::default();
        for (name, value) in &self.variables {
            let comma = if is_first { "" } else { ", " };
            write!(f, "{comma}{name} = {value}")?;
            is_first = false;
        }
        Ok(())
    }
}

/// A G-code program on a machine, as one control reads it.
#[derive(Clone, Debug)]
pub struct MachineProgram {
    file: String,
    text: Arc<str>,
    machine: Arc<Machine>,
    setup: ControlSetup,
    assumed: Assumption,
    /// Set if the program has no length offset at all, and a tool whose length is not stated.
    off_is_tip: bool,
    /// The tool in the spindle before one is named: the register of the first length offset, or the only tool of the job.
    unnamed_tool: Option<u32>,
    summary: MachineSummary,
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

/// Something of which moves are asked for, and the frame in which they are given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MoveRequest {
    /// The tool relative to the part.
    AtPart,
    /// The tool relative to a link of the table, in the frame of the part while all axes are at 0.
    AtTable(usize),
    /// Any bodies of the machine.
    Bodies {
        /// The bodies.
        relation: Box<Relation>,
        /// Set if poses are in the frame of the part while all axes are at 0, and not in machine coordinates.
        is_in_part: bool,
    },
}

impl MachineProgram {
    /// Interprets a program on a machine. `name` is the program's name in errors.
    ///
    /// `setup` states work offsets, tool lengths, and the rules of the control. The frame of the part is that of G54. If its
    /// origin on the machine is not given, the machine's home and the limits of X, Y and Z have no part, and the table may
    /// turn under tool centre point control only. If the length of a tool is not given, the tip is where the program says
    /// under a length offset.
    ///
    /// Of a rule that is not stated, M6 moves the axes where only the machine knows, axes in rapid traverse move at any
    /// rates, and the first choice is made otherwise. [`MachineProgram::readings`] makes the others too.
    ///
    /// A line that stops the interpreter ends the program: [`MachineProgram::check_complete`].
    ///
    /// # Errors
    /// If the labels of the program do not fit, or if a motion is not possible on the machine.
    pub fn new(
        name: &str,
        text: String,
        machine: Machine,
        setup: ControlSetup,
    ) -> Result<MachineProgram, MachineProgramError> {
        let (text, machine) = (Arc::from(text), Arc::new(machine));
        MachineProgram::reading(name, text, machine, setup, Assumption::default())
    }

    /// Interprets a program in every way in which a control does, as far as its rules are not stated, and with every value of its
    /// variables: a program per combination of the choices on which it depends. A result holds if it holds for all.
    ///
    /// # Errors
    /// As for [`MachineProgram::new`], and if there are more than [`MAX_READINGS`] of rules or [`MAX_VALUES`] of variables.
    pub fn readings(
        name: &str,
        text: String,
        machine: Machine,
        setup: &ControlSetup,
    ) -> Result<Vec<MachineProgram>, MachineProgramError> {
        let (text, machine): (Arc<str>, _) = (Arc::from(text), Arc::new(machine));
        let mut branched: BTreeMap<Rule, BlockLine> = BTreeMap::new();
        let values = values(&setup.variables)
            .ok_or_else(|| MachineProgramError::Values { file: name.to_owned() })?;
        loop {
            let mut assumed = vec![ControlRules::default()];
            for rule in branched.keys() {
                assumed = assumed
                    .into_iter()
                    .flat_map(|rules| {
                        choices(*rule, &machine).map(move |c| rules.clone().with(*rule, c))
                    })
                    .collect();
            }
            if assumed.len() > MAX_READINGS {
                let rules = branched
                    .iter()
                    .map(|(rule, block)| format!("`{}` (line {})", rule.key(), block.line));
                let rules = rules.collect::<Vec<_>>().join(", ");
                return Err(MachineProgramError::Readings { file: name.to_owned(), rules });
            }
            // Few bytes can ask for much work, so that all readings together have one budget.
            let count = assumed.len() * values.len();
            let shared = ControlSetup { max_repeated: setup.max_repeated / count, ..setup.clone() };
            let assumed = assumed.into_iter().flat_map(|rules| {
                let with = move |variables: &BTreeMap<String, f64>| Assumption {
                    rules: rules.clone(),
                    variables: variables.clone(),
                };
                values.iter().map(with)
            });
            let programs = assumed.map(|assumed| {
                let (text, machine) = (Arc::clone(&text), Arc::clone(&machine));
                MachineProgram::reading(name, text, machine, shared.clone(), assumed)
            });
            let programs = programs.collect::<Result<Vec<_>, _>>()?;
            // A choice can lead to blocks that depend on further rules. Without such, every reading is known.
            let known = branched.len();
            for program in &programs {
                let open = program.summary.open_rules.iter().filter(|(rule, _)| rule.is_branched());
                for (rule, block) in open {
                    branched.entry(*rule).or_insert(*block);
                }
            }
            if branched.len() == known {
                return Ok(programs);
            }
        }
    }

    /// Interprets a program under the rules of the setup and those that are assumed besides.
    fn reading(
        name: &str,
        text: Arc<str>,
        machine: Arc<Machine>,
        mut setup: ControlSetup,
        assumed: Assumption,
    ) -> Result<MachineProgram, MachineProgramError> {
        let mut stated = setup.rules.clone();
        if let Some(own) = gcode::rules_of(&text) {
            stated = stated.and(&own);
        }
        setup.rules = stated.clone().and(&assumed.rules);
        for (name, value) in &assumed.variables {
            setup.variables.insert(name.clone(), vec![*value]);
        }
        // Whatever the control does, the axes are somewhere: that nobody knows where includes all choices.
        if setup.rules.get(Rule::ToolChange).is_none() {
            setup.rules = setup.rules.with(Rule::ToolChange, Choice::Moves);
        }
        setup.axes = Letter::ALL.map(|letter| machine.axis(letter).is_some());
        setup.carries_tool = Letter::ALL
            .map(|letter| machine.axis(letter).is_some_and(|axis| axis.side == Side::Tool));
        setup.tilts = Letter::ALL.map(|letter| machine.axis(letter).is_some_and(Axis::tilts));
        setup.tool_change = machine.tool_change();
        setup.builder_point = machine.builder_point();
        let machine = match setup.rules.get(Rule::RotaryDirection) {
            Some(choice) if !machine.states_directions() => {
                Arc::new(machine.reversed(|letter| is_reversed(choice, letter)))
            }
            _ => machine,
        };
        let is_placed = setup.work_offsets[0].is_some();
        // The gauge point has a place where G54 or the tools have theirs.
        if setup.t0_is_empty && (is_placed || !setup.lengths.is_empty()) {
            setup.lengths.insert(0, 0.0);
        }
        // The position of the machine before the program is unknown; axes that it lacks are at 0.
        setup.start = Letter::ALL.map(|letter| machine.axis(letter).is_none().then_some(0.0));
        if is_placed {
            setup.home = machine.home();
        }
        let travel = machine.axis(Letter::Z).and_then(|axis| axis.limits);
        setup.top = travel.map(|[_, top]| top);
        let mut program = MachineProgram {
            file: name.to_owned(),
            text,
            machine,
            setup,
            assumed,
            off_is_tip: false,
            unnamed_tool: None,
            summary: MachineSummary::default(),
        };
        let mut result = program.run(is_placed);
        // Both facts hold for the whole program and follow from all of its steps, so that the first run cannot use them.
        if let Ok((summary, offsets)) = &result {
            let mut causes = summary.unknown.iter().map(|unknown| unknown.cause);
            program.off_is_tip =
                !offsets.any && causes.any(|cause| matches!(cause, UnknownCause::NoOffset { .. }));
            // In a program that names tools, the only tool of the job is in the spindle before: its body is checked there.
            let is_unnamed = summary.tools.iter().any(|tool| tool.number.is_none());
            let is_tool = |tool: &&u32| !program.setup.is_spindle_empty(Some(**tool));
            let mut lengths = program.setup.lengths.keys().filter(is_tool);
            let only = match (lengths.next(), lengths.next()) {
                (Some(tool), None) if is_unnamed && offsets.names_tool => Some(*tool),
                _ => None,
            };
            program.unnamed_tool = offsets.unnamed.or(only);
            if program.off_is_tip || program.unnamed_tool.is_some() {
                result = program.run(is_placed);
            }
        }
        let result = result.map(|(summary, _)| summary);
        program.summary = result.map_err(|error| match program.assumed {
            ref assumed if *assumed == Assumption::default() => error,
            ref assumed => {
                MachineProgramError::Under { error: Box::new(error), rules: assumed.to_string() }
            }
        })?;
        let assumed = &program.assumed;
        program
            .summary
            .open_rules
            .retain(|rule, _| stated.get(*rule).is_none() && assumed.rules.get(*rule).is_none());
        // The interpreter does not know the machine.
        let (has_head, states_directions) =
            (program.machine.has_rotary(Side::Tool), program.machine.states_directions());
        program.summary.open_rules.retain(|rule, _| match rule {
            Rule::RotaryDirection => !states_directions,
            Rule::HeadLength => has_head,
            _ => true,
        });
        Ok(program)
    }

    /// Returns what this reading assumes, since it is not stated.
    pub fn assumed(&self) -> &Assumption {
        &self.assumed
    }

    /// Returns the program's name in messages.
    pub fn name(&self) -> &str {
        &self.file
    }

    /// Returns the files of subprograms that it can call.
    pub(crate) fn subprograms(&self) -> &[SubprogramFile] {
        &self.setup.subprograms
    }

    /// Returns the origin of the part in machine coordinates, if the setup states it.
    pub fn part_origin(&self) -> Option<[f64; 6]> {
        self.setup.work_offsets[0]
    }

    /// Checks that the program is read to its end.
    ///
    /// # Errors
    /// If a line stops the interpreter.
    pub fn check_complete(&self) -> Result<(), MachineProgramError> {
        match &self.summary.stop {
            Some(stop) => Err(self.error(stop.error.clone())),
            None => Ok(()),
        }
    }

    /// Returns the length of a tool in mm, if it is stated, so that the joint values of its motions are known, given the origin of the
    /// part.
    pub(crate) fn tool_length(&self, tool: Option<u32>) -> Option<f64> {
        self.setup.lengths.get(&tool.or(self.unnamed_tool)?).copied()
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
        let restarts = tool != ToolSelection::All;
        let request = link.map_or(MoveRequest::AtPart, MoveRequest::AtTable);
        let blocks =
            self.blocks(&[request], unit, restarts, move |number| tool.contains(number))?;
        Ok(blocks.flat_map(|(_, frames)| frames.into_iter().flatten()))
    }

    /// Returns the motions with all tools relative to the part, in the order of the program and in a unit of length. Each tool
    /// begins with a rest at its first position after a change, as [`MachineProgram::moves`] of that tool does.
    pub fn moves_in_order(&self, unit: Unit) -> impl Iterator<Item = Move> + '_ {
        // The frame of a link alone could be missing.
        let blocks = self.blocks(&[MoveRequest::AtPart], unit, true, |_| true);
        blocks.into_iter().flatten().flat_map(|(_, frames)| frames.into_iter().flatten())
    }

    /// Returns the moves of each block with the number of the tool in the spindle, for each request. `restarts` is set if a tool begins with a rest at its first position after each change. A tool that
    /// is not wanted makes none.
    pub(crate) fn blocks<'a, W: Fn(Option<u32>) -> bool + 'a>(
        &'a self,
        requests: &[MoveRequest],
        unit: Unit,
        restarts: bool,
        is_wanted: W,
    ) -> Result<impl Iterator<Item = (Option<u32>, Vec<Vec<Move>>)> + use<'a, W>, JointError> {
        for request in requests {
            if let MoveRequest::AtTable(link) = request {
                self.machine.chain(&Setup::default())?.relative_to(*link)?;
            }
        }
        let [x, y, z, ..] = self.setup.work_offsets[0].unwrap_or_default();
        let origin = Vector3::new(x, y, z);
        let frames: Vec<_> = requests
            .iter()
            .map(|request| MoveFrame { request: request.clone(), origin, unit })
            .collect();
        // The program exists because an execution had no error, and every execution has the same steps.
        let reason = "the execution that created the program had no error";
        let steps = self.execute().expect(reason);
        // The line at which the tool stands, and the tool.
        let mut from: Option<(usize, Option<u32>)> = None;
        Ok(steps.map(move |(step, resolved)| {
            let tool = step.state.tool;
            from = from.filter(|(_, before)| !restarts || *before == tool);
            // Tools that count as one are not changed.
            let is_same = !restarts && matches!(resolved, Resolved::Loaded(_));
            if is_same || !is_wanted(tool) {
                return (tool, vec![Vec::new(); frames.len()]);
            }
            let start = from.map(|(line, _)| line);
            let moves: Vec<Vec<Move>> =
                frames.iter().map(|frame| frame.moves(&step, &resolved, start)).collect();
            if moves.iter().any(|moves| !moves.is_empty()) {
                from = Some((step.line, tool));
            }
            (tool, moves)
        }))
    }

    fn error(&self, error: BlockError) -> MachineProgramError {
        let BlockError { block, fault } = error;
        MachineProgramError::Block { file: self.file.clone(), line: block.line, fault }
    }

    /// Returns a block that is not read.
    fn unread(&self, error: GcodeError) -> BlockError {
        let GcodeError { line, fault } = error;
        let within = gcode::line_of(&self.setup.subprograms, &fault);
        BlockError { block: BlockLine { line, within }, fault: fault.into() }
    }

    /// Returns the error of an axis that the machine lacks and that a step moves elsewhere than to 0, where it is taken to stand.
    fn lacking_axis(&self, step: &Step) -> Option<JointError> {
        Letter::ALL.into_iter().zip(step.commanded.into_iter().zip(step.end)).find_map(
            |(letter, (is_commanded, end))| {
                let value = end.filter(|end| is_commanded && *end != 0.0)?;
                self.machine.axis(letter).is_none().then_some(JointError::NoAxis { letter, value })
            },
        )
    }

    /// Begins an execution of the program.
    fn execute(&self) -> Result<Execution<'_>, MachineProgramError> {
        let interpreter = Interpreter::new(&self.text, &self.setup)
            .map_err(|error| self.error(self.unread(error)))?
            .with_loads();
        let resolver =
            Resolver::new(&self.machine, &self.setup, self.off_is_tip, self.unnamed_tool);
        Ok(Execution { program: self, interpreter, resolver, stop: None })
    }

    /// Runs the program once. `is_placed` is set if the origin of the part is known.
    fn run(&self, is_placed: bool) -> Result<(MachineSummary, LengthOffsets), MachineProgramError> {
        let mut offsets = LengthOffsets::default();
        let mut summary = MachineSummary::default();
        let mut seen: Vec<(Option<u32>, BlockLine)> = Vec::new();
        let mut is_last_singular = false;
        let has_z_limits = self.machine.axis(Letter::Z).is_some_and(|axis| axis.limits.is_some());
        // The other controls turn axes by ISO 841.
        let asks_direction = !self.machine.states_directions()
            && self.setup.rules.get(Rule::Dialect) == Some(Choice::Rs274Ngc);
        let mut execution = self.execute()?;
        // LinuxCNC has neither tool centre point control nor tilted planes by the words of other controls.
        let assumes_direction = !self.machine.states_directions()
            && self.setup.rules.get(Rule::Dialect).is_none()
            && self.setup.rules.get(Rule::RotaryDirection).is_none()
            && execution.interpreter.is_iso();
        while let Some((step, resolved)) = execution.next() {
            let number = step.state.tool;
            let is_empty = self.setup.is_spindle_empty(number);
            let is_plain = step.state.tcp == Tcp::Off
                && !matches!(step.state.rotation, Rotation::Tilted { .. });
            if assumes_direction && is_plain && resolved.is_turned() {
                summary.direction_assumed.get_or_insert(step.block());
            }
            if asks_direction && resolved.is_turned() {
                execution.resolver.note(Rule::RotaryDirection, &step);
            }
            // A tool change is no motion of the program.
            if !matches!(step.path, StepPath::ToolChange(_)) {
                if is_empty {
                    summary.first_empty.get_or_insert(step.block());
                    summary.empty_blocks.insert(step.block());
                } else if !seen.iter().any(|(tool, _)| *tool == number) {
                    seen.push((number, step.block()));
                }
            }
            if let Some(way) = execution.resolver.empty_way.take() {
                MachineSummary::add_blind_way(&mut summary.empty_ways, step.block(), way);
            }
            offsets.names_tool |= number.is_some();
            if let LengthOffset::On { register, .. } = step.state.length {
                offsets.any = true;
                if number.is_none() {
                    offsets.unnamed.get_or_insert(register);
                }
            }
            let is_known = number.is_some_and(|tool| self.setup.lengths.contains_key(&tool));
            if step.state.length == LengthOffset::Off
                && step.state.turns_with_workpiece()
                && (self.off_is_tip || number.or(self.unnamed_tool).is_none())
                && !is_known
                && !is_empty
            {
                summary.tcp_without_length.get_or_insert(step.block());
            }
            summary.add_offset(&step, &self.setup);
            if !step.rapid && !is_empty {
                summary.add_feed(&step, self.off_is_tip);
            }
            if step.state.length == LengthOffset::Off && !self.off_is_tip && !is_empty {
                summary.bare_blocks.insert(step.block());
            }
            let arrives = matches!(resolved, Resolved::Arrival(..));
            let has_length = execution.resolver.has_length(&step.state);
            // What is followed with its length is checked as it is.
            let is_followed = matches!(
                resolved,
                Resolved::Motions(_) | Resolved::Band(_) | Resolved::AnyRapid(_)
            );
            let is_change = matches!(resolved, Resolved::ToolChange | Resolved::Loaded(_));
            if !(is_empty || is_change || is_followed && has_length)
                && let Some(way) = execution.resolver.top_way(&step, has_length)
            {
                summary.add_top_way(TopWay {
                    block: step.block(),
                    tool: number,
                    length: self.tool_length(number),
                    way,
                });
            }
            // The known part of a way and the other curves of an arc keep the limits, too.
            let further: Vec<&JointMotion> = match &resolved {
                Resolved::Arrival(rest, _) | Resolved::Loaded(rest) => vec![rest],
                Resolved::Band(band) => band.curves.iter().map(|(curve, _)| curve).collect(),
                _ => Vec::new(),
            };
            let known = match &resolved {
                Resolved::Unknown(_) if is_placed => execution.resolver.known_violations(&step),
                _ => Vec::new(),
            };
            let further = further.into_iter().flat_map(JointMotion::check_limits);
            for violation in further.chain(known) {
                summary.add_violation(step.block(), violation);
            }
            let motions = match resolved {
                Resolved::ToolChange => continue,
                Resolved::Loaded(_) if is_empty => continue,
                Resolved::Loaded(_) => {
                    summary.use_of(&step);
                    continue;
                }
                Resolved::Unknown(cause)
                | Resolved::Arrival(_, cause)
                | Resolved::Departure(_, cause) => {
                    let Resolver { way_home, blind_way, .. } = &mut execution.resolver;
                    let MachineSummary { blind_ways, ways_home, empty_ways, .. } = &mut summary;
                    if let Some(way) = way_home.take() {
                        let ways = if is_empty { &mut *empty_ways } else { ways_home };
                        MachineSummary::add_blind_way(ways, step.block(), way);
                    }
                    let way = blind_way.take();
                    // Of a way with unknown axes at a known Z, its level is compared with all bodies.
                    let is_judged = cause == UnknownCause::Axis && way.is_some();
                    if let Some(way) = way {
                        let ways = if is_empty { empty_ways } else { blind_ways };
                        MachineSummary::add_blind_way(ways, step.block(), way);
                    }
                    let is_judged =
                        is_judged || execution.resolver.leaves_change(&step, cause, arrives);
                    summary.add_unknown(&step, cause, is_judged);
                    continue;
                }
                Resolved::Motions(motions) | Resolved::Band(Band { motions, .. }) => motions,
                Resolved::AnyRapid(any) => {
                    if let OtherRates::Level(way) = any.other_rates {
                        MachineSummary::add_blind_way(&mut summary.rotary_ways, step.block(), way);
                    }
                    vec![(any.straight, 0.0)]
                }
            };
            if is_empty {
                summary.empty_motions += 1;
            } else {
                summary.use_of(&step).motions += 1;
                if is_placed && has_z_limits && !has_length && step.commanded[2] {
                    summary.z_limit_unchecked.get_or_insert(step.block());
                }
                if step.rapid {
                    summary.add_rapid(&step, self.off_is_tip, self.unnamed_tool);
                }
            }
            let other = execution.resolver.other_length(&step.state);
            let other = other.filter(|_| !step.rapid && !is_empty);
            if let Some((register, tool)) = other
                && !summary.other_lengths.iter().any(|known| (known.1, known.2) == (register, tool))
            {
                summary.other_lengths.push((step.block(), register, tool));
            }
            for (motion, _) in &motions {
                for violation in motion.check_limits() {
                    summary.add_violation(step.block(), violation);
                }
                let pass = motion.singular_pass();
                // A pass of several blocks is one.
                if let (false, Some(pass)) = (is_last_singular, pass) {
                    summary.singular.push((step.block(), pass));
                }
                is_last_singular = pass.is_some();
            }
        }
        if let Some(error) = execution.stop.take() {
            // Motions of a program without an end, up to its limit, are worth no check.
            if matches!(&error.fault, BlockFault::Gcode(fault) if matches!(fault.innermost(), GcodeFault::TooLong { .. }))
            {
                return Err(self.error(error));
            }
            summary.stop = Some(execution.stop_at(error));
        }
        summary.notes = execution.interpreter.notes();
        summary.blank = execution.interpreter.blank();
        summary.stated_tools =
            gcode::stated_tools(&self.text, execution.interpreter.unit(), &self.setup.tool_names);
        summary.open_rules.clone_from(execution.interpreter.asked());
        summary.open_rules.extend(execution.resolver.asked);
        let is_checked = |number| {
            let mut tools = summary.tools.iter();
            tools.any(|tool| tool.number == number && tool.motions > 0)
        };
        let unchecked = seen.into_iter().filter(|(tool, _)| !is_checked(*tool));
        summary.unchecked_tools =
            unchecked.filter_map(|(tool, block)| Some((tool?, block))).collect();
        let mut linear = self.machine.axes().iter().filter(|axis| !axis.letter.is_rotary());
        summary.limits_unchecked = !is_placed && linear.any(|axis| axis.limits.is_some());
        Ok((summary, offsets))
    }
}

/// Returns the choices of a rule on a machine. Axes of a table turn all one way or all the other, those of a head each by itself: the
/// kinematics of LinuxCNC mix both.
fn choices(rule: Rule, machine: &Machine) -> impl Iterator<Item = Choice> + '_ {
    let rotary = || machine.axes().iter().map(|axis| axis.letter).filter(|l| l.is_rotary());
    let is_mixed = machine.has_rotary(Side::Tool) && rotary().count() > 1;
    rule.choices().filter(move |choice| match choice {
        Choice::ReversedA | Choice::ReversedB | Choice::ReversedC => {
            is_mixed && rotary().any(|letter| is_reversed(*choice, letter))
        }
        _ => true,
    })
}

/// Returns whether a rotary axis of a machine of the library turns against ISO 841.
fn is_reversed(direction: Choice, letter: Letter) -> bool {
    match direction {
        Choice::Reversed => true,
        Choice::ReversedA => letter == Letter::A,
        Choice::ReversedB => letter == Letter::B,
        Choice::ReversedC => letter == Letter::C,
        _ => false,
    }
}

/// Returns every combination of the values of variables that can have several; `None` if there are too many.
fn values(variables: &BTreeMap<String, Vec<f64>>) -> Option<Vec<BTreeMap<String, f64>>> {
    let mut combinations = vec![BTreeMap::new()];
    for (name, values) in variables.iter().filter(|(_, values)| values.len() > 1) {
        combinations = combinations
            .iter()
            .flat_map(|known: &BTreeMap<String, f64>| {
                values.iter().map(move |value| {
                    let mut with = known.clone();
                    with.insert(name.clone(), *value);
                    with
                })
            })
            .collect();
        if combinations.len() > MAX_VALUES {
            return None;
        }
    }
    Some(combinations)
}

/// An execution of a program: its steps, with what the machine makes of each.
struct Execution<'a> {
    program: &'a MachineProgram,
    interpreter: Interpreter<'a>,
    resolver: Resolver<'a>,
    /// The block that has stopped it, after which there are no more steps.
    stop: Option<BlockError>,
}

impl Execution<'_> {
    /// Returns the stop at the block that has stopped it, with the obstacles behind it.
    fn stop_at(&mut self, error: BlockError) -> ProgramStop {
        let BlockError { block, fault } = error.clone();
        let mut found = vec![Obstacle { block, count: 1, fault }];
        let mut known = HashSet::from([(0, block)]);
        let mut unlisted = HashSet::new();
        let mut survey = self.interpreter.survey();
        let mut errors = Vec::new();
        while let Some(step) = survey.next() {
            match step {
                Ok(step) => {
                    let block = step.block();
                    let lacking = self.program.lacking_axis(&step);
                    // An axis stays where it is in the blocks after the one that states it.
                    let others = self.resolver.resolve(&step).err().filter(|fault| {
                        let is_lacking =
                            matches!(fault, StepFault::Joint(JointError::NoAxis { .. }));
                        !is_lacking && fault.is_of_job(survey.is_uncertain())
                    });
                    let faults = lacking.map(StepFault::from).into_iter().chain(others);
                    errors.extend(faults.map(|fault| BlockError { block, fault: fault.into() }));
                }
                Err(error) => errors.push(self.program.unread(error)),
            }
            for BlockError { block, fault } in errors.drain(..) {
                let position = found.iter().position(|known| known.fault.is_same(&fault));
                let index = match position {
                    Some(index) => index,
                    None if found.len() <= MAX_OBSTACLES => {
                        found.push(Obstacle { block, count: 0, fault });
                        found.len() - 1
                    }
                    None => {
                        unlisted.insert(block);
                        continue;
                    }
                };
                if known.insert((index, block)) {
                    found[index].count += 1;
                }
            }
        }
        let count = found.remove(0).count;
        ProgramStop { error, count, obstacles: found, unlisted: unlisted.len() }
    }
}

impl Iterator for Execution<'_> {
    type Item = (Step, Resolved);

    fn next(&mut self) -> Option<Self::Item> {
        if self.stop.is_some() {
            return None;
        }
        let error = match self.interpreter.next()? {
            Ok(step) => match self.resolver.resolve(&step) {
                Ok(resolved) => return Some((step, resolved)),
                Err(fault) => BlockError { block: step.block(), fault: fault.into() },
            },
            Err(error) => self.program.unread(error),
        };
        self.stop = Some(error);
        None
    }
}

/// The length offsets of a program.
#[derive(Clone, Copy, Default)]
struct LengthOffsets {
    /// Set if one is in force in some step.
    any: bool,
    /// The register of the first that is in force before a tool is named.
    unnamed: Option<u32>,
    /// Set if a tool is named.
    names_tool: bool,
}

/// The frame of moves.
struct MoveFrame {
    request: MoveRequest,
    /// Origin of the part in machine coordinates, in mm.
    origin: Vector3<f64>,
    unit: Unit,
}

impl MoveFrame {
    /// Returns the path of a joint motion that differs from that of the control by at most `error`, in mm.
    fn path(&self, motion: JointMotion, error: f64) -> JointPath {
        let (related, is_in_part) = match &self.request {
            MoveRequest::AtPart => return JointPath::new(motion, self.unit, error),
            MoveRequest::AtTable(link) => {
                (motion.relative_to(*link).expect("a link of the machine"), true)
            }
            MoveRequest::Bodies { relation, is_in_part } => (motion.between(relation), *is_in_part),
        };
        let path = JointPath::new(related, self.unit, error);
        if is_in_part { path.relative_to(self.origin) } else { path }
    }

    /// Returns a rest at a pose of a joint motion.
    fn rest(&self, motion: JointMotion, at: f64) -> Option<MovePath> {
        let pose = self.path(motion, 0.0).pose(at);
        Motion::with_spin(&pose, &pose).ok().map(MovePath::Straight)
    }

    /// Returns the moves of a step. `from` is the line of the move before, if there is one.
    fn moves(&self, step: &Step, resolved: &Resolved, from: Option<usize>) -> Vec<Move> {
        // The tool is checked at rest first where no move comes before. It cuts nothing there, whatever the step is.
        let start = |motion: JointMotion| match from {
            None => self
                .rest(motion, 0.0)
                .map(|path| Move { rapid: true, ..move_along(step, None, path) }),
            Some(_) => None,
        };
        // A move after a rest of its own begins at its own line.
        let arriving = |path: MovePath| move_along(step, Some(from.unwrap_or(step.line)), path);
        match resolved {
            Resolved::Unknown(_) | Resolved::ToolChange => Vec::new(),
            Resolved::Loaded(motion) => {
                let rest = self.rest(**motion, 0.0);
                rest.map(|path| move_along(step, None, path)).into_iter().collect()
            }
            Resolved::AnyRapid(any) => {
                let AnyRapid { straight, other_rates } = &**any;
                let straight = *straight;
                let OtherRates::Box(edges) = other_rates else {
                    return self.moves(step, &Resolved::Motions(vec![(straight, 0.0)]), from);
                };
                let corner = self.path(straight, 0.0).pose(0.0);
                let ways = edges.iter().map(|edge| {
                    let end = self.path(*edge, 0.0).pose(1.0);
                    end.tip() - corner.tip()
                });
                let all = MovePath::Box(Box::new(RapidBox::new(corner, ways.collect())));
                start(straight).into_iter().chain([arriving(all)]).collect()
            }
            Resolved::Departure(motion, _) => {
                let path = MovePath::Joints(Box::new(self.path(**motion, 0.0)));
                start(**motion).into_iter().chain([arriving(path)]).collect()
            }
            Resolved::Band(Band { motions, curves }) => {
                // The tool ends where the spiral ends, which is the last.
                let first = motions.first().and_then(|(motion, _)| start(*motion));
                let along = |(motion, error): &(_, f64)| {
                    arriving(MovePath::Joints(Box::new(self.path(*motion, *error))))
                };
                let curves = curves.iter().map(|curve| Move { alternative: true, ..along(curve) });
                first.into_iter().chain(curves).chain(motions.iter().map(along)).collect()
            }
            Resolved::Arrival(motion, _) => {
                let rest = self.rest(**motion, 1.0);
                rest.map(|path| move_along(step, None, path)).into_iter().collect()
            }
            Resolved::Motions(motions) => {
                let first = motions.first().and_then(|(motion, _)| start(*motion));
                let motions = motions.iter().map(|(motion, error)| {
                    arriving(MovePath::Joints(Box::new(self.path(*motion, *error))))
                });
                first.into_iter().chain(motions).collect()
            }
        }
    }
}

/// Returns the move of a step along a path, which begins at a line.
fn move_along(step: &Step, from: Option<usize>, path: MovePath) -> Move {
    Move {
        line: step.line,
        within: step.within,
        from,
        rapid: step.rapid,
        alternative: false,
        tool: step.state.tool,
        work_offset: Some(step.state.work_offset),
        path,
    }
}
