//! Motions and changes of coordinates that Heidenhain Klartext has, and ISO 6983 has no words for.

use super::motion::{ArcWords, path};
use super::{AXES, Control, Motion, TapTurn};
use crate::gcode::block::Block;
use crate::gcode::error::{CompensationFault, combination, missing};
use crate::gcode::state::{LengthOffset, Position, Rotation, Tcp, WorkOffset};
use crate::gcode::{Alignment, GcodeFault, Plane, StepPath, Z_ALONE};
use std::sync::Arc;
use touchoff::Unit;

/// An arc in a plane, of which the tool axis need not be the normal. Lengths are in millimetres.
#[derive(Clone, Copy, Debug)]
pub(in crate::gcode) struct Circle {
    /// The statement, for messages.
    pub(in crate::gcode) word: &'static str,
    pub(in crate::gcode) plane: Plane,
    pub(in crate::gcode) curve: Curve,
    pub(in crate::gcode) rapid: bool,
    /// The unit of the program, in which the tolerance of its radii is defined.
    pub(in crate::gcode) unit: Unit,
}

/// The curve of an arc.
#[derive(Clone, Copy, Debug)]
pub(in crate::gcode) enum Curve {
    /// About a centre to the end.
    Centre { centre: [f64; 2], clockwise: bool },
    /// By its radius, which is below 0 for more than half a turn.
    Radius { radius: f64, clockwise: bool },
    /// About a centre by an angle in radians. The end is stated, too.
    Sweep { centre: [f64; 2], sweep: f64 },
}

impl Control {
    /// Returns the present position in program coordinates.
    pub(in crate::gcode) fn position(&self) -> Position {
        self.position
    }

    /// Returns the rotation of program coordinates.
    pub(in crate::gcode) fn rotation(&self) -> Rotation {
        self.state.rotation
    }

    /// Returns whether the machine has the axes A, B and C.
    pub(in crate::gcode) fn rotary_axes(&self) -> impl Iterator<Item = bool> + use<> {
        let [_, _, _, a, b, c] = self.axes;
        [a, b, c].into_iter()
    }

    /// Returns whether tool centre point control is on.
    pub(in crate::gcode) fn is_tcp(&self) -> bool {
        self.state.tcp != Tcp::Off
    }

    /// Returns whether the coordinates of the plane have changed by a rotation since both of its axes were stated.
    pub(in crate::gcode) fn is_rotation_open(&self) -> bool {
        self.rotation_changed
    }

    /// Executes an arc to the end that a block states, and returns its programmed path.
    pub(in crate::gcode) fn circle(
        &mut self,
        block: &mut Block,
        circle: Circle,
    ) -> Result<StepPath, GcodeFault> {
        let Circle { word, plane, curve, rapid, unit } = circle;
        self.check_compensated_plane(plane)?;
        self.feed(block)?;
        if !rapid {
            self.check_feed(word)?;
        }
        self.check_tilted(block)?;
        self.check_position(block)?;
        self.check_offset(block)?;
        let (end, _, commanded) = self.take_end(block);
        let words = |clockwise, centre: Option<[f64; 2]>, radius| {
            let mut offsets = [None; 3];
            for (axis, value) in plane.axes().into_iter().zip(centre.into_iter().flatten()) {
                offsets[axis] = Some(value);
            }
            ArcWords { clockwise, plane, offsets, absolute: true, radius, turns: 1, unit }
        };
        let path = match curve {
            Curve::Sweep { centre, sweep } => StepPath::Arc { plane, centre, sweep },
            Curve::Centre { centre, clockwise } => {
                path(&words(clockwise, Some(centre), None), self.position, end)?
            }
            Curve::Radius { radius, clockwise } => {
                path(&words(clockwise, None, Some(radius)), self.position, end)?
            }
        };
        if !matches!(curve, Curve::Sweep { .. }) {
            self.check_radii(&path, &end)?;
        }
        if let Curve::Radius { radius, .. } = curve
            && plane == self.modal.plane
        {
            self.check_radius_digits(radius, &end);
        }
        let known = self.pending.len();
        self.push(rapid, end, commanded, path);
        self.corners(block.corner.take(), known)?;
        self.compensate(known)?;
        Ok(path)
    }

