//! The mapping of a step's coordinates to joints.

use super::super::path::{self, Map};
use super::super::{StepFault, UnknownCause};
use super::{Located, Resolver, UPRIGHT, known, linear_only};
use crate::gcode::{
    self, Choice, ControlState, LengthOffset, Position, Rotation, Rule, Step, StepPath, Tcp,
    WorkOffset,
};
use crate::machine::{Chain, JointMotion, Joints, Letter, Setup, Side};
use nalgebra::{Matrix3, Vector3};

/// Tolerance of tool lengths, in mm: registers are set to 0.001 mm.
const LENGTH_TOLERANCE: f64 = 1e-3;

/// The mapping of a step's coordinates.
pub(super) struct Frame {
    pub(super) chain: Chain,
    /// From program coordinates to linear joints, or to the tip in the part's frame.
    pub(super) map: Map,
    /// From program coordinates to rotary joints.
    pub(super) rotary: [f64; 3],
    /// Set if the map leads to the tip.
    pub(super) is_tip: bool,
    /// Set if a rotary axis carries the tool, whose length is unknown.
    pub(super) has_unknown_lever: bool,
    /// The chain of a tool as long as the length offset, whose tip is where the program says under tool centre point control. The
    /// offset may differ from the length by the rounding of registers.
    pub(super) guide: Chain,
}

/// The length of the tool in the spindle and the length offset, in mm.
pub(super) struct Lengths {
    length: f64,
    offset: f64,
    pub(super) is_known: bool,
}

