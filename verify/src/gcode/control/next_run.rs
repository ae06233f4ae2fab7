//! The next run of a program: it starts with what the control keeps from the end of the run before.
//!
//! Most modes are kept or set by parameters of a control, so two runs are executed block by block, from the place at which the
//! first run ended: the program as it starts, and as it starts with all modes that it left, or with one of them. Where their
//! motions are the same, the program depends on none of these modes. The runs end at the block from which on both controls agree.
//! They are executed at both positions of the switch for optional blocks, which the operator can turn between runs.

use super::{Control, Motion};
use crate::gcode::interpreter::{End, Interpreter};
use crate::gcode::note::{NoteKind, ProgramNote};
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{LengthOffset, Rotation, Tcp};
use crate::gcode::{BlockLine, Plane, Step, StepPath};
use std::sync::Arc;
use touchoff::Unit;

/// Tolerance of positions, in mm or degrees: those of both runs are rounded in different ways.
const TOLERANCE: f64 = 1e-6;

/// Something that a control can keep from one run to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Unit,
    Plane,
    Distance,
    ArcDistance,
    Retract,
    WorkOffset,
    /// The origins that G10 has set.
    Origins,
    Shift,
    Rotation,
    Length,
    /// The last H.
    Register,
    Tcp,
    /// The tool of the last T.
    Staged,
    /// A series of canned cycles, with its initial level.
    Series,
    Polar,
    Mirror,
}

const MODES: [Mode; 16] = [
    Mode::Unit,
    Mode::Plane,
    Mode::Distance,
    Mode::ArcDistance,
    Mode::Retract,
    Mode::WorkOffset,
    Mode::Origins,
    Mode::Shift,
    Mode::Rotation,
    Mode::Length,
    Mode::Register,
    Mode::Tcp,
    Mode::Staged,
    Mode::Series,
    Mode::Polar,
    Mode::Mirror,
];

impl Interpreter<'_> {
    /// Returns the notes about the blocks that were executed so far, by line.
    pub fn notes(&self) -> Vec<ProgramNote> {
        let mut notes = self.control.notes.clone();
        if let Some(block) = self.control.uncalled.filter(|_| self.end.is_some()) {
            notes.add(block, NoteKind::UncalledCycle);
        }
        let mut notes = notes.list();
        if let (Some(first), Some(end)) = (&self.first, self.end) {
            notes.extend(note(first, self, end));
        }
        notes.sort_by_key(|note| note.line);
        notes
    }
}

/// Notes the first block that the next run of a program executes otherwise, because the control keeps what it `left`.
///
/// `first` is the program before its first block.
fn note(first: &Interpreter, left: &Interpreter, end: End) -> Option<ProgramNote> {
    let end = left.control.stated(Rule::ProgramEnd).filter(|_| end == End::Stop);
    let kept: Vec<Mode> = MODES
        .into_iter()
        .filter(|mode| mode.differs(&first.control, &left.control) && !mode.is_reset(end))
        .collect();
    if kept.is_empty() {
        return None;
    }
    let all = first_difference(first, left, &kept);
    // LinuxCNC keeps all others for certain. Elsewhere, one of two that cancel each other may be set.
    if all.is_none() && end == Some(Choice::SetsModes) {
        return None;
    }
    let mut alone: Vec<(Mode, BlockLine)> = Vec::new();
    for mode in &kept {
        alone.extend(first_difference(first, left, &[*mode]).map(|block| (*mode, block)));
    }
    let BlockLine { line, within } = alone.iter().map(|(_, block)| *block).chain(all).min()?;
    // Modes that differ only together are named together.
    let guilty: Vec<Mode> = match alone.is_empty() {
        true => kept,
        false => alone.into_iter().map(|(mode, _)| mode).collect(),
    };
    let words: Vec<String> = guilty.into_iter().map(|mode| mode.word(left)).collect();
    let kind = NoteKind::LeftModes { words: words.join(", ") };
    Some(ProgramNote { line, within, count: 1, kind })
}