    /// Moves to the machine coordinates of a block (M91), or to coordinates from a point of the machine's builder (M92).
    pub(in crate::gcode) fn machine_position(
        &mut self,
        block: &mut Block,
        rapid: bool,
        is_from_point: bool,
    ) -> Result<(), GcodeFault> {
        let word = if is_from_point { "M92" } else { "M91" };
        if self.is_tcp() {
            return Err(combination(word, "M128 is in force", "write M129 before"));
        }
        self.feed(block)?;
        if !rapid {
            self.check_feed("L")?;
        }
        let axes = self.take_axes(block);
        match (is_from_point, self.builder_point) {
            (false, _) => self.move_to_machine(axes),
            (true, Some(point)) => {
                // A stated point is where the builder lets tools be changed, as the top of Z's travel is.
                let is_at_point = axes[2] == Some(0.0) && self.state.origin[2].is_some();
                let mut target = axes;
                for (value, point) in target.iter_mut().zip(point) {
                    *value = value.map(|value| value + point);
                }
                let is_homeward = is_at_point || self.leads_home(target);
                self.move_to_machine(target);
                self.set_homeward(is_homeward);
            }
            // The place of an unstated point is the machine's alone.
            (true, None) => {
                self.move_machine(axes.map(|value| value.is_some()), [None; 6], StepPath::Line);
            }
        }
        let spindle = self.spindle(rapid);
        let step = self.pending.back_mut().expect("the step that was added");
        (step.rapid, step.spindle) = (rapid, spindle);
        Ok(())
    }

    /// Moves along the tool axis (M140) by a distance in millimetres, or to the end of the travel.
    pub(in crate::gcode) fn retract(&mut self, distance: Option<f64>, rapid: bool) {
        let at_zero = self.state.turns_nothing(self.position, &self.rotary_axes);
        // The axis of a table, or of a head that is turned about z, leaves the tool along z of the machine.
        let is_upright = !self.rotary_axes.tilts_tool(at_zero);
        // Positions that turn with the table have another z, but for that of a plane to which the tool is aligned.
        let is_along_z = match self.state.rotation {
            Rotation::Tilted { aligned, .. } => aligned,
            Rotation::Off | Rotation::Plane { .. } => {
                let turns_with_table = self.state.turns_with_workpiece();
                is_upright && !(turns_with_table && self.rotary_axes.tilts(at_zero))
            }
        };
        let end = self.position;
        match distance {
            Some(distance) if is_along_z => {
                let mut end = end;
                end[2] = end[2].map(|z| z + distance);
                self.push(rapid, end, Z_ALONE, StepPath::Line);
            }
            None if is_upright => {
                let target = [None, None, self.top, None, None, None];
                self.move_machine(Z_ALONE, target, StepPath::Line);
            }
            _ => {
                let mut end = end;
                end[..3].fill(None);
                self.push(rapid, end, [true, true, true, false, false, false], StepPath::Line);
            }
        }
        let spindle = self.spindle(rapid);
        let step = self.pending.back_mut().expect("the step that was added");
        // The way of Z to the end of its travel leads away from the part, as that to a home does. One along a tilted tool also leads
        // sideways.
        let is_homeward = distance.is_none() && is_upright;
        (step.rapid, step.spindle, step.is_homeward) = (rapid, spindle, is_homeward);
    }

    /// Moves along Z to a level in program coordinates, in millimetres.
    pub(in crate::gcode) fn move_to_level(&mut self, level: f64, rapid: bool) {
        if self.position[2] == Some(level) {
            return;
        }
        let mut end = self.position;
        end[2] = Some(level);
        self.push(rapid, end, Z_ALONE, StepPath::Line);
    }