impl Resolver<'_> {
    /// Returns the mapping of a state's coordinates; the cause if only the machine knows it.
    pub(super) fn frame(&mut self, step: &Step) -> Result<Located<Frame>, StepFault> {
        let state = &*step.state;
        let is_tip = state.turns_with_workpiece();
        let lengths = match self.lengths(state)? {
            // Z rests, so that its offset does not matter.
            Located::Unknown(UnknownCause::NoOffset { .. } | UnknownCause::OtherOffset { .. })
                if self.rests_high(step) =>
            {
                let length = self.stated_length(state);
                Lengths { length: length.unwrap_or(0.0), offset: 0.0, is_known: length.is_some() }
            }
            Located::Known(lengths) => lengths,
            Located::Unknown(cause) => return Ok(Located::Unknown(cause)),
        };
        let Lengths { length, offset, is_known } = lengths;
        let Some(shift) = self.known_in_machine(&state.shift) else {
            return Ok(Located::Unknown(UnknownCause::Shift));
        };
        let guide = if is_tip { Some(self.chain(offset)?) } else { None };
        let chain = self.chain(length)?;
        // The axis is higher than the tip by a length that is not known. Machine coordinates are those of the axis.
        let is_of_axis = is_known || matches!(step.path, StepPath::Machine(_));
        let chain = match is_of_axis {
            true => chain,
            // The tool is a lever.
            false if is_tip && self.has_head => chain.without_linear_limits(),
            false => chain.without_lower_z_limit(),
        };
        let guide = guide.unwrap_or(chain);
        let origin = if state.work_offset == WorkOffset::Standard(1) {
            // G54 is the frame of the part: the program may set it to the same values, and to no others.
            let mut origin = state.origin.iter().zip(&self.origin);
            let is_moved = origin
                .any(|(set, stated)| set.is_some_and(|value| !self.is_placed || value != *stated));
            if state.origin_rotation != 0.0 || is_moved {
                return Err(StepFault::MovedPart);
            }
            self.origin
        } else {
            match self.known_in_machine(&state.origin).filter(|_| self.is_placed) {
                Some(origin) => origin,
                None => {
                    return Err(StepFault::NoOrigin { offset: state.work_offset });
                }
            }
        };
        let (turn, about) = match state.rotation.frame() {
            Some(frame) => (frame.rotation, frame.origin),
            None => (Matrix3::identity(), Vector3::zeros()),
        };
        let about = about + Vector3::new(shift[0], shift[1], shift[2]);
        let mut linear = Vector3::new(origin[0], origin[1], origin[2]);
        // A plane is aligned with the axes of the part, as positions of the tip are counted along them.
        let aligns = matches!(step.path, StepPath::Align | StepPath::Pivot { .. });
        let is_of_part = is_tip || aligns && matches!(state.rotation, Rotation::Tilted { .. });
        let has_rotary_offset = origin[3..] != self.origin[3..] || shift[3..] != [0.0; 3];
        // The part stands at the offset, if it is taken with the table as it stands.
        let is_table_turned = is_tip
            && self.rotary(Side::Table).any(|k| origin[k] != 0.0)
            && self.ask(Rule::TcpStart, step) != Some(Choice::TableAsItStands);
        if is_table_turned || is_of_part && (has_rotary_offset || state.origin_rotation != 0.0) {
            return Err(StepFault::TurnedOffset { offset: state.work_offset });
        }
        if is_tip {
            // The origin of the part's frame is that of G54.
            linear -= Vector3::new(self.origin[0], self.origin[1], self.origin[2]);
        } else {
            linear.z += offset;
        }
        let map = if state.origin_rotation == 0.0 {
            Map { rotation: turn, origin: about + linear }
        } else {
            let origin_turn = gcode::about(2, state.origin_rotation);
            Map { rotation: origin_turn * turn, origin: origin_turn * about + linear }
        };
        let rotary = [3, 4, 5].map(|k| origin[k] + shift[k]);
        let has_unknown_lever = self.has_head && !is_known;
        Ok(Located::Known(Frame { chain, guide, map, rotary, is_tip, has_unknown_lever }))
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

    /// Returns the length of the tool in the spindle and the length offset; the cause if only the machine knows where the
    /// tip is. If neither is known, both count as 0: the tip is then where the program says. Without an offset this holds
    /// for a program that names no tool: Z of the work offset is then that of the tip.
    pub(super) fn lengths(&self, state: &ControlState) -> Result<Located<Lengths>, StepFault> {
        let tool = state.tool.or(self.unnamed_tool);
        let known = self.stated_length(state);
        // Without a tool, Z is that of the gauge point, if that has a place and the offset is known.
        if self.setup.is_spindle_empty(state.tool) {
            match state.length {
                _ if known.is_none() => return Ok(Located::Unknown(UnknownCause::EmptySpindle)),
                LengthOffset::On { register, length: None } => {
                    return Ok(Located::Unknown(UnknownCause::EmptyOffset { register }));
                }
                LengthOffset::Off | LengthOffset::On { .. } => {}
            }
        }
        let lengths = match (state.length, known) {
            // The tip would be that of a tool without length. In a plane the gauge point is where the program says.
            (LengthOffset::Off, Some(length)) if state.tcp != Tcp::Off && length != 0.0 => {
                return Ok(Located::Unknown(UnknownCause::TcpWithoutLength));
            }
            (LengthOffset::Off, Some(length)) => Lengths { length, offset: 0.0, is_known: true },
            (LengthOffset::Off, None) => match tool {
                Some(tool) if !self.off_is_tip => {
                    return Ok(Located::Unknown(UnknownCause::NoOffset { tool }));
                }
                _ => Lengths { length: 0.0, offset: 0.0, is_known: false },
            },
            (LengthOffset::On { length: Some(offset), .. }, Some(length)) => {
                Lengths { length, offset, is_known: true }
            }
            (LengthOffset::On { register, length: offset }, length) => {
                if let Some(tool) = tool.filter(|tool| *tool != register) {
                    return Ok(Located::Unknown(UnknownCause::OtherOffset { tool, register }));
                }
                // The offset in the tool's own register is its length, so that one of them tells both.
                let known = offset.or(length);
                let length = known.unwrap_or(0.0);
                Lengths { length, offset: length, is_known: known.is_some() }
            }
        };
        let Lengths { length, offset, .. } = lengths;
        if let (LengthOffset::On { register, .. }, Some(tool)) = (state.length, state.tool)
            && state.turns_with_workpiece()
            && (length - offset).abs() > LENGTH_TOLERANCE
        {
            return Err(StepFault::Length { register, offset, tool, length });
        }
        Ok(Located::Known(lengths))
    }

    /// Returns the stated length of the tool in the spindle, in mm.
    fn stated_length(&self, state: &ControlState) -> Option<f64> {
        let tool = state.tool.or(self.unnamed_tool)?;
        self.setup.lengths.get(&tool).copied()
    }

    /// Returns whether the length of the tool in the spindle is known: it is stated, or the offset in the tool's own register is.
    pub(in crate::check::machine_program) fn has_length(&self, state: &ControlState) -> bool {
        self.stated_length(state).is_some()
            || matches!(self.lengths(state), Ok(Located::Known(Lengths { is_known: true, .. })))
    }

    /// Returns the register of a length offset that is not that of the tool in the spindle, if both lengths are known.
    pub(in crate::check::machine_program) fn other_length(
        &self,
        state: &ControlState,
    ) -> Option<(u32, u32)> {
        let (LengthOffset::On { register, length: Some(offset) }, Some(tool)) =
            (state.length, state.tool.or(self.unnamed_tool))
        else {
            return None;
        };
        let length = self.stated_length(state)?;
        ((length - offset).abs() > LENGTH_TOLERANCE).then_some((register, tool))
    }

    /// Returns the position of the machine in program coordinates, as far as it is known.
    pub(super) fn current_position(&self, frame: &Frame) -> Position {
        let mut position = self.joints;
        for (k, angle) in position.iter_mut().enumerate().skip(3) {
            *angle = angle.map(|angle| angle - frame.rotary[k - 3]);
        }
        if frame.is_plain() {
            // Each axis is known by itself.
            for (k, value) in position.iter_mut().enumerate().take(3) {
                *value = value.map(|value| value - frame.map.origin[k]);
            }
            return position;
        }
        let mapped = if frame.is_tip {
            let joints = known(&self.joints).filter(|_| !frame.has_unknown_lever);
            let pose = joints.and_then(|joints| frame.guide.pose(&joints).ok());
            pose.map(|pose| pose.tip().coords)
        } else {
            linear_only(&self.joints).map(|[x, y, z, ..]| Vector3::new(x, y, z))
        };
        let linear =
            mapped.map(|mapped| frame.map.rotation.transpose() * (mapped - frame.map.origin));
        for k in 0..3 {
            position[k] = linear.map(|linear| linear[k]);
        }
        if linear.is_none() && frame.is_tip && !frame.has_unknown_lever {
            position[2] = self.height_along_tool(frame);
        }
        position
    }

    /// Returns Z of the tip in program coordinates where X and Y of the machine are not known, and move across it.
    fn height_along_tool(&self, frame: &Frame) -> Option<f64> {
        let [_, _, rest @ ..] = self.joints;
        let [z, a, b, c] = rest;
        let height = |x: f64, y: f64| {
            let pose = frame.guide.pose(&[x, y, z?, a?, b?, c?]).ok()?;
            let tip = frame.map.rotation.transpose() * (pose.tip().coords - frame.map.origin);
            Some(tip.z)
        };
        let [from, beside @ ..] = [height(0.0, 0.0)?, height(1.0, 0.0)?, height(0.0, 1.0)?];
        beside.iter().all(|other| (other - from).abs() <= UPRIGHT).then_some(from)
    }

    /// Keeps the joints that are known at an end that is not known in all axes.
    pub(super) fn forget(&mut self, frame: &Frame, end: &Position) {
        self.joints = [0, 1, 2, 3, 4, 5].map(|k| match k {
            0..3 => end[k].filter(|_| frame.is_plain()).map(|value| value + frame.map.origin[k]),
            _ => end[k].map(|angle| angle + frame.rotary[k - 3]),
        });
    }

    /// Returns the chain of a tool by its length, in mm.
    pub(super) fn chain(&mut self, length: f64) -> Result<Chain, StepFault> {
        if let Some((known, chain)) = &self.chain
            && *known == length
        {
            return Ok(*chain);
        }
        let setup = Setup { work_offset: self.origin, tool_length: length };
        let chain = self.machine.chain(&setup)?;
        // Without a work offset, linear joints are known up to a displacement only.
        let chain = if self.is_placed { chain } else { chain.without_linear_limits() };
        self.chain = Some((length, chain));
        Ok(chain)
    }
}