/// Returns the place of the first block that is executed otherwise if some modes are kept, at any position of the switch for
/// optional blocks, and under all choices of the rules on which the first run did not depend.
fn first_difference(first: &Interpreter, left: &Interpreter, kept: &[Mode]) -> Option<BlockLine> {
    let mut start = first.clone();
    start.control.stand_as(&left.control);
    let mut starts = vec![start];
    if left.control.asked.contains_key(&Rule::OptionalBlocks) {
        starts = under_each(&starts[0], Rule::OptionalBlocks);
    }
    while let Some(start) = starts.pop() {
        let (mut run, mut next) = (start.clone(), start.clone());
        next.control.keep(&left.control, kept);
        next.keep_frame(left, [Mode::Shift, Mode::Rotation].map(|mode| kept.contains(&mode)));
        let block = run_beside(&mut run, &mut next);
        if block.is_some() {
            return block;
        }
        let mut asked = run.control.asked.keys().chain(next.control.asked.keys());
        if let Some(rule) =
            asked.find(|rule| rule.is_of_interpreter() && start.control.stated(**rule).is_none())
        {
            // From here on a rule decides which the first run has not asked: each of its choices is a run of its own.
            starts.extend(under_each(&start, *rule));
        }
    }
    None
}

/// Returns a program under each choice of a rule.
fn under_each<'a>(start: &Interpreter<'a>, rule: Rule) -> Vec<Interpreter<'a>> {
    rule.choices()
        .map(|choice| {
            let mut start = start.clone();
            start.control.state_rule(rule, choice);
            start
        })
        .collect()
}

/// Executes two runs until they agree, and returns the place of the first block that they execute in different ways.
fn run_beside(run: &mut Interpreter, next: &mut Interpreter) -> Option<BlockLine> {
    while !run.control.agrees(&next.control) {
        let lengths = [&*run, next].map(|run| run.control.state.length);
        // The first run has shown what stops the program itself.
        let more = run.execute_line().ok()?;
        let block = run.control.block();
        if next.execute_line().is_err() {
            return Some(block);
        }
        let mut steps = std::mem::take(&mut run.control.pending);
        let mut others = std::mem::take(&mut next.control.pending);
        // A new tool in the spindle is no motion.
        for steps in [&mut steps, &mut others] {
            steps.retain(|step| {
                step.commanded.contains(&true) || !matches!(step.path, StepPath::ToolChange(_))
            });
        }
        // A length that changes moves Z on some controls. One that is in force already does not, and the first position after it is
        // the same.
        let changes = [(&*run, lengths[0]), (next, lengths[1])]
            .map(|(run, before)| run.control.state.length != before);
        if changes == [true, false] && steps.len() == others.len() + 1 {
            steps.pop_front();
        }
        let is_same = steps.len() == others.len()
            && steps.iter().zip(&others).all(|(step, other)| is_same_motion(step, other));
        match (is_same, more) {
            (false, _) => return Some(block),
            (true, false) => return None,
            (true, true) => {}
        }
    }
    None
}

impl Mode {
    /// Returns whether a control that states `end` sets it at M2 and M30 as it is at the start.
    fn is_reset(self, end: Option<Choice>) -> bool {
        match end {
            Some(Choice::SetsModes) => {
                matches!(self, Mode::Plane | Mode::Distance | Mode::WorkOffset)
            }
            Some(Choice::CancelsLength) => self == Mode::Length,
            Some(Choice::ResetsModes) => self != Mode::Origins,
            _ => false,
        }
    }

    /// Returns whether two controls differ in it.
    fn differs(self, first: &Control, second: &Control) -> bool {
        let [(modal, state), (other, others)] =
            [first, second].map(|control| (&control.modal, &*control.state));
        match self {
            Mode::Unit => (modal.unit, modal.unit_stated) != (other.unit, other.unit_stated),
            Mode::Plane => modal.plane != other.plane,
            Mode::Distance => modal.incremental != other.incremental,
            Mode::ArcDistance => modal.absolute_centres != other.absolute_centres,
            Mode::Retract => modal.retract_to_r != other.retract_to_r,
            Mode::WorkOffset => state.work_offset != others.work_offset,
            Mode::Origins => first.origins != second.origins,
            Mode::Shift => {
                (state.shift, first.local, first.preset)
                    != (others.shift, second.local, second.preset)
            }
            Mode::Rotation => (state.rotation, first.frames) != (others.rotation, second.frames),
            Mode::Length => {
                (state.length, first.length_implicit, first.length_cancelled)
                    != (others.length, second.length_implicit, second.length_cancelled)
            }
            Mode::Register => first.last_register != second.last_register,
            Mode::Tcp => (state.tcp, first.transformed) != (others.tcp, second.transformed),
            Mode::Staged => first.staged != second.staged,
            Mode::Series => (&first.cycle, modal.cycle()) != (&second.cycle, other.cycle()),
            Mode::Polar => first.polar != second.polar,
            Mode::Mirror => first.mirror != second.mirror,
        }
    }