    /// Taps a thread from one level to another and back, in millimetres.
    pub(in crate::gcode) fn tap(&mut self, [top, bottom]: [f64; 2], turn: TapTurn) {
        let motion = self.tapping_motion(turn);
        let thread = match motion {
            Some(Motion::Tap(thread)) => thread,
            _ => None,
        };
        let before = std::mem::replace(&mut self.modal.motion, motion);
        self.move_to_level(bottom, false);
        self.move_to_level(top, false);
        self.modal.motion = before;
        self.end_tapping(thread);
    }

    /// Returns whether the setup states work offsets of presets.
    pub(in crate::gcode) fn has_presets(&self) -> bool {
        !self.presets.is_empty()
    }

    /// Selects the work offset of a preset. Returns `false` if the setup does not state it.
    pub(in crate::gcode) fn select_preset(&mut self, number: f64) -> bool {
        let known = self.presets.iter().find(|(known, _)| f64::from(**known) == number);
        let Some((_, offset)) = known else { return false };
        self.select_offset(WorkOffset::Standard(*offset));
        true
    }

    /// Sets F, and returns the one before.
    pub(in crate::gcode) fn replace_feed(&mut self, feed: Option<f64>) -> Option<f64> {
        std::mem::replace(&mut self.modal.feed, feed)
    }

    /// Returns the radius of the tool in the spindle with its allowance (DR), in millimetres.
    pub(in crate::gcode) fn tool_radius(&self, word: &str) -> Result<f64, GcodeFault> {
        let tool = self.state.tool;
        let number = tool.ok_or_else(|| missing(word, "a tool in the spindle (TOOL CALL)"))?;
        let radius = self.radius_offsets.get(&number);
        let radius = radius.ok_or(CompensationFault::NoRadius { number })?;
        Ok(radius + self.radius_allowance)
    }

    /// Moves on a helix about a centre in X and Y to a level, at feed rate. The sweep is in radians, lengths are in millimetres. X and Y
    /// have to be known.
    pub(in crate::gcode) fn helix(&mut self, centre: [f64; 2], sweep: f64, level: f64) {
        let mut end = self.position;
        let radius = [0, 1].map(|axis| end[axis].map(|value| value - centre[axis]));
        if let [Some(x), Some(y)] = radius {
            let (sine, cosine) = sweep.sin_cos();
            end[0] = Some(centre[0] + x * cosine - y * sine);
            end[1] = Some(centre[1] + x * sine + y * cosine);
        }
        end[2] = Some(level);
        let commanded = [true, true, true, false, false, false];
        self.push(false, end, commanded, StepPath::Arc { plane: Plane::Xy, centre, sweep });
    }

    /// Moves to a point in X and Y at feed rate, in millimetres.
    pub(in crate::gcode) fn move_in_plane(&mut self, [x, y]: [f64; 2]) {
        let mut end = self.position;
        (end[0], end[1]) = (Some(x), Some(y));
        let commanded = [true, true, false, false, false, false];
        self.push(false, end, commanded, StepPath::Line);
    }

    /// Moves an axis by an increment, in millimetres.
    pub(in crate::gcode) fn move_by(&mut self, axis: usize, increment: f64, rapid: bool) {
        let mut end = self.position;
        end[axis] = end[axis].map(|value| value + increment);
        let mut commanded = [false; 6];
        commanded[axis] = true;
        self.push(rapid, end, commanded, StepPath::Line);
    }

    /// Sets the shift and the rotation of program coordinates.
    pub(in crate::gcode) fn set_coordinates(&mut self, shift: [f64; 6], rotation: Rotation) {
        self.local = shift;
        self.change(|state| {
            state.shift = shift.map(Some);
            state.rotation = rotation;
        });
    }

    /// Turns the rotary axes so that the tool stands along z of the tilted plane, at an angle of the master axis whose sign may be
    /// stated. X, Y and Z rest, or follow about a point below the tip by `pivot` millimetres.
    pub(in crate::gcode) fn align_with_plane(
        &mut self,
        pivot: Option<f64>,
        master_is_positive: Option<bool>,
    ) {
        let Rotation::Tilted { frame, .. } = self.state.rotation else { return };
        let mut end = self.position;
        end[3..].fill(None);
        let commanded = [false, false, false, true, true, true];
        self.turn(end, commanded, StepPath::Align, pivot);
        let step = self.pending.back_mut().expect("the step that was added");
        step.alignment = master_is_positive.map(|is_positive| Alignment::Master { is_positive });
        self.change(|state| state.rotation = Rotation::Tilted { frame, aligned: true });
    }

