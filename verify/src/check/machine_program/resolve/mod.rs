//! Steps in program coordinates, resolved to joint motions.

mod align;
mod blind_way;
mod frame;

use super::path;
use super::{BlindWay, StepFault, UnknownCause};
use crate::gcode::{
    self, BlockLine, Choice, ControlSetup, ControlState, Position, Rotation, Rule, Step, StepPath,
    Tcp, WorkOffset, Z_ALONE,
};
use crate::machine::{Chain, JointMotion, Joints, Letter, LimitViolation, Machine, Side};
use frame::Frame;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// The increment of angles, in degrees: nearer to half a turn a control may take either way.
const ANGLE_INCREMENT: f64 = 1e-3;

/// Greatest distance between the tool axis and z, as unit vectors, at which the tool is along z.
const UPRIGHT: f64 = 1e-9;

/// The motions of a step.
pub(super) enum Resolved {
    /// The motions, in order, each with a bound on its distance from that of the control, in mm.
    Motions(Vec<(JointMotion, f64)>),
    /// Rapid traverse of several axes whose rates are unknown.
    AnyRapid(Box<AnyRapid>),
    /// Any curve between the circles of an arc whose radii differ.
    Band(Band),
    /// Only the end is known: a motion that rests there.
    Arrival(Box<JointMotion>, UnknownCause),
    /// Only the direction is known: a motion from the start that goes as far as the axis can.
    Departure(Box<JointMotion>, UnknownCause),
    /// The end is unknown.
    Unknown(UnknownCause),
    /// A tool change: no motion of the program.
    ToolChange,
    /// A new tool in the spindle: it rests where the change has left the axes.
    Loaded(Box<JointMotion>),
}

impl Resolved {
    /// Returns whether a rotary axis is off 0.
    pub(super) fn is_turned(&self) -> bool {
        let is_turned = |motion: &JointMotion| {
            [0.0, 1.0].iter().any(|at| motion.joints(*at)[3..].iter().any(|angle| *angle != 0.0))
        };
        match self {
            Resolved::Motions(motions) | Resolved::Band(Band { motions, .. }) => {
                motions.iter().any(|(motion, _)| is_turned(motion))
            }
            Resolved::AnyRapid(any) => is_turned(&any.straight),
            Resolved::Arrival(motion, _)
            | Resolved::Departure(motion, _)
            | Resolved::Loaded(motion) => is_turned(motion),
            Resolved::Unknown(_) | Resolved::ToolChange => false,
        }
    }
}

/// An arc whose radii differ.
pub(super) struct Band {
    /// The motions along a spiral, as of other paths.
    pub(super) motions: Vec<(JointMotion, f64)>,
    /// Motions along arcs of the radii between, as near to each other as their errors say.
    pub(super) curves: Vec<(JointMotion, f64)>,
}

/// Rapid traverse of several axes whose rates are unknown.
pub(super) struct AnyRapid {
    /// The motion if all axes arrive together.
    pub(super) straight: JointMotion,
    /// What is checked of other rates.
    pub(super) other_rates: OtherRates,
}

/// What is checked of rapid traverse at other rates than those of a straight motion.
pub(super) enum OtherRates {
    /// The box of the axes' positions: the motions of each axis by itself from the start.
    Box(Vec<JointMotion>),
    /// The level of the way alone: the turn of a rotary axis spans no box.
    Level(BlindWay),
}

/// Resolves the steps of a program in their order.
pub(super) struct Resolver<'a> {
    machine: &'a Machine,
    setup: &'a ControlSetup,
    off_is_tip: bool,
    /// Origin of the part in machine coordinates.
    origin: [f64; 6],
    rapid: RapidPath,
    /// The rotary axes A, B, C without limits.
    endless: [bool; 3],
    /// The start of tool centre point control and of a tilted plane that are in force.
    turning: Turning,
    /// The cause for which coordinates are not followed while they are.
    unfollowed: Option<UnknownCause>,
    /// The tool in the spindle before the program names one, if it is known.
    unnamed_tool: Option<u32>,
    /// The rules of the control on which the steps depend, each with the first line.
    pub(super) asked: BTreeMap<Rule, BlockLine>,
    /// Set if a rotary axis carries the tool.
    has_head: bool,
    /// Set if the origin of the part on the machine is given.
    is_placed: bool,
    /// Set if it is not, and a rotary axis turns the part.
    part_position_unknown: bool,
    /// The meaning of the height at which the joints are.
    height: Height,
    /// The chain for the last tool length.
    chain: Option<(f64, Chain)>,
    /// The height of the spindle's gauge point while Z is at the top of its travel or at a reference position, to which the program has
    /// moved it.
    at_top: Option<f64>,
    /// That before the last step.
    was_at_top: Option<f64>,
    /// The last step, if X, Y or rotary axes are not known on it, and Z is.
    pub(super) blind_way: Option<BlindWay>,
    /// The last step, if it leaves for a reference position that is not known, in more axes than Z.
    pub(super) way_home: Option<BlindWay>,
    /// The known motions of the last step, if the spindle is empty.
    pub(super) empty_way: Option<BlindWay>,
    /// The joint values after the last step, as far as they are known.
    joints: Position,
    /// The reason for which others are not.
    cause: UnknownCause,
}

