//! Steps in program coordinates, resolved to joint motions.

use super::StepFault;
use super::path::{self, Map};
use super::rapid;
use crate::gcode::{
    self, ControlSetup, ControlState, LengthOffset, Position, Rotation, Step, StepPath, WorkOffset,
};
use crate::machine::{Chain, JointMotion, Joints, Letter, Machine, Setup, Side};
use nalgebra::{Matrix3, Point3, Vector3};
use std::collections::BTreeMap;

/// Tolerance of tool lengths, in mm: registers are set to 0.001 mm.
const LENGTH_TOLERANCE: f64 = 1e-3;

/// The motions of a step.
pub(super) enum Resolved {
    /// The motions, in order, each with a bound on its distance from that of the control, in mm.
    Motions(Vec<(JointMotion, f64)>),
    /// Only the end is known: a motion that rests there.
    Arrival(Box<JointMotion>),
    /// The end is unknown.
    Unknown,
}

impl Resolved {
    /// Returns the motions of axes from one joint position to another, at their rates.
    fn rapid(
        chain: &Chain,
        rates: Option<&Joints>,
        joints: [Joints; 2],
    ) -> Result<Resolved, StepFault> {
        let motions = rapid::motions(chain, rates, joints)?;
        Ok(Resolved::Motions(motions.into_iter().map(|motion| (motion, 0.0)).collect()))
    }
}

/// Resolves the steps of a program in their order.
pub(super) struct Resolver<'a> {
    machine: &'a Machine,
    lengths: &'a BTreeMap<u32, f64>,
    /// Origin of the part in machine coordinates.
    origin: [f64; 6],
    /// Rates of the axes in rapid traverse, if each moves at its own.
    rates: Option<Joints>,
    /// Set if a rotary axis carries the tool.
    has_head: bool,
    /// Set if the origin of the part on the machine is given.
    is_placed: bool,
    /// Set if it is not, and a rotary axis turns the part.
    part_position_unknown: bool,
    /// The chain for the last tool length.
    chain: Option<(f64, Chain)>,
    /// The joint values after the last step, as far as they are known.
    joints: Position,
}

/// The mapping of a step's coordinates.
struct Frame {
    chain: Chain,
    /// From program coordinates to linear joints, or to the tip in the part's frame.
    map: Map,
    /// From program coordinates to rotary joints.
    rotary: [f64; 3],
    /// Set if the map leads to the tip.
    is_tip: bool,
    /// Set if a rotary axis carries the tool, whose length is unknown.
    has_unknown_lever: bool,
}

/// The length of the tool in the spindle and the length offset, in mm.
struct Lengths {
    length: f64,
    offset: f64,
    is_known: bool,
}