    /// Takes the tool to stand along z of the tilted plane, to which the program has turned the axes.
    pub(in crate::gcode) fn stand_along_plane(&mut self) {
        let Rotation::Tilted { frame, .. } = self.state.rotation else { return };
        self.push(true, self.position, [false; 6], StepPath::Align);
        self.change(|state| state.rotation = Rotation::Tilted { frame, aligned: true });
    }

    /// Turns the rotary axes to 0. X, Y and Z rest, or follow about a point below the tip by `pivot` millimetres.
    pub(in crate::gcode) fn turn_to_zero(&mut self, pivot: Option<f64>) {
        let mut end = self.position;
        let mut commanded = [false; 6];
        for axis in 3..AXES.len() {
            if self.axes[axis] {
                end[axis] = Some(0.0);
                commanded[axis] = true;
            }
        }
        if commanded.contains(&true) {
            self.turn(end, commanded, StepPath::Line, pivot);
        }
    }

    /// Turns the rotary axes on a path, or about a point below the tip by `pivot` millimetres.
    fn turn(
        &mut self,
        mut end: Position,
        mut commanded: [bool; 6],
        path: StepPath,
        pivot: Option<f64>,
    ) {
        let path = match pivot {
            Some(distance) => {
                end[..3].fill(None);
                commanded[..3].fill(true);
                StepPath::Pivot { distance }
            }
            None => path,
        };
        self.push(true, end, commanded, path);
    }

    /// Switches tool centre point control (M128).
    pub(in crate::gcode) fn set_tcp(&mut self, is_on: bool) {
        self.transformed = is_on;
        let tcp = if is_on { Tcp::Rotary } else { Tcp::Off };
        if self.state.tcp != tcp {
            self.change(|state| {
                state.tcp = tcp;
                state.tcp_starts += usize::from(is_on);
            });
        }
    }

    /// Sets whether rotary axes turn the shorter way (M126), whatever the control does otherwise.
    pub(in crate::gcode) fn set_shorter_way(&mut self, is_on: bool) {
        // It changes no coordinate, and so no position.
        if self.state.shorter_way != is_on {
            Arc::make_mut(&mut self.state).shorter_way = is_on;
        }
    }

    /// Sets the length of a tool, in millimetres, which the program states.
    pub(in crate::gcode) fn define_length(&mut self, tool: u32, length: f64) {
        Arc::make_mut(&mut self.lengths).insert(tool, length);
    }

    /// Sets the radius offset of a tool, in millimetres, which the program states.
    pub(in crate::gcode) fn define_radius(&mut self, tool: u32, radius: f64) {
        Arc::make_mut(&mut self.radius_offsets).insert(tool, radius);
    }

    /// Returns the length of a tool that is stated, in millimetres.
    pub(in crate::gcode) fn defined_length(&self, tool: u32) -> Option<f64> {
        self.lengths.get(&tool).copied()
    }

    /// Returns the radius offset of a tool that is stated, in millimetres.
    pub(in crate::gcode) fn defined_radius(&self, tool: u32) -> Option<f64> {
        self.radius_offsets.get(&tool).copied()
    }

    /// Returns whether a tool is in the spindle.
    pub(in crate::gcode) fn has_in_spindle(&self, tool: u32) -> bool {
        self.state.tool == Some(tool)
    }

    /// Sets what the program adds to the radius offset of the tool in the spindle (DR), in millimetres.
    pub(in crate::gcode) fn set_radius_allowance(&mut self, allowance: f64) {
        self.radius_allowance = allowance;
    }

    /// Returns whether the length of the tool in the spindle is in force.
    pub(in crate::gcode) fn has_length(&self) -> bool {
        self.state.length != LengthOffset::Off
    }
}