    /// Returns the word that left it.
    fn word(self, left: &Interpreter) -> String {
        let shift = left.klartext_shift();
        let left = &left.control;
        let (modal, state) = (&left.modal, &*left.state);
        let is_heidenhain = left.stated(Rule::Dialect) == Some(Choice::Heidenhain);
        let word = match self {
            Mode::Shift if is_heidenhain => shift.unwrap_or("CYCL DEF 7 or G54"),
            Mode::Rotation if is_heidenhain => match state.rotation {
                Rotation::Tilted { .. } => "PLANE",
                _ => "CYCL DEF 10 or G73",
            },
            Mode::Tcp if is_heidenhain => "M128",
            Mode::Length if is_heidenhain => "the length of its last tool",
            Mode::Unit if modal.unit == Unit::Inch => "G20",
            Mode::Unit => "G21",
            Mode::Plane => match modal.plane {
                Plane::Xy => "G17",
                Plane::Zx => "G18",
                Plane::Yz => "G19",
            },
            Mode::Distance => "G91",
            Mode::ArcDistance if modal.absolute_centres == Some(true) => "G90.1",
            Mode::ArcDistance => "G91.1",
            Mode::Retract if modal.retract_to_r == Some(true) => "G99",
            Mode::Retract => "G98",
            Mode::WorkOffset => return state.work_offset.to_string(),
            Mode::Origins => "G10",
            Mode::Shift | Mode::Rotation if left.frames.word().is_some() => {
                left.frames.word().unwrap_or_default()
            }
            Mode::Shift if left.local == [0.0; 6] => "G92",
            Mode::Shift => "G52",
            Mode::Rotation if matches!(state.rotation, Rotation::Tilted { .. }) => "G68.2",
            Mode::Rotation => "G68",
            Mode::Length => match state.length {
                LengthOffset::On { register, .. } => return format!("G43 H{register}"),
                LengthOffset::Off => "G49",
            },
            Mode::Register => return format!("H{}", left.last_register.unwrap_or_default()),
            Mode::Staged => return format!("T{}", left.staged.unwrap_or_default()),
            Mode::Series => match modal.motion {
                Some(Motion::Cycle(number)) => return format!("G{number} without G80"),
                _ => "a canned cycle without G80",
            },
            Mode::Polar => "G16",
            Mode::Mirror => "G51.1",
            Mode::Tcp => match state.tcp {
                Tcp::Transformation => "TRAORI",
                Tcp::Vector => "G43.5",
                _ if left.transformed => "M428",
                _ => "G43.4",
            },
        };
        word.to_owned()
    }
}

impl Control {
    /// Takes over the position and the tool in the spindle that another run has left.
    fn stand_as(&mut self, left: &Control) {
        let mut state = (*self.state).clone();
        state.tool = left.state.tool;
        self.position = left.state.carry_over(&state, left.position, &self.rotary_axes);
        self.state = Arc::new(state);
    }