impl Frame {
    /// Returns whether each linear joint depends on one coordinate alone.
    pub(super) fn is_plain(&self) -> bool {
        !self.is_tip && self.map.rotation == Matrix3::identity()
    }

    /// Returns the joints at a position in program coordinates.
    pub(super) fn joints(&self, position: Joints) -> Joints {
        let [x, y, z] = self.map.apply([position[0], position[1], position[2]]);
        let [a, b, c] = [3, 4, 5].map(|k| position[k] + self.rotary[k - 3]);
        [x, y, z, a, b, c]
    }

    /// Returns the motions between two positions in program coordinates.
    pub(super) fn motions(
        &self,
        path: &StepPath,
        [start, end]: [Joints; 2],
    ) -> Result<Vec<(JointMotion, f64)>, StepFault> {
        let linear = [start, end].map(|position| [position[0], position[1], position[2]]);
        let segments = path::map(path, linear, &self.map)?.into_iter();
        let motions = segments.map(|segment| {
            let rotary = segment.fractions.map(|at| {
                [3, 4, 5].map(|k| {
                    // The end is exactly the one that is stated.
                    let value =
                        if at == 1.0 { end[k] } else { start[k] + at * (end[k] - start[k]) };
                    value + self.rotary[k - 3]
                })
            });
            let motion = match self.is_tip {
                true => {
                    let motion = JointMotion::with_tcp(&self.guide, rotary, &segment.path)?;
                    if self.guide == self.chain { motion } else { motion.with_tool(&self.chain) }
                }
                false => JointMotion::new(&self.chain, rotary, &segment.path)?,
            };
            Ok((motion, segment.error))
        });
        motions.collect()
    }
}