/// The meaning of Z of the joints.
#[derive(Clone, Copy, PartialEq)]
enum Height {
    /// The axis, by a length that is stated or by machine coordinates.
    OfAxis,
    /// The tip of a tool: the axis is higher by its length, which is not stated.
    OfTip(Option<u32>),
}

/// The path of several axes in rapid traverse.
enum RapidPath {
    Straight,
    /// Each axis at its rate.
    Rates(Joints),
    /// Each axis at a rate that is not known.
    Any,
}

/// The words by which positions turn with the table.
#[derive(Clone, Default, PartialEq)]
struct Turning {
    /// The start of tool centre point control.
    tcp: Option<usize>,
    /// The start of a tilted plane, and its frame.
    plane: Option<(usize, gcode::Frame)>,
}

/// A value that follows from the program, unless only the machine knows it.
enum Located<T> {
    Known(T),
    Unknown(UnknownCause),
}

impl<'a> Resolver<'a> {
    /// Creates a resolver. `off_is_tip` is set for programs without length offsets: positions are then those of the tip.
    pub(super) fn new(
        machine: &'a Machine,
        setup: &'a ControlSetup,
        off_is_tip: bool,
        unnamed_tool: Option<u32>,
    ) -> Resolver<'a> {
        let origin = setup.work_offsets[0].unwrap_or_default();
        let mut joints = [None; 6];
        for (joint, (start, origin)) in joints.iter_mut().zip(setup.start.iter().zip(origin)) {
            *joint = start.map(|start| start + origin);
        }
        Resolver {
            machine,
            setup,
            off_is_tip,
            origin,
            rapid: match (setup.rules.get(Rule::Rapid), path::rates(machine)) {
                (Some(Choice::Straight), _) => RapidPath::Straight,
                (_, Some(rates)) => RapidPath::Rates(rates),
                (_, None) => RapidPath::Any,
            },
            endless: [Letter::A, Letter::B, Letter::C]
                .map(|letter| machine.axis(letter).is_some_and(|axis| axis.limits.is_none())),
            turning: Turning::default(),
            unfollowed: None,
            unnamed_tool,
            asked: BTreeMap::new(),
            has_head: machine.has_rotary(Side::Tool),
            is_placed: setup.work_offsets[0].is_some(),
            part_position_unknown: setup.work_offsets[0].is_none()
                && machine.has_rotary(Side::Table),
            height: Height::OfAxis,
            at_top: None,
            was_at_top: None,
            blind_way: None,
            way_home: None,
            empty_way: None,
            chain: None,
            joints,
            cause: UnknownCause::Start,
        }
    }

    /// Resolves a step.
    ///
    /// # Errors
    /// If the motion is not possible on the machine, or a length or an origin is missing.
    pub(super) fn resolve(&mut self, step: &Step) -> Result<Resolved, StepFault> {
        (self.blind_way, self.way_home, self.empty_way) = (None, None, None);
        let is_empty = self.setup.is_spindle_empty(step.state.tool);
        if !is_empty && self.cause.is_of_empty() {
            self.cause = UnknownCause::TipHeight;
        }
        if !matches!(step.path, StepPath::ToolChange(_)) {
            self.follow_height(step);
        }
        self.was_at_top = self.at_top;
        let before = self.joints;
        let resolved = self.resolve_step(step)?;
        if !matches!(resolved, Resolved::ToolChange | Resolved::Loaded(_)) {
            self.blind_way = self.blind_way(step, [before, self.joints]);
        }
        if is_empty {
            self.empty_way = self.empty_way(&resolved)?;
        }
        Ok(resolved)
    }

    /// Forgets a height that has another meaning for the length of a step: between the axis and the tip of a tool, or the tips of two, is a
    /// length that is not stated. At the top of Z's travel all tools are out of the way, and straight down from it.
    fn follow_height(&mut self, step: &Step) {
        let state = &step.state;
        // Without a meaning the frame says why.
        let Ok(Located::Known(lengths)) = self.lengths(state) else { return };
        let height = match lengths.is_known {
            true => Height::OfAxis,
            false => Height::OfTip(state.tool.or(self.unnamed_tool)),
        };
        if self.height == height {
            return;
        }
        if let Some(z) = self.joints[2] {
            // Positions of a part that turns move Z, those of the axes do not. In a tilted plane no length offset is read.
            let is_upright = !state.turns_with_workpiece()
                || matches!(step.path, StepPath::Machine(_) | StepPath::Align);
            let is_top = self.stands_high(z) && is_upright;
            if is_top && !step.commanded[2] {
                return;
            }
            // At any rates the axes are anywhere between their ends.
            let is_any = step.rapid && matches!(self.rapid, RapidPath::Any);
            let is_box = is_any && matches!(step.path, StepPath::Line);
            if !(is_top && (step.commanded == Z_ALONE || is_box)) {
                (self.joints[2], self.at_top) = (None, None);
                // The height before a tool is named is the operator's.
                self.cause = match self.height {
                    Height::OfTip(None) => UnknownCause::Start,
                    _ => UnknownCause::TipHeight,
                };
            }
        }
        self.height = height;
    }

    fn resolve_step(&mut self, step: &Step) -> Result<Resolved, StepFault> {
        if step.commanded[2] {
            let height = step.machine_height.unwrap_or(self.reference_height());
            self.at_top = step.is_homeward.then_some(height);
        }
        if let StepPath::ToolChange(target) = step.path {
            if !step.commanded.contains(&true) {
                return self.load(step);
            }
            let before = self.joints;
            for k in (0..6).filter(|k| step.commanded[*k]) {
                // Without the place of the part, machine coordinates lead nowhere that is known.
                self.joints[k] = target[k].filter(|_| self.is_placed);
                if self.joints[k].is_none() {
                    self.cause = UnknownCause::ToolChange;
                }
                if k == 2 {
                    self.height = Height::OfAxis;
                }
            }
            // At the reference position of Z other axes are free, too.
            let height = self.joints[2].filter(|z| step.commanded[2] && self.is_high(*z));
            self.at_top = height.or(self.at_top);
            self.leave_plane(step, &before);
            return Ok(Resolved::ToolChange);
        }
        // Machine coordinates are those of the axes, wherever the table stands.
        let unfollowed = self.unfollowed(step);
        if let Some(cause) = unfollowed.filter(|_| !matches!(step.path, StepPath::Machine(_))) {
            return Ok(self.lose(cause));
        }
        let frame = match self.frame(step)? {
            Located::Known(frame) => frame,
            Located::Unknown(cause) => {
                let (joints, known_cause) = (self.joints, self.cause);
                let lost = self.lose_linear(step, cause);
                // The axis goes to its own place, whatever the length is, and the others rest.
                if step.commanded == Z_ALONE && self.end_at_top(step).is_some() {
                    (self.joints, self.cause) = (joints, known_cause);
                    self.rise_to_top(step);
                }
                // The way home of machine coordinates is the same with and without the length offset: of Z alone, and of others at its top.
                let is_free = self.is_way_home_free(step);
                return Ok(match cause {
                    _ if cause.is_of_empty() && step.is_homeward && is_free => {
                        Resolved::Unknown(UnknownCause::Home)
                    }
                    UnknownCause::NoOffset { .. } if step.is_homeward && is_free => {
                        Resolved::Unknown(UnknownCause::Home)
                    }
                    _ => lost,
                });
            }
        };
        match step.path {
            StepPath::Machine(target) => return self.move_axes(&frame, step, &target),
            StepPath::Align => return self.align(&frame, step),
            StepPath::Pivot { distance } => return self.pivot(&frame, step, distance),
            _ => {}
        }
        let current = self.current_position(&frame);
        let mut ends = match self.ends(step, &frame, &current)? {
            Located::Known(ends) => ends,
            Located::Unknown(cause) => return Ok(self.lose(cause)),
        };
        if self.is_length_along_z(step, &frame, [&ends[0], &ends[1]]) {
            return Ok(self.lose(UnknownCause::HeadLength));
        }
        let mut unknown_path = self.turn_endless(step, &frame, &mut ends);
        if step.tool_vector.is_some() {
            let angles = [3, 4, 5].map(|k| ends[1][k].map(|angle| angle + frame.rotary[k - 3]));
            unknown_path = unknown_path.or(self.half_turn(&angles));
        }
        let [start, end] = ends.map(|position| known(&position));
        let Some(end) = end else {
            self.forget(&frame, &ends[1]);
            self.rise_to_top(step);
            let cause = self.unknown_end(step, &current);
            return match start.filter(|_| cause == UnknownCause::Home) {
                Some(start) => self.leave(step, &frame, frame.joints(start)),
                None => Ok(Resolved::Unknown(cause)),
            };
        };
        self.refuse_unknown_levers(&frame, start, end)?;
        if step.state.tcp == Tcp::Transformation
            && start.is_some_and(|start| start[3..] != end[3..])
            && self.orientation(step) == Some(Choice::GreatCircle)
        {
            unknown_path = Some(UnknownCause::GreatCircle);
        }
        let is_undetermined = matches!(step.path, StepPath::Undetermined);
        if is_undetermined && start.is_some() {
            unknown_path = Some(UnknownCause::ArcStart);
        }
        let is_determined = !is_undetermined && unknown_path.is_none();
        let resolved = match start.filter(|_| is_determined) {
            Some(start) => self.motion(step, &frame, [start, end])?,
            // The way is not known, but its end: the tool is checked at rest there.
            None => {
                let (rest, _) = frame.motions(&StepPath::Line, [end, end])?.swap_remove(0);
                Resolved::Arrival(Box::new(rest), unknown_path.unwrap_or(self.cause))
            }
        };
        self.arrive(&frame, &resolved);
        Ok(resolved)
    }

    /// Resolves a motion of axes to machine coordinates, while positions turn with the workpiece: the others rest.
    fn move_axes(
        &mut self,
        frame: &Frame,
        step: &Step,
        target: &Position,
    ) -> Result<Resolved, StepFault> {
        if frame.has_unknown_lever {
            return Ok(self.lose(UnknownCause::NoLever));
        }
        let (current, before) = (self.current_position(frame), known(&self.joints));
        let mut ends = [self.joints; 2];
        for k in (0..6).filter(|k| step.commanded[*k]) {
            // Without the place of the part, machine coordinates lead nowhere that is known.
            ends[1][k] = target[k].filter(|_| self.is_placed);
        }
        if step.commanded[2] {
            // A place of the axis is none of a tip, but straight up at the top.
            if self.height != Height::OfAxis {
                let is_free = step.commanded == Z_ALONE;
                ends[1][2] = ends[1][2].filter(|z| is_free && self.is_high(*z));
            }
            self.height = Height::OfAxis;
        }
        let shifted = |position: Position, sign: f64| {
            let origins = [0.0, 0.0, 0.0, frame.rotary[0], frame.rotary[1], frame.rotary[2]];
            [0, 1, 2, 3, 4, 5].map(|k| position[k].map(|value| value + sign * origins[k]))
        };
        let mut programmed = ends.map(|position| shifted(position, -1.0));
        let unknown_path = self.turn_endless(step, frame, &mut programmed);
        let start = known(&shifted(programmed[0], 1.0));
        self.joints = ends[1];
        self.leave_plane(step, &ends[0]);
        let Some(end) = known(&self.joints) else {
            let cause = self.unknown_end(step, &current);
            return match before.filter(|_| cause == UnknownCause::Home) {
                Some(start) => self.leave(step, frame, start),
                None => Ok(Resolved::Unknown(cause)),
            };
        };
        match start.filter(|_| unknown_path.is_none()) {
            Some(start) if step.rapid => self.rapid(step, &frame.chain, [start, end]),
            Some(start) => {
                Ok(Resolved::Motions(vec![(path::line(&frame.chain, [start, end])?, 0.0)]))
            }
            None => {
                let rest = path::line(&frame.chain, [end, end])?;
                Ok(Resolved::Arrival(Box::new(rest), unknown_path.unwrap_or(self.cause)))
            }
        }
    }

    /// Resolves the way from known joints to a reference position that is not known. Z alone goes straight up, and is followed as
    /// far as its travel is long. With other axes the way goes in any direction; where it begins is noted.
    fn leave(&mut self, step: &Step, frame: &Frame, joints: Joints) -> Result<Resolved, StepFault> {
        /// The travel of Z where it is not stated, in mm.
        const TRAVEL: f64 = 1000.0;
        let chain = frame.chain.without_linear_limits();
        if step.commanded != Z_ALONE {
            self.way_home = Some(BlindWay {
                levels: self.levels(&chain, &joints),
                is_at_top: self.stands_high(joints[2]),
            });
            return Ok(Resolved::Unknown(UnknownCause::Home));
        }
        let limits = self.machine.axis(Letter::Z).and_then(|axis| axis.limits);
        let mut end = joints;
        end[2] = match limits {
            // It ends at the top, where the place of Z is known.
            Some([_, high]) if self.is_placed && self.height == Height::OfAxis => {
                high.max(joints[2])
            }
            Some([low, high]) => joints[2] + (high - low),
            None => joints[2] + TRAVEL,
        };
        let rise = path::line(&chain, [joints, end])?;
        Ok(Resolved::Departure(Box::new(rise), UnknownCause::Home))
    }

    /// Returns the limits beyond which a step ends whose joints are known in part.
    pub(super) fn known_violations(&self, step: &Step) -> Vec<LimitViolation> {
        let axes = self.machine.axes().iter();
        let commanded = axes.filter(|axis| step.commanded[axis.letter.index()]);
        let violations = commanded.filter_map(|axis| {
            let value = self.joints[axis.letter.index()]?;
            let [low, high] = axis.limits?;
            // The axis is higher than the tip by a length that is not known.
            let is_tip = axis.letter == Letter::Z && self.height != Height::OfAxis;
            let low = if is_tip { f64::NEG_INFINITY } else { low };
            LimitViolation::of_joint(axis.letter, value, [low, high])
        });
        violations.collect()
    }

    /// Notes that a rotary axis has left an aligned plane, if it has moved.
    fn leave_plane(&mut self, step: &Step, before: &Position) {
        let is_aligned = matches!(step.state.rotation, Rotation::Tilted { aligned: true, .. });
        if is_aligned && before[3..] != self.joints[3..] {
            self.unfollowed = Some(UnknownCause::LeftPlane);
        }
    }

    /// Returns whether Z is at the top of its travel, which is at 0 where the machine does not state it.
    fn is_top(&self, z: f64) -> bool {
        self.is_placed && z >= self.setup.top.unwrap_or_default()
    }

    /// Returns whether Z is there or at its reference position, where tools are out of the way.
    fn is_high(&self, z: f64) -> bool {
        self.is_placed && z >= self.reference_height()
    }

    /// Returns whether Z is as high at a joint value, which is not that of the tip of a tool.
    fn stands_high(&self, z: f64) -> bool {
        self.height == Height::OfAxis && self.is_high(z)
    }

    /// Returns whether Z rests there during a step.
    fn rests_high(&self, step: &Step) -> bool {
        !step.state.turns_with_workpiece()
            && !step.commanded[2]
            && self.at_top.is_some()
            && self.joints[2].is_some_and(|z| self.stands_high(z))
    }

    /// Returns the place of Z's axis at the end of a step that leads to the top of its travel or its reference position, whatever its tool is.
    fn end_at_top(&self, step: &Step) -> Option<f64> {
        step.machine_height.filter(|z| step.is_homeward && self.is_high(*z))
    }

    /// Notes the place of Z's axis after a step that leads to the top of its travel.
    fn rise_to_top(&mut self, step: &Step) {
        if let Some(top) = self.end_at_top(step) {
            (self.joints[2], self.height) = (Some(top), Height::OfAxis);
        }
    }

    /// Returns the height of the reference position of Z, or of the top of its travel if that is lower.
    fn reference_height(&self) -> f64 {
        let top = self.setup.top.unwrap_or_default();
        self.setup.home[2].map_or(top, |home| home.min(top))
    }

    /// Returns whether nothing is in the way home from an unknown place: of Z alone, or of other axes at its top.
    fn is_way_home_free(&self, step: &Step) -> bool {
        self.was_at_top.is_some() || step.commanded == Z_ALONE
    }

    /// Returns whether an unknown motion is on the way from a tool change: that of Z to the top of its travel, or of other axes while it is
    /// there. That of an empty spindle from there to a known position (`arrives`) is judged by its end.
    pub(super) fn leaves_change(&self, step: &Step, cause: UnknownCause, arrives: bool) -> bool {
        let is_of_change = matches!(cause, UnknownCause::ToolChange | UnknownCause::TipHeight);
        // Without a tool the height matters alone, while nothing turns.
        let is_empty = self.setup.is_spindle_empty(step.state.tool)
            && !step.commanded[3..].contains(&true)
            && (is_of_change || cause == UnknownCause::Return || cause.is_of_empty());
        let goes_home = step.is_homeward && (is_empty || self.is_way_home_free(step));
        let stays_at_top = self.at_top.is_some() && (goes_home || !step.commanded[2]);
        step.rapid
            && ((is_of_change || is_empty) && stays_at_top
                || is_empty && arrives && self.was_at_top.is_some())
    }

    /// Resolves the rest of a new tool where its change has left the axes. Without their joints, or the lengths on which these depend,
    /// only the machine knows the place.
    fn load(&mut self, step: &Step) -> Result<Resolved, StepFault> {
        let length = step.state.tool.and_then(|tool| self.setup.lengths.get(&tool).copied());
        let joints = known(&self.joints).filter(|_| self.height == Height::OfAxis);
        let (Some(joints), Some(length)) = (joints, length) else {
            return Ok(Resolved::ToolChange);
        };
        if self.part_position_unknown && self.rotary(Side::Table).any(|k| joints[k] != 0.0) {
            return Ok(Resolved::Unknown(UnknownCause::NoPartPosition));
        }
        let chain = self.chain(length)?;
        Ok(Resolved::Loaded(Box::new(path::line(&chain, [joints, joints])?)))
    }

    /// Resolves a step whose coordinates only the machine knows. Angles stay known: they do not depend on lengths.
    fn lose_linear(&mut self, step: &Step, cause: UnknownCause) -> Resolved {
        // If the position was not known before either, that is the cause.
        if self.joints[2].is_some() || step.commanded[2] {
            self.cause = cause;
        }
        self.joints[..3].fill(None);
        for k in (3..6).filter(|k| step.commanded[*k]) {
            let terms = [step.end[k], self.rotary_origin(&step.state, k), step.state.shift[k]];
            self.joints[k] = terms.into_iter().sum();
        }
        Resolved::Unknown(self.cause)
    }

    /// Returns the start and the end of a step in program coordinates, as far as they are known. `current` is the position
    /// of the machine.
    fn ends(
        &self,
        step: &Step,
        frame: &Frame,
        current: &Position,
    ) -> Result<Located<[Position; 2]>, StepFault> {
        let (mut start, mut end) = (step.start, step.end);
        for k in 0..6 {
            // The machine knows where it is, also where the program does not.
            start[k] = current[k].or(start[k]);
            if end[k].is_none() && !step.commanded[k] {
                end[k] = start[k];
            }
        }
        // The program counts Z with an offset that may be that of another tool.
        if self.rests_high(step) {
            end[2] = start[2];
        }
        if let (Some(axis), Some([x, y, z, ..])) = (step.tool_vector, linear_only(&end)) {
            let near = self.joints.map(Option::unwrap_or_default);
            let tip = Point3::from(frame.map.apply([x, y, z]));
            let found = frame.guide.solutions(&tip, &Vector3::from(axis), &near)?;
            if !self.is_one_choice(&found) {
                return Ok(Located::Unknown(UnknownCause::TwoPositions));
            }
            let angles = self.angles(&found[0]);
            if angles.contains(&None) {
                return Ok(Located::Unknown(UnknownCause::Axis));
            }
            (3..6).for_each(|k| end[k] = angles[k - 3].map(|angle| angle - frame.rotary[k - 3]));
        }
        Ok(Located::Known([start, end]))
    }

    /// Refuses a step in which a rotary axis is not at 0 and turns the part, or the tool, about a distance that is unknown.
    /// Positions of the tip do not depend on it.
    fn refuse_unknown_levers(
        &self,
        frame: &Frame,
        start: Option<Joints>,
        end: Joints,
    ) -> Result<(), StepFault> {
        let is_turned = |side: Side| {
            start
                .iter()
                .chain([&end])
                .any(|position| self.rotary(side).any(|k| position[k] + frame.rotary[k - 3] != 0.0))
        };
        if !frame.is_tip && self.part_position_unknown && is_turned(Side::Table) {
            return Err(StepFault::NoPartPosition);
        }
        if !frame.is_tip && frame.has_unknown_lever && is_turned(Side::Tool) {
            return Err(StepFault::NoLength);
        }
        Ok(())
    }

    /// Resolves the motion of a step between two positions in program coordinates.
    fn motion(
        &mut self,
        step: &Step,
        frame: &Frame,
        ends: [Joints; 2],
    ) -> Result<Resolved, StepFault> {
        // Under tool centre point control rapid traverse is straight: Fanuc asks for that (parameter 1401). A path that is
        // stated, such as an arc at FMAX, is that of the control at any rate.
        let is_any_way = step.rapid && step.state.tcp == Tcp::Off;
        let (arcs, width) = path::band(&step.path, ends);
        if !arcs.is_empty() {
            let mut curves = Vec::new();
            for ends in arcs {
                let motions = frame.motions(&step.path, ends)?.into_iter();
                curves.extend(motions.map(|(motion, error)| (motion, error + width)));
            }
            let motions = frame.motions(&step.path, ends)?;
            return Ok(Resolved::Band(Band { motions, curves }));
        }
        if !(is_any_way && matches!(step.path, StepPath::Line)) {
            return Ok(Resolved::Motions(frame.motions(&step.path, ends)?));
        }
        let joints = if frame.is_tip {
            // In an aligned plane the rotary axes rest, and the others move each by itself.
            let (motion, _) = frame.motions(&StepPath::Line, ends)?.swap_remove(0);
            [0.0, 1.0].map(|at| motion.joints(at))
        } else {
            ends.map(|position| frame.joints(position))
        };
        self.rapid(step, &frame.chain, joints)
    }

    /// Notes the joints at the end of a motion.
    fn arrive(&mut self, frame: &Frame, resolved: &Resolved) {
        let last = match resolved {
            Resolved::Motions(motions) | Resolved::Band(Band { motions, .. }) => {
                motions.last().map(|(motion, _)| motion)
            }
            Resolved::AnyRapid(any) => Some(&any.straight),
            Resolved::Arrival(rest, _) => Some(&**rest),
            Resolved::Departure(..)
            | Resolved::Unknown(_)
            | Resolved::ToolChange
            | Resolved::Loaded(_) => None,
        };
        if let Some(last) = last {
            self.joints = last.joints(1.0).map(Some);
        }
        // The path of the tip is known without the length of the tool, the linear joints are not.
        if frame.is_tip && frame.has_unknown_lever {
            self.joints[..3].fill(None);
            self.cause = UnknownCause::NoLever;
        }
    }

    /// Returns the cause for which the end of a step is unknown that starts at `current`, and keeps that of later ones.
    fn unknown_end(&mut self, step: &Step, current: &Position) -> UnknownCause {
        let lost = || (0..6).filter(|k| step.commanded[*k] && step.end[*k].is_none());
        let mut known = (0..6).filter(|k| current[*k].is_some());
        let knows_axis = known.any(|k| self.machine.axis(Letter::ALL[k]).is_some());
        let is_start = self.cause == UnknownCause::Start;
        // A height that is forgotten is none at which other axes go home, nor is that of a tool change: with the tool in the spindle the
        // control does not change it. From there Z goes first, alone.
        let is_low = match self.cause {
            UnknownCause::TipHeight => !step.commanded[2],
            UnknownCause::ToolChange => !self.is_way_home_free(step),
            _ => false,
        };
        // The way to a reference position before the first position is the operator's, too.
        if lost().next().is_some() && self.end_at_top(step).is_none() && (!is_start || knows_axis) {
            self.cause = UnknownCause::Return;
        } else if is_start {
            // The block states its own axes: the unknown one is another axis of the machine.
            let mut commanded = (0..6).filter(|k| step.commanded[*k]).peekable();
            let is_known = commanded.peek().is_some() && commanded.all(|k| current[k].is_some());
            if is_known && !step.is_homeward {
                return UnknownCause::Axis;
            }
        }
        match step.is_homeward && !is_low && lost().all(|k| current[k].is_some()) {
            true => UnknownCause::Home,
            false => self.cause,
        }
    }

    /// Resolves rapid traverse of the axes from one joint position to another.
    fn rapid(
        &mut self,
        step: &Step,
        chain: &Chain,
        joints @ [start, end]: [Joints; 2],
    ) -> Result<Resolved, StepFault> {
        let moving: Vec<usize> = (0..6).filter(|k| start[*k] != end[*k]).collect();
        let rates = match &self.rapid {
            RapidPath::Rates(rates) => Some(rates),
            // One axis alone moves straight at any rate.
            RapidPath::Any if moving.len() > 1 => {
                let straight = path::line(chain, joints)?;
                let other_rates = if moving.iter().all(|k| *k < 3) {
                    let edges = moving.iter().map(|k| {
                        let mut to = start;
                        to[*k] = end[*k];
                        path::line(chain, [start, to])
                    });
                    OtherRates::Box(edges.collect::<Result<_, _>>()?)
                } else {
                    OtherRates::Level(self.level_way(chain, joints, start[2].min(end[2])))
                };
                return Ok(Resolved::AnyRapid(Box::new(AnyRapid { straight, other_rates })));
            }
            RapidPath::Any | RapidPath::Straight => None,
        };
        let motions = path::rapid(chain, rates, joints)?;
        // Several motions are those of axes that arrive at different times, which they do not on a straight path.
        if motions.len() > 1 {
            self.ask(Rule::Rapid, step);
        }
        Ok(Resolved::Motions(motions.into_iter().map(|motion| (motion, 0.0)).collect()))
    }

    /// Returns what the control does under a rule, if that is stated, and notes that a step depends on it.
    fn ask(&mut self, rule: Rule, step: &Step) -> Option<Choice> {
        self.note(rule, step);
        self.setup.rules.get(rule)
    }

    /// Notes that a step depends on a rule.
    pub(super) fn note(&mut self, rule: Rule, step: &Step) {
        self.asked.entry(rule).or_insert(step.block());
    }

    /// Returns whether the head tilts the tool under M428 at one of the ends of a step, and the control leaves its length along z.
    fn is_length_along_z(&mut self, step: &Step, frame: &Frame, ends: [&Position; 2]) -> bool {
        let rules = &self.setup.rules;
        let is_linuxcnc = rules.get(Rule::Dialect) == Some(Choice::Rs274Ngc)
            || rules.get(Rule::HeadLength) == Some(Choice::AlongZ);
        if !is_linuxcnc || step.state.tcp != Tcp::Rotary {
            return false;
        }
        let mut axes = self.machine.axes().iter();
        let is_tilted = axes.any(|axis| {
            let k = axis.letter.index();
            let turns = axis.letter.is_rotary() && axis.side == Side::Tool;
            turns
                && axis.direction.cross(&Vector3::z()).norm() > UPRIGHT
                && ends.iter().any(|end| end[k].is_some_and(|v| v + frame.rotary[k - 3] != 0.0))
        });
        is_tilted && self.ask(Rule::HeadLength, step) == Some(Choice::AlongZ)
    }

    /// Returns the tool axis between two positions: as the program states it, or as the control does it.
    fn orientation(&mut self, step: &Step) -> Option<Choice> {
        step.state.orientation.or_else(|| self.ask(Rule::ToolOrientation, step))
    }

    /// Notes that nothing tells where the axes are.
    fn lose(&mut self, cause: UnknownCause) -> Resolved {
        self.joints = [None; 6];
        self.cause = cause;
        Resolved::Unknown(cause)
    }

    /// Returns the cause for which the coordinates of a step are not followed: under tool centre point control, or in a tilted plane, that
    /// began while the table was turned, if the control takes them as those of the part as it stood then; in a plane that a rotary axis has
    /// left, until the axes are aligned anew or positions turn no longer.
    fn unfollowed(&mut self, step: &Step) -> Option<UnknownCause> {
        let state = &*step.state;
        let turning = Turning {
            tcp: (state.tcp != Tcp::Off).then_some(state.tcp_starts),
            plane: match state.rotation {
                Rotation::Tilted { frame, .. } => Some((state.plane_starts, frame)),
                Rotation::Off | Rotation::Plane { .. } => None,
            },
        };
        let aligns = matches!(step.path, StepPath::Align | StepPath::Pivot { .. });
        let stays_out = self.unfollowed == Some(UnknownCause::LeftPlane)
            && state.turns_with_workpiece()
            && !(aligns && step.commanded[3..].contains(&true));
        if turning == Turning::default() {
            self.unfollowed = None;
        } else if turning != self.turning && !stays_out {
            // A table that turns in the block counts at its end, but for the alignment with a plane.
            let is_turned = self.rotary(Side::Table).any(|k| {
                self.joints[k] != Some(self.origin[k])
                    || !aligns && step.commanded[k] && step.end[k] != Some(0.0)
            });
            let stands =
                is_turned && self.ask(Rule::TcpStart, step) == Some(Choice::TableAsItStands);
            self.unfollowed = stands.then_some(UnknownCause::TurnedTable);
        }
        self.turning = turning;
        self.unfollowed
    }

    /// Counts the angles at the start so that the ways of endless axes to stated angles are those of the control. Returns
    /// the cause for which one is not known.
    fn turn_endless(
        &mut self,
        step: &Step,
        frame: &Frame,
        [start, end]: &mut [Position; 2],
    ) -> Option<UnknownCause> {
        let mut cause = None;
        let endless = self.endless;
        // Heidenhain counts a turn from the datum, by which it displays the axis. Others may count it on the machine.
        let is_of_datum = self.setup.rules.get(Rule::Dialect) == Some(Choice::Heidenhain);
        for k in (3..6).filter(|k| step.absolute && step.commanded[*k] && endless[k - 3]) {
            let (Some(from), Some(to)) = (start[k], end[k]) else { continue };
            // The angles of a tool vector are the control's own, which are the nearest.
            if step.tool_vector.is_some() && step.end[k].is_none() {
                continue;
            }
            let turn = to - from;
            // Fanuc turns it in the direction of the reference position.
            if step.is_return
                && turn.abs() >= ANGLE_INCREMENT
                && self.ask(Rule::Rotary, step) != Some(Choice::Counts)
            {
                cause = Some(UnknownCause::ReturnWay);
                continue;
            }
            let within_from =
                |origin: f64| (to + origin).rem_euclid(360.0) - (from + origin).rem_euclid(360.0);
            let within = within_from(0.0);
            let on_machine = if is_of_datum { within } else { within_from(frame.rotary[k - 3]) };
            // Every choice is the same way.
            if turn.abs() < 180.0 - ANGLE_INCREMENT
                && [within, on_machine].iter().all(|way| (way - turn).abs() < ANGLE_INCREMENT)
            {
                continue;
            }
            let way = match step.shortest[k] || step.state.shorter_way {
                true => Some(Choice::Shortest),
                false => self.ask(Rule::Rotary, step),
            };
            match way {
                Some(Choice::Shortest) => {
                    let shorter = turn - 360.0 * (turn / 360.0).round();
                    start[k] = Some(to - shorter);
                    if shorter.abs() >= 180.0 - ANGLE_INCREMENT {
                        cause = Some(UnknownCause::HalfTurn);
                    }
                }
                Some(Choice::WithinTurn) => {
                    start[k] = Some(to - within);
                    if (within - on_machine).abs() >= ANGLE_INCREMENT {
                        cause = Some(UnknownCause::TurnOrigin);
                    }
                }
                _ => {}
            }
        }
        cause
    }

    /// Returns whether the machine has an axis, by its index.
    fn has_axis(&self, axis: usize) -> bool {
        self.machine.axis(Letter::ALL[axis]).is_some()
    }

    /// Returns the indices of the rotary joints of a side.
    fn rotary(&self, side: Side) -> impl Iterator<Item = usize> + '_ {
        let axes = self.machine.axes().iter();
        axes.filter(move |axis| axis.letter.is_rotary() && axis.side == side)
            .map(|axis| axis.letter.index())
    }

    /// Returns the origin of a work offset along a rotary axis, if it is known.
    fn rotary_origin(&self, state: &ControlState, axis: usize) -> Option<f64> {
        match state.work_offset == WorkOffset::Standard(1) {
            true => Some(self.origin[axis]),
            false => state.origin[axis],
        }
    }
}

/// Returns the coordinates if all are known.
fn known(position: &Position) -> Option<[f64; 6]> {
    let mut values = [0.0; 6];
    for (value, known) in values.iter_mut().zip(position) {
        *value = (*known)?;
    }
    Some(values)
}

/// Returns the position with rotary coordinates of 0, if X, Y and Z are known.
fn linear_only(position: &Position) -> Option<[f64; 6]> {
    known(&[position[0], position[1], position[2], Some(0.0), Some(0.0), Some(0.0)])
}