impl<'a> Resolver<'a> {
    pub(super) fn new(machine: &'a Machine, setup: &'a ControlSetup) -> Resolver<'a> {
        let origin = setup.work_offsets[0].unwrap_or_default();
        let mut joints = [None; 6];
        for (joint, (start, origin)) in joints.iter_mut().zip(setup.start.iter().zip(origin)) {
            *joint = start.map(|start| start + origin);
        }
        let has_rotary = |side: Side| {
            machine.axes().iter().any(|axis| axis.letter.is_rotary() && axis.side == side)
        };
        Resolver {
            machine,
            lengths: &setup.lengths,
            origin,
            rates: rapid::rates(machine),
            has_head: has_rotary(Side::Tool),
            is_placed: setup.work_offsets[0].is_some(),
            part_position_unknown: setup.work_offsets[0].is_none() && has_rotary(Side::Table),
            chain: None,
            joints,
        }
    }

    /// Resolves a step.
    ///
    /// # Errors
    /// If the motion is not possible on the machine, or a length or an origin is missing.
    pub(super) fn resolve(&mut self, step: &Step) -> Result<Resolved, StepFault> {
        let Some(frame) = self.frame(&step.state)? else {
            // Only the machine knows what positions mean.
            self.joints = self.joints.map(|_| None);
            return Ok(Resolved::Unknown);
        };
        if matches!(step.path, StepPath::Align) {
            return self.align(&frame, &step.state);
        }
        let current = self.current_position(&frame);
        let mut ends = [step.start, step.end];
        for k in 0..6 {
            // The machine knows where it is, also where the program does not.
            ends[0][k] = current[k].or(ends[0][k]);
            if ends[1][k].is_none() && !step.commanded[k] {
                ends[1][k] = ends[0][k];
            }
        }
        if let (Some(axis), Some(end)) = (step.tool_vector, linear_only(&ends[1])) {
            let near = self.joints.map(Option::unwrap_or_default);
            let tip = Point3::from(frame.map.apply([end[0], end[1], end[2]]));
            let chain = self.limited(&frame.chain);
            let found = chain.inverse(&tip, &Vector3::from(axis), &near)?;
            (3..6).for_each(|k| ends[1][k] = Some(found.joints[k] - frame.rotary[k - 3]));
        }
        let [start, end] = ends.map(|position| known(&position));
        let Some(end) = end else {
            self.forget(&frame, &ends[1]);
            return Ok(Resolved::Unknown);
        };
        let turns = |side: Side| {
            let is_turned = |position: [f64; 6]| {
                self.rotary(side).any(|k| position[k] + frame.rotary[k - 3] != 0.0)
            };
            is_turned(end) || start.is_some_and(is_turned)
        };
        if !frame.is_tip && self.part_position_unknown && turns(Side::Table) {
            return Err(StepFault::NoPartPosition);
        }
        if !frame.is_tip && frame.has_unknown_lever && turns(Side::Tool) {
            return Err(StepFault::NoLength);
        }
        let is_determined = !matches!(step.path, StepPath::Undetermined);
        let resolved = match start.filter(|_| is_determined) {
            Some(start) => match &self.rates {
                Some(rates) if step.rapid && !frame.is_tip => {
                    let joints = [start, end].map(|position| frame.joints(position));
                    Resolved::rapid(&frame.chain, Some(rates), joints)?
                }
                _ => Resolved::Motions(frame.motions(&step.path, [start, end])?),
            },
            None => {
                let mut motions = frame.motions(&StepPath::Line, [end, end])?;
                let (rest, _) = motions.swap_remove(0);
                Resolved::Arrival(Box::new(rest))
            }
        };
        let last = match &resolved {
            Resolved::Motions(motions) => motions.last().map(|(motion, _)| motion),
            Resolved::Arrival(rest) => Some(&**rest),
            Resolved::Unknown => None,
        };
        if let Some(last) = last {
            self.joints = last.joints(1.0).map(Some);
        }
        if frame.is_tip && frame.has_unknown_lever {
            self.joints[..3].fill(None);
        }
        Ok(resolved)
    }

    /// Resolves the rotation that aligns the tool with z of a tilted plane, with the linear joints at rest.
    fn align(&mut self, frame: &Frame, state: &ControlState) -> Result<Resolved, StepFault> {
        let axis = match &state.rotation {
            Rotation::Tilted { frame, .. } => frame.rotation.column(2).into_owned(),
            Rotation::Off | Rotation::Plane { .. } => Vector3::z(),
        };
        let near = self.joints.map(Option::unwrap_or_default);
        // The angles do not depend on the tip, whose linear joints are not those of the machine at rest.
        let chain = frame.chain.without_linear_limits();
        let found = chain.inverse(&Point3::origin(), &axis, &near)?.joints;
        let before = known(&self.joints);
        (3..6).for_each(|k| self.joints[k] = Some(found[k]));
        let Some(joints) = before else { return Ok(Resolved::Unknown) };
        if self.part_position_unknown || frame.has_unknown_lever {
            return Ok(Resolved::Unknown);
        }
        let mut end = joints;
        end[3..].copy_from_slice(&found[3..]);
        Resolved::rapid(&frame.chain, self.rates.as_ref(), [joints, end])
    }

    /// Returns the indices of the rotary joints of a side.
    fn rotary(&self, side: Side) -> impl Iterator<Item = usize> + '_ {
        let axes = self.machine.axes().iter();
        axes.filter(move |axis| axis.letter.is_rotary() && axis.side == side)
            .map(|axis| axis.letter.index())
    }

    /// Returns a chain without the limits of linear axes if the position of the part on the machine is unknown.
    fn limited(&self, chain: &Chain) -> Chain {
        if self.is_placed { *chain } else { chain.without_linear_limits() }
    }

    /// Returns the mapping of a state's coordinates; `None` if only the machine knows it.
    fn frame(&mut self, state: &ControlState) -> Result<Option<Frame>, StepFault> {
        let is_tip = state.turns_with_workpiece();
        let Some(Lengths { length, offset, is_known }) = self.lengths(state)? else {
            return Ok(None);
        };
        let Some(shift) = self.known_in_machine(&state.shift) else { return Ok(None) };
        let chain = match &self.chain {
            Some((known, chain)) if *known == length => *chain,
            _ => {
                let setup = Setup { work_offset: self.origin, tool_length: length };
                let chain = self.machine.chain(&setup)?;
                self.chain = Some((length, chain));
                chain
            }
        };
        let offset_name = || state.work_offset.to_string();
        let origin = if state.work_offset == WorkOffset::Standard(1) {
            let differs = |k: usize| match state.origin[k] {
                Some(value) => !self.is_placed || value != self.origin[k],
                None => false,
            };
            if state.origin_rotation != 0.0 || (0..6).any(differs) {
                return Err(StepFault::MovedPart);
            }
            self.origin
        } else {
            match self.known_in_machine(&state.origin).filter(|_| self.is_placed) {
                Some(origin) => origin,
                None => return Err(StepFault::NoOrigin { offset: offset_name() }),
            }
        };
        let (turn, about) = match state.rotation.frame() {
            Some(frame) => (frame.rotation, frame.origin),
            None => (Matrix3::identity(), Vector3::zeros()),
        };
        let about = about + Vector3::new(shift[0], shift[1], shift[2]);
        let mut linear = Vector3::new(origin[0], origin[1], origin[2]);
        if is_tip {
            let is_turned = origin[3..] != self.origin[3..] || shift[3..] != [0.0; 3];
            if state.origin_rotation != 0.0 || is_turned {
                return Err(StepFault::TurnedOffset { offset: offset_name() });
            }
            linear -= Vector3::new(self.origin[0], self.origin[1], self.origin[2]);
        } else {
            linear.z += offset;
        }
        let map = if state.origin_rotation == 0.0 {
            Map { rotation: turn, origin: about + linear }
        } else {
            let turned = gcode::about(2, state.origin_rotation);
            Map { rotation: turned * turn, origin: turned * about + linear }
        };
        let rotary = [3, 4, 5].map(|k| origin[k] + shift[k]);
        let has_unknown_lever = self.has_head && !is_known;
        Ok(Some(Frame { chain, map, rotary, is_tip, has_unknown_lever }))
    }

    /// Returns the coordinates, if those of all axes of the machine are known. Others are 0.
    fn known_in_machine(&self, position: &Position) -> Option<[f64; 6]> {
        let mut values = *position;
        for (value, letter) in values.iter_mut().zip(Letter::ALL) {
            if self.machine.axis(letter).is_none() {
                *value = value.or(Some(0.0));
            }
        }
        known(&values)
    }

    /// Returns the length of the tool in the spindle and the length offset; `None` if the offset is that of another tool
    /// and one of both is unknown. If neither is known, both count as 0: the tip is then where the program says.
    fn lengths(&self, state: &ControlState) -> Result<Option<Lengths>, StepFault> {
        let known = state.tool.and_then(|tool| self.lengths.get(&tool).copied());
        let of = |length: f64, offset: f64, is_known: bool| Lengths { length, offset, is_known };
        let lengths = match (state.length, known) {
            (LengthOffset::Off, Some(length)) => of(length, 0.0, true),
            (LengthOffset::Off, None) => of(0.0, 0.0, false),
            (LengthOffset::On { length: Some(offset), .. }, Some(length)) => {
                of(length, offset, true)
            }
            (LengthOffset::On { register, length: offset }, length) => {
                if state.tool.is_some_and(|tool| tool != register) {
                    return Ok(None);
                }
                let known = offset.or(length);
                of(known.unwrap_or(0.0), known.unwrap_or(0.0), known.is_some())
            }
        };
        let Lengths { length, offset, .. } = lengths;
        if let (LengthOffset::On { register, .. }, Some(tool)) = (state.length, state.tool)
            && state.turns_with_workpiece()
            && (length - offset).abs() > LENGTH_TOLERANCE
        {
            return Err(StepFault::Length { register, offset, tool, length });
        }
        Ok(Some(lengths))
    }

    /// Returns the register of a length offset that is not that of the tool in the spindle, if both lengths are known.
    pub(super) fn other_length(&self, state: &ControlState) -> Option<(u32, u32)> {
        let (LengthOffset::On { register, length: Some(offset) }, Some(tool)) =
            (state.length, state.tool)
        else {
            return None;
        };
        let length = self.lengths.get(&tool)?;
        ((length - offset).abs() > LENGTH_TOLERANCE).then_some((register, tool))
    }

    /// Returns the position of the machine in program coordinates, as far as it is known.
    fn current_position(&self, frame: &Frame) -> Position {
        let angle = |k: usize| self.joints[k].map(|angle| angle - frame.rotary[k - 3]);
        let with_linear = |[x, y, z]: [Option<f64>; 3]| [x, y, z, angle(3), angle(4), angle(5)];
        let back = |position: Vector3<f64>| -> [Option<f64>; 3] {
            let linear = frame.map.rotation.transpose() * (position - frame.map.origin);
            [0, 1, 2].map(|k| Some(linear[k]))
        };
        if frame.is_tip {
            let joints = known(&self.joints).filter(|_| !frame.has_unknown_lever);
            let pose = joints.and_then(|joints| frame.chain.pose(&joints).ok());
            return with_linear(pose.map_or([None; 3], |pose| back(pose.tip().coords)));
        }
        if frame.is_plain() {
            let linear = |k: usize| self.joints[k].map(|value| value - frame.map.origin[k]);
            return with_linear([0, 1, 2].map(linear));
        }
        let linear = linear_only(&self.joints);
        with_linear(linear.map_or([None; 3], |[x, y, z, ..]| back(Vector3::new(x, y, z))))
    }

    /// Keeps the joints that are known at an end that is not known in all axes.
    fn forget(&mut self, frame: &Frame, end: &Position) {
        self.joints = [0, 1, 2, 3, 4, 5].map(|k| match k {
            0..3 => end[k].filter(|_| frame.is_plain()).map(|value| value + frame.map.origin[k]),
            _ => end[k].map(|angle| angle + frame.rotary[k - 3]),
        });
    }
}