    /// Takes over modes that another run has left, and the position.
    fn keep(&mut self, left: &Control, modes: &[Mode]) {
        let mut state = (*self.state).clone();
        for mode in modes {
            match mode {
                Mode::Unit => {
                    (self.modal.unit, self.modal.unit_stated) =
                        (left.modal.unit, left.modal.unit_stated);
                }
                Mode::Plane => self.modal.plane = left.modal.plane,
                Mode::Distance => self.modal.incremental = left.modal.incremental,
                Mode::ArcDistance => self.modal.absolute_centres = left.modal.absolute_centres,
                Mode::Retract => self.modal.retract_to_r = left.modal.retract_to_r,
                Mode::WorkOffset => state.work_offset = left.state.work_offset,
                Mode::Origins => self.origins = left.origins.clone(),
                Mode::Shift => {
                    (self.local, self.preset, state.shift) =
                        (left.local, left.preset, left.state.shift);
                    self.frames = left.frames;
                }
                Mode::Rotation => {
                    (state.rotation, self.frames) = (left.state.rotation, left.frames);
                }
                Mode::Length => {
                    (state.length, self.returned) = (left.state.length, left.returned);
                    (self.length_implicit, self.length_cancelled) =
                        (left.length_implicit, left.length_cancelled);
                }
                Mode::Register => self.last_register = left.last_register,
                Mode::Polar => self.polar = left.polar,
                Mode::Mirror => self.mirror = left.mirror,
                Mode::Staged => self.staged = left.staged,
                Mode::Series => {
                    // M2 and M30 select G1 on LinuxCNC, and keep the level of the series until another motion word
                    // (`convert_stop`).
                    self.cycle.clone_from(&left.cycle);
                    self.modal.motion = left.modal.motion;
                }
                Mode::Tcp => {
                    (state.tcp, self.transformed) = (left.state.tcp, left.transformed);
                }
            }
        }
        (state.origin, state.origin_rotation) = self.origin_of(state.work_offset);
        self.position = left.state.carry_over(&state, left.position, &self.rotary_axes);
        self.state = Arc::new(state);
    }

    /// Returns whether all blocks that follow are executed as another control executes them. The words about the spindle have
    /// no part in it, and what was stated may be more than on the other one.
    fn agrees(&self, next: &Control) -> bool {
        MODES.iter().all(|mode| !mode.differs(self, next))
            && self.state == next.state
            && self.position == next.position
            && self.vector == next.vector
            // A motion that is held back is compared once it is known.
            && self.compensation.is_none()
            && next.compensation.is_none()
            && self.held_motion.is_none()
            && next.held_motion.is_none()
            && self.returned == next.returned
            && (self.tcp_position_needed || !next.tcp_position_needed)
            && self.changed().zip(next.changed()).all(|(changed, next)| changed || !next)
    }

    /// Returns whether the length offset, a rotation, and the origin or the shift of each axis have changed since a position was
    /// stated.
    fn changed(&self) -> impl Iterator<Item = bool> {
        [self.length_changed, self.rotation_changed].into_iter().chain(self.origin_changed)
    }
}

/// Returns whether two steps are one motion of the machine.
fn is_same_motion(step: &Step, other: &Step) -> bool {
    manner(step) == manner(other) && is_same_end(step, other)
}

/// Returns all that makes a motion but its ends.
fn manner(step: &Step) -> impl PartialEq + use<> {
    let path = match step.path {
        // Set by the rules and the machine alone.
        StepPath::ToolChange(_) => StepPath::ToolChange([None; 6]),
        path => path,
    };
    let turns = (step.state.tcp, step.state.turns_with_workpiece());
    (step.rapid, step.commanded, step.is_return, step.tool_vector, path, turns)
}

/// Returns whether two coordinates are the same, or both unknown.
fn is_near(first: Option<f64>, second: Option<f64>) -> bool {
    match (first, second) {
        (Some(first), Some(second)) => (first - second).abs() <= TOLERANCE,
        (first, second) => first == second,
    }
}

/// Returns whether two steps end at one position of the machine, along the axes that they move. Where its coordinates are not
/// known, all that they depend on has to be the same.
fn is_same_end(step: &Step, other: &Step) -> bool {
    let [state, other_state] = [step, other].map(|step| &*step.state);
    let machine = [step, other].map(|step| step.state.to_machine(step.end));
    let workpiece = [step, other].map(|step| step.state.to_workpiece(step.end));
    let has_same_origin = (state.work_offset, state.origin, state.origin_rotation)
        == (other_state.work_offset, other_state.origin, other_state.origin_rotation);
    let has_same_length = state.length == other_state.length;
    // An axis of the program moves several ones of the machine.
    let is_rotated = state.rotation != Rotation::Off
        || state.origin_rotation != 0.0
        || state.turns_with_workpiece();
    (0..6).filter(|axis| is_rotated || step.commanded[*axis]).all(|axis| {
        if machine.iter().all(|position| position[axis].is_some()) {
            return is_near(machine[0][axis], machine[1][axis]);
        }
        let uses_length = axis == 2 || axis < 2 && state.turns_with_workpiece();
        let is_unknown = workpiece.iter().all(|position| position[axis].is_none());
        is_unknown
            || is_near(workpiece[0][axis], workpiece[1][axis])
                && has_same_origin
                && (has_same_length || !uses_length)
    })
}