impl Frame {
    /// Returns whether each linear joint depends on one coordinate alone.
    fn is_plain(&self) -> bool {
        !self.is_tip && self.map.rotation == Matrix3::identity()
    }

    /// Returns the joints at a position in program coordinates.
    fn joints(&self, position: Joints) -> Joints {
        let [x, y, z] = self.map.apply([position[0], position[1], position[2]]);
        let [a, b, c] = [3, 4, 5].map(|k| position[k] + self.rotary[k - 3]);
        [x, y, z, a, b, c]
    }

    /// Returns the motions between two positions in program coordinates.
    fn motions(
        &self,
        path: &StepPath,
        [start, end]: [Joints; 2],
    ) -> Result<Vec<(JointMotion, f64)>, StepFault> {
        let linear = [start, end].map(|position| [position[0], position[1], position[2]]);
        let angles = |at: f64| {
            [3, 4, 5].map(|k| {
                let value = if at == 1.0 { end[k] } else { start[k] + at * (end[k] - start[k]) };
                value + self.rotary[k - 3]
            })
        };
        let motion = |segment: path::Segment| {
            let rotary = segment.fractions.map(angles);
            let motion = match self.is_tip {
                true => JointMotion::with_tcp(&self.chain, rotary, &segment.path)?,
                false => JointMotion::new(&self.chain, rotary, &segment.path)?,
            };
            Ok((motion, segment.error))
        };
        path::map(path, linear, &self.map)?.into_iter().map(motion).collect()
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
